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
  // Of those of a lattice `box` stands here for all that is deformed; gradients are none of the volume's own.
  const std::span<const OptionRow> lattice = ResampleOptions::schema().rows;
  static const OptionRow rows[] = {
      option<&O::frames>({.text = "So many poses from before to after, NAME_000.*, …: handles go straight, those of a "
                                  "group turn",
                          .range = {2, 100000}}),
      option<&O::refine>({.text = "Cuts edges in half first whose middle the deformation moves off by more than this",
                          .unit = "length",
                          .range = positive()}),
      option<&O::cut_open>({.text = "Closed meshes stay open along cuts: without faces there"}),
      option<&O::resolution>(
          {.text = "Of meshes: cells along the longest side; of sections: squares", .range = {2, 4096}}),
      option<&O::cell>(
          {.text = "Edge of the cells instead", .unit = "length", .range = positive(), .excludes = "resolution"}),
      option<&O::simplify>({.text = "Fewer triangles where the surface is flat to within this; 0: nowhere",
                            .unit = "length",
                            .range = at_least(0)}),
      option<&O::components>({.text = "Parts to keep: auto, all, largest or a number",
                              .unit = "choice",
                              .from_data = "auto with functions, otherwise all"}),
      option<&O::planes>({.text = "Of sections: z=0.5, or nx,ny,nz,d; may be repeated",
                          .unit = "plane",
                          .from_data = "three through the middle",
                          .name = "plane"}),
      option<&O::box>({.text = "After the deformation: cut off at, or resampled in this box: x0,y0,z0,x1,y1,z1"}),
      option_group<&O::lattice>(lattice.first(1)),
      option_group<&O::lattice>(lattice.last(1)),
      option<&O::map_nodes>({.text = "Of pictures: nodes along the longest side of the map that they are seen through",
                             .range = {8, 512}}),
      option<&O::exact_deformation>(
          {.text = "Straight through the deformation, and of functions without a mesh: slow", .old_name = "exact"}),
      option<&O::draw_handles>({.text = "In pictures: handles as balls, blue before, red after, and their ways"}),
      option<&O::draw_folds>({.text = "In pictures: in red where space is folded"})};
  static const OptionSchema schema{rows};
  return schema;
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
