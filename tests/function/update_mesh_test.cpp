// Meshes of edited functions: brought up to date in place, cut to boxes, coarser.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "function/edit_shapes.h"
#include "io/io_test_tools.h"
#include "polygonize/mesh_shapes.h"
#include "sansmesh/core/error.h"
#include "sansmesh/mesh_function.h"
#include "sansmesh/polygonize/clip_mesh.h"
#include "sansmesh/polygonize/mesh_distance.h"
#include "sansmesh/polygonize/mesh_topology.h"
#include "sansmesh/polygonize/replace_region.h"

namespace sansmesh {
namespace {

using namespace test;
using Action = decltype(Edit::action);

TriangleMesh meshed(const SurfaceFunction& function, const MeshOptions& options = {}) {
  Progress progress;
  return mesh_function(function, options, progress);
}

using Corners = std::array<std::array<float, 3>, 3>;

/// A triangle by its corners' positions, whatever their numbers and whichever comes first.
Corners corners(const TriangleMesh& mesh, const Triangle& t) {
  Corners c;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices[t[k]];
    c[k] = {v.x, v.y, v.z};
  }
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}
std::set<Corners> triangle_set(const TriangleMesh& mesh) {
  std::set<Corners> set;
  for (const Triangle& t : mesh.triangles) set.insert(corners(mesh, t));
  return set;
}

bool near_box(const TriangleMesh& mesh, const Triangle& t, const Box3& box) {
  Box3 b;
  for (const std::uint32_t v : t) b.extend(mesh.origin + Vec3(mesh.vertices[v]));
  for (std::size_t k = 0; k < 3; ++k)
    if (b.upper[k] < box.lower[k] || b.lower[k] > box.upper[k]) return false;
  return true;
}

Box3 widened(const Box3& box, double by) { return {box.lower - Vec3{by, by, by}, box.upper + Vec3{by, by, by}}; }

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += norm(Vec3(mesh.vertices[t[0]] - mesh.vertices[t[1]]));
  return sum / static_cast<double>(mesh.triangles.size());
}

void expect_closed(const TriangleMesh& mesh) {
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.degenerate_triangles, 0u);
  EXPECT_EQ(topology.unused_vertices, 0u);
}

/// Updated and remade meshes are one surface up to what another choice of triangles makes of it.
void expect_same_surface(const TriangleMesh& updated, const TriangleMesh& remade, double tolerance) {
  Progress progress;
  DistanceOptions options;
  options.samples = 5000;
  const SurfaceDistance d = measure_distance(updated, remade, options, progress);
  EXPECT_LT(d.to_reference.mean, 0.02 * tolerance);
  EXPECT_LT(d.from_reference.mean, 0.02 * tolerance);
  EXPECT_LT(d.to_reference.max, 0.7 * tolerance);
  EXPECT_LT(d.from_reference.max, 0.7 * tolerance);
}

std::vector<Action> local_actions() {
  return {SetDegree{1}, SetDegree{3}, Refit{2, {}, {}, 2.0, false}, SetConstant{1}, SetConstant{-1}, RemoveSupports{}};
}

