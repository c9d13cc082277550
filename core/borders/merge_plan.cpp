#include "core/borders/merge_plan.h"

#include <algorithm>

namespace trapeze {

Box widened_for_blocks(const Box& box) {
  constexpr auto kHalf = static_cast<std::int32_t>(kWidestBridge / 2) + 1;
  if (box.is_empty()) return box;
  return {
      std::max(box.min_x, kGridMin + kHalf) - kHalf, std::max(box.min_y, kGridMin + kHalf) - kHalf,
      std::min(box.max_x, kGridMax - kHalf) + kHalf, std::min(box.max_y, kGridMax - kHalf) + kHalf};
}

std::vector<std::uint32_t> classes_of_faces(const FaceFeatures& faces, const Merging& merging) {
  std::vector<std::uint32_t> classes(faces.face_count() + 1, 0);
  classes[kOutside] = kMixedClass;
  if (merging.classes.empty()) return classes;
  for (FaceId face = 1; face < classes.size(); ++face) {
    const auto features = faces.of(face);
    const std::uint32_t first = merging.classes[features.front()];
    const bool are_equal = std::ranges::all_of(
        features, [&](std::uint32_t feature) { return merging.classes[feature] == first; });
    classes[face] = are_equal ? first : kMixedClass;
  }
  return classes;
}

bool MergePlan::are_of_one_class(FaceId a, FaceId b) const {
  return classes[a - 1] == classes[b - 1] && classes[a - 1] != kMixedClass;
}

}  // namespace trapeze
