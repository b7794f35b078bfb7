// Implicit surfaces compared with the published formulas in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/surface/bilateral_normals.h"
#include "sansmesh/surface/implicit_surface.h"
#include "source_references.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kWideWeights = 1.5;

ImplicitSurface make_of_source(const PointSet& cloud, ImplicitOptions options) {
  Progress progress;
  if (!options.smoothing) options.smoothing = kWideWeights;
  options.separate_sheets = false;
  return make_implicit_surface(prepare_samples(cloud, progress, 0.0), options, progress);
}

/// Points off the surface by up to `most` spacings.
std::vector<Vec3> places_off(const SurfaceSamples& samples, double most, std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Vec3> x;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * samples.size() / count;
    const double s = samples.median_spacing;
    const Vec3 aside{0.3 * s * u(random), 0.3 * s * u(random), 0.3 * s * u(random)};
    x.push_back(Vec3(samples.positions[i]) + aside * 0.3 + Vec3(samples.normals[i]) * (most * s * u(random)));
  }
  return x;
}

/// Checks values against the reference, and gradients against its finite differences.
template <class Reference>
void expect_formula(const ImplicitSurface& surface, const Reference& reference, double scale) {
  const std::vector<Vec3> x = places_off(surface.samples(), 0.25, 120);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  surface.evaluate(x, values, gradients);
  const double step = 1e-4 * scale;
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(values[i], reference(x[i]), 2e-5 * scale);
    Vec3 slope;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 up = x[i], down = x[i];
      up[k] += step, down[k] -= step;
      slope[k] = (reference(up) - reference(down)) / (2 * step);
    }
    EXPECT_LT(norm(gradients[i] - slope), 1e-3 * std::max(1.0, norm(slope)));
  }
}

class SourceWeights : public testing::TestWithParam<SurfaceWeights> {};

/// adamson2003: f = ⟨n, x − a⟩, n the direction of least Σ w ⟨n, x − x_i⟩².
TEST_P(SourceWeights, AdamsonsNormalIsTheDirectionOfLeastCovariance) {
  const ImplicitSurface surface =
      make_of_source(test::torus(3000),
                     {.method = ImplicitMethod::adamson, .weights = GetParam(), .normal = SurfaceNormal::covariance});
  const test::Weighed all(surface.samples(), kWideWeights, GetParam());
  expect_formula(
      surface, [&](const Vec3& x) { return dot(all.least_covariance(x, x), x - all.mean(x)); },
      surface.report().spacing);
}

TEST_P(SourceWeights, AdamsonsOtherNormalIsTheMean) {
  const ImplicitSurface surface =
      make_of_source(test::torus(3000), {.method = ImplicitMethod::adamson, .weights = GetParam()});
  const test::Weighed all(surface.samples(), kWideWeights, GetParam());
  expect_formula(
      surface, [&](const Vec3& x) { return dot(all.mean_normal(x), x - all.mean(x)); }, surface.report().spacing);
}

INSTANTIATE_TEST_SUITE_P(Both, SourceWeights, testing::Values(SurfaceWeights::compact, SurfaceWeights::gaussian),
                         [](const auto& tested) {
                           return tested.param == SurfaceWeights::gaussian ? "gaussian" : "compact";
                         });

/// kolluri2005: Σ w ⟨x − x_i, n_i⟩ / Σ w, w = exp(−d²/h²) / A_i, A_i the number of samples in the ball of radius h
/// around x_i.
TEST(GaussianWeights, KolluriDividesByTheSamplesAround) {
  const ImplicitSurface surface =
      make_of_source(test::torus(3000), {.method = ImplicitMethod::kolluri, .weights = SurfaceWeights::gaussian});
  test::Weighed all(surface.samples(), kWideWeights, SurfaceWeights::gaussian);
  for (std::size_t i = 0; i < all.x.size(); ++i) {
    double count = 0;
    for (std::size_t k = 0; k < all.x.size(); ++k) count += norm(all.x[i] - all.x[k]) <= all.h[i];
    all.factor[i] = 1 / count;
  }
  expect_formula(
      surface,
      [&](const Vec3& x) {
        double sum = 0, weights = 0;
        for (std::size_t i = 0; i < all.x.size(); ++i)
          sum += all.weight(i, x) * dot(x - all.x[i], all.n[i]), weights += all.weight(i, x);
        return sum / weights;
      },
      surface.report().spacing);
}

