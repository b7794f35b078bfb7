#include "sansmesh/mesh/booleans/mesh_booleans.h"

#include "sansmesh/mesh/booleans/thin_seams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

using Kind = BooleanExpression::Kind;

SolidFaces faces_of(const TriangleMesh& mesh) {
  SolidFaces faces;
  for (const Vec3f& v : mesh.vertices) faces.vertices.emplace_back(v);
  faces.triangles = mesh.triangles;
  return faces;
}

SolidFaces box_faces(const Vec3& lower, const Vec3& upper) {
  SolidFaces f;
  for (int c = 0; c < 8; ++c)
    f.vertices.push_back({c & 1 ? upper.x : lower.x, c & 2 ? upper.y : lower.y, c & 4 ? upper.z : lower.z});
  f.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return f;
}

/// Prism of n sides around z.
SolidFaces prism(std::uint32_t n, double radius, double bottom, double top) {
  SolidFaces f;
  for (const double z : {bottom, top})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n;
      f.vertices.push_back({radius * std::cos(a), radius * std::sin(a), z});
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    f.triangles.push_back({i, j, n + j});
    f.triangles.push_back({i, n + j, n + i});
    if (i > 0 && j > 0) {
      f.triangles.push_back({0, j, i});
      f.triangles.push_back({n, n + i, n + j});
    }
  }
  return f;
}

template <class Map>
SolidFaces mapped(SolidFaces f, const Map& map) {
  for (Vec3& v : f.vertices) v = map(v);
  return f;
}

SolidFaces moved(const SolidFaces& f, const Vec3& by) {
  return mapped(f, [&](const Vec3& v) { return v + by; });
}

double volume_of(const BooleanResult& r) {
  double sum = 0;
  for (const auto& [a, b, c] : r.triangles) sum += dot(r.vertices[a], cross(r.vertices[b], r.vertices[c])) / 6;
  return sum;
}

/// Each edge has two faces in opposite directions, and the faces at each vertex are one fan.
void expect_manifold(const BooleanResult& r) {
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const Triangle& t : r.triangles)
    for (std::size_t e = 0; e < 3; ++e) ++edges[{t[e], t[(e + 1) % 3]}];
  std::map<std::uint32_t, std::size_t> degree;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> fan;
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge[1], edge[0]}));
  }
  for (const Triangle& t : r.triangles)
    for (std::size_t e = 0; e < 3; ++e) ++degree[t[e]], fan[t[e]][t[(e + 1) % 3]] = t[(e + 2) % 3];
  for (const auto& [v, next] : fan) {
    std::size_t steps = 1;
    const std::uint32_t first = next.begin()->first;
    for (std::uint32_t w = next.at(first); w != first && steps <= degree[v]; w = next.at(w)) ++steps;
    ASSERT_EQ(steps, degree[v]) << "vertex " << v;
  }
}

/// 2 · (components − handles): components are counted.
long euler_of(const BooleanResult& r) {
  return static_cast<long>(r.vertices.size()) - static_cast<long>(r.triangles.size() / 2);
}

BooleanResult combined(const std::vector<SolidFaces>& solids, const BooleanExpression& e) {
  Progress progress;
  BooleanResult r = combine_solids(solids, e, progress);
  expect_manifold(r);
  return r;
}

BooleanResult joined_all(const std::vector<SolidFaces>& solids, Kind kind) {
  BooleanExpression e;
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t s = 0; s < solids.size(); ++s) leaves.push_back(e.leaf(s));
  e.combine(kind, leaves);
  return combined(solids, e);
}
BooleanResult united(const SolidFaces& a, const SolidFaces& b) { return joined_all({a, b}, Kind::any); }
BooleanResult common(const SolidFaces& a, const SolidFaces& b) { return joined_all({a, b}, Kind::all); }
BooleanResult less(const SolidFaces& a, const SolidFaces& b) {
  BooleanExpression e;
  const std::uint32_t first = e.leaf(0), second = e.leaf(1);
  const std::uint32_t outside = e.combine(Kind::complement, {second});
  e.combine(Kind::all, {first, outside});
  return combined({a, b}, e);
}

std::array<Vec3, 3> random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vec3 x = normalized(Vec3{normal(random), normal(random), normal(random)});
  const Vec3 y = normalized(cross(x, Vec3{normal(random), normal(random), normal(random)}));
  return {x, y, cross(x, y)};
}

SolidFaces turned(const SolidFaces& f, std::mt19937& random, double spread) {
  const auto r = random_rotation(random);
  std::uniform_real_distribution<double> place(-spread, spread);
  const Vec3 by{place(random), place(random), place(random)};
  return mapped(f, [&](const Vec3& v) { return Vec3{dot(r[0], v), dot(r[1], v), dot(r[2], v)} + by; });
}

