#include "sansmesh/volume/reconstruction.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/median.h"
#include "sansmesh/field/scaled_volume.h"
#include "sansmesh/volume/choose_reconstruction.h"
#include "sansmesh/volume/reconstruction_makers.h"

namespace sansmesh {
namespace {

struct Entry {
  ReconstructionInfo info;
  std::unique_ptr<VolumeField> (*make)(ReconstructionInput) = nullptr;
};

using Method = ReconstructionMethod;

constexpr std::string_view word_of(Method method) { return kReconstructionWords[static_cast<std::size_t>(method)]; }

/// One entry a method, in the order of the enumerators.
const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {
      // nearest
      {{Method::nearest, word_of(Method::nearest), "the value of the nearest sample", "all", {}},  //
       make_nearest_field},

      // linear
      {{Method::linear,
        word_of(Method::linear),
        "the grid's own: trilinear in hexahedra, barycentric in tetrahedra",
        "all",
        {}},  //
       make_linear_field},

      // shepard
      {{Method::shepard,
        word_of(Method::shepard),
        "inverse squared distances of the samples around",
        "all",
        {"radius"}},  //
       make_shepard_field},

      // sibson
      {{Method::sibson, word_of(Method::sibson), "natural neighbours: volumes taken from Voronoi cells", "all", {}},  //
       make_sibson_field},

      // mean-value
      {{Method::mean_value,
        word_of(Method::mean_value),
        "mean value coordinates in the cell, convex or not",
        "all",
        {}},  //
       make_mean_value_field},

      // cubic
      {{Method::cubic,
        word_of(Method::cubic),
        "piecewise cubics of the BC family: Catmull–Rom, B-spline and between",
        "uniform and rectilinear",
        {"b", "c"}},  //
       make_cubic_field},

      // sinc
      {{Method::sinc, word_of(Method::sinc), "windowed sinc, eight samples in each direction", "uniform", {}},  //
       make_sinc_field},

      // lagrange
      {{Method::lagrange,
        word_of(Method::lagrange),
        "polynomials through samples in each direction",
        "uniform and rectilinear",
        {"degree"}},  //
       make_lagrange_field},

      // rbf
      {{Method::rbf, word_of(Method::rbf), "radial basis functions of compact support, blended", "all", {"radius"}},  //
       make_rbf_field},

      // bernstein
      {{Method::bernstein,
        word_of(Method::bernstein),
        "cubic splines in Bernstein–Bézier form on tetrahedra",
        "all",
        {}},  //
       make_bernstein_field},

      // mls
      {{Method::mls,
        word_of(Method::mls),
        "moving least squares about each point, ellipsoidal weights",
        "all",
        {"degree", "radius"}},
       make_mls_field},

      // mls-detail
      {{Method::mls_detail,
        word_of(Method::mls_detail),
        "robust polynomials about samples, of the degree that predicts best, blended",
        "all",
        {"degree", "robust"}},
       make_mls_detail_field},

      // amls
      {{Method::amls,
        word_of(Method::amls),
        "approximate moving least squares: ellipsoidal, normalised, iterated; the fastest smooth one",
        "all",
        {"iterations", "shape", "order", "spherical"}},
       make_amls_field},
  };
  return all;
}

/// Options that are set and that the method does not heed.
void check_heeded(const ReconstructionOptions& options, const ReconstructionInfo& info) {
  std::vector<std::string_view> set = options_set(options);
  std::erase(set, "method");
  check_used(set, info.options, set, fmt::format("the reconstruction {}", info.name));
  const bool lagrange = info.method == ReconstructionMethod::lagrange;
  if (options.degree) check_range("degree", *options.degree, lagrange ? 1 : 0, lagrange ? 5 : 4);
}

const Entry& entry_of(ReconstructionMethod method) { return entries()[static_cast<std::size_t>(method)]; }

template <class... Arrays>
std::size_t bytes_in(const Arrays&... arrays) {
  return (std::size_t{0} + ... + (arrays.size() * sizeof(arrays[0])));
}

std::size_t bytes_of_samples(const SampledVolume& v) {
  std::size_t sum = bytes_in(v.positions, v.cells.shapes, v.cells.corners, v.cells.first, v.corners, v.cell_sample,
                             v.stars.entries, v.stars.first, v.part, v.block, v.level);
  for (const Attribute& a : v.attributes)
    sum += std::visit([](const auto& values) { return bytes_in(values); }, a.values);
  if (v.lattice)
    for (const auto& axis : v.lattice->axes) sum += bytes_in(axis);
  constexpr std::size_t kLocated = 40;  // the boxes of the locator's tree, and their order, a cell
  return sum + kLocated * v.cells.size();
}

std::size_t bytes_of_coefficients(const ReconstructionCoefficients& c) {
  const LocalPolynomials& p = c.polynomials;
  return bytes_in(p.metrics, p.constants, p.degrees, p.first, p.coefficients, p.trust, c.radii);
}

/// Values that become smaller by `scale`, for a method whose coefficients are floats. Throws DataError where a few
/// numbers stand apart that are so much larger than the rest that floats lose this beside them. What falls off to
/// nothing by itself may be lost.
void check_not_lost(const VolumeValues& values, double scale, std::string_view method) {
  constexpr double kLost = 0x1p-120, kApart = 0x1p-60;
  constexpr std::size_t kLooked = 100'000;
  const std::size_t n = values.components, rows = values.values.size() / n, stride = 1 + rows / kLooked;
  std::vector<double> away, component;
  for (std::size_t k = 0; k < n; ++k) {
    component.clear();
    for (std::size_t i = 0; i < rows; i += stride) component.push_back(values.values[i * n + k]);
    away.resize(component.size(), 0.0);
    const double middle = median(component);
    for (std::size_t r = 0; r < away.size(); ++r)
      away[r] = std::max(away[r], std::abs(values.values[r * stride * n + k] - middle));
  }
  std::erase(away, 0.0);
  if (away.empty()) return;
  const double rest = median(away);
  if (rest * scale >= kLost || rest < kLost) return;
  const double most = largest_value(values);
  if (std::any_of(away.begin(), away.end(), [&](double a) { return a >= kLost * most && a < kApart * most; })) return;
  throw DataError(
      fmt::format("array '{}': values of up to {:.4g} stand so far apart from the rest, which spans about {:.4g}, that "
                  "{} loses it beside them: say what stands for missing values (`fill_values`), or choose the method "
                  "linear",
                  printable(values.name, 60), most, rest, method));
}

}  // namespace

