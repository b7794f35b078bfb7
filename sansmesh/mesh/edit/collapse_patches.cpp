#include "sansmesh/mesh/edit/collapse_patches.h"

#include <algorithm>
#include <span>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/search/space_order.h"

namespace sansmesh::inline v1::detail {
namespace {

/// `members` are consecutive in `order`; marks those whose edges are all within the patch.
void collapse_patch(EdgeCollapses& mesh, std::span<const std::uint32_t> members, const std::vector<std::uint32_t>& rank,
                    std::vector<std::uint8_t>& tried) {
  const std::uint32_t begin = rank[members[0]];
  std::vector<Triangle> inner;
  std::vector<std::uint32_t> from;
  std::vector<std::uint8_t> at_border(members.size(), 0);
  for (std::uint32_t i = 0; i < members.size(); ++i)
    for (const std::uint32_t r : mesh.ring(members[i])) {
      Triangle t = mesh.triangles[r];
      bool all = true;
      for (std::uint32_t& v : t) {
        v = rank[v] - begin;  // vertices before the patch wrap around
        all = all && v < members.size();
      }
      if (!all) {
        at_border[i] = 1;
      } else if (std::min({t[0], t[1], t[2]}) == i) {
        inner.push_back(t);
        from.push_back(r);
      }
    }
  EdgeCollapses patch(mesh.options, members.size(), std::move(inner));
  patch.error = mesh.error;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const std::uint32_t v = members[i];
    if (!mesh.limit.empty()) patch.limit.push_back(mesh.limit[v]);
    patch.x[i] = mesh.x[v], patch.quadric[i] = mesh.quadric[v], patch.chance[i] = mesh.chance[v];
    patch.fixed[i] = at_border[i] || mesh.fixed[v];
    patch.border[i] = mesh.border[v];
  }
  patch.collapse_in_turn();
  for (std::size_t i = 0; i < members.size(); ++i) {
    const std::uint32_t v = members[i];
    tried[v] = !at_border[i];
    mesh.blocked[v] = patch.blocked[i];
    if (patch.merged_into[i] != kNoVertex) {
      mesh.merged_into[v] = members[patch.merged_into[i]];
    } else if (!patch.fixed[i]) {
      if (!mesh.limit.empty()) mesh.limit[v] = patch.limit[i];
      mesh.x[v] = patch.x[i], mesh.quadric[v] = patch.quadric[i], mesh.border[v] = patch.border[i];
    }
  }
  for (std::size_t k = 0; k < from.size(); ++k)
    for (std::size_t j = 0; j < 3; ++j) mesh.triangles[from[k]][j] = members[patch.triangles[k][j]];
}

}  // namespace

std::vector<std::uint32_t> collapse_patches(EdgeCollapses& mesh, Progress& progress) {
  const Box3 box = mesh.bounds_of();
  const Vec3 size = box.size();
  const double scale = (1u << 21) / std::max({size.x, size.y, size.z, 1e-300}) * 0.999;
  const std::vector<std::uint32_t> order = space_order(mesh.x, box.lower, scale);
  std::vector<std::uint32_t> rank(order.size());
  parallel_for(0, order.size(), 8192, [&](std::size_t i) { rank[order[i]] = static_cast<std::uint32_t>(i); });
  std::vector<std::uint8_t> tried(mesh.x.size(), 0);
  parallel_for(0, (order.size() + kPatch - 1) / kPatch, 1, [&](std::size_t c) {
    progress.check();
    collapse_patch(mesh, std::span(order).subspan(c * kPatch, std::min(kPatch, order.size() - c * kPatch)), rank,
                   tried);
  });
  mesh.pack_triangles();
  std::fill(mesh.to.begin(), mesh.to.end(), kNoVertex);  // invalidates earlier results
  std::vector<std::uint32_t> open;
  mesh.left = 0;
  for (std::uint32_t v = 0; v < mesh.x.size(); ++v) {
    if (mesh.merged_into[v] != kNoVertex) continue;
    ++mesh.left;
    bool all = tried[v] || mesh.fixed[v];
    for (const std::uint32_t i : mesh.ring(v))
      for (const std::uint32_t w : mesh.triangles[i]) all = all && (tried[w] || mesh.fixed[w]);
    if (!all) open.push_back(v);
  }
  return open;
}

}  // namespace sansmesh::inline v1::detail
