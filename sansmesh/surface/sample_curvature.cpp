#include "sansmesh/surface/sample_curvature.h"

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMixed = 24;  // number of samples around a point
constexpr float kOnSheet = 0.3f;    // least cosine between normals of one sheet

}  // namespace

SampleCurvature::SampleCurvature(const PointSet& points, const LocalFrame& frame, const CurvatureOptions& options,
                                 Progress& progress)
    : SampleCurvature(points, estimate_curvatures(points, options, progress), frame) {}

SampleCurvature::SampleCurvature(const PointSet& points, std::span<const FittedCurvatures> curvatures,
                                 const LocalFrame& frame)
    : frame_(frame) {
  if (curvatures.size() != points.size() || points.normals.size() != points.size())
    throw ArgumentError("SampleCurvature: as many curvatures and normals as points are needed");
  frame_.origin = frame.to_input(points.origin);
  tree_ = KdTree(points.positions);
  normals_ = points.normals;
  tensors_.resize(curvatures.size());
  parallel_for(0, curvatures.size(), 4096, [&](std::size_t i) {
    const FittedCurvatures& c = curvatures[i];
    if (!c.defined) {
      normals_[i] = {};
      return;
    }
    const Vec3f &a = c.direction1, &b = c.direction2;
    tensors_[i] = {c.k1 * a.x * a.x + c.k2 * b.x * b.x, c.k1 * a.y * a.y + c.k2 * b.y * b.y,
                   c.k1 * a.z * a.z + c.k2 * b.z * b.z, c.k1 * a.x * a.y + c.k2 * b.x * b.y,
                   c.k1 * a.x * a.z + c.k2 * b.x * b.z, c.k1 * a.y * a.z + c.k2 * b.y * b.z};
  });
}

void SampleCurvature::evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                               std::span<PrincipalCurvatures> curvatures) const {
  if (x.size() != normals.size() || x.size() != curvatures.size())
    throw ArgumentError("SampleCurvature::evaluate: as many normals and results as points are needed");
  parallel_ranges(0, x.size(), 1024, [&](std::size_t first, std::size_t last) {
    std::array<Neighbour, kMixed> near;
    for (std::size_t i = first; i < last; ++i) {
      curvatures[i] = {};
      const std::size_t n = tree_.nearest(Vec3f(frame_.from_input(x[i])), near);
      if (n == 0) continue;
      // The outward side of the samples' normals may differ from the visible side.
      float side = 0;
      for (std::size_t j = 0; j < n && side == 0; ++j) {
        const float along = dot(normals_[near[j].index], normals[i]);
        side = along > 0 ? 1.0f : along < 0 ? -1.0f : 0.0f;
      }
      const float reach = near[n - 1].squared_distance * 1.0001f + 1e-37f;
      std::array<float, 6> sum{};
      float total = 0;
      for (std::size_t j = 0; j < n; ++j) {
        const std::uint32_t k = near[j].index;
        const float likeness = side * dot(normals_[k], normals[i]) - kOnSheet;
        if (!(likeness > 0)) continue;
        const float t = 1 - near[j].squared_distance / reach, w = likeness * t * t + 1e-9f;
        for (std::size_t m = 0; m < 6; ++m) sum[m] += w * tensors_[k][m];
        total += w;
      }
      if (!(total > 0)) continue;
      const float scale = side / (total * static_cast<float>(frame_.unit));
      Vec3f a, b;
      tangent_frame(normals[i], a, b);
      const auto form = [&](const Vec3f& u, const Vec3f& v) {
        return scale *
               (sum[0] * u.x * v.x + sum[1] * u.y * v.y + sum[2] * u.z * v.z + sum[3] * (u.x * v.y + u.y * v.x) +
                sum[4] * (u.x * v.z + u.z * v.x) + sum[5] * (u.y * v.z + u.z * v.y));
      };
      curvatures[i] = principal_curvatures_of(form(a, a), form(a, b), form(b, b), a, b);
    }
  });
}

}  // namespace sansmesh::inline v1