TEST(UpdateMesh, IsTheMeshOfTheEditedFunction) {
  struct Shape {
    const char* name;
    PointSet cloud;
    Vec3 at;
    double radius;
  };
  PointSet far = bumpy(6000);
  far.origin = {431234.5, 5812345.25, 812};
  for (Vec3f& p : far.positions) p *= 250.0f;
  const Shape shapes[] = {{"bumpy", bumpy(6000), {0, 0, 1}, 0.06},
                          {"edge of a cube", cube(6000), {1, 1, 0.1}, 0.06},
                          {"corner of a cube", cube(6000), {1, 1, 1}, 0.06},
                          {"far", far, far.origin + Vec3{0, 0, 250}, 15}};
  MeshOptions plain;
  plain.enhance = false;
  MeshOptions coarse;
  coarse.mesh_error = 0.004;
  for (const Shape& shape : shapes) {
    const SurfaceFunction function = fitted(shape.cloud);
    for (const MeshOptions& options : {MeshOptions{}, plain, coarse}) {
      const bool smooth = std::string(shape.name).find("cube") == std::string::npos;
      if ((options.mesh_error || !options.enhance) && std::string(shape.name) == "far") continue;
      const TriangleMesh before = meshed(function, options);
      const double edge = mean_edge(before);
      std::size_t local = 0;
      for (const Action& action : local_actions()) {
        FunctionEditor editor(
            {PartitionOfUnity(function.field.data()), function.origin, function.unit, function.samples, {}, {}});
        Progress progress;
        const EditReport report = editor.apply(edit_in_ball(shape.at, shape.radius, action), progress);
        SCOPED_TRACE(std::string(shape.name) + ": " + report.what + (options.mesh_error ? ", coarse" : "") +
                     (options.enhance ? "" : ", plain"));
        MeshUpdate update;
        const TriangleMesh after = update_mesh(editor.function(), before, editor.changed(), options, progress, &update);
        local += update.local;
        expect_closed(after);
        expect_same_surface(after, meshed(editor.function(), options), options.mesh_error ? 4 * edge : 2 * edge);
        if (!update.local) continue;
        EXPECT_EQ(after.triangles.size() + update.removed, before.triangles.size() + update.added);
        EXPECT_LT(update.removed, before.triangles.size() / 2);
        EXPECT_EQ(after.normals.size(), after.vertices.size());
        const std::set<Corners> now = triangle_set(after);
        const Box3 around = widened(editor.changed(), 10 * edge);
        std::size_t off = 0, gone = 0;
        for (const Triangle& t : before.triangles)
          if (!near_box(before, t, around)) ++off, gone += !now.count(corners(before, t));
        EXPECT_GT(off, before.triangles.size() / 4);
        EXPECT_EQ(gone, 0u);
      }
      // Simplified triangles of flat faces reach from edge to edge: there all may be made anew.
      if (!options.mesh_error && (smooth || !options.enhance)) {
        EXPECT_GE(local, local_actions().size() - 1) << shape.name << (options.enhance ? "" : ", plain");
      }
    }
  }
}

TEST(UpdateMesh, OfNothingIsTheMesh) {
  const SurfaceFunction function = fitted(sphere(2000));
  const TriangleMesh before = meshed(function);
  Progress progress;
  MeshUpdate update;
  const TriangleMesh after = update_mesh(function, before, {}, {}, progress, &update);
  EXPECT_TRUE(update.local);
  EXPECT_EQ(after.triangles, before.triangles);
  EXPECT_EQ(update.added + update.removed, 0u);
}

TEST(UpdateMesh, ManyEditsOneMesh) {
  // Whatever is done, the mesh stays closed and manifold, made from that of the last step or anew.
  const SurfaceFunction function = fitted(bumpy(8000));
  FunctionEditor editor(
      {PartitionOfUnity(function.field.data()), function.origin, function.unit, function.samples, {}, {}});
  TriangleMesh mesh = meshed(function);
  std::mt19937 random(4);
  std::size_t local = 0, rounds = 30;
  for (std::size_t round = 0; round < rounds; ++round) {
    const auto& samples = function.samples->positions;
    const Vec3 at = function.to_input(function.field.data().origin + Vec3(samples[random() % samples.size()]));
    const std::vector<Action> all = local_actions();
    const double radius = 0.03 + 0.02 * static_cast<double>(random() % 4);
    Action action = all[random() % all.size()];
    if (round % 7 == 6) action = Undo{1};
    Progress progress;
    Edit edit = std::holds_alternative<Undo>(action) ? Edit{{}, action} : edit_in_ball(at, radius, action);
    const EditReport report = editor.apply(edit, progress);
    SCOPED_TRACE(std::to_string(round) + ": " + report.what);
    MeshUpdate update;
    // An undo changes what its edit changed.
    mesh = update_mesh(editor.function(), std::move(mesh), report.changed, {}, progress, &update);
    local += update.local;
    expect_closed(mesh);
  }
  EXPECT_GT(local, rounds / 2);
  expect_same_surface(mesh, meshed(editor.function()), 3 * mean_edge(mesh));
}

