// Benchmark of surfaces in cell means: a front a quarter of a cell wide on a sphere, and a smooth field over four
// decades, on grids of exact means.
//
//   benchmark_cell_means [OPTION...] [GRID...]
//
//   GRID              amr, blocks, abutting, hexahedra, tetrahedra; default: all
//   --methods=A,B     default: linear, amls, mls-detail with centres and with means; a name may end with :centres,
//                     :plain (no logarithm), :all (not robust, hence without fronts) and :raw (unchanged triangles)
//   --size=N          cells per direction; default: 24
//
// Per method: mean and 95 % quantile of the distance of the vertices of the isosurface from the true one, in spacings,
// and of the angle of their normals (degrees); open edges inside the volume; CPU seconds of the fit.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/reconstruction.h"
#include "volume/cell_means.h"

namespace {

using namespace sansmesh;

struct Truth {
  std::function<double(const Vec3&)> distance;
  std::function<Vec3(const Vec3&)> normal;  // towards smaller values
  double value = 0.5;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

void measure(const std::string& grid, const std::string& what, GridData data, const Truth& truth,
             const std::vector<std::string>& methods) {
  Progress progress;
  const auto volume = std::make_shared<const SampledVolume>(assemble_volume(data, Association::cells, progress));
  const VolumeValues values = volume_values(*volume, "f");
  for (const std::string& name : methods) {
    VolumeReconstructionOptions options;
    options.method = name.substr(0, name.find(':'));
    const auto with = [&](std::string_view word) { return name.find(word) != std::string::npos; };
    if (with(":centres")) options.cell_values = CellValues::centres;
    if (with(":plain")) options.logarithm = false;
    if (with(":all")) options.robust = false;  // without fronts
    VolumeReconstructionReport report;
    const double before = process_cpu_seconds();
    const std::shared_ptr<const VolumeField> field = reconstruct_volume(volume, "f", options, progress, &report);
    const double fitted = process_cpu_seconds() - before;
    const Isosurface surface(
        volume, field, [&](std::size_t i) { return values.values[i]; }, truth.value);
    IsosurfaceOptions meshing;
    if (with(":raw")) meshing.enhance = false;
    const TriangleMesh mesh = mesh_isosurface(surface, meshing, progress);
    std::vector<double> distances, angles;
    std::vector<Vec3> x;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) x.push_back(mesh.origin + Vec3(mesh.vertices[v]));
    std::vector<double> spacing(x.size());
    field->spacing(x, spacing);
    for (std::size_t v = 0; v < x.size(); ++v) {
      distances.push_back(std::abs(truth.distance(x[v])) / spacing[v]);
      const double c = dot(truth.normal(x[v]), Vec3(mesh.normals[v]));
      angles.push_back(std::acos(std::clamp(c, -1.0, 1.0)) * 180 / std::numbers::pi);
    }
    if (getenv("WORST")) {
      std::vector<std::size_t> o(x.size());
      for (std::size_t v = 0; v < o.size(); ++v) o[v] = v;
      std::sort(o.begin(), o.end(), [&](auto a, auto b) { return distances[a] > distances[b]; });
      for (std::size_t v = 0; v < std::min<std::size_t>(o.size(), 400); v += 16)
        fmt::print("  {} of {}: {:.3f} {:.3f} {:.3f}: {:.4f} spacing {:.4f}\n", v, o.size(), x[o[v]].x, x[o[v]].y,
                   x[o[v]].z, truth.distance(x[o[v]]) / spacing[o[v]], spacing[o[v]]);
    }
    const MeshTopology topology = measure_topology(mesh);
    fmt::print("{:<11} {:<7} {:<24} {:>8.4f} {:>8.4f} {:>7.2f} {:>7.2f} {:>6} {:>7.2f}\n", grid, what, name,
               mean(distances), quantile(distances, 0.95), mean(angles), quantile(angles, 0.95),
               topology.boundary_edges, fitted);
  }
}

GridData grid_of(const std::string& name, std::size_t n) {
  const auto zero = [](const Vec3&) { return 0.0; };
  if (name == "amr") return test::two_level_amr(n / 4 * 4, zero);
  if (name == "blocks") return test::three_overlapping_blocks(n, zero);
  if (name == "abutting") return test::abutting_blocks(n + 1, n * 3 / 2 + 1, zero);
  if (name == "hexahedra") return test::bent_grid({n + 1, n + 1, n + 1}, zero);
  if (name == "tetrahedra") return test::tetrahedra_grid({n * 2 / 3 + 1, n * 2 / 3 + 1, n * 2 / 3 + 1}, zero);
  throw ArgumentError("unknown grid " + name);
}

int run(int argc, char** argv) {
  std::vector<std::string> methods{"linear", "amls", "mls-detail:centres:plain", "mls-detail"}, grids;
  std::size_t size = 24;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--methods=")) {
      methods.clear();
      std::string rest = argument.substr(10);
      for (std::size_t at = 0; at != std::string::npos;) {
        const std::size_t end = rest.find(',', at);
        methods.push_back(rest.substr(at, end == std::string::npos ? end : end - at));
        at = end == std::string::npos ? end : end + 1;
      }
    } else if (argument.starts_with("--size=")) {
      size = static_cast<std::size_t>(std::stoul(argument.substr(7)));
    } else {
      grids.push_back(argument);
    }
  }
  if (grids.empty()) grids = {"amr", "blocks", "abutting", "hexahedra", "tetrahedra"};
  fmt::print("{:<11} {:<7} {:<24} {:>8} {:>8} {:>7} {:>7} {:>6} {:>7}\n", "grid", "field", "method", "mean", "95 %",
             "normal", "95 %", "open", "fit s");
  for (const std::string& grid : grids) {
    test::SphereFront front;
    if (grid == "abutting") front.center = {1.02, 0.49, 0.505};
    if (grid == "hexahedra") front.center = test::bend({0.5, 0.5, 0.5});
    front.width = 0.125 / static_cast<double>(size);  // tanh from −1 to 1: a quarter of a cell
    Truth truth;
    truth.distance = [&](const Vec3& x) { return front.distance(x); };
    truth.normal = [&](const Vec3& x) { return normalized(x - front.center); };
    GridData data = grid_of(grid, size);
    test::set_front_means(data, front);
    measure(grid, "front", std::move(data), truth, methods);

    // exp of 9.2 times a smooth function of about 0..1: four decades.
    const auto log = [](const Vec3& x) {
      return 9.2 * (0.5 + 0.3 * std::sin(2.7 * x.x + 0.4) * std::cos(2.1 * x.y) - 0.25 * std::cos(3 * x.z + 0.5 * x.x));
    };
    const auto slope = [&](const Vec3& x) {
      Vec3 g;
      constexpr double h = 1e-5;
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 a = x, b = x;
        a[k] -= h, b[k] += h;
        g[k] = (log(b) - log(a)) / (2 * h);
      }
      return g;
    };
    truth.value = std::exp(4.6);
    truth.distance = [&](const Vec3& x) { return (log(x) - 4.6) / norm(slope(x)); };
    truth.normal = [&](const Vec3& x) { return normalized(slope(x)) * -1.0; };
    data = grid_of(grid, size);
    test::set_means(data, [&](const Vec3& x) { return std::exp(log(x)); });
    measure(grid, "smooth", std::move(data), truth, methods);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_cell_means: {}\n", error.what());
    return 1;
  }
}
