#include "core/io/source/change_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "core/io/source/open_source.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kQuery = "SELECT number, id FROM changes WHERE number > {since}";

class ChangeFeedTest : public ::testing::Test {
 protected:
  ChangeFeedTest() {
    write_source(town_, "GPKG",
                 {{.name = "houses",
                   .type = wkbPolygon,
                   .features = {{"POLYGON((0 0,1 0,1 1,0 1,0 0))", 7, "stone"}}}});
    sql("CREATE TABLE changes(number INTEGER, id INTEGER)");
    note(1, 40);
    note(2, 41);
  }

  void sql(const std::string& statement) const {
    const GDALDatasetUniquePtr source(
        GDALDataset::Open(town_.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    source->ReleaseResultSet(source->ExecuteSQL(statement.c_str(), nullptr, nullptr));
  }
  void note(int number, int id) const {
    sql("INSERT INTO changes VALUES(" + std::to_string(number) + ", " + std::to_string(id) + ")");
  }

  std::string failure_of(const std::string& query) const {
    try {
      ChangeFeed feed(town_, query);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "was taken";
  }

  TemporaryFolder folder_;
  const std::string town_ = folder_.file("town.gpkg");
};

TEST_F(ChangeFeedTest, TellsWhatHasChangedSinceItWasMade) {
  ChangeFeed feed(town_, kQuery);
  EXPECT_THAT(feed.take(), IsEmpty());
  note(3, 9);
  note(4, 5);
  note(7, 9);
  EXPECT_THAT(feed.take(), ElementsAre(5, 9));
  EXPECT_THAT(feed.take(), IsEmpty());
  note(6, 2);  // too late
  note(8, 3);
  EXPECT_THAT(feed.take(), ElementsAre(3));
}

TEST_F(ChangeFeedTest, TellsAgainWhatWasTakenBack) {
  ChangeFeed feed(town_, kQuery);
  note(3, 9);
  const ChangeFeed::Mark mark = feed.mark();
  EXPECT_THAT(feed.take(), ElementsAre(9));
  feed.go_back(mark);
  EXPECT_THAT(feed.take(), ElementsAre(9));
}

TEST_F(ChangeFeedTest, KnowsTheColumnOfIdsOfATable) {
  ChangeFeed feed(town_, "SELECT number, fid FROM houses WHERE number > {since}");
  EXPECT_THAT(feed.take(), IsEmpty());
  sql("UPDATE houses SET number = 8");
  EXPECT_THAT(feed.take(), ElementsAre(1));
}

TEST_F(ChangeFeedTest, TheNumberMayBeTheKeyOfTheTableOfChanges) {
  sql("CREATE TABLE notes(number INTEGER PRIMARY KEY AUTOINCREMENT, id INTEGER)");
  sql("INSERT INTO notes(id) VALUES(40)");
  ChangeFeed feed(town_, "SELECT number, id FROM notes WHERE number > {since};");
  EXPECT_THAT(feed.take(), IsEmpty());
  sql("INSERT INTO notes(id) VALUES(9)");
  EXPECT_THAT(feed.take(), ElementsAre(9));
  EXPECT_THAT(feed.take(), IsEmpty());
  sql("INSERT INTO notes(id) VALUES(5)");
  EXPECT_THAT(feed.take(), ElementsAre(5));
}

TEST_F(ChangeFeedTest, SaysWhatIsWrongWithAQuery) {
  EXPECT_THAT(failure_of("SELECT number, id FROM changes"),
              AllOf(HasSubstr("town.gpkg"), HasSubstr("{since}")));
  EXPECT_THAT(failure_of("SELECT number, id FROM nowhere WHERE number > {since}"),
              HasSubstr("nowhere"));
  EXPECT_THAT(failure_of("SELECT number FROM changes WHERE number > {since}"),
              HasSubstr("two integer columns"));
  EXPECT_THAT(failure_of("SELECT number, 'x' FROM changes WHERE number > {since}"),
              HasSubstr("two integer columns"));
}

TEST_F(ChangeFeedTest, AsksAgainAfterAFailure) {
  ChangeFeed feed(town_, kQuery);
  note(3, 9);
  sql("ALTER TABLE changes RENAME TO hidden");
  EXPECT_THROW(feed.take(), std::runtime_error);
  sql("ALTER TABLE hidden RENAME TO changes");
  EXPECT_THAT(feed.take(), ElementsAre(9));
}

}  // namespace
}  // namespace trapeze
