#include "sansmesh/polygonize/pieces/piece_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/polygonize/editable_surface.h"

namespace sansmesh::inline v1 {
namespace {

/// Least triangle shape, in general and in planes, where regular grids of vertices offer nothing better on the way to a
/// few large triangles.
constexpr double kMergeLeastShape = 0.3, kMergeLeastShapeOfFlat = 0.1;
constexpr double kMostTurn = 0.5;  ///< least cosine between a triangle and its piece
constexpr double kRoomShare = 0.25;
constexpr std::size_t kMostSpokes = 48;
constexpr int kMostMergePasses = 40;
constexpr std::size_t kWorthAPass = 5000;
/// Number of vertices merged sequentially, far more than those adjacent to another region. Results depend on it.
constexpr std::size_t kFewestOfRegion = 4096, kMostRegions = 64;

/// The mesh during coarsening. Vertices with successive indices are close to each other; each block of indices is a
/// region.
struct Merging {
  CutPieces& mesh;
  const std::vector<Vec3>& normal;
  const PieceMergeOptions& options;
  EditableSurface surface;
  std::vector<std::uint32_t> into;  ///< per vertex: the vertex that it was merged into, or itself
  /// Per vertex: changed in this pass, to be visited in this pass, in the next.
  std::vector<std::uint8_t> touched, open, queued;
  std::size_t region_size;
  std::vector<std::vector<std::uint32_t>> now, next;  ///< per region: vertices of this pass and the next

  Merging(CutPieces& cut, const std::vector<Vec3>& facing, const PieceMergeOptions& chosen)
      : mesh(cut),
        normal(facing),
        options(chosen),
        surface(std::move(cut.triangles), cut.vertices.size()),
        into(cut.vertices.size()),
        touched(into.size(), 0),
        open(into.size(), 1),
        queued(into.size(), 0),
        region_size(std::max(kFewestOfRegion, into.size() / kMostRegions + 1)),
        now((into.size() + region_size - 1) / region_size),
        next(now.size()) {
    std::iota(into.begin(), into.end(), 0u);
    for (const std::uint32_t v : into) now[region_of(v)].push_back(v);
  }

  std::size_t region_of(std::uint32_t v) const { return v / region_size; }
};

/// Merges vertices sequentially. A merge accesses only the vertex and its neighbours: if all are in one region, other
/// threads can process other regions.
struct Merger {
  static constexpr std::size_t kAnywhere = ~std::size_t{0};

  Merging& all;
  std::size_t region = kAnywhere;       ///< the only one that may change
  std::vector<std::uint32_t> beside{};  ///< vertices with neighbours in other regions, postponed
  std::size_t merged = 0;

  CutPieces& mesh = all.mesh;
  EditableSurface& surface = all.surface;
  const PieceMergeOptions& options = all.options;
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
    bool fine = true, inside = true;
    surface.around(v, [&](std::uint32_t h) {
      inside = inside && (region == kAnywhere || all.region_of(surface.to(h)) == region);
      if (n == kMostSpokes) {
        fine = false;
        return;
      }
      leaving[n] = h;
      tip[n] = surface.to(h);
      facing[n] = all.normal[h / 3];
      spoke[n] = mesh.vertices[tip[n]].x - mesh.vertices[v].x;
      ++n;
    });
    if (!inside) beside.push_back(v);
    if (!inside || !fine || n < 3) return false;
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

  /// Largest distance by which merging v into neighbour k moves triangles out of their planes.
  double leaves_planes(std::size_t k) const {
    double most = 0;
    for (std::size_t t = 0; t < n; ++t) {
      if (t == k || t == (k + n - 1) % n) continue;
      const double size = norm(area[t]), longest = std::max(squared_norm(spoke[t]), squared_norm(spoke[(t + 1) % n]));
      // A triangle without height has no plane: use the normal of its piece.
      const double off =
          size > 1e-3 * longest ? std::abs(dot(area[t], spoke[k])) / size : std::abs(dot(facing[t], spoke[k]));
      most = std::max(most, off);
    }
    return most;
  }

  /// Least shape of the remaining triangles; below −1 if one turns too far.
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
      // Merge along a crease, not across the region between two parts of it.
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
    all.into[v] = tip[chosen];
    surface.collapse(leaving[chosen]);
    return true;
  }

  void again(std::uint32_t v) {
    if (all.open[v] && !all.queued[v]) all.queued[v] = 1, all.next[all.region_of(v)].push_back(v);
  }

  /// No two vertices merged in a pass are neighbours, so that all parts coarsen evenly.
  void pass(const std::vector<std::uint32_t>& vertices) {
    for (const std::uint32_t v : vertices) {
      check_cancelled();
      if (!surface.used(v)) continue;
      if (all.touched[v]) {
        again(v);
        continue;
      }
      const std::size_t left_alone = beside.size();
      bool later = false;
      const bool done = merge(v, later);
      if (beside.size() > left_alone) continue;
      all.open[v] = later;
      if (!done) continue;
      ++merged;
      for (std::size_t k = 0; k < n; ++k) {
        all.touched[tip[k]] = all.open[tip[k]] = 1;
        again(tip[k]);
      }
    }
  }
};

/// All regions in parallel, then the vertices between them, until almost nothing changes.
void run_passes(Merging& all) {
  std::size_t left = all.into.size();
  std::vector<Merger> mergers;
  mergers.reserve(all.now.size());
  for (std::size_t region = 0; region < all.now.size(); ++region) mergers.push_back(Merger{all, region});
  Merger between{all};
  for (int pass = 0; pass < kMostMergePasses; ++pass) {
    parallel_for(0, mergers.size(), 1, [&](std::size_t region) {
      mergers[region].merged = 0;
      mergers[region].beside.clear();
      mergers[region].pass(all.now[region]);
    });
    between.merged = 0;
    for (const Merger& merger : mergers) between.pass(merger.beside);
    std::size_t merged = between.merged;
    for (const Merger& merger : mergers) merged += merger.merged;
    left -= merged;
    if (merged * kWorthAPass < left) break;
    std::swap(all.now, all.next);
    for (std::size_t region = 0; region < all.now.size(); ++region) {
      for (const std::uint32_t v : all.now[region]) all.touched[v] = all.queued[v] = 0;
      all.next[region].clear();
    }
  }
}

}  // namespace

std::vector<std::uint32_t> merge_pieces(CutPieces& mesh, std::vector<Vec3>& normal, const PieceMergeOptions& options) {
  const std::size_t count = mesh.triangles.size();
  Merging merging(mesh, normal, options);
  run_passes(merging);
  mesh.triangles.clear();
  std::size_t kept = 0;
  std::vector<std::uint32_t> number(mesh.vertices.size(), CutPieces::kNone);
  for (std::size_t t = 0; t < count; ++t) {
    if (!merging.surface.alive(t)) continue;
    mesh.triangles.push_back(merging.surface[t]);
    mesh.piece[kept] = mesh.piece[t];
    normal[kept++] = normal[t];
    for (const std::uint32_t v : merging.surface[t]) number[v] = 0;
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
    while (merging.into[last] != last) last = merging.into[last];
    for (std::uint32_t w = v; merging.into[w] != last;) w = std::exchange(merging.into[w], last);
    becomes[v] = number[last];
  }
  return becomes;
}

}  // namespace sansmesh::inline v1
