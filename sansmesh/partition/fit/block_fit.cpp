#include "sansmesh/partition/fit/block_fit.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

/// Slopes of the first plane against the mean normal for which the frame is rotated. Below, the weights and residuals
/// change by at most a hundredth; above, the plane is not that of the samples that face the mean normal.
constexpr float kLeastSlope = 0.1f, kMostSlope = 2.0f;

/// Projects the samples of the ball around `middle` that face the same way as f.nu into f's frame. Returns the share of
/// the weight that faces away.
float project(const Vec3f& middle, Workspace& ws, const LocalFunction& f, float height) {
  const float stretch = height > f.scale ? f.scale * f.scale / (height * height) - 1 : 0;
  ws.view = project_ball(ws.ball, {middle, f.scale, stretch, f.xi, f.eta, f.nu}, ws.samples);
  const float all = ws.view.kept + ws.view.away;
  return all > 0 ? ws.view.away / all : 0;
}

}  // namespace

void set_normal(LocalFunction& f, const Vec3f& nu) {
  f.nu = nu;
  tangent_frame(f.nu, f.xi, f.eta);
}

double coverage(const BallView& view) {
  return std::max(0.0f, view.upper[0] - view.lower[0]) * std::max(0.0f, view.upper[1] - view.lower[1]) / 3.14159265;
}

void gather(const SampleTree& tree, int level, const SampleTree::Neighbours& cells, const Vec3f& c, float radius,
            GatheredSamples& ball, std::size_t stride) {
  const auto& begin = tree.level(level).begin;
  std::array<SampleRange, 27> ranges;
  std::size_t n = 0;
  for (const std::int32_t cell : cells) {
    if (cell < 0) continue;
    const auto k = static_cast<std::size_t>(cell);
    // Cells that follow each other on the Morton curve make one range, in larger vectors; a stride starts in each cell.
    if (n > 0 && stride == 1 && ranges[n - 1].last == begin[k]) {
      ranges[n - 1].last = begin[k + 1];
    } else {
      ranges[n++] = {begin[k], begin[k + 1]};
    }
  }
  ball.gather(tree.positions(), tree.normals(), std::span(ranges).first(n), c, radius, stride);
}

float gather_enough(const BlockFitter& fitter, int level, std::uint32_t cell, const SampleTree::Neighbours& own,
                    const SampleTree::Neighbours& parents, GatheredSamples& ball) {
  const Vec3f c = fitter.center(level, cell);
  const float radius = fitter.fit_radius(level);
  const auto enough = [&](float r) { return ball.count(r) >= static_cast<std::size_t>(fitter.options.min_samples); };
  if (fitter.height <= radius || level == 0) {
    gather(fitter.tree, level, own, c, kShift * radius, ball);
  } else {
    gather(fitter.tree, level - 1, parents, c, kShift * fitter.height, ball);
  }
  if (enough(radius) || level == 0) return 1;
  for (const float reach : kReaches) {
    gather(fitter.tree, level - 1, parents, c, kShift * std::max(reach * radius, fitter.height), ball);
    if (enough(reach * radius)) return reach;
  }
  return 0;
}

DegreeFits fit_local(float scale, int max_degree, Workspace& ws, LocalFunction& f, float* dropped, float height) {
  const BallSums sums = sum_ball(ws.ball, scale);
  Vec3f normal = normalized(sums.normal);
  if (normal == Vec3f{}) normal = {0, 0, 1};
  set_normal(f, normal);
  f.center = ws.ball.center();
  f.scale = scale;
  const Vec3f middle = sums.weight > 0 ? normal * (dot(sums.offset, normal) / sums.weight) : Vec3f{};
  float away = project(middle, ws, f, height);
  DegreeFits fits = fit_all_degrees(ws.samples, max_degree);
  if (fits.highest >= 1) {
    const auto plane = monomial_coefficients(fits, 1);
    const float slope = std::hypot(plane[1], plane[2]);
    if (slope > kLeastSlope && slope < kMostSlope) {
      set_normal(f, normalized(f.nu - f.xi * plane[1] - f.eta * plane[2]));
      away = project(f.nu * (plane[0] * scale / std::sqrt(1 + slope * slope)), ws, f, height);
      fits = fit_all_degrees(ws.samples, max_degree);
    }
  }
  if (dropped) *dropped = away;
  return fits;
}

int highest_degree(const PartitionOptions& options, const DegreeFits& fits, const BallView& view) {
  int d = fits.highest;
  // 0 in the interior of a surface, 0.28 at a straight border (with the weights (1 − t²)²).
  if (d > 1 && view.eccentricity > options.max_eccentricity) return 1;
  const double k = coverage(view);
  while (d > 1 && k < options.coverage[static_cast<std::size_t>(d)]) --d;
  return d;
}

std::size_t ball_samples(const SampleTree& tree, const LocalFunction& f, std::span<const std::uint32_t> ids,
                         std::vector<Vec3f>& position, std::vector<Vec3f>& normal, std::vector<float>& weight) {
  position.clear(), normal.clear(), weight.clear();
  const float inverse = 1 / (f.scale * f.scale);
  const auto add = [&](bool inside) {
    for (const std::uint32_t i : ids) {
      const float t = squared_norm(tree.positions()[i] - f.center) * inverse;
      if ((t < 1) != inside) continue;
      position.push_back(tree.positions()[i]);
      normal.push_back(tree.normals()[i]);
      weight.push_back(inside ? smooth_weight(t) : 0);
    }
  };
  add(true);
  const std::size_t inner = position.size();
  add(false);
  return inner;
}

}  // namespace sansmesh::inline v1
