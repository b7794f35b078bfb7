#include "sansmesh/mesh/edit/collapse_patches.h"

#include <algorithm>
#include <span>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

/// The vertices along a curve that fills space.
std::vector<std::uint32_t> order_in_space(const EdgeCollapses& mesh) {
  const Box3 box = mesh.bounds_of();
  const Vec3 size = box.size();
  const double scale = (1u << 21) / std::max({size.x, size.y, size.z, 1e-300}) * 0.999;
  std::vector<KeyIndex> keys(mesh.x.size());
  parallel_for(0, keys.size(), 8192, [&](std::size_t v) {
    const Vec3 at = (mesh.x[v] - box.lower) * scale;
    const auto cell = [](double c) { return index_in<std::uint32_t>(c, 0, 0x1fffff); };
    keys[v] = {morton_code(cell(at.x), cell(at.y), cell(at.z)), static_cast<unsigned>(v)};
  });
  parallel_sort(keys);
  std::vector<std::uint32_t> order(mesh.x.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = keys[i].index;
  return order;
}

/// `members`: consecutive in `order`; marks those whose edges were all within the patch.
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
        v = rank[v] - begin;  // those before the patch wrap round
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
  const std::vector<std::uint32_t> order = order_in_space(mesh);
  std::vector<std::uint32_t> rank(order.size());
  parallel_for(0, order.size(), 8192, [&](std::size_t i) { rank[order[i]] = static_cast<std::uint32_t>(i); });
  std::vector<std::uint8_t> tried(mesh.x.size(), 0);
  parallel_for(0, (order.size() + kPatch - 1) / kPatch, 1, [&](std::size_t c) {
    progress.check();
    collapse_patch(mesh, std::span(order).subspan(c * kPatch, std::min(kPatch, order.size() - c * kPatch)), rank,
                   tried);
  });
  mesh.pack_triangles();
  std::fill(mesh.to.begin(), mesh.to.end(), kNoVertex);  // what was asked before is not true any more
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
