#include "sansmesh/surface/sample_colors.h"

#include <array>

#include "sansmesh/core/error.h"

namespace sansmesh {

SampleColors::SampleColors(const PointSet& points) : tree_(points.positions), colors_(points.colors) {
  if (!points.has_colors()) throw DataError("the samples have no colours");
}

void SampleColors::evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::array<Neighbour, 4> found;
    const std::size_t count = tree_.nearest(Vec3f(x[i]), found);
    Vec3f sum;
    float weight = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const float w = 1 / (found[k].squared_distance + 1e-12f * found[count - 1].squared_distance + 1e-30f);
      const auto& c = colors_[found[k].index];
      sum += Vec3f{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])} * w;
      weight += w;
    }
    colors[i] = weight > 0 ? sum / (255 * weight) : Vec3f{1, 1, 1};
  }
}

}  // namespace sansmesh
