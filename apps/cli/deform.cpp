// sansmesh deform: anything by handles, or by a map of displacements.
#include "sansmesh/deform.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io.h"
#include "sansmesh/io/write_volume.h"
#include "sansmesh/jobs/frame_names.h"
#include "sansmesh/measure/section_text.h"
#include "sansmesh/surface_function.h"
#include "schema_options.h"
#include "solid_input.h"
#include "volume_colors.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

enum class DeformedThing { points, solid, volume };

struct DeformArguments {
  VolumeInput input;  ///< its files are also those of clouds, or an expression
  DeformationInput deformation;
  DeformOptions options;
  DeformationMapOptions map;
  PictureArguments picture;
  VolumeColors colors;
  std::vector<std::string> clips;
  std::string output, unit;
  bool ascii = false, all_arrays = false, no_bar = false;

  DeformAim aim() const {
    if (output.ends_with(".png")) return DeformAim::picture;
    return output.ends_with(".svg") || output.ends_with(".csv") ? DeformAim::sections : DeformAim::shape;
  }
  std::string file(int pose) const {
    return options.frames ? frame_name(output, static_cast<std::size_t>(pose)) : output;
  }
};

/// Summary of all poses, printed at the end.
struct Deformed {
  DeformResult result;
  std::vector<std::string> files, lines;
};

/// What the input is, by its name alone.
DeformedThing thing_of(const DeformArguments& a) {
  const std::vector<std::string>& files = a.input.files;
  if (files.size() == 1) {
    const std::string& name = files[0];
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored)) {
      if (parse_isosurface_name(name) || name.find_first_of("()|&~+ ") != std::string::npos)
        return DeformedThing::solid;
      throw FileError(name, "does not exist");
    }
    if (is_function_file(name)) return DeformedThing::solid;
  }
  if (a.input.read.raw.given() || !a.input.array.empty() || a.all_arrays) return DeformedThing::volume;
  return std::all_of(files.begin(), files.end(), is_volume_name) ? DeformedThing::volume : DeformedThing::points;
}

/// All that can be told before anything is read.
void check_deform(DeformArguments& a) {
  VolumePictureOptions& look = a.options.look;
  look.picture = a.picture.chosen();
  a.options.any_view = !a.picture.has_view();
  a.picture.check_frames(a.options.frames.has_value());
  a.deformation.validate();
  a.options.validate(a.aim());
  require(!a.options.frames || a.deformation.map.empty(), "--frames needs handles: a map is one deformation");
  require(!a.options.draw_handles || a.deformation.map.empty(), "--draw-handles needs handles");
  require(!a.options.cut_open || !a.deformation.cuts.empty(), "--cut-open needs --cut");
  require(a.unit.empty() || a.output.ends_with(".svg"), "--unit is for drawings: -o FILE.svg");
  if (a.aim() == DeformAim::picture) check_writable(a.output, "image");
  if (a.aim() == DeformAim::sections) check_writable(a.output, "text");
  if (!a.map.nodes) return;
  require(a.output.ends_with(".vti"), "--displacement-map is written as -o FILE.vti");
  require(!a.options.frames, "--displacement-map is of one deformation: without --frames");
  a.map.box = a.options.box;
}

UsePose to_files(const DeformArguments& a, Deformed& deformed, Console& console) {
  return [&](int pose, const DeformedPose& made) {
    deformed.files.push_back(a.file(pose));
    console.progress().begin("write");
    const std::string& file = deformed.files.back();
    const auto* const picture = std::get_if<DeformedPicture>(&made);
    if (!picture) return write_pose(file, made, a.ascii, a.unit);
    RenderOptions look = a.options.look.picture;
    look.view.width -= picture->bar;
    a.picture.write(file, picture->image, look);
  };
}

PointSet read_cloud(const DeformArguments& a, Console& console) {
  const CloudInput cloud{a.input.files, {}, {}, {}};
  ReadReport read;
  PointSet points = cloud.read(console, read);
  console.tell(cloud.told(read, points.size()), "input");
  return points;
}

SolidModel read_solid_of(const DeformArguments& a, Console& console) {
  SolidModel solid = open_solid(a.input.files[0], console);
  console.tell(solid, "input");
  return solid;
}

