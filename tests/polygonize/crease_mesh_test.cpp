#include "sansmesh/polygonize/creases/crease_mesh.h"
#include "sansmesh/mesh_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "polygonize/piece_solids.h"
#include "support/any_threads.h"
#include "support/mesh_checks.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr double kPi = std::numbers::pi;

BlockTree blocks(int level) {
  BlockTree tree({-1, -1, -1}, 2);
  for (std::size_t b = 0; b < tree.size(); ++b)
    if (tree[b].level < level) tree.subdivide(b);
  return tree;
}

PolygonizeOptions on_surface() {
  PolygonizeOptions options;
  options.balance = false;
  return options;
}

TriangleMesh mesh_of(const PiecewiseField& field, int level = 5, const PolygonizeOptions& options = on_surface()) {
  Progress progress;
  return polygonize_with_creases(field, blocks(level), {}, options, progress);
}

double value_at(const ScalarField& field, const Vec3& x, Vec3* gradient = nullptr) {
  double f = 0;
  Vec3 g;
  field.evaluate({&x, 1}, {&f, 1}, {&g, 1});
  if (gradient != nullptr) *gradient = g;
  return f;
}

/// Distances of the mesh from the zero set, at vertices and on triangles.
struct Gaps {
  double vertices = 0, triangles = 0;
  std::size_t folded = 0;  ///< triangles turned by more than 75° against the surface
  double small_share = 0;  ///< share of triangles with an angle below 5°
};

Gaps gaps_of(const TriangleMesh& mesh, const ScalarField& field) {
  Gaps gaps;
  for (const Vec3f& v : mesh.vertices)
    gaps.vertices = std::max(gaps.vertices, std::abs(value_at(field, mesh.origin + Vec3(v))));
  std::size_t small = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 p = mesh.origin;
    const Vec3 a = p + Vec3(mesh.vertices[t[0]]), b = p + Vec3(mesh.vertices[t[1]]), c = p + Vec3(mesh.vertices[t[2]]);
    for (int i = 0; i <= 4; ++i)
      for (int j = 0; i + j <= 4; ++j)
        gaps.triangles =
            std::max(gaps.triangles, std::abs(value_at(field, a + (b - a) * (i / 4.0) + (c - a) * (j / 4.0))));
    Vec3 g;
    value_at(field, (a + b + c) / 3, &g);
    gaps.folded += dot(normalized(cross(b - a, c - a)), g) < 0.26;
    const auto angle = [](const Vec3& at, const Vec3& q, const Vec3& r) {
      return std::atan2(norm(cross(q - at, r - at)), dot(q - at, r - at)) * 180 / kPi;
    };
    small += std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)}) < 5;
  }
  gaps.small_share = static_cast<double>(small) / static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size()));
  return gaps;
}

/// Number of pieces that vanish at each vertex.
std::vector<int> pieces_at(const TriangleMesh& mesh, const PiecewiseField& field, double tolerance) {
  std::vector<int> count(mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < count.size(); ++v)
    for (std::uint32_t p = 0; p < field.pieces(); ++p) {
      const Vec3 x = mesh.origin + Vec3(mesh.vertices[v]);
      double f = 1;
      field.evaluate_piece(p, {&x, 1}, {&f, 1}, {});
      count[v] += std::abs(f) < tolerance;
    }
  return count;
}

