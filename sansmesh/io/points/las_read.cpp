// Reads LAS files, compressed (LAZ) or not, and the parts of COPC files that a query selects.
#include <algorithm>

#include "sansmesh/core/parallel.h"
#include "sansmesh/io/laz/read_laz.h"
#include "sansmesh/io/points/las_points.h"
#include "sansmesh/io/points/las_reference.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::inline v1::io {
namespace {

/// The records in the box, in the order of the file.
std::vector<char> las_records_in(const LasHeader& header, const Box3& box, std::span<const char> records) {
  const std::size_t chunk = std::size_t{1} << 16, n = records.size() / header.record;
  std::vector<std::vector<char>> parts((n + chunk - 1) / chunk);
  parallel_for(0, parts.size(), 1, [&](std::size_t k) {
    const std::size_t first = k * chunk, count = std::min(chunk, n - first);
    keep_records_in(header, box, records.subspan(first * header.record, count * header.record), parts[k]);
  });
  std::vector<char> kept;
  for (const std::vector<char>& part : parts) kept.insert(kept.end(), part.begin(), part.end());
  return kept;
}

}  // namespace

PointSet read_las(const Input& in) {
  const LasHeader header = read_las_header(in);
  const auto points_of = [&](std::span<const char> records, std::span<const char> all) {
    PointSet points = records.empty() ? PointSet{} : decode_las_points(in, header, records, all);
    points.reference = las_reference(in, header);
    return points;
  };
  if (header.compressed) return points_of(laz::read_laz_records(in, header).span(), {});
  in.warn_without_levels();
  const std::span<const char> all(in.bytes.data() + header.begin, header.count * header.record);
  if (in.options.box) return points_of(las_records_in(header, *in.options.box, all), all);
  return points_of(all, all);
}

}  // namespace sansmesh::inline v1::io
