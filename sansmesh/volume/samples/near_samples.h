// The nearest samples around a sample, on every kind of grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/samples/sample_stencil.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {

/// Finds the samples nearest to a sample in its metric. One object per thread; it reuses memory. On lattices any sample
/// within nine steps counts; elsewhere rings of stars are gathered, which do not cross gaps of the mesh.
class NearSamples {
 public:
  /// `metrics` are those of star_metrics(), empty for lattices. Both must outlive this.
  NearSamples(const SampledVolume& volume, std::span<const StarMetric> metrics);

  /// Finds at least `count` samples, if there are as many, and all that are as near as the last one.
  void gather(std::uint32_t sample, std::size_t count);

  /// Whether local() is the same as after the previous call, as inside uniform lattices.
  bool repeated() const { return repeated_; }

  /// Nearest first; the first is the sample itself.
  std::span<const std::uint32_t> samples() const { return samples_; }
  /// Local coordinates of samples().
  std::span<const Vec3> local() const { return local_; }
  /// Squared norms of local().
  std::span<const double> squares() const { return squares_; }
  /// The radius of a ball with `count` samples inside: between the count-th and the next distance.
  double radius(std::size_t count) const;

 private:
  struct Found {
    double square;
    std::uint32_t sample;
    Vec3 local;
    friend bool operator<(const Found& a, const Found& b) {
      return a.square != b.square ? a.square < b.square : a.sample < b.sample;
    }
  };
  void gather_on_lattice(std::uint32_t sample, std::size_t count);
  bool gather_inside(std::uint32_t sample, std::size_t count);

  const SampledVolume& volume_;
  std::span<const StarMetric> metrics_;
  SampleStencil stencil_;
  std::vector<Found> found_;
  std::vector<std::uint32_t> samples_;
  std::vector<Vec3> local_;
  std::vector<double> squares_;
  bool repeated_ = false;
  std::size_t inside_count_ = 0;        ///< count of the samples in `inside_`, 0: none
  std::size_t margin_ = 0;              ///< steps to the borders from where all of them are inside
  std::vector<std::ptrdiff_t> inside_;  ///< differences of the numbers of samples
};

}  // namespace sansmesh::inline v1
