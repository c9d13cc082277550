#include "server/service/reloader.h"
#include "server/base/failure_words.h"
#include "server/base/heap.h"
#include "server/data/layer_damage.h"
#include "server/data/named_tables.h"
#include "server/data/source_files.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <utility>

namespace trapeze {
namespace {

constexpr auto kTick = std::chrono::milliseconds(1000);  // without a watch, only for clean-up
constexpr auto kRest = std::chrono::seconds(5);          // before a full read of a live layer
constexpr auto kLongAnswer = std::chrono::seconds(10);   // of a database: logged after this time

}  // namespace

/// Datasets that are no longer used, kept until the reloader destroys them: destroying one takes
/// too long for the thread that happens to hold the last reference.
struct Reloader::Retired {
  std::mutex mutex;
  std::vector<std::shared_ptr<const Dataset>> datasets;
};

/// While an object of this class exists, a database query is in progress.
class Reloader::Asking {
 public:
  Asking(Reloader& reloader, const std::string& layer) : reloader_(reloader) {
    const std::lock_guard lock(reloader_.mutex_);
    reloader_.question_ = Question{layer, Clock::now()};
  }
  ~Asking() {
    const std::lock_guard lock(reloader_.mutex_);
    reloader_.question_.reset();
  }
  Asking(const Asking&) = delete;
  Asking& operator=(const Asking&) = delete;

