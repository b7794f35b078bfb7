// Command `convert`: converts clouds and meshes to other formats, and moves, crops, thins, welds or splits them.
#include "sansmesh/convert.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/points/cloud_files.h"
#include "sansmesh/jobs/frame_names.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kPrintedFiles = 10;

struct ConvertArguments {
  CloudInput input;
  std::string output;
  bool ascii = false, split = false;
  ConvertOptions options;
  SplitOptions parts;
  HeightGridOptions heights;
  std::string contours, hillshade;  ///< files beside a height grid

  bool writes_heights() const { return output.ends_with(".tif") || output.ends_with(".tiff"); }
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

/// Generated names, which must not be those of the input.
std::vector<std::string> names_of_parts(const ConvertArguments& a, std::size_t parts, Console& console) {
  std::vector<std::string> names(parts);
  for (std::size_t k = 0; k < parts; ++k) names[k] = part_name(a.output, k + 1, parts);
  check_inputs_stay(io::list_cloud_files(a.input.files), names);
  std::error_code none;
  const std::string beyond = part_name(a.output, parts + 1, parts);
  if (std::filesystem::exists(beyond, none))
    console.warn(beyond, {"is not one of the " + counted(parts, "part") + ", and existed before"});
  return names;
}

/// Height grid of a terrain, with contour lines and picture.
void write_heights(const ConvertArguments& a, const CloudOrMesh& data, std::vector<std::string>& summary,
                   Console& console) {
  const std::string name = a.input.name();
  const HeightGridResult made =
      naming(name, console, [&] { return make_height_grid(data, a.heights, console.progress()); });
  console.note(name, made.notes);
  console.progress().begin("write");
  write_height_grid(a.output, made.grid);
  summary.push_back(a.output + ": " + summary_of(made.report)[0]);
  console.report(made.report, "heights");
  console.report_value("heights.file", a.output);
  if (!a.contours.empty()) {
    const std::size_t lines = write_contours(a.contours, made.grid, made.report.interval);
    summary.push_back(
        fmt::format("{}: {}, every {:.6g}", a.contours, counted(lines, "contour line"), made.report.interval));
    console.report_value("contours.file", a.contours);
    console.report_value("contours.lines", lines);
  }
  if (a.hillshade.empty()) return;
  const Image picture = hillshade_of(made.grid);
  write_image(a.hillshade, picture);
  const WrittenPictures written{{a.hillshade}, picture.width, picture.height};
  summary.push_back(written.size_line());
  console.report_value("hillshade.file", a.hillshade);
}

void check_heights(const ConvertArguments& a) {
  if (!a.writes_heights()) {
    require(a.contours.empty() && a.hillshade.empty() && options_set(a.heights).empty(),
            "--cell, --gap, --interval, --contours and --hillshade need a height grid: -o FILE.tif");
    return;
  }
  require(!a.split && !a.ascii, "--split and --ascii are for points and meshes, not for a height grid");
  if (!a.contours.empty()) check_contours_writable(a.contours);
  if (!a.hillshade.empty()) check_writable(a.hillshade, "image");
}

void run_convert(const ConvertArguments& a, Console& console) {
  a.options.validate();
  a.parts.validate();
  a.heights.validate();
  check_heights(a);
  require(a.split || options_set(a.parts).empty(), "--split-distance and --min-size need --split");
  if (!a.writes_heights()) check_converted(a.output, a.options.vertices_only);
  const std::string name = a.input.name();
  Progress& progress = console.progress();
  ReadReport read;
  PointSet given = a.input.read(console, read);
  ConvertResult made = naming(name, console, [&] { return convert(std::move(given), a.options, progress); });
  CloudOrMesh& data = made.data;
  console.note(name, made.notes);
  if (a.writes_heights()) {
    std::vector<std::string> lines = summary_of(made.report);
    write_heights(a, data, lines, console);
    console.print(fmt::format("{}: {} ({})", name, made.report.size_words, read.format));
    console.print(lines);
    console.report(a.input.report(), "input");
    console.report_value("input.format", read.format);
    console.report_value("input.unread", read.unread);
    console.report(made.report);
    return;
  }
  console.note(a.output, fit_to_format(data, a.output));
  if (data.is_mesh)
    warn_of_losses(name, read, a.output, data.mesh, console);
  else
    warn_of_losses(name, read, a.output, data.points, console);
  const std::vector<std::string> lost = left_out(a.output, data);
  std::vector<std::string> summary = summary_of(made.report);
  std::vector<CloudOrMesh> parts;
  std::vector<std::string> files{a.output};
  if (a.split) {
    SplitResult found = naming(name, console, [&] { return split(data, a.parts, progress); });
    console.note(name, found.notes);
    summary.push_back(summary_of(found)[0]);
    console.report(found);
    parts = std::move(found.parts);
    files = names_of_parts(a, parts.size(), console);
  } else {
    parts.push_back(std::move(data));
  }
  progress.begin("write");
  std::vector<ConvertedFile> outputs;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const bool mesh = parts[k].is_mesh;
    if (k == 0) warn_of_system(files[k], (mesh ? parts[k].mesh.reference : parts[k].points.reference).get(), console);
    write_converted(files[k], parts[k], a.ascii);
    outputs.push_back({files[k], parts[k].size(), value_if(mesh, parts[k].mesh.triangles.size())});
  }
  console.print(fmt::format("{}: {} ({})", name, made.report.size_words, read.format));
  console.print(summary);
  for (std::size_t k = 0; k < std::min(kPrintedFiles, parts.size()); ++k)
    console.print(
        fmt::format("{}: {}{}", files[k], parts[k].size_words(), a.split ? "" : parts[k].attribute_words(lost)));
  if (parts.size() > kPrintedFiles)
    console.print(fmt::format("… {} written, {}", counted(parts.size(), "part"), WrittenPictures{files}.words()));
  console.report(a.input.report(), "input");
  console.report_value("input.format", read.format);
  console.report_value("input.unread", read.unread);
  console.report(made.report);
  console.report(outputs, "outputs");
  console.report_value("left_out", lost);
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
  add_schema(c, a.heights, {.group = "Height grid"});
  c.add_option("--contours", a.contours, "Contour lines of the height grid to write (.svg .dxf .vtp .ply .csv)")
      .writes({".svg", ".dxf", ".vtp", ".ply", ".csv"})
      .group("Height grid");
  c.add_option("--hillshade", a.hillshade, "Picture of the height grid, lit from the north-west, to write (.png)")
      .writes({".png"})
      .group("Height grid");
  c.footer(std::string(kReadable) +
           " Moves, selections and changes are applied in the\n"
           "given order.\n\nExamples:\n"
           "  sansmesh convert part.stl -o part.ply --weld 0 --unit mm --to-unit m --up z\n"
           "  sansmesh convert a.las b.las -o all.ply --box 0,0,0,100,100,50 --point-spacing 0.5\n"
           "  sansmesh convert scan.ply -o moved.ply --transform matrix.txt\n"
           "  sansmesh convert tile.las -o classified.las --classify-ground\n"
           "  sansmesh convert tile.las -o terrain.tif --cell 0.5 --contours lines.dxf --hillshade shade.png");
  c.announce(
      {report_of<ReadFiles>("input"), value_of<std::string>("input.format", "Format of the file"),
       value_of<std::vector<std::string>>("input.unread", "Unread parts of the file"), report_of<ConvertReport>(),
       report_of<SplitResult>(), report_of<HeightGridReport>("heights"),
       value_of<std::string>("heights.file", "Height grid"), value_of<std::string>("contours.file", "Contour lines"),
       value_of<std::size_t>("contours.lines", "Number of contour lines"),
       value_of<std::string>("hillshade.file", "Picture of the height grid"), reports_of<ConvertedFile>("outputs"),
       value_of<std::vector<std::string>>("left_out", "Parts that the output format cannot hold")});
  return {&c, [shared](Console& console) { run_convert(*shared, console); }};
}

}  // namespace sansmesh::cli
