#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/core/edge_key.h"

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/repair/components.h"

namespace sansmesh::inline v1 {
namespace {

/// Keeps the part with height >= 0; `correct(position)` corrects new vertices.
template <class Correct>
class HeightCut {
 public:
  HeightCut(TriangleMesh& mesh, std::vector<float> heights, const Correct& correct)
      : mesh_(mesh), heights_(std::move(heights)), correct_(correct) {}

  void run() {
    if (std::none_of(heights_.begin(), heights_.end(), [](float h) { return h < 0; })) return;
    std::vector<Triangle> kept;
    std::vector<std::uint32_t> of;  // original triangle of each part
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      cut(mesh_.triangles[i], kept);
      of.resize(kept.size(), static_cast<std::uint32_t>(i));
    }
    mesh_.triangles = std::move(kept);
    if (!mesh_.triangle_attributes.empty()) mesh_.triangle_attributes = mesh_.triangle_attributes.taken(of);
  }

 private:
  /// Vertex where the edge from an inner to an outer vertex crosses height 0.
  std::uint32_t crossing(std::uint32_t in, std::uint32_t out) {
    if (heights_[in] == 0) return in;
    const auto [entry, is_new] = made_.try_emplace(std::uint64_t{in} << 32 | out, 0);
    if (!is_new) return entry->second;
    const float a = heights_[in], b = heights_[out], t = a / (a - b);
    Vec3f x = mesh_.vertices[in] + (mesh_.vertices[out] - mesh_.vertices[in]) * t;
    correct_(x);
    heights_.push_back(0);
    return entry->second = append_vertex_between(mesh_, in, out, t, x);
  }

  void cut(const Triangle& t, std::vector<Triangle>& kept) {
    std::array<std::uint32_t, 5> polygon{};
    std::size_t n = 0;
    const auto add = [&](std::uint32_t v) {
      if (n == 0 || polygon[n - 1] != v) polygon[n++] = v;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const bool a_in = heights_[a] >= 0, b_in = heights_[b] >= 0;
      if (a_in) add(a);
      if (a_in != b_in) add(a_in ? crossing(a, b) : crossing(b, a));
    }
    if (n > 1 && polygon[n - 1] == polygon[0]) --n;
    for (std::size_t k = 1; k + 1 < n; ++k) kept.push_back({polygon[0], polygon[k], polygon[k + 1]});
  }

  TriangleMesh& mesh_;
  std::vector<float> heights_;
  const Correct& correct_;
  std::unordered_map<std::uint64_t, std::uint32_t> made_;
};

/// Keeps the side of a plane perpendicular to `axis` where sign · (x − at) >= 0.
void cut_by_plane(TriangleMesh& mesh, std::size_t axis, float at, float sign) {
  std::vector<float> heights(mesh.vertices.size());
  for (std::size_t v = 0; v < heights.size(); ++v) heights[v] = sign * (mesh.vertices[v][axis] - at);
  const auto correct = [&](Vec3f& x) { x[axis] = at; };
  HeightCut(mesh, std::move(heights), correct).run();
}

/// Divides triangles along the planes of a box: those that may intersect it, and neighbours with a divided edge in
/// common.
class BoxCutOut {
 public:
  BoxCutOut(TriangleMesh& mesh, const Box3f& box) : mesh_(mesh), box_(box) {}

  void run() {
    for (const Triangle& t : mesh_.triangles) {
      Box3f of;
      for (const std::uint32_t v : t) of.extend(mesh_.vertices[v]);
      bool apart = false;
      for (std::size_t k = 0; k < 3; ++k) apart |= of.upper[k] <= box_.lower[k] || of.lower[k] >= box_.upper[k];
      inside_.push_back(!apart);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      divide(axis, box_.lower[axis], 1);
      divide(axis, box_.upper[axis], -1);
    }
    std::vector<std::uint8_t> keep(inside_.size());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = !inside_[i];
    keep_triangles(mesh_, keep);
  }

