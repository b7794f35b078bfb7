#include "sansmesh/mesh/edit/tubes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSamePoint = 1e-3;              // in radii
constexpr double kSameCorner = 1e-4;             // in radii, for cross-sections that rotate about a point
constexpr double kMitred = 0.70710678118654752;  // cosine of the sharpest mitred bend
constexpr double kTurn = std::numbers::pi / 6;   // largest angle between cross-sections about a point
constexpr double kMitreShare = 0.5;              // largest fraction of a segment for a mitre
constexpr double kReversed = 1e-12;              // squared sine; below it, the plane of a bend is undefined

/// Tubes of one line.
struct TubePart {
  std::vector<Vec3f> positions, normals;
  std::vector<std::uint32_t> rows;
  std::vector<Triangle> triangles;
};

struct CrossSection {
  Vec3 u, v;  ///< right-handed orthonormal with the direction of the segment
};

/// Rotates a vector about a unit axis.
Vec3 rotated(const Vec3& a, const Vec3& axis, double cosine, double sine) {
  return cosine * a + sine * cross(axis, a) + ((1 - cosine) * dot(axis, a)) * axis;
}

class TubeMaker {
 public:
  explicit TubeMaker(const TubeOptions& options)
      : radius_(options.radius), sides_(static_cast<std::size_t>(options.sides)) {
    for (std::size_t k = 0; k < sides_; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sides_);
      around_.push_back({std::cos(angle), std::sin(angle), 0});
    }
  }

  /// Makes the tube of points of which no two consecutive ones coincide; `rows` are their indices.
  void add(const std::vector<Vec3>& x, const std::vector<std::uint32_t>& rows, TubePart& part) const {
    if (x.size() < 2) return;
    Vec3 along = normalized(x[1] - x[0]);
    CrossSection section;
    tangent_frame(along, section.u, section.v);
    std::vector<std::uint32_t> ring = straight_ring(x[0], section, rows[0], part);
    for (std::size_t k = 1; k + 1 < sides_; ++k) part.triangles.push_back({ring[0], ring[k + 1], ring[k]});
    for (std::size_t i = 1; i + 1 < x.size(); ++i) {
      const Vec3 next = normalized(x[i + 1] - x[i]);
      const double shorter = std::min(norm(x[i] - x[i - 1]), norm(x[i + 1] - x[i]));
      bend(x[i], along, next, shorter, rows[i], section, ring, part);
      along = next;
    }
    join(ring, straight_ring(x.back(), section, rows.back(), part), part);
    for (std::size_t k = 1; k + 1 < sides_; ++k) part.triangles.push_back({ring[0], ring[k], ring[k + 1]});
  }

 private:
  Vec3 spoke(const CrossSection& s, std::size_t k) const { return around_[k].x * s.u + around_[k].y * s.v; }

  static std::uint32_t vertex(const Vec3& x, const Vec3& normal, std::uint32_t row, TubePart& part) {
    part.positions.emplace_back(x);
    part.normals.emplace_back(normal);
    part.rows.push_back(row);
    return static_cast<std::uint32_t>(part.positions.size() - 1);
  }

  std::vector<std::uint32_t> straight_ring(const Vec3& x, const CrossSection& section, std::uint32_t row,
                                           TubePart& part) const {
    std::vector<std::uint32_t> ring(sides_);
    for (std::size_t k = 0; k < sides_; ++k) {
      const Vec3 w = spoke(section, k);
      ring[k] = vertex(x + radius_ * w, w, row, part);
    }
    return ring;
  }

  /// Connects the last cross-section with `next`, which replaces it. Common corners make no triangle.
  void join(std::vector<std::uint32_t>& ring, std::vector<std::uint32_t> next, TubePart& part) const {
    for (std::size_t k = 0; k < sides_; ++k) {
      const std::size_t l = (k + 1) % sides_;
      if (next[l] != ring[l]) part.triangles.push_back({ring[k], ring[l], next[l]});
      if (next[k] != ring[k]) part.triangles.push_back({ring[k], next[l], next[k]});
    }
    ring.swap(next);
  }

  void bend(const Vec3& x, const Vec3& along, const Vec3& next, double shorter, std::uint32_t row,
            CrossSection& section, std::vector<std::uint32_t>& ring, TubePart& part) const {
    const double cosine = std::clamp(dot(along, next), -1.0, 1.0);
    // Half the angle between the directions: its tangent determines the mitre.
    const Vec3 middle = along + next;
    const Vec3 across = cross(along, next);
    const double half = norm(next - along) / std::max(norm(middle), 1e-300);
    if (cosine >= kMitred && radius_ * half <= kMitreShare * shorter) {
      // The plane of the mitre reflects one segment and its cross-section into the other.
      const Vec3 mirror = normalized(middle);
      CrossSection turned{section.u - 2 * dot(section.u, mirror) * mirror,
                          section.v - 2 * dot(section.v, mirror) * mirror};
      std::vector<std::uint32_t> mitre(sides_);
      for (std::size_t k = 0; k < sides_; ++k) {
        const Vec3 w = spoke(section, k);
        const double back = dot(w, middle) / dot(along, middle);
        mitre[k] = vertex(x + radius_ * (w - back * along), normalized(w + spoke(turned, k)), row, part);
      }
      join(ring, std::move(mitre), part);
      section = straightened(turned, next);
      return;
    }
    const Vec3 axis = squared_norm(across) > kReversed ? normalized(across) : section.u;
    const double angle = std::atan2(norm(across), cosine);
    const int steps = std::max(1, whole_part<int>(std::ceil(angle / kTurn - 1e-9)));
    join(ring, straight_ring(x, section, row, part), part);
    const CrossSection first = section;
    const std::vector<std::uint32_t> first_ring = ring;
    std::vector<char> still(sides_);  // corners on the axis
    for (std::size_t k = 0; k < sides_; ++k) {
      const Vec3 w = spoke(section, k);
      still[k] = norm(w - dot(w, axis) * axis) * angle < kSameCorner;
    }
    for (int s = 1; s <= steps; ++s) {
      const double part_angle = angle * s / steps, c = std::cos(part_angle), i = std::sin(part_angle);
      section = {rotated(first.u, axis, c, i), rotated(first.v, axis, c, i)};
      if (s == steps) section = straightened(section, next);
      std::vector<std::uint32_t> turned(sides_);
      for (std::size_t k = 0; k < sides_; ++k) {
        const Vec3 w = spoke(section, k);
        turned[k] = still[k] ? first_ring[k] : vertex(x + radius_ * w, w, row, part);
      }
      join(ring, std::move(turned), part);
    }
  }

  /// Orthogonalises the cross-section against accumulating rounding errors.
  static CrossSection straightened(const CrossSection& section, const Vec3& along) {
    const Vec3 u = normalized(section.u - dot(section.u, along) * along);
    return {u, cross(along, u)};
  }

  double radius_;
  std::size_t sides_;
  std::vector<Vec3> around_;
};

