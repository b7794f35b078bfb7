// What a solid amounts to: area, volume, centre of mass, moments of inertia, size.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/measure/smallest_box.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Of a solid of density 1; lengths in the unit of the mesh, positions in world coordinates.
struct MassMeasures {
  double volume = 0;  ///< length³; negative if the triangles face inward
  Vec3 center;        ///< of mass
  /// Principal moments of inertia about the centre, ascending (length⁵), and their axes: orthonormal, right-handed.
  /// Where moments are equal any axes do.
  std::array<double, 3> moments{};
  std::array<Vec3, 3> axes{};
};

struct BodyMeasures {
  std::size_t triangles = 0;
  std::size_t boundary_edges = 0;     ///< of one triangle
  std::size_t open_edges = 0;         ///< that more triangles run through in one direction than in the other
  std::size_t nonmanifold_edges = 0;  ///< of three triangles or more
  double area = 0;                    ///< length²
  Vec3 surface_center;                ///< mean of the surface's points
  Box3 box;
  /// Only if closed: there is no inside otherwise.
  std::optional<MassMeasures> mass;

  /// Every edge is run through as often in one direction as in the other: then the volume does not depend on where it
  /// is measured from.
  bool closed() const { return triangles > 0 && open_edges == 0; }

  /// Of a component: the winding number of the other closed components around it. 0 outside of all of them.
  int surrounding = 0;
  /// Its volume is neither that of a solid that stands free nor that of a cavity in one.
  bool misplaced() const { return mass && surrounding != (mass->volume < 0 ? 1 : 0); }

  static const ReportSchema& schema();
};

struct SolidMeasures {
  BodyMeasures whole;
  std::vector<BodyMeasures> components;  ///< sets of triangles that share vertices, largest area first
  MeshTopology topology;                 ///< of the whole
  /// Of least volume that was found: not larger than the upright one, nor than that along the principal axes.
  OrientedBox smallest_box;
  /// Triangles with a corner that is not finite or missing, or with two corners that are one.
  std::size_t left_out = 0;
  std::size_t crossing_pairs = 0;       ///< pairs of triangles that cut through each other
  std::size_t crossing_components = 0;  ///< components that cut through another one

  static const ReportSchema& schema();
};

/// Of the sewn mesh (sewn_mesh.h). Volume, centre and moments by the divergence theorem, exactly for the
/// polyhedron: cavities (components that face inward) are subtracted, overlaps count twice, and are counted
/// (`misplaced`, `crossing_pairs`). Deterministic for any
/// number of threads. Throws DataError if there is no triangle with an area.
SolidMeasures measure_solid(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
