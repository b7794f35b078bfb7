// Options of deformations.
#include <span>

#include "sansmesh/deform.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

CsgMeshOptions solid_options(const DeformOptions& o) {
  return {.cell = o.cell, .resolution = o.resolution, .box = o.box, .simplify = o.simplify};
}

}  // namespace

const OptionSchema& DeformOptions::schema() {
  using O = DeformOptions;
  // `box` of the lattice is replaced by the common one; gradients are not available here.
  const std::span<const OptionRow> lattice = ResampleOptions::schema().rows;
  static const OptionRow rows[] = {
      option<&O::frames>({.text = "Number of poses from before to after, NAME_000.*, …: handles move straight, groups "
                                  "rotate",
                          .range = {2, 100000}}),
      option<&O::refine>(
          {.text = "First halve edges whose midpoint the deformation moves off the edge by more than this",
           .unit = "length",
           .range = positive()}),
      option<&O::cut_open>({.text = "Leave closed meshes open along cuts"}),
      option<&O::resolution>(
          {.text = "For meshes: cells along the longest side; for sections: squares", .range = {2, 4096}}),
      option<&O::cell>(
          {.text = "Edge length of the cells", .unit = "length", .range = positive(), .excludes = "resolution"}),
      option<&O::simplify>({.text = "Merge triangles where the surface is flat to within this; 0: never",
                            .unit = "length",
                            .range = at_least(0)}),
      option<&O::components>({.text = "Components to keep: auto, all, largest or a number",
                              .unit = "choice",
                              .from_data = "auto with functions, otherwise all"}),
      option<&O::planes>({.text = "Plane of a section: z=0.5, or nx,ny,nz,d; may be repeated",
                          .unit = "plane",
                          .from_data = "three through the middle",
                          .name = "plane"}),
      option<&O::box>({.text = "Box after the deformation, to cut off or resample: x0,y0,z0,x1,y1,z1"}),
      option_group<&O::lattice>(lattice.first(1)),
      option_group<&O::lattice>(lattice.last(1)),
      option<&O::map_nodes>(
          {.text = "In pictures: nodes along the longest side of the displacement map", .range = {8, 512}}),
      option<&O::exact_deformation>(
          {.text = "Evaluate the deformation exactly, functions without a mesh: slow", .old_name = "exact"}),
      option<&O::draw_handles>(
          {.text = "In pictures: draw handles as balls, blue before, red after, with their paths"}),
      option<&O::draw_folds>({.text = "In pictures: draw folds of space in red"})};
  return option_schema<rows>();
}

void DeformOptions::validate(DeformAim aim) const {
  validate_options(*this);
  if (aim != DeformAim::sections) solid_options(*this).validate();
  if (aim != DeformAim::picture && draw_handles) throw ArgumentError("`draw_handles` is for pictures");
  if (aim != DeformAim::picture && draw_folds) throw ArgumentError("`draw_folds` is for pictures");
  if (aim != DeformAim::sections && !planes.empty()) throw ArgumentError("`plane` is for sections");
  lattice.validate();
  if (aim == DeformAim::picture) look.validate();
}

void DeformOptions::validate(DeformAim aim, const Deformation& deformation) const {
  validate(aim);
  const bool handles = deformation.has_handles();
  if (frames && !handles) throw ArgumentError("`frames` needs handles: a map is one deformation");
  if (draw_handles && !handles) throw ArgumentError("`draw_handles` needs handles");
  if (cut_open && deformation.cuts().empty()) throw ArgumentError("`cut_open` needs `cut`");
}

}  // namespace sansmesh::inline v1
