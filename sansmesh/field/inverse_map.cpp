#include "sansmesh/field/inverse_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kInverseTolerance = 1e-10;  // relative to the targets' box
constexpr double kRounding = 1e-14;          // relative to their coordinates
constexpr double kSingular = 1e-9;           // determinant relative to the product of the column lengths
constexpr double kShortestStep = 1e-3;       // shorter Newton steps do not converge

struct Target {
  std::uint32_t index;
  Vec3 at;           // best position so far
  double distance;   // distance of its image from the target
  Vec3 step;         // Newton step from there
  double share = 1;  // fraction of the step in the current trial
};

/// Step towards the target: Newton's, or steepest descent if the Jacobian is singular.
Vec3 step_of(const Jacobian& j, const Vec3& residual) {
  const Matrix3 m{j[0], j[1], j[2]};
  const double scale = norm(j[0]) * norm(j[1]) * norm(j[2]);
  if (std::abs(m.determinant()) > kSingular * scale) return m.solve(residual);
  const Vec3 down{dot(j[0], residual), dot(j[1], residual), dot(j[2], residual)};
  const Vec3 change = j[0] * down.x + j[1] * down.y + j[2] * down.z;
  const double length = squared_norm(change);
  return length > 0 ? down * (squared_norm(down) / length) : Vec3{};
}

}  // namespace

InvertedPoints inverse_map(const SpaceMap& map, std::span<const Vec3> targets, std::span<const Vec3> starts,
                           const InverseOptions& options) {
  if (targets.size() != starts.size())
    throw ArgumentError("an inverse map needs a start for each target: " + std::to_string(targets.size()) +
                        " targets, " + std::to_string(starts.size()) + " starts");
  double tolerance = options.tolerance;
  if (!(tolerance > 0)) {
    Box3 box;
    double largest = 0;
    for (const Vec3& u : targets)
      if (is_finite(u)) box.extend(u), largest = std::max({largest, std::abs(u.x), std::abs(u.y), std::abs(u.z)});
    tolerance = std::max(kInverseTolerance * box.diagonal(), kRounding * largest);
    if (tolerance == 0) tolerance = std::numeric_limits<double>::min();
  }
  InvertedPoints inverse{{starts.begin(), starts.end()}, std::vector<std::uint8_t>(targets.size()), 0};
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  std::vector<Target> open;
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (is_finite(targets[i]) && is_finite(starts[i]))
      open.push_back({static_cast<std::uint32_t>(i), starts[i], kUnknown, {}, 1});
  std::vector<Vec3> x, image;
  std::vector<Jacobian> jacobian;
  for (int step = 0; step <= options.most_steps && !open.empty(); ++step) {
    x.clear();
    for (const Target& t : open) x.push_back(t.at + t.step * t.share);
    image.resize(x.size()), jacobian.resize(x.size());
    map.map(x, {image, jacobian, {}, {}});
    std::size_t kept = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      Target t = open[k];
      const Vec3 residual = targets[t.index] - image[k];
      const double distance = is_finite(residual) ? norm(residual) : kUnknown;
      if (distance < t.distance) {
        t.at = x[k], t.distance = distance;
        inverse.positions[t.index] = t.at;
        if (distance <= tolerance) {
          inverse.found[t.index] = 1;
          continue;
        }
        t.step = step_of(jacobian[k], residual), t.share = 1;
        if (!is_finite(t.step) || squared_norm(t.step) == 0) continue;
      } else {
        t.share *= 0.5;
        if (t.share < kShortestStep || t.distance == kUnknown) continue;
      }
      open[kept++] = t;
    }
    open.resize(kept);
  }
  inverse.missed = static_cast<std::size_t>(std::count(inverse.found.begin(), inverse.found.end(), 0));
  return inverse;
}

void InverseMap::map(std::span<const Vec3> x, const MappedPoints& wanted) const {
  std::vector<Vec3> starts(x.begin(), x.end());
  if (starts_) {
    starts_->map(x, {starts, {}, {}, {}});
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!is_finite(starts[i])) starts[i] = x[i];
  }
  // A fixed tolerance: the default would depend on the batch.
  const InvertedPoints found = inverse_map(*map_, x, starts, {tolerance_});
  std::vector<Vec3> positions(x.size());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < x.size(); ++i)
    positions[i] = found.found[i] ? found.positions[i] : Vec3{kNone, kNone, kNone};
  if (!wanted.positions.empty()) std::copy(positions.begin(), positions.end(), wanted.positions.begin());
  if (!wanted.jacobians.empty()) {
    std::vector<Jacobian> j(x.size());
    map_->map(found.positions, {{}, j, {}, {}});
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Matrix3 m{j[i][0], j[i][1], j[i][2]};
      wanted.jacobians[i] = {m.solve({1, 0, 0}), m.solve({0, 1, 0}), m.solve({0, 0, 1})};
    }
  }
  std::fill_n(wanted.gaps.begin(), wanted.gaps.size(), -std::numeric_limits<double>::infinity());
  std::fill_n(wanted.gap_gradients.begin(), wanted.gap_gradients.size(), Vec3{});
}

}  // namespace sansmesh::inline v1