std::span<const ReconstructionInfo> reconstruction_methods() {
  static const std::vector<ReconstructionInfo> there = [] {
    std::vector<ReconstructionInfo> infos;
    for (const Entry& entry : entries()) infos.push_back(entry.info);
    return infos;
  }();
  return there;
}

const ReconstructionInfo& info_of(ReconstructionMethod method) { return entry_of(method).info; }

ReconstructionMethod reconstruction_of_name(std::string_view name) {
  std::string names;
  for (const ReconstructionInfo& info : reconstruction_methods()) {
    if (info.name == name) return info.method;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw ArgumentError("there is no reconstruction '" + printable(name, 60) + "'; those there are: " + names);
}

std::unique_ptr<VolumeField> reconstruct_volume(std::shared_ptr<const SampledVolume> volume, const std::string& array,
                                                const ReconstructionOptions& options, Progress& progress,
                                                ReconstructionReport* report,
                                                ReconstructionCoefficients* coefficients) {
  options.validate();
  if (options.method) check_heeded(options, info_of(*options.method));
  ReconstructionReport own;
  ReconstructionReport& told = report ? *report : own;
  told = {};
  told.options = options;
  VolumeValues values = volume_values(*volume, array);
  if (!options.method) {
    ReconstructionChoice suited = choose_reconstruction(*volume, measure_volume_traits(*volume, values, progress));
    told.options.method = suited.method, told.why = std::move(suited.why);
  }
  const Entry& entry = entry_of(*told.options.method);
  if (!values.filled.empty())
    told.notes.push_back(fmt::format("{} of {} samples have no finite value: filled in from their neighbours",
                                     values.filled.size(), volume->size()));
  ReconstructionCoefficients own_coefficients;
  ReconstructionCoefficients& used = coefficients ? *coefficients : own_coefficients;
  const std::size_t bytes = bytes_of_samples(*volume) + values.values.size() * sizeof(double);
  // Coefficients and kernels are in float, squares in double: values far from 1 are brought there, and back.
  std::vector<double> factors = used.empty() ? value_scales(values) : used.scales;
  if (!factors.empty() && factors[0] < 1 && has_coefficients(entry.info.method))
    check_not_lost(values, factors[0], entry.info.name);
  values = scaled_values(std::move(values), factors);
  std::unique_ptr<VolumeField> field =
      entry.make({std::move(volume), std::move(values), told.options, progress, told, used});
  if (!used.empty()) used.scales = factors;
  told.bytes = bytes + bytes_of_coefficients(used);
  if (factors.empty()) return field;
  for (double& f : factors) f = 1 / f;
  return std::make_unique<ScaledVolume>(std::move(field), std::move(factors));
}

}  // namespace sansmesh
