// Point cloud: result of every reader and input of every method.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Coordinate reference system of a cloud or mesh, as its file states it. Coordinates are never converted.
struct ReferenceSystem {
  std::string name;                     ///< "NAD83 / UTM zone 10N"; empty if unknown
  int code = 0;                         ///< EPSG code of the horizontal or geocentric system, 0 if unknown
  int vertical_code = 0;                ///< EPSG code of the heights, 0 if unknown
  std::string unit;                     ///< "metre", "foot", "US survey foot", "degree"; empty if unknown
  double metres = 0;                    ///< length of the unit in metres; 0 for angles and if unknown
  std::string vertical_unit;            ///< unit of the heights; empty if the file states none
  double vertical_metres = 0;           ///< length of that unit in metres, 0 if unknown
  std::string wkt;                      ///< well-known text (1 or 2) of the file; may be empty
  std::vector<std::uint16_t> geo_keys;  ///< GeoTIFF keys of the file (tag 34735); may be empty
  std::vector<double> geo_doubles;      ///< real numbers of the keys (tag 34736)
  std::string geo_ascii;                ///< texts of the keys (tag 34737)
};

/// Samples of a surface as a structure of arrays. Every optional array is either empty or as long as `positions`.
struct PointSet {
  /// Origin of the positions in the file's unit: world position = origin + position. Keeps survey coordinates
  /// (six-digit eastings with millimetres) exact in float.
  Vec3 origin;
  /// Positions of the samples relative to `origin`.
  std::vector<Vec3f> positions;
  /// Outward unit normals, zero if unknown; empty if the file has none.
  std::vector<Vec3f> normals;
  /// RGB, 0..255.
  std::vector<std::array<std::uint8_t, 3>> colors;
  /// Other properties of the samples (confidence, intensity, curvatures, …): a row each.
  AttributeTable attributes;
  /// Scan of each sample: index into `scanners`. For larger indices the scanner position is unknown, for kUnknownScan
  /// the scan too. May be empty.
  std::vector<std::uint16_t> scan_of_point;
  static constexpr std::uint16_t kUnknownScan = 65535;  ///< `scan_of_point` of an unknown scan
  /// Known scanner positions, relative to `origin`.
  std::vector<Vec3f> scanners;
  /// Names of the scans by index, usually files; may be incomplete or empty.
  std::vector<std::string> scan_names;
  /// Unit normals of organised clouds (depth frames) from neighbouring rows and columns, towards the sensor, zero if
  /// unknown. Too inaccurate for normals, but sufficient for their signs.
  std::vector<Vec3f> grid_normals;
  /// Triangles of a mesh or polygon soup (indices into positions); may be empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Properties of the triangles: a row each.
  AttributeTable triangle_attributes;
  /// All samples are on faces of a mesh, so none is a stray sample.
  bool of_faces = false;
  /// Reference system of the coordinates; null if unknown.
  std::shared_ptr<const ReferenceSystem> reference = {};

  /// Number of samples.
  std::size_t size() const { return positions.size(); }
  /// Whether there are normals; some may be unknown.
  bool has_normals() const { return !normals.empty(); }
  /// Whether there are colours.
  bool has_colors() const { return !colors.empty(); }
};

/// Bounding box of the positions (relative to the origin).
inline Box3f bounds(const PointSet& points) {
  Box3f box;
  for (const Vec3f& p : points.positions) box.extend(p);
  return box;
}

/// Keeps the samples with mask 0 and their properties, in order. Removes triangles with a removed corner. Throws
/// ArgumentError if the mask and the cloud differ in length.
SANSMESH_API void remove_samples(PointSet& points, const std::vector<std::uint8_t>& mask);

/// Cloud whose sample i is sample rows[i], with its properties but without triangles. Row numbers must exist.
SANSMESH_API PointSet take_samples(const PointSet& points, std::span<const std::uint32_t> rows);

}  // namespace sansmesh::inline v1
