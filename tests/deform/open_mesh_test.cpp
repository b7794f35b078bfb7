// Meshes opened along cuts, and the faces that close them again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "deform/cut_support.h"
#include "sansmesh/deform/cuts/mesh_occluder.h"
#include "sansmesh/deform/cuts/open_mesh.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh/repair/planar_fill.h"
#include "sansmesh/mesh_measures.h"
#include "support/mesh_checks.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using Cuts = std::vector<std::shared_ptr<const Occluder>>;

/// Moves the side of a plane's normal by `shift` along it.
class Parting final : public SpaceMap {
 public:
  Parting(Vec3 origin, Vec3 normal, double shift) : origin_(origin), normal_(normalized(normal)), shift_(shift) {}
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool above = dot(x[i] - origin_, normal_) >= 0;
      if (!wanted.positions.empty()) wanted.positions[i] = x[i] + normal_ * (above ? shift_ : 0);
      if (!wanted.jacobians.empty()) wanted.jacobians[i] = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    }
  }

 private:
  Vec3 origin_, normal_;
  double shift_;
};

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += dot(Vec3(mesh.vertices[t[0]]), cross(Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]))) / 6;
  return sum;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    sum += 0.5 * norm(cross(b - a, c - a));
  }
  return sum;
}

/// Number of triangles that the cut crosses in their interior, away from corners, edges and the cut's border.
std::size_t crossed(const TriangleMesh& mesh, const Occluder& cut) {
  std::size_t count = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    const Vec3 middle = (a + b + c) / 3.0;
    bool found = false;
    for (const Vec3& p : {a, b, c}) found = found || test::blocked(cut, middle, p + (middle - p) * 0.02);
    count += found;
  }
  return count;
}

/// A half-plane that begins far away: it cuts anything not larger than 10.
std::shared_ptr<const Occluder> whole_plane(const Vec3& through, const Vec3& normal) {
  const Vec3 into = std::abs(normal.x) > std::abs(normal.y) ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  return half_plane(through - into * 10.0, normal, into);
}

TEST(OpenMesh, NothingIsCutWhereNoCutIs) {
  TriangleMesh mesh = test::octasphere(3);
  mesh.attributes.set("number", std::vector<float>(mesh.vertices.size(), 2));
  const TriangleMesh opened = open_along_cuts(mesh, Cuts{half_plane({2, 0, 0}, {0, 0, 1}, {1, 0, 0})});
  EXPECT_EQ(opened.vertices, mesh.vertices);
  EXPECT_EQ(opened.triangles, mesh.triangles);
  EXPECT_EQ(opened.attributes, mesh.attributes);
}

TEST(OpenMesh, AHalfPlaneThroughASphereMakesASlit) {
  const TriangleMesh mesh = test::octasphere(4);
  const auto cut = half_plane({0.31, 0, 0}, {0.1, 0.2, 1}, {1, 0, 0.1});
  OpenMeshReport report;
  const TriangleMesh opened = open_along_cuts(mesh, Cuts{cut}, {}, &report);
  EXPECT_EQ(report.unopened, 0u);
  EXPECT_GT(report.edges, 20u);
  EXPECT_EQ(report.doubled, report.edges - 1);  // except for its two ends
  const MeshTopology topology = measure_topology(opened);
  EXPECT_EQ(topology.euler, 1);  // a disk: the sphere minus one slit
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_EQ(topology.boundary_edges, 2 * report.edges);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_TRUE(topology.manifold() && topology.oriented());
  EXPECT_GT(crossed(mesh, *cut), 20u);
  EXPECT_EQ(crossed(opened, *cut), 0u);
  EXPECT_NEAR(area(opened), area(mesh), 1e-5);
  EXPECT_NEAR(volume(opened), volume(mesh), 1e-5);
  // Ends with the half-plane: vertices on its border.
  int ends = 0;
  for (const Vec3f& v : opened.vertices)
    ends += std::abs(cut->height(Vec3(v))) < 1e-6 && std::abs(cut->depth(cut->in_plane(Vec3(v)), nullptr)) < 1e-6;
  EXPECT_EQ(ends, 2);
}

