#include "sansmesh/flow_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;

/// Computes the vector at a point and moment, and its derivatives; false outside the flow.
using Formula = bool (*)(const Vec3& x, double t, Vec3& v, Jacobian& j);

class FormulaFlow final : public VectorField {
 public:
  FormulaFlow(Formula formula, Box3 bounds) : formula_(formula), bounds_(bounds) {}
  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian) const override {
    parallel_for(0, x.size(), 1024, [&](std::size_t i) {
      Vec3 v;
      Jacobian j{};
      inside[i] = bounds_.contains(x[i]) && std::isfinite(t[i]) && formula_(x[i], t[i], v, j);
      vectors[i] = v;
      if (!jacobian.empty()) jacobian[i] = j;
    });
  }

 private:
  Formula formula_;
  Box3 bounds_;
};

/// Rigid rotation with period 2π about the z axis.
bool rotation(const Vec3& x, double, Vec3& v, Jacobian& j) {
  j = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{}};
  v = {-x.y, x.x, 0};
  return true;
}

/// The rotation, rising by one per unit of time.
bool helix(const Vec3& x, double, Vec3& v, Jacobian& j) {
  j = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{}};
  v = {-x.y, x.x, 1};
  return true;
}

bool saddle(const Vec3& x, double, Vec3& v, Jacobian& j) {
  j = {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{}};
  v = {x.x, -x.y, 0};
  return true;
}

/// Arnold–Beltrami–Childress flow with A² = 3, B² = 2, C = 1.
bool abc(const Vec3& x, double, Vec3& v, Jacobian& j) {
  const double a = std::sqrt(3.0), b = std::sqrt(2.0), c = 1;
  j = {Vec3{0, b * std::cos(x.x), -b * std::sin(x.x)}, Vec3{-c * std::sin(x.y), 0, c * std::cos(x.y)},
       Vec3{a * std::cos(x.z), -a * std::sin(x.z), 0}};
  v = {a * std::sin(x.z) + c * std::cos(x.y), b * std::sin(x.x) + a * std::cos(x.z),
       c * std::sin(x.y) + b * std::cos(x.x)};
  return true;
}

/// Shadden, Lekien and Marsden 2005: two gyres whose border oscillates with period 10; independent of z.
bool double_gyre(const Vec3& x, double t, Vec3& v, Jacobian& j) {
  constexpr double kStrength = 0.1, kSwing = 0.25, kTurn = 2 * kPi / 10;
  const double a = kSwing * std::sin(kTurn * t), b = 1 - 2 * a;
  const double f = a * x.x * x.x + b * x.x, f1 = 2 * a * x.x + b, f2 = 2 * a;
  const double sx = std::sin(kPi * f), cx = std::cos(kPi * f), sy = std::sin(kPi * x.y), cy = std::cos(kPi * x.y);
  const double s = kPi * kStrength;
  j = {Vec3{-s * kPi * f1 * cx * cy, s * sy * (f2 * cx - kPi * f1 * f1 * sx), 0},
       Vec3{s * kPi * sx * sy, s * kPi * f1 * cx * cy, 0}, Vec3{}};
  v = {-s * sx * cy, s * cx * sy * f1, 0};
  return true;
}

