// The motion of samples onto a surface, from a start that is near.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/mesh/align/align_side.h"

namespace sansmesh::inline v1::detail {

struct PoseFitOptions {
  int iterations = 40;
  double reach = 0;        ///< farthest distance that counts at first (0: what holds most of the samples)
  double least_reach = 0;  ///< and at last
  bool scale = false;
  bool signs = true;        ///< normals that look the other way do not belong together
  double last_step = 1e-6;  ///< root mean square of the motion of samples; a shorter step is the last,
                            ///< not counting motions that the distances do not tell
};

/// A motion of which less than this shows in the distances is not told by them.
constexpr double kToldShare = 3e-4;

struct FitResult {
  Pose pose;
  int iterations = 0;
  double reach = 0;  ///< at last
  /// Share of each independent motion that shows in the distances, ascending; of the last step.
  std::vector<double> told;
};

/// Whether two normals belong together: less than 60° apart, or opposite unless `signs`. Unknown normals do.
bool alike_normals(const Vec3& a, const Vec3& b, bool signs);

/// Gauss and Newton's steps on the distances to the surface's tangent planes, by Tukey's weights.
/// `closest(place, reach, foot)` finds the surface: a SampleSurface or a WholeSurface.
template <class Surface>
FitResult fit_pose(const OrientedPoints& moving, const Surface& fixed, const Pose& start,
                   const PoseFitOptions& options);
extern template FitResult fit_pose(const OrientedPoints&, const SampleSurface&, const Pose&, const PoseFitOptions&);
extern template FitResult fit_pose(const OrientedPoints&, const WholeSurface&, const Pose&, const PoseFitOptions&);

/// How well samples lie on a surface: the mean over all of (1 − (distance / reach)²)², of those that do.
template <class Surface>
double share_on(const OrientedPoints& moving, const Surface& fixed, const Pose& pose, double reach, bool signs);
extern template double share_on(const OrientedPoints&, const SampleSurface&, const Pose&, double, bool);
extern template double share_on(const OrientedPoints&, const WholeSurface&, const Pose&, double, bool);
/// The same for samples of the fixed surface on the moving one.
template <class Surface>
double share_back(const OrientedPoints& fixed, const Surface& moving, const Pose& pose, double reach, bool signs);
extern template double share_back(const OrientedPoints&, const SampleSurface&, const Pose&, double, bool);
extern template double share_back(const OrientedPoints&, const WholeSurface&, const Pose&, double, bool);

/// Of each sample the distance to the surface; nothing where they do not belong together. `any`: whatever its
/// distance, and whether or not it is beyond the border.
std::vector<std::optional<double>> distances_to(const OrientedPoints& moving, const WholeSurface& fixed,
                                                const Pose& pose, double reach, bool signs, bool any);

}  // namespace sansmesh::inline v1::detail
