// Deformations with cuts, from handles to closed solids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <set>

#include "deform/cut_support.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/deform/cuts/mesh_occluder.h"
#include "sansmesh/deform/cuts/open_mesh.h"
#include "sansmesh/deform/maps/cut_map.h"
#include "sansmesh/deform/mls/mls_deformation.h"
#include "sansmesh/field/deformed_field.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::random_point;
using CutList = std::vector<std::shared_ptr<const Occluder>>;

/// Corners of a cube; those with x > 0 and z > 0 move up, those with x > 0 and z < 0 down.
std::vector<Handle> opening_handles(double by) {
  std::vector<Handle> handles;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        Handle h;
        h.p = h.q = {x, y, z};
        if (x > 0) h.q.z += z * by;
        handles.push_back(h);
      }
  return handles;
}

std::shared_ptr<const PlanarOccluder> slot() { return half_plane({-0.1, 0, 0}, {0, 0, 1}, {1, 0, 0}); }

MlsDeformationOptions damped() {
  MlsDeformationOptions options;
  options.damping = 4;
  return options;
}

struct MapAt {
  Vec3 position, gap_gradient;
  Jacobian jacobian;
  double gap = 0;
};
MapAt map_at(const SpaceMap& map, const Vec3& x) {
  MapAt found;
  map.map({&x, 1}, {{&found.position, 1}, {&found.jacobian, 1}, {&found.gap, 1}, {&found.gap_gradient, 1}});
  return found;
}

TEST(CutDeformation, HandlesStayExactAndSeveralCutsSumUp) {
  const std::vector<Handle> handles = opening_handles(0.4);
  const auto other = polygon_occluder({{{-2, 0.1, -2}, {2, 0.1, -2}, {2, 0.1, 2}, {-2, 0.1, 2}}});
  const MlsDeformation both(handles, damped(), {slot(), other});
  const MlsDeformation one(handles, damped(), {slot()}), two(handles, damped(), {other});
  for (const Handle& h : handles) EXPECT_LT(norm(map_at(both, h.q).position - h.p), 1e-12);
  std::mt19937 random(1);
  int differ = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random_point(random, 1.3);
    const MapAt found = map_at(both, x);
    // The deeper of the gaps that the common sources give for both cuts.
    const double depth = std::max(test::gap(*slot(), x, found.position, found.jacobian).depth,
                                  test::gap(*other, x, found.position, found.jacobian).depth);
    EXPECT_NEAR(found.gap, depth, 1e-9);
    differ +=
        norm(found.position - map_at(one, x).position) > 1e-3 && norm(found.position - map_at(two, x).position) > 1e-3;
  }
  EXPECT_GT(differ, 20);
}

TEST(CutDeformation, NothingMovesWhereHandlesDoNot) {
  const MlsDeformation still(opening_handles(0), damped(), {slot()});
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random_point(random, 1.5);
    const MapAt found = map_at(still, x);
    EXPECT_LT(norm(found.position - x), 1e-12);
    EXPECT_LE(found.gap, 1e-12);
  }
}

TEST(CutDeformation, SidesPartAndMeetAtTheEdge) {
  const MlsDeformation map(opening_handles(0.4), damped(), {slot()});
  const auto jump = [&](double x) {
    return norm(map_at(map, {x, 0, 1e-9}).position - map_at(map, {x, 0, -1e-9}).position);
  };
  EXPECT_GT(jump(0.8), 0.2);
  EXPECT_GT(jump(0.8), jump(0.3));
  EXPECT_LT(jump(-0.09), 0.05);
  EXPECT_LT(jump(-0.0999), 5e-4);  // vanishes towards the edge
  EXPECT_LT(jump(-0.2), 1e-7);
  // Continuous on a path around the edge, at steps of any size.
  for (const int steps : {1000, 20000}) {
    double most = 0;
    Vec3 before;
    for (int i = 0; i <= steps; ++i) {
      const double angle = 1e-3 + (2 * std::numbers::pi - 2e-3) * i / steps;
      const Vec3 now = map_at(map, {-0.1 + 0.5 * std::cos(angle), 0.1, 0.5 * std::sin(angle)}).position;
      if (i > 0) most = std::max(most, norm(now - before));
      before = now;
    }
    EXPECT_LT(most, 10.0 / steps);
  }
}

TEST(CutDeformation, JacobiansAndGapGradientsAreThoseOfDifferences) {
  const MlsDeformation map(opening_handles(0.4), damped(), {slot()});
  std::mt19937 random(3);
  int gaps = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = random_point(random, 0.9);
    if (std::abs(x.z) < 1e-3) continue;
    const MapAt found = map_at(map, x);
    gaps += found.gap > 0;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 step;
      step[k] = 1e-6;
      const MapAt ahead = map_at(map, x + step), behind = map_at(map, x - step);
      EXPECT_LT(norm(found.jacobian[k] - (ahead.position - behind.position) / 2e-6), 1e-5);
      EXPECT_NEAR(found.gap_gradient[k], (ahead.gap - behind.gap) / 2e-6, 1e-4);
    }
  }
  EXPECT_GT(gaps, 3);
}

