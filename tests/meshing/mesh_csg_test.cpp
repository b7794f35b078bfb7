// Solids to meshes: closed, with the volumes that formulas say.
#include "sansmesh/meshing/mesh_csg.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "csg/catalogue.h"
#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/mesh_checks.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace csg;
constexpr double kPi = std::numbers::pi;

Solid parsed(const std::string& text) {
  return parse_csg(text, [](const std::string& name) -> Solid { throw FileError(name, "not here"); });
}

TriangleMesh meshed(const Solid& solid, const CsgMeshOptions& options, CsgMeshReport& report) {
  Progress progress;
  return mesh_csg(solid, options, progress, &report);
}

/// Largest distance of vertices from the surface.
double largest_value(const Solid& solid, const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3f& v : mesh.vertices)
    largest = std::max(largest, std::abs(test::value_at(solid, mesh.origin + Vec3(v))));
  return largest;
}

struct Known {
  const char* text;
  double volume, area;
  long components, genus;
};

const Known kKnown[] = {
    {"sphere(1)", 4 * kPi / 3, 4 * kPi, 1, 0},
    {"box(2, 1, 1.5)", 3, 13, 1, 0},
    {"rotate(box(2, 1, 1.5), 33, axis=(1,2,3))", 3, 13, 1, 0},
    {"cylinder(r=0.5, h=2)", kPi / 2, 2.5 * kPi, 1, 0},
    {"cone(r=0.5, h=1)", kPi / 12, kPi / 4 + kPi * 0.5 * std::sqrt(1.25), 1, 0},
    {"torus(R=1, r=0.3)", 2 * kPi* kPi * 0.09, 4 * kPi* kPi * 0.3, 1, 1},
    {"capsule(r=0.3, from=(0,0,0), to=(1,0.5,0))", kPi*(0.09 * std::sqrt(1.25) + 0.036),
     2 * kPi * 0.3 * std::sqrt(1.25) + 4 * kPi * 0.09, 1, 0},
    {"sphere(1) - plane(normal=(1,2,3), offset=-0.4)", 4 * kPi / 3 - kPi * 0.36 * 2.4 / 3,
     4 * kPi - 2 * kPi * 0.6 + kPi * 0.84, 1, 0},
    {"sphere(1) & sphere(1, center=(0,0.9,0))", kPi * 4.9 * 1.21 / 12, 4 * kPi * 0.55, 1, 0},
    {"cylinder(r=0.8, axis=x) & cylinder(r=0.8, axis=z)", 16.0 / 3 * 0.512, 16 * 0.64, 1, 0},
    {"box(2) - cylinder(r=0.5)", 8 - kPi / 2, 24 - kPi / 2 + 2 * kPi, 1, 1},
    {"shell(sphere(1), 0.2, inside) - plane(z, offset=-2)", 4 * kPi / 3 * 0.488, 4 * kPi * 1.64, 2, 0},
    {"box(1) | box(1, center=(3,0,0))", 2, 12, 2, 0},
    {"box(3) - box(1, 1, 4) - box(1, 4, 1) - box(4, 1, 1)", 20, 72, 1, 5},
};

TEST(MeshCsg, KnownSolids) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others mesh the same solids");
  for (const Known& k : kKnown) {
    const Solid solid = parsed(k.text);
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(solid, {.resolution = 48}, report);
    EXPECT_TRUE(report.closed) << k.text;
    EXPECT_TRUE(test::topology_of(mesh).closed_manifold()) << k.text;
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(static_cast<long>(report.components), k.components) << k.text;
    EXPECT_EQ(topology.genus(), std::optional<long>(k.genus)) << k.text;
    EXPECT_NEAR(report.volume / k.volume, 1, 2e-4) << k.text;
    EXPECT_NEAR(report.area / k.area, 1, 1e-3) << k.text;
    EXPECT_LT(largest_value(solid, mesh), 0.2 * report.cell) << k.text;
  }
}

