// Benchmark of the smoothing of noisy volumes: errors at the samples and between them, in deviations of the noise.
//
//   benchmark_volume_noise [OPTION...]
//
//   --grids=A,B    uniform, rectilinear, bent, tets, amr, blocks, scattered; those with -cells have samples in cells;
//                  default: all
//   --noise=A,B    deviations, as a percentage of the range of the values; default: 1,2,5,15
//   --size=N       points per axis; default: 24
//   --detail       prints estimates of the noise, and CPU seconds
//
// A ball with the value 1 in 0 has flat parts (three spacings and more from its surface) and the step (within 1.5
// spacings); f3 of the thesis is the curved part. Beside the samples themselves and interpolation (linear, mls-detail
// without smoothing) stand a plain quadratic moving least squares fit of the 120 nearest samples, and the kernels of
// VTK's point interpolation: Gaussian (radius 3 spacings, sharpness 2) and quintic SPH (step of one spacing).
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_inputs.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "sansmesh/volume/samples/centre_fit.h"
#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume/samples/smooth_samples.h"
#include "thesis_functions.h"
#include "timing.h"
#include "volume/volume_grids.h"

namespace {

using namespace sansmesh;
using benchmark::split, benchmark::points_inside;

enum Part { kFlat, kStep, kCurved, kOther };
constexpr std::array<const char*, 3> kPartNames{"flat", "step", "curved"};

GridData grid_of(std::string_view name, std::size_t n) {
  const auto zero = [](const Vec3&) { return 0.0; };
  if (name == "uniform") return test::lattice_grid({n, n, n}, zero);
  if (name == "rectilinear") return test::stretched_grid({n, n, n}, zero, 1.06);
  if (name == "bent") return test::bent_grid({n, n, n}, zero);
  if (name == "tets") return test::tetrahedra_grid({n, n, n}, zero);
  if (name == "amr") return test::two_level_amr(n / 4 * 4, zero);
  if (name == "blocks") return test::three_overlapping_blocks(n * 2 / 3, zero);
  if (name == "scattered") return test::scattered_grid(n * n * n, zero);
  fmt::print(stderr, "no grid {}\n", name);
  std::exit(2);
}

/// Values without noise, and the part of each position, in coordinates normalised by the box.
struct Truth {
  bool step = false;
  Box3 box;
  double spacing = 1, scale = 1, offset = 0;

  double distance(const Vec3& x) const { return norm(x - box.center()) - 0.3 * box.size().x; }
  double value(const Vec3& x) const {
    if (step) return distance(x) < 0 ? 1 : 0;
    Vec3 u = x - box.lower;
    for (std::size_t k = 0; k < 3; ++k) u[k] /= box.size()[k];
    return (benchmark::f3(u) - offset) * scale;
  }
  Part part(const Vec3& x) const {
    if (!step) return kCurved;
    const double d = std::abs(distance(x)) / spacing;
    return d < 1.5 ? kStep : d > 3 ? kFlat : kOther;
  }
};

/// Root mean squares of the errors by part.
std::array<double, 3> errors_of(const std::vector<double>& values, const std::vector<Vec3>& x, const Truth& truth) {
  std::array<double, 4> sums{}, counts{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double e = values[i] - truth.value(x[i]);
    sums[truth.part(x[i])] += e * e, ++counts[truth.part(x[i])];
  }
  std::array<double, 3> result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = counts[k] > 0 ? std::sqrt(sums[k] / counts[k]) : NAN;
  return result;
}

/// A weighted polynomial of the samples within a radius, or of the `nearest`, at each position.
template <class Weight>
std::vector<double> plain_fit(const KdTree& tree, const std::vector<Vec3>& samples, const std::vector<double>& f,
                              const std::vector<Vec3>& at, double radius, std::size_t nearest, int degree,
                              const Weight& weight) {
  std::vector<double> result(at.size());
  parallel_ranges(0, at.size(), 256, [&](std::size_t begin, std::size_t end) {
    CentreFit fit;
    std::vector<Vec3> u;
    std::vector<double> weights;
    std::vector<Neighbour> found;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f q(at[i]);
      if (nearest == 0) tree.within(q, static_cast<float>(radius), found);
      if (nearest > 0 || found.empty()) {
        found.resize(std::max<std::size_t>(nearest, 1));
        found.resize(tree.nearest(q, found));
      }
      double reach = radius;
      if (nearest > 0) {
        reach = 0;
        for (const Neighbour& s : found) reach = std::max(reach, norm(samples[s.index] - at[i]));
        reach *= 1.001;
      }
      u.clear(), weights.clear();
      for (const Neighbour& s : found) {
        u.push_back((samples[s.index] - at[i]) / reach);
        weights.push_back(weight(norm(u.back())));
      }
      fit.place(u), fit.weigh(weights);
      const auto l = fit.coefficients(degree);
      for (std::size_t j = 0; j < l.size(); ++j) result[i] += l[j] * f[found[j].index];
    }
  });
  return result;
}

struct Options {
  std::vector<std::string> grids = split(
      "uniform,uniform-cells,rectilinear,rectilinear-cells,bent,bent-cells,tets,tets-cells,amr,amr-cells,blocks,"
      "blocks-cells,scattered");
  std::vector<std::string> noise = split("1,2,5,15");
  std::size_t size = 24;
  bool detail = false;
};

