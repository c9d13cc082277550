#include "server/values/csv_reader.h"

#include <gmock/gmock.h>

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Record = std::vector<std::string>;

/// All records; if there is a problem, its message is the last one.
std::vector<Record> records_of(std::string_view text) {
  CsvReader reader(text, find_delimiter(text));
  std::vector<Record> records;
  while (true) {
    const auto has_record = reader.next();
    if (!has_record) {
      records.push_back({has_record.problem().detail});
      return records;
    }
    if (!*has_record) return records;
    records.emplace_back(reader.fields().begin(), reader.fields().end());
  }
}

TEST(CsvReaderTest, ReadsFieldsBetweenCommasSemicolonsOrTabs) {
  for (const char* text :
       {"a,b\n1,2\n", "a;b\n1;2", "a\tb\r\n1\t2\r\n", "\n\na,b\r1,2\r", "\r\n\na\tb\n1\t2\n"}) {
    EXPECT_THAT(records_of(text), ElementsAre(Record{"a", "b"}, Record{"1", "2"})) << text;
  }
}

TEST(CsvReaderTest, TakesWhatStandsInQuotesAsItIs) {
  EXPECT_THAT(records_of("\"a,\"\"b\"\"\",\"c\nd\"\n,\"\"\n"),
              ElementsAre(Record{"a,\"b\"", "c\nd"}, Record{"", ""}));
  EXPECT_EQ(find_delimiter("\"a;\tb\",c;d\n"), ';');
}

TEST(CsvReaderTest, TellsTheLineThatIsMalformed) {
  EXPECT_THAT(records_of("a,b\n\n1,\"2\n3").back(), ElementsAre(HasSubstr("Line 3")));
  EXPECT_THAT(records_of("a,\"b\" c\n").back(), ElementsAre(HasSubstr("after the quote")));
  EXPECT_THAT(records_of("\"a\nb\",c\n1,\"2\"3").back(), ElementsAre(HasSubstr("Line 3")));
  EXPECT_THAT(records_of(std::string(100'000, ',')).back(), ElementsAre(HasSubstr("1000 fields")));
}

}  // namespace
}  // namespace trapeze
