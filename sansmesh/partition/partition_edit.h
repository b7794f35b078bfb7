// Editing of a fitted function (METHODS §3.4; tejada2008, section 4): choose supports, and replace what they hold.
// Everything is in the function's own coordinates, relative to its origin; every edit returns new data that share the
// arrays that it left alone.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/partition/edit_result.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// What a support must be like to be chosen: all conditions that are given must hold.
struct SupportQuery {
  struct Ball {
    Vec3f center;
    float radius;
  };
  struct HalfSpace {
    Vec3f point, normal;
  };
  std::optional<Ball> ball;             ///< its block meets the ball
  std::optional<Box3f> box;             ///< its block meets the box
  std::optional<HalfSpace> half_space;  ///< its block's centre lies on the side that the normal points to
  std::optional<float> coverage_below;  ///< of the support by its samples (METHODS §3.1)
  /// Its samples are too few for a plane, or do not cover as much of it as its degree needs: of degrees 2, 3 and 4.
  std::optional<PaperCoverage> coverage_fails;
  std::optional<float> error_above;  ///< rms distance of its samples from its zero set (length)
  std::optional<std::uint32_t> samples_below;
  std::optional<int> level_from, level_to;
  std::optional<std::vector<std::uint8_t>> flags;  ///< 1 where it may be chosen, of every support
};
Selection select_supports(const PartitionData& data, const SupportQuery& query);

/// Polynomials of this degree (0..4 or kAutomaticDegree), or of the highest below it that the samples of a support
/// determine. Creases in the supports go. A support without samples enough for any stays as it was. Throws DataError
/// without samples.
EditResult set_degree(const PartitionData& data, const Selection& chosen, int degree, const EditSamples& samples,
                      Progress& progress);

/// Fits anew below the largest blocks that the selection fills, with other options; noise and accepted error stay those
/// of the whole fit unless `options.error` says otherwise. Supports of other sizes may take the place of the chosen
/// ones. Throws DataError without samples, ArgumentError for bad options.
EditResult refit(const PartitionData& data, const Selection& chosen, const PartitionOptions& options,
                 const EditSamples& samples, Progress& progress);

/// Size of the constants that make sense, in radii of a support.
constexpr double kLeastConstant = 1e-3, kMostConstant = 1e3;
/// Constants in place of the functions, positive: outside (erases a sheet), negative: inside (fills); in units of each
/// support's radius. Throws ArgumentError unless kLeastConstant ≤ |value| ≤ kMostConstant.
EditResult set_constant(const PartitionData& data, const Selection& chosen, float value);

/// Constants that are what all other functions make of the supports' centres, as if the chosen ones were not there;
/// in size between kLeastConstant and kMostConstant radii. Throws DataError if all are chosen.
EditResult set_automatic_constant(const PartitionData& data, const Selection& chosen);

/// Takes the supports away: neighbours and the far field decide what is there.
EditResult remove_supports(const PartitionData& data, const Selection& chosen);

}  // namespace sansmesh::inline v1
