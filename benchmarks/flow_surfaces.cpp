// Benchmark of flow surfaces and lines: seconds, particles and points; exact and interpolated insertion.
//
//   benchmark_flow_surfaces [seconds|reach|drift|lines [VOLUME]]
//
// seconds: 256 particles on 256 fronts, in analytic flows and in a lattice of 256 × 128 × 256 samples with linear
// interpolation, best of five. reach: the same in that lattice and in 17 such time steps held in memory (200 MB each),
// on two threads: surfaces per second (tejada2008, 5.3). drift: distance of the points of a surface from the exact
// trajectories of their seeds. lines: 22³ stream lines from two diagonals, with all quantities along them, in a tornado
// of 128³ samples and in the first vectors of a file (default: the Blunt Fin of ../shared/data, if present), best of
// five.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/flow/flow_lines.h"
#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/flow/trace.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "timing.h"

namespace {

using namespace sansmesh;

constexpr const char* kBluntFin = "../shared/data/volumes/plot3d/bluntfinxyz.bin";

/// An analytic flow at one moment, sampled on a lattice with linear interpolation.
std::shared_ptr<const VolumeField> sampled(const VectorField& flow, std::array<std::size_t, 3> dims, double moment) {
  GridData data;
  GridBlock& block = data.blocks.emplace_back();
  block.kind = GridKind::lattice;
  const Box3 box = flow.bounds();
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < dims[k]; ++i)
      block.axes[k].push_back(box.lower[k] + box.size()[k] * static_cast<double>(i) / static_cast<double>(dims[k] - 1));
  const std::size_t layer = dims[0] * dims[1];
  std::vector<Vec3> places(layer), vectors(layer);
  std::vector<std::uint8_t> inside(layer);
  std::vector<float> values;
  values.reserve(3 * layer * dims[2]);
  for (const double z : block.axes[2]) {
    places.clear();
    for (const double y : block.axes[1])
      for (const double x : block.axes[0]) places.emplace_back(x, y, z);
    flow.evaluate(places, std::vector<double>(layer, moment), vectors, inside);
    for (const Vec3& v : vectors)
      for (std::size_t k = 0; k < 3; ++k) values.push_back(static_cast<float>(v[k]));
  }
  block.point_arrays.set("v", std::move(values), 3);
  Progress progress;
  auto volume = std::make_shared<const SampledVolume>(assemble_volume(data, Association::points, progress));
  VolumeReconstructionOptions options;
  options.method = "linear";
  return reconstruct_volume(std::move(volume), "v", options, progress);
}

std::unique_ptr<VectorField> on_lattice(const VectorField& flow, std::array<std::size_t, 3> dims) {
  return volume_flow(sampled(flow, dims, 0));
}

void time_surface(const std::string& what, const VectorField& flow, const SeedCurve& curve,
                  FlowSurfaceOptions options) {
  Progress progress;
  FlowSurface surface;
  const auto [best, cpu] = fastest_of(5, [&] { surface = flow_surface(flow, curve, options, progress); });
  const FlowSurfaceReport& r = surface.report;
  fmt::print(
      "{:44} {:7.3f} s {:7.3f} CPU s {:5.1f}/s {:8} points {:8} triangles {:5} fronts {:6} inserted {:6} removed {:4} "
      "torn\n",
      what, best, cpu, 1 / best, surface.points.size(), surface.mesh.triangles.size(), r.fronts, r.inserted, r.removed,
      r.tears);
}

