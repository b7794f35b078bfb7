// Meshes of edited functions, updated in place.
#include <cmath>
#include <random>
#include <set>

#include "function/edit_shapes.h"
#include "function/mesh_sets.h"
#include "io/io_test_tools.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/error.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "support/mesh_shapes.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using Action = decltype(Edit::action);

/// Updated and remade meshes are one surface up to the choice of triangles.
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
  SANSMESH_NOT_SANITIZED("others update meshes, too");
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
    const FittedFunction function = fitted(shape.cloud);
    for (const MeshOptions& options : {MeshOptions{}, plain, coarse}) {
      const bool smooth = std::string(shape.name).find("cube") == std::string::npos;
      const bool varied = std::string(shape.name) == "bumpy" || std::string(shape.name) == "corner of a cube";
      if ((options.mesh_error || !options.enhance) && !varied) continue;
      const TriangleMesh before = meshed(function, options);
      const double edge = mean_edge(before);
      std::size_t local = 0;
      for (const Action& action : local_actions()) {
        FunctionEditor editor({PartitionOfUnity(function.field.data()), function.frame, function.samples, {}, {}});
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
        const Box3 around = widened(bounds_of(editor.changed()), 10 * edge);
        std::size_t off = 0, gone = 0;
        for (const Triangle& t : before.triangles)
          if (!near_box(before, t, around)) ++off, gone += !now.count(corners(before, t));
        if (!options.mesh_error) {
          EXPECT_GT(off, before.triangles.size() / 4);
        }
        EXPECT_EQ(gone, 0u);
      }
      // Simplified triangles of flat faces reach from edge to edge: there the whole mesh may be remeshed.
      if (!options.mesh_error && (smooth || !options.enhance)) {
        EXPECT_GE(local, local_actions().size() - 1) << shape.name << (options.enhance ? "" : ", plain");
      }
    }
  }
}

/// Directions evenly spread over the unit sphere, by the golden angle.
std::vector<Vec3> spread_directions(int count) {
  std::vector<Vec3> all;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), a = 2.399963 * i;
    all.push_back({r * std::cos(a), r * std::sin(a), z});
  }
  return all;
}

TEST(UpdateMesh, ManyLocalEditsTogetherStayLocal) {
  // Fifteen edits all over the surface, whose common box contains it completely.
  SANSMESH_NOT_SANITIZED("others update meshes, too");
  FunctionEditor editor(fitted(bumpy(20000)));
  const TriangleMesh before = meshed(editor.function());
  Progress progress;
  const std::vector<Action> actions = local_actions();
  const std::vector<Vec3> points = spread_directions(15);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto along = [&](const Vec3f& a, const Vec3f& b) {
      return dot(normalized(Vec3(a)), points[i]) < dot(normalized(Vec3(b)), points[i]);
    };
    const Vec3 at(*std::max_element(before.vertices.begin(), before.vertices.end(), along));
    const EditReport report =
        editor.apply(edit_in_ball(before.origin + at, 0.02, actions[i % actions.size()]), progress);
    ASSERT_GT(report.chosen, 0u);
  }
  EXPECT_GT(bounds_of(editor.changed()).diagonal(), 2.5);
  EXPECT_GE(separate_sets(editor.changed()), 15u);
  MeshUpdate update;
  const TriangleMesh after = update_mesh(editor.function(), before, editor.changed(), {}, progress, &update);
  EXPECT_TRUE(update.local) << update.why;
  EXPECT_EQ(update.why, "");
  EXPECT_LT(update.removed, before.triangles.size() / 4);
  EXPECT_EQ(after.triangles.size() + update.removed, before.triangles.size() + update.added);
  expect_closed(after);
  expect_same_surface(after, meshed(editor.function()), 2 * mean_edge(before));
  const std::set<Corners> old = triangle_set(before), now = triangle_set(after);
  const auto kept = std::count_if(now.begin(), now.end(), [&](const Corners& c) { return old.count(c) > 0; });
  EXPECT_EQ(static_cast<std::size_t>(kept), after.triangles.size() - update.added);
}

