# Installs the libraries core and core/io for other programs, which find them with
# find_package(Trapeze).
include(CMakePackageConfigHelpers)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/trapeze)
set(cmake_files ${CMAKE_INSTALL_LIBDIR}/cmake/Trapeze)

set_target_properties(trapeze_core PROPERTIES EXPORT_NAME core)
set_target_properties(trapeze_io PROPERTIES EXPORT_NAME io)
install(TARGETS trapeze_core EXPORT TrapezeCore ARCHIVE COMPONENT development
  INCLUDES DESTINATION ${headers})
install(TARGETS trapeze_io EXPORT TrapezeIo ARCHIVE COMPONENT development)
foreach(export TrapezeCore TrapezeIo)
  install(EXPORT ${export} NAMESPACE Trapeze:: DESTINATION ${cmake_files} COMPONENT development)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core DESTINATION ${headers} COMPONENT development
  FILES_MATCHING PATTERN "*.h" PATTERN io EXCLUDE)
# The headers of core/io that do not expose GDAL.
foreach(header export/export_crs export/export_layer load/load_layer load/load_report prepared/open_layer
    source/source_selection)
  get_filename_component(folder core/io/${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/core/io/${header}.h DESTINATION ${headers}/${folder} COMPONENT development)
endforeach()

configure_package_config_file(TrapezeConfig.cmake.in TrapezeConfig.cmake INSTALL_DESTINATION ${cmake_files}
  NO_SET_AND_CHECK_MACRO)
# Before 1.0, a minor version may change the interface.
write_basic_package_version_file(TrapezeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/TrapezeConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/TrapezeConfigVersion.cmake
  DESTINATION ${cmake_files} COMPONENT development)
