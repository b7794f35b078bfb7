#include "sansmesh/volume/cells/cell_adjacency.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/data/group_rows.h"

namespace sansmesh::inline v1 {
namespace {

/// Builds rows in parallel; `fill(row, list)` makes the list of one row (ascending, without duplicates).
template <class Fill>
Adjacency rows_of(std::size_t rows, const Fill& fill) {
  constexpr std::size_t kChunk = 16384;
  const std::size_t chunks = (rows + kChunk - 1) / kChunk;
  std::vector<std::vector<std::uint32_t>> parts(chunks);
  Adjacency result;
  result.first.assign(rows + 1, 0);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    std::vector<std::uint32_t> row;
    for (std::size_t r = c * kChunk; r < std::min(rows, (c + 1) * kChunk); ++r) {
      row.clear();
      fill(r, row);
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      result.first[r + 1] = row.size();
      parts[c].insert(parts[c].end(), row.begin(), row.end());
    }
  });
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.entries.reserve(result.first.back());
  for (auto& part : parts) {
    result.entries.insert(result.entries.end(), part.begin(), part.end());
    part = {};
  }
  return result;
}

bool same_corners(std::span<const std::uint32_t> a, const CellFace& f, std::span<const std::uint32_t> b,
                  const CellFace& g) {
  if (f.count != g.count) return false;
  for (std::size_t i = 0; i < f.count; ++i) {
    bool found = false;
    for (std::size_t j = 0; j < g.count && !found; ++j) found = a[f.corner[i]] == b[g.corner[j]];
    if (!found) return false;
  }
  return true;
}

}  // namespace

Adjacency cells_of_points(const CellList& cells, std::size_t points) {
  return group_rows(points, [&](const auto& visit) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const std::uint32_t p : cells[c]) visit(p, c);
  });
}

Adjacency cells_of_samples(const SampledVolume& volume) {
  if (volume.cell_sample.empty()) return cells_of_points(volume.cells, volume.size());
  return group_rows(volume.size(), [&](const auto& visit) {
    for (std::size_t c = 0; c < volume.cell_sample.size(); ++c) visit(volume.cell_sample[c], c);
  });
}

Adjacency edge_neighbours(const CellList& cells, std::size_t points) {
  const Adjacency incidence = cells_of_points(cells, points);
  return rows_of(points, [&](std::size_t p, std::vector<std::uint32_t>& row) {
    for (const std::uint32_t c : incidence[p]) {
      const auto corners = cells[c];
      for (const auto& edge : cell_edges(cells.shapes[c])) {
        if (corners[edge[0]] == p) row.push_back(corners[edge[1]]);
        if (corners[edge[1]] == p) row.push_back(corners[edge[0]]);
      }
    }
  });
}

std::vector<std::uint32_t> face_neighbours(const CellList& cells, std::size_t points) {
  const Adjacency incidence = cells_of_points(cells, points);
  std::vector<std::uint32_t> found(kMostFaces * cells.size(), kNoCell);
  parallel_for(0, cells.size(), 2048, [&](std::size_t c) {
    const auto corners = cells[c];
    const auto faces = cell_faces(cells.shapes[c]);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      std::uint32_t rare = corners[faces[f].corner[0]];
      for (std::size_t i = 1; i < faces[f].count; ++i) {
        const std::uint32_t p = corners[faces[f].corner[i]];
        if (incidence[p].size() < incidence[rare].size()) rare = p;
      }
      for (const std::uint32_t other : incidence[rare]) {
        if (other == c) continue;
        const auto theirs = cells[other];
        // The corner across the face dismisses most neighbours of a corner.
        const std::uint32_t across = corners[faces[f].corner[2]];
        if (std::find(theirs.begin(), theirs.end(), across) == theirs.end()) continue;
        const auto their_faces = cell_faces(cells.shapes[other]);
        const bool same = std::any_of(their_faces.begin(), their_faces.end(),
                                      [&](const CellFace& g) { return same_corners(corners, faces[f], theirs, g); });
        if (same) {
          found[kMostFaces * c + f] = other;
          break;
        }
      }
    }
  });
  return found;
}

std::vector<std::uint32_t> open_faces(const CellList& cells, std::size_t points) {
  const std::vector<std::uint32_t> across = face_neighbours(cells, points);
  std::vector<std::uint32_t> slots;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t f = 0; f < cell_faces(cells.shapes[c]).size(); ++f)
      if (across[kMostFaces * c + f] == kNoCell) slots.push_back(static_cast<std::uint32_t>(kMostFaces * c + f));
  return slots;
}

FaceRing ring_of_face(const CellList& cells, std::uint32_t slot) {
  const std::size_t cell = slot / kMostFaces;
  const CellFace& face = cell_faces(cells.shapes[cell])[slot % kMostFaces];
  FaceRing ring;
  for (; ring.count < face.count; ++ring.count) ring.points[ring.count] = cells[cell][face.corner[ring.count]];
  return ring;
}

Adjacency symmetric_links(std::span<const std::uint64_t> links, std::size_t rows) {
  std::vector<std::uint64_t> both;
  both.reserve(2 * links.size());
  for (const std::uint64_t link : links) {
    if (link >> 32 == (link & 0xffffffffu)) continue;
    both.push_back(link);
    both.push_back(link << 32 | link >> 32);
  }
  parallel_sort(both);
  both.erase(std::unique(both.begin(), both.end()), both.end());
  return group_rows(rows, [&](const auto& visit) {
    for (const std::uint64_t link : both) visit(link >> 32, link & 0xffffffffu);
  });
}

Adjacency united(const Adjacency& a, const Adjacency& b) {
  return rows_of(a.size(), [&](std::size_t r, std::vector<std::uint32_t>& row) {
    row.insert(row.end(), a[r].begin(), a[r].end());
    row.insert(row.end(), b[r].begin(), b[r].end());
  });
}

std::vector<std::uint32_t> connected_parts(const Adjacency& links, std::size_t& count) {
  UnionFind sets(links.size());
  for (std::size_t r = 0; r < links.size(); ++r)
    for (const std::uint32_t other : links[r]) sets.join(static_cast<std::uint32_t>(r), other);
  std::vector<std::uint32_t> part(links.size());
  count = 0;
  for (std::size_t r = 0; r < links.size(); ++r) {
    const std::uint32_t root = sets.find(static_cast<std::uint32_t>(r));
    part[r] = root == r ? static_cast<std::uint32_t>(count++) : part[root];
  }
  return part;
}

}  // namespace sansmesh::inline v1