/// Points of one tube with their indices.
struct TubePoints {
  std::vector<Vec3> x;
  std::vector<std::uint32_t> rows;
};

TubePart tube_of_line(const PolylineSet& lines, std::size_t line, const TubeMaker& maker, const TubeOptions& options) {
  const double same = kSamePoint * options.radius, step = std::max(same, options.least_step);
  TubePart part;
  TubePoints kept;
  std::optional<std::uint32_t> left_out;  // skipped since the last kept point
  const auto finish = [&] {
    // The tube ends at the end of the line.
    if (const std::size_t n = kept.x.size(); left_out && n > 1) {
      const Vec3 end(lines.positions[*left_out]);
      if (norm(end - kept.x[n - 2]) > same) kept.x[n - 1] = end, kept.rows[n - 1] = *left_out;
    }
    maker.add(kept.x, kept.rows, part);
    kept = {}, left_out.reset();
  };
  for (std::size_t i = lines.offsets[line]; i < lines.offsets[line + 1]; ++i) {
    if (!is_finite(lines.positions[i])) {
      finish();
      continue;
    }
    const Vec3 p(lines.positions[i]);
    const auto row = static_cast<std::uint32_t>(i);
    if (kept.x.empty() || norm(p - kept.x.back()) > step)
      kept.x.push_back(p), kept.rows.push_back(row), left_out.reset();
    else
      left_out = row;
  }
  finish();
  return part;
}

}  // namespace

void TubeOptions::validate() const {
  check_argument(std::isfinite(radius) && radius > 0, "`radius` must be positive");
  check_range("sides", sides, 3, 256);
  check_argument(std::isfinite(least_step) && least_step >= 0, "`least_step` must not be negative");
}

TriangleMesh tubes(const PolylineSet& lines, const TubeOptions& options) {
  options.validate();
  if (lines.positions.size() > std::numeric_limits<std::uint32_t>::max()) throw DataError("too many points for tubes");
  const TubeMaker maker(options);
  std::vector<TubePart> parts(lines.size());
  parallel_for(0, lines.size(), 1, [&](std::size_t i) { parts[i] = tube_of_line(lines, i, maker, options); });

  TriangleMesh mesh;
  mesh.origin = lines.origin;
  mesh.reference = lines.reference;
  std::size_t vertices = 0, triangles = 0;
  for (const TubePart& part : parts) vertices += part.positions.size(), triangles += part.triangles.size();
  if (vertices > std::numeric_limits<std::uint32_t>::max()) throw DataError("too many points for tubes");
  mesh.vertices.reserve(vertices), mesh.normals.reserve(vertices), mesh.triangles.reserve(triangles);
  std::vector<std::uint32_t> rows, line_rows;
  rows.reserve(vertices), line_rows.reserve(triangles);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    TubePart& part = parts[i];
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    rows.insert(rows.end(), part.rows.begin(), part.rows.end());
    for (const Triangle& t : part.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    line_rows.insert(line_rows.end(), part.triangles.size(), static_cast<std::uint32_t>(i));
    part = {};
  }
  mesh.attributes = lines.attributes.taken(rows);
  mesh.triangle_attributes = lines.line_attributes.taken(line_rows);
  return mesh;
}

}  // namespace sansmesh::inline v1
