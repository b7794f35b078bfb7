// Construction of the evaluation structures of a partition of unity, and its queries for polygonisation.
#include "sansmesh/partition/partition_of_unity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/far/support_patches.h"
#include "sansmesh/partition/partition_evaluate.h"
#include "sansmesh/partition/partition_range.h"
#include "sansmesh/partition/partition_state.h"

namespace sansmesh::inline v1 {

namespace {

constexpr float kSteep = 2.0f;

/// Noise below this share of a support's radius is negligible.
constexpr double kClean = 0.05;

/// Rounding of 1 − d²/R² may leave a support some weight this little beyond its radius.
constexpr float kRim = 1 + 1e-6f;

/// Whether the function's slope against its plane exceeds kSteep at a point of its support.
bool is_steep(const LocalFunction& f) {
  for (const float ring : {0.5f, 0.9f})
    for (int k = 0; k < 8; ++k) {
      const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 4, r = ring * f.radius / f.scale;
      const HeightGradient g = height_gradient(f, r * std::cos(angle), r * std::sin(angle));
      if (g.u * g.u + g.v * g.v > kSteep * kSteep) return true;
    }
  return false;
}

}  // namespace

PartitionOfUnity::PartitionOfUnity(PartitionData data) {
  const auto state = std::make_shared<PartitionState>();
  state->data = std::move(data);
  if (state->data.slopes.size() != state->data.functions.size()) state->data.find_slopes();
  const PartitionData& d = state->data;
  std::vector<Vec3f> centers(d.supports.size());
  std::vector<float> radii(d.supports.size());
  for (std::size_t i = 0; i < d.supports.size(); ++i) {
    centers[i] = d.functions[i].center;
    radii[i] = d.functions[i].radius * kRim;
  }
  state->tree = BallTree(centers, radii);
  std::size_t creased = 0;
  for (std::size_t i = 0; i < d.supports.size(); ++i)
    if (d.supports[i].creased) centers[creased] = centers[i], radii[creased++] = radii[i];
  state->creased = BallTree(std::span(centers).first(creased), std::span(radii).first(creased));
  state->manner.resize(d.functions.size());
  parallel_for(0, state->manner.size(), 8192, [&](std::size_t i) {
    const LocalFunction& f = d.functions[i];
    if (d.paper) {
      state->manner[i] = kPlain;
      return;
    }
    const bool steep = d.slopes[i] > kSteep && is_steep(f),
               clean = d.report.noise < kClean * static_cast<double>(f.radius);
    state->manner[i] = static_cast<std::uint8_t>((steep ? kNormalised : 0) | (steep || clean ? kClose : 0));
  });
  if (d.paper) {
    const auto corner = static_cast<float>(1 - 1 / (d.paper->support * d.paper->support));
    state->full = kPlainShare * corner * corner * corner * corner;
  }
  // Each support's surface patch within its block: together they tile the surface, and determine inside and outside
  // beyond all supports.
  std::vector<OrientedPatch> closed = support_patches(d), open;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    if (d.supports[i].open) {
      open.push_back(closed[i]);
    } else {
      closed[kept++] = closed[i];
    }
  }
  closed.resize(kept);
  state->far = {GlobalSign(closed, d.edge), GlobalSign(open, d.edge, true)};
  state_ = state;
}

Box3 PartitionOfUnity::bounds() const {
  const Vec3 lower = state_->data.origin + Vec3(state_->data.lower);
  const double e = state_->data.edge;
  return {lower, lower + Vec3{e, e, e}};
}
const PartitionData& PartitionOfUnity::data() const { return state_->data; }

void PartitionOfUnity::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  evaluate_partition(*state_, x, values, gradients);
}
void PartitionOfUnity::evaluate_signs(std::span<const Vec3> x, std::span<double> values,
                                      std::span<std::uint8_t> sized) const {
  evaluate_partition(*state_, x, values, {}, sized);
}
void PartitionOfUnity::find_creases(std::span<const Vec3> x, std::span<std::uint8_t> near) const {
  parallel_ranges(0, x.size(), 1024, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> found;
    for (std::size_t i = first; i < last; ++i) {
      const Vec3f p(x[i] - state_->data.origin);
      near[i] = !state_->creased.touching({p, p}, 0, found);
    }
  });
}
void PartitionOfUnity::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  partition_ranges(*state_, x, radius, found);
}

std::vector<Vec3> PartitionOfUnity::seeds() const {
  const PartitionData& d = state_->data;
  std::vector<Vec3> result;
  result.reserve(d.supports.size());
  for (const Support& s : d.supports)
    if (!d.paper || s.area > 0) result.push_back(d.origin + Vec3(s.foot));
  return result;
}

BlockTree PartitionOfUnity::mesh_blocks(double mesh_error, int deepest) const {
  const PartitionData& s = state_->data;
  BlockTree tree(s.origin + Vec3(s.lower), s.edge);
  struct Item {
    std::size_t block;
    int level;
    std::uint32_t cell;  // index in flatness[level]
  };
  const int last = static_cast<int>(s.flatness.size()) - 1;
  std::vector<Item> stack{{0, 0, 0}};
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const PartitionData::Flatness& here = s.flatness[static_cast<std::size_t>(item.level)];
    if (here.gap[item.cell] <= mesh_error || item.level >= deepest) continue;
    const std::size_t first = tree.subdivide(item.block);
    if (item.level == last) continue;  // the samples do not resolve finer scales
    const PartitionData::Flatness& below = s.flatness[static_cast<std::size_t>(item.level) + 1];
    for (std::uint32_t c = here.child[item.cell]; c < here.child[item.cell + 1]; ++c)
      stack.push_back({first + (below.code[c] & 7), item.level + 1, c});
  }
  return tree;
}

}  // namespace sansmesh::inline v1
