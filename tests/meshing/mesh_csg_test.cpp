// Meshes of solids: closed, with the volumes of closed formulas.
#include "sansmesh/meshing/mesh_csg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "csg/catalogue.h"
#include "meshing/csg_meshes.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/mesh_checks.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace csg;
using namespace test;

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
  // The rest is a cube of edge 1, found on a grid of 32 blocks along the 10 of the whole: at most one block too far.
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
  // A field of known pieces that is not a Solid.
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
  // A half-space is bounded on one side only: the message names the other five, and the remedy.
  EXPECT_EQ(message("plane(z)", {}),
            "the solid may be unbounded in the directions -x, +x, -y, +y, -z: intersect it with a box, or clip it with "
            "`box`");
  EXPECT_NE(message("cylinder(1)", {}).find("directions -z, +z:"), std::string::npos);
  EXPECT_NE(message("sphere(1) & sphere(1, center=(3,0,0))", {}).find("empty"), std::string::npos);
  EXPECT_NE(message("sphere(1) - sphere(2)", {.resolution = 16}).find("empty"), std::string::npos);
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_NE(message("sphere(1, center=(5,0,0))", {.box = box}).find("no point inside the box"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.box = Box3{{0, 0, 0}, {1e-13, 1e-13, 1e-13}}})
                .find("the part of the solid inside the box is 1e-13 across: too small for a mesh"),
            std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = 0.1, .resolution = 10}).find("exclude each other"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = 1e-9}).find("too small"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = -1}).find("above 0"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.resolution = 1}).find("from 4 to 4096"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.box = Box3{{0, 0, 0}, {1, 0, 1}}}).find("in y"), std::string::npos);
  EXPECT_EQ(message("sphere(1)", {.cell = 5}), "");  // coarse, but not empty

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

// At 24 cells the first mesh once had strips of triangles without area along an edge, which opened.
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

/// Blocks are small along curved parts only: flat parts use few large ones, and almost no triangles remain.
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

/// Thin parts between all sample points of large blocks are still found.
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

/// Default blocks are small enough for thin parts, and only there. A warning reports parts thinner than requested
/// cells.
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
    EXPECT_TRUE(report.notes.empty()) << c.text << ": " << report.notes[0].text;
  }
  CsgMeshReport report;
  const Solid ball = parsed("box(2) - sphere(0.006, center=(0.3, 0.2, 0.1))");
  meshed(ball, {.cell = 0.02}, report);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].text, "parts or holes may be missing: some are 0.012 across, cells 0.02");
  meshed(ball, {.cell = 0.004}, report);
  EXPECT_TRUE(report.notes.empty());
  EXPECT_EQ(report.components, 2u);
  // Parts beyond any tree of blocks are a single error, with the remedy.
  try {
    meshed(parsed("box(2) - sphere(1e-5)"), {}, report);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("some parts are 2e-05 across"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("`cell`"), std::string::npos) << error.what();
  }
  meshed(parsed("box(2) - sphere(1e-5)"), {.cell = 0.05}, report);
  EXPECT_EQ(report.notes.size(), 1u);
}

/// The mesh error is relative to the box, however thin the solid is: flat parts have none.
TEST(MeshCsg, LongBoxesAreExact) {
  CsgMeshReport report;
  for (const double length : {1e3, 1e5, 1e6}) {
    meshed(parsed("box((" + std::to_string(length) + ", 1, 1))"), {}, report);
    EXPECT_NEAR(report.volume / length, 1, 1e-9 * length);  // faces are exact to 1e-10 of the length
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

/// With default cells.
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

/// Cells with one piece have a polygon instead of the triangles of their simplices.
TEST(MeshCsg, SmoothPartsHaveAPolygonInEachCell) {
  CsgMeshOptions options;
  options.cell = 0.1, options.simplify = 0;
  CsgMeshReport report;
  const TriangleMesh mesh = meshed(parsed("sphere(1)"), options, report);
  EXPECT_TRUE(report.closed);
  EXPECT_LT(static_cast<double>(mesh.triangles.size()), 3 * 4 * kPi / (0.05 * 0.05));
}

/// The number of triangles follows from the error.
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

/// Blocks halve from the root, whose size is adapted: here they may be slightly smaller than twice the size that
/// halving the box would give.
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

/// Two of these balls nearly touch, so that triangles cross after simplification: only that region is remade.
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
  EXPECT_TRUE(report.notes.empty());
  EXPECT_TRUE(self_intersections(mesh, 1e-7 * report.box.diagonal()).empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
