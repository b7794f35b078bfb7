// sansmesh deform: clouds and meshes.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "deform.h"
#include "sansmesh/core/error.h"
#include "sansmesh/deform/handle_shapes.h"
#include "sansmesh/deform/open_mesh.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/deformed_mesh.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/render/mesh_picture.h"
#include "sansmesh/render/picture_surfaces.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kFoldPoints = 33;  // along the longest side
constexpr double kFlatBox = 1e-3;        // of the diagonal
constexpr std::array<std::uint8_t, 3> kFolded{222, 30, 30}, kUsual{222, 214, 204};

/// Vertices in red where the map turns space inside out.
void color_folded(TriangleMesh& mesh, const SpaceMap& map) {
  std::vector<Vec3> x;
  x.reserve(mesh.vertices.size());
  for (const Vec3f& p : mesh.vertices) x.push_back(mesh.origin + Vec3(p));
  std::vector<Jacobian> jacobians(x.size());
  map.map(x, {{}, jacobians, {}, {}});
  if (mesh.colors.empty()) mesh.colors.assign(x.size(), kUsual);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Jacobian& j = jacobians[i];
    if (dot(j[0], cross(j[1], j[2])) <= 0) mesh.colors[i] = kFolded;
  }
}

Box3 world_box(const Vec3& origin, const std::vector<Vec3f>& positions) {
  Box3 box;
  for (const Vec3f& p : positions)
    if (is_finite(p)) box.extend(origin + Vec3(p));
  return box;
}

std::string number_of(std::size_t n, bool vertices) {
  return vertices ? fmt::format("{} {}", grouped(n), n == 1 ? "vertex" : "vertices") : counted(n, "point");
}

}  // namespace

RenderOptions deform_look(const DeformArguments& a) {
  RenderOptions look = a.picture.chosen();
  set_background(look, a.background);
  return look;
}

void add_corners(const Box3& box, std::vector<Vec3>& places) {
  for (int c = 0; c < 8; ++c)
    places.push_back(
        {(c & 1 ? box.upper : box.lower).x, (c & 2 ? box.upper : box.lower).y, (c & 4 ? box.upper : box.lower).z});
}

TriangleMesh FoldWatch::look(const SpaceMap& map, const Box3& box, Progress& progress) {
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper)) return {};
  Box3 wide = box;
  const double least = std::max(kFlatBox * box.diagonal(), std::numeric_limits<double>::min());
  for (std::size_t k = 0; k < 3; ++k)  // of what is flat, too
    if (wide.upper[k] - wide.lower[k] < least) wide.lower[k] -= least, wide.upper[k] += least;
  FoldReport found = find_folds(map, wide, lattice_sizes(wide, kFoldPoints), progress);
  TriangleMesh shapes = fold_shapes(found);
  if (found.share > worst_.share) worst_ = std::move(found);
  return shapes;
}

void FoldWatch::report(const std::string& name, DeformResult& result, Console& console) const {
  result.output["folded"] = worst_.share;
  if (worst_.folds.empty()) return;
  const Fold& largest = worst_.folds[0];
  console.warn(
      name, {fmt::format("space is folded on {:.2g} % of what was looked at, in {}, the largest about ({:.4g}, "
                         "{:.4g}, {:.4g}): handles move across each other there; move them less, or in several "
                         "steps, or take a smaller --alpha",
                         100 * worst_.share, counted(worst_.folds.size(), "place"), largest.center.x, largest.center.y,
                         largest.center.z)});
  Json list = Json::array();
  for (const Fold& f : worst_.folds)
    list.push_back({{"center", std::vector<double>{f.center.x, f.center.y, f.center.z}}, {"share", f.share}});
  result.output["folds"] = list;
}

Image picture_beside(std::vector<PictureSurface> surfaces, const DeformArguments& a, const OpenDeformation& deformation,
                     double share, std::vector<Vec3> places, const TriangleMesh& folds, Progress& progress) {
  const RenderOptions look = deform_look(a);
  if (a.draw_handles && deformation.has_handles()) {
    Box3 box;
    for (const Vec3& p : places) box.extend(p);
    const TriangleMesh shapes = deformation.shapes(share, box.diagonal());
    add_corners(world_box(shapes.origin, shapes.vertices), places);
    surfaces.push_back(surface_in_picture(shapes, look));
  }
  if (a.draw_folds && !folds.triangles.empty()) surfaces.push_back(surface_in_picture(folds, look));
  return render_surfaces(surfaces, places, false, a.frames > 0, look, progress);
}

