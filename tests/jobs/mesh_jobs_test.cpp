// Tests of jobs on meshes: reports. The quality of the meshes is tested in tests/mesh.
#include <gtest/gtest.h>

#include "sansmesh/error.h"
#include "sansmesh/repair.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

TEST(SmoothJob, SaysWhenMoreThanNoiseGoes) {
  Progress progress;
  const SmoothResult fine = smooth(octasphere(4), {}, progress);
  EXPECT_TRUE(fine.notes.empty());
  EXPECT_EQ(fine.mesh.triangles.size(), octasphere(4).triangles.size());
  // All edges of an octahedron are creases.
  const SmoothResult coarse = smooth(octasphere(0), {.iterations = 50}, progress);
  ASSERT_TRUE(has_note(coarse.notes, "moved_far"));
  EXPECT_NE(coarse.notes[0].remedy.find("`creases`"), std::string::npos);
}

TEST(SmoothJob, SaysWhenWavesAreTooLongForIt) {
  Progress progress;
  EXPECT_TRUE(has_note(smooth(octasphere(2), {.shorter_than = 40}, progress).notes, "shortened"));
}

TEST(SimplifyJob, HalvesByItselfAndGoesAsFarAsItIsAsked) {
  const TriangleMesh ball = octasphere(4);
  Progress progress;
  EXPECT_EQ(simplify(ball, {}, progress).mesh.triangles.size(), ball.triangles.size() / 2);
  EXPECT_EQ(simplify(ball, {.triangles = 300}, progress).mesh.triangles.size(), 300u);
  EXPECT_EQ(simplify(ball, {.ratio = 0.25}, progress).mesh.triangles.size(), ball.triangles.size() / 4);
  const SimplifyResult close = simplify(ball, {.error = 0.01}, progress);
  EXPECT_LT(close.report.distance.to_reference.rms, 0.02);
  EXPECT_EQ(close.report.triangles, ball.triangles.size());
}

TEST(SimplifyJob, SaysWhatCannotBeHadAndWhatIsFarOff) {
  const TriangleMesh ball = octasphere(4);
  Progress progress;
  const SimplifyResult few = simplify(ball, {.triangles = 8}, progress);
  EXPECT_TRUE(has_note(few.notes, "far_off"));
  EXPECT_FALSE(has_note(simplify(ball, {}, progress).notes, "far_off"));
  // Two tetrahedra that share a face cannot collapse an edge without losing the face.
  TriangleMesh walls;
  walls.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  walls.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 1, 4}, {1, 2, 4}, {2, 0, 4}};
  EXPECT_TRUE(has_note(simplify(walls, {.triangles = 4}, progress).notes, "more_triangles"));
}

TEST(SimplifyJob, OneGoalAtATime) {
  Progress progress;
  EXPECT_THROW(simplify(octasphere(1), {.triangles = 8, .ratio = 0.5}, progress), ArgumentError);
  EXPECT_THROW(simplify(octasphere(1), {.ratio = 1}, progress), ArgumentError);
  EXPECT_THROW(simplify(octasphere(1), {.triangle_shape = 1}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
