#include "sansmesh/approximation/generating_functions.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using RadialName = std::pair<std::string_view, RadialFunction>;
constexpr std::array<RadialName, 8> kRadialNames{{{"thin-plate", RadialFunction::kThinPlate},
                                                  {"biharmonic", RadialFunction::kBiharmonic},
                                                  {"triharmonic", RadialFunction::kTriharmonic},
                                                  {"multiquadric", RadialFunction::kMultiquadric},
                                                  {"inverse-multiquadric", RadialFunction::kInverseMultiquadric},
                                                  {"gaussian", RadialFunction::kGaussian},
                                                  {"wendland-c2", RadialFunction::kWendlandC2},
                                                  {"wendland-c4", RadialFunction::kWendlandC4}}};
using WeightName = std::pair<std::string_view, WeightFunction>;
constexpr std::array<WeightName, 3> kWeightNames{{{"compact", WeightFunction::kCompact},
                                                  {"wendland", WeightFunction::kWendland},
                                                  {"gaussian", WeightFunction::kGaussian}}};

template <class Names, class Function>
std::string_view name_in(const Names& names, Function function) {
  for (const auto& [name, known] : names)
    if (known == function) return name;
  return {};
}

// Coefficients of the generalised Laguerre polynomial of degree d <= 2.
void laguerre(int d, double alpha, double* c) {
  c[0] = c[1] = c[2] = 0;
  if (d == 0) {
    c[0] = 1;
  } else if (d == 1) {
    c[0] = alpha + 1, c[1] = -1;
  } else {
    c[0] = 0.5 * (alpha + 1) * (alpha + 2), c[1] = -(alpha + 2), c[2] = 0.5;
  }
}

bool is_positive(double x) { return x > 0 && std::isfinite(x); }

}  // namespace

std::string_view name_of(RadialFunction function) { return name_in(kRadialNames, function); }
std::string_view name_of(WeightFunction function) { return name_in(kWeightNames, function); }

RadialKernel::RadialKernel(RadialFunction function, double scale)
    : function_(function), scale_(scale), inverse_square_(1 / (scale * scale)) {
  if (!is_positive(scale)) throw ArgumentError("approximation: the scale of a radial basis function must be positive");
}

RadialValue RadialKernel::with_slope(double r2) const {
  const double t2 = r2 * inverse_square_;
  switch (function_) {
    case RadialFunction::kThinPlate: {
      if (!(t2 > 0)) return {};
      const double log = std::log(t2);
      return {0.5 * t2 * log, inverse_square_ * (log + 1)};
    }
    case RadialFunction::kBiharmonic: {
      const double t = std::sqrt(t2);
      return {-t, t > 0 ? -inverse_square_ / t : 0};
    }
    case RadialFunction::kTriharmonic: {
      const double t = std::sqrt(t2);
      return {t2 * t, 3 * inverse_square_ * t};
    }
    case RadialFunction::kMultiquadric: {
      const double root = std::sqrt(1 + t2);
      return {-root, -inverse_square_ / root};
    }
    case RadialFunction::kInverseMultiquadric: {
      const double v = 1 / std::sqrt(1 + t2);
      return {v, -inverse_square_ * v * v * v};
    }
    case RadialFunction::kGaussian: {
      const double v = std::exp(-t2);
      return {v, -2 * inverse_square_ * v};
    }
    case RadialFunction::kWendlandC2: {
      if (t2 >= 1) return {};
      const double t = std::sqrt(t2), q = (1 - t) * (1 - t);
      return {q * q * (4 * t + 1), -20 * inverse_square_ * q * (1 - t)};
    }
    case RadialFunction::kWendlandC4: {
      if (t2 >= 1) return {};
      const double t = std::sqrt(t2), q = (1 - t) * (1 - t);
      return {q * q * q * (35 * t2 + 18 * t + 3) / 3, -56.0 / 3 * inverse_square_ * q * q * (1 - t) * (5 * t + 1)};
    }
  }
  return {};
}

RadialValue weight(WeightFunction function, double r2, double radius) {
  const double inverse = 1 / (radius * radius), t2 = r2 * inverse;
  if (t2 >= 1) return {};
  switch (function) {
    case WeightFunction::kCompact: {
      const double u = 1 - t2, u3 = u * u * u;
      return {u3 * u, -8 * inverse * u3};
    }
    case WeightFunction::kWendland: {
      const double t = std::sqrt(t2), q = (1 - t) * (1 - t);
      return {q * q * (4 * t + 1), -20 * inverse * q * (1 - t)};
    }
    case WeightFunction::kGaussian: {
      const double e = std::exp(-9 * t2);
      return {e - std::exp(-9.0), -18 * inverse * e};
    }
  }
  return {};
}

LaguerreGaussian::LaguerreGaussian(int dimension, int order, double shape, double spacing)
    : factor_(shape / (spacing * spacing)), scale_(std::pow(shape / std::numbers::pi, 0.5 * dimension)) {
  if (dimension < 1 || dimension > 3) throw ArgumentError("approximation: Laguerre–Gaussians of 1, 2 or 3 variables");
  if (order != 2 && order != 4 && order != 6)
    throw ArgumentError("approximation: the order of approximate moving least squares must be 2, 4 or 6, not " +
                        std::to_string(order));
  if (!is_positive(shape)) throw ArgumentError("approximation: the shape parameter must be positive");
  if (!is_positive(spacing)) throw ArgumentError("approximation: the spacing must be positive");
  laguerre(order / 2 - 1, 0.5 * dimension, l_);
  laguerre(order / 2 - 1, 0.5 * dimension + 1, m_);
}

double LaguerreGaussian::cutoff(double fraction) const {
  if (!(fraction > 0 && fraction < 1)) throw ArgumentError("approximation: the cutoff must lie in (0, 1)");
  // |φ| decreases beyond the last zero of its slope: the search goes inwards from a distance that is certainly beyond
  // it.
  const double limit = fraction * l_[0];
  const auto magnitude = [&](double rho) { return std::abs(l_[0] + rho * (l_[1] + rho * l_[2])) * std::exp(-rho); };
  double outside = 60 - 2 * std::log(fraction), step = outside / 4096;
  while (outside > step && magnitude(outside - step) <= limit) outside -= step;
  double inside = std::max(0.0, outside - step);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (inside + outside);
    (magnitude(middle) <= limit ? outside : inside) = middle;
  }
  return std::sqrt(outside / factor_);
}

}  // namespace sansmesh::inline v1
