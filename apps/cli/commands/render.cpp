// Command `render`: draws meshes, clouds and functions.
#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/line/surface_options.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::cli {
namespace {

struct RenderArguments {
  CloudInput input;
  std::string output;
  PictureArguments picture;
  SurfaceArguments of_samples;
  PictureOptions options;
  bool as_one = false;
};

/// Drawn object with its files.
struct ObjectReport : ReadFiles {
  DrawnObject object;

  static const ReportSchema& schema();
};

constexpr ReportRow kObjectReport[] = {reported_base<ReadFiles, ObjectReport>(),
                                       reported_inline<&ObjectReport::object>()};
constexpr ReportSchema kObjectReportSchema{kObjectReport};
const ReportSchema& ObjectReport::schema() { return kObjectReportSchema; }

/// Files of each object.
std::vector<CloudInput> inputs_of(const RenderArguments& a, const PictureOptions& options) {
  if (a.as_one || options.surface || options.splats) return {a.input};
  std::vector<CloudInput> inputs(a.input.files.size(), a.input);
  for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i].files = {a.input.files[i]};
  return inputs;
}

PictureObject open_object(const CloudInput& input, bool with_lines, Console& console, ReadReport& read) {
  const std::string& file = input.files[0];
  PictureObject object{.name = input.name(), .title = std::filesystem::path(file).filename().string()};
  if (input.is_function()) {
    console.progress().begin("read");
    read.format = "function";
    object.function = read_function(file);
    return object;
  }
  object.points = input.read(console, read);
  if (with_lines && input.files.size() == 1 && (file.ends_with(".vtp") || file.ends_with(".vtp.gz")))
    object.lines = read_lines(file);
  return object;
}

void run_render(const RenderArguments& a, Console& console) {
  PictureOptions options = a.options;
  options.look.picture = a.picture.chosen();
  options.surface = a.of_samples.chosen();
  options.validate();
  a.picture.check_frames(options.frames.has_value());
  check_writable(a.output, "image");
  Progress& progress = console.progress();
  ReadReport read;
  const std::vector<CloudInput> inputs = inputs_of(a, options);
  std::vector<PictureObject> objects;
  objects.reserve(inputs.size());
  for (const CloudInput& input : inputs)
    objects.push_back(open_object(input, !options.surface && !options.splats, console, read));
  PictureFiles files(a.picture, a.output, options.frames.has_value(), console);
  const RenderResult made = render(std::move(objects), options, files.writer(), progress);
  const RenderReport& r = made.report;
  console.note(a.input.name(), made.notes);
  if (r.surface) {
    console.report(a.input.report(), "input");
    console.report_value("input.format", read.format);
    console.report(r);
    console.report_stages();
    console.print(fmt::format("{} ({})", a.input.name(), read.format));
    console.print(summary_of(*r.surface));
  }
  std::vector<ObjectReport> object_reports;
  object_reports.reserve(r.objects.size());
  for (std::size_t i = 0; i < r.objects.size(); ++i) object_reports.push_back({inputs[i].report(), r.objects[i]});
  console.report(object_reports, "objects");
  const WrittenPictures& p = files.written();
  console.report(p, "output");
  console.print(fmt::format("{}: {}{} × {} pixels{}", p.words(),
                            r.objects.empty() ? "" : counted(r.objects.size(), "object") + ", ", p.width, p.height,
                            p.files.size() == 1 ? "" : " each"));
}

}  // namespace

Command add_render(CommandLine& app) {
  CommandLine& c = app.add_subcommand("render", "Mesh, points or function → picture");
  auto shared = std::make_shared<RenderArguments>();
  RenderArguments& a = *shared;
  add_surface_input(
      c, "input", a.input.files,
      "Meshes, points or functions (.smf): several are separate objects, unless --as-one or --surface is given");
  add_selection_options(c, a.input);
  add_picture_output(c, a.output);
  add_picture_options(c, a.picture);
  add_background_option(c, a.picture);
  add_schema(c, a.picture.options, {.group = "Picture", .only = {"smooth", "shadows", "antialiasing", "point_radius"}});
  add_surface(c, a.of_samples, a.options.cloud, "Cast rays at this surface of the samples, without a mesh");
  add_wireframe_options(c, a.picture.options);
  add_line_options(c, a.picture);
  add_accessibility_options(c, a.picture);
  add_schema(c, a.options, {.group = "Objects", .only = {"color", "opacity", "name", "legend"}});
  c.add_flag("--as-one", a.as_one, "Read several files (tiles) as one object").group("Objects");
  add_schema(c, a.options, {.group = "Colours", .only = {"color_by", "color_range", "bar", "unit"}});
  add_schema(
      c, a.options.look,
      {.group = "Surface", .only = {"reflection", "transmission", "refraction_index", "exact_shadows", "quick"}});
  add_schema(c, a.options, {.group = "Surface", .only = {"rays", "splats", "frames"}});
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh render surface.ply -o surface.png --view front\n"
           "  sansmesh render part.stl -o part.png --orthographic --scale-bar=mm --wireframe\n"
           "  sansmesh render a.ply b.ply scan.smf -o all.png --color red --color '#4080ff' --opacity 1 --opacity 0.4\n"
           "  sansmesh render curved.ply -o k1.png --color-by k1 --look-at 1,0,2 --look-radius 0.5\n"
           "  sansmesh render scan.ply -o scan.png --surface apss\n"
           "  sansmesh render scan.ply -o splats.png --splats\n"
           "  sansmesh render mesh.ply -o drawing.png --lines\n"
           "  sansmesh render mesh.ply -o open.png --accessibility\n"
           "  sansmesh render part.xyz -o part.png --surface amls --sharp --color-by mean\n"
           "  sansmesh render scan.ply -o turn.png --surface curvature --frames 72");
  c.announce({report_of<ReadFiles>("input"), value_of<std::string>("input.format", "Format of the file"),
              report_of<RenderReport>(), reports_of<ObjectReport>("objects"), report_of<WrittenPictures>("output")});
  return {&c, [shared](Console& console) { run_render(*shared, console); }};
}

}  // namespace sansmesh::cli
