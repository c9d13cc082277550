// Runs a fuzz harness over inputs that are given: files, or files of folders. And, so that there is
// something to run on before the first finding, over `--random N` inputs of seeded bytes.
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

void replay(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

void run_random(int count) {
  for (int seed = 0; seed < count; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::vector<std::uint8_t> bytes(2 + random() % 400);
    // Many inputs of few different values: points meet, lie level and in line.
    const unsigned range = seed % 3 == 0 ? 256 : seed % 3 == 1 ? 16 : 4;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const bool is_high_byte = i >= 2 && i % 2 == 1;
      bytes[i] = static_cast<std::uint8_t>(is_high_byte && range < 256 ? 0 : random() % range);
    }
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t inputs = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--random" && i + 1 < argc) {
      const int count = std::atoi(argv[++i]);
      run_random(count);
      inputs += static_cast<std::size_t>(count);
    } else if (std::filesystem::is_directory(argument)) {
      for (const auto& entry : std::filesystem::recursive_directory_iterator(argument)) {
        if (!entry.is_regular_file()) continue;
        replay(entry.path());
        ++inputs;
      }
    } else {
      replay(argument);
      ++inputs;
    }
  }
  std::printf("%zu inputs\n", inputs);
  return inputs > 0 ? 0 : 1;
}
