// The result of a request, or what is wrong with it.
#pragma once

#include <cassert>
#include <concepts>
#include <type_traits>
#include <utility>
#include <variant>

#include "server/base/problem.h"

namespace trapeze {

/// A value or a Problem, tested like an optional:
///
///   const Result<TileId> tile = parse_tile_id(z, x, y);
///   if (!tile) return tile.problem();
///   draw(*tile);
template <typename T>
class [[nodiscard]] Result {
  static_assert(!std::is_same_v<T, Problem> && !std::is_reference_v<T>);

 public:
  template <typename U = T>
  requires(std::convertible_to<U, T> && !std::same_as<std::remove_cvref_t<U>, Result> &&
           !std::same_as<std::remove_cvref_t<U>, Problem>) Result(U&& value)
      : outcome_(std::in_place_index<0>, std::forward<U>(value)) {}
  Result(Problem problem) : outcome_(std::in_place_index<1>, std::move(problem)) {}

  explicit operator bool() const { return outcome_.index() == 0; }

  /// The value. There must be one.
  const T& operator*() const& { return *value(); }
  T& operator*() & { return *value(); }
  T&& operator*() && { return std::move(*value()); }
  const T* operator->() const { return value(); }
  T* operator->() { return value(); }

  /// The reason why there is no value. There must be no value.
  const Problem& problem() const& { return *fault(); }
  Problem& problem() & { return *fault(); }
  Problem&& problem() && { return std::move(*fault()); }

 private:
  const T* value() const {
    assert(outcome_.index() == 0);
    return std::get_if<0>(&outcome_);
  }
  T* value() {
    assert(outcome_.index() == 0);
    return std::get_if<0>(&outcome_);
  }
  const Problem* fault() const {
    assert(outcome_.index() == 1);
    return std::get_if<1>(&outcome_);
  }
  Problem* fault() {
    assert(outcome_.index() == 1);
    return std::get_if<1>(&outcome_);
  }

  std::variant<T, Problem> outcome_;
};

}  // namespace trapeze
