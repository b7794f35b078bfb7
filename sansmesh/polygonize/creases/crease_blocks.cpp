#include "sansmesh/polygonize/creases/crease_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

/// Shift of the cube in blocks, so that faces of blocks do not coincide with faces of solids, which are often at round
/// numbers.
constexpr Vec3 kBlockShift{0.3819, 0.2361, 0.4271};
/// Distance in cells between larger blocks and points with two pieces: the triangles of a crease zone have one size.
constexpr double kRoom = 2;
/// Enlargement of the queried cube beyond the block, in cells: vertices move, so a curved part just outside the block
/// affects it.
constexpr double kWider = 0.5;

/// Largest deviation of a piece from a plane, over half the block's edge: a pipe then has four blocks across, a ball
/// six.
constexpr double kShape = 0.25;

/// Whether the field is planar to within `flat` in each of these cubes, tested at 27 points.
std::vector<std::uint8_t> flat_cubes(const PiecewiseField& field, const std::vector<Vec3>& centers, double half,
                                     double flat) {
  std::vector<std::uint8_t> result(centers.size(), 1);
  std::vector<double> value(centers.size());
  std::vector<Vec3> gradient(centers.size());
  field.evaluate(centers, value, gradient);
  std::vector<std::uint32_t> open(centers.size());
  std::iota(open.begin(), open.end(), 0u);
  std::vector<Vec3> x;
  std::vector<double> f;
  // Corners first, which reveal most curvature, then midpoints of edges and faces.
  for (const bool corners : {true, false}) {
    std::vector<Vec3> offsets;
    for (int k = 0; k < 27; ++k) {
      const int i = k % 3 - 1, j = k / 3 % 3 - 1, l = k / 9 - 1;
      const Vec3 d{static_cast<double>(i), static_cast<double>(j), static_cast<double>(l)};
      const double from_center = squared_norm(d);
      if (from_center > 0 && (from_center > 2.5) == corners) offsets.push_back(d * half);
    }
    x.clear();
    for (const std::uint32_t i : open)
      for (const Vec3& d : offsets) x.push_back(centers[i] + d);
    f.resize(x.size());
    field.evaluate(x, f);
    std::size_t q = 0;
    for (const std::uint32_t i : open)
      for (const Vec3& d : offsets)
        if (!(std::abs(f[q++] - value[i] - dot(gradient[i], d)) <= flat * norm(gradient[i]))) result[i] = 0;
    std::erase_if(open, [&](std::uint32_t i) { return !result[i]; });
  }
  return result;
}

/// Selects blocks of one size, given by their centres, that the surface may cross according to the field at a ball
/// around each.
std::vector<std::uint32_t> blocks_with_surface(const PiecewiseField& field, const std::optional<double>& slope,
                                               const std::vector<Vec3>& centers, double corner) {
  std::vector<std::uint32_t> found;
  if (slope) {
    std::vector<double> values(centers.size());
    field.evaluate(centers, values);
    for (std::uint32_t i = 0; i < centers.size(); ++i)
      if (std::abs(values[i]) <= *slope * corner) found.push_back(i);
  } else {
    std::vector<ValueRange> ranges(centers.size());
    field.ranges(centers, corner, ranges);
    for (std::uint32_t i = 0; i < centers.size(); ++i)
      if (ranges[i].holds_zero()) found.push_back(i);
  }
  return found;
}

/// Marks the blocks, all of this size, that must be divided.
void choose(const PiecewiseField& field, const CreaseBlockOptions& options, const std::vector<Vec3>& centers,
            double half, std::vector<std::uint8_t>& cut) {
  const double block = 2 * half, corner = std::sqrt(3.0) * half, alone = corner + kRoom * options.cell;
  const std::vector<std::uint32_t> met = blocks_with_surface(field, options.slope, centers, corner);
  std::fill(cut.begin(), cut.end(), std::uint8_t{0});
  for (const std::uint32_t i : met) cut[i] = 1;
  if (options.flat < 0 || met.empty()) return;
  std::vector<Vec3> at(met.size());
  for (std::size_t j = 0; j < met.size(); ++j) at[j] = centers[met[j]];
  std::vector<double> values(met.size());
  std::vector<Surroundings> around(met.size());
  field.survey(at, {half, alone}, values, around);
  std::vector<std::uint32_t> asked;
  std::vector<Vec3> x;
  for (std::size_t j = 0; j < met.size(); ++j) {
    if (around[j].alone < alone) continue;
    if (std::isinf(around[j].detail)) {
      asked.push_back(met[j]);
      x.push_back(at[j]);
    } else {
      cut[met[j]] = block > (around[j].detail > 0 ? around[j].detail : options.smooth_cell);
    }
  }
  if (asked.empty()) return;
  const double flat = block > options.smooth_cell ? options.flat : kShape * half;
  const std::vector<std::uint8_t> is_flat = flat_cubes(field, x, half + kWider * options.cell, flat);
  for (std::size_t j = 0; j < asked.size(); ++j) cut[asked[j]] = !is_flat[j];
}

}  // namespace

BlockTree crease_blocks(const PiecewiseField& field, const Box3& box, const CreaseBlockOptions& options,
                        Progress& progress) {
  return *crease_blocks(field, box, options, progress, std::numeric_limits<std::size_t>::max());
}

std::optional<BlockTree> crease_blocks(const PiecewiseField& field, const Box3& box, const CreaseBlockOptions& options,
                                       Progress& progress, std::size_t most) {
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z}), cell = options.cell;
  int depth = 0;
  while (cell * static_cast<double>(1 << depth) < longest + 4 * cell) ++depth;
  const double edge = cell * static_cast<double>(1 << depth);
  BlockTree tree(box.center() - Vec3{edge, edge, edge} * 0.5 + cell * (kBlockShift - Vec3{0.5, 0.5, 0.5}), edge);
  progress.begin("blocks", static_cast<std::size_t>(depth));
  std::vector<std::uint32_t> level{0};
  for (int l = 0; l < depth; ++l) {
    const double half = edge / static_cast<double>(1 << l) / 2;
    std::vector<std::uint32_t> candidates;
    std::vector<Vec3> centers;
    for (const std::uint32_t b : level) {
      const Vec3 c = tree.block_center(b);
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k)
        meets = meets && c[k] + half >= box.lower[k] - cell && c[k] - half <= box.upper[k] + cell;
      if (!meets) continue;
      candidates.push_back(b);
      centers.push_back(c);
    }
    std::vector<std::uint8_t> cut(candidates.size(), 1);
    if (l >= kCreaseBaseLevel) choose(field, options, centers, half, cut);
    level.clear();
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (cut[i]) level.push_back(candidates[i]);
    if (!level.empty() && tree.size() + 8 * (level.size() - 1) > most) return std::nullopt;
    level = tree.subdivide_all(level);
    progress.advance();
  }
  progress.finish();
  return tree;
}

}  // namespace sansmesh::inline v1
