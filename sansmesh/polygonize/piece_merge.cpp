#include "sansmesh/polygonize/piece_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "sansmesh/polygonize/editable_surface.h"

namespace sansmesh {
namespace {

/// The least shape of triangles, and where they lie in planes: regular grids of vertices offer nothing better on the
/// way to a few large ones.
constexpr double kMergeLeastShape = 0.3, kMergeLeastShapeOfFlat = 0.1;
constexpr double kMostTurn = 0.5;  ///< least cosine between a triangle and its piece
constexpr double kRoomShare = 0.25;
constexpr std::size_t kMostSpokes = 48;
constexpr int kMostMergePasses = 40;
constexpr std::size_t kWorthAPass = 5000;

struct Merger {
  CutPieces& mesh;
  std::vector<Vec3>& normal;
  const PieceMergeOptions& options;
  EditableSurface surface;
  std::vector<std::uint32_t> into;  ///< by vertex: the one that it was merged into, or itself

  std::size_t n = 0;
  std::array<std::uint32_t, kMostSpokes> leaving{}, tip{};
  std::array<Vec3, kMostSpokes> spoke{}, area{}, facing{};
  std::array<double, kMostSpokes> before{};

  static double signed_shape(const Vec3& a, const Vec3& b, const Vec3& area, const Vec3& facing) {
    const double sum = squared_norm(a) + squared_norm(b) + squared_norm(b - a);
    return sum > 0 ? 2 * std::sqrt(3.0) * dot(area, facing) / sum : 0;
  }

  bool gather(std::uint32_t v) {
    if (surface.on_border(v)) return false;
    n = 0;
    bool fine = true;
    surface.around(v, [&](std::uint32_t h) {
      if (n == kMostSpokes) {
        fine = false;
        return;
      }
      leaving[n] = h;
      tip[n] = surface.to(h);
      facing[n] = normal[h / 3];
      spoke[n] = mesh.vertices[tip[n]].x - mesh.vertices[v].x;
      ++n;
    });
    if (!fine || n < 3) return false;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 &a = spoke[k], &b = spoke[(k + 1) % n];
      area[k] = cross(a, b);
      before[k] = signed_shape(a, b, area[k], facing[k]);
    }
    return true;
  }

  /// Whether all pieces of v are pieces of w.
  bool on_all(std::uint32_t v, std::uint32_t w) const {
    const auto &p = mesh.vertices[v].piece, &q = mesh.vertices[w].piece;
    return std::all_of(p.begin(), p.end(), [&](std::uint32_t piece) {
      return piece == CutPieces::kNone || std::find(q.begin(), q.end(), piece) != q.end();
    });
  }

  /// How far merging v into neighbour k would move triangles out of their planes.
  double leaves_planes(std::size_t k) const {
    double most = 0;
    for (std::size_t t = 0; t < n; ++t) {
      if (t == k || t == (k + n - 1) % n) continue;
      const double size = norm(area[t]), longest = std::max(squared_norm(spoke[t]), squared_norm(spoke[(t + 1) % n]));
      // One without height has no plane: its piece says how it should lie.
      const double off =
          size > 1e-3 * longest ? std::abs(dot(area[t], spoke[k])) / size : std::abs(dot(facing[t], spoke[k]));
      most = std::max(most, off);
    }
    return most;
  }

  /// The least shape of the triangles that are left; below −1 if one turns too far.
  double shape_after(std::size_t k) const {
    double least = 1;
    for (std::size_t t = 0; t < n; ++t) {
      if (t == k || t == (k + n - 1) % n) continue;
      const Vec3 a = spoke[t] - spoke[k], b = spoke[(t + 1) % n] - spoke[k], after = cross(a, b);
      const double shape = signed_shape(a, b, after, facing[t]);
      if (dot(after, facing[t]) < kMostTurn * norm(after) && shape <= before[t]) return -2;
      least = std::min(least, shape);
    }
    return least;
  }

