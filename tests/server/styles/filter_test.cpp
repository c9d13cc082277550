#include "server/styles/filter.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Rows 0 to 3: name, people and height of places; the last one has no values.
FeatureTable places() {
  FeatureTable table({{"name", FieldType::text},
                      {"people", FieldType::integer},
                      {"height", FieldType::real},
                      {"is in", FieldType::text}});
  const auto add = [&table](std::vector<Value> values) {
    table.append(static_cast<std::int64_t>(table.size()), values);
  };
  add({"Zürich", std::int64_t{430000}, 408.0, "Zürich"});
  add({"O'Hare", std::int64_t{-5}, 204.5, "Illinois"});
  add({"100%", std::int64_t{9007199254740993}, std::nan(""), "a_b"});
  add({Value(), Value(), Value(), Value()});
  return table;
}

std::string canonical_filter(std::string_view text) {
  const auto parsed = Filter::parse(text);
  if (const auto* mistake = std::get_if<1>(&parsed)) return "mistake: " + mistake->what;
  return std::get<0>(parsed)->text();
}

std::vector<std::uint32_t> rows(std::string_view text) {
  const FeatureTable table = places();
  const auto parsed = Filter::parse(text);
  if (parsed.index() != 0) {
    ADD_FAILURE() << text << ": " << std::get<1>(parsed).what;
    return {};
  }
  const auto bound = BoundFilter::bind(std::get<0>(parsed), table);
  if (!bound) {
    ADD_FAILURE() << text << ": " << bound.problem().detail;
    return {};
  }
  std::vector<std::uint32_t> passing;
  for (std::uint32_t row = 0; row < table.size(); ++row) {
    if (bound->passes(row)) passing.push_back(row);
  }
  return passing;
}

TEST(FilterTest, ComparesNumbers) {
  EXPECT_THAT(rows("people = 430000"), ElementsAre(0));
  EXPECT_THAT(rows("people <> 430000"), ElementsAre(1, 2));
  EXPECT_THAT(rows("people < 0"), ElementsAre(1));
  EXPECT_THAT(rows("people <= -5"), ElementsAre(1));
  EXPECT_THAT(rows("people > 1e5"), ElementsAre(0, 2));
  EXPECT_THAT(rows("people >= 430000"), ElementsAre(0, 2));
  EXPECT_THAT(rows("height > 204.4 AND height < 204.6"), ElementsAre(1));
  EXPECT_THAT(rows("0 > people"), ElementsAre(1)) << "a literal may come first";
}

TEST(FilterTest, ComparesLargeIntegersExactly) {
  EXPECT_THAT(rows("people = 9007199254740993"), ElementsAre(2));
  EXPECT_THAT(rows("people = 9007199254740992"), IsEmpty());
  EXPECT_THAT(rows("people > 9007199254740992"), ElementsAre(2));
}

TEST(FilterTest, ComparesText) {
  EXPECT_THAT(rows("name = 'O''Hare'"), ElementsAre(1));
  EXPECT_THAT(rows("name > 'P'"), ElementsAre(0));
  EXPECT_THAT(rows("name IN ('Zürich', 'Bern', '100%')"), ElementsAre(0, 2));
  EXPECT_THAT(rows("name NOT IN ('Zürich', 'Bern')"), ElementsAre(1, 2));
  EXPECT_THAT(rows("\"is in\" = 'Illinois'"), ElementsAre(1));
}

TEST(FilterTest, LikeKnowsPlaceholders) {
  EXPECT_THAT(rows("name LIKE 'Z%'"), ElementsAre(0));
  EXPECT_THAT(rows("name LIKE 'Z_rich'"), ElementsAre(0)) << "one character, not one byte";
  EXPECT_THAT(rows("name LIKE '%a%e'"), ElementsAre(1));
  EXPECT_THAT(rows("name LIKE '%'"), ElementsAre(0, 1, 2));
  EXPECT_THAT(rows("name LIKE '100\\%'"), ElementsAre(2));
  EXPECT_THAT(rows("\"is in\" LIKE 'a\\_b'"), ElementsAre(2));
  EXPECT_THAT(rows("\"is in\" LIKE 'a_'"), IsEmpty());
  EXPECT_THAT(rows("name NOT LIKE '%r%'"), ElementsAre(2));
  EXPECT_THAT(rows("name LIKE ''"), IsEmpty());
}

