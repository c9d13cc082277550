// Asks a database which features have changed.
//
// Belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace trapeze {

class ChangeFeed {
 public:
  /// What stands in a query for the greatest number that has been seen.
  static constexpr const char* kSince = "{since}";

  /// `query` is SQL, written by the operator, whose rows are a number, which grows, and the id of a
  /// feature that has changed, appeared or gone: of those with a number greater than kSince. Notes
  /// the greatest number that there is by now, and throws std::runtime_error, naming the source, if
  /// it cannot be asked or answers something else.
  ChangeFeed(std::string path, std::string query);
  ~ChangeFeed();
  ChangeFeed(ChangeFeed&&) noexcept;

  /// The ids of features that have changed since it was asked last, each once, in ascending order.
  /// Throws as the constructor does; then nothing is lost: the next call asks for the same again,
  /// in a connection of its own.
  std::vector<std::int64_t> take();

  /// What it has taken since then is told again.
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
  std::unique_ptr<Connection> connection_;  // null: there is none
  std::int64_t since_ = 0;
};

}  // namespace trapeze
