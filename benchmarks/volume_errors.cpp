// Benchmark of errors of volume reconstructions between the samples: test functions of the thesis sampled on a grid and
// evaluated at random interior points, beside the grid's own linear interpolation.
//
//   benchmark_volume_errors [OPTION...] FILE...|GRID...
//
//   FILE              a volume; several files joined by '+' are its blocks
//   GRID              synthetic: lattice, stretched, bent, layers, o-grid, tets, o-tets, mixed, scattered, amr,
//                     overlapping
//   --methods=A,B     default: all; linear is always first
//   --cells           samples in cells; default: at their corners
//   --means           samples in cells, means over them instead of values at centres
//   --overlap=SHIFT   structured blocks as two overlapping ones, the second moved by that share of its cells
//   --tets            split cells of structured grids into tetrahedra
//   --count=N         query points; default: 100,000
//   --by-cells        random points in random cells, so that small cells have the same weight as large ones
//   --size=N          points per axis of synthetic grids; default: 20
//
// Coordinates are normalised by the bounding box. Errors are mean and maximum, also relative to linear interpolation.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_inputs.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "sansmesh/volume/samples/cell_quadrature.h"
#include "thesis_functions.h"
#include "volume/overlapping_halves.h"
#include "volume/volume_grids.h"
#include "volume/volume_points.h"

