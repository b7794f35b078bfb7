#include "sansmesh/mesh/edit/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

TriangleMesh simplified(TriangleMesh mesh, double error, std::size_t triangles = 0) {
  Progress progress;
  simplify_mesh(mesh, {.error = error, .triangles = triangles}, progress);
  return mesh;
}

SurfaceDistance distance(const TriangleMesh& a, const TriangleMesh& b) {
  Progress progress;
  return measure_distance(a, b, {.samples = 20000}, progress);
}

/// Cube of n × n × 6 quads with edge 2.
TriangleMesh grid_cube(std::uint32_t n);

TEST(Simplify, FlatPartsNeedFewTrianglesAndCreasesStay) {
  const TriangleMesh cube = grid_cube(24);
  const TriangleMesh few = simplified(cube, 1e-6);
  const MeshTopology topology = measure_topology(few);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_LT(few.triangles.size(), cube.triangles.size() / 10);
  EXPECT_NEAR(measure_quality(few).volume, 8, 1e-4);
  EXPECT_LT(distance(cube, few).to_reference.max, 1e-5);
}

TEST(Simplify, StaysNearTheSurfaceAndWellShaped) {
  const TriangleMesh ball = test::octasphere(6);
  std::size_t last = ball.triangles.size();
  for (const double error : {3e-4, 1e-3, 1e-2}) {
    const TriangleMesh few = simplified(ball, error);
    const SurfaceDistance d = distance(few, ball);
    EXPECT_LT(few.triangles.size(), last);
    EXPECT_LT(d.to_reference.mean, 2 * error);
    EXPECT_LT(d.from_reference.mean, 2 * error);
    EXPECT_TRUE(measure_topology(few).closed());
    EXPECT_EQ(measure_topology(few).euler, 2);
    last = few.triangles.size();
  }
  EXPECT_LT(measure_quality(simplified(ball, 1e-2)).aspect_mean, 1.7);
}

TEST(Simplify, ReachesTheNumberAskedFor) {
  const TriangleMesh ring = test::torus_mesh(80, 40);
  for (const std::size_t target : {3000u, 500u, 120u}) {
    const TriangleMesh few = simplified(ring, 1e-7, target);
    EXPECT_LE(few.triangles.size(), target);
    EXPECT_GE(few.triangles.size() + 2, target);
    EXPECT_TRUE(measure_topology(few).closed());
    EXPECT_EQ(measure_topology(few).genus(), 1);
  }
}

TEST(Simplify, IsDoneWhereThereAreFewEnough) {
  const TriangleMesh ring = test::torus_mesh(40, 20);
  const TriangleMesh same = simplified(ring, 1e-9, 100000);
  EXPECT_EQ(same.triangles, ring.triangles);
  EXPECT_EQ(simplified(ring, 1e-9, ring.triangles.size()).triangles.size(), ring.triangles.size());
}

TEST(Simplify, EndsWhereTopologyForbidsMore) {
  const TriangleMesh ring = test::torus_mesh(20, 10);
  const TriangleMesh few = simplified(ring, 1e-7, 4);
  EXPECT_GE(few.triangles.size(), 14u) << "no torus has fewer";
  EXPECT_EQ(measure_topology(few).genus(), 1);
  EXPECT_TRUE(measure_topology(few).closed());
}

/// Square of n × n quads with edge 2, without its middle ninth.
TriangleMesh frame(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j)
      mesh.vertices.push_back({2 * static_cast<float>(i) / static_cast<float>(n) - 1,
                               2 * static_cast<float>(j) / static_cast<float>(n) - 1, 0});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      if (3 * i >= n && 3 * i < 2 * n && 3 * j >= n && 3 * j < 2 * n) continue;
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  const std::vector<std::uint32_t> used = [&] {
    std::vector<std::uint8_t> is_used(mesh.vertices.size(), 0);
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) is_used[v] = 1;
    std::vector<std::uint32_t> all;
    for (std::uint32_t v = 0; v < is_used.size(); ++v)
      if (is_used[v]) all.push_back(v);
    return all;
  }();
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  std::vector<Vec3f> vertices;
  for (const std::uint32_t v : used)
    number[v] = static_cast<std::uint32_t>(vertices.size()), vertices.push_back(mesh.vertices[v]);
  mesh.vertices = vertices;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return mesh;
}

