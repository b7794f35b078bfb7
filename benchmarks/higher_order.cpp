// Benchmark of cells of higher order: errors and times of reconstructions that follow the cells' own shape functions,
// beside the same nodes as linear pieces, and the corners alone as linear cells.
//
//   benchmark_higher_order [--size=N] [METHOD...]
//
//   --size=N   hexahedra per direction (times six tetrahedra); default: 8
//   METHOD     default: linear, mls-detail, mls, amls
//
// Per grid and method: mean and largest error at 50,000 points, both as shares of those of the cells' own functions in
// the last columns, and CPU seconds of the fit and of a million values.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "benchmark_inputs.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "timing.h"
#include "volume/higher_order_grids.h"

namespace {

using namespace sansmesh;

double field_of_waves(const Vec3& x) {
  return std::sin(7 * x.x + 2 * x.y) + 0.5 * std::cos(6 * x.y - 5 * x.z) * (1 + x.z) + 0.3 * std::sin(9 * x.z);
}
Vec3 slightly_bent(const Vec3& x) {
  return {x.x + 0.04 * std::sin(2.5 * x.y + 4 * x.z), x.y + 0.03 * std::cos(5 * x.x - x.z), x.z + 0.05 * x.x * x.y};
}

/// Only the corners, as linear cells.
GridData corners_of(const test::HigherOrderGrid& grid) {
  test::HigherOrderGrid coarse = grid;
  coarse.p = 1;
  if (coarse.family == HigherOrderFamily::hexahedron_20) coarse.family = HigherOrderFamily::hexahedron;
  return test::without_higher_order(test::higher_order_grid(coarse, field_of_waves));
}

struct Measured {
  double mean = 0, most = 0;
};

Measured measure(const std::string& label, const std::shared_ptr<const SampledVolume>& volume,
                 const std::string& method, const std::vector<Vec3>& x, const Measured& own) {
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = method;
  options.smoothing = 0;
  const double before = process_cpu_seconds();
  const auto field = reconstruct_volume(volume, "f", options, progress);
  const double fitted = process_cpu_seconds();
  std::vector<double> values(x.size());
  field->evaluate(x, {values});
  const double done = process_cpu_seconds();
  Measured m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double e = std::abs(values[i] - field_of_waves(x[i]));
    m.mean += e / static_cast<double>(x.size()), m.most = std::max(m.most, e);
  }
  fmt::print("| {} | {} | {:.2e} | {:.2e} | {} | {} | {:.2f} | {:.2f} |\n", label, method, m.mean, m.most,
             own.mean > 0 ? fmt::format("{:.2f}", m.mean / own.mean) : "1",
             own.mean > 0 ? fmt::format("{:.2f}", m.most / own.most) : "1", fitted - before,
             (done - fitted) * 1e6 / static_cast<double>(x.size()));
  return m;
}

void run(const std::string& name, const test::HigherOrderGrid& grid, const std::vector<std::string>& methods) {
  Progress progress;
  const auto assembled = [&](const GridData& data) {
    return std::make_shared<const SampledVolume>(assemble_volume(data, Association::points, progress));
  };
  const GridData data = test::higher_order_grid(grid, field_of_waves);
  const auto own = assembled(data), pieces = assembled(test::without_higher_order(data)),
             corners = assembled(corners_of(grid));
  const std::vector<Vec3> x = benchmark::points_inside(*own, 50'000);
  const Measured best = measure(name, own, "linear", x, {});
  for (const std::string& method : methods) {
    if (method != "linear") measure(name, own, method, x, best);
    measure(name + ", pieces", pieces, method, x, best);
    measure(name + ", corners", corners, method, x, best);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> methods;
  std::size_t size = 8;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("--size="))
      size = std::stoul(word.substr(7));
    else
      methods.push_back(word);
  }
  if (methods.empty()) methods = {"linear", "mls-detail", "mls", "amls"};
  fmt::print(
      "| grid | method | mean | largest | mean / own | largest / own | fit, CPU s | 10⁶ values, CPU s |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|\n");
  for (const bool straight : {true, false}) {
    const std::string how = straight ? "" : ", curved";
    const auto map = [](const Vec3& p) { return slightly_bent(p); };
    run("tetrahedra of 10" + how, {HigherOrderFamily::tetrahedron, size, 2, map, straight}, methods);
    run("hexahedra of 20" + how, {HigherOrderFamily::hexahedron_20, size, 2, map, straight}, methods);
    run("hexahedra of 27" + how, {HigherOrderFamily::hexahedron, size, 2, map, straight}, methods);
  }
}