void seconds() {
  const auto rotation = analytic_flow("rotation"), tornado = analytic_flow("tornado"), abc = analytic_flow("abc");
  FlowSurfaceOptions options;
  const auto steps = [&](double duration) { options.duration = duration, options.front_step = duration / 255; };
  const SeedCurve radius{{{0.2, 0, 0}, {1.8, 0, 0}}}, ground{{{0.2, 0.5, 0.05}, {0.8, 0.45, 0.1}}};
  const SeedCurve chaos{{{0.5, 1, 0.2}, {1.5, 1.2, 0.8}}};
  for (const bool removal : {true, false}) {
    options.delta = removal ? 0.5 : 0;
    const std::string end = removal ? "" : ", delta = 0";
    steps(6), time_surface("rotation, formula" + end, *rotation, radius, options);
    steps(2), time_surface("tornado, formula" + end, *tornado, ground, options);
  }
  options.delta = 0.5;
  steps(2), time_surface("abc, formula", *abc, chaos, options);
  options.kind = FlowSurfaceKind::path;
  steps(2), time_surface("tornado, formula, path", *tornado, ground, options);
  options.kind = FlowSurfaceKind::streak;
  steps(2), time_surface("tornado, formula, streak", *tornado, ground, options);
  options.kind = FlowSurfaceKind::stream;
  for (const bool formula : {false, true}) {
    const std::string end = formula ? "" : ", lattice";
    const auto field = formula ? analytic_flow("tornado") : on_lattice(*tornado, {256, 128, 256});
    for (const std::string_view integrator : {"dopri5", "rk4", "euler"}) {
      options.trace.integrator = integrator;
      options.trace.step = integrator == "dopri5" ? std::optional<double>() : 0.01;
      steps(2), time_surface(fmt::format("tornado{}, {}", end, integrator), *field, ground, options);
    }
    options.trace = {};
  }
  const auto cube = on_lattice(*tornado, {128, 128, 128});
  FlowSurfaceOptions whole;
  whole.duration = 4, whole.seeds = 100;
  time_surface("tornado 128^3, own steps", *cube, ground, whole);
}

void reach() {
  constexpr std::array<std::size_t, 3> kDims{256, 128, 256};
  constexpr std::size_t kSteps = 17, kFronts = 256;
  constexpr double kDuration = 2;
  const ThreadScope two(2);
  const auto tornado = analytic_flow("tornado");
  const SeedCurve ground{{{0.2, 0.5, 0.05}, {0.8, 0.45, 0.1}}};
  FlowSurfaceOptions options;
  options.duration = kDuration, options.front_step = kDuration / (kFronts - 1);
  std::vector<double> times;
  std::vector<std::shared_ptr<const VolumeField>> steps;
  for (std::size_t i = 0; i < kSteps; ++i) {
    times.push_back(kDuration * static_cast<double>(i) / (kSteps - 1));
    steps.push_back(sampled(*tornado, kDims, times[i]));
  }
  constexpr std::size_t kBytes = 3 * sizeof(double) * kDims[0] * kDims[1] * kDims[2];
  const auto load = [&](std::size_t i) { return FlowStep{steps[i], kBytes}; };
  const auto in_time = [&](TimeInterpolation between) {
    return flow_in_time(times, load, {between, (kSteps + 1) * kBytes});
  };
  struct Case {
    const char* name;
    FlowSurfaceKind kind;
    std::unique_ptr<VectorField> field;
  };
  std::vector<Case> cases;
  cases.push_back({"steady", FlowSurfaceKind::stream, volume_flow(steps[0])});
  cases.push_back({"17 steps, constant between", FlowSurfaceKind::path, in_time(TimeInterpolation::constant)});
  cases.push_back({"17 steps, linear between", FlowSurfaceKind::path, in_time(TimeInterpolation::linear)});
  cases.push_back({"17 steps, cubic between", FlowSurfaceKind::path, in_time(TimeInterpolation::cubic)});
  for (const Case& c : cases)
    for (const std::string_view integrator : {"dopri5", "euler"}) {
      options.kind = c.kind, options.trace = {};
      options.trace.integrator = integrator;
      if (integrator == "euler") options.trace.step = 0.01;  // one step from front to front
      time_surface(fmt::format("{}, {}", c.name, integrator), *c.field, ground, options);
    }
}