TEST(Simplify, StraightBordersNeedTheirCornersOnly) {
  const TriangleMesh whole = frame(60);
  for (const std::size_t triangles : {std::size_t{0}, whole.triangles.size() / 25}) {
    const TriangleMesh few = simplified(whole, 1e-5, triangles);
    const MeshTopology topology = measure_topology(few);
    EXPECT_TRUE(topology.manifold());
    EXPECT_EQ(topology.boundary_loops, 2u);
    EXPECT_LE(few.triangles.size(), triangles > 0 ? triangles : whole.triangles.size() / 20);
    EXPECT_NEAR(measure_quality(few).area, 4 - 4.0 / 9, 1e-4);
    for (const float end : {1.0f, 1.0f / 3})
      for (const float sx : {-end, end})
        for (const float sy : {-end, end}) {
          float nearest = 1;
          for (const Vec3f& x : few.vertices) nearest = std::min(nearest, norm(x - Vec3f{sx, sy, 0}));
          EXPECT_LT(nearest, 1e-4f);
        }
  }
}

TEST(Simplify, HubsOfManySpokesAreNoTrouble) {
  // Two hubs with a spoke to every vertex of the equator: a ball.
  const TriangleMesh ball = [] {
    TriangleMesh mesh;
    constexpr std::uint32_t n = 60, rows = 31;
    for (std::uint32_t r = 0; r < rows; ++r)
      for (std::uint32_t k = 0; k < n; ++k) {
        const double up = std::numbers::pi * ((r + 1.0) / (rows + 1) - 0.5), turn = 2 * std::numbers::pi * k / n;
        mesh.vertices.push_back(
            Vec3f(Vec3{std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up)}));
      }
    const auto south = static_cast<std::uint32_t>(mesh.vertices.size()), north = south + 1;
    mesh.vertices.push_back({0, 0, -1}), mesh.vertices.push_back({0, 0, 1});
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t l = (k + 1) % n;
      mesh.triangles.push_back({south, l, k});
      mesh.triangles.push_back({north, (rows - 1) * n + k, (rows - 1) * n + l});
      for (std::uint32_t r = 0; r + 1 < rows; ++r) {
        const std::uint32_t a = r * n + k, b = r * n + l;
        mesh.triangles.push_back({a, b, b + n});
        mesh.triangles.push_back({a, b + n, a + n});
      }
    }
    return mesh;
  }();
  test::expect_equal_for_any_threads([&] { return simplified(ball, 1e-2).vertices; });
  const TriangleMesh few = simplified(ball, 1e-2);
  EXPECT_TRUE(measure_topology(few).closed());
  EXPECT_LT(distance(few, ball).from_reference.mean, 2e-2);
}

TEST(Simplify, CapsOfManySpokesGoDownToTheTrianglesAskedFor) {
  // Edges around a hub collapse in parallel: sequential collapses would take too long.
  for (const std::uint32_t n : {400u, 700u, 2000u}) {
    SCOPED_TRACE(n);
    TriangleMesh can;
    for (const float z : {0.f, 1.f})
      for (std::uint32_t k = 0; k < n; ++k) {
        const double turn = 2 * std::numbers::pi * k / n;
        can.vertices.push_back(Vec3f(Vec3{std::cos(turn), std::sin(turn), static_cast<double>(z)}));
      }
    can.vertices.push_back({0, 0, 0}), can.vertices.push_back({0, 0, 1});
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t l = (k + 1) % n;
      for (const Triangle& t :
           {Triangle{k, l, l + n}, Triangle{k, l + n, k + n}, Triangle{2 * n, l, k}, Triangle{2 * n + 1, k + n, l + n}})
        can.triangles.push_back(t);
    }
    const auto down = [](TriangleMesh mesh) {
      Progress progress;
      simplify_mesh(mesh, {.error = 1e-4, .triangles = 200, .least_shape = 0}, progress);
      return mesh;
    };
    const TriangleMesh few = down(can);
    EXPECT_LE(few.triangles.size(), 200u);
    EXPECT_GE(few.triangles.size(), 198u);
    EXPECT_TRUE(measure_topology(few).closed());
    EXPECT_NEAR(measure_quality(few).volume, std::numbers::pi, 0.05);
    if (n == 700) test::expect_equal_for_any_threads([&] { return down(can).vertices; });
  }
}