TEST(MeshCsg, FlatSolidsAreExact) {
  for (const char* text : {"box(2, 1, 1.5)", "rotate(box(2, 1, 1.5), 33, axis=(1,2,3))",
                           "box(3) - box(1, 1, 4) - box(1, 4, 1) - box(4, 1, 1)", "shell(box(1), 0.2)"}) {
    const Solid solid = parsed(text);
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(solid, {.resolution = 32}, report);
    EXPECT_LT(largest_value(solid, mesh), 1e-5) << text;
  }
}

/// Parts that touch in faces, edges and points, and faces that coincide.
TEST(MeshCsg, TouchingParts) {
  const struct {
    const char* text;
    double volume, area;
  } known[] = {
      {"box(1) | translate(box(1), (1,0,0))", 2, 10},
      {"box(1) | translate(box(1), (1,1,0))", 2, 12},
      {"box(1) - translate(box(1), (1,0,0))", 1, 6},
      {"box(1) & translate(box(1), (0,0,0))", 1, 6},
      {"box(1) | translate(box(1), (0,0,0))", 1, 6},
      {"box(2) - translate(box(1), (0.5,0,0))", 7, 28},
      {"box(2) - box(1, center=(0.5,0.5,0.5))", 7, 24},
      {"box(2) - cylinder(r=0.5, h=2)", 8 - kPi / 2, 24 - kPi / 2 + 2 * kPi},
      {"box(2) | cylinder(r=1, h=2)", 8, 24},
      {"sphere(1) | sphere(1, center=(2,0,0))", 8 * kPi / 3, 8 * kPi},
      {"sphere(1) - sphere(1, center=(2,0,0))", 4 * kPi / 3, 4 * kPi},
  };
  for (const auto& k : known) {
    CsgMeshReport report;
    const TriangleMesh mesh = meshed(parsed(k.text), {.resolution = 40}, report);
    EXPECT_TRUE(report.closed) << k.text;
    EXPECT_NEAR(report.volume / k.volume, 1, 2e-3) << k.text;
    EXPECT_NEAR(report.area / k.area, 1, 1e-2) << k.text;
  }
  for (const char* nothing : {"box(1) - box(1)", "box(1) - translate(box(1), (0,0,0))",
                              "box(1) & translate(box(1), (1,0,0))", "sphere(1) & sphere(1, center=(5,0,0))"}) {
    CsgMeshReport report;
    EXPECT_THROW(meshed(parsed(nothing), {.resolution = 40}, report), DataError) << nothing;
  }
}

TEST(MeshCsg, BoxesFollowTheSolidThatIsLeft) {
  CsgMeshReport report;
  meshed(parsed("box(from=(0,0,0), to=(10,1,1)) - box(from=(1,-1,-1), to=(11,2,2))"), {}, report);
  // What is left is a cube of edge 1, found on a grid of 32 blocks along the 10 of the whole: at most one too far.
  EXPECT_LE(report.box.upper.x, 1 + 10.0 / 32);
  EXPECT_NEAR(report.volume, 1, 1e-6);
  meshed(parsed("sphere(1)"), {.resolution = 32}, report);
  EXPECT_NEAR(report.cell, 2.0 / 32, 1e-9);
}

TEST(MeshCsg, FinerIsBetter) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others mesh solids, too");
  double before = 1;
  for (const int resolution : {16, 32, 64}) {
    CsgMeshReport report;
    meshed(parsed("sphere(1) - cylinder(r=0.4)"), {.resolution = resolution}, report);
    const double error = std::abs(report.volume / (4 * kPi / 3 * std::pow(1 - 0.16, 1.5)) - 1);
    EXPECT_LT(error, before / 2);
    before = error;
  }
}

TEST(MeshCsg, BlendsAreClosed) {
  for (const char* text :
       {"union(box(1), cylinder(r=0.2, h=2), r=0.2)", "difference(box(2), sphere(0.8, center=(1,1,1)), r=0.3)",
        "union(torus(R=1, r=0.2), box(0.4, 3, 0.3), r=0.15)", "offset(union(box(1), sphere(0.6), r=0.1), 0.05)"}) {
    CsgMeshReport report;
    const Solid solid = parsed(text);
    const TriangleMesh mesh = meshed(solid, {.resolution = 48}, report);
    EXPECT_TRUE(report.closed) << text;
    EXPECT_EQ(report.components, 1u) << text;
    EXPECT_LT(largest_value(solid, mesh), 0.2 * report.cell) << text;
  }
}

