// Command `compare`: maps the distances between a part and its reference.
#include "sansmesh/inspect.h"
#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <string>
#include <vector>

#include "cli/input/surface_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/convert.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {
namespace {

struct CompareArguments {
  CloudInput part, reference;
  std::string output, preview, unit;
  bool ascii = false, histogram = false;
  CompareOptions options;
  PictureArguments picture;
};

void check_arguments(const CompareArguments& a) {
  a.options.validate();
  if (!a.output.empty()) check_writable(a.output, "text");
  const RenderOptions look = a.picture.chosen();
  look.validate();
  if (a.preview.empty()) return;
  check_writable(a.preview, "image");
  check_map_picture(look, a.unit);
}

/// The mesh carries the colours of the map.
void write_map(const CompareArguments& a, const CompareResult& made, Progress& progress) {
  MapPicture picture;
  if (!a.preview.empty()) picture = draw_map(made, a.options, a.picture.chosen(), a.unit, progress);
  if (!a.output.empty() || !a.preview.empty()) progress.begin("write");
  if (!a.output.empty()) {
    if (made.mesh.triangles.empty())
      write_points(a.output, vertices_of(made.mesh), {.ascii = a.ascii});
    else
      write_mesh(a.output, made.mesh, {.ascii = a.ascii});
  }
  if (!a.preview.empty()) a.picture.write(a.preview, picture.image, picture.made_with);
}

void run_compare(const CompareArguments& a, Console& console) {
  check_arguments(a);
  Progress& progress = console.progress();
  const SurfaceInput part = open_surface(a.part, console), reference = open_surface(a.reference, console);
  const bool reversed = a.options.on == MapSide::reference;
  const AnySurface& mapped = (reversed ? reference : part).surface;
  const AnySurface& other = (reversed ? part : reference).surface;
  const bool points = mapped.kind() == AnySurface::Kind::points;
  if (!a.output.empty()) check_writable(a.output, points ? "points" : "mesh");
  const CompareResult made = compare(part.surface, reference.surface, a.options, progress);
  console.note(mapped.name(), made.notes);
  write_map(a, made, progress);
  console.report(part.report, "part");
  console.report(reference.report, "reference");
  console.report(made);
  if (!a.output.empty()) console.report(FileReport{a.output}, "output");
  if (!a.preview.empty()) console.report(FileReport{a.preview}, "preview");

  console.print(fmt::format("{}: {} of {} {} compared with {} ({})", mapped.name(), grouped(made.map.measured),
                            grouped(made.mesh.vertices.size()), points ? "points" : "vertices", other.name(),
                            other.kind_word()));
  console.print(summary_of(made, a.options, other.name()));
  if (a.histogram && made.map.measured > 0) console.print(histogram_of(made.map));
  const DistanceStatistics& s = made.map.statistics;
  for (const std::string& file : {a.output, a.preview})
    if (!file.empty())
      console.print(fmt::format("{}: blue inside, red outside, full colour at ±{}{}", file, length(s.range),
                                s.smallest_range ? ", a millionth of the diagonal: 99 % are closer" : ""));
}

}  // namespace

Command add_compare(CommandLine& app) {
  CommandLine& c = app.add_subcommand("compare", "Two surfaces → signed distances as numbers, colours and a picture");
  auto a = std::make_shared<CompareArguments>();
  a->part.files.resize(1);
  add_surface_input(c, "part", a->part.files[0], "Manufactured part: mesh, points, or function (.smf)");
  add_surface_input(c, "reference", a->reference.files,
                    "Nominal shape: mesh, points, or function (.smf); several files are read as one");
  add_selection_options(c, a->reference, " of the reference");
  c.add_option("-o,--output", a->output,
               "Map to write, with distances as quality and as colours: .ply .vtp .glb (others: colours)")
      .writes({".ply", ".vtp", ".glb"});
  add_preview_option(c, a->preview, "the map, with a scale in its --width,");
  const std::vector<std::string_view> of_alignment = {"align", "from", "find_scale", "align_samples",
                                                      "align_iterations"};
  add_schema(c, a->options, {.without = of_alignment});
  add_schema(c, a->options, {.group = "Alignment", .only = of_alignment});
  c.add_flag("--histogram", a->histogram, "Also print the distribution");
  add_ascii_flag(c, a->ascii);
  add_picture_options(c, a->picture);
  add_wireframe_options(c, a->picture.options);
  c.add_option("--unit", a->unit, "Unit of lengths at the scale").type_name("UNIT").group("Picture");
  c.footer(
      "Positive distances are outside the reference. Statistics are weighted by area. The part is moved only "
      "with --align.\n\n"
      "Examples:\n"
      "  sansmesh compare made.ply design.stl --within 0.05 -o map.ply --preview map.png\n"
      "  sansmesh compare scan.ply design.stl --max-distance 2 --histogram\n"
      "  sansmesh compare design.stl scan.smf --refine 0.5 --json");
  c.announce({report_of<ReadSurface>("part"), report_of<ReadSurface>("reference"), report_of<CompareResult>(),
              report_of<FileReport>("output"), report_of<FileReport>("preview")});
  return {&c, [a](Console& console) { run_compare(*a, console); }};
}

}  // namespace sansmesh::cli