TEST(UpdateMesh, OfAnotherFunctionIsMadeAnew) {
  FunctionEditor editor(fitted(bumpy(6000)));
  Progress progress;
  editor.apply(edit_in_ball({0, 0, 1}, 0.1, SetDegree{1}), progress);
  const TriangleMesh whole = meshed(editor.function());
  MeshOptions other;
  other.enhance = false;
  TriangleMesh shifted = whole;
  for (Vec3f& v : shifted.vertices) v += Vec3f{0.01f, 0.02f, 0.005f};
  for (const TriangleMesh& wrong :
       {octasphere(4), meshed(fitted(sphere(5000))), meshed(editor.function(), other), shifted, TriangleMesh{}}) {
    MeshUpdate update;
    const TriangleMesh after = update_mesh(editor.function(), wrong, editor.changed(), {}, progress, &update);
    EXPECT_FALSE(update.local);
    EXPECT_EQ(after.triangles, whole.triangles);
    EXPECT_EQ(triangle_set(after), triangle_set(whole));
  }
}

TEST(UpdateMesh, FarAwayMeshesAreNotTakenForTheFunctions) {
  // Nothing is left where the change was, so that no triangle can be compared.
  PointSet cloud = sphere(4000);
  for (const PointSet& small : {sphere(500)})
    for (std::size_t i = 0; i < small.size(); ++i) {
      cloud.positions.push_back(small.positions[i] * 0.3f + Vec3f{2, 0, 0});
      cloud.normals.push_back(small.normals[i]);
    }
  FunctionEditor editor(fitted(cloud));
  Progress progress;
  EditSelection small;
  small.sheet_at = Vec3{2.3, 0, 0};
  editor.apply({small, RemoveSupports{}}, progress);
  TriangleMesh wrong = octasphere(4);
  for (Vec3f& v : wrong.vertices) v += Vec3f{50, 0, 0};
  MeshUpdate update;
  const TriangleMesh after = update_mesh(editor.function(), wrong, editor.changed(), {}, progress, &update);
  EXPECT_FALSE(update.local);
  EXPECT_EQ(triangle_set(after), triangle_set(meshed(editor.function())));
}

TEST(UpdateMesh, MeshesFromFiles) {
  PointSet cloud = bumpy(8000);
  cloud.origin = {3000, -200, 5};
  const SurfaceFunction function = fitted(cloud);
  const TriangleMesh mesh = meshed(function);
  Folder folder;
  for (const char* name : {"mesh.ply", "mesh.stl", "mesh.obj", "mesh.off"}) {
    SCOPED_TRACE(name);
    const std::string file = folder / name;
    write_mesh(file, mesh);
    FunctionEditor editor(
        {PartitionOfUnity(function.field.data()), function.origin, function.unit, function.samples, {}, {}});
    Progress progress;
    editor.apply(edit_in_ball(cloud.origin + Vec3{0, 0, 1}, 0.08, SetConstant{1}), progress);
    MeshUpdate update;
    const TriangleMesh after = update_mesh(editor.function(), read_mesh(file), editor.changed(), {}, progress, &update);
    expect_closed(after);
    expect_same_surface(after, meshed(editor.function()), 2 * mean_edge(mesh));
    // Binary files keep every bit that matters.
    if (std::string(name) == "mesh.ply") {
      EXPECT_TRUE(update.local);
    }
  }
}

TEST(UpdateMesh, WholeComponentsComeAndGo) {
  const SurfaceFunction function = fitted(two_spheres());
  const TriangleMesh both = meshed(function);
  ASSERT_EQ(measure_topology(both).components, 2u);
  for (const bool large : {false, true}) {
    FunctionEditor editor(
        {PartitionOfUnity(function.field.data()), function.origin, function.unit, function.samples, {}, {}});
    Progress progress;
    Edit edit;
    edit.select.sheet_at = large ? Vec3{-1, 0, 0} : Vec3{2.5, 0, 0};
    edit.action = RemoveSupports{};
    editor.apply(edit, progress);
    MeshUpdate update;
    const TriangleMesh one = update_mesh(editor.function(), both, editor.changed(), {}, progress, &update);
    expect_closed(one);
    EXPECT_EQ(measure_topology(one).components, 1u);
    if (!large) {
      EXPECT_TRUE(update.local);
    }
    editor.apply({{}, Undo{}}, progress);
    const TriangleMesh again = update_mesh(editor.function(), one, {{-2, -2, -2}, {3, 2, 2}}, {}, progress, &update);
    expect_closed(again);
    EXPECT_EQ(measure_topology(again).components, 2u);
  }
  FunctionEditor editor(fitted(sphere(2000)));
  Progress progress;
  editor.apply({{}, SetConstant{1}}, progress);
  EXPECT_THROW(meshed(editor.function()), DataError);
  EXPECT_THROW(update_mesh(editor.function(), meshed(fitted(sphere(2000))), editor.changed(), {}, progress), DataError);
}

