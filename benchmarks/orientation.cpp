// Benchmark of the signs of normals: samples closed meshes with known normals, adds noise, discards the normals,
// estimates and orients them as `prepare_cloud` does, and counts wrong signs.
//
//   benchmark_orientation [--samples N] [--noise PERCENT] [--only TEXT] [--data FOLDER] [--closed]
//
// A sign is wrong if the normal points against the true one. Open shapes have no outside: there, the better of both
// common signs counts. Noise: standard deviation of each coordinate, in % of the diagonal.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/io.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/shape/face_shape.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"
#include "timing.h"

using namespace sansmesh;

namespace {

struct Options {
  std::vector<std::size_t> samples;
  std::vector<double> noise;
  std::string only, data = "../shared/data/points";
  bool closed = false;  ///< closed shapes only
};

struct Sums {
  double wrong = 0, least = 0, worst = 0, normals = 0, orientation = 0;
  int rows = 0, certain = 0, falsely_certain = 0;
};

/// Sums over the closed shapes, by number of samples and noise.
std::map<std::pair<std::size_t, double>, Sums> sums;

PointSet stripped(const PointSet& points) {
  PointSet bare;
  bare.positions = points.positions;
  return bare;
}

void add_noise(PointSet& points, double percent, unsigned seed) {
  if (percent == 0) return;
  std::mt19937 random(seed);
  const Vec3f size = bounds(points).size();
  std::normal_distribution<float> g(0, static_cast<float>(percent / 100) * norm(size));
  for (Vec3f& p : points.positions) p += Vec3f{g(random), g(random), g(random)};
}

/// Wrong signs, in %, of a method that knows the surface and takes the normal of the nearest sample without noise.
double least_wrong(const PointSet& points, const PointSet& truth, const PointSet& exact) {
  const KdTree tree(exact.positions);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto nearest = tree.nearest(points.positions[i]);
    if (!nearest) continue;
    const Vec3f n = exact.normals[nearest->index];
    wrong += (dot(points.normals[i], n) > 0) != (dot(points.normals[i], truth.normals[i]) > 0);
  }
  return 100 * static_cast<double>(wrong) / static_cast<double>(points.size());
}

/// `truth`: samples with true normals; `exact`: the same surface without noise. Prints a row.
void measure(const std::string& name, const PointSet& truth, const PointSet& exact, double noise, bool open) {
  PointSet points = stripped(truth);
  Progress progress;
  OrientationOptions orientation;
  OrientBy by = OrientBy::automatic;
  Time estimating, orienting;
  KdTree tree;
  estimating = time_of([&] {
    orientation.noise = estimate_noise(points);
    tree = KdTree(points.positions);
    NormalOptions normals;
    normals.spacing = estimate_spacing(points), normals.noise = orientation.noise;
    estimate_normals(points, tree, normals, progress);
  });
  orienting = time_of([&] { by = orient_normals(points, tree, orientation, progress); });
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) wrong += !(dot(points.normals[i], truth.normals[i]) > 0);
  if (open) wrong = std::min(wrong, points.size() - wrong);
  const double percent = 100 * static_cast<double>(wrong) / static_cast<double>(points.size());
  const double least = least_wrong(points, truth, exact);
  const OrientationReport report = measure_orientation(points, orientation.noise);
  std::printf("| %-18s | %7zu | %4.2f | %7.3f | %7.3f | %-9s | %6.4f | %5.3f | %6.2f | %6.2f | %s\n", name.c_str(),
              points.size(), noise, percent, least, report.certain() ? "certain" : "", report.agreement, report.doubt,
              estimating.cpu, orienting.cpu, by == OrientBy::propagation ? "|" : "by sensor |");
  std::fflush(stdout);
  if (open) return;
  Sums& s = sums[{truth.size(), noise}];
  s.wrong += percent, s.least += least, s.worst = std::max(s.worst, percent);
  s.normals += estimating.cpu, s.orientation += orienting.cpu;
  ++s.rows, s.certain += report.certain(), s.falsely_certain += report.certain() && percent > 5;
}

/// Samples in an order without relation to the surface.
PointSet shuffled(const PointSet& points, unsigned seed) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  PointSet result;
  for (const std::size_t i : order)
    result.positions.push_back(points.positions[i]), result.normals.push_back(points.normals[i]);
  return result;
}

PointSet samples_of(const PointSet& mesh, std::size_t count, double noise) {
  PointSet points = shuffled(sample_faces(mesh, count), 1);
  add_noise(points, noise, 2);
  return points;
}

/// Samples that a direction sees, ignoring occlusion.
PointSet half_of(const PointSet& points, const Vec3f& direction) {
  PointSet half;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (dot(points.normals[i], direction) > 0.2f)
      half.positions.push_back(points.positions[i]), half.normals.push_back(points.normals[i]);
  return half;
}

