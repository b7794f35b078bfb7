#include "sansmesh/surface/curvature_colors.h"

#include <array>
#include <cmath>
#include <limits>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using Quantity = CurvatureQuantity;

constexpr std::size_t kNear = 8;     ///< number of samples that a colour is mixed from
constexpr double kFullColor = 0.95;  ///< quantile of the absolute values with the full colour
constexpr Vec3f kUnknown{0.6f, 0.6f, 0.6f};

}  // namespace

float curvature_quantity(const PrincipalCurvatures& c, Quantity quantity) {
  switch (quantity) {
    case Quantity::mean:
      return mean_curvature(c);
    case Quantity::gaussian:
      return gaussian_curvature(c);
    case Quantity::k1:
      return c.k1;
    case Quantity::k2:
      return c.k2;
  }
  return 0;
}

void CurvatureColorOptions::validate() const {
  if (range && !(*range > 0 && std::isfinite(*range))) throw ArgumentError("`color_range` must be positive");
  curvature.validate();
}

CurvatureColors::CurvatureColors(const PointSet& points, const CurvatureColorOptions& options, Progress& progress)
    : CurvatureColors(points, estimate_curvatures(points, (options.validate(), options.curvature), progress), options) {
}

CurvatureColors::CurvatureColors(const PointSet& points, std::span<const FittedCurvatures> curvatures,
                                 const CurvatureColorOptions& options) {
  options.validate();
  if (curvatures.size() != points.size() || points.normals.size() != points.size())
    throw ArgumentError("CurvatureColors: as many curvatures and normals as points are needed");
  tree_ = KdTree(points.positions);
  normals_ = points.normals;
  values_.resize(curvatures.size());
  parallel_for(0, curvatures.size(), 4096, [&](std::size_t i) {
    values_[i] = curvatures[i].defined ? curvature_quantity(curvatures[i], options.quantity)
                                       : std::numeric_limits<float>::quiet_NaN();
  });
  if (options.range) {
    range_ = *options.range;
    return;
  }
  std::vector<float> sizes;
  for (const float v : values_)
    if (std::isfinite(v)) sizes.push_back(std::abs(v));
  if (sizes.empty()) return;
  range_ = static_cast<double>(quantile(sizes, kFullColor));
}

void CurvatureColors::evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const {
  if (x.size() != colors.size()) throw ArgumentError("CurvatureColors::evaluate: points and colours differ in number");
  parallel_ranges(0, x.size(), 1024, [&](std::size_t first, std::size_t last) {
    std::array<Neighbour, kNear> near;
    for (std::size_t i = first; i < last; ++i) {
      colors[i] = kUnknown;
      const std::size_t n = tree_.nearest(Vec3f(x[i]), near);
      if (n == 0) continue;
      // The weights vanish at the farthest sample, so that the colour is continuous where samples enter and leave.
      const double reach = static_cast<double>(near[n - 1].squared_distance) * 1.0001 + 1e-37;
      double sum = 0, total = 0;
      for (std::size_t j = 0; j < n; ++j) {
        const std::uint32_t index = near[j].index;
        if (!std::isfinite(values_[index]) || dot(normals_[index], normals_[near[0].index]) < 0) continue;
        const double t = 1 - static_cast<double>(near[j].squared_distance) / reach, w = t * t + 1e-9;
        sum += w * static_cast<double>(values_[index]);
        total += w;
      }
      if (total > 0) colors[i] = diverging_color(range_ > 0 ? static_cast<float>(sum / total / range_) : 0.0f);
    }
  });
}

}  // namespace sansmesh::inline v1
