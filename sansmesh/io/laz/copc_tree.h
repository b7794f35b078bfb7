// Octree of the points of a COPC file that is written, and its records (copc.io specification, version 1.0).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io::laz {

/// Coordinates in steps of the file.
using LasSteps = std::array<std::int32_t, 3>;

struct CopcNode {
  std::int32_t level = 0;
  LasSteps cube = {};                 ///< cube among those of the level
  std::vector<std::uint32_t> points;  ///< in ascending order
};

struct CopcTree {
  Vec3 center;                  ///< centre of the root's cube (steps)
  double half_size = 0;         ///< half of its edge (steps)
  double spacing = 0;           ///< edge of the cells of which the root has a point each (steps)
  std::vector<CopcNode> nodes;  ///< none is empty; parents first
};

/// Each node has the first point of each of 128 × 128 × 128 cells, and all if there are few; its children have the
/// others.
CopcTree make_copc_tree(const std::vector<LasSteps>& points);

/// Place of a node's chunk in the file.
struct CopcChunk {
  std::uint64_t begin = 0;
  std::size_t bytes = 0;
};

/// The VLR that describes the octree, with its head. The centre, sizes and spacing in world coordinates.
struct CopcDescription {
  Vec3 center;
  double half_size = 0, spacing = 0;
  std::uint64_t hierarchy = 0, hierarchy_bytes = 0;  ///< range of bytes of its page
  double first_time = 0, last_time = 0;
};
std::string copc_vlr(const CopcDescription& description);
/// Size of copc_vlr.
inline constexpr std::size_t kCopcVlrBytes = 54 + 160;

/// Head of the EVLR with the hierarchy, and its page: an entry for each node.
std::string copc_evlr_head(std::size_t bytes);
std::string copc_page(const std::vector<CopcNode>& nodes, const std::vector<CopcChunk>& chunks);

}  // namespace sansmesh::inline v1::io::laz
