#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "render/picture/webp.h"
#include "server/cli/commands.h"
#include "server/data/layer_summary.h"
#include "server/data/named_tables.h"
#include "server/seed/batch_jobs.h"
#include "server/seed/earlier_archive.h"
#include "server/seed/join.h"
#include "server/seed/seed_jobs.h"
#include "server/seed/seed_log.h"
#include "server/seed/seeder.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/start_renderers.h"

namespace trapeze {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSecondsOfSample = 10;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string duration_words(double seconds) {
  constexpr double kMinute = 60;
  constexpr double kHour = 60 * kMinute;
  if (seconds >= 2 * kHour) return fmt::format("{:.1f} hours", seconds / kHour);
  if (seconds >= 2 * kMinute) return fmt::format("{:.0f} minutes", seconds / kMinute);
  return fmt::format("{:.0f} s", seconds);
}

/// "1,234,567".
std::string number_words(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

std::string bytes_words(double bytes) {
  constexpr double kThousand = 1000;
  if (bytes < kThousand) return fmt::format("{:.0f} bytes", bytes);
  for (const char* unit : {"kB", "MB", "GB"}) {
    bytes /= kThousand;
    if (bytes < kThousand) return fmt::format("{:.1f} {}", bytes, unit);
  }
  return fmt::format("{:.1f} TB", bytes / kThousand);
}

/// Of the tiles that would be drawn, `reused` were taken from the earlier archive; there can only
/// be some if `is_update`.
std::string figures_words(const SeedFigures& figures, bool is_update = false,
                          std::uint64_t reused = 0) {
  return fmt::format("{} tiles: {} drawn,{} {} of one colour when looked at, {} known without",
                     number_words(figures.tiles()), number_words(figures.drawn - reused),
                     is_update ? fmt::format(" {} as they were,", number_words(reused)) : "",
                     number_words(figures.alone), number_words(figures.known));
}

/// Reports progress every few seconds.
class ProgressLine {
 public:
  ProgressLine(double cost, double done_before) : cost_(cost), done_before_(done_before) {}

  void operator()(const SeedProgress& progress) {
    constexpr double kSeconds = 5;
    if (seconds_since(last_) < kSeconds) return;
    last_ = Clock::now();
    const double seconds = seconds_since(begin_);
    const double done = done_before_ + progress.cost;
    const double left = seconds * std::max(cost_ - done, 0.0) / std::max(progress.cost, 1.0);
    const std::uint64_t drawn = progress.figures.drawn - progress.reused;
    spdlog::info(fmt::format(
        "{:.1f} %: {} tiles drawn, {:.0f} a second; {} known without; about {} left",
        100 * done / std::max(cost_, 1.0), number_words(drawn),
        static_cast<double>(drawn) / seconds,
        number_words(progress.figures.known + progress.figures.alone), duration_words(left)));
  }

 private:
  const double cost_;
  const double done_before_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;
};

std::vector<std::string> layers_of(const SeedArguments& arguments, const Config& config) {
  std::vector<std::string> names;
  for (const std::string& name : arguments.layers) {  // as in an address, where each counts once
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  if (names.empty()) {
    for (const LayerConfig& layer : config.layers) names.push_back(layer.name);
  }
  if (names.size() > config.limits.layers) {
    throw UsageError(
        fmt::format("--layers takes up to {} layers (limits.layers)", config.limits.layers));
  }
  return names;
}

TileFormat format_or_throw(const std::string& name) {
  const TileFormat format = word_or_throw("--format", name, kTileFormatNames);
  if (format == TileFormat::webp && !has_webp()) {
    throw UsageError("--format: this program was built without WebP; use png");
  }
  return format;
}

ZoomRange zooms_or_throw(const std::string& given, int last) {
  if (given.empty()) throw UsageError("--zooms is missing");
  const auto zooms = parse_zooms(given);
  if (zooms && zooms->last <= last) return *zooms;
  throw UsageError(
      fmt::format("--zooms takes a zoom or a range of them such as 0-12, from 0 to {}, got \"{}\"",
                  last, given));
}

SeedRequest make_request(const SeedArguments& arguments, const Config& config) {
  SeedRequest request;
  request.tile.layers = layers_of(arguments, config);
  request.tile.scale = arguments.scale;
  request.tile.format = format_or_throw(arguments.format);
  request.tile.style = style_or_throw(arguments.style, request.tile.layers, config);
  request.zooms = zooms_or_throw(arguments.zooms, config.limits.zoom);
  if (!arguments.bbox.empty()) {
    request.bbox = parse_bbox(arguments.bbox);
    if (!request.bbox) {
      throw UsageError(
          fmt::format("--bbox takes W,S,E,N in degrees, W being less than E and S "
                      "less than N, got \"{}\"",
                      arguments.bbox));
    }
  }
  return request;
}

/// Limited to the area to be seeded.
GeographicBounds bounds_of(const LayerSummary& summary, const SeedRequest& request) {
  if (!request.bbox) return summary.bounds();
  const auto [west, south, east, north] = summary.bounds();
  const auto& box = *request.bbox;
  const GeographicBounds both = {std::max(west, box[0]), std::max(south, box[1]),
                                 std::min(east, box[2]), std::min(north, box[3])};
  return both[0] < both[2] && both[1] < both[3] ? both : box;
}

/// The middle of the archive's bounds. They do not go over the antimeridian, even if the layers do:
/// the middle is then that of the layers, as in TileJSON, and not on the other side of the world.
GeographicCenter center_of(const ArchiveDescription& archive, const LayerSummary& summary,
                           const SeedRequest& request, const Dataset& dataset) {
  const auto [west, south, east, north] = archive.bounds;
  const auto whole = summary.bounds();
  const LongitudeStrip strip = strip_around_layers(request.tile.layers, dataset);
  const bool is_over = strip.east > 180 && west == whole[0] && east == whole[2];
  const double middle = is_over ? (strip.west + strip.east) / 2 : (west + east) / 2;
  return {round_degrees(middle > 180 ? middle - 360 : middle), round_degrees((south + north) / 2)};
}

ArchiveDescription describe(const SeedRequest& request, const Dataset& dataset) {
  const auto summary = summarize_layers(request.tile.layers, dataset);
  ArchiveDescription archive;
  archive.name = summary->title;
  archive.description = summary->description;
  archive.attribution = summary->attribution;
  archive.zooms = request.zooms;
  archive.bounds = bounds_of(*summary, request);
  archive.center = center_of(archive, *summary, request, dataset);
  archive.format = request.tile.format;
  archive.scale = request.tile.scale;
  archive.layers = fmt::format("{}", fmt::join(request.tile.layers, ","));
  archive.style = request.tile.style.canonical_text();
  return archive;
}

SeedPart part_of(const SeedArguments& arguments) {
  if (arguments.part.empty()) return {};
  const auto part = parse_part(arguments.part);
  if (!part) {
    throw UsageError(
        fmt::format("--part takes I/N, I being from 1 to N, got \"{}\"", arguments.part));
  }
  if (kind_of_archive(arguments.output) != ArchiveKind::folder) {
    throw UsageError(
        fmt::format("--part writes an input for `trapeze seed --join`, not an archive: give "
                    "--output another name, such as {}.part{}",
                    arguments.output, part->number));
  }
  return *part;
}

/// Everything needed for a seeding. The words are those of the same command.
struct Work {
  SeedRequest request;
  std::shared_ptr<const Dataset> dataset;
  SeedPlan plan;
  SeedJobs jobs;
  JobRange range;
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  std::string renderer;  // its identity
  std::shared_ptr<LabelBook> labels;
};

Work prepare_work(const SeedArguments& arguments, const Config& config) {
  SeedRequest request = make_request(arguments, config);
  const SeedPart part = part_of(arguments);
  auto renderers = start_renderers(config.server.renderer, renderer_count(config.server.workers));
  const auto dataset =
      Dataset::load(config.layers, nullptr, nullptr, read_named_tables(config.values));
  auto plan = SeedPlan::make(request, dataset);
  if (!plan) throw UsageError(plan.problem().detail);
  std::string renderer = renderers.front()->identity();
  Work work{std::move(request),
            dataset,
            *std::move(plan),
            {},
            {},
            std::move(renderers),
            std::move(renderer),
            std::make_shared<LabelBook>(open_font_choice(config))};
  KnownTiles known(work.plan, TilePainter::new_class_cache(), work.labels);
  work.jobs = divide_into_jobs(work.plan, known);
  work.range = jobs_of_part(work.jobs, part);
  return work;
}

int tell_estimate(const Work& work, Seeder& seeder, bool is_update) {
  const auto estimate = seeder.estimate(work.range, kSecondsOfSample);
  const std::uint64_t tiles = work.plan.count();
  const bool is_all = work.range.end - work.range.first == work.jobs.jobs.size();
  fmt::print("tiles to be drawn       {}\n",
             number_words(estimate.figures.drawn - estimate.reused));
  if (is_update) fmt::print("as they were            {}\n", number_words(estimate.reused));
  fmt::print("of one colour           {}\n", number_words(estimate.figures.alone));
  if (is_all) {
    const std::uint64_t looked_at = estimate.figures.drawn + estimate.figures.alone;
    fmt::print("known without looking   {}\n", number_words(tiles - std::min(tiles, looked_at)));
    fmt::print("all tiles               {}\n", number_words(tiles));
  }
  fmt::print("size                    {}\n", bytes_words(estimate.bytes));
  fmt::print("time                    {}\n", duration_words(estimate.seconds));
  return 0;
}

/// The file for work in progress.
std::string log_path(const SeedArguments& arguments) {
  if (!arguments.part.empty()) return arguments.output;
  std::string path = arguments.output;
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path + ".seeding";
}

/// The parts do not tell tiles that were drawn from those that an update took from the earlier
/// archive.
void make_archive(const std::vector<std::string>& logs, const std::string& output,
                  const JoinOptions& options, bool is_update) {
  const auto begin = Clock::now();
  const SeedLogs parts(logs);
  join_into_archive(parts, output, options);
  const SeedFigures figures = parts.figures();
  spdlog::info(fmt::format(
      "{}: {}; put together in {}", output,
      is_update ? fmt::format("{} tiles", number_words(figures.tiles())) : figures_words(figures),
      duration_words(seconds_since(begin))));
}

SeedLogHead head_of(const SeedArguments& arguments, const Work& work) {
  return {work.plan.identity(work.renderer, work.labels->identity_of_fonts()),
          work.jobs.jobs.size(), work.range, part_of(arguments),
          describe(work.request, *work.dataset)};
}

void seed_into(SeedLog& log, const SeedArguments& arguments, const Work& work, Seeder& seeder) {
  const std::string path = log_path(arguments);
  double done = 0;
  for (const std::uint64_t job : log.done()) done += work.jobs.jobs[job].cost;
  const double cost = work.jobs.cost(work.range);
  if (!log.done().empty()) {
    spdlog::info(fmt::format("{}: resuming, {:.1f} % were done before", path,
                             100 * done / std::max(cost, 1.0)));
  }
  const auto begin = Clock::now();
  SeedProgress last;
  ProgressLine line(cost, done);
  seeder.seed(work.range, log, [&](const SeedProgress& progress) {
    last = progress;
    line(progress);
  });
  const double seconds = seconds_since(begin);
  spdlog::info(
      fmt::format("{}: {}; {} in {}, {:.0f} drawn a second", path,
                  figures_words(last.figures, !arguments.update.empty(), last.reused),
                  bytes_words(static_cast<double>(log.bytes_of_data())), duration_words(seconds),
                  static_cast<double>(last.figures.drawn - last.reused) / std::max(seconds, 1e-3)));
}

/// Layers and styles are checked on the machines that will seed: here, only arguments that can be
/// checked without them are.
int print_jobs(const SeedArguments& arguments) {
  const BatchSystem system = word_or_throw("--jobs", arguments.jobs, kBatchSystemNames);
  if (arguments.parts == 0) throw UsageError("--jobs needs --parts, the number of parts");
  if (!arguments.part.empty() || !arguments.join.empty()) {
    throw UsageError("--jobs writes --part and --join itself");
  }
  if (arguments.is_dry_run) throw UsageError("--jobs does not go with --dry-run");
  zooms_or_throw(arguments.zooms, kMaxZoom);
  if (kind_of_archive(arguments.output) == ArchiveKind::folder) {
    throw UsageError("--jobs needs an --output that ends in .pmtiles or .mbtiles");
  }
  constexpr std::array<std::string_view, 3> kNotOfParts{"--jobs", "--parts", "--output"};
  BatchSeeding seeding{without_options(arguments.words, kNotOfParts), arguments.output,
                       arguments.parts, arguments.is_sparse};
  std::erase(seeding.arguments, "--sparse");
  if (fmt::format("{}{}", fmt::join(seeding.arguments, ""), seeding.output).find('\n') !=
      std::string::npos) {
    throw UsageError("--jobs takes no line feed in an argument");
  }
  fmt::print("{}", batch_jobs(system, seeding));
  return 0;
}

}  // namespace

int run_seed(const SeedArguments& arguments) {
  if (!arguments.jobs.empty()) return print_jobs(arguments);
  if (arguments.parts != 0) throw UsageError("--parts goes with --jobs; one part is --part I/N");
  const JoinOptions options{arguments.is_sparse};
  if (arguments.output.empty() && !arguments.is_dry_run) throw UsageError("--output is missing");
  if (!arguments.join.empty()) {
    if (arguments.is_dry_run) throw UsageError("--join does not go with --dry-run");
    check_place_of_archive(arguments.output);
    make_archive(arguments.join, arguments.output, options, false);
    return 0;
  }
  if (!arguments.is_dry_run && arguments.part.empty()) check_place_of_archive(arguments.output);
  const Config config = configure(arguments.serve);
  Work work = prepare_work(arguments, config);
  std::optional<EarlierArchive> earlier;
  JobPainter::FindKnown find_known;
  if (!arguments.update.empty()) {
    earlier.emplace(arguments.update);
    find_known = [&earlier](const Digest& fingerprint) { return earlier->find(fingerprint); };
  }
  Seeder seeder(work.plan, work.jobs, std::move(work.renderers), work.labels, find_known);
  if (arguments.is_dry_run) return tell_estimate(work, seeder, !arguments.update.empty());
  // Locked until it is removed: it belongs to this process while the archive is put together, too.
  SeedLog log(log_path(arguments), head_of(arguments, work));
  seed_into(log, arguments, work, seeder);
  if (!arguments.part.empty()) return 0;
  make_archive({log_path(arguments)}, arguments.output, options, !arguments.update.empty());
  std::filesystem::remove(log_path(arguments));
  return 0;
}

}  // namespace trapeze
