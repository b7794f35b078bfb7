#include "sansmesh/function/function_domain.h"

#include <algorithm>
#include <limits>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/far/support_patches.h"

namespace sansmesh::inline v1 {
namespace {

/// Value next to a closed sheet: as deep inside as a point with samples on all sides.
constexpr double kOnClosed = -0.42;
/// Largest edge of the blocks along a border, in spacings of the samples there, and largest distance of the border from
/// these, in reaches.
constexpr float kBorderBlock = 3.5f, kBorderWidth = 0.6f;
/// Least depth of the deepest blocks of open surfaces.
constexpr int kLeastOpenDepth = 4;
/// Of this many samples at a border one determines whether a block is too large.
constexpr std::size_t kEnough = 256;

std::vector<Vec3f> feet(const PartitionData& data, bool open) {
  std::vector<Vec3f> feet;
  for (const Support& s : data.supports.view())
    if (s.state != Support::constant && (s.open != 0) == open) feet.push_back(s.foot);
  return feet;
}

Coverage coverage_of(const FittedFunction& function, std::optional<double> fill) {
  const PartitionReport& report = function.field.report();
  const PartitionData& data = function.field.data();
  // Holes wider than the cube are unlimited.
  if (fill) fill = std::min(*fill, static_cast<double>(data.edge));
  if (function.samples->size() > 0) return {function.samples->positions, report.spacing, fill};
  // Without samples each support represents the samples of its block.
  std::vector<Vec3f> positions;
  std::vector<float> spacings;
  for (const Support& s : data.supports.view()) {
    if (s.state == Support::constant) continue;
    positions.push_back(s.foot);
    spacings.push_back(data.edge / static_cast<float>(1u << s.level));
  }
  return {positions, spacings, fill};
}

/// Winding number of the closed sheets, if there are open ones, too.
GlobalSign solid_of(const PartitionData& data) {
  std::vector<OrientedPatch> patches = support_patches(data);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (!data.supports[i].open) patches[kept++] = patches[i];
  const bool both = kept > 0 && kept < patches.size();
  patches.resize(kept);
  return both ? GlobalSign(patches, data.edge) : GlobalSign();
}

/// A membrane is where the winding number is between these bounds, far from 0 and 1.
constexpr float kMembrane = 0.25f;

}  // namespace

FunctionDomain::FunctionDomain(const FittedFunction& function, std::optional<double> fill, std::optional<double> trim)
    : coverage_(coverage_of(function, fill)),
      trim_(trim),
      open_(feet(function.field.data(), true)),
      closed_(feet(function.field.data(), false)),
      solid_(solid_of(function.field.data())),
      origin_(function.field.data().origin),
      samples_(trim ? KdTree(function.samples->positions) : KdTree()) {}

bool FunctionDomain::needed(const FittedFunction& function, std::optional<double> trim) {
  const auto supports = function.field.data().supports.view();
  return trim || std::any_of(supports.begin(), supports.end(), [](const Support& s) { return s.open != 0; });
}

void FunctionDomain::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  if (open_.size() > 0) {
    coverage_.evaluate(x, values);
  } else {
    std::fill(values.begin(), values.end(), kOnClosed);
  }
  std::fill(gradients.begin(), gradients.end(), Vec3{});
  parallel_ranges(0, x.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3f p(x[i]);
      if (values[i] > 0 && !solid_.empty() && closed_.distance(p) <= open_.distance(p)) {
        float w = 0;
        solid_.winding_number({&p, 1}, {&w, 1});
        if (w > kMembrane && w < 1 - kMembrane) values[i] = kOnClosed;
      }
      if (trim_) values[i] = std::max(values[i], samples_.distance(p) / *trim_ - 1);
    }
  });
}

void FunctionDomain::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (open_.size() > 0) {
    coverage_.ranges(x, radius, found);
  } else {
    std::fill(found.begin(), found.end(), ValueRange{-kInfinity, kInfinity});
  }
  parallel_ranges(0, x.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3f p(x[i]);
      // At some point of the ball a closed sheet may be nearer than an open one.
      if (found[i].least > 0 && closed_.size() > 0 && closed_.distance(p) <= open_.distance(p) + 2 * radius)
        found[i] = {-kInfinity, kInfinity};
      if (trim_ && samples_.distance(p) - radius > *trim_) found[i] = {1e-9, kInfinity};
    }
  });
}

void FunctionDomain::refine(BlockTree& blocks, int deepest) const {
  std::vector<Coverage::Border> borders = coverage_.borders();
  if (!trim_)
    std::erase_if(borders, [&](const Coverage::Border& b) {
      return !(open_.distance(b.position) < closed_.distance(b.position));
    });
  refine_along(borders, blocks, deepest);
  // A plane needs few blocks, but faces of the cube, where the surface is closed, must be beyond the reach of samples.
  while (blocks.depth() < std::min(kLeastOpenDepth, deepest)) {
    const std::vector<std::uint32_t> leaves = blocks.leaves();
    blocks.subdivide_all(leaves);
  }
}

void refine_along(std::span<const Coverage::Border> borders, BlockTree& blocks, int deepest) {
  std::vector<Vec3f> centers;
  std::vector<float> reach, edge;
  for (const Coverage::Border& b : borders) {
    centers.push_back(b.position);
    reach.push_back(kBorderWidth * b.reach);
    edge.push_back(kBorderBlock * b.spacing);
  }
  const BallTree tree(centers, reach);
  std::vector<std::uint32_t> near;
  std::vector<std::size_t> stack{0};
  while (!stack.empty()) {
    const std::size_t block = stack.back();
    stack.pop_back();
    if (blocks.is_leaf(block)) {
      if (static_cast<int>(blocks[block].level) >= deepest) continue;
      const double h = blocks.block_edge(block);
      const Vec3 center = blocks.block_center(block), half = Vec3{h, h, h} * 0.5;
      const Box3f box{Vec3f(center - half), Vec3f(center + half)};
      bool divide = false;
      tree.touching(box, kEnough, near);
      for (const std::uint32_t i : near) divide = divide || h > static_cast<double>(edge[i]);
      if (!divide) continue;
      blocks.subdivide(block);
    }
    const auto first = static_cast<std::size_t>(blocks[block].first_child);
    for (std::size_t c = 0; c < 8; ++c) stack.push_back(first + c);
  }
}

}  // namespace sansmesh::inline v1