TEST(MeshCsg, FieldsOfOthers) {
  CsgMeshReport report;
  const Solid solid = subtract(leaf(std::make_shared<test::QuadricField>()), cylinder({}, {1, 0, 0}, 0.2));
  meshed(solid, {.cell = 0.04}, report);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.components, 1u);
  EXPECT_LT(report.volume, 4 * kPi / 3 / std::sqrt(3));
  // A field whose pieces are known, but which is no Solid.
  class Wedge final : public PiecewiseField {
   public:
    Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
    std::uint32_t pieces() const override { return 2; }
    void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override {
      for (std::size_t i = 0; i < x.size(); ++i) piece[i] = x[i].y > 0;
    }
    void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
      for (std::size_t i = 0; i < x.size(); ++i)
        evaluate_piece(x[i].y > 0, x.subspan(i, 1), values.subspan(i, 1),
                       gradients.empty() ? gradients : gradients.subspan(i, 1));
    }
    void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                        std::span<Vec3> gradients) const override {
      const Vec3 n = piece == 0 ? Vec3{0.6, -0.8, 0} : Vec3{0.6, 0.8, 0};
      for (std::size_t i = 0; i < x.size(); ++i) {
        values[i] = dot(n, x[i]);
        if (!gradients.empty()) gradients[i] = n;
      }
    }
  };
  Progress progress;
  mesh_csg(Wedge(), {.resolution = 24, .box = Box3{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}}, progress, &report);
  EXPECT_TRUE(report.closed);
  // 0.6 x + 0.8 |y| < 0 in the cube: ∫∫ (0.5 − 4/3 |y|) over |y| < 0.375.
  EXPECT_NEAR(report.volume, 2 * (0.5 * 0.375 - 2.0 / 3 * 0.375 * 0.375), 1e-5);
}

TEST(MeshCsg, UnboundedSolidsNeedABox) {
  CsgMeshReport report;
  const auto message = [&](const char* text, const CsgMeshOptions& options) -> std::string {
    try {
      meshed(parsed(text), options, report);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  // A half-space ends on one side only: the message names the other five, and what to do.
  EXPECT_EQ(
      message("plane(z)", {}),
      "the solid is not known to end in the directions -x, +x, -y, +y, -z: intersect it with a box, or give a `box` "
      "to cut it off");
  EXPECT_NE(message("cylinder(1)", {}).find("directions -z, +z:"), std::string::npos);
  EXPECT_NE(message("sphere(1) & sphere(1, center=(3,0,0))", {}).find("empty"), std::string::npos);
  EXPECT_NE(message("sphere(1) - sphere(2)", {.resolution = 16}).find("empty"), std::string::npos);
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_NE(message("sphere(1, center=(5,0,0))", {.box = box}).find("no point inside the box"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.box = Box3{{0, 0, 0}, {1e-13, 1e-13, 1e-13}}})
                .find("what is left of the solid inside the box is 1e-13 across: too small for a mesh"),
            std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = 0.1, .resolution = 10}).find("exclude each other"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = 1e-9}).find("too small"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = -1}).find("above 0"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.resolution = 1}).find("from 4 to 4096"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.box = Box3{{0, 0, 0}, {1, 0, 1}}}).find("in y"), std::string::npos);
  EXPECT_EQ(message("sphere(1)", {.cell = 5}), "");  // coarse, but it has an end

  ASSERT_EQ(message("~sphere(0.5)", {.resolution = 48, .box = box}), "");
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.components, 2u);
  EXPECT_NEAR(report.volume, 8 - kPi / 6, 4e-3);
  ASSERT_EQ(message("cylinder(0.5)", {.resolution = 48, .box = box}), "");
  EXPECT_NEAR(report.volume, kPi / 2, 4e-3);
}

