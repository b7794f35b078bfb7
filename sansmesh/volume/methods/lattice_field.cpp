// Tensor-product reconstructions on a lattice: BC family (mitchell1988), windowed sinc, Lagrange (tejada2008, ch. 6).
// Cell data are at the cell centres: the volume extends half a step beyond the first and the last one.
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
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

/// The same for four samples in each direction, without a stride.
ValueGradient sum_of_fours(const double* f, std::size_t row, std::size_t slab, const std::array<AxisWeights, 3>& w) {
  constexpr std::size_t kFour = 4;
  double values[kFour] = {}, by_y[kFour] = {}, by_z[kFour] = {};
  for (std::size_t k = 0; k < kFour; ++k)
    for (std::size_t j = 0; j < kFour; ++j) {
      const double* const r = f + k * slab + j * row;
      const double weight = w[2].value[k] * w[1].value[j];
      const double along_y = w[2].value[k] * w[1].slope[j], along_z = w[2].slope[k] * w[1].value[j];
      for (std::size_t i = 0; i < kFour; ++i) {
        values[i] += weight * r[i];
        by_y[i] += along_y * r[i];
        by_z[i] += along_z * r[i];
      }
    }
  ValueGradient sum;
  for (std::size_t i = 0; i < kFour; ++i) {
    sum.value += w[0].value[i] * values[i];
    sum.x += w[0].slope[i] * values[i];
    sum.y += w[0].value[i] * by_y[i];
    sum.z += w[0].value[i] * by_z[i];
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
        (!wanted.gradients.empty() && wanted.gradients.size() != x.size()) ||
        (!wanted.inside.empty() && wanted.inside.size() != x.size()))
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
        if (!wanted.inside.empty()) wanted.inside[i] = 1;
      }
      if (outside.empty()) return;
      std::vector<double> values(outside.size());
      std::vector<Vec3> gradients(wanted.gradients.empty() ? 0 : outside.size());
      std::vector<std::uint8_t> within(wanted.inside.empty() ? 0 : outside.size());
      PointwiseField::evaluate(outside, {values, gradients, within});
      for (std::size_t k = 0; k < outside.size(); ++k) {
        wanted.values[of[k]] = values[k];
        if (!gradients.empty()) wanted.gradients[of[k]] = gradients[k];
        if (!within.empty()) wanted.inside[of[k]] = within[k];
      }
    });
  }

  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override {
    if constexpr (std::is_same_v<Axis, CubicAxis>)
      parallel_for(0, boxes.size(), kLatticeGrain, [&](std::size_t b) { found[b] = range_in(boxes[b]); });
    else
      PointwiseField::ranges(boxes, found);
  }

 protected:
  void evaluate_at(const Vec3& x, const CellLocation& /*location*/, double* values, Vec3* gradients) const override {
    at_axes(volume().lattice->to_axes(x), values, gradients);
  }

 private:
  /// Weights sum to 1, so values exceed those of the samples around by at most a share of their range.
  ValueRange range_in(const Box3& box) const {
    const Lattice& lattice = *volume().lattice;
    Box3 axes;
    for (int corner = 0; corner < 8; ++corner)
      axes.extend(lattice.to_axes({(corner & 1 ? box.upper : box.lower).x, (corner & 2 ? box.upper : box.lower).y,
                                   (corner & 4 ? box.upper : box.lower).z}));
    std::array<std::pair<std::size_t, std::size_t>, 3> part;
    double most = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      part[k] = axes_[k].samples_of(axes.lower[k], axes.upper[k]);
      most *= axes_[k].most_weight(axes.lower[k], axes.upper[k]);
    }
    const std::size_t n = components(), nx = axes_[0].size(), ny = axes_[1].size();
    const double* const f = samples().values.data();
    ValueRange range{f[n * (part[0].first + nx * (part[1].first + ny * part[2].first))], 0};
    range.most = range.least;
    for (std::size_t k = part[2].first; k <= part[2].second; ++k)
      for (std::size_t j = part[1].first; j <= part[1].second; ++j)
        for (std::size_t i = part[0].first; i <= part[0].second; ++i) {
          const double value = f[n * (i + nx * (j + ny * k))];
          range.least = std::min(range.least, value), range.most = std::max(range.most, value);
        }
    const double beyond = 0.5 * (most - 1) * (range.most - range.least);
    return {range.least - beyond, range.most + beyond};
  }

  void at_axes(const Vec3& a, double* values, Vec3* gradients) const {
    std::array<AxisWeights, 3> w;
    for (std::size_t k = 0; k < 3; ++k) axes_[k].weights(a[k], w[k]);
    const Lattice& lattice = *volume().lattice;
    const std::size_t n = components(), row = axes_[0].size() * n, slab = axes_[1].size() * row;
    const double* const f = samples().values.data() + w[0].first * n + w[1].first * row + w[2].first * slab;
    const bool whole = w[0].count == 4 && w[1].count == 4 && w[2].count == 4;
    for (std::size_t c = 0; c < n; ++c) {
      const ValueGradient sum = !whole   ? tensor_sum<0>(f + c, n, row, slab, w)
                                : n == 1 ? sum_of_fours(f, row, slab, w)
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
