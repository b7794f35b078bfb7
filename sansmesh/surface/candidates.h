// Samples prepared for the kernels: the samples whose supports reach a group of points.
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

/// Widths h of the weights: `smoothing` × local spacing, or one length for all. For Gaussians without a length:
/// `smoothing` × median spacing for all.
std::vector<float> weight_widths(const SurfaceSamples& samples, double smoothing, const std::optional<double>& width,
                                 SurfaceWeights weights = SurfaceWeights::compact);

/// Throws ArgumentError for widths of more than 20 times the largest local spacing, because every point would then
/// reach most of the cloud.
void check_width(const SurfaceSamples& samples, double width);

class Candidates {
 public:
  Candidates() = default;
  /// `weights`: compact weights differ from Gaussians by less than 0.075, with a third of the neighbours. `reach`:
  /// radius of the domain's balls over the local spacing (at most the support).
  Candidates(const SurfaceSamples& samples, const std::vector<float>& widths, SurfaceWeights weights, double reach);

  /// Gives all samples the same weight, regardless of their area.
  void equalize_areas();
  /// Access for further data that the kernels need of each sample; positions are relative to the cloud's origin.
  std::vector<Candidate>& all() { return candidates_; }
  const Box3& bounds() const { return bounds_; }
  std::vector<float> reach() const;

  /// Calls visit(group, candidates, mixed) for groups of nearby points, in parallel for large batches. mixed: normals
  /// of candidates differ by more than 90°, so that the group may be near more than one sheet.
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