struct Case {
  std::string name;
  Solid solid;
  long euler;
  double volume;  ///< 0: not compared
  double gap;     ///< largest distance of a triangle from the surface: chords of curved parts
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

Solid pyramid(int sides) {
  std::vector<Solid> parts;
  for (int i = 0; i < sides; ++i) {
    const double a = 2 * kPi * i / sides + 0.3;
    parts.push_back(half_space({std::cos(a), std::sin(a), 0.7}, 0.25));
  }
  parts.push_back(half_space({0, 0, -1}, 0.3));
  return intersect(std::move(parts));
}

std::vector<Case> cases() {
  const auto axes = tilted_axes();
  const double drop = 2e-3;  // 2 % of (1/16)² / 0.3, the height of an arc over an edge
  return {
      {"cube", box({0.013, 0.02, -0.01}, {0.51, 0.53, 0.55}), 2, 8 * 0.51 * 0.53 * 0.55, 1e-6},
      {"cube on the lattice", box({0, 0, 0}, {0.5, 0.5, 0.5}), 2, 1, 1e-6},
      {"cube on half the lattice", box({0, 0, 0}, {0.53125, 0.5, 0.515625}), 2, 8 * 0.53125 * 0.5 * 0.515625, 1e-6},
      {"tilted cube", box({0.01, 0.02, 0.03}, {0.5, 0.45, 0.4}, axes), 2, 8 * 0.5 * 0.45 * 0.4, 1e-6},
      {"ball with a flat", intersect({ball({0, 0, 0}, 0.7), half_space({0.3, 0.2, 1}, 0.2)}), 2, 0, drop},
      {"Steinmetz", intersect({cylinder({0, 0, 0}, axes[0], 0.5), cylinder({0, 0, 0}, axes[1], 0.5)}), 2, 0, drop},
      {"two balls", unite({ball({-0.3, 0.01, 0.02}, 0.45), ball({0.28, 0.05, 0}, 0.4)}), 2, 0, drop},
      {"ball with a hole", subtract(ball({0, 0, 0}, 0.7), cylinder({0.1, 0, 0.05}, axes[2], 0.3)), 0, 0, drop},
      {"pyramid of four", pyramid(4), 2, 0, 1e-6},
      {"pyramid of six", pyramid(6), 2, 0, 1e-6},
      {"boxes side by side",
       unite({box(axes[0] * -0.2, {0.3, 0.4, 0.3}, axes), box(axes[0] * 0.3, {0.3, 0.4, 0.2}, axes)}), 2,
       8 * (0.3 * 0.4 * 0.3 + 0.3 * 0.4 * 0.2) - 0.1 * 0.8 * 0.4, 1e-6},
      {"wedge of 14 degrees",
       intersect({half_space({0, 0.12, 1}, 0), half_space({0, 0.12, -1}, 0), half_space({0, -1, 0}, 0.7),
                  half_space({1, 0.1, 0.05}, 0.5), half_space({-1, 0, 0.1}, 0.5)}),
       2, 0, 1e-6},
      {"the same ball twice", unite({ball({0, 0, 0}, 0.6), ball({0, 0, 0}, 0.6)}), 2, 0, drop},
      {"the same box twice", unite({box({0, 0, 0}, {0.5, 0.4, 0.3}, axes), box({0, 0, 0}, {0.5, 0.4, 0.3}, axes)}), 2,
       8 * 0.5 * 0.4 * 0.3, 1e-6},
      {"plane touching a ball from outside", intersect({ball({0, 0, 0}, 0.5), half_space({0, 0, 1}, 0.5)}), 2, 0, drop},
      {"all at once",
       subtract(intersect({box({0, 0, 0}, {0.5, 0.5, 0.5}, axes), ball({0, 0, 0}, 0.65)}),
                unite({cylinder({0, 0, 0}, axes[0], 0.3), cylinder({0, 0, 0}, axes[1], 0.3),
                       cylinder({0, 0, 0}, axes[2], 0.3)})),
       -8, 0, drop},
      {"lens", intersect({ball({-0.3, 0.01, 0.02}, 0.45), ball({0.28, 0.05, 0}, 0.4)}), 2, 0, drop},
  };
}

class CreaseMesh : public ::testing::TestWithParam<Case> {};

TEST_P(CreaseMesh, IsClosedExactAndOfGoodShape) {
  const Case& c = GetParam();
  const SolidField field(c.solid);
  const TriangleMesh mesh = mesh_of(field);
  const Topology topology = topology_of(mesh);
  EXPECT_TRUE(topology.closed_manifold());
  EXPECT_EQ(topology.euler, c.euler);
  const Gaps gaps = gaps_of(mesh, field);
  EXPECT_LT(gaps.vertices, 1e-6);
  EXPECT_LT(gaps.triangles, c.gap);  // no triangle crosses a crease, which would give a gap of up to 0.03
  EXPECT_EQ(gaps.folded, 0u);
  EXPECT_LT(gaps.small_share, 1e-3);
  if (c.volume > 0) {
    EXPECT_NEAR(measure_quality(mesh).volume, c.volume, 2e-7);
  }
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (const Vec3f& n : mesh.normals) EXPECT_NEAR(norm(n), 1, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Solids, CreaseMesh, ::testing::ValuesIn(cases()), [](const auto& param_info) {
  std::string name;
  for (const char c : param_info.param.name) name += c == ' ' ? '_' : c;
  return name;
});

TEST(CreaseMeshOf, ACubeHasItsTwelveEdgesAndEightCorners) {
  const SolidField field(box({0.01, 0.02, 0.03}, {0.5, 0.45, 0.4}, tilted_axes()));
  const TriangleMesh mesh = mesh_of(field);
  const std::vector<int> pieces = pieces_at(mesh, field, 1e-6);
  EXPECT_EQ(std::count(pieces.begin(), pieces.end(), 3), 8);
  // The total length of crease edges is that of the cube's edges.
  double length = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (pieces[a] < 2 || pieces[b] < 2) continue;
      const Vec3 middle = (Vec3(mesh.vertices[a]) + Vec3(mesh.vertices[b])) * 0.5;
      int vanish = 0;
      for (std::uint32_t p = 0; p < field.pieces(); ++p) {
        double f = 1;
        field.evaluate_piece(p, {&middle, 1}, {&f, 1}, {});
        vanish += std::abs(f) < 1e-6;
      }
      if (vanish == 2) length += 0.5 * norm(Vec3(mesh.vertices[a]) - Vec3(mesh.vertices[b]));
    }
  EXPECT_NEAR(length, 8 * (0.5 + 0.45 + 0.4), 1e-5);
}

/// Largest distance of a vertex from the pieces of the triangles around it.
double crease_drift(const TriangleMesh& mesh, const PiecewiseField& field) {
  double drift = 0;
  std::vector<std::vector<std::uint32_t>> around(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 p =
        mesh.origin + (Vec3(mesh.vertices[t[0]]) + Vec3(mesh.vertices[t[1]]) + Vec3(mesh.vertices[t[2]])) / 3;
    std::uint32_t piece = 0;
    field.active({&p, 1}, {&piece, 1});
    for (const std::uint32_t v : t) around[v].push_back(piece);
  }
  for (std::size_t v = 0; v < around.size(); ++v) {
    if (std::equal(around[v].begin() + 1, around[v].end(), around[v].begin())) continue;  // smooth, possibly balanced
    for (const std::uint32_t p : around[v]) {
      const Vec3 x = mesh.origin + Vec3(mesh.vertices[v]);
      double f = 1;
      field.evaluate_piece(p, {&x, 1}, {&f, 1}, {});
      drift = std::max(drift, std::abs(f));
    }
  }
  return drift;
}

TEST(CreaseMeshOf, SimplificationAndBalanceKeepTheCreases) {
  const auto axes = tilted_axes();
  const SolidField cube(box({0.01, 0.02, 0.03}, {0.5, 0.45, 0.4}, axes));
  const SolidField drilled(subtract(ball({0, 0, 0}, 0.7), cylinder({0.1, 0, 0.05}, axes[2], 0.3)));
  for (const SolidField* field : {&cube, &drilled}) {
    PolygonizeOptions options;
    options.simplify = 1e-3;
    const std::size_t full = mesh_of(*field).triangles.size();
    const TriangleMesh mesh = mesh_of(*field, 5, options);
    EXPECT_TRUE(topology_of(mesh).closed_manifold());
    EXPECT_LT(mesh.triangles.size(), full / 3);
    EXPECT_LT(crease_drift(mesh, *field), 1e-6);
    EXPECT_EQ(gaps_of(mesh, *field).folded, 0u);
    EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  }
  PolygonizeOptions options;
  options.simplify = 1e-3;
  const TriangleMesh mesh = mesh_of(cube, 5, options);
  EXPECT_LT(mesh.triangles.size(), 400u);
  EXPECT_NEAR(measure_quality(mesh).volume, 8 * 0.5 * 0.45 * 0.4, 1e-6);
}

TEST(CreaseMeshOf, BalanceHalvesTheErrorOfTheVolume) {
  const SolidField field(intersect({ball({0, 0, 0}, 0.7), half_space({0.3, 0.2, 1}, 0.2)}));
  PolygonizeOptions options;
  const double h =
      0.7 + 0.2;  // height of the remaining part of the ball: the half-space's offset is measured from its centre
  const double volume = kPi * h * h * (0.7 - h / 3);
  const double plain = measure_quality(mesh_of(field)).volume - volume;
  const double balanced = measure_quality(mesh_of(field, 5, options)).volume - volume;
  EXPECT_LT(plain, 0);
  EXPECT_LT(std::abs(balanced), 0.5 * std::abs(plain));
  EXPECT_LT(crease_drift(mesh_of(field, 5, options), field), 1e-6);
}

// Random solids on a lattice that is too coarse for some of their features: wrong there, but closed, manifold and
// without stray vertices.
TEST(CreaseMeshOf, WhatTheLatticeCannotResolveDoesNoHarm) {
  SANSMESH_NOT_SANITIZED("judges topology; others mesh creases, too");
  std::mt19937 generator(7);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(generator); };
  const auto point = [&] { return Vec3{number(-0.4, 0.4), number(-0.4, 0.4), number(-0.4, 0.4)}; };
  const auto part = [&] {
    const Vec3 a = normalized(point()), b = normalized(cross(a, point())), centre = point();
    if (generator() % 3 == 0) return ball(centre, number(0.1, 0.4));
    const Solid block =
        box(centre, {number(0.1, 0.3), number(0.1, 0.3), number(0.02, 0.3)}, std::array<Vec3, 3>{a, b, cross(a, b)});
    return generator() % 2 == 0 ? block : subtract(block, cylinder(centre, a, number(0.05, 0.2)));
  };
  for (int i = 0; i < 12; ++i) {
    Solid solid = part();
    for (int k = 0; k < 4; ++k)
      solid = k % 2 == 0 ? unite({std::move(solid), part()}) : subtract(std::move(solid), part());
    const SolidField field(solid);
    PolygonizeOptions options = on_surface();
    if (i % 3 == 2) options.simplify = 1e-3;
    const TriangleMesh mesh = mesh_of(field, 4 + i % 2, options);
    EXPECT_TRUE(topology_of(mesh).closed_manifold()) << i;
    const double cell = 2.0 / (16 << i % 2);
    const Gaps gaps = gaps_of(mesh, field);
    EXPECT_LT(gaps.triangles, cell) << i;
    EXPECT_LT(static_cast<double>(gaps.folded), 0.05 * static_cast<double>(mesh.triangles.size())) << i;
  }
}

