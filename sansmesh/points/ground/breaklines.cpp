#include "sansmesh/points/ground/breaklines.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Points per edge of a bin that decide which bins a piece passes through.
constexpr int kPlacesOfPiece = 8;
/// Least length of pieces inside a line, and the largest distance of the left out vertices (edges).
constexpr double kLeastPiece = 1.0 / 16, kStraightPiece = 1.0 / 50;
constexpr double kMostPieces = 4e6;

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

/// Leaves out vertices nearer to the last one than a part of the edge, and those of which a straight piece, at most an
/// edge long, passes within a smaller part.
void simplify(std::vector<Vec3>& line, double edge) {
  const auto apart = [](const Vec3& a, const Vec3& b) { return std::hypot(b.x - a.x, b.y - a.y); };
  const auto keep = [&](auto&& is_kept) {
    std::size_t count = 1;
    for (std::size_t k = 1; k < line.size(); ++k)
      if (k + 1 == line.size() || is_kept(line[count - 1], k)) line[count++] = line[k];
    line.resize(std::min(line.size(), count));
  };
  keep([&](const Vec3& last, std::size_t k) { return !(apart(last, line[k]) < kLeastPiece * edge); });
  std::size_t first = 1;  // vertex after the last kept one
  keep([&](const Vec3& last, std::size_t k) {
    const Vec3 step = line[k + 1] - last;
    const double length = std::hypot(step.x, step.y);
    bool kept = !(length <= edge);
    for (std::size_t j = first; j <= k && !kept; ++j) {
      const Vec3 to = line[j] - last;
      const double along = to.x * step.x + to.y * step.y;
      kept = !(std::abs(to.x * step.y - to.y * step.x) <= kStraightPiece * edge * length) || along < 0 ||
             along > length * length;
    }
    if (kept) first = k + 1;
    return kept;
  });
}

/// Cuts lines into pieces within one bin of a rectangle from (0, 0).
class PieceCutter {
 public:
  PieceCutter(double edge, double width, double height, std::vector<Breaklines::Piece>& pieces)
      : edge_(edge), width_(width), height_(height), pieces_(pieces) {}

  /// A line that begins where the last one ends continues it.
  void add(const std::vector<Vec3>& line, bool heights) {
    if (line.empty()) return;
    if (!(line.front() == last_)) to_height_ = 0.5 * edge_;
    last_ = line.back();
    for (std::size_t k = 0; k + 1 < line.size(); ++k) add_step(line[k], line[k + 1] - line[k], heights);
  }

 private:
  void add_step(const Vec3& a, const Vec3& step, bool heights) {
    if (!std::isfinite(a.x + a.y + step.x + step.y)) return;
    double from = 0, to = 1;
    for (const auto& [p, d, most] : {std::array{a.x, step.x, width_}, std::array{a.y, step.y, height_}}) {
      if (d == 0 && (p < -edge_ || p > most + edge_)) to = -1;
      if (d == 0) continue;
      const double t = (-edge_ - p) / d, u = (most + edge_ - p) / d;
      from = std::max(from, std::min(t, u)), to = std::min(to, std::max(t, u));
    }
    if (!(from < to)) return;
    const double length = (to - from) * std::hypot(step.x, step.y);
    const double count = std::max(1.0, std::ceil(length / edge_));
    if (!(static_cast<double>(pieces_.size()) + count <= kMostPieces))
      throw DataError(
          fmt::format("the breaklines are too long: more than {:.0f} spacings of the samples", kMostPieces));
    for (double i = 0; i < count; ++i) {
      const auto point_at = [&](double share) { return a + step * (from + (to - from) * share); };
      const Vec3 b = point_at(i / count), c = point_at((i + 1) / count);
      pieces_.push_back({b.x, b.y, c.x, c.y});
      to_height_ -= length / count;
      if (to_height_ > 0) continue;
      to_height_ += edge_;
      if (heights) pieces_.back().height = point_at((i + 0.5) / count).z;
    }
  }

  double edge_, width_, height_;
  std::vector<Breaklines::Piece>& pieces_;
  Vec3 last_{NAN, NAN, NAN};
  double to_height_ = 0;  ///< length up to the next height
};

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
  const auto inside = [&](double x, double y) { return x >= 0 && y >= 0 && x < width && y < height; };
  std::vector<Breaklines::Piece> pieces;
  PieceCutter cutter(edge, width, height, pieces);
  std::size_t lines_inside = 0;
  std::vector<Vec3> line;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t before = pieces.size();
    line.clear();
    for (std::size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; ++k)
      line.push_back(lines.origin + Vec3(lines.positions[k]) - bins.corner);
    simplify(line, edge);
    cutter.add(line, has_heights(lines, i));
    lines_inside += std::any_of(pieces.begin() + static_cast<std::ptrdiff_t>(before), pieces.end(),
                                [&](const Piece& p) { return inside(p.x(), p.y()); });
  }
  lines_inside_ = std::max(lines_inside_, lines_inside);
  sort_pieces(made, std::move(pieces), edge);
  return made;
}

void Breaklines::sort_pieces(Level& level, std::vector<Piece> pieces, double edge) {
  const auto bin_of = [&](double x, double y) {
    const auto c = index_in<std::ptrdiff_t>(x / edge, 0, level.columns - 1);
    return static_cast<std::size_t>(index_in<std::ptrdiff_t>(y / edge, 0, level.rows - 1) * level.columns + c);
  };
  level.crossed.assign(static_cast<std::size_t>(level.columns * level.rows), 0);
  level.first.assign(level.crossed.size() + 1, 0);
  // A line that a file has twice counts once.
  std::sort(pieces.begin(), pieces.end());
  pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
  for (const Piece& p : pieces) {
    ++level.first[bin_of(p.x(), p.y()) + 1];
    for (int j = 0; j <= kPlacesOfPiece; ++j) {
      const double share = static_cast<double>(j) / kPlacesOfPiece;
      const double x = p.ax + share * (p.bx - p.ax), y = p.ay + share * (p.by - p.ay);
      if (x >= 0 && y >= 0 && x < edge * static_cast<double>(level.columns) &&
          y < edge * static_cast<double>(level.rows))
        level.crossed[bin_of(x, y)] = 1;
    }
  }
  for (std::size_t i = 1; i < level.first.size(); ++i) level.first[i] += level.first[i - 1];
  level.pieces.resize(pieces.size());
  std::vector<std::uint32_t> next = level.first;
  for (const Piece& p : pieces) level.pieces[next[bin_of(p.x(), p.y())]++] = p;
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
