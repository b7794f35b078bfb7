#include "sansmesh/volume/grid/volume_boundary.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>
#include <tuple>
#include <utility>

#include "sansmesh/core/parallel_collect.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_finder.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kFinest = 4;  ///< subdivisions of a partly covered face into four

/// A part of a face in the parameters of its patch.
struct Patch {
  std::uint32_t cell;
  std::uint32_t face;
  double r0, s0, size;
};

class BoundaryWalk {
 public:
  BoundaryWalk(const CellList& cells, std::span<const Vec3> points) : cells_(cells), faces_(cells, points) {}

  /// All parts of faces without a cell beyond, by cell and face.
  std::vector<Patch> open_patches() const {
    return parallel_collect<Patch>(
        cells_.size(), 1024, [&](std::size_t first, std::size_t last, std::vector<Patch>& found) {
          std::vector<std::uint32_t> scratch;
          for (std::size_t c = first; c < last; ++c)
            for (std::size_t f = 0; f < cell_faces(cells_.shapes[c]).size(); ++f)
              if (faces_.equal(c, f) == kNoCell)
                add({static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(f), 0, 0, 1}, 0, found, scratch);
        });
  }

  std::array<Vec3, 4> ring(const Patch& patch) const {
    const CellFace& f = cell_faces(cells_.shapes[patch.cell])[patch.face];
    std::array<Vec3, 4> x, out;
    for (std::size_t k = 0; k < 4; ++k)
      x[k] = faces_.finder().corner(patch.cell, f.corner[std::min<std::size_t>(k, f.count - 1)]);
    for (std::size_t k = 0; k < 4; ++k) {
      const double r = patch.r0 + (k == 1 || k == 2 ? patch.size : 0), s = patch.s0 + (k >= 2 ? patch.size : 0);
      out[k] = x[0] * ((1 - r) * (1 - s)) + x[1] * (r * (1 - s)) + x[2] * (r * s) + x[3] * ((1 - r) * s);
    }
    return out;
  }

 private:
  void add(const Patch& patch, int depth, std::vector<Patch>& out, std::vector<std::uint32_t>& scratch) const {
    constexpr double kParameters[5][2] = {{0.5, 0.5}, {0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}};
    int covered = 0;
    for (const auto& at : kParameters) {
      const std::uint32_t beyond =
          faces_.beyond(patch.cell, patch.face, patch.r0 + at[0] * patch.size, patch.s0 + at[1] * patch.size, scratch);
      covered += beyond != kNoCell;
      if (depth == kFinest) {
        if (covered == 0) out.push_back(patch);
        return;
      }
    }
    if (covered == 0) return out.push_back(patch);
    if (covered == 5) return;
    const double half = patch.size / 2;
    for (int i = 0; i < 4; ++i)
      add({patch.cell, patch.face, patch.r0 + (i & 1 ? half : 0), patch.s0 + (i & 2 ? half : 0), half}, depth + 1, out,
          scratch);
  }

  const CellList& cells_;
  FaceNeighbours faces_;
};

/// The boundary box of a lattice.
TriangleMesh lattice_boundary(const Lattice& lattice) {
  TriangleMesh mesh;
  const auto corner = [&](std::size_t c) {
    return lattice.from_axes({c & 1 ? lattice.upper[0] : lattice.lower[0], c & 2 ? lattice.upper[1] : lattice.lower[1],
                              c & 4 ? lattice.upper[2] : lattice.lower[2]});
  };
  mesh.origin = (corner(0) + corner(7)) / 2;
  for (std::size_t c = 0; c < 8; ++c) mesh.vertices.push_back(Vec3f(corner(c) - mesh.origin));
  const bool mirrored = dot(cross(lattice.directions[0], lattice.directions[1]), lattice.directions[2]) < 0;
  constexpr std::uint32_t kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : kQuads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
    if (mirrored)
      for (std::size_t t = mesh.triangles.size() - 2; t < mesh.triangles.size(); ++t)
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  return mesh;
}

void add_line(PolylineSet& lines, std::initializer_list<Vec3> points) {
  for (const Vec3& x : points) lines.positions.emplace_back(x - lines.origin);
  lines.offsets.push_back(lines.positions.size());
}