TEST(UpdateMesh, ColorsComeAlong) {
  PointSet cloud = sphere(8000);
  for (const Vec3f& p : cloud.positions)
    cloud.colors.push_back({static_cast<std::uint8_t>(p.z > 0.9f ? 200 : 10), 50, 60});
  FunctionEditor editor(fitted(cloud));
  const TriangleMesh before = meshed(editor.function());
  Progress progress;
  editor.apply(edit_in_ball({0, 0, 1}, 0.1, SetDegree{1}), progress);
  MeshUpdate update;
  const TriangleMesh after = update_mesh(editor.function(), before, editor.changed(), {}, progress, &update);
  ASSERT_TRUE(update.local);
  ASSERT_EQ(after.colors.size(), after.vertices.size());
  for (std::size_t v = 0; v < after.vertices.size(); ++v)
    if (std::abs(after.vertices[v].z - 0.9f) > 0.1f) {
      EXPECT_EQ(after.colors[v][0], after.vertices[v].z > 0.9f ? 200 : 10);
    }
}

// Boxes

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += 0.5 * norm(cross(Vec3(mesh.vertices[t[1]] - mesh.vertices[t[0]]),
                             Vec3(mesh.vertices[t[2]] - mesh.vertices[t[0]])));
  return area;
}

TriangleMesh cube_mesh() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

void expect_clipped(const TriangleMesh& mesh, const Box3f& box) {
  for (const Vec3f& v : mesh.vertices) EXPECT_TRUE(box.contains(v));
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.unused_vertices, 0u);
  // Borders lie in the faces, edge by edge.
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
  std::size_t border = 0;
  for (const auto& [a, b] : edges) {
    if (edges.count({b, a})) continue;
    ++border;
    bool same_face = false;
    for (std::size_t k = 0; k < 3; ++k)
      for (const float f : {box.lower[k], box.upper[k]})
        same_face |= mesh.vertices[a][k] == f && mesh.vertices[b][k] == f;
    EXPECT_TRUE(same_face);
  }
  EXPECT_EQ(border, topology.boundary_edges);
}

TEST(ClipMesh, CubesToTheirArea) {
  struct Case {
    Box3f box;
    double area;
    std::size_t loops;
  };
  const Case cases[] = {
      {{{-2, -2, -2}, {2, 2, 2}}, 24, 0},
      {{{-2, -2, -2}, {0.25f, 2, 2}}, 4 + 4 * 2 * 1.25, 1},
      {{{-0.5f, -2, -2}, {0.25f, 2, 2}}, 4 * 2 * 0.75, 2},
      {{{-0.5f, -0.5f, -2}, {0.25f, 0.75f, 2}}, 2 * 0.75 * 1.25, 2},
      {{{0, 0, 0}, {3, 3, 3}}, 3, 1},
      {{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}}, 0, 0},
      {{{5, 5, 5}, {6, 6, 6}}, 0, 0},
      {{{-1, -1, -1}, {1, 1, 1}}, 24, 0},
  };
  for (const Case& c : cases) {
    TriangleMesh mesh = cube_mesh();
    clip_mesh(mesh, c.box);
    EXPECT_NEAR(area_of(mesh), c.area, 1e-5);
    EXPECT_EQ(measure_topology(mesh).boundary_loops, c.loops);
    EXPECT_EQ(mesh.triangles.empty(), c.area == 0);
    expect_clipped(mesh, c.box);
  }
}

