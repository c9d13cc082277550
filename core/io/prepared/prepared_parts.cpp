#include "core/io/prepared/prepared_parts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <new>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/grid/digest.h"
#include "core/io/file/mapped_file.h"
#include "core/io/file/prepared_file.h"
#include "core/layer/layer_arrays.h"

namespace trapeze {
namespace {

using Part = std::shared_ptr<const PreparedPart>;

/// Whether the name matches the pattern.
bool fits(std::string_view pattern, std::string_view name) {
  // Position of the last `*`, and the end of the part of the name that it matches so far.
  std::size_t p = 0;
  std::size_t n = 0;
  std::optional<std::size_t> star;
  std::size_t star_end = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_end = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star) {
      p = *star + 1;
      n = ++star_end;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// "2, 5 and 7", limited to the first few.
std::string listed(const std::vector<std::uint32_t>& numbers) {
  constexpr std::size_t kMost = 10;
  std::string words;
  const std::size_t shown = std::min(numbers.size(), kMost);
  for (std::size_t i = 0; i < shown; ++i) {
    const bool is_last = i + 1 == shown && shown == numbers.size();
    if (i > 0) words += is_last ? " and " : ", ";
    words += std::to_string(numbers[i]);
  }
  if (shown < numbers.size()) {
    words += " and " + std::to_string(numbers.size() - shown) + " more";
  }
  return words;
}

std::string part_words(const PartNumber& number) {
  const std::string of = " of " + std::to_string(number.count);
  if (number.is_overview()) return "the overview of " + std::to_string(number.count) + " parts";
  return "part " + std::to_string(number.number) + of;
}

[[noreturn]] void fail(const std::string& path, const std::string& words) {
  throw std::runtime_error(path + ": " + words);
}

/// Whether no file of the source had other contents for one than for the other. On another machine
/// the source may have had another name: then there is nothing to compare.
bool are_of_one_state(const SourceStamp& one, const SourceStamp& two) {
  return std::ranges::all_of(one.files, [&two](const FileStamp& file) {
    const auto same = std::ranges::find(two.files, file.name, &FileStamp::name);
    return same == two.files.end() || (same->size == file.size && same->checksum == file.checksum);
  });
}

/// Throws if they are not from one division and prepared alike.
void check_alike(const Part& first, const Part& other) {
  const PartNumber& a = first->number();
  const PartNumber& b = other->number();
  if (a.count != b.count) {
    fail(other->path(), "is " + part_words(b) + ", and " + first->path() + " is " + part_words(a));
  }
  if (first->summary().options != other->summary().options ||
      first->summary().fingerprint != other->summary().fingerprint) {
    fail(other->path(),
         "was prepared with other options, or another version of Trapeze, than " + first->path());
  }
  const auto are_alike = [](const Field& one, const Field& two) {
    return one.name == two.name && one.type == two.type;
  };
  const bool have_fields =
      b.is_overview() ||
      std::ranges::equal(first->summary().fields, other->summary().fields, are_alike);
  // The division knows only ids, boxes and numbers of vertices. An overview names its parts.
  const bool is_one_state =
      b.is_overview() || are_of_one_state(first->summary().source, other->summary().source);
  if (a.division != b.division || !have_fields || !is_one_state) {
    fail(other->path(), "is a part of another source than " + first->path() +
                            ", or of the same one in another state, or selected otherwise");
  }
}

/// In order of number; throws if one is missing or occurs twice.
std::vector<Part> in_order(std::vector<Part> parts) {
  std::ranges::stable_sort(parts, {}, [](const Part& part) { return part->number().number; });
  const std::uint32_t count = parts.front()->number().count;
  std::vector<std::uint32_t> missing;
  std::uint32_t next = 1;
  for (const Part& part : parts) {
    for (; next < part->number().number; ++next) missing.push_back(next);
    if (part->number().number < next) {
      const auto same = std::ranges::find_if(parts, [&](const Part& other) {
        return other->number().number == part->number().number;
      });
      fail(part->path(), "is " + part_words(part->number()) + ", and so is " + (*same)->path());
    }
    ++next;
  }
  for (; next <= count; ++next) missing.push_back(next);
  if (!missing.empty()) {
    const std::string folder = std::filesystem::path(parts.front()->path()).parent_path().string();
    fail(folder.empty() ? "." : folder, (missing.size() == 1 ? "part " : "parts ") +
                                            listed(missing) + " of " + std::to_string(count) +
                                            (missing.size() == 1 ? " is" : " are") +
                                            " missing beside " + parts.front()->path());
  }
  return parts;
}

struct Found {
  std::vector<Part> parts;
  Part overview;
};

/// Whether they have the same contents. The state of the source may be another one, if it has
/// changed only in other parts.
bool are_same(const PreparedPart& part, const PreparedSummary& summary) {
  return part.summary().revision == summary.revision && part.summary().part == summary.part &&
         part.summary().file_size == summary.file_size &&
         part.summary().fingerprint == summary.fingerprint && !part.is_damaged();
}

Part earlier_part(const PreparedParts* earlier, const std::string& path,
                  const PreparedSummary& summary) {
  if (earlier == nullptr) return nullptr;
  const auto fits = [&](const Part& part) {
    return part != nullptr && part->path() == path && are_same(*part, summary);
  };
  if (fits(earlier->overview())) return earlier->overview();
  const auto part = std::ranges::find_if(earlier->parts(), fits);
  return part == earlier->parts().end() ? nullptr : *part;
}

Found find_parts(const std::vector<std::string>& files, const PreparedDemands& demands,
                 const PreparedParts* earlier) {
  Found found;
  for (const std::string& file : files) {
    if (!is_prepared_file(file)) fail(file, "is not a prepared file, and so not a part of a layer");
    PreparedSummary summary = read_prepared_summary(file);
    if (!summary.part) {
      fail(file, "is a whole layer, not a part of one: serve it by its own name");
    }
    Part part = earlier_part(earlier, file, summary);
    if (part == nullptr) {
      part = std::make_shared<const PreparedPart>(file, std::move(summary));
    } else if (!are_of_one_state(part->summary().source, summary.source)) {
      part = std::make_shared<const PreparedPart>(file, std::move(summary), *part);
    }
    if (!part->number().is_overview()) {
      found.parts.push_back(std::move(part));
    } else if (found.overview == nullptr) {
      found.overview = std::move(part);
    } else {
      fail(file, "is an overview, and so is " + found.overview->path());
    }
  }
  if (found.parts.empty()) {
    throw std::runtime_error((files.empty() ? std::string("nothing") : files.front()) +
                             ": there is no part of a layer");
  }
  for (const Part& part : found.parts) check_alike(found.parts.front(), part);
  found.parts = in_order(std::move(found.parts));
  // The others were prepared alike, from the same source.
  const Part& first = found.parts.front();
  check_prepared_summary(first->path(), first->summary(), demands);
  return found;
}

void check_overview(const Part& overview, const std::vector<Part>& parts) {
  if (overview == nullptr) return;
  check_alike(parts.front(), overview);
  if (overview->number().revision_of_parts == revision_of_parts(parts)) return;
  fail(overview->path(),
       "is not the overview of the current parts; run `trapeze prepare --join` again");
}

void add_report(const LoadReport& part, LoadReport& sum) {
  for (const auto count : {&LoadReport::features, &LoadReport::loaded, &LoadReport::other_geometry,
                           &LoadReport::empty, &LoadReport::skipped, &LoadReport::polygons,
                           &LoadReport::rings, &LoadReport::source_vertices, &LoadReport::vertices,
                           &LoadReport::collapsed_rings, &LoadReport::repaired}) {
    sum.*count += part.*count;
  }
  for (const auto count : kCoverageCounts) sum.coverage.*count += part.coverage.*count;
  constexpr std::size_t kMostNotes = 1000;
  const std::size_t more =
      std::min(part.notes.size(), kMostNotes - std::min(kMostNotes, sum.notes.size()));
  sum.notes.insert(sum.notes.end(), part.notes.begin(),
                   part.notes.begin() + static_cast<std::ptrdiff_t>(more));
}

/// A layer with these fields and bounds, without polygons.
std::unique_ptr<Layer> frame_of(const std::vector<Part>& parts) {
  LayerArrays arrays;
  arrays.fields = parts.front()->summary().fields;
  arrays.cells.columns.resize(arrays.fields.size());
  arrays.options = parts.front()->summary().options;
  for (const Part& part : parts) arrays.bounds.include(part->summary().bounds);
  return layer_from(arrays, nullptr);
}

}  // namespace

PreparedPart::PreparedPart(std::string path, PreparedSummary summary, const PreparedPart& earlier)
    : PreparedPart(std::move(path), std::move(summary)) {
  const std::lock_guard lock(earlier.mutex_);
  layer_ = earlier.layer_;
  file_ = earlier.file_;
}

std::shared_ptr<const Layer> PreparedPart::layer() const {
  const std::lock_guard lock(mutex_);
  if (layer_ != nullptr || has_failed_) return layer_;
  try {
    LoadedLayer loaded = open_summarized_layer(path_, summary_);
    file_ = std::move(loaded.file);
    layer_ = std::move(loaded.layer);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const MappingShortage&) {
    throw;
  } catch (const std::exception& error) {
    problem_ = error.what();
    has_failed_ = true;
  }
  return layer_;
}

std::shared_ptr<const Layer> PreparedPart::layer_if_open() const {
  const std::lock_guard lock(mutex_);
  return layer_;
}

bool PreparedPart::is_damaged() const {
  if (has_failed_) return true;
  const std::lock_guard lock(mutex_);
  return file_ != nullptr && !file_->is_whole();
}

std::string PreparedPart::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

PreparedParts::PreparedParts(std::vector<Part> parts, Part overview)
    : parts_(std::move(parts)), overview_(std::move(overview)) {
  Digester digester;
  digester.add(revision_of_parts(parts_));
  if (overview_ != nullptr) digester.add(overview_->summary().revision);
  revision_ = digester.digest().low;
  const auto add = [this](const PreparedPart& part) { file_size_ += part.summary().file_size; };
  for (const Part& part : parts_) {
    const LayerSize& size = part->summary().size;
    size_.vertices += size.vertices;
    size_.trapezoids += size.trapezoids;
    size_.edges += size.edges;
    size_.motes += size.motes;
    add(*part);
  }
  if (overview_ != nullptr) add(*overview_);
}

bool PreparedParts::is_whole() const {
  const auto is_damaged = [](const Part& part) { return part != nullptr && part->is_damaged(); };
  return !is_damaged(overview_) && std::ranges::none_of(parts_, is_damaged);
}

bool PreparedParts::was_whole_lately() const {
  constexpr std::int64_t kLately = 50'000'000;
  const std::int64_t now = std::chrono::steady_clock::now().time_since_epoch().count();
  if (now - looked_at_ >= kLately) {
    was_whole_ = is_whole();
    looked_at_ = now;
  }
  return was_whole_;
}

bool is_pattern_of_files(const std::string& path) {
  if (std::filesystem::path(path).filename().string().find_first_of("*?") == std::string::npos) {
    return false;
  }
  // A database, or a path in an archive, is not a file.
  const std::size_t colon = path.find(':');
  if (colon != std::string::npos && colon < path.find('/')) return false;
  if (path.starts_with("/vsi")) return false;
  std::error_code error;
  return !std::filesystem::exists(path, error);
}

std::vector<std::string> files_of_pattern(const std::string& pattern) {
  const std::filesystem::path path(pattern);
  const std::string name = path.filename().string();
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  if (error) fail(pattern, "the folder " + folder.string() + " cannot be read: " + error.message());
  std::vector<std::string> files;
  for (const auto& entry : entries) {
    const std::string file = entry.path().filename().string();
    if (file.starts_with('.') || !fits(name, file) || !entry.is_regular_file(error)) continue;
    files.push_back(path.has_parent_path() ? entry.path().string() : file);
  }
  if (files.empty()) fail(pattern, "there is no file of such a name");
  std::ranges::sort(files);
  return files;
}

std::uint64_t revision_of_parts(const std::vector<Part>& parts) {
  Digester digester;
  for (const Part& part : parts) digester.add(part->summary().revision);
  return digester.digest().low;
}

LoadedLayer open_prepared_parts(const std::vector<std::string>& files,
                                const PreparedDemands& demands, const PreparedParts* earlier) {
  const auto start = std::chrono::steady_clock::now();
  Found found = find_parts(files, demands, earlier);
  check_overview(found.overview, found.parts);
  LoadedLayer loaded;
  loaded.layer = frame_of(found.parts);
  for (const Part& part : found.parts) add_report(part->summary().report, loaded.report);
  const PreparedPart& first = *found.parts.front();
  loaded.report.driver = first.summary().report.driver;
  loaded.report.prepared_from = first.summary().report.prepared_from;
  loaded.report.path = first.path() + " and " + std::to_string(found.parts.size() - 1) + " more";
  loaded.parts =
      std::make_shared<const PreparedParts>(std::move(found.parts), std::move(found.overview));
  loaded.revision = loaded.parts->revision();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  loaded.report.read_seconds = loaded.report.total_seconds = took.count();
  return loaded;
}

std::vector<Part> find_prepared_parts(const std::vector<std::string>& files,
                                      const PreparedDemands& demands) {
  return find_parts(files, demands, nullptr).parts;
}

}  // namespace trapeze
