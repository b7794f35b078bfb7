#include "sansmesh/dataset/value_ranges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();
constexpr std::size_t kBrick = 2;  ///< cells of a lattice along each side of a group
constexpr std::size_t kGroup = 4;  ///< cells of other grids per group

/// Converts a box to float, rounded outwards.
Box3f outwards(const Box3& box) {
  Box3f out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.lower[k] = std::nextafter(static_cast<float>(box.lower[k]), -kEndless);
    out.upper[k] = std::nextafter(static_cast<float>(box.upper[k]), kEndless);
  }
  return out;
}

/// Range of some values, widened by the overshoot of reconstructions.
class Spread {
 public:
  void take(double v) {
    if (!std::isfinite(v)) return;
    least_ = std::min(least_, v), most_ = std::max(most_, v);
  }
  std::pair<float, float> widened() const {
    if (least_ > most_) return {kEndless, -kEndless};
    const double beyond = ValueRanges::kBeyond * (most_ - least_);
    return {std::nextafter(static_cast<float>(least_ - beyond), -kEndless),
            std::nextafter(static_cast<float>(most_ + beyond), kEndless)};
  }

 private:
  double least_ = std::numeric_limits<double>::infinity(), most_ = -least_;
};

/// Indices 0 … n − 1 along the Morton curve through their positions.
template <class At>
std::vector<std::uint32_t> along_curve(std::size_t n, const Box3& box, At&& at) {
  const Vec3 size = box.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(n);
  parallel_for(0, n, 4096, [&](std::size_t i) {
    const Vec3 x = at(i);
    std::uint32_t cell[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const double t = size[k] > 0 ? (x[k] - box.lower[k]) / size[k] : 0;
      cell[k] = index_in<std::uint32_t>(t * 0x1fffff, 0, 0x1fffff);
    }
    keys[i] = {morton_code(cell[0], cell[1], cell[2]), static_cast<std::uint32_t>(i)};
  });
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = keys[i].second;
  return order;
}