TEST(FilterTest, BetweenHasBothEnds) {
  EXPECT_THAT(rows("people BETWEEN -5 AND 430000"), ElementsAre(0, 1));
  EXPECT_THAT(rows("people NOT BETWEEN -5 AND 430000"), ElementsAre(2));
  EXPECT_THAT(rows("people BETWEEN 1 AND 0"), IsEmpty());
}

TEST(FilterTest, WhatIsUnknownDoesNotPassNorDoesItsOpposite) {
  EXPECT_THAT(rows("people IS NULL"), ElementsAre(3));
  EXPECT_THAT(rows("people IS NOT NULL"), ElementsAre(0, 1, 2));
  EXPECT_THAT(rows("NOT people = 430000"), ElementsAre(1, 2));
  EXPECT_THAT(rows("people = 1 OR people IS NULL"), ElementsAre(3));
  EXPECT_THAT(rows("NOT (people = 1 AND name = 'x')"), ElementsAre(0, 1, 2));
  EXPECT_THAT(rows("height < 1e9 OR height >= 1e9"), ElementsAre(0, 1)) << "not a number";
}

TEST(FilterTest, AndBindsTighterThanOrAndNotTighterStill) {
  EXPECT_THAT(rows("people = -5 OR people = 430000 AND name = 'x'"), ElementsAre(1));
  EXPECT_THAT(rows("(people = -5 OR people = 430000) AND name = 'x'"), IsEmpty());
  EXPECT_THAT(rows("NOT people = -5 AND people = -5"), IsEmpty());
  EXPECT_THAT(rows("not (people=-5 or (people=430000))"), ElementsAre(2));
}

TEST(FilterTest, EqualFiltersHaveOneText) {
  const std::string text = canonical_filter("a = 1 AND b IN (2, 1) AND NOT c LIKE 'x'");
  for (const char* same : {"b in(1,2,2)and a=1 and c not like 'x'",
                           "(a = 1.0) AND ((b IN (2,1)) AND NOT (c LIKE 'x'))",
                           "NOT c LIKE 'x' AND a=1 AND 1 = a AND b IN (1,2)",
                           " a=+1\tAND\n\"b\" IN (2,1) AND NOT NOT NOT c LIKE 'x'"}) {
    EXPECT_EQ(canonical_filter(same), text) << same;
  }
  EXPECT_NE(canonical_filter("a=1 OR b=1"), canonical_filter("a=1 AND b=1"));
  EXPECT_NE(canonical_filter("a='1'"), canonical_filter("a=1"));
  EXPECT_NE(canonical_filter("A=1"), canonical_filter("a=1"))
      << "names of properties keep their case";
}

TEST(FilterTest, TheTextReadsBackAsItself) {
  for (const char* filter :
       {"a=1", "\"a b\"='it''s'", "\"and\" IS NOT NULL", "NOT (a=1 OR b=2)", "a=1 AND (b=2 OR c=3)",
        "a BETWEEN 1e300 AND 0.1", "a = -0", "a<>TRUE", "\"x\"\"y\" LIKE '%\\%'", "5 < a"}) {
    const std::string text = canonical_filter(filter);
    EXPECT_EQ(canonical_filter(text), text) << filter;
    EXPECT_THAT(text, ::testing::Not(HasSubstr("mistake"))) << filter;
  }
}

TEST(FilterTest, IsRefusedIfItsTextWouldBeNestedTooDeep) {
  std::string filter = "a IS NOT NULL";
  for (std::size_t i = 0; i < kMaxFilterDepth; ++i) {
    filter = "a=2 OR b=1 AND (" + filter + ")";
    const std::string text = canonical_filter(filter);
    if (text.starts_with("mistake")) continue;
    EXPECT_EQ(canonical_filter(text), text) << filter;
  }
  EXPECT_THAT(canonical_filter(filter), HasSubstr("deep"));
}

