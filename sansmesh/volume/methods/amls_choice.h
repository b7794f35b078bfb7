// Cross-validation of shape parameter and number of iterations of amls.
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

/// Cross-validation: one sample in twenty, selected by position, is left out and predicted from the others. The values
/// left out enter neither the local polynomials nor their trust nor the iteration. For large volumes only eight
/// connected patches of a few thousand samples each are evaluated, away from their rims, so that the time does not grow
/// with the volume.
class AmlsTrial {
 public:
  /// fitted: has the metrics of all samples. least: radii below which supports do not cover the cells of their samples.
  /// local: options of the polynomials. ε ranges from `widest` to `narrowest`. Samples that the narrowest functions
  /// hardly reach are not evaluated. All arguments but phi and the options must outlive the object.
  AmlsTrial(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& fitted,
            std::span<const float> least, const LocalPolynomialOptions& local, const AmlsShape& phi, double widest,
            double narrowest, Progress& progress);
  ~AmlsTrial();
  AmlsTrial(const AmlsTrial&) = delete;
  AmlsTrial& operator=(const AmlsTrial&) = delete;

  /// Indices of the samples left out.
  const std::vector<std::uint32_t>& left_out() const;
  /// Calls go_on(n, errors) for n = 0, 1, … iterations while it returns true. errors: value minus prediction at the
  /// samples left out, all components of each.
  void run(double epsilon, const std::function<bool(int n, std::span<const double> errors)>& go_on) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Chooses whichever of `shape` (one of kAmlsShapes) and `iterations` (0..20) is absent: the least sum of squared
/// errors at the samples left out; among nearly equal ones the widest functions with the fewest iterations. With too
/// few samples left out it returns the defaults of AmlsChoice.
AmlsChoice choose_amls(const AmlsTrial& trial, std::optional<double> shape, std::optional<int> iterations,
                       Progress& progress);
inline constexpr double kAmlsShapes[] = {0.7, 1.0, 1.5, 2.2};

/// Share of amls in the field, 0..1, for a trust of the polynomials (LocalPolynomials::trust); the rest is linear
/// interpolation. It is 1 from a trust of about 1/2 on.
float amls_share(float trust);

}  // namespace sansmesh::inline v1