TEST(ClipMesh, LeavesWhatIsInside) {
  const TriangleMesh sphere = octasphere(4);
  TriangleMesh mesh = sphere;
  clip_mesh(mesh, {{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(mesh.triangles, sphere.triangles);
  EXPECT_EQ(mesh.vertices, sphere.vertices);
  const Box3f box{{-0.3f, -2, 0.1f}, {0.7f, 0.55f, 0.95f}};
  clip_mesh(mesh, box);
  expect_clipped(mesh, box);
  const std::set<Corners> now = triangle_set(mesh);
  std::size_t in = 0;
  for (const Triangle& t : sphere.triangles) {
    if (!std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return box.contains(sphere.vertices[v]); })) continue;
    ++in;
    EXPECT_TRUE(now.count(corners(sphere, t)));
  }
  EXPECT_GT(in, 200u);
}

TEST(ClipMesh, ZonesOfASphere) {
  // Archimedes: the area between parallel planes is 2π times their distance.
  for (const float z : {-0.5f, 0.0f, 0.3f, 0.9f}) {
    TriangleMesh mesh = octasphere(6);
    clip_mesh(mesh, {{-2, -2, z}, {2, 2, 2}});
    EXPECT_NEAR(area_of(mesh), 2 * std::numbers::pi * (1 - static_cast<double>(z)), 3e-3);
    EXPECT_EQ(measure_topology(mesh).boundary_loops, 1u);
  }
}

TEST(ClipMesh, AttributesAreInterpolated) {
  TriangleMesh mesh = octasphere(3);
  mesh.normals = mesh.vertices;
  for (const Vec3f& v : mesh.vertices) {
    mesh.quality.push_back(3 * v.x - v.z);
    mesh.colors.push_back({static_cast<std::uint8_t>(128 + 100 * v.x), 7, static_cast<std::uint8_t>(128 + 100 * v.z)});
  }
  clip_mesh(mesh, {{-0.4f, -0.2f, -2}, {0.35f, 2, 0.6f}});
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.quality.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_NEAR(mesh.quality[v], 3 * mesh.vertices[v].x - mesh.vertices[v].z, 1e-5);
    EXPECT_NEAR(mesh.colors[v][0], 128 + 100 * mesh.vertices[v].x, 3);
    EXPECT_EQ(mesh.colors[v][1], 7);
    EXPECT_NEAR(norm(mesh.normals[v]), 1, 1e-5);
    EXPECT_GT(dot(mesh.normals[v], normalized(mesh.vertices[v])), 0.999f);
  }
}

TEST(MeshFunction, InABoxIsAPartOfTheWhole) {
  for (const PointSet& cloud : {bumpy(8000), cube(8000)}) {
    const SurfaceFunction function = fitted(cloud);
    MeshOptions options;
    options.enhance = function.field.report().creased == 0;  // no large triangles on the faces of the cube
    const TriangleMesh whole = meshed(function, options);
    options.box = Box3{{-0.3, 0.1, 0.2}, {0.55, 0.8, 3}};
    const TriangleMesh part = meshed(function, options);
    ASSERT_FALSE(part.triangles.empty());
    const double edge = mean_edge(whole);
    TriangleMesh clipped = whole;
    clip_mesh(clipped, {Vec3f(options.box->lower - clipped.origin), Vec3f(options.box->upper - clipped.origin)});
    EXPECT_NEAR(area_of(part), area_of(clipped), 2e-3 * area_of(clipped));
    for (const Vec3f& v : part.vertices) EXPECT_TRUE(widened(*options.box, 1e-5).contains(part.origin + Vec3(v)));
    const MeshTopology topology = measure_topology(part);
    EXPECT_TRUE(topology.manifold() && topology.oriented());
    EXPECT_EQ(topology.components, 1u);
    EXPECT_EQ(topology.boundary_loops, 1u);
    // The same triangles well inside.
    const std::set<Corners> of_whole = triangle_set(whole);
    const Box3 inner = widened(*options.box, -3 * edge);
    std::size_t in = 0, same = 0;
    for (const Triangle& t : part.triangles) {
      bool inside = true;
      for (const std::uint32_t v : t) inside &= inner.contains(part.origin + Vec3(part.vertices[v]));
      in += inside, same += inside && of_whole.count(corners(part, t));
    }
    EXPECT_GT(in, 20u);
    EXPECT_GT(static_cast<double>(same), 0.9 * static_cast<double>(in));
  }
}

