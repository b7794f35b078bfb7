// sansmesh convert: clouds and meshes into other formats, moved, cropped, thinned, welded, split on the way.
#include "sansmesh/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "convert_steps.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
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
  ConvertSteps steps;
};

/// "--outside-box".
std::string flag_of_step(std::string_view name) {
  std::string flag = "--" + std::string(name);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

/// "out/a.ply.gz", 7 of 1234 → "out/a_0007.ply.gz".
std::string part_name(const std::string& file, std::size_t number, std::size_t parts) {
  check_holds_several(file);
  const std::filesystem::path path(file);
  std::string name = path.filename().string();
  std::string endings = path.extension().string();
  if (endings == ".gz" || endings == ".GZ") endings = path.stem().extension().string() + endings;
  name.resize(name.size() - endings.size());
  const std::size_t width = std::max<std::size_t>(3, std::to_string(parts).size());
  return (path.parent_path() / fmt::format("{}_{:0{}}{}", name, number, width, endings)).string();
}

/// ", with normals, colours, intensity and 3 more": what there is but for what is lost.
std::string belongings(const CloudOrMesh& data, const std::vector<std::string>& lost) {
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> names;
  if (!(data.is_mesh ? data.mesh.normals : data.points.normals).empty()) names.emplace_back("normals");
  if (!(data.is_mesh ? data.mesh.colors : data.points.colors).empty()) names.emplace_back("colours");
  for (const Attribute& a : data.attributes()) names.push_back(printable(a.name, 80));
  for (const Attribute& a : data.mesh.triangle_attributes) names.push_back(printable(a.name, 80) + " of triangles");
  std::erase_if(names, [&](const std::string& n) { return std::find(lost.begin(), lost.end(), n) != lost.end(); });
  if (names.empty()) return "";
  const std::size_t more = names.size() > kNamed + 1 ? names.size() - kNamed : 0;
  names.resize(names.size() - more);
  return fmt::format(", with {}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

class Conversion {
 public:
  Conversion(const ConvertArguments& arguments, Console& console) : a_(arguments), console_(console) {}

  void run() {
    a_.steps.check();
    ConvertOptions options = a_.options;
    options.steps = a_.steps.steps;
    options.validate();
    a_.parts.validate();
    require(a_.split || !a_.parts.split_distance, "--split-distance means nothing without --split");
    require(a_.split || a_.parts.min_size == 0, "--min-size means nothing without --split");
    check_output();
    const std::string name = a_.input.name();
    Progress& progress = console_.progress();
    progress.begin("read");
    PointSet given = a_.input.read(console_, read_);
    if (!read_.unread.empty())
      warn(name, fmt::format("not read, there is no place for it: {}", fmt::join(read_.unread, ", ")));
    ConvertResult made = naming(name, console_, [&] { return convert(std::move(given), options, progress); });
    const ConvertReport& r = made.report;
    said_.push_back(fmt::format("{}: {} ({})", name, r.size_words, read_.format));
    const Json steps = told_steps(r);
    console_.note(name, made.notes);
    choose_kind(made.data);
    Json outputs = Json::array();
    if (a_.split) {
      split_into_files(made.data, outputs);
    } else {
      progress.begin("write");
      write(a_.output, made.data, outputs);
    }
    progress.finish();
    for (const std::string& line : said_) console_.say(line);
    if (!console_.options().json) return console_.print_timings();
    Json json;
    json["input"] = a_.input.json();
    json["input"]["format"] = read_.format;
    json["input"][r.triangles > 0 ? "vertices" : "points"] = r.size;
    if (r.triangles > 0) json["input"]["triangles"] = r.triangles;
    json["input"]["unread"] = read_.unread;
    json["steps"] = steps;
    json["outputs"] = outputs;
    json["left_out"] = left_out_;
    console_.say_json(json);
    console_.print_timings();
  }

 private:
  void warn(const std::string& file, const std::string& warning) {
    console_.warn(file, std::vector<std::string>{warning});
  }

  Json told_steps(const ConvertReport& report) {
    Json steps = Json::array();
    for (const ConvertedBy& done : report.steps) {
      const std::string flag = flag_of_step(done.step);
      if (!done.remark.empty()) said_.push_back(fmt::format("{}: {}", flag, done.remark));
      Json entry;
      entry["option"] = flag;
      entry[done.triangles ? "vertices" : "points"] = done.size;
      if (done.triangles) entry["triangles"] = *done.triangles;
      steps.push_back(std::move(entry));
    }
    return steps;
  }

  /// Before anything is read: whether something can be written there at all.
  void check_output() const {
    const bool mesh = is_written(a_.output, "mesh"), points = is_written(a_.output, "points");
    if (!mesh && !points && is_read(a_.output))
      throw FileError(a_.output, "this format is read, not written; .ply, .vtp, .las and .csv hold whatever it does");
    check_writable(a_.output, mesh && !(a_.options.vertices_only && points) ? "mesh" : "points");
  }

  /// Meshes are written as points, with a word, where the format has no faces; points never become a mesh.
  void choose_kind(CloudOrMesh& data) {
    if (data.is_mesh && !is_written(a_.output, "mesh")) {
      warn(a_.output, fmt::format("holds points only: {} left out", counted(data.mesh.triangles.size(), "triangle")));
      data.make_points();
    }
    if (!data.is_mesh && !is_written(a_.output, "points"))
      throw FileError(a_.output,
                      "is of a format for meshes, and there are only points; `sansmesh reconstruct` makes a mesh of "
                      "them, .ply .obj .xyz .csv .pcd .vtp .las hold points");
  }

  void write(const std::string& file, const CloudOrMesh& data, Json& outputs) {
    const std::vector<std::string> lost = data.is_mesh ? left_out(file, data.mesh) : left_out(file, data.points);
    if (!lost.empty() && left_out_.empty()) {
      left_out_ = lost;
      warn(a_.output, fmt::format("its format has no room for {}: left out", fmt::join(lost, ", ")));
    }
    if (data.is_mesh)
      write_mesh(file, data.mesh, {.ascii = a_.ascii});
    else
      write_points(file, data.points, {.ascii = a_.ascii});
    if (outputs_ < kTold)
      said_.push_back(fmt::format("{}: {}{}", file, data.size_words(), a_.split ? "" : belongings(data, lost)));
    else if (outputs_ == kTold)
      said_.push_back("…");
    ++outputs_;
    Json entry;
    entry["file"] = file;
    entry[data.is_mesh ? "vertices" : "points"] = data.size();
    if (data.is_mesh) entry["triangles"] = data.mesh.triangles.size();
    outputs.push_back(std::move(entry));
  }

  /// Parts have names that nobody gave: they must not be those of the input.
  void check_part_names(std::size_t parts) {
    std::error_code none;
    for (std::size_t k = 1; k <= parts; ++k)
      for (const std::string& file : a_.input.files)
        if (std::filesystem::equivalent(part_name(a_.output, k, parts), file, none))
          throw FileError(
              file, "is an input, and part " + std::to_string(k) + " would be written over it; give -o another name");
    const std::string beyond = part_name(a_.output, parts + 1, parts);
    if (std::filesystem::exists(beyond, none))
      warn(beyond, "is none of the " + counted(parts, "part") + ", but was there before");
  }

  void split_into_files(const CloudOrMesh& data, Json& outputs) {
    const std::string name = a_.input.name();
    const SplitResult made = naming(name, console_, [&] { return split(data, a_.parts, console_.progress()); });
    console_.note(name, made.notes);
    if (made.distance)
      said_.push_back(
          fmt::format("--split: {} at a distance of {}", counted(made.found, "part"), length(*made.distance)));
    const std::size_t parts = made.parts.size();
    check_part_names(parts);
    console_.progress().begin("write");
    for (std::size_t k = 0; k < parts; ++k) write(part_name(a_.output, k + 1, parts), made.parts[k], outputs);
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
  std::size_t outputs_ = 0;
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
      .type_name("FILE")
      .required();
  add_ascii_flag(c, a.ascii);
  add_schema(c, a.options);
  c.add_flag("--split", a.split, "Connected parts as files of their own: NAME_001.ply, … the largest first");
  add_schema(c, a.parts);
  add_convert_steps(c, a.steps);
  c.footer(std::string(kReadable) +
           " Moves, selections and changes are done in the order in\n"
           "which they are given.\n\nExamples:\n"
           "  sansmesh convert part.stl -o part.ply --weld 0 --unit mm --to-unit m --up z\n"
           "  sansmesh convert a.las b.las -o all.ply --box 0,0,0,100,100,50 --point-spacing 0.5\n"
           "  sansmesh convert scan.ply -o moved.ply --transform matrix.txt");
  return {&c, [shared](Console& console) { Conversion(*shared, console).run(); }};
}

}  // namespace sansmesh::cli