void drift() {
  fmt::print("{:14}{:>10}{:>14}{:>10}{:>12}{:>12}\n", "flow", "duration", "insertion", "inserted", "mean", "largest");
  struct Case {
    const char* name;
    SeedCurve curve;
    double duration;
  };
  for (const Case& c : {Case{"double-gyre", {{{0.2, 0.5, 0.3}, {0.45, 0.5, 0.7}}}, 15},
                        {"abc", {{{0.5, 1, 0.2}, {1.5, 1.2, 0.8}}}, 3},
                        {"tornado", {{{0.2, 0.5, 0.05}, {0.8, 0.45, 0.1}}}, 2}}) {
    const auto flow = analytic_flow(c.name);
    for (const FlowInsertion insertion : {FlowInsertion::traced, FlowInsertion::interpolated}) {
      FlowSurfaceOptions options;
      options.kind = FlowSurfaceKind::path, options.insertion = insertion;
      options.duration = c.duration, options.seeds = 50;
      options.trace.tolerance = 1e-8;
      Progress progress;
      const FlowSurface surface = flow_surface(*flow, c.curve, options, progress);
      double sum = 0, most = 0;
      std::size_t n = 0;
      std::vector<std::size_t> by_time(surface.points.size());
      for (std::size_t i = 0; i < by_time.size(); ++i) by_time[i] = i;
      std::sort(by_time.begin(), by_time.end(),
                [&](std::size_t a, std::size_t b) { return surface.points[a].t < surface.points[b].t; });
      for (std::size_t first = 0; first < by_time.size();) {
        const double t = surface.points[by_time[first]].t;
        std::size_t last = first;
        std::vector<double> s;
        std::vector<std::uint32_t> all;
        for (; last < by_time.size() && surface.points[by_time[last]].t == t; ++last) {
          s.push_back(surface.points[by_time[last]].s);
          all.push_back(static_cast<std::uint32_t>(last - first));
        }
        Particles p = particles_at(*flow, c.curve.at(s), std::vector<double>(s.size(), 0.0));
        options.trace.tolerance = 1e-9;
        if (t > 0) move_particles(*flow, p, all, t, options.trace);
        for (std::size_t k = first; k < last; ++k) {
          const double d = norm(p.positions[k - first] - surface.points[by_time[k]].position);
          sum += d, most = std::max(most, d), ++n;
        }
        first = last;
      }
      fmt::print("{:14}{:10}{:>14}{:10}{:12.2e}{:12.2e}  (spacing {:.3f})\n", c.name, c.duration,
                 insertion == FlowInsertion::traced ? "traced" : "interpolated", surface.report.inserted,
                 sum / static_cast<double>(n), most, surface.report.spacing);
    }
  }
}

void time_lines(const std::string& what, const VectorField& flow) {
  Progress progress;
  FlowLineOptions options;
  options.length = 2 * flow.bounds().diagonal();
  const Seeds seeds = parse_seeds("box(10648)", flow.bounds());
  PolylineSet lines;
  const auto [best, cpu] = fastest_of(5, [&] { lines = flow_lines(flow, seeds.points, options, progress); });
  fmt::print("{:44} {:7.3f} s {:7.3f} CPU s {:8} lines {:9} points\n", what, best, cpu, lines.size(),
             lines.positions.size());
}

void lines(const std::string& file) {
  time_lines("tornado, lattice of 128^3", *on_lattice(*analytic_flow("tornado"), {128, 128, 128}));
  time_lines("tornado, formula", *analytic_flow("tornado"));
  if (file == kBluntFin && !std::filesystem::exists(file)) return;
  Progress progress;
  VolumeDataset volume(read_volumes({file}));
  VolumeReconstructionOptions options;
  options.method = "linear";
  for (const DatasetArray& array : volume.arrays())
    if (array.components == 3)
      return time_lines(std::filesystem::path(file).filename().string(),
                        *volume_flow(volume.field({array.name, {}, false}, options, progress)));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what.empty() || what == "seconds") seconds();
  if (what.empty() || what == "reach") reach();
  if (what.empty() || what == "drift") drift();
  if (what.empty() || what == "lines") lines(argc > 2 ? argv[2] : kBluntFin);
}
