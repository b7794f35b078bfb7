// Where particles start, as users write it: "line(0,0,0, 1,0,0, 50)".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// What a text of seeds stands for. Shapes: `points` in order; of files (points FILE, curve FILE, mesh FILE) only the
/// name, for whoever can read them.
struct Seeds {
  std::vector<Vec3> points;
  bool curve = false;   ///< the points follow one another along a curve
  bool closed = false;  ///< and the last is followed by the first
  std::string file;     ///< not empty: the points are those of a file
  bool mesh = false;    ///< that file is a mesh: its vertices
};

/// line(ax,ay,az, bx,by,bz, n): n points from a to b; circle(cx,cy,cz, nx,ny,nz, radius, n): around c, across n;
/// plane(ox,oy,oz, ux,uy,uz, vx,vy,vz, nu, nv): nu × nv points from o along u and v, both ends included;
/// box(n): about n points evenly in `bounds`, so also without any text; point(x,y,z); points(FILE), mesh(FILE): those
/// of a file; curve(FILE), loop(FILE): these as a curve. Several with ; between them make one set of points (no curve).
/// Throws ArgumentError saying what is wrong with the text.
Seeds parse_seeds(std::string_view text, const Box3& bounds);

}  // namespace sansmesh::inline v1
