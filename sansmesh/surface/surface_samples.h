// What every surface from samples starts with: positions, normals, how far apart they are there, and a tree of
// supports.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// A cloud in an order that keeps neighbours together. Arrays of equal length; positions relative to the cloud's
/// origin.
struct SurfaceSamples {
  KdTree tree;  ///< of `positions`: its indices are places in these arrays
  std::vector<Vec3f> positions, normals;
  std::vector<std::uint32_t> source;  ///< the sample's index in the cloud
  /// Edge of the square that each sample stands for, √(π d² / k) with d the distance to its k = 16th neighbour,
  /// averaged over these neighbours: supports that grow and shrink with the density (length).
  std::vector<float> spacing;
  double median_spacing = 0, noise = 0;  ///< of the cloud (length)
  /// Median distance to the nearest other sample over the spacing: 1 for a square lattice, 0.5 for places at random.
  double evenness = 1;

  std::size_t size() const { return positions.size(); }
};

/// Samples without a position or a normal are left out. Throws DataError if there are no normals, or fewer than 9
/// samples are left, or all of them coincide. `noise` (length), where it is known, saves its estimation.
SurfaceSamples prepare_samples(const PointSet& points, Progress& progress, std::optional<double> noise = {});

/// Replaces the normals by means over neighbours with the compact weights of the given width over spacing, without
/// those that face the other way. Estimated normals follow the noise of the positions that they were estimated from;
/// the means do so less.
void smooth_normals(SurfaceSamples& samples, double smoothing, int rounds);
/// The same as often as the noise asks for: not at all below a tenth of the spacing, else once or twice.
void smooth_noisy_normals(SurfaceSamples& samples, double smoothing);

/// Moves the samples along their normals onto the mean of those around them, with the same weights: the centres of
/// tangent planes, as Hoppe et al. (1992) have them. `tree` keeps the places that they had.
void move_to_means(SurfaceSamples& samples, double smoothing);
/// The same where the noise asks for it: from a tenth of the spacing on.
void move_noisy_to_means(SurfaceSamples& samples, double smoothing);

/// 0 where samples lie evenly (by their `evenness`), 1 where they lie at random.
double unevenness(const SurfaceSamples& samples);

/// Radius of the balls around the samples in which a surface is defined, over the local spacing: large enough that they
/// leave no hole where none is meant. 1.2 for even samples; 2 for samples at random, of which a disc of that radius
/// stays empty about once in 300,000 times; more with noise.
double default_reach(const SurfaceSamples& samples);

}  // namespace sansmesh::inline v1
