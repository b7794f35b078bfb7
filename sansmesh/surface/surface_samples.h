// Samples of a surface with positions, normals, local spacing and a tree: the input of all meshless surfaces.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// A cloud in an order that keeps neighbours together. Arrays of equal length; positions relative to the cloud's
/// origin.
struct SurfaceSamples {
  KdTree tree;  ///< tree of `positions`; its indices refer to these arrays
  std::vector<Vec3f> positions, normals;
  std::vector<std::uint32_t> source;  ///< index of the sample in the cloud
  /// Edge of the square of a sample's area, √(π d² / k) with d the distance to its k = 16th neighbour, averaged over
  /// these neighbours: supports follow the density (length).
  std::vector<float> spacing;
  double median_spacing = 0, noise = 0;  ///< spacing and noise of the cloud (length)
  /// Median distance to the nearest other sample over the spacing: 1 for a square lattice, 0.5 for random positions.
  double evenness = 1;

  std::size_t size() const { return positions.size(); }
};

/// Skips samples without a position or a normal. Throws DataError if there are no normals, fewer than 9 samples remain,
/// or all of them coincide. `noise` (length): known value that replaces its estimation.
SurfaceSamples prepare_samples(const PointSet& points, Progress& progress, std::optional<double> noise = {});

/// Replaces the normals by means over neighbours, with compact weights of the given width over the spacing and without
/// those that face the opposite way. Normals estimated from noisy positions follow the noise; the means do so less.
void smooth_normals(SurfaceSamples& samples, double smoothing, int rounds);
/// The same as often as the noise requires: never below a tenth of the spacing, else once or twice.
void smooth_noisy_normals(SurfaceSamples& samples, double smoothing);

/// Moves the samples along their normals onto the mean of the samples around them, with the same weights: the centres
/// of tangent planes of hoppe1992. `tree` keeps the original positions.
void move_to_means(SurfaceSamples& samples, double smoothing);
/// The same if the noise is at least a tenth of the spacing.
void move_noisy_to_means(SurfaceSamples& samples, double smoothing);

/// 0 for even samples (by their `evenness`), 1 for random ones.
double unevenness(const SurfaceSamples& samples);

/// Radius of the balls around the samples that form the domain of a surface, over the local spacing: large enough to
/// leave no unintended hole. 1.2 for even samples; 2 for random samples, where a disc of that radius is empty about
/// once in 300,000 times; more with noise.
double default_reach(const SurfaceSamples& samples);

}  // namespace sansmesh::inline v1
