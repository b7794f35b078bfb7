// Moving surfaces from one triangulation of space and time. The zero set of a field in (x, y, z, t) is extracted from
// the four-dimensional J₁ᴬ triangulation (castelo2006), where it consists of tetrahedra; meshes at single moments are
// their sections at t = const.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sansmesh/field/time_field.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

class SpaceTimeLattice;

struct SpaceTimeOptions {
  double cell = 0;  ///< edge of the smallest blocks (length); required
  /// Duration of the smallest blocks (time), reduced so that a whole number of blocks fills the field's time interval;
  /// required. A surface that moves by `cell` during this time is well resolved.
  double time_cell = 0;
  /// Blocks in which the field is linear up to this (length) are not divided further. 0: all crossing blocks are.
  double mesh_error = 0;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Tetrahedra in space and time.
struct SpaceTimeMesh {
  std::vector<std::array<double, 4>> vertices;  ///< x, y, z (length) and t (time)
  /// The determinant of (c_1 − c_0, c_2 − c_0, c_3 − c_0, direction of larger field values) is positive.
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
};

/// The zero set of the continuous function that is linear on the simplices and has the field's values at their
/// vertices. Outside bounds() of the field all is outside: a surface that leaves the bounds is closed there.
/// Deterministic for any number of threads.
class SpaceTimeSurface {
 public:
  /// Divides space and time. `field` must outlive this. Throws ArgumentError for bad options and for more than 16
  /// million blocks or 13 levels.
  SpaceTimeSurface(const TimeField& field, const SpaceTimeOptions& options, Progress& progress);
  ~SpaceTimeSurface();
  SpaceTimeSurface(SpaceTimeSurface&&) noexcept;
  SpaceTimeSurface& operator=(SpaceTimeSurface&&) noexcept;

  /// The surface at a moment, or at a lattice moment less than a 400th of `time_cell` away: a closed, consistently
  /// oriented 2-manifold, or empty where no surface exists. Its vertices move continuously with t as long as they
  /// exist: each is in a triangle of lattice vertices of which two stay on either side of t. Positions are relative to
  /// `origin`. Throws ArgumentError outside times() of the field.
  TriangleMesh slice(double t, const Vec3& origin = {}) const;

  /// The whole surface: a 3-manifold whose boundary is at the first and the last moment. Some hundred tetrahedra per
  /// block.
  SpaceTimeMesh mesh() const;

  std::size_t blocks() const;  ///< leaves of the tree
  double cell() const;         ///< edge of the smallest blocks (length)
  double time_cell() const;    ///< duration of the smallest blocks

 private:
  std::unique_ptr<SpaceTimeLattice> lattice_;
};

}  // namespace sansmesh::inline v1
