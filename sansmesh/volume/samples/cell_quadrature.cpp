#include "sansmesh/volume/samples/cell_quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {
namespace {

struct GaussRule {
  std::span<const double> at, weight;  // on 0..1
};

GaussRule gauss_rule(bool fine) {
  static const double three[] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
  static constexpr double three_weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  static const double near = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)) / 2,
                      far = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2)) / 2;
  static const double four[] = {0.5 - far, 0.5 - near, 0.5 + near, 0.5 + far};
  static const double inner = (18 + std::sqrt(30.0)) / 72, outer = (18 - std::sqrt(30.0)) / 72;
  static const double four_weights[] = {outer, inner, inner, outer};
  if (fine) return {four, four_weights};
  return {three, three_weights};
}

double box_product(const std::array<Vec3, 3>& d) { return dot(d[0], cross(d[1], d[2])); }

/// Vertices and centres of faces: exact for degree 3.
void append_tetrahedron(std::span<const Vec3> x, std::vector<QuadraturePoint>& out) {
  const double volume = std::abs(dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0]))) / 6;
  const Vec3 sum = x[0] + x[1] + x[2] + x[3];
  for (const Vec3& p : x) {
    out.push_back({p, volume / 40});
    out.push_back({(sum - p) / 3, volume * 9 / 40});
  }
}

/// The centres of the faces: exact for degree 3 in a parallelepiped.
void append_box(std::span<const Vec3> x, const std::array<Vec3, 3>& edges, std::vector<QuadraturePoint>& out) {
  const double volume = std::abs(box_product(edges));
  const Vec3 middle = (x[0] + x[6]) * 0.5;
  for (const Vec3& e : edges) {
    out.push_back({middle - e * 0.5, volume / 6});
    out.push_back({middle + e * 0.5, volume / 6});
  }
}

void append_mapped(CellShape shape, const CellMap& map, const GaussRule& rule, std::vector<QuadraturePoint>& out) {
  const std::size_t n = rule.at.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        double weight = rule.weight[i] * rule.weight[j] * rule.weight[k];
        Vec3 u{rule.at[i], rule.at[j], rule.at[k]};
        // Prisms and simplices as cubes with a collapsed side.
        if (shape != CellShape::hexahedron && shape != CellShape::pyramid) weight *= 1 - u.x, u.y *= 1 - u.x;
        if (shape == CellShape::tetrahedron) {
          const double rest = 1 - u.x - u.y;
          weight *= rest, u.z *= rest;
        }
        out.push_back({map.at(u), weight * std::abs(box_product(map.derivatives(u)))});
      }
}

}  // namespace

CellQuadrature::CellQuadrature(const SampledVolume& volume) : volume_(volume), cells_(cells_of_samples(volume)) {}

void CellQuadrature::points(std::uint32_t sample, const Vec3& origin, std::vector<QuadraturePoint>& out) const {
  gather(sample, origin, false, out);
}

void CellQuadrature::fine_points(std::uint32_t sample, const Vec3& origin, std::vector<QuadraturePoint>& out) const {
  gather(sample, origin, true, out);
}

void CellQuadrature::gather(std::uint32_t sample, const Vec3& origin, bool fine,
                            std::vector<QuadraturePoint>& out) const {
  out.clear();
  for (const std::uint32_t cell : cells_[sample]) {
    const CellShape shape = volume_.cells.shapes[cell];
    const auto corners = volume_.cells[cell];
    std::array<Vec3, 8> store;
    for (std::size_t v = 0; v < corners.size(); ++v) store[v] = volume_.corner(corners[v]) - origin;
    const auto x = std::span<const Vec3>(store).first(corners.size());
    if (!fine && shape == CellShape::tetrahedron) {
      append_tetrahedron(x, out);
      continue;
    }
    const CellMap map(shape, x);
    if (!fine && shape == CellShape::hexahedron) {
      const std::array<Vec3, 3> edges{x[1] - x[0], x[3] - x[0], x[4] - x[0]};
      const CellMap::Curvature c = map.curvature();
      const double least = std::min({squared_norm(edges[0]), squared_norm(edges[1]), squared_norm(edges[2])});
      const double bent = squared_norm(c.rs) + squared_norm(c.st) + squared_norm(c.rt) + squared_norm(c.rst);
      if (bent < 1e-20 * least) {
        append_box(x, edges, out);
        continue;
      }
    }
    append_mapped(shape, map, gauss_rule(fine || shape == CellShape::wedge), out);
  }
  double sum = 0;
  for (const QuadraturePoint& p : out) sum += p.weight;
  if (sum > 0) {
    for (QuadraturePoint& p : out) p.weight /= sum;
  } else {
    out.assign(1, {volume_.position(sample) - origin, 1});
  }
}

}  // namespace sansmesh::inline v1
