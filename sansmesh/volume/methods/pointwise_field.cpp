#include "sansmesh/volume/methods/pointwise_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/grid/point_order.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::size_t kLocatedGrain = 256,
                      kAtOnce = 32;  // points per task of a thread; points with their locations in memory

}  // namespace

LocatedField::LocatedField(std::shared_ptr<const SampledVolume> volume, VolumeValues values)
    : volume_(std::move(volume)), values_(std::move(values)), bounds_(volume_->bounds()), locator_(*volume_) {
  if (values_.values.size() != volume_->size() * values_.components)
    throw ArgumentError("`values` must have one row per sample");
}

template <class Visit>
void LocatedField::for_each_location(std::span<const Vec3> x, const Visit& visit) const {
  // Callers with few points continue from one call to the next (for example one particle per slot). The search starts
  // at the previous cell of the slot, even if another field of the same thread found it.
  static thread_local std::array<std::uint32_t, kLocatedGrain> slots{};
  const std::vector<std::uint32_t> order = locality_order(x);
  const bool few = x.size() <= slots.size();
  parallel_ranges(0, x.size(), kLocatedGrain, [&](std::size_t begin, std::size_t end) {
    std::array<CellLocation, kAtOnce> locations;
    std::array<Vec3, kAtOnce> sorted;
    std::uint32_t before = 0;
    for (std::size_t first = begin, count; first < end; first += count) {
      count = std::min(kAtOnce, end - first);
      const std::span<CellLocation> found = std::span(locations).first(count);
      const auto starts = few ? std::span(slots).subspan(first, count) : std::span(&before, 1);
      if (order.empty()) {
        locator_.locate(x.subspan(first, count), found, starts);
      } else {
        for (std::size_t k = 0; k < count; ++k) sorted[k] = x[order[first + k]];
        locator_.locate(std::span(sorted).first(count), found, starts);
      }
      for (std::size_t k = 0; k < count; ++k) visit(order.empty() ? first + k : order[first + k], locations[k]);
    }
  });
}

void LocatedField::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  const std::size_t n = components();
  if (!sizes_agree(wanted, x.size(), n)) throw ArgumentError("VolumeField: the numbers of answers and points differ");
  for_each_location(x, [&](std::size_t i, const CellLocation& location) {
    if (is_finite(x[i])) return evaluate_point(i, x[i], location, wanted);
    if (!wanted.values.empty()) std::fill_n(wanted.values.data() + i * n, n, 0.0);
    if (!wanted.gradients.empty()) std::fill_n(wanted.gradients.data() + i * n, n, Vec3{});
    if (!wanted.inside.empty()) wanted.inside[i] = 0;
  });
}

void LocatedField::spacing(std::span<const Vec3> x, std::span<double> found) const {
  if (found.size() != x.size()) throw ArgumentError("VolumeField: the numbers of spacings and points differ");
  for_each_location(x,
                    [&](std::size_t i, const CellLocation& location) { found[i] = local_spacing(*volume_, location); });
}

Vec3 LocatedField::position_of(const CellLocation& location) const {
  Vec3 at;
  for (std::size_t c = 0; c < location.corner_count; ++c)
    at += corner_position(*volume_, location.corners[c]) * location.weights[c];
  return at;
}

void PointwiseField::evaluate_point(std::size_t i, const Vec3& x, const CellLocation& location,
                                    const VolumeFieldValues& wanted) const {
  if (!wanted.inside.empty()) wanted.inside[i] = location.inside;
  if (wanted.values.empty() && wanted.gradients.empty()) return;
  const std::size_t n = components();
  static thread_local std::vector<double> value;
  static thread_local std::vector<Vec3> slope;
  value.assign(n, 0), slope.assign(n, {});
  double* const values = wanted.values.empty() ? value.data() : wanted.values.data() + i * n;
  Vec3* const gradients = wanted.gradients.empty() ? slope.data() : wanted.gradients.data() + i * n;
  if (location.inside) {
    evaluate_at(x, location, values, wanted.gradients.empty() ? nullptr : gradients);
  } else {
    const Vec3 nearest = position_of(location);
    evaluate_at(nearest, location, values, gradients);
    const Vec3 beyond = held_outside(volume(), location, x - nearest);
    for (std::size_t c = 0; c < n; ++c) values[c] += dot(gradients[c], beyond);
  }
}

void WeightedField::evaluate_at(const Vec3& x, const CellLocation& location, double* values, Vec3* gradients) const {
  static thread_local std::vector<SampleWeight> found;
  weights(x, location, gradients != nullptr, found);
  const std::size_t n = components();
  std::fill_n(values, n, 0);
  if (gradients) std::fill_n(gradients, n, Vec3{});
  if (found.empty()) return;
  // Gradients as sums of differences: a constant cancels exactly even with large slopes of opposite sign.
  const double* const base = samples().values.data() + found.front().sample * n;
  for (const SampleWeight& w : found) {
    const double* const f = samples().values.data() + w.sample * n;
    for (std::size_t c = 0; c < n; ++c) {
      values[c] += w.weight * f[c];
      if (gradients) gradients[c] += w.slope * (f[c] - base[c]);
    }
  }
}

}  // namespace sansmesh::inline v1::detail
