#include "server/seed/seed_log.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/io/file/checksum.h"
#include "server/base/json_text.h"

namespace trapeze {
namespace {

constexpr std::string_view kLogMark = "trapeze seeding 1\n";
constexpr const char* kChecksum = "checksum";  // the member with that of the others

[[noreturn]] void refuse_log(const std::string& path, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: {}", path, why));
}

[[noreturn]] void fail_to_write(const std::string& path, int error) {
  throw std::runtime_error(
      fmt::format("cannot write {}: {}", path, std::generic_category().message(error)));
}

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::uint64_t checksum_of_members(const Json& json) {
  const std::string text = dumped(json);
  return checksum(std::as_bytes(std::span(text)));
}

/// A line of JSON after the mark, padded with spaces up to where blocks begin.
std::string text_of(const SeedLogHead& head) {
  const ArchiveDescription& archive = head.archive;
  Json json = {{"identity", head.identity},
               {"jobs", head.jobs},
               {"first_job", head.range.first},
               {"end_job", head.range.end},
               {"part", head.part.number},
               {"parts", head.part.count},
               {"name", archive.name},
               {"description", archive.description},
               {"attribution", archive.attribution},
               {"minzoom", archive.zooms.first},
               {"maxzoom", archive.zooms.last},
               {"bounds", archive.bounds},
               {"center", archive.center},
               {"format", kTileFormatNames.name_of(archive.format)},
               {"scale", archive.scale},
               {"layers", archive.layers},
               {"style", archive.style}};
  const std::uint64_t checksum = checksum_of_members(json);
  json[kChecksum] = checksum;
  std::string text = std::string(kLogMark) + dumped(json);
  const std::size_t size =
      (text.size() + 1 + kBlockAlignment - 1) / kBlockAlignment * kBlockAlignment;
  text.append(size - 1 - text.size(), ' ').push_back('\n');
  return text;
}

struct ReadHead {
  SeedLogHead head;
  std::size_t size = 0;
};

/// Nothing if it is not a head, or not a complete one, or damaged.
std::optional<ReadHead> read_head(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kLogMark)) return std::nullopt;
  const std::size_t end = text.find('\n', kLogMark.size());
  if (end == std::string_view::npos) return std::nullopt;
  Json json = Json::parse(text.substr(kLogMark.size(), end - kLogMark.size()), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  try {
    const std::uint64_t checksum = json.at(kChecksum);
    json.erase(kChecksum);
    if (checksum_of_members(json) != checksum) return std::nullopt;
    SeedLogHead head;
    head.identity = json.at("identity");
    head.jobs = json.at("jobs");
    head.range = {json.at("first_job"), json.at("end_job")};
    head.part = {json.at("part"), json.at("parts")};
    ArchiveDescription& archive = head.archive;
    archive.name = json.at("name");
    archive.description = json.at("description");
    archive.attribution = json.at("attribution");
    archive.zooms = {json.at("minzoom"), json.at("maxzoom")};
    archive.bounds = json.at("bounds");
    archive.center = json.at("center");
    archive.format = json.at("format") == "webp" ? TileFormat::webp : TileFormat::png;
    archive.scale = json.at("scale");
    archive.layers = json.at("layers");
    archive.style = json.at("style");
    return ReadHead{head, end + 1};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

/// Calls visit(block) for the complete blocks up to the first incomplete one; returns where that
/// begins.
template <typename Visit>
std::size_t for_each_block(std::span<const std::byte> bytes, std::size_t begin,
                           const Visit& visit) {
  while (begin < bytes.size()) {
    const auto block = SeedBlock::read(bytes.subspan(begin));
    if (!block) break;
    visit(*block);
    begin += block->size();
  }
  return begin;
}

}  // namespace

SeedLog::SeedLog(const std::string& path, const SeedLogHead& head)
    : path_(path), file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (file_ < 0) fail_to_write(path, errno);
  try {
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) refuse_log(path, "another process is writing it");
    const std::string text = text_of(head);
    struct stat status {};
    if (fstat(file_, &status) != 0) fail_to_write(path, errno);
    // Finished, and removed after it was opened here.
    if (status.st_nlink == 0) refuse_log(path, "another process is writing it");
    const auto size = static_cast<std::size_t>(status.st_size);
    std::string begin(std::min(size, text.size()), '\0');
    if (pread(file_, begin.data(), begin.size(), 0) != static_cast<ssize_t>(begin.size())) {
      refuse_log(path, "cannot be read");
    }
    if (!begin.starts_with(kLogMark.substr(0, begin.size()))) {
      refuse_log(path, "this is not a part of a seeding: use another --output");
    }
    if (!text.starts_with(begin)) {
      refuse_log(path,
                 "this is the state of a different seeding: data, options or program have changed. "
                 "Remove it to start again, or use another --output");
    }
    // A shorter file was interrupted before any block was written.
    if (size <= text.size()) {
      append(std::as_bytes(std::span(text)));
      return;
    }
    const MappedFile mapped(path);
    const std::span<const std::byte> bytes = mapped.bytes();
    end_ = for_each_block(bytes, text.size(), [this](const SeedBlock& block) {
      if (done_.insert(block.job()).second) figures_.add(block.figures());
    });
    if (ftruncate(file_, static_cast<off_t>(end_)) != 0) fail_to_write(path, errno);
  } catch (...) {
    close(file_);
    throw;
  }
}

