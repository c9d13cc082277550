# Debian packages: trapeze, the server, and libtrapeze-dev, the libraries. Built with cpack -G DEB.
set(TRAPEZE_PACKAGE_CONTACT "Trapeze developers <trapeze@packages.invalid>" CACHE STRING
  "Who answers for the packages of Debian: Name <address>")

# Includes the licence of the viewer's map library.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE licence)
set(copyright "Trapeze\n\n${licence}")
if(TRAPEZE_HAS_VIEWER)
  file(READ ${PROJECT_SOURCE_DIR}/web/node_modules/leaflet/LICENSE licence)
  string(APPEND copyright "\n\nLeaflet, within the program\n\n${licence}")
endif()
file(CONFIGURE OUTPUT copyright CONTENT "${copyright}" @ONLY)

string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
function(make_changelog package)
  set(changelog ${CMAKE_CURRENT_BINARY_DIR}/${package}.changelog)
  file(CONFIGURE OUTPUT ${changelog} @ONLY CONTENT
"${package} (${PROJECT_VERSION}) unstable; urgency=medium

  * What has changed is told by CHANGELOG.md beside this file.

 -- ${TRAPEZE_PACKAGE_CONTACT}  ${date}
")
  execute_process(COMMAND gzip --best --no-name --keep --force ${changelog} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(package "program trapeze" "development libtrapeze-dev")
  string(REPLACE " " ";" package ${package})
  list(GET package 0 component)
  list(GET package 1 name)
  make_changelog(${name})
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/copyright ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${folder} COMPONENT ${component})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.changelog.gz DESTINATION ${folder} COMPONENT ${component}
    RENAME changelog.gz)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME trapeze)
set(CPACK_PACKAGE_CONTACT ${TRAPEZE_PACKAGE_CONTACT})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own
# Files are installed at the paths in the unit and the configuration.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME trapeze)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION web)
# In addition to the libraries: the unit reloads with kill.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS procps)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libegl-mesa0, libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS libosmesa6)  # loaded only when it is requested
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "tile server for polygon maps
Reads polygons in any format of GDAL and serves them over HTTP as PNG and WebP
tiles, in the style that a request asks for, simplified to what a pixel shows.
It draws through EGL, or in plain C++ where there is none.")
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/conffiles "${etc}/trapeze.toml\n")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/conffiles)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtrapeze-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS libgdal-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "simplification of polygons for maps (development files)
Static libraries, headers and files of CMake: rings become a trapezoidal graph,
which is adapted to any tolerance, forward and back, without a crossing.")
include(CPack)
