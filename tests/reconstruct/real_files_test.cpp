// Optional test, if ../shared exists next to the checkout: with default options every real file gives a closed manifold
// mesh with the right components. hard_clouds_test.cpp covers the difficulties without it.
#include <gtest/gtest.h>

#include <filesystem>

#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/reconstruct.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

struct RealFile {
  const char* name;
  int components = 1;  ///< −1: undetermined (vegetation, loose triangles, self-intersecting necks)
  int genus = -1;      ///< −1: unknown
  bool open = false;   ///< bounds no solid: ends where the samples end
  double lost = 5e-4;  ///< largest accepted share of samples without a surface
};

class ExtraFiles : public ::testing::TestWithParam<RealFile> {};

TEST_P(ExtraFiles, GiveManifoldsClosedIfSolid) {
  const std::string file = test::shared_points(GetParam().name);
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no " << file;
  Progress progress;
  const auto [mesh, report, notes] = reconstruct(read_points(file), {}, progress);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_EQ(report.open, GetParam().open);
  EXPECT_EQ(topology.closed(), !GetParam().open);
  EXPECT_TRUE(topology.manifold());
  EXPECT_LE(report.lost, GetParam().lost);
  if (GetParam().components >= 0) {
    EXPECT_EQ(topology.components, static_cast<std::size_t>(GetParam().components));
  }
  if (GetParam().genus >= 0) {
    EXPECT_EQ(topology.genus(), GetParam().genus);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Points, ExtraFiles,
    ::testing::Values(RealFile{"aneurysm_vessel.stl.gz", 1, 0}, RealFile{"armadillo_43k.obj", 1, 0},
                      RealFile{"bimba_80k.ply", 1, 0}, RealFile{"bun_zipper.ply", 1, 0},
                      RealFile{"bunny_noised_20k.xyz", 1, 0}, RealFile{"bunny_scans/bun.conf", 1, 0, false, 0.002},
                      RealFile{"cad_part1.stl", 1, 1}, RealFile{"chinese-dragon_10k.off", 1, 0},
                      RealFile{"cube.pwn", 1, 0}, RealFile{"dragon_vrip_res3.ply", -1},
                      RealFile{"elephant-with-holes.off", 1}, RealFile{"fandisk.off", 1, 0},
                      RealFile{"fertility_4k.off", 1, 4}, RealFile{"hippo1.ply", -1, -1, true, 0.01},
                      RealFile{"horse.ply", 1, 0}, RealFile{"icosahedron.off", 1, 0}, RealFile{"igea_gt.ply", 1, 0},
                      RealFile{"kinect_capture0001.pcd", -1, -1, true, 0.01}, RealFile{"kitten.xyz", 1, 1},
                      RealFile{"lidar_autzen_trim.las", -1, -1, true, 0.01},
                      RealFile{"lidar_samp11.pcd", -1, -1, true, 0.01}, RealFile{"max-planck_5k.obj", 1, 0},
                      RealFile{"oni.pwn", 1, -1, false, 0.02}, RealFile{"rocker-arm.obj", 1, 1},
                      RealFile{"soup_chair.obj", -1, -1, true, 0.01}, RealFile{"soup_self_intersect.obj", -1},
                      RealFile{"soup_triangles.stl", -1, -1, false, 0.005}, RealFile{"sphere_1k.xyz", 1, 0},
                      RealFile{"sphere_20k_noisy.xyz", 1, 0}, RealFile{"vase_sfm_owl.vtp", 1, 0}),
    [](const auto& tested) {
      std::string name = tested.param.name;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

}  // namespace
}  // namespace sansmesh::inline v1