TEST(CutDeformation, SolidsComeOutClosedWithSmoothFaces) {
  const Solid ball = csg::sphere({}, 0.9);
  for (const bool by_mesh : {false, true}) {
    CutList cuts{slot()};
    if (by_mesh) {  // the same half-plane, as far as the ball reaches
      TriangleMesh sheet;
      sheet.vertices = {{-0.1f, -1.5f, 0}, {1.6f, -1.5f, 0}, {1.6f, 1.5f, 0}, {-0.1f, 1.5f, 0}};
      sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
      MeshOccluderOptions options;
      options.resolution = 32;
      options.domain = Box3{{-1.5, -1.5, -1.5}, {1.6, 1.5, 1.5}};
      cuts = {mesh_occluder(sheet, options)};
    }
    const auto map = std::make_shared<const MlsDeformation>(opening_handles(0.4), damped(), cuts);
    const DeformedField field(std::make_shared<const Solid>(ball), map, Box3{{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}});
    CsgMeshOptions options;
    options.resolution = 32;
    options.simplify = 0;
    Progress progress;
    CsgMeshReport report;
    const TriangleMesh mesh = mesh_csg(field, options, progress, &report);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(measure_topology(mesh).closed());
    // Sources of face vertices are on the plane, or the vertices are.
    std::size_t on_faces = 0;
    double farthest = 0;
    for (const Vec3f& v : mesh.vertices) {
      const Vec3 x = mesh.origin + Vec3(v);
      const MapAt at = map_at(*map, x);
      if (norm(at.position) > 0.88 || at.position.x < 0) continue;
      ++on_faces;
      farthest = std::max(farthest, std::min(std::abs(x.z), std::abs(at.position.z)));
    }
    EXPECT_GT(on_faces, 60u);
    EXPECT_LT(farthest, 0.01);  // cells of 0.08
  }
}

TEST(CutDeformation, SegmentsAskFromFewPlaces) {
  class Counting final : public Occluder {
   public:
    void detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const override {
      points.insert({handle.x, handle.y, handle.z});
      inner->detours(handle, x, found);
    }
    void gaps(std::span<const Vec3> x, std::span<const Vec3> sources, std::span<const std::array<Vec3, 3>> jacobians,
              std::span<Gap> found) const override {
      inner->gaps(x, sources, jacobians, found);
    }
    void crossings(const Vec3& a, const Vec3& b, std::vector<double>& found) const override {
      inner->crossings(a, b, found);
    }
    void border_points(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& found) const override {
      inner->border_points(a, b, c, found);
    }
    std::shared_ptr<const Occluder> inner = slot();
    mutable std::set<std::array<double, 3>> points;
  };
  const auto cut = std::make_shared<const Counting>();
  std::vector<Handle> handles = opening_handles(0.4);
  handles[0].p_end = handles[0].q_end = Vec3{-1, 1, 1};
  const MlsDeformation map(handles, damped(), {cut});
  std::mt19937 random(4);
  for (int i = 0; i < 30; ++i) {
    const Vec3 x = random_point(random, 0.9);
    const MapAt found = map_at(map, x);
    EXPECT_TRUE(is_finite(found.position));
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 step;
      step[k] = 1e-6;
      EXPECT_LT(norm(found.jacobian[k] - (map_at(map, x + step).position - map_at(map, x - step).position) / 2e-6),
                1e-5);
    }
  }
  EXPECT_LE(cut->points.size(), 7u + 17u);  // bounded cache per handle
}

TEST(CutDeformation, MeshesOpenAndPart) {
  const TriangleMesh ball = test::octasphere(4);
  const CutList cuts{half_plane({-0.1, 0, 0.013}, {0, 0, 1}, {1, 0, 0})};
  const MlsDeformation forward(reversed(opening_handles(0.4)), damped(), cuts);
  OpenMeshOptions options;
  options.close = true;
  const TriangleMesh opened = open_along_cuts(ball, cuts, options);
  const TriangleMesh moved = deform_mesh(opened, forward);
  EXPECT_TRUE(measure_topology(moved).closed());
  ASSERT_EQ(moved.vertices.size(), opened.vertices.size());
  // Copies of a vertex move separately, those at the cut's border together.
  const std::vector<float>& sides = *opened.attributes.find<float>(kCutSide);
  double widest = 0;
  for (std::size_t v = 0; v < opened.vertices.size(); ++v) {
    if (sides[3 * v + 2] == 0 || opened.vertices[v].x < 0.5f) continue;
    const float up = moved.vertices[v].z - opened.vertices[v].z;
    EXPECT_GT(sides[3 * v + 2] > 0 ? up : -up, 0.05f);
    widest = std::max(widest, static_cast<double>(std::abs(up)));
  }
  EXPECT_GT(widest, 0.2);
  // Handles that do not move leave the mesh unchanged.
  const TriangleMesh still = deform_mesh(opened, MlsDeformation(reversed(opening_handles(0)), damped(), cuts));
  for (std::size_t v = 0; v < opened.vertices.size(); ++v)
    EXPECT_LT(norm(still.vertices[v] - opened.vertices[v]), 1e-6f);
}

