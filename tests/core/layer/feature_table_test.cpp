#include "core/layer/feature_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace trapeze {
namespace {

FeatureTable make_table() {
  return FeatureTable(
      {{"population", FieldType::integer}, {"height", FieldType::real}, {"name", FieldType::text}});
}

TEST(FeatureTableTest, GivesBackEveryValueOfEveryType) {
  FeatureTable table = make_table();
  EXPECT_EQ(table.append(17, std::vector<Value>{std::int64_t{-5}, 2.5, std::string_view("Gozo")}),
            0u);
  EXPECT_EQ(table.append(-3, std::vector<Value>{std::numeric_limits<std::int64_t>::min(), -0.0,
                                                std::string_view("")}),
            1u);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table.id(0), 17);
  EXPECT_EQ(table.id(1), -3);
  EXPECT_EQ(table.value(0, 0), Value(std::int64_t{-5}));
  EXPECT_EQ(table.value(0, 1), Value(2.5));
  EXPECT_EQ(table.value(0, 2), Value(std::string_view("Gozo")));
  EXPECT_EQ(table.value(1, 0), Value(std::numeric_limits<std::int64_t>::min()));
  EXPECT_TRUE(std::signbit(std::get<double>(table.value(1, 1))));
  EXPECT_EQ(table.value(1, 2), Value(std::string_view("")));
}

TEST(FeatureTableTest, KeepsNullApartFromZeroAndFromEmptyText) {
  FeatureTable table = make_table();
  table.append(0, std::vector<Value>{std::int64_t{0}, 0.0, std::string_view("")});
  table.append(1, std::vector<Value>{Value(), Value(), Value()});
  table.append(2, std::vector<Value>{std::int64_t{0}, 0.0, std::string_view("")});
  for (int field = 0; field < 3; ++field) {
    EXPECT_NE(table.value(0, field), Value());
    EXPECT_EQ(table.value(1, field), Value());
    EXPECT_EQ(table.value(2, field), table.value(0, field));
  }
}

TEST(FeatureTableTest, FindsFieldsByName) {
  const FeatureTable table = make_table();
  EXPECT_EQ(table.field_index("population"), 0);
  EXPECT_EQ(table.field_index("name"), 2);
  EXPECT_EQ(table.field_index("Name"), -1);
  EXPECT_EQ(table.field_index(""), -1);
}

TEST(FeatureTableTest, KeepsThousandsOfDifferentTextsApart) {
  FeatureTable table({{"a", FieldType::text}, {"b", FieldType::text}});
  for (int i = 0; i < 10'000; ++i) {
    const std::string a = "street " + std::to_string(i);
    const std::string b = "street " + std::to_string(i % 7);
    table.append(i, std::vector<Value>{std::string_view(a), std::string_view(b)});
  }
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    EXPECT_EQ(std::get<std::string_view>(table.value(i, 0)), "street " + std::to_string(i));
    EXPECT_EQ(std::get<std::string_view>(table.value(i, 1)), "street " + std::to_string(i % 7));
  }
}

TEST(FeatureTableTest, StoresEqualTextsOnce) {
  FeatureTable table({{"a", FieldType::text}, {"b", FieldType::text}});
  const std::string text(1000, 'x');
  for (int i = 0; i < 1000; ++i) {
    table.append(i, std::vector<Value>{std::string_view(text), std::string_view(text)});
  }
  EXPECT_LT(table.memory(), 100'000u);
}

TEST(FeatureTableTest, GivesBackMemoryAndStillFindsItsTextsWhenMoreIsAppended) {
  FeatureTable table({{"a", FieldType::text}});
  const auto append = [&table](int i) {
    const std::string text = "street " + std::to_string(i);
    table.append(i, std::vector<Value>{std::string_view(text)});
  };
  for (int i = 0; i < 1000; ++i) append(i);
  const std::size_t before = table.memory();
  table.shrink_to_fit();
  EXPECT_LT(table.memory(), before);
  const std::size_t strings = table.cells().string_ends.size();
  for (int i = 0; i < 1000; ++i) append(i);
  EXPECT_EQ(table.cells().string_ends.size(), strings);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    EXPECT_EQ(std::get<std::string_view>(table.value(i, 0)), "street " + std::to_string(i % 1000));
  }
}

TEST(FeatureTableTest, TakesTextWithZeroBytes) {
  FeatureTable table({{"a", FieldType::text}});
  const std::string_view text("a\0b", 3);
  table.append(0, std::vector<Value>{text});
  table.append(1, std::vector<Value>{std::string_view("a")});
  EXPECT_EQ(table.value(0, 0), Value(text));
  EXPECT_EQ(table.value(1, 0), Value(std::string_view("a")));
}

