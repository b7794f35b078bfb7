// Which cells and points of a volume lie side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

inline constexpr std::uint32_t kNoCell = 0xffffffffu;
inline constexpr std::size_t kMostFaces = 6;  ///< of a cell

/// The cells that each point is a corner of, ascending.
Adjacency cells_of_points(const CellList& cells, std::size_t points);
/// The cells that a sample is a corner of, or that it stands for, ascending.
Adjacency cells_of_samples(const SampledVolume& volume);

/// The points that share an edge with each point, ascending.
Adjacency edge_neighbours(const CellList& cells, std::size_t points);

/// For each cell and each of its faces (slot kMostFaces · cell + face) the cell that has the same corners there; of
/// several the first. kNoCell where there is none, and in slots of faces that a shape has not.
std::vector<std::uint32_t> face_neighbours(const CellList& cells, std::size_t points);

/// Lists of links as rows: both directions of each, ascending, each once, none to itself.
Adjacency symmetric_links(std::span<const std::uint64_t> links, std::size_t rows);
/// A link as a number.
inline std::uint64_t link_of(std::uint32_t a, std::uint32_t b) { return static_cast<std::uint64_t>(a) << 32 | b; }
/// The rows of both, each entry once.
Adjacency united(const Adjacency& a, const Adjacency& b);

/// A number for each row: which connected part it belongs to, parts numbered by their first rows; and how many there
/// are.
std::vector<std::uint32_t> connected_parts(const Adjacency& links, std::size_t& count);

}  // namespace sansmesh::inline v1
