#include "sansmesh/measure/section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <string>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/clean_text.h"

namespace sansmesh::inline v1 {
namespace {

using std::numbers::pi;

/// Invariants of every section.
void expect_consistent(const Section& s) {
  double length = 0, area = 0;
  for (const SectionCurve& c : s.curves) {
    ASSERT_EQ(c.points.size(), c.plane.size());
    ASSERT_GE(c.points.size(), c.closed ? 3u : 2u);
    double along = 0;
    for (std::size_t i = 0; i < c.points.size(); ++i) {
      EXPECT_NEAR(s.plane.height(c.points[i]), 0, 1e-9);
      EXPECT_NEAR(norm(s.plane.at(c.plane[i][0], c.plane[i][1]) - c.points[i]), 0, 1e-9);
      if (i + 1 < c.points.size() || c.closed) along += norm(c.points[(i + 1) % c.points.size()] - c.points[i]);
    }
    EXPECT_NEAR(along, c.length, 1e-9 * (1 + along));
    EXPECT_TRUE(c.closed || c.area == 0);
    length += c.length, area += c.area;
  }
  EXPECT_NEAR(length, s.length, 1e-9 * (1 + length));
  EXPECT_NEAR(area, s.area, 1e-9 * (1 + length));
}

TEST(SectionMesh, SphereIsACircleCounterClockwise) {
  const TriangleMesh sphere = test::octasphere(5);
  for (const CutPlane& plane : {axis_plane(2, 0.3), axis_plane(0, -0.3), axis_plane(1, 0.3), cut_plane({1, 2, -2}, 0.9),
                                cut_plane({-3, 0.5, 1}, 0.3 * std::sqrt(10.25))}) {
    const Section s = section_mesh(sphere, plane);
    expect_consistent(s);
    ASSERT_EQ(s.curves.size(), 1u);
    EXPECT_TRUE(s.curves[0].closed);
    const double r2 = 1 - 0.09;
    EXPECT_NEAR(s.area, pi * r2, 2e-3 * pi);
    EXPECT_NEAR(s.length, 2 * pi * std::sqrt(r2), 2e-3 * 2 * pi);
    EXPECT_LT(s.area, pi * r2);
  }
  EXPECT_TRUE(section_mesh(sphere, axis_plane(2, 1.5)).curves.empty());
}

TEST(SectionMesh, HolesAreClockwise) {
  const TriangleMesh torus = test::torus_mesh(200, 100);
  const Section flat = section_mesh(torus, axis_plane(2, 0.01));
  expect_consistent(flat);
  ASSERT_EQ(flat.curves.size(), 2u);
  EXPECT_LT(std::min(flat.curves[0].area, flat.curves[1].area), 0);
  const double half = std::sqrt(0.35 * 0.35 - 1e-4);
  EXPECT_NEAR(flat.area, 4 * pi * half, 5e-3);
  const Section across = section_mesh(torus, axis_plane(0, 0.003));
  ASSERT_EQ(across.curves.size(), 2u);
  for (const SectionCurve& c : across.curves) EXPECT_NEAR(c.area, pi * 0.35 * 0.35, 2e-3);
  EXPECT_NEAR(section_mesh(test::turned_inside_out(torus), axis_plane(2, 0.01)).area, -flat.area, 1e-12);
}

TEST(SectionMesh, VerticesEdgesAndFacesInThePlane) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {2, 3, 1});
  // The top face is in the plane, with the solid below: it is the section. With the opposite normal the solid is above,
  // and the section is empty.
  const Section top = section_mesh(box, axis_plane(2, 1));
  expect_consistent(top);
  ASSERT_EQ(top.curves.size(), 1u);
  EXPECT_TRUE(top.closed());
  EXPECT_DOUBLE_EQ(top.area, 6);
  EXPECT_DOUBLE_EQ(top.length, 10);
  EXPECT_TRUE(section_mesh(box, axis_plane(2, 0)).curves.empty());
  // With the opposite normal the solid is below the lower face.
  EXPECT_DOUBLE_EQ(section_mesh(box, cut_plane({0, 0, -1}, 0)).area, 6);
  // Through two opposite edges.
  const Section diagonal = section_mesh(box, cut_plane({3, -2, 0}, 0));
  expect_consistent(diagonal);
  EXPECT_TRUE(diagonal.closed());
  EXPECT_NEAR(diagonal.area, std::sqrt(13.0), 1e-12);
  // Through a ring of vertices and edges.
  const Section equator = section_mesh(test::octasphere(4), axis_plane(2, 0));
  expect_consistent(equator);
  ASSERT_EQ(equator.curves.size(), 1u);
  EXPECT_TRUE(equator.closed());
  EXPECT_EQ(equator.curves[0].points.size(), 64u);
  // A single vertex.
  EXPECT_TRUE(section_mesh(test::octasphere(2), axis_plane(2, 1)).curves.empty());
}

