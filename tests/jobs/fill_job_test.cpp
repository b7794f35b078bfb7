// Tests of hole filling as a job: decisions and notes. The quality of fillings is tested in tests/mesh.
#include "sansmesh/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

/// The mesh without the triangles around its first vertex.
TriangleMesh opened(TriangleMesh mesh) {
  std::erase_if(mesh.triangles, [](const Triangle& t) { return std::find(t.begin(), t.end(), 0u) != t.end(); });
  return mesh;
}

/// Separate vertices for every triangle.
TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh made;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(made.vertices.size());
    for (const std::uint32_t v : t) made.vertices.push_back(mesh.vertices[v]);
    made.triangles.push_back({first, first + 1, first + 2});
  }
  return made;
}

TEST(FillJob, ListsWhatItFills) {
  const TriangleMesh ball = opened(octasphere(4));
  Progress progress;
  const HolesResult found = list_holes(ball, progress);
  EXPECT_EQ(found.holes.loops.size(), 1u);
  EXPECT_EQ(found.triangles, ball.triangles.size());
  EXPECT_TRUE(found.notes.empty());
  const FillResult made = fill(ball, {}, progress);
  EXPECT_EQ(made.report.filled, 1u);
  EXPECT_EQ(made.triangles, ball.triangles.size());
  EXPECT_TRUE(measure_topology(made.mesh).closed());
  EXPECT_TRUE(made.notes.empty());
  EXPECT_EQ(summary_of(made, 0)[0], "1 hole with 4 border edges");
  EXPECT_EQ(summary_of(made, 0)[1], "and 1 smaller ones");
  EXPECT_EQ(summary_of(made, 1).size(), 4u);
}

TEST(FillJob, JoinsVerticesAtOnePlaceBefore) {
  const TriangleMesh ball = opened(octasphere(4));
  Progress progress;
  const FillResult made = fill(soup(ball), {}, progress);
  EXPECT_EQ(made.report.found.loops.size(), 1u);
  EXPECT_EQ(made.joined_vertices, 3 * ball.triangles.size() - (ball.vertices.size() - 1));
  EXPECT_TRUE(measure_topology(made.mesh).closed());
}

TEST(FillJob, TellsOfEndsThatStayAndOfWhatIsInvented) {
  // A tube with eight sides and open ends.
  TriangleMesh tube;
  constexpr std::uint32_t kSides = 8, kRings = 12;
  for (std::uint32_t k = 0; k < kRings; ++k)
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double turn = 6.283185307179586 * i / kSides;
      tube.vertices.push_back(Vec3f(Vec3{std::cos(turn), std::sin(turn), 1.0 * k}));
    }
  for (std::uint32_t k = 0; k + 1 < kRings; ++k)
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = k * kSides + i, b = k * kSides + (i + 1) % kSides;
      tube.triangles.push_back({a, b, b + kSides});
      tube.triangles.push_back({a, b + kSides, a + kSides});
    }
  Progress progress;
  const FillResult stays = fill(tube, {.share = 0.5}, progress);
  ASSERT_TRUE(has_note(stays.notes, "ends"));
  EXPECT_EQ(stays.report.ends, 2u);
  EXPECT_NE(stays.notes[0].remedy.find("`all`"), std::string::npos);
  const FillResult all = fill(tube, {.all = true}, progress);
  EXPECT_EQ(all.report.filled, 2u);
  EXPECT_TRUE(has_note(all.notes, "wide"));
  EXPECT_FALSE(has_note(all.notes, "ends"));
}

TEST(FillJob, BadOptions) {
  Progress progress;
  EXPECT_THROW(fill(octasphere(1), {.largest = 0}, progress), ArgumentError);
  EXPECT_THROW(fill(octasphere(1), {.edges = 2}, progress), ArgumentError);
  EXPECT_THROW(fill(octasphere(1), {.largest = 1, .all = true}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
