#include "server/values/read_values.h"

#include <gmock/gmock.h>

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Result<ValueTable> read(std::string_view text, const ReadValuesOptions& options = {}) {
  return read_values(text, *table_format({}, text), options);
}

/// "FRA=1 DEU=2.5", or the status and the message of the problem.
std::string rows_of(std::string_view text, const ReadValuesOptions& options = {}) {
  const auto table = read(text, options);
  if (!table) return std::to_string(table.problem().status) + " " + table.problem().detail;
  std::string rows;
  for (std::uint32_t row = 0; row < table->size(); ++row) {
    rows += (row == 0 ? "" : " ") + std::string(table->key(row)) + "=";
    const Value value = table->value(row);
    if (const auto* integer = std::get_if<std::int64_t>(&value)) rows += std::to_string(*integer);
    if (const auto* real = std::get_if<double>(&value)) rows += std::to_string(*real).substr(0, 4);
    if (const auto* words = std::get_if<std::string_view>(&value))
      rows += "'" + std::string(*words) + "'";
  }
  return rows;
}

TEST(ReadValuesTest, ReadsTheSameRowsFromAllForms) {
  for (const char* text : {
           "A3,area\nFRA,1\nDEU,2\n",
           "\xef\xbb\xbf"
           "A3;area\nFRA;1\nDEU;2",
           "[{\"A3\": \"FRA\", \"area\": 1}, {\"area\": 2, \"A3\": \"DEU\"}]",
           "[[\"FRA\", 1], [\"DEU\", 2]]",
           " {\"FRA\": 1, \"DEU\": \"2\"}",
           "A3\tarea\r\nFRA\t 1\r\n\r\n DEU \t2\r\n",
       }) {
    EXPECT_EQ(rows_of(text), "FRA=1 DEU=2") << text;
  }
}

TEST(ReadValuesTest, FindsColumnsByTheirNames) {
  const std::string text = "name,A3,\"area, km2\"\nFrance,FRA,1\n";
  EXPECT_EQ(rows_of(text), "France='FRA'");
  EXPECT_EQ(rows_of(text, {{"A3", "area, km2"}}), "FRA=1");
  EXPECT_EQ(rows_of(text, {{"A3", ""}}), "FRA='France'");
  EXPECT_EQ(rows_of(text, {{"", "area, km2"}}), "France=1");
  EXPECT_THAT(rows_of(text, {{"a3", ""}}), HasSubstr("no column \"a3\"; did you mean \"A3\"?"));
  EXPECT_THAT(rows_of(text, {{"A3", "A3"}}), HasSubstr("same column"));
  EXPECT_EQ(rows_of("[{\"x\": 0, \"A3\": \"FRA\", \"area\": 1}]", {{"A3", "area"}}), "FRA=1");
}

TEST(ReadValuesTest, FindsAColumnThatOnlyLaterRowsHaveAndRefusesOneThatNoneHas) {
  const auto table = read(R"([{"A3": "FRA"}, {"A3": "DEU", "area": 2}, {"area": 3, "A3": "ITA"}])");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->names().value, "area");
  EXPECT_EQ(table->missing(), 1u);
  EXPECT_THAT(rows_of(R"([{"A3": "FRA", "area": 1}])", {{"A3", "aera"}}),
              HasSubstr("400 No row of the table has \"aera\""));
  EXPECT_THAT(rows_of(R"([{"A3": "FRA"}])"), HasSubstr("has a value beside \"A3\""));
}

TEST(ReadValuesTest, FindsColumnsWithLongNames) {
  const std::string name(200, 'n');
  const std::string text = "A3," + name + "1," + name + "2\nFRA,1,2\n";
  EXPECT_EQ(rows_of(text, {{"A3", name + "2"}}), "FRA=2");
  EXPECT_EQ(read(text, {{"A3", name + "2"}})->names().value.size(), 128u);
}

TEST(ReadValuesTest, CutsLongNamesBetweenCharacters) {
  std::string name(127, 'x');
  name += "\xe7\x9c\x81";
  for (const std::string& text :
       {"A3," + name + "\nFRA,1\n", R"([{"A3": "FRA", ")" + name + R"(": 1}])"}) {
    const auto table = read(text, {{"A3", name}});
    ASSERT_TRUE(table) << text;
    EXPECT_EQ(table->names().value, std::string(127, 'x')) << text;
  }
}

TEST(ReadValuesTest, TakesColumnsForNumbersOnlyIfAllAreNumbers) {
  EXPECT_EQ(read("k,v\na,1\nb,-2\nc,+3\n")->type(), FieldType::integer);
  EXPECT_EQ(read("k,v\na,1\nb,2.5e3\n")->type(), FieldType::real);
  const auto words = read("k,v\na,1\nb,many\nc,NA\nd,\n");
  EXPECT_EQ(words->type(), FieldType::text);
  EXPECT_EQ(words->first_word(), "many");
  EXPECT_EQ(words->missing(), 1u);
  EXPECT_EQ(rows_of("k,v\na,1\nb,many\nc,NA\n"), "a='1' b='many' c='NA'");
}

TEST(ReadValuesTest, KnowsHowOthersWriteThatThereIsNoNumber) {
  const auto table = read("k,v\na,1\nb,\nc,NA\nd,NaN\ne,-\nf,..\ng,null\nh,N/A\n");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->type(), FieldType::integer);
  EXPECT_EQ(table->missing(), 7u);
  EXPECT_EQ(rows_of("[{\"k\": \"a\", \"v\": null}, {\"k\": \"b\", \"v\": 1}, {\"k\": \"c\"}]"),
            "a= b=1 c=");
}

