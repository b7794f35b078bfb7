#include "sansmesh/volume/cells/cell_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/box.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMost = 65536;  // cached cells, some hundred bytes each
constexpr int kMostSteps = 6;         // through faces; a search is as fast for longer distances
/// Cells overlap by rounding. Points with this margin of their parameters are deeper than the overlap.
constexpr double kCellOverlap = 1e-13;

/// Corners of the faces at the bounds of the parameters. Only for tetrahedra and hexahedra.
std::size_t side_count(CellShape shape) {
  return shape == CellShape::hexahedron ? 6 : shape == CellShape::tetrahedron ? 4 : 0;
}
std::span<const std::uint8_t> corners_of_side(CellShape shape, std::size_t side) {
  static constexpr std::uint8_t kHexahedron[6][4] = {{0, 3, 4, 7}, {1, 2, 5, 6}, {0, 1, 4, 5},
                                                     {2, 3, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};
  static constexpr std::uint8_t kTetrahedron[4][3] = {{0, 2, 3}, {0, 1, 3}, {0, 1, 2}, {1, 2, 3}};
  if (shape == CellShape::hexahedron) return kHexahedron[side];
  return kTetrahedron[side];
}

/// Largest violation of a parameter bound (negative inside), and the side with it.
inline double beyond_side(CellShape shape, const Vec3& u, std::size_t& side) {
  side = 0;
  if (shape == CellShape::tetrahedron) {
    const double sum = u.x + u.y + u.z - 1;
    double most = -u.x;
    if (-u.y > most) most = -u.y, side = 1;
    if (-u.z > most) most = -u.z, side = 2;
    if (sum > most) most = sum, side = 3;
    return most;
  }
  const double x = std::abs(u.x - 0.5), y = std::abs(u.y - 0.5), z = std::abs(u.z - 0.5);
  double most = x, at = u.x;
  std::size_t axis = 0;
  if (y > most) most = y, at = u.y, axis = 1;
  if (z > most) most = z, at = u.z, axis = 2;
  side = 2 * axis + (at > 0.5 ? 1 : 0);
  return most - 0.5;
}

struct Extent {
  double lower, upper;
};
Extent extent(std::span<const Vec3> x, const Vec3& normal) {
  Extent e{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Vec3& p : x) {
    const double d = dot(normal, p);
    e.lower = std::min(e.lower, d), e.upper = std::max(e.upper, d);
  }
  return e;
}

}  // namespace

CellCache::CellCache(const SampledVolume& volume, const BoxTree& boxes, std::span<const std::uint8_t> folded)
    : volume_(volume),
      boxes_(boxes),
      folded_(folded),
      most_(std::min(kMost, volume.cells.size())),
      state_(volume.cells.size()),
      cells_(most_) {}

CellCache::~CellCache() = default;

std::uint32_t CellCache::find(const Vec3& x, std::uint32_t from, double margin, Vec3& u) const {
  for (int step = 0; step < kMostSteps && from < state_.size(); ++step) {
    const Cell* const cell = known(from);
    if (!cell) return kNoCell;
    const CellShape shape = cell->inverse.shape();
    const Vec3 at = x - cell->corner;
    // A point far outside by the linear part is also outside by the nonlinear one.
    constexpr double kFar = 0.5;
    std::size_t side = 0;
    if (!(beyond_side(shape, cell->inverse.guess(at), side) > kFar)) {
      if (!cell->inverse.invert(at, u)) return kNoCell;
      const double out = beyond_side(shape, u, side);
      // Other shapes have more sides; a point on a side may belong to other cells.
      const bool within = out < -margin && (side_count(shape) > 0 || parameters_within(shape, u, margin));
      if (within) {
        for (const Rival& rival : cell->rivals)
          if (!(dot(rival.normal, at) < rival.from)) return kNoCell;
        return from;
      }
      if (!(out > margin)) return kNoCell;
    }
    if (side_count(shape) == 0) return kNoCell;
    from = cell->beyond[side];
  }
  return kNoCell;
}

