// Meshes of solids given by expressions.
#pragma once

#include <numbers>
#include <string>

#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/error.h"
#include "sansmesh/meshing/mesh_csg.h"

namespace sansmesh::test {

inline constexpr double kPi = std::numbers::pi;

inline double ball_volume(double r) { return 4 * kPi / 3 * r * r * r; }

inline Solid parsed(const std::string& text) {
  return parse_csg(text, [](const std::string& name) -> Solid { throw FileError(name, "not here"); });
}

inline TriangleMesh meshed(const Solid& solid, const CsgMeshOptions& options, CsgMeshReport& report) {
  Progress progress;
  return mesh_csg(solid, options, progress, &report);
}

}  // namespace sansmesh::test