 private:
  void divide(std::size_t axis, float at, float sign) {
    const auto height = [&](std::uint32_t v) { return sign * (mesh_.vertices[v][axis] - at); };
    std::unordered_map<std::uint64_t, std::uint32_t> made;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      for (std::size_t k = 0; inside_[i] && k < 3; ++k) {
        const std::uint32_t a = std::min(mesh_.triangles[i][k], mesh_.triangles[i][(k + 1) % 3]);
        const std::uint32_t b = std::max(mesh_.triangles[i][k], mesh_.triangles[i][(k + 1) % 3]);
        const float ha = height(a), hb = height(b);
        if (!((ha < 0 && hb > 0) || (ha > 0 && hb < 0))) continue;
        const auto [entry, is_new] = made.try_emplace(edge_key(a, b), 0);
        if (!is_new) continue;
        const float t = ha / (ha - hb);
        Vec3f x = mesh_.vertices[a] + (mesh_.vertices[b] - mesh_.vertices[a]) * t;
        x[axis] = at;
        entry->second = append_vertex_between(mesh_, a, b, t, x);
      }
    std::vector<Triangle> triangles;
    std::vector<std::uint8_t> inside;
    std::vector<std::uint32_t> of;
    const auto add = [&](std::size_t i, const Triangle& t) {
      const bool below = height(t[0]) < 0 || height(t[1]) < 0 || height(t[2]) < 0;
      // A triangle in the plane has no inner part.
      const bool flat = !(height(t[0]) > 0 || height(t[1]) > 0 || height(t[2]) > 0);
      triangles.push_back(t);
      inside.push_back(inside_[i] && !below && !flat);
      of.push_back(static_cast<std::uint32_t>(i));
    };
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Triangle t = mesh_.triangles[i];
      std::array<std::uint32_t, 3> cut{};
      std::size_t cuts = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = made.find(edge_key(t[k], t[(k + 1) % 3]));
        cut[k] = found == made.end() ? kNoVertex : found->second;
        cuts += cut[k] != kNoVertex;
      }
      if (cuts == 0) {
        add(i, t);
      } else if (cuts == 1) {
        const std::size_t k = cut[0] != kNoVertex ? 0 : cut[1] != kNoVertex ? 1 : 2;
        add(i, {t[k], cut[k], t[(k + 2) % 3]});
        add(i, {cut[k], t[(k + 1) % 3], t[(k + 2) % 3]});
      } else {  // one corner, and a quadrilateral as two triangles; a plane does not cross three edges
        const std::size_t k = cut[0] == kNoVertex   ? 2
                              : cut[1] == kNoVertex ? 0
                                                    : 1;  // corner between the edges k − 1 and k
        const std::uint32_t before = cut[(k + 2) % 3], after = cut[k];
        add(i, {t[k], after, before});
        add(i, {before, after, t[(k + 1) % 3]});
        add(i, {before, t[(k + 1) % 3], t[(k + 2) % 3]});
      }
    }
    if (!made.empty() && !mesh_.triangle_attributes.empty())
      mesh_.triangle_attributes = mesh_.triangle_attributes.taken(of);
    mesh_.triangles = std::move(triangles);
    inside_ = std::move(inside);
  }

  TriangleMesh& mesh_;
  Box3f box_;
  std::vector<std::uint8_t> inside_;  ///< per triangle: inside all planes so far
};

/// Moves vertices close to the contour onto it, along the edge with the nearest crossing.
void snap_to_contour(TriangleMesh& mesh, std::vector<float>& heights, float snap) {
  struct Move {
    float share = 1;  ///< fraction of the edge
    Vec3f to;
  };
  std::unordered_map<std::uint32_t, Move> moves;
  const auto look = [&](std::uint32_t v, std::uint32_t to) {
    const float t = heights[v] / (heights[v] - heights[to]);
    if (!(t <= snap)) return;
    Move& m = moves[v];
    if (t < m.share) m = {t, mesh.vertices[v] + (mesh.vertices[to] - mesh.vertices[v]) * t};
  };
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if ((heights[a] < 0) == (heights[b] < 0)) continue;
      look(a, b), look(b, a);
    }
  for (const auto& [v, move] : moves) {
    mesh.vertices[v] = move.to;
    heights[v] = 0;
  }
}

}  // namespace

void clip_mesh(TriangleMesh& mesh, const Box3f& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cut_by_plane(mesh, axis, box.lower[axis], 1);
    cut_by_plane(mesh, axis, box.upper[axis], -1);
  }
  keep_triangles(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1));
  separate_fans(mesh);
}

void cut_out_box(TriangleMesh& mesh, const Box3f& box) {
  BoxCutOut(mesh, box).run();
  separate_fans(mesh);
}

void clip_mesh(TriangleMesh& mesh, std::vector<float> heights, float snap) {
  snap_to_contour(mesh, heights, snap);
  const auto stay = [](Vec3f&) {};
  // A triangle moved entirely onto the contour is not above it.
  std::erase_if(mesh.triangles,
                [&](const Triangle& t) { return heights[t[0]] <= 0 && heights[t[1]] <= 0 && heights[t[2]] <= 0; });
  HeightCut(mesh, std::move(heights), stay).run();
  keep_triangles(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1));
  separate_fans(mesh);
}

}  // namespace sansmesh::inline v1
