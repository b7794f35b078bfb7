#include "sansmesh/deform/displacement_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

constexpr std::size_t kLookups = 1024;
constexpr std::size_t kChunk = 256;  // points that are mapped at a time
constexpr std::size_t kBlock = 8;    // points along each axis whose bounds are kept
constexpr double kUneven = 1e-4;     // of the spacing

void check_lattice(const Box3& box, const std::array<std::size_t, 3>& sizes) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(box.upper[k] > box.lower[k]) || !std::isfinite(box.upper[k] - box.lower[k]))
      throw ArgumentError("the box of a displacement map has no size along axis " + std::to_string(k + 1));
    if (sizes[k] < 2 || sizes[k] > 4096)
      throw ArgumentError("a displacement map has 2 to 4096 points along each axis, not " + std::to_string(sizes[k]));
  }
}

}  // namespace

/// Which points count at a place, and how: along each axis the two around it, and their neighbours for derivatives.
struct DisplacementMap::Stencil {
  std::array<std::array<std::size_t, 4>, 3> at{};  ///< numbers of points along the axis
  std::array<std::array<double, 4>, 3> value{}, slope{};

  /// Σ of values, and of slopes along x, y, z.
  template <class T, class Of>
  std::array<T, 4> sums(const std::array<std::size_t, 3>& sizes, bool slopes, const Of& of) const {
    std::array<T, 4> sum{};
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t b = 0; b < 4; ++b) {
        const bool inner_c = c == 1 || c == 2, inner_b = b == 1 || b == 2;
        if (!inner_c && (!inner_b || !slopes)) continue;
        if (!inner_b && !slopes) continue;
        const std::size_t row = sizes[0] * (at[1][b] + sizes[1] * at[2][c]);
        const double vb = value[1][b], vc = value[2][c];
        for (std::size_t a = 0; a < 4; ++a) {
          const bool inner_a = a == 1 || a == 2;
          if (static_cast<int>(inner_a) + inner_b + inner_c < (slopes ? 2 : 3)) continue;
          const T v = of(row + at[0][a]);
          const double va = value[0][a];
          if (inner_a && inner_b && inner_c) sum[0] += v * (va * vb * vc);
          if (!slopes) continue;
          if (inner_b && inner_c) sum[1] += v * (slope[0][a] * vb * vc);
          if (inner_a && inner_c) sum[2] += v * (va * slope[1][b] * vc);
          if (inner_a && inner_b) sum[3] += v * (va * vb * slope[2][c]);
        }
      }
    }
    return sum;
  }
};

DisplacementMap::DisplacementMap(const Box3& box, const std::array<std::size_t, 3>& sizes,
                                 SharedArray<Vec3f> displacements, SharedArray<float> gaps)
    : box_(box), sizes_(sizes), displacements_(std::move(displacements)), gaps_(std::move(gaps)) {
  check_lattice(box, sizes);
  const std::size_t points = sizes[0] * sizes[1] * sizes[2];
  for (std::size_t k = 0; k < 3; ++k) {
    spacing_[k] = (box.upper[k] - box.lower[k]) / static_cast<double>(sizes[k] - 1);
    blocks_[k] = (sizes[k] + kBlock - 1) / kBlock;
  }
  if (displacements_.size() != points || (!gaps_.empty() && gaps_.size() != points))
    throw ArgumentError("a displacement map of " + std::to_string(points) + " points needs as many displacements");
  block_bounds_.resize(blocks_[0] * blocks_[1] * blocks_[2]);
  parallel_for(0, block_bounds_.size(), 16, [&](std::size_t b) {
    const std::array<std::size_t, 3> block{b % blocks_[0], b / blocks_[0] % blocks_[1], b / blocks_[0] / blocks_[1]};
    Box3f& bounds = block_bounds_[b];
    for (std::size_t k = block[2] * kBlock; k < std::min((block[2] + 1) * kBlock, sizes_[2]); ++k)
      for (std::size_t j = block[1] * kBlock; j < std::min((block[1] + 1) * kBlock, sizes_[1]); ++j)
        for (std::size_t i = block[0] * kBlock; i < std::min((block[0] + 1) * kBlock, sizes_[0]); ++i)
          bounds.extend(displacements_[i + sizes_[0] * (j + sizes_[1] * k)]);
  });
}

DisplacementMap::Stencil DisplacementMap::stencil_at(const Vec3& x) const {
  Stencil s;
  for (std::size_t k = 0; k < 3; ++k) {
    const double last = static_cast<double>(sizes_[k] - 1);
    const double free = (x[k] - box_.lower[k]) / spacing_[k], u = std::clamp(free, 0.0, last);
    const auto cell = std::min(static_cast<std::size_t>(u), sizes_[k] - 2);
    const double f = u - static_cast<double>(cell);
    s.at[k] = {cell > 0 ? cell - 1 : 0, cell, cell + 1, std::min(cell + 2, sizes_[k] - 1)};
    s.value[k] = {0, 1 - f, f, 0};
    if (free < 0 || free > last) continue;  // outside nothing changes across the border
    // Differences at both ends of the cell, over two cells but at the border of the lattice.
    const double left = (1 - f) / (static_cast<double>(s.at[k][2] - s.at[k][0]) * spacing_[k]);
    const double right = f / (static_cast<double>(s.at[k][3] - s.at[k][1]) * spacing_[k]);
    s.slope[k] = {-left, -right, left, right};
  }
  return s;
}

