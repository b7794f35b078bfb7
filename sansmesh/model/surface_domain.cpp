#include "sansmesh/model/surface_domain.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/function/function_domain.h"
#include "sansmesh/partition/far/global_sign.h"

namespace sansmesh::inline v1 {
namespace {

/// Fewest samples of a border: the narrowest hole that Coverage leaves open has 1.5 times as many around it.
constexpr std::size_t kLeastBorder = 12;
/// Samples of a border are neighbours within this fraction of their reach.
constexpr float kNextBorder = 1;
/// A point is next to a border unless other samples are nearer by this factor.
constexpr double kNextTo = 1.5;
/// Distance beyond a border at which the surface has ended, in reaches, and the number of Newton steps back to it.
constexpr double kBeyondBorder = 0.45;
constexpr int kSteps = 3;
/// Number of samples at which the winding number is evaluated, at most, and depths behind them in spacings.
constexpr std::size_t kTestedFeet = 4096;
constexpr std::array<double, 3> kDepths{1, 2, 4};
/// Mean winding number behind a surface above which it bounds a solid.
constexpr double kSolid = 0.75;
/// The same if all holes will be closed: it is 0.87 behind half a sphere.
constexpr double kWholeSolid = 0.9;
/// Diagonal of the widest hole of a solid that is closed, in spacings.
constexpr double kHole = 12;
/// Elsewhere the surface ends at this distance from all samples, in spacings.
constexpr double kFar = 4;
constexpr double kCovered = -0.42;  ///< level for points as deep inside as among samples on all sides

std::vector<Vec3f> positions_of(const std::vector<Coverage::Border>& borders) {
  std::vector<Vec3f> x;
  x.reserve(borders.size());
  for (const Coverage::Border& b : borders) x.push_back(b.position);
  return x;
}

/// Whether the surface bounds a solid: the winding number behind it is about 1, behind open sheets at most ½. Evaluated
/// at some samples only; the depth with the largest mean counts, for thin walls.
bool bounds_solid(const PointSet& feet, double spacing, double least) {
  std::vector<OrientedPatch> patches;
  std::vector<Vec3f> behind, before;
  const std::size_t stride = 1 + feet.size() / kTestedFeet;
  const auto area = static_cast<float>(spacing * spacing);
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Vec3f &x = feet.positions[i], &n = feet.normals[i];
    patches.push_back({x, n * area});
    if (i % stride != 0) continue;
    for (const double depth : kDepths) {
      const Vec3f way = n * static_cast<float>(depth * spacing);
      behind.push_back(x - way), before.push_back(x + way);
    }
  }
  const GlobalSign sign(patches);
  std::vector<float> w(behind.size()), outside(before.size());
  sign.winding_number(behind, w);
  sign.winding_number(before, outside);
  double sum = 0, jump = 0;
  for (std::size_t i = 0; i < w.size(); i += kDepths.size()) {
    std::size_t most = i;
    for (std::size_t k = i; k < i + kDepths.size(); ++k)
      if (w[k] > w[most]) most = k;
    sum += static_cast<double>(w[most]), jump += static_cast<double>(w[most] - outside[most]);
  }
  return jump > 0 && sum >= least * jump;
}

/// Removes borders that are too short. `hole`: widest hole that is closed.
std::vector<Coverage::Border> long_borders(std::vector<Coverage::Border> borders, double hole) {
  const KdTree tree(positions_of(borders));
  UnionFind sets(borders.size());
  std::vector<Neighbour> near;
  for (std::uint32_t i = 0; i < borders.size(); ++i) {
    tree.within(borders[i].position, kNextBorder * borders[i].reach, near);
    for (const Neighbour& n : near) sets.join(i, n.index);
  }
  std::vector<std::size_t> count(borders.size(), 0);
  std::vector<Box3f> box(borders.size());
  for (std::uint32_t i = 0; i < borders.size(); ++i) {
    const std::uint32_t set = sets.find(i);
    ++count[set];
    box[set].extend(borders[i].position);
  }
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < borders.size(); ++i) {
    const std::uint32_t set = sets.find(i);
    if (count[set] >= kLeastBorder && static_cast<double>(norm(box[set].size())) > hole) borders[kept++] = borders[i];
  }
  borders.resize(kept);
  return borders;
}

