// The cloud: what every reader returns and every method takes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Samples of a surface as a structure of arrays. Every optional array is either empty or as long as `positions`.
struct PointSet {
  /// Positions relative to `origin`, in the file's unit. Survey coordinates (six-digit eastings with millimetres)
  /// lose nothing in float this way: world position = origin + position.
  Vec3 origin;
  std::vector<Vec3f> positions;
  /// Unit normals pointing outward, or zero where unknown; empty if the file has none.
  std::vector<Vec3f> normals;
  /// RGB, 0..255.
  std::vector<std::array<std::uint8_t, 3>> colors;
  /// Whatever else is known of each sample (confidence, intensity, curvatures, …): a row each.
  AttributeTable attributes;
  /// Which scan the sample is of: the index of the position that saw it (`scanners`). Of indices beyond these the
  /// position is unknown, of kUnknownScan the scan, too. May be empty.
  std::vector<std::uint16_t> scan_of_point;
  static constexpr std::uint16_t kUnknownScan = 65535;
  /// Scanner positions relative to `origin`, where known.
  std::vector<Vec3f> scanners;
  /// What the scans are called, by their index: files. As far as known; may be empty.
  std::vector<std::string> scan_names;
  /// Of clouds in rows and columns, such as depth frames: the unit normal of the grid at the sample, on the side from
  /// which it was seen, or zero where unknown. Too rough for a normal, but it tells the side.
  std::vector<Vec3f> grid_normals;
  /// Triangles, where the file was a mesh or polygon soup (indices into positions); may be empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// What is known of each triangle: a row each.
  AttributeTable triangle_attributes;
  /// Every sample lies on a face of a mesh, so there is a surface at each: none is a stray.
  bool of_faces = false;

  std::size_t size() const { return positions.size(); }
  bool has_normals() const { return !normals.empty(); }
  bool has_colors() const { return !colors.empty(); }
};

/// Smallest box around the positions (relative to the origin).
inline Box3f bounds(const PointSet& points) {
  Box3f box;
  for (const Vec3f& p : points.positions) box.extend(p);
  return box;
}

/// Keeps the samples whose mask is 0, with all that belongs to them, in order. Triangles with a removed corner go.
/// Throws ArgumentError if the mask has another length than the cloud.
SANSMESH_API void remove_samples(PointSet& points, const std::vector<std::uint8_t>& mask);

/// Sample i is what sample rows[i] is, with all that belongs to it but triangles. Row numbers must exist.
SANSMESH_API PointSet take_samples(const PointSet& points, std::span<const std::uint32_t> rows);

}  // namespace sansmesh::inline v1