/// Square plate of edge 1 with `count` samples; thickness in spacings.
PointSet plate(std::size_t count, double thickness) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0, 1);
  const auto half = static_cast<float>(thickness * std::sqrt(2 / static_cast<double>(count)) / 2);
  const float rim = 8 * half / (2 + 8 * half);
  PointSet points;
  for (std::size_t i = 0; i < count; ++i) {
    const float side = u(random) < 0.5f ? -1.0f : 1.0f;
    if (u(random) < rim) {
      const float t = u(random), z = half * (2 * u(random) - 1), end = side > 0 ? 1 : 0;
      const bool along_x = u(random) < 0.5f;
      points.positions.push_back(along_x ? Vec3f{t, end, z} : Vec3f{end, t, z});
      points.normals.push_back(along_x ? Vec3f{0, side, 0} : Vec3f{side, 0, 0});
    } else {
      points.positions.push_back({u(random), u(random), side * half});
      points.normals.push_back({0, 0, side});
    }
  }
  return points;
}

constexpr std::pair<const char*, const char*> kShapes[] = {{"horse", "horse.ply"},
                                                           {"armadillo", "armadillo_43k.obj"},
                                                           {"igea", "igea_gt.ply"},
                                                           {"rocker-arm", "rocker-arm.obj"},
                                                           {"fandisk", "fandisk.off"},
                                                           {"fertility", "fertility_4k.off"},
                                                           {"max-planck", "max-planck_5k.obj"},
                                                           {"cad_part1", "cad_part1.stl"},
                                                           {"chinese-dragon", "chinese-dragon_10k.off"}};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const auto next = [&] { return std::string(i + 1 < argc ? argv[++i] : ""); };
    if (!std::strcmp(argv[i], "--samples"))
      options.samples.push_back(std::stoul(next()));
    else if (!std::strcmp(argv[i], "--noise"))
      options.noise.push_back(std::stod(next()));
    else if (!std::strcmp(argv[i], "--only"))
      options.only = next();
    else if (!std::strcmp(argv[i], "--data"))
      options.data = next();
    else if (!std::strcmp(argv[i], "--closed"))
      options.closed = true;
  }
  if (options.samples.empty()) options.samples = {1500, 20000};
  if (options.noise.empty()) options.noise = {0, 0.25, 1};
  std::printf(
      "| shape | samples | noise | wrong %% | least %% | | agreement | doubt | normals, CPU s | orientation, CPU s | "
      "|\n"
      "|---|---:|---:|---:|---:|---|---:|---:|---:|---:|---|\n");
  const auto wanted = [&](const std::string& name) {
    return name.find(options.only) != std::string::npos || options.only.find(name) != std::string::npos;
  };
  for (const auto& [name, file] : kShapes) {
    if (!wanted(name)) continue;
    PointSet mesh = read_points((std::filesystem::path(options.data) / file).string());
    if (face_sides(mesh) == FaceSides::inward)
      for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    if (face_sides(mesh) != FaceSides::outward) std::printf("| %s: its faces do not bound a solid |\n", name);
    const PointSet exact = sample_faces(mesh, 100000);
    for (const std::size_t n : options.samples)
      for (const double noise : options.noise) measure(name, samples_of(mesh, n, noise), exact, noise, false);
    for (const std::size_t n : options.samples) {
      if (options.closed) break;
      const std::string half = std::string(name) + ", half";
      PointSet seen = half_of(samples_of(mesh, 2 * n, 0), normalized(Vec3f{0.3f, -0.4f, 0.85f}));
      measure(half, seen, exact, 0, true);
      add_noise(seen, 0.25, 4);
      measure(half, seen, exact, 0.25, true);
    }
  }
  for (const std::size_t n : options.samples)
    for (const double thickness : {2.0, 3.0})
      if (const std::string name = "plate " + std::to_string(static_cast<int>(thickness)); wanted(name))
        for (const double noise : {0.0, 0.2}) {
          // `noise` is in spacings, as the thickness.
          const PointSet exact = plate(n, thickness);
          PointSet points = exact;
          add_noise(points, 100 * noise * std::sqrt(2 / static_cast<double>(n)) / std::numbers::sqrt2, 5);
          measure(name + ", " + std::to_string(noise).substr(0, 3), points, exact, 0, true);
        }
  std::printf(
      "\n| samples | noise | mean wrong %% | least %% | worst | certain | certain with over 5 %% wrong | CPU s |\n");
  for (const auto& [key, s] : sums)
    std::printf("| %zu | %.2f | %.3f | %.3f | %.3f | %d of %d | %d | %.2f + %.2f |\n", key.first, key.second,
                s.wrong / s.rows, s.least / s.rows, s.worst, s.certain, s.rows, s.falsely_certain, s.normals,
                s.orientation);
  return 0;
}
