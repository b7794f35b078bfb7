#include "sansmesh/partition/fit/sorted_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

namespace {

/// Space between the samples and the sides of the cube, in extents of the samples.
constexpr double kCubeMargin = 0.05;
/// Corners of snapped cubes are multiples of their edge over this.
constexpr double kCorners = 16;
/// Offset of the corners from these multiples, in steps: a third, and two thirds of the steps twice and half as large,
/// so that all lattices coincide. Planes at coordinates that are round in binary, such as a plane of symmetry at 0, are
/// at a third or two thirds of the blocks of every level, never on a side of them.
double corner_offset(double step) {
  const auto octave = static_cast<long>(std::floor(std::log2(step) + 1e-6));
  return octave % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
}

/// Share of the samples outside each side of the box of most samples, and number of samples that suffices for it.
constexpr double kOutside = 0.02;
constexpr std::size_t kEnough = 100000;
/// Levels from the deepest one up to the blocks that are counted whole.
constexpr int kLevelsOfBlock = 6;
/// Edge of a cube that follows the box, in extents of the samples.
constexpr double kCubeOverExtent = 1.1;

}  // namespace

Box3f set_root_cube(const PointSet& points, PartitionData& data) {
  if (points.size() < 4) throw DataError("partition of unity: at least 4 points are needed");
  if (points.normals.size() != points.size()) throw DataError("partition of unity: points need oriented normals");
  const Box3f box = bounds(points);
  const float extent = std::max({box.size().x, box.size().y, box.size().z});
  if (!(extent > 0)) throw DataError("partition of unity: all points coincide");
  data.origin = points.origin;
  data.edge = static_cast<float>(kCubeOverExtent) * extent;
  data.lower = box.center() - Vec3f{1, 1, 1} * (0.5f * data.edge);
  return box;
}

namespace {

/// Largest side of the box of most samples (0.96 of them along each axis), as an estimate of that of all samples that
/// does not depend on a few of them.
double typical_extent(std::span<const Vec3f> positions) {
  const std::size_t stride = 1 + positions.size() / kEnough;
  std::vector<float> values((positions.size() + stride - 1) / stride);
  const auto outside = static_cast<std::size_t>(kOutside * static_cast<double>(values.size()));
  double extent = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = positions[i * stride][k];
    const float lower = nth_smallest(values, outside);
    extent = std::max(extent, static_cast<double>(nth_smallest(values, values.size() - 1 - outside) - lower));
  }
  return extent / (1 - 2 * kOutside);
}

}  // namespace

int deepest_level(std::span<const Vec3f> positions, float edge) {
  const double extent = typical_extent(positions), samples = static_cast<double>(positions.size());
  const double cells = extent > 0 ? static_cast<double>(edge) / (kCubeOverExtent * extent) : 1;
  return whole_part<int>(std::ceil(0.5 * std::log2(samples) + std::log2(cells) + 1.5));
}

namespace {

/// Edge of the form 2^(k/4) of the cells with this many samples in the mean cell of a sample, rounded up.
double cell_edge_with(double company, std::span<const Vec3f> positions, const PartitionData& data, int depth) {
  // All samples of some blocks of 64³ finest cells show the numbers on all levels below these blocks.
  const int coarse = std::max(0, depth - kLevelsOfBlock);
  std::size_t skip = 1;
  while (positions.size() / skip > kEnough) skip *= 2;
  const double scale = std::exp2(depth) / static_cast<double>(data.edge);
  const std::uint32_t last = (1u << depth) - 1;
  std::vector<std::uint64_t> codes = parallel_reduce(
      positions.size(), std::size_t{1} << 15, std::vector<std::uint64_t>{},
      [&](std::size_t first, std::size_t end) {
        std::vector<std::uint64_t> some;
        for (std::size_t i = first; i < end; ++i) {
          const Vec3 p = Vec3(positions[i] - data.lower) * scale;
          const auto cell = [&](double x) { return index_in<std::uint32_t>(x, 0, last); };
          const std::uint64_t code = morton_code(cell(p.x), cell(p.y), cell(p.z));
          // Fibonacci hashing.
          const std::uint64_t mixed = ((code >> 3 * (depth - coarse)) + 1) * 0x9e3779b97f4a7c15u;
          if ((mixed >> 40) % skip == 0) some.push_back(code);
        }
        return some;
      },
      [](std::vector<std::uint64_t> a, const std::vector<std::uint64_t>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  if (codes.empty()) return 0;
  parallel_sort(codes);
  double finer = 1;  // one level below
  for (int level = depth; level > 0; --level) {
    const int shift = 3 * (depth - level);
    double squares = 0;
    for (std::size_t i = 0; i < codes.size();) {
      std::size_t j = i;
      while (j < codes.size() && codes[j] >> shift == codes[i] >> shift) ++j;
      squares += static_cast<double>(j - i) * static_cast<double>(j - i);
      i = j;
    }
    const double own = squares / static_cast<double>(codes.size());
    if (own >= company) {
      const double below = own > finer ? std::log(own / company) / std::log(own / finer) : 0;
      return std::exp2(std::ceil(4 * (std::log2(static_cast<double>(data.edge)) - level - below)) / 4);
    }
    finer = own;
  }
  return 0;
}

}  // namespace

void snap_root_cube(const Box3f& box, std::span<const Vec3f> positions, double company, PartitionData& data) {
  const double cell =
      cell_edge_with(company, positions, data, std::min(kMostDepth, deepest_level(positions, data.edge)));
  const double least =
      static_cast<double>(data.edge) / kCubeOverExtent * (1 + 2 * kCubeMargin) * kCorners / (kCorners - 1);
  const double unit = cell > 0 ? cell : 1;
  const double edge = unit * std::exp2(std::ceil(std::log2(least / unit))), step = edge / kCorners;
  const double offset = corner_offset(step);
  for (std::size_t k = 0; k < 3; ++k) {
    const double centred = static_cast<double>(box.lower[k]) - 0.5 * (edge - static_cast<double>(box.size()[k]));
    data.lower[k] = static_cast<float>(step * (std::round(centred / step - offset) + offset));
  }
  data.edge = static_cast<float>(edge);
}

SampleTree sort_samples(PointSet& points, const PartitionData& data, PointSet* sorted) {
  SampleTree tree(std::move(points.positions), std::move(points.normals), data.lower, data.edge, data.basis.sort_depth);
  const std::vector<std::uint32_t> order = tree.take_order();
  if (!sorted) return tree;
  *sorted = PointSet{};
  sorted->origin = points.origin;
  sorted->reference = points.reference;
  if (points.has_colors()) {
    sorted->colors.resize(order.size());
    parallel_for(0, order.size(), 16384, [&](std::size_t i) { sorted->colors[i] = points.colors[order[i]]; });
    points.colors = {};
  }
  return tree;
}

void take_samples(SampleTree& tree, PointSet* sorted) {
  if (!sorted) return;
  sorted->positions = tree.take_positions();
  sorted->normals = tree.take_normals();
}

}  // namespace sansmesh::inline v1
