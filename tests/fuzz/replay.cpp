// Runs a fuzz harness with the given inputs (files, or the files of folders), then `--changed N`
// times with a few bytes of each changed, and with `--random N` inputs of seeded random bytes.
// Random values are the same in every run.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

void run(const Bytes& bytes) {
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

Bytes read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

/// The files of a folder, in order, or the file itself.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Sets, deletes, inserts or duplicates a few bytes.
Bytes changed(Bytes bytes, std::mt19937& random) {
  for (auto changes = 1 + random() % 3; changes > 0; --changes) {
    const std::size_t at = bytes.empty() ? 0 : random() % bytes.size();
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto byte = static_cast<std::uint8_t>(random() % 256);
    const std::size_t length = std::min<std::size_t>(1 + random() % 8, bytes.size() - at);
    const auto end = place + static_cast<std::ptrdiff_t>(length);
    switch (random() % 4) {
      case 0:
        if (!bytes.empty()) *place = byte;
        break;
      case 1:
        bytes.erase(place, end);
        break;
      case 2:
        bytes.insert(place, byte);
        break;
      default: {
        const Bytes part(place, end);
        bytes.insert(end, part.begin(), part.end());
      }
    }
  }
  return bytes;
}

std::size_t replay(const std::filesystem::path& path, int changes) {
  std::size_t inputs = 0;
  std::mt19937 random(1);
  for (const std::filesystem::path& file : files_of(path)) {
    const Bytes bytes = read(file);
    run(bytes);
    for (int i = 0; i < changes; ++i) run(changed(bytes, random));
    inputs += 1 + static_cast<std::size_t>(changes);
  }
  return inputs;
}

void run_random(int count) {
  for (int seed = 0; seed < count; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    Bytes bytes(2 + random() % 400);
    // Many inputs have few different values: points coincide, lie level and are collinear.
    const unsigned range = seed % 3 == 0 ? 256 : seed % 3 == 1 ? 16 : 4;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const bool is_high_byte = i >= 2 && i % 2 == 1;
      bytes[i] = static_cast<std::uint8_t>(is_high_byte && range < 256 ? 0 : random() % range);
    }
    run(bytes);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t inputs = 0;
  int changes = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--random" && i + 1 < argc) {
      const int count = std::atoi(argv[++i]);
      run_random(count);
      inputs += static_cast<std::size_t>(count);
    } else if (argument == "--changed" && i + 1 < argc) {
      changes = std::atoi(argv[++i]);
    } else {
      inputs += replay(argument, changes);
    }
  }
  std::printf("%zu inputs\n", inputs);
  return inputs > 0 ? 0 : 1;
}
