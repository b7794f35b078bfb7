#include "sansmesh/points/ground/breaklines.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {
namespace {

/// Places per edge of a bin that decide which bins a piece passes through.
constexpr int kPlacesOfPiece = 8;

/// Whether (x, y) is on the left of the line through a and b, or on it.
bool is_left(double ax, double ay, double bx, double by, double x, double y) {
  return (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0;
}

bool has_heights(const PolylineSet& lines, std::size_t line) {
  bool any = false;
  for (std::size_t k = lines.offsets[line]; k < lines.offsets[line + 1]; ++k) {
    const double z = lines.origin.z + static_cast<double>(lines.positions[k].z);
    if (!std::isfinite(z)) return false;
    any = any || z != 0;
  }
  return any;
}

}  // namespace

bool Breaklines::Piece::separates(double x, double y, double u, double v) const {
  return is_left(ax, ay, bx, by, x, y) != is_left(ax, ay, bx, by, u, v) &&
         is_left(x, y, u, v, ax, ay) != is_left(x, y, u, v, bx, by);
}

Breaklines::Breaklines(const PolylineSet& lines, const BreaklineBins& bins) {
  for (std::size_t l = 0; l < bins.columns.size(); ++l) levels_.push_back(make_level(lines, bins, l));
}

Breaklines::Level Breaklines::make_level(const PolylineSet& lines, const BreaklineBins& bins, std::size_t level) {
  Level made{bins.columns[level], bins.rows[level], {}, {}, {}};
  const double edge = std::ldexp(bins.edge, static_cast<int>(level));
  const double width = edge * static_cast<double>(made.columns), height = edge * static_cast<double>(made.rows);
  made.crossed.assign(static_cast<std::size_t>(made.columns * made.rows), 0);
  made.first.assign(made.crossed.size() + 1, 0);
  const auto bin_of = [&](double x, double y) {
    const auto c = index_in<std::ptrdiff_t>(x / edge, 0, made.columns - 1);
    return static_cast<std::size_t>(index_in<std::ptrdiff_t>(y / edge, 0, made.rows - 1) * made.columns + c);
  };
  const auto inside = [&](double x, double y) { return x >= 0 && y >= 0 && x < width && y < height; };
  std::vector<Piece> pieces;
  std::size_t lines_inside = 0;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const bool heights = has_heights(lines, line);
    const std::size_t before = pieces.size();
    const auto at = [&](std::size_t k) { return lines.origin + Vec3(lines.positions[k]) - bins.corner; };
    for (std::size_t k = lines.offsets[line]; k + 1 < lines.offsets[line + 1]; ++k) {
      const Vec3 a = at(k), step = at(k + 1) - a;
      if (!std::isfinite(a.x + a.y + step.x + step.y)) continue;
      // The part within a bin of the bins.
      double from = 0, to = 1;
      for (const auto& [p, d, most] : {std::array{a.x, step.x, width}, std::array{a.y, step.y, height}}) {
        if (d == 0 && (p < -edge || p > most + edge)) to = -1;
        if (d == 0) continue;
        const double t = (-edge - p) / d, u = (most + edge - p) / d;
        from = std::max(from, std::min(t, u)), to = std::min(to, std::max(t, u));
      }
      if (!(from < to)) continue;
      const double length = (to - from) * std::hypot(step.x, step.y);
      const auto count = std::max<std::size_t>(1, whole_part<std::size_t>(std::ceil(length / edge)));
      for (std::size_t i = 0; i < count; ++i) {
        const auto place = [&](double share) { return a + step * (from + (to - from) * share); };
        const auto n = static_cast<double>(count), first = static_cast<double>(i);
        const Vec3 b = place(first / n), c = place((first + 1) / n), middle = place((first + 0.5) / n);
        pieces.push_back({b.x, b.y, c.x, c.y, heights ? std::optional(middle.z) : std::nullopt});
        for (int j = 0; j <= kPlacesOfPiece; ++j) {
          const Vec3 q = b + (c - b) * (static_cast<double>(j) / kPlacesOfPiece);
          if (inside(q.x, q.y)) made.crossed[bin_of(q.x, q.y)] = 1;
        }
      }
    }
    lines_inside += std::any_of(pieces.begin() + static_cast<std::ptrdiff_t>(before), pieces.end(),
                                [&](const Piece& p) { return inside(p.x(), p.y()); });
  }
  lines_inside_ = std::max(lines_inside_, lines_inside);
  for (const Piece& p : pieces) ++made.first[bin_of(p.x(), p.y()) + 1];
  for (std::size_t i = 1; i < made.first.size(); ++i) made.first[i] += made.first[i - 1];
  made.pieces.resize(pieces.size());
  std::vector<std::uint32_t> next = made.first;
  for (const Piece& p : pieces) made.pieces[next[bin_of(p.x(), p.y())]++] = p;
  return made;
}

void Breaklines::append_pieces(std::size_t level, std::ptrdiff_t column, std::ptrdiff_t row,
                               std::vector<Piece>& pieces) const {
  const Level& l = levels_[level];
  const auto bin = static_cast<std::size_t>(row * l.columns + column);
  pieces.insert(pieces.end(), l.pieces.begin() + l.first[bin], l.pieces.begin() + l.first[bin + 1]);
}

bool Breaklines::crosses(std::size_t level, std::ptrdiff_t column, std::ptrdiff_t row) const {
  const Level& l = levels_[level];
  return l.crossed[static_cast<std::size_t>(row * l.columns + column)] != 0;
}

}  // namespace sansmesh::inline v1