TEST(MeshCsg, ThreadsMakeNoDifference) {
  const Solid solid = parsed("difference(box(1), sphere(0.4, center=(0.5,0.5,0.5)), r=0.1) | torus(R=1, r=0.1)");
  CsgMeshReport report;
  test::compare_threads([&] { return meshed(solid, {.resolution = 40}, report); },
                        [](const TriangleMesh& one, const TriangleMesh& many) {
                          EXPECT_EQ(one.vertices, many.vertices);
                          EXPECT_EQ(one.triangles, many.triangles);
                        });
}

TEST(MeshCsg, FlatPartsHaveFewTriangles) {
  CsgMeshReport fine, few;
  const Solid solid = parsed("rotate(box(2) - cylinder(r=0.5), 20, axis=(1,2,3))");
  const TriangleMesh all = meshed(solid, {.resolution = 48, .simplify = 0}, fine);
  const TriangleMesh mesh = meshed(solid, {.resolution = 48}, few);
  EXPECT_TRUE(few.closed);
  EXPECT_LT(mesh.triangles.size(), all.triangles.size() * 2 / 3);
  EXPECT_NEAR(few.volume, fine.volume, 3e-5);
  EXPECT_NEAR(few.area, fine.area, 2e-4);
  EXPECT_LT(largest_value(solid, mesh), 0.02 * few.cell);
}

/// Triangles whose height is less than a thousandth of their edges.
std::size_t flat_triangles(const TriangleMesh& mesh) {
  std::size_t count = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p(mesh.vertices[a]), q(mesh.vertices[b]), r(mesh.vertices[c]);
    count += norm(cross(q - p, r - p)) < 1e-3 * (squared_norm(q - p) + squared_norm(r - q) + squared_norm(p - r)) / 3;
  }
  return count;
}

// At 24 cells the first mesh used to have strips of triangles without area along an edge, and these opened.
TEST(MeshCsg, WedgesStayWedges) {
  const Solid solid = parsed("plane((0.6,0.8,0)) & plane((0.6,-0.8,0)) & box(1)");
  for (const int resolution : {12, 17, 24, 31}) {
    for (const double simplify : {0.0, 1e-6, 1e-4}) {
      CsgMeshReport report;
      const TriangleMesh mesh = meshed(solid, {.resolution = resolution, .simplify = simplify}, report);
      EXPECT_TRUE(report.closed);
      EXPECT_NEAR(report.volume, 0.1875, 1e-7) << resolution << " " << simplify;
      EXPECT_NEAR(report.area, 2.375, 1e-6) << resolution << " " << simplify;
      EXPECT_LT(largest_value(solid, mesh), 1e-6);
      EXPECT_EQ(flat_triangles(mesh), 0u) << resolution << " " << simplify;
      if (simplify > 0) {
        EXPECT_LT(mesh.triangles.size(), 400u) << resolution;
      }
    }
  }
}

