#include "sansmesh/deform/maps/displacement_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr const char* kUser = "a displacement map";
constexpr std::size_t kLookups = 1024;
constexpr std::size_t kChunk = 256;          // points mapped at a time
constexpr std::size_t kBlock = 8;            // points along each axis of a block with cached bounds
constexpr std::size_t kMostNodes = 1200000;  // 77 MB: for larger lattices, differences are computed on demand
constexpr double kUneven = 1e-4;             // in spacings

}  // namespace

/// Lattice points around a position, with weights.
struct DisplacementMap::Corners {
  std::size_t first = 0;                ///< index of the lowest
  std::array<std::size_t, 3> stride{};  ///< to the next along each axis
  std::array<double, 8> weight{};       ///< for point (c & 1, c & 2, c & 4)
  std::array<bool, 3> inside{};         ///< within the lattice along the axis: derivatives are not zero
  std::size_t at(std::size_t c) const {
    return first + (c & 1 ? stride[0] : 0) + (c & 2 ? stride[1] : 0) + (c & 4 ? stride[2] : 0);
  }
};

DisplacementMap::DisplacementMap(const Box3& box, const std::array<std::size_t, 3>& sizes,
                                 SharedArray<Vec3f> displacements, SharedArray<float> gaps)
    : lattice_(box, sizes), displacements_(std::move(displacements)), gaps_(std::move(gaps)) {
  lattice_.validate(kUser);
  const std::size_t points = lattice_.size();
  for (std::size_t k = 0; k < 3; ++k) blocks_[k] = (sizes[k] + kBlock - 1) / kBlock;
  if (displacements_.size() != points || (!gaps_.empty() && gaps_.size() != points))
    throw ArgumentError("a displacement map of " + std::to_string(points) + " points needs as many displacements");
  block_bounds_.resize(blocks_[0] * blocks_[1] * blocks_[2]);
  parallel_for(0, block_bounds_.size(), 16, [&](std::size_t b) {
    const std::array<std::size_t, 3> block{b % blocks_[0], b / blocks_[0] % blocks_[1], b / blocks_[0] / blocks_[1]};
    Box3f& bounds = block_bounds_[b];
    for (std::size_t k = block[2] * kBlock; k < std::min((block[2] + 1) * kBlock, lattice_.sizes[2]); ++k)
      for (std::size_t j = block[1] * kBlock; j < std::min((block[1] + 1) * kBlock, lattice_.sizes[1]); ++j)
        for (std::size_t i = block[0] * kBlock; i < std::min((block[0] + 1) * kBlock, lattice_.sizes[0]); ++i)
          bounds.extend(displacements_[lattice_.point({i, j, k})]);
  });
  if (points > kMostNodes) return;
  nodes_.resize(points);
  parallel_for(0, points, 4096, [&](std::size_t p) { nodes_[p] = node_of(p); });
}

/// Differences over two cells, at the border of the lattice over one.
DisplacementMap::Node DisplacementMap::node_of(std::size_t p) const {
  const BoxLattice::Index i = lattice_.index(p), stride = lattice_.strides();
  Node n;
  n.d = displacements_[p];
  if (!gaps_.empty()) n.gap = gaps_[p];
  for (std::size_t k = 0; k < 3; ++k) {
    const bool below = i[k] > 0, above = i[k] + 1 < lattice_.sizes[k];
    const std::size_t low = below ? p - stride[k] : p, high = above ? p + stride[k] : p;
    const double inverse = 1 / ((below && above ? 2 : 1) * lattice_.spacing[k]);
    n.by[k] = Vec3f((Vec3(displacements_[high]) - Vec3(displacements_[low])) * inverse);
    if (!gaps_.empty()) n.gap_by[k] = static_cast<float>((double{gaps_[high]} - double{gaps_[low]}) * inverse);
  }
  return n;
}

/// False where the position is not finite.
bool DisplacementMap::corners_at(const Vec3& x, Corners& c) const {
  std::array<double, 3> f{};
  c.first = 0;
  std::size_t stride = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double last = static_cast<double>(lattice_.sizes[k] - 1),
                 free = (x[k] - lattice_.box.lower[k]) / lattice_.spacing[k];
    if (!std::isfinite(free)) return false;
    const double u = std::clamp(free, 0.0, last);
    const auto cell = std::min(static_cast<std::size_t>(u), lattice_.sizes[k] - 2);
    f[k] = u - static_cast<double>(cell);
    c.inside[k] = free >= 0 && free <= last;  // constant outside, across the border
    c.stride[k] = stride;
    c.first += cell * stride;
    stride *= lattice_.sizes[k];
  }
  for (std::size_t i = 0; i < 8; ++i)
    c.weight[i] = (i & 1 ? f[0] : 1 - f[0]) * (i & 2 ? f[1] : 1 - f[1]) * (i & 4 ? f[2] : 1 - f[2]);
  return true;
}