TEST(ReadValuesTest, TakesCommasForPointsWhereSemicolonsPartFields) {
  EXPECT_EQ(rows_of("k;v\na;1,5\nb;2\n"), "a=1.50 b=2.00");
  EXPECT_EQ(rows_of("k,v\na,\"1,5\"\n"), "a='1,5'");
}

TEST(ReadValuesTest, RefusesNumbersWithoutEnd) {
  for (const char* number : {"inf", "-Infinity", "1e999"}) {
    EXPECT_THAT(rows_of("k,v\na,1\nb," + std::string(number) + "\n"),
                AllOf(HasSubstr("400"), HasSubstr("of b (row 3)")))
        << number;
  }
}

TEST(ReadValuesTest, NamesKeysThatComeTwice) {
  EXPECT_THAT(rows_of("k,v\na,1\nb,2\na,3\n"), HasSubstr("a (rows 2 and 4)"));
  EXPECT_THAT(rows_of("{\"a\": 1, \"a\": 1}"), HasSubstr("a (rows 1 and 2)"));
  std::string many = "k,v\n";
  for (int i = 0; i < 40; ++i) many += std::to_string(i % 20) + ",1\n";
  EXPECT_THAT(rows_of(many), HasSubstr("9 (rows 11 and 31) and 10 more"));
}

TEST(ReadValuesTest, RefusesWhatIsNoTable) {
  EXPECT_THAT(rows_of(""), HasSubstr("empty"));
  EXPECT_THAT(rows_of("k,v\n"), HasSubstr("no row"));
  EXPECT_THAT(rows_of("k\na\n"), HasSubstr("two columns"));
  EXPECT_THAT(rows_of("FRA,1\nDEU,2\n"), HasSubstr("\"1\" looks like a value"));
  EXPECT_THAT(rows_of("k,2020\na,1\n"), HasSubstr("\"2020\" looks like a value"));
  EXPECT_EQ(rows_of("k,2019,2020\na,1,2\n", {{"k", "2020"}}), "a=2");
  EXPECT_THAT(rows_of("k,v\na,1\nb\n"), HasSubstr("Line 3 of the table has 1 fields"));
  EXPECT_THAT(rows_of("k,v\n\xff\xfe,1\n"), HasSubstr("Line 2 of the table is not UTF-8"));
  EXPECT_THAT(rows_of("k,v\n\xed\xa0\x80,1\n"), HasSubstr("not UTF-8"));
  for (const char* text : {"[1, 2]", "[[\"a\", [1]]]", "[{\"k\": {}}]", "{\"a\": {\"b\": 1}}",
                           "[[\"a\", 1], {\"k\": \"b\"}]", "[[\"a\", 1, 2]]", "[[\"a\"]]", "[[]]",
                           "[{}]", "{}", "[]", "[", "{\"a\": 1} x", "[[\"a\", 1]] []"}) {
    EXPECT_THAT(rows_of(text), HasSubstr("400 ")) << text;
  }
}

TEST(ReadValuesTest, RefusesMoreThanMayBe) {
  EXPECT_THAT(rows_of("k,v\na,1\nb,2\n", {{}, 1}), HasSubstr("413 A table has at most 1 rows"));
  EXPECT_THAT(rows_of("k,v\n" + std::string(257, 'a') + ",1\n"), HasSubstr("at most 256 bytes"));
}

TEST(ReadValuesTest, CountsRowsWithoutKey) {
  const auto table = read("k,v\na,1\n,99\n,\n");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->size(), 1u);
  EXPECT_EQ(table->without_key(), 1u);
}

TEST(ReadValuesTest, GivesEqualTablesEqualIds) {
  const std::string id = read("k,v\na,1\nb,2\n")->id();
  EXPECT_EQ(id.size(), 40u);
  EXPECT_EQ(read("k;v\r\na;1\r\nb;2")->id(), id);
  EXPECT_EQ(read("[{\"k\": \"a\", \"v\": 1}, {\"k\": \"b\", \"v\": 2}]")->id(), id);
  for (const char* other : {"k,w\na,1\nb,2\n", "k,v\na,1\nb,3\n", "k,v\na,1\nc,2\n", "k,v\na,1\n",
                            "k,v\na,1\nb,2.5\n", "k,v\na,1\nb,two\n", "k,v\na,1\nb,\n"}) {
    EXPECT_NE(read(other)->id(), id) << other;
  }
}

TEST(ReadValuesTest, FindsEveryKeyOfALargeTable) {
  std::string text = "k,v\n";
  for (int i = 0; i < 20'000; ++i)
    text += "key" + std::to_string(i) + "," + std::to_string(i) + "\n";
  const auto table = read(text);
  ASSERT_TRUE(table);
  for (int i = 0; i < 20'000; i += 7) {
    const auto row = table->find("key" + std::to_string(i));
    ASSERT_TRUE(row);
    ASSERT_TRUE(table->value(*row) == Value(std::int64_t{i}));
  }
  EXPECT_FALSE(table->find("key20000"));
}

TEST(TableFormatTest, GoesByContentTypeOrElseByTheBody) {
  EXPECT_EQ(*table_format("text/csv; charset=UTF-8", "["), TableFormat::csv);
  EXPECT_EQ(*table_format("application/json", "a,b"), TableFormat::json);
  EXPECT_EQ(*table_format("application/x-www-form-urlencoded", " \n[1]"), TableFormat::json);
  EXPECT_EQ(*table_format("", "a,b"), TableFormat::csv);
  for (const char* type : {"image/png", "multipart/form-data; boundary=x", "application/xml",
                           "text/csv; charset=utf-16", "text/html"}) {
    const auto format = table_format(type, "a,b\n");
    ASSERT_FALSE(format) << type;
    EXPECT_EQ(format.problem().status, 415);
  }
}

}  // namespace
}  // namespace trapeze
