// Interpolation in the grid's cells, and nearest-neighbour interpolation.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/axis_interval.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/cells/higher_order_functions.h"
#include "sansmesh/volume/grid/point_order.h"
#include "sansmesh/volume/methods/cell_interpolant.h"
#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kInLattice = 1024;  // points per task of a thread

class LinearField final : public detail::LocatedField {
 public:
  explicit LinearField(ReconstructionInput& input)
      : LocatedField(std::move(input.volume), std::move(input.values)), higher_(volume()) {
    if (volume().in_cells && !volume().lattice) between_cells_.emplace(volume(), samples());
  }

  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    const std::size_t n = components();
    const bool lattice = volume().lattice && detail::sizes_agree(wanted, x.size(), n);
    if (lattice && n == 1) return in_lattice<1>(x, wanted);
    if (lattice && n == 2) return in_lattice<2>(x, wanted);
    if (lattice && n == 3) return in_lattice<3>(x, wanted);
    LocatedField::evaluate(x, wanted);
  }

 private:
  /// Fast path for lattices with few components.
  template <std::size_t N>
  void in_lattice(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
    const double slack = 1e-9 * bounds().diagonal();  // the locator's tolerance
    const std::vector<std::uint32_t> order = locality_order(x);
    parallel_ranges(0, x.size(), kInLattice, [&](std::size_t first, std::size_t last) {
      std::array<double, N> value_store;
      std::array<Vec3, N> slope_store;
      for (std::size_t k = first; k < last; ++k) {
        const std::size_t i = order.empty() ? k : order[k];
        double* const values = wanted.values.empty() ? value_store.data() : wanted.values.data() + i * N;
        Vec3* const gradients = wanted.gradients.empty() ? slope_store.data() : wanted.gradients.data() + i * N;
        const bool inside = at_lattice<N>(x[i], slack, values, gradients, !wanted.gradients.empty());
        if (!wanted.inside.empty()) wanted.inside[i] = inside;
      }
    });
  }

  /// Values at x, gradients if `wanted`; returns whether x is inside. Outside as evaluate_point().
  template <std::size_t N>
  bool at_lattice(const Vec3& x, double slack, double* values, Vec3* gradients, bool wanted) const {
    if (!is_finite(x)) {
      std::fill_n(values, N, 0.0), std::fill_n(gradients, N, Vec3{});
      return false;
    }
    const Lattice& l = *volume().lattice;
    const Vec3 a = l.to_axes(x);
    std::array<std::size_t, 3> cell;
    Vec3 u, per_step, nearest;
    bool inside = true;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      inside = inside && a[k] >= l.lower[k] - slack && a[k] <= l.upper[k] + slack;
      nearest[k] = std::clamp(a[k], l.lower[k], l.upper[k]);
      cell[k] = interval_of(l.axes[k], l.uniform, nearest[k]);
      const double from = l.axes[k][cell[k]], step = l.axes[k][cell[k] + 1] - from;
      per_step[k] = 1 / step, least = std::min(least, step);
      u[k] = (nearest[k] - from) / step;
    }
    const std::size_t row = l.axes[0].size(), slab = row * l.axes[1].size();
    const double* const f = samples().values.data() + (cell[0] + row * cell[1] + slab * cell[2]) * N;
    const std::array<const double*, 4> rows{f, f + row * N, f + slab * N, f + (slab + row) * N};
    const double p = 1 - u.x, q = 1 - u.y, o = 1 - u.z;
    const std::array<double, 4> shares{q * o, u.y * o, q * u.z, u.y * u.z};
    for (std::size_t c = 0; c < N; ++c) {
      double value = 0;
      for (std::size_t r = 0; r < 4; ++r) value += (p * rows[r][c] + u.x * rows[r][N + c]) * shares[r];
      values[c] = value;
    }
    if (inside && !wanted) return true;
    for (std::size_t c = 0; c < N; ++c) {
      std::array<double, 4> line;
      double by_x = 0;
      for (std::size_t r = 0; r < 4; ++r) {
        line[r] = p * rows[r][c] + u.x * rows[r][N + c];
        by_x += (rows[r][N + c] - rows[r][c]) * shares[r];
      }
      const double by_y = (line[1] - line[0]) * o + (line[3] - line[2]) * u.z;
      const double by_z = (line[2] - line[0]) * q + (line[3] - line[1]) * u.y;
      gradients[c] = l.directions[0] * (by_x * per_step.x) + l.directions[1] * (by_y * per_step.y) +
                     l.directions[2] * (by_z * per_step.z);
    }
    if (inside) return true;
    Vec3 beyond = x - l.from_axes(nearest);
    const double length = norm(beyond);
    if (length > least / 2) beyond *= std::isfinite(length) ? least / 2 / length : 0;
    for (std::size_t c = 0; c < N; ++c)
      if (const double more = dot(gradients[c], beyond); std::isfinite(more)) values[c] += more;
    return false;
  }

  void evaluate_point(std::size_t i, const Vec3& x, const CellLocation& location,
                      const VolumeFieldValues& wanted) const override {
    if (!wanted.inside.empty()) wanted.inside[i] = location.inside;
    if (wanted.values.empty() && wanted.gradients.empty()) return;
    const std::size_t n = samples().components;
    const bool in_corners = !between_cells_ && !higher_.has(location.cell);
    if (location.inside && in_corners && !wanted.values.empty() && n == 3) return three_at(i, x, location, wanted);
    if (location.inside && in_corners && wanted.gradients.empty()) {
      double* const v = wanted.values.data() + i * n;
      std::fill_n(v, n, 0.0);
      for (std::size_t c = 0; c < location.corner_count; ++c) {
        const double* const of = samples().values.data() + location.corners[c] * n;
        for (std::size_t k = 0; k < n; ++k) v[k] += location.weights[c] * of[k];
      }
      return;
    }
    // Outside, the function continues a little from the nearest point.
    Vec3 beyond, at = x;
    if (!location.inside) {
      at = position_of(location);
      beyond = x - at;
      const double length = norm(beyond), most = shortest_edge(location) / 2;
      if (length > most) beyond *= std::isfinite(length) ? most / length : 0;
    }
    const std::span<double> values = wanted.values.empty() ? std::span<double>() : wanted.values.subspan(i * n, n);
    const std::span<Vec3> gradients = wanted.gradients.empty() ? std::span<Vec3>() : wanted.gradients.subspan(i * n, n);
    constexpr std::size_t kSome = 16;
    std::array<double, kSome> value_store;
    std::array<Vec3, kSome> slope_store;
    std::vector<double> more_values;
    std::vector<Vec3> more_slopes;
    std::span<double> v = values;
    std::span<Vec3> g = gradients;
    if (n <= kSome) {
      if (v.empty()) v = std::span(value_store).first(n);
      if (g.empty() && !location.inside) g = std::span(slope_store).first(n);
    } else {
      if (v.empty()) v = more_values = std::vector<double>(n);
      if (g.empty() && !location.inside) g = more_slopes = std::vector<Vec3>(n);
    }
    if (between_cells_) {
      between_cells_->evaluate(location, at, v, g);
    } else if (!in_corners) {
      static thread_local NodeWeights nodes;
      higher_.find(location, at, !g.empty(), nodes);
      for (std::size_t k = 0; k < n; ++k) {
        v[k] = nodes.value(samples(), k);
        if (!g.empty()) g[k] = nodes.gradient(samples(), k);
      }
    } else {
      std::fill(v.begin(), v.end(), 0.0);
      for (std::size_t c = 0; c < location.corner_count; ++c) {
        const auto of = samples().of(location.corners[c]);
        for (std::size_t k = 0; k < n; ++k) v[k] += location.weights[c] * of[k];
      }
      if (!g.empty()) {
        std::array<Vec3, 8> slopes;
        shape_gradients(volume(), location, x, slopes);
        std::fill(g.begin(), g.end(), Vec3{});
        for (std::size_t c = 0; c < location.corner_count; ++c) {
          const auto of = samples().of(location.corners[c]);
          for (std::size_t k = 0; k < n; ++k) g[k] += slopes[c] * of[k];
        }
      }
    }
    if (!location.inside)
      for (std::size_t k = 0; k < n; ++k)
        if (const double more = dot(g[k], beyond); std::isfinite(more)) v[k] += more;
  }

  /// Fast path for vectors inside, as used by particles.
  void three_at(std::size_t i, const Vec3& x, const CellLocation& location, const VolumeFieldValues& wanted) const {
    const double* const all = samples().values.data();
    std::array<Vec3, 8> of;
    Vec3 sum;
    for (std::size_t c = 0; c < location.corner_count; ++c) {
      const double* const f = all + std::size_t{3} * location.corners[c];
      of[c] = {f[0], f[1], f[2]};
      sum += of[c] * location.weights[c];
    }
    double* const v = wanted.values.data() + 3 * i;
    v[0] = sum.x, v[1] = sum.y, v[2] = sum.z;
    if (wanted.gradients.empty()) return;
    std::array<Vec3, 8> slopes;
    shape_gradients(volume(), location, x, slopes);
    std::array<Vec3, 3> g{};
    for (std::size_t c = 0; c < location.corner_count; ++c)
      for (std::size_t k = 0; k < 3; ++k) g[k] += slopes[c] * of[c][k];
    std::copy(g.begin(), g.end(), wanted.gradients.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }

  double shortest_edge(const CellLocation& location) const {
    double least = std::numeric_limits<double>::infinity();
    const auto corner = [&](std::size_t c) { return corner_position(volume(), location.corners[c]); };
    for (const auto& edge : cell_edges(shape_of_cell(volume(), location.cell)))
      least = std::min(least, squared_norm(corner(edge[0]) - corner(edge[1])));
    return std::sqrt(least);
  }

  std::optional<CellInterpolant> between_cells_;
  HigherOrderFunctions higher_;
};

