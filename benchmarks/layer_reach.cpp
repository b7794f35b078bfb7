// Benchmark of the projections onto layers of samples: distance from which one step finds the right point
// (tejada2008, 5.2, figure 5.1), for the predictor alone, the corrector alone, and both.
//
//   benchmark_layer_reach [FILE VALUE]   an isosurface of a volume (default: a ball of radius 16 samples, blurred by
//                                        one, 2 % of noise)
//
// Points of the surface are moved along its normal by a distance to either side. A result is right if it is within 0.15
// spacings of the surface and within one spacing of the point. Prints a markdown table of shares.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/dataset/mesh_volume_surface.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/dataset/volume_surface.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/layer_projection.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_slopes.h"

namespace {

using namespace sansmesh;

constexpr double kFarthest =
    6;  // radius of the balls in spacings, so that the operator is defined everywhere in the test

GridData noisy_ball() {
  constexpr std::size_t kSide = 48;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.02);
  GridBlock block;
  block.kind = GridKind::lattice;
  for (std::vector<double>& axis : block.axes)
    for (std::size_t i = 0; i < kSide; ++i) axis.push_back(static_cast<double>(i));
  std::vector<double> values;
  for (const double z : block.axes[2])
    for (const double y : block.axes[1])
      for (const double x : block.axes[0]) {
        const double d = norm(Vec3{x, y, z} - Vec3{23.7, 23.2, 24.1}) - 16;
        values.push_back(0.5 * std::erfc(d / std::numbers::sqrt2) + noise(random));
      }
  block.point_arrays.set("f", std::move(values));
  GridData data;
  data.blocks.push_back(std::move(block));
  return data;
}

/// The samples near the isosurface, weighted as in volume_surface.cpp, without its treatment of plateaus and uneven
/// grids.
LayerSamples layer_of(const SampledVolume& volume, const std::vector<double>& values, double value) {
  const SampleSlopes slopes(volume, values);
  std::vector<Vec3f> positions;
  std::vector<std::size_t> samples;
  std::vector<float> away;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double steep = norm(slopes.gradient(i)) * slopes.spacing(i);
    const double d = steep > 0 ? std::abs(values[i] - value) / steep : 9;
    if (d > 2.2) continue;
    positions.emplace_back(volume.position(i));
    samples.push_back(i);
    away.push_back(static_cast<float>(d));
  }
  LayerSamples layer;
  const KdTree tree(positions);
  for (const std::uint32_t i : tree.order()) {
    const auto s = static_cast<float>(slopes.spacing(samples[i]));
    layer.positions.push_back(positions[i]);
    layer.normals.push_back(Vec3f(normalized(slopes.gradient(samples[i]) * -1.0)));
    layer.weights.push_back(std::exp(-away[i] * away[i]));
    layer.spacing.push_back(s);
    layer.reach.push_back(s * static_cast<float>(kFarthest));
  }
  return layer;
}

void run(int argc, char** argv) {
  Progress progress;
  VolumeDataset dataset(argc > 2 ? read_volume(argv[1]) : noisy_ball());
  const double value = argc > 2 ? std::atof(argv[2]) : 0.5;
  const std::string name = dataset.default_array().name;
  const auto volume = dataset.volume(name, progress);
  const std::vector<double> values = volume_values(*volume, name).values;

  VolumeSurfaceOptions options;
  options.value = value;
  const VolumeSurface surface = make_volume_surface(volume, values, 0, options, progress);
  const PointSet truth = sample_volume_surface(surface, {}, progress);
  const double spacing = surface.report().spacing;
  const LayerSamples layer = layer_of(*volume, values, value);

  fmt::print(
      "{} points of the surface, spacing {:.3g}\n\n| from (spacings) | predictor | corrector | both "
      "|\n|--:|--:|--:|--:|\n",
      truth.size(), spacing);
  for (const double distance : {0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0}) {
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < truth.size(); ++i)
      for (const double side : {-1.0, 1.0})
        x.push_back(truth.origin + Vec3(truth.positions[i]) + Vec3(truth.normals[i]) * (side * distance * spacing));
    std::array<double, 3> shares{};
    for (std::size_t k = 0; k < 3; ++k) {
      LayerOptions how;
      how.smoothing = surface.report().smoothing;
      how.predictor = k != 1, how.corrector = k != 0;
      const LayerProjection projection(layer, how);
      std::vector<FootPoint> feet(x.size());
      projection.project(x, feet);
      std::size_t right = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3 d = feet[i].position - truth.origin - Vec3(truth.positions[i / 2]);
        right += feet[i].defined && norm(d) < spacing && std::abs(dot(d, Vec3(truth.normals[i / 2]))) < 0.15 * spacing;
      }
      shares[k] = static_cast<double>(right) / static_cast<double>(x.size());
    }
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} |\n", distance, shares[0], shares[1], shares[2]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_layer_reach: {}\n", error.what());
    return 1;
  }
}