  bool merge(std::uint32_t v, bool& later) {
    if (!gather(v)) return false;
    const CutPieces::Vertex& vertex = mesh.vertices[v];
    const double room = kRoomShare * static_cast<double>(vertex.room);
    const double near = options.near * static_cast<double>(vertex.size);
    double least = options.straight[v] ? kMergeLeastShapeOfFlat : kMergeLeastShape, best = -2;
    for (std::size_t t = 0; t < n; ++t) least = std::min(least, before[t]);
    std::size_t chosen = n;
    for (std::size_t k = 0; k < n; ++k) {
      const double length = norm(spoke[k]);
      if (length <= options.nothing) {
        later = true;
        if (!surface.can_collapse(leaving[k])) continue;
        chosen = k;
        break;
      }
      if (!on_all(v, tip[k])) continue;
      // Along a crease, not across what lies between two parts of it.
      if (vertex.rank() > 1 && mesh.piece[leaving[k] / 3] == mesh.piece[leaving[(k + n - 1) % n] / 3]) continue;
      const double off = leaves_planes(k);
      const double near_by = options.straight[v] ? options.rounding : room;
      if (off > (length <= near ? near_by : std::min(near_by, options.flat))) continue;
      later = true;
      const double q = shape_after(k);
      if (q >= least && q > best && surface.can_collapse(leaving[k])) best = q, chosen = k;
    }
    if (chosen == n) return false;
    CutPieces::Vertex& kept = mesh.vertices[tip[chosen]];
    kept.room = std::min(kept.room, vertex.room);
    into[v] = tip[chosen];
    surface.collapse(leaving[chosen]);
    return true;
  }

  /// Passes in which no two merged vertices are neighbours, so that all parts become coarser alike.
  void run() {
    std::vector<std::uint32_t> now(mesh.vertices.size()), next, reset;
    for (std::uint32_t v = 0; v < now.size(); ++v) now[v] = v;
    std::vector<std::uint8_t> touched(now.size(), 0), open(now.size(), 1), queued(now.size(), 0);
    std::size_t left = now.size();
    for (int pass = 0; pass < kMostMergePasses; ++pass) {
      next.clear();
      reset.clear();
      std::size_t merged = 0;
      const auto again = [&](std::uint32_t v) {
        if (open[v] && !queued[v]) queued[v] = 1, next.push_back(v);
      };
      for (const std::uint32_t v : now) {
        if (!surface.used(v)) continue;
        if (touched[v]) {
          again(v);
          continue;
        }
        bool later = false;
        const bool done = merge(v, later);
        open[v] = later;
        if (!done) continue;
        ++merged;
        for (std::size_t k = 0; k < n; ++k) {
          touched[tip[k]] = 1;
          reset.push_back(tip[k]);
          open[tip[k]] = 1;
          again(tip[k]);
        }
      }
      for (const std::uint32_t v : reset) touched[v] = 0;
      for (const std::uint32_t v : next) queued[v] = 0;
      left -= merged;
      if (merged * kWorthAPass < left) break;
      std::swap(now, next);
    }
  }
};

}  // namespace

std::vector<std::uint32_t> merge_pieces(CutPieces& mesh, std::vector<Vec3>& normal, const PieceMergeOptions& options) {
  const std::size_t count = mesh.triangles.size();
  Merger merger{mesh, normal, options, EditableSurface(std::move(mesh.triangles), mesh.vertices.size()), {}};
  merger.into.resize(mesh.vertices.size());
  std::iota(merger.into.begin(), merger.into.end(), 0u);
  merger.run();
  mesh.triangles.clear();
  std::size_t kept = 0;
  std::vector<std::uint32_t> number(mesh.vertices.size(), CutPieces::kNone);
  for (std::size_t t = 0; t < count; ++t) {
    if (!merger.surface.alive(t)) continue;
    mesh.triangles.push_back(merger.surface[t]);
    mesh.piece[kept] = mesh.piece[t];
    normal[kept++] = normal[t];
    for (const std::uint32_t v : merger.surface[t]) number[v] = 0;
  }
  mesh.piece.resize(kept);
  normal.resize(kept);
  std::uint32_t used = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == CutPieces::kNone) continue;
    number[v] = used;
    mesh.vertices[used++] = mesh.vertices[v];
  }
  mesh.vertices.resize(used);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  std::vector<std::uint32_t> becomes(number.size());
  for (std::uint32_t v = 0; v < becomes.size(); ++v) {
    std::uint32_t last = v;
    while (merger.into[last] != last) last = merger.into[last];
    for (std::uint32_t w = v; merger.into[w] != last;) w = std::exchange(merger.into[w], last);
    becomes[v] = number[last];
  }
  return becomes;
}

}  // namespace sansmesh
