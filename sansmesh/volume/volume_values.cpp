#include "sansmesh/volume/volume_values.h"

#include <cmath>

#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

/// Gives the samples that are not `known` the mean of the known ones of their stars, those next to them first, ring by
/// ring; samples that no ring reaches the mean of all.
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

}  // namespace

VolumeValues volume_values(const SampledVolume& volume, const std::string& name) {
  const Attribute* const array = volume.attributes.find(name);
  if (!array) {
    std::string names;
    for (const Attribute& a : volume.attributes) names += (names.empty() ? "" : ", ") + printable(a.name, 60);
    throw ArgumentError("there is no array '" + printable(name, 60) + "'; " +
                        (names.empty() ? "there are none at all" : "those there are: " + names));
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
  if (of.filled.size() == array->rows()) throw DataError("array '" + printable(name, 60) + "': no value is finite");
  if (!of.filled.empty()) fill_in(volume, known, of);
  return of;
}

}  // namespace sansmesh
