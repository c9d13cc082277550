#include "bench/experiment/contestant.h"

#include "bench/experiment/adapting.h"
#include "bench/experiment/lifespans.h"
#include "bench/experiment/resimplifying.h"

namespace trapeze::experiment {

std::string_view name_of(Method method) {
  switch (method) {
    case Method::douglas_peucker:
      return "dp";
    case Method::blg_tree:
      return "blg";
    case Method::triangulation:
      return "cdt";
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

// Nothing is simplified, so there is nothing to keep consistent; and constraints that cross are a
// case of their own for a triangulation.
bool is_possible(Method method, Topology topology) {
  if (method == Method::no_simplification) return topology == Topology::strict;
  if (method != Method::triangulation) return true;
  return topology == Topology::strict && has_triangulation();
}

std::unique_ptr<Contestant> make_contestant(Method method, Topology topology, const Map& map,
                                            Screen& screen) {
  switch (method) {
    case Method::douglas_peucker:
    case Method::blg_tree:
    case Method::triangulation:
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
