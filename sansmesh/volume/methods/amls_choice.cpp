#include "sansmesh/volume/methods/amls_choice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/samples/support_index.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostIterations = 20;
constexpr int kTrialPatience = 5;      // iterations without a gain that end the trial of a shape
constexpr double kTrialGain = 0.96;    // a gain is a sum of squares below this factor of the best
constexpr std::size_t kOneIn = 20;     // one sample in so many is left out
constexpr std::size_t kWhole = 20000;  // number of samples up to which the whole volume is used
constexpr std::size_t kPatches = 8, kPatchSamples = 2500;
constexpr std::size_t kRimRings = 3;  // width of a patch's rim without tests
constexpr std::size_t kFewTests = 10;
constexpr double kCovered = 0.8;  // t of a support up to which a point counts as covered
constexpr std::uint32_t kElsewhere = 0xffffffffu;

// Hash of a position, independent of the order of samples.
std::uint64_t position_hash(const Vec3& x) {
  std::uint64_t h = 0x9e3779b97f4a7c15ULL;
  for (std::size_t k = 0; k < 3; ++k) {
    h = mixed_bits(h ^ std::bit_cast<std::uint64_t>(x[k] + 0.0));
  }
  return h;
}

// A subset of the samples as a separate volume, in which the samples left out are no neighbours.
struct TestVolume {
  SampledVolume volume;
  std::vector<std::uint32_t> samples;   // their indices in the whole volume, ascending
  std::vector<std::uint8_t> left_out;   // per sample
  std::vector<std::uint32_t> tests;     // indices of the samples left out
  std::vector<std::uint32_t> local_of;  // per sample of the whole volume; kElsewhere if not included

  std::vector<std::uint32_t> known_around(const SampledVolume& whole, std::size_t local) const {
    std::vector<std::uint32_t> star, known;
    whole.star(samples[local], star);
    for (const std::uint32_t j : star)
      if (const std::uint32_t at = local_of[j]; at != kElsewhere && left_out[at] == 0) known.push_back(at);
    return known;
  }
};

// Connected patches around seeds chosen by position: the samples, and those not at a rim.
void grow_patches(const SampledVolume& whole, std::vector<std::uint32_t>& samples, std::vector<std::uint8_t>& inner) {
  const std::size_t n = whole.size();
  if (n <= kWhole) {
    samples.resize(n), inner.assign(n, 1);
    for (std::size_t i = 0; i < n; ++i) samples[i] = static_cast<std::uint32_t>(i);
    return;
  }
  using Seed = std::pair<std::uint64_t, std::uint32_t>;
  std::vector<Seed> seeds(n);
  parallel_for(0, n, 8192, [&](std::size_t i) {
    seeds[i] = {position_hash(whole.position(i)), static_cast<std::uint32_t>(i)};
  });
  std::partial_sort(seeds.begin(), seeds.begin() + static_cast<std::ptrdiff_t>(4 * kPatches), seeds.end());
  std::vector<std::uint8_t> taken(n);
  std::vector<std::pair<std::uint32_t, std::uint8_t>> all;
  std::vector<std::uint32_t> star, patch;
  std::size_t patches = 0;
  for (std::size_t s = 0; s < 4 * kPatches && patches < kPatches; ++s) {
    if (taken[seeds[s].second] != 0) continue;
    ++patches;
    patch.assign(1, seeds[s].second);
    taken[seeds[s].second] = 1;
    std::vector<std::size_t> rings{0, 1};  // begin of each ring
    while (patch.size() < kPatchSamples && rings[rings.size() - 2] < rings.back()) {
      for (std::size_t k = rings[rings.size() - 2]; k < rings.back(); ++k) {
        whole.star(patch[k], star);
        for (const std::uint32_t j : star)
          if (std::exchange(taken[j], std::uint8_t{1}) == 0) patch.push_back(j);
      }
      rings.push_back(patch.size());
    }
    // A patch that ended by itself reaches the border of its component, or another patch: it has no rim.
    const bool ended = rings[rings.size() - 2] == rings.back();
    const std::size_t within = ended                      ? patch.size()
                               : rings.size() > kRimRings ? rings[rings.size() - 1 - kRimRings]
                                                          : 0;
    for (std::size_t k = 0; k < patch.size(); ++k) all.emplace_back(patch[k], k < within);
  }
  std::sort(all.begin(), all.end());
  for (const auto& [sample, within] : all) samples.push_back(sample), inner.push_back(within);
}

