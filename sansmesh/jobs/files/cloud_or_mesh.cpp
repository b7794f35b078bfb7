#include "sansmesh/jobs/files/cloud_or_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/mesh/repair/weld.h"
#include "sansmesh/points/cleaning/close_points.h"
#include "sansmesh/points/cleaning/duplicates.h"
#include "sansmesh/points/ground/classify_ground.h"
#include "sansmesh/points/sampling/poisson_discs.h"
#include "sansmesh/points/sampling/subsample.h"

namespace sansmesh::inline v1 {
namespace {

/// Keeps only these samples of a cloud.
void take(CloudOrMesh& data, const std::vector<std::uint32_t>& rows) {
  if (rows.size() < data.points.size()) data.points = take_samples(data.points, rows);
}

void need_points(const CloudOrMesh& data, const char* instead) {
  if (data.is_mesh) throw DataError(fmt::format("is for points, and the input is a mesh; {}", instead));
}

std::string left_of(std::size_t before, const CloudOrMesh& data) {
  return fmt::format("{} of {} {}", grouped(data.size()), grouped(before), data.is_mesh ? "vertices" : "points");
}

}  // namespace

PointSet vertices_of(TriangleMesh mesh) {
  PointSet points;
  points.origin = mesh.origin;
  points.reference = mesh.reference;
  points.positions = std::move(mesh.vertices);
  points.normals = std::move(mesh.normals);
  points.colors = std::move(mesh.colors);
  points.attributes = std::move(mesh.attributes);
  return points;
}

CloudOrMesh::CloudOrMesh(PointSet read) : is_mesh(!read.triangles.empty()) {
  const bool several = std::any_of(read.scan_of_point.begin(), read.scan_of_point.end(),
                                   [&](std::uint16_t scan) { return scan != read.scan_of_point.front(); });
  if (several) {
    std::string name = "source";
    for (int k = 2; read.attributes.find(name) || read.triangle_attributes.find(name); ++k)
      name = fmt::format("source_{}", k);
    if (is_mesh) {
      std::vector<std::uint16_t> of_triangle;
      of_triangle.reserve(read.triangles.size());
      for (const auto& t : read.triangles) of_triangle.push_back(read.scan_of_point[t[0]]);
      read.triangle_attributes.set(name, std::move(of_triangle));
    }
    read.attributes.set(name, std::move(read.scan_of_point));
  }
  if (is_mesh)
    mesh = to_mesh(std::move(read));
  else
    points = std::move(read);
}

std::string CloudOrMesh::size_words() const {
  if (!is_mesh) return counted(points.size(), "point");
  return counted(mesh.vertices.size(), "vertex") + ", " + counted(mesh.triangles.size(), "triangle");
}

Box3 CloudOrMesh::bounds() const {
  const Box3f own = is_mesh ? sansmesh::bounds(mesh) : sansmesh::bounds(points);
  return own.empty() ? Box3{} : Box3{origin() + Vec3(own.lower), origin() + Vec3(own.upper)};
}

std::string CloudOrMesh::attribute_words(const std::vector<std::string>& lost) const {
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> names;
  if (!(is_mesh ? mesh.normals : points.normals).empty()) names.emplace_back("normals");
  if (!(is_mesh ? mesh.colors : points.colors).empty()) names.emplace_back("colours");
  for (const Attribute& a : attributes()) names.push_back(printable(a.name, 80));
  for (const Attribute& a : mesh.triangle_attributes) names.push_back(printable(a.name, 80) + " of triangles");
  std::erase_if(names, [&](const std::string& n) { return std::find(lost.begin(), lost.end(), n) != lost.end(); });
  if (names.empty()) return "";
  const std::size_t more = names.size() > kNamed + 1 ? names.size() - kNamed : 0;
  names.resize(names.size() - more);
  return fmt::format(", with {}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

void CloudOrMesh::make_points() {
  if (!is_mesh) return;
  points = vertices_of(std::exchange(mesh, {}));
  is_mesh = false;
}

std::string move_all(CloudOrMesh& data, const AffineMap& map) {
  try {
    if (data.is_mesh)
      transform(data.mesh, map);
    else
      transform(data.points, map);
  } catch (const ArgumentError& error) {
    throw DataError(error.what());
  }
  auto& reference = data.is_mesh ? data.mesh.reference : data.points.reference;
  if (reference && map != AffineMap()) data.former_reference = std::move(reference), reference = nullptr;
  if (map.is_translation()) return "";
  const AttributeTable& of_triangles = data.mesh.triangle_attributes;
  for (const AttributeTable* const table : {&data.attributes(), &of_triangles})
    for (const Attribute& a : *table)
      if (a.components == 3 && is_real(a.type()) &&
          std::find(data.untransformed.begin(), data.untransformed.end(), a.name) == data.untransformed.end())
        data.untransformed.push_back(a.name);
  return "";
}

std::string crop_to_box(CloudOrMesh& data, const Box3& box, bool inside) {
  const std::size_t before = data.size();
  if (data.is_mesh) {
    const Box3f own{Vec3f(box.lower - data.mesh.origin), Vec3f(box.upper - data.mesh.origin)};
    if (inside)
      clip_mesh(data.mesh, own);
    else
      cut_out_box(data.mesh, own);
    return data.size_words();
  }
  std::vector<std::uint8_t> gone(before);
  for (std::size_t i = 0; i < before; ++i) {
    const Vec3 p = data.points.origin + Vec3(data.points.positions[i]);
    bool in = true;
    for (std::size_t k = 0; k < 3; ++k) in = in && p[k] >= box.lower[k] && p[k] <= box.upper[k];
    gone[i] = in != inside;
  }
  remove_samples(data.points, gone);
  return left_of(before, data);
}

std::string weld_points(CloudOrMesh& data, double distance) {
  const std::size_t before = data.size();
  if (data.is_mesh) {
    const WeldReport report = weld_vertices(data.mesh, distance);
    data.nonmanifold_edges_of_weld += report.nonmanifold_edges;
    return fmt::format("{} merged with others{}", counted(report.vertices, "vertex"),
                       report.triangles > 0
                           ? fmt::format(", {} without area dropped", counted(report.triangles, "triangle"))
                           : std::string());
  }
  if (distance == 0) {
    remove_samples(data.points, find_duplicates(data.points));
  } else {
    const std::vector<std::uint32_t> of = close_representatives(data.points.positions, distance);
    std::vector<std::uint8_t> gone(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) gone[i] = of[i] != i;
    remove_samples(data.points, gone);
  }
  return left_of(before, data);
}

std::string keep_apart(CloudOrMesh& data, double distance) {
  need_points(data, "`vertices_only` takes its vertices, a simplification makes fewer triangles");
  const std::size_t before = data.size();
  const std::vector<Vec3> positions(data.points.positions.begin(), data.points.positions.end());
  take(data, poisson_discs(positions, distance));
  return left_of(before, data);
}

std::string keep_count(CloudOrMesh& data, std::size_t count) {
  need_points(data, "`vertices_only` takes its vertices");
  const std::size_t before = data.size();
  take(data, scattered_choice(before, count));
  return left_of(before, data);
}

std::string keep_every(CloudOrMesh& data, std::size_t n) {
  need_points(data, "`vertices_only` takes its vertices");
  const std::size_t before = data.size();
  take(data, every_nth(before, n));
  return left_of(before, data);
}

std::string find_ground_of(CloudOrMesh& data, Progress& progress) {
  need_points(data, "`vertices_only` takes its vertices");
  return classify_ground(data.points, progress).words();
}

std::string flip_sides(CloudOrMesh& data, bool faces, bool normals) {
  std::vector<Vec3f>& directions = data.is_mesh ? data.mesh.normals : data.points.normals;
  if (!data.is_mesh && !normals) throw DataError("is for meshes, and the input has no faces");
  if (!data.is_mesh && directions.empty())
    throw DataError("finds no normals, and points have no faces; they can be estimated");
  if (data.is_mesh && !faces && directions.empty()) throw DataError("finds no normals");
  if (faces)
    for (Triangle& t : data.mesh.triangles) std::swap(t[1], t[2]);
  if (normals)
    for (Vec3f& n : directions) n = Vec3f{} - n;  // avoids -0
  return "";
}

std::string choose_attributes(CloudOrMesh& data, const std::vector<std::string>& names, bool keep) {
  AttributeTable& own = data.is_mesh ? data.mesh.attributes : data.points.attributes;
  AttributeTable none;
  AttributeTable& of_triangles = data.is_mesh ? data.mesh.triangle_attributes : none;
  auto& normals = data.is_mesh ? data.mesh.normals : data.points.normals;
  auto& colors = data.is_mesh ? data.mesh.colors : data.points.colors;
  std::vector<std::string> known;
  if (!normals.empty()) known.emplace_back("normals");
  if (!colors.empty()) known.emplace_back("colors");
  for (const AttributeTable* const table : {&own, &of_triangles})
    for (const Attribute& a : *table)
      if (std::find(known.begin(), known.end(), a.name) == known.end()) known.push_back(a.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw DataError(
          fmt::format("there is no '{}'; there {}{}", printable(name, 80), known.size() == 1 ? "is " : "are ",
                      known.empty() ? "no attributes" : printable(fmt::format("{}", fmt::join(known, ", ")))));
  const auto goes = [&](const std::string& name) {
    return (std::find(names.begin(), names.end(), name) != names.end()) != keep;
  };
  if (goes("normals")) normals.clear();
  if (goes("colors")) colors.clear();
  for (AttributeTable* const table : {&own, &of_triangles})
    for (const std::string& name : known)
      if (goes(name)) table->erase(name);
  return "";
}

}  // namespace sansmesh::inline v1
