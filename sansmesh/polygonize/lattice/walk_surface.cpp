#include "sansmesh/polygonize/lattice/walk_surface.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/polygonize/lattice/marched_simplex.h"
#include "sansmesh/triangulation/block_tree_view.h"
#include "sansmesh/triangulation/j1a.h"

namespace sansmesh::inline v1 {
namespace {

using Tuple = Simplex<3>;
using Corners = std::array<std::uint32_t, 4>;

struct LatticeVertexHash {
  std::size_t operator()(const LatticeVertex<3>& v) const {
    std::uint64_t h = 0;
    for (const std::int64_t k : v) {
      h = (h ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return h;
  }
};

bool on_cube_face(const LatticeVertex<3>& v) {
  return std::any_of(v.begin(), v.end(), [](std::int64_t k) { return k == 0 || k == kLatticeEdge; });
}

/// Six times the signed volume.
double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return dot(b - a, cross(c - a, d - a)); }

/// The level that limits the move of the i-th vertex of a simplex: that of its block, one more on a refined face.
int level_of(const Tuple& s, int i) { return s.level + (s.steps < 3 && i >= s.steps ? 1 : 0); }

class SurfaceWalk {
 public:
  SurfaceWalk(const ScalarField& field, BlockTree blocks, const Vec3& origin)
      : field_(field), tree_(std::move(blocks)), view_(tree_), origin_(origin) {
    tree_.balance();
  }

  /// Finds the crossing simplices, their vertices and the values there.
  void walk(const std::vector<Vec3>& seeds, Progress& progress, WalkReport& r) {
    std::vector<Tuple> starts;
    starts.reserve(seeds.size());
    for (const Vec3& x : seeds)
      if (const auto s = locate<3>(view_, view_.to_lattice(x))) starts.push_back(*s);
    std::unordered_map<LatticeVertex<3>, std::uint32_t, LatticeVertexHash> number;
    const auto inside = [&](std::span<const LatticeVertex<3>> asked, std::span<std::uint8_t> answers) {
      progress.check();
      const std::size_t before = points_.size();
      points_.insert(points_.end(), asked.begin(), asked.end());
      evaluate_from(before);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        number.emplace(asked[i], static_cast<std::uint32_t>(before + i));
        answers[i] = values_[before + i] < 0;
      }
    };
    simplices_ = walk_crossing<3>(view_, starts, inside);
    corners_.resize(simplices_.size());
    for (std::size_t n = 0; n < simplices_.size(); ++n) {
      const auto v = vertices(simplices_[n]);
      for (std::size_t i = 0; i < 4; ++i) corners_[n][i] = number.at(v[i]);
    }
    r.simplices = simplices_.size();
    for (const Tuple& s : starts) {
      int in = 0;
      for (const LatticeVertex<3>& v : vertices(s)) in += values_[number.at(v)] < 0;
      r.started += in > 0 && in < 4;
    }
  }

  /// Displacement of tejada2008, 4.4.3 (WalkOptions::displacement).
  void displace(double alpha, WalkReport& r) {
    const std::size_t n = points_.size();
    std::vector<std::int8_t> level(n, -1);
    for (std::size_t s = 0; s < simplices_.size(); ++s)
      for (int i = 0; i < 4; ++i) {
        std::int8_t& l = level[corners_[s][static_cast<std::size_t>(i)]];
        l = std::max(l, static_cast<std::int8_t>(level_of(simplices_[s], i)));
      }
    std::array<double, kDeepestBlockLevel + 2> most{};
    for (std::size_t v = 0; v < n; ++v)
      if (level[v] >= 0)
        most[static_cast<std::size_t>(level[v])] =
            std::max(most[static_cast<std::size_t>(level[v])], std::abs(values_[v]));
    std::vector<double> f(n);
    std::vector<Vec3> g(n), target = positions_;
    field_.evaluate(positions_, f, g);
    parallel_for(0, n, 4096, [&](std::size_t v) {
      const double slope = norm(g[v]);
      if (level[v] < 0 || !(slope > 0) || on_cube_face(points_[v])) return;
      const double top = most[static_cast<std::size_t>(level[v])],
                   edge = tree_.edge() / static_cast<double>(1u << level[v]);
      if (!(top > 0)) return;
      const double step = (top - std::abs(values_[v])) / top * alpha * edge / 4;
      target[v] += g[v] * ((values_[v] < 0 ? -step : step) / slope);
    });
    field_.evaluate(target, f);
    std::vector<std::uint8_t> moves(n, 0);
    for (std::size_t v = 0; v < n; ++v) {
      if (target[v] == positions_[v]) continue;
      moves[v] = (f[v] < 0) == (values_[v] < 0);
      r.held += !moves[v];
    }
    hold_turned(target, moves, r);
    for (std::size_t v = 0; v < n; ++v) {
      if (!moves[v]) continue;
      positions_[v] = target[v];
      values_[v] = f[v];
      ++r.moved;
    }
  }

