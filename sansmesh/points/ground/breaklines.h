// Breaklines of a terrain: lines at which its height or slope jumps.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/polyline_set.h"

namespace sansmesh::inline v1 {

/// Square bins over x and y; level l has bins of 2^l times the edge.
struct BreaklineBins {
  double edge = 0;  ///< edge at level 0 (length)
  Vec3 corner;      ///< lower left corner in world coordinates; z is the origin of heights
  std::vector<std::ptrdiff_t> columns = {}, rows = {};  ///< counts at each level
};

/// Breaklines in pieces at most as long as the bins of a level, relative to the corner of the bins.
class Breaklines {
 public:
  struct Piece {
    double ax = 0, ay = 0, bx = 0, by = 0;  ///< ends
    /// Height of the middle over the corner. Lines have one per edge of a bin, as samples would, if they have heights.
    std::optional<double> height = {};

    auto operator<=>(const Piece&) const = default;
    double x() const { return 0.5 * (ax + bx); }
    double y() const { return 0.5 * (ay + by); }
    /// Whether the segment from (x, y) to (u, v) crosses the piece. A point on it is on its left side.
    bool separates(double x, double y, double u, double v) const;
  };

  /// A line whose heights are all 0, or not finite, has none. Throws DataError if there are too many pieces.
  Breaklines(const PolylineSet& lines, const BreaklineBins& bins);

  /// Number of lines with a part in the bins.
  std::size_t lines_inside() const { return lines_inside_; }
  /// Appends the pieces with their middle in this bin of a level.
  void append_pieces(std::size_t level, std::ptrdiff_t column, std::ptrdiff_t row, std::vector<Piece>& pieces) const;
  /// Whether a line passes through the bin: the mean of its samples mixes two sides.
  bool crosses(std::size_t level, std::ptrdiff_t column, std::ptrdiff_t row) const;

 private:
  struct Level {
    std::ptrdiff_t columns = 0, rows = 0;
    std::vector<Piece> pieces;         ///< by bin of the middle
    std::vector<std::uint32_t> first;  ///< first piece of each bin; one more entry than bins
    std::vector<std::uint8_t> crossed;
  };

  Level make_level(const PolylineSet& lines, const BreaklineBins& bins, std::size_t level);
  static void sort_pieces(Level& level, std::vector<Piece> pieces, double edge);

  std::vector<Level> levels_;
  std::size_t lines_inside_ = 0;
};

}  // namespace sansmesh::inline v1
