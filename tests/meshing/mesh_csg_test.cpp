// Solids to meshes: closed, with the volumes that formulas say.
#include "sansmesh/meshing/mesh_csg.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "csg/catalogue.h"
#include "sansmesh/core/error.h"
#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "support/any_threads.h"
#include "support/mesh_checks.h"
#include "support/sanitizers.h"

namespace sansmesh {
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

TEST(MeshCsg, CellsFollowTheSolidThatIsLeft) {
  CsgMeshReport report;
  meshed(parsed("box(10) - box(from=(-6,-6,-6), to=(4,6,6)) - plane(z, offset=4)"), {.resolution = 32}, report);
  EXPECT_NEAR(report.cell, 10.0 / 32, 1e-9);
  meshed(parsed("box(from=(0,0,0), to=(10,1,1)) - box(from=(1,-1,-1), to=(11,2,2))"), {.simplify = 0}, report);
  // What is left is a cube of edge 1, found on a grid of 32 blocks along the 10 of the whole: at most one too far.
  EXPECT_LE(report.cell, norm(Vec3{1 + 10.0 / 32, 1, 1}) / 256 * (1 + 1e-9));
  EXPECT_GE(report.cell, std::sqrt(3.0) / 256);
  EXPECT_NEAR(report.volume, 1, 1e-5);
}

TEST(MeshCsg, FinerIsBetter) {
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
  EXPECT_NE(message("sphere(1)", {.cell = 0.1, .resolution = 10}).find("not both"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = 1e-9}).find("too small"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.cell = -1}).find("positive"), std::string::npos);
  EXPECT_NE(message("sphere(1)", {.resolution = 1}).find("4..4096"), std::string::npos);
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
  EXPECT_LT(mesh.triangles.size(), all.triangles.size() / 3);
  EXPECT_NEAR(few.volume, fine.volume, 1e-5);
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

/// Blocks are small along creases only: where all is flat a few large ones do, and hardly any triangles are left.
TEST(MeshCsg, BlocksFollowTheSolid) {
  struct Case {
    const char* text;
    double volume, most_blocks;  ///< as a share of those of one size
    std::size_t most_triangles;
  };
  for (const Case& c : {Case{"box(1)", 1, 0.45, 200}, Case{"rotate(box(1), 33, axis=(1,2,3))", 1, 0.6, 200},
                        Case{"box(2) - cylinder(r=0.5)", 8 - kPi / 2, 0.8, 40000},
                        Case{"shell(box(2), 0.5)", 15.625 - 3.375, 0.65, 400}}) {
    CsgMeshReport large, small;
    const Solid solid = parsed(c.text);
    meshed(solid, {.resolution = 64, .simplify = 0}, small);
    const TriangleMesh mesh = meshed(solid, {.resolution = 64}, large);
    EXPECT_TRUE(large.closed) << c.text;
    EXPECT_LT(static_cast<double>(large.blocks), c.most_blocks * static_cast<double>(small.blocks)) << c.text;
    EXPECT_LT(mesh.triangles.size(), c.most_triangles) << c.text;
    EXPECT_NEAR(large.volume / c.volume, 1, 2e-6) << c.text;
    EXPECT_LT(largest_value(solid, mesh), 1e-2 * large.cell) << c.text;
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

/// By default cells are small enough for thin parts, where that does not take too many of them. Of what is thinner than
/// the cells a warning tells.
TEST(MeshCsg, CellsFollowThinParts) {
  SANSMESH_NOT_SANITIZED("judges sizes; others mesh thin walls");
  struct Case {
    const char* text;
    std::size_t components;
    long genus;
  };
  for (const Case& c : {Case{"box(2) - sphere(0.006, center=(0.3, 0.2, 0.1))", 2, 0},
                        Case{"box(2) - cylinder(r=0.006, axis=(1, 2, 3), center=(0.1, 0.2, 0.3))", 1, 1},
                        Case{"torus(R=1, r=0.005)", 1, 1}}) {
    CsgMeshReport report;
    const Solid solid = parsed(c.text);
    const TriangleMesh mesh = meshed(solid, {}, report);
    EXPECT_TRUE(report.closed) << c.text;
    EXPECT_EQ(report.components, c.components) << c.text;
    EXPECT_EQ(measure_topology(mesh).genus(), std::optional<long>(c.genus)) << c.text;
    EXPECT_LT(largest_value(solid, mesh), 0.1 * report.cell) << c.text;
    EXPECT_TRUE(report.warnings.empty()) << c.text << ": " << report.warnings[0];
  }
  CsgMeshReport report;
  const Solid ball = parsed("box(2) - sphere(0.006, center=(0.3, 0.2, 0.1))");
  meshed(ball, {.cell = 0.02}, report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0], "parts or holes may be missing: some are 0.012 across, cells 0.02");
  meshed(ball, {.cell = 0.006}, report);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(report.components, 2u);
  meshed(parsed("box(2) - sphere(1e-5)"), {.resolution = 16}, report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0], "parts or holes may be missing: some are 2e-05 across, cells 0.125");
  // Cells that would not do are not made.
  meshed(parsed("box(2) - sphere(1e-5)"), {}, report);
  EXPECT_EQ(report.warnings.size(), 1u);
  EXPECT_NEAR(report.cell, std::sqrt(12.0) / 256, 1e-4);
  try {
    meshed(parsed("box(1, 1, 1e-5)"), {}, report);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("parts are 1e-05 across"), std::string::npos) << error.what();
  }
}

/// Walls would need very many blocks: they get as many as are affordable.
TEST(MeshCsg, CellsOfWallsAreAffordable) {
  SANSMESH_NOT_SANITIZED("judges sizes; others mesh thin walls");
  CsgMeshReport report;
  meshed(parsed("rotate(box(1, 1, 0.004), 20, axis=(1, 2, 3))"), {}, report);
  EXPECT_LE(report.blocks, 1'000'000u);
  EXPECT_LE(report.cell, 0.004);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.components, 1u);
  EXPECT_NEAR(report.volume / 0.004, 1, 1e-3);
  EXPECT_TRUE(report.warnings.empty());
}

}  // namespace
}  // namespace sansmesh
