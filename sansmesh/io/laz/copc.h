// Octree of COPC files: LAZ 1.4 whose chunks are the nodes of an octree (copc.io specification, version 1.0).
#pragma once

#include <optional>
#include <vector>

#include "sansmesh/io/laz/chunk_table.h"

namespace sansmesh::inline v1::io::laz {

struct CopcInfo {
  Vec3 center;
  double half_size = 0;                    ///< half of the edge of the root's cube
  double spacing = 0;                      ///< distance of points in the root; half of it in the next level, and so on
  std::uint64_t root = 0, root_bytes = 0;  ///< first page of the hierarchy
};

/// Nothing if the file is not COPC, or if its description is damaged: it is then read as LAZ.
std::optional<CopcInfo> find_copc_info(const LasHeader& header);

/// The nodes that the input's options need, in the order of the file. Reads only the pages of the hierarchy with such
/// nodes. Throws FileError if the hierarchy is malformed.
std::vector<Chunk> find_copc_chunks(const Input& in, const LasHeader& header, const CopcInfo& info);

}  // namespace sansmesh::inline v1::io::laz