TEST(MeshBooleans, BoxesThatOverlap) {
  const SolidFaces a = box_faces({0, 0, 0}, {2, 2, 2}), b = box_faces({1, 1, 1}, {3, 3, 3});
  EXPECT_DOUBLE_EQ(volume_of(united(a, b)), 15);
  EXPECT_NEAR(volume_of(common(a, b)), 1, 1e-14);
  EXPECT_DOUBLE_EQ(volume_of(less(a, b)), 7);
  EXPECT_EQ(euler_of(united(a, b)), 2);
}

TEST(MeshBooleans, CoincidentFacesBelongToBothSolids) {
  const SolidFaces a = box_faces({0, 0, 0}, {1, 1, 1});
  // Neighbours with a common face, of equal and of different size.
  EXPECT_DOUBLE_EQ(volume_of(united(a, box_faces({1, 0, 0}, {2, 1, 1}))), 2);
  EXPECT_EQ(euler_of(united(a, box_faces({1, 0, 0}, {2, 1, 1}))), 2);
  EXPECT_DOUBLE_EQ(volume_of(united(a, box_faces({1, 0.25, -1}, {2, 0.5, 0.5}))), 1.375);
  EXPECT_TRUE(common(a, box_faces({1, 0, 0}, {2, 1, 1})).triangles.empty());
  EXPECT_DOUBLE_EQ(volume_of(less(a, box_faces({1, 0, 0}, {2, 1, 1}))), 1);
  // A pocket as deep as the box, and one beside its faces.
  EXPECT_DOUBLE_EQ(volume_of(less(a, box_faces({0.25, 0.25, 0}, {0.75, 0.75, 1}))), 0.75);
  EXPECT_EQ(euler_of(less(a, box_faces({0.25, 0.25, 0}, {0.75, 0.75, 1}))), 0);
  EXPECT_DOUBLE_EQ(volume_of(less(a, box_faces({0, 0, 0}, {0.5, 0.5, 0.5}))), 0.875);
  EXPECT_DOUBLE_EQ(volume_of(common(a, box_faces({0, 0, 0}, {0.5, 2, 0.5}))), 0.25);
}

TEST(MeshBooleans, SolidsThatAreEqual) {
  for (const SolidFaces& a : {box_faces({0, 0, 0}, {1, 2, 3}), faces_of(octasphere(3))}) {
    const BooleanResult same = united(a, a);
    EXPECT_EQ(same.triangles.size(), a.triangles.size());
    EXPECT_EQ(same.vertices, a.vertices);
    EXPECT_EQ(common(a, a).triangles.size(), a.triangles.size());
    EXPECT_TRUE(less(a, a).triangles.empty());
    EXPECT_EQ(joined_all({a, a, a, a}, Kind::any).triangles.size(), a.triangles.size());
  }
}

TEST(MeshBooleans, SolidsThatTouchAreSeparateParts) {
  const SolidFaces a = box_faces({0, 0, 0}, {1, 1, 1});
  // Along an edge; along a part of an edge; in a vertex; a vertex on a face.
  for (const Vec3& by : {Vec3{1, 1, 0}, Vec3{1, 1, 0.5}, Vec3{1, 1, 1}}) {
    const BooleanResult both = united(a, moved(a, by));
    EXPECT_DOUBLE_EQ(volume_of(both), 2);
    EXPECT_EQ(euler_of(both), 4);
    EXPECT_TRUE(common(a, moved(a, by)).triangles.empty());
  }
  const SolidFaces tip{{{0.5, 0.5, 1}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}}, {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}}};
  EXPECT_EQ(euler_of(united(a, tip)), 4);
  // A ridge that lies on a face.
  const SolidFaces ridge{{{0, 0.5, 1}, {1, 0.5, 1}, {0, 0, 2}, {0, 1, 2}},
                         {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  EXPECT_EQ(euler_of(united(a, ridge)), 4);
}

TEST(MeshBooleans, TrianglesThatNothingTouchesStay) {
  const TriangleMesh sphere = octasphere(5);
  const SolidFaces ball = faces_of(sphere);
  const BooleanResult drilled = less(ball, prism(40, 0.2, -2, 2));
  EXPECT_EQ(euler_of(drilled), 0);
  std::set<std::array<Vec3f, 3>, bool (*)(const std::array<Vec3f, 3>&, const std::array<Vec3f, 3>&)> now(
      [](const auto& a, const auto& b) {
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t k = 0; k < 3; ++k)
            if (a[i][k] != b[i][k]) return a[i][k] < b[i][k];
        return false;
      });
  for (const auto& [a, b, c] : drilled.triangles)
    now.insert({Vec3f(drilled.vertices[a]), Vec3f(drilled.vertices[b]), Vec3f(drilled.vertices[c])});
  std::size_t far = 0;
  for (const auto& [a, b, c] : sphere.triangles) {
    const auto away = [&](std::uint32_t v) { return std::hypot(sphere.vertices[v].x, sphere.vertices[v].y) > 0.3; };
    if (!away(a) || !away(b) || !away(c)) continue;
    ++far;
    EXPECT_TRUE(now.contains({sphere.vertices[a], sphere.vertices[b], sphere.vertices[c]}));
  }
  EXPECT_GT(far, 7000u);
  EXPECT_LT(drilled.triangles.size(), sphere.triangles.size() * 11 / 10);
}

