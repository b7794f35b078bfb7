// sansmesh convert: clouds and meshes into other formats, moved, cropped, thinned, welded, split on the way.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "convert_steps.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/components.h"
#include "sansmesh/points/close_points.h"
#include "sansmesh/points/spacing.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kMostParts = 10000, kTold = 10;
constexpr double kSpacingsApart = 4;

struct ConvertArguments {
  CloudInput input;
  std::string output;
  bool ascii = false, points = false, split = false;
  std::optional<double> split_distance;
  std::size_t min_size = 0;
  ConvertSteps steps;
};

/// "out/a.ply.gz", 7 of 1234 → "out/a_0007.ply.gz".
std::string part_name(const std::string& file, std::size_t number, std::size_t parts) {
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
    require(a_.split || !a_.split_distance, "--split-distance means nothing without --split");
    require(a_.split || a_.min_size == 0, "--min-size means nothing without --split");
    check_output();
    console_.progress().begin("read");
    CloudOrMesh data(a_.input.read(console_, read_));
    const std::size_t read_vertices = data.size(), read_triangles = data.mesh.triangles.size();
    if (!read_.unread.empty())
      warn(a_.input.name(), fmt::format("not read, there is no place for it: {}", fmt::join(read_.unread, ", ")));
    said_.push_back(fmt::format("{}: {} ({})", a_.input.name(), data.size_words(), read_.format));
    if (a_.points) data.make_points();
    Json steps;
    try {
      steps = a_.steps.run(data, console_.progress(), said_);
    } catch (const DataError& error) {
      throw FileError(a_.input.name(), error.what());
    }
    if (data.nonmanifold_edges_of_weld > 0)
      warn(a_.input.name(), fmt::format("--weld has made {} of three triangles or more: the mesh is not manifold there",
                                        counted(data.nonmanifold_edges_of_weld, "edge")));
    if (!data.unturned.empty())
      warn(a_.input.name(), fmt::format("attributes of three numbers are not turned: {}",
                                        printable(fmt::format("{}", fmt::join(data.unturned, ", ")))));
    choose_kind(data);
    Json outputs = Json::array();
    if (a_.split) {
      split(data, outputs);
    } else {
      console_.progress().begin("write");
      write(a_.output, data, outputs);
    }
    console_.progress().finish();
    for (const std::string& line : said_) console_.say(line);
    if (!console_.options().json) return console_.print_timings();
    Json json;
    json["input"] = a_.input.json();
    json["input"]["format"] = read_.format;
    json["input"][read_triangles > 0 ? "vertices" : "points"] = read_vertices;
    if (read_triangles > 0) json["input"]["triangles"] = read_triangles;
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

  /// Before anything is read: whether something can be written there at all.
  void check_output() const {
    const bool mesh = is_written(a_.output, "mesh"), points = is_written(a_.output, "points");
    if (!mesh && !points && is_read(a_.output))
      throw FileError(a_.output, "this format is read, not written; .ply, .vtp, .las and .csv hold whatever it does");
    check_writable(a_.output, mesh && !(a_.points && points) ? "mesh" : "points");
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

  void check_parts(std::size_t parts, std::size_t small, const char* of) {
    const std::string all = fmt::format("--split finds {}", counted(parts + small, "part"));
    if (parts == 0)
      throw FileError(a_.input.name(), fmt::format("{}, none of them of {} {} or more", all, grouped(a_.min_size), of));
    if (parts > kMostParts)
      throw FileError(a_.input.name(),
                      fmt::format("{}, more than {}: {}", all, grouped(kMostParts),
                                  std::string(of) == "triangles"
                                      ? "--weld 0 before joins what only touches, --min-size leaves out small ones"
                                      : "--split-distance joins more, --min-size leaves out small ones"));
    if (small > 0)
      warn(a_.input.name(),
           fmt::format("{} of fewer than {} {} left out", counted(small, "part"), grouped(a_.min_size), of));
    check_part_names(parts);
    console_.progress().begin("write");
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

  /// The largest part first.
  void split(CloudOrMesh& data, Json& outputs) {
    console_.progress().begin("split");
    if (data.is_mesh) {
      const MeshComponents components = find_components(data.mesh);
      std::vector<std::size_t> triangles(components.size());
      for (const std::uint32_t c : components.of_triangle) ++triangles[c];
      const auto parts = static_cast<std::size_t>(
          std::count_if(triangles.begin(), triangles.end(), [&](std::size_t n) { return n >= a_.min_size; }));
      check_parts(parts, components.size() - parts, "triangles");
      if (parts > kTold && 2 * parts > data.mesh.triangles.size())
        warn(a_.input.name(), fmt::format("{} of {}: triangles that share no vertex are parts of their own; --weld 0 "
                                          "before --split joins those that touch",
                                          counted(parts, "part"), counted(data.mesh.triangles.size(), "triangle")));
      std::vector<TriangleMesh> meshes = split_components(data.mesh, components);
      std::size_t vertices = 0;
      for (const TriangleMesh& m : meshes) vertices += m.vertices.size();
      if (vertices < data.mesh.vertices.size())
        warn(a_.input.name(),
             fmt::format("{} of no triangle left out", counted(data.mesh.vertices.size() - vertices, "point")));
      for (std::size_t c = 0, number = 0; c < meshes.size(); ++c) {
        if (triangles[c] < a_.min_size) continue;
        CloudOrMesh part{PointSet{}};
        part.is_mesh = true;
        part.mesh = std::move(meshes[c]);
        write(part_name(a_.output, ++number, parts), part, outputs);
      }
      tell_parts(parts);
      return;
    }
    const double distance = a_.split_distance ? *a_.split_distance : kSpacingsApart * estimate_spacing(data.points);
    const CloudComponents components = find_cloud_components(data.points.positions, distance, console_.progress());
    said_.push_back(
        fmt::format("--split: {} at a distance of {}", counted(components.size(), "part"), length(distance)));
    const auto parts = static_cast<std::size_t>(std::count_if(components.points.begin(), components.points.end(),
                                                              [&](std::size_t n) { return n >= a_.min_size; }));
    check_parts(parts, components.size() - parts, "points");
    std::vector<std::vector<std::uint32_t>> rows(components.size());
    for (std::size_t i = 0; i < components.of_point.size(); ++i)
      rows[components.of_point[i]].push_back(static_cast<std::uint32_t>(i));
    for (std::size_t c = 0; c < parts; ++c) {  // those of fewer points come last
      CloudOrMesh part{take_samples(data.points, rows[c])};
      write(part_name(a_.output, c + 1, parts), part, outputs);
    }
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
               "Mesh (.ply .obj .stl .off .glb .vtp) or points (.ply .obj .xyz .csv .pcd .vtp .las) to write")
      .type_name("FILE")
      .required();
  add_ascii_flag(c, a.ascii);
  c.add_flag("--points", a.points, "Of a mesh the vertices alone");
  c.add_flag("--split", a.split, "Connected parts as files of their own: NAME_001.ply, … the largest first");
  c.add_option("--split-distance", a.split_distance, "Of clouds: points as close as this are connected [4 spacings]")
      .type_name("LENGTH")
      .positive();
  c.add_option("--min-size", a.min_size, "With --split: leave out parts of fewer triangles (or points)")
      .type_name("COUNT");
  add_convert_steps(c, a.steps);
  c.footer(std::string(kReadable) +
           " Moves, selections and changes are done in the order in\n"
           "which they are given.\n\nExamples:\n"
           "  sansmesh convert part.stl -o part.ply --weld 0 --unit mm --to-unit m --up z\n"
           "  sansmesh convert a.las b.las -o all.ply --crop 0,0,0,100,100,50 --spacing 0.5\n"
           "  sansmesh convert scan.ply -o moved.ply --transform matrix.txt");
  return {&c, [shared](Console& console) { Conversion(*shared, console).run(); }};
}

}  // namespace sansmesh::cli
