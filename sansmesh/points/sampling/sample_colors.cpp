#include "sansmesh/points/sampling/sample_colors.h"

#include <array>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

Vec3 mean_color(const KdTree& samples, std::span<const std::array<std::uint8_t, 3>> colors, const Vec3f& x) {
  std::array<Neighbour, 4> found;
  const std::size_t count = samples.nearest(x, found);
  double sum[3] = {}, weight = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double w = 1 / (static_cast<double>(found[k].squared_distance) +
                          1e-12 * static_cast<double>(found[count - 1].squared_distance) + 1e-30);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += w * colors[found[k].index][c];
    weight += w;
  }
  if (!(weight > 0)) return {255, 255, 255};
  return {sum[0] / weight, sum[1] / weight, sum[2] / weight};
}

SampleColors::SampleColors(const PointSet& points) : tree_(points.positions), colors_(points.colors) {
  if (!points.has_colors()) throw DataError("the samples have no colours");
}

void SampleColors::evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const {
  parallel_for(0, x.size(), 1024,
               [&](std::size_t i) { colors[i] = Vec3f(mean_color(tree_, colors_, Vec3f(x[i])) / 255.0); });
}

}  // namespace sansmesh::inline v1
