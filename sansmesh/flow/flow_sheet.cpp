#include "sansmesh/flow/flow_sheet.h"

#include "sansmesh/core/median.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Particles with starts closer than this, in tolerances of the integrator, have none inserted between them. They make
/// nearly the same steps and nearly the same errors, so their separation is known far better than the tolerance.
constexpr double kTooNear = 0.2;

}  // namespace

double front_time(std::vector<double> speeds, double spacing) {
  const double speed = median(speeds);
  if (!(speed > 0)) throw DataError("the flow is at rest on at least half of the seed curve");
  return spacing / speed;
}

double least_seed_distance(const VectorField& field, const TraceOptions& options) {
  return kTooNear * trace_tolerance(field, options);
}

}  // namespace sansmesh::inline v1
