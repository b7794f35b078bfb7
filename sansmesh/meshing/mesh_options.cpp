#include "sansmesh/meshing/mesh_options.h"

#include <fmt/core.h>

#include <cmath>

#include "sansmesh/core/error.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh {

void MeshOptions::validate() const {
  const auto check = [](bool ok, const std::string& what) {
    if (!ok) throw ArgumentError(what);
  };
  check(!mesh_error || (std::isfinite(*mesh_error) && *mesh_error > 0), "`mesh_error` must be a positive length");
  check(!triangles || (*triangles >= 4 && enhance),
        "`triangles` must be at least 4, and does not go with `enhance = false`");
  check(displacement >= 0 && displacement < 1, "`displacement` must lie in [0, 1)");
  check(displacement == 0 || !enhance || mesher != Mesher::blocks,
        "`displacement` needs `enhance = false`: clustering undoes it");
  if (mesher == Mesher::walk) validate_walk();
  check(!fill_holes || (std::isfinite(*fill_holes) && *fill_holes >= 0), "`fill_holes` must be a length of at least 0");
  check(!trim || (std::isfinite(*trim) && *trim >= 0), "`trim` must be a length of at least 0");
  check(components.kind != ComponentChoice::Kind::count || components.count >= 1,
        "the number of `components` must be at least 1");
  check(!box || (is_finite(box->lower) && is_finite(box->upper) && !box->empty()),
        "`box` must be finite, and its lower corner below its upper one");
  check(!block_depth || (*block_depth >= kLeastDepth && *block_depth <= kMostDepth),
        fmt::format("`block_depth` must lie in {}..{}", kLeastDepth, kMostDepth));
}

void MeshOptions::validate_walk() const {
  const auto unset = [](bool ok, const char* field) {
    if (!ok) throw ArgumentError(fmt::format("`{}` means nothing to a walk; it goes with `mesher = blocks`", field));
  };
  unset(!mesh_error, "mesh_error");
  unset(!triangles, "triangles");
  unset(!fill_holes, "fill_holes");
  unset(!trim, "trim");
  unset(enhance, "enhance = false");
}

}  // namespace sansmesh
