#include "server/seed/batch_jobs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "server/base/build_id.h"

namespace trapeze {
namespace {

// Braces of shell and YAML are doubled for fmt.

constexpr const char* kKubernetes =
    R"(# Tiles drawn beforehand on Kubernetes, in {parts} parts, and the archive of them:
#
#   kubectl apply -f seed.yaml
#   kubectl wait --for=condition=complete --timeout=-1s job/trapeze-seed
#   kubectl patch job/trapeze-join --patch '{{"spec": {{"suspend": false}}}}'
#
# Each pod of the Job seeds its part onto a volume that all of them share (ReadWriteMany: NFS, CephFS); one
# that is killed or moved goes on where it was. The sample is in the image; for maps of your own, put their
# files on the volume, or into an image made FROM this one. Written by
#
#   trapeze seed {words}{sparse} --output {output} \
#     --parts {parts} --jobs kubernetes
apiVersion: v1
kind: PersistentVolumeClaim
metadata:
  name: trapeze-seed
spec:
  accessModes: [ReadWriteMany]
  resources:
    requests:
      storage: 50Gi   # twice the archive
---
apiVersion: batch/v1
kind: Job
metadata:
  name: trapeze-seed
  labels: {{ app.kubernetes.io/name: trapeze-seed }}
spec:
  completionMode: Indexed
  completions: {parts}
  parallelism: {parts}
  backoffLimit: {retries}   # of pods that fail: what they had done is not lost
  template:
    metadata:
      labels: {{ app.kubernetes.io/name: trapeze-seed }}
    spec:
{pod}
      containers:
        - name: seed
          image: trapeze:{version}
          # The index of a pod counts from 0, parts from 1.
          command: [sh, -c]
          args:
            - |-
              part=$((JOB_COMPLETION_INDEX + 1))
              exec trapeze seed {words} \
                --part "$part/{parts}" --output {archive}.part"$part"
          resources:
            requests: {{ cpu: "2", memory: 1Gi }}
            limits: {{ memory: 2Gi }}
{container}
---
# Waits until it is let go.
apiVersion: batch/v1
kind: Job
metadata:
  name: trapeze-join
  labels: {{ app.kubernetes.io/name: trapeze-seed }}
spec:
  suspend: true
  backoffLimit: 3
  template:
    metadata:
      labels: {{ app.kubernetes.io/name: trapeze-seed }}
    spec:
{pod}
      containers:
        - name: join
          image: trapeze:{version}
          command: [sh, -c]
          args:
            - |-
              exec trapeze seed --join {archive}.part* --output {archive}{sparse}
          resources:
            requests: {{ cpu: "1", memory: 1Gi }}
            limits: {{ memory: 2Gi }}
{container}
)";

constexpr const char* kPod = R"(      restartPolicy: OnFailure
      enableServiceLinks: false
      automountServiceAccountToken: false
      securityContext:
        runAsNonRoot: true
        runAsUser: 10001
        runAsGroup: 10001
        fsGroup: 10001
        seccompProfile: { type: RuntimeDefault }
      volumes:
        - name: seed
          persistentVolumeClaim: { claimName: trapeze-seed })";

constexpr const char* kContainer = R"(          securityContext:
            allowPrivilegeEscalation: false
            readOnlyRootFilesystem: true
            capabilities: { drop: [ALL] }
          volumeMounts:
            - { name: seed, mountPath: /seed })";

constexpr const char* kSlurm = R"(#!/usr/bin/env bash
# Tiles drawn beforehand on Slurm, in {parts} parts, and the archive of them:
#
#   array=$(sbatch --parsable --array=1-{parts} seed.sbatch)
#   sbatch --dependency=afterok:"$array" seed.sbatch join
#
# A task that is killed, or whose node goes away, is requeued, and goes on where it was. The folder of the
# archive is shared by all nodes. Written by
#
#   trapeze seed {words}{sparse} --output {output} \
#     --parts {parts} --jobs slurm
#SBATCH --job-name=trapeze-seed
#SBATCH --cpus-per-task=2
#SBATCH --mem=2G
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
program=${{TRAPEZE:-trapeze}}
archive={archive}
if [[ ${{1:-}} == join ]]; then
  exec "$program" seed --join "$archive".part* --output "$archive"{sparse}
fi
part=$SLURM_ARRAY_TASK_ID
status=0
"$program" seed {words} \
  --workers "${{SLURM_CPUS_PER_TASK:-2}}" --part "$part/{parts}" --output "$archive.part$part" || status=$?
# Killed by a signal, for lack of memory mostly: Slurm itself requeues only what a node took with it.
if ((status > 128 && ${{SLURM_RESTART_COUNT:-0}} < 100)); then exec scontrol requeue "$SLURM_JOB_ID"; fi
exit "$status"
)";

std::string words_of(const BatchSeeding& seeding) {
  std::vector<std::string> words;
  std::ranges::transform(seeding.arguments, std::back_inserter(words), shell_word);
  return fmt::format("{}", fmt::join(words, " "));
}

const char* sparse_option(const BatchSeeding& seeding) {
  return seeding.is_sparse ? " --sparse" : "";
}

std::string kubernetes_jobs(const BatchSeeding& seeding) {
  constexpr int kRetriesOfPart = 12;
  const auto name = std::filesystem::path(seeding.output).filename();
  return fmt::format(
      fmt::runtime(kKubernetes), fmt::arg("parts", seeding.parts),
      fmt::arg("retries", kRetriesOfPart * seeding.parts), fmt::arg("words", words_of(seeding)),
      fmt::arg("output", shell_word(seeding.output)), fmt::arg("version", version()),
      fmt::arg("archive", shell_word("/seed/" + name.string())), fmt::arg("pod", kPod),
      fmt::arg("container", kContainer), fmt::arg("sparse", sparse_option(seeding)));
}

std::string slurm_script(const BatchSeeding& seeding) {
  return fmt::format(
      fmt::runtime(kSlurm), fmt::arg("parts", seeding.parts), fmt::arg("words", words_of(seeding)),
      fmt::arg("output", shell_word(seeding.output)),
      fmt::arg("archive", shell_word(seeding.output)), fmt::arg("sparse", sparse_option(seeding)));
}

}  // namespace

std::vector<std::string> without_options(std::span<const std::string> words,
                                         std::span<const std::string_view> options) {
  std::vector<std::string> left;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto is_value_in_word = [&](std::string_view option) {
      return words[i].starts_with(std::string(option) + "=");
    };
    if (std::ranges::any_of(options, is_value_in_word)) continue;
    if (std::ranges::find(options, words[i]) != options.end()) {
      ++i;
    } else {
      left.push_back(words[i]);
    }
  }
  return left;
}

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,:=+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char each : word) quoted += each == '\'' ? std::string("'\\''") : std::string(1, each);
  return quoted + "'";
}

std::string batch_jobs(BatchSystem system, const BatchSeeding& seeding) {
  return system == BatchSystem::kubernetes ? kubernetes_jobs(seeding) : slurm_script(seeding);
}

}  // namespace trapeze