void add_test_cells(const SampledVolume& whole, const TestVolume& test, SampledVolume& part) {
  const auto local = [&](std::uint32_t sample) { return test.local_of[sample]; };
  std::vector<std::uint32_t> corners;
  if (whole.lattice) {
    const auto& axes = whole.lattice->axes;
    for (const std::uint32_t s : test.samples) {
      const auto at = whole.lattice->indices(s);
      if (at[0] + 1 == axes[0].size() || at[1] + 1 == axes[1].size() || at[2] + 1 == axes[2].size()) continue;
      corners.clear();
      for (const std::uint32_t corner : corners_of_lattice_cell(*whole.lattice, s)) corners.push_back(local(corner));
      if (std::find(corners.begin(), corners.end(), kElsewhere) == corners.end())
        part.cells.add(CellShape::hexahedron, corners);
    }
    return;
  }
  for (std::size_t cell = 0; cell < whole.cells.size(); ++cell) {
    const auto of = whole.cells[cell];
    corners.clear();
    if (whole.cell_sample.empty()) {
      for (const std::uint32_t k : of) {
        corners.push_back(local(k));
        if (corners.back() == kElsewhere) break;
      }
      if (corners.back() == kElsewhere) continue;
    } else {
      const std::uint32_t sample = local(whole.cell_sample[cell]);
      if (sample == kElsewhere) continue;
      part.cell_sample.push_back(sample);
      for (const std::uint32_t k : of) {
        corners.push_back(static_cast<std::uint32_t>(part.corners.size()));
        part.corners.push_back(whole.corner(k));
      }
    }
    part.cells.add(whole.cells.shapes[cell], corners);
  }
}

/// `made_up`: samples whose values are means of their neighbours, ascending. They are unknown and are not tested.
TestVolume test_volume(const SampledVolume& whole, std::span<const std::uint32_t> made_up) {
  TestVolume test;
  std::vector<std::uint8_t> inner;
  grow_patches(whole, test.samples, inner);
  const std::size_t n = test.samples.size();
  test.local_of.assign(whole.size(), kElsewhere);
  test.left_out.resize(n);
  const auto is_made_up = [&](std::size_t i) {
    return std::binary_search(made_up.begin(), made_up.end(), test.samples[i]);
  };
  SampledVolume& part = test.volume;
  part.in_cells = whole.in_cells;
  for (std::size_t i = 0; i < n; ++i) {
    test.local_of[test.samples[i]] = static_cast<std::uint32_t>(i);
    part.positions.push_back(whole.position(test.samples[i]));
    test.left_out[i] = position_hash(part.positions[i]) % kOneIn == 0 || is_made_up(i);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (test.left_out[i] == 0) {
      const auto known = test.known_around(whole, i);
      part.stars.entries.insert(part.stars.entries.end(), known.begin(), known.end());
    } else if (inner[i] != 0 && !is_made_up(i)) {
      test.tests.push_back(static_cast<std::uint32_t>(i));
    }
    part.stars.first.push_back(part.stars.entries.size());
  }
  add_test_cells(whole, test, part);
  return test;
}

// The supports of largest width at the samples, before their final width is known.
struct AmlsReach {
  std::vector<std::uint64_t> first{0};
  std::vector<std::uint32_t> columns;
  std::vector<float> squares;  // local squared distances
  std::vector<float> rises;    // values of the polynomials: all components of an entry
};

