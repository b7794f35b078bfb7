// Reads LAS files, uncompressed and compressed.
#include "sansmesh/io/points/las_points.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::inline v1::io {

PointSet read_las(const Input& in) {
  const LasHeader header = read_las_header(in);
  if (header.compressed) in.fail("is LAZ (compressed LAS), which is not supported; decompress it to LAS first");
  return decode_las_points(in, header, {in.bytes.data() + header.begin, header.count * header.record});
}

}  // namespace sansmesh::inline v1::io
