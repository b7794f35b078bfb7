// Lowest samples of an airborne survey in square cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Horizontal extent of a survey, and the spacing of its samples.
struct SurveyExtent {
  Vec3 lower, upper;   ///< box of all samples but those far away from the others; z is unused
  double spacing = 0;  ///< edge of the square of covered area per sample
};

/// Extent from the finite samples; nothing if they do not cover an area.
std::optional<SurveyExtent> measure_survey(const PointSet& points);

/// Square cells over x and y with their lowest samples.
struct GroundGrid {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  double cell = 0, left = 0, bottom = 0;  ///< edge of the cells (length), corner of the first
  std::size_t columns = 0, rows = 0;
  std::vector<std::uint32_t> cell_of;  ///< cell of each sample; kNone for samples outside
  std::vector<std::uint32_t> lowest;   ///< lowest sample of each cell, row by row; kNone for empty ones
  std::vector<std::uint8_t> inside;    ///< 1 for cells with samples within two cells

  std::size_t size() const { return lowest.size(); }
};

/// Cells of this edge (length). `shift` (cells, 0 to 1) moves all cells to the lower left. Stray samples below the
/// others are outside; those of the grid `without`, if it is given.
GroundGrid make_ground_grid(const PointSet& points, const SurveyExtent& extent, double cell, double shift,
                            const GroundGrid* without = nullptr);

}  // namespace sansmesh::inline v1