TEST(OpenMesh, APlaneThroughASphereMakesTwoClosedSolids) {
  const TriangleMesh mesh = test::octasphere(4);
  for (const Vec3& through : {Vec3{0, 0, 0}, Vec3{0.1, 0.2, 0.31}}) {  // the first through vertices
    const Cuts cuts{whole_plane(through, {0, 0, 1})};
    const TriangleMesh opened = open_along_cuts(mesh, cuts);
    const MeshTopology open = measure_topology(opened);
    EXPECT_EQ(open.euler, 2);  // two disks
    EXPECT_EQ(open.boundary_loops, 2u);
    EXPECT_EQ(open.components, 2u);

    OpenMeshOptions options;
    options.close = true;
    OpenMeshReport report;
    const TriangleMesh closed = open_along_cuts(mesh, cuts, options, &report);
    EXPECT_EQ(report.unclosed, 0u);
    const MeshTopology topology = measure_topology(closed);
    EXPECT_TRUE(topology.closed());
    EXPECT_EQ(topology.components, 2u);
    EXPECT_EQ(topology.euler, 4);
    EXPECT_TRUE(test::topology_of(closed).closed_manifold());
    EXPECT_NEAR(volume(closed), volume(mesh), 1e-5);
    // The volume below each cap is that of the part of the sphere.
    const MeshComponents parts = find_components(closed);
    double below = 0;
    for (std::size_t i = 0; i < closed.triangles.size(); ++i)
      if (parts.of_triangle[i] == 0) {
        const Triangle& t = closed.triangles[i];
        below += dot(Vec3(closed.vertices[t[0]]), cross(Vec3(closed.vertices[t[1]]), Vec3(closed.vertices[t[2]]))) / 6;
      }
    const double h = 1 + through.z;
    EXPECT_NEAR(below, std::numbers::pi * h * h * (3 - h) / 3, 0.02 * 4.2);

    // After separation, both parts are in place, and the faces are flat.
    const TriangleMesh moved = deform_mesh(closed, Parting(through, {0, 0, 1}, 0.5));
    EXPECT_NEAR(volume(moved), volume(mesh), 1e-4);
    EXPECT_EQ(moved.attributes.find(kCutSide), nullptr);
    for (std::size_t v = 0; v < moved.vertices.size(); ++v) {
      const double z = static_cast<double>(moved.vertices[v].z) - through.z;
      EXPECT_TRUE(z < 1e-5 || z > 0.5 - 1e-5) << z;
    }
  }
}

TEST(OpenMesh, SlitsInSolidsAreClosed) {
  const TriangleMesh mesh = test::octasphere(4);
  OpenMeshOptions options;
  options.close = true;
  const auto cut = half_plane({0.31, 0, 0}, {0.1, 0.2, 1}, {1, 0, 0.1});
  const auto square = polygon_occluder({{{0.1, -0.4, 0.05}, {1.5, -0.4, 0.05}, {1.5, 0.5, 0.05}, {0.1, 0.5, 0.05}},
                                        {{0.3, 0, 0.05}, {0.4, 0, 0.05}, {0.4, 0.1, 0.05}}});
  for (const std::shared_ptr<const PlanarOccluder>& one : {cut, square}) {
    OpenMeshReport report;
    const TriangleMesh closed = open_along_cuts(mesh, Cuts{one}, options, &report);
    EXPECT_EQ(report.unclosed, 0u);
    EXPECT_GT(report.faces, 50u);
    const MeshTopology topology = measure_topology(closed);
    EXPECT_TRUE(topology.closed());
    EXPECT_EQ(topology.euler, one == cut ? 2 : 0);  // the hole in the square joins both sides: a handle
    EXPECT_NEAR(volume(closed), volume(mesh), 1e-5);
    EXPECT_EQ(crossed(open_along_cuts(mesh, Cuts{one}), *one), 0u);
  }
}

