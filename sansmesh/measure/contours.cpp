#include "sansmesh/measure/contours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostLevels = 10000;
/// Every so many-th contour is bold.
constexpr long kIndexContours = 5;

/// Edge of the lattice of centres: node · 2, + 1 for the edge to the south.
using EdgeKey = std::uint64_t;

/// Segments of one level: each point on an edge of the lattice has one or two neighbours.
class LevelLines {
 public:
  LevelLines(const HeightGrid& grid, double level) : grid_(grid), level_(level) {}

  /// Adds the segments of the square whose north-western node is (c, r).
  void add_square(int c, int r) {
    const std::array<float, 4> h{height(c, r), height(c + 1, r), height(c + 1, r + 1), height(c, r + 1)};
    // Edges: north, east, south, west.
    const std::array<EdgeKey, 4> edges{key(c, r, 0), key(c + 1, r, 1), key(c, r + 1, 0), key(c, r, 1)};
    std::array<std::size_t, 4> crossed{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (above(h[k]) != above(h[(k + 1) % 4])) crossed[count++] = k;
    if (count == 2) connect(edges[crossed[0]], edges[crossed[1]]);
    if (count < 4) return;
    // A saddle: the mean decides which corners are connected.
    const bool middle = above((h[0] + h[1] + h[2] + h[3]) / 4);
    const bool around_first = middle != above(h[0]);
    connect(edges[0], edges[around_first ? 3 : 1]);
    connect(edges[2], edges[around_first ? 1 : 3]);
  }

  /// Appends the lines: open ones from their ends first.
  void append_to(PolylineSet& lines, std::vector<double>& heights) {
    for (const bool open : {true, false})
      for (const EdgeKey start : order_) {
        const Neighbours& n = neighbours_.at(start);
        if (n.used || (open && n.count == 2)) continue;
        trace(start, lines);
        lines.offsets.push_back(lines.positions.size());
        heights.push_back(level_);
      }
  }

 private:
  struct Neighbours {
    std::array<EdgeKey, 2> of{};
    int count = 0;
    bool used = false;
  };

  float height(int c, int r) const { return grid_.heights.at(c, r); }
  bool above(float h) const { return static_cast<double>(h) >= level_; }
  EdgeKey key(int c, int r, unsigned south) const {
    return 2 * (static_cast<EdgeKey>(r) * static_cast<EdgeKey>(grid_.heights.width) + static_cast<EdgeKey>(c)) + south;
  }
  void connect(EdgeKey a, EdgeKey b) {
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
      const auto [at, fresh] = neighbours_.try_emplace(from);
      if (fresh) order_.push_back(from);
      if (at->second.count < 2) at->second.of[static_cast<std::size_t>(at->second.count++)] = to;
    }
  }
  Vec3f point_on(EdgeKey edge) const {
    const auto width = static_cast<EdgeKey>(grid_.heights.width);
    const int c = static_cast<int>(edge / 2 % width), r = static_cast<int>(edge / 2 / width);
    const bool south = edge % 2 != 0;
    const double a = static_cast<double>(height(c, r)),
                 b = static_cast<double>(south ? height(c, r + 1) : height(c + 1, r));
    const double t = (level_ - a) / (b - a);
    return Vec3f(Vec3{(c + 0.5 + (south ? 0 : t)) * grid_.cell, -(r + 0.5 + (south ? t : 0)) * grid_.cell, level_});
  }
  void trace(EdgeKey start, PolylineSet& lines) {
    EdgeKey at = start;
    while (true) {
      Neighbours& n = neighbours_.at(at);
      n.used = true;
      lines.positions.push_back(point_on(at));
      const EdgeKey* next = nullptr;
      for (int k = 0; k < n.count && !next; ++k)
        if (!neighbours_.at(n.of[static_cast<std::size_t>(k)]).used) next = &n.of[static_cast<std::size_t>(k)];
      if (!next) break;
      at = *next;
    }
    const Neighbours &first = neighbours_.at(start), &last = neighbours_.at(at);
    if (first.count == 2 && last.count == 2 && at != start) lines.positions.push_back(point_on(start));
  }

  const HeightGrid& grid_;
  double level_;
  std::unordered_map<EdgeKey, Neighbours> neighbours_;
  std::vector<EdgeKey> order_;
};

long level_number(double height, double interval) { return std::lround(height / interval); }

const std::vector<double>& heights_in(const PolylineSet& contours) {
  const auto* const heights = contours.line_attributes.find<double>("height");
  if (!heights) throw ArgumentError("contour lines have no heights");
  return *heights;
}

}  // namespace