TEST(MeshFunction, BoxesOfAnySizeAndPlace) {
  const SurfaceFunction function = fitted(sphere(3000));
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 40; ++round) {
    // On the surface, down to a small share of a triangle.
    const Vec3 at = normalized(Vec3{uniform(random), uniform(random), uniform(random)});
    const double half = std::pow(10.0, -2.5 + 0.05 * round);
    MeshOptions options;
    options.box = widened({at, at}, half);
    const TriangleMesh mesh = meshed(function, options);
    const double area = area_of(mesh);
    EXPECT_GT(area, 1.5 * half * half) << half;
    EXPECT_LT(area, 15 * half * half) << half;
  }
  for (const Box3& nowhere : {Box3{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}}, Box3{{5, 5, 5}, {6, 6, 6}},
                              Box3{{1.02, 0, 0}, {1.03, 0.01, 0.01}}}) {
    MeshOptions options;
    options.box = nowhere;
    try {
      meshed(function, options);
      ADD_FAILURE();
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("box"), std::string::npos) << error.what();
    }
  }
}

TEST(MeshFunction, DepthMakesItCoarser) {
  for (const PointSet& cloud : {bumpy(12000), cube(12000)}) {
    const SurfaceFunction function = fitted(cloud);
    const auto size = static_cast<double>(meshed(function).triangles.size());
    double last = 1e30;
    for (const int depth : {12, 6, 5, 4, 3, 2}) {
      MeshOptions options;
      options.block_depth = depth;
      const TriangleMesh mesh = meshed(function, options);
      expect_closed(mesh);
      const auto n = static_cast<double>(mesh.triangles.size());
      if (depth == 12) {
        EXPECT_EQ(n, size);
      }
      EXPECT_LE(n, last) << depth;
      last = n;
      Box3f box, samples;
      for (const Vec3f& v : mesh.vertices) box.extend(v);
      for (const Vec3f& p : cloud.positions) samples.extend(p);
      EXPECT_LT(norm(box.lower - samples.lower), 0.35f) << depth;
      EXPECT_LT(norm(box.upper - samples.upper), 0.35f) << depth;
    }
    EXPECT_LT(last, 0.3 * size);
  }
}

// replace_region

/// A flat lattice of n × n squares of edge 1; heights at its vertices.
template <class Height>
TriangleMesh lattice(std::uint32_t n, Height&& height, std::uint32_t from = 0) {
  TriangleMesh mesh;
  const std::uint32_t m = n + 1;
  for (std::uint32_t y = 0; y < m; ++y)
    for (std::uint32_t x = 0; x < m; ++x) {
      const auto fx = static_cast<float>(x + from), fy = static_cast<float>(y + from);
      mesh.vertices.push_back({fx, fy, height(fx, fy)});
    }
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * m + x;
      mesh.triangles.push_back({a, a + 1, a + m});
      mesh.triangles.push_back({a + 1, a + m + 1, a + m});
    }
  return mesh;
}

float flat(float, float) { return 0; }
float hill(float x, float y) { return std::max(0.0f, 3.0f - norm(Vec3f{x - 10, y - 10, 0})); }
const Box3f kHill{{6.5f, 6.5f, -1}, {13.5f, 13.5f, 4}};

TEST(ReplaceRegion, TakesThePatchWhereTheyDiffer) {
  TriangleMesh mesh = lattice(20, flat);
  const TriangleMesh patch = lattice(14, hill, 3);
  const RegionReplacement r = replace_region(mesh, patch, {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.agreement, 1);
  EXPECT_EQ(r.removed, r.added);
  EXPECT_GT(r.added, 20u);
  EXPECT_EQ(triangle_set(mesh), triangle_set(lattice(20, hill)));
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold() && topology.oriented());
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_EQ(topology.vertices, 21u * 21u);
  EXPECT_EQ(topology.unused_vertices, 0u);
}

