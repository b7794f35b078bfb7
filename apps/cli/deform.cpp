// sansmesh deform: anything by handles, or by a map of displacements.
#include "deform.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "commands.h"
#include "sansmesh/core/error.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/field/map_stretch.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/write_volume.h"
#include "solid_input.h"

namespace sansmesh::cli {
namespace {

enum class DeformedThing { points, solid, volume };

bool is_file(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::exists(name, ignored);
}

/// What the input is, by its name alone.
DeformedThing thing_of(const DeformArguments& a) {
  const std::vector<std::string>& files = a.input.files;
  if (files.size() == 1) {
    const std::string& name = files[0];
    if (!is_file(name)) {
      if (parse_isosurface_name(name) || name.find_first_of("()|&~+ ") != std::string::npos)
        return DeformedThing::solid;
      throw FileError(name, "does not exist");
    }
    if (is_function_file(name)) return DeformedThing::solid;
  }
  if (a.input.read.raw.given() || !a.input.array.empty() || a.all_arrays) return DeformedThing::volume;
  return std::all_of(files.begin(), files.end(), is_volume_name) ? DeformedThing::volume : DeformedThing::points;
}

void check_deform(const DeformArguments& a) {
  a.deformation.check();
  require(a.frames == 0 || a.frames >= 2,
          "--frames must be at least 2: the first is before the deformation, the last "
          "after it");
  require(a.frames == 0 || a.deformation.map.empty(), "--frames needs handles: a map is one deformation");
  require(!a.draw_handles || a.to_picture(), "--draw-handles is for pictures: -o FILE.png");
  require(!a.draw_handles || a.deformation.map.empty(), "--draw-handles needs handles");
  require(!a.draw_folds || a.to_picture(), "--draw-folds is for pictures: -o FILE.png");
  require(a.planes.empty() || a.to_section(), "--plane is for sections: -o FILE.svg or FILE.csv");
  require(a.unit.empty() || a.output.ends_with(".svg"), "--unit is for drawings: -o FILE.svg");
  require(a.map_nodes >= 8 && a.map_nodes <= 512, "--map-nodes must lie in 8..512");
  if (a.to_picture()) check_writable(a.output, "image");
  if (a.to_section()) check_writable(a.output, "text");
  if (a.displacement_map) {
    require(a.output.ends_with(".vti"), "--displacement-map is written as -o FILE.vti");
    require(*a.displacement_map >= 2 && *a.displacement_map <= 1024, "--displacement-map must lie in 2..1024");
    require(a.frames == 0, "--displacement-map is of one deformation: without --frames");
  }
  a.mesh.validate();
  a.picture.chosen().validate();
  a.picture.check_frames(a.frames > 0);
}

/// Around the input, before the deformation: points, or what bounds it.
Box3 input_box(const DeformArguments& a, DeformedThing thing, Console& console) {
  if (thing == DeformedThing::volume) {
    OpenVolume volume(a.input, console);
    return volume.samples()->bounds();
  }
  if (thing == DeformedThing::solid) return open_solid(a.input.files[0], console).solid.bounds();
  ReadReport read;
  const PointSet points = CloudInput{a.input.files, {}, {}, {}}.read(console, read);
  Box3 box;
  for (const Vec3f& p : points.positions) box.extend(points.origin + Vec3(p));
  return box;
}

DeformResult write_displacement_map(const DeformArguments& a, DeformedThing thing, const OpenDeformation& deformation,
                                    Console& console) {
  constexpr double kMargin = 0.1;  // of the diagonal
  const Box3 before = input_box(a, thing, console);
  require(is_finite(before.lower) && is_finite(before.upper) && !before.empty(),
          "--displacement-map needs an input that ends somewhere, for its box");
  const DeformationMaps maps = deformation.at(1);
  Progress& progress = console.progress();
  const Box3 box =
      a.mesh.box.value_or(with_room(box_before(*maps.backward, before, deformation.box_of(maps, before)), kMargin));
  const std::array<std::size_t, 3> sizes = lattice_sizes(box, static_cast<std::size_t>(*a.displacement_map));
  const DisplacementMap map = displacement_map(*maps.backward, box, sizes, progress);
  DeformResult result;
  FoldWatch folds;
  folds.look(*maps.backward, box, progress);
  progress.begin("write");
  write_volume(a.output, displacement_block(map));
  result.files = {a.output};
  result.lines = {
      fmt::format("{} × {} × {} displacements: sansmesh deform … --map {}", sizes[0], sizes[1], sizes[2], a.output)};
  result.input = a.input.json();
  result.output = {{"size", std::vector<std::size_t>(sizes.begin(), sizes.end())}};
  folds.report(a.input.name(), result, console);
  return result;
}

void run_deform(DeformArguments& a, Console& console) {
  check_deform(a);
  const DeformedThing thing = thing_of(a);
  const OpenDeformation deformation(a.deformation, console);
  deformation.at(1);  // what is wrong with the handles is told before long work
  DeformResult result;
  try {
    result = a.displacement_map               ? write_displacement_map(a, thing, deformation, console)
             : thing == DeformedThing::solid  ? deform_solid(a, deformation, console)
             : thing == DeformedThing::volume ? deform_volume(a, deformation, console)
                                              : deform_points(a, deformation, console);
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  console.progress().finish();
  console.say(fmt::format("{}: {}", a.input.name(), deformation.words()));
  for (const std::string& line : result.lines)
    console.say(fmt::format("{}: {}", result.files.size() == 1 ? result.files[0] : a.output, line));
  if (result.files.size() > 1)
    console.say(
        fmt::format("{} to {}: {}", result.files.front(), result.files.back(), counted(result.files.size(), "pose")));
  result.output["files"] = result.files;
  console.say_json({{"input", result.input}, {"deformation", deformation.json()}, {"output", result.output}});
  console.print_timings();
}

}  // namespace

Command add_deform(CommandLine& app) {
  CommandLine& c = app.add_subcommand("deform", "Anything, pulled at handles: cloud, mesh, function, solid, volume");
  auto shared = std::make_shared<DeformArguments>();
  DeformArguments& a = *shared;
  c.add_option("input", a.input.files,
               "Mesh, points, function (.smf), expression as of csg, DATA[NAME=VALUE], or a volume")
      .type_name("INPUT")
      .required();
  c.add_option(
       "-o,--output", a.output,
       "Mesh or points as they came; of functions a mesh, a section (.svg, .csv); of volumes .vti, .mhd, .nrrd; "
       "of all a picture (.png)")
      .type_name("FILE")
      .required();
  add_deformation_options(c, a.deformation);
  c.add_option("--frames", a.frames,
               "So many poses from before to after, NAME_000.*, …: handles go straight, those of a group turn")
      .type_name("COUNT")
      .group("Deformation");
  c.add_option("--displacement-map", a.displacement_map,
               "Writes the map instead (-o MAP.vti), with so many nodes along the longest side")
      .type_name("COUNT")
      .group("Deformation");

  const char* const meshes = "Meshes";
  c.add_option("--refine", a.bend, "Cuts edges in half first whose middle the deformation moves off by more than this")
      .type_name("LENGTH")
      .group(meshes);
  c.add_flag("--ascii", a.ascii, "Text instead of binary, where the format has both").group(meshes);

  const char* const functions = "Functions and solids";
  c.add_option("--resolution", a.mesh.resolution,
               "Of meshes: cells along the longest side, 4..4096; of sections: squares")
      .type_name("COUNT")
      .group(functions);
  c.add_option("--cell", a.mesh.cell, "Edge of the cells instead").type_name("LENGTH").group(functions);
  c.add_option("--simplify", a.mesh.simplify, "Fewer triangles where the surface is flat to within this; 0: nowhere")
      .type_name("LENGTH")
      .group(functions);
  c.add_option_function(
       "--components", [&a](const std::string& text) { a.components = parse_components(text); },
       "Parts to keep: auto, all, largest or a number [auto with functions, otherwise all]")
      .type_name("CHOICE")
      .group(functions);
  c.add_option("--plane", a.planes, "Of sections: z=0.5, or nx,ny,nz,d; may be repeated [three through the middle]")
      .type_name("PLANE")
      .repeated()
      .group(functions);
  c.add_option("--unit", a.unit, "mm, cm or in: the drawing is true to scale")
      .type_name("UNIT")
      .one_of({"mm", "cm", "in"})
      .group(functions);
  add_box_option(c, a.mesh.box, "After the deformation: cut off at, or resampled in this box: x0,y0,z0,x1,y1,z1");

  add_raw_options(c, a.input.read);
  add_volume_array(c, a.input);
  const char* const volumes = "Volumes";
  c.add_flag("--all-arrays", a.all_arrays, "All arrays of the same samples (.vti)").group(volumes);
  c.add_option("--size", a.size, "Points along the longest side, or along x, y and z [128]")
      .type_name("N [N N]")
      .group(volumes);
  c.add_flag("--nan", a.nan, "Values outside of the volume are NaN instead of 0").group(volumes);
  c.add_option("--map-nodes", a.map_nodes,
               "Of pictures: nodes along the longest side of the map that they are seen through, 8..512 [96]")
      .type_name("COUNT")
      .group(volumes);
  c.add_flag("--exact", a.exact, "Straight through the deformation, and of functions without a mesh: slow")
      .group("Picture");
  a.colors.add_options(c, volumes);
  c.add_option("--clip", a.clips, "Takes away what is there: 'x>1.5', '-1<z<2', '1,1,0>3'; may be repeated")
      .type_name("PLACE")
      .repeated()
      .group(volumes);
  c.add_flag("--no-shading", a.no_shading, "Colours as the transfer function has them, without light").group(volumes);
  c.add_flag("--no-bar", a.no_bar, "Without the colour bar").group(volumes);

  c.add_flag("--draw-handles", a.draw_handles, "In pictures: handles as balls, blue before, red after, and their ways")
      .group("Picture");
  c.add_flag("--draw-folds", a.draw_folds, "In pictures: in red where space is folded").group("Picture");
  add_background_option(c, a.background);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(
      "Handles are places that went somewhere, all else follows: {\"handles\": [{\"p\": [x, y, z], \"q\": [x, y, z]}, "
      "…]}\n"
      "(docs/formats/handles.md). A handle without q stays where it is: some that hold fast what is not to move.\n\n"
      "Examples:\n"
      "  sansmesh deform scan.ply --handles pull.json -o pulled.ply\n"
      "  sansmesh deform scan.ply --handles pull.csv --kind affine -o pose.png --frames 24 --draw-handles\n"
      "  sansmesh deform scan.smf --handles pull.json -o pulled.stl\n"
      "  sansmesh deform 'box(2) - cylinder(r=0.5)' --handles twist.json -o twisted.ply --resolution 200\n"
      "  sansmesh deform head.mhd --handles nod.json -o nod.png --preset ct-bone --frames 12\n"
      "  sansmesh deform solid.ply --handles open.json --cut 'half-plane(0,0,0; 0,0,1; 1,0,0)' -o opened.ply\n"
      "  sansmesh deform head.mhd --handles nod.json -o nod.vti --size 256\n"
      "  sansmesh deform body.ply --handles-from scan0.ply,scan1.ply --handle-count 60 -o body1.ply");
  return {&c, [shared](Console& console) { run_deform(*shared, console); }};
}

}  // namespace sansmesh::cli
