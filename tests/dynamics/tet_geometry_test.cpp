#include "sansmesh/dynamics/tet_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "dynamics/body_checks.h"
#include "sansmesh/error.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

/// An uneven mesh without symmetries.
TetMesh uneven() {
  TetMesh mesh = test::box_of_tets({0, 0, 0}, {3, 2, 1}, 3, 3, 2);
  mesh.vertices = test::sum(mesh.vertices, test::random_vectors(mesh.vertices.size(), 0.1, 4));
  return mesh;
}

double volume_of(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.tets) sum += tet_volume(t, mesh.vertices);
  return sum;
}

/// Volume enclosed by the boundary, by the divergence theorem.
double volume_within(const TetMesh& mesh) {
  double six = 0;
  for (const Triangle& t : boundary_faces(mesh)) {
    six += dot(mesh.vertices[t[0]], cross(mesh.vertices[t[1]], mesh.vertices[t[2]]));
  }
  return six / 6;
}

TEST(TetGeometry, BoxesAreFull) {
  const TetMesh box = test::box_of_tets({1, 2, 3}, {4, 4, 4}, 3, 4, 5);
  check_tets(box);
  EXPECT_EQ(box.tets.size(), 6 * 3 * 4 * 5);
  EXPECT_NEAR(volume_of(box), 6, 1e-12);
  EXPECT_EQ(boundary_faces(box).size(), 2 * 2 * (3 * 4 + 4 * 5 + 5 * 3));
}

TEST(TetGeometry, TheBoundaryIsClosedAndFacesOutward) {
  const TetMesh mesh = uneven();
  EXPECT_NEAR(volume_within(mesh), volume_of(mesh), 1e-12);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  std::vector<std::uint32_t> owners;
  const auto faces = boundary_faces(mesh, &owners);
  for (const Triangle& t : faces) {
    for (std::size_t k = 0; k < 3; ++k) ++ways[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : ways) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(ways.count({edge.second, edge.first}), 1);
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const std::uint32_t v : faces[f]) {
      const Tet& t = mesh.tets[owners[f]];
      EXPECT_NE(std::find(t.begin(), t.end(), v), t.end());
    }
  }
  std::vector<std::uint32_t> sources;
  const TriangleMesh surface = boundary_mesh(mesh, mesh.vertices, &sources);
  ASSERT_EQ(surface.vertices.size(), sources.size());
  EXPECT_LT(sources.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    EXPECT_LT(norm(surface.origin + Vec3(surface.vertices[i]) - mesh.vertices[sources[i]]), 1e-6);
  }
}

TEST(TetGeometry, RefinementFillsTheSameSpaceWithoutSlivers) {
  const TetMesh mesh = uneven(), fine = test::refine_uniformly(mesh);
  check_tets(fine);
  EXPECT_EQ(fine.tets.size(), 8 * mesh.tets.size());
  EXPECT_EQ(boundary_faces(fine).size(), 4 * boundary_faces(mesh).size());  // conforming
  EXPECT_NEAR(volume_of(fine), volume_of(mesh), 1e-12);
  EXPECT_NEAR(volume_within(fine), volume_of(mesh), 1e-12);
  for (std::size_t k = 0; k < fine.tets.size(); ++k) {
    EXPECT_NEAR(tet_volume(fine.tets[k], fine.vertices), tet_volume(mesh.tets[k / 8], mesh.vertices) / 8, 1e-14);
  }
}

TEST(TetGeometry, RefusesTurnedOnes) {
  TetMesh mesh = uneven();
  std::swap(mesh.tets[3][0], mesh.tets[3][1]);
  EXPECT_THROW(check_tets(mesh), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