TEST(CreaseMeshOf, SolidsThatLeaveTheCubeAreClosedAtItsFaces) {
  const SolidField field(subtract(cylinder({0, 0, 0}, {1, 0.02, 0.01}, 0.6), cylinder({0, 0, 0}, {0, 0.1, 1}, 0.3)));
  const TriangleMesh mesh = mesh_of(field);
  EXPECT_TRUE(topology_of(mesh).closed_manifold());
  for (const Vec3f& v : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(std::abs(v[k]), 1);
}

TEST(CreaseMeshOf, TheOriginIsSubtracted) {
  const SolidField field(box({0.01, 0.02, 0.03}, {0.5, 0.45, 0.4}, tilted_axes()));
  Progress progress;
  const Vec3 origin{0.5, -0.25, 0.125};
  const TriangleMesh here = mesh_of(field);
  const TriangleMesh there = polygonize_with_creases(field, blocks(5), origin, on_surface(), progress);
  EXPECT_EQ(there.origin, origin);
  EXPECT_LT(crease_drift(there, field), 1e-6);
  EXPECT_NEAR(measure_quality(there).volume, measure_quality(here).volume, 1e-6);
}

TEST(CreaseMeshOf, TheSameForAnyNumberOfThreads) {
  const auto axes = tilted_axes();
  const SolidField field(subtract(intersect({box({0, 0, 0}, {0.5, 0.5, 0.5}, axes), ball({0, 0, 0}, 0.65)}),
                                  unite({cylinder({0, 0, 0}, axes[0], 0.3), cylinder({0, 0, 0}, axes[1], 0.3)})));
  test::compare_threads([&] { return mesh_of(field); },
                        [](const TriangleMesh& one, const TriangleMesh& many) {
                          EXPECT_EQ(one.triangles, many.triangles);
                          EXPECT_EQ(one.vertices, many.vertices);
                          EXPECT_EQ(one.normals, many.normals);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