TEST(ReplaceRegion, TakesNothingWhereTheyAgree) {
  TriangleMesh mesh = lattice(20, hill);
  const TriangleMesh before = mesh;
  const RegionReplacement r = replace_region(mesh, lattice(14, hill, 3), {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.removed + r.added, 0u);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(ReplaceRegion, LeavesDifferencesAwayFromTheChange) {
  // The patch differs at the hill, and at a bump elsewhere: that one is an accident of how it was made.
  const auto bump = [](float x, float y) { return hill(x, y) + (x == 5 && y == 5 ? 0.5f : 0.0f); };
  TriangleMesh mesh = lattice(20, flat);
  const RegionReplacement r = replace_region(mesh, lattice(14, bump, 3), {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_LT(r.agreement, 1);
  EXPECT_EQ(triangle_set(mesh), triangle_set(lattice(20, hill)));
}

TEST(ReplaceRegion, FailsWhereAPieceReachesOut) {
  const TriangleMesh before = lattice(20, flat);
  const auto ridge = [](float x, float) { return x == 10 ? 1.0f : 0.0f; };
  TriangleMesh mesh = before;
  RegionReplacement r = replace_region(mesh, lattice(14, ridge, 3), {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f);
  EXPECT_FALSE(r.done);
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.vertices, before.vertices);
  // A patch of something else.
  r = replace_region(mesh,
                     lattice(
                         14, [](float, float) { return 0.3f; }, 3),
                     {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f);
  EXPECT_EQ(r.agreement, 0);
  EXPECT_FALSE(r.done);
  r = replace_region(mesh, {}, {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f);
  EXPECT_FALSE(r.done);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(ReplaceRegion, WholeComponents) {
  // Two spheres, one of which goes; then comes back.
  const TriangleMesh small = octasphere(2), both = joined(octasphere(3), small, {3, 0, 0});
  const Box3f around{{1.9f, -1.1f, -1.1f}, {4.1f, 1.1f, 1.1f}}, sound{{1.5f, -2, -2}, {5, 2, 2}};
  TriangleMesh mesh = both;
  RegionReplacement r = replace_region(mesh, {}, sound, around, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.removed, small.triangles.size());
  EXPECT_EQ(triangle_set(mesh), triangle_set(octasphere(3)));
  r = replace_region(mesh, joined({}, small, {3, 0, 0}), sound, around, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.added, small.triangles.size());
  EXPECT_EQ(triangle_set(mesh), triangle_set(both));
  EXPECT_TRUE(measure_topology(mesh).closed());
}

TEST(ReplaceRegion, ToleratesRoundingButNotCoincidence) {
  // Vertices a little off are the same, and each is the same as one only.
  TriangleMesh mesh = lattice(20, flat);
  TriangleMesh patch = lattice(14, hill, 3);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-4e-4f, 4e-4f);
  for (Vec3f& v : patch.vertices) v += Vec3f{uniform(random), uniform(random), uniform(random)};
  EXPECT_TRUE(replace_region(mesh, patch, {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f).done);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold() && topology.oriented());
  EXPECT_EQ(topology.boundary_loops, 1u);

  // Triangles smaller than the tolerance: no two of their vertices become one.
  TriangleMesh fine = lattice(20, flat);
  const RegionReplacement r = replace_region(fine, patch, {{4, 4, -9}, {16, 16, 9}}, kHill, 1.5f);
  const MeshTopology now = measure_topology(fine);
  EXPECT_TRUE(!r.done || (now.manifold() && now.oriented() && now.degenerate_triangles == 0));
}

TEST(ReplaceRegion, AttributesComeAlong) {
  TriangleMesh mesh = lattice(20, flat), patch = lattice(14, hill, 3);
  mesh.normals.assign(mesh.vertices.size(), {0, 0, 1});
  mesh.quality.assign(mesh.vertices.size(), 1);
  mesh.colors.assign(mesh.vertices.size(), {1, 2, 3});
  patch.normals.assign(patch.vertices.size(), {1, 0, 0});
  patch.colors.assign(patch.vertices.size(), {9, 8, 7});  // and no quality
  ASSERT_TRUE(replace_region(mesh, patch, {{4, 4, -9}, {16, 16, 9}}, kHill, 1e-3f).done);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.quality.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const bool is_new = mesh.vertices[v].z > 0;
    EXPECT_EQ(mesh.normals[v], is_new ? (Vec3f{1, 0, 0}) : (Vec3f{0, 0, 1}));
    EXPECT_EQ(mesh.colors[v][0], is_new ? 9 : 1);
    EXPECT_EQ(mesh.quality[v], is_new ? 0 : 1);
  }
}

}  // namespace
}  // namespace sansmesh
