// Fits samples to a surface by a motion, from a nearby start.
#pragma once

#include <optional>
#include <vector>

#include "sansmesh/mesh/align/align_side.h"

namespace sansmesh::inline v1::detail {

struct PoseFitOptions {
  int iterations = 40;
  double reach = 0;        ///< initial largest distance (0: one that contains most samples)
  double least_reach = 0;  ///< final largest distance
  bool scale = false;
  bool signs = true;  ///< opposite normals do not match
  /// Least rms motion of the samples per step, apart from motions that the distances do not determine; a smaller step
  /// is the last.
  double last_step = 1e-6;
};

/// Motions that change the distances by less than this share are undetermined.
constexpr double kDeterminedShare = 3e-4;

struct FitResult {
  Similarity pose;
  int iterations = 0;
  double reach = 0;  ///< final largest distance
  /// Share of each independent motion that the distances determine, ascending; of the last step.
  std::vector<double> determined;
};

/// Whether two normals match: less than 60° apart, or opposite unless `signs`. Unknown normals match.
bool alike_normals(const Vec3& a, const Vec3& b, bool signs);

/// Gauss–Newton on the distances to the tangent planes of the surface, with Tukey weights. `closest(point, reach,
/// foot)` evaluates the surface: a SampleSurface or a WholeSurface.
template <class Surface>
FitResult fit_pose(const OrientedPoints& moving, const Surface& fixed, const Similarity& start,
                   const PoseFitOptions& options);
extern template FitResult fit_pose(const OrientedPoints&, const SampleSurface&, const Similarity&,
                                   const PoseFitOptions&);
extern template FitResult fit_pose(const OrientedPoints&, const WholeSurface&, const Similarity&,
                                   const PoseFitOptions&);

/// Overlap of two surfaces, 0..1: the mean, over the samples of both, of (1 − (distance / reach)²)², which is 0 for
/// samples off the other surface.
template <class Surface>
double mutual_overlap(const OrientedPoints& moving, const Surface& fixed_surface, const OrientedPoints& fixed,
                      const Surface& moving_surface, const Similarity& pose, double reach, bool signs);
extern template double mutual_overlap(const OrientedPoints&, const SampleSurface&, const OrientedPoints&,
                                      const SampleSurface&, const Similarity&, double, bool);
extern template double mutual_overlap(const OrientedPoints&, const WholeSurface&, const OrientedPoints&,
                                      const WholeSurface&, const Similarity&, double, bool);

/// Distance of each sample to the surface; nothing for samples that do not match. `any`: at any distance, and beyond
/// borders.
std::vector<std::optional<double>> distances_to(const OrientedPoints& moving, const WholeSurface& fixed,
                                                const Similarity& pose, double reach, bool signs, bool any);

}  // namespace sansmesh::inline v1::detail