SeedLog::~SeedLog() {
  close(file_);
}

void SeedLog::append(std::span<const std::byte> block) {
  const std::lock_guard lock(mutex_);
  std::uint64_t at = end_;
  while (!block.empty()) {
    const ssize_t written = pwrite(file_, block.data(), block.size(), static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      // Anything written is cut off, here or when the log is continued.
      [[maybe_unused]] const int ignored = ftruncate(file_, static_cast<off_t>(end_));
      fail_to_write(path_, error);
    }
    at += static_cast<std::uint64_t>(written);
    block = block.subspan(static_cast<std::size_t>(written));
  }
  end_ = at;
}

void SeedLog::sync() {
  if (fsync(file_) != 0) fail_to_write(path_, errno);
}

SeedLogs::SeedLogs(const std::vector<std::string>& paths) {
  std::optional<SeedLogHead> first;
  std::vector<std::optional<SeedBlock>> found;
  for (const std::string& path : paths) {
    files_.push_back(std::make_unique<MappedFile>(path));
    const std::span<const std::byte> bytes = files_.back()->bytes();
    const std::optional<ReadHead> read = read_head(bytes);
    if (!read) refuse_log(path, "this is not a part of a seeding, or it is damaged");
    const SeedLogHead& head = read->head;
    if (!first) {
      first = head;
      found.resize(head.jobs);
    }
    if (head.identity != first->identity || head.jobs != first->jobs) {
      refuse_log(path, fmt::format("this is a part of another seeding than {}", paths.front()));
    }
    if (head.archive != first->archive) {
      refuse_log(path, fmt::format("its title, attribution, bounds or style are not those of {}",
                                   paths.front()));
    }
    std::size_t jobs = 0;
    for_each_block(bytes, read->size, [&](const SeedBlock& block) {
      if (block.job() >= found.size()) return;
      found[block.job()] = block;
      ++jobs;
    });
    if (jobs < head.range.end - head.range.first) {
      refuse_log(path, fmt::format("part {} of {} has not been finished: {} of {} jobs are done",
                                   head.part.number, head.part.count, jobs,
                                   head.range.end - head.range.first));
    }
  }
  archive_ = first->archive;
  for (const std::optional<SeedBlock>& block : found) {
    if (!block) {
      refuse_log(paths.front(),
                 fmt::format("of its {} parts, not all were given", first->part.count));
    }
    blocks_.push_back(*block);
  }
}

SeedFigures SeedLogs::figures() const {
  SeedFigures sum;
  for (const SeedBlock& block : blocks_) sum.add(block.figures());
  return sum;
}

}  // namespace trapeze