void CellCache::count(std::uint32_t cell) const {
  std::uint32_t state = state_[cell].load(std::memory_order_relaxed);
  if (state >= kOften) return;
  if (state + 1 < kOften) {  // counts lost between threads are harmless
    state_[cell].compare_exchange_weak(state, state + 1, std::memory_order_relaxed);
    return;
  }
  if (!state_[cell].compare_exchange_strong(state, kNever, std::memory_order_relaxed)) return;
  const std::uint32_t slot = used_.fetch_add(1, std::memory_order_relaxed);
  if (slot >= most_) {
    used_.store(static_cast<std::uint32_t>(most_), std::memory_order_relaxed);
    return;
  }
  cells_[slot] = make_entry(cell);
  state_[cell].store(kOften + slot, std::memory_order_release);
}

std::unique_ptr<CellCache::Cell> CellCache::make_entry(std::uint32_t number) const {
  if (!folded_.empty() && folded_[number] != 0) return nullptr;  // parameters may differ from those of the search
  const CellList& cells = volume_.cells;
  std::array<Vec3, 8> own, other;
  const auto corners_of = [&](std::uint32_t cell, std::array<Vec3, 8>& into) {
    const auto points = cells[cell];
    for (std::size_t k = 0; k < points.size(); ++k) into[k] = volume_.corner(points[k]);
    return std::span<Vec3>(into).first(points.size());
  };
  auto made = std::make_unique<Cell>();
  Cell& cell = *made;
  const std::span<Vec3> mine = corners_of(number, own);
  const CellShape shape = cells.shapes[number];
  cell.inverse = CellInverse(shape, mine);
  cell.corner = mine[0];
  cell.beyond.fill(kNoCell);
  Box3 box;
  for (const Vec3& p : mine) box.extend(p);
  std::vector<std::uint32_t> near;
  boxes_.overlapping(box, near);
  std::sort(near.begin(), near.end());
  for (Vec3& p : mine) p -= cell.corner;
  const auto normals = [](CellShape of, std::span<const Vec3> x, std::vector<Vec3>& into) {
    for (const CellFace& f : cell_faces(of)) {
      const Vec3 &a = x[f.corner[0]], &b = x[f.corner[1]], &c = x[f.corner[2]], &d = x[f.corner[f.count - 1]];
      const Vec3 normal = f.count == 4 ? cross(c - a, d - b) : cross(b - a, c - a);
      if (squared_norm(normal) > 0) into.push_back(normalized(normal));
    }
  };
  std::vector<Vec3> directions;
  normals(shape, mine, directions);
  const std::size_t own_directions = directions.size();
  for (const std::uint32_t n : near) {
    if (n == number) continue;
    const std::span<Vec3> its = corners_of(n, other);
    for (Vec3& p : its) p -= cell.corner;
    const auto points = cells[number], others = cells[n];
    for (std::size_t side = 0; side < side_count(shape); ++side) {
      const auto corners = corners_of_side(shape, side);
      const auto shared = [&](std::uint8_t c) {
        return std::find(others.begin(), others.end(), points[c]) != others.end();
      };
      if (cell.beyond[side] == kNoCell && std::all_of(corners.begin(), corners.end(), shared)) cell.beyond[side] = n;
    }
    // Among the planes along faces of both cells and perpendicular to the line between them, the one that leaves the
    // smallest part of this cell on the side of the other.
    directions.resize(own_directions);
    normals(cells.shapes[n], its, directions);
    for (std::size_t k = own_directions; k < directions.size(); ++k) directions[k] *= -1;
    Vec3 way;
    for (const Vec3& p : its) way += p / static_cast<double>(its.size());
    for (const Vec3& p : mine) way -= p / static_cast<double>(mine.size());
    if (squared_norm(way) > 0) directions.push_back(normalized(way));
    Rival best{{}, -std::numeric_limits<double>::infinity()};
    double least = std::numeric_limits<double>::infinity();
    bool apart = false;
    for (const Vec3& normal : directions) {
      const Extent here = extent(mine, normal), there = extent(its, normal);
      const double thin = std::min(here.upper - here.lower, there.upper - there.lower);
      const double overlap = here.upper - there.lower;
      apart = overlap <= kCellOverlap * thin;
      if (apart) break;
      if (overlap < least * thin) least = overlap / thin, best = {normal, there.lower - kCellOverlap * thin};
    }
    if (!apart) cell.rivals.push_back(best);
  }
  return made;
}

}  // namespace sansmesh::inline v1
