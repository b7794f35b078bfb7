// How often values are in a volume, and how steep the field is where they are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

struct ValueHistogram {
  static constexpr std::size_t kBins = 256;
  double least = 0, most = 0;     ///< of all values
  double lower = 0, upper = 0;    ///< that the bins cover: all but a thousandth at each end
  double diagonal = 0;            ///< of the box of the volume; 0: unknown
  double across = 0;              ///< of a ray that meets that box, what lies in the volume, about; 0: unknown
  std::vector<double> share;      ///< of the values in each bin; those beyond count in the outermost. Sum 1
  std::vector<double> steepness;  ///< mean length of the gradient of those, 0 where there are none or nothing is known

  double value(std::size_t bin) const { return lower + (static_cast<double>(bin) + 0.5) / kBins * (upper - lower); }
};

/// Of these values, those that are not finite left out; lengths of gradients are as many or none. Throws DataError
/// where no value is finite.
ValueHistogram value_histogram(std::span<const double> values, std::span<const double> gradients = {});

/// At most so many of a list of places, evenly over the list; those that are not finite are left out.
std::vector<Vec3> some_places(std::span<const Vec3> places, std::size_t most);

/// Of a field of one component, at about so many points of a lattice over its box, those inside of the volume. Where
/// fewer than one in 50 are (thin shells, parts that are far apart), as many of the `places` count, too, which the
/// caller knows to lie in the volume or on its boundary (its samples, say; those that are not finite are left out), and
/// are not asked for. Without places finer lattices are tried, up to 64 times as many points, until a point is inside.
/// Throws DataError where none is.
ValueHistogram value_histogram(const VolumeField& field, std::size_t points = 100000,
                               std::span<const Vec3> places = {});

}  // namespace sansmesh::inline v1
