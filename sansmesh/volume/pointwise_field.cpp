#include "sansmesh/volume/pointwise_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/point_order.h"

namespace sansmesh::detail {
namespace {

constexpr std::size_t kPointwiseGrain = 128;

}  // namespace

std::size_t interval_of(std::span<const double> knots, bool uniform, double x) {
  const std::size_t last = knots.size() - 2;
  if (!(x > knots[1])) return 0;
  if (x >= knots[last]) return last;
  if (!uniform) return static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), x) - knots.begin()) - 1;
  const double step = (knots.back() - knots.front()) / static_cast<double>(knots.size() - 1);
  std::size_t i = std::min(last, static_cast<std::size_t>((x - knots.front()) / step));
  while (i > 0 && x < knots[i]) --i;  // the quotient is rounded
  while (i < last && x >= knots[i + 1]) ++i;
  return i;
}

PointwiseField::PointwiseField(std::shared_ptr<const SampledVolume> volume, VolumeValues values)
    : volume_(std::move(volume)), values_(std::move(values)), bounds_(volume_->bounds()), locator_(*volume_) {
  if (values_.values.size() != volume_->size() * values_.components)
    throw ArgumentError("`values` must have a row for each sample");
}

template <class Visit>
void PointwiseField::for_each_place(std::span<const Vec3> x, const Visit& visit) const {
  const std::vector<std::uint32_t> order = locality_order(x);
  parallel_ranges(0, x.size(), kPointwiseGrain, [&](std::size_t first, std::size_t last) {
    std::array<VolumePlace, kPointwiseGrain> places;
    std::array<Vec3, kPointwiseGrain> at;
    const std::size_t count = last - first;
    for (std::size_t k = 0; k < count; ++k) at[k] = x[order.empty() ? first + k : order[first + k]];
    locator_.locate(std::span(at).first(count), std::span(places).first(count));
    for (std::size_t k = 0; k < count; ++k) visit(order.empty() ? first + k : order[first + k], places[k]);
  });
}

void PointwiseField::evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const {
  const std::size_t n = components();
  const auto fits = [](std::size_t size, std::size_t want) { return size == 0 || size == want; };
  if (!fits(wanted.values.size(), x.size() * n) || !fits(wanted.gradients.size(), x.size() * n) ||
      !fits(wanted.inside.size(), x.size()) || !fits(wanted.degrees.size(), x.size()))
    throw ArgumentError("VolumeField: the answers are not as many as the points");
  const bool asked = !wanted.values.empty() || !wanted.gradients.empty() || !wanted.degrees.empty();
  for_each_place(x, [&](std::size_t i, const VolumePlace& place) {
    static thread_local std::vector<double> value;
    static thread_local std::vector<Vec3> slope;
    value.assign(n, 0), slope.assign(n, {});
    double* const values = wanted.values.empty() ? value.data() : wanted.values.data() + i * n;
    Vec3* const gradients = wanted.gradients.empty() ? slope.data() : wanted.gradients.data() + i * n;
    const bool finite = is_finite(x[i]), inside = finite && place.inside;
    std::uint8_t degree = 0;
    if (!finite || !asked) {
      std::fill_n(values, n, 0);
      std::fill_n(gradients, n, Vec3{});
    } else if (inside) {
      degree = answer(x[i], place, values, wanted.gradients.empty() ? nullptr : gradients);
    } else {
      Vec3 nearest;
      for (std::size_t c = 0; c < place.corner_count; ++c)
        nearest +=
            (volume_->lattice ? volume_->lattice->position(place.corners[c]) : volume_->corner(place.corners[c])) *
            place.weights[c];
      degree = answer(nearest, place, values, gradients);
      const Vec3 beyond = held_outside(*volume_, place, x[i] - nearest);
      for (std::size_t c = 0; c < n; ++c) values[c] += dot(gradients[c], beyond);
    }
    if (!wanted.inside.empty()) wanted.inside[i] = inside;
    if (!wanted.degrees.empty()) wanted.degrees[i] = degree;
  });
}

void PointwiseField::spacing(std::span<const Vec3> x, std::span<double> found) const {
  if (found.size() != x.size()) throw ArgumentError("VolumeField: as many spacings as points are needed");
  for_each_place(x, [&](std::size_t i, const VolumePlace& place) { found[i] = local_spacing(*volume_, place); });
}

std::uint8_t WeightedField::answer(const Vec3& x, const VolumePlace& place, double* values, Vec3* gradients) const {
  static thread_local std::vector<SampleWeight> found;
  weights(x, place, gradients != nullptr, found);
  const std::size_t n = components();
  std::fill_n(values, n, 0);
  if (gradients) std::fill_n(gradients, n, Vec3{});
  if (found.empty()) return 0;
  // Gradients as sums of differences: large slopes of opposite sign leave nothing of a constant.
  const double* const base = samples().values.data() + found.front().sample * n;
  for (const SampleWeight& w : found) {
    const double* const f = samples().values.data() + w.sample * n;
    for (std::size_t c = 0; c < n; ++c) {
      values[c] += w.weight * f[c];
      if (gradients) gradients[c] += w.slope * (f[c] - base[c]);
    }
  }
  return 0;
}

}  // namespace sansmesh::detail
