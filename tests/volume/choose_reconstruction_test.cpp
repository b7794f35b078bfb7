#include "sansmesh/volume/choose_reconstruction.h"
#include "sansmesh/volume/smoothed_values.h"
#include "sansmesh/volume/volume_traits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {
namespace {

VolumeReconstructionChoice chosen_for(const std::function<double(const Vec3&)>& f) {
  constexpr std::size_t kSamples = 24;
  std::vector<double> values;
  for (std::size_t k = 0; k < kSamples; ++k)
    for (std::size_t j = 0; j < kSamples; ++j)
      for (std::size_t i = 0; i < kSamples; ++i)
        values.push_back(f(Vec3{double(i), double(j), double(k)} / (kSamples - 1)));
  GridBlock block;
  block.kind = GridKind::lattice;
  for (auto& axis : block.axes)
    for (std::size_t i = 0; i < kSamples; ++i) axis.push_back(static_cast<double>(i));
  block.point_arrays.set("f", values);
  GridData data;
  data.blocks.push_back(std::move(block));
  Progress progress;
  const SampledVolume volume = assemble_volume(data, Association::points, progress);
  const VolumeValues of = volume_values(volume, "f");
  return choose_reconstruction(volume,
                               measure_volume_traits(volume, of, noise_of_values(volume, of, progress), progress));
}

TEST(ChooseReconstruction, SmoothAndNoisyLatticesGetPolynomialsEdgesCubics) {
  const VolumeReconstructionChoice smooth =
      chosen_for([](const Vec3& x) { return std::sin(4 * x.x) * std::cos(3 * x.y) + x.z; });
  EXPECT_EQ(smooth.method, "mls-detail") << smooth.why;
  // Smooth except at the surface of a ball.
  const VolumeReconstructionChoice edges = chosen_for([](const Vec3& x) {
    return std::sin(4 * x.x) * std::cos(3 * x.y) + (norm(x - Vec3{0.5, 0.5, 0.5}) < 0.3 ? 5 : 0);
  });
  EXPECT_EQ(edges.method, "cubic") << edges.why;
  EXPECT_NE(edges.why.find("edges"), std::string::npos) << edges.why;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.05);
  const VolumeReconstructionChoice noisy = chosen_for([&](const Vec3& x) { return x.x + noise(random); });
  EXPECT_EQ(noisy.method, "mls-detail") << noisy.why;
  EXPECT_NE(noisy.why.find("noise"), std::string::npos) << noisy.why;
}

}  // namespace
}  // namespace sansmesh::inline v1
