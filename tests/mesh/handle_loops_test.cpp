#include "sansmesh/mesh/repair/handle_loops.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <vector>

#include "sansmesh/mesh/repair/cut_handles.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/handled_meshes.h"
#include "support/mesh_checks.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::torus_mesh;

std::vector<HandleLoop> loops_up_to(const TriangleMesh& mesh, double length) {
  return HandleClasses(mesh).short_loops([&](std::uint32_t, std::uint32_t) { return length; });
}

/// Number of triangles that paths across edges off the loop reach from the first triangle.
std::size_t reached_beside(const TriangleMesh& mesh, const HandleLoop& loop) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> wall;
  for (std::size_t i = 0; i < loop.vertices.size(); ++i) {
    const std::uint32_t a = loop.vertices[i], b = loop.vertices[(i + 1) % loop.vertices.size()];
    wall.insert({a, b}), wall.insert({b, a});
  }
  const HandleClasses classes(mesh);
  std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> open{0};
  seen[0] = 1;
  for (std::size_t at = 0; at < open.size(); ++at)
    for (std::uint32_t h = 3 * open[at]; h < 3 * open[at] + 3; ++h) {
      const std::uint32_t other = classes.twin(h);
      if (other == HandleClasses::kNone || wall.contains({classes.from(h), classes.to(h)}) || seen[other / 3]++)
        continue;
      open.push_back(other / 3);
    }
  return open.size();
}

TEST(HandleClasses, CountHandlesOfAllComponents) {
  const TriangleMesh torus = torus_mesh(24, 12), ball = test::octasphere(3);
  EXPECT_EQ(HandleClasses(ball).genus(), 0u);
  EXPECT_EQ(HandleClasses(torus).genus(), 1u);
  EXPECT_EQ(HandleClasses(test::joined(test::joined(torus, ball, {5, 0, 0}), torus, {9, 0, 0})).genus(), 2u);
  EXPECT_EQ(HandleClasses(test::with_prism(torus, {0.65, 0, 0}, {-0.65, 0, 0})).genus(), 2u);
  EXPECT_EQ(HandleClasses(TriangleMesh{}).genus(), 0u);
  TriangleMesh open = torus;  // borders are no handles
  open.triangles.erase(open.triangles.begin() + 200);
  open.triangles.erase(open.triangles.begin() + 50);
  EXPECT_EQ(HandleClasses(open).genus(), 1u);
}

TEST(HandleClasses, TwinsAreTheOnlyOppositeHalfEdges) {
  TriangleMesh mesh = torus_mesh(24, 12);
  mesh.triangles.erase(mesh.triangles.begin() + 50);
  std::swap(mesh.triangles[100][0], mesh.triangles[100][1]);                                      // turned over
  mesh.triangles.push_back({mesh.triangles[7][0], mesh.triangles[7][1], mesh.triangles[30][2]});  // a third face
  const HandleClasses classes(mesh);
  std::size_t none = 0;
  for (std::uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    std::vector<std::uint32_t> same, opposite;
    for (std::uint32_t other = 0; other < 3 * mesh.triangles.size(); ++other) {
      if (classes.from(other) == classes.from(h) && classes.to(other) == classes.to(h)) same.push_back(other);
      if (classes.from(other) == classes.to(h) && classes.to(other) == classes.from(h)) opposite.push_back(other);
    }
    const bool paired = same.size() == 1 && opposite.size() == 1;
    EXPECT_EQ(classes.twin(h), paired ? opposite[0] : HandleClasses::kNone) << h;
    none += !paired;
  }
  EXPECT_GT(none, 3u);
}

TEST(HandleClasses, LeaveOutComponentsThatAreNoSurfaces) {
  TriangleMesh mesh = test::joined(torus_mesh(24, 12), torus_mesh(24, 12), {5, 0, 0});
  const Triangle t = mesh.triangles[10];
  mesh.vertices.push_back({0, 0, 9});
  mesh.triangles.push_back({t[0], t[1], static_cast<std::uint32_t>(mesh.vertices.size() - 1)});  // edge of 3 triangles
  EXPECT_EQ(HandleClasses(mesh).genus(), 1u);
}