/// Blocks are small along curved parts only: where all is flat a few large ones do, and hardly any triangles are left.
TEST(MeshCsg, BlocksFollowTheSolid) {
  struct Case {
    const char* text;
    double volume;
    std::size_t most_blocks, most_triangles;
  };
  for (const Case& c : {Case{"box(1)", 1, 600, 60}, Case{"rotate(box(1), 33, axis=(1,2,3))", 1, 600, 60},
                        Case{"box(2) - cylinder(r=0.5)", 8 - kPi / 2, 60000, 45000},
                        Case{"shell(box(2), 0.5)", 15.625 - 3.375, 600, 120}}) {
    CsgMeshReport report;
    const Solid solid = parsed(c.text);
    const TriangleMesh mesh = meshed(solid, {.resolution = 64}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_LT(report.blocks, c.most_blocks) << c.text;
    EXPECT_LT(mesh.triangles.size(), c.most_triangles) << c.text;
    EXPECT_NEAR(report.volume / c.volume, 1, 5e-6) << c.text;
    EXPECT_LT(largest_value(solid, mesh), 2e-2 * report.cell) << c.text;
  }
}

/// Thin parts lie between all points at which large blocks are sampled, and are found nevertheless.
TEST(MeshCsg, LargeBlocksMissNothingThin) {
  struct Case {
    const char* text;
    double volume;
    long genus;
  };
  for (const Case& c : {Case{"box(1) - box(0.06, 0.06, 2, center=(0.23, 0.19, 0))", 1 - 0.0036, 1},
                        Case{"box(1) - cylinder(r=0.03, axis=(0.1, 0.2, 1), center=(-0.21, 0.2, 0))", 0, 1},
                        Case{"box(1) | box(0.06, 0.06, 2, center=(0.23, 0.19, 0))", 1 + 0.0036, 0},
                        Case{"box(2) - box(1, 0.06, 4)", 8 - 0.12, 1},
                        Case{"offset(box(1) - sphere(0.05, center=(0.5, 0.21, 0.17)), 0.001)", 0, 0}}) {
    CsgMeshReport report;
    const Solid solid = parsed(c.text);
    const TriangleMesh mesh = meshed(solid, {.resolution = 64}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_EQ(report.components, 1u) << c.text;
    EXPECT_EQ(measure_topology(mesh).genus(), std::optional<long>(c.genus)) << c.text;
    if (c.volume > 0) {
      EXPECT_NEAR(report.volume, c.volume, 1e-5) << c.text;
    }
    EXPECT_LT(largest_value(solid, mesh), 0.05 * report.cell) << c.text;
  }
}

/// By default blocks are small enough for thin parts, only there. Of what is thinner than cells that were asked for a
/// warning tells.
TEST(MeshCsg, BlocksFollowThinParts) {
  SANSMESH_NOT_SANITIZED("judges sizes; others mesh thin walls");
  struct Case {
    const char* text;
    double volume;
    std::size_t components;
    long genus;
  };
  for (const Case& c :
       {Case{"box(2) - sphere(0.006, center=(0.3, 0.2, 0.1))", 8 - 4 * kPi / 3 * 0.006 * 0.006 * 0.006, 2, 0},
        Case{"box(0.4) - cylinder(r=0.001, h=1, axis=(1, 2, 3))", 0, 1, 1},
        Case{"cylinder(r=0.002, h=0.2) | sphere(0.05)", 0, 1, 0},
        Case{"torus(R=0.2, r=0.004)", 2 * kPi * kPi * 0.2 * 0.004 * 0.004, 1, 1},
        Case{"box(2) - sphere(1e-4)", 8, 2, 0}}) {
    CsgMeshReport report;
    const Solid solid = parsed(c.text);
    const TriangleMesh mesh = meshed(solid, {.mesh_error = 2e-4}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_EQ(report.components, c.components) << c.text;
    EXPECT_EQ(measure_topology(mesh).genus(), std::optional<long>(c.genus)) << c.text;
    if (c.volume > 0) {
      EXPECT_NEAR(report.volume / c.volume, 1, 2e-3) << c.text;
    }
    EXPECT_TRUE(report.warnings.empty()) << c.text << ": " << report.warnings[0];
  }
  CsgMeshReport report;
  const Solid ball = parsed("box(2) - sphere(0.006, center=(0.3, 0.2, 0.1))");
  meshed(ball, {.cell = 0.02}, report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0], "parts or holes may be missing: some are 0.012 across, cells 0.02");
  meshed(ball, {.cell = 0.004}, report);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(report.components, 2u);
  // What no tree of blocks reaches is one error, with the remedy.
  try {
    meshed(parsed("box(2) - sphere(1e-5)"), {}, report);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("some parts are 2e-05 across"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("`cell`"), std::string::npos) << error.what();
  }
  meshed(parsed("box(2) - sphere(1e-5)"), {.cell = 0.05}, report);
  EXPECT_EQ(report.warnings.size(), 1u);
}

double ball_volume(double r) { return 4 * kPi / 3 * r * r * r; }

/// The mesh error is a share of the box, however thin the solid is: what is flat has none.
TEST(MeshCsg, LongBoxesAreExact) {
  CsgMeshReport report;
  for (const double length : {1e3, 1e5, 1e6}) {
    meshed(parsed("box((" + std::to_string(length) + ", 1, 1))"), {}, report);
    EXPECT_NEAR(report.volume / length, 1, 1e-9 * length);  // faces are where they are to 1e-10 of the length
    EXPECT_NEAR(report.area / (4 * length + 2), 1, 1e-9 * length);
  }
  // Faces of two parts in one plane.
  for (const double length : {1e2, 1e4}) {
    const std::string bar = "box((" + std::to_string(length) + ", 1, 1))";
    meshed(parsed(bar + " | translate(" + bar + ", (0, 3, 0))"), {}, report);
    EXPECT_NEAR(report.volume / (2 * length), 1, 1e-4);
    EXPECT_LT(report.largest_error, 1e-6);
    meshed(parsed(bar + " | translate(" + bar + ", (0, 3, 0))"), {.cell = 3}, report);
    EXPECT_NEAR(report.volume / (2 * length), 1, 1e-4);
  }
}

/// With the cells that they choose themselves.
TEST(MeshCsg, TipsAndDimples) {
  CsgMeshReport report;
  meshed(parsed("cone(r=0.5, h=1)"), {}, report);
  EXPECT_TRUE(report.closed);
  EXPECT_NEAR(report.volume / (kPi / 12), 1, 3e-4);
  meshed(parsed("shell(cone(r=0.5, h=1), 0.01)"), {}, report);
  EXPECT_EQ(report.components, 2u);
  meshed(parsed("offset(torus(R=1, r=0.5), 0.7)"), {}, report);
  EXPECT_EQ(report.components, 1u);
  EXPECT_TRUE(report.closed);
}

/// Where balls touch, nearly touch or cross at small angles, simplified sheets come to cross: what is left alone there
/// is little, and the rest has as few triangles as elsewhere.
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
  EXPECT_EQ(report.warnings, std::vector<std::string>());
  EXPECT_NEAR(report.volume / volume, 1, 1e-3);
  EXPECT_NEAR(report.area / area, 1, 1e-3);
  EXPECT_TRUE(self_intersections(mesh, 1e-7 * report.box.diagonal()).empty());
  EXPECT_LT(mesh.triangles.size(), 6000 * balls.size());
}

/// Cells that hold one piece have a polygon, not those of all their simplices.
TEST(MeshCsg, SmoothPartsHaveAPolygonInEachCell) {
  CsgMeshOptions options;
  options.cell = 0.1, options.simplify = 0;
  CsgMeshReport report;
  const TriangleMesh mesh = meshed(parsed("sphere(1)"), options, report);
  EXPECT_TRUE(report.closed);
  EXPECT_LT(static_cast<double>(mesh.triangles.size()), 3 * 4 * kPi / (0.05 * 0.05));
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

/// Faces that coincide are one, turned or not.
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

/// Parts that touch are joined wherever they stand in the tree: a union that is cut, what is cut of a part of one.
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

/// What is flat in many places only is no plane: a large rounded box beside a small one with a face in its plane.
TEST(MeshCsg, RoundedBoxesAreNotTheirFaces) {
  const std::string rounded = "box(from=(-20,-0.9,-20),to=(20,20,-0.5),r=0.3)";
  CsgMeshReport alone, beside;
  meshed(parsed("box(2) - " + rounded), {}, alone);
  meshed(parsed("box(2) - box(from=(0.5,0.5,-2),to=(0.9,0.9,-0.5)) - " + rounded), {}, beside);
  // Less a slab of half the height but for a strip of .1, and the corner of a square that its rounding leaves.
  const double left = 8 - 2 * 0.5 * 1.9 + 2 * (1 - kPi / 4) * 0.3 * 0.3;
  EXPECT_NEAR(alone.volume, left, 1e-4);
  EXPECT_NEAR(beside.volume, left, 1e-4);
}

/// Any number of faces in one plane are one: a star of 80 points, of 20 boxes turned about an axis.
TEST(MeshCsg, ManyFacesInOnePlane) {
  std::string boxes;
  for (int k = 0; k < 20; ++k) boxes += fmt::format("{}rotate(box(2),{},axis=z)", k ? "+" : "", 4.5 * k);
  // From the middle: 160 triangles between a point of the star, a notch beside it and the axis.
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

/// A hundred faces meet in the tip of a pyramid, forty in an edge of boxes that are turned about it.
TEST(MeshCsg, ManyFacesInOnePlace) {
  std::string fan;
  for (int k = 0; k < 20; ++k)
    fan += fmt::format("{}rotate(box(from=(0,0,0),to=(1,1,1)),{},axis=z)", k ? "+" : "", 4.5 * k);
  // Of the fan: half of the first and last squares, and in between 38 triangles as of the star above.
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
  // Neighbours of a prism of many sides part nowhere: no smaller blocks than for one of few.
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
    EXPECT_NE(std::string(e.what()).find("more than 251 faces meet in one place"), std::string::npos) << e.what();
  }
}

/// As many triangles as the error asks for.
TEST(MeshCsg, TrianglesFollowTheMeshError) {
  const Solid solid = parsed("sphere(1)");
  CsgMeshReport report, coarse, fine;
  const TriangleMesh usual = meshed(solid, {}, report);
  EXPECT_LT(usual.triangles.size(), 40'000u);
  EXPECT_NEAR(report.volume / ball_volume(1), 1, 5e-5);
  const TriangleMesh few = meshed(solid, {.mesh_error = 1e-3}, coarse),
                     many = meshed(solid, {.mesh_error = 3e-5}, fine);
  EXPECT_LT(few.triangles.size(), 3000u);
  EXPECT_LT(coarse.mean_error, 1.5e-3);
  EXPECT_GT(coarse.mean_error, 0.3e-3);
  EXPECT_GT(many.triangles.size(), 30'000u);
  EXPECT_LT(fine.mean_error, 4.5e-5);
  const TriangleMesh counted = meshed(solid, {.triangles = 500}, coarse);
  EXPECT_LE(counted.triangles.size(), 500u);
  EXPECT_GT(counted.triangles.size(), 400u);
  EXPECT_TRUE(coarse.closed);
}

/// Blocks halve from the root on, which is as large as makes them fit: here they may be just a little smaller than
/// twice what halves of the box would be.
TEST(MeshCsg, TheRootFollowsWhatCurvedPartsAllow) {
  std::string text = "box(4, 4, 1)";
  for (const char* x : {"-1.5", "-0.5", "0.5", "1.5"})
    for (const char* y : {"-1.5", "-0.5", "0.5", "1.5"})
      text += std::string(" - cylinder(r=0.3, h=2, center=(") + x + "," + y + ",0))";
  CsgMeshReport report;
  const TriangleMesh mesh = meshed(parsed(text), {}, report);
  EXPECT_GT(report.cell, 0.05);
  EXPECT_LT(report.cell, 0.07);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(measure_topology(mesh).genus(), std::optional<long>(16));
  EXPECT_NEAR(report.volume / (16 - 16 * std::numbers::pi * 0.09), 1, 1e-3);
  EXPECT_LT(report.mean_error, 2e-5 * std::sqrt(33.0));
}

/// Two of these balls nearly touch, so that triangles cross once they are simplified: what is made again is only there.
TEST(MeshCsg, WhereTrianglesCrossOnlyThatIsMadeAgain) {
  const Solid balls = parsed(
      "union(sphere(0.178, center=(0.589,0.206,-0.404)), "
      "sphere(0.182, center=(0.577,0.007,0.598)), "
      "sphere(0.156, center=(0.286,-0.573,-0.527)), "
      "sphere(0.151, center=(0.556,-0.299,-0.052)), "
      "sphere(0.138, center=(-0.256,0.372,-0.546)), "
      "sphere(0.186, center=(0.232,0.509,0.476)), "
      "sphere(0.185, center=(0.092,-0.584,0.294)), "
      "sphere(0.112, center=(0.527,0.135,-0.190)), "
      "sphere(0.174, center=(-0.591,0.154,0.435)))");
  std::string stage;
  int simplified = 0;
  Progress progress([&](const std::string& now, double) {
    simplified += now == "simplify" && stage != now;
    stage = now;
  });
  CsgMeshReport report;
  const TriangleMesh mesh = mesh_csg(balls, {}, progress, &report);
  EXPECT_EQ(simplified, 1);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.warnings, std::vector<std::string>());
  EXPECT_TRUE(self_intersections(mesh, 1e-7 * report.box.diagonal()).empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
