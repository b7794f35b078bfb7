#include "sansmesh/volume/methods/grouped_field.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/grid/point_order.h"
#include "sansmesh/volume/methods/pointwise_field.h"

namespace sansmesh::inline v1 {
namespace {

// Below the number of points from which the locator sorts.
constexpr std::size_t kBlockPoints = 2000;
constexpr std::uint64_t kOutside = 1u << 31;

}  // namespace

struct GroupedField::Block {
  std::vector<Vec3> x;
  std::vector<std::uint32_t> at;
  std::vector<CellLocation> locations;
  std::vector<std::uint64_t> keys;
  std::unique_ptr<Memory> memory;
  // Results of a group outside the volume.
  std::vector<double> values;
  std::vector<Vec3> gradients;
  std::vector<std::uint8_t> degrees;
};

void GroupedField::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  evaluate_all(x, {wanted.values, wanted.gradients, wanted.inside, {}});
}

void GroupedField::degrees(std::span<const Vec3> x, std::span<std::uint8_t> found) const {
  evaluate_all(x, {{}, {}, {}, found});
}

void GroupedField::evaluate_all(std::span<const Vec3> x, const PolynomialValues& wanted) const {
  const std::size_t n = x.size(), c = components_;
  if (!detail::sizes_agree({wanted.values, wanted.gradients, wanted.inside}, n, c) ||
      (!wanted.degrees.empty() && wanted.degrees.size() != n))
    throw ArgumentError("VolumeField: the numbers of answers and points differ");
  const auto order = locality_order(x);
  parallel_ranges(0, (n + kBlockPoints - 1) / kBlockPoints, 1, [&](std::size_t begin, std::size_t end) {
    Block block;
    block.memory = memory();
    for (std::size_t b = begin; b < end; ++b)
      evaluate_block(x, order, b * kBlockPoints, std::min(n, (b + 1) * kBlockPoints), wanted, block);
  });
}

void GroupedField::spacing(std::span<const Vec3> x, std::span<double> found) const {
  if (found.size() != x.size()) throw ArgumentError("VolumeField: the numbers of spacings and points differ");
  std::vector<CellLocation> locations(x.size());
  locator_->locate(x, locations);
  parallel_for(0, x.size(), 1024, [&](std::size_t i) { found[i] = local_spacing(*volume_, locations[i]); });
}

void GroupedField::evaluate_block(std::span<const Vec3> x, std::span<const std::uint32_t> order, std::size_t first,
                                  std::size_t last, const PolynomialValues& wanted, Block& s) const {
  const std::size_t m = last - first;
  s.x.resize(m), s.at.resize(m), s.locations.resize(m), s.keys.clear();
  for (std::size_t i = 0; i < m; ++i) {
    s.at[i] = order.empty() ? static_cast<std::uint32_t>(first + i) : order[first + i];
    s.x[i] = x[s.at[i]];
  }
  locator_->locate(s.x, s.locations);
  for (std::size_t i = 0; i < m; ++i) {
    if (!wanted.inside.empty()) wanted.inside[s.at[i]] = s.locations[i].inside;
    if (is_finite(s.x[i])) {
      s.keys.push_back(static_cast<std::uint64_t>(s.locations[i].cell) << 32 | (s.locations[i].inside ? 0 : kOutside) |
                       i);
      continue;
    }
    for (std::size_t k = 0; k < components_; ++k) {
      if (!wanted.values.empty()) wanted.values[s.at[i] * components_ + k] = 0;
      if (!wanted.gradients.empty()) wanted.gradients[s.at[i] * components_ + k] = {};
    }
    if (!wanted.degrees.empty()) wanted.degrees[s.at[i]] = 0;
  }
  if (wanted.values.empty() && wanted.gradients.empty() && wanted.degrees.empty()) return;
  std::sort(s.keys.begin(), s.keys.end());
  for (std::size_t i = 0; i < s.keys.size();) {
    const auto number = [&] { return static_cast<std::size_t>(s.keys[i] & (kOutside - 1)); };
    Group group{s.locations[number()], 0, {}, {}, {}, {}};
    const std::uint64_t side = s.keys[i] / kOutside;  // cell, inside or outside
    for (; i < s.keys.size() && s.keys[i] / kOutside == side && group.size < kMostPoints; ++i, ++group.size) {
      const std::size_t p = number();
      const CellLocation& location = s.locations[p];
      group.locations[group.size] = &location;
      group.to[group.size] = s.at[p];
      group.x[group.size] = s.x[p];
      group.out[group.size] = {};
      if (location.inside) continue;
      Vec3 near;
      for (std::size_t v = 0; v < location.corner_count; ++v)
        near += corner_position(*volume_, location.corners[v]) * location.weights[v];
      group.x[group.size] = near;
      group.out[group.size] = s.x[p] - near;
    }
    if (side % 2 != 0 && goes_on_straight())
      evaluate_outside(group, wanted, s);
    else
      evaluate_group(group, *s.memory, wanted);
  }
}

void GroupedField::evaluate_outside(Group& group, const PolynomialValues& wanted, Block& s) const {
  const std::size_t n = group.size, c = components_;
  const auto to = group.to;
  std::iota(group.to.begin(), group.to.end(), 0u);
  s.values.resize(n * c), s.gradients.resize(n * c), s.degrees.resize(wanted.degrees.empty() ? 0 : n);
  evaluate_group(group, *s.memory, {s.values, s.gradients, {}, s.degrees, wanted.level});
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 beyond = held_outside(*volume_, *group.locations[i], group.out[i]);
    for (std::size_t k = 0; k < c; ++k) {
      const Vec3& gradient = s.gradients[i * c + k];
      if (!wanted.values.empty()) wanted.values[to[i] * c + k] = s.values[i * c + k] + dot(gradient, beyond);
      if (!wanted.gradients.empty()) wanted.gradients[to[i] * c + k] = gradient;
    }
    if (!wanted.degrees.empty()) wanted.degrees[to[i]] = s.degrees[i];
  }
}

}  // namespace sansmesh::inline v1