TEST(MeshBooleans, VolumesOfRandomPlacementsAddUp) {
  std::mt19937 random(7);
  const SolidFaces a = faces_of(octasphere(3)), b = faces_of(torus_mesh(24, 12)),
                   c = box_faces({-1, -1, -1}, {1, 1, 1});
  const auto volume = [&](const SolidFaces& f) {
    return volume_of({.vertices = f.vertices, .triangles = f.triangles});
  };
  for (int i = 0; i < 20; ++i) {
    const SolidFaces p = turned(i % 2 ? a : b, random, 0.5), q = turned(i % 3 ? c : a, random, 0.5);
    const double both = volume_of(united(p, q)), overlap = volume_of(common(p, q));
    EXPECT_NEAR(both + overlap, volume(p) + volume(q), 1e-13 * both);
    EXPECT_NEAR(volume_of(less(p, q)), volume(p) - overlap, 1e-13 * both);
  }
}

TEST(MeshBooleans, ManySolidsAtOnce) {
  // Three slabs through each other, whose planes meet in the triangles of each other.
  const auto slab = [](std::size_t k) {
    Vec3 lower{-2, -2, -2}, upper{2, 2, 2};
    lower[k] = -0.5, upper[k] = 0.5;
    return box_faces(lower, upper);
  };
  EXPECT_DOUBLE_EQ(volume_of(joined_all({slab(0), slab(1), slab(2)}, Kind::any)), 48 - 3 * 4 + 1);
  EXPECT_DOUBLE_EQ(volume_of(joined_all({slab(0), slab(1), slab(2)}, Kind::all)), 1);
  std::mt19937 random(3);
  std::vector<SolidFaces> many;
  for (int i = 0; i < 30; ++i) many.push_back(turned(box_faces({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), random, 0.7));
  const BooleanResult all = joined_all(many, Kind::any);
  // The same in two steps.
  const std::vector<SolidFaces> half(many.begin(), many.begin() + 15), rest(many.begin() + 15, many.end());
  const BooleanResult first = joined_all(half, Kind::any), second = joined_all(rest, Kind::any);
  EXPECT_NEAR(volume_of(all), volume_of(united({first.vertices, first.triangles}, {second.vertices, second.triangles})),
              1e-12);
}

TEST(MeshBooleans, TurnedCopiesAboutACommonAxis) {
  // All axes and caps coincide: planes of equal orientation, edges through common points.
  std::vector<SolidFaces> many;
  for (int i = 0; i < 12; ++i) {
    const double a = i * std::numbers::pi / 24;
    many.push_back(mapped(box_faces({-1, -1, 0}, {1, 1, 1}), [&](const Vec3& v) {
      return Vec3{std::cos(a) * v.x - std::sin(a) * v.y, std::sin(a) * v.x + std::cos(a) * v.y, v.z};
    }));
  }
  const BooleanResult all = joined_all(many, Kind::any);
  EXPECT_EQ(euler_of(all), 2);
  EXPECT_NEAR(volume_of(joined_all(many, Kind::all)), 48 * std::tan(std::numbers::pi / 48), 1e-12);
}

/// Boxes with whole corners share planes, edges and vertices in all ways.
TEST(MeshBooleans, RandomExpressionsOfBoxesOnAGrid) {
  constexpr int kCells = 4;
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    const auto pick = [&](int a, int b) { return a + static_cast<int>(random() % static_cast<unsigned>(b - a + 1)); };
    std::vector<SolidFaces> solids;
    std::vector<std::array<Vec3, 2>> boxes;
    BooleanExpression e;
    std::vector<std::uint32_t> open;
    const int count = pick(2, 7);
    for (int i = 0; i < count; ++i) {
      std::array<Vec3, 2> box;
      for (std::size_t k = 0; k < 3; ++k) {
        const int low = pick(0, kCells - 1);
        box[0][k] = low, box[1][k] = pick(low + 1, kCells);
      }
      boxes.push_back(box);
      solids.push_back(box_faces(box[0], box[1]));
      open.push_back(e.leaf(static_cast<std::uint32_t>(i)));
    }
    while (open.size() > 1) {
      const std::uint32_t a = open[0], b = open[1];
      open.erase(open.begin(), open.begin() + 2);
      const int kind = pick(0, 2);
      const std::uint32_t second = kind == 2 ? e.combine(Kind::complement, {b}) : b;
      open.push_back(e.combine(kind == 0 ? Kind::any : Kind::all, {a, second}));
    }
    int cells = 0;
    for (int i = 0; i < kCells * kCells * kCells; ++i) {
      const int row = i / kCells, layer = row / kCells;
      const Vec3 x{i % kCells + 0.5, row % kCells + 0.5, layer + 0.5};
      BooleanState state(e, solids.size());
      for (std::uint32_t s = 0; s < boxes.size(); ++s) state.put(s, Box3{boxes[s][0], boxes[s][1]}.contains(x));
      cells += state.value();
    }
    BooleanResult r = combined(solids, e);
    EXPECT_NEAR(volume_of(r), cells, 1e-12) << "seed " << seed;
    const ThinnedSeams thinned = thin_seams(r, 1e-7);
    EXPECT_EQ(thinned.inverted, 0u);
    expect_manifold(r);
    EXPECT_NEAR(volume_of(r), cells, 1e-12) << "seed " << seed;
  }
}