class Row {
 public:
  Row(std::string name, SampledVolume volume, double sigma, bool step, bool detail)
      : name_(std::move(name)), sigma_(sigma), detail_(detail) {
    truth_.step = step, truth_.box = volume.bounds(), truth_.spacing = volume.facts.median_spacing;
    for (std::size_t i = 0; i < volume.size(); ++i) at_.push_back(volume.position(i));
    if (!step) {
      double least = INFINITY, most = -INFINITY;
      for (const Vec3& x : at_) least = std::min(least, truth_.value(x)), most = std::max(most, truth_.value(x));
      truth_.offset = least, truth_.scale = 1 / (most - least);
    }
    std::mt19937 random(4711);
    std::normal_distribution<double> normal;
    for (const Vec3& x : at_) f_.push_back(truth_.value(x) + sigma * normal(random));
    volume.attributes.set("f", f_);
    volume_ = std::make_shared<const SampledVolume>(std::move(volume));
    between_ = points_inside(*volume_, 20000);
  }

  void measure() {
    add("samples", f_, {});
    for (const char* method : {"linear", "mls-detail"}) add_field(method, method, 0.0);
    const std::vector<Vec3f> points(at_.begin(), at_.end());
    const KdTree tree(points);
    const double h = truth_.spacing;
    const auto plain = [&](const char* what, double radius, std::size_t nearest, int degree, const auto& weight) {
      add(what, plain_fit(tree, at_, f_, at_, radius, nearest, degree, weight),
          plain_fit(tree, at_, f_, between_, radius, nearest, degree, weight));
    };
    plain("quadratic 120", 0, 120, 2, [](double t) { return std::exp(-2 * t * t); });
    plain("gaussian", 3 * h, 0, 0, [](double t) { return std::exp(-4 * t * t); });
    plain("sph", 3 * h, 0, 0, [](double t) {
      const auto fifth = [](double x) { return x > 0 ? x * x * x * x * x : 0; };
      return fifth(3 - 3 * t) - 6 * fifth(2 - 3 * t) + 15 * fifth(1 - 3 * t);
    });
    smooth();
    add_field("ours", "mls-detail", std::nullopt);
  }

 private:
  void smooth() {
    Progress progress;
    const VolumeValues values = volume_values(*volume_, "f");
    const auto metrics = volume_->lattice ? std::vector<StarMetric>() : star_metrics(*volume_);
    const Time start = now();
    const SampleNoise noise = estimate_noise(*volume_, values, metrics, progress);
    const Time estimated = now();
    const SmoothedSamples smooth = smooth_samples(*volume_, values, metrics, noise, 1, progress);
    const Time end = now();
    smoothed_ = smooth.values;
    if (!detail_) return;
    double expected = 0;
    for (const float d : smooth.deviations) expected += static_cast<double>(d) * static_cast<double>(d);
    fmt::print(
        "  noise {:.4f} of {:.4f}{}, correlation {:+.3f}, expected error {:.3f}; CPU {:.2f} + {:.2f} s, {} samples\n",
        noise.typical[0], sigma_, noise.found ? "" : " NOT FOUND", noise.correlation,
        std::sqrt(expected / static_cast<double>(at_.size())) / sigma_, (estimated - start).cpu, (end - estimated).cpu,
        at_.size());
  }

  void add_field(const char* what, const char* method, std::optional<double> smoothing) {
    Progress progress;
    VolumeReconstructionOptions options;
    options.method = method, options.smoothing = smoothing;
    const auto field = reconstruct_volume(volume_, "f", options, progress);
    std::vector<double> at(at_.size()), other(between_.size());
    field->evaluate(at_, {at});
    field->evaluate(between_, {other});
    add(what, smoothing ? at : smoothed_, other);
  }

  void add(const char* what, const std::vector<double>& at, const std::vector<double>& other) const {
    const auto errors = errors_of(at, at_, truth_);
    const auto far = other.empty() ? std::array<double, 3>{NAN, NAN, NAN} : errors_of(other, between_, truth_);
    for (std::size_t k = 0; k < 3; ++k)
      if (!std::isnan(errors[k]))
        fmt::print("{} | {:g} | {} | {} | {:.3f} | {:.3f}\n", name_, 100 * sigma_, kPartNames[k], what,
                   errors[k] / sigma_, far[k] / sigma_);
  }

  std::string name_;
  double sigma_;
  bool detail_;
  Truth truth_;
  std::shared_ptr<const SampledVolume> volume_;
  std::vector<Vec3> at_, between_;
  std::vector<double> f_, smoothed_;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view a = argv[i];
    const auto after = [&](std::string_view name) { return a.substr(name.size()); };
    if (a.starts_with("--grids="))
      options.grids = split(after("--grids="));
    else if (a.starts_with("--noise="))
      options.noise = split(after("--noise="));
    else if (a.starts_with("--size="))
      options.size = std::stoul(std::string(after("--size=")));
    else if (a == "--detail")
      options.detail = true;
    else
      return fmt::print(stderr, "unknown option {}\n", a), 2;
  }
  for (const std::string& name : options.grids) {
    const bool cells = name.ends_with("-cells");
    const GridData data = grid_of(std::string_view(name).substr(0, name.size() - (cells ? 6 : 0)), options.size);
    Progress progress;
    const SampledVolume volume = assemble_volume(data, cells ? Association::cells : Association::points, progress);
    for (const std::string& percent : options.noise)
      for (const bool step : {true, false}) Row(name, volume, std::stod(percent) / 100, step, options.detail).measure();
  }
  return 0;
}
