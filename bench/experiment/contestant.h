// Methods of drawing a map of polygons, simplified for every view. All draw through the same
// screen, each in a single thread; the device may use further threads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/experiment/map_data.h"
#include "bench/experiment/screen.h"
#include "core/graph/topological_consistency.h"

namespace trapeze::experiment {

/// The parameters of drawing a view. The tolerance is that of a level of the ladder, so that it is
/// exactly the same for all.
struct ScaledView {
  View view;
  Level level = 0;
  double scale = 0;  // 1 : scale, at the centre of the map

  double epsilon() const { return epsilon_of_level(level); }
};

/// The cost of one view.
struct ViewCost {
  double simplify_ms = 0;
  double tessellate_ms = 0;  // 0 if it is part of simplifying
  double send_ms = 0;
  double draw_ms = 0;  // until the device has summed the covered areas
  double read_ms = 0;  // until the masks are in memory: about the same for all
  // Processor time of all threads of the program, including those of a software device.
  double cpu_before_draw_ms = 0;
  double cpu_ms = 0;
  std::uint64_t vertices = 0;    // of the simplified polygons; 0 if not counted
  std::uint64_t trapezoids = 0;  // drawn
  std::uint64_t bytes = 0;       // sent to the device

  double before_draw_ms() const { return simplify_ms + tessellate_ms + send_ms; }
  double total_ms() const { return before_draw_ms() + draw_ms + read_ms; }
  void add(const DrawTimes& times) {
    draw_ms += times.draw_ms;
    read_ms += times.read_ms + times.resolve_ms;
  }
};

/// Used by one thread.
class Contestant {
 public:
  virtual ~Contestant() = default;

  /// Called before the views of a run: resets to the state after opening the map.
  virtual void start_run() {}

  /// Bytes sent to the device before the first view.
  virtual std::uint64_t sent_before() const { return 0; }

  /// Heap memory of the map that the method needs, in bytes: not 0 if views are computed from the
  /// polygons themselves.
  virtual std::size_t shared_memory() const { return 0; }

  /// Draws all layers, each into its own mask; `masks` is resized to the number of layers.
  virtual ViewCost draw(const ScaledView& view, std::vector<Mask>& masks) = 0;
};

enum class Method : std::uint8_t {
  douglas_peucker,
  blg_tree,
  triangulation,
  whole_map,
  adapting,
  lifespans,
  lifespans_and_dust,
  no_simplification,
};
constexpr Method kMethods[] = {Method::douglas_peucker,    Method::blg_tree,
                               Method::triangulation,      Method::whole_map,
                               Method::adapting,           Method::lifespans,
                               Method::lifespans_and_dust, Method::no_simplification};

/// Short, for files: "dp", "blg", "cdt", "all", "paper", "trapeze", "dust", "none".
std::string_view name_of(Method method);
/// For readers.
std::string_view title_of(Method method);

/// Whether the method is only included as a reference for the others.
bool is_for_reference(Method method);

/// Whether the method can be run on that map with that topology in this program.
bool is_possible(Method method, Topology topology, const Map& map);

/// Does all preparation of a method before the first view. Both references must outlive the
/// contestant.
std::unique_ptr<Contestant> make_contestant(Method method, Topology topology, const Map& map,
                                            Screen& screen);

}  // namespace trapeze::experiment
