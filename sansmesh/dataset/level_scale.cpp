#include "sansmesh/dataset/level_scale.h"

#include <limits>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/field/level_field.h"

namespace sansmesh::inline v1 {

void evaluate_level(const VolumeField& field, double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) {
  const auto* const levels = dynamic_cast<const LevelField*>(&field);
  levels ? levels->evaluate_level(level, x, wanted) : field.evaluate(x, wanted);
}

std::vector<double> slopes_at(const VolumeField& field, double level, std::span<const Vec3> points,
                              const LocalFrame& frame, std::size_t most) {
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / most) some.push_back(frame.to_input(points[i]));
  std::vector<Vec3> gradients(some.size());
  evaluate_level(field, level, some, {{}, gradients});
  std::vector<double> slopes;
  for (const Vec3& g : gradients)
    if (const double slope = safe_norm(g); slope > 0) slopes.push_back(slope);
  return slopes;
}

ValueRange level_range(const ValueRange& values, double value, double slope) {
  if (values.least > values.most) return {1e-9, std::numeric_limits<double>::infinity()};
  return {(value - values.most) / slope, (value - values.least) / slope};
}

}  // namespace sansmesh::inline v1