TEST(CutMap, IsExactBesideCutsAndNearElsewhere) {
  const CutList cuts{slot()};
  const auto exact = std::make_shared<const MlsDeformation>(opening_handles(0.4), damped(), cuts);
  Progress progress;
  const Box3 box{{-1.2, -1.2, -1.6}, {1.2, 1.2, 1.6}};
  const CutMap map(exact, cuts, box, {33, 33, 44}, progress);
  EXPECT_GT(map.exact_share(), 0.02);
  EXPECT_LT(map.exact_share(), 0.12);
  EXPECT_TRUE(map.has_gaps());
  std::mt19937 random(6);
  std::vector<Vec3> x;
  for (int i = 0; i < 4000; ++i) {
    x.push_back(random_point(random, 0.9));
    if (i % 2) x.back().z *= 0.02;
  }
  const auto all = [&](const SpaceMap& of) {
    struct Found {
      std::vector<Vec3> positions, slopes;
      std::vector<Jacobian> jacobians;
      std::vector<double> gaps;
      bool operator==(const Found&) const = default;
    } found{std::vector<Vec3>(x.size()), std::vector<Vec3>(x.size()), std::vector<Jacobian>(x.size()),
            std::vector<double>(x.size())};
    of.map(x, {found.positions, found.jacobians, found.gaps, found.slopes});
    return found;
  };
  const auto right = all(*exact), found = all(map), plain = all(map.lattice());
  double most = 0, most_plain = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = norm(found.positions[i] - right.positions[i]);
    most_plain = std::max(most_plain, norm(plain.positions[i] - right.positions[i]));
    most = std::max(most, off);
    if (std::abs(x[i].z) < 0.03 && x[i].x > -0.1) {
      EXPECT_LT(off, 1e-12);
      EXPECT_EQ(found.gaps[i] > 0, right.gaps[i] > 0);
    }
  }
  EXPECT_LT(most, 0.02);
  EXPECT_GT(most_plain, 0.1);  // mixes both sides
  test::expect_equal_for_any_threads([&] { return all(map); });
  std::vector<Box3> boxes;
  for (const Vec3& p : x) boxes.push_back({p - Vec3{0.04, 0.03, 0.02}, p + Vec3{0.04, 0.03, 0.02}});
  std::vector<Box3> images(boxes.size());
  map.images(boxes, images);
  std::vector<Vec3> within;
  for (const Box3& b : boxes)
    for (int k = 0; k < 8; ++k) {
      const Vec3 at = random_point(random);
      within.push_back(b.center() + Vec3{0.04 * at.x, 0.03 * at.y, 0.02 * at.z});
    }
  std::vector<Vec3> mapped(within.size());
  map.map(within, {mapped, {}, {}, {}});
  for (std::size_t i = 0; i < mapped.size(); ++i) EXPECT_TRUE(images[i / 8].contains(mapped[i]));
}