/// amenta2004: ½⟨n, ∇_y e⟩ with e the mean of squared distances along n; finite differences of e with n fixed.
TEST(GaussianWeights, ExtremalIsTheSlopeOfItsEnergy) {
  const ImplicitSurface surface =
      make_of_source(test::torus(3000), {.method = ImplicitMethod::extremal, .weights = SurfaceWeights::gaussian});
  const test::Weighed all(surface.samples(), kWideWeights, SurfaceWeights::gaussian);
  const double s = surface.report().spacing, step = 1e-4 * s;
  const std::vector<Vec3> x = places_off(surface.samples(), 0.25, 60);
  std::vector<double> values(x.size());
  surface.evaluate(x, values);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Vec3 n = all.mean_normal(x[k]);
    const auto energy = [&](const Vec3& y) {
      double sum = 0, weights = 0;
      for (std::size_t i = 0; i < all.x.size(); ++i)
        sum += all.weight(i, y) * std::pow(dot(n, y - all.x[i]), 2), weights += all.weight(i, y);
      return sum / weights;
    };
    EXPECT_NEAR(values[k], (energy(x[k] + n * step) - energy(x[k] - n * step)) / (4 * step), 1e-4 * s);
  }
}

TEST(GaussianWeights, SpheresAreExactForAlgebraicSpheres) {
  const ImplicitSurface surface = make_of_source(test::sphere(3000), {.weights = SurfaceWeights::gaussian});
  const std::vector<Vec3> x = places_off(surface.samples(), 0.4, 200);
  std::vector<double> values(x.size());
  surface.evaluate(x, values);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(values[i], norm(x[i]) - 1, 1e-5);
}

/// With one h and equal weights, samples added on one half of a plate pull the mean of two planes; compact weights do
/// not.
TEST(GaussianWeights, DoNotKnowTheDensity) {
  const auto height = [](SurfaceWeights weights) {
    // Two nearly coincident sheets, the upper one sampled four times as densely.
    PointSet cloud;
    for (int i = -40; i <= 40; ++i)
      for (int j = -40; j <= 40; ++j)
        if (i % 2 == 0 && j % 2 == 0) cloud.positions.push_back({0.05f * i, 0.05f * j, 0});
    const std::size_t sparse = cloud.size();
    for (int i = -40; i <= 40; ++i)
      for (int j = -40; j <= 40; ++j) cloud.positions.push_back({0.05f * i + 0.01f, 0.05f * j + 0.01f, 0.02f});
    cloud.normals.assign(cloud.size(), {0, 0, 1});
    EXPECT_LT(4 * sparse, cloud.size());
    const ImplicitSurface surface =
        make_of_source(cloud, {.method = ImplicitMethod::kolluri, .bandwidth = 0.2, .weights = weights});
    std::vector<double> value(1);
    surface.evaluate(std::vector<Vec3>{{0, 0, 0}}, value);
    return -value[0];
  };
  EXPECT_NEAR(height(SurfaceWeights::gaussian), 0.02 * 4 / 5, 0.001);
}

/// φ_i of one h for all samples, over their sum: the rows of A, at any point.
std::vector<double> generating(const test::Weighed& all, const Vec3& x, double epsilon, double h, int order) {
  std::vector<double> phi(all.x.size());
  double sum = 0;
  for (std::size_t i = 0; i < phi.size(); ++i) {
    const double r = epsilon * squared_norm(x - all.x[i]) / (h * h);
    if (r >= 12) continue;
    sum += std::exp(-r);
    phi[i] = std::exp(-r) * (order == 2 ? 1 : order == 4 ? 2.5 - r : 35.0 / 8 - 3.5 * r + 0.5 * r * r);
  }
  for (double& p : phi) p /= sum * (order == 2 ? 1 : order == 4 ? 1.5 : 1.875);
  return phi;
}

