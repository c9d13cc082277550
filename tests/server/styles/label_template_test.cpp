#include "server/styles/label_template.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace trapeze {
namespace {

class LabelTemplateTest : public ::testing::Test {
 protected:
  LabelTemplateTest()
      : features_({{"name", FieldType::text},
                   {"A3", FieldType::text},
                   {"people", FieldType::integer},
                   {"share", FieldType::real}}) {
    features_.append(1,
                     std::vector<Value>{"  Saint\n\tLucia ", "LCA", std::int64_t{183'629}, 0.25});
    features_.append(2, std::vector<Value>{Value(), "X", Value(), Value()});
    features_.append(3, std::vector<Value>{" ", Value(), Value(), Value()});
    features_.append(4, std::vector<Value>{Value(), Value(), Value(), std::nan("")});
    features_.append(5, std::vector<Value>{Value(), Value(), Value(), -0.0});
  }

  std::string text(const std::string& written, std::uint32_t row,
                   const std::optional<NumberFormat>& format = {}) const {
    const auto bound = LabelTemplate::bind(written, features_);
    EXPECT_TRUE(bound) << written;
    return bound->text_of(features_, row, format);
  }

  FeatureTable features_;
};

TEST_F(LabelTemplateTest, SaysWhatAttributesHave) {
  EXPECT_EQ(text("name", 0), "Saint Lucia");
  EXPECT_EQ(text("{name} ({A3})", 0), "Saint Lucia (LCA)");
  EXPECT_EQ(text("{people}/{share}", 0), "183629/0.25");
  EXPECT_EQ(text("{people}/{share}", 0, parse_number_format(",.2f")), "183,629.00/0.25");
}

TEST_F(LabelTemplateTest, NullSaysNothing) {
  EXPECT_EQ(text("name", 1), "");
  EXPECT_EQ(text("{name} ({A3})", 1), "(X)");
  EXPECT_EQ(text("{name}: {people} people", 1), "");
  EXPECT_EQ(text("{name}!", 2), "") << "white space is nothing";
  EXPECT_EQ(text("share", 3), "") << "not a number";
  EXPECT_EQ(text("share", 4), "0");
}

TEST_F(LabelTemplateTest, SaysInALanguageWhatIsKnownInIt) {
  FeatureTable features({{"name", FieldType::text},
                         {"name:de", FieldType::text},
                         {"kind", FieldType::text},
                         {"kind_de", FieldType::text},
                         {"people", FieldType::integer}});
  features.append(1, std::vector<Value>{"Vienna", "Wien", "city", "Stadt", std::int64_t{2}});
  features.append(2, std::vector<Value>{"Graz", Value(), "city", " ", std::int64_t{1}});
  const auto said = [&](const std::string& written, const char* language, std::uint32_t row) {
    const auto bound = LabelTemplate::bind(written, features, language);
    return bound->translation_of(features, nullptr, row, {});
  };
  EXPECT_EQ(said("name", "de", 0), "Wien");
  EXPECT_EQ(said("{kind} {name}: {people}", "de", 0), "Stadt Wien: 2");
  EXPECT_EQ(said("{kind} {name}", "de", 1), "city Graz") << "null and blanks say nothing";
  EXPECT_EQ(said("{kind} {name}", "fr", 0), "city Vienna");
  EXPECT_EQ(LabelTemplate::bind("name", features, "de")->text_of(features, 0, {}), "Vienna");
}

TEST_F(LabelTemplateTest, WhatIsLongEndsInAnEllipsis) {
  FeatureTable features({{"t", FieldType::text}});
  std::string umlauts;
  for (int i = 0; i < 500; ++i) umlauts += "\u00e4";
  features.append(1, std::vector<Value>{umlauts});
  const std::string text = LabelTemplate::bind("t", features)->text_of(features, 0, {});
  EXPECT_EQ(text, umlauts.substr(0, 2 * LabelTemplate::kMostLetters) + "\u2026");
}

TEST_F(LabelTemplateTest, BracesHaveToFit) {
  for (const char* valid : {"name", "{name}", "a {name} b", "{a}{b}", "no such"}) {
    EXPECT_TRUE(LabelTemplate::is_valid(valid)) << valid;
  }
  for (const char* broken :
       {"", "{", "}", "{}", "{name", "name}", "{{name}}", "}{", "{a}{", "{a{b}}"}) {
    EXPECT_FALSE(LabelTemplate::is_valid(broken)) << broken;
  }
}

TEST_F(LabelTemplateTest, AnUnknownAttributeIsNamed) {
  const auto bound = LabelTemplate::bind("{name} {nmae}", features_);
  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.problem().status, 400);
  EXPECT_EQ(bound.problem().parameter, "label");
  EXPECT_NE(bound.problem().detail.find("nmae"), std::string::npos) << bound.problem().detail;
}

}  // namespace
}  // namespace trapeze