class NearestField final : public detail::LocatedField {
 public:
  explicit NearestField(ReconstructionInput& input) : LocatedField(std::move(input.volume), std::move(input.values)) {
    if (volume().lattice) return;
    tree_ = BoxTree(volume().size(), [this](std::size_t i) {
      return Box3{volume().positions[i], volume().positions[i]};
    });
  }

 private:
  void evaluate_point(std::size_t i, const Vec3& x, const CellLocation& location,
                      const VolumeFieldValues& wanted) const override {
    if (!wanted.inside.empty()) wanted.inside[i] = location.inside;
    const std::size_t n = samples().components;
    if (!wanted.gradients.empty())
      std::fill_n(wanted.gradients.begin() + static_cast<std::ptrdiff_t>(i * n), n, Vec3{});
    if (wanted.values.empty()) return;
    const auto of = samples().of(nearest(x, location));
    std::copy(of.begin(), of.end(), wanted.values.begin() + static_cast<std::ptrdiff_t>(i * n));
  }

  std::uint32_t nearest(const Vec3& x, const CellLocation& location) const {
    std::uint32_t best = location.corners[0];
    const auto distance = [&](std::uint32_t s) { return squared_norm(volume().position(s) - x); };
    if (volume().lattice) {
      for (std::size_t c = 1; c < location.corner_count; ++c)
        if (distance(location.corners[c]) < distance(best)) best = location.corners[c];
      return best;
    }
    const std::uint32_t found = tree_.nearest(x, distance, std::numeric_limits<double>::infinity());
    return found == BoxTree::kNone ? 0 : found;
  }

  BoxTree tree_;
};

}  // namespace

static std::unique_ptr<VolumeField> make_nearest_field(ReconstructionInput input) {
  return std::make_unique<NearestField>(input);
}
static std::unique_ptr<VolumeField> make_linear_field(ReconstructionInput input) {
  return std::make_unique<LinearField>(input);
}

namespace {

constexpr VolumeMethod kLinearMethods[] = {
    {.name = "nearest",
     .summary = "the value of the nearest sample",
     .grids = "all",
     .make = make_nearest_field,
     .plain = true},
    {.name = "linear",
     .summary = "interpolation in the grid's cells: trilinear in hexahedra, barycentric in tetrahedra, by their own "
                "functions in cells of higher order",
     .grids = "all",
     .make = make_linear_field,
     .plain = true}};

}  // namespace

std::span<const VolumeMethod> linear_field_methods() { return kLinearMethods; }

}  // namespace sansmesh::inline v1