AmlsReach reach_of(const SampledVolume& whole, const TestVolume& test, const LocalPolynomials& local,
                   std::span<const float> radii) {
  const SampledVolume& volume = test.volume;
  const std::size_t n = volume.size(), c = local.components, chunk = 512;
  const SupportIndex index(volume, local.metrics.view(), radii);
  std::vector<AmlsReach> parts((n + chunk - 1) / chunk);
  std::vector<std::uint8_t> asked(n);
  for (std::size_t i = 0; i < n; ++i) asked[i] = test.left_out[i] == 0;
  for (const std::uint32_t i : test.tests) asked[i] = 1;
  parallel_ranges(0, parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    SupportIndex::Memory found;
    for (std::size_t p = begin; p < end; ++p) {
      AmlsReach& part = parts[p];
      for (std::size_t i = p * chunk; i < std::min(n, (p + 1) * chunk); ++i) {
        const Vec3 x = volume.positions[i];
        found.supports.clear();
        if (asked[i] != 0 && test.left_out[i] != 0)
          index.of_point(x, test.known_around(whole, i), found);
        else if (asked[i] != 0)
          index.of_sample(static_cast<std::uint32_t>(i), found);
        for (const std::uint32_t j : found.supports) {
          const Vec3 u = local.metrics[j](x - volume.positions[j]);
          part.columns.push_back(j);
          part.squares.push_back(static_cast<float>(squared_norm(u)));
          for (std::size_t m = 0; m < c; ++m) part.rises.push_back(static_cast<float>(amls_rise(local.of(j, m), u)));
        }
        part.first.push_back(part.columns.size());
      }
    }
  });
  AmlsReach all;
  for (AmlsReach& part : parts) {
    const std::uint64_t before = all.columns.size();
    for (std::size_t i = 1; i < part.first.size(); ++i) all.first.push_back(before + part.first[i]);
    all.columns.insert(all.columns.end(), part.columns.begin(), part.columns.end());
    all.squares.insert(all.squares.end(), part.squares.begin(), part.squares.end());
    all.rises.insert(all.rises.end(), part.rises.begin(), part.rises.end());
    part = {};
  }
  return all;
}

AmlsMatrix narrowed(const AmlsReach& reach, std::span<const float> radii, std::size_t c, const AmlsShape& shape) {
  const std::size_t n = reach.first.size() - 1;
  AmlsMatrix matrix;
  std::vector<std::uint32_t> counts(n);
  const auto relative_square = [&](std::uint64_t e) {
    const double radius = static_cast<double>(radii[reach.columns[e]]);
    return static_cast<double>(reach.squares[e]) / (radius * radius);
  };
  parallel_for(0, n, 1024, [&](std::size_t i) {
    for (std::uint64_t e = reach.first[i]; e < reach.first[i + 1]; ++e) counts[i] += relative_square(e) < 1;
  });
  for (const std::uint32_t count : counts) matrix.first.push_back(matrix.first.back() + count);
  matrix.columns.resize(matrix.first.back()), matrix.shares.resize(matrix.first.back());
  matrix.rises.assign(n * c, 0.0);
  parallel_ranges(0, n, 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<double> phis;
    for (std::size_t i = begin; i < end; ++i) {
      double weights = 0, sizes = 0;
      phis.clear();
      std::uint64_t to = matrix.first[i];
      for (std::uint64_t e = reach.first[i]; e < reach.first[i + 1]; ++e) {
        const double t = relative_square(e);
        if (!(t < 1)) continue;
        const double w = shape.weight(t), phi = w * shape.laguerre(t);
        weights += w, sizes += std::abs(phi);
        phis.push_back(phi);
        matrix.columns[to++] = reach.columns[e];
        for (std::size_t m = 0; m < c; ++m)
          matrix.rises[i * c + m] += phi * static_cast<double>(reach.rises[e * c + m]);
      }
      const double divisor = shape.divisor(weights, sizes), inverse = divisor > 1e-30 ? 1 / divisor : 0;
      for (std::size_t m = 0; m < c; ++m) matrix.rises[i * c + m] *= inverse;
      for (std::size_t k = 0; k < phis.size(); ++k)
        matrix.shares[matrix.first[i] + k] = static_cast<float>(phis[k] * inverse);
    }
  });
  return matrix;
}

}  // namespace

struct AmlsTrial::State {
  AmlsShape phi;
  std::span<const float> least;
  TestVolume test;
  VolumeValues known;
  AmlsReach reach;
  std::vector<std::uint32_t> left_out;

  std::vector<float> radii_of(double epsilon) const {
    std::vector<float> radii(test.samples.size());
    for (std::size_t i = 0; i < radii.size(); ++i)
      if (test.left_out[i] == 0)
        radii[i] = std::max(least[test.samples[i]], static_cast<float>(AmlsShape::radius(epsilon)));
    return radii;
  }
};

