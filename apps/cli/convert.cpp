// sansmesh convert: clouds and meshes into other formats, moved, cropped, thinned, welded, split on the way.
#include "sansmesh/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloud_input.h"
#include "commands.h"
#include "flags.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/jobs/frame_names.h"
#include "schema_options.h"
#include "standard_streams.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kTold = 10;

struct ConvertArguments {
  CloudInput input;
  std::string output;
  bool ascii = false, split = false;
  ConvertOptions options;
  SplitOptions parts;
};

/// A cloud or a mesh that was written.
struct ConvertedFile {
  std::string file;
  std::size_t size = 0;
  std::optional<std::size_t> triangles;

  static const ReportSchema& schema();
};

constexpr ReportRow kConvertedFile[] = {
    reported<&ConvertedFile::file>({.text = "File"}),
    reported<[](const ConvertedFile& r) { return told_if(!r.triangles, r.size); }>(
        {.name = "points", .text = "Points that were written"}),
    reported<[](const ConvertedFile& r) { return told_if(r.triangles.has_value(), r.size); }>(
        {.name = "vertices", .text = "Vertices that were written"}),
    reported<&ConvertedFile::triangles>({.text = "Triangles that were written"})};
constexpr ReportSchema kConvertedFileSchema{kConvertedFile};
const ReportSchema& ConvertedFile::schema() { return kConvertedFileSchema; }

class Conversion {
 public:
  Conversion(const ConvertArguments& arguments, Console& console) : a_(arguments), console_(console) {}

  void run() {
    const ConvertOptions& options = a_.options;
    options.validate();
    a_.parts.validate();
    require(a_.split || !a_.parts.split_distance, "--split-distance means nothing without --split");
    require(a_.split || a_.parts.min_size == 0, "--min-size means nothing without --split");
    check_converted(a_.output, options.vertices_only);
    const std::string name = a_.input.name();
    Progress& progress = console_.progress();
    PointSet given = a_.input.read(console_, read_);
    if (!read_.unread.empty())
      warn(name, fmt::format("not read, there is no place for it: {}", fmt::join(read_.unread, ", ")));
    ConvertResult made = naming(name, console_, [&] { return convert(std::move(given), options, progress); });
    const ConvertReport& r = made.report;
    said_.push_back(fmt::format("{}: {} ({})", name, r.size_words, read_.format));
    for (const ConvertedBy& done : r.steps)
      if (!done.remark.empty()) said_.push_back(fmt::format("{}: {}", flag_of_name(done.step), done.remark));
    console_.note(name, made.notes);
    console_.note(a_.output, fit_to_format(made.data, a_.output));
    if (a_.split) {
      split_into_files(made.data);
    } else {
      progress.begin("write");
      write(a_.output, made.data);
    }
    for (const std::string& line : said_) console_.say(line);
    console_.tell(a_.input.told(), "input");
    console_.tell_value("input.format", read_.format);
    console_.tell_value("input.unread", read_.unread);
    console_.tell(r);
    console_.tell(outputs_, "outputs");
    console_.tell_value("left_out", left_out_);
  }

 private:
  void warn(const std::string& file, const std::string& warning) {
    console_.warn(file, std::vector<std::string>{warning});
  }

  void write(const std::string& file, const CloudOrMesh& data) {
    const std::vector<std::string> lost = data.is_mesh ? left_out(file, data.mesh) : left_out(file, data.points);
    if (!lost.empty() && left_out_.empty()) {
      left_out_ = lost;
      warn(a_.output, fmt::format("its format has no room for {}: left out", fmt::join(lost, ", ")));
    }
    if (data.is_mesh)
      write_mesh(file, data.mesh, {.ascii = a_.ascii});
    else
      write_points(file, data.points, {.ascii = a_.ascii});
    if (outputs_.size() < kTold)
      said_.push_back(fmt::format("{}: {}{}", file, data.size_words(), a_.split ? "" : data.belongings(lost)));
    else if (outputs_.size() == kTold)
      said_.push_back("…");
    outputs_.push_back({file, data.size(), data.is_mesh ? std::optional(data.mesh.triangles.size()) : std::nullopt});
  }

