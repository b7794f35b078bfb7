// Cubic splines in Bernstein–Bézier form on tetrahedra (lai2007; tejada2008, ch. 6).
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/volume/cells/axis_interval.h"
#include "sansmesh/volume/cells/cell_tetrahedra.h"
#include "sansmesh/volume/grid/corner_volume.h"
#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/axis_weights.h"
#include "sansmesh/volume/samples/sample_gradients.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace detail {
namespace {

/// Evaluates one tetrahedron from values and gradients at its corners, barycentric coordinates and their gradients
/// (`gradient` null: not requested).
double bernstein_cubic(std::span<const Vec3, 4> corners, std::span<const double, 4> values,
                       std::span<const Vec3, 4> slopes, std::span<const double, 4> barycentric,
                       std::span<const Vec3, 4> barycentric_gradients, Vec3* gradient) {
  const auto& l = barycentric;
  double value = 0;
  std::array<double, 4> by{};  // derivatives by the barycentric coordinates
  double edge[4][4] = {};      // edge[i][j]: control value on the edge from i to j, next to i
  for (std::size_t i = 0; i < 4; ++i) {
    value += l[i] * l[i] * l[i] * values[i];
    by[i] += 3 * l[i] * l[i] * values[i];
    for (std::size_t j = 0; j < 4; ++j) {
      if (j == i) continue;
      edge[i][j] = values[i] + dot(slopes[i], corners[j] - corners[i]) / 3;
      value += 3 * l[i] * l[i] * l[j] * edge[i][j];
      by[i] += 6 * l[i] * l[j] * edge[i][j];
      by[j] += 3 * l[i] * l[i] * edge[i][j];
    }
  }
  for (std::size_t without = 0; without < 4; ++without) {
    const std::size_t i = without == 0 ? 1 : 0, j = without <= 1 ? 2 : 1, k = without == 3 ? 2 : 3;
    const double face = (edge[i][j] + edge[j][i] + edge[j][k] + edge[k][j] + edge[k][i] + edge[i][k]) / 4 -
                        (values[i] + values[j] + values[k]) / 6;
    value += 6 * l[i] * l[j] * l[k] * face;
    by[i] += 6 * l[j] * l[k] * face;
    by[j] += 6 * l[i] * l[k] * face;
    by[k] += 6 * l[i] * l[j] * face;
  }
  if (gradient) {
    *gradient = {};
    for (std::size_t i = 0; i < 4; ++i) *gradient += barycentric_gradients[i] * by[i];
  }
  return value;
}

/// A cubic on each tetrahedron by 20 control values from the samples and their gradients
/// (docs/methods/volume-baselines.md). Control values on a face depend only on the face: the spline is continuous, with
/// continuous derivatives at samples and along edges but not quite across faces. Quadratic functions are reproduced
/// where the gradients are exact for them (sample_gradients.h). Other cells are split into tetrahedra
/// (cell_tetrahedra.h); cell data are converted to corner values (corner_volume.h).
class BernsteinTetrahedra final : public PointwiseField {
 public:
  BernsteinTetrahedra(std::shared_ptr<const SampledVolume> tetrahedra, VolumeValues values, std::vector<Vec3> slopes)
      : PointwiseField(std::move(tetrahedra), std::move(values)), slopes_(std::move(slopes)) {}

 protected:
  void evaluate_at(const Vec3& x, const CellLocation& location, double* values, Vec3* gradients) const override {
    std::array<Vec3, 4> corners, slopes, barycentric_gradients{};
    std::array<double, 4> f, weights;
    std::array<Vec3, 8> shape{};
    if (gradients) shape_gradients(volume(), location, x, shape);
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = volume().positions[location.corners[k]];
      weights[k] = location.weights[k];
      barycentric_gradients[k] = shape[k];
    }
    const std::size_t n = components();
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t k = 0; k < 4; ++k) {
        f[k] = samples().values[location.corners[k] * n + c];
        slopes[k] = slopes_[location.corners[k] * n + c];
      }
      values[c] =
          bernstein_cubic(corners, f, slopes, weights, barycentric_gradients, gradients ? gradients + c : nullptr);
    }
  }

 private:
  std::vector<Vec3> slopes_;
};

