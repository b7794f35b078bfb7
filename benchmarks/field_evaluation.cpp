// Benchmark of evaluations of the adaptive partition of unity: fits samples of a bumpy ball and evaluates the function
// near the surface and in the whole box, with and without gradients.
//
//   benchmark_field_evaluation [SAMPLES=400000] [EVALUATIONS=1000000] [THREADS=all]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "timing.h"

using namespace sansmesh;

namespace {

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  const Vec3 v{gauss(random), gauss(random), gauss(random)};
  return normalized(v);
}

/// A ball of radius 1 with bumps of height 0.1: zero on the surface and negative inside.
double ball(const Vec3& p) { return norm(p) - 1 - 0.1 * std::sin(6 * p.x) * std::sin(6 * p.y) * std::sin(6 * p.z); }

Vec3 ball_gradient(const Vec3& p) {
  const double h = 1e-5;
  return Vec3{ball({p.x + h, p.y, p.z}) - ball({p.x - h, p.y, p.z}),
              ball({p.x, p.y + h, p.z}) - ball({p.x, p.y - h, p.z}),
              ball({p.x, p.y, p.z + h}) - ball({p.x, p.y, p.z - h})} /
         (2 * h);
}

/// The surface point in a direction, by bisection along the ray.
Vec3 on_ball(const Vec3& direction) {
  double inside = 0.5, outside = 1.5;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (inside + outside);
    (ball(direction * middle) < 0 ? inside : outside) = middle;
  }
  return direction * (0.5 * (inside + outside));
}

PointSet bumpy_ball(std::size_t count) {
  std::mt19937_64 random(1);
  PointSet points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = on_ball(random_direction(random));
    points.positions.emplace_back(p);
    points.normals.emplace_back(normalized(ball_gradient(p)));
  }
  return points;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t samples = argc > 1 ? std::stoul(argv[1]) : 400000;
  const std::size_t evaluations = argc > 2 ? std::stoul(argv[2]) : 1000000;
  const ThreadScope threads(argc > 3 ? std::atoi(argv[3]) : 0);

  const PointSet points = bumpy_ball(samples);
  Progress progress;
  std::optional<PartitionOfUnity> field;
  const double fit = time_of([&] { field.emplace(fit_partition_of_unity(points, {}, progress)); }).wall;

  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> offset(-0.02, 0.02), anywhere(-1.2, 1.2);
  std::vector<Vec3> near_surface(evaluations), in_box(evaluations);
  for (Vec3& x : near_surface) x = on_ball(random_direction(random)) * (1 + offset(random));
  for (Vec3& x : in_box) x = {anywhere(random), anywhere(random), anywhere(random)};

  std::vector<double> values(evaluations);
  std::vector<Vec3> gradients(evaluations);
  const auto timed = [&](const std::vector<Vec3>& x, bool with_gradients) {
    const Time time =
        time_of([&] { field->evaluate(x, values, with_gradients ? std::span<Vec3>(gradients) : std::span<Vec3>()); });
    return 1e9 / static_cast<double>(evaluations) * time.wall;
  };
  std::printf("| what | figure |\n|---|---:|\n");
  std::printf("| fit to %zu samples, %d threads | %.2f s |\n", samples, thread_count(), fit);
  std::printf("| local functions | %zu |\n", field->functions().size());
  std::printf("| value near the surface | %.0f ns |\n", timed(near_surface, false));
  std::printf("| value and gradient near the surface | %.0f ns |\n", timed(near_surface, true));
  double error = 0;
  field->evaluate(near_surface, values);
  for (std::size_t i = 0; i < evaluations; ++i)
    error += std::abs(values[i] - ball(near_surface[i]) / norm(ball_gradient(near_surface[i])));
  std::printf("| mean difference from the first-order distance | %.2g |\n", error / static_cast<double>(evaluations));
  std::printf("| value anywhere in the box | %.0f ns |\n", timed(in_box, false));
}
