// How wide the functions of amls are, and how often it iterates: what predicts samples best that it was not told.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/methods/amls_system.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

struct AmlsChoice {
  double shape = 1.5;  ///< ε
  int iterations = 5;
};

/// Samples that are left out, one in twenty, chosen by their places, and what is said there by the others. Their values
/// act on nothing that predicts them: neither local polynomials nor their trust nor the iteration know of them. Large
/// volumes are judged by eight connected patches, a few thousand samples each, away from their rims: the time does not
/// grow with the volume.
class AmlsTrial {
 public:
  /// fitted: has the metrics of all samples. least: radii below which supports do not cover the cells of their samples.
  /// local: what polynomials are fitted with. ε will lie between `widest` and `narrowest`. Samples that the narrowest
  /// functions hardly reach are not asked. All but phi and the options must outlive it.
  AmlsTrial(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& fitted,
            std::span<const float> least, const LocalPolynomialOptions& local, const AmlsShape& phi, double widest,
            double narrowest, Progress& progress);
  ~AmlsTrial();
  AmlsTrial(const AmlsTrial&) = delete;
  AmlsTrial& operator=(const AmlsTrial&) = delete;

  /// Numbers of the samples that are asked.
  const std::vector<std::uint32_t>& left_out() const;
  /// Calls go_on(n, errors) for n = 0, 1, … iterations while it returns true. errors: value less prediction at the
  /// samples left out, components each.
  void run(double epsilon, const std::function<bool(int n, std::span<const double> errors)>& go_on) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What is not given of `shape` (one of kAmlsShapes) and `iterations` (0..20) is that of the least sum of squared
/// errors at samples left out; of nearly equal ones the widest with the fewest iterations. Where too few samples are
/// left out the numbers above stay.
AmlsChoice choose_amls(const AmlsTrial& trial, std::optional<double> shape, std::optional<int> iterations,
                       Progress& progress);
inline constexpr double kAmlsShapes[] = {0.7, 1.0, 1.5, 2.2};

/// How much of the field is amls and not linear interpolation, 0..1, where polynomials are trusted so much
/// (LocalPolynomials::trust): all of it from about 1/2 on.
float amls_share(float trust);

}  // namespace sansmesh::inline v1
