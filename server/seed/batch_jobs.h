// The jobs that seed an archive in parts on the batch systems that people have: an Indexed Job of
// Kubernetes, an array of Slurm. Both run the same commands.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/name_table.h"

namespace trapeze {

enum class BatchSystem { kubernetes, slurm };

inline constexpr NameTable<BatchSystem, 2> kBatchSystemNames({
    {"kubernetes", BatchSystem::kubernetes},
    {"slurm", BatchSystem::slurm},
});

/// As many as a Job of Kubernetes or an array of Slurm takes where nobody has set it otherwise, or
/// fewer.
constexpr int kMostParts = 1000;

/// What is seeded, as `trapeze seed` is told.
struct BatchSeeding {
  std::vector<std::string> arguments;  // but for --output, --part, --sparse, and what asks for jobs
  std::string output;                  // the archive; on Kubernetes its name on the volume
  int parts = 1;                       // 1 to kMostParts
  bool is_sparse = false;              // --sparse, which is for who joins
};

/// The words of a command line but for these options, which all take a value: "--name value" and
/// "--name=value".
std::vector<std::string> without_options(std::span<const std::string> words,
                                         std::span<const std::string_view> options);

/// The word as a shell reads it back: in quotes where it has to be.
std::string shell_word(const std::string& word);

/// A claim of a volume, the Job that seeds the parts, and the suspended Job that joins them, in
/// YAML; a script for sbatch. No argument may hold a line feed.
std::string batch_jobs(BatchSystem system, const BatchSeeding& seeding);

}  // namespace trapeze
