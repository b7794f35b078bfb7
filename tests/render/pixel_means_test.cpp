#include "sansmesh/render/volume/pixel_means.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

using PictureLight = std::function<float(double x, double y)>;

TracePoints rays_of(const PictureLight& light) {
  return [light](std::span<const std::array<float, 2>> points, std::span<TracedLight> lights) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float v = light(static_cast<double>(points[i][0]), static_cast<double>(points[i][1]));
      lights[i] = {{v, v, v}, 0};
    }
  };
}

struct MeanPicture {
  PixelMap<std::array<float, 4>> map;
  std::size_t rays = 0;
};

MeanPicture picture_by_rays(int width, int height, const PixelMeanOptions& options, const PictureLight& light) {
  MeanPicture made{{width, height}, 0};
  constexpr int kTile = 32;
  for (int y = 0; y < height; y += kTile)
    for (int x = 0; x < width; x += kTile)
      made.rays += pixel_means({x, y, std::min(x + kTile, width), std::min(y + kTile, height)}, options, rays_of(light),
                               made.map);
  return made;
}

/// The mean at n² midpoints of a pixel's parts.
double midpoint_mean(int x, int y, int n, const PictureLight& light) {
  double sum = 0;
  for (int v = 0; v < n; ++v)
    for (int u = 0; u < n; ++u) sum += static_cast<double>(light(x + (u + 0.5) / n, y + (v + 0.5) / n));
  return sum / (n * n);
}

/// White on one side of a straight line at a distance from a point, black on the other.
PictureLight band(double angle, double x0, double y0, double from, double to) {
  return [=](double x, double y) {
    const double d = std::cos(angle) * (x - x0) + std::sin(angle) * (y - y0);
    return d > from && d < to ? 1.0f : 0.0f;
  };
}

TEST(PixelMeans, QuadraticLightIsExactWithARayPerPixel) {
  const PictureLight light = [](double x, double y) {
    return static_cast<float>(0.3 + 0.004 * x - 0.003 * y + 1e-5 * (x * x - 2 * x * y + 3 * y * y));
  };
  // Sizes that no tile divides, and an odd one.
  const MeanPicture made = picture_by_rays(70, 41, {}, light);
  double most = 0;
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 70; ++x) {
      // Exact for quadratic polynomials: Gauss's two points in each direction.
      double exact = 0;
      for (const double v : {-0.5, 0.5})
        for (const double u : {-0.5, 0.5})
          exact +=
              0.25 * static_cast<double>(light(x + 0.5 + u / std::numbers::sqrt3, y + 0.5 + v / std::numbers::sqrt3));
      most = std::max(most, std::abs(static_cast<double>(made.map.at(x, y)[0]) - exact));
      EXPECT_EQ(made.map.at(x, y)[3], 0);
    }
  EXPECT_LT(most, 1e-5);
  EXPECT_LT(made.rays, 70u * 41u * 6 / 5);
}

TEST(PixelMeans, EdgesAreBetterThanNineMidpointsEach) {
  double squares = 0, of_midpoints = 0;
  std::size_t rays = 0, old_rays = 0;
  constexpr int kSize = 64;
  for (int k = 0; k < 12; ++k) {
    const PictureLight light = band(0.21 + 0.53 * k, 31.3 + 0.17 * k, 32.9 - 0.23 * k, 0, 1000);
    const MeanPicture made = picture_by_rays(kSize, kSize, {}, light);
    rays += made.rays, old_rays += kSize * kSize;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double exact = midpoint_mean(x, y, 40, light);
        squares += std::pow(static_cast<double>(made.map.at(x, y)[0]) - exact, 2);
        if (exact == 0 || exact == 1) continue;
        of_midpoints += std::pow(midpoint_mean(x, y, 3, light) - exact, 2);
        old_rays += 9;
      }
  }
  EXPECT_LT(squares, of_midpoints);
  EXPECT_LT(static_cast<double>(rays), 1.5 * static_cast<double>(old_rays));
}

TEST(PixelMeans, ThinLinesAreFollowed) {
  constexpr int kSize = 64;
  for (int k = 0; k < 24; ++k) {
    const PictureLight light = band(0.131 * k, 30.7, 33.1, -0.75, 0.75);
    const MeanPicture made = picture_by_rays(kSize, kSize, {}, light);
    double most = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        most = std::max(most, std::abs(static_cast<double>(made.map.at(x, y)[0]) - midpoint_mean(x, y, 24, light)));
    EXPECT_LT(most, 0.3) << k;
  }
}

// The first rays are a pixel apart, so that no disc of this radius is missed.
TEST(PixelMeans, DotsOfAPixelAreNotMissed) {
  constexpr int kSize = 128, kApart = 16;
  constexpr double kRadius = 0.75;
  const auto centre = [](int i, int j) {
    const double a = std::fmod(0.754877666 * (i + 8 * j), 1.0), b = std::fmod(0.569840291 * (i + 8 * j), 1.0);
    return std::array{kApart * (i + 0.5) + a, kApart * (j + 0.5) + b};
  };
  const PictureLight light = [&](double x, double y) {
    const auto c = centre(static_cast<int>(x) / kApart, static_cast<int>(y) / kApart);
    return std::hypot(x - c[0], y - c[1]) < kRadius ? 1.0f : 0.0f;
  };
  const MeanPicture made = picture_by_rays(kSize, kSize, {}, light);
  for (int j = 0; j < kSize / kApart; ++j)
    for (int i = 0; i < kSize / kApart; ++i) {
      double sum = 0;
      for (int y = kApart * j; y < kApart * (j + 1); ++y)
        for (int x = kApart * i; x < kApart * (i + 1); ++x) sum += static_cast<double>(made.map.at(x, y)[0]);
      EXPECT_NEAR(sum, std::numbers::pi * kRadius * kRadius, 0.5) << i << " " << j;
    }
}

TEST(PixelMeans, WithoutAToleranceAllPixelsHaveTheirSamples) {
  for (int samples = 2; samples <= 8; ++samples) {
    const MeanPicture made = picture_by_rays(33, 20, {samples, 0}, [](double, double) { return 0.25f; });
    EXPECT_GE(static_cast<double>(made.rays), 0.8 * samples * samples * 33 * 20) << samples;
    for (const auto& p : made.map.pixels) EXPECT_NEAR(p[0], 0.25f, 1e-6f);
  }
  EXPECT_EQ(picture_by_rays(33, 20, {1, 0}, [](double, double) { return 0.25f; }).rays, 33u * 20u);
}

TEST(PixelMeans, ErrorsFallWithTheTolerance) {
  const PictureLight light = [](double x, double y) {
    return static_cast<float>(0.5 + 0.4 * std::sin(0.8 * x + 0.3 * y) * std::cos(0.5 * y));
  };
  double before = 1e9;
  std::size_t rays = 0;
  for (const double error : {8.0, 2.0, 0.5}) {
    const MeanPicture made = picture_by_rays(64, 64, {3, error}, light);
    double squares = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        squares += std::pow(255 * (static_cast<double>(made.map.at(x, y)[0]) - midpoint_mean(x, y, 24, light)), 2);
    const double rms = std::sqrt(squares / (64 * 64));
    EXPECT_LT(rms, before);
    EXPECT_LT(rms, error);
    EXPECT_GT(made.rays, rays);
    before = rms, rays = made.rays;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