  /// Parts have names that nobody gave: they must not be those of the input.
  void check_part_names(std::size_t parts) {
    std::vector<std::string> names(parts);
    for (std::size_t k = 0; k < parts; ++k) names[k] = part_name(a_.output, k + 1, parts);
    check_inputs_stay(a_.input.files, names);
    std::error_code none;
    const std::string beyond = part_name(a_.output, parts + 1, parts);
    if (std::filesystem::exists(beyond, none))
      warn(beyond, "is none of the " + counted(parts, "part") + ", but was there before");
  }

  void split_into_files(const CloudOrMesh& data) {
    const std::string name = a_.input.name();
    const SplitResult made = naming(name, console_, [&] { return split(data, a_.parts, console_.progress()); });
    console_.note(name, made.notes);
    console_.tell(made);
    if (made.distance)
      said_.push_back(
          fmt::format("--split: {} at a distance of {}", counted(made.found, "part"), length(*made.distance)));
    const std::size_t parts = made.parts.size();
    check_part_names(parts);
    console_.progress().begin("write");
    for (std::size_t k = 0; k < parts; ++k) write(part_name(a_.output, k + 1, parts), made.parts[k]);
    tell_parts(parts);
  }

  void tell_parts(std::size_t parts) {
    if (parts <= kTold) return;
    said_.push_back(fmt::format("{} written, {} to {}", counted(parts, "part"), part_name(a_.output, 1, parts),
                                part_name(a_.output, parts, parts)));
  }

  const ConvertArguments& a_;
  Console& console_;
  ReadReport read_;
  std::vector<ConvertedFile> outputs_;
  std::vector<std::string> said_, left_out_;  // lines for when all is done; what the format has no room for
};

}  // namespace

Command add_convert(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("convert", "Points or meshes → other formats; moved, cropped, thinned, merged, split");
  auto shared = std::make_shared<ConvertArguments>();
  ConvertArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a.output,
               "Mesh (" + listed_endings(endings_written(kMesh)) + ") or points (" +
                   listed_endings(endings_written(kPoints)) + ") to write")
      .writes(endings_written(kMesh | kPoints))
      .required();
  add_ascii_flag(c, a.ascii);
  add_schema(c, a.options, {.only = {"vertices_only"}});
  c.add_flag("--split", a.split, "Connected parts as files of their own: NAME_001.ply, … the largest first");
  add_schema(c, a.parts);
  add_schema(c, a.options,
             {.group = "Moves",
              .only = {"transform", "inverse_transform", "translate", "center", "rotate", "scale", "about", "new_axes",
                       "up", "unit", "to_unit"}});
  add_schema(
      c, a.options,
      {.group = "Selection", .only = {"box", "outside_box", "point_spacing", "point_count", "every", "keep", "drop"}});
  add_schema(c, a.options, {.group = "Changes", .only = {"weld", "flip", "flip_faces", "flip_normals"}});
  c.footer(std::string(kReadable) +
           " Moves, selections and changes are done in the order in\n"
           "which they are given.\n\nExamples:\n"
           "  sansmesh convert part.stl -o part.ply --weld 0 --unit mm --to-unit m --up z\n"
           "  sansmesh convert a.las b.las -o all.ply --box 0,0,0,100,100,50 --point-spacing 0.5\n"
           "  sansmesh convert scan.ply -o moved.ply --transform matrix.txt");
  c.tells({told<ReadFiles>("input"), told_value<std::string>("input.format", "Format of the file"),
           told_value<std::vector<std::string>>("input.unread", "What there was no place for"), told<ConvertReport>(),
           told<SplitResult>(), told_list<ConvertedFile>("outputs"),
           told_value<std::vector<std::string>>("left_out", "What the format of the output has no room for")});
  return {&c, [shared](Console& console) { Conversion(*shared, console).run(); }};
}

}  // namespace sansmesh::cli