TEST(Simplify, TheHubOfADiscGoesOnceItHasFewSpokes) {
  TriangleMesh disc;
  constexpr std::uint32_t n = 40;
  disc.vertices.push_back({});
  for (std::uint32_t k = 0; k < n; ++k) {
    const double turn = 2 * std::numbers::pi * k / n;
    disc.vertices.push_back(Vec3f(Vec3{std::cos(turn), std::sin(turn), 0}));
    disc.triangles.push_back({0, 1 + k, 1 + (k + 1) % n});
  }
  TriangleMesh few = disc;
  Progress progress;
  // Without the hub, triangles are thin.
  simplify_mesh(few, {.error = 1e-3, .triangles = 8, .least_shape = 0.3}, progress);
  EXPECT_EQ(few.triangles.size(), 8u);
  EXPECT_EQ(few.vertices.size(), 10u);  // all on the rim
  for (const Vec3f& v : few.vertices) EXPECT_NEAR(norm(v), 1, 0.1);
}

TEST(Simplify, BordersStayWithinTheError) {
  TriangleMesh open = test::octasphere(5);
  std::erase_if(open.triangles, [&](const Triangle& t) { return open.vertices[t[0]][2] > 0.5f; });
  const MeshTopology before = measure_topology(open);
  for (const double error : {1e-3, 1e-2}) {
    const TriangleMesh few = simplified(open, error);
    const MeshTopology after = measure_topology(few);
    EXPECT_LT(few.triangles.size(), open.triangles.size() / 2);
    EXPECT_EQ(after.boundary_loops, before.boundary_loops);
    EXPECT_TRUE(after.manifold());
    const SurfaceDistance d = distance(few, open);
    EXPECT_LT(d.to_reference.max, 6 * error);
    EXPECT_LT(d.from_reference.max, 6 * error);
  }
}

TEST(Simplify, CarriesAttributes) {
  TriangleMesh ball = test::octasphere(5);
  ball.normals = ball.vertices;
  std::vector<double> heights;
  std::vector<std::uint16_t> numbers;
  for (const Vec3f& v : ball.vertices) {
    ball.colors.push_back({static_cast<std::uint8_t>(127 + 120 * v[0]), 40, 0});
    heights.push_back(v[1]);
    numbers.push_back(static_cast<std::uint16_t>(numbers.size()));
  }
  ball.attributes.set("height", heights);
  ball.attributes.set("number", numbers);
  std::vector<std::uint32_t> faces(ball.triangles.size());
  std::iota(faces.begin(), faces.end(), 0u);
  ball.triangle_attributes.set("face", faces);
  const TriangleMesh few = simplified(ball, 3e-3);
  ASSERT_EQ(few.normals.size(), few.vertices.size());
  ASSERT_EQ(few.colors.size(), few.vertices.size());
  few.attributes.check_rows(few.vertices.size(), "vertices");
  few.triangle_attributes.check_rows(few.triangles.size(), "triangles");
  const auto& height = *few.attributes.find<double>("height");
  const auto& number = *few.attributes.find<std::uint16_t>("number");
  const auto& face = *few.triangle_attributes.find<std::uint32_t>("face");
  for (std::size_t i = 0; i < few.vertices.size(); ++i) {
    EXPECT_GT(dot(few.normals[i], normalized(few.vertices[i])), 0.98f);
    EXPECT_NEAR(few.colors[i][0], 127 + 120 * few.vertices[i][0], 16);
    EXPECT_EQ(few.colors[i][1], 40);
    EXPECT_NEAR(height[i], few.vertices[i][1], 0.12);
    // Integers are those of a merged vertex, not means.
    EXPECT_LT(norm(ball.vertices[number[i]] - few.vertices[i]), 0.3f);
  }
  for (std::size_t i = 0; i < face.size(); ++i) {
    EXPECT_TRUE(i == 0 || face[i - 1] < face[i]);
    const auto middle = [](const TriangleMesh& m, const Triangle& t) {
      return (m.vertices[t[0]] + m.vertices[t[1]] + m.vertices[t[2]]) * (1 / 3.0f);
    };
    EXPECT_LT(norm(middle(ball, ball.triangles[face[i]]) - middle(few, few.triangles[i])), 0.4f);
  }
}