namespace {

using namespace sansmesh;
using benchmark::f1, benchmark::f2, benchmark::f3;
using benchmark::split, benchmark::points_inside;

struct Options {
  std::vector<std::string> methods, grids;
  bool cells = false, means = false, tets = false, by_cells = false;
  double overlap = 0;  // no overlap
  std::size_t count = 100000, size = 20;
};

GridData made_up(const std::string& name, std::size_t n, bool& found) {
  const auto zero = [](const Vec3&) { return 0.0; };
  found = true;
  if (name == "lattice") return test::lattice_grid({n, n, n}, zero);
  if (name == "stretched") return test::stretched_grid({n, n, n}, zero, 1.2);
  if (name == "bent") return test::bent_grid({n, n, n}, zero);
  if (name == "layers") return test::bent_grid({n, n, n}, zero, 1.5);
  if (name == "o-grid") return test::o_grid({2 * n + 1, n, n}, zero);
  if (name == "tets") return test::tetrahedra_grid({n, n, n}, zero);
  if (name == "o-tets") return test::one_block(test::tetrahedra_of(test::o_grid_block({2 * n + 1, n, n})), zero);
  if (name == "mixed") return test::mixed_grid({n, n, n}, zero);
  if (name == "scattered") return test::scattered_grid(n * n * n, zero);
  if (name == "amr") return test::two_level_amr(n / 4 * 4, zero);
  if (name == "overlapping") return test::three_overlapping_blocks(n, zero);
  found = false;
  return {};
}

/// Means over the cells of samples.
template <class F>
void set_means(const SampledVolume& volume, const F& f, std::vector<double>& values) {
  const CellQuadrature cells(volume);
  std::vector<QuadraturePoint> points;
  for (std::size_t i = 0; i < values.size(); ++i) {
    cells.fine_points(static_cast<std::uint32_t>(i), volume.positions[i], points);
    values[i] = 0;
    for (const QuadraturePoint& q : points) values[i] += q.weight * f(volume.positions[i] + q.x);
  }
}

void measure(const std::string& name, const Options& options) {
  Progress progress;
  bool found = false;
  GridData data = made_up(name, options.size, found);
  if (!found) data = read_volumes(split(name, '+'));
  if (options.overlap > 0) {
    std::vector<GridBlock> halves;
    for (const GridBlock& block : data.blocks)
      for (GridBlock& half : test::overlapping_halves(block, options.overlap)) halves.push_back(std::move(half));
    data.blocks = std::move(halves);
  }
  if (options.tets)
    for (GridBlock& block : data.blocks)
      if (block.kind == GridKind::lattice || block.kind == GridKind::curvilinear) {
        const auto hidden = block.hidden_points;
        block = test::tetrahedra_of(block);
        block.hidden_points = hidden;
      }
  for (GridBlock& block : data.blocks) {
    block.point_arrays.clear(), block.cell_arrays.clear();
    if (block.kind == GridKind::lattice)
      for (const auto& axis : block.axes)
        if (axis.size() < 2) throw DataError("a layer: errors are measured in volumes only");
    test::set_function(block, [](const Vec3&) { return 0.0; });
  }
  const double start = process_cpu_seconds();
  SampledVolume made = assemble_volume(data, options.cells ? Association::cells : Association::points, progress);
  const double assembled = process_cpu_seconds() - start;
  data = {};
  const Box3 box = made.bounds();
  const Vec3 size = box.size();
  const auto normal = [&](const Vec3& x) {
    const Vec3 d = x - box.lower;
    return Vec3{d.x / size.x, d.y / size.y, d.z / size.z};
  };
  double (*const functions[])(const Vec3&) = {f1, f2, f3};
  for (int f = 0; f < 3; ++f) {
    std::vector<double> values(made.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = functions[f](normal(made.position(i)));
    if (options.means && !made.lattice)
      set_means(
          made, [&](const Vec3& x) { return functions[f](normal(x)); }, values);
    made.attributes.set(fmt::format("f{}", f + 1), std::move(values));
  }
  const auto volume = std::make_shared<const SampledVolume>(std::move(made));
  const auto x = options.by_cells ? test::points_within(*volume, options.count) : points_inside(*volume, options.count);
  const VolumeFacts& facts = volume->facts;
  fmt::print(
      "\n{}: {}{}, {} samples, {} cells, aspect {:.3g}, {} merged, {} degenerate, {} overlapped; assembled in "
      "{:.2f} CPU s\n",
      name, facts.grid, options.cells ? " (cells)" : "", volume->size(), volume->cells.size(), facts.aspect,
      facts.merged, facts.degenerate, facts.overlapped, assembled);
  fmt::print("{:<12} {:>2} {:>10} {:>10} {:>8} {:>8} {:>10} {:>8} {:>8}\n", "method", "", "mean", "max", "mean/lin",
             "max/lin", "not finite", "fit s", "ask s");
  double linear_mean[3] = {}, linear_max[3] = {};
  for (const std::string& method : options.methods) {
    VolumeReconstructionOptions wanted;
    wanted.method = method;
    for (int f = 0; f < 3; ++f) {
      try {
        const double before = process_cpu_seconds();
        const auto field = reconstruct_volume(volume, fmt::format("f{}", f + 1), wanted, progress);
        const double fitted = process_cpu_seconds();
        std::vector<double> values(x.size());
        field->evaluate(x, {values});
        const double asked = process_cpu_seconds();
        double sum = 0, most = 0;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
          const double error = std::abs(values[i] - functions[f](normal(x[i])));
          if (!std::isfinite(error)) {
            ++wrong;
            continue;
          }
          sum += error, most = std::max(most, error);
        }
        const double mean = sum / static_cast<double>(x.size());
        if (method == "linear") linear_mean[f] = mean, linear_max[f] = most;
        fmt::print("{:<12} f{} {:>10.3e} {:>10.3e} {:>8.3f} {:>8.3f} {:>10} {:>8.3f} {:>8.3f}{}\n", method, f + 1, mean,
                   most, mean / linear_mean[f], most / linear_max[f], wrong, fitted - before, asked - fitted,
                   most > linear_max[f] * (1 + 1e-9) ? "  WORSE" : "");
      } catch (const ArgumentError& e) {
        fmt::print("{:<12} f{} {}\n", method, f + 1, e.what());
      }
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::vector<std::string> methods;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string_view a = argv[i];
      if (a.starts_with("--methods="))
        methods = split(a.substr(10), ',');
      else if (a == "--cells")
        options.cells = true;
      else if (a == "--means")
        options.cells = options.means = true;
      else if (a == "--tets")
        options.tets = true;
      else if (a.starts_with("--overlap="))
        options.overlap = std::stod(std::string(a.substr(10)));
      else if (a == "--by-cells")
        options.by_cells = true;
      else if (a.starts_with("--count="))
        options.count = std::stoul(std::string(a.substr(8)));
      else if (a.starts_with("--size="))
        options.size = std::stoul(std::string(a.substr(7)));
      else if (a.starts_with("--"))
        throw ArgumentError("unknown option " + std::string(a));
      else
        options.grids.emplace_back(a);
    }
    if (methods.empty())
      for (const VolumeMethod* const info : VolumeMethod::registry().all()) methods.emplace_back(info->name);
    std::erase(methods, "linear");
    methods.insert(methods.begin(), "linear");
    options.methods = methods;
    if (options.grids.empty()) throw ArgumentError("which grids or files?");
    for (const std::string& grid : options.grids) measure(grid, options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "benchmark_volume_errors: {}\n", e.what());
    return 1;
  }
  return 0;
}
