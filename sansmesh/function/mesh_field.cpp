#include "sansmesh/function/mesh_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/function/mesh_patches.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/partition/far/global_sign.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFieldBatch = 256;
/// Within this share of the diagonal from the surface creases are sharp: a twentieth of a typical cell.
constexpr double kSharp = 2e-4;
/// Faces larger than kUsualSize typical ones count as several in the winding number, if that adds at most kMostSeen.
/// Within kTrustedSizes of their sizes the closest face determines the side; beyond, the winding number does if it
/// differs from 1/2 by kDecided.
constexpr double kUsualSize = 2, kTrustedSizes = 2;
constexpr std::size_t kMostSeen = 500'000;
constexpr float kDecided = 0.25f;
/// A mean of normals is used as the gradient if it is within 20 degrees of it.
constexpr double kAlike = 0.94;
/// Patches are planar if they deviate from a plane by less than this share of the diagonal.
constexpr double kPlanar = 1e-6;
/// The triangles off a patch are stored for each patch if their total is at most this.
constexpr std::size_t kMostOthers = 2'000'000;

struct Foot {
  Vec3 point;  ///< relative to the mesh's origin
  std::uint32_t triangle = 0;
  TrianglePart part = TrianglePart::inside;
};

int corner_of(TrianglePart part) { return part <= TrianglePart::c ? static_cast<int>(part) : -1; }
int edge_of(TrianglePart part) {
  return part == TrianglePart::ab ? 0 : part == TrianglePart::bc ? 1 : part == TrianglePart::ca ? 2 : -1;
}

}  // namespace

struct MeshField::Parts {
  struct Patch {
    std::vector<std::uint32_t> triangles;  ///< indices in the mesh
    bool planar = false;
    Vec3 normal;
    double offset = 0;
    std::unique_ptr<ClosestTriangle> faces;   ///< unless planar
    std::unique_ptr<ClosestTriangle> others;  ///< all faces off the patch, for planar ones
  };

  Parts(TriangleMesh m, const Options& options)
      : mesh(std::move(m)),
        rounded(options.rounded),
        smooth(options.smooth),
        patches(mesh, options.crease_angle, options.least_crease),
        closest(mesh),
        corners(patches.triangles, mesh.vertices.size()) {
    if (closest.empty()) throw DataError("no triangles to measure distances to");
    for (const Triangle& t : patches.triangles)
      for (const std::uint32_t v : t) box.extend(position(v));
    sharp = kSharp * box.diagonal();
    vertex_normal.resize(mesh.vertices.size());
    parallel_for(0, vertex_normal.size(), 4096,
                 [&](std::size_t v) { vertex_normal[v] = normal_at(static_cast<std::uint32_t>(v), all_patches); });
    make_patches();
    if (rounded) make_curves();
    make_winding();
  }

  static constexpr std::uint32_t all_patches = MeshPatches::kSmooth;

  Vec3 position(std::uint32_t v) const { return Vec3(mesh.vertices[v]); }