TEST(UpdateMesh, EditsThatOverlapAreOneChange) {
  FunctionEditor editor(fitted(bumpy(6000)));
  const TriangleMesh before = meshed(editor.function());
  Progress progress;
  for (const double x : {0.0, 0.05, 0.1}) editor.apply(edit_in_ball({x, 0, 1}, 0.06, SetDegree{1}), progress);
  EXPECT_EQ(separate_sets(editor.changed()), 1u);
  MeshUpdate update;
  const TriangleMesh after = update_mesh(editor.function(), before, editor.changed(), {}, progress, &update);
  EXPECT_TRUE(update.local) << update.why;
  EXPECT_EQ(update.regions, 1u);
  expect_closed(after);
  expect_same_surface(after, meshed(editor.function()), 2 * mean_edge(before));
}

TEST(UpdateMesh, SaysWhyAllIsMadeAnew) {
  FunctionEditor editor(fitted(bumpy(3000)));
  const TriangleMesh before = meshed(editor.function());
  Progress progress;
  editor.apply(edit_in_ball({0, 0, 1}, 0.1, SetDegree{1}), progress);
  const auto why = [&](const TriangleMesh& mesh, const MeshOptions& options) {
    MeshUpdate update;
    update_mesh(editor.function(), mesh, editor.changed(), options, progress, &update);
    EXPECT_FALSE(update.local);
    return update.why;
  };
  MeshOptions few;
  few.triangles = 500;
  EXPECT_NE(why(before, few).find("number of triangles"), std::string::npos);
  MeshOptions plain;
  plain.enhance = false;
  EXPECT_NE(why(meshed(editor.function(), plain), {}).find("meshing without options"), std::string::npos);
  // A mesh that another edit has changed elsewhere.
  FunctionEditor other(editor.function());
  other.apply(edit_in_ball({0, 0, -1}, 0.7, SetConstant{1}), progress);
  EXPECT_NE(why(meshed(other.function()), {}).find("not on the surface"), std::string::npos);
}

TEST(UpdateMesh, OfAMeshThatIsOlderThanAnEditIsMendedThere) {
  FunctionEditor editor(fitted(bumpy(6000)));
  const TriangleMesh oldest = meshed(editor.function());
  Progress progress;
  editor.apply(edit_in_ball({0, 0, -1}, 0.12, SetConstant{1}), progress);
  FunctionEditor later(editor.function());
  later.apply(edit_in_ball({0, 0, 1}, 0.08, SetDegree{1}), progress);
  MeshUpdate update;
  const TriangleMesh after = update_mesh(later.function(), oldest, later.changed(), {}, progress, &update);
  EXPECT_TRUE(update.local) << update.why;
  EXPECT_EQ(update.regions, 2u);
  expect_closed(after);
  expect_same_surface(after, meshed(later.function()), 2 * mean_edge(oldest));
}

TEST(UpdateMesh, MeshesAreJudgedByWhereTheyAre) {
  PointSet cloud = bumpy(4000);
  cloud.origin = {3000, -200, 5};
  const FittedFunction function = fitted(cloud);
  TriangleMesh mesh = meshed(function);
  EXPECT_TRUE(match_mesh(function, mesh).belongs());
  MeshOptions coarse;
  coarse.triangles = 400;
  EXPECT_TRUE(match_mesh(function, meshed(function, coarse)).belongs()) << "whatever its triangles";
  for (Vec3f& v : mesh.vertices) v *= 1.3f;
  const MeshMatch wrong = match_mesh(function, mesh);
  EXPECT_FALSE(wrong.belongs());
  EXPECT_GT(wrong.farthest, 0.2);
  EXPECT_LT(norm(wrong.farthest_at - cloud.origin), 2);
  EXPECT_FALSE(match_mesh(function, octasphere(4)).belongs()) << "elsewhere";
  EXPECT_FALSE(match_mesh(function, {}).belongs());
  const std::vector<Box3> everywhere{Box3{cloud.origin - Vec3{9, 9, 9}, cloud.origin + Vec3{9, 9, 9}}};
  EXPECT_EQ(match_mesh(function, mesh, everywhere).vertices, 0u);
}

