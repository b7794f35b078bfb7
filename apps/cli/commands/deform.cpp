// Command `deform`: deforms clouds, meshes, functions, solids and volumes.
#include "sansmesh/deform.h"

#include <fmt/core.h>

#include <memory>
#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/input/surface_input.h"
#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::cli {
namespace {

struct DeformArguments {
  VolumeInput input;  ///< files are also those of clouds, or an expression
  DeformationInput deformation;
  DeformOptions options;
  DeformationMapOptions map;
  PictureArguments picture;
  VolumeColors colors;
  std::string output, unit;
  bool ascii = false, all_arrays = false;

  DeformAim aim() const { return deform_aim(output); }
};

/// Checks everything that can be checked before reading.
DeformKind check_deform(DeformArguments& a) {
  const bool vti = a.output.ends_with(".vti");
  a.options.look.picture = a.picture.chosen();
  if (a.aim() == DeformAim::picture) a.colors.apply_to(a.options.look);
  a.options.default_view = !a.picture.has_view();
  a.picture.check_frames(a.options.frames.has_value());
  a.deformation.validate();
  a.options.validate(a.aim());
  require(a.unit.empty() || a.output.ends_with(".svg"), "--unit is for drawings: -o FILE.svg");
  require(!a.all_arrays || a.input.array.empty(), "give --array or --all-arrays, not both");
  require(!a.all_arrays || vti, "--all-arrays needs a format with several arrays: -o FILE.vti");
  require(!a.map.nodes || vti, "--displacement-map is written as -o FILE.vti");
  require(!a.map.nodes || !a.options.frames, "--displacement-map excludes --frames");
  a.map.box = a.options.box;
  const bool volume = a.input.read.raw.given() || !a.input.array.empty() || a.all_arrays;
  DeformKind kind = deform_kind(a.input.files);
  if (kind == DeformKind::points && volume) kind = DeformKind::volume;
  check_deformed(a.output, a.map.nodes ? DeformKind::volume : kind);
  return kind;
}

DeformSubject read_subject(const DeformArguments& a, DeformKind kind, std::vector<std::string>& summary,
                           Console& console) {
  if (kind == DeformKind::points) {
    CloudInput cloud;
    cloud.files = a.input.files;
    ReadReport read;
    PointSet points = cloud.read(console, read);
    console.report(cloud.report(read, points.size()), "input");
    if (a.aim() == DeformAim::shape && !a.map.nodes)
      check_writable(a.output, points.triangles.empty() ? "points" : "mesh");
    return points;
  }
  if (kind == DeformKind::solid) {
    SolidModel solid = open_solid(a.input.files[0], console);
    console.report(solid, "input");
    return solid;
  }
  VolumeModel volume = a.input.open(console);
  if (a.map.nodes) {  // only the box is needed
    DeformableVolume subject{
        .name = volume.name(), .samples = volume.samples(console.progress()), .fields = {}, .arrays = {}};
    console.report(a.input.report(volume, console.progress()), "input");
    return subject;
  }
  std::vector<Note> notes;
  DeformableVolume subject = deformable_volume(volume, a.aim(), a.all_arrays, console.progress(), notes);
  console.note(volume.name(), notes);
  console.report(a.input.report(volume, console.progress()), "input");
  console.report(subject, "output");
  summary = summary_of(volume, console.progress());
  return subject;
}

void run_deform(DeformArguments& a, Console& console) {
  const DeformKind kind = check_deform(a);
  Progress& progress = console.progress();
  const std::string name = a.input.name();
  const Deformation deformation = read_deformation(a.deformation, progress);
  a.options.validate(a.aim(), deformation);
  std::vector<std::string> files, summary;
  const DeformSubject subject = read_subject(a, kind, summary, console);
  const UsePose write = [&](int pose, const DeformedPose& made) {
    files.push_back(a.options.frames ? frame_name(a.output, static_cast<std::size_t>(pose)) : a.output);
    progress.begin("write");
    const auto* const picture = std::get_if<DeformedPicture>(&made);
    if (!picture) return write_pose(files.back(), made, a.ascii, a.unit);
    RenderOptions look = a.options.look.picture;
    look.view.width -= picture->bar;
    a.picture.write(files.back(), picture->image, look);
  };
  DeformResult made;
  if (a.map.nodes) {
    DeformationMapResult map = deformation_map(deformation, bounds_of(subject), name, a.map, progress);
    write(0, std::move(map.block));
    made = {std::move(map.report), std::move(map.notes)};
  } else {
    made = deform(subject, name, deformation, a.aim(), a.options, write, progress);
  }
  console.note(name, made.notes);
  console.report(deformation, "deformation");
  console.report(made.report, "output");
  console.report_value("output.files", files);
  console.print(summary);
  console.print(fmt::format("{}: {}", name, deformation.words()));
  for (const std::string& line : summary_of(made.report))
    console.print(fmt::format("{}: {}", files.size() == 1 ? files[0] : a.output, line));
  if (files.size() > 1)
    console.print(fmt::format("{} to {}: {}", files.front(), files.back(), counted(files.size(), "pose")));
}

}  // namespace