/// The iterations of tejada2008, 4.3.1, exactly as published, one point after another.
TEST(Amls, EpsilonAndWidthAndTheIteratedNormalsAreTheSources) {
  SANSMESH_NOT_SANITIZED("compares formulas; others evaluate the same");
  for (const int order : {2, 4, 6})
    for (const int iterations : {0, 1, 3}) {
      const double epsilon = 0.8;
      ImplicitOptions options{.method = ImplicitMethod::amls,
                              .order = order,
                              .iterations = iterations,
                              .epsilon = epsilon,
                              .weights = SurfaceWeights::gaussian,
                              .normal = SurfaceNormal::iterated};
      const ImplicitSurface surface = make_of_source(test::torus(1200), options);
      const test::Weighed all(surface.samples(), kWideWeights, SurfaceWeights::gaussian);
      const double h = kWideWeights * surface.report().spacing;
      std::vector<std::vector<double>> rows;
      for (const Vec3& x : all.x) rows.push_back(generating(all, x, epsilon, h, order));
      const std::vector<Vec3> x = places_off(surface.samples(), 0.15, 25);
      std::vector<double> values(x.size());
      std::vector<Vec3> normals(x.size());
      surface.evaluate(x, values);
      surface.iterated_normals(x, normals);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const std::vector<double> phi = generating(all, x[k], epsilon, h, order);
        // M⁰ = Σ g_i φ_i; Mⁿ⁺¹ = Mⁿ + Σ (g_i − Mⁿ(x_i)) φ_i with x fixed in g; N likewise.
        const std::size_t n = all.x.size();
        std::vector<double> rest(n);
        std::vector<Vec3> rest_normal = all.n;
        for (std::size_t i = 0; i < n; ++i) rest[i] = dot(x[k] - all.x[i], all.n[i]);
        double value = 0;
        Vec3 normal;
        for (int iteration = 0;; ++iteration) {
          for (std::size_t i = 0; i < n; ++i) value += rest[i] * phi[i], normal += rest_normal[i] * phi[i];
          if (iteration == iterations) break;
          std::vector<double> next = rest;
          std::vector<Vec3> next_normal = rest_normal;
          for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) {
              if (rows[i][j] == 0) continue;
              next[i] -= rows[i][j] * rest[j], next_normal[i] -= rest_normal[j] * rows[i][j];
            }
          rest.swap(next), rest_normal.swap(next_normal);
        }
        EXPECT_NEAR(values[k], value, 1e-4 * h) << order << ", " << iterations;
        EXPECT_LT(norm(normals[k] - normalized(normal)), 1e-4) << order << ", " << iterations;
      }
    }
}

TEST(Amls, EpsilonIsAWidth) {
  const PointSet cloud = test::torus(2000);
  ImplicitOptions by_epsilon{.method = ImplicitMethod::amls, .smoothing = 2, .order = 4, .iterations = 2, .epsilon = 4};
  ImplicitOptions by_width{.method = ImplicitMethod::amls, .smoothing = 1, .order = 4, .iterations = 2};
  const ImplicitSurface a = make_of_source(cloud, by_epsilon), b = make_of_source(cloud, by_width);
  const std::vector<Vec3> x = places_off(a.samples(), 0.3, 200);
  std::vector<double> values(x.size()), others(x.size());
  a.evaluate(x, values), b.evaluate(x, others);
  EXPECT_EQ(values, others);
}

/// One round of the published sharp normals equals its formula; the radial weights of the bilateral ones are Gaussians
/// on request.
TEST(SharpNormals, LaguerreWeightsAreTheFormula) {
  Progress progress;
  const SurfaceSamples samples = prepare_samples(test::cube(3000), progress, 0.0);
  const double h = kWideWeights * samples.median_spacing, sigma = 0.4 * samples.median_spacing, epsilon = 0.7;
  for (const auto formula : {SharpFormula::laguerre, SharpFormula::bilateral}) {
    const bool laguerre = formula == SharpFormula::laguerre;
    const BilateralNormals field(samples, {.height = sigma,
                                           .smoothing = kWideWeights,
                                           .iterations = 1,
                                           .formula = formula,
                                           .epsilon = epsilon,
                                           .weights = SurfaceWeights::gaussian});
    std::vector<Vec3> x, normals;
    std::mt19937 random(3);
    std::normal_distribution<double> g;
    for (std::size_t i = 0; i < samples.size(); i += 40) {
      x.emplace_back(samples.positions[i]);
      normals.push_back(normalized(Vec3(samples.normals[i]) + Vec3{g(random), g(random), g(random)} * 0.2));
    }
    std::vector<Vec3> refined = normals;
    field.refine(x, refined);
    for (std::size_t k = 0; k < x.size(); ++k) {
      Vec3 sum;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec3 d = Vec3(samples.positions[i]) - x[k], n(samples.normals[i]);
        const double r = squared_norm(d) / (h * h), z = dot(normals[k], d);
        if ((laguerre ? epsilon * r : r) >= 12) continue;
        const double across = z * z / (2 * sigma * sigma);
        if (laguerre) {
          const double s = epsilon * r + across;
          sum += n * ((35.0 / 8 - 3.5 * s + 0.5 * s * s) * std::exp(-s));
        } else if (dot(n, normals[k]) > 0) {
          sum += n * std::exp(-r - across - squared_norm(normals[k] - n) / (2 * 0.4 * 0.4));
        }
      }
      EXPECT_LT(norm(refined[k] - normalized(sum)), 1e-4) << laguerre;
    }
  }
}