/// A leaning, moving column of air, with fastest rotation at its wall and ascent inside; inflow at the ground.
bool tornado(const Vec3& x, double t, Vec3& v, Jacobian& j) {
  constexpr double kCore = 0.12, kSwirl = 1, kRise = 0.5, kInflow = 0.35, kLean = 0.08;
  // Position of the axis at this height, and its derivatives.
  const double phase = 3 * x.z + 0.7 * t;
  const double ax = 0.5 + kLean * x.z * std::sin(phase), ay = 0.5 + kLean * x.z * std::cos(phase);
  const double ax_z = kLean * (std::sin(phase) + 3 * x.z * std::cos(phase));
  const double ay_z = kLean * (std::cos(phase) - 3 * x.z * std::sin(phase));
  const double a = x.x - ax, b = x.y - ay, d = a * a + b * b + kCore * kCore;
  // Swirl like a smoothed Rankine vortex: kSwirl r c / (r² + c²). Derivatives of 1 / d by a are −2a / d².
  const double g = kSwirl * kCore / d, g_d = -g / d, w = kRise * kCore * kCore / d, w_d = -w / d;
  const double p = -kInflow * (1 - x.z);  // towards the axis
  v = {-b * g + p * a, a * g + p * b, w};
  const Vec3 by_a{-b * g_d * 2 * a + p, g + a * g_d * 2 * a, w_d * 2 * a};
  const Vec3 by_b{-g - b * g_d * 2 * b, a * g_d * 2 * b + p, w_d * 2 * b};
  j = {by_a, by_b, Vec3{kInflow * a, kInflow * b, 0} - by_a * ax_z - by_b * ay_z};
  return true;
}

/// Potential flow of unit speed from the left past the unit sphere about the origin; none inside.
bool past_sphere(const Vec3& x, double, Vec3& v, Jacobian& j) {
  const double r2 = squared_norm(x), r = std::sqrt(r2);
  if (r < 1) return false;
  // v = e (1 + 1 / 2r³) − 3 x₀ x / 2r⁵ with e the direction of the stream.
  const double i3 = 0.5 / (r2 * r), i5 = 1.5 / (r2 * r2 * r), i7 = 5 * i5 / r2;
  const Vec3 e{1, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 unit;
    unit[k] = 1;
    const double x0_k = k == 0 ? 1 : 0;
    j[k] = e * (-3 * i3 * x[k] / r2) - (x * x0_k + unit * x.x) * i5 + x * (x.x * i7 * x[k]);
  }
  v = e * (1 + i3) - x * (x.x * i5);
  return true;
}

struct Known {
  AnalyticFlow flow;
  Formula formula;
  Box3 bounds;
};

const std::array kKnown{
    Known{{"rotation", "rigid rotation about the z axis, period 2π", false}, rotation, {{-2, -2, -2}, {2, 2, 2}}},
    Known{{"helix", "rotation, rising by one per unit of time", false}, helix, {{-2, -2, -20}, {2, 2, 20}}},
    Known{{"saddle", "(x, -y, 0): away from x = 0, towards y = 0", false}, saddle, {{-4, -4, -4}, {4, 4, 4}}},
    Known{{"abc", "Arnold-Beltrami-Childress flow, chaotic", false},
          abc,
          {{-2 * kPi, -2 * kPi, -2 * kPi}, {4 * kPi, 4 * kPi, 4 * kPi}}},
    Known{
        {"double-gyre", "two gyres with an oscillating border, period 10", true}, double_gyre, {{0, 0, 0}, {2, 1, 1}}},
    Known{{"tornado", "a leaning, moving column that rotates and rises", true}, tornado, {{0, 0, 0}, {1, 1, 1}}},
    Known{
        {"past-sphere", "potential flow past a sphere of radius one", false}, past_sphere, {{-4, -4, -4}, {4, 4, 4}}}};

const std::array<AnalyticFlow, kKnown.size()> kFlows = [] {
  std::array<AnalyticFlow, kKnown.size()> flows{};
  for (std::size_t i = 0; i < kKnown.size(); ++i) flows[i] = kKnown[i].flow;
  return flows;
}();

}  // namespace

std::span<const AnalyticFlow> analytic_flows() { return kFlows; }

std::unique_ptr<VectorField> analytic_flow(std::string_view name) {
  const auto found = std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& k) { return k.flow.name == name; });
  if (found == kKnown.end()) {
    std::string names;
    for (const Known& k : kKnown) names += (names.empty() ? "" : ", ") + std::string(k.flow.name);
    throw ArgumentError("no flow is called \"" + std::string(name) + "\": there are " + names);
  }
  return std::make_unique<FormulaFlow>(found->formula, found->bounds);
}

}  // namespace sansmesh::inline v1
