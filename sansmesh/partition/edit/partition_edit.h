// Editing of a fitted function (tejada2008, 4.4.4): selects supports and replaces their functions. All coordinates are
// those of the function, relative to its origin. Every edit returns new data that share unchanged arrays.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/partition/edit/edit_result.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Conditions on supports: all that are given must hold.
struct SupportQuery {
  struct Ball {
    Vec3f center;
    float radius;
  };
  struct HalfSpace {
    Vec3f point, normal;
  };
  std::optional<Ball> ball;             ///< the block meets the ball
  std::optional<Box3f> box;             ///< the block meets the box
  std::optional<HalfSpace> half_space;  ///< the block's centre is on the side of the normal
  std::optional<float> coverage_below;  ///< coverage of the support by its samples (tejada2008, 4.4.3)
  /// The samples are too few for a plane, or cover less than the degree (2, 3 or 4) requires.
  std::optional<PaperCoverage> coverage_fails;
  std::optional<float> error_above;  ///< rms distance of the samples from the zero set (length)
  std::optional<std::uint32_t> samples_below;
  std::optional<int> level_from, level_to;
  std::optional<std::vector<std::uint8_t>> flags;  ///< one per support, 1: may be selected
};
Selection select_supports(const PartitionData& data, const SupportQuery& query);

/// Replaces polynomials by those of this degree (0..4 or kAutomaticDegree), or of the highest below it that the samples
/// of a support determine. Removes creases. A support without enough samples is unchanged. Throws DataError without
/// samples.
EditResult set_degree(const PartitionData& data, const Selection& chosen, int degree, const EditSamples& samples,
                      Progress& progress);

/// Fits again below the largest blocks that the selection fills, with other options. Noise and accepted error are those
/// of the whole fit unless `options.error` is set. The new supports may have other sizes. Throws DataError without
/// samples, ArgumentError for invalid options.
EditResult refit(const PartitionData& data, const Selection& chosen, const PartitionOptions& options,
                 const EditSamples& samples, Progress& progress);

/// Range of the magnitude of constants, in radii of a support.
constexpr double kLeastConstant = 1e-3, kMostConstant = 1e3;
/// Replaces the functions by constants, positive: outside (erases a sheet), negative: inside (fills); in units of each
/// support's radius. Throws ArgumentError unless kLeastConstant ≤ |value| ≤ kMostConstant.
EditResult set_constant(const PartitionData& data, const Selection& chosen, float value);

/// Replaces each chosen function by the value that all unchosen ones have at its support's centre, with a magnitude
/// between kLeastConstant and kMostConstant radii. Throws DataError if all are chosen.
EditResult set_automatic_constant(const PartitionData& data, const Selection& chosen);

/// Removes the supports: neighbours and the far field determine the function there.
EditResult remove_supports(const PartitionData& data, const Selection& chosen);

}  // namespace sansmesh::inline v1