TEST(CutMap, CutsNarrowerThanCellsCount) {
  const Box3 box{{-2, -2, -2}, {2, 2, 2}};
  Progress progress;
  std::vector<CutList> all;  // between lines of the lattice; small enough to fit in a cell; a mesh
  all.push_back({polygon_occluder({{{0.01, 0.02, -1.5}, {0.01, 0.1, -1.5}, {0.01, 0.1, 1.5}, {0.01, 0.02, 1.5}}})});
  all.push_back({polygon_occluder({{{0.05, 0.02, 0.02}, {0.06, 0.1, 0.03}, {0.055, 0.06, 0.1}}})});
  TriangleMesh strip;
  strip.vertices = {{0.01f, 0.02f, -1.5f}, {0.01f, 0.1f, -1.5f}, {0.01f, 0.1f, 1.5f}, {0.01f, 0.02f, 1.5f}};
  strip.triangles = {{0, 1, 2}, {0, 2, 3}};
  MeshOccluderOptions options;
  options.resolution = 16;
  all.push_back({mesh_occluder(strip, options)});
  const std::array<Box3, 3> where{Box3{{0, 0.02, -1.5}, {0.02, 0.1, 1.5}}, Box3{{0.05, 0.02, 0.02}, {0.06, 0.1, 0.1}},
                                  Box3{{0, 0.02, -1.5}, {0.02, 0.1, 1.5}}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(0, 1);
  for (std::size_t c = 0; c < all.size(); ++c) {
    const auto exact = std::make_shared<const MlsDeformation>(opening_handles(0.4), damped(), all[c]);
    const CutMap map(exact, all[c], box, {33, 33, 33}, progress);
    EXPECT_GT(map.exact_share(), 0) << c;
    EXPECT_LT(map.exact_share(), 0.03) << c;
    for (int i = 0; i < 200; ++i) {
      Vec3 x;
      for (std::size_t k = 0; k < 3; ++k)
        x[k] = where[c].lower[k] + (where[c].upper[k] - where[c].lower[k]) * in(random);
      ASSERT_EQ(map_at(map, x).position, map_at(*exact, x).position) << c;
    }
  }
}

TEST(CutMap, BeyondItsBoxNothingJumpsButAtCuts) {
  const CutList cuts{slot()};
  const auto exact = std::make_shared<const MlsDeformation>(opening_handles(0.4), damped(), cuts);
  Progress progress;
  // The cut is between nodes: cells next to it are exact, and the end of the box must not be noticeable.
  const CutMap map(exact, cuts, {{-0.6, -0.6, -0.61}, {0.6, 0.6, 0.59}}, {25, 25, 25}, progress);
  std::vector<Vec3> x;
  for (int i = 0; i <= 20000; ++i) x.push_back({0.3, 0.9, -0.5 + i * 5e-5});
  std::vector<Vec3> y(x.size());
  map.map(x, {y, {}, {}, {}});
  double most = 0;
  for (std::size_t i = 1; i < x.size(); ++i) most = std::max(most, norm(y[i] - y[i - 1]));
  EXPECT_LT(most, 0.002);
}

TEST(CutDeformation, JacobiansBesideMeshesAreThoseOfDifferences) {
  TriangleMesh sheet;  // bent along x = 0.5
  sheet.vertices = {{-0.1f, -0.8f, 0.01f}, {0.5f, -0.8f, 0.2f},  {0.5f, 0.8f, 0.2f},
                    {-0.1f, 0.8f, 0.01f},  {0.9f, -0.8f, 0.01f}, {0.9f, 0.8f, 0.01f}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  MeshOccluderOptions options;
  options.resolution = 16;
  options.domain = Box3{{-1, -1, -1}, {1, 1, 1}};
  const auto cut = mesh_occluder(sheet, options);
  const MlsDeformation map(opening_handles(0.4), damped(), {cut}), free(opening_handles(0.4), damped(), {});
  std::mt19937 random(9);
  int shadowed = 0, off = 0;
  for (int i = 0; i < 600; ++i) {
    const Vec3 x = random_point(random, 0.9);
    const MapAt found = map_at(map, x);
    if (norm(found.position - map_at(free, x).position) < 1e-3) continue;
    ++shadowed;
    bool differs = false;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 step;
      step[k] = 1e-6;
      if (test::blocked(*cut, x - step, x + step)) continue;
      const Vec3 slope = (map_at(map, x + step).position - map_at(map, x - step).position) / 2e-6;
      differs = differs || norm(found.jacobian[k] - slope) > 2e-3;
    }
    off += differs;  // detours have kinks at faces of cells
  }
  EXPECT_GT(shadowed, 100);
  EXPECT_LE(off, shadowed / 50);
}

TEST(CutDeformation, PlacesThatAreNotFiniteAreAnswered) {
  TriangleMesh sheet;
  sheet.vertices = {{0, -1, 0.01f}, {1, -1, 0.01f}, {1, 1, 0.01f}, {0, 1, 0.01f}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  MeshOccluderOptions options;
  options.resolution = 8;
  const auto cut = mesh_occluder(sheet, options);
  const double nan = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  for (const Vec3& x : {Vec3{nan, 0, 0}, Vec3{0, 0, nan}, Vec3{endless, 0, 0}, Vec3{0, -endless, 0}}) {
    const Detour found = test::detour(*cut, {0.1, 0.1, 0.5}, x);
    EXPECT_EQ(found.extra, 0);
    EXPECT_EQ(found.gradient, Vec3{});
    EXPECT_EQ(test::gap(*cut, x, {0, 0, 0}, {}).depth, -endless);
    EXPECT_EQ(test::gap(*cut, {0, 0, 0}, x, {}).depth, -endless);
    const MlsDeformation map(opening_handles(0.4), damped(), {cut, slot()});
    EXPECT_FALSE(is_finite(map_at(map, x).position));
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