TEST(SectionMesh, ClosedMeshesGiveClosedCurves) {
  // Integer coordinates, so that planes often meet vertices, edges and faces exactly.
  TriangleMesh mesh = test::joined(test::box_mesh({0, 0, 0}, {4, 4, 4}),
                                   test::turned_inside_out(test::box_mesh({1, 1, 1}, {3, 3, 3})), {});
  mesh = test::joined(mesh, test::scaled(test::octasphere(0), 2), {8, 2, 2});
  mesh = test::joined(mesh, test::box_mesh({4, 0, 0}, {6, 4, 4}), {});  // shares a face with the first
  std::mt19937 random(7);
  std::uniform_int_distribution<int> small(-3, 3);
  int cuts = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 n{double(small(random)), double(small(random)), double(small(random))};
    if (squared_norm(n) == 0) continue;
    const Vec3 through{double(small(random) + 3), double(small(random) + 3), double(small(random) + 3)};
    const Section s = section_mesh(mesh, cut_plane(n, dot(n, through)));
    cuts += !s.curves.empty();
    ASSERT_TRUE(s.closed()) << equation(s.plane);
    expect_consistent(s);
    ASSERT_GE(s.area, -1e-12) << equation(s.plane);
  }
  EXPECT_GT(cuts, 1000);
}

TEST(SectionMesh, VolumeIsTheIntegralOfTheSections) {
  const TriangleMesh torus = test::torus_mesh(120, 60);
  for (int axis = 0; axis < 3; ++axis) {
    const double from = -1.4, step = 2.8 / 400;
    double volume = 0;
    for (const CutPlane& plane : plane_series(axis, from + 0.5 * step, step, 400))
      volume += step * section_mesh(torus, plane).area;
    double truth = 0;
    for (const Triangle& t : torus.triangles)
      truth += dot(Vec3(torus.vertices[t[0]]), cross(Vec3(torus.vertices[t[1]]), Vec3(torus.vertices[t[2]]))) / 6;
    EXPECT_NEAR(volume, truth, 2e-3 * truth) << axis;
  }
}

TEST(SectionMesh, OpenMeshesGiveOpenCurves) {
  TriangleMesh half = test::octasphere(4);
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return std::min({half.vertices[t[0]].x, half.vertices[t[1]].x, half.vertices[t[2]].x}) < -1e-6f;
  });
  const Section s = section_mesh(half, axis_plane(2, 0.301));
  expect_consistent(s);
  ASSERT_EQ(s.curves.size(), 1u);
  EXPECT_FALSE(s.closed());
  EXPECT_NEAR(s.length, pi * std::sqrt(1 - 0.301 * 0.301), 0.01);
  EXPECT_EQ(s.area, 0);
  // From −y to +y around +x: the solid is on the left.
  EXPECT_LT(s.curves[0].points.front().y, 0);
  EXPECT_GT(s.curves[0].points.back().y, 0);
}

