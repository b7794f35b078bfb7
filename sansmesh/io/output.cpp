#include "sansmesh/io/output.h"

#include <zlib.h>

#include <algorithm>
#include <cstdlib>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/option_text.h"

namespace sansmesh::inline v1::io {
namespace {

const std::vector<Triangle> kNoTriangles;
const AttributeTable kNoAttributes;

using PartViews = std::vector<std::string_view>;

PartViews views(const std::vector<std::string>& parts) { return {parts.begin(), parts.end()}; }

std::vector<std::string> gzip(const std::string& file, const PartViews& parts) {
  z_stream z{};
  if (deflateInit2(&z, 4, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw FileError(file, "cannot be written (compression does not start)");
  }
  std::vector<std::string> packed;
  const std::size_t block = 1 << 20;
  struct End {
    z_stream& z;
    ~End() { deflateEnd(&z); }
  } const end{z};
  for (std::size_t k = 0; k <= parts.size(); ++k) {
    const bool last = k == parts.size();
    const char* next = last ? nullptr : parts[k].data();
    std::size_t left = last ? 0 : parts[k].size();
    do {
      const uInt now = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
      z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next));
      z.avail_in = now;
      next += now, left -= now;
      do {
        if (packed.empty() || packed.back().size() == block) {
          check_cancelled();
          packed.emplace_back();
          packed.back().reserve(block);
        }
        std::string& out = packed.back();
        const std::size_t used = out.size();
        out.resize(block);
        z.next_out = reinterpret_cast<Bytef*>(out.data() + used);
        z.avail_out = static_cast<uInt>(block - used);
        deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);
        out.resize(block - z.avail_out);
      } while (z.avail_out == 0);
    } while (left > 0);
  }
  return packed;
}

}  // namespace

void write_whole(const std::string& file, const std::vector<std::string>& parts) { write_parts(file, views(parts)); }

void write_parts(const std::string& file, const PartViews& parts) {
  if (file.empty()) throw FileError("(no name)", "the name of the file to write is empty");
  if (lower_case(file).ends_with(".gz")) return write_bytes(file, views(gzip(file, parts)));
  write_bytes(file, parts);
}

OutputContent::OutputContent(const TriangleMesh& mesh)
    : origin(mesh.origin),
      positions(mesh.vertices),
      normals(mesh.normals),
      colors(mesh.colors),
      attributes(mesh.attributes),
      triangles(mesh.triangles),
      triangle_attributes(mesh.triangle_attributes),
      reference(mesh.reference.get()) {}

OutputContent::OutputContent(const PointSet& points)
    : origin(points.origin),
      positions(points.positions),
      normals(points.normals),
      colors(points.colors),
      attributes(points.attributes),
      triangles(kNoTriangles),
      triangle_attributes(kNoAttributes),
      reference(points.reference.get()) {}

WorldCoordinates::WorldCoordinates(const Vec3& origin, const std::vector<Vec3f>& positions)
    : origin_(origin), positions_(positions), shifted_(origin != Vec3{}) {
  if (!shifted_) return;
  const Box3f box = parallel_reduce(
      positions.size(), 1 << 15, Box3f{},
      [&](std::size_t first, std::size_t last) {
        Box3f b;
        for (std::size_t i = first; i < last; ++i) b.extend(positions[i]);
        return b;
      },
      [](Box3f a, const Box3f& b) { return a.extend(b), a; });
  if (box.empty()) return;
  double farthest = 0;
  for (int k = 0; k < 3; ++k) {
    farthest = std::max({farthest, std::abs(origin[k] + box.lower[k]), std::abs(origin[k] + box.upper[k])});
  }
  const double extent = std::max<double>(box.diagonal(), farthest * 0x1p-40);
  if (!(extent > 0)) return;
  float_loss_ = farthest * 0x1p-24 / extent;
  decimals_ = index_in<int>(std::ceil(-std::log10(extent * 0x1p-26)), 0, 17);
}

char* WorldCoordinates::put(char* p, std::size_t i, char separator) const {
  for (int k = 0; k < 3; ++k) {
    if (k > 0) *p++ = separator;
    if (!shifted_) {
      p = std::to_chars(p, p + number_width, positions_[i][k]).ptr;
      continue;
    }
    const double value = origin_[k] + static_cast<double>(positions_[i][k]);
    const auto [end, error] = std::to_chars(p, p + number_width, value, std::chars_format::fixed, decimals_);
    if (error != std::errc()) {  // too long for fixed notation: astronomically large
      p = std::to_chars(p, p + number_width, value).ptr;
      continue;
    }
    p = end;
    if (decimals_ > 0) {
      while (p[-1] == '0') --p;
      if (p[-1] == '.') --p;
    }
  }
  return p;
}

}  // namespace sansmesh::inline v1::io
