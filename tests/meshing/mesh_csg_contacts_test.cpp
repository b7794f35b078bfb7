// Solids whose sheets or faces are close together, touch or coincide: closed meshes with the volumes of closed
// formulas.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "meshing/csg_meshes.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace csg;
using namespace test;

/// Where balls touch, nearly touch or cross at small angles, simplified sheets may cross: only a small part remains
/// unsimplified, and the rest has as few triangles as elsewhere.
TEST(MeshCsg, BallsThatNearlyTouchAreSimplified) {
  SANSMESH_NOT_SANITIZED("judges meshes; others simplify, too");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> radius(0.1, 0.2), digits(-5, -2), direction(-1, 1);
  std::vector<Solid> balls;
  double volume = 0, area = 0;
  std::size_t components = 0;
  constexpr int kSide = 3;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const double r = radius(random), s = radius(random), gap = std::pow(10, digits(random)) * (i % 2 ? 1 : -1);
    const double d = r + s + gap;
    const int column = i % kSide, row = i / kSide % kSide, layer = i / (kSide * kSide);
    const Vec3 center = Vec3{column * 0.9, row * 0.9, layer * 0.9};
    const Vec3 to = normalized(Vec3{direction(random), direction(random), direction(random)});
    balls.push_back(sphere(center, r));
    balls.push_back(sphere(center + to * d, s));
    volume += 4 * kPi / 3 * (r * r * r + s * s * s), area += 4 * kPi * (r * r + s * s);
    components += gap > 0 ? 2 : 1;
    if (gap > 0) continue;
    const double of_r = r - (d * d + r * r - s * s) / (2 * d), of_s = s - (d * d + s * s - r * r) / (2 * d);
    volume -= kPi * (of_r * of_r * (r - of_r / 3) + of_s * of_s * (s - of_s / 3));
    area -= 2 * kPi * (r * of_r + s * of_s);
  }
  Solid all = balls[0];
  for (std::size_t k = 1; k < balls.size(); ++k) all = unite(all, balls[k]);
  CsgMeshReport report;
  const TriangleMesh mesh = meshed(all, {}, report);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.components, components);
  EXPECT_TRUE(report.notes.empty());
  EXPECT_NEAR(report.volume / volume, 1, 1e-3);
  EXPECT_NEAR(report.area / area, 1, 1e-3);
  EXPECT_TRUE(self_intersections(mesh, 1e-7 * report.box.diagonal()).empty());
  EXPECT_LT(mesh.triangles.size(), 6000 * balls.size());
}

TEST(MeshCsg, WallsThatFloatsCannotHoldAreAnError) {
  CsgMeshReport report;
  for (const char* text : {"shell(box(1), 1e-9)", "shell(sphere(1), 1e-8)"})
    EXPECT_THROW(meshed(parsed(text), {}, report), DataError) << text;
}

