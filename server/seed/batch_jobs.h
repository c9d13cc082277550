// The jobs that seed an archive in parts on batch systems: an Indexed Job on Kubernetes, a job
// array on Slurm. Both run the same commands.
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

/// Within the default limits of Kubernetes Jobs and Slurm job arrays.
constexpr int kMostBatchParts = 1000;

/// What to seed, as given to `trapeze seed`.
struct BatchSeeding {
  std::vector<std::string> arguments;  // except --output, --part, --sparse and job options
  std::string output;                  // the archive; on Kubernetes, its name on the volume
  int parts = 1;                       // 1 to kMostBatchParts
  bool is_sparse = false;              // --sparse, which applies to joining
};

/// The words of a command line without these options, each of which takes a value: "--name value"
/// or "--name=value".
std::vector<std::string> without_options(std::span<const std::string> words,
                                         std::span<const std::string_view> options);

/// The word as a shell argument: quoted if necessary.
std::string shell_word(const std::string& word);

/// For Kubernetes, a volume claim, the Job that seeds the parts, and the suspended Job that joins
/// them, as YAML; for Slurm, a script for sbatch. No argument may contain a line feed.
std::string batch_jobs(BatchSystem system, const BatchSeeding& seeding);

}  // namespace trapeze
