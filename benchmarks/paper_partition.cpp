// Tables of the publications (tejada2008, 4.4.4; polizelli, section 4) on available data, beside the default method:
// times, numbers of functions, shapes of triangles with and without displacement, lengths of gradients, spurious
// sheets.
//
//   benchmark_paper_partition [--data FOLDER] [--only TEXT] [--points N] [--meshes FOLDER] [--threshold RATIO]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/progress.h"

using namespace sansmesh;

namespace {

struct Arguments {
  std::string data = "../shared/data/points", only, meshes;
  std::size_t points = 1000000;
  std::optional<double> threshold;
};

struct Variant {
  const char* name;
  FitOptions fit;
};

std::vector<Variant> variants(int depth, std::optional<double> threshold) {
  Variant thesis{"paper", {}}, strict{"paper, its coverage", {}}, without{"paper, no coverage", {}},
      ours{"partition", {}};
  for (Variant* v : {&thesis, &strict, &without}) {
    v->fit.fit = FitMethod::paper;
    v->fit.depth = depth;
    v->fit.threshold = threshold;
  }
  strict.fit.coverage = kPaperCoverage;
  without.fit.coverage = kNoCoverage;
  return {thesis, strict, without, ours};
}

struct Gradients {
  double largest = 0, p999 = 0;
};

Gradients gradients_at(const PartitionOfUnity& field, const std::vector<Vec3>& x) {
  std::vector<double> f(x.size()), size(x.size());
  std::vector<Vec3> g(x.size());
  field.evaluate(x, f, g);
  for (std::size_t i = 0; i < x.size(); ++i) size[i] = norm(g[i]);
  std::sort(size.begin(), size.end());
  return {size.back(), size[size.size() - 1 - size.size() / 1000]};
}

class Clock {
 public:
  double seconds() const { return process_cpu_seconds() - start_; }

 private:
  double start_ = process_cpu_seconds();
};

void measure(const std::string& name, const PointSet& cloud, int depth, const Arguments& a) {
  for (const Variant& v : variants(depth, a.threshold)) {
    Progress progress;
    const PreparedCloud prepared = prepare_cloud(cloud, {}, progress);
    const Clock fitting;
    const FittedFunction function = fit_surface_function(prepared, v.fit, progress);
    const double fit_seconds = fitting.seconds();
    const PartitionReport& r = function.field.report();

    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> gauss;
    const Box3 cube = function.field.bounds();
    std::vector<Vec3> box, near;
    const PointSet& samples = *function.samples;
    for (std::size_t i = 0; i < a.points; ++i) {
      box.push_back(cube.lower + Vec3{unit(random), unit(random), unit(random)} * (cube.upper.x - cube.lower.x));
      const Vec3 d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
      near.push_back(samples.origin + Vec3(samples.positions[random() % samples.size()]) + d * r.spacing);
    }
    std::vector<double> values(box.size());
    const Clock evaluating;
    function.field.evaluate(box, values);
    const double evaluate_seconds = evaluating.seconds();
    const Gradients all = gradients_at(function.field, box), close = gradients_at(function.field, near);

    MeshOptions meshing;
    meshing.components.kind = ComponentChoice::Kind::all;
    meshing.measure_quality = true;
    const bool paper = v.fit.is_paper();
    if (paper) meshing.displacement = 0.9;
    MeshReport report;
    TriangleMesh mesh = mesh_function(function, meshing, progress, &report);
    // The time is for one extraction, without the measurements.
    MeshOptions plain = meshing;
    plain.measure_quality = false;
    const Clock meshing_time;
    mesh = mesh_function(function, plain, progress);
    const double mesh_seconds = meshing_time.seconds();
    TriangleMesh own = mesh;
    move_from_input(own, function.frame);
    const FarPoints invented = find_invented(own, samples, r.spacing, 200000);
    const FarPoints lost = find_lost(own, samples, r.spacing, r.noise);
    TriangleMesh reference;
    reference.origin = samples.origin;
    reference.vertices = samples.positions;
    const SurfaceDistance off = measure_distance(own, reference, {}, progress);
    const std::size_t borrowed = function.paper ? function.paper->borrowed : 0;
    std::printf(
        "| %s | %s | %.2f | %.2f | %.2f | %zu | %zu/%zu/%zu/%zu | %zu | %zu | %zu | %.2f ± %.2f | %.2f ± %.2f | %.3g | "
        "%.3g | %.3g | %.4f | %.3f | %.3f |\n",
        name.c_str(), v.name, fit_seconds, mesh_seconds, evaluate_seconds, r.functions, r.functions_of_degree[1],
        r.functions_of_degree[2], r.functions_of_degree[3], r.functions_of_degree[4], borrowed, mesh.triangles.size(),
        find_components(mesh).size(), report.aspect_mean_before, report.aspect_deviation_before, report.aspect_mean,
        report.aspect_deviation, all.largest, all.p999, close.largest, off.percent(off.from_reference.mean),
        100 * invented.share, 100 * lost.share);
    std::fflush(stdout);
    if (!a.meshes.empty()) {
      std::string file = name + "_" + v.name + ".ply";
      for (char& c : file)
        if (c == ' ' || c == ',') c = '_';
      write_mesh((std::filesystem::path(a.meshes) / file).string(), mesh);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const auto next = [&] { return std::string(i + 1 < argc ? argv[++i] : ""); };
    if (!std::strcmp(argv[i], "--data"))
      a.data = next();
    else if (!std::strcmp(argv[i], "--only"))
      a.only = next();
    else if (!std::strcmp(argv[i], "--points"))
      a.points = std::stoul(next());
    else if (!std::strcmp(argv[i], "--threshold"))
      a.threshold = std::stod(next());
    else if (!std::strcmp(argv[i], "--meshes"))
      a.meshes = next();
  }
  std::printf(
      "| cloud | fit | fit s | mesh s | evaluations s | functions | of degree 1/2/3/4 | borrowed | triangles | parts | "
      "aspect ratio | displaced or enhanced | largest ‖∇F‖ | 99.9 %% | near samples | samples off %% | made up %% | "
      "lost %% |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  // The stand-ins have the numbers of samples of the publications.
  struct Cloud {
    const char *file, *name;
    std::size_t sampled;
    int depth;
  };
  for (const Cloud& c : {Cloud{"bunny_scans/bun.conf", "bunny raw", 0, 9},
                         Cloud{"dragon_vrip_res3.ply", "dragon 398K of its faces", 398000, 9},
                         Cloud{"chinese-dragon_10k.off", "chinese dragon 665K of its faces", 665000, 7},
                         Cloud{"fertility_4k.off", "fertility 514K of its faces for filigree", 514000, 9},
                         Cloud{"horse.ply", "horse", 0, 9}, Cloud{"armadillo_43k.obj", "armadillo", 0, 9},
                         Cloud{"kitten.xyz", "kitten", 0, 9}, Cloud{"oni.pwn", "oni", 0, 9}}) {
    if (std::string(c.name).find(a.only) == std::string::npos) continue;
    const std::filesystem::path path = std::filesystem::path(a.data) / c.file;
    if (!std::filesystem::exists(path)) {
      std::printf("| %s: not in %s |\n", c.file, a.data.c_str());
      continue;
    }
    PointSet cloud = read_points(path.string());
    if (c.sampled > 0) cloud = sample_faces(cloud, c.sampled);
    measure(c.name, cloud, c.depth, a);
  }
  return 0;
}