Deformed deform_cloud(const DeformArguments& a, const Deformation& deformation, Console& console) {
  Deformed d;
  const PointSet points = read_cloud(a, console);
  const bool mesh = !points.triangles.empty();
  if (a.aim() == DeformAim::shape) check_writable(a.output, mesh ? "mesh" : "points");
  d.result =
      deform(points, a.input.name(), deformation, a.aim(), a.options, to_files(a, d, console), console.progress());
  const DeformReport& r = d.result.report;
  d.lines.push_back(mesh ? fmt::format("{}, {} {}{}", counted(r.triangles, "triangle"), grouped(r.vertices),
                                       r.vertices == 1 ? "vertex" : "vertices",
                                       r.added > 0 ? fmt::format(" ({} added)", grouped(r.added)) : "")
                         : counted(r.vertices, "point"));
  if (r.cut)
    d.lines.push_back(r.cut->edges == 0 ? "no cut reaches it"
                                        : fmt::format("opened along {}, {} on cut faces", counted(r.cut->edges, "edge"),
                                                      counted(r.cut->faces, "triangle")));
  return d;
}

Deformed deform_solid(const DeformArguments& a, const Deformation& deformation, Console& console) {
  if (a.aim() == DeformAim::shape) check_writable(a.output, "mesh");
  Deformed d;
  const SolidModel solid = read_solid_of(a, console);
  d.result = deform(solid, deformation, a.aim(), a.options, to_files(a, d, console), console.progress());
  const DeformReport& r = d.result.report;
  if (r.mesh_of_open)
    d.lines = {fmt::format("{}, its surface bounds no solid: its mesh was deformed", counted(r.triangles, "triangle"))};
  for (const Section& s : r.sections) d.lines.push_back(section_words(s));
  if (r.solid)
    d.lines = {fmt::format("{}, {} vertices in {}{}", counted(r.triangles, "triangle"), grouped(r.vertices),
                           counted(r.solid->components, "component"), r.solid->closed ? ", closed" : ", not closed"),
               area_words(r.solid->area, r.solid->volume)};
  return d;
}

Deformed deform_volume(DeformArguments& a, const Deformation& deformation, Console& console) {
  const bool picture = a.aim() == DeformAim::picture;
  require(!a.all_arrays || a.input.array.empty(), "give --array or --all-arrays, not both");
  require(!a.all_arrays || a.output.ends_with(".vti"), "--all-arrays needs a format of several arrays: -o FILE.vti");
  if (a.aim() == DeformAim::shape) check_volume_writable(a.output);
  VolumePictureOptions& look = a.options.look;
  if (picture) {
    a.colors.put_into(look);
    for (const std::string& text : a.clips) look.clips.push_back(volume_cut_of(text));
    look.color_bar = !a.no_bar;
    look.validate();
  }
  VolumeModel volume = a.input.open(console);
  std::vector<Note> notes;
  const DeformableVolume subject = deformable_volume(volume, a.aim(), a.all_arrays, console.progress(), notes);
  console.note(volume.name(), notes);
  Deformed d;
  d.result = deform(subject, deformation, a.aim(), a.options, to_files(a, d, console), console.progress());
  console.tell(a.input.told(volume, console.progress()), "input");
  console.tell(subject, "output");
  console.say(summary_of(volume, console.progress()));
  const DeformReport& r = d.result.report;
  if (!picture) d.lines = {lattice_words(r.size, r.inside.value_or(0))};
  return d;
}

Deformed write_displacement_map(const DeformArguments& a, DeformedThing thing, const Deformation& deformation,
                                Console& console) {
  Box3 before;
  if (thing == DeformedThing::volume) {
    before = a.input.open(console).samples(console.progress())->bounds();
    console.tell(a.input.told(), "input");
  } else {
    before = thing == DeformedThing::solid ? read_solid_of(a, console).bounds() : bounds_of(read_cloud(a, console));
  }
  DeformationMapResult made = deformation_map(deformation, before, a.input.name(), a.map, console.progress());
  console.progress().begin("write");
  write_volume(a.output, made.block);
  Deformed d;
  d.files = {a.output};
  const std::array<std::size_t, 3> size{made.block.axes[0].size(), made.block.axes[1].size(),
                                        made.block.axes[2].size()};
  d.lines = {
      fmt::format("{} × {} × {} displacements: sansmesh deform … --map {}", size[0], size[1], size[2], a.output)};
  d.result.report.size = size;
  d.result.report.folds = std::move(made.folds);
  d.result.notes = std::move(made.notes);
  return d;
}

