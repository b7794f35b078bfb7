// Meshes of solids by operations on their faces.
#include "sansmesh/meshing/face_csg.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "support/mesh_checks.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

struct Made {
  TriangleMesh mesh;
  CsgMeshReport report;
};

Made made_of(const Solid& solid, const CsgMeshOptions& options = {}) {
  Made m;
  Progress progress;
  auto mesh = mesh_of_faces(solid, options, progress, m.report);
  EXPECT_TRUE(mesh.has_value());
  m.mesh = *mesh;
  EXPECT_TRUE(topology_of(m.mesh).closed_manifold());
  return m;
}

std::shared_ptr<const TriangleMesh> shared(TriangleMesh mesh) {
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

TEST(FaceCsg, ADrillLeavesOtherTrianglesAlone) {
  TriangleMesh ball = octasphere(5);
  ball.origin = {1e6, 2e6, 0};
  const Made drilled = made_of(csg::subtract(csg::face_leaf(shared(ball)), csg::cylinder(ball.origin, {0, 0, 1}, 0.2)));
  EXPECT_EQ(drilled.mesh.origin, ball.origin);
  EXPECT_EQ(measure_topology(drilled.mesh).genus(), 1);
  EXPECT_LT(drilled.mesh.triangles.size(), ball.triangles.size() * 11 / 10);
  EXPECT_NEAR(drilled.report.volume, 4 * std::numbers::pi / 3 * std::pow(1 - 0.04, 1.5), 0.01);
  const auto key = [](const TriangleMesh& m, const Triangle& t) {
    std::vector<float> k;
    for (const std::uint32_t v : t) k.insert(k.end(), {m.vertices[v].x, m.vertices[v].y, m.vertices[v].z});
    return k;
  };
  std::set<std::vector<float>> now;
  for (const Triangle& t : drilled.mesh.triangles) now.insert(key(drilled.mesh, t));
  std::size_t kept = 0;
  for (const Triangle& t : ball.triangles) kept += now.contains(key(ball, t)) ? 1 : 0;
  EXPECT_GT(kept, ball.triangles.size() * 9 / 10);
}

TEST(FaceCsg, FlatSolidsAreExact) {
  const Solid frame = csg::subtract(csg::box({0, 0, 0}, {3, 3, 1}), csg::box({1, 1, -1}, {2, 2, 2}));
  const Made m = made_of(frame);
  EXPECT_NEAR(m.report.volume, 8, 1e-12);
  EXPECT_EQ(m.mesh.vertices.size(), 16u);
  EXPECT_EQ(m.mesh.triangles.size(), 32u);
  EXPECT_EQ(measure_topology(m.mesh).genus(), 1);
}

/// Half-spaces and infinite cylinders end beyond the solid.
TEST(FaceCsg, UnboundedPartsOfABoundedSolid) {
  const Solid corner = csg::intersect(csg::half_space({1, 1, 1}, 0), csg::box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_NEAR(made_of(corner).report.volume, 4, 1e-6);
  const Solid outside = csg::complement(
      csg::unite(csg::unite(csg::half_space({1, 0, 0}, 0), csg::half_space({-1, 0, 0}, -2)),
                 csg::unite(csg::unite(csg::half_space({0, 1, 0}, 0), csg::half_space({0, -1, 0}, -2)),
                            csg::unite(csg::half_space({0, 0, 1}, 0), csg::half_space({0, 0, -1}, -2)))));
  EXPECT_DOUBLE_EQ(made_of(outside).report.volume, 8);
  const Solid tube = csg::subtract(csg::cylinder({}, {0, 0, 1}, 1), csg::cylinder({}, {0, 0, 1}, 0.5));
  CsgMeshOptions options;
  options.box = Box3{{-2, -2, 0}, {2, 2, 1}};
  EXPECT_NEAR(made_of(tube, options).report.volume, 0.75 * std::numbers::pi, 1e-6);
}

TEST(FaceCsg, AgreesWithTheFunction) {
  const Solid solid = csg::subtract(csg::unite(csg::sphere({}, 1), csg::box({0, 0, 0}, {1.2, 1, 1})),
                                    csg::rotate(csg::cylinder({}, {1, 0, 0}, 0.3), {0, 0, 1}, 20));
  Progress progress;
  CsgMeshReport by_function;
  mesh_csg(solid, {}, progress, &by_function);
  const Made m = made_of(solid);
  EXPECT_NEAR(m.report.volume, by_function.volume, 2e-4 * by_function.volume);
  EXPECT_NEAR(m.report.area, by_function.area, 1e-3 * by_function.area);
}

TEST(FaceCsg, ChoosesByTheParts) {
  const Solid mesh = csg::face_leaf(shared(octasphere(2))), ball = csg::sphere({}, 0.5), box = csg::box({}, {1, 1, 1});
  const auto choice = [](const Solid& s, const CsgMeshOptions& o = {}) { return choose_csg_mesher(s, o); };
  EXPECT_TRUE(choice(csg::subtract(mesh, ball)).faces);
  EXPECT_TRUE(choice(box).faces);
  EXPECT_FALSE(choice(csg::subtract(box, ball)).faces);
  EXPECT_FALSE(choice(csg::offset(mesh, 0.1)).faces);
  EXPECT_EQ(choice(csg::offset(mesh, 0.1)).reason, "an offset has no faces");
  CsgMeshOptions options;
  options.cell = 0.1;
  EXPECT_FALSE(choice(mesh, options).faces);
  options = {};
  options.mesher = CsgMesher::function;
  EXPECT_FALSE(choice(mesh, options).faces);
  options.mesher = CsgMesher::faces;
  EXPECT_TRUE(choice(csg::subtract(box, ball), options).faces);
  EXPECT_THROW(choice(csg::offset(mesh, 0.1), options), ArgumentError);
  options.cell = 0.1;
  EXPECT_THROW(options.validate(), ArgumentError);
}

TEST(FaceCsg, EmptySolidsAreAnError) {
  Progress progress;
  CsgMeshReport report;
  const Solid box = csg::box({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(mesh_of_faces(csg::subtract(box, csg::box({-1, -1, -1}, {2, 2, 2})), {}, progress, report), DataError);
}

/// Vertices that files repeat for each face.
TEST(FaceCsg, TooManyFacesAreLeftToTheFunction) {
  CsgMeshOptions options;
  options.mesh_error = 1e-10;
  CsgMeshReport report;
  Progress progress;
  EXPECT_FALSE(mesh_of_faces(csg::subtract(csg::box({0, 0, 0}, {1, 1, 1}), csg::sphere({0, 0, 0}, 0.5)), options,
                             progress, report));
  EXPECT_EQ(report.reason, "curved parts would need too many faces for the mesh error");
}

TEST(FaceCsg, EqualVerticesAreJoined) {
  const TriangleMesh ball = octasphere(2);
  TriangleMesh soup;
  for (const Triangle& t : ball.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(ball.vertices[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const Made m = made_of(csg::intersect(csg::face_leaf(shared(soup)), csg::half_space({0, 0, 1}, 0.1)));
  EXPECT_EQ(m.report.components, 1u);
  soup.triangles.pop_back();
  Progress progress;
  CsgMeshReport report;
  EXPECT_FALSE(mesh_of_faces(csg::face_leaf(shared(soup)), {}, progress, report).has_value());
  EXPECT_EQ(report.reason, "a mesh has edges with unpaired faces");
}

}  // namespace
}  // namespace sansmesh::test
