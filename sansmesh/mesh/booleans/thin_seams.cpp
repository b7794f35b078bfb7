#include "sansmesh/mesh/booleans/thin_seams.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kGone = ~std::uint32_t{0};
constexpr int kThinningPasses = 4;
/// A collapse may not make the flattest face at a vertex flatter than this share of what it was, unless faces stay
/// above the second: ratio of height and longest edge.
constexpr double kFlatterShare = 0.5, kFairShape = 0.1;

class SeamThinning {
 public:
  SeamThinning(BooleanResult& mesh, double tolerance) : mesh_(mesh), tolerance_(tolerance) {
    number_.assign(mesh.vertices.size(), kGone);
    normal_.assign(mesh.triangles.size(), kGone);
    for (std::uint32_t i = 0; i < mesh.cut_faces.size(); ++i) {
      normal_[mesh.cut_faces[i].face] = i;
      for (const std::uint32_t v : mesh.triangles[mesh.cut_faces[i].face])
        if (number_[v] == kGone) {
          number_[v] = static_cast<std::uint32_t>(faces_.size());
          faces_.emplace_back();
        }
    }
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      for (const std::uint32_t v : mesh.triangles[f])
        if (number_[v] != kGone) faces_[number_[v]].push_back(f);
  }

  ThinnedSeams run() {
    ThinnedSeams done;
    for (int pass = 0; pass < kThinningPasses; ++pass) {
      std::size_t removed = 0;
      for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v)
        if (number_[v] != kGone && !mesh_.sources[v].given && !faces_of(v).empty()) removed += remove(v) ? 1 : 0;
      done.removed += removed;
      if (removed == 0) break;
    }
    for (const auto& [face, normal] : mesh_.cut_faces)
      if (mesh_.triangles[face][0] != kGone) done.inverted += dot(area_of(mesh_.triangles[face]), normal) <= 0;
    if (done.removed > 0) compact();
    return done;
  }

 private:
  std::vector<std::uint32_t>& faces_of(std::uint32_t v) { return faces_[number_[v]]; }
  const Vec3& normal_of(std::uint32_t face) const { return mesh_.cut_faces[normal_[face]].normal; }
  Vec3 area_of(const Triangle& t) const {
    const auto& x = mesh_.vertices;
    return cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
  }
  /// Height over the longest edge; negative if the face is turned over.
  double shape_of(const Triangle& t, const Vec3& normal) const {
    const auto& x = mesh_.vertices;
    const double longest =
        std::max({squared_norm(x[t[1]] - x[t[0]]), squared_norm(x[t[2]] - x[t[1]]), squared_norm(x[t[0]] - x[t[2]])});
    return longest > 0 ? dot(area_of(t), normal) / longest : 0;
  }
  static bool has(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

  /// Vertices with an edge to v.
  std::vector<std::uint32_t> neighbours(std::uint32_t v) {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t f : faces_of(v))
      for (const std::uint32_t w : mesh_.triangles[f])
        if (w != v) found.push_back(w);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  bool remove(std::uint32_t v) {
    const std::vector<std::uint32_t> around = neighbours(v);
    double worst = 1;
    for (const std::uint32_t f : faces_of(v)) {
      if (normal_[f] == kGone) return false;
      worst = std::min(worst, shape_of(mesh_.triangles[f], normal_of(f)));
    }
    const double needed = worst > 0 ? std::min(kFlatterShare * worst, kFairShape) : 0;
    std::uint32_t best = kGone;
    double best_shape = 0;
    for (const std::uint32_t u : around) {
      const Vec3 move = mesh_.vertices[u] - mesh_.vertices[v];
      double off = 0, shape = 1;
      for (const std::uint32_t f : faces_of(v)) off = std::max(off, std::abs(dot(normal_of(f), move)));
      if (off > tolerance_) continue;
      for (const std::uint32_t f : faces_of(v)) {
        if (has(mesh_.triangles[f], u)) continue;
        Triangle moved = mesh_.triangles[f];
        for (std::uint32_t& w : moved)
          if (w == v) w = u;
        shape = std::min(shape, shape_of(moved, normal_of(f)));
      }
      if (shape <= needed || shape <= best_shape || !keeps_topology(around, u)) continue;
      best = u, best_shape = shape;
    }
    if (best == kGone) return false;
    collapse(v, best);
    return true;
  }

  /// The ends have exactly two common neighbours, and more than three together.
  bool keeps_topology(const std::vector<std::uint32_t>& around_v, std::uint32_t u) {
    std::size_t common = 0;
    const std::vector<std::uint32_t> around_u = neighbours(u);
    for (const std::uint32_t w : around_u) common += std::binary_search(around_v.begin(), around_v.end(), w) ? 1u : 0u;
    return common == 2 && around_v.size() + around_u.size() > 6;
  }

  void collapse(std::uint32_t v, std::uint32_t u) {
    for (const std::uint32_t f : faces_of(v)) {
      Triangle& t = mesh_.triangles[f];
      if (has(t, u)) {
        for (const std::uint32_t w : t)
          if (w != v) std::erase(faces_of(w), f);
        t = {kGone, kGone, kGone};
        continue;
      }
      for (std::uint32_t& w : t)
        if (w == v) w = u;
      faces_of(u).push_back(f);
    }
    faces_of(v).clear();
  }

  void compact() {
    std::vector<std::uint32_t> next(mesh_.vertices.size(), kGone);
    std::size_t kept = 0;
    for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (number_[v] != kGone && faces_of(v).empty()) continue;
      next[v] = static_cast<std::uint32_t>(kept);
      mesh_.vertices[kept] = mesh_.vertices[v];
      mesh_.sources[kept++] = mesh_.sources[v];
    }
    mesh_.vertices.resize(kept);
    mesh_.sources.resize(kept);
    mesh_.cut_faces.clear();  // their numbers change
    std::erase_if(mesh_.triangles, [](const Triangle& t) { return t[0] == kGone; });
    for (Triangle& t : mesh_.triangles)
      for (std::uint32_t& v : t) v = next[v];
  }

  BooleanResult& mesh_;
  double tolerance_;
  std::vector<std::uint32_t> number_;  ///< index in faces_ of each vertex of a cut face
  std::vector<std::uint32_t> normal_;  ///< index in mesh_.cut_faces of each face
  std::vector<std::vector<std::uint32_t>> faces_;
};

}  // namespace

ThinnedSeams thin_seams(BooleanResult& mesh, double tolerance) { return SeamThinning(mesh, tolerance).run(); }

}  // namespace sansmesh::inline v1