PolylineSet lattice_edges(const Lattice& lattice, bool in_cells) {
  PolylineSet lines;
  std::array<double, 3> middle;
  for (std::size_t k = 0; k < 3; ++k) middle[k] = (lattice.lower[k] + lattice.upper[k]) / 2;
  lines.origin = lattice.from_axes({middle[0], middle[1], middle[2]});
  for (std::size_t along = 0; along < 3; ++along) {
    const std::size_t a = (along + 1) % 3, b = (along + 2) % 3;
    const auto line = [&](double at_a, double at_b) {
      Vec3 from, to;
      from[along] = lattice.lower[along], to[along] = lattice.upper[along];
      from[a] = to[a] = at_a, from[b] = to[b] = at_b;
      add_line(lines, {lattice.from_axes(from), lattice.from_axes(to)});
    };
    const std::vector<double> across = cell_borders(lattice, b, in_cells);
    for (const double at_a : {lattice.lower[a], lattice.upper[a]})
      for (const double at_b : across) line(at_a, at_b);
    const std::vector<double> inner = cell_borders(lattice, a, in_cells);
    for (std::size_t i = 1; i + 1 < inner.size(); ++i)
      for (const double at_b : {lattice.lower[b], lattice.upper[b]}) line(inner[i], at_b);
  }
  return lines;
}

}  // namespace

std::vector<double> cell_borders(const Lattice& lattice, std::size_t axis, bool in_cells) {
  std::vector<double> borders = lattice.axes[axis];
  if (!in_cells) return borders;
  for (std::size_t i = borders.size() - 1; i > 0; --i) borders[i] = (borders[i - 1] + borders[i]) / 2;
  borders.front() = lattice.lower[axis];
  borders.push_back(lattice.upper[axis]);
  return borders;
}

PolylineSet boundary_edges(const SampledVolume& volume) {
  if (volume.lattice) return lattice_edges(*volume.lattice, volume.in_cells);
  PolylineSet lines;
  if (volume.cells.empty()) return lines;
  const std::span<const Vec3> points = volume.corners.empty() ? volume.positions : volume.corners;
  lines.origin = volume.bounds().center();
  const BoundaryWalk walk(volume.cells, points);
  using Position = std::tuple<float, float, float>;
  std::vector<std::pair<Position, Position>> edges;
  for (const Patch& patch : walk.open_patches()) {
    const auto ring = walk.ring(patch);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto position = [&](std::size_t at) {
        const Vec3f x(ring[at] - lines.origin);
        return Position{x.x, x.y, x.z};
      };
      const std::pair<Position, Position> ends = std::minmax({position(k), position((k + 1) % ring.size())});
      if (ends.first != ends.second) edges.emplace_back(ends.first, ends.second);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const auto at = [&](const Position& p) {
    return lines.origin + Vec3(std::get<0>(p), std::get<1>(p), std::get<2>(p));
  };
  for (const auto& [from, to] : edges) add_line(lines, {at(from), at(to)});
  return lines;
}

TriangleMesh volume_boundary(const SampledVolume& volume) {
  if (volume.lattice) return lattice_boundary(*volume.lattice);
  TriangleMesh mesh;
  if (volume.cells.empty()) return mesh;
  const std::span<const Vec3> points = volume.corners.empty() ? volume.positions : volume.corners;
  mesh.origin = volume.bounds().center();
  const BoundaryWalk walk(volume.cells, points);
  std::vector<std::uint32_t> of_corner(points.size(), kNoCell);
  std::map<std::tuple<float, float, float>, std::uint32_t> of_position;  // unnumbered corners of parts of faces
  const auto vertex = [&](const Vec3& x) {
    mesh.vertices.push_back(Vec3f(x - mesh.origin));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  for (const Patch& patch : walk.open_patches()) {
    const CellFace& face = cell_faces(volume.cells.shapes[patch.cell])[patch.face];
    std::array<std::uint32_t, 4> ring{};
    std::size_t count = 4;
    if (patch.size == 1) {
      count = face.count;
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t c = volume.cells[patch.cell][face.corner[k]];
        if (of_corner[c] == kNoCell) of_corner[c] = vertex(points[c]);
        ring[k] = of_corner[c];
      }
    } else {
      const auto corners = walk.ring(patch);
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3f at(corners[k] - mesh.origin);
        const auto [it, fresh] = of_position.try_emplace({at.x, at.y, at.z}, 0);
        if (fresh) it->second = vertex(corners[k]);
        ring[k] = it->second;
      }
    }
    mesh.triangles.push_back({ring[0], ring[1], ring[2]});
    if (count == 4 && ring[3] != ring[2]) mesh.triangles.push_back({ring[0], ring[2], ring[3]});
  }
  return mesh;
}

}  // namespace sansmesh::inline v1
