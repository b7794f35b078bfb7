#include "sansmesh/approximation/sample_index.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

// Coordinates in the tree are in [−1, 1], those of queries are clamped to ±3: errors by rounding to float and by float
// arithmetic of a distance stay below this.
constexpr double kSlack = 4e-6;
constexpr std::size_t kSpacingSamples = 4096;

}  // namespace

void require_finite(std::span<const double> values, std::size_t components) {
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  if (bad == values.end()) return;
  const std::size_t sample = static_cast<std::size_t>(bad - values.begin()) / components;
  throw DataError("approximation: the value of sample " + std::to_string(sample) + " is not finite");
}

template <int D>
SampleIndex<D>::SampleIndex(std::span<const Position<D>> positions) : positions_(positions.begin(), positions.end()) {
  if (positions.empty()) throw DataError("approximation: no samples");
  lower_ = upper_ = positions[0];
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (std::size_t k = 0; k < D; ++k) {
      const double v = positions[i][k];
      if (!std::isfinite(v))
        throw DataError("approximation: the position of sample " + std::to_string(i) + " is not finite");
      lower_[k] = std::min(lower_[k], v);
      upper_[k] = std::max(upper_[k], v);
    }
  double extent = 0;
  for (std::size_t k = 0; k < D; ++k) {
    center_[k] = lower_[k] + (upper_[k] - lower_[k]) / 2;
    extent = std::max(extent, (upper_[k] - lower_[k]) / 2);
  }
  if (!std::isfinite(extent)) throw DataError("approximation: the samples' extent overflows");
  scale_ = extent > 0 && std::isnormal(1 / extent) ? 1 / extent : 1;
  std::vector<Vec3f> points(positions_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) points[i] = local(positions_[i]);
  tree_ = KdTree(points);
}

template <int D>
Vec3f SampleIndex<D>::local(const Position<D>& x) const {
  Vec3f p{};
  for (std::size_t k = 0; k < D; ++k) p[k] = static_cast<float>((x[k] - center_[k]) * scale_);
  return p;
}

template <int D>
void SampleIndex<D>::within(const Position<D>& x, double radius, std::vector<Hit>& out) const {
  thread_local std::vector<Neighbour> found;
  out.clear();
  // A query outside the box starts at the point where its ball enters the box, which keeps float coordinates small.
  double away = 0;
  Position<D> q;
  for (std::size_t k = 0; k < D; ++k) {
    if (!std::isfinite(x[k])) return;
    q[k] = std::clamp(x[k], center_[k] - 3 / scale_, center_[k] + 3 / scale_);
    away = std::max(away, std::abs(x[k] - q[k]));
  }
  if (away > radius) return;
  tree_.within(local(q), static_cast<float>(std::min(radius * scale_, 8.0) + kSlack), found);
  const double limit = radius * radius;
  out.reserve(found.size());
  for (const Neighbour& n : found) {
    const double r2 = sansmesh::squared_distance<D>(x, positions_[n.index]);
    if (r2 < limit) out.push_back({r2, n.index});
  }
}

template <int D>
void SampleIndex<D>::nearest(const Position<D>& x, std::size_t k, std::vector<Hit>& out) const {
  thread_local std::vector<Neighbour> found;
  out.clear();
  Position<D> q;
  for (std::size_t c = 0; c < D; ++c) {
    if (!std::isfinite(x[c])) return;
    q[c] = std::clamp(x[c], center_[c] - 1e6 / scale_, center_[c] + 1e6 / scale_);
  }
  found.resize(std::min(k, size()));
  found.resize(tree_.nearest(local(q), found));
  for (const Neighbour& n : found) out.push_back({sansmesh::squared_distance<D>(x, positions_[n.index]), n.index});
}

template <int D>
double SampleIndex<D>::spacing() const {
  const std::size_t n = size(), stride = (n + kSpacingSamples - 1) / kSpacingSamples;
  std::vector<double> distance((n + stride - 1) / stride);
  parallel_ranges(0, distance.size(), 256, [&](std::size_t first, std::size_t last) {
    std::vector<Hit> hits;
    for (std::size_t i = first; i < last; ++i) {
      nearest(positions_[order()[i * stride]], 2 * D + 1, hits);
      double r2 = 0;
      for (const Hit& hit : hits) r2 = std::max(r2, hit.squared_distance);
      distance[i] = std::sqrt(r2);
    }
  });
  // For D > 1 most samples of a small grid are on its boundary, where neighbours are farther away.
  const double usual = nth_smallest(distance, distance.size() / (D == 1 ? 2 : 4));
  if (usual > 0) return usual;
  double extent = 0;
  for (std::size_t k = 0; k < D; ++k) extent = std::max(extent, upper_[k] - lower_[k]);
  return extent > 0 ? extent / std::pow(static_cast<double>(n), 1.0 / D) : 1.0;
}

template class SampleIndex<1>;
template class SampleIndex<2>;
template class SampleIndex<3>;

}  // namespace sansmesh::inline v1
