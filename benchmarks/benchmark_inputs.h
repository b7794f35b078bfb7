// Lists of words, and random query points in volumes, for benchmarks.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"

namespace sansmesh::benchmark {

/// Parts of a text between separators.
inline std::vector<std::string> split(std::string_view text, char at = ',') {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = std::min(text.find(at), text.size());
    parts.emplace_back(text.substr(0, end));
    if (end == text.size()) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Random positions in a volume, uniformly distributed.
inline std::vector<Vec3> points_inside(const SampledVolume& volume, std::size_t count) {
  const VolumeLocator locator(volume);
  const Box3 box = volume.bounds();
  std::mt19937 random(12345);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Vec3> inside;
  while (inside.size() < count) {
    std::vector<Vec3> x(count);
    for (Vec3& p : x)
      for (std::size_t k = 0; k < 3; ++k) p[k] = box.lower[k] + uniform() * box.size()[k];
    std::vector<CellLocation> locations(x.size());
    locator.locate(x, locations);
    for (std::size_t i = 0; i < x.size() && inside.size() < count; ++i)
      if (locations[i].inside) inside.push_back(x[i]);
  }
  return inside;
}

}  // namespace sansmesh::benchmark
