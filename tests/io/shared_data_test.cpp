// Optional test of the real files in ../shared, if that folder is beside the checkout: counts match those of the
// source. dialects_test.cpp and shipped_files_test.cpp cover the same formats without it.
#include <unordered_set>

#include "io_test_tools.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct Expected {
  const char* file;
  std::size_t points, triangles;
  bool normals = false;
};
std::ostream& operator<<(std::ostream& out, const Expected& e) { return out << e.file; }

class ExtraFiles : public ::testing::TestWithParam<Expected> {};

TEST_P(ExtraFiles, HasTheStatedCounts) {
  const std::string file = shared_points(GetParam().file);
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no ../shared/data/points beside the checkout";
  const PointSet p = read_points(file);
  EXPECT_EQ(p.size(), GetParam().points);
  EXPECT_EQ(p.triangles.size(), GetParam().triangles);
  EXPECT_EQ(p.has_normals(), GetParam().normals);
}

INSTANTIATE_TEST_SUITE_P(
    Files, ExtraFiles,
    ::testing::Values(Expected{"bunny_scans/bun000.ply", 40256, 0}, Expected{"bunny_scans/bun.conf", 362272, 0},
                      Expected{"bun_zipper.ply", 35947, 69451}, Expected{"horse.ply", 48485, 96966},
                      Expected{"armadillo_43k.obj", 43243, 86482}, Expected{"fandisk.off", 7229, 14454},
                      Expected{"kitten.xyz", 5210, 0, true}, Expected{"oni.pwn", 1435, 0, true},
                      Expected{"cube.pwn", 50000, 0, true}, Expected{"hippo1.ply", 6104, 0, true},
                      Expected{"bimba_80k.ply", 80002, 0}, Expected{"lidar_autzen_trim.las", 110000, 0},
                      Expected{"lidar_samp11.pcd", 38010, 0}, Expected{"kinect_capture0001.pcd", 307200 - 57553, 0},
                      Expected{"cad_part1.stl", 190, 380}, Expected{"aneurysm_vessel.stl.gz", 10204, 20294},
                      Expected{"vase_sfm_owl.vtp", 12442, 24407}));

TEST(ExtraAlignment, EveryScanMeetsTheZipperedModel) {
  const std::string conf = shared_points("bunny_scans/bun.conf"), zippered = shared_points("bun_zipper.ply");
  if (!std::filesystem::exists(conf)) GTEST_SKIP() << "an extra: there is no ../shared/data/points beside the checkout";
  // Cells of 1.5 mm (the unit is the metre) around the model's vertices; a wrong sense of rotation moves most scans by
  // centimetres.
  const auto cell = [](const Vec3& p, int dx, int dy, int dz) {
    const auto index = [](double v, int d) { return static_cast<std::uint64_t>(std::floor(v / 0.0015) + d + 1000); };
    return index(p.x, dx) << 40 | index(p.y, dy) << 20 | index(p.z, dz);
  };
  std::unordered_set<std::uint64_t> near_model;
  const TriangleMesh model = read_mesh(zippered);
  for (const Vec3f& v : model.vertices) {
    for (int k = 0; k < 27; ++k) near_model.insert(cell(model.origin + Vec3(v), k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
  }
  const PointSet scans = read_points(conf);
  ASSERT_EQ(scans.scanners.size(), 10u);
  std::vector<double> near(10), all(10);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    near[scans.scan_of_point[i]] += near_model.count(cell(scans.origin + Vec3(scans.positions[i]), 0, 0, 0));
    all[scans.scan_of_point[i]] += 1;
  }
  for (int s = 0; s < 10; ++s) EXPECT_GT(near[s], 0.8 * all[s]) << "scan " << s;
}

}  // namespace
}  // namespace sansmesh::inline v1
