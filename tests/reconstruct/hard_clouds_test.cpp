// Difficulties of real clouds in isolation, on known shapes: limbs, holes, strong noise, misaligned scans, wrong
// normals, broken faces, steps of a depth camera. With default options, each gives a closed manifold with the
// components and handles of its shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/reconstruct.h"
#include "support/clouds.h"
#include "support/places.h"
#include "support/thin_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

constexpr int kUnknown = -1;  ///< undetermined: vegetation, loose triangles, a scene seen from one side

struct HardCloud {
  const char* name;
  PointSet (*make)();
  int components = 1;
  int genus = 0;
  bool open = false;  ///< bounds no solid: ends where the samples end
};
void PrintTo(const HardCloud& c, std::ostream* out) { *out << c.name; }

/// Signed distance of a capsule from a to b.
double capsule(const Vec3& x, const Vec3& a, const Vec3& b, double radius) {
  const double t = std::clamp(dot(x - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return norm(x - a - (b - a) * t) - radius;
}

/// A body with four legs, a neck and a head: limbs close together, with blended joints.
const test::ThinShape& animal() {
  static const test::ThinShape shape = [] {
    test::ThinShape s;
    s.box = {{-1.2, -0.6, -1.0}, {1.4, 0.6, 1.1}};
    s.value = [](const Vec3& x) {
      double sum = 0;
      const auto add = [&](double d) { sum += std::exp(-24 * d); };
      add(capsule(x, {-0.7, 0, 0}, {0.6, 0, 0}, 0.35));
      for (const double side : {-0.22, 0.22})
        for (const double end : {-0.65, 0.55}) add(capsule(x, {end, side, 0}, {end, side, -0.8}, 0.11));
      add(capsule(x, {0.6, 0, 0.1}, {0.95, 0, 0.7}, 0.14));
      add(capsule(x, {0.95, 0, 0.7}, {1.15, 0, 0.62}, 0.17));
      return -std::log(sum) / 24;
    };
    return s;
  }();
  return shape;
}

PointSet with_normals() {
  static const PointSet cloud = test::even_samples(animal(), 0.04);
  return cloud;
}

PointSet without_normals() {
  PointSet cloud = with_normals();
  cloud.normals.clear();
  return cloud;
}

void add_noise(PointSet& cloud, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  for (Vec3f& p : cloud.positions) p = Vec3f(Vec3(p) + Vec3{gauss(random), gauss(random), gauss(random)} * deviation);
}

/// Noise of a third of the spacing.
PointSet noisy() {
  PointSet cloud = without_normals();
  add_noise(cloud, 0.013, 2);
  return cloud;
}

/// Ten views from around and above, each of the samples that face it, off by a few hundredths of the spacing.
PointSet aligned_scans() {
  const PointSet all = with_normals();
  PointSet cloud;
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  for (std::uint16_t s = 0; s < 10; ++s) {
    const Vec3 scanner{6 * std::cos(0.63 * s), 6 * std::sin(0.63 * s), s % 3 * 3.0 - 3};
    const Vec3 shift = Vec3{gauss(random), gauss(random), gauss(random)} * 0.002;
    cloud.scanners.emplace_back(scanner);
    for (std::size_t i = s % 3; i < all.size(); i += 3) {
      const Vec3 p(all.positions[i]), ray = normalized(scanner - p);
      if (dot(ray, Vec3(all.normals[i])) < 0.3) continue;
      cloud.positions.emplace_back(p + shift + ray * (0.003 * gauss(random)));
      cloud.scan_of_point.push_back(s);
    }
  }
  return cloud;
}

/// Normals along the correct lines, all turned to the same side of the axes.
PointSet one_sided_normals() {
  PointSet cloud = test::cube(9000);
  for (Vec3f& n : cloud.normals) n = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  return cloud;
}

/// Noise, normals off by tens of degrees, and one random sample in twenty.
PointSet noise_and_outliers() {
  PointSet cloud = test::sphere(8000, 0.04);
  std::mt19937 random(4);
  std::normal_distribution<float> gauss;
  std::uniform_real_distribution<float> unit(-1.5f, 1.5f);
  for (Vec3f& n : cloud.normals) n = normalized(n + Vec3f{gauss(random), gauss(random), gauss(random)} * 0.25f);
  for (int i = 0; i < 400; ++i) {
    cloud.positions.push_back({unit(random), unit(random), unit(random)});
    cloud.normals.push_back({0, 0, 1});
  }
  return cloud;
}

/// 1,400 samples of a ring that is as thin as three spacings.
PointSet sparse_and_thin() {
  const test::ThinShape ring = test::linked_tori(1, 0.12);
  return test::even_samples(ring, 0.06);
}

PointSet four_handles() {
  PointSet cloud = test::even_samples(test::perforated_plate(0.3, 2, false), 0.05);
  cloud.normals.clear();
  return cloud;
}

/// Half a ball, dense on one side and sparse on the other, with round holes.
PointSet partial_and_uneven() {
  const PointSet whole = test::sphere(12000);
  PointSet cloud;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const Vec3f p = whole.positions[i];
    if (p.z < -0.1f || (p.x < 0 && i % 5 != 0)) continue;
    if (norm(p - Vec3f{0.8f, 0, 0.6f}) < 0.15f || norm(p - Vec3f{0, 0.8f, 0.6f}) < 0.2f) continue;
    cloud.positions.push_back(p);
    cloud.normals.push_back(whole.normals[i]);
  }
  return cloud;
}

/// Hills, and points at random heights above a third of them, in survey coordinates.
PointSet terrain() {
  PointSet cloud;
  cloud.origin = {636000, 849000, 400};
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 8000; ++i) {
    const double x = 300 * unit(random), y = 200 * unit(random);
    const bool tree = x > 200 && unit(random) < 0.5;
    const double z = 10 * std::sin(0.02 * x) * std::cos(0.03 * y) + (tree ? 12 * unit(random) : 0.05 * unit(random));
    cloud.positions.push_back(Vec3f(Vec3{x, y, z}));
  }
  return cloud;
}