/// Next to an edge of evenly sampled faces the normals turn towards that of the face.
TEST(SharpNormals, LaguerreWeightsSharpenEdges) {
  SANSMESH_RUNS_ONCE("judges accuracy; others evaluate, too");
  PointSet cloud;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> u(-0.1f, 0.1f);
  constexpr int kSide = 40;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
          const auto at = [&](int k) { return -1 + 2 * (static_cast<float>(k) + 0.5f + u(random)) / kSide; };
          Vec3f p, n;
          p[axis] = n[axis] = side, p[(axis + 1) % 3] = at(i), p[(axis + 2) % 3] = at(j);
          cloud.positions.push_back(p), cloud.normals.push_back(n);
        }
  Progress progress;
  const ImplicitSurface field =
      make_implicit_surface(prepare_samples(cloud, progress, 0.0), {.smoothing = 3}, progress);
  const BilateralNormals normals(field.samples(), {.formula = SharpFormula::laguerre});
  const double s = field.report().spacing;
  std::vector<Vec3> x;
  for (double y = -0.8; y <= 0.8; y += 0.01) x.push_back({1, y, 1 - 1.3 * s});
  std::vector<double> values(x.size());
  std::vector<Vec3> smooth(x.size());
  field.evaluate(x, values, smooth);
  std::vector<Vec3> sharp = smooth;
  normals.refine(x, sharp);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    before += std::acos(std::min(1.0, normalized(smooth[i]).x)), after += std::acos(std::min(1.0, sharp[i].x));
  EXPECT_GT(before, 0.1 * static_cast<double>(x.size()));
  EXPECT_LT(after, 0.3 * before);
}

/// Negative values of the polynomial never turn a normal to the opposite side, for any distribution of samples.
TEST(SharpNormals, LaguerreWeightsKeepTheSide) {
  Progress progress;
  const SurfaceSamples samples = prepare_samples(test::cube(4000), progress, 0.0);
  const BilateralNormals field(samples, {.smoothing = 5, .iterations = 1, .formula = SharpFormula::laguerre});
  std::vector<Vec3> x, normals;
  std::mt19937 random(5);
  std::normal_distribution<double> g;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    x.push_back(Vec3(samples.positions[i]) + Vec3{g(random), g(random), g(random)} * (0.5 * samples.median_spacing));
    normals.push_back(normalized(Vec3(samples.normals[i]) + Vec3{g(random), g(random), g(random)} * 0.3));
  }
  std::vector<Vec3> refined = normals;
  field.refine(x, refined);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_GT(dot(refined[i], normals[i]), 0);
}

/// h and ε are bounded by their combination.
TEST(ImplicitSources, WidthsAreJudgedWithEpsilon) {
  Progress progress;
  const SurfaceSamples samples = prepare_samples(test::sphere(600), progress, 0.0);
  const double spacing = samples.median_spacing;
  ImplicitOptions o{.method = ImplicitMethod::amls, .order = 2, .iterations = 0};
  o.smoothing = 20, o.epsilon = 0.05;
  EXPECT_THROW(make_implicit_surface(samples, o, progress), ArgumentError);
  o.epsilon = 20;
  EXPECT_NO_THROW(make_implicit_surface(samples, o, progress));
  o.smoothing.reset(), o.bandwidth = 15 * spacing, o.epsilon = 0.05;
  EXPECT_THROW(make_implicit_surface(samples, o, progress), ArgumentError);
  o.bandwidth = 25 * spacing, o.epsilon = 20;
  EXPECT_NO_THROW(make_implicit_surface(samples, o, progress));
}

TEST(ImplicitSources, AreRefusedWhereTheyMeanNothing) {
  const auto refused = [](ImplicitOptions o, const std::string& field) {
    try {
      o.validate();
      ADD_FAILURE() << field;
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find("`" + field + "`"), std::string::npos) << error.what();
    }
  };
  refused({.epsilon = 1}, "epsilon");
  refused({.method = ImplicitMethod::amls, .epsilon = 0}, "epsilon");
  refused({.normal = SurfaceNormal::covariance}, "normal");
  refused({.method = ImplicitMethod::adamson, .normal = SurfaceNormal::iterated}, "normal");
  refused({.method = ImplicitMethod::hoppe, .weights = SurfaceWeights::gaussian}, "weights");
  EXPECT_THROW(BilateralOptions{.epsilon = 0}.validate(), ArgumentError);
  const ImplicitSurface spheres = make_of_source(test::sphere(500), {});
  std::vector<Vec3> one(1);
  EXPECT_THROW(spheres.iterated_normals(one, one), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