TEST(HandleClasses, ShortestLoopsDoNotSeparate) {
  const TriangleMesh torus = torus_mesh(40, 24);
  const double around = 2 * std::numbers::pi * 0.35;
  EXPECT_TRUE(loops_up_to(torus, 0.9 * around).empty());
  const std::vector<HandleLoop> loops = loops_up_to(torus, 1.5 * around);
  ASSERT_FALSE(loops.empty());
  for (const HandleLoop& loop : loops) {
    EXPECT_EQ(loop.label, loops[0].label);  // all are cross-sections of the tube
    EXPECT_NEAR(loop.length, around, 0.02 * around);
    EXPECT_EQ(std::set(loop.vertices.begin(), loop.vertices.end()).size(), loop.vertices.size());
    EXPECT_EQ(reached_beside(torus, loop), torus.triangles.size());
  }
}

TEST(HandleClasses, LoopsAroundFingersAndBordersAreNone) {
  // A ring around a thin finger of the torus, or around one of its holes, is shorter than any cross-section.
  TriangleMesh mesh = torus_mesh(40, 24);
  const std::uint32_t t = test::triangle_near(mesh, {1.35, 0, 0});
  const Triangle base = mesh.triangles[t];
  const auto tip = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({4, 0, 0});
  mesh.triangles.erase(mesh.triangles.begin() + t);
  for (std::size_t k = 0; k < 3; ++k) mesh.triangles.push_back({base[k], base[(k + 1) % 3], tip});
  mesh.triangles.erase(mesh.triangles.begin() + test::triangle_near(mesh, {-1.35, 0, 0}));
  EXPECT_EQ(HandleClasses(mesh).genus(), 1u);
  EXPECT_TRUE(loops_up_to(mesh, 1.9).empty());
  const TriangleMesh two = test::with_prism(mesh, {0, 0.65, 0}, {0, -0.65, 0});
  const std::vector<HandleLoop> loops = loops_up_to(two, 1);
  ASSERT_FALSE(loops.empty());
  EXPECT_EQ(loops[0].vertices.size(), 3u);
  for (const HandleLoop& loop : loops) EXPECT_EQ(loop.label, loops[0].label);
}

TEST(HandleClasses, DoNotDependOnThreads) {
  const TriangleMesh mesh = test::with_prism(torus_mesh(60, 30), {0.65, 0, 0}, {-0.65, 0, 0});
  test::expect_equal_for_any_threads([&] {
    std::vector<std::vector<std::uint32_t>> loops;
    for (HandleLoop& loop : loops_up_to(mesh, 4)) loops.push_back(std::move(loop.vertices));
    return loops;
  });
}

TEST(CutHandles, TurnsATorusIntoABall) {
  const TriangleMesh torus = torus_mesh(40, 24);
  const HandleClasses classes(torus);
  const HandleLoop loop = loops_up_to(torus, 3).at(0);
  for (const double width : {0.0, 0.2, 0.5}) {
    const auto cut = cut_handle(torus, classes, loop, width);
    ASSERT_TRUE(cut) << width;
    TriangleMesh mesh = torus;
    apply_cuts(mesh, std::span(&*cut, 1));
    const test::Topology topology = test::topology_of(mesh);
    EXPECT_TRUE(topology.closed_manifold()) << width;
    EXPECT_EQ(topology.euler, 2) << width;
    EXPECT_LT(mesh.triangles.size(), torus.triangles.size());
    EXPECT_LE(mesh.vertices.size(), torus.vertices.size());
    EXPECT_EQ(measure_topology(mesh).degenerate_triangles, 0u);
    std::vector<std::uint32_t> all(torus.triangles.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    EXPECT_FALSE(caps_intersect(torus, *cut, all)) << width;
  }
  EXPECT_FALSE(cut_handle(torus, classes, loop, 10));  // the band is the whole torus
}

TEST(CutHandles, CarriesProperties) {
  TriangleMesh mesh = torus_mesh(40, 24);
  const HandleClasses classes(mesh);
  const auto cut = cut_handle(mesh, classes, loops_up_to(mesh, 3).at(0), 0.3);
  ASSERT_TRUE(cut);
  mesh.normals.assign(mesh.vertices.size(), {0, 0, 1});
  mesh.colors.assign(mesh.vertices.size(), {1, 2, 3});
  mesh.attributes.set("quality", std::vector<float>(mesh.vertices.size(), 0.5f));
  apply_cuts(mesh, std::span(&*cut, 1));
  EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.attributes[0].size(), mesh.vertices.size());
}

}  // namespace
}  // namespace sansmesh::inline v1