Command add_deform(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("deform", "Cloud, mesh, function, solid or volume → the same, deformed by handles");
  auto shared = std::make_shared<DeformArguments>();
  DeformArguments& a = *shared;
  c.add_option("input", a.input.files,
               "Mesh, points, function (.smf), expression of csg, DATA[NAME=VALUE], or a volume")
      .type_name("INPUT")
      .reads()
      .required();
  c.add_option(
       "-o,--output", a.output,
       "Mesh or points like the input; for functions a mesh or sections (.svg, .csv); for volumes .vti, .mhd, .nrrd; "
       "always a picture (.png)")
      .writes({".ply", ".png", ".svg", ".csv", ".vti", ".mhd", ".nrrd"})
      .required();
  add_schema(c, a.deformation, {.group = "Deformation", .without = {"cut", "cut_damping"}});
  add_schema(c, a.options, {.group = "Deformation", .only = {"frames"}});
  add_schema(c, a.map, {.group = "Deformation", .only = {"displacement_map"}});
  for (const char* const name : {"cut", "cut_damping"}) add_schema(c, a.deformation, {.group = "Cuts", .only = {name}});
  add_schema(c, a.options, {.group = "Cuts", .only = {"cut_open"}});

  add_schema(c, a.options, {.group = "Meshes", .only = {"refine"}});
  add_ascii_flag(c, a.ascii, "Meshes");

  const char* const functions = "Functions and solids";
  add_schema(c, a.options, {.group = functions, .only = {"resolution", "cell", "simplify", "components", "plane"}});
  add_drawing_unit(c, a.unit, functions);
  add_schema(c, a.options, {.only = {"box"}});

  add_raw_options(c, a.input.read);
  add_volume_array(c, a.input);
  const char* const volumes = "Volumes";
  c.add_flag("--all-arrays", a.all_arrays, "Deform all arrays of the same samples (.vti)").group(volumes);
  add_schema(c, a.options, {.group = volumes, .only = {"size", "outside", "map_nodes"}});
  add_nan_flag(c, a.options.lattice.outside, volumes);
  a.colors.add_options(c, volumes);
  add_schema(c, a.options.look, {.group = volumes, .only = {"clip", "shading"}});
  a.options.look.color_bar = true;
  c.add_flag_callback(
       "--no-bar", [&a] { a.options.look.color_bar = false; }, "Omit the colour bar")
      .group(volumes);

  add_schema(c, a.options, {.group = "Picture", .only = {"exact_deformation", "draw_handles", "draw_folds"}});
  add_background_option(c, a.picture);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(
      "Handles move points p to q, and everything else follows: {\"handles\": [{\"p\": [x, y, z], \"q\": [x, y, z]}, "
      "…]}\n"
      "(docs/formats/handles.md). A handle without q is fixed: use some for the parts that should not move.\n\n"
      "Examples:\n"
      "  sansmesh deform scan.ply --handles pull.json -o pulled.ply\n"
      "  sansmesh deform scan.ply --handles pull.csv --kind affine -o pose.png --frames 24 --draw-handles\n"
      "  sansmesh deform scan.smf --handles pull.json -o pulled.stl\n"
      "  sansmesh deform 'box(2) - cylinder(r=0.5)' --handles twist.json -o twisted.ply --resolution 200\n"
      "  sansmesh deform head.mhd --handles nod.json -o nod.png --preset ct-bone --frames 12\n"
      "  sansmesh deform solid.ply --handles open.json --cut 'half-plane(0,0,0; 0,0,1; 1,0,0)' -o opened.ply\n"
      "  sansmesh deform head.mhd --handles nod.json -o nod.vti --size 256\n"
      "  sansmesh deform body.ply --handles-from scan0.ply,scan1.ply --handle-count 60 -o body1.ply");
  c.announce({report_of<ReadCloud>("input"), report_of<SolidModel>("input"), report_of<ReadVolume>("input"),
              report_of<Deformation>("deformation"), report_of<DeformableVolume>("output"),
              report_of<DeformReport>("output"),
              value_of<std::vector<std::string>>("output.files", "Files, one per pose")});
  return {&c, [shared](Console& console) { run_deform(*shared, console); }};
}

}  // namespace sansmesh::cli
