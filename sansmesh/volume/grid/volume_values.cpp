#include "sansmesh/volume/grid/volume_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Sets unknown samples to the mean of the known ones of their stars, ring by ring, nearest first; samples without a
/// connection to known ones get the mean of all.
void fill_in(const SampledVolume& volume, std::vector<std::uint8_t>& known, VolumeValues& of) {
  const std::size_t n = of.components;
  std::vector<double> whole(n, 0.0);
  double count = 0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i]) continue;
    ++count;
    for (std::size_t k = 0; k < n; ++k) whole[k] += (of.values[i * n + k] - whole[k]) / count;
  }
  std::vector<std::uint32_t> star, open = of.filled, ring, later;
  std::vector<double> found;
  while (!open.empty()) {
    ring.clear(), later.clear(), found.clear();
    for (const std::uint32_t i : open) {
      volume.star(i, star);
      std::vector<double> mean(n, 0.0);
      double neighbours = 0;
      for (const std::uint32_t j : star) {
        if (!known[j]) continue;
        ++neighbours;
        for (std::size_t k = 0; k < n; ++k) mean[k] += (of.values[j * n + k] - mean[k]) / neighbours;
      }
      if (neighbours > 0) {
        ring.push_back(i);
        found.insert(found.end(), mean.begin(), mean.end());
      } else {
        later.push_back(i);
      }
    }
    if (ring.empty()) {
      for (const std::uint32_t i : later)
        for (std::size_t k = 0; k < n; ++k) of.values[i * n + k] = whole[k];
      return;
    }
    for (std::size_t r = 0; r < ring.size(); ++r) {
      known[ring[r]] = 1;
      for (std::size_t k = 0; k < n; ++k) of.values[ring[r] * n + k] = found[r * n + k];
    }
    open.swap(later);
  }
}

void check_size(const VolumeValues& of, double spacing) {
  constexpr double kMost = 0x1p1000, kMostSlope = 0x1p1015;
  const double most = largest_value(of), slope = spacing > 0 ? most / spacing : most;
  if (most > kMost || slope > kMostSlope)
    throw DataError(
        fmt::format("array '{}': values of up to {:.4g} are too large: slopes between samples are no numbers",
                    printable(of.name, 60), most));
  // One component may be negligible relative to others: a direction without flow.
  if (most > 0 && most < 1 / kMost)
    throw DataError(fmt::format("array '{}': values of at most {:.4g} are too small to be distinguished",
                                printable(of.name, 60), most));
}

}  // namespace

double largest_value(const VolumeValues& values) {
  return parallel_reduce(
      values.values.size(), 1 << 16, 0.0,
      [&](std::size_t first, std::size_t last) {
        double most = 0;
        for (std::size_t i = first; i < last; ++i) most = std::max(most, std::abs(values.values[i]));
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
}

std::vector<double> value_scales(const VolumeValues& values) {
  const double scale = binary_scale(largest_value(values));
  return scale == 1 ? std::vector<double>() : std::vector<double>(values.components, scale);
}

VolumeValues scaled_values(VolumeValues values, std::span<const double> scales) {
  if (scales.empty()) return values;
  for (std::size_t i = 0; i < values.values.size(); ++i) values.values[i] *= scales[i % values.components];
  return values;
}

std::string no_array_named(const std::string& name, std::span<const std::string> available) {
  std::string list;
  for (const std::string& other : available) list += (list.empty() ? "" : ", ") + printable(other, 60);
  return "there is no array '" + printable(name, 60) + "'; " +
         (list.empty() ? "there are none" : "available are: " + list);
}

VolumeValues volume_values(const SampledVolume& volume, const std::string& name) {
  const Attribute* const array = volume.attributes.find(name);
  if (!array) {
    std::vector<std::string> names;
    for (const Attribute& a : volume.attributes) names.push_back(a.name);
    throw ArgumentError(no_array_named(name, names));
  }
  VolumeValues of;
  of.name = name, of.components = array->components;
  of.values.resize(array->size());
  std::visit(
      [&](const auto& numbers) {
        for (std::size_t i = 0; i < numbers.size(); ++i) of.values[i] = static_cast<double>(numbers[i]);
      },
      array->values);
  std::vector<std::uint8_t> known;
  for (std::size_t i = 0; i < array->rows(); ++i) {
    bool finite = true;
    for (const double v : of.of(i)) finite = finite && std::isfinite(v);
    if (finite) continue;
    if (known.empty()) known.assign(array->rows(), 1);
    known[i] = 0;
    of.filled.push_back(static_cast<std::uint32_t>(i));
  }
  if (of.filled.size() == array->rows())
    throw DataError("array '" + printable(name, 60) + "' has no finite value: there is nothing to reconstruct");
  if (!of.filled.empty()) fill_in(volume, known, of);
  check_size(of, volume.facts.least_spacing);
  return of;
}

}  // namespace sansmesh::inline v1
