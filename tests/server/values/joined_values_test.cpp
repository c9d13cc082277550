#include "server/values/joined_values.h"

#include <gmock/gmock.h>

#include "core/layer/layer_builder.h"
#include "server/values/derived_values.h"
#include "server/values/read_values.h"
#include "server/values/value_book.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Features with codes as text, integers and numbers: FRA 7 7.5, DEU 8 8.5, one without any, FRA 7
/// 7.5.
std::unique_ptr<const Layer> countries() {
  FeatureTable features(
      {{"A3", FieldType::text}, {"number", FieldType::integer}, {"share", FieldType::real}});
  const auto add = [&features](std::vector<Value> values) { features.append(0, values); };
  add({"FRA", std::int64_t{7}, 7.5});
  add({"DEU", std::int64_t{8}, 8.5});
  add({Value(), Value(), Value()});
  add({"FRA", std::int64_t{7}, 7.5});
  std::vector<LayerBuilder> builders(1);
  return LayerBuilder::join(builders, std::move(features));
}

std::shared_ptr<const ValueTable> table_of(std::string_view text) {
  auto table = read_values(text, TableFormat::csv, {});
  if (!table) throw std::invalid_argument(table.problem().detail);
  return std::make_shared<const ValueTable>(*std::move(table));
}

class JoinedValuesTest : public ::testing::Test {
 protected:
  std::shared_ptr<const JoinedValues> join(std::string_view text, int field) {
    auto joined = JoinedValues::join(table_of(text), *layer_, field);
    if (!joined) throw std::invalid_argument(joined.problem().detail);
    return *joined;
  }

  const std::unique_ptr<const Layer> layer_ = countries();
};

TEST_F(JoinedValuesTest, JoinsByTextsThatAreTheSame) {
  const auto joined = join("key,value\nFRA,1\nfra,2\nITA,3\nDEU,\n", 0);
  EXPECT_TRUE(joined->value(0) == Value(std::int64_t{1}));
  EXPECT_TRUE(joined->value(1) == Value());
  EXPECT_TRUE(joined->value(2) == Value());
  EXPECT_TRUE(joined->value(3) == Value(std::int64_t{1}));
  EXPECT_EQ(joined->matched_rows(), 2u);
  EXPECT_THAT(joined->unmatched_keys(), ElementsAre("fra", "ITA"));
  EXPECT_EQ(joined->unmatched_features(), 1u);
}

TEST_F(JoinedValuesTest, JoinsByNumbersHoweverTheyAreWritten) {
  const auto joined = join("key,value\n007,a\n8.0,b\n9,c\nx,d\n", 1);
  EXPECT_TRUE(joined->value(0) == Value(std::string_view("a")));
  EXPECT_TRUE(joined->value(1) == Value(std::string_view("b")));
  EXPECT_THAT(joined->unmatched_keys(), ElementsAre("9", "x"));
  EXPECT_TRUE(join("key,value\n7.50,1\nnan,2\n", 2)->value(3) == Value(std::int64_t{1}));
}

TEST_F(JoinedValuesTest, TakesCommasForPointsInKeysWhereSemicolonsPartFields) {
  EXPECT_TRUE(join("key;value\n7,50;1\n", 2)->value(3) == Value(std::int64_t{1}));
  EXPECT_TRUE(join("key;value\n7,0;1\n", 1)->value(3) == Value(std::int64_t{1}));
  EXPECT_THAT(join("key\tvalue\n7,50\t1\n", 2)->unmatched_keys(), ElementsAre("7,50"));
  EXPECT_NE(table_of("key;value\n7,50;1\n")->id(), table_of("key\tvalue\n7,50\t1\n")->id());
  EXPECT_EQ(table_of("key;value\n7.50;1\n")->id(), table_of("key\tvalue\n7.50\t1\n")->id());
}