 private:
  Reloader& reloader_;
};

Reloader::Reloader(LayerSource source, Pace pace, CurrentDataset& data, TileService& tiles,
                   Metrics& metrics, ChangeLog* changes, std::function<void()> give_up,
                   std::function<void()> is_loaded)
    : source_(std::move(source)),
      pace_(pace),
      data_(data),
      tiles_(tiles),
      metrics_(metrics),
      changes_(changes),
      give_up_(std::move(give_up)),
      is_loaded_(std::move(is_loaded)),
      retired_(std::make_shared<Retired>()) {}

void Reloader::start() {
  has_ended_ = false;
  thread_ = std::thread([this] { work(); });
}

Reloader::~Reloader() {
  end(std::chrono::milliseconds(0));
  if (thread_.joinable()) thread_.join();
  if (watching_.joinable()) watching_.join();
}

bool Reloader::end(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  is_stopping_ = true;
  wake_.notify_all();
  return wake_.wait_for(lock, patience, [this] { return has_ended_; });
}

void Reloader::reload() {
  {
    const std::lock_guard lock(mutex_);
    is_asked_ = true;
  }
  wake_.notify_all();
}

void Reloader::rethrow_failure() const {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

std::string Reloader::last_problem() const {
  const std::lock_guard lock(mutex_);
  if (!problem_.empty()) return problem_;
  return damage_.empty() ? database_problem_ : damage_;
}

void Reloader::work() {
  follow();
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }
  wake_.notify_all();
}

void Reloader::follow() {
  if (!load_first()) return give_up_();
  is_loaded_();
  return_free_memory();  // used for building, here and below
  while (true) {
    // Memory may run out in places where load_again() does not catch it; that passes.
    try {
      if (!wait_for_a_reason()) return;
      load_again();
    } catch (const std::exception& error) {
      log_failure("looking after the layers", error);
      is_loading_ = false;
    }
  }
}

bool Reloader::load_first() {
  try {
    serve();
  } catch (const std::exception&) {
    metrics_.count_load(false);
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  is_loading_ = false;
  return data_.get() != nullptr;
}

void Reloader::load_again() {
  is_loading_ = true;
  last_load_ = Clock::now();
  // Before reading, as in serve(): after a failure, the next attempt waits until something has
  // changed since, possibly during reading.
  state_read_ = state_of_files(files_);
  try {
    serve();
    note("");
  } catch (const std::exception& error) {
    metrics_.count_load(false);
    const std::string problem = failure_words(error);
    spdlog::error(
        fmt::format("the layers cannot be read again, so the old ones are kept: {}", problem));
    note(problem);
  }
  return_free_memory();
  is_loading_ = false;
}

void Reloader::note(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  problem_ = problem;
}

void Reloader::serve() {
  // Before reading, here and below: later changes are noticed.
  std::vector<std::string> config;
  if (!source_.config.empty()) config.push_back(source_.config);
  const std::string state_of_config = state_of_files(config);
  const std::vector<LayerConfig> layers = source_.layers();
  const ValueTables values = source_.values ? source_.values() : ValueTables();
  const std::vector<std::string> sources = watched_files(layers, values);
  files_ = config;
  files_.insert(files_.end(), sources.begin(), sources.end());
  state_read_ = state_of_config + state_of_files(sources);
  std::vector<LiveLayer> live;
  for (const LayerConfig& layer : layers) {
    if (layer.live_query.empty()) continue;
    if (!watching_.joinable()) watching_ = std::thread([this] { watch_databases(); });
    const Asking asking(*this, layer.name);
    live.emplace_back(layer);  // also before it is read
  }
  const auto before = data_.get();
  std::shared_ptr<const Dataset> loaded =
      Dataset::load(layers, before.get(), &to_read_, read_named_tables(values));
  begin_live(live, loaded);
  publish(std::move(loaded));
  live_ = std::move(live);  // only now: they must be those of the dataset that is served
  if (live_.empty()) note_of_databases("");  // no database is queried any more
  metrics_.count_load(true);
  spdlog::info(
      fmt::format("ready: {} layers, generation {}", layers.size(), data_.get()->generation()));
  if (changes_ != nullptr && before != nullptr) changes_->note(before, data_.get());
}

void Reloader::begin_live(std::vector<LiveLayer>& live, std::shared_ptr<const Dataset>& loaded) {
  if (live.empty()) return;
  std::vector<ServedLayer> layers = loaded->layers_on_all_grids();
  loaded = nullptr;
  auto next = live.begin();
  for (ServedLayer& layer : layers) {
    if (!layer.config.live_query.empty()) layer = (next++)->begin(std::move(layer));
  }
  loaded = std::make_shared<const Dataset>(std::move(layers));
}

bool Reloader::follow_live() {
  if (live_.empty()) return true;
  const auto before = data_.get();
  std::vector<ServedLayer> layers = before->layers_on_all_grids();
  bool has_changed = false;
  std::string problem;
  auto live = live_.begin();
  for (ServedLayer& layer : layers) {
    if (layer.config.live_query.empty()) continue;
    try {
      const Asking asking(*this, layer.config.name);
      live->next();
      // Not what next() returns: an earlier state may not have been published, for lack of memory.
      if (live->now().revision != layer.revision) {
        layer = live->now();
        has_changed = true;
      }
    } catch (const std::exception& error) {
      problem = failure_words(error);
    }
    ++live;
  }
  note_of_databases(problem);
  if (has_changed) {
    publish(std::make_shared<const Dataset>(std::move(layers)));
    if (changes_ != nullptr) changes_->note(before, data_.get(), ChangeLog::Memory::shared);
  }
  return std::ranges::none_of(live_, [](const LiveLayer& each) { return each.is_worn(); });
}

void Reloader::note_of_databases(const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    if (problem == database_problem_) return;
    database_problem_ = problem;
  }
  if (problem.empty()) {
    spdlog::info("what has changed in databases is known again");
  } else {
    spdlog::error(fmt::format("what has changed is not known: {}", problem));
  }
}

/// Logs that a query takes long: the thread that waits for the answer cannot.
void Reloader::watch_databases() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kTick, [this] { return is_stopping_; })) {
    if (!question_ || question_->is_told || Clock::now() < question_->since + kLongAnswer) continue;
    question_->is_told = true;
    database_problem_ = fmt::format(
        "layer \"{}\": its database has not answered for {} s; until it does, no layer is read "
        "again",
        question_->layer, std::chrono::seconds(kLongAnswer).count());
    spdlog::error(fmt::format("what has changed is not known: {}", database_problem_));
  }
}