/// The largest absolute finite value.
double largest_size(std::size_t n, const std::function<double(std::size_t)>& value) {
  return parallel_reduce(
      n, 1 << 16, 0.0,
      [&](std::size_t first, std::size_t last) {
        double most = 0;
        for (std::size_t i = first; i < last; ++i)
          if (const double v = std::abs(value(i)); std::isfinite(v)) most = std::max(most, v);
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace

std::vector<ValueRanges::Item> ValueRanges::lattice_items(const SampledVolume& volume,
                                                          const std::function<double(std::size_t)>& value,
                                                          const LocalFrame& frame) {
  const Lattice& l = *volume.lattice;
  std::array<std::size_t, 3> n{}, bricks{};
  for (std::size_t k = 0; k < 3; ++k) {
    n[k] = l.axes[k].size();
    bricks[k] = std::max<std::size_t>(1, (n[k] - 1 + kBrick - 1) / kBrick);
  }
  const auto brick_at = [&](std::size_t b) {
    return std::array{b % bricks[0], b / bricks[0] % bricks[1], b / (bricks[0] * bricks[1])};
  };
  const Box3 cube{{0, 0, 0},
                  {static_cast<double>(bricks[0]), static_cast<double>(bricks[1]), static_cast<double>(bricks[2])}};
  const std::vector<std::uint32_t> order = along_curve(bricks[0] * bricks[1] * bricks[2], cube, [&](std::size_t b) {
    const auto at = brick_at(b);
    return Vec3{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
  });
  std::vector<Item> items(order.size());
  parallel_for(0, items.size(), 256, [&](std::size_t i) {
    const auto at = brick_at(order[i]);
    std::array<std::size_t, 3> first{}, last{};
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = at[k] * kBrick;
      last[k] = std::min(first[k] + kBrick, n[k] - 1);
      low[k] = first[k] == 0 ? l.lower[k] : l.axes[k][first[k]];
      high[k] = last[k] == n[k] - 1 ? l.upper[k] : l.axes[k][last[k]];
    }
    Spread spread;
    for (std::size_t z = first[2]; z <= last[2]; ++z)
      for (std::size_t y = first[1]; y <= last[1]; ++y)
        for (std::size_t x = first[0]; x <= last[0]; ++x) spread.take(value(x + n[0] * (y + n[1] * z)));
    Box3 box;
    for (int c = 0; c < 8; ++c)
      box.extend(frame.from_input(
          l.from_axes({c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1], c & 4 ? high[2] : low[2]})));
    const auto [least, most] = spread.widened();
    items[i] = {outwards(box), least, most};
  });
  return items;
}

std::vector<ValueRanges::Item> ValueRanges::cell_items(const SampledVolume& volume,
                                                       const std::function<double(std::size_t)>& value,
                                                       const LocalFrame& frame) {
  const CellList& cells = volume.cells;
  const std::vector<std::uint32_t> order = along_curve(cells.size(), volume.bounds(), [&](std::size_t c) {
    Vec3 sum;
    for (const std::uint32_t corner : cells[c]) sum += volume.corner(corner);
    return sum / static_cast<double>(cells[c].size());
  });
  std::vector<Item> items((cells.size() + kGroup - 1) / kGroup);
  parallel_ranges(0, items.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> star;
    for (std::size_t i = begin; i < end; ++i) {
      Box3 box;
      Spread spread;
      const std::size_t last = std::min(kGroup * (i + 1), cells.size());
      for (std::size_t g = kGroup * i; g < last; ++g) {
        const std::uint32_t c = order[g];
        for (const std::uint32_t corner : cells[c]) {
          box.extend(frame.from_input(volume.corner(corner)));
          if (!volume.in_cells) spread.take(value(corner));
        }
        // Values in a piece depend on all nodes of its cell.
        if (const HigherOrderCells& higher = volume.higher; !higher.of_piece.empty())
          if (const std::uint32_t whole = higher.of_piece[c]; whole != HigherOrderCells::kNone)
            for (const std::uint32_t node : higher[whole]) spread.take(value(node));
        if (!volume.in_cells) continue;
        // Values at a cell's corners depend on all cells around them.
        const std::uint32_t sample = volume.cell_sample[c];
        spread.take(value(sample));
        volume.star(sample, star);
        for (const std::uint32_t s : star) spread.take(value(s));
      }
      const auto [least, most] = spread.widened();
      items[i] = {outwards(box), least, most};
    }
  });
  return items;
}

ValueRanges::ValueRanges(const SampledVolume& volume, const std::function<double(std::size_t)>& value,
                         const LocalFrame& frame)
    : scale_(binary_scale(largest_size(volume.size(), value))) {
  std::function<double(std::size_t)> scaled;
  if (scale_ != 1) scaled = [&](std::size_t i) { return scale_ * value(i); };
  const auto& taken = scale_ != 1 ? scaled : value;
  std::vector<Item> items = volume.lattice ? lattice_items(volume, taken, frame) : cell_items(volume, taken, frame);
  levels_ = eight_wide_levels<Node>(std::move(items), [](std::span<const Item> siblings, std::size_t, Node& node) {
    Item above{{}, kEndless, -kEndless};
    for (std::size_t lane = 0; lane < kTreeWidth; ++lane) {
      const bool used = lane < siblings.size();
      const Item item = used ? siblings[lane] : Item{{}, kEndless, -kEndless};
      for (std::size_t k = 0; k < 3; ++k)
        node.boxes.lower[k][lane] = item.box.lower[k], node.boxes.upper[k][lane] = item.box.upper[k];
      node.least[lane] = item.least, node.most[lane] = item.most;
      if (!used) continue;
      above.box.extend(item.box);
      above.least = std::min(above.least, item.least), above.most = std::max(above.most, item.most);
    }
    return above;
  });
}

ValueRanges::Reach ValueRanges::reach(const Node& node, std::size_t lane, const Vec3f& x) {
  Reach r{0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const float below = node.boxes.lower[k][lane] - x[k], above = x[k] - node.boxes.upper[k][lane];
    const float out = std::max({below, above, 0.0F}), across = std::max(-below, -above);
    r.nearest += out * out, r.farthest += across * across;
  }
  return r;
}

bool ValueRanges::among(const Vec3& x, double radius, double value) const {
  if (levels_.empty()) return false;
  const Vec3f p(x);
  const auto squared = static_cast<float>(radius * radius * (1 + 1e-5));
  const float v = static_cast<float>(value * scale_);  // ranges were rounded outwards
  const auto visit = [&](const auto& self, std::size_t level, std::size_t n) -> bool {
    const Node& node = levels_[level][n];
    for (std::size_t lane = 0; lane < kTreeWidth; ++lane) {
      if (node.least[lane] > v || node.most[lane] < v || reach(node, lane, p).nearest > squared) continue;
      if (level == 0 || self(self, level - 1, kTreeWidth * n + lane)) return true;
    }
    return false;
  };
  return visit(visit, levels_.size() - 1, 0);
}

ValueRange ValueRanges::around(const Vec3& x, double radius) const {
  ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  if (levels_.empty()) return range;
  const Vec3f p(x);
  const auto squared = static_cast<float>(radius * radius * (1 + 1e-5));
  const auto visit = [&](const auto& self, std::size_t level, std::size_t n) -> void {
    const Node& node = levels_[level][n];
    for (std::size_t lane = 0; lane < kTreeWidth; ++lane) {
      const double least = static_cast<double>(node.least[lane]), most = static_cast<double>(node.most[lane]);
      if (least > most || (least >= range.least && most <= range.most)) continue;
      const auto [near, far] = reach(node, lane, p);
      if (near > squared) continue;
      if (level == 0 || far <= squared) {
        range.least = std::min(range.least, least), range.most = std::max(range.most, most);
      } else {
        self(self, level - 1, kTreeWidth * n + lane);
      }
    }
  };
  visit(visit, levels_.size() - 1, 0);
  return {range.least / scale_, range.most / scale_};
}

ValueRange ValueRanges::of_samples() const {
  const ValueRange all = around({}, 2);
  const double beyond = kBeyond * (all.most - all.least) / (1 + 2 * kBeyond);
  return {all.least + beyond, all.most - beyond};
}

std::vector<Vec3> ValueRanges::points_with(double value) const {
  std::vector<Vec3> points;
  if (levels_.empty()) return points;
  value *= scale_;
  for (const Node& node : levels_[0])
    for (std::size_t lane = 0; lane < kTreeWidth; ++lane) {
      if (static_cast<double>(node.least[lane]) > value || static_cast<double>(node.most[lane]) < value) continue;
      Vec3 center;
      for (std::size_t k = 0; k < 3; ++k)
        center[k] =
            0.5 * (static_cast<double>(node.boxes.lower[k][lane]) + static_cast<double>(node.boxes.upper[k][lane]));
      points.push_back(center);
    }
  return points;
}

}  // namespace sansmesh::inline v1