TEST(UpdateMesh, OfNothingIsTheMesh) {
  const FittedFunction function = fitted(sphere(2000));
  const TriangleMesh before = meshed(function);
  Progress progress;
  MeshUpdate update;
  const TriangleMesh after = update_mesh(function, before, {}, {}, progress, &update);
  EXPECT_TRUE(update.local);
  EXPECT_EQ(after.triangles, before.triangles);
  EXPECT_EQ(update.added + update.removed, 0u);
}

TEST(UpdateMesh, ManyEditsOneMesh) {
  SANSMESH_NOT_SANITIZED("compares results; others edit meshes, too");
  // After any edit the mesh stays closed and manifold, updated from the previous step or remade.
  const FittedFunction function = fitted(bumpy(8000));
  FunctionEditor editor({PartitionOfUnity(function.field.data()), function.frame, function.samples, {}, {}});
  TriangleMesh mesh = meshed(function);
  std::mt19937 random(4);
  std::size_t local = 0, rounds = 30;
  for (std::size_t round = 0; round < rounds; ++round) {
    const auto& samples = function.samples->positions;
    const Vec3 at = function.frame.to_input(function.field.data().origin + Vec3(samples[random() % samples.size()]));
    const std::vector<Action> all = local_actions();
    const double radius = 0.03 + 0.02 * static_cast<double>(random() % 4);
    Action action = all[random() % all.size()];
    if (round % 7 == 6) action = Undo{1};
    Progress progress;
    Edit edit = std::holds_alternative<Undo>(action) ? Edit{{}, action} : edit_in_ball(at, radius, action);
    const EditReport report = editor.apply(edit, progress);
    SCOPED_TRACE(std::to_string(round) + ": " + report.what);
    MeshUpdate update;
    // An undo changes the regions that its edit changed.
    mesh = update_mesh(editor.function(), std::move(mesh), report.regions, {}, progress, &update);
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
  // The surface at the change has vanished, so that no triangle can be compared.
  FunctionEditor editor(fitted(joined(sphere(4000), sphere(500), 0.3f, {2, 0, 0})));
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
  const FittedFunction function = fitted(cloud);
  const TriangleMesh mesh = meshed(function);
  Folder folder;
  for (const char* name : {"mesh.ply", "mesh.stl", "mesh.obj", "mesh.off"}) {
    SCOPED_TRACE(name);
    const std::string file = folder / name;
    write_mesh(file, mesh);
    FunctionEditor editor({PartitionOfUnity(function.field.data()), function.frame, function.samples, {}, {}});
    Progress progress;
    editor.apply(edit_in_ball(cloud.origin + Vec3{0, 0, 1}, 0.08, SetConstant{1}), progress);
    MeshUpdate update;
    const TriangleMesh after = update_mesh(editor.function(), read_mesh(file), editor.changed(), {}, progress, &update);
    expect_closed(after);
    expect_same_surface(after, meshed(editor.function()), 2 * mean_edge(mesh));
    // Binary files keep every relevant bit.
    if (std::string(name) == "mesh.ply") {
      EXPECT_TRUE(update.local);
    }
  }
}

TEST(UpdateMesh, WholeComponentsComeAndGo) {
  const FittedFunction function = fitted(two_spheres());
  const TriangleMesh both = meshed(function);
  ASSERT_EQ(measure_topology(both).components, 2u);
  for (const bool large : {false, true}) {
    FunctionEditor editor({PartitionOfUnity(function.field.data()), function.frame, function.samples, {}, {}});
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
    const std::vector<Box3> all{Box3{{-2, -2, -2}, {3, 2, 2}}};
    const TriangleMesh again = update_mesh(editor.function(), one, all, {}, progress, &update);
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

}  // namespace
}  // namespace sansmesh::inline v1
