#include "server/http/static_files.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "server/base/content_hash.h"

namespace trapeze {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{32} << 20;

constexpr std::array<std::pair<std::string_view, std::string_view>, 17> kContentTypes = {{
    {".css", "text/css; charset=utf-8"},
    {".gif", "image/gif"},
    {".htm", "text/html; charset=utf-8"},
    {".html", "text/html; charset=utf-8"},
    {".ico", "image/x-icon"},
    {".jpeg", "image/jpeg"},
    {".jpg", "image/jpeg"},
    {".js", "text/javascript; charset=utf-8"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".pbf", "application/x-protobuf"},
    {".png", "image/png"},
    {".svg", "image/svg+xml"},
    {".txt", "text/plain; charset=utf-8"},
    {".woff", "font/woff"},
    {".woff2", "font/woff2"},
}};

bool is_hidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

std::string read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad() || !file.is_open()) {
    throw std::runtime_error(fmt::format("cannot read {}", path.string()));
  }
  return bytes;
}

using Bytes = std::shared_ptr<const std::string>;

Bytes shared(std::string bytes) {
  return std::make_shared<const std::string>(std::move(bytes));
}

std::string tag_of(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes);
  return fmt::format("\"{}\"", hash.hex());
}

StaticFile load_file(const fs::path& path) {
  StaticFile file;
  file.content_type = content_type_of(path.filename().string());
  file.bytes = shared(read_bytes(path));
  file.entity_tag = tag_of(*file.bytes);
  const auto compressed = [&file](ContentEncoding encoding) -> Bytes {
    auto made = compress(*file.bytes, encoding, Effort::quick);
    return made ? shared(*std::move(made)) : nullptr;
  };
  if (file.bytes->size() >= kLeastToCompress && is_worth_compressing(file.content_type)) {
    file.gzip = compressed(ContentEncoding::gzip);
    file.brotli = compressed(ContentEncoding::brotli);
  }
  return file;
}

StaticFile take_file(const BuiltInFile& built_in) {
  const auto taken = [](std::string_view bytes) {
    return bytes.empty() ? nullptr : shared(std::string(bytes));
  };
  return {content_type_of(std::string(built_in.path)), tag_of(built_in.bytes),
          shared(std::string(built_in.bytes)), taken(built_in.gzip), taken(built_in.brotli)};
}

}  // namespace

std::string content_type_of(const std::string& file_name) {
  std::string ending = fs::path(file_name).extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  for (const auto& [known, type] : kContentTypes) {
    if (ending == known) return std::string(type);
  }
  return "application/octet-stream";
}

std::vector<ContentEncoding> StaticFile::encodings() const {
  std::vector<ContentEncoding> all;
  if (brotli != nullptr) all.push_back(ContentEncoding::brotli);
  if (gzip != nullptr) all.push_back(ContentEncoding::gzip);
  return all;
}

const Bytes& StaticFile::in(ContentEncoding encoding) const {
  switch (encoding) {
    case ContentEncoding::gzip:
      return gzip;
    case ContentEncoding::brotli:
      return brotli;
    case ContentEncoding::identity:
      break;
  }
  return bytes;
}

StaticFiles::StaticFiles(std::span<const BuiltInFile> files) {
  for (const BuiltInFile& file : files) files_.emplace(file.path, take_file(file));
}

StaticFiles::StaticFiles(const std::string& root) {
  try {
    for (auto entry = fs::recursive_directory_iterator(root);
         entry != fs::recursive_directory_iterator(); ++entry) {
      if (is_hidden(entry->path())) {
        if (entry->is_directory()) entry.disable_recursion_pending();
        continue;
      }
      if (!entry->is_regular_file()) continue;
      if (entry->file_size() > kMaxFileBytes) {
        spdlog::warn(fmt::format("{} is larger than {} MB and is not served",
                                 entry->path().string(), kMaxFileBytes >> 20));
        continue;
      }
      const std::string path = entry->path().lexically_relative(root).generic_string();
      files_.emplace("/" + path, load_file(entry->path()));
    }
  } catch (const fs::filesystem_error& error) {
    throw std::runtime_error(
        fmt::format("cannot read the folder of the viewer {}: {}", root, error.code().message()));
  }
}

const StaticFile* StaticFiles::find(const std::string& path) const {
  const auto found = files_.find(path.ends_with('/') ? path + "index.html" : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace trapeze
