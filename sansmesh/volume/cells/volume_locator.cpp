#include "sansmesh/volume/cells/volume_locator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/volume/cells/axis_interval.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_cache.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/cells/cell_inverse.h"
#include "sansmesh/volume/grid/point_order.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kBeside = 2000;   // tolerances from the volume: 2e-6 of its diagonal
constexpr double kStrict = 1e-10;  // in parameters: closer points are on the face

void locate_in_lattice(const Lattice& l, double tolerance, const Vec3& x, CellLocation& location) {
  const Vec3 a = is_finite(x) ? l.to_axes(x) : Vec3{l.lower[0], l.lower[1], l.lower[2]};
  location.inside = is_finite(x);
  std::size_t cell[3];
  Vec3 u;
  for (std::size_t k = 0; k < 3; ++k) {
    location.inside = location.inside && a[k] >= l.lower[k] - tolerance && a[k] <= l.upper[k] + tolerance;
    const double c = std::clamp(a[k], l.lower[k], l.upper[k]);
    cell[k] = interval_of(l.axes[k], l.uniform, c);
    const double from = l.axes[k][cell[k]], to = l.axes[k][cell[k] + 1];
    u[k] = (c - from) / (to - from);
  }
  location.corners = corners_of_lattice_cell(l, cell[0] + l.axes[0].size() * (cell[1] + l.axes[1].size() * cell[2]));
  location.cell = location.corners[0];
  location.corner_count = 8;
  shape_functions(CellShape::hexahedron, u, location.weights);
}

}  // namespace

struct VolumeLocator::State {
  const SampledVolume& volume;
  double tolerance;
  BoxTree cells;
  std::vector<std::uint8_t> folded;  ///< per cell; empty if no cell is folded
  std::unique_ptr<CellCache> cache;

  /// Faces without a cell on the other side, for points outside: computed on first use.
  struct Border {
    std::vector<std::uint32_t> faces;  ///< kMostFaces · cell + face
    BoxTree tree;
  };
  mutable std::once_flag border_made;
  mutable Border border;

  explicit State(const SampledVolume& v) : volume(v), tolerance(1e-9 * v.bounds().diagonal()) {
    if (volume.lattice) return;
    if (volume.cells.empty()) throw DataError("the volume has no cells");
    cells = BoxTree(volume.cells.size(), [this](std::size_t c) {
      Box3 box;
      for (const std::uint32_t p : volume.cells[c]) box.extend(volume.corner(p));
      return widened(box);
    });
    folded.resize(volume.cells.size());
    parallel_for(0, folded.size(), 4096, [this](std::size_t c) {
      std::array<Vec3, 8> corners;
      const std::size_t count = corners_of(c, volume.corner(volume.cells[c][0]), corners);
      folded[c] = is_folded(volume.cells.shapes[c], std::span(corners).first(count));
    });
    if (std::find(folded.begin(), folded.end(), 1) == folded.end()) folded = {};
    cache = std::make_unique<CellCache>(volume, cells, folded);
  }

  Box3 widened(Box3 box) const {
    const Vec3 slack{tolerance, tolerance, tolerance};
    return {box.lower - slack, box.upper + slack};
  }

  std::size_t corners_of(std::size_t cell, const Vec3& x, std::array<Vec3, 8>& corners) const {
    const auto points = volume.cells[cell];
    for (std::size_t c = 0; c < points.size(); ++c) corners[c] = volume.corner(points[c]) - x;
    return points.size();
  }

  void make_border() const {
    const std::size_t points = volume.corners.empty() ? volume.positions.size() : volume.corners.size();
    border.faces = open_faces(volume.cells, points);
    border.tree = BoxTree(border.faces.size(), [this](std::size_t i) {
      Box3 box;
      for (const std::uint32_t p : ring_of_face(volume.cells, border.faces[i])) box.extend(volume.corner(p));
      return box;
    });
  }

  std::size_t ring_of(std::uint32_t id, const Vec3& x, std::array<Vec3, 4>& ring) const {
    const FaceRing points = ring_of_face(volume.cells, id);
    for (std::size_t k = 0; k < points.count; ++k) ring[k] = volume.corner(points.points[k]) - x;
    return points.count;
  }

  void set(CellLocation& location, std::uint32_t cell) const {
    const auto points = volume.cells[cell];
    location.cell = cell;
    location.corner_count = static_cast<std::uint8_t>(points.size());
    std::copy(points.begin(), points.end(), location.corners.begin());
  }

