// Dormand and Prince's method with adaptive steps (dormand1980). The dense output is Shampine's, as in hairer1993.
#include <array>
#include <cmath>

#include "sansmesh/flow/flow_integrator.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kStages = 7;
constexpr std::array<double, kStages> kMoment{0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
constexpr std::array<std::array<double, 6>, kStages> kStage{{
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
}};
constexpr std::array<double, kStages> kError{71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                             -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
constexpr std::array<double, kStages> kBetween{-12715105075.0 / 11282082432,  0,
                                               87487479700.0 / 32700410799,   -10690763975.0 / 1880347072,
                                               701980252875.0 / 199316789632, -1453857185.0 / 822651844,
                                               69997945.0 / 29380423};

void dormand_prince_step(ParticleStep& step) {
  std::array<const Vec3*, kStages> k{step.velocities(0).data()};
  for (std::size_t s = 1; s < kStages; ++s) {
    step.ask(kMoment[s], [&](std::size_t i) {
      Vec3 mean;
      for (std::size_t j = 0; j < s; ++j) mean += k[j][i] * kStage[s][j];
      return mean;
    });
    k[s] = step.velocities(s).data();
  }
  for (std::size_t i = 0; i < step.size(); ++i) {
    const double h = step.duration(i);
    Vec3 error, bulge;
    for (std::size_t j = 0; j < kStages; ++j) error += k[j][i] * kError[j], bulge += k[j][i] * (kBetween[j] * h);
    step.error(i) = norm(error) * std::abs(h);
    step.bulge(i) = bulge;
  }
}

constexpr FlowIntegrator kDormandPrince[] = {{.name = "dopri5",
                                              .summary = "Dormand-Prince, fifth order, adaptive",
                                              .step = dormand_prince_step,
                                              .order = 5,
                                              .adaptive = true,
                                              .reach = 0.02}};

}  // namespace

std::span<const FlowIntegrator> dormand_prince_integrators() { return kDormandPrince; }

}  // namespace sansmesh::inline v1
