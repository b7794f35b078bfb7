// Recommended methods for volumes: figure 7.2 of tejada2008, case by case.
#include "sansmesh/volume_advice.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sansmesh::inline v1 {
namespace {

using VolumeAim = VolumeRecommendation::Aim;

const VolumeRecommendation* find(const std::vector<VolumeRecommendation>& list, VolumeAim aim) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const auto& r) { return r.aim == aim; });
  return at == list.end() ? nullptr : &*at;
}

/// Samples that parabolas predict much better than planes.
VolumeAdviceInput resolved() {
  VolumeAdviceInput offer;
  offer.traits.left_out = {0.02, 0.01, 0.001, 0.0005};
  offer.traits.left_out_rms = offer.traits.left_out;
  offer.lattice = true;
  return offer;
}

TEST(AdviseVolume, ResolvedVolumesGetIsosurfaces) {
  const auto list = advise_volume(resolved());
  ASSERT_NE(find(list, VolumeAim::surface), nullptr);
  EXPECT_FALSE(find(list, VolumeAim::surface)->by_samples);
  EXPECT_EQ(find(list, VolumeAim::border), nullptr);
  EXPECT_EQ(find(list, VolumeAim::lines), nullptr) << "nothing flows";
  EXPECT_EQ(find(list, VolumeAim::forces), nullptr) << "no body";
  for (const VolumeAim aim : {VolumeAim::picture, VolumeAim::values, VolumeAim::grid, VolumeAim::deformation})
    EXPECT_NE(find(list, aim), nullptr) << aim_word(aim);
}

TEST(AdviseVolume, CoarseLatticesWithStepsHaveBordersFirst) {
  VolumeAdviceInput offer = resolved();
  offer.traits.left_out_rms = {0.04, 0.03, 0.029, 0.03};
  offer.traits.steps = 0.05;
  const auto list = advise_volume(offer);
  ASSERT_FALSE(list.empty());
  EXPECT_EQ(list[0].aim, VolumeAim::border);
  EXPECT_TRUE(find(list, VolumeAim::surface)->by_samples);
  // In flat cells layers of samples fall apart: surfaces use the reconstruction for all values.
  offer.lattice = false;
  EXPECT_EQ(find(advise_volume(offer), VolumeAim::border), nullptr);
  EXPECT_FALSE(find(advise_volume(offer), VolumeAim::surface)->by_samples);
}

TEST(AdviseVolume, UnsteadyFlowsGetPathLinesSteadyOnesStreamLines) {
  VolumeAdviceInput offer = resolved();
  offer.vectors = true;
  const auto steady = advise_volume(offer);
  EXPECT_EQ(steady[0].aim, VolumeAim::flow_picture);
  EXPECT_EQ(steady[0].why.find("stream"), 0u);
  offer.steps = 11;
  EXPECT_EQ(advise_volume(offer)[0].why.find("path"), 0u);
}

TEST(AdviseVolume, BodiesMoveByForces) {
  VolumeAdviceInput bare;
  bare.values = false, bare.body = true;
  const auto list = advise_volume(bare);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].aim, VolumeAim::forces);
  bare.vectors = true;
  EXPECT_EQ(find(advise_volume(bare), VolumeAim::forces), nullptr) << "a fluid, or a result";
}

}  // namespace
}  // namespace sansmesh::inline v1
