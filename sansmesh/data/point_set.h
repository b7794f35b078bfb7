// The cloud: what every reader returns and every method takes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"

namespace sansmesh {

/// One number per sample, with a name: what was computed there.
struct Attribute {
  std::string name;  ///< a word, as files need it: k1, mean_curvature, …
  std::vector<float> values;
};

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
  /// Confidence or quality of each sample, larger is better, in the file's own scale.
  std::vector<float> confidence;
  /// Further numbers; every one as long as `positions`. Written to PLY and CSV.
  std::vector<Attribute> attributes;
  /// For merged range scans: which scanner position (index into `scanners`) saw the sample. May be empty.
  std::vector<std::uint16_t> scan_of_point;
  /// Scanner positions relative to `origin`, where known.
  std::vector<Vec3f> scanners;
  /// Triangles, where the file was a mesh or polygon soup (indices into positions); may be empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;

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

}  // namespace sansmesh