void DisplacementMap::map(std::span<const Vec3> x, const MappedPoints& wanted) const {
  parallel_ranges(0, x.size(), kLookups, [&](std::size_t first, std::size_t last) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    Corners c;
    for (std::size_t i = first; i < last; ++i) {
      const bool known = corners_at(x[i], c);
      if (!known) corners_at(lattice_.box.lower, c);
      if (!wanted.positions.empty() || !wanted.jacobians.empty()) {
        std::array<double, 12> sum{};
        for (std::size_t k = 0; k < 8; ++k) {
          const Node n = nodes_.empty() ? node_of(c.at(k)) : nodes_[c.at(k)];
          const double w = c.weight[k];
          const std::array<float, 12> part{n.d.x,     n.d.y,     n.d.z,     n.by[0].x, n.by[0].y, n.by[0].z,
                                           n.by[1].x, n.by[1].y, n.by[1].z, n.by[2].x, n.by[2].y, n.by[2].z};
          for (std::size_t m = 0; m < 12; ++m) sum[m] += w * double{part[m]};
        }
        if (!wanted.positions.empty())
          wanted.positions[i] = known ? x[i] + Vec3{sum[0], sum[1], sum[2]} : Vec3{kNone, kNone, kNone};
        if (!wanted.jacobians.empty())
          for (std::size_t k = 0; k < 3; ++k) {
            Vec3& j = wanted.jacobians[i][k];
            j = c.inside[k] ? Vec3{sum[3 * k + 3], sum[3 * k + 4], sum[3 * k + 5]} : Vec3{};
            j[k] += 1;
          }
      }
      if (wanted.gaps.empty() && wanted.gap_gradients.empty()) continue;
      double gap = gaps_.empty() ? -std::numeric_limits<double>::infinity() : 0;
      Vec3 slope;
      for (std::size_t k = 0; !gaps_.empty() && k < 8; ++k) {
        const Node n = nodes_.empty() ? node_of(c.at(k)) : nodes_[c.at(k)];
        gap += c.weight[k] * double{n.gap};
        for (std::size_t m = 0; m < 3; ++m)
          if (c.inside[m]) slope[m] += c.weight[k] * double{n.gap_by[m]};
      }
      if (!wanted.gaps.empty()) wanted.gaps[i] = gap;
      if (!wanted.gap_gradients.empty()) wanted.gap_gradients[i] = slope;
    }
  });
}

Box3f DisplacementMap::bounds_of_points(const std::array<std::size_t, 3>& first,
                                        const std::array<std::size_t, 3>& last) const {
  Box3f bounds;
  for (std::size_t c = first[2] / kBlock; c <= last[2] / kBlock; ++c) {
    for (std::size_t b = first[1] / kBlock; b <= last[1] / kBlock; ++b) {
      for (std::size_t a = first[0] / kBlock; a <= last[0] / kBlock; ++a) {
        const std::array<std::size_t, 3> block{a, b, c};
        std::array<std::size_t, 3> from{}, to{};
        bool whole = true;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t begin = block[k] * kBlock, end = std::min(begin + kBlock, lattice_.sizes[k]) - 1;
          from[k] = std::max(begin, first[k]), to[k] = std::min(end, last[k]);
          whole = whole && from[k] == begin && to[k] == end;
        }
        if (whole) {
          bounds.extend(block_bounds_[a + blocks_[0] * (b + blocks_[1] * c)]);
          continue;
        }
        for (std::size_t k = from[2]; k <= to[2]; ++k)
          for (std::size_t j = from[1]; j <= to[1]; ++j)
            for (std::size_t i = from[0]; i <= to[0]; ++i) bounds.extend(displacements_[lattice_.point({i, j, k})]);
      }
    }
  }
  return bounds;
}

void DisplacementMap::images(std::span<const Box3> boxes, std::span<Box3> found) const {
  parallel_for(0, boxes.size(), 8, [&](std::size_t n) {
    found[n] = {};
    if (boxes[n].empty()) return;
    std::array<std::size_t, 3> first{}, last{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double end = static_cast<double>(lattice_.sizes[k] - 1);
      const auto cell = [&](double x) {
        return std::clamp((x - lattice_.box.lower[k]) / lattice_.spacing[k], 0.0, end);
      };
      // Allows for the rounding of the division by the spacing.
      first[k] = index_in<std::size_t>(std::floor(cell(boxes[n].lower[k]) - 1e-9), 0, lattice_.sizes[k] - 1);
      last[k] = index_in<std::size_t>(std::ceil(cell(boxes[n].upper[k]) + 1e-9), 0, lattice_.sizes[k] - 1);
    }
    const Box3f bounds = bounds_of_points(first, last);
    if (bounds.empty()) return;
    // Sums of eight products are also rounded.
    for (std::size_t k = 0; k < 3; ++k) {
      const double lower = boxes[n].lower[k] + double{bounds.lower[k]},
                   upper = boxes[n].upper[k] + double{bounds.upper[k]};
      const double size =
          std::max({std::abs(boxes[n].lower[k]), std::abs(boxes[n].upper[k]), std::abs(lower), std::abs(upper)});
      found[n].lower[k] = lower - 1e-14 * size, found[n].upper[k] = upper + 1e-14 * size;
    }
  });
}

