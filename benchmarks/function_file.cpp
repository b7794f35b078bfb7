// Benchmark of function files: fitting, writing, reading (with and without samples, mapped and gzipped), the first
// evaluation and the mesh.
//
//   benchmark_function_file [CLOUD] [FOLDER=.] [THREADS=all]
//
// CLOUD: any file of points; default: 400,000 samples of a ball. The written files are removed. Reading is measured
// from the system's cache; from a disk, its transfer time is added.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io.h"
#include "timing.h"

using namespace sansmesh;

namespace {

PointSet ball(std::size_t n) {
  PointSet points;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(n), r = std::sqrt(1 - z * z);
    const double phi = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec3 d{r * std::cos(phi), r * std::sin(phi), z};
    points.positions.emplace_back(d * (1 + 0.05 * std::sin(9 * d.x) * std::sin(9 * d.y)));
  }
  return points;
}

}  // namespace

int main(int argc, char** argv) {
  const ThreadScope threads(argc > 3 ? std::atoi(argv[3]) : 0);
  const std::filesystem::path folder = argc > 2 ? argv[2] : ".";
  PointSet points;
  const double load = time_of([&] { points = argc > 1 ? read_points(argv[1]) : ball(400000); }).wall;
  const std::size_t samples = points.size();
  Progress progress;
  std::optional<FittedFunction> function;
  const double fit = time_of([&] { function.emplace(fit_surface_function(std::move(points), {}, progress)); }).wall;
  std::printf("| what | seconds | bytes | fit / this |\n|---|---:|---:|---:|\n");
  const auto row = [&](const char* what, double seconds, unsigned long long bytes = 0) {
    if (bytes > 0) {
      std::printf("| %s | %.4f | %llu | %.1f |\n", what, seconds, bytes, fit / seconds);
    } else {
      std::printf("| %s | %.4f | | %.1f |\n", what, seconds, fit / seconds);
    }
  };
  std::printf("| read the cloud, %zu points | %.4f | | |\n", samples, load);
  row("fit", fit);
  struct Kind {
    const char *written, *read, *ending;
    bool with_samples;
  };
  for (const Kind& kind : {Kind{"write", "read", ".smf", true}, Kind{"write without samples", "read it", ".smf", false},
                           Kind{"write gzipped", "read it", ".smf.gz", true}}) {
    const std::string file = (folder / (std::string("benchmark_function_file") + kind.ending)).string();
    const double write = time_of([&] { write_fitted_function(file, *function, kind.with_samples); }).wall;
    const auto bytes = std::filesystem::file_size(file);
    row(kind.written, write, bytes);
    row(kind.read, fastest_of(5, [&] { read_fitted_function(file); }).wall, bytes);
    std::filesystem::remove(file);
  }
  row("mesh", time_of([&] { mesh_function(*function, {}, progress); }).wall);
}
