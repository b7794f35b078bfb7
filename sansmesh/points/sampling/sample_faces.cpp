#include "sansmesh/points/sampling/sample_faces.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/data/triangles.h"

namespace sansmesh::inline v1 {
namespace {

/// Interpolates attributes of vertices, and copies those of triangles.
void carry_attributes(const PointSet& mesh, const std::vector<FaceSample>& samples, PointSet& cloud) {
  if (!mesh.attributes.empty()) {
    std::vector<std::uint32_t> corners(3 * samples.size());
    std::vector<double> weights(corners.size());
    parallel_for(0, samples.size(), 8192, [&](std::size_t i) {
      const FaceSample& s = samples[i];
      const double u = static_cast<double>(s.u), v = static_cast<double>(s.v), weight[3] = {1 - u - v, u, v};
      for (std::size_t k = 0; k < 3; ++k) {
        corners[3 * i + k] = mesh.triangles[s.triangle][k];
        weights[3 * i + k] = std::max(0.0, weight[k]);
      }
    });
    cloud.attributes = mesh.attributes.blended(3, corners, weights);
  }
  if (!mesh.triangle_attributes.empty()) {
    std::vector<std::uint32_t> of(samples.size());
    for (std::size_t i = 0; i < of.size(); ++i) of[i] = samples[i].triangle;
    for (const Attribute& a : mesh.triangle_attributes.taken(of))
      if (!cloud.attributes.find(a.name)) cloud.attributes.set(a);
  }
}

}  // namespace

std::vector<FaceSample> sample_triangles(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                         std::size_t count) {
  std::vector<double> area(triangles.size());  // cumulative areas
  double total = 0;
  for (std::size_t i = 0; i < area.size(); ++i) area[i] = total += norm(doubled_area(vertices, triangles[i]));
  if (!(total > 0)) return {};
  std::vector<FaceSample> samples(count);
  parallel_for(0, count, 2048, [&](std::size_t i) {
    const double at = (static_cast<double>(i) + unit_random(3 * i)) / static_cast<double>(count) * total;
    auto found = std::upper_bound(area.begin(), area.end(), at);
    if (found == area.end()) found = std::lower_bound(area.begin(), area.end(), total);  // rounding beyond the end
    const auto index = static_cast<std::size_t>(found - area.begin());
    const Triangle& t = triangles[index];
    double u = unit_random(3 * i + 1), v = unit_random(3 * i + 2);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 a(vertices[t[0]]), b(vertices[t[1]]), c(vertices[t[2]]);
    samples[i] = {a + (b - a) * u + (c - a) * v, Vec3f(normalized(cross(b - a, c - a))),
                  static_cast<std::uint32_t>(index), static_cast<float>(u), static_cast<float>(v)};
  });
  return samples;
}

PointSet sample_faces(const PointSet& mesh, std::size_t count) {
  const std::vector<FaceSample> samples = sample_triangles(mesh.positions, mesh.triangles, count);
  PointSet cloud;
  cloud.origin = mesh.origin;
  cloud.reference = mesh.reference;
  cloud.positions.resize(samples.size());
  cloud.normals.resize(samples.size());
  if (mesh.has_colors()) cloud.colors.resize(samples.size());
  parallel_for(0, samples.size(), 8192, [&](std::size_t i) {
    const FaceSample& s = samples[i];
    cloud.positions[i] = Vec3f(s.position);
    cloud.normals[i] = s.normal;
    if (!mesh.has_colors()) return;
    const Triangle& t = mesh.triangles[s.triangle];
    for (std::size_t k = 0; k < 3; ++k) {
      const float mixed = (1 - s.u - s.v) * static_cast<float>(mesh.colors[t[0]][k]) +
                          s.u * static_cast<float>(mesh.colors[t[1]][k]) +
                          s.v * static_cast<float>(mesh.colors[t[2]][k]);
      cloud.colors[i][k] = index_in<std::uint8_t>(std::round(mixed), 0, 255);
    }
  });
  carry_attributes(mesh, samples, cloud);
  return cloud;
}

std::vector<Vec3f> normals_from_faces(const PointSet& mesh) {
  std::vector<Vec3> sums(mesh.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 area = doubled_area(mesh.positions, t);
    if (area == Vec3{}) continue;
    for (const std::uint32_t v : t) sums[v] = sums[v] + area;
  }
  std::vector<Vec3f> normals(mesh.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = norm(sums[i]);
    if (length > 0) normals[i] = Vec3f(sums[i] / length);
  }
  return normals;
}

void set_normals_from_faces(PointSet& mesh) { mesh.normals = normals_from_faces(mesh); }

}  // namespace sansmesh::inline v1
