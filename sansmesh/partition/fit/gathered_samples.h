// The samples in a ball as a structure of arrays, and the passes of a local fit over them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/partition/fit/local_fit.h"
#include "sansmesh/partition/local_function.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Samples [first, last) of a sorted cloud.
struct SampleRange {
  std::uint32_t first, last;
};

/// Samples in a ball, relative to its centre. Padded to a whole number of SIMD vectors with samples at infinity.
class GatheredSamples {
 public:
  static constexpr std::size_t kLanes = 8;  ///< on every instruction set, so that sums are equal

  std::size_t size() const { return size_; }
  const Vec3f& center() const { return center_; }
  std::span<const std::uint32_t> ids() const { return {ids_.data(), size_}; }
  /// Component a of the positions relative to the centre, and of the normals.
  const float* position(std::size_t a) const { return rows_[a].data(); }
  const float* normal(std::size_t a) const { return rows_[3 + a].data(); }
  std::size_t padded() const { return (size_ + kLanes - 1) / kLanes * kLanes; }

  /// Replaces the samples by those of some ranges within `radius` of `center`: every stride-th of each range.
  void gather(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const SampleRange> ranges,
              const Vec3f& center, float radius, std::size_t stride = 1);

  /// Number of samples within a radius of the centre.
  std::size_t count(float radius) const;

  // Buffers with room for a vector more than `size`, for the kernels.
  float* row(std::size_t r) { return rows_[r].data(); }
  std::uint32_t* id_row() { return ids_.data(); }
  void resize(std::size_t size) { size_ = size; }

 private:
  void reserve(std::size_t n);
  Vec3f center_;
  std::array<std::vector<float>, 6> rows_;
  std::vector<std::uint32_t> ids_;
  std::size_t size_ = 0;
};

/// Sums over the samples with the weights (1 − t)², t = squared distance from the centre / radius².
struct BallSums {
  Vec3f normal, offset;  ///< Σ w n, Σ w (p − centre)
  float weight = 0;
};
BallSums sum_ball(const GatheredSamples& ball, float radius);

/// Frame of a projection: the middle of a ball relative to the samples' centre, its radius, and orthonormal axes.
/// `stretch`: radius² / height² − 1 for a ball that is `height` long along nu, else 0.
struct BallFrame {
  Vec3f middle;
  float scale, stretch;
  Vec3f xi, eta, nu;
};

/// The samples in a ball, seen along nu.
struct BallView {
  float kept = 0, away = 0;  ///< weight of the samples whose normals agree with nu, and of those that face away
  float least_cosine = 1;    ///< between nu and a normal
  float lower[2] = {1, 1}, upper[2] = {-1, -1};  ///< box of the kept samples in the plane, over the scale
  float eccentricity = 0;                        ///< distance of their centre of gravity from the centre
};

/// Replaces `samples` by those in the ball that face nu: in the frame's axes around the centre, divided by the scale.
BallView project_ball(const GatheredSamples& ball, const BallFrame& frame, LocalSamples& samples);

/// Weighted mean square of the distances of samples in the frame of `own` from a function with the same centre. Pads
/// the samples.
double mean_square_of(LocalSamples& samples, const LocalFunction& own, const LocalFunction& other);

/// The weights alone, in a ball around the centre.
BallView weigh_ball(const GatheredSamples& ball, float radius, const Vec3f& nu);

}  // namespace sansmesh::inline v1