TEST(FilterTest, NumbersBeyondExactDoublesKeepTheirText) {
  // From 2^53 to 10^16 a whole double is written like an integer, and integers sort before doubles.
  const std::string text =
      canonical_filter("n IN (.4,9223372039223372.37,1e17,-9223372036854775808.0,1e30)");
  EXPECT_EQ(canonical_filter(text), text);
  EXPECT_EQ(text, "n IN (-9223372036854775808,9223372039223372,100000000000000000,0.4,1e+30)");
}

TEST(FilterTest, MistakesAreTold) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "at its end"},
      {"a", "at its end"},
      {"a =", "at its end"},
      {"= 1", "at byte 1"},
      {"a = b", "at byte 5"},
      {"a = 1 b", "at byte 7, expected AND, OR or the end"},
      {"a = 'x", "the quote at byte 5 is not closed"},
      {"a\n=\n'x\n'", "at byte 7 there is a control character"},
      {"\"a\x7f\" = 1", "at byte 3 there is a control character"},
      {"\"a = 1", "the quote at byte 1"},
      {"(a = 1", ")"},
      {"a IN ()", "a literal"},
      {"a IN 1", "("},
      {"a BETWEEN 1", "AND"},
      {"a IS 1", "NULL"},
      {"a LIKE 1", "single quotes"},
      {"a NOT = 1", "IN, BETWEEN or LIKE"},
      {"a = 1e999", "number"},
      {"a = 1x", "number"},
      {"a = 1; DROP TABLE", "at byte 6"},
      {"NOT", "at its end"},
      {"f(a) = 1", "at byte 2"},
      {std::string(40, '(') + "a=1" + std::string(40, ')'), "deep"},
      {[] {
         std::string t;
         for (int i = 0; i < 40; ++i) t += "NOT ";
         return t + "a=1";
       }(),
       "deep"},
      {"a IN (" +
           [] {
             std::string t = "1";
             for (int i = 0; i < 300; ++i) t += ",1";
             return t;
           }() +
           ")",
       "literals"},
      {"a = '" + std::string(2000, 'x') + "'", "longer than 1024"}};
  for (const auto& [text, says] : wrong) {
    const auto parsed = Filter::parse(text);
    ASSERT_EQ(parsed.index(), 1u) << text;
    EXPECT_THAT(std::get<1>(parsed).what, HasSubstr(says)) << text;
  }
}

TEST(FilterTest, PropertiesThatAreNotThereOrDoNotFitAreProblems) {
  const FeatureTable table = places();
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"nosuch = 1", "name, people, height, is in"},
      {"people = 1 AND (nosuch IS NULL)", "name, people"},
      {"people = 'x'", "a number"},
      {"name = 1", "single quotes"},
      {"people LIKE '1%'", "a number"},
      {"name IN ('a', 1)", "single quotes"}};
  for (const auto& [text, takes] : wrong) {
    const auto filter = std::get<0>(Filter::parse(text));
    const auto bound = BoundFilter::bind(filter, table);
    ASSERT_FALSE(bound) << text;
    EXPECT_EQ(bound.problem().status, 400);
    EXPECT_EQ(bound.problem().parameter, "filter");
    EXPECT_THAT(bound.problem().takes, HasSubstr(takes)) << text;
  }
}

TEST(FilterTest, WhateverIsWrittenIsAFilterOrAMistake) {
  const std::vector<std::string> pieces = {
      "a",   "people", "\"is in\"", "=",  "<",       "<>",   ">=",  "(",    ")", ",",
      "AND", "OR",     "NOT",       "IN", "BETWEEN", "LIKE", "IS",  "NULL", "1", "-2.5",
      "'x'", "'%'",    "TRUE",      "'",  "\"",      "\xff", "1e9", ";",    "\\"};
  std::mt19937 random(7);
  int filters = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::string text;
    const auto length = std::uniform_int_distribution<int>(1, 9)(random);
    for (int k = 0; k < length; ++k) {
      text += pieces[std::uniform_int_distribution<std::size_t>(0, pieces.size() - 1)(random)];
      text += random() % 4 == 0 ? "" : " ";
    }
    const auto parsed = Filter::parse(text);
    if (parsed.index() != 0) continue;
    ++filters;
    const std::string canonical_text = std::get<0>(parsed)->text();
    ASSERT_EQ(canonical_filter(canonical_text), canonical_text) << text;
  }
  EXPECT_GT(filters, 100);
}

}  // namespace
}  // namespace trapeze
