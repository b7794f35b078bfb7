#include "sansmesh/surface/candidates.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kCompactSupport = 2, kGaussianSupport = 3.4641;  // radius of the supports over h
/// Validity of the formulas over the width of the weights (distance from the surface): the generating functions of
/// orders 4 and 6 change their signs again at 1.22 and 0.96 widths from a plane, the extremal energy at 0.8.
constexpr double kSlab = 0.75;
/// Size of the boxes of groups over the median spacing: smaller ones waste lanes, larger ones waste samples.
constexpr double kGroupExtent = 3.2;
/// Above this cosine to the mean normal any two normals differ by less than 90°.
constexpr float kAgree = 0.7072f;
constexpr std::size_t kBatch = 4096;  // number of points that are sorted together

}  // namespace

std::vector<float> weight_widths(const SurfaceSamples& samples, double smoothing, const std::optional<double>& width,
                                 SurfaceWeights weights) {
  if (weights == SurfaceWeights::gaussian && !width)
    return weight_widths(samples, smoothing, smoothing * samples.median_spacing);
  std::vector<float> widths = samples.spacing;
  for (float& w : widths) w = width ? static_cast<float>(*width) : w * static_cast<float>(smoothing);
  return widths;
}

void check_width(const SurfaceSamples& samples, double width) {
  const double largest = static_cast<double>(*std::max_element(samples.spacing.begin(), samples.spacing.end()));
  if (width > 20 * largest)
    throw ArgumentError("`bandwidth` is " + std::to_string(width / samples.median_spacing) +
                        " times the spacing of the samples: at most 20 times the largest spacing is allowed");
}

Candidates::Candidates(const SurfaceSamples& samples, const std::vector<float>& widths, SurfaceWeights weights,
                       double reach)
    : candidates_(samples.size()), extent_(kGroupExtent * samples.median_spacing) {
  const bool gaussian = weights == SurfaceWeights::gaussian;
  std::vector<float> radii(samples.size());
  Box3f box;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Candidate& c = candidates_[i];
    const Vec3f &p = samples.positions[i], &n = samples.normals[i];
    const float h = widths[i], s = samples.spacing[i];
    radii[i] = h * static_cast<float>(gaussian ? kGaussianSupport : kCompactSupport);
    const float ball = std::min(s * static_cast<float>(reach), radii[i]);
    const float height = h * static_cast<float>(kSlab);
    const float share = s / static_cast<float>(samples.median_spacing);
    c = {};
    c.x = p.x, c.y = p.y, c.z = p.z;
    c.inverse_support = gaussian ? 1 / (h * h) : 1 / (radii[i] * radii[i]);
    c.nx = n.x, c.ny = n.y, c.nz = n.z;
    c.weight = share * share;
    c.inverse_reach = 1 / (ball * ball);
    c.inverse_height = 1 / (height * height);
    box.extend(p - Vec3f{ball, ball, ball});
    box.extend(p + Vec3f{ball, ball, ball});
  }
  supports_ = BallTree(samples.positions, radii);
  bounds_ = {Vec3(box.lower), Vec3(box.upper)};
}

void Candidates::equalize_areas() {
  for (Candidate& c : candidates_) c.weight = 1;
}

std::vector<float> Candidates::reach() const {
  std::vector<float> radii(candidates_.size());
  for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = 1 / std::sqrt(candidates_[i].inverse_reach);
  return radii;
}

bool Candidates::gather(const PointGroup& group, const Box3f& box, std::vector<Candidate>& chosen) const {
  thread_local std::vector<std::uint32_t> near;
  supports_.touching(box, near);
  chosen.resize(near.size());
  const Vec3f& o = group.center;
  Vec3f mean;
  for (std::size_t k = 0; k < near.size(); ++k) {
    Candidate& c = chosen[k];
    c = candidates_[near[k]];
    c.x -= o.x, c.y -= o.y, c.z -= o.z;
    c.plane = c.x * c.nx + c.y * c.ny + c.z * c.nz;
    c.square = c.x * c.x + c.y * c.y + c.z * c.z;
    c.plane_m += c.x * c.mx + c.y * c.my + c.z * c.mz;
    mean.x += c.nx, mean.y += c.ny, mean.z += c.nz;
  }
  const float limit = kAgree * norm(mean);
  for (const Candidate& c : chosen)
    if (!(c.nx * mean.x + c.ny * mean.y + c.nz * mean.z > limit)) return true;  // also if the mean vanishes
  return false;
}

void Candidates::for_each_group(std::span<const Vec3> x, const Visit& visit) const {
  // Batches of lattice points have millions of points; those of rays have hundreds, and come from separate threads.
  const std::size_t batches = (x.size() + kBatch - 1) / kBatch;
  parallel_for(0, batches, 1, [&](std::size_t b) {
    thread_local std::vector<Candidate> of_thread;
    std::vector<Candidate> chosen;
    chosen.swap(of_thread);  // `visit` may evaluate another surface
    const std::size_t first = b * kBatch;
    detail::for_each_group(x.subspan(first, std::min(kBatch, x.size() - first)), extent_,
                           [&](PointGroup& group, const Box3f& box) {
                             for (std::uint32_t& slot : group.slot) slot += static_cast<std::uint32_t>(first);
                             const bool mixed = gather(group, box, chosen);
                             visit(group, chosen, mixed);
                           });
    chosen.swap(of_thread);
  });
}

}  // namespace sansmesh::inline v1::detail
