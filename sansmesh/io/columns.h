// A cloud as a table of records, the way binary formats hold it, and its way into a PointSet.
#pragma once

#include "sansmesh/io/binary.h"
#include "sansmesh/io/input.h"

namespace sansmesh::io {

/// Which columns of a table mean what; absent ones are empty.
struct CloudColumns {
  Column position[3];
  Column normal[3];
  Column color[3];
  Column confidence;
  bool whole_colors = false;  ///< colour columns of a real type hold whole numbers: 1 is nearly black, not full
};

/// Decodes `n` records in parallel into positions, normals, colours and confidence. Positions are
/// `scale` * value + `offset` per axis. Colours: 8 bits as they are, 16 bits or more if any value exceeds 255, reals as
/// fractions if none exceeds 1.
void decode_columns(const CloudColumns& columns, std::size_t n, PointSet& points, const Vec3& scale = {1, 1, 1},
                    const Vec3& offset = {});

}  // namespace sansmesh::io