TEST(OpenMesh, SolidsThatFaceInwardAreClosedInward) {
  TriangleMesh mesh = test::octasphere(3);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  OpenMeshOptions options;
  options.close = true;
  OpenMeshReport report;
  const TriangleMesh closed =
      open_along_cuts(mesh, Cuts{half_plane({0.31, 0, 0}, {0.1, 0.2, 1}, {1, 0, 0.1})}, options, &report);
  EXPECT_EQ(report.unclosed, 0u);
  EXPECT_TRUE(measure_topology(closed).closed());
  EXPECT_NEAR(volume(closed), volume(mesh), 1e-5);
  EXPECT_NEAR(area(closed), area(mesh) + 2 * 0.5 * (std::numbers::pi - 2 * std::asin(0.31) - 2 * 0.31 * 0.95), 0.1);
}

TEST(OpenMesh, SeveralCutsAndManyPlaces) {
  const TriangleMesh mesh = test::torus_mesh(40, 24);
  OpenMeshOptions options;
  options.close = true;
  std::mt19937 random(8);
  for (int i = 0; i < 12; ++i) {
    const Vec3 n = normalized(test::random_point(random)), p = test::random_point(random, 0.4);
    Vec3 t, b;
    tangent_frame(n, t, b);
    const Cuts cuts{half_plane(p, n, t)};
    OpenMeshReport report;
    const TriangleMesh closed = open_along_cuts(mesh, cuts, options, &report);
    if (report.edges == 0) continue;
    EXPECT_EQ(report.unopened, 0u) << i;
    EXPECT_EQ(report.unclosed, 0u) << i;
    EXPECT_TRUE(measure_topology(closed).closed()) << i;
    EXPECT_NEAR(volume(closed), volume(mesh), 1e-4);
    EXPECT_EQ(crossed(open_along_cuts(mesh, cuts), *cuts[0]), 0u);
  }
  // Three orthogonal planes: eight pieces of a sphere.
  const Cuts three{whole_plane({0, 0, 0.05}, {0, 0, 1}), whole_plane({0.1, 0, 0}, {1, 0, 0}),
                   whole_plane({0, 0, 0}, {0, 1, 0})};
  OpenMeshReport report;
  const TriangleMesh eight = open_along_cuts(test::octasphere(4), three, options, &report);
  EXPECT_EQ(report.unclosed, 0u);
  EXPECT_TRUE(measure_topology(eight).closed());
  EXPECT_EQ(measure_topology(eight).components, 8u);
  EXPECT_NEAR(volume(eight), volume(test::octasphere(4)), 1e-4);
}

