#include "sansmesh/measure/body_measures.h"
#include "sansmesh/core/edge_key.h"

#include <Eigen/Dense>
#include <algorithm>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/group_rows.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/measure/component_overlap.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh/repair/sewn_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMassChunk = 8192;

/// Integrals over surface and volume, relative to a centre.
struct MassSums {
  double area = 0, volume = 0;
  Vec3 surface, first;             ///< ∫ x over the surface, over the volume
  std::array<double, 6> second{};  ///< ∫ xx, yy, zz, xy, yz, zx over the volume
};

MassSums combine_mass(MassSums a, const MassSums& b) {
  a.area += b.area;
  a.volume += b.volume;
  a.surface += b.surface;
  a.first += b.first;
  for (std::size_t k = 0; k < 6; ++k) a.second[k] += b.second[k];
  return a;
}

/// Adds a triangle and the tetrahedron from the centre to it: over the tetrahedron with corners 0, a, b, c and s = a +
/// b + c the integral of x xᵀ is det/120 (a aᵀ + b bᵀ + c cᵀ + s sᵀ).
void add(const Vec3& a, const Vec3& b, const Vec3& c, MassSums& sums) {
  const double area = triangle_area(a, b, c), det = Matrix3{a, b, c}.determinant();
  const Vec3 s = a + b + c;
  sums.area += area;
  sums.surface += s * (area / 3);
  sums.volume += det / 6;
  sums.first += s * (det / 24);
  const std::size_t pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [i, j] = pairs[k];
    sums.second[k] += det / 120 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
  }
}

MassMeasures mass_of(const MassSums& sums, const Vec3& middle) {
  MassMeasures mass;
  mass.volume = sums.volume;
  if (sums.volume == 0) {
    mass.center = middle + sums.surface / sums.area;
    mass.axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    return mass;
  }
  const Vec3 c = sums.first / sums.volume;
  mass.center = middle + c;
  const auto& q = sums.second;
  Eigen::Matrix3d moments;
  moments << q[0], q[3], q[5], q[3], q[1], q[4], q[5], q[4], q[2];
  const Eigen::Vector3d shift(c.x, c.y, c.z);
  moments -= sums.volume * shift * shift.transpose();
  const Eigen::Matrix3d inertia = moments.trace() * Eigen::Matrix3d::Identity() - moments;
  // Independent of the orientation of the triangles.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sums.volume < 0 ? Eigen::Matrix3d(-inertia) : inertia);
  for (int k = 0; k < 3; ++k) {
    mass.moments[static_cast<std::size_t>(k)] = std::max(0.0, solver.eigenvalues()[k]);
    Eigen::Vector3d axis = solver.eigenvectors().col(k);
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0) axis = -axis;
    mass.axes[static_cast<std::size_t>(k)] = {axis.x(), axis.y(), axis.z()};
  }
  mass.axes[2] = cross(mass.axes[0], mass.axes[1]);
  return mass;
}

/// Counts the edges of each component, as measure_topology does for the whole.
void count_edges(const TriangleMesh& mesh, const std::vector<std::uint32_t>& component, SolidMeasures& result) {
  // Key: the unordered pair; index: triangle and direction.
  std::vector<KeyIndex> edges(3 * mesh.triangles.size());
  parallel_for(0, mesh.triangles.size(), kMassChunk, [&](std::size_t i) {
    const Triangle& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      edges[3 * i + k] = {edge_key(a, b), static_cast<unsigned>(3 * i + k)};
    }
  });
  parallel_sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    long balance = 0;
    for (; end < edges.size() && edges[end].key == edges[i].key; ++end) {
      const Triangle& t = mesh.triangles[edges[end].index / 3];
      const std::size_t k = edges[end].index % 3;
      balance += t[k] < t[(k + 1) % 3] ? 1 : -1;
    }
    BodyMeasures& body = result.components[component[edges[i].index / 3]];
    body.boundary_edges += end - i == 1;
    body.open_edges += balance != 0;
    body.nonmanifold_edges += end - i > 2;
    i = end;
  }
}

}  // namespace