/// Two sheets in one simplex are two planes in it, however close they are.
TEST(MeshCsg, WallsOfAnyThickness) {
  SANSMESH_NOT_SANITIZED("judges sizes; others mesh thin walls");
  struct Case {
    const char* text;
    double volume, area;
    std::size_t components;
    long genus;
    double tolerance;
  };
  const double r = 0.999, shifted = ball_volume(1) - ball_volume(r);
  for (const Case& c :
       {Case{"shell(sphere(1), 0.01, side=inside)", ball_volume(1) - ball_volume(0.99), 4 * kPi * 1.9801, 2, 0, 3e-3},
        Case{"shell(sphere(1), 0.005, side=inside)", ball_volume(1) - ball_volume(0.995), 4 * kPi * 1.990025, 2, 0,
             3e-3},
        Case{"shell(sphere(1), 0.0001, side=inside)", ball_volume(1) - ball_volume(0.9999), 4 * kPi * 1.9998, 2, 0,
             3e-3},
        Case{"shell(sphere(1), 0.000001, side=inside)", 4 * kPi * 1e-6, 8 * kPi, 2, 0, 3e-3},
        Case{"box(2) - box(1.99)", 8 - 1.99 * 1.99 * 1.99, 24 + 6 * 1.99 * 1.99, 2, 0, 1e-5},
        Case{"box(2) - box(1.9999)", 8 - 1.9999 * 1.9999 * 1.9999, 24 + 6 * 1.9999 * 1.9999, 2, 0, 3e-3},
        Case{"box((2,2,0.004)) - cylinder(r=0.5)", 0.004 * (4 - kPi / 4), 2 * (4 - kPi / 4) + 0.004 * (8 + kPi), 1, 1,
             3e-3},
        Case{"shell(torus(R=1, r=0.3), 0.002)", 4 * kPi * kPi * 0.3 * 0.002, 8 * kPi * kPi * 0.3, 2, 2, 6e-3},
        Case{"shell(cylinder(r=0.5, h=1), 0.001)", 0, 3 * kPi, 2, 0, 3e-3},
        Case{"rotate(box(2) - box(1.999), 33, axis=(1,2,3))", 8 - 1.999 * 1.999 * 1.999, 24 + 6 * 1.999 * 1.999, 2, 0,
             3e-3},
        Case{"sphere(1) - sphere(0.999, center=(0.0005,0,0))", shifted, 4 * kPi * (1 + r * r), 2, 0, 3e-3},
        Case{"box(1) | translate(box(1), (1.0001,0,0))", 2, 12, 2, 0, 1e-6},
        Case{"box(1) & plane(z) & plane((0.00174533,0,-1))", 0.5 * 0.25 * 0.00174533, 0, 1, 0, 3e-3},
        Case{"box(2) - sphere(0.9999)", 8 - ball_volume(0.9999), 24 + 4 * kPi, 2, 0, 3e-3},
        Case{"difference(shell(sphere(1), 0.01), cylinder(r=0.3), r=0.02)", 0, 0, 1, 1, 1}}) {
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(parsed(c.text), {.mesh_error = 3e-4}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_EQ(report.components, c.components) << c.text;
    EXPECT_EQ(measure_topology(mesh).genus(), std::optional<long>(c.genus)) << c.text;
    if (c.volume > 0) {
      EXPECT_NEAR(report.volume / c.volume, 1, c.tolerance) << c.text;
    }
    if (c.area > 0) {
      EXPECT_NEAR(report.area / c.area, 1, c.tolerance) << c.text;
    }
    EXPECT_LE(mesh.triangles.size(), 100'000u) << c.text;
  }
}

/// Coincident faces are one, in either orientation.
TEST(MeshCsg, FacesThatCoincide) {
  struct Case {
    const char* text;
    double volume;
    std::size_t components;
    long genus;
  };
  for (const Case& c : {Case{"box(1) | translate(box(1), (1,0,0))", 2, 1, 0},
                        Case{"rotate(box(1) | translate(box(1), (1,0,0)), 33, axis=(1,2,3))", 2, 1, 0},
                        Case{"box(2) - cylinder(r=0.5, h=2)", 8 - kPi / 2, 1, 1},
                        Case{"rotate(box(2) - cylinder(r=0.5, h=2), 33, axis=(1,2,3))", 8 - kPi / 2, 1, 1},
                        Case{"rotate(box(2) - box(from=(0,-2,-2), to=(2,2,2)), 10, axis=(1,2,3))", 4, 1, 0}}) {
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(parsed(c.text), {}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_EQ(report.components, c.components) << c.text;
    EXPECT_EQ(measure_topology(mesh).genus(), std::optional<long>(c.genus)) << c.text;
    EXPECT_NEAR(report.volume / c.volume, 1, 1e-4) << c.text;
  }
  CsgMeshReport report;
  EXPECT_THROW(meshed(parsed("box(1) - box(1)"), {}, report), DataError);
  EXPECT_THROW(meshed(parsed("rotate(box(1), 20, axis=(1,1,0)) & rotate(translate(box(1), (1,0,0)), 20, axis=(1,1,0))"),
                      {}, report),
               DataError);
}

/// Touching parts are joined anywhere in the expression: in a clipped union, or in a cut part of one.
TEST(MeshCsg, TouchingPartsOfParts) {
  struct Case {
    const char* solid;
    double area, volume;
    std::size_t components;
  };
  const char* const l = "(box(1)+translate(box(1),1,0.25,0))";
  for (const Case& c : {Case{"{} & box(6)", 10.5, 2, 1}, Case{"{} & sphere(3)", 10.5, 2, 1},
                        Case{"{} - box(0.5)", 12, 1.875, 2}, Case{"(box(2) - box(1) | box(1)) & sphere(5)", 24, 8, 1},
                        Case{"(({} & box(6)) + translate(box(1),2,0.25,0)) & box(9)", 14.5, 3, 1},
                        Case{"box(6) - (box(4) - {})", 6 * 36 + 6 * 16 + 10.5, 216 - 64 + 2, 3}}) {
    const std::string text = fmt::format(fmt::runtime(c.solid), l);
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(parsed(text), {}, report);
    EXPECT_TRUE(report.closed) << text;
    EXPECT_EQ(report.components, c.components) << text;
    EXPECT_NEAR(report.volume, c.volume, 5e-5) << text;
    EXPECT_NEAR(report.area, c.area, 3e-4) << text;
    EXPECT_LE(mesh.triangles.size(), 500u) << text;
  }
}

/// Parts that are flat in many places only are no planes: a large rounded box beside a small one with a face in its
/// plane.
TEST(MeshCsg, RoundedBoxesAreNotTheirFaces) {
  const std::string rounded = "box(from=(-20,-0.9,-20),to=(20,20,-0.5),r=0.3)";
  CsgMeshReport alone, beside;
  meshed(parsed("box(2) - " + rounded), {}, alone);
  meshed(parsed("box(2) - box(from=(0.5,0.5,-2),to=(0.9,0.9,-0.5)) - " + rounded), {}, beside);
  // The cube minus a slab of half the height except for a strip of .1, and the corner of a square removed by its
  // rounding.
  const double left = 8 - 2 * 0.5 * 1.9 + 2 * (1 - kPi / 4) * 0.3 * 0.3;
  EXPECT_NEAR(alone.volume, left, 1e-4);
  EXPECT_NEAR(beside.volume, left, 1e-4);
}

/// Any number of faces in one plane are one: a star of 80 points, of 20 boxes rotated about an axis.
TEST(MeshCsg, ManyFacesInOnePlane) {
  std::string boxes;
  for (int k = 0; k < 20; ++k) boxes += fmt::format("{}rotate(box(2),{},axis=z)", k ? "+" : "", 4.5 * k);
  // From the centre: 160 triangles between a point of the star, an adjacent notch and the axis.
  const double half = kPi / 80, point = std::sqrt(2.0), notch = 1 / std::cos(kPi / 4 - half);
  const double volume = 2 * 160 * 0.5 * point * notch * std::sin(half);
  for (const std::string& text : {boxes, fmt::format("rotate({},33,axis=(1,2,3))", boxes)}) {
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(parsed(text), {}, report);
    EXPECT_TRUE(report.closed) << text;
    EXPECT_EQ(report.components, 1u) << text;
    EXPECT_NEAR(report.volume / volume, 1, 1e-6) << text;
    EXPECT_LE(report.largest_error, 1e-7) << text;
    EXPECT_LE(report.blocks, 100'000u) << text;
    EXPECT_LE(mesh.triangles.size(), 5'000u) << text;
  }
}

std::string pyramid(int sides) {
  std::string text;
  for (int k = 0; k < sides; ++k)
    text += fmt::format("plane(normal=({},{},1), through=(0,0,1)) & ", std::cos(2 * kPi * k / sides),
                        std::sin(2 * kPi * k / sides));
  return text + "box(from=(-2,-2,0), to=(2,2,2))";
}

/// A hundred faces meet in the tip of a pyramid, forty in an edge shared by rotated boxes.
TEST(MeshCsg, ManyFacesInOnePlace) {
  std::string fan;
  for (int k = 0; k < 20; ++k)
    fan += fmt::format("{}rotate(box(from=(0,0,0),to=(1,1,1)),{},axis=z)", k ? "+" : "", 4.5 * k);
  // The fan: half of the first and last squares, and 38 triangles in between as for the star above.
  const double half = kPi / 80, point = std::sqrt(2.0), notch = 1 / std::cos(kPi / 4 - half);
  struct Case {
    std::string text;
    double volume;
  };
  for (const Case& c :
       {Case{pyramid(100), 100 * std::tan(kPi / 100) / 3}, Case{fan, 1 + 38 * 0.5 * point * notch * std::sin(half)}}) {
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(parsed(c.text), {}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_EQ(report.components, 1u) << c.text;
    EXPECT_NEAR(report.volume / c.volume, 1, 1e-5) << c.text;
    EXPECT_LE(report.blocks, 100'000u) << c.text;
  }
  // Adjacent faces of a prism with many sides do not separate: its blocks are no smaller than for few sides.
  std::string prism = "box(4)";
  for (int k = 0; k < 200; ++k)
    prism +=
        fmt::format(" & plane(normal=({},{},0), offset=1)", std::cos(2 * kPi * k / 200), std::sin(2 * kPi * k / 200));
  CsgMeshReport report;
  meshed(parsed(prism), {}, report);
  EXPECT_NEAR(report.volume / (4 * 200 * std::tan(kPi / 200)), 1, 1e-6);
  EXPECT_LE(report.blocks, 20'000u);
  try {
    meshed(parsed(pyramid(300)), {}, report);
    FAIL() << "300 faces are too many";
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("more than 251 faces meet at one point"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