DisplacementMap displacement_map(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                                 Progress& progress) {
  const BoxLattice lattice(box, sizes);
  lattice.validate(kUser);
  const std::size_t points = lattice.size();
  // Uninitialised memory: the threads below touch it first.
  const std::shared_ptr<void> memory(::operator new(points * sizeof(Vec3f)), [](void* m) { ::operator delete(m); });
  const std::span<Vec3f> displacements(static_cast<Vec3f*>(memory.get()), points);
  std::vector<float> gaps(map.has_gaps() ? points : 0);
  const double farthest = box.diagonal();
  std::array<std::vector<double>, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    const double end = static_cast<double>(sizes[k] - 1);
    for (std::size_t i = 0; i < sizes[k]; ++i) {
      const double t = static_cast<double>(i) / end;
      axes[k].push_back(box.lower[k] * (1 - t) + box.upper[k] * t);
    }
  }
  const std::size_t chunks = (points + kChunk - 1) / kChunk;
  progress.begin("displacement map", chunks);
  parallel_ranges(0, chunks, 64, [&](std::size_t begin, std::size_t end) {
    std::array<Vec3, kChunk> x, found;
    std::array<double, kChunk> depths{};
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      const std::size_t first = chunk * kChunk, n = std::min(kChunk, points - first);
      auto [i, j, k] = lattice.index(first);
      for (std::size_t p = 0; p < n; ++p) {
        x[p] = {axes[0][i], axes[1][j], axes[2][k]};
        if (++i < sizes[0]) continue;
        i = 0;
        if (++j == sizes[1]) j = 0, ++k;
      }
      const std::span<double> wanted(depths.data(), gaps.empty() ? 0 : n);
      map.map({x.data(), n}, {{found.data(), n}, {}, wanted, {}});
      for (std::size_t p = 0; p < n; ++p) displacements[first + p] = Vec3f(found[p] - x[p]);
      for (std::size_t p = 0; p < wanted.size(); ++p)
        gaps[first + p] = static_cast<float>(std::clamp(depths[p], -farthest, farthest));
    }
    progress.advance(end - begin);
  });
  progress.finish();
  return {box, sizes, SharedArray<Vec3f>(displacements, memory), std::move(gaps)};
}

GridBlock displacement_block(const DisplacementMap& map) {
  GridBlock block = map.lattice().grid();
  std::vector<float> numbers;
  numbers.reserve(3 * map.displacements().size());
  for (const Vec3f& d : map.displacements()) numbers.insert(numbers.end(), {d.x, d.y, d.z});
  block.point_arrays.set("displacement", std::move(numbers), 3);
  if (map.has_gaps()) block.point_arrays.set("gap", map.gaps().copy());
  return block;
}

DisplacementMap displacement_map_of(const GridBlock& block) {
  const auto fail = [](const std::string& why) { throw DataError("not a displacement map: " + why); };
  if (block.kind != GridKind::lattice) fail("its points are not on a lattice");
  Box3 box;
  std::array<std::size_t, 3> sizes{};
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 axis;
    axis[k] = 1;
    if (norm(block.directions[k] - axis) > kUneven) fail("its lattice is not parallel to the axes");
    const std::vector<double>& at = block.axes[k];
    sizes[k] = at.size();
    if (at.size() < 2) fail("its lattice has no cells along axis " + std::to_string(k + 1));
    const double step = (at.back() - at.front()) / static_cast<double>(at.size() - 1);
    for (std::size_t i = 0; i < at.size(); ++i)
      if (!(std::abs(at.front() + step * static_cast<double>(i) - at[i]) <= kUneven * step))
        fail("its lattice is not evenly spaced along axis " + std::to_string(k + 1));
    box.lower[k] = block.origin[k] + at.front(), box.upper[k] = block.origin[k] + at.back();
  }
  const Attribute* const d = block.point_arrays.find("displacement");
  if (!d || d->components != 3) fail("it has no array `displacement` of 3 components");
  std::vector<Vec3f> displacements(d->rows());
  for (std::size_t i = 0; i < displacements.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) displacements[i][k] = static_cast<float>(d->number(3 * i + k));
  std::vector<float> gaps;
  if (const Attribute* const g = block.point_arrays.find("gap"); g && g->components == 1) {
    gaps.resize(g->rows());
    for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i] = static_cast<float>(g->number(i));
  }
  return {box, sizes, std::move(displacements), std::move(gaps)};
}

}  // namespace sansmesh::inline v1