PolylineSet contours_of(const HeightGrid& grid, double interval) {
  PolylineSet lines;
  lines.origin = {grid.left, grid.top, 0};
  lines.reference = grid.reference;
  const int width = grid.heights.width, height = grid.heights.height;
  float least = INFINITY, most = -INFINITY;
  for (const float h : grid.heights.pixels)
    if (std::isfinite(h)) least = std::min(least, h), most = std::max(most, h);
  std::vector<double> heights;
  const double first = std::ceil(static_cast<double>(least) / interval);
  const double last = std::floor(static_cast<double>(most) / interval);
  if (least <= most && last - first >= kMostLevels)
    throw ArgumentError(
        fmt::format("`interval` would give {:.0f} contour heights: at most 10000 are possible", last - first + 1));
  // Squares by level, so that each is visited for its own levels only.
  std::vector<std::vector<std::pair<int, int>>> squares(
      least <= most && last >= first ? static_cast<std::size_t>(last - first) + 1 : 0);
  for (int r = 0; r + 1 < height && !squares.empty(); ++r)
    for (int c = 0; c + 1 < width; ++c) {
      const std::array<float, 4> h{grid.heights.at(c, r), grid.heights.at(c + 1, r), grid.heights.at(c + 1, r + 1),
                                   grid.heights.at(c, r + 1)};
      if (!std::all_of(h.begin(), h.end(), [](float x) { return std::isfinite(x); })) continue;
      const auto [low, high] = std::minmax_element(h.begin(), h.end());
      const double from = std::max(first, std::ceil(static_cast<double>(*low) / interval));
      const double to = std::min(last, std::floor(static_cast<double>(*high) / interval));
      for (double k = from; k <= to; ++k) squares[static_cast<std::size_t>(k - first)].push_back({c, r});
    }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    LevelLines level(grid, (first + static_cast<double>(k)) * interval);
    for (const auto& [c, r] : squares[k]) level.add_square(c, r);
    level.append_to(lines, heights);
  }
  lines.line_attributes.set("height", std::move(heights));
  return lines;
}

std::string contours_svg(const PolylineSet& contours, double interval) {
  const std::vector<double>& heights = heights_in(contours);
  float x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
  for (const Vec3f& p : contours.positions)
    x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, -p.y), y1 = std::max(y1, -p.y);
  if (!(x0 <= x1)) x0 = y0 = 0, x1 = y1 = 1;
  const float size = std::max({x1 - x0, y1 - y0, 1e-6f}), scale = 1000 / size;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.6g}\" height=\"{:.6g}\" viewBox=\"{:.7g} {:.7g} {:.7g} "
      "{:.7g}\" "
      "data-origin=\"{} {}\">\n<g fill=\"none\" stroke=\"#7a4a1e\" stroke-width=\"{:.4g}\">\n",
      scale * (x1 - x0), scale * (y1 - y0), x0, y0, x1 - x0, y1 - y0, contours.origin.x, contours.origin.y,
      0.7f / scale);
  auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < contours.size();) {
    const double height = heights[i];
    const bool bold = level_number(height, interval) % kIndexContours == 0;
    fmt::format_to(out, "<path data-height=\"{:.10g}\"{} d=\"", height,
                   bold ? fmt::format(" stroke-width=\"{:.4g}\"", 1.6f / scale) : "");
    for (; i < contours.size() && heights[i] == height; ++i)
      for (std::size_t k = contours.offsets[i]; k < contours.offsets[i + 1]; ++k)
        fmt::format_to(out, "{}{:.7g} {:.7g}", k == contours.offsets[i] ? 'M' : 'L', contours.positions[k].x,
                       -contours.positions[k].y);
    fmt::format_to(out, "\"><title>{:.10g}</title></path>\n", height);
  }
  return text + "</g>\n</svg>\n";
}

std::string contours_dxf(const PolylineSet& contours, double interval) {
  const std::vector<double>& heights = heights_in(contours);
  std::string text =
      "  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n";
  auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const std::size_t begin = contours.offsets[i];
    std::size_t end = contours.offsets[i + 1];
    const bool closed = end - begin > 3 && contours.positions[begin] == contours.positions[end - 1];
    if (closed) --end;
    const char* layer = level_number(heights[i], interval) % kIndexContours == 0 ? "CONTOUR_INDEX" : "CONTOUR";
    fmt::format_to(out, "  0\nPOLYLINE\n  8\n{}\n 66\n1\n 10\n0.0\n 20\n0.0\n 30\n{}\n 70\n{}\n", layer, heights[i],
                   closed ? 1 : 0);
    for (std::size_t k = begin; k < end; ++k)
      fmt::format_to(out, "  0\nVERTEX\n  8\n{}\n 10\n{:.12g}\n 20\n{:.12g}\n 30\n{}\n", layer,
                     contours.origin.x + static_cast<double>(contours.positions[k].x),
                     contours.origin.y + static_cast<double>(contours.positions[k].y), heights[i]);
    fmt::format_to(out, "  0\nSEQEND\n  8\n{}\n", layer);
  }
  return text + "  0\nENDSEC\n  0\nEOF\n";
}

}  // namespace sansmesh::inline v1
