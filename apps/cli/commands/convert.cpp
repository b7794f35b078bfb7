// Command `convert`: converts clouds and meshes to other formats, and moves, crops, thins, welds or splits them.
#include "sansmesh/convert.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/height_output.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kPrintedFiles = 10;

struct ConvertArguments {
  CloudInput input;
  std::string output;
  bool ascii = false, split = false;
  ConvertOptions options;
  SplitOptions parts;
  HeightOutput heights;

  bool writes_heights() const { return HeightOutput::is_grid(output); }
  bool writes_parts() const { return split || parts.tile_size.has_value(); }
};

/// Written cloud or mesh.
struct ConvertedFile {
  std::string file;
  std::size_t size = 0;
  std::optional<std::size_t> triangles;

  static const ReportSchema& schema();
};

constexpr ReportRow kConvertedFile[] = {
    reported<&ConvertedFile::file>({.text = "File"}),
    reported<[](const ConvertedFile& r) { return value_if(!r.triangles, r.size); }>(
        {.name = "points", .text = "Points in the file"}),
    reported<[](const ConvertedFile& r) { return value_if(r.triangles.has_value(), r.size); }>(
        {.name = "vertices", .text = "Vertices in the file"}),
    reported<&ConvertedFile::triangles>({.text = "Triangles in the file"})};
constexpr ReportSchema kConvertedFileSchema{kConvertedFile};
const ReportSchema& ConvertedFile::schema() { return kConvertedFileSchema; }

bool moves(const ConvertStep& step) {
  return std::visit(
      []<class S>(const S&) {
        return std::is_same_v<S, TransformStep> || std::is_same_v<S, TranslateStep> || std::is_same_v<S, CenterStep> ||
               std::is_same_v<S, RotateStep> || std::is_same_v<S, ScaleStep> || std::is_same_v<S, AxesStep> ||
               std::is_same_v<S, UpStep> || std::is_same_v<S, UnitStep>;
      },
      step);
}

std::string option_of(const ConvertStep& step) {
  std::string name(step_name(step));
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

void check_convert(const ConvertArguments& a) {
  a.options.validate();
  a.parts.validate();
  a.heights.check(a.output, a.parts.tile_size, a.input.files);
  if (a.writes_heights()) {
    require(!a.split && !a.ascii && !a.parts.split_distance && a.parts.min_size == 0,
            "--split, --split-distance, --min-size and --ascii are for points and meshes, not for a height grid");
    for (const ConvertStep& step : a.options.steps)
      if (!a.heights.breaklines.empty() && moves(step))
        throw ArgumentError("--breaklines have the coordinates of the input, which --" + option_of(step) + " changes");
    return;
  }
  require(!a.split || !a.parts.tile_size, "--split makes connected parts, --tile-size makes tiles: give one of them");
  require(a.writes_parts() || options_set(a.parts).empty(), "--split-distance and --min-size need --split");
  check_converted(a.output, a.options.vertices_only);
}

/// Height grid of a terrain, with contour lines and picture.
void write_heights(const ConvertArguments& a, const ConvertResult& made, const ReadReport& read, Console& console) {
  const std::string name = a.input.name();
  const HeightGridUse use = a.heights.use(a.parts.tile_size, console);
  const HeightGridResult grid =
      naming(name, console, [&] { return make_height_grid(made.data, a.heights.options, console.progress(), use); });
  console.note(name, grid.notes);
  std::vector<std::string> summary = summary_of(made.report);
  a.heights.write(a.output, grid, a.parts.tile_size, a.input.files, summary, console);
  console.print(fmt::format("{}: {} ({})", name, made.report.size_words, read.format));
  console.print(summary);
}

/// The data or its parts.
struct ConvertedParts {
  std::vector<CloudOrMesh> parts;
  std::vector<std::string> files;
};

ConvertedParts parts_of(const ConvertArguments& a, CloudOrMesh& data, std::vector<std::string>& summary,
                        Console& console) {
  ConvertedParts made;
  if (!a.writes_parts()) {
    made.parts.push_back(std::move(data)), made.files = {a.output};
    return made;
  }
  const std::string name = a.input.name();
  SplitResult found = naming(name, console, [&] { return split(data, a.parts, console.progress()); });
  console.note(name, found.notes);
  summary.push_back(summary_of(found)[0]);
  console.report(found);
  made.files = names_of_parts(a.output, found.parts.size(), found.places, a.input.files, console);
  made.parts = std::move(found.parts);
  return made;
}

void write_parts(const ConvertArguments& a, CloudOrMesh& data, const ConvertReport& report, const ReadReport& read,
                 Console& console) {
  const std::string name = a.input.name();
  console.note(a.output, fit_to_format(data, a.output));
  if (data.is_mesh)
    warn_of_losses(name, read, a.output, data.mesh, console);
  else
    warn_of_losses(name, read, a.output, data.points, console);
  const std::vector<std::string> lost = left_out(a.output, data);
  std::vector<std::string> summary = summary_of(report);
  const auto [parts, files] = parts_of(a, data, summary, console);
  console.progress().begin("write");
  std::vector<ConvertedFile> outputs;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const bool mesh = parts[k].is_mesh;
    if (k == 0) warn_of_system(files[k], (mesh ? parts[k].mesh.reference : parts[k].points.reference).get(), console);
    write_converted(files[k], parts[k], a.ascii);
    outputs.push_back({files[k], parts[k].size(), value_if(mesh, parts[k].mesh.triangles.size())});
  }
  console.print(fmt::format("{}: {} ({})", name, report.size_words, read.format));
  console.print(summary);
  for (std::size_t k = 0; k < std::min(kPrintedFiles, parts.size()); ++k)
    console.print(fmt::format("{}: {}{}", files[k], parts[k].size_words(),
                              a.writes_parts() ? "" : parts[k].attribute_words(lost)));
  if (parts.size() > kPrintedFiles)
    console.print(fmt::format("… {} written, {}", counted(parts.size(), a.split ? "part" : "tile"),
                              WrittenPictures{files}.words()));
  console.report(outputs, "outputs");
  console.report_value("left_out", lost);
}

