#include "sansmesh/render/volume/volume_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/index_in.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostCells = 48;            // along the longest side
constexpr int kMostKnown = 96;            // the same for fields that know their ranges
constexpr double kCellSpacings = 3;       // approximate edge of a cell in spacings
constexpr int kMostPoints = 6;            // in each direction of a cell
constexpr std::size_t kBudget = 3000000;  // points for ranges
constexpr double kWider = 1.25;           // safety factor of ranges from gradients

}  // namespace

VolumeCells::VolumeCells(const VolumeField& field, const VolumeField* other, Progress& progress) {
  box_ = field.bounds();
  if (box_.empty() || !is_finite(box_.lower) || !is_finite(box_.upper) || !(box_.diagonal() > 0))
    throw DataError("nothing to draw: the volume has no extent");
  Vec3 size = box_.size();
  const double longest = std::max({size.x, size.y, size.z});
  const Vec3 center = box_.center();
  for (std::size_t k = 0; k < 3; ++k)  // gives flat boxes some thickness
    size[k] = std::max(size[k], 1e-4 * longest);
  box_ = {center - size * 0.5, center + size * 0.5};

  // A coarse sample of the spacing determines the number of cells.
  constexpr int kLook = 12;
  std::vector<Vec3> x;
  for (int k = 0; k < kLook; ++k)
    for (int j = 0; j < kLook; ++j)
      for (int i = 0; i < kLook; ++i)
        x.push_back(box_.lower +
                    Vec3{(i + 0.5) / kLook * size.x, (j + 0.5) / kLook * size.y, (k + 0.5) / kLook * size.z});
  std::vector<double> found(x.size());
  field.spacing(x, found);
  std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(found.size() / 4), found.end());
  const double typical = found[found.size() / 4];
  ValueRange whole{-std::numeric_limits<double>::infinity(), 0};
  field.ranges(std::span(&box_, 1), std::span(&whole, 1));
  const bool known = std::isfinite(whole.least) && !other;
  const int most_cells = known ? kMostKnown : kMostCells;
  const double edge = std::max(longest / most_cells, std::min(longest / 4, kCellSpacings * typical));
  for (std::size_t k = 0; k < 3; ++k) {
    counts_[k] = index_in<int>(std::ceil(size[k] / edge - 1e-9), 1, most_cells);
    edge_[k] = size[k] / counts_[k], inverse_[k] = counts_[k] / size[k];
  }
  const auto total = static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) *
                     static_cast<std::size_t>(counts_[2]);
  // The least spacing at the centre and, where it varies, near the corners.
  const bool even = known && *std::max_element(found.begin(), found.end()) <=
                                 (1 + 1e-6) * *std::min_element(found.begin(), found.end());
  const std::size_t tests = even ? 1 : 9;
  x.clear();
  x.reserve(tests * total);
  for (std::size_t c = 0; c < total; ++c) {
    const std::size_t i = c % static_cast<std::size_t>(counts_[0]);
    const std::size_t j = c / static_cast<std::size_t>(counts_[0]) % static_cast<std::size_t>(counts_[1]);
    const std::size_t k = c / static_cast<std::size_t>(counts_[0]) / static_cast<std::size_t>(counts_[1]);
    const Vec3 corner = box_.lower + Vec3{static_cast<double>(i) * edge_.x, static_cast<double>(j) * edge_.y,
                                          static_cast<double>(k) * edge_.z};
    for (int p = 9 - static_cast<int>(tests); p < 9; ++p) {
      const auto at = [&](int bit, double length) { return (p == 8 ? 0.5 : p >> bit & 1 ? 0.98 : 0.02) * length; };
      x.push_back(corner + Vec3{at(0, edge_.x), at(1, edge_.y), at(2, edge_.z)});
    }
  }
  found.resize(x.size());
  field.spacing(x, found);
  if (other) {
    std::vector<double> second(x.size());
    other->spacing(x, second);
    for (std::size_t i = 0; i < x.size(); ++i) found[i] = std::min(found[i], second[i]);
  }
  spacing_.resize(total);
  for (std::size_t c = 0; c < total; ++c) {
    const auto first = found.begin() + static_cast<std::ptrdiff_t>(tests * c);
    const double least = *std::min_element(first, first + static_cast<std::ptrdiff_t>(tests));
    spacing_[c] = static_cast<float>(std::isfinite(least) && least > 0 ? std::min(least, longest) : 1e-3 * longest);
  }
  find_ranges(field, ranges_, progress);
  if (other) find_ranges(*other, other_ranges_, progress);
}

