// Tensor-product reconstructions on a lattice: BC family (mitchell1988), windowed sinc, Lagrange (tejada2008, ch. 6).
// Cell data are at the cell centres: the volume extends half a step beyond the first and the last one.
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/axis_weights.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace detail {
namespace {

constexpr std::size_t kLatticeGrain = 512;

struct ValueGradient {
  double value = 0, x = 0, y = 0, z = 0;
};

/// Rows of NX samples whose components are `stride` numbers apart. NX = 0: the number is that of w.
template <std::size_t NX>
ValueGradient tensor_sum(const double* f, std::size_t stride, std::size_t row, std::size_t slab,
                         const std::array<AxisWeights, 3>& w) {
  const std::size_t nx = NX ? NX : w[0].count, ny = NX ? NX : w[1].count, nz = NX ? NX : w[2].count;
  ValueGradient sum;
  for (std::size_t k = 0; k < nz; ++k) {
    double value = 0, by_x = 0, by_y = 0;
    for (std::size_t j = 0; j < ny; ++j) {
      const double* const r = f + k * slab + j * row;
      double line = 0, slope = 0;
      for (std::size_t i = 0; i < nx; ++i)
        line += w[0].value[i] * r[i * stride], slope += w[0].slope[i] * r[i * stride];
      value += w[1].value[j] * line;
      by_x += w[1].value[j] * slope;
      by_y += w[1].slope[j] * line;
    }
    sum.value += w[2].value[k] * value;
    sum.x += w[2].value[k] * by_x;
    sum.y += w[2].value[k] * by_y;
    sum.z += w[2].slope[k] * value;
  }
  return sum;
}

template <class Axis>
class LatticeField final : public PointwiseField {
 public:
  LatticeField(std::shared_ptr<const SampledVolume> sampled, VolumeValues values, std::array<Axis, 3> axes)
      : PointwiseField(std::move(sampled), std::move(values)), axes_(std::move(axes)) {}

  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    if (components() != 1 || wanted.values.size() != x.size() ||
        (!wanted.gradients.empty() && wanted.gradients.size() != x.size()) || !wanted.inside.empty())
      return PointwiseField::evaluate(x, wanted);
    // Fast path for pictures: a value and its gradient at many points.
    const Lattice& lattice = *volume().lattice;
    parallel_ranges(0, x.size(), kLatticeGrain, [&](std::size_t first, std::size_t last) {
      const double slack = 1e-9 * bounds().diagonal();  // the locator's tolerance
      std::vector<Vec3> outside;
      std::vector<std::size_t> of;
      for (std::size_t i = first; i < last; ++i) {
        const Vec3 a = lattice.to_axes(x[i]);
        bool inside = is_finite(x[i]);
        for (std::size_t k = 0; k < 3; ++k)
          inside = inside && a[k] >= lattice.lower[k] - slack && a[k] <= lattice.upper[k] + slack;
        if (!inside) {
          outside.push_back(x[i]), of.push_back(i);
          continue;
        }
        Vec3 gradient;
        at_axes(a, &wanted.values[i], &gradient);
        if (!wanted.gradients.empty()) wanted.gradients[i] = gradient;
      }
      if (outside.empty()) return;
      std::vector<double> values(outside.size());
      std::vector<Vec3> gradients(wanted.gradients.empty() ? 0 : outside.size());
      PointwiseField::evaluate(outside, {values, gradients});
      for (std::size_t k = 0; k < outside.size(); ++k) {
        wanted.values[of[k]] = values[k];
        if (!gradients.empty()) wanted.gradients[of[k]] = gradients[k];
      }
    });
  }

 protected:
  void evaluate_at(const Vec3& x, const CellLocation& /*location*/, double* values, Vec3* gradients) const override {
    at_axes(volume().lattice->to_axes(x), values, gradients);
  }

 private:
  void at_axes(const Vec3& a, double* values, Vec3* gradients) const {
    std::array<AxisWeights, 3> w;
    for (std::size_t k = 0; k < 3; ++k) axes_[k].weights(a[k], w[k]);
    const Lattice& lattice = *volume().lattice;
    const std::size_t n = components(), row = axes_[0].size() * n, slab = axes_[1].size() * row;
    const double* const f = samples().values.data() + w[0].first * n + w[1].first * row + w[2].first * slab;
    const bool whole = w[0].count == 4 && w[1].count == 4 && w[2].count == 4;
    for (std::size_t c = 0; c < n; ++c) {
      const ValueGradient sum = !whole   ? tensor_sum<0>(f + c, n, row, slab, w)
                                : n == 1 ? tensor_sum<4>(f, 1, row, slab, w)
                                         : tensor_sum<4>(f + c, n, row, slab, w);
      values[c] = sum.value;
      if (gradients)
        gradients[c] = lattice.directions[0] * sum.x + lattice.directions[1] * sum.y + lattice.directions[2] * sum.z;
    }
  }

  std::array<Axis, 3> axes_;
};

const Lattice& lattice_of(const SampledVolume& volume, const char* method, bool uniform) {
  if (!volume.lattice || (uniform && !volume.lattice->uniform))
    throw ArgumentError(std::string("`method = ") + method + "` needs a " +
                        (uniform ? "uniform grid" : "uniform or rectilinear grid"));
  return *volume.lattice;
}

/// Makes the field, with one axis object per set of coordinates.
template <class Axis, class MakeAxis>
std::unique_ptr<VolumeField> lattice_field(ReconstructionInput& input, const MakeAxis& make) {
  const Lattice& lattice = *input.volume->lattice;
  std::array<Axis, 3> axes{make(lattice.axes[0]), make(lattice.axes[1]), make(lattice.axes[2])};
  return std::make_unique<LatticeField<Axis>>(std::move(input.volume), std::move(input.values), std::move(axes));
}

}  // namespace
}  // namespace detail