  TriangleMesh triangles(Progress& progress) {
    TriangleMesh mesh;
    mesh.origin = origin_;
    std::unordered_map<std::uint64_t, std::uint32_t> vertex;
    std::vector<Vec3> x;
    const auto crossing = [&](std::uint32_t in, std::uint32_t out) {
      const auto [it, fresh] = vertex.try_emplace(std::uint64_t{in} << 32 | out, static_cast<std::uint32_t>(x.size()));
      if (fresh) {
        const double t = values_[in] / (values_[in] - values_[out]);
        x.push_back(positions_[in] + (positions_[out] - positions_[in]) * t);
      }
      return it->second;
    };
    for (std::size_t n = 0; n < simplices_.size(); ++n) {
      progress.check();
      march(n, crossing, mesh.triangles);
    }
    mesh.vertices.resize(x.size());
    mesh.normals.resize(x.size());
    std::vector<double> f(x.size());
    std::vector<Vec3> g(x.size());
    field_.evaluate(x, f, g);
    parallel_for(0, x.size(), 4096, [&](std::size_t i) {
      mesh.vertices[i] = Vec3f(x[i] - origin_);
      mesh.normals[i] = Vec3f(normalized(g[i]));
    });
    return mesh;
  }

 private:
  /// Values are positive on the cube's faces, which closes the mesh.
  void evaluate_from(std::size_t first) {
    positions_.resize(points_.size());
    values_.resize(points_.size());
    parallel_for(first, points_.size(), 8192, [&](std::size_t i) { positions_[i] = view_.position(points_[i]); });
    field_.evaluate(std::span(positions_).subspan(first), std::span(values_).subspan(first));
    parallel_for(first, points_.size(), 8192, [&](std::size_t i) {
      if (values_[i] < 0 && on_cube_face(points_[i])) values_[i] = -values_[i];
    });
  }

  /// Keeps vertices in place whose moves would invert a crossing simplex, and the other vertices of that simplex. The
  /// mesh would remain a manifold, which depends on signs alone, but it would fold.
  void hold_turned(const std::vector<Vec3>& target, std::vector<std::uint8_t>& moves, WalkReport& r) const {
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<std::uint8_t> hold(moves.size(), 0);
      const auto at = [&](std::uint32_t v) { return moves[v] ? target[v] : positions_[v]; };
      for (const Corners& c : corners_) {
        const double was = volume(positions_[c[0]], positions_[c[1]], positions_[c[2]], positions_[c[3]]),
                     is = volume(at(c[0]), at(c[1]), at(c[2]), at(c[3]));
        if (is * was > 0) continue;
        for (const std::uint32_t v : c) hold[v] = 1;
      }
      for (std::size_t v = 0; v < moves.size(); ++v) {
        if (!hold[v] || !moves[v]) continue;
        moves[v] = 0, changed = true;
        ++r.held;
      }
    }
  }

  /// Triangles of one simplex, with normals towards positive values.
  template <class Crossing>
  void march(std::size_t n, const Crossing& crossing, std::vector<Triangle>& out) const {
    Corners v = corners_[n];
    if (orientation(simplices_[n]) < 0) std::swap(v[2], v[3]);
    unsigned mask = 0;
    for (unsigned i = 0; i < 4; ++i) mask |= (values_[v[i]] < 0 ? 1u : 0u) << i;
    march_simplex(
        mask, [&](std::size_t i, std::size_t j) { return crossing(v[i], v[j]); },
        [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
          out.push_back({p, q, r});
        });
  }

  const ScalarField& field_;
  BlockTree tree_;
  BlockTreeView view_;
  Vec3 origin_;
  std::vector<Tuple> simplices_;  ///< crossing simplices
  std::vector<Corners> corners_;  ///< corners of each simplex
  std::vector<LatticeVertex<3>> points_;
  std::vector<Vec3> positions_;
  std::vector<double> values_;
};

}  // namespace

TriangleMesh walk_surface(const ScalarField& field, BlockTree blocks, const Vec3& origin, const WalkOptions& options,
                          Progress& progress, WalkReport* report) {
  if (!(options.displacement >= 0 && options.displacement < 1))
    throw ArgumentError("walk: `displacement` must lie in [0, 1)");
  WalkReport local;
  WalkReport& r = report ? *report : local;
  r = {};
  progress.begin("walk");
  SurfaceWalk walk(field, std::move(blocks), origin);
  walk.walk(options.seeds, progress, r);
  if (options.displacement > 0) {
    progress.begin("displace");
    walk.displace(options.displacement, r);
  }
  progress.begin("triangles");
  TriangleMesh mesh = walk.triangles(progress);
  progress.finish();
  return mesh;
}

}  // namespace sansmesh::inline v1