void VolumeCells::find_ranges(const VolumeField& field, std::vector<ValueRange>& ranges, Progress& progress) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t total = spacing_.size();
  const auto nx = static_cast<std::size_t>(counts_[0]), ny = static_cast<std::size_t>(counts_[1]);
  const auto corner = [&](std::size_t c) {
    const std::size_t row = c / nx, layer = row / ny;
    return box_.lower + Vec3{static_cast<double>(c % nx) * edge_.x, static_cast<double>(row % ny) * edge_.y,
                             static_cast<double>(layer) * edge_.z};
  };
  std::vector<Box3> boxes(total);
  for (std::size_t c = 0; c < total; ++c) boxes[c] = {corner(c), corner(c) + edge_};
  ranges.assign(total, {-kInfinity, kInfinity});
  field.ranges(boxes, ranges);

  // As many points as are needed to see every sample; cells that would need too many have infinite ranges.
  struct Job {
    std::size_t cell;
    int points;
  };
  std::vector<Job> jobs;
  std::size_t sum = 0;
  for (std::size_t c = 0; c < total; ++c) {
    if (ranges[c].least > -kInfinity) continue;
    const double need = std::ceil(std::max({edge_.x, edge_.y, edge_.z}) / (1.2 * spacing(c)));
    if (!(need <= kMostPoints)) continue;
    jobs.push_back({c, index_in<int>(need, 2, kMostPoints)});
    sum += static_cast<std::size_t>(jobs.back().points * jobs.back().points * jobs.back().points);
  }
  if (sum > kBudget) return;
  constexpr std::size_t kBatch = 200000;
  std::vector<Vec3> x, gradients;
  std::vector<double> values;
  for (std::size_t begin = 0; begin < jobs.size();) {
    progress.check();
    x.clear();
    std::size_t end = begin;
    for (; end < jobs.size() && x.size() < kBatch; ++end) {
      const int n = jobs[end].points;
      const Vec3 low = corner(jobs[end].cell);
      for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i)
            x.push_back(low + Vec3{(i + 0.5) / n * edge_.x, (j + 0.5) / n * edge_.y, (k + 0.5) / n * edge_.z});
    }
    values.resize(x.size()), gradients.resize(x.size());
    field.evaluate(x, {values, gradients});
    std::size_t at = 0;
    for (; begin < end; ++begin) {
      const int n = jobs[begin].points;
      ValueRange& r = ranges[jobs[begin].cell];
      r = {kInfinity, -kInfinity};
      for (int p = 0; p < n * n * n; ++p, ++at) {
        const Vec3& g = gradients[at];
        const double way =
            kWider * 0.5 * (std::abs(g.x) * edge_.x + std::abs(g.y) * edge_.y + std::abs(g.z) * edge_.z) / n;
        r.least = std::min(r.least, values[at] - way), r.most = std::max(r.most, values[at] + way);
      }
      // Variation between the points beyond the slopes.
      const double slack = 0.05 * (r.most - r.least);
      r.least -= slack, r.most += slack;
    }
  }
}

double VolumeCells::exit(std::size_t cell, const Vec3& x, const Vec3& d, std::size_t around) const {
  const auto number = static_cast<std::uint32_t>(cell), nx = static_cast<std::uint32_t>(counts_[0]);
  const std::uint32_t row = number / nx, ny = static_cast<std::uint32_t>(counts_[1]);
  const int index[3] = {static_cast<int>(number - row * nx), static_cast<int>(row % ny), static_cast<int>(row / ny)};
  const int more = static_cast<int>(around);
  double t = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    if (d[k] == 0) continue;
    const int wall = d[k] > 0 ? index[k] + 1 + more : index[k] - more;
    if (wall <= 0 || wall >= counts_[k]) continue;  // outermost cells have no outer end
    t = std::min(t, (box_.lower[k] + static_cast<double>(wall) * edge_[k] - x[k]) / d[k]);
  }
  return std::max(0.0, t);
}

void detail::clear_reach(const VolumeCells& cells, std::span<std::uint8_t> clear) {
  // The distance in the maximum norm from the nearest cell that is not clear, separably along each axis. Along an axis
  // it is the least of max(previous distance, steps), and grows by at most one per step.
  const auto n = cells.counts();
  const auto nx = static_cast<std::size_t>(n[0]), ny = static_cast<std::size_t>(n[1]),
             nz = static_cast<std::size_t>(n[2]);
  for (std::uint8_t& c : clear) c = c ? 255 : 0;
  const std::size_t stride[3] = {1, nx, nx * ny}, count[3] = {nx, ny, nz};
  std::vector<std::uint8_t> line;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    line.resize(count[k]);
    for (std::size_t v = 0; v < count[b]; ++v)
      for (std::size_t u = 0; u < count[a]; ++u) {
        std::uint8_t* const first = &clear[u * stride[a] + v * stride[b]];
        for (std::size_t i = 0; i < count[k]; ++i) line[i] = first[i * stride[k]];
        for (std::size_t i = 0; i < count[k]; ++i) {
          // The search is limited by the distance found so far.
          unsigned found = line[i];
          for (unsigned d = 1; d < found; ++d) {
            if (d <= i) found = std::min(found, std::max<unsigned>(d, line[i - d]));
            if (i + d < count[k]) found = std::min(found, std::max<unsigned>(d, line[i + d]));
            if (d > i && i + d >= count[k]) break;
          }
          first[i * stride[k]] = static_cast<std::uint8_t>(found);
        }
      }
  }
}

}  // namespace sansmesh::inline v1
