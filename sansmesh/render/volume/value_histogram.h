// Frequencies of values in a volume, and gradient lengths by value.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

struct ValueHistogram {
  static constexpr std::size_t kBins = 256;
  double least = 0, most = 0;     ///< range of all values
  double lower = 0, upper = 0;    ///< range of the bins: all but a thousandth at each end
  double diagonal = 0;            ///< diagonal of the volume's box; 0: unknown
  double across = 0;              ///< approximate mean length inside the volume of rays that meet its box; 0: unknown
  std::vector<double> share;      ///< share of the values in each bin; values beyond count in the outermost ones. Sum 1
  std::vector<double> steepness;  ///< mean gradient length per bin; 0 for empty bins or unknown gradients

  double value(std::size_t bin) const { return lower + (static_cast<double>(bin) + 0.5) / kBins * (upper - lower); }
};

/// Histogram of the finite values; there are as many gradient lengths, or none. Throws DataError if no value is finite.
ValueHistogram value_histogram(std::span<const double> values, std::span<const double> gradients = {});

/// At most `most` of the finite points, evenly from the list.
std::vector<Vec3> selected_points(std::span<const Vec3> samples, std::size_t most);

/// Histogram of a field of one component, at those of about `points` points of a lattice over its box that are inside
/// the volume. If fewer than one in 50 are inside (thin shells, scattered parts), as many of the `samples` are added
/// without a test; they must be in the volume or on its boundary (usually its samples; non-finite ones are left out).
/// Without samples, finer lattices of up to 64 times as many points are tried until a point is inside. Throws DataError
/// if none is. Values beyond `held`, which is extrapolated, count as its ends.
ValueHistogram value_histogram(const VolumeField& field, std::size_t points = 100000,
                               std::span<const Vec3> samples = {}, const std::optional<ValueRange>& held = {});

}  // namespace sansmesh::inline v1
