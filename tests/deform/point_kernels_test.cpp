// Vectorised maps compared with the map at single points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "deform/handle_sets.h"
#include "sansmesh/deform/cuts/planar_occluder.h"
#include "sansmesh/deform/mls/deform_setup.h"
#include "sansmesh/deform/mls/node_fit.h"
#include "sansmesh/deform/mls/weighted_nodes.h"

namespace sansmesh::test {
namespace {

using Cuts = std::vector<std::shared_ptr<const Occluder>>;

std::vector<Vec3> one_by_one(const std::vector<Handle>& handles, const MlsDeformationOptions& options,
                             const std::vector<Vec3>& x, const Cuts& cuts = {}) {
  const detail::DeformSetup setup = detail::set_up_deformation(handles, options);
  detail::NodesFrom nodes;
  std::vector<double> scratch;
  std::vector<Vec3> found;
  for (const Vec3& v : x) {
    std::vector<Detour> ways(cuts.empty() ? 0 : handles.size()), detours;
    for (std::size_t h = 0; h < ways.size(); ++h)
      detail::add_detours(cuts, handles[h].q, {&v, 1}, {&ways[h], 1}, detours);
    detail::gather_nodes(setup, cuts, ways, v, nodes);
    const Vec3 position = detail::fit_nodes(setup, nodes, v, false, scratch).position;
    found.push_back(nodes.held.value_or(position));
  }
  return found;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
  return most;
}

TEST(PointKernels, SayWhatOnePlaceAtATimeSays) {
  std::vector<Handle> handles = loose_handles(25);
  handles[3].weight = 4, handles[5].weight = 0.01;
  std::vector<Vec3> x = random_places(203, 5, 1.3);
  for (const Handle& h : handles) x.push_back(h.q), x.push_back(h.q + Vec3{1e-5, 0, 1e-7});
  for (const double alpha : {0.5, 0.9, 1.0, 1.5, 2.0, 3.0}) {
    for (const MlsDeformationOptions& options : all_kinds(alpha)) {
      SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(options.kind) << ", degree " << options.degree
                                      << ", alpha " << alpha);
      EXPECT_LT(largest_difference(mapped(MlsDeformation(handles, options), x), one_by_one(handles, options, x)),
                1e-10);
    }
  }
}

TEST(PointKernels, PowersOfWeightsAreThoseOfTheLibrary) {
  double most = 0;
  for (const double alpha : {0.5, 0.51, 0.9, 1.0, 1.25, 1.5, 1.7, 3.3, 7.75, 8.0})
    for (double base = 1; std::pow(base, alpha) > 1e-60; base *= 0.9371)
      most = std::max(most, std::abs(detail::weight_power(base, alpha) / std::pow(base, alpha) - 1));
  for (const double base :
       {0.5, 0.70710678118654746, 0.70710678118654757, 0.9999999999999999, 1.0, 1.0000001, 2.0, 1e100})
    most = std::max(most, std::abs(detail::weight_power(base, 1.1) / std::pow(base, 1.1) - 1));
  EXPECT_LT(most, 1e-13);
  EXPECT_EQ(detail::weight_power(1, 1.3), 1);
  EXPECT_EQ(detail::weight_power(0, 1.3), 0);
}

TEST(PointKernels, HeedCuts) {
  const Cuts cuts{half_plane({0.1, 0, 0}, {1, 0.2, 0}, {0, 0, -1}), half_plane({0, 0.3, 0.2}, {0, 1, 0}, {0, 0, 1})};
  const std::vector<Handle> handles = loose_handles(25);
  const std::vector<Vec3> x = random_places(150, 5, 1.3);
  for (MlsDeformationOptions options : all_kinds()) {
    options.damping = 2;
    const std::vector<Vec3> found = mapped(MlsDeformation(handles, options, cuts), x);
    EXPECT_LT(largest_difference(found, one_by_one(handles, options, x, cuts)), 1e-10);
    EXPECT_GT(largest_difference(found, one_by_one(handles, options, x)), 1e-3);
  }
}

TEST(PointKernels, AreAsGoodOnNearlyFlatHandles) {
  // The normal equations of affine maps lose twice the digits: polynomials take over where that is noticeable.
  for (const double thickness : {1e-1, 1e-2, 1e-3, 1e-5, 1e-7}) {
    std::vector<Handle> handles = loose_handles(12);
    for (Handle& h : handles) h.q.z *= thickness, h.p.z = h.q.z;
    std::vector<Vec3> x = random_places(64, 5);
    for (Vec3& v : x) v.z *= thickness;
    for (const DeformationKind kind : {DeformationKind::affine, DeformationKind::rigid}) {
      const auto options = of_kind(kind);
      EXPECT_LT(largest_difference(mapped(MlsDeformation(handles, options), x), one_by_one(handles, options, x)),
                1e-12 + 1e-15 / thickness)
          << thickness;
    }
  }
}

}  // namespace
}  // namespace sansmesh::test
