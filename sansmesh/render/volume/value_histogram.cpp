#include "sansmesh/render/volume/value_histogram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kEnough = 50;  // one point in so many inside is enough
constexpr int kFiner = 2;            // number of times that the lattice is refined by two in each direction

/// About `points` centres of cubes that fill a box; flat boxes have at least one layer.
std::vector<Vec3> lattice_points(const Box3& box, std::size_t points) {
  const Vec3 size = box.size();
  const double floor = 1e-3 * std::max({size.x, size.y, size.z});
  const double edge = std::cbrt(std::max(size.x, floor) * std::max(size.y, floor) * std::max(size.z, floor) /
                                static_cast<double>(points));
  std::array<std::size_t, 3> n{};
  for (std::size_t k = 0; k < 3; ++k) n[k] = index_in<std::size_t>(size[k] / edge, 1, 100 * points);
  std::vector<Vec3> x;
  x.reserve(n[0] * n[1] * n[2]);
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i)
        x.push_back(box.lower + Vec3{(static_cast<double>(i) + 0.5) / static_cast<double>(n[0]) * size.x,
                                     (static_cast<double>(j) + 0.5) / static_cast<double>(n[1]) * size.y,
                                     (static_cast<double>(k) + 0.5) / static_cast<double>(n[2]) * size.z});
  return x;
}

struct FoundValues {
  std::vector<double> values, slopes;  // lengths of gradients
};

/// Mean length of rays through a box, times 3/2, so that for a cube it is the edge: 6 times volume over surface
/// (Cauchy: the mean is 4 times that ratio).
double length_across(const Box3& box) {
  const Vec3 size = box.size();
  const double floor = 1e-3 * std::max({size.x, size.y, size.z});
  const double x = std::max(size.x, floor), y = std::max(size.y, floor), z = std::max(size.z, floor);
  return 3 * x * y * z / (x * y + y * z + z * x);
}

/// Adds the values at the points in the volume, or at all.
void add_values(const VolumeField& field, std::span<const Vec3> x, bool all, FoundValues& found) {
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  std::vector<std::uint8_t> inside(all ? 0 : x.size());
  field.evaluate(x, {values, gradients, inside});
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!all && !inside[i]) continue;
    found.values.push_back(values[i]);
    found.slopes.push_back(safe_norm(gradients[i]));
  }
}

}  // namespace

std::vector<Vec3> selected_points(std::span<const Vec3> samples, std::size_t most) {
  std::vector<Vec3> x;
  const std::size_t count = std::min(samples.size(), most);
  x.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    // Evenly over the list: index i ⋅ size / count, without overflow of the product.
    const std::size_t at = samples.size() / count * i + samples.size() % count * i / count;
    if (is_finite(samples[at])) x.push_back(samples[at]);
  }
  return x;
}

ValueHistogram value_histogram(std::span<const double> values, std::span<const double> gradients) {
  if (!gradients.empty() && gradients.size() != values.size())
    throw ArgumentError("as many lengths of gradients as values are needed");
  std::vector<double> sorted;
  sorted.reserve(values.size());
  for (const double v : values)
    if (std::isfinite(v)) sorted.push_back(v);
  if (sorted.empty()) throw DataError("no value of the volume is finite");
  std::sort(sorted.begin(), sorted.end());
  ValueHistogram h;
  h.least = sorted.front(), h.most = sorted.back();
  const std::size_t rest = sorted.size() / 1000;
  h.lower = sorted[rest], h.upper = sorted[sorted.size() - 1 - rest];
  if (!(h.upper > h.lower)) h.lower = h.least, h.upper = h.most;
  h.share.assign(ValueHistogram::kBins, 0);
  h.steepness.assign(ValueHistogram::kBins, 0);
  const double scale = h.upper > h.lower ? ValueHistogram::kBins / (h.upper - h.lower) : 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const auto bin = index_in<std::size_t>((values[i] - h.lower) * scale, 0, ValueHistogram::kBins - 1);
    h.share[bin] += 1;
    if (!gradients.empty() && std::isfinite(gradients[i])) h.steepness[bin] += gradients[i];
  }
  for (std::size_t b = 0; b < ValueHistogram::kBins; ++b) {
    if (h.share[b] > 0) h.steepness[b] /= h.share[b];
    h.share[b] /= static_cast<double>(sorted.size());
  }
  return h;
}

ValueHistogram value_histogram(const VolumeField& field, std::size_t points, std::span<const Vec3> samples,
                               const std::optional<ValueRange>& held) {
  if (field.components() != 1) throw ArgumentError("a histogram needs a field of one component");
  const Box3 box = field.bounds();
  if (box.empty() || !(box.diagonal() > 0)) throw DataError("the volume has no extent");
  points = std::max<std::size_t>(points, 1);
  FoundValues found;
  add_values(field, lattice_points(box, points), false, found);
  std::size_t inside = found.values.size();
  if (inside * kEnough < points) {
    add_values(field, selected_points(samples, points), true, found);
    for (int finer = 0; found.values.empty() && finer < kFiner; ++finer) {
      add_values(field, lattice_points(box, points *= 8), false, found);
      inside = found.values.size();
    }
  }
  if (found.values.empty()) throw DataError("no point of the volume was found in its box");
  if (held)
    for (double& v : found.values) v = std::clamp(v, held->least, held->most);
  ValueHistogram h = value_histogram(found.values, found.slopes);
  h.diagonal = box.diagonal();
  const double share = static_cast<double>(std::max<std::size_t>(1, inside)) / static_cast<double>(points);
  h.across = std::min(1.0, share) * length_across(box);
  return h;
}

}  // namespace sansmesh::inline v1
