// Scans of an E57 file as its XML section describes them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/io/e57/e57_section.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Position of a scan: world = rotation · local + translation.
struct E57Pose {
  double w = 1;
  Vec3 xyz;  ///< with w a unit quaternion
  Vec3 translation;

  bool is_rotated() const { return xyz != Vec3{}; }
  Vec3 rotate(const Vec3& v) const {
    const Vec3 t = cross(xyz, v) * 2.0;
    return v + t * w + cross(xyz, t);
  }
  Vec3 apply(const Vec3& v) const { return is_rotated() ? rotate(v) + translation : v + translation; }
};

struct E57Scan {
  std::string name;  ///< printable; "2" if the file gives none
  std::uint64_t offset = 0, records = 0;
  std::vector<E57Field> fields;
  std::optional<E57Pose> pose;
  std::array<std::optional<std::array<double, 2>>, 3> color_limits;  ///< red, green, blue: least and largest

  /// Number of the field with that name, if there is one with numbers.
  std::optional<std::size_t> find(std::string_view field) const;
  /// Numbers of three fields, if all are there.
  std::optional<std::array<std::size_t, 3>> find(std::string_view a, std::string_view b, std::string_view c) const;
};

struct E57Content {
  std::vector<E57Scan> scans;  ///< those with points
  std::size_t empty_scans = 0, pictures = 0;
  std::string reference_system;  ///< coordinateMetadata: WKT; may be empty
};

/// Throws FileError if the XML is damaged or a scan cannot be read.
E57Content describe_scans(const Input& in, std::string_view xml);

}  // namespace sansmesh::inline v1::io
