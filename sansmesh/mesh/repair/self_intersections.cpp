#include "sansmesh/mesh/repair/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/search/space_order.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTrianglesOfLeaf = 4;

/// Triangles in the order of a space-filling curve, with a tree of boxes: node i has the children 2i and 2i + 1.
struct BoxesOfTriangles {
  std::vector<std::uint32_t> order;
  std::vector<Box3f> box;
  std::size_t leaves = 1;

  explicit BoxesOfTriangles(const std::vector<Box3f>& of_triangle) {
    std::vector<Vec3> centers(of_triangle.size());
    parallel_for(0, centers.size(), 8192, [&](std::size_t t) { centers[t] = Vec3(of_triangle[t].center()); });
    order = space_order(centers);
    while (leaves * kTrianglesOfLeaf < order.size()) leaves *= 2;
    box.resize(2 * leaves);
    for (std::size_t i = 0; i < order.size(); ++i) box[leaves + i / kTrianglesOfLeaf].extend(of_triangle[order[i]]);
    for (std::size_t i = leaves; i-- > 1;)
      for (const std::size_t child : {2 * i, 2 * i + 1}) box[i].extend(box[child]);
  }
};

/// Whether the segment passes through the interior of the triangle.
bool goes_through(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t, double tolerance) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double size = norm(normal);
  if (!(size > 0)) return false;
  const double above = dot(normal, p - t[0]), below = dot(normal, q - t[0]);
  if ((above > 0) == (below > 0) || std::min(std::abs(above), std::abs(below)) <= tolerance * size) return false;
  const Vec3 d = q - p;
  int positive = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = t[k] - p, b = t[(k + 1) % 3] - p;
    const double side = dot(d, cross(a, b));
    if (std::abs(side) <= 1e-9 * norm(d) * (squared_norm(a) + squared_norm(b))) return false;
    positive += side > 0;
  }
  return positive == 0 || positive == 3;
}

constexpr std::size_t kChunkOfBoxes = 256;

std::size_t chunks_of(const TriangleMesh& mesh) {
  return (mesh.triangles.size() + kTrianglesOfLeaf * kChunkOfBoxes - 1) / (kTrianglesOfLeaf * kChunkOfBoxes);
}

/// Calls found(chunk, a, b) for each pair: sequentially within a chunk, concurrently for several.
template <class Found>
void for_each_crossing(const TriangleMesh& mesh, double tolerance, const Found& found) {
  const std::size_t n = mesh.triangles.size();
  if (n < 2) return;
  std::vector<Box3f> box(n);
  parallel_for(0, n, 8192, [&](std::size_t t) {
    for (const std::uint32_t v : mesh.triangles[t]) box[t].extend(mesh.vertices[v]);
  });
  const BoxesOfTriangles tree(box);
  const auto corners = [&](std::uint32_t t) {
    const auto [a, b, c] = mesh.triangles[t];
    return std::array<Vec3, 3>{Vec3(mesh.vertices[a]), Vec3(mesh.vertices[b]), Vec3(mesh.vertices[c])};
  };
  const auto cut = [&](std::uint32_t s, std::uint32_t t) {
    const Triangle &a = mesh.triangles[s], &b = mesh.triangles[t];
    const auto has = [](const Triangle& x, std::uint32_t v) { return x[0] == v || x[1] == v || x[2] == v; };
    if (has(b, a[0]) + has(b, a[1]) + has(b, a[2]) > 1) return false;
    const std::array<Vec3, 3> p = corners(s), q = corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3;
      if (!has(b, a[k]) && !has(b, a[l]) && goes_through(p[k], p[l], q, tolerance)) return true;
      if (!has(a, b[k]) && !has(a, b[l]) && goes_through(q[k], q[l], p, tolerance)) return true;
    }
    return false;
  };
  // Tests the triangles of a leaf together, against later leaves only.
  const std::size_t leaves = (n + kTrianglesOfLeaf - 1) / kTrianglesOfLeaf;
  parallel_for(0, chunks_of(mesh), 1, [&](std::size_t c) {
    const auto compare = [&](std::size_t leaf, std::size_t other) {
      const Box3f& around = tree.box[tree.leaves + other];
      const std::size_t end = std::min(n, (leaf + 1) * kTrianglesOfLeaf);
      for (std::size_t i = leaf * kTrianglesOfLeaf; i < end; ++i) {
        const std::uint32_t t = tree.order[i];
        if (!touch(around, box[t])) continue;
        const std::size_t first = other * kTrianglesOfLeaf;
        for (std::size_t j = std::max(first, i + 1); j < std::min(n, first + kTrianglesOfLeaf); ++j) {
          const std::uint32_t s = tree.order[j];
          if (touch(box[s], box[t]) && cut(s, t)) found(c, std::min(s, t), std::max(s, t));
        }
      }
    };
    std::vector<std::size_t> open;
    for (std::size_t leaf = c * kChunkOfBoxes; leaf < std::min(leaves, (c + 1) * kChunkOfBoxes); ++leaf) {
      const Box3f& own = tree.box[tree.leaves + leaf];
      compare(leaf, leaf);
      // Traverses the tree upwards from the leaf, visiting right siblings.
      for (std::size_t node = tree.leaves + leaf; node > 1; node /= 2) {
        if (node % 2 != 0) continue;
        open.assign(1, node + 1);
        while (!open.empty()) {
          const std::size_t now = open.back();
          open.pop_back();
          if (!touch(tree.box[now], own)) continue;
          if (now >= tree.leaves) {
            compare(leaf, now - tree.leaves);
            continue;
          }
          open.push_back(2 * now);
          open.push_back(2 * now + 1);
        }
      }
    }
  });
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh, double tolerance) {
  std::vector<std::vector<std::array<std::uint32_t, 2>>> parts(chunks_of(mesh));
  for_each_crossing(mesh, tolerance, [&](std::size_t c, std::uint32_t a, std::uint32_t b) {
    parts[c].push_back({a, b});
  });
  std::vector<std::array<std::uint32_t, 2>> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  return all;
}

std::size_t count_self_intersections(const TriangleMesh& mesh, double tolerance,
                                     const std::function<void(std::uint32_t, std::uint32_t)>& found) {
  std::vector<std::size_t> counts(chunks_of(mesh));
  for_each_crossing(mesh, tolerance, [&](std::size_t c, std::uint32_t a, std::uint32_t b) {
    ++counts[c];
    found(a, b);
  });
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

}  // namespace sansmesh::inline v1
