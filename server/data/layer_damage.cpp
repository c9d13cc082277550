#include "server/data/layer_damage.h"

#include "core/io/prepared/prepared_parts.h"

namespace trapeze {
namespace {

std::string damage_by_writing(const std::string& file) {
  return file + ": was truncated or modified while it was served; run `trapeze prepare` again";
}

std::string damage_of_part(const PreparedPart& part) {
  if (!part.is_damaged()) return {};
  std::string problem = part.problem();
  return problem.empty() ? damage_by_writing(part.path()) : problem;
}

}  // namespace

std::string damage_of(const ServedLayer& layer) {
  if (layer.is_whole()) return {};
  if (layer.parts == nullptr) return damage_by_writing(layer.report.path);
  for (const auto& part : layer.parts->parts()) {
    std::string damage = damage_of_part(*part);
    if (!damage.empty()) return damage;
  }
  const auto& overview = layer.parts->overview();
  return overview == nullptr ? std::string() : damage_of_part(*overview);
}

}  // namespace trapeze
