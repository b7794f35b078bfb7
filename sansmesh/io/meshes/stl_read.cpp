// STL, ascii and binary. Corners with identical coordinates become one vertex.
#include <fmt/core.h>

#include <array>
#include <bit>
#include <cstdint>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

/// Hash table of vertices with open addressing. Only exact equality counts, so that results do not depend on the order.
class Welder {
 public:
  explicit Welder(std::size_t expected_corners) {
    std::size_t size = 64;
    while (size < expected_corners) size *= 2;
    slots_.assign(size, empty);
  }

  std::uint32_t add(Vec3 p) {
    p = p + Vec3{};  // -0 becomes 0
    if (2 * vertices.size() >= slots_.size()) grow();
    for (std::size_t s = hash(p) & (slots_.size() - 1);; s = (s + 1) & (slots_.size() - 1)) {
      if (slots_[s] == empty) {
        slots_[s] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(p);
        return slots_[s];
      }
      if (same(vertices[slots_[s]], p)) return slots_[s];
    }
  }

  std::vector<Vec3> vertices;

 private:
  static constexpr std::uint32_t empty = 0xffffffffu;

  // Compares bits, so that NaN equals itself.
  static bool same(const Vec3& a, const Vec3& b) {
    using Bits = std::array<std::uint64_t, 3>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
  }
  static std::size_t hash(const Vec3& p) {
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) {
      h = (h ^ std::bit_cast<std::uint64_t>(p[static_cast<std::size_t>(k)])) * 0x9e3779b97f4a7c15ull;
      h ^= h >> 29;
    }
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
  void grow() {
    slots_.assign(2 * slots_.size(), empty);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      std::size_t s = hash(vertices[i]) & (slots_.size() - 1);
      while (slots_[s] != empty) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<std::uint32_t> slots_;
};

void read_binary(const Input& in, PointSet& points, Welder& weld, std::size_t count) {
  points.triangles.resize(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char* p = in.bytes.data() + 84 + 50 * t + 12;
    for (std::uint32_t& corner : points.triangles[t]) {
      corner = weld.add({load<float>(p), load<float>(p + 4), load<float>(p + 8)});
      p += 12;
    }
  }
}

void read_ascii(const Input& in, PointSet& points, Welder& weld) {
  TextScanner text(in.bytes);
  std::uint64_t number = 0;
  std::array<std::uint32_t, 3> corners{};
  std::size_t filled = 0;
  bool ended = false;
  while (!text.at_end()) {
    TextScanner words(text.line());
    ++number;
    const std::string_view key = words.word();
    if (key == "vertex" || key == "VERTEX") {
      Vec3 p;
      if (!words.vector(p)) {
        in.fail(fmt::format("line {}: a vertex needs three coordinates", grouped(number)));
      }
      if (filled == 3) in.fail(fmt::format("line {}: a facet with more than three vertices", grouped(number)));
      corners[filled++] = weld.add(p);
    } else if (key == "endfacet" || key == "ENDFACET") {
      if (filled != 3) in.fail(fmt::format("line {}: a facet with {} vertices", grouped(number), filled));
      points.triangles.push_back(corners);
      filled = 0;
    } else if (key == "endsolid" || key == "ENDSOLID") {
      ended = true;
    }
  }
  if (filled != 0) in.fail("truncated: ends inside a facet");
  if (!ended)
    in.fail(fmt::format("truncated: 'endsolid' is missing after {} facets", grouped(points.triangles.size())));
}

}  // namespace

PointSet read_stl(const Input& in) {
  PointSet points;
  const std::size_t size = in.bytes.size();
  const std::uint64_t announced = size >= 84 ? load<std::uint32_t>(in.bytes.data() + 80) : 0;
  const std::uint64_t needed = 84 + 50 * announced;
  TextScanner start(in.bytes);
  start.skip_space();
  const std::string_view head = in.bytes.substr(0, 2048);
  // Some binary files begin with "solid", too: the size decides first.
  const bool text =
      size != needed && lower_case(start.rest().substr(0, 5)) == "solid" && head.find('\0') == std::string_view::npos;
  Welder weld(text ? size / 64 : std::min<std::uint64_t>(announced, size / 50) * 2);
  if (text) {
    in.report.format = "STL ascii";
    read_ascii(in, points, weld);
  } else {
    in.report.format = "STL binary";
    if (size < 84) in.fail("is neither an ascii STL (no 'solid') nor a binary one (shorter than its header)");
    if (size < needed) {
      in.fail(fmt::format("truncated (or not an STL file): announces {} triangles, {} bytes are missing",
                          grouped(announced), grouped(needed - size)));
    }
    if (size > needed) in.warn(fmt::format("{} bytes after the last triangle were ignored", grouped(size - needed)));
    read_binary(in, points, weld, static_cast<std::size_t>(announced));
  }
  if (weld.vertices.empty()) in.fail("holds no triangles");
  const std::size_t degenerate =
      std::erase_if(points.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  if (degenerate > 0)
    in.warn(fmt::format("{} triangles have coinciding corners and were left out", grouped(degenerate)));
  store_positions(in, points, weld.vertices.size(), [&](std::size_t i) { return weld.vertices[i]; });
  finish(in, points);
  return points;
}

}  // namespace sansmesh::inline v1::io
