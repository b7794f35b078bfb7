// Estimated errors of interpolation between the samples of a volume.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "sansmesh/volume/reconstruction.h"

namespace sansmesh::inline v1 {
namespace {

/// Error that is fine enough, as a share of the range, at this share of the samples.
constexpr double kFineEnough = 0.01, kFineAt = 0.99;
/// Samples with less trust do not resolve the function: the estimate is a guess.
constexpr float kResolved = 0.5F;
constexpr std::size_t kAskedAtOnce = 1 << 15;  ///< cells

/// Parameters of the points of a cell at which errors are averaged.
std::vector<Vec3> asked_in(CellShape shape) {
  std::vector<Vec3> u;
  if (shape == CellShape::tetrahedron) {
    const double a = 0.58541020, b = 0.13819660;
    return {{b, b, b}, {a, b, b}, {b, a, b}, {b, b, a}};
  }
  for (const double t : {0.21132487, 0.78867513}) {
    if (shape == CellShape::wedge) {
      for (const auto& [r, s] : {std::pair{1.0, 1.0}, std::pair{4.0, 1.0}, std::pair{1.0, 4.0}})
        u.push_back({r / 6, s / 6, t});
      continue;
    }
    for (const double s : {0.21132487, 0.78867513})
      for (const double r : {0.21132487, 0.78867513}) u.push_back({r, s, t});
  }
  return u;
}

/// The cells of a volume, also of a lattice: their samples, and points in them.
class AskedCells {
 public:
  explicit AskedCells(const SampledVolume& volume) : volume_(volume) {
    for (const CellShape s : {CellShape::tetrahedron, CellShape::hexahedron, CellShape::wedge, CellShape::pyramid})
      asked_[static_cast<std::size_t>(s)] = asked_in(s);
    if (!volume.lattice) return;
    for (std::size_t k = 0; k < 3; ++k) planes_[k] = cell_borders(*volume.lattice, k, volume.in_cells);
  }

  std::size_t size() const {
    return volume_.lattice ? (planes_[0].size() - 1) * (planes_[1].size() - 1) * (planes_[2].size() - 1)
                           : volume_.cells.size();
  }

  /// Appends the points of a cell; returns their number.
  std::size_t add_points(std::size_t cell, std::vector<Vec3>& x) const {
    const CellShape shape = volume_.lattice ? CellShape::hexahedron : volume_.cells.shapes[cell];
    const std::vector<Vec3>& asked = asked_[static_cast<std::size_t>(shape)];
    if (volume_.lattice) {
      const auto at = indices(cell);
      for (const Vec3& u : asked) {
        Vec3 a;
        for (std::size_t k = 0; k < 3; ++k)
          a[k] = planes_[k][at[k]] + u[k] * (planes_[k][at[k] + 1] - planes_[k][at[k]]);
        x.push_back(volume_.lattice->from_axes(a));
      }
      return asked.size();
    }
    std::array<double, 8> weights{};
    for (const Vec3& u : asked) {
      shape_functions(shape, u, weights);
      Vec3 sum;
      const auto corners = volume_.cells[cell];
      for (std::size_t v = 0; v < corners.size(); ++v) sum += volume_.corner(corners[v]) * weights[v];
      x.push_back(sum);
    }
    return asked.size();
  }

  /// Calls visit(sample) for the samples of a cell.
  template <class Visit>
  void each_sample(std::size_t cell, const Visit& visit) const {
    if (!volume_.lattice) {
      if (volume_.in_cells) return visit(volume_.cell_sample[cell]);
      for (const std::uint32_t k : volume_.cells[cell]) visit(k);
      return;
    }
    if (volume_.in_cells) return visit(cell);
    const auto at = indices(cell);
    const std::size_t nx = planes_[0].size(), ny = planes_[1].size();
    for (std::size_t c = 0; c < 8; ++c) visit(at[0] + (c & 1) + nx * (at[1] + (c >> 1 & 1) + ny * (at[2] + (c >> 2))));
  }

 private:
  std::array<std::size_t, 3> indices(std::size_t cell) const {
    const std::size_t nx = planes_[0].size() - 1, ny = planes_[1].size() - 1;
    return {cell % nx, cell / nx % ny, cell / (nx * ny)};
  }