/// Two bars that touch along an edge, and meet around it.
TEST(MeshBooleans, EdgesThatPartsShareTwice) {
  const BooleanResult r = joined_all({box_faces({0, 0, 0}, {1, 1, 3}), box_faces({1, 1, 0}, {2, 2, 3}),
                                      box_faces({0, 1, 0}, {1, 2, 1}), box_faces({0, 1, 2}, {1, 2, 3})},
                                     Kind::any);
  EXPECT_DOUBLE_EQ(volume_of(r), 8);
}

/// Two balls that cross in one mesh, cut through their crossing; cubes of one mesh with a common edge.
TEST(MeshBooleans, SolidsThatMeetThemselves) {
  const SolidFaces balls = faces_of(joined(octasphere(3), octasphere(3), {0.7f, 0.1f, 0.03f}));
  const SolidFaces bar = moved(prism(16, 0.4, -2, 2), {0.35, 0, 0});
  const double whole = volume_of(less(balls, bar)) + volume_of(common(balls, bar));
  EXPECT_NEAR(whole, volume_of(united(faces_of(octasphere(3)), moved(faces_of(octasphere(3)), {0.7f, 0.1f, 0.03f}))),
              1e-6);
  SolidFaces cubes = box_faces({0, 0, 0}, {1, 1, 1});
  const SolidFaces other = box_faces({1, 1, 0}, {2, 2, 1});
  const std::array<std::uint32_t, 8> names{3, 8, 9, 10, 7, 11, 12, 13};  // 3 and 7 are the common corners
  for (const std::uint32_t c : {1u, 2u, 3u, 5u, 6u, 7u}) cubes.vertices.push_back(other.vertices[c]);
  for (const Triangle& t : other.triangles) cubes.triangles.push_back({names[t[0]], names[t[1]], names[t[2]]});
  ASSERT_TRUE(encloses(cubes));
  EXPECT_NEAR(volume_of(less(cubes, box_faces({0.5, 0.5, 0.25}, {1.5, 1.5, 0.75}))), 1.75, 1e-12);
}

TEST(MeshBooleans, FlatTrianglesOfTheInput) {
  // A vertex on an edge of the top face, which one triangle without area fills.
  SolidFaces a = box_faces({0, 0, 0}, {2, 2, 2});
  a.vertices.push_back({1, 0, 2});
  a.triangles.erase(a.triangles.begin() + 2);  // (4, 5, 7)
  a.triangles.insert(a.triangles.end(), {{4, 8, 7}, {8, 5, 7}, {4, 5, 8}});
  ASSERT_TRUE(encloses(a));
  EXPECT_DOUBLE_EQ(volume_of(less(a, box_faces({0.5, -1, 1}, {1.5, 1, 3}))), 7);
}

TEST(MeshBooleans, SameForAnyNumberOfThreads) {
  const SolidFaces a = faces_of(octasphere(4));
  std::mt19937 random(1);
  std::vector<SolidFaces> many{a};
  for (int i = 0; i < 5; ++i) many.push_back(turned(a, random, 1));
  expect_equal_for_any_threads([&] {
    const BooleanResult r = joined_all(many, Kind::any);
    return std::pair(r.vertices, r.triangles);
  });
}

TEST(MeshBooleans, FacesThatEnclose) {
  SolidFaces a = box_faces({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(encloses(a));
  std::swap(a.triangles[0][0], a.triangles[0][1]);
  EXPECT_FALSE(encloses(a));
  a.triangles.erase(a.triangles.begin());
  EXPECT_FALSE(encloses(a));
}

}  // namespace
}  // namespace sansmesh::test