TEST(Simplify, ToANumberPreservesTheVolume) {
  const TriangleMesh ball = test::octasphere(6);
  const double volume = measure_quality(ball).volume;
  for (const std::size_t triangles : {2000u, 200u}) {
    const TriangleMesh few = simplified(ball, 1e-6, triangles);
    EXPECT_NEAR(measure_quality(few).volume, volume, 2e-3 * volume) << triangles;
  }
}

/// Stepped profile turned around z in n steps, as CAD programs tessellate it: long thin triangles.
TriangleMesh turned_part(std::uint32_t n) {
  const std::vector<std::array<double, 2>> profile{{.3, 0},    {1.5, 0}, {1.5, .3}, {1.36, .31}, {1.2, .4},
                                                   {1.11, .5}, {1.1, 2}, {.8, 2.1}, {.8, 3},     {.3, 3}};
  TriangleMesh mesh;
  const auto rows = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t k = 0; k < n; ++k)
    for (const auto& [r, z] : profile) {
      const double turn = 2 * std::numbers::pi * k / n;
      mesh.vertices.push_back(Vec3f(Vec3{r * std::cos(turn), r * std::sin(turn), z}));
    }
  for (std::uint32_t k = 0; k < n; ++k)
    for (std::uint32_t i = 0; i < rows; ++i) {
      const std::uint32_t a = k * rows + i, b = k * rows + (i + 1) % rows, c = (a + rows) % (n * rows),
                          d = (b + rows) % (n * rows);
      mesh.triangles.push_back({a, c, d});
      mesh.triangles.push_back({a, d, b});
    }
  return mesh;
}

TEST(Simplify, SliversOfTheInputDoNotBlockOthers) {
  const TriangleMesh part = turned_part(400);
  Progress progress;
  TriangleMesh few = part;
  simplify_mesh(few, {.triangles = part.triangles.size() / 10, .least_shape = kLeastShapeOfNumber}, progress);
  const SurfaceDistance d = distance(few, part);
  const double diagonal = bounds(part).diagonal();
  EXPECT_LT(d.to_reference.mean + d.from_reference.mean, 1e-3 * diagonal);
  EXPECT_LT(std::max(d.to_reference.max, d.from_reference.max), 5e-3 * diagonal);
  EXPECT_EQ(measure_topology(few).genus(), 1);
}

TEST(Simplify, IsTheSameInAnyUnit) {
  const auto few = [](float unit) {
    TriangleMesh part = turned_part(60);
    for (Vec3f& v : part.vertices) v = v * unit;
    Progress progress;
    simplify_mesh(part, {.triangles = part.triangles.size() / 10, .least_shape = kLeastShapeOfNumber}, progress);
    return part;
  };
  const TriangleMesh part = turned_part(60);
  const double one = distance(few(1), part).to_reference.mean;
  for (const float unit : {0x1p-37f, 0x1p57f}) {
    TriangleMesh scaled = few(unit);
    EXPECT_LE(scaled.triangles.size(), part.triangles.size() / 10) << unit;
    for (Vec3f& v : scaled.vertices) v = v * (1 / unit);
    EXPECT_LT(distance(scaled, part).to_reference.mean, 1.2 * one) << unit;
  }
}

