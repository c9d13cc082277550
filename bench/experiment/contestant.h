// Ways of drawing a map of polygons, simplified for every view. All draw through the same screen,
// each with one thread of its own; what the device does with its threads is up to the device.
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

/// What a view is drawn with. The tolerance is that of a level of the ladder, so that it is exactly
/// the same for all.
struct ScaledView {
  View view;
  Level level = 0;
  double scale = 0;  // 1 : scale, at the map's middle

  double epsilon() const { return epsilon_of_level(level); }
};

/// What one view cost.
struct ViewCost {
  double simplify_ms = 0;
  double tessellate_ms = 0;  // 0 where it is one with simplifying
  double send_ms = 0;
  double draw_ms = 0;  // until the device has added up what is covered
  double read_ms = 0;  // until the masks are in memory: much the same for all
  // Processor time of all threads of the program, those of a software device among them.
  double cpu_before_draw_ms = 0;
  double cpu_ms = 0;
  std::uint64_t vertices = 0;    // of the simplified polygons; 0 where nobody counts them
  std::uint64_t trapezoids = 0;  // drawn
  std::uint64_t bytes = 0;       // sent to the device

  double before_draw_ms() const { return simplify_ms + tessellate_ms + send_ms; }
  double total_ms() const { return before_draw_ms() + draw_ms + read_ms; }
  void add(const DrawTimes& times) {
    draw_ms += times.draw_ms;
    read_ms += times.read_ms + times.resolve_ms;
  }
};

/// Belongs to one thread.
class Contestant {
 public:
  virtual ~Contestant() = default;

  /// Before the views of a run: as if the map had just been opened.
  virtual void start_run() {}

  /// Bytes sent to the device before the first view.
  virtual std::uint64_t sent_before() const { return 0; }

  /// Heap memory of the map that it cannot do without, bytes: where views are made of the polygons
  /// themselves.
  virtual std::size_t shared_memory() const { return 0; }

  /// Draws all layers, each into its own mask; `masks` is resized to the layers.
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

/// Whether that method is there for comparison with the other ones only.
bool is_for_reference(Method method);

/// Whether that method can be tried on that map with that topology in this program.
bool is_possible(Method method, Topology topology, const Map& map);

/// Prepares everything that a method prepares before the first view. Both arguments must outlive
/// the contestant.
std::unique_ptr<Contestant> make_contestant(Method method, Topology topology, const Map& map,
                                            Screen& screen);

}  // namespace trapeze::experiment
