// PLY in and out.
#include "io_test_tools.h"

namespace sansmesh {
namespace {

using namespace test;

class PlyRoundTrip : public ::testing::TestWithParam<bool> {};

TEST_P(PlyRoundTrip, MeshKeepsEveryAttributeExactly) {
  const Folder folder;
  const TriangleMesh mesh = made_mesh();
  write_mesh(folder / "m.ply", mesh, {.ascii = GetParam()});
  ReadReport report;
  const TriangleMesh back = read_mesh(folder / "m.ply", &report);
  EXPECT_EQ(report.format, GetParam() ? "PLY ascii" : "PLY binary little endian");
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(back.origin, Vec3{});
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.normals, mesh.normals);
  EXPECT_EQ(back.colors, mesh.colors);
  EXPECT_EQ(back.quality, mesh.quality);
}

INSTANTIATE_TEST_SUITE_P(AsciiAndBinary, PlyRoundTrip, ::testing::Bool());

}  // namespace
}  // namespace sansmesh