DeformResult deform_points(const DeformArguments& a, const OpenDeformation& deformation, Console& console) {
  const CloudInput input{a.input.files, {}, {}, {}};
  Progress& progress = console.progress();
  ReadReport read;
  const PointSet points = input.read(console, read);
  const bool mesh = !points.triangles.empty();
  if (!mesh && a.bend) throw ArgumentError("--refine is for meshes: the input has no faces");
  if (!a.to_picture()) check_writable(a.output, mesh ? "mesh" : "points");
  DeformResult result;
  result.input = input.json(read, points.size());
  MeshDeformOptions options;
  options.bend = a.bend;
  options.validate();

  std::vector<Vec3> places;  // that all poses lie within
  const Box3 before = world_box(points.origin, points.positions);
  if (a.to_picture() && a.frames > 0)
    for (const double share : {0.0, 0.5, 1.0})
      add_corners(deformation.box_of(deformation.at(share), before).value_or(before), places);
  TriangleMesh opened;  // along cuts; a cloud is as it is
  OpenMeshReport cut;
  if (mesh || a.to_picture()) opened = to_mesh(points);
  if (mesh && !deformation.cuts().empty()) {
    progress.begin("open");
    OpenMeshOptions open;
    open.close = !a.deformation.cuts.open && measure_topology(opened).closed();
    opened = open_along_cuts(std::move(opened), deformation.cuts(), open, &cut);
  }
  MeshDeformReport report;
  FoldWatch folds;
  std::size_t vertices = 0, triangles = 0;
  for (int k = 0; k < a.poses(); ++k) {
    const double share = a.share(k);
    const DeformationMaps maps = deformation.at(share);
    folds.look(*maps.forward, before, progress);
    progress.begin("deform");
    TriangleMesh moved;
    if (mesh || a.to_picture()) {
      TriangleMesh whole = opened;
      if (a.draw_folds) color_folded(whole, *maps.forward);
      moved = deform_mesh(std::move(whole), *maps.forward, options, &report);
      vertices = moved.vertices.size(), triangles = moved.triangles.size();
    }
    result.files.push_back(a.file(k));
    if (a.to_picture()) {
      std::vector<Vec3> framed = places;
      if (framed.empty())
        for (const Vec3f& v : moved.vertices)
          if (is_finite(v)) framed.push_back(moved.origin + Vec3(v));
      const Image image = picture_beside({surface_in_picture(moved, deform_look(a))}, a, deformation, share,
                                         std::move(framed), {}, progress);
      a.picture.write(result.files.back(), image, deform_look(a));
    } else if (mesh) {
      progress.begin("write");
      write_mesh(result.files.back(), moved, {a.ascii});
    } else {
      const PointSet cloud = deform_points(points, *maps.forward, &report);
      vertices = cloud.size();
      progress.begin("write");
      write_points(result.files.back(), cloud, {a.ascii});
    }
  }
  std::vector<std::string> warnings;
  if (!report.fine)
    warnings.emplace_back("there would be too many triangles to cut all edges that bend: --refine coarser");
  if (report.undefined > 0)
    warnings.push_back(
        fmt::format("{} stay where they are: the map is not defined there", number_of(report.undefined, mesh)));
  if (report.turned > 0)
    warnings.push_back(
        fmt::format("{} of {} lie where space is folded", grouped(report.turned), number_of(vertices, mesh)));
  if (cut.unopened > 0)
    warnings.push_back(fmt::format("{} stayed whole where a cut passes: it does so in too many places",
                                   counted(cut.unopened, "triangle")));
  if (cut.unclosed > 0)
    warnings.emplace_back("the mesh stays open along a cut: faces are made along half-planes and polygons only");
  console.warn(input.name(), warnings);
  result.lines.push_back(mesh ? fmt::format("{}, {}{}", counted(triangles, "triangle"), number_of(vertices, mesh),
                                            report.added > 0 ? fmt::format(" ({} added)", grouped(report.added)) : "")
                              : counted(vertices, "point"));
  if (mesh && !deformation.cuts().empty())
    result.lines.push_back(cut.edges == 0 ? "no cut reaches it"
                                          : fmt::format("opened along {}, {} on cut faces", counted(cut.edges, "edge"),
                                                        counted(cut.faces, "triangle")));
  result.output = {{"vertices", vertices},
                   {"triangles", triangles},
                   {"added", report.added},
                   {"turned", report.turned},
                   {"undefined", report.undefined}};
  if (!deformation.cuts().empty())
    result.output["cut"] = {
        {"edges", cut.edges}, {"faces", cut.faces}, {"unopened", cut.unopened}, {"unclosed", cut.unclosed}};
  folds.report(input.name(), result, console);
  return result;
}

}  // namespace sansmesh::cli