  const SampledVolume& volume_;
  std::array<std::vector<double>, 3> planes_;
  std::array<std::vector<Vec3>, 4> asked_;
};

/// Means over the cells of each sample of the length of the difference of two fields.
std::vector<double> mean_differences(const SampledVolume& volume, const VolumeField& a, const VolumeField& b,
                                     Progress& progress) {
  const AskedCells cells(volume);
  const std::size_t components = a.components();
  std::vector<double> sum(volume.size(), 0.0), count(volume.size(), 0.0);
  std::vector<Vec3> x;
  std::vector<std::size_t> first;
  std::vector<double> of_a, of_b;
  progress.begin("compare degrees", (cells.size() + kAskedAtOnce - 1) / kAskedAtOnce);
  for (std::size_t begin = 0; begin < cells.size(); begin += kAskedAtOnce) {
    const std::size_t end = std::min(begin + kAskedAtOnce, cells.size());
    x.clear(), first.assign(1, 0);
    for (std::size_t c = begin; c < end; ++c) first.push_back(first.back() + cells.add_points(c, x));
    of_a.resize(x.size() * components), of_b.resize(x.size() * components);
    a.evaluate(x, {of_a});
    b.evaluate(x, {of_b});
    for (std::size_t c = begin; c < end; ++c) {
      double mean = 0;
      for (std::size_t p = first[c - begin]; p < first[c - begin + 1]; ++p) {
        double square = 0;
        for (std::size_t m = 0; m < components; ++m) {
          const double d = of_a[p * components + m] - of_b[p * components + m];
          square += d * d;
        }
        mean += std::sqrt(square) / static_cast<double>(first[c - begin + 1] - first[c - begin]);
      }
      cells.each_sample(c, [&](std::size_t i) { sum[i] += mean, count[i] += 1; });
    }
    progress.advance();
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = count[i] > 0 ? sum[i] / count[i] : 0;
  return sum;
}

/// Diagonal of the box of the values of all components.
double extent_of(const VolumeValues& values) {
  const std::size_t c = values.components;
  double square = 0;
  for (std::size_t m = 0; m < c; ++m) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = m; i < values.values.size(); i += c)
      least = std::min(least, values.values[i]), most = std::max(most, values.values[i]);
    if (least <= most) square += (most - least) * (most - least);
  }
  return std::sqrt(square);
}

void summarise(const SampledVolume& volume, const std::vector<double>& errors, ResolutionReport& r) {
  std::vector<double> sorted;
  sorted.reserve(errors.size());
  std::size_t where = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (std::isnan(errors[i])) continue;
    if (sorted.empty() || errors[i] > errors[where]) where = i;
    sorted.push_back(errors[i]);
  }
  for (const double e : sorted) r.mean += e / static_cast<double>(sorted.size());
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  r.median = at(0.5), r.high = at(kFineAt), r.most = sorted.back();
  r.most_at = volume.position(where);
  // Errors of linear interpolation fall with the square of the distance of samples.
  if (r.range > 0) r.finer = std::max(1.0, std::sqrt(r.high / (kFineEnough * r.range)));
}

}  // namespace

ResolutionResult estimate_resolution(const VolumeModel& volume, Progress& progress) {
  const std::shared_ptr<const SampledVolume> samples = volume.samples(progress);
  const std::string& array = volume.array().name;
  if (volume.choice().component || volume.choice().magnitude)
    throw ArgumentError(fmt::format("`array`: the errors are those of whole vectors: {}", printable(array, 60)));
  ResolutionResult result;
  ResolutionReport& r = result.report;
  r.array = array;
  VolumeReconstructionOptions options;
  options.method = "mls-detail", options.logarithm = false;
  options.smoothing = volume.options().reconstruction.smoothing;
  options.cell_values = volume.options().reconstruction.cell_values;
  std::vector<double> errors = with_name(volume.name(), [&] {
    VolumeReconstructionReport fit;
    ReconstructionCoefficients coefficients;
    reconstruct_volume(samples, array, options, progress, &fit, &coefficients);
    const std::vector<float> trust(coefficients.polynomials.trust.begin(), coefficients.polynomials.trust.end());
    const auto doubtful = std::count_if(trust.begin(), trust.end(), [](float t) { return t < kResolved; });
    r.unresolved = static_cast<double>(doubtful) / static_cast<double>(trust.size());
    // Full trust: where polynomials disagree, their difference to linear interpolation still estimates its error.
    coefficients.polynomials.trust = std::vector<float>(trust.size(), 1.0F);
    const auto high = reconstruct_volume(samples, array, fit.options, progress, nullptr, &coefficients);
    VolumeReconstructionOptions plain;
    plain.method = "linear", plain.smoothing = fit.options.smoothing;
    const auto low = reconstruct_volume(samples, array, plain, progress);
    return mean_differences(*samples, *high, *low, progress);
  });
  // Samples without a value have no error.
  const VolumeValues values = volume_values(*samples, array);
  for (const std::uint32_t i : values.filled) errors[i] = std::numeric_limits<double>::quiet_NaN();
  r.range = extent_of(values);
  summarise(*samples, errors, r);
  auto made = std::make_shared<SampledVolume>(*samples);
  made->attributes.clear();
  made->attributes.set("error", errors);
  result.samples = std::move(made);
  if (3 * r.unresolved > 1)
    result.notes.push_back({.code = "unresolved",
                            .text = fmt::format("at {:.0f} % of the samples polynomials of neighbours disagree: the "
                                                "errors there are estimated roughly, and finer samples may show more",
                                                100 * r.unresolved),
                            .severity = Note::Severity::information,
                            .of = volume.name()});
  return result;
}