  /// The nearest point to x on the faces without a neighbour.
  void locate_outside(const Vec3& x, CellLocation& location, std::vector<std::uint32_t>& candidates) const {
    if (locate_next_to(x, location, candidates)) return;
    std::call_once(border_made, [this] { make_border(); });
    const auto distance = [&](std::uint32_t i) {
      std::array<Vec3, 4> r;
      const std::size_t count = ring_of(border.faces[i], x, r);
      double d = squared_norm(closest_on_triangle({}, r[0], r[1], r[2]));
      if (count == 4) d = std::min(d, squared_norm(closest_on_triangle({}, r[0], r[2], r[3])));
      return d;
    };
    const std::uint32_t nearest = border.tree.nearest(x, distance, std::numeric_limits<double>::infinity());
    if (nearest == BoxTree::kNone) {  // no border (a volume that closes on itself), or distances that overflow
      set(location, 0);
      location.weights[0] = 1;
      return;
    }
    const std::uint32_t id = border.faces[nearest];
    set(location, id / kMostFaces);
    std::array<Vec3, 4> ring;
    std::array<double, 4> weights;
    const std::size_t count = ring_of(id, x, ring);
    nearest_on_face(std::span(ring).first(count), weights);
    const CellFace& face = cell_faces(volume.cells.shapes[location.cell])[id % kMostFaces];
    for (std::size_t k = 0; k < count; ++k) location.weights[face.corner[k]] = weights[k];
  }

  /// Most points outside are just beyond a face, at ends of rays. The point of a cell at nearly the same parameters
  /// suffices for them, without a search.
  bool locate_next_to(const Vec3& x, CellLocation& location, std::vector<std::uint32_t>& candidates) const {
    const double near = kBeside * tolerance;
    const Vec3 slack{near, near, near};
    cells.overlapping({x - slack, x + slack}, candidates);
    double least = near * near;
    std::uint32_t best = kNoCell;
    Vec3 at;
    for (const std::uint32_t cell : candidates) {
      std::array<Vec3, 8> corners;
      const CellShape shape = volume.cells.shapes[cell];
      const CellInverse inverse(shape, std::span<const Vec3>(corners).first(corners_of(cell, {}, corners)));
      const Vec3 from_corner = x - corners[0];
      Vec3 u;
      if (!inverse.may_reach(from_corner, near) || !inverse.invert(from_corner, u)) continue;
      u = clamped_parameters(shape, u);
      const double d = squared_norm(inverse.at(u) - from_corner);
      if (d < least || (d == least && cell < best)) least = d, best = cell, at = u;
    }
    if (best == kNoCell) return false;
    set(location, best);
    shape_functions(volume.cells.shapes[best], at, location.weights);
    return true;
  }

  /// `start` is a cell nearby, or none, and receives the cell found.
  void locate(const Vec3& x, CellLocation& location, std::uint32_t& start,
              std::vector<std::uint32_t>& candidates) const {
    if (!is_finite(x)) {
      location.inside = false;
      location.weights.fill(0);
      set(location, 0);
      location.weights[0] = 1;
      return;
    }
    Vec3 u;
    if (const std::uint32_t cell = cache->find(x, start, kStrict, u); cell != kNoCell) {
      location.inside = true;
      set(location, cell);
      shape_functions(volume.cells.shapes[cell], u, location.weights);
      start = cell;
      return;
    }
    location.inside = false;
    location.weights.fill(0);
    search(x, location, candidates);
    if (location.inside) cache->count(location.cell);
    start = location.cell;
  }

  void search(const Vec3& x, CellLocation& location, std::vector<std::uint32_t>& candidates) const {
    cells.containing(x, candidates);
    std::array<Vec3, 8> corners;
    // Inside a cell, where the smallest counts, or only on cell faces, where the first counts.
    std::uint32_t within = kNoCell, touched = kNoCell;
    double smallest = -1;
    Vec3 within_at, touched_at;
    bool failed = false;
    for (const std::uint32_t cell : candidates) {
      const CellShape shape = volume.cells.shapes[cell];
      const std::size_t count = corners_of(cell, {}, corners);
      const std::span<const Vec3> these = std::span(corners).first(count);
      const CellInverse inverse(shape, these);
      const Vec3 from_corner = x - corners[0];
      if (!inverse.may_reach(from_corner, tolerance)) continue;
      Vec3 u;
      if (!inverse.invert(from_corner, u)) {
        failed = true;
        continue;
      }
      if (parameters_within(shape, u, kStrict)) {
        if (within == kNoCell) {
          within = cell, within_at = u;
          continue;
        }
        if (smallest < 0) {
          std::array<Vec3, 8> others;
          const std::size_t n = corners_of(within, {}, others);
          smallest = std::abs(cell_volume(volume.cells.shapes[within], std::span(others).first(n)));
        }
        const double size = std::abs(cell_volume(shape, these));
        if (size < smallest || (size == smallest && cell < within)) within = cell, within_at = u, smallest = size;
      } else if (within == kNoCell && cell < touched) {
        const Vec3 nearest = clamped_parameters(shape, u);
        if (squared_norm(nearest - u) < 0.25 &&
            squared_norm(inverse.at(nearest) - from_corner) <= tolerance * tolerance)
          touched = cell, touched_at = nearest;
        else if (!folded.empty() && folded[cell])
          failed = true;
      }
    }
    if (within != kNoCell || touched != kNoCell) {
      location.inside = true;
      set(location, within != kNoCell ? within : touched);
      shape_functions(volume.cells.shapes[location.cell], within != kNoCell ? within_at : touched_at, location.weights);
      return;
    }
    if (failed) {  // folded or nearly flat cells, for which Newton's method diverges
      double nearest = tolerance * tolerance;
      for (const std::uint32_t cell : candidates) {
        std::array<double, 8> weights;
        const std::size_t count = corners_of(cell, x, corners);
        const double d = nearest_in_cell(volume.cells.shapes[cell], std::span(corners).first(count), weights);
        if (!(d <= nearest) || (d == nearest && location.inside && cell > location.cell)) continue;
        location.inside = true;
        nearest = d;
        set(location, cell);
        location.weights.fill(0);
        std::copy_n(weights.begin(), count, location.weights.begin());
      }
      if (location.inside) return;
    }
    locate_outside(x, location, candidates);
  }
};

