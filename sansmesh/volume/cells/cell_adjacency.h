// Adjacency of cells and points of a volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

inline constexpr std::uint32_t kNoCell = 0xffffffffu;
inline constexpr std::size_t kMostFaces = 6;  ///< per cell

/// The cells with each point as a corner, ascending.
Adjacency cells_of_points(const CellList& cells, std::size_t points);
/// The cells of each sample, as a corner or as cell data, ascending.
Adjacency cells_of_samples(const SampledVolume& volume);

/// The points that share an edge with each point, ascending.
Adjacency edge_neighbours(const CellList& cells, std::size_t points);

/// For each face of each cell (slot kMostFaces · cell + face): the first other cell with the same face corners; kNoCell
/// if there is none, and in unused slots.
std::vector<std::uint32_t> face_neighbours(const CellList& cells, std::size_t points);

/// The slots of faces without a matching cell, ascending.
std::vector<std::uint32_t> open_faces(const CellList& cells, std::size_t points);

/// The corners of a face by its slot, as points.
struct FaceRing {
  std::array<std::uint32_t, 4> points{};
  std::size_t count = 0;
  const std::uint32_t* begin() const { return points.data(); }
  const std::uint32_t* end() const { return points.data() + count; }
};
FaceRing ring_of_face(const CellList& cells, std::uint32_t slot);

/// Links as rows: both directions of each, ascending, without duplicates and self-links.
Adjacency symmetric_links(std::span<const std::uint64_t> links, std::size_t rows);
/// Packs a link into a number.
inline std::uint64_t link_of(std::uint32_t a, std::uint32_t b) { return static_cast<std::uint64_t>(a) << 32 | b; }
/// Union of the rows of both, without duplicates.
Adjacency united(const Adjacency& a, const Adjacency& b);

/// Connected component of each row, numbered by their first rows; `count` receives the number of components.
std::vector<std::uint32_t> connected_parts(const Adjacency& links, std::size_t& count);

}  // namespace sansmesh::inline v1
