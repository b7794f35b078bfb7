#include "sansmesh/mesh/clip_mesh.h"

#include <unordered_map>
#include <utility>
#include <vector>

#include "sansmesh/mesh/components.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh {
namespace {

/// Keeps the side of a plane across `axis` where sign · (x − at) >= 0.
class PlaneCut {
 public:
  PlaneCut(TriangleMesh& mesh, std::size_t axis, float at, float sign)
      : mesh_(mesh), axis_(axis), at_(at), sign_(sign) {}

  void run() {
    bool any_out = false;
    for (const Vec3f& v : mesh_.vertices) any_out = any_out || height(v) < 0;
    if (!any_out) return;
    std::vector<Triangle> kept;
    std::vector<std::uint32_t> of;  // the triangle that each was part of
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      cut(mesh_.triangles[i], kept);
      of.resize(kept.size(), static_cast<std::uint32_t>(i));
    }
    mesh_.triangles = std::move(kept);
    if (!mesh_.triangle_attributes.empty()) mesh_.triangle_attributes = mesh_.triangle_attributes.taken(of);
  }

 private:
  float height(const Vec3f& v) const { return sign_ * (v[axis_] - at_); }

  /// The vertex where the edge from an inner to an outer vertex crosses the plane.
  std::uint32_t crossing(std::uint32_t in, std::uint32_t out) {
    if (height(mesh_.vertices[in]) == 0) return in;
    const auto [entry, is_new] = made_.try_emplace(std::uint64_t{in} << 32 | out, 0);
    if (!is_new) return entry->second;
    const float a = height(mesh_.vertices[in]), b = height(mesh_.vertices[out]), t = a / (a - b);
    Vec3f x = mesh_.vertices[in] + (mesh_.vertices[out] - mesh_.vertices[in]) * t;
    x[axis_] = at_;
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
      const bool a_in = height(mesh_.vertices[a]) >= 0, b_in = height(mesh_.vertices[b]) >= 0;
      if (a_in) add(a);
      if (a_in != b_in) add(a_in ? crossing(a, b) : crossing(b, a));
    }
    if (n > 1 && polygon[n - 1] == polygon[0]) --n;
    for (std::size_t k = 1; k + 1 < n; ++k) kept.push_back({polygon[0], polygon[k], polygon[k + 1]});
  }

  TriangleMesh& mesh_;
  std::size_t axis_;
  float at_, sign_;
  std::unordered_map<std::uint64_t, std::uint32_t> made_;
};

}  // namespace

void clip_mesh(TriangleMesh& mesh, const Box3f& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    PlaneCut(mesh, axis, box.lower[axis], 1).run();
    PlaneCut(mesh, axis, box.upper[axis], -1).run();
  }
  keep_triangles(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1));
  separate_fans(mesh);
}

}  // namespace sansmesh