  /// Sum of the normals of the faces of a patch around a vertex, weighted by their angles there.
  Vec3 normal_at(std::uint32_t v, std::uint32_t patch) const {
    Vec3 sum;
    for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
      const std::uint32_t t = corners.entries[i] / 3, k = corners.entries[i] % 3;
      if (patch != all_patches && patches.patch[t] != patch) continue;
      const Triangle& f = patches.triangles[t];
      const Vec3 a = position(f[(k + 1) % 3]) - position(v), b = position(f[(k + 2) % 3]) - position(v);
      sum += patches.normal[t] * std::atan2(norm(cross(a, b)), dot(a, b));
    }
    return sum;
  }

  void make_patches() {
    all.resize(patches.patches);
    for (std::uint32_t t = 0; t < patches.patch.size(); ++t) all[patches.patch[t]].triangles.push_back(t);
    const bool know_others = patches.patch.size() * all.size() <= kMostOthers;
    parallel_for(0, all.size(), 1, [&](std::size_t p) {
      Patch& patch = all[p];
      Vec3 sum, middle;
      for (const std::uint32_t t : patch.triangles) {
        const Triangle& f = patches.triangles[t];
        sum += cross(position(f[1]) - position(f[0]), position(f[2]) - position(f[0]));
        for (const std::uint32_t v : f) middle += position(v) / (3.0 * static_cast<double>(patch.triangles.size()));
      }
      patch.normal = normalized(sum);
      patch.offset = dot(patch.normal, middle);
      patch.planar = squared_norm(patch.normal) > 0;
      for (const std::uint32_t t : patch.triangles)
        for (const std::uint32_t v : patches.triangles[t])
          patch.planar =
              patch.planar && std::abs(dot(patch.normal, position(v)) - patch.offset) <= kPlanar * box.diagonal();
      if (!patch.planar) patch.faces = std::make_unique<ClosestTriangle>(part_of(patch.triangles));
      if (!patch.planar || !know_others) return;
      std::vector<std::uint32_t> rest;
      for (std::uint32_t t = 0; t < patches.patch.size(); ++t)
        if (patches.patch[t] != p) rest.push_back(t);
      if (!rest.empty()) patch.others = std::make_unique<ClosestTriangle>(part_of(rest));
    });
  }

  void make_winding() {
    const double diagonal = box.diagonal();
    const std::size_t n = patches.triangles.size();
    std::vector<double> longest(n, 0);
    for (std::size_t t = 0; t < n; ++t)
      for (std::size_t k = 0; k < 3; ++k)
        longest[t] =
            std::max(longest[t], norm(position(patches.triangles[t][(k + 1) % 3]) - position(patches.triangles[t][k])));
    // Large faces count as several, because each is approximated by a point.
    std::vector<double> sorted = longest;
    double size = std::max(kUsualSize * median(sorted), 1e-4 * diagonal);
    const auto cuts = [&](std::size_t t) { return std::max(1.0, std::ceil(longest[t] / size)); };
    for (double count = 2 * static_cast<double>(kMostSeen + n); count > static_cast<double>(kMostSeen + n);) {
      count = 0;
      for (std::size_t t = 0; t < n; ++t) count += cuts(t) * cuts(t);
      if (count > static_cast<double>(kMostSeen + n)) size *= 1.5;
    }
    trusted = kTrustedSizes * size;
    std::vector<OrientedPatch> seen;
    for (std::size_t t = 0; t < n; ++t) {
      const Triangle& f = patches.triangles[t];
      const auto k = static_cast<int>(cuts(t));
      const Vec3 a = position(f[0]), u = (position(f[1]) - a) / k, v = (position(f[2]) - a) / k;
      const Vec3f area(cross(u, v) / 2);
      for (int i = 0; i < k; ++i)
        for (int j = 0; i + j < k; ++j) {
          seen.push_back({Vec3f(a + u * (i + 1.0 / 3) + v * (j + 1.0 / 3)), area});
          if (i + j + 1 < k) seen.push_back({Vec3f(a + u * (i + 2.0 / 3) + v * (j + 2.0 / 3)), area});
        }
    }
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(seen.size());
    for (std::uint32_t i = 0; i < seen.size(); ++i) {
      const Vec3 cell = (Vec3(seen[i].position) - box.lower) * (1e6 / std::max(diagonal, 1e-300));
      const auto at = [](double x) { return index_in<std::uint32_t>(x, 0, 1000000); };
      order[i] = {morton_code(at(cell.x), at(cell.y), at(cell.z)), i};
    }
    std::sort(order.begin(), order.end());
    std::vector<OrientedPatch> along(seen.size());
    for (std::size_t i = 0; i < order.size(); ++i) along[i] = seen[order[i].second];
    winding = GlobalSign(along, static_cast<float>(diagonal));
  }

  /// Where faces cross each other the closest one may face the wrong way, which would reverse the side of all points
  /// closest to it at any distance: beyond a few edges the winding number decides.
  void check_sides(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
    std::vector<std::size_t> far;
    std::vector<Vec3f> at;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!(std::abs(values[i]) > trusted)) continue;
      far.push_back(i);
      at.push_back(Vec3f(x[i] - mesh.origin));
    }
    std::vector<float> number(at.size());
    if (!at.empty()) winding.winding_number(at, number);
    for (std::size_t j = 0; j < far.size(); ++j) {
      const std::size_t i = far[j];
      if (!(std::abs(number[j] - 0.5f) > kDecided) || (number[j] > 0.5f) == (values[i] < 0)) continue;
      values[i] = -values[i];
      if (!gradients.empty()) gradients[i] = -gradients[i];
    }
  }

  TriangleMesh part_of(const std::vector<std::uint32_t>& triangles) const {
    TriangleMesh part;
    for (const std::uint32_t t : triangles) {
      const auto n = static_cast<std::uint32_t>(part.vertices.size());
      for (const std::uint32_t v : patches.triangles[t]) part.vertices.push_back(mesh.vertices[v]);
      part.triangles.push_back({n, n + 1, n + 2});
    }
    return part;
  }

  /// Curves and corners, as triangles without area.
  void make_curves() {
    std::vector<TriangleMesh> lines(patches.curves + patches.corners);
    const auto add = [&](std::uint32_t line, std::uint32_t a, std::uint32_t b) {
      TriangleMesh& m = lines[line];
      const auto n = static_cast<std::uint32_t>(m.vertices.size());
      m.vertices.push_back(mesh.vertices[a]);
      m.vertices.push_back(mesh.vertices[b]);
      m.triangles.push_back({n, n + 1, n + 1});
    };
    for (std::uint32_t h = 0; h < patches.curve.size(); ++h) {
      if (patches.curve[h] == MeshPatches::kSmooth) continue;
      const Triangle& t = patches.triangles[h / 3];
      add(patches.curve[h], t[h % 3], t[(h % 3 + 1) % 3]);
    }
    for (std::uint32_t v = 0; v < patches.feature.size(); ++v)
      if (patches.feature[v] != MeshPatches::kSmooth && patches.feature[v] >= patches.curves)
        add(patches.feature[v], v, v);
    for (const TriangleMesh& m : lines) curves.emplace_back(m);
  }

  /// The piece of the closest crease or corner without its side; kSmooth elsewhere.
  std::uint32_t feature_of(const Foot& foot) const {
    if (const int k = corner_of(foot.part); k >= 0) return patches.feature[patches.triangles[foot.triangle][k]];
    if (const int k = edge_of(foot.part); k >= 0)
      return patches.curve[3 * foot.triangle + static_cast<std::uint32_t>(k)];
    return MeshPatches::kSmooth;
  }

  /// Sum of the normals of all faces at an edge.
  Vec3 edge_normal(std::uint32_t a, std::uint32_t b) const {
    Vec3 sum;
    for (std::uint32_t i = corners.first[a]; i < corners.first[a + 1]; ++i) {
      const std::uint32_t t = corners.entries[i] / 3;
      const Triangle& f = patches.triangles[t];
      if (f[0] == b || f[1] == b || f[2] == b) sum += patches.normal[t];
    }
    return sum;
  }

  /// The normal that determines the side.
  Vec3 normal_of(const Foot& foot) const {
    const Triangle& t = patches.triangles[foot.triangle];
    if (const int k = corner_of(foot.part); k >= 0) return vertex_normal[t[static_cast<std::size_t>(k)]];
    Vec3 normal = patches.normal[foot.triangle];
    if (const int k = edge_of(foot.part); k >= 0) {
      const std::uint32_t other = patches.across[3 * foot.triangle + static_cast<std::uint32_t>(k)];
      normal = other != MeshPatches::kSmooth
                   ? normal + patches.normal[other]
                   : edge_normal(t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>(k + 1) % 3]);
    }
    // A triangle without area uses its corners.
    if (squared_norm(normal) < 1e-12) normal = vertex_normal[t[0]] + vertex_normal[t[1]] + vertex_normal[t[2]];
    return normal;
  }

  /// Mean of the normals at the corners of a face, restricted to its patch.
  Vec3 smooth_normal(const Foot& foot) const {
    const Triangle& t = patches.triangles[foot.triangle];
    const Vec3 a = position(t[0]), b = position(t[1]), c = position(t[2]);
    const Vec3 n = cross(b - a, c - a);
    const double area = squared_norm(n);
    if (!(area > 0)) return normal_of(foot);
    const std::array<double, 3> share{dot(cross(c - b, foot.point - b), n) / area,
                                      dot(cross(a - c, foot.point - c), n) / area,
                                      dot(cross(b - a, foot.point - a), n) / area};
    Vec3 sum;
    for (std::size_t k = 0; k < 3; ++k)
      sum += normalized(patches.feature[t[k]] == MeshPatches::kSmooth ? vertex_normal[t[k]]
                                                                      : normal_at(t[k], patches.patch[foot.triangle])) *
             std::max(0.0, share[k]);
    return sum;
  }

  Foot locate(const ClosestTriangle::Hit& hit, std::uint32_t triangle, const Vec3& query) const {
    const Triangle& t = patches.triangles[triangle];
    const TrianglePoint at = locate_on_triangle(query, position(t[0]), position(t[1]), position(t[2]));
    return {hit.point, triangle, at.part};
  }

  /// Value and gradient derived from a foot point.
  double value_at(const Vec3& query, const Foot& foot, Vec3* gradient) const {
    const Vec3 normal = normal_of(foot), away = query - foot.point;
    const double distance = norm(away), side = dot(away, normal);
    if (gradient) {
      *gradient = distance > 1e-9 * sharp ? away * ((side < 0 ? -1 : 1) / distance) : normalized(normal);
      if (smooth && feature_of(foot) == MeshPatches::kSmooth) {
        const Vec3 mean = normalized(smooth_normal(foot));
        if (dot(mean, *gradient) > kAlike) *gradient = mean;
      }
    }
    return side < 0 ? -distance : distance;
  }

  /// The patch at a crease or corner whose plane is farthest on this side of the surface.
  std::uint32_t patch_at(const Vec3& query, const Foot& foot, double value) const {
    std::uint32_t best = foot.triangle;
    double most = -std::numeric_limits<double>::infinity();
    const double sign = value < 0 ? -1 : 1;
    const auto look = [&](std::uint32_t t) {
      const double height = sign * dot(query - foot.point, patches.normal[t]);
      if (patches.normal[t] == Vec3{} || height < most || (height == most && t >= best)) return;
      most = height, best = t;
    };
    if (const int k = corner_of(foot.part); k >= 0) {
      const std::uint32_t v = patches.triangles[foot.triangle][k];
      for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) look(corners.entries[i] / 3);
    } else if (const int e = edge_of(foot.part); e >= 0) {
      look(foot.triangle);
      const std::uint32_t other = patches.across[3 * foot.triangle + static_cast<std::uint32_t>(e)];
      if (other != MeshPatches::kSmooth) look(other);
    }
    return patches.patch[best];
  }

  std::uint32_t piece_at(const Vec3& query, const Foot& foot, double value) const {
    const std::uint32_t feature = feature_of(foot);
    if (feature == MeshPatches::kSmooth) return patches.patch[foot.triangle];
    if (!rounded || std::abs(value) <= sharp) return patch_at(query, foot, value);
    return patches.patches + 2 * feature + (value < 0 ? 1 : 0);
  }

  /// Values at all points, and their feet; gradients unless that span is empty. Calls body(i, query, foot) for each.
  template <class Body>
  void for_feet(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients, Body&& body) const {
    parallel_ranges(0, x.size(), kFieldBatch, [&](std::size_t first, std::size_t last) {
      const std::size_t n = last - first;
      std::vector<Foot> feet(n);
      ClosestTriangle::Hit hit;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 query = x[first + i] - mesh.origin;
        hit = closest.closest(query, hit);
        feet[i] = locate(hit, hit.triangle, query);
        values[first + i] = value_at(query, feet[i], gradients.empty() ? nullptr : &gradients[first + i]);
      }
      check_sides(x.subspan(first, n), values.subspan(first, n),
                  gradients.empty() ? gradients : gradients.subspan(first, n));
      for (std::size_t i = 0; i < n; ++i) body(first + i, x[first + i] - mesh.origin, feet[i]);
    });
  }

  TriangleMesh mesh;
  bool rounded, smooth;
  MeshPatches patches;
  ClosestTriangle closest;
  VertexCorners corners;
  Box3 box;
  double sharp = 0;
  std::vector<Vec3> vertex_normal;
  std::vector<Patch> all;
  std::vector<ClosestTriangle> curves;
  GlobalSign winding;
  double trusted = 0;  ///< within this distance the closest face alone determines the side
};

