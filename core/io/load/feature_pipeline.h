// The way of features from a source to whoever makes something of them: they are read on one
// thread, brought to the grid on all cores, gaps between them closed, those that share borders
// grouped, and every group built on one of all cores.
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

/// A feature that waits for the others, with which it may share borders.
struct WaitingFeature {
  FeatureKey key;
  Rings rings;       // clean, not empty
  Rings drawn = {};  // as they were before gaps were closed; empty if that did not change them
  std::uint64_t merge_class = 0;  // see MergeClasses; 0 of all if there are no classes

  /// What is to be drawn where no border is shared.
  Rings& rings_apart() { return drawn.empty() ? rings : drawn; }
};

/// The classes of features, by position; empty if there are none.
std::vector<std::uint64_t> classes_of(std::span<WaitingFeature* const> features);

/// Makes something of features. Each is used by one thread at a time.
class FeatureWorker {
 public:
  virtual ~FeatureWorker() = default;

  /// Takes a feature by itself; may use so many threads. `rings` may be used as scratch memory.
  virtual void build_apart(const FeatureKey& feature, Rings& rings, unsigned threads) = 0;
  /// Takes two or more that share borders, in ascending order of rows; may use so many threads.
  virtual void build_together(std::span<WaitingFeature* const> features, unsigned threads) = 0;

  /// How far it is with what it took last; begun anew by who gives it something.
  WorkShare& share() { return share_; }

 protected:
  WorkShare share_;
};

/// 0: one a core.
unsigned thread_count(unsigned wanted);

class FeaturePipeline {
 public:
  /// Takes over the attributes of a polygon feature, whose geometry has been taken away, and says
  /// which row it has; called on the thread that called run().
  using Take = std::function<std::uint32_t(SourceFeature&)>;

  /// How much one round takes in.
  struct RoundLimit {
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    std::size_t features = std::numeric_limits<std::size_t>::max();
  };

  /// There is a thread for each worker; those that would wait for another help it. `source` and the
  /// workers must outlive the pipeline. `progress` is as in LoadOptions, and may be empty: it is
  /// called now and then with the share of the expected time that has gone, as far as it is spent
  /// here.
  /// Throws SourceError if the source lacks the attribute by which features are merged.
  /// Of `earlier`, if it is not null, is taken which features share borders: it was built with the
  /// same options, and must outlive the pipeline. Features come on the grid, null being that of Web
  /// Mercator.
  FeaturePipeline(FeatureSource& source, const LayerOptions& options,
                  const std::vector<FeatureWorker*>& workers, std::function<void(double)> progress,
                  const EarlierLayer* earlier = nullptr,
                  const std::shared_ptr<const TargetGrid>& grid = {});
  ~FeaturePipeline();

  /// Reads features until the limit is reached or the source has no more, and has all of them
  /// built; false if there is nothing more to read. Only features of one round meet each other:
  /// where they may share borders, there is to be one round. Which worker gets what is left to
  /// chance. Throws what reading, a worker, `take` or `progress` throws, among it SourceError if
  /// the whole source cannot be understood.
  bool run(const Take& take, const RoundLimit& limit);

  /// Features of the source that have been read.
  std::size_t features() const { return features_; }
  /// When the last feature was read.
  std::chrono::steady_clock::time_point read_until() const { return read_until_; }
  /// What was found before a worker got to see it.
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
  /// Features that are built together, or one by itself.
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

  // What is to be handed over next.
  Batch batch_;
  std::size_t batch_bytes_ = 0;

  // For the progress.
  bool is_all_read_ = false;
  bool are_gaps_closed_ = false;
  bool is_grouped_ = false;
  double work_read_ = 0;  // what lanes are to do with what has been read; their unit
  double shown_ = 0;
};

}  // namespace trapeze
