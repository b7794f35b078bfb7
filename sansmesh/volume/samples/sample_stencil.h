// Neighbourhoods of samples in the mesh: rings of stars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/samples/sample_set.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {

/// Gathers samples ring by ring. One object per thread; it reuses memory. `volume` must outlive it and be no lattice.
class SampleStencil {
 public:
  explicit SampleStencil(const SampledVolume& volume) : volume_(volume) {}

  /// The sample, its star, their stars and so on: whole rings until there are at least `enough` samples or no more
  /// connected ones, at most `max_rings` rings. If the last ring would exceed `most`, only its nearest samples in the
  /// metric are taken (among equally near ones those of smaller index). Gaps of the mesh are not crossed.
  void gather(std::uint32_t sample, const StarMetric& metric, std::size_t enough, std::size_t most, int max_rings);

  /// Ordered by rings; the first is the sample itself.
  std::span<const std::uint32_t> samples() const { return samples_; }
  /// Local coordinates of samples().
  std::span<const Vec3> local() const { return local_; }
  int rings() const { return rings_; }

 private:
  const SampledVolume& volume_;
  SampleSet seen_;
  std::vector<std::uint32_t> samples_;
  std::vector<Vec3> local_;
  std::vector<std::pair<double, std::uint32_t>> ring_;
  int rings_ = 0;
};

}  // namespace sansmesh::inline v1