void DisplacementMap::map(std::span<const Vec3> x, const MapAnswers& wanted) const {
  parallel_ranges(0, x.size(), kLookups, [&](std::size_t first, std::size_t last) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = first; i < last; ++i) {
      const bool known = is_finite(x[i]);
      const Stencil s = stencil_at(known ? x[i] : box_.lower);
      const bool slopes = !wanted.jacobians.empty();
      if (slopes || !wanted.positions.empty()) {
        const auto d = s.sums<Vec3>(sizes_, slopes, [&](std::size_t p) { return Vec3(displacements_[p]); });
        if (!wanted.positions.empty()) wanted.positions[i] = known ? x[i] + d[0] : Vec3{kNone, kNone, kNone};
        for (std::size_t k = 0; slopes && k < 3; ++k) {
          wanted.jacobians[i][k] = d[k + 1];
          wanted.jacobians[i][k][k] += 1;
        }
      }
      if (wanted.gaps.empty() && wanted.gap_gradients.empty()) continue;
      std::array<double, 4> g{-std::numeric_limits<double>::infinity(), 0, 0, 0};
      if (!gaps_.empty())
        g = s.sums<double>(sizes_, !wanted.gap_gradients.empty(), [&](std::size_t p) { return double{gaps_[p]}; });
      if (!wanted.gaps.empty()) wanted.gaps[i] = g[0];
      if (!wanted.gap_gradients.empty()) wanted.gap_gradients[i] = {g[1], g[2], g[3]};
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
          const std::size_t begin = block[k] * kBlock, end = std::min(begin + kBlock, sizes_[k]) - 1;
          from[k] = std::max(begin, first[k]), to[k] = std::min(end, last[k]);
          whole = whole && from[k] == begin && to[k] == end;
        }
        if (whole) {
          bounds.extend(block_bounds_[a + blocks_[0] * (b + blocks_[1] * c)]);
          continue;
        }
        for (std::size_t k = from[2]; k <= to[2]; ++k)
          for (std::size_t j = from[1]; j <= to[1]; ++j)
            for (std::size_t i = from[0]; i <= to[0]; ++i)
              bounds.extend(displacements_[i + sizes_[0] * (j + sizes_[1] * k)]);
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
      const double end = static_cast<double>(sizes_[k] - 1);
      const auto cell = [&](double x) { return std::clamp((x - box_.lower[k]) / spacing_[k], 0.0, end); };
      // A cell more than division by the spacing says: that rounds.
      first[k] = static_cast<std::size_t>(std::max(0.0, std::floor(cell(boxes[n].lower[k]) - 1e-9)));
      last[k] = static_cast<std::size_t>(std::min(end, std::ceil(cell(boxes[n].upper[k]) + 1e-9)));
    }
    const Box3f bounds = bounds_of_points(first, last);
    if (bounds.empty()) return;
    // Sums of eight products round, too.
    for (std::size_t k = 0; k < 3; ++k) {
      const double lower = boxes[n].lower[k] + double{bounds.lower[k]},
                   upper = boxes[n].upper[k] + double{bounds.upper[k]};
      const double size =
          std::max({std::abs(boxes[n].lower[k]), std::abs(boxes[n].upper[k]), std::abs(lower), std::abs(upper)});
      found[n].lower[k] = lower - 1e-14 * size, found[n].upper[k] = upper + 1e-14 * size;
    }
  });
}

std::array<std::size_t, 3> lattice_sizes(const Box3& box, std::size_t longest) {
  const Vec3 size = box.size();
  const double most = std::max({size.x, size.y, size.z});
  std::array<std::size_t, 3> sizes{2, 2, 2};
  for (std::size_t k = 0; k < 3 && most > 0; ++k)
    sizes[k] = std::max<std::size_t>(
        2, static_cast<std::size_t>(std::lround(static_cast<double>(longest - 1) * size[k] / most)) + 1);
  return sizes;
}

DisplacementMap displacement_map(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                                 Progress& progress) {
  check_lattice(box, sizes);
  const std::size_t points = sizes[0] * sizes[1] * sizes[2];
  // Not filled with zeros: the threads below touch it first.
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
      std::size_t i = first % sizes[0], j = first / sizes[0] % sizes[1], k = first / sizes[0] / sizes[1];
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
  GridBlock block;
  block.kind = GridKind::lattice;
  for (std::size_t k = 0; k < 3; ++k) {
    const double step = (map.box().upper[k] - map.box().lower[k]) / static_cast<double>(map.sizes()[k] - 1);
    block.origin[k] = map.box().lower[k];
    for (std::size_t i = 0; i < map.sizes()[k]; ++i) block.axes[k].push_back(step * static_cast<double>(i));
  }
  std::vector<float> numbers;
  numbers.reserve(3 * map.displacements().size());
  for (const Vec3f& d : map.displacements()) numbers.insert(numbers.end(), {d.x, d.y, d.z});
  block.point_arrays.set("displacement", std::move(numbers), 3);
  if (map.has_gaps()) block.point_arrays.set("gap", map.gaps().copy());
  return block;
}

DisplacementMap displacement_map_of(const GridBlock& block) {
  const auto fail = [](const std::string& why) { throw DataError("not a displacement map: " + why); };
  if (block.kind != GridKind::lattice) fail("its points are not those of a lattice");
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

}  // namespace sansmesh
