// Queries a database for the features that have changed.
//
// One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace trapeze {

class ChangeFeed {
 public:
  /// The placeholder in a query for the greatest number seen so far.
  static constexpr const char* kSince = "{since}";

  /// `query` is SQL written by the operator. Its rows are a number, which grows, and the id of a
  /// feature that was changed, added or removed, for all numbers greater than kSince. The
  /// constructor notes the greatest present number. Throws std::runtime_error that names the source
  /// if the query fails or returns anything else.
  ChangeFeed(std::string path, std::string query);
  ~ChangeFeed();
  ChangeFeed(ChangeFeed&&) noexcept;

  /// The ids of features changed since the last call, each once, in ascending order. Throws like
  /// the constructor; then nothing is lost: the next call repeats the query on a new connection.
  std::vector<std::int64_t> take();

  /// A position to return to: what take() returns after it can be returned again.
  struct Mark {
    std::int64_t since = 0;
  };
  Mark mark() const { return {since_}; }
  void go_back(Mark mark) { since_ = mark.since; }

 private:
  struct Connection;

  std::vector<std::int64_t> ask();
  void require(bool condition, const std::string& words) const;

  std::string path_;
  std::string query_;
  std::unique_ptr<Connection> connection_;  // null: not connected
  std::int64_t since_ = 0;
};

}  // namespace trapeze
