#include "core/io/source/merge_classes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/io/export/export_layer.h"
#include "core/io/load/load_layer.h"
#include "core/io/prepared/open_layer.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// The field at that place in a row of fields of 100 metres, with lanes of ten metres between.
TestFeature field(int place, const std::string& use) {
  const std::string left = std::to_string(110 * place);
  const std::string right = std::to_string(110 * place + 100);
  std::string wkt = "POLYGON((";
  for (const std::string& corner : {left + " 0,", right + " 0,", right + " 100,", left + " 100,"}) {
    wkt += corner;
  }
  return {wkt + left + " 0))", place % 2, use};
}

class MergeClassesTest : public ::testing::Test {
 protected:
  MergeClassesTest() {
    write_source(path_, "GPKG",
                 {{.name = "fields",
                   .crs = "EPSG:3857",
                   .type = wkbPolygon,
                   .features = {field(0, "corn"), field(1, "corn"), field(2, "hay"),
                                field(3, "corn"), field(4, ""), field(5, "")}}});
  }

  std::vector<std::uint64_t> classes(const std::string& attribute) const {
    FeatureSource source(path_);
    MergeClasses reader(source, attribute);
    std::vector<std::uint64_t> classes;
    SourceFeature next;
    while (source.next(next)) classes.push_back(reader.class_of(next));
    return classes;
  }

  /// With gaps of up to twelve metres bridged.
  std::size_t blocks(const std::string& attribute) const {
    ExportOptions options;
    options.generalization.merge = 4;
    options.generalization.merge_by = attribute;
    options.epsilon = 40;
    options.overwrite = true;
    return export_layer(path_, folder_.file("out.fgb"), options).written;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.file("fields.gpkg");
};

TEST_F(MergeClassesTest, AreEqualForEqualValues) {
  const auto by_text = classes("text");
  ASSERT_EQ(by_text.size(), 6u);
  EXPECT_EQ(by_text[0], by_text[1]);
  EXPECT_NE(by_text[1], by_text[2]);
  EXPECT_EQ(by_text[0], by_text[3]);
  EXPECT_NE(by_text[3], by_text[4]);
  EXPECT_EQ(by_text[4], by_text[5]);
  const auto by_number = classes("number");
  EXPECT_EQ(by_number[0], by_number[2]);
  EXPECT_NE(by_number[0], by_number[1]);
  EXPECT_THAT(classes(""), ElementsAre(0, 0, 0, 0, 0, 0));
}

TEST_F(MergeClassesTest, OnlyFeaturesOfOneClassBecomeABlock) {
  EXPECT_EQ(blocks(""), 1u);
  EXPECT_EQ(blocks("text"), 4u);    // the first two, each of the next two, the last two
  EXPECT_EQ(blocks("number"), 6u);  // no two beside each other have the same number
}

TEST_F(MergeClassesTest, AnAttributeThatIsNotThereIsAnErrorThatNamesThoseThatAre) {
  LoadOptions options;
  options.generalization.merge = 4;
  options.generalization.merge_by = "colour";
  try {
    load_layer(path_, options);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(StartsWith(path_), HasSubstr("no attribute \"colour\""),
                                    HasSubstr("it has: number, text")));
  }
  EXPECT_THROW(blocks("colour"), std::runtime_error);
}

TEST_F(MergeClassesTest, WhatIsWrongWithThemIsFoundWithoutReading) {
  const auto parts = [this](const OpenOptions& options) {
    std::vector<OpenPart> found;
    for (const OpenFinding& finding : examine_layer(path_, options)) {
      EXPECT_THAT(finding.what, StartsWith(path_));
      found.push_back(finding.part);
    }
    return found;
  };
  EXPECT_THAT(parts({.merge = 4, .merge_by = "text"}), IsEmpty());
  EXPECT_THAT(parts({.merge = 4, .merge_by = "colour"}), ElementsAre(OpenPart::merge_by));
  EXPECT_THAT(parts({.merge_by = "text"}), ElementsAre(OpenPart::merge_by));
  EXPECT_THROW(open_layer(path_, {.merge_by = "text"}), std::runtime_error);
}

TEST_F(MergeClassesTest, GroupsOfOtherClassesAreNotTakenOver) {
  LoadOptions options;
  options.generalization.merge = 4;
  options.generalization.merge_by = "text";
  options.earlier = load_layer(path_, options).layer;
  EXPECT_EQ(load_layer(path_, options).report.taken_over, 6u);
  const std::string other = folder_.file("other.gpkg");
  write_source(other, "GPKG",
               {{.name = "fields",
                 .crs = "EPSG:3857",
                 .type = wkbPolygon,
                 .features = {field(0, "hay"), field(1, "corn"), field(2, "hay"), field(3, "corn"),
                              field(4, ""), field(5, "")}}});
  EXPECT_EQ(load_layer(other, options).report.taken_over, 0u);
}

}  // namespace
}  // namespace trapeze
