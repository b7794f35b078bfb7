// Benchmark of the trust of `mls-detail`: errors between the samples beside the grid's own interpolation, where fits
// mislead: far fields of airfoils, whose steps grow, overlapping blocks, and measured data of which every second sample
// is left out.
//
//   benchmark_volume_trust [--methods=A,B] [--count=N] [airfoil] [overlapping] [FILE...]
//
//   FILE   a structured block (PLOT3D, .vts): every second sample is left out and compared
//
// Prints rows of a table: the mean and the largest error, and both relative to `linear`.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_inputs.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "thesis_functions.h"
#include "volume/airfoil.h"
#include "volume/volume_grids.h"
#include "volume/volume_points.h"

namespace {

using namespace sansmesh;
using benchmark::f1, benchmark::f2, benchmark::f3;
using benchmark::split, benchmark::points_inside;

struct Options {
  std::vector<std::string> methods{"mls-detail"}, subjects;
  std::size_t count = 50000;
};

/// A volume with values "f" at its samples, points to ask at and the true values there.
struct Case {
  std::string name;
  std::shared_ptr<const SampledVolume> volume;
  std::vector<Vec3> x;
  std::vector<double> truth;
};

void print_case(const Case& c, const Options& options) {
  Progress progress;
  double linear_mean = 0, linear_most = 0;
  for (const std::string& method : options.methods) {
    VolumeReconstructionOptions wanted;
    wanted.method = method, wanted.smoothing = 0;
    if (c.volume->in_cells && method == "mls-detail") wanted.cell_values = CellValues::centres;
    std::vector<double> values(c.x.size());
    reconstruct_volume(c.volume, "f", wanted, progress)->evaluate(c.x, {values});
    double mean = 0, most = 0;
    std::size_t where = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double e = std::abs(values[i] - c.truth[i]);
      mean += e / static_cast<double>(values.size());
      if (e > most) most = e, where = i;
    }
    if (method == "linear") linear_mean = mean, linear_most = most;
    fmt::print("| {} | {} | {:.3e} | {:.3e} | {:.3f} | {:.3f} |{}\n", c.name, method, mean, most, mean / linear_mean,
               most / linear_most,
               most > linear_most * (1 + 1e-9)
                   ? fmt::format(" at {:.4g} {:.4g} {:.4g}", c.x[where].x, c.x[where].y, c.x[where].z)
                   : "");
    std::fflush(stdout);
  }
}

void ask(const std::string& name, const GridData& data, Association association, const test::VolumeFunction& f,
         bool by_cells, const Options& options) {
  Progress progress;
  SampledVolume made = assemble_volume(data, association, progress);
  std::vector<double> values(made.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(made.position(i));
  made.attributes.set("f", std::move(values));
  Case c;
  c.name = name;
  c.volume = std::make_shared<const SampledVolume>(std::move(made));
  c.x = by_cells ? test::points_within(*c.volume, options.count) : points_inside(*c.volume, options.count);
  for (const Vec3& x : c.x) c.truth.push_back(f(x));
  print_case(c, options);
}

void ask_airfoil(const Options& options) {
  for (const double growth : {1.2, 1.5, 2.0})
    for (const bool tets : {false, true})
      for (const Association of : {Association::points, Association::cells})
        for (const auto& [name, f] :
             {std::pair{"pressure", &test::airfoil_pressure}, std::pair{"velocity", &test::airfoil_velocity},
              std::pair{"vortex", &test::decaying_vortex}}) {
          GridData data = test::airfoil_grid(growth, f);
          if (tets) data = test::one_block(test::tetrahedra_of(data.blocks[0]), f);
          ask(fmt::format("airfoil{}, growth {}, {}, {}", tets ? " in tetrahedra" : "", growth,
                          of == Association::cells ? "cells" : "points", name),
              data, of, f, false, options);
        }
}

void ask_overlapping(const Options& options) {
  double (*const functions[])(const Vec3&) = {f1, f2, f3};
  for (const std::size_t n : {8u, 12u, 20u})
    for (const Association of : {Association::points, Association::cells}) {
      Progress progress;
      const GridData data = test::three_overlapping_blocks(n, [](const Vec3&) { return 0.0; });
      const Box3 box = assemble_volume(data, of, progress).bounds();
      for (int k = 0; k < 3; ++k)
        ask(
            fmt::format("overlapping, {}, {}, f{}", n, of == Association::cells ? "cells" : "points", k + 1), data, of,
            [&](const Vec3& x) {
              const Vec3 d = x - box.lower, size = box.size();
              return functions[k]({d.x / size.x, d.y / size.y, d.z / size.z});
            },
            false, options);
    }
}

/// Every second sample in each direction of a structured block, asked at those left out.
void ask_held_out(const std::string& file, const Options& options) {
  Progress progress;
  const GridData data = read_volumes(split(file, '+'));
  const GridBlock& whole = data.blocks.at(0);
  const auto n = test::block_dims(whole);
  for (const Attribute& a : whole.point_arrays) {
    if (a.components != 1) continue;
    GridBlock half;
    half.kind = GridKind::curvilinear;
    Case c;
    c.name = fmt::format("{}, {}", file.substr(file.rfind('/') + 1), a.name);
    std::vector<double> kept;
    for (std::size_t k = 0; k < 3; ++k) half.dims[k] = (n[k] + 1) / 2;
    for (std::size_t i = 0; i < test::block_point_count(whole); ++i) {
      const std::size_t at[] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
      bool inside = true, own = true;
      for (std::size_t k = 0; k < 3; ++k)
        inside = inside && at[k] <= 2 * (half.dims[k] - 1), own = own && at[k] % 2 == 0;
      if (own) half.points.push_back(test::block_point(whole, i)), kept.push_back(a.number(i));
      if (inside && !own) c.x.push_back(test::block_point(whole, i)), c.truth.push_back(a.number(i));
    }
    half.point_arrays.set("f", std::move(kept));
    GridData halved;
    halved.blocks.push_back(std::move(half));
    c.volume = std::make_shared<const SampledVolume>(assemble_volume(halved, Association::points, progress));
    const VolumeLocator locator(*c.volume);
    std::vector<CellLocation> locations(c.x.size());
    locator.locate(c.x, locations);
    std::size_t to = 0;
    for (std::size_t i = 0; i < c.x.size(); ++i)
      if (locations[i].inside) c.x[to] = c.x[i], c.truth[to++] = c.truth[i];
    c.x.resize(to), c.truth.resize(to);
    print_case(c, options);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string_view a = argv[i];
      if (a.starts_with("--methods="))
        options.methods = split(a.substr(10), ',');
      else if (a.starts_with("--count="))
        options.count = std::stoul(std::string(a.substr(8)));
      else if (a.starts_with("--"))
        throw ArgumentError("unknown option " + std::string(a));
      else
        options.subjects.emplace_back(a);
    }
    std::erase(options.methods, "linear");
    options.methods.insert(options.methods.begin(), "linear");
    fmt::print(
        "| samples and function | method | mean | largest | mean of `linear` | largest of `linear` "
        "|\n|---|---|--:|--:|--:|--:|\n");
    for (const std::string& subject : options.subjects)
      if (subject == "airfoil")
        ask_airfoil(options);
      else if (subject == "overlapping")
        ask_overlapping(options);
      else
        ask_held_out(subject, options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "benchmark_volume_trust: {}\n", e.what());
    return 1;
  }
  return 0;
}