TEST(Simplify, ColoursAreInTheCost) {
  // A flat square, in two colours with a wavy border between them.
  constexpr std::uint32_t n = 60;
  const auto is_red = [](double x, double y) { return y < 0.5 + 0.2 * std::sin(9 * x); };
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t k = 0; k <= n; ++k) {
      const double x = i / double{n}, y = k / double{n};
      mesh.vertices.push_back(Vec3f(Vec3{x, y, 0}));
      mesh.colors.push_back(is_red(x, y) ? std::array<std::uint8_t, 3>{250, 0, 0}
                                         : std::array<std::uint8_t, 3>{0, 0, 0});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = i * (n + 1) + k, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  const TriangleMesh few = simplified(mesh, 1e-5, mesh.triangles.size() / 10);
  double off = 0, area = 0;  // at the centres of the triangles
  for (const Triangle& t : few.triangles) {
    Vec3 middle;
    double red = 0;
    for (const std::uint32_t v : t) middle += Vec3(few.vertices[v]) / 3, red += few.colors[v][0] / 750.0;
    const Vec3 a(few.vertices[t[0]]), b(few.vertices[t[1]]), c(few.vertices[t[2]]);
    const double size = norm(cross(b - a, c - a));
    off += size * std::abs(red - is_red(middle.x, middle.y)), area += size;
  }
  EXPECT_LT(off / area, 0.05);
}

TEST(Simplify, IsTheSameForAnyNumberOfThreads) {
  // Large enough, and repeated, for concurrent collapses.
  const TriangleMesh ring = test::torus_mesh(300, 200);
  for (int repeat = 0; repeat < 3; ++repeat)
    test::compare_threads([&] { return simplified(ring, 2e-3); },
                          [](const TriangleMesh& one, const TriangleMesh& many) {
                            ASSERT_EQ(one.vertices, many.vertices);
                            ASSERT_EQ(one.triangles, many.triangles);
                          });
}

TEST(Simplify, InPatchesIsAsGood) {
  const TriangleMesh ring = test::torus_mesh(300, 200);
  const auto in_patches = [&](bool patches) {
    TriangleMesh mesh = ring;
    CollapseOptions options;
    options.error = 2e-3;
    options.in_patches = patches;
    Progress progress;
    EXPECT_TRUE(simplify_mesh(mesh, options, progress));
    return mesh;
  };
  test::compare_threads([&] { return in_patches(true); },
                        [](const TriangleMesh& one, const TriangleMesh& many) {
                          ASSERT_EQ(one.vertices, many.vertices);
                          ASSERT_EQ(one.triangles, many.triangles);
                        });
  const TriangleMesh patches = in_patches(true), whole = in_patches(false);
  EXPECT_LT(static_cast<double>(patches.triangles.size()), 1.15 * static_cast<double>(whole.triangles.size()));
  EXPECT_LT(patches.triangles.size(), ring.triangles.size() / 4);
  const MeshTopology topology = measure_topology(patches);
  EXPECT_TRUE(topology.manifold() && topology.oriented());
  EXPECT_EQ(topology.boundary_loops, 0u);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_GT(measure_quality(patches).smallest_angle_mean, 0.95 * measure_quality(whole).smallest_angle_mean);
  EXPECT_NEAR(measure_quality(patches).volume, measure_quality(ring).volume, 5e-3 * measure_quality(ring).volume);
}

TEST(Simplify, BadOptionsAndEmptyMeshes) {
  TriangleMesh empty;
  EXPECT_EQ(simplified(empty, 1).triangles.size(), 0u);
  EXPECT_THROW(simplified(empty, 0), ArgumentError);
  EXPECT_THROW(simplified(empty, -1), ArgumentError);
  EXPECT_THROW(simplified(empty, std::nan("")), ArgumentError);
}

TriangleMesh grid_cube(std::uint32_t n) {
  TriangleMesh mesh;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> numbers;
  const auto vertex = [&](std::array<std::uint32_t, 3> p) {
    const auto [it, fresh] = numbers.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
    const auto place = [&](std::uint32_t i) { return 2 * static_cast<float>(i) / static_cast<float>(n) - 1; };
    if (fresh) mesh.vertices.push_back({place(p[0]), place(p[1]), place(p[2])});
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t side : {0u, n})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto at = [&](std::uint32_t u, std::uint32_t v) {
            std::array<std::uint32_t, 3> p{};
            p[axis] = side, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
            return vertex(p);
          };
          std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (side == 0) std::swap(b, d);
          mesh.triangles.push_back({a, b, c});
          mesh.triangles.push_back({a, c, d});
        }
  return mesh;
}

}  // namespace
}  // namespace sansmesh::inline v1
