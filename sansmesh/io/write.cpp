// Chooses the writer for a file by its ending.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/output_place.h"

namespace sansmesh {
namespace {

using FileParts = std::vector<std::string>;

/// What a format has room for beside positions and triangles.
enum class Room { positions, colors, colors_and_few_floats, all_but_normals, all };

template <class Data>
struct Writer {
  const char* ending;
  FileParts (*write)(const Data&, const WriteOptions&);
  Room room = Room::all;
};

constexpr Writer<TriangleMesh> mesh_writers[] = {
    {"ply", io::mesh_to_ply},
    {"obj", io::mesh_to_obj, Room::colors},
    {"stl", io::mesh_to_stl, Room::positions},
    {"off", io::mesh_to_off, Room::colors},
    {"glb", io::mesh_to_glb, Room::colors_and_few_floats},
    {"vtp", io::mesh_to_vtp},
};
constexpr Writer<PointSet> point_writers[] = {
    {"ply", io::points_to_ply},
    {"obj", io::points_to_obj, Room::colors},
    {"xyz", io::points_to_xyz, Room::colors},
    {"csv", io::points_to_csv},
    {"pcd", io::points_to_pcd},
    {"vtp", io::points_to_vtp},
    {"las", io::points_to_las, Room::all_but_normals},
};

constexpr Writer<PolylineSet> line_writers[] = {
    {"vtp", io::lines_to_vtp},
    {"ply", io::lines_to_ply},
    {"csv", io::lines_to_csv},
};

/// What a format of that room leaves out.
std::vector<std::string> without_room(Room room, const io::OutputContent& content) {
  std::vector<std::string> names;
  if (room == Room::all) return names;
  if ((room == Room::positions || room == Room::all_but_normals) && !content.normals.empty())
    names.emplace_back("normals");
  if (room == Room::positions && !content.colors.empty()) names.emplace_back("colours");
  if (room == Room::all_but_normals) return names;
  for (const Attribute& a : content.attributes)
    if (room != Room::colors_and_few_floats || a.type() != NumberType::f32 || a.components > 4)
      names.push_back(printable(a.name, 80));
  for (const Attribute& a : content.triangle_attributes) names.push_back(printable(a.name, 80) + " of triangles");
  return names;
}

/// Throws ArgumentError's sibling for files: the ending is not one of those known.
[[noreturn]] void fail_ending(const std::string& file, const std::string& kind, const std::string& known) {
  const std::string e = io::ending(file);
  throw FileError(file, e.empty() ? fmt::format("has no ending that names a format for {}; known: {}", kind, known)
                                  : fmt::format("no writer for {} with the ending '.{}'; known: {}", kind, e, known));
}

template <class Data, std::size_t n>
const Writer<Data>& find_writer(const Writer<Data> (&writers)[n], const std::string& file, const std::string& kind) {
  const std::string e = io::ending(file);
  std::string known;
  for (const Writer<Data>& w : writers) {
    if (e == w.ending) return w;
    known += fmt::format("{}.{}", known.empty() ? "" : " ", w.ending);
  }
  fail_ending(file, kind, known);
}

/// Throws ArgumentError unless an optional per-vertex array is empty or complete.
void check_length(const char* what, std::size_t length, std::size_t n) {
  if (length != 0 && length != n) {
    throw ArgumentError(fmt::format("{} {} for {} points: there must be none or one for each", length, what, n));
  }
}

/// Throws FileError for coordinates beyond those that readers accept.
void check_reach(const std::string& file, std::span<const Vec3f> positions, const Vec3& origin) {
  const double far = parallel_reduce(
      positions.size(), 1 << 16, 0.0,
      [&](std::size_t first, std::size_t last) {
        double far = 0;
        for (std::size_t i = first; i < last; ++i)
          for (std::size_t k = 0; k < 3; ++k)
            if (const double x = std::abs(origin[k] + static_cast<double>(positions[i][k])); std::isfinite(x))
              far = std::max(far, x);
        return far;
      },
      [](double a, double b) { return std::max(a, b); });
  if (far > kLargestCoordinate)
    throw FileError(file, fmt::format("would reach out to {:.3g}, and coordinates up to {:g} are supported", far,
                                      kLargestCoordinate));
}

template <class Triangles>
void check_triangles(const Triangles& triangles, std::size_t n) {
  for (const auto& t : triangles) {
    for (const std::uint32_t v : t) {
      if (v >= n) throw ArgumentError(fmt::format("a triangle refers to vertex {} of {}", v, n));
    }
  }
}

}  // namespace

void write_mesh(const std::string& file, const TriangleMesh& mesh, const WriteOptions& options) {
  const auto& writer = find_writer(mesh_writers, file, "meshes");
  check_length("normals", mesh.normals.size(), mesh.vertices.size());
  check_length("colors", mesh.colors.size(), mesh.vertices.size());
  mesh.attributes.check_rows(mesh.vertices.size(), "vertices");
  mesh.triangle_attributes.check_rows(mesh.triangles.size(), "triangles");
  check_triangles(mesh.triangles, mesh.vertices.size());
  check_reach(file, mesh.vertices, mesh.origin);
  io::write_whole(file, writer.write(mesh, options));
}

void write_points(const std::string& file, const PointSet& points, const WriteOptions& options) {
  const auto& writer = find_writer(point_writers, file, "points");
  check_length("normals", points.normals.size(), points.size());
  check_length("colors", points.colors.size(), points.size());
  points.attributes.check_rows(points.size(), "points");
  check_triangles(points.triangles, points.size());
  check_reach(file, points.positions, points.origin);
  io::write_whole(file, writer.write(points, options));
}

bool is_written(const std::string& file, const std::string& kind) {
  const std::string e = io::ending(file);
  const auto known = [&](const auto& writers) {
    return std::any_of(std::begin(writers), std::end(writers), [&](const auto& w) { return e == w.ending; });
  };
  return (kind == "mesh" && known(mesh_writers)) || (kind == "points" && known(point_writers)) ||
         (kind == "lines" && known(line_writers));
}

std::vector<std::string> left_out(const std::string& file, const TriangleMesh& mesh) {
  return without_room(find_writer(mesh_writers, file, "meshes").room, io::OutputContent(mesh));
}

std::vector<std::string> left_out(const std::string& file, const PointSet& points) {
  return without_room(find_writer(point_writers, file, "points").room, io::OutputContent(points));
}

void write_lines(const std::string& file, const PolylineSet& lines, const WriteOptions& options) {
  const auto& writer = find_writer(line_writers, file, "lines");
  if (lines.offsets.empty() || lines.offsets.front() != 0 || lines.offsets.back() != lines.positions.size() ||
      !std::is_sorted(lines.offsets.begin(), lines.offsets.end()))
    throw ArgumentError("lines must begin where those before them end");
  lines.attributes.check_rows(lines.positions.size(), "points");
  lines.line_attributes.check_rows(lines.size(), "lines");
  io::write_whole(file, writer.write(lines, options));
}

void write_text(const std::string& file, const std::string& text) { io::write_whole(file, {text}); }

void check_writable(const std::string& file, const std::string& kind) {
  if (file.empty()) throw FileError("(no name)", "the name of the file to write is empty");
  if (kind == "mesh") {
    find_writer(mesh_writers, file, "meshes");
  } else if (kind == "points") {
    find_writer(point_writers, file, "points");
  } else if (kind == "lines") {
    find_writer(line_writers, file, "lines");
  } else if (kind == "image") {
    if (io::ending(file) != "png") fail_ending(file, "images", ".png");
  } else if (kind != "text") {
    throw ArgumentError(fmt::format("check_writable: unknown kind '{}'; known: mesh points lines image text", kind));
  }
  io::find_output_place(file);
}

}  // namespace sansmesh