SolidMeasures measure_solid(const TriangleMesh& mesh) {
  const SewnMesh sewn = sewn_mesh(mesh);
  const TriangleMesh& clean = sewn.mesh;
  SolidMeasures result;
  result.left_out = sewn.left_out;
  result.topology = sewn_topology(sewn);
  result.whole.boundary_edges = result.topology.boundary_edges;
  result.whole.open_edges = result.topology.open_edges;
  result.whole.nonmanifold_edges = result.topology.nonmanifold_edges;
  const MeshComponents components = find_components(clean);
  result.components.resize(components.size());
  count_edges(clean, components.of_triangle, result);

  // Triangles grouped by component, in order.
  const Adjacency grouped = group_rows(components.size(), [&](const auto& visit) {
    for (std::size_t i = 0; i < clean.triangles.size(); ++i) visit(components.of_triangle[i], i);
  });

  std::vector<Vec3f> corners;
  const auto measure = [&](BodyMeasures& body, std::span<const std::uint32_t> triangles) {
    body.triangles = triangles.size();
    Box3f box;
    for (const std::uint32_t i : triangles)
      for (const std::uint32_t v : clean.triangles[i]) box.extend(clean.vertices[v]);
    const Vec3 middle = box.empty() ? Vec3{} : (Vec3(box.lower) + Vec3(box.upper)) * 0.5;
    const MassSums sums = parallel_reduce(
        triangles.size(), kMassChunk, MassSums{},
        [&](std::size_t from, std::size_t to) {
          MassSums part;
          for (const std::uint32_t i : triangles.subspan(from, to - from)) {
            const Triangle& t = clean.triangles[i];
            add(Vec3(clean.vertices[t[0]]) - middle, Vec3(clean.vertices[t[1]]) - middle,
                Vec3(clean.vertices[t[2]]) - middle, part);
          }
          return part;
        },
        combine_mass);
    body.area = sums.area;
    body.box = {clean.origin + Vec3(box.lower), clean.origin + Vec3(box.upper)};
    body.surface_center = clean.origin + middle + (sums.area > 0 ? sums.surface / sums.area : Vec3{});
    if (body.closed() && sums.area > 0) body.mass = mass_of(sums, clean.origin + middle);
  };
  measure(result.whole, grouped.entries);
  // The same sums as in other commands, to the last bit.
  const MeshSize size = measure_size(clean);
  result.whole.area = size.area;
  if (result.whole.mass) result.whole.mass->volume = size.volume;
  if (!(result.whole.area > 0)) throw DataError("no triangles with an area to measure");
  std::vector<std::uint8_t> closed(components.size());
  for (std::size_t c = 0; c < components.size(); ++c) {
    measure(result.components[c], grouped[c]);
    closed[c] = result.components[c].mass.has_value();
  }
  const ComponentOverlap overlap = component_overlap(clean, components.of_triangle, closed);
  for (std::size_t c = 0; c < components.size(); ++c) result.components[c].surrounding = overlap.surrounding[c];
  result.crossing_pairs = overlap.crossing_pairs;
  result.crossing_components = overlap.crossing_components;

  std::vector<std::uint8_t> used(clean.vertices.size());
  for (const Triangle& t : clean.triangles)
    for (const std::uint32_t v : t)
      if (!used[v]) used[v] = 1, corners.push_back(clean.vertices[v]);
  std::vector<std::array<Vec3, 3>> axes;
  if (result.whole.mass) axes.push_back(result.whole.mass->axes);
  result.smallest_box = smallest_box(corners, axes);
  result.smallest_box.center += clean.origin;
  return result;
}

namespace {

template <class T>
std::optional<T> of_mass(const BodyMeasures& body, T MassMeasures::*measure) {
  return body.mass ? std::optional<T>((*body.mass).*measure) : std::nullopt;
}

constexpr ReportRow kBodyMeasuresRows[] = {
    reported<&BodyMeasures::triangles>({.text = "Triangles"}),
    reported<&BodyMeasures::closed>({.text = "Whether the triangles enclose a volume"}),
    reported<&BodyMeasures::boundary_edges>({.text = "Edges of one triangle"}),
    reported<&BodyMeasures::open_edges>(
        {.text = "Edges that triangles traverse more often in one direction than in the other"}),
    reported<&BodyMeasures::nonmanifold_edges>({.text = "Edges of three triangles or more"}),
    reported<&BodyMeasures::area>({.text = "Area", .unit = "length²"}),
    reported<&BodyMeasures::surface_center>({.text = "Mean of the surface's points", .unit = "length"}),
    reported<[](const BodyMeasures& r) { return r.box.lower; }>(
        {.name = "box.lower", .text = "Lower corner of the box", .unit = "length"}),
    reported<[](const BodyMeasures& r) { return r.box.upper; }>(
        {.name = "box.upper", .text = "Upper corner of the box", .unit = "length"}),
    reported<[](const BodyMeasures& r) { return of_mass(r, &MassMeasures::volume); }>(
        {.name = "volume", .text = "Volume, of what is closed", .unit = "length³"}),
    reported<[](const BodyMeasures& r) { return of_mass(r, &MassMeasures::center); }>(
        {.name = "center_of_mass", .text = "Centre of mass, of what is closed", .unit = "length"}),
    reported<[](const BodyMeasures& r) { return of_mass(r, &MassMeasures::moments); }>(
        {.name = "principal_moments", .text = "Principal moments of inertia, for density 1", .unit = "length⁵"}),
    reported<[](const BodyMeasures& r) { return of_mass(r, &MassMeasures::axes); }>(
        {.name = "principal_axes", .text = "Axes of these"}),
    reported<&BodyMeasures::surrounding>(
        {.name = "surrounding_winding_number", .text = "Winding number of the other parts around it"})};

}  // namespace

const ReportSchema& BodyMeasures::schema() {
  static constexpr ReportSchema schema{kBodyMeasuresRows};
  return schema;
}

namespace {

std::vector<BodyMeasures> largest_components(const SolidMeasures& solid) {
  constexpr std::size_t kListed = 1000;
  const std::size_t listed = std::min(kListed, solid.components.size());
  return {solid.components.begin(), solid.components.begin() + static_cast<std::ptrdiff_t>(listed)};
}

constexpr ReportRow kSolidMeasuresRows[] = {
    reported<&SolidMeasures::topology>({.text = "Topology of all triangles"}),
    reported<&SolidMeasures::whole>({.text = "All parts together"}),
    reported<&SolidMeasures::smallest_box>({.text = "Smallest box around all"}),
    reported<&SolidMeasures::left_out>(
        {.name = "left_out_triangles", .text = "Triangles that were left out for bad corners"}),
    reported<&SolidMeasures::crossing_pairs>({.text = "Pairs of triangles that cut through each other"}),
    reported<&SolidMeasures::crossing_components>({.text = "Parts that cut through another one"}),
    reported<[](const SolidMeasures& r) { return r.components.size(); }>({.name = "component_count", .text = "Parts"}),
    reported<[](const SolidMeasures& r) { return largest_components(r); }>(
        {.name = "components", .text = "Parts, the largest area first, a thousand at most"})};

}  // namespace

const ReportSchema& SolidMeasures::schema() {
  static constexpr ReportSchema schema{kSolidMeasuresRows};
  return schema;
}

}  // namespace sansmesh::inline v1