/// View of a depth camera at the origin: a ball in front of a wall, in steps that grow with the square of the distance.
PointSet depth_frame() {
  PointSet cloud;
  cloud.scanners = {{0, 0, 0}};
  const Vec3 center{0.2, 0.1, 1.8};
  for (int row = 0; row < 72; ++row)
    for (int column = 0; column < 96; ++column) {
      const Vec3 ray{(column - 47.5) / 80, (row - 35.5) / 80, 1};
      const double b = dot(ray, center), a = dot(ray, ray), inside = b * b - a * (dot(center, center) - 0.16);
      const double depth = inside > 0 ? (b - std::sqrt(inside)) / a : 3;
      const double step = 0.0028 * depth * depth;
      cloud.positions.emplace_back(ray * (step * std::round(depth / step)));
    }
  cloud.scan_of_point.assign(cloud.size(), 0);
  return cloud;
}

// -------------------------------------------------------------------------------------------------------- faces

/// The ball [-1, 1]³ as a closed grid of `rows` × 2·`rows` quads, divided into triangles.
PointSet ball_of_faces(std::uint32_t rows, const Vec3f& by = {}) {
  PointSet mesh;
  const std::uint32_t columns = 2 * rows;
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return i == 0 ? 0 : i == rows ? 1 : 2 + (i - 1) * columns + j % columns;
  };
  mesh.positions = {Vec3f{0, 0, 1} + by, Vec3f{0, 0, -1} + by};
  for (std::uint32_t i = 1; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rows, phi = std::numbers::pi * j / rows;
      mesh.positions.push_back(
          Vec3f(Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}) + by);
    }
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < rows) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  return mesh;
}