TEST(OpenMesh, CutsAlongTheMeshsOwnEdges) {
  const TriangleMesh mesh = test::octasphere(4);  // with vertices and edges in z = 0
  OpenMeshOptions options;
  options.close = true;
  std::vector<std::shared_ptr<const Occluder>> all = {
      half_plane({0.1, 0, 0}, {0, 0, 1}, {1, 0, 0}), half_plane({0.1, 0, 0}, {0, 0, -1}, {1, 0.3, 0}),
      half_plane({0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
      polygon_occluder({{{0.31, -2, 0}, {2, -2, 0}, {2, 2, 0}, {0.31, 2, 0}}})};
  for (const double turn : {0.0, 0.7}) {  // rotated, they are in the plane up to rounding
    const Vec3 x{1, 0, 0}, y{0, std::cos(turn), std::sin(turn)}, z = cross(x, y);
    TriangleMesh turned = mesh;
    for (Vec3f& v : turned.vertices) v = Vec3f(x * double{v.x} + y * double{v.y} + z * double{v.z});
    if (turn > 0) all = {half_plane(x * 0.1, z, x), half_plane(x * 0.1, -z, x + y * 0.3), half_plane({}, z, x)};
    for (std::size_t c = 0; c < all.size(); ++c) {
      OpenMeshReport report;
      const TriangleMesh opened = open_along_cuts(turned, Cuts{all[c]}, {}, &report);
      EXPECT_EQ(report.unopened, 0u) << turn << ' ' << c;
      EXPECT_EQ(measure_topology(opened).boundary_loops, 1u) << turn << ' ' << c;
      EXPECT_LT(report.edges, 60u);
      EXPECT_EQ(crossed(opened, *all[c]), 0u) << turn << ' ' << c;
      const TriangleMesh closed = open_along_cuts(turned, Cuts{all[c]}, options, &report);
      EXPECT_EQ(report.unclosed, 0u);
      EXPECT_TRUE(measure_topology(closed).closed());
      EXPECT_NEAR(volume(closed), volume(turned), 1e-5);
    }
  }
}

/// Number of triangles whose corners are evaluated on different sides of a plane.
std::size_t mixed_triangles(const TriangleMesh& mesh, const PlanarOccluder& cut) {
  const std::vector<float>& sides = *mesh.attributes.find<float>(kCutSide);
  std::size_t mixed = 0;
  for (const Triangle& t : mesh.triangles) {
    std::size_t above = 0;
    for (const std::uint32_t v : t)
      above += cut.height(mesh.origin + Vec3(mesh.vertices[v]) +
                          Vec3(Vec3f{sides[3 * v], sides[3 * v + 1], sides[3 * v + 2]})) >= 0;
    mixed += above % 3 != 0;
  }
  return mixed;
}

TEST(OpenMesh, SidesAreKnownFarFromTheOrigin) {
  const Vec3 normal = normalized(Vec3{0.3, 0.2, 1}), along = normalized(Vec3{1, 0, 0} - normal * normal.x);
  for (const float far : {0.0f, 100.0f, 1000.0f})
    for (const bool companion : {false, true}) {  // far on the other side: the common centre is the origin
      if (companion && far > 100) continue;       // there rounding is a hundredth of an edge
      TriangleMesh mesh = test::octasphere(5);
      for (Vec3f& v : mesh.vertices) v = v + Vec3f{far, far, far};
      if (companion) {
        const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3f& v : {Vec3f{-1, -1, -1}, Vec3f{-1.5f, -1, -1}, Vec3f{-1, -1.5f, -1}})
          mesh.vertices.push_back(v * (far + 1));
        mesh.triangles.push_back({n, n + 1, n + 2});
      }
      const Vec3 middle{far, far, far};
      const auto place = [&](const TriangleMesh& of, std::size_t v) { return of.origin + Vec3(of.vertices[v]); };
      for (const double height : {0.0, 0.9}) {
        const auto cut = half_plane(middle + normal * height - along * 9.0, normal, along);
        OpenMeshReport report;
        const TriangleMesh opened = open_along_cuts(mesh, Cuts{cut}, {}, &report);
        EXPECT_GT(report.edges, 50u);
        EXPECT_EQ(mixed_triangles(opened, *cut), 0u) << far << ' ' << companion << ' ' << height;
        if (!companion) EXPECT_EQ(report.unopened, 0u) << far << ' ' << height;
        std::size_t moved = 0;  // except those moved onto the cut
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) moved += place(opened, v) != place(mesh, v);
        EXPECT_LT(moved, 10u);
        if (companion) continue;
        OpenMeshOptions options;
        options.close = true;
        const TriangleMesh closed = open_along_cuts(mesh, Cuts{cut}, options, &report);
        EXPECT_EQ(report.unclosed, 0u);
        EXPECT_EQ(mixed_triangles(closed, *cut), 0u);
        EXPECT_EQ(measure_topology(closed).components, 2u);
      }
    }
}

