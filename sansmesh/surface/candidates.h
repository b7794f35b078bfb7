// The samples of a surface ready for the kernels: for each group of points, those whose supports reach it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/surface/sample_group.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::inline v1::detail {

enum class WeightKind {
  compact,  ///< (1 − d²/(2h)²)⁴: resembles exp(−d²/h²) (the difference stays below 0.075), with a third of the
            ///< neighbours
  gaussian  ///< exp(−d²/h²), cut off at √12 h
};

/// Widths h of the weights: `smoothing` × local spacing, or one length for all. Gaussians without a length: `smoothing`
/// × median spacing for all.
std::vector<float> weight_widths(const SurfaceSamples& samples, double smoothing, const std::optional<double>& width,
                                 SurfaceWeights weights = SurfaceWeights::compact);

/// Throws ArgumentError for widths of more than 20 times the largest local spacing: every point would see most of the
/// cloud.
void check_width(const SurfaceSamples& samples, double width);

class Candidates {
 public:
  Candidates() = default;
  /// `reach`: radius of the domain's balls over the local spacing (never beyond the support).
  Candidates(const SurfaceSamples& samples, const std::vector<float>& widths, WeightKind kind, double reach);

  /// Samples count alike, whatever area they stand for.
  void count_alike();
  /// For setting what else the kernels need of each sample; positions are relative to the cloud's origin.
  std::vector<Candidate>& all() { return candidates_; }
  const Box3& bounds() const { return bounds_; }
  std::vector<float> reach() const;

  /// Calls visit(group, candidates, mixed) for groups of points that lie together, for large batches in parallel.
  /// mixed: some of the candidates look more than 90° away from others, so that more than one sheet may be there.
  using Visit = std::function<void(const PointGroup&, std::span<const Candidate>, bool mixed)>;
  void for_each_group(std::span<const Vec3> x, const Visit& visit) const;

 private:
  bool gather(const PointGroup& group, const Box3f& box, std::vector<Candidate>& chosen) const;

  std::vector<Candidate> candidates_;
  BallTree supports_;
  Box3 bounds_;
  double extent_ = 0;
};

}  // namespace sansmesh::inline v1::detail
