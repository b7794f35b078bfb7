// sansmesh volume isosurface: where a quantity has a value, as a mesh.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "commands.h"
#include "isosurface_frames.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/isosurface.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

struct IsosurfaceArguments {
  VolumeInput input;
  std::optional<double> value;
  std::optional<std::string> carry;
  MeshOutput output;
  IsosurfaceOptions options;
  IsosurfaceFrames frames;
};

/// The arrays of --carry. Throws ArgumentError for names of none.
std::vector<std::string> carried(const IsosurfaceArguments& a, OpenVolume& volume) {
  const std::string carry = a.carry.value_or("all");
  if (carry == "none") return {};
  std::vector<std::string> wanted;
  if (carry != "all") wanted = between_commas(carry);
  const Association of = volume.dataset().array(volume.choice().array).of;
  if (wanted.empty())
    for (const DatasetArray& array : volume.dataset().arrays())
      if (array.of == of && array.name != volume.choice().array) wanted.push_back(array.name);
  for (const std::string& name : wanted) volume.dataset().array(name, "carry");
  return wanted;
}

/// Other arrays at the vertices, interpolated in the grid's own way; whole numbers, which are labels, as they are.
void carry_arrays(const std::vector<std::string>& wanted, OpenVolume& volume, TriangleMesh& mesh, Console& console) {
  std::vector<Vec3> x;
  x.reserve(mesh.vertices.size());
  for (const Vec3f& v : mesh.vertices) x.push_back(mesh.origin + Vec3(v));
  for (const std::string& name : wanted) {
    ReconstructionOptions options;
    options.method =
        is_real(volume.dataset().array(name).type) ? ReconstructionMethod::linear : ReconstructionMethod::nearest;
    const auto field = volume.dataset().field({name, {}, false}, options, console.progress());
    std::vector<double> values(x.size() * field->components());
    field->evaluate(x, {values, {}, {}, {}});
    constexpr double kMost = std::numeric_limits<float>::max();
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::abs(v) > kMost; })) {
      console.warn(volume.name(), {fmt::format("{} is not carried along: its values do not fit into floats", name)});
      continue;
    }
    mesh.attributes.set(name, std::vector<float>(values.begin(), values.end()), field->components());
  }
}

void run_isosurface(IsosurfaceArguments& a, Console& console) {
  a.frames.check();
  if (a.frames.unsteady) {
    require(!a.carry && !a.options.closed && a.options.components.kind == ComponentChoice::Kind::all,
            "--carry, --closed and --components are not for --unsteady: its meshes are closed, without other arrays");
    return write_isosurface_frames(a.input, a.value, a.options, a.frames, a.output, console);
  }
  a.options.validate();
  a.output.check();
  OpenVolume volume(a.input, console);
  volume.samples();
  const DatasetArray& array = volume.dataset().array(volume.choice().array);
  if (!a.value && array.components > 1) throw ArgumentError("--value is needed for arrays of several components");
  const double value = a.value ? *a.value : volume.model().middle_value();
  const std::vector<std::string> wanted = carried(a, volume);
  const auto surface = volume.isosurface(value);
  const auto samples = volume.samples();
  IsosurfaceReport report;
  TriangleMesh mesh;
  try {
    mesh = mesh_isosurface(*surface, a.options, console.progress(), &report);
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  console.progress().begin("carry arrays");
  carry_arrays(wanted, volume, mesh, console);
  console.warn(a.input.name(), report.warnings);
  a.output.write(mesh, console.progress());
  console.progress().finish();

  volume.say_method();
  console.say(fmt::format("{}: {} = {:.6g}{} on {} ({})", a.input.name(), volume.array_name(), value,
                          a.value ? "" : " (the middle of its range)", counted(samples->size(), "sample"),
                          samples->facts.grid));
  console.say(fmt::format("{}: {}, {} vertices in {}{}", a.output.file, counted(mesh.triangles.size(), "triangle"),
                          grouped(mesh.vertices.size()), counted(report.components, "component"),
                          report.closed ? ", closed" : ", with borders"));
  console.say(report.volume
                  ? fmt::format("area {:.6g}, volume {:.6g}", report.area, *report.volume)
                  : fmt::format("area {:.6g} (--closed gives the volume of what is above the value)", report.area));
  console.say_json({{"input", volume.json()},
                    {"value", value},
                    {"blocks", report.blocks},
                    {"cell", report.cell},
                    {"area", report.area},
                    {"volume", report.volume ? Json(*report.volume) : Json()},
                    {"output",
                     {{"file", a.output.file},
                      {"vertices", mesh.vertices.size()},
                      {"triangles", mesh.triangles.size()},
                      {"components", report.components},
                      {"closed", report.closed}}}});
  console.print_timings();
}

}  // namespace

Command add_volume_isosurface(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("isosurface", "Volume on any grid → where a quantity has a value, as a mesh");
  auto a = std::make_shared<IsosurfaceArguments>();
  add_volume_input(c, a->input);
  c.add_option("--value", a->value, "Value on the surface [the middle of the array's range]").type_name("NUMBER");
  add_mesh_output(c, a->output);
  c.add_option("--carry", a->carry, "Arrays for the vertices: all, none, or names with commas between")
      .type_name("NAMES");
  c.add_flag("--closed", a->options.closed, "Close the surface at the boundary of the volume, round what is above");
  c.add_option("--cell", a->options.cell, "Edge of the smallest blocks [the local spacing of the samples]")
      .type_name("LENGTH")
      .group("Mesh");
  c.add_option("--mesh-error", a->options.mesh_error, "Accepted mean distance between mesh and surface")
      .type_name("LENGTH")
      .group("Mesh");
  c.add_option("--triangles", a->options.triangles, "At most this many triangles").type_name("COUNT").group("Mesh");
  c.add_option_function(
       "--components", [a](const std::string& text) { a->options.components = parse_components(text); },
       "Parts to keep: auto, all, largest or a number [all]")
      .type_name("CHOICE")
      .group("Mesh");
  add_isosurface_frames(c, a->frames);
  c.footer(std::string(kReadableVolumes) +
           "\n\nOther commands take such a surface as DATA[NAME=VALUE]: csg, section, compare, measure.\n\nExamples:\n"
           "  sansmesh volume isosurface engine.mhd --value 80 -o engine.ply --preview engine.png\n"
           "  sansmesh volume isosurface disk_out_ref.vtu --array Temp --value 600 -o hot.vtp\n"
           "  sansmesh volume isosurface flame_*.vti --unsteady --value 900 --frames 100 -o flame.ply\n"
           "  sansmesh section 'disk_out_ref.vtu[Temp=600]' --axis z -o cut.svg");
  return {&c, [a](Console& console) { run_isosurface(*a, console); }};
}

}  // namespace sansmesh::cli