TEST_F(JoinedValuesTest, RefusesKeysThatAreTheSameNumber) {
  const auto joined = JoinedValues::join(table_of("key,value\n7,1\n007,2\n"), *layer_, 1);
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.problem().status, 400);
  EXPECT_THAT(joined.problem().detail, HasSubstr("7 and 007"));
  EXPECT_TRUE(JoinedValues::join(table_of("key,value\n7,1\n007,2\n"), *layer_, 0));
}

TEST_F(JoinedValuesTest, CountsEachMatchedRowOnceInItsSpread) {
  const auto spread = join("key,value\nFRA,1\nITA,1000\nDEU,3\n", 0)->spread();
  EXPECT_THAT(spread.values, ElementsAre(1, 3));
  EXPECT_THAT(spread.counts, ElementsAre(1, 1));
}

TEST_F(JoinedValuesTest, NamesTenKeysAtMost) {
  std::string text = "key,value\n";
  for (int i = 0; i < 25; ++i) text += std::to_string(100 + i) + ",1\n";
  const auto joined = join(text, 1);
  EXPECT_EQ(joined->unmatched_rows(), 25u);
  EXPECT_EQ(joined->unmatched_keys().size(), 10u);
  EXPECT_EQ(joined->unmatched_keys().back(), "109");
}

TEST_F(JoinedValuesTest, IsFoundOutOnceForAllWhoAsk) {
  DerivedValues derived;
  const auto table = table_of("key,value\nFRA,1\nDEU,3\n");
  EXPECT_FALSE(derived.has_join(5, 0, *table));
  const auto joined = *derived.join(5, *layer_, 0, table);
  EXPECT_TRUE(derived.has_join(5, 0, *table));
  EXPECT_EQ(*derived.join(5, *layer_, 0, table), joined);
  EXPECT_NE(*derived.join(6, *layer_, 0, table), joined);
  const BreakRule halves{BreakMethod::quantile, 2};
  EXPECT_FALSE(derived.has_breaks(5, *table, 0, halves));
  EXPECT_THAT(derived.breaks(5, *joined, halves), ElementsAre(3));
  EXPECT_TRUE(derived.has_breaks(5, *table, 0, halves));
  EXPECT_FALSE(derived.has_breaks(5, 1, halves));
  EXPECT_THAT(derived.breaks(5, *layer_, 1, halves), ElementsAre(8));
  EXPECT_THAT(derived.breaks(5, *layer_, 2, halves), ElementsAre(8.5));
}

TEST_F(JoinedValuesTest, GivesUpWhatWasNotAskedForLongest) {
  DerivedValues derived(1);
  const auto first = table_of("key,value\nFRA,1\n");
  const auto second = table_of("key,value\nFRA,2\n");
  ASSERT_TRUE(derived.join(5, *layer_, 0, first));
  ASSERT_TRUE(derived.join(5, *layer_, 0, second));
  EXPECT_FALSE(derived.has_join(5, 0, *first));
}

TEST(ValueBookTest, KeepsTablesWithinItsBudget) {
  const auto table = [](int i) {
    return *read_values("key,value\n" + std::to_string(i) + ",1\n", TableFormat::csv, {});
  };
  const std::size_t bytes = table(0).memory();
  ValueBook book(3 * bytes);
  std::vector<std::string> ids;
  for (int i = 0; i < 4; ++i) ids.push_back((*book.post(table(i)))->id());
  EXPECT_EQ(book.find(ids[0]), nullptr);
  for (int i = 1; i < 4; ++i) EXPECT_NE(book.find(ids[static_cast<std::size_t>(i)]), nullptr);
  EXPECT_LE(book.memory(), 3 * bytes);
  EXPECT_EQ(*book.post(table(3)), book.find(ids[3]));
  EXPECT_EQ(ValueBook(bytes - 1).post(table(0)).problem().status, 413);
  EXPECT_EQ(ValueBook(0).post(table(0)).problem().status, 403);
}

}  // namespace
}  // namespace trapeze