void run_deform(DeformArguments& a, Console& console) {
  check_deform(a);
  const DeformedThing thing = thing_of(a);
  const Deformation deformation = read_deformation(a.deformation, console.progress());
  const Deformed d = a.map.nodes                      ? write_displacement_map(a, thing, deformation, console)
                     : thing == DeformedThing::solid  ? deform_solid(a, deformation, console)
                     : thing == DeformedThing::volume ? deform_volume(a, deformation, console)
                                                      : deform_cloud(a, deformation, console);
  console.note(a.input.name(), d.result.notes);
  console.tell(deformation, "deformation");
  console.tell(d.result.report, "output");
  console.tell_value("output.files", d.files);
  console.say(fmt::format("{}: {}", a.input.name(), deformation.words()));
  for (const std::string& line : d.lines)
    console.say(fmt::format("{}: {}", d.files.size() == 1 ? d.files[0] : a.output, line));
  if (d.files.size() > 1)
    console.say(fmt::format("{} to {}: {}", d.files.front(), d.files.back(), counted(d.files.size(), "pose")));
}

}  // namespace

Command add_deform(CommandLine& app) {
  CommandLine& c = app.add_subcommand("deform", "Anything, pulled at handles: cloud, mesh, function, solid, volume");
  auto shared = std::make_shared<DeformArguments>();
  DeformArguments& a = *shared;
  c.add_option("input", a.input.files,
               "Mesh, points, function (.smf), expression as of csg, DATA[NAME=VALUE], or a volume")
      .type_name("INPUT")
      .reads()
      .required();
  c.add_option(
       "-o,--output", a.output,
       "Mesh or points as they came; of functions a mesh, a section (.svg, .csv); of volumes .vti, .mhd, .nrrd; "
       "of all a picture (.png)")
      .writes({".ply", ".png", ".svg", ".csv", ".vti", ".mhd", ".nrrd"})
      .required();
  add_schema(c, a.deformation, {.group = "Deformation", .without = {"cut", "cut_damping"}});
  add_schema(c, a.options, {.group = "Deformation", .only = {"frames"}});
  add_schema(c, a.map, {.group = "Deformation", .only = {"displacement_map"}});
  for (const char* const name : {"cut", "cut_damping"}) add_schema(c, a.deformation, {.group = "Cuts", .only = {name}});
  add_schema(c, a.options, {.group = "Cuts", .only = {"cut_open"}});

  add_schema(c, a.options, {.group = "Meshes", .only = {"refine"}});
  c.add_flag("--ascii", a.ascii, "Text instead of binary, where the format has both").group("Meshes");

  const char* const functions = "Functions and solids";
  add_schema(c, a.options, {.group = functions, .only = {"resolution", "cell", "simplify", "components"}});
  add_schema(c, a.options, {.group = functions, .only = {"plane"}});
  c.add_option("--unit", a.unit, "mm, cm or in: the drawing is true to scale")
      .type_name("UNIT")
      .one_of({"mm", "cm", "in"})
      .group(functions);
  add_schema(c, a.options, {.only = {"box"}});

  add_raw_options(c, a.input.read);
  add_volume_array(c, a.input);
  const char* const volumes = "Volumes";
  c.add_flag("--all-arrays", a.all_arrays, "All arrays of the same samples (.vti)").group(volumes);
  add_schema(c, a.options, {.group = volumes, .only = {"size", "outside", "map_nodes"}});
  c.add_flag_callback(
       "--nan", [&a] { a.options.lattice.outside = std::numeric_limits<double>::quiet_NaN(); },
       "Values outside of the volume are NaN: --outside nan")
      .group(volumes);
  a.colors.add_options(c, volumes);
  c.add_option("--clip", a.clips, "Takes away what is there: 'x>1.5', '-1<z<2', '1,1,0>3'; may be repeated")
      .type_name("PLACE")
      .repeated()
      .group(volumes);
  add_schema(c, a.options.look, {.group = volumes, .only = {"shading"}});
  c.add_flag("--no-bar", a.no_bar, "Without the colour bar").group(volumes);

  add_schema(c, a.options, {.group = "Picture", .only = {"exact_deformation", "draw_handles", "draw_folds"}});
  add_background_option(c, a.picture);
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
  c.tells({told<ReadCloud>("input"), told<SolidModel>("input"), told<ReadVolume>("input"), told<ReadFiles>("input"),
           told<Deformation>("deformation"), told<DeformableVolume>("output"), told<DeformReport>("output"),
           told_value<std::vector<std::string>>("output.files", "Files, a pose each")});
  return {&c, [shared](Console& console) { run_deform(*shared, console); }};
}

}  // namespace sansmesh::cli
