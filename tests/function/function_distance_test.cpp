// Fitted functions as distances: shells and offsets have the right walls and parts.
#include "sansmesh/function/function_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/function/function_solid.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "support/clouds.h"
#include "support/mesh_checks.h"
#include "support/places.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

struct Fitted {
  std::shared_ptr<const FittedFunction> function;
  std::shared_ptr<const FunctionDistance> distance;

  explicit Fitted(const PointSet& cloud) {
    Progress progress;
    function = std::make_shared<const FittedFunction>(fit_surface_function(cloud, {}, progress));
    distance = std::make_shared<const FunctionDistance>(function, progress);
  }
};

const Fitted& ball() {
  static const Fitted all(test::sphere(4000));
  return all;
}
const Fitted& ring() {
  static const Fitted all(test::torus(6000));
  return all;
}
const Fitted& owl() {
  static const Fitted all(read_points(test::source_file("examples/data/owl.vtp")));
  return all;
}

struct Meshed {
  TriangleMesh mesh;
  CsgMeshReport report;
};

Meshed meshed_csg(const std::string& text, const Fitted& fitted, int resolution) {
  Meshed m;
  Progress progress;
  const auto fails = [](const std::string&) -> Solid { throw std::logic_error("no distance asked for"); };
  const Solid solid = parse_csg(text, fails, [&](const std::string&) { return csg::distance_leaf(fitted.distance); });
  m.mesh = mesh_csg(solid, {.resolution = resolution, .simplify = 0}, progress, &m.report);
  EXPECT_TRUE(test::topology_of(m.mesh).closed_manifold()) << text;
  return m;
}

/// Distance of vertices, by `distance`, from the nearer of two levels: the largest, or the largest without a share of
/// them.
template <class Distance>
double off_walls(const TriangleMesh& mesh, double a, double b, Distance&& distance, double without = 0) {
  std::vector<double> off;
  for (const Vec3f& v : mesh.vertices) {
    const double d = distance(mesh.origin + Vec3(v));
    off.push_back(std::min(std::abs(d - a), std::abs(d - b)));
  }
  std::sort(off.begin(), off.end());
  return off[static_cast<std::size_t>((1 - without) * static_cast<double>(off.size() - 1))];
}

double sphere_distance(const Vec3& x) { return norm(x) - 1; }

TEST(FunctionDistance, ShellsOfASphere) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same");
  for (const double t : {0.15, 0.6}) {
    const Meshed inside = meshed_csg("shell(a, " + std::to_string(t) + ", inside)", ball(), 28);
    EXPECT_EQ(inside.report.components, 2u) << t;
    EXPECT_NEAR(inside.report.volume / (4 * std::numbers::pi / 3 * (1 - std::pow(1 - t, 3))), 1, 2e-3) << t;
    EXPECT_LT(off_walls(inside.mesh, 0, -t, sphere_distance), 0.05 * inside.report.cell) << t;
    const Meshed both = meshed_csg("shell(a, " + std::to_string(t) + ")", ball(), 28);
    EXPECT_EQ(both.report.components, 2u) << t;
    EXPECT_LT(off_walls(both.mesh, -t / 2, t / 2, sphere_distance), 0.05 * both.report.cell) << t;
  }
}

TEST(FunctionDistance, OffsetsOfASphere) {
  SANSMESH_NOT_SANITIZED("judges accuracy; that of a cube runs the same");
  for (const double d : {-0.7, -0.1, 0.1, 0.5}) {
    const Meshed m = meshed_csg("offset(a, " + std::to_string(d) + ")", ball(), 20);
    EXPECT_EQ(m.report.components, 1u) << d;
    EXPECT_NEAR(m.report.volume / (4 * std::numbers::pi / 3 * std::pow(1 + d, 3)), 1, 4e-3) << d;
    EXPECT_LT(off_walls(m.mesh, d, d, sphere_distance), 0.08 * m.report.cell) << d;
  }
}