MeshField::MeshField(TriangleMesh mesh, const Options& options)
    : parts_(std::make_shared<Parts>(std::move(mesh), options)) {}

Box3 MeshField::bounds() const {
  return {parts_->box.lower + parts_->mesh.origin, parts_->box.upper + parts_->mesh.origin};
}

std::uint32_t MeshField::pieces() const {
  const MeshPatches& p = parts_->patches;
  return p.patches + (parts_->rounded ? 2 * (p.curves + p.corners) : 0);
}

void MeshField::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  parts_->for_feet(x, values, gradients, [](std::size_t, const Vec3&, const Foot&) {});
}

void MeshField::active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const {
  std::vector<double> values(x.size());
  parts_->for_feet(x, values, {}, [&](std::size_t i, const Vec3& query, const Foot& foot) {
    piece[i] = parts_->piece_at(query, foot, values[i]);
  });
}

void MeshField::evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                               std::span<Vec3> gradients) const {
  const Parts& all = *parts_;
  const auto put = [&](std::size_t i, double value, const Vec3& gradient) {
    values[i] = value;
    if (!gradients.empty()) gradients[i] = gradient;
  };
  if (piece >= all.patches.patches) {
    const std::uint32_t feature = (piece - all.patches.patches) / 2;
    const double sign = (piece - all.patches.patches) % 2 ? -1 : 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 query = x[i] - all.mesh.origin, away = query - all.curves[feature].closest(query).point;
      const double distance = norm(away);
      put(i, sign * distance, distance > 0 ? away * (sign / distance) : Vec3{});
    }
    return;
  }
  const Parts::Patch& patch = all.all[piece];
  if (patch.planar) {
    const double offset = patch.offset + dot(patch.normal, all.mesh.origin);
    for (std::size_t i = 0; i < x.size(); ++i) put(i, dot(patch.normal, x[i]) - offset, patch.normal);
    return;
  }
  ClosestTriangle::Hit hit;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 query = x[i] - all.mesh.origin;
    hit = patch.faces->closest(query, hit);
    const Foot foot = all.locate(hit, patch.triangles[hit.triangle], query);
    Vec3 gradient;
    if (all.feature_of(foot) == MeshPatches::kSmooth) {
      const double value = all.value_at(query, foot, &gradient);
      put(i, value, gradient);
      continue;
    }
    // The plane of the patch continues beyond its border.
    const int k = corner_of(foot.part);
    gradient = k < 0 ? all.patches.normal[foot.triangle]
                     : normalized(all.normal_at(all.patches.triangles[foot.triangle][k], piece));
    put(i, dot(query - foot.point, gradient), gradient);
  }
}

void MeshField::survey(std::span<const Vec3> x, const SurveyReach&, std::span<double> values,
                       std::span<Surroundings> around) const {
  const Parts& all = *parts_;
  all.for_feet(x, values, {}, [&](std::size_t i, const Vec3& query, const Foot& foot) {
    around[i] = {};
    const std::uint32_t piece = all.piece_at(query, foot, values[i]);
    if (piece >= all.all.size() || !all.all[piece].others || all.feature_of(foot) != MeshPatches::kSmooth) return;
    // Another patch at twice the distance cannot become the closest before half-way.
    const double other = std::sqrt(all.all[piece].others->closest(query).squared_distance);
    around[i] = {std::max(0.0, (other - std::abs(values[i])) / 2), std::numeric_limits<double>::infinity()};
  });
}

}  // namespace sansmesh::inline v1