TEST(OpenMesh, MeshesAsCuts) {
  // A dome above the equator, through a finer sphere.
  TriangleMesh dome;
  constexpr std::uint32_t n = 12;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = -0.17 + 2.0 * i / n, y = -1.53 + 3.0 * j / n;
      dome.vertices.push_back(Vec3f(Vec3{x, y, 0.311 - 0.2 * x * x - 0.1 * y * y}));
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      dome.triangles.push_back({a, a + 1, a + n + 2});
      dome.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  MeshOccluderOptions coarse;
  coarse.resolution = 8;
  const TriangleMesh mesh = test::octasphere(5);
  const Cuts cuts{mesh_occluder(dome, coarse)};
  OpenMeshReport report;
  OpenMeshOptions options;
  options.close = true;
  const TriangleMesh opened = open_along_cuts(mesh, cuts, options, &report);
  EXPECT_EQ(report.unopened, 0u);
  EXPECT_EQ(report.unclosed, 1u);  // meshes leave the cut part open
  const MeshTopology topology = measure_topology(opened);
  EXPECT_EQ(topology.euler, 1);
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_TRUE(topology.manifold());
}

TEST(OpenMesh, CutsSmallerThanTriangles) {
  TriangleMesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1.5f, 0}};
  mesh.triangles = {{0, 1, 2}};
  const auto small = polygon_occluder({{{-0.11, 0.03, -1}, {0.13, 0.05, -1}, {0.13, 0.05, 1}, {-0.11, 0.03, 1}}});
  OpenMeshReport report;
  const TriangleMesh opened = open_along_cuts(mesh, Cuts{small}, {}, &report);
  EXPECT_EQ(report.unopened, 0u);
  EXPECT_EQ(measure_topology(opened).boundary_loops, 2u);
  EXPECT_EQ(measure_topology(opened).euler, 0);
  EXPECT_EQ(crossed(opened, *small), 0u);
}

TEST(OpenMesh, AttributesAreMixed) {
  TriangleMesh mesh = test::octasphere(3);
  std::vector<float> x;
  for (const Vec3f& v : mesh.vertices) x.push_back(v.x + 2 * v.z);
  mesh.attributes.set("x", x);
  mesh.triangle_attributes.set("number", std::vector<std::int32_t>(mesh.triangles.size(), 3));
  OpenMeshOptions options;
  options.close = true;
  const TriangleMesh opened =
      open_along_cuts(mesh, Cuts{half_plane({0.31, 0, 0}, {0.1, 0.2, 1}, {1, 0, 0.1})}, options);
  opened.attributes.check_rows(opened.vertices.size(), "vertices");
  opened.triangle_attributes.check_rows(opened.triangles.size(), "triangles");
  const TriangleMesh open = open_along_cuts(mesh, Cuts{half_plane({0.31, 0, 0}, {0.1, 0.2, 1}, {1, 0, 0.1})});
  const std::vector<float>& now = *open.attributes.find<float>("x");
  for (std::size_t v = 0; v < now.size(); ++v) EXPECT_NEAR(now[v], open.vertices[v].x + 2 * open.vertices[v].z, 1e-5);
}

/// The vertex of the mesh nearest to a point.
std::uint32_t vertex_near(const TriangleMesh& mesh, const Vec3f& place) {
  const auto nearest = std::min_element(
      mesh.vertices.begin(), mesh.vertices.end(),
      [&](const Vec3f& a, const Vec3f& b) { return squared_norm(a - place) < squared_norm(b - place); });
  return static_cast<std::uint32_t>(nearest - mesh.vertices.begin());
}

TEST(OpenMesh, CornersThatAreNowhereTellNoSides) {
  const Cuts cuts{half_plane({0.31, 0, 0}, {0, 0, 1}, {1, 0, 0})};  // along edges of the sphere
  OpenMeshReport whole, report;
  open_along_cuts(test::octasphere(4), cuts, {}, &whole);
  for (const float nowhere : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    TriangleMesh mesh = test::octasphere(4);
    mesh.vertices[vertex_near(mesh, {0.9f, 0.1f, 0.06f})] = {0, nowhere, 0};  // beside the cut
    const TriangleMesh opened = open_along_cuts(mesh, cuts, {}, &report);
    EXPECT_EQ(report.edges, whole.edges);
    EXPECT_EQ(report.doubled, whole.doubled);
    const std::vector<float>& sides = *opened.attributes.find<float>(kCutSide);
    EXPECT_TRUE(std::all_of(sides.begin(), sides.end(), [](float s) { return std::isfinite(s); }));
    EXPECT_EQ(measure_topology(opened).boundary_loops, 1u);
    EXPECT_TRUE(measure_topology(opened).manifold());
  }
}

