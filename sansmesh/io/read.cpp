// Chooses the reader for a file: by its first bytes where they say what it is, else by its ending.
#include <fmt/core.h>

#include "sansmesh/io/input.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh {
namespace {

using io::Input;

struct Reader {
  const char* endings;  ///< separated and surrounded by spaces
  PointSet (*read)(const Input&);
};

constexpr Reader readers[] = {
    {" ply ", io::read_ply},
};
constexpr const char* known_endings = "ply";

PointSet read_any(const std::string& file, ReadReport& report) {
  const io::FileContent content(file);
  const Input in{file, content.bytes(), report};
  const std::string name = io::ending(file);
  for (const Reader& r : readers) {
    if (!name.empty() && std::string(r.endings).find(" " + name + " ") != std::string::npos) return r.read(in);
  }
  if (in.bytes.starts_with("ply\n") || in.bytes.starts_with("ply\r\n")) return io::read_ply(in);
  in.fail(fmt::format("unknown kind of file (ending '{}'); known: {}", name, known_endings));
}

}  // namespace

PointSet read_points(const std::string& file, ReadReport* report) {
  ReadReport own;
  ReadReport& r = report ? *report : own;
  r = {};
  return read_any(file, r);
}

TriangleMesh read_mesh(const std::string& file, ReadReport* report) {
  PointSet points = read_points(file, report);
  if (points.triangles.empty()) throw FileError(file, "holds points but no faces; a mesh is needed");
  TriangleMesh mesh;
  mesh.origin = points.origin;
  mesh.vertices = std::move(points.positions);
  mesh.triangles = std::move(points.triangles);
  mesh.normals = std::move(points.normals);
  mesh.colors = std::move(points.colors);
  mesh.quality = std::move(points.confidence);
  return mesh;
}

}  // namespace sansmesh
