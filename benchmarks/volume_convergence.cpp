// Benchmark of the convergence of volume reconstructions: the test functions of tejada2008, 6.3 on the unit cube, on
// grids of 9, 17, 33 … points per axis, at the samples and at random points between them. Errors at the samples do not
// predict errors between them.
//
//   benchmark_volume_convergence [OPTION...]
//
//   --methods=A,B     default: all; methods that do not support a grid are left out
//   --grids=A,B       of lattice, stretched, layers (stretched and bent), tets; all by default
//   --levels=N        number of grids in a sequence, 1..5; default: 3
//   --count=N         points between samples, and samples, at most; default: 20,000
//
// Orders are base-2 logarithms of the ratio of mean errors in successive rows.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_inputs.h"
#include "sansmesh/error.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "thesis_functions.h"
#include "volume/volume_grids.h"

namespace {

using namespace sansmesh;
using benchmark::split;
using Function = double (*)(const Vec3&);
constexpr Function kFunctions[] = {benchmark::f1, benchmark::f2, benchmark::f3};

GridData grid_of(const std::string& name, std::size_t n, Function f) {
  // All grids use the same map of the cube: spacings grow by a factor of eight from one end to the other.
  const double growth = std::pow(8, 1 / static_cast<double>(n - 2));
  if (name == "lattice") return test::lattice_grid({n, n, n}, f);
  if (name == "stretched") return test::stretched_grid({n, n, n}, f, growth);
  if (name == "layers") return test::bent_grid({n, n, n}, f, growth);
  if (name == "tets") return test::tetrahedra_grid({n, n, n}, f);
  throw ArgumentError("unknown grid " + name);
}

struct Errors {
  double mean = 0, most = 0;
};

Errors errors_at(const VolumeField& field, const std::vector<Vec3>& x, Function f) {
  std::vector<double> values(x.size());
  std::vector<std::uint8_t> inside(x.size());
  field.evaluate(x, {values, {}, inside});
  Errors errors;
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!inside[i]) continue;
    const double error = std::abs(values[i] - f(x[i]));
    errors.mean += error, ++count;
    errors.most = std::max(errors.most, error);
  }
  errors.mean /= static_cast<double>(std::max<std::size_t>(count, 1));
  return errors;
}

void converge(const std::string& grid, const std::string& method, int levels, std::size_t count) {
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = method;
  for (int f = 0; f < 3; ++f) {
    double before = 0;
    for (int level = 0; level < levels; ++level) {
      const std::size_t n = (std::size_t{8} << level) + 1;
      const auto volume = std::make_shared<const SampledVolume>(
          assemble_volume(grid_of(grid, n, kFunctions[f]), Association::points, progress));
      std::unique_ptr<VolumeField> field;
      try {
        field = reconstruct_volume(volume, "f", options, progress);
      } catch (const ArgumentError&) {
        return;
      }
      const Box3 box = volume->bounds();
      std::mt19937 random(99);
      const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
      std::vector<Vec3> between(count), samples;
      for (Vec3& p : between)
        for (std::size_t k = 0; k < 3; ++k) p[k] = box.lower[k] + uniform() * box.size()[k];
      for (std::size_t i = 0; i < std::min(count, volume->size()); ++i)
        samples.push_back(volume->position(volume->size() <= count ? i : random() % volume->size()));
      const Errors at = errors_at(*field, samples, kFunctions[f]), off = errors_at(*field, between, kFunctions[f]);
      fmt::print("{:<10} {:<11} f{} {:>4} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e} {:>6}\n", grid, method, f + 1, n,
                 at.mean, at.most, off.mean, off.most,
                 level > 0 ? fmt::format("{:.2f}", std::log2(before / off.mean)) : "");
      std::fflush(stdout);
      before = off.mean;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::vector<std::string> methods, grids{"lattice", "stretched", "layers", "tets"};
    int levels = 3;
    std::size_t count = 20000;
    const auto number = [](std::string_view text, auto& value) {
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size() || value < 1)
        throw ArgumentError("not a number of at least 1: " + std::string(text));
    };
    for (int i = 1; i < argc; ++i) {
      const std::string_view a = argv[i];
      if (a.starts_with("--methods="))
        methods = split(a.substr(10));
      else if (a.starts_with("--grids="))
        grids = split(a.substr(8));
      else if (a.starts_with("--levels="))
        number(a.substr(9), levels);
      else if (a.starts_with("--count="))
        number(a.substr(8), count);
      else
        throw ArgumentError("unknown option " + std::string(a));
    }
    if (methods.empty())
      for (const VolumeMethod* const info : VolumeMethod::registry().all()) methods.emplace_back(info->name);
    fmt::print("{:<10} {:<11}    {:>4} {:>10} {:>10} {:>10} {:>10} {:>6}\n", "grid", "method", "n", "samples", "max",
               "between", "max", "order");
    for (const std::string& grid : grids)
      for (const std::string& method : methods) converge(grid, method, std::min(levels, 5), count);
  } catch (const std::exception& e) {
    fmt::print(stderr, "benchmark_volume_convergence: {}\n", e.what());
    return 1;
  }
  return 0;
}
