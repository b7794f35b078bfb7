// Surfaces that move, from one triangulation of space and time: the zero set of a field in (x, y, z, t) is cut out of
// the J₁ᴬ triangulation in four dimensions (castelo2006), where it consists of tetrahedra, and meshes at single moments
// are cuts of these by t = const.
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

struct SpaceTimeOptions {
  double cell = 0;  ///< edge of the smallest blocks (length); required
  /// How long the smallest blocks last (time), made less so that a whole number fills the times of the field; required.
  /// A surface that moves by `cell` meanwhile is followed well.
  double time_cell = 0;
  /// Blocks in which the field is linear up to this (length) are not divided further. 0: all are that hold the surface.
  double mesh_error = 0;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Tetrahedra in space and time.
struct SpaceTimeMesh {
  std::vector<std::array<double, 4>> vertices;  ///< x, y, z (length) and t (time)
  /// Of (c_1 − c_0, c_2 − c_0, c_3 − c_0, a vector to where the field is larger) the determinant is positive.
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
};

/// The zero set of the continuous function that is linear on the simplices of the triangulation and has the values of
/// the field at their vertices. Outside bounds() of the field nothing is inside: what leaves them is closed there.
/// Deterministic for any number of threads.
class SpaceTimeSurface {
 public:
  /// Divides space and time. `field` must outlive this. Throws ArgumentError for bad options and if there would be more
  /// than 16 million blocks or 13 levels.
  SpaceTimeSurface(const TimeField& field, const SpaceTimeOptions& options, Progress& progress);
  ~SpaceTimeSurface();
  SpaceTimeSurface(SpaceTimeSurface&&) noexcept;
  SpaceTimeSurface& operator=(SpaceTimeSurface&&) noexcept;

  /// The surface at a moment, or at one of the lattice that is less than a 400th of `time_cell` away: a closed,
  /// consistently oriented 2-manifold, or nothing where no part of it exists then. Its vertices move continuously with
  /// t as long as they exist: each lies in a triangle of lattice vertices of which two stay on either side of t.
  /// Positions are relative to `origin`. Throws ArgumentError outside times() of the field.
  TriangleMesh slice(double t, const Vec3& origin = {}) const;

  /// All of it: a 3-manifold whose boundary lies at the first and the last moment. Large: some hundred tetrahedra a
  /// block.
  SpaceTimeMesh mesh() const;

  std::size_t blocks() const;  ///< leaves of the tree
  double cell() const;         ///< edge of the smallest ones (length)
  double time_cell() const;    ///< how long these last

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