static std::unique_ptr<VolumeField> make_cubic_field(ReconstructionInput input) {
  const Lattice& lattice = detail::lattice_of(*input.volume, "cubic", false);
  return detail::lattice_field<detail::CubicAxis>(input, [&](std::span<const double> knots) {
    return detail::CubicAxis(knots, lattice.uniform, input.options.b, input.options.c);
  });
}

static std::unique_ptr<VolumeField> make_sinc_field(ReconstructionInput input) {
  detail::lattice_of(*input.volume, "sinc", true);
  return detail::lattice_field<detail::SincAxis>(input,
                                                 [](std::span<const double> knots) { return detail::SincAxis(knots); });
}

static std::unique_ptr<VolumeField> make_lagrange_field(ReconstructionInput input) {
  constexpr int kDegree = 3;
  const Lattice& lattice = detail::lattice_of(*input.volume, "lagrange", false);
  const int degree = input.report.options.degree.emplace(input.options.degree.value_or(kDegree));
  check_range("degree", degree, 1, 5);
  return detail::lattice_field<detail::LagrangeAxis>(
      input, [&](std::span<const double> knots) { return detail::LagrangeAxis(knots, lattice.uniform, degree); });
}

namespace {

constexpr std::string_view kCubicUses[] = {"b", "c"};
constexpr std::string_view kLagrangeUses[] = {"degree"};
constexpr VolumeMethod kLatticeMethods[] = {
    {.name = "cubic",
     .summary = "piecewise cubics of the BC family: Catmull–Rom, B-spline and between",
     .grids = "uniform and rectilinear",
     .make = make_cubic_field,
     .uses = kCubicUses},
    {.name = "sinc",
     .summary = "windowed sinc, eight samples in each direction",
     .grids = "uniform",
     .make = make_sinc_field},
    {.name = "lagrange",
     .summary = "polynomials through samples in each direction",
     .grids = "uniform and rectilinear",
     .make = make_lagrange_field,
     .uses = kLagrangeUses}};

}  // namespace

std::span<const VolumeMethod> lattice_field_methods() { return kLatticeMethods; }

}  // namespace sansmesh::inline v1