AmlsTrial::AmlsTrial(const SampledVolume& whole, const VolumeValues& values, const LocalPolynomials& fitted,
                     std::span<const float> least, const LocalPolynomialOptions& how, const AmlsShape& phi,
                     double widest, double narrowest, Progress& progress)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.phi = phi, s.least = least;
  s.test = test_volume(whole, values.filled);
  const std::size_t c = values.components;
  s.known.components = c;
  std::vector<StarMetric> own_metrics;
  for (const std::uint32_t i : s.test.samples) {
    const auto of = values.of(i);
    s.known.values.insert(s.known.values.end(), of.begin(), of.end());
    own_metrics.push_back(fitted.metric(whole, i));
  }
  if (s.test.tests.empty()) return;
  const LocalPolynomials local =
      trusted(fit_local_polynomials(s.test.volume, s.known, how, std::move(own_metrics), progress));
  s.reach = reach_of(whole, s.test, local, s.radii_of(widest));
  const std::vector<float> least_radii = s.radii_of(narrowest);
  std::erase_if(s.test.tests, [&](std::uint32_t i) {
    for (std::uint64_t e = s.reach.first[i]; e < s.reach.first[i + 1]; ++e) {
      const auto radius = static_cast<double>(least_radii[s.reach.columns[e]]);
      if (static_cast<double>(s.reach.squares[e]) < kCovered * radius * radius) return false;
    }
    return true;
  });
  for (const std::uint32_t i : s.test.tests) s.left_out.push_back(s.test.samples[i]);
}

AmlsTrial::~AmlsTrial() = default;

const std::vector<std::uint32_t>& AmlsTrial::left_out() const { return state_->left_out; }

void AmlsTrial::run(double epsilon, const std::function<bool(int, std::span<const double>)>& go_on) const {
  const State& s = *state_;
  const std::size_t c = s.known.components;
  const AmlsMatrix matrix = narrowed(s.reach, s.radii_of(epsilon), c, s.phi);
  AmlsIteration iteration(matrix, s.known.values, c);
  std::vector<double> errors(s.test.tests.size() * c);
  for (int n = 0;; ++n, iteration.advance()) {
    // Samples left out have rows but no columns, so their residuals are the prediction errors.
    for (std::size_t t = 0; t < s.test.tests.size(); ++t)
      for (std::size_t m = 0; m < c; ++m) errors[t * c + m] = iteration.residuals()[s.test.tests[t] * c + m];
    if (!go_on(n, errors)) return;
  }
}

float amls_share(float trust) {
  // τ = 1 / (1 + q), q the doubt of a correction; the share is that of three times the doubt.
  constexpr float kDoubt = 3, kCertain = 0.25f;
  return std::min(trust / (trust + kDoubt * (1 - trust)) / kCertain, 1.0f);
}

AmlsChoice choose_amls(const AmlsTrial& trial, std::optional<double> shape, std::optional<int> iterations,
                       Progress& progress) {
  AmlsChoice choice;
  if (shape) choice.shape = *shape;
  if (iterations) choice.iterations = *iterations;
  if ((shape && iterations) || trial.left_out().size() < kFewTests) return choice;
  const std::vector<double> shapes =
      shape ? std::vector<double>{*shape} : std::vector<double>(std::begin(kAmlsShapes), std::end(kAmlsShapes));
  double best = std::numeric_limits<double>::infinity();
  progress.begin("shape and iterations", shapes.size());
  for (const double epsilon : shapes) {
    double here = std::numeric_limits<double>::infinity();
    int since = 0;
    trial.run(epsilon, [&](int n, std::span<const double> errors) {
      if (iterations && n < *iterations) return true;
      double sum = 0;
      for (const double e : errors) sum += e * e;
      if (sum < kTrialGain * best) best = sum, choice = {epsilon, n};
      if (sum < kTrialGain * here)
        here = sum, since = 0;
      else
        ++since;
      return !iterations && n < kMostIterations && since < kTrialPatience;
    });
    progress.advance();
  }
  return choice;
}

}  // namespace sansmesh::inline v1