TEST(FeatureTableTest, RefusesARowThatDoesNotFitTheFieldsAndStaysAsItWas) {
  FeatureTable table = make_table();
  EXPECT_THROW(table.append(0, std::vector<Value>{std::int64_t{1}}), std::invalid_argument);
  EXPECT_THROW(table.append(0, std::vector<Value>{std::int64_t{1}, 1.0, 2.0}),
               std::invalid_argument);
  EXPECT_EQ(table.size(), 0u);
  table.append(9, std::vector<Value>{std::int64_t{1}, 1.0, std::string_view("ok")});
  EXPECT_EQ(table.value(0, 2), Value(std::string_view("ok")));
}

TEST(FeatureTableTest, WorksWithoutAnyField) {
  FeatureTable table;
  EXPECT_EQ(table.append(4, {}), 0u);
  EXPECT_EQ(table.id(0), 4);
  EXPECT_TRUE(table.fields().empty());
}

TEST(FeatureTableTest, ATableOverItsCellsGivesTheSameValues) {
  FeatureTable table = make_table();
  for (int i = 0; i < 200; ++i) {
    const std::string name = "name " + std::to_string(i % 13);
    const Value number = i % 5 == 0 ? Value() : Value(std::int64_t{i});
    const Value text = i % 7 == 0 ? Value() : Value(std::string_view(name));
    table.append(i, std::vector<Value>{number, i * 0.5, text});
  }
  const FeatureTable view({table.fields().begin(), table.fields().end()}, table.cells());
  ASSERT_EQ(view.size(), table.size());
  for (std::uint32_t row = 0; row < 200; ++row) {
    EXPECT_EQ(view.id(row), table.id(row));
    for (int field = 0; field < 3; ++field) {
      EXPECT_EQ(view.value(row, field), table.value(row, field)) << row << " " << field;
    }
  }
}

TEST(FeatureTableTest, AppendingToATableOverCellsLeavesThemAlone) {
  FeatureTable table = make_table();
  table.append(1, std::vector<Value>{std::int64_t{1}, 1.0, std::string_view("one")});
  FeatureTable view({table.fields().begin(), table.fields().end()}, table.cells());
  view.append(2, std::vector<Value>{Value(), 2.0, std::string_view("one")});
  EXPECT_EQ(table.size(), 1u);
  ASSERT_EQ(view.size(), 2u);
  EXPECT_EQ(view.value(0, 0), Value(std::int64_t{1}));
  EXPECT_EQ(view.value(1, 0), Value());
  EXPECT_EQ(view.value(1, 2), Value(std::string_view("one")));
}

TEST(FeatureTableTest, RefusesCellsThatDoNotFit) {
  FeatureTable table = make_table();
  table.append(1, std::vector<Value>{std::int64_t{1}, 1.0, std::string_view("one")});
  table.append(2, std::vector<Value>{Value(), 1.0, std::string_view("two")});
  const std::vector<Field> fields(table.fields().begin(), table.fields().end());
  const auto refused = [&fields](const FeatureTable::Cells& cells) {
    try {
      FeatureTable(fields, cells);
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  ASSERT_FALSE(refused(table.cells()));
  FeatureTable::Cells cells = table.cells();
  cells.columns.pop_back();
  EXPECT_TRUE(refused(cells)) << "a column is missing";
  cells = table.cells();
  cells.columns[0].numbers = cells.columns[0].numbers.first(1);
  EXPECT_TRUE(refused(cells)) << "a number is missing";
  cells = table.cells();
  cells.columns[2].texts = {};
  EXPECT_TRUE(refused(cells)) << "texts are missing";
  cells = table.cells();
  cells.columns[0].texts = cells.columns[2].texts;
  EXPECT_TRUE(refused(cells)) << "numbers have texts";
  const std::vector<std::uint32_t> wild = {0, 2};
  cells = table.cells();
  cells.columns[2].texts = wild;
  EXPECT_TRUE(refused(cells)) << "a text is not there";
  for (const std::vector<std::uint64_t>& ends :
       {std::vector<std::uint64_t>{3, 7}, std::vector<std::uint64_t>{4, 3}}) {
    cells = table.cells();
    cells.string_ends = ends;
    EXPECT_TRUE(refused(cells)) << "texts end at " << ends[1];
  }
}

}  // namespace
}  // namespace trapeze
