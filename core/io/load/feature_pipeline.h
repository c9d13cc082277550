// Passes features from a source to the workers that process them: features are read on one thread
// and projected to the grid on all cores, gaps between them are closed, those that share borders
// are grouped, and every group is built on one of the cores.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <ogr_geometry.h>

#include "core/grid/work_share.h"
#include "core/io/load/feature_tally.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/merge_classes.h"
#include "core/io/source/source_ring_reader.h"
#include "core/layer/earlier_layer.h"
#include "core/layer/layer_options.h"

namespace trapeze {

/// A feature that waits for others with which it may share borders.
struct WaitingFeature {
  FeatureKey key;
  Rings rings;                    // clean, not empty
  Rings drawn = {};               // before gaps were closed; empty if that did not change them
  std::uint64_t merge_class = 0;  // see MergeClasses; always 0 if there are no classes

  /// The rings to draw if no border is shared.
  Rings& rings_apart() { return drawn.empty() ? rings : drawn; }
};

/// The classes of features, by position; empty if there are none.
std::vector<std::uint64_t> classes_of(std::span<WaitingFeature* const> features);

/// Processes features. Each worker is used by one thread at a time.
class FeatureWorker {
 public:
  virtual ~FeatureWorker() = default;

  /// Processes a single feature on up to `threads` threads. `rings` may be used as scratch memory.
  virtual void build_apart(const FeatureKey& feature, Rings& rings, unsigned threads) = 0;
  /// Processes two or more features that share borders, in ascending order of rows, on up to
  /// `threads` threads.
  virtual void build_together(std::span<WaitingFeature* const> features, unsigned threads) = 0;

  /// Progress with the current unit; restarted by whoever passes it one.
  WorkShare& share() { return share_; }

 protected:
  WorkShare share_;
};

/// 0: one per core.
unsigned thread_count(unsigned wanted);

class FeaturePipeline {
 public:
  /// Takes over the attributes of a polygon feature, whose geometry has been removed, and returns
  /// its row. Called on the thread that called run().
  using Take = std::function<std::uint32_t(SourceFeature&)>;

  /// The maximum input of one round.
  struct RoundLimit {
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    std::size_t features = std::numeric_limits<std::size_t>::max();
  };

  /// Each worker has a thread; threads that would wait for another one help it. `source` and the
  /// workers must outlive the pipeline. `progress` is as in LoadOptions and may be empty: it is
  /// called from time to time with the elapsed fraction of the expected time, as far as it is spent
  /// here. `earlier`, if not null, supplies which features share borders: it must have been built
  /// with the same options and must outlive the pipeline. Features are projected to `grid`, null
  /// being that of Web Mercator. Throws SourceError if the source lacks the attribute by which
  /// features are merged.
  FeaturePipeline(FeatureSource& source, const LayerOptions& options,
                  const std::vector<FeatureWorker*>& workers, std::function<void(double)> progress,
                  const EarlierLayer* earlier = nullptr,
                  const std::shared_ptr<const TargetGrid>& grid = {});
  ~FeaturePipeline();

  /// Reads features until the limit is reached or the source has no more, and has all of them
  /// built. Returns false if there is nothing more to read. Only features of one round are
  /// considered together: if they may share borders, there must be only one round. The assignment
  /// to workers is arbitrary. Throws what reading, a worker, `take` or `progress` throws, including
  /// SourceError if the source as a whole cannot be interpreted.
  bool run(const Take& take, const RoundLimit& limit);

  /// Number of features read from the source.
  std::size_t features() const { return features_; }
  /// When the last feature was read.
  std::chrono::steady_clock::time_point read_until() const { return read_until_; }
  /// Findings from before the features reached a worker.
  std::vector<const FeatureTally*> tallies() const;

 private:
  class Lane;
  class Pool;
  /// A polygon feature on its way from the reading thread to a lane.
  struct Job {
    FeatureKey key;
    std::size_t layer_index = 0;
    std::unique_ptr<OGRGeometry> geometry;
    std::size_t bytes = 0;  // of the geometry, as WKB
    std::uint64_t merge_class = 0;
  };
  using Batch = std::vector<Job>;
  /// Features that are built together, or a single one.
  using Task = std::vector<WaitingFeature*>;

  bool read(const Take& take, const RoundLimit& limit, Pool& pool);
  void accept(SourceFeature& next, const Take& take);
  std::vector<WaitingFeature> take_waiting();
  std::vector<std::uint32_t> known_groups(const std::vector<WaitingFeature>& waiting) const;
  void close_gaps_between(std::vector<WaitingFeature>& waiting);
  void build_waiting();
  void build(std::span<const Task> tasks, std::size_t lanes,
             const std::function<unsigned(const Task&)>& threads_for);
  void wait_for(std::vector<std::future<void>>& running);
  void show_progress();
  double share() const;

  FeatureSource& source_;
  const LayerOptions options_;
  MergeClasses classes_;
  const std::function<void(double)> progress_;
  const EarlierLayer* const earlier_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  FeatureTally tally_;  // of features that never reached a lane
  std::size_t features_ = 0;
  std::chrono::steady_clock::time_point read_until_;

  // The next items to hand over.
  Batch batch_;
  std::size_t batch_bytes_ = 0;

  // For progress.
  bool is_all_read_ = false;
  bool are_gaps_closed_ = false;
  bool is_grouped_ = false;
  double work_read_ = 0;  // estimated work of the lanes for the features read so far, in the lanes'
                          // unit
  double shown_ = 0;
};

}  // namespace trapeze