PointSet both(PointSet a, const PointSet& b) {
  const auto shift = static_cast<std::uint32_t>(a.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

/// Closed, but self-intersecting.
PointSet through_itself() { return both(ball_of_faces(40), ball_of_faces(40, {0.9f, 0.1f, 0})); }

/// A bent pipe that is open at both ends.
PointSet open_pipe() {
  PointSet mesh;
  const std::uint32_t rings = 60, around = 24;
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / around, r = 1 + 0.3 * std::cos(b);
      mesh.positions.push_back(Vec3f(Vec3{r * std::cos(a), r * std::sin(a), 0.3 * std::sin(b) + 0.2 * a}));
    }
  for (std::uint32_t i = 0; i + 1 < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t p = i * around + j, q = i * around + (j + 1) % around;
      mesh.triangles.push_back({p, p + around, q});
      mesh.triangles.push_back({q, p + around, q + around});
    }
  return mesh;
}

/// Five holes, and unused vertices inside.
PointSet holes_and_unused_vertices() {
  PointSet mesh = ball_of_faces(50);
  std::erase_if(mesh.triangles, [&](const auto& t) {
    for (int k = 0; k < 5; ++k) {
      const Vec3f c{0.6f * std::cos(1.2566f * static_cast<float>(k)), 0.6f * std::sin(1.2566f * static_cast<float>(k)),
                    -0.8f};
      if (norm(mesh.positions[t[0]] - c) < 0.15f) return true;
    }
    return false;
  });
  for (int i = 0; i < 100; ++i) mesh.positions.push_back({0.001f * static_cast<float>(i), 0.2f, 0});
  return mesh;
}

/// One face in four is missing.
PointSet a_quarter_missing() {
  PointSet mesh = ball_of_faces(40);
  std::mt19937 random(7);
  std::erase_if(mesh.triangles, [&](const auto&) { return random() % 4 == 0; });
  return mesh;
}

/// Edges with more than two faces: some faces are duplicated, some inverted, and fins stick out where three meet.
PointSet not_manifold() {
  PointSet mesh = ball_of_faces(50);
  const Triangles faces = mesh.triangles;
  for (std::size_t i = 0; i < faces.size(); i += 7) mesh.triangles.push_back({faces[i][0], faces[i][2], faces[i][1]});
  for (std::size_t i = 3; i < faces.size(); i += 11) mesh.triangles.push_back(faces[i]);
  for (std::size_t i = 5; i < faces.size(); i += 400) {
    const auto tip = static_cast<std::uint32_t>(mesh.size());
    mesh.positions.push_back(mesh.positions[faces[i][0]] * 1.02f);
    mesh.triangles.push_back({faces[i][0], faces[i][1], tip});
  }
  return mesh;
}

/// A chair of intersecting boxes, with every face duplicated. Sampled here, with fewer samples than `reconstruct` would
/// take of such large faces, to save time.
PointSet chair() {
  PointSet mesh;
  const auto box = [&](const Vec3f& low, const Vec3f& high) {
    const auto first = static_cast<std::uint32_t>(mesh.size());
    for (int i = 0; i < 8; ++i)
      mesh.positions.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    for (const auto& t : Triangles{{0, 2, 3},
                                   {0, 3, 1},
                                   {4, 5, 7},
                                   {4, 7, 6},
                                   {0, 1, 5},
                                   {0, 5, 4},
                                   {2, 6, 7},
                                   {2, 7, 3},
                                   {0, 4, 6},
                                   {0, 6, 2},
                                   {1, 3, 7},
                                   {1, 7, 5}})
      for (int copy = 0; copy < 2; ++copy) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  };
  box({-0.5f, -0.5f, -0.05f}, {0.5f, 0.5f, 0.05f});
  box({-0.5f, 0.4f, -0.05f}, {0.5f, 0.5f, 1});
  for (const float x : {-0.48f, 0.36f})
    for (const float y : {-0.48f, 0.36f}) box({x, y, -0.8f}, {x + 0.12f, y + 0.12f, 0});
  return sample_faces(mesh, 8000);
}

PointSet loose_triangles() {
  PointSet mesh;
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::uint32_t t = 0; t < 12; ++t) {
    for (int k = 0; k < 3; ++k) mesh.positions.push_back({unit(random), unit(random), unit(random)});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return sample_faces(mesh, 2000);
}

class HardClouds : public ::testing::TestWithParam<HardCloud> {};

TEST_P(HardClouds, GiveManifoldsClosedIfSolid) {
  Progress progress;
  const auto [mesh, report, notes] = reconstruct(GetParam().make(), {}, progress);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_EQ(report.open, GetParam().open);
  EXPECT_EQ(topology.closed(), !GetParam().open);
  EXPECT_TRUE(topology.manifold());
  EXPECT_GT(topology.components, 0u);
  if (GetParam().components != kUnknown) {
    EXPECT_EQ(topology.components, static_cast<std::size_t>(GetParam().components));
  }
  if (GetParam().genus != kUnknown) {
    EXPECT_EQ(topology.genus(), GetParam().genus);
  }
}

INSTANTIATE_TEST_SUITE_P(Points, HardClouds,
                         ::testing::Values(HardCloud{"Limbs", with_normals},
                                           HardCloud{"LimbsWithoutNormals", without_normals}, HardCloud{"Noisy", noisy},
                                           HardCloud{"AlignedScans", aligned_scans},
                                           HardCloud{"OneSidedNormals", one_sided_normals},
                                           HardCloud{"NoiseAndOutliers", noise_and_outliers},
                                           HardCloud{"SparseAndThin", sparse_and_thin, 1, 1},
                                           HardCloud{"FourHandles", four_handles, 1, 4},
                                           HardCloud{"PartialAndUneven", partial_and_uneven, 1, 0, true},
                                           HardCloud{"Terrain", terrain, kUnknown, kUnknown, true},
                                           HardCloud{"DepthFrame", depth_frame, kUnknown, kUnknown, true}),
                         [](const auto& of) { return std::string(of.param.name); });
INSTANTIATE_TEST_SUITE_P(Faces, HardClouds,
                         ::testing::Values(HardCloud{"ThroughItself", through_itself, 1, kUnknown},
                                           HardCloud{"OpenPipe", open_pipe},
                                           HardCloud{"HolesAndUnusedVertices", holes_and_unused_vertices},
                                           HardCloud{"AQuarterMissing", a_quarter_missing},
                                           HardCloud{"NotManifold", not_manifold},
                                           HardCloud{"Chair", chair, kUnknown, kUnknown},
                                           HardCloud{"LooseTriangles", loose_triangles, kUnknown, kUnknown, true}),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(HardClouds, BundledScan) {
  Progress progress;
  const PointSet scan = read_points(test::source_file("examples/data/owl.vtp"));
  const MeshTopology topology = measure_topology(reconstruct(scan, {}, progress).mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.genus(), 0);
}

/// Few large faces with exact edges, as CAD programs export them.
TEST(HardClouds, DesignedPart) {
  Progress progress;
  const PointSet part = read_points(test::source_file("tests/data/plate_holes.STL"));
  const MeshTopology topology = measure_topology(reconstruct(part, {}, progress).mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.genus(), 5);
}

}  // namespace
}  // namespace sansmesh::inline v1