void Reloader::publish(std::shared_ptr<const Dataset> loaded) {
  tiles_.place_usual_labels(loaded);
  const Dataset* served = loaded.get();
  data_.set({served, [loaded = std::move(loaded), retired = retired_](const Dataset*) mutable {
               const std::lock_guard lock(retired->mutex);
               try {
                 retired->datasets.push_back(std::move(loaded));
               } catch (const std::bad_alloc&) {
                 // Then it is destroyed here, which takes longer but frees memory.
               }
             }});
}

std::vector<std::string> Reloader::watched_files(const std::vector<LayerConfig>& layers,
                                                 const ValueTables& values) const {
  std::vector<std::string> files;
  for (const auto& [name, table] : values) files.push_back(table.file);
  for (const LayerConfig& layer : with_grids(layers)) {
    if (layer.live_query.empty()) append_files(layer.file, files);
    append_files(layer.prepared, files);
  }
  return files;
}

/// False if the reloader is to end.
bool Reloader::wait_for_a_reason() {
  while (true) {
    forget_retired();  // here, so that it is done however often reloads are requested
    look_for_damage();
    {
      std::unique_lock lock(mutex_);
      const auto tick = pace_.watch.count() > 0 ? pace_.watch : kTick;
      wake_.wait_for(lock, live_.empty() ? tick : pace_.live,
                     [this] { return is_stopping_ || is_asked_; });
      if (is_stopping_) return false;
      if (std::exchange(is_asked_, false)) {
        spdlog::info("reading the layers again, as told");
        return true;
      }
    }
    if (!follow_live() && Clock::now() >= last_load_ + kRest) {
      spdlog::info("reading the layers again, as much of them has changed");
      return true;
    }
    if (pace_.watch.count() == 0 || Clock::now() < last_look_ + pace_.watch) continue;
    last_look_ = Clock::now();
    if (has_settled_change()) {
      spdlog::info("reading the layers again, as files have changed");
      return true;
    }
  }
}

void Reloader::look_for_damage() {
  if (Clock::now() < last_look_for_damage_ + kTick) return;
  last_look_for_damage_ = Clock::now();
  std::string damage;
  for (const ServedLayer& served : data_.get()->layers_on_all_grids()) {
    damage = damage_of(served);
    if (!damage.empty()) break;
  }
  {
    const std::lock_guard lock(mutex_);
    if (damage == damage_) return;
    damage_ = damage;
  }
  if (!damage.empty()) spdlog::error(damage);
}

bool Reloader::has_settled_change() {
  const std::string state = state_of_files(files_);
  const bool has_settled = state == state_seen_;
  state_seen_ = state;
  return has_settled && state != state_read_;
}

void Reloader::forget_retired() {
  std::vector<std::shared_ptr<const Dataset>> datasets;
  {
    const std::lock_guard lock(retired_->mutex);
    datasets.swap(retired_->datasets);
  }
  if (datasets.empty()) return;
  struct Mesh {
    std::weak_ptr<const Layer> layer;  // that it belongs to
    std::uint64_t id;
  };
  std::vector<Mesh> meshes;
  for (const auto& dataset : datasets) {
    for (const ServedLayer& served : dataset->layers_on_all_grids()) {
      meshes.push_back({served.layer, served.layer->mesh().id});
      if (served.untested != nullptr) {
        meshes.push_back({served.untested, served.untested->mesh().id});
      }
      // Of a live layer, what was read in full outlives the dataset in which it was served.
      if (served.whole != nullptr) meshes.push_back({served.whole, served.whole->mesh().id});
      if (served.parts == nullptr) continue;
      const auto add = [&meshes](const PreparedPart& part) {
        if (const auto layer = part.layer_if_open()) meshes.push_back({layer, layer->mesh().id});
      };
      for (const auto& part : served.parts->parts()) add(*part);
      if (served.parts->overview() != nullptr) add(*served.parts->overview());
    }
  }
  datasets.clear();
  // A layer that has not changed stays alive in the dataset being served.
  for (const Mesh& mesh : meshes) {
    if (mesh.layer.expired()) tiles_.forget(mesh.id);
  }
  return_free_memory();
}

}  // namespace trapeze