/// The same on a lattice, without storage besides the samples.
class BernsteinLattice final : public PointwiseField {
 public:
  BernsteinLattice(std::shared_ptr<const SampledVolume> sampled, VolumeValues values)
      : PointwiseField(std::move(sampled), std::move(values)) {
    const Lattice& lattice = *volume().lattice;
    for (std::size_t k = 0; k < 3; ++k) axes_[k] = CubicAxis(lattice.axes[k], lattice.uniform, 0, 0.5);
  }

 protected:
  void evaluate_at(const Vec3& x, const CellLocation& /*location*/, double* values, Vec3* gradients) const override {
    const Lattice& lattice = *volume().lattice;
    const Vec3 a = lattice.to_axes(x);
    std::array<std::size_t, 3> at, order{0, 1, 2};
    Vec3 u, h;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& axis = lattice.axes[k];
      at[k] = interval_of(axis, lattice.uniform, a[k]);
      h[k] = axis[at[k] + 1] - axis[at[k]];
      u[k] = std::clamp((a[k] - axis[at[k]]) / h[k], 0.0, 1.0);
    }
    // From the cell's first corner to its last, along the axes in the order of descending coordinates.
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return u[i] != u[j] ? u[i] > u[j] : i < j; });
    std::array<std::array<std::size_t, 3>, 4> corner;
    std::array<Vec3, 4> corners, slopes, barycentric_gradients{};
    std::array<double, 4> f, weights;
    corner[0] = at;
    weights[0] = 1 - u[order[0]];
    barycentric_gradients[0][order[0]] = -1 / h[order[0]];
    for (std::size_t k = 1; k < 4; ++k) {
      const std::size_t along = order[k - 1];
      corner[k] = corner[k - 1];
      ++corner[k][along];
      weights[k] = u[along] - (k < 3 ? u[order[k]] : 0);
      barycentric_gradients[k][along] = 1 / h[along];
      if (k < 3) barycentric_gradients[k][order[k]] = -1 / h[order[k]];
    }
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t d = 0; d < 3; ++d) corners[k][d] = lattice.axes[d][corner[k][d]];
    const std::size_t n = components();
    const std::size_t step[] = {n, n * lattice.axes[0].size(), n * lattice.axes[0].size() * lattice.axes[1].size()};
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t k = 0; k < 4; ++k) {
        const double* const here =
            samples().values.data() + corner[k][0] * step[0] + corner[k][1] * step[1] + corner[k][2] * step[2] + c;
        f[k] = *here;
        for (std::size_t d = 0; d < 3; ++d) slopes[k][d] = slope(axes_[d], corner[k][d], here, step[d]);
      }
      Vec3 gradient;
      values[c] = bernstein_cubic(corners, f, slopes, weights, barycentric_gradients, gradients ? &gradient : nullptr);
      if (gradients)
        gradients[c] = lattice.directions[0] * gradient.x + lattice.directions[1] * gradient.y +
                       lattice.directions[2] * gradient.z;
    }
  }

 private:
  /// Slope along an axis at the knot with the sample `here`.
  static double slope(const CubicAxis& axis, std::size_t knot, const double* here, std::size_t step) {
    std::size_t first = 0;
    const auto& weights = axis.slope_at(knot, first);
    double sum = 0;
    for (std::size_t j = 0; j < std::min<std::size_t>(3, axis.size()); ++j)
      sum += weights[j] * here[static_cast<std::ptrdiff_t>(step) *
                               (static_cast<std::ptrdiff_t>(first + j) - static_cast<std::ptrdiff_t>(knot))];
    return sum;
  }

  std::array<CubicAxis, 3> axes_;
};

}  // namespace

}  // namespace detail

static std::unique_ptr<VolumeField> make_bernstein_field(ReconstructionInput input) {
  using namespace detail;
  CornerSamples corners = corner_samples(std::move(input.volume), std::move(input.values));
  if (corners.volume->lattice)
    return std::make_unique<BernsteinLattice>(std::move(corners.volume), std::move(corners.values));
  std::vector<Vec3> slopes = sample_gradients(*corners.volume, corners.values);
  return std::make_unique<BernsteinTetrahedra>(tetrahedra_of(corners.volume).volume, std::move(corners.values),
                                               std::move(slopes));
}

namespace {

constexpr VolumeMethod kBernsteinMethods[] = {{.name = "bernstein",
                                               .summary = "cubic splines in Bernstein–Bézier form on tetrahedra",
                                               .grids = "all",
                                               .make = make_bernstein_field}};

}  // namespace

std::span<const VolumeMethod> bernstein_field_methods() { return kBernsteinMethods; }

}  // namespace sansmesh::inline v1