TEST(OpenMesh, TrianglesThatAreNoneChangeNothing) {
  OpenMeshOptions options;
  options.close = true;
  const Cuts cuts{whole_plane({0, 0, 0}, {0, 0, 1})};  // along edges of the sphere
  TriangleMesh mesh = test::octasphere(3);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  OpenMeshReport report;
  const TriangleMesh closed = open_along_cuts(mesh, cuts, options, &report);
  ASSERT_EQ(report.unclosed, 0u);
  // Invalid corners, and edges instead of triangles, some along the cut.
  const std::uint32_t on = vertex_near(mesh, {1, 0, 0}), next = vertex_near(mesh, {0.98f, 0.19f, 0}), far = 1u << 31;
  const std::vector<Triangle> none{{on, next, far}, {far, on, far + 1}, {on, next, next}, {next, on, on}};
  mesh.triangles.insert(mesh.triangles.begin(), none.begin(), none.end());
  const TriangleMesh more = open_along_cuts(mesh, cuts, options, &report);
  EXPECT_EQ(report.unclosed, 0u);
  EXPECT_TRUE(measure_topology(more).closed());
  EXPECT_EQ(measure_topology(more).components, 2u);
  EXPECT_EQ(more.triangles.size(), closed.triangles.size() + none.size());
  EXPECT_NEAR(measure_size(more).volume, measure_size(closed).volume, 1e-6);
  const TriangleMesh moved = deform_mesh(more, Parting({0, 0, 0}, {0, 0, 1}, 0.5));
  EXPECT_NEAR(measure_size(moved).volume, measure_size(closed).volume, 1e-4);
}

TEST(OpenMesh, BadOptionsAreRefused) {
  OpenMeshOptions options;
  options.refinements = 13;
  EXPECT_THROW(open_along_cuts({}, {}, options), ArgumentError);
  options = {};
  options.face_edges = 0;
  EXPECT_THROW(open_along_cuts({}, {}, options), ArgumentError);
}

TEST(FillPlanar, HolesAndTurns) {
  std::vector<std::vector<std::array<double, 2>>> loops = {{{0, 0}, {4, 0}, {4, 3}, {2, 1}, {0, 3}},
                                                           {{1, 0.5}, {1, 0.8}, {1.3, 0.8}, {1.3, 0.5}},
                                                           {{3, 0.5}, {3, 0.8}, {3.3, 0.5}}};
  std::size_t given = 0;
  for (auto& loop : loops) {  // with more corners along its edges
    std::vector<std::array<double, 2>> finer;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto &a = loop[i], &b = loop[(i + 1) % loop.size()];
      const int n = static_cast<int>(std::ceil(std::hypot(b[0] - a[0], b[1] - a[1]) / 0.19));
      for (int k = 0; k < n; ++k) finer.push_back({a[0] + (b[0] - a[0]) * k / n, a[1] + (b[1] - a[1]) * k / n});
    }
    loop = finer, given += loop.size();
  }
  for (const double length : {10.0, 0.2}) {
    const PlanarFill fill = fill_planar(loops, length);
    double sum = 0, longest = 0;
    for (const Triangle& t : fill.triangles) {
      const auto &a = fill.points[t[0]], &b = fill.points[t[1]], &c = fill.points[t[2]];
      const double one = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
      EXPECT_GT(one, 0);
      sum += one;
      for (const std::uint32_t v : t)
        for (const std::uint32_t w : t)
          longest = std::max(longest,
                             std::hypot(fill.points[v][0] - fill.points[w][0], fill.points[v][1] - fill.points[w][1]));
    }
    EXPECT_NEAR(sum, 12 - 4 - 0.09 - 0.045, 1e-12);
    EXPECT_LE(longest, length);
    EXPECT_EQ(fill.points.size() > given, length < 1);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
