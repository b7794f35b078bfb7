#include "sansmesh/volume/samples/sample_supports.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/axis_interval.h"
#include "sansmesh/volume/cells/cell_adjacency.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kMostOfMedian = 3;  ///< slivers along the hull of scattered samples are long

}  // namespace

double reach_of_radius(double radius) { return std::max(1.05, radius / std::numbers::sqrt3 * (1 + 1e-9)); }

SampleSupports::SampleSupports(const SampledVolume& volume, double reach) : volume_(volume), reach_(reach) {
  if (volume.lattice) return;
  const std::size_t n = volume.size();
  const bool in_cells = !volume.cell_sample.empty();
  const Adjacency cells = cells_of_samples(volume);
  const double fallback = std::max(1e-6 * volume.bounds().diagonal(), std::numeric_limits<double>::min());
  metrics_.resize(n);
  parallel_ranges(0, n, 256, [&](std::size_t first, std::size_t last) {
    std::vector<Vec3> star;
    std::vector<double> around;
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 x = volume.positions[i];
      star.clear();
      for (const std::uint32_t s : volume.stars[i]) star.push_back(volume.positions[s] - x);
      if (in_cells || star.empty())
        for (const std::uint32_t c : cells[i])
          for (const std::uint32_t corner : volume.cells[c]) star.push_back(volume.corner(corner) - x);
      metrics_[i] = star_metric(star, fallback);
      around.clear();
      double own = 0;  // farthest corner of a sample's own cell, which must be covered
      for (const Vec3& d : star)
        if (const double t2 = squared_norm(metrics_[i](d)); t2 > 0) around.push_back(t2);
      for (const std::uint32_t c : cells[i])
        for (const std::uint32_t corner : volume.cells[c]) {
          const double t2 = squared_norm(metrics_[i](volume.corner(corner) - x));
          if (t2 > 0) around.push_back(t2);
          if (in_cells) own = std::max(own, t2);
        }
      if (around.empty()) continue;
      const double most = *std::max_element(around.begin(), around.end());
      const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
      std::nth_element(around.begin(), middle, around.end());
      const double unit = std::max(own, std::min(most, kMostOfMedian * kMostOfMedian * *middle));
      for (Vec3f& row : metrics_[i].rows) row = Vec3f(Vec3(row) / std::sqrt(unit));
    }
  });
  tree_ = BoxTree(n, [&](std::size_t i) {
    // Half the box around an ellipsoid ‖M d‖ <= reach: the lengths of the rows of M⁻¹; M's rows are orthogonal.
    Vec3 half;
    for (const Vec3f& row : metrics_[i].rows) {
      const Vec3 r(row), axis = r / squared_norm(r);
      for (std::size_t k = 0; k < 3; ++k) half[k] += axis[k] * axis[k];
    }
    for (std::size_t k = 0; k < 3; ++k) half[k] = reach_ * std::sqrt(half[k]) * (1 + 1e-5);
    return Box3{volume.positions[i] - half, volume.positions[i] + half};
  });
}

double SampleSupports::width(std::size_t k, std::size_t i) const {
  const double step = lattice_step(volume_.lattice->axes[k], i);
  return 3 * step * step;
}

Vec3 SampleSupports::local(std::uint32_t sample, const Vec3& d) const {
  if (!volume_.lattice) return metrics_[sample](d);
  const auto at = volume_.lattice->indices(sample);
  Vec3 u;
  for (std::size_t k = 0; k < 3; ++k) u[k] = dot(volume_.lattice->directions[k], d) / std::sqrt(width(k, at[k]));
  return u;
}

Vec3 SampleSupports::transposed(std::uint32_t sample, const Vec3& u) const {
  if (!volume_.lattice) return metrics_[sample].transposed(u);
  const auto at = volume_.lattice->indices(sample);
  Vec3 d;
  for (std::size_t k = 0; k < 3; ++k) d += volume_.lattice->directions[k] * (u[k] / std::sqrt(width(k, at[k])));
  return d;
}

double SampleSupports::squared(std::uint32_t sample, const Vec3& d, Vec3& slope) const {
  if (volume_.lattice) {
    const Lattice& lattice = *volume_.lattice;
    const auto at = lattice.indices(sample);
    slope = {};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = dot(lattice.directions[k], d), over = along / width(k, at[k]);
      slope += lattice.directions[k] * over;
      sum += along * over;
    }
    return sum;
  }
  const Vec3 u = metrics_[sample](d);
  slope = metrics_[sample].transposed(u);
  return squared_norm(u);
}

void SampleSupports::covering_lattice(const Vec3& x, std::vector<Cover>& out) const {
  const Lattice& lattice = *volume_.lattice;
  const Vec3 a = lattice.to_axes(x);
  struct Part {
    std::size_t index;
    double square, slope;
  };
  static thread_local std::array<std::vector<Part>, 3> parts;
  const double most = reach_ * reach_;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double>& axis = lattice.axes[k];
    parts[k].clear();
    const std::size_t middle = interval_of(axis, lattice.uniform, a[k]);
    const auto visit = [&](std::size_t i) {
      const double d = a[k] - axis[i], slope = d / width(k, i);
      if (d * slope < most) parts[k].push_back({i, d * slope, slope});
      return d * slope < most;
    };
    // Widths may differ from knot to knot: the search continues after a few knots out of reach.
    constexpr int kPatience = 3;
    int missed = 0;
    for (std::size_t i = middle + 1; i-- > 0 && missed < kPatience;) missed = visit(i) ? 0 : missed + 1;
    std::reverse(parts[k].begin(), parts[k].end());
    missed = 0;
    for (std::size_t i = middle + 1; i < axis.size() && missed < kPatience; ++i) missed = visit(i) ? 0 : missed + 1;
  }
  const std::size_t nx = lattice.axes[0].size(), ny = lattice.axes[1].size();
  for (const Part& z : parts[2])
    for (const Part& y : parts[1])
      for (const Part& p : parts[0]) {
        const double t2 = p.square + y.square + z.square;
        if (!(t2 < most)) continue;
        out.push_back(
            {static_cast<std::uint32_t>(p.index + nx * (y.index + ny * z.index)), t2,
             lattice.directions[0] * p.slope + lattice.directions[1] * y.slope + lattice.directions[2] * z.slope});
      }
}

void SampleSupports::covering(const Vec3& x, std::vector<Cover>& out) const {
  out.clear();
  if (volume_.lattice) return covering_lattice(x, out);
  static thread_local std::vector<std::uint32_t> found;
  tree_.containing(x, found);
  for (const std::uint32_t i : found) {
    Cover cover{i, 0, {}};
    cover.squared = squared(i, x - volume_.positions[i], cover.slope);
    if (cover.squared < reach_ * reach_) out.push_back(cover);
  }
}

}  // namespace sansmesh::inline v1::detail