VolumeLocator::VolumeLocator(const SampledVolume& volume) : state_(std::make_unique<State>(volume)) {}
VolumeLocator::~VolumeLocator() = default;

const SampledVolume& VolumeLocator::volume() const { return state_->volume; }

void VolumeLocator::locate(std::span<const Vec3> x, std::span<CellLocation> locations) const {
  locate(x, locations, {});
}

void VolumeLocator::locate(std::span<const Vec3> x, std::span<CellLocation> locations,
                           std::span<std::uint32_t> starts) const {
  if (x.size() != locations.size() || (starts.size() > 1 && starts.size() != x.size()))
    throw ArgumentError("VolumeLocator: the numbers of locations and points differ");
  const State& state = *state_;
  if (state.volume.lattice) {
    parallel_for(0, x.size(), 1024,
                 [&](std::size_t i) { locate_in_lattice(*state.volume.lattice, state.tolerance, x[i], locations[i]); });
    return;
  }
  const auto order = locality_order(x);
  constexpr std::size_t kGrain = 256;
  parallel_ranges(0, x.size(), kGrain, [&](std::size_t first, std::size_t last) {
    static thread_local std::vector<std::uint32_t> candidates;
    std::uint32_t before = starts.empty() ? kNoCell : starts[0];
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t i = order.empty() ? k : order[k];
      state.locate(x[i], locations[i], starts.size() > 1 ? starts[i] : before, candidates);
    }
    if (starts.size() == 1 && x.size() <= kGrain) starts[0] = before;
  });
}

double local_spacing(const SampledVolume& volume, const CellLocation& location) {
  if (volume.lattice) {
    const Lattice& l = *volume.lattice;
    const auto at = l.indices(location.cell);
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += l.axes[k][at[k] + 1] - l.axes[k][at[k]];
    return sum / 3;
  }
  double sum = 0;
  const auto corners = volume.cells[location.cell];
  const auto edges = cell_edges(volume.cells.shapes[location.cell]);
  for (const auto& edge : edges) sum += norm(volume.corner(corners[edge[0]]) - volume.corner(corners[edge[1]]));
  return sum / static_cast<double>(edges.size());
}

Vec3 held_outside(const SampledVolume& volume, const CellLocation& location, const Vec3& out) {
  const double length = norm(out), most = local_spacing(volume, location) / 2;
  if (length <= most) return out;
  return std::isfinite(length) ? out * (most / length) : Vec3{};
}

void shape_gradients(const SampledVolume& volume, const CellLocation& location, const Vec3& /*x*/,
                     std::span<Vec3, 8> gradients) {
  std::fill(gradients.begin(), gradients.end(), Vec3{});
  const CellShape shape = shape_of_cell(volume, location.cell);
  const std::size_t count = location.corner_count;
  Vec3 u = parameters_of(shape, location.weights);
  // The tip of a pyramid is singular; points just below it are regular.
  if (shape == CellShape::pyramid) u.z = std::min(u.z, 1 - 1e-6);
  std::array<Vec3, 8> by_parameter;
  shape_derivatives(shape, u, by_parameter);
  if (volume.lattice) {
    const Lattice& l = *volume.lattice;
    const auto at = l.indices(location.cell);
    double step[3];
    for (std::size_t k = 0; k < 3; ++k) step[k] = l.axes[k][at[k] + 1] - l.axes[k][at[k]];
    for (std::size_t c = 0; c < 8; ++c)
      for (std::size_t k = 0; k < 3; ++k) gradients[c] += l.directions[k] * (by_parameter[c][k] / step[k]);
    return;
  }
  std::array<Vec3, 3> j;
  const Vec3 base = volume.corner(location.corners[0]);
  for (std::size_t c = 1; c < count; ++c) {
    const Vec3 edge = volume.corner(location.corners[c]) - base;
    for (std::size_t k = 0; k < 3; ++k) j[k] += edge * by_parameter[c][k];
  }
  const Vec3 st = cross(j[1], j[2]);
  const double size = dot(j[0], st);
  const Vec3 by_r = st / size, by_s = cross(j[2], j[0]) / size, by_t = cross(j[0], j[1]) / size;
  if (!is_finite(by_r) || !is_finite(by_s) || !is_finite(by_t)) return;
  for (std::size_t c = 0; c < count; ++c) {
    const Vec3& d = by_parameter[c];
    gradients[c] = by_r * d.x + by_s * d.y + by_t * d.z;
  }
}

}  // namespace sansmesh::inline v1