void run_convert(const ConvertArguments& a, Console& console) {
  check_convert(a);
  const std::string name = a.input.name();
  ReadReport read;
  PointSet given = a.input.read(console, read);
  ConvertResult made = naming(name, console, [&] { return convert(std::move(given), a.options, console.progress()); });
  console.note(name, made.notes);
  if (a.writes_heights())
    write_heights(a, made, read, console);
  else
    write_parts(a, made.data, made.report, read, console);
  console.report(a.input.report(), "input");
  console.report_value("input.format", read.format);
  console.report_value("input.unread", read.unread);
  console.report(made.report);
}

}  // namespace

Command add_convert(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("convert", "Points or meshes → other formats; moved, cropped, thinned, merged, split");
  auto shared = std::make_shared<ConvertArguments>();
  ConvertArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  std::vector<std::string> written = endings_written(kMesh | kPoints);
  written.emplace_back(".tif");
  c.add_option("-o,--output", a.output,
               "Mesh (" + listed_endings(endings_written(kMesh)) + "), points (" +
                   listed_endings(endings_written(kPoints)) + ") or height grid of the ground (.tif) to write")
      .writes(written)
      .required();
  add_ascii_flag(c, a.ascii);
  add_schema(c, a.options, {.only = {"vertices_only"}});
  c.add_flag("--split", a.split, "Write connected parts as separate files: NAME_001.ply, …, the largest first");
  add_schema(c, a.parts);
  add_schema(c, a.options,
             {.group = "Moves",
              .only = {"transform", "inverse_transform", "translate", "center", "rotate", "scale", "about", "new_axes",
                       "up", "unit", "to_unit"}});
  add_schema(
      c, a.options,
      {.group = "Selection", .only = {"box", "outside_box", "point_spacing", "point_count", "every", "keep", "drop"}});
  add_schema(c, a.options,
             {.group = "Changes", .only = {"weld", "flip", "flip_faces", "flip_normals", "classify_ground"}});
  add_height_output(c, a.heights, true);
  c.footer(std::string(kReadable) +
           " Moves, selections and changes are applied in the\n"
           "given order.\n\nExamples:\n"
           "  sansmesh convert part.stl -o part.ply --weld 0 --unit mm --to-unit m --up z\n"
           "  sansmesh convert a.las b.las -o all.ply --box 0,0,0,100,100,50 --point-spacing 0.5\n"
           "  sansmesh convert scan.ply -o moved.ply --transform matrix.txt\n"
           "  sansmesh convert tile.las -o classified.las --classify-ground\n"
           "  sansmesh convert tile.las -o terrain.tif --cell 0.5 --contours lines.dxf --hillshade shade.png\n"
           "  sansmesh convert tiles/ -o new/survey.laz --tile-size 500");
  c.announce({report_of<ReadFiles>("input"), value_of<std::string>("input.format", "Format of the file"),
              value_of<std::vector<std::string>>("input.unread", "Unread parts of the file"),
              report_of<ConvertReport>(), report_of<SplitResult>(), reports_of<ConvertedFile>("outputs"),
              value_of<std::vector<std::string>>("left_out", "Parts that the output format cannot hold")});
  return {&c, [shared](Console& console) { run_convert(*shared, console); }};
}

}  // namespace sansmesh::cli
