// Neighbourhoods of samples by the mesh: rings of stars.
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

/// Gathers samples ring by ring. One object a thread; its memory is reused. `volume` must outlive it and be no lattice.
class SampleStencil {
 public:
  explicit SampleStencil(const SampledVolume& volume) : volume_(volume) {}

  /// The sample, its star, the stars of these and so on, whole rings until there are at least `enough` or nothing more
  /// is connected, at most `max_rings` of them. Of the last ring only the nearest by the metric are taken where there
  /// would be more than `most` (of equally near ones those of lower number). Nothing is reached across gaps of the
  /// mesh.
  void gather(std::uint32_t sample, const StarMetric& metric, std::size_t enough, std::size_t most, int max_rings);

  /// Ring after ring; the first is the sample itself.
  std::span<const std::uint32_t> samples() const { return samples_; }
  /// Local coordinates of these.
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