/// Distances to a fitted cube: flat faces, edges rounded outside and sharp inside.
TEST(FunctionDistance, OffsetsOfACubeHaveItsCreases) {
  const Fitted cube(test::cube(6000));
  const auto distance = [](const Vec3& x) {  // from the cube [-1, 1]³
    Vec3 q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = std::abs(x[k]) - 1;
    const double largest = std::max({q.x, q.y, q.z});
    return largest < 0 ? largest : norm(Vec3{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
  };
  for (const double d : {0.2, -0.2}) {
    const Meshed m = meshed_csg("offset(a, " + std::to_string(d) + ")", cube, 40);
    double squares = 0, crossed = 0, faces = 0;
    for (const Vec3f& v : m.mesh.vertices) squares += std::pow(distance(m.mesh.origin + Vec3(v)) - d, 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(m.mesh.vertices.size())), d > 0 ? 6e-3 : 1e-3)
        << d;  // at round edges the cells limit the accuracy
    for (const Triangle& t : m.mesh.triangles) {
      const Vec3 a(m.mesh.vertices[t[0]]), b(m.mesh.vertices[t[1]]), c(m.mesh.vertices[t[2]]);
      const Vec3 n = normalized(cross(b - a, c - a)), middle = (a + b + c) / 3;
      // Deviation of the normals of faces, away from their edges.
      for (std::size_t k = 0; k < 3; ++k)
        if (std::max(std::abs(middle[(k + 1) % 3]), std::abs(middle[(k + 2) % 3])) < 0.7)
          crossed += 1 - std::abs(n[k]), faces += 1;
    }
    EXPECT_LT(crossed / faces, 1e-4) << d;
  }
}

TEST(FunctionDistance, ShellOfATorus) {
  SANSMESH_NOT_SANITIZED("the same of a sphere is run");
  const Meshed m = meshed_csg("shell(a, 0.2, inside)", ring(), 36);
  EXPECT_EQ(m.report.components, 2u);

  EXPECT_EQ(measure_topology(m.mesh).euler, 0);
  Progress progress;
  const TriangleMesh surface = mesh_function(*ring().function, {}, progress);
  const MeshDistance exact(surface);
  const auto distance = [&](const Vec3& x) {
    MeasuredPoint found;
    exact.measure({&x, 1}, 10, {&found, 1});
    return found.distance;
  };
  EXPECT_LT(off_walls(m.mesh, 0, -0.2, distance), 0.1 * m.report.cell);
}

TEST(FunctionDistance, ShellsAndOffsetsOfTheOwl) {
  SANSMESH_NOT_SANITIZED("the same of simpler functions is run");
  const Meshed shell = meshed_csg("shell(a, 6, side=inside)", owl(), 64);
  EXPECT_EQ(shell.report.components, 2u);
  Progress progress;
  const TriangleMesh surface = mesh_function(*owl().function, {}, progress);
  const MeshDistance exact(surface);
  const auto distance = [&](const Vec3& x) {
    MeasuredPoint found;
    exact.measure({&x, 1}, 1000, {&found, 1});
    return found.distance;
  };
  // Inner walls have creases where the owl is thin, which the field does not represent.
  EXPECT_LT(off_walls(shell.mesh, 0, -6, distance, 0.02), 0.08 * shell.report.cell);
  // The bottom has no samples: a few vertices at its border depend on the blocks.
  EXPECT_LT(off_walls(shell.mesh, 0, -6, distance, 0.005), shell.report.cell);
  for (const double d : {-10, 12}) {
    const Meshed m = meshed_csg("offset(a, " + std::to_string(d) + ")", owl(), 32);
    EXPECT_EQ(m.report.components, 1u) << d;
    EXPECT_LT(off_walls(m.mesh, d, d, distance, 0.02), 0.05 * m.report.cell) << d;
    // Where the mesh folds, its normals give the wrong side.
    const auto to_that_side = [&](const Vec3& x) { return std::copysign(distance(x), static_cast<double>(d)); };
    EXPECT_LT(off_walls(m.mesh, d, d, to_that_side), m.report.cell) << d;
  }
}

TEST(FunctionDistance, IsADistanceWithItsGradientEverywhere) {
  const FunctionDistance& f = *ball().distance;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.6, 1.6);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x{uniform(random), uniform(random), uniform(random)};
    if (norm(x) < 0.1) continue;
    double value = 0, there = 0;
    Vec3 gradient;
    f.evaluate({&x, 1}, {&value, 1}, {&gradient, 1});
    EXPECT_NEAR(value, norm(x) - 1, 5e-3);
    EXPECT_GT(dot(gradient, normalized(x)), 0.95);
    EXPECT_LT(norm(gradient), 1.1);
    const Vec3 y = x + Vec3{3e-6, -2e-6, 1e-6};  // continuous
    f.evaluate({&y, 1}, {&there, 1});
    EXPECT_LT(std::abs(there - value), 2 * norm(y - x));
  }
}

/// The cells of a function with more detail than a 256th of the diagonal follow it, and its smooth parts need no more
/// than its own mesh.
TEST(FunctionSolid, CellsFollowTheFunction) {
  SANSMESH_NOT_SANITIZED("judges sizes; others mesh functions as solids");
  const Solid solid = csg::subtract(function_solid(owl().function), csg::half_space({0, 0, 1}, 40));
  Progress progress;
  CsgMeshReport own, usual;
  const TriangleMesh mesh = mesh_csg(solid, {}, progress, &own);
  mesh_csg(
      csg::subtract(csg::place(csg::leaf(std::shared_ptr<const ScalarField>(owl().function, &owl().function->field)),
                               owl().function->frame),
                    csg::half_space({0, 0, 1}, 40)),
      {}, progress, &usual);
  EXPECT_TRUE(own.closed);
  EXPECT_LE(own.cell, usual.cell);
  EXPECT_GE(own.cell, usual.cell / 4.001);
  EXPECT_LT(own.blocks, usual.blocks);
  EXPECT_NEAR(own.volume / usual.volume, 1, 1e-3);
}

TEST(FunctionDistance, OnlyOffsetsAndShellsAskForIt) {
  int plain = 0, far = 0;
  const auto load = [](int& count) {
    return [&count](const std::string&) {
      ++count;
      return csg::sphere({}, 1);
    };
  };
  parse_csg("a | shell(translate(a - b, 1, 0, 0), 0.1) & offset(~a, 0.2) - b", load(plain), load(far));
  EXPECT_EQ(plain, 2);
  EXPECT_EQ(far, 2);
  parse_csg("shell(a, 0.1) - offset(b, 1)", load(plain));
  EXPECT_EQ(plain, 4);
}

}  // namespace
}  // namespace sansmesh::inline v1
