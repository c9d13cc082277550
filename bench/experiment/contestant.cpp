#include "bench/experiment/contestant.h"

#include "bench/experiment/adapting.h"
#include "bench/experiment/lifespans.h"
#include "bench/experiment/resimplifying.h"

namespace trapeze::experiment {
namespace {

constexpr std::size_t kMostVerticesOfWholeMap = 1'000'000;

}  // namespace

std::string_view name_of(Method method) {
  switch (method) {
    case Method::douglas_peucker:
      return "dp";
    case Method::blg_tree:
      return "blg";
    case Method::triangulation:
      return "cdt";
    case Method::whole_map:
      return "all";
    case Method::adapting:
      return "paper";
    case Method::lifespans:
      return "trapeze";
    case Method::lifespans_and_dust:
      return "dust";
    case Method::no_simplification:
      return "none";
  }
  return "";
}

std::string_view title_of(Method method) {
  switch (method) {
    case Method::douglas_peucker:
      return "DP";
    case Method::blg_tree:
      return "BLG tree";
    case Method::triangulation:
      return "BLG tree, CDT";
    case Method::whole_map:
      return "DP, whole map";
    case Method::adapting:
      return "The paper's method";
    case Method::lifespans:
      return "Trapeze";
    case Method::lifespans_and_dust:
      return "Trapeze, with dust";
    case Method::no_simplification:
      return "No simplification";
  }
  return "";
}

bool is_for_reference(Method method) {
  return method == Method::triangulation || method == Method::whole_map ||
         method == Method::no_simplification;
}

// Without simplification, consistency does not matter, and a triangulation would have to handle
// crossing constraints as a special case. The whole of a large map takes minutes.
bool is_possible(Method method, Topology topology, const Map& map) {
  if (!is_for_reference(method)) return true;
  if (topology != Topology::strict) return false;
  if (method == Method::triangulation) return has_triangulation();
  return method != Method::whole_map || map.vertex_count() <= kMostVerticesOfWholeMap;
}

std::unique_ptr<Contestant> make_contestant(Method method, Topology topology, const Map& map,
                                            Screen& screen) {
  switch (method) {
    case Method::douglas_peucker:
    case Method::blg_tree:
    case Method::triangulation:
    case Method::whole_map:
      return std::make_unique<Resimplifying>(method, topology, map, screen);
    case Method::adapting:
      return std::make_unique<Adapting>(topology, map, screen);
    case Method::lifespans:
    case Method::lifespans_and_dust:
    case Method::no_simplification:
      return std::make_unique<Lifespans>(method, topology, map, screen);
  }
  return nullptr;
}

}  // namespace trapeze::experiment