void write_resolution(const std::string& file, const ResolutionResult& resolution) {
  SmoothVolumeResult as_samples;
  as_samples.samples = resolution.samples;
  write_smoothed(file, as_samples);
}

VolumeModel resolution_volume(const ResolutionResult& resolution, const std::string& name) {
  const SampledVolume& v = *resolution.samples;
  GridBlock block;
  AttributeTable& arrays = v.in_cells ? block.cell_arrays : block.point_arrays;
  arrays = v.attributes;
  if (v.lattice) {
    block.kind = GridKind::lattice;
    block.origin = v.lattice->origin, block.directions = v.lattice->directions;
    for (std::size_t k = 0; k < 3; ++k) block.axes[k] = cell_borders(*v.lattice, k, v.in_cells);
  } else {
    block.points = v.corners.empty() ? v.positions : v.corners;
    block.cells = v.cells;
    if (v.in_cells) arrays = v.attributes.taken(v.cell_sample);
  }
  GridData data;
  data.blocks.push_back(std::move(block));
  VolumeModelOptions options;
  options.reconstruction.method = "linear", options.reconstruction.smoothing = 0;
  return {std::move(data), name, options};
}

std::vector<std::string> summary_of(const ResolutionReport& r) {
  const auto share = [&](double error) {
    return r.range > 0 ? fmt::format("{:.3g} ({:.2g} % of the range)", error, 100 * error / r.range)
                       : fmt::format("{:.3g}", error);
  };
  std::vector<std::string> lines{
      titled("resolution",
             fmt::format("{}: estimated error of linear interpolation {} on average, median {:.3g}",
                         printable(r.array, 60), share(r.mean), r.median),
             12),
      titled("", fmt::format("99 % below {}, largest {:.3g} at {}", share(r.high), r.most, point_words(r.most_at, 6)),
             12)};
  lines.push_back(titled("",
                         r.finer > 1
                             ? fmt::format("samples {:.2g} times as dense along each axis would reach 1 %", r.finer)
                             : std::string("fine enough for 1 % of the range"),
                         12));
  return lines;
}

const ReportSchema& ResolutionReport::schema() {
  using R = ResolutionReport;
  static constexpr ReportRow rows[] = {
      reported<&R::array>({.text = "Array"}),
      reported<&R::range>({.text = "Range of its values; of vectors the diagonal of their box", .unit = "value"}),
      reported<&R::mean>({.text = "Estimated error of linear interpolation, mean over the samples", .unit = "value"}),
      reported<&R::median>({.text = "Median of the estimated errors", .unit = "value"}),
      reported<&R::high>({.text = "Estimated error that 99 % of the samples do not exceed", .unit = "value"}),
      reported<&R::most>({.text = "Largest estimated error", .unit = "value"}),
      reported<&R::most_at>({.text = "Sample with the largest estimated error", .unit = "length"}),
      reported<&R::unresolved>({.text = "Share of samples at which polynomials disagree", .unit = "share"}),
      reported<&R::finer>({.text = "Factor of the samples per length at which 99 % have an error of at most 1 % of the "
                                   "range; 1 if they have"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