TEST(SectionMesh, SoupsAndMixedOrientationsAreChained) {
  const TriangleMesh sphere = test::octasphere(3);
  TriangleMesh soup;
  for (const Triangle& t : sphere.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(sphere.vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  for (Vec3f& v : soup.vertices)
    if (v.z == 0) v.z = -0.0f;
  const Section whole = section_mesh(sphere, axis_plane(2, 0.2));
  const Section s = section_mesh(soup, axis_plane(2, 0.2));
  EXPECT_EQ(s.curves.size(), 1u);
  EXPECT_TRUE(s.closed());
  EXPECT_NEAR(s.area, whole.area, 1e-12);
  for (std::size_t i = 0; i < soup.triangles.size(); i += 3) std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  const Section mixed = section_mesh(soup, axis_plane(2, 0.2));
  EXPECT_EQ(mixed.curves.size(), 1u);
  EXPECT_TRUE(mixed.closed());
  EXPECT_NEAR(mixed.area, whole.area, 1e-12);
}

TEST(SectionMesh, FarOriginsAndBadVertices) {
  TriangleMesh sphere = test::octasphere(5);
  const double area = section_mesh(sphere, axis_plane(2, 0.3)).area;
  sphere.origin = {500000, 4000000, 120};
  sphere.vertices.push_back({NAN, 0, 0});
  sphere.triangles.push_back({0, 1, static_cast<std::uint32_t>(sphere.vertices.size() - 1)});
  sphere.triangles.push_back({0, 1, 999999});
  const Section s = section_mesh(sphere, axis_plane(2, 120.3));
  ASSERT_EQ(s.curves.size(), 1u);
  EXPECT_TRUE(s.closed());
  EXPECT_NEAR(s.area, area, 1e-7);
  EXPECT_NEAR(s.curves[0].points[0].x, 500000, 1.1);
  EXPECT_TRUE(section_mesh({}, axis_plane(0, 0)).curves.empty());
}

TEST(SectionMesh, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh torus = test::torus_mesh(400, 200);
  Progress progress;
  const std::vector<CutPlane> planes = plane_series(1, -1, 0.13, 16);
  test::compare_threads([&] { return section_mesh(torus, planes, progress); },
                        [](const auto& one, const auto& many) {
                          ASSERT_EQ(one.size(), 16u);
                          for (std::size_t i = 0; i < one.size(); ++i) {
                            ASSERT_EQ(one[i].curves.size(), many[i].curves.size());
                            for (std::size_t c = 0; c < one[i].curves.size(); ++c)
                              EXPECT_EQ(one[i].curves[c].plane, many[i].curves[c].plane);
                          }
                        });
}

TEST(CutPlane, FramesAreRightHanded) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const CutPlane p = i < 3 ? axis_plane(i, 0.7) : cut_plane({normal(random), normal(random), normal(random)}, 2);
    EXPECT_NEAR(norm(p.normal), 1, 1e-12);
    EXPECT_NEAR(norm(cross(p.u, p.v) - p.normal), 0, 1e-12);
    EXPECT_NEAR(p.height(p.at(3, -2)), 0, 1e-12);
  }
  EXPECT_EQ(axis_plane(2, 1).u, (Vec3{1, 0, 0}));
  EXPECT_EQ(axis_plane(0, 1).u, (Vec3{0, 1, 0}));
  EXPECT_EQ(axis_plane(1, 1).u, (Vec3{0, 0, 1}));
  const CutPlane scaled = cut_plane({0, 0, 1e200}, 3e200);
  EXPECT_NEAR(scaled.offset, 3, 1e-12);
}

TEST(CutPlane, TextIsReadAndWritten) {
  EXPECT_EQ(equation(parse_plane("z=0.5")), "z = 0.5");
  EXPECT_EQ(equation(parse_plane("X = -2e3")), "x = -2000");
  EXPECT_EQ(equation(parse_plane("3, 0, -4, 10")), "0.6 x - 0.8 z = 2");
  EXPECT_EQ(equation(parse_plane("0,0,-2,1")), "-z = 0.5");
  for (const char* bad : {"", "z", "w=1", "z=", "z=1e", "z=nan", "zz=1", "1,2,3", "1,2,3,4,5", "0,0,0,1", "1,,2,3",
                          "1,2,3,inf", "a,b,c,d", "=1"})
    EXPECT_THROW(parse_plane(bad), ArgumentError) << bad;
  EXPECT_THROW(plane_series(2, 0, 0, 2), ArgumentError);
  EXPECT_THROW(plane_series(3, 0, 1, 2), ArgumentError);
  EXPECT_THROW(plane_series(0, 0, 1, 0), ArgumentError);
  EXPECT_THROW(middle_planes({}), ArgumentError);
  const auto spread = spread_planes({{0, 0, 0}, {1, 1, 10}}, 2, 4);
  ASSERT_EQ(spread.size(), 4u);
  EXPECT_DOUBLE_EQ(spread[0].offset, 2);
  EXPECT_DOUBLE_EQ(spread[3].offset, 8);
}

TEST(CutPlane, MessagesQuoteAnythingInOnePrintableLine) {
  try {
    parse_plane("z=\x05\n\xff" + std::string(10000, 'x'));
    FAIL();
  } catch (const ArgumentError& error) {
    EXPECT_TRUE(test::is_clean(error.what()));
    EXPECT_LT(std::string(error.what()).size(), 1000u);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
