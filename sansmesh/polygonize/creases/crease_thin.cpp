#include "sansmesh/polygonize/creases/crease_thin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/polygonize/editable_surface.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kThinLeastShape = 0.3;
constexpr double kTurn = 0.5;  // least cosine between a triangle's normals before and after
constexpr std::size_t kMostRing = 16;
constexpr int kMostPasses = 40;
constexpr std::size_t kWorthIt = 200;  // the last pass merges fewer than one vertex in this many

struct Thinner {
  PieceMesh& mesh;
  EditableSurface surface;
  double error;

  std::size_t n = 0;  ///< size of the ring of the current vertex
  std::array<std::uint32_t, kMostRing> leaving{}, tip{}, piece{};
  std::array<Vec3, kMostRing> spoke{}, area{};  ///< vectors to the neighbours; triangle normals of twice the area

  static double shape(const Vec3& normal, const Vec3& a, const Vec3& b) {
    const double sum = squared_norm(a) + squared_norm(b) + squared_norm(b - a);
    return sum > 0 ? 2 * std::sqrt(3.0) * norm(normal) / sum : 0;
  }

  enum class Found { nothing, later, merged };

  /// Collects the ring of v: triangle k is between neighbours k and k + 1. Returns `nothing` if v cannot be merged,
  /// `later` if it has too many neighbours, some of which may merge first; else `merged`.
  Found gather(std::uint32_t v) {
    if (surface.on_border(v) || mesh.rank[v] == 0) return Found::nothing;
    n = 0;
    bool fine = true, crowded = false;
    surface.around(v, [&](std::uint32_t h) {
      if (n == kMostRing) {
        crowded = true;
        return;
      }
      leaving[n] = h;
      tip[n] = surface.to(h);
      piece[n] = mesh.piece[h / 3];
      spoke[n] = mesh.x[tip[n]] - mesh.x[v];
      fine = fine && piece[n] != PieceMesh::kNone;
      ++n;
    });
    if (!fine || n < 3) return Found::nothing;
    if (crowded) return Found::later;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 &a = spoke[k], &b = spoke[(k + 1) % n];
      area[k] = cross(a, b);
      // Triangles without height define no plane.
      const double longest = std::max({squared_norm(a), squared_norm(b), squared_norm(b - a)});
      if (!(squared_norm(area[k]) > error * error * longest)) return Found::nothing;
    }
    return Found::merged;
  }

  /// Whether merging v into neighbour k keeps all triangles in their planes and changes no piece.
  bool in_plane(std::size_t k) const {
    const std::size_t other = (k + n - 1) % n;  // the other triangle of the edge to neighbour k
    const bool along_crease = piece[k] != piece[other];
    for (std::size_t t = 0; t < n; ++t) {
      if (!along_crease && piece[t] != piece[k]) return false;
      if (t == k || t == other) continue;
      const double off = dot(area[t], spoke[k]);
      if (off * off > error * error * squared_norm(area[t])) return false;
    }
    return true;
  }

  /// Least shape of the remaining triangles after merging v into neighbour k; below 0 if one inverts.
  double shape_after(std::size_t k) const {
    double least = 1;
    for (std::size_t t = 0; t < n; ++t) {
      if (t == k || t == (k + n - 1) % n) continue;
      const Vec3 a = spoke[t] - spoke[k], b = spoke[(t + 1) % n] - spoke[k], after = cross(a, b);
      if (dot(after, area[t]) < kTurn * norm(after) * norm(area[t])) return -1;
      least = std::min(least, shape(after, a, b));
    }
    return least;
  }

  Found merge(std::uint32_t v) {
    if (const Found found = gather(v); found != Found::merged) return found;
    double least = kThinLeastShape;
    bool asked = false, flat = false;
    double best = 0;
    std::size_t chosen = kMostRing;
    for (std::size_t k = 0; k < n; ++k) {
      if (!in_plane(k)) continue;
      flat = true;
      if (!asked) {
        for (std::size_t t = 0; t < n; ++t) least = std::min(least, shape(area[t], spoke[t], spoke[(t + 1) % n]));
        asked = true;
      }
      const double q = shape_after(k);
      if (q >= least && q > best && surface.can_collapse(leaving[k])) best = q, chosen = k;
    }
    if (chosen == kMostRing) return flat ? Found::later : Found::nothing;
    surface.collapse(leaving[chosen]);
    return Found::merged;
  }

  /// Passes in which no two merged vertices are neighbours, so that all parts coarsen evenly.
  void run() {
    std::vector<std::uint32_t> now(mesh.x.size()), next;
    for (std::uint32_t v = 0; v < now.size(); ++v) now[v] = v;
    std::vector<std::uint8_t> touched(now.size(), 0), flat(now.size(), 1), queued(now.size(), 0);
    std::size_t left = now.size();
    for (int pass = 0; pass < kMostPasses; ++pass) {
      next.clear();
      std::size_t merged = 0;
      const auto again = [&](std::uint32_t v) {
        if (flat[v] && !queued[v]) queued[v] = 1, next.push_back(v);
      };
      std::vector<std::uint32_t> reset;
      for (const std::uint32_t v : now) {
        if (!surface.used(v)) continue;
        if (touched[v]) {
          again(v);
          continue;
        }
        const Found found = merge(v);
        if (found == Found::nothing) flat[v] = 0;
        if (found != Found::merged) continue;
        ++merged;
        for (std::size_t k = 0; k < n; ++k) {
          touched[tip[k]] = 1;
          reset.push_back(tip[k]);
          again(tip[k]);
        }
      }
      for (const std::uint32_t v : reset) touched[v] = 0;
      for (const std::uint32_t v : next) queued[v] = 0;
      left -= merged;
      if (merged * kWorthIt < left) break;
      std::swap(now, next);
    }
  }
};

}  // namespace

void thin_flat_parts(PieceMesh& mesh, double error) {
  const std::size_t triangles = mesh.triangles.size();
  Thinner thinner{mesh, EditableSurface(std::move(mesh.triangles), mesh.x.size()), error};
  thinner.run();
  mesh.triangles.clear();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    if (!thinner.surface.alive(t)) continue;
    mesh.triangles.push_back(thinner.surface[t]);
    mesh.piece[kept++] = mesh.piece[t];
  }
  mesh.piece.resize(kept);
  drop_unused_vertices(mesh);
}

}  // namespace sansmesh::inline v1
