// Benchmark of tetrahedral dynamics: frames per second of each integrator, beside tejada2008, 6.4.5, table 6.3 (the
// explicit ones and implicit Euler on a graphics card of 2006), and beside Bullet's soft body.
//
//   benchmark_tetrahedra [FOLDER] [SECONDS] [BULLET]
//
// FOLDER (../shared/data/tets) contains the meshes. A frame is a step without pictures: medians over the first 0.6 s of
// motion, or over SECONDS (2) of run time per row. Every mesh is scaled to 1 m, its lowest fifth is fixed, and it is
// stretched by a tenth. Vertices weigh 0.2 kg on average, for which the explicit methods are stable with h = 0.001 s at
// k_s = 3000 N/m and not much beyond, as in the thesis. Implicit Euler uses h = 0.01 s and k_s = 30,000 N/m; the
// elastic moduli make edges about as stiff. BULLET: the program of peers/bullet_soft_body.cpp, which receives the same
// meshes with steps of 0.01 s (benchmarks/compare_dynamics).
#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/tet_dataset.h"
#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"
#include "sansmesh/progress.h"
#include "support/tet_shapes.h"
#include "timing.h"

namespace {

using namespace sansmesh;

struct Subject {
  std::string name;
  TetMesh mesh;
  std::string thesis[4];  ///< frames per second in the thesis, in the order of kIntegrators
};

constexpr const char* kIntegrators[] = {"explicit-euler", "verlet", "velocity-verlet", "implicit-euler"};

TetMesh of_size_one(TetMesh mesh) {
  const Box3 box = bounds(mesh);
  for (Vec3& p : mesh.vertices) p = (p - box.lower) / box.diagonal();
  return mesh;
}

std::vector<std::uint32_t> lowest_of(const TetMesh& mesh) {
  std::vector<std::uint32_t> found;
  const double height = bounds(mesh).size().z;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].z <= 0.2 * height) found.push_back(static_cast<std::uint32_t>(v));
  }
  return found;
}

void measure(const Subject& subject, SoftBodyModel model, int integrator, double patience) {
  const std::size_t n = subject.mesh.vertices.size();
  SoftBodyOptions options;
  options.model = model, options.integrator = kIntegrators[integrator];
  const bool is_implicit = options.integrator == "implicit-euler";
  options.total_mass = 0.2 * static_cast<double>(n), options.equal_masses = true;
  options.step = is_implicit ? 0.01 : 0.001;
  options.stiffness = is_implicit ? 30000 : 3000;
  options.damping = options.integrator == "explicit-euler" ? 3 : 1;
  double volume = 0;
  for (const Tet& t : subject.mesh.tets) volume += tet_volume(t, subject.mesh.vertices);
  const double edge = std::cbrt(volume / static_cast<double>(subject.mesh.tets.size()) * 6 * std::sqrt(2.0));
  options.young = 0.5 * options.stiffness / edge;
  options.stiffness_damping = options.damping / options.stiffness;
  DynamicsScene scene;
  std::vector<Vec3> x = subject.mesh.vertices;
  for (Vec3& p : x) p.z *= 1.1;
  scene.fixed = lowest_of(subject.mesh);
  SoftBody body(subject.mesh, options, scene);
  body.set_state(x, std::vector<Vec3>(n));
  std::vector<double> walls, cpus;
  int iterations = 0;
  try {
    for (const double begin = now().wall;
         body.time() < 0.6 - 1e-9 && (now().wall - begin < patience || walls.size() < 5);) {
      const Time time = time_of([&] { iterations += body.step().iterations; });
      walls.push_back(time.wall), cpus.push_back(time.cpu);
    }
  } catch (const Error& error) {
    fmt::print("| {} | {} | {} | {} | | | | | {} |\n", subject.name, subject.mesh.tets.size(),
               model == SoftBodyModel::springs ? "springs" : "elasticity", kIntegrators[integrator], error.what());
    return;
  }
  const double wall = median(walls), cpu = median(cpus);
  fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} | {:.0f} | {:.0f} | {} |\n", subject.name, subject.mesh.tets.size(),
             model == SoftBodyModel::springs ? "springs" : "elasticity", kIntegrators[integrator], 1000 * wall,
             1000 * cpu, 1 / wall, static_cast<double>(iterations) / static_cast<double>(walls.size()),
             model == SoftBodyModel::springs ? subject.thesis[integrator] : "");
  std::fflush(stdout);
}

/// Rows of Bullet.
void measure_peer(const Subject& subject, const std::string& program) {
  const std::string file = (std::filesystem::temp_directory_path() / "benchmark_tetrahedra.txt").string();
  {
    std::ofstream out(file);
    const auto fixed = lowest_of(subject.mesh);
    out.precision(9);
    out << subject.mesh.vertices.size() << ' ' << subject.mesh.tets.size() << '\n';
    for (const Vec3& p : subject.mesh.vertices) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const Tet& t : subject.mesh.tets) out << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << '\n';
    out << fixed.size() << '\n';
    for (const std::uint32_t v : fixed) out << v << '\n';
  }
  FILE* pipe = popen(fmt::format("'{}' '{}' 30000", program, file).c_str(), "r");
  char name[64];
  double wall = 0, cpu = 0;
  while (pipe && std::fscanf(pipe, "%63s %lf %lf", name, &wall, &cpu) == 3) {
    fmt::print("| {} | {} | Bullet | {} | {:.2f} | {:.2f} | {:.0f} | | |\n", subject.name, subject.mesh.tets.size(),
               name, wall, cpu, 1000 / wall);
  }
  if (pipe) pclose(pipe);
  std::filesystem::remove(file);
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "../shared/data/tets";
  const double patience = argc > 2 ? std::atof(argv[2]) : 2;
  const std::string peer = argc > 3 ? argv[3] : "";
  const auto read = [&](const char* file) { return of_size_one(read_tets((folder / file).string()).mesh); };
  std::vector<Subject> subjects;
  try {
    subjects.push_back({"bar-2523 refined", test::refine_uniformly(read("bar-2523.msh")), {}});
    subjects.push_back({"bunny (elephant, 24,106)", read("bunny.msh"), {"900", "539", "541", "48"}});
    subjects.push_back({"dolphin", read("dolphin.msh"), {}});
    subjects.push_back({"box of 24 × 26 × 30 cells (knee, 112,299)",
                        of_size_one(test::box_of_tets({0, 0, 0}, {24, 26, 30}, 24, 26, 30)),
                        {"169", "119", "119", "22"}});
    subjects.push_back(
        {"bunny refined (foot, 156,612)", test::refine_uniformly(read("bunny.msh")), {"220", "149", "149", "12"}});
    subjects.push_back({"hand refined", test::refine_uniformly(read("hand.mesh")), {}});
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  fmt::print(
      "{} threads\n\n| mesh (of the thesis) | tetrahedra | forces | integrator | ms | CPU ms | frames/s | iterations | "
      "thesis, frames/s |\n|---|---|---|---|---|---|---|---|---|\n",
      thread_count());
  for (const Subject& s : subjects) {
    for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
      for (int k = 0; k < 4; ++k) measure(s, model, k, patience);
    }
    if (!peer.empty()) measure_peer(s, peer);
  }
}