/// Removes borders at edges and tips, beyond which the surface continues around the corner: from outside the samples,
/// descent to the surface leads back to them.
std::vector<Coverage::Border> at_ends(const ScalarField& field, const Coverage& coverage, const KdTree& samples,
                                      const PointSet& feet, std::vector<Coverage::Border> borders) {
  std::vector<Vec3> x(borders.size()), g(x.size());
  std::vector<double> values(x.size());
  parallel_for(0, x.size(), 256, [&](std::size_t i) {
    const Coverage::Border& b = borders[i];
    const auto found = samples.nearest(b.position);
    const Vec3 n(found ? feet.normals[found->index] : Vec3f{}), in(b.inward);
    x[i] = Vec3(b.position) - normalized(in - n * dot(in, n)) * (kBeyondBorder * static_cast<double>(b.reach));
  });
  for (int step = 0; step < kSteps; ++step) {
    field.evaluate(x, values, g);
    parallel_for(0, x.size(), 1024, [&](std::size_t i) {
      const double slope = norm(g[i]), most = kBeyondBorder * static_cast<double>(borders[i].reach);
      if (slope > 0) x[i] -= g[i] * (std::clamp(values[i] / slope, -most, most) / slope);
    });
  }
  coverage.evaluate(x, values);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < borders.size(); ++i)
    if (values[i] > 0) borders[kept++] = borders[i];
  borders.resize(kept);
  return borders;
}

}  // namespace

SurfaceDomain::SurfaceDomain(const ScalarField& field, const PointSet& feet, double spacing, std::optional<double> fill,
                             std::optional<double> trim, std::optional<bool> solid, bool whole)
    : coverage_(feet.positions, spacing, fill), samples_(feet.positions), borders_(coverage_.borders()), trim_(trim) {
  if (solid == false) return;
  std::vector<Coverage::Border> ends = long_borders(at_ends(field, coverage_, samples_, feet, borders_), 0);
  if (!solid && !ends.empty() && !bounds_solid(feet, spacing, whole ? kWholeSolid : kSolid)) return;
  if (whole) {
    far_ = std::numeric_limits<double>::infinity();
    borders_.clear();
    return;
  }
  far_ = kFar * spacing;
  borders_ = long_borders(std::move(ends), kHole * spacing);
  border_samples_ = KdTree(positions_of(borders_));
}

bool SurfaceDomain::stays(const Vec3f& x) const {
  const double distance = samples_.distance(x);
  return distance < far_ && border_samples_.distance(x) > kNextTo * distance;
}

void SurfaceDomain::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  coverage_.evaluate(x, values, gradients);
  parallel_for(0, x.size(), 1024, [&](std::size_t i) {
    const Vec3f p(x[i]);
    if (values[i] > 0 && far_ > 0 && stays(p)) values[i] = kCovered;
    if (trim_) values[i] = std::max(values[i], samples_.distance(p) / *trim_ - 1);
  });
}

void SurfaceDomain::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  coverage_.ranges(x, radius, found);
  parallel_for(0, x.size(), 1024, [&](std::size_t i) {
    const double nearest = samples_.distance(Vec3f(x[i])) - radius;
    if (found[i].least > 0 && nearest < far_) found[i] = {-kInfinity, kInfinity};
    if (trim_ && nearest > *trim_) found[i] = {1e-9, kInfinity};
  });
}

void SurfaceDomain::refine(BlockTree& blocks, int deepest) const { refine_along(borders_, blocks, deepest); }

}  // namespace sansmesh::inline v1
