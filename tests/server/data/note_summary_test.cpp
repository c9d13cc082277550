#include "server/data/note_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(NoteSummaryTest, OneNoteIsItsOwnLine) {
  EXPECT_THAT(summarize_notes({}), IsEmpty());
  EXPECT_THAT(summarize_notes(std::vector<FeatureNote>{{7, "ring 2 has 3 points"}}),
              ElementsAre("feature 7: ring 2 has 3 points"));
}

TEST(NoteSummaryTest, NotesOfOneSortAreOneLine) {
  std::vector<FeatureNote> notes;
  for (std::int64_t id = 1; id <= 90; ++id) notes.push_back({id, "repaired: its rings cross"});
  notes.insert(notes.begin() + 1, {50, "overlapped: 2 % of it lies under feature 51"});
  notes.push_back({91, "overlapped: 1 % of it lies under feature 92"});
  EXPECT_THAT(summarize_notes(notes),
              ElementsAre("features 1, 2, 3 and 87 more: repaired: its rings cross",
                          "features 50 and 91: overlapped; of feature 50: 2 % of it lies under "
                          "feature 51"));
}

TEST(NoteSummaryTest, AFeatureWithSeveralNotesIsNamedOnce) {
  const std::vector<FeatureNote> notes = {{3, "overlapped: a"}, {3, "overlapped: b"}};
  EXPECT_THAT(summarize_notes(notes), ElementsAre("feature 3: overlapped; of feature 3: a"));
}

}  // namespace
}  // namespace trapeze
