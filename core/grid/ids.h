// Distinct types for the numbers of vertices, edges, nodes and corners, so that they cannot be
// confused, and tables indexed by them.
#pragma once

#include <cstdint>

#include "core/grid/large_array.h"

namespace trapeze {

template <class Tag>
struct Id {
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::uint32_t value = kNone;

  constexpr Id() = default;
  explicit constexpr Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  constexpr bool is_none() const { return value == kNone; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

/// A vector indexed by its own kind of id.
template <class IdType, class T>
class Table {
 public:
  T& operator[](IdType id) { return items_[id.value]; }
  const T& operator[](IdType id) const { return items_[id.value]; }
  std::size_t size() const { return items_.size(); }
  std::size_t capacity() const { return items_.capacity(); }
  void clear() { items_.clear(); }
  void reserve(std::size_t n) { items_.reserve(n); }
  void resize(std::size_t n) { items_.resize(n); }
  void assign(std::size_t n, const T& value) { items_.assign(n, value); }
  IdType push_back(const T& item) {
    items_.push_back(item);
    return IdType(items_.size() - 1);
  }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  T* data() { return items_.data(); }
  const T* data() const { return items_.data(); }

  friend bool operator==(const Table&, const Table&) = default;

 private:
  LargeArray<T> items_;
};

using VertexId = Id<struct VertexTag>;
using EdgeId = Id<struct EdgeTag>;
using NodeId = Id<struct NodeTag>;
using CornerId = Id<struct CornerTag>;

/// Number of a face: 0 is outside, 1 inside. If polygons that share borders are in one graph, each
/// has its own number.
using FaceId = std::uint32_t;
constexpr FaceId kOutside = 0;

}  // namespace trapeze
