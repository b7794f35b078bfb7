// Tetrahedra that move by forces: frames a second of each integrator, beside those of the thesis (table 6.3; METHODS
// §7.2: a graphics card of 2006, and implicit Euler on it).
//
//   benchmark_tetrahedra [FOLDER] [SECONDS]
//
// FOLDER (../shared/data/tets) holds the meshes; without it there are boxes only. A frame is a step of h, everything in
// it but pictures; the best of several parts of SECONDS (2) for each row. Every mesh is made 1 m large, stands on its
// lowest twentieth, which is fixed, and has been stretched by a tenth. Vertices weigh 0.2 kg on average: so the
// explicit methods are stable with h = 0.001 s at k_s = 3000 N/m and not much beyond, as the source has it. Implicit
// Euler takes h = 0.01 s and k_s = 30,000 N/m; elasticity has moduli that make edges about as stiff.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/dynamics/tet_geometry.h"

namespace {

using namespace sansmesh;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Subject {
  std::string name;
  TetMesh mesh;
  std::string thesis[4];  ///< frames a second there, in the order of DynamicsIntegrator
};

constexpr const char* kIntegrators[] = {"explicit Euler", "Verlet", "velocity Verlet", "implicit Euler"};

TetMesh of_size_one(TetMesh mesh) {
  const Box3 box = bounds(mesh);
  for (Vec3& p : mesh.vertices) p = (p - box.lower) / box.diagonal();
  return mesh;
}

void measure(const Subject& subject, SoftBodyModel model, DynamicsIntegrator integrator, double patience) {
  const std::size_t n = subject.mesh.vertices.size();
  const bool is_implicit = integrator == DynamicsIntegrator::implicit_euler;
  SoftBodyOptions options;
  options.model = model, options.integrator = integrator;
  options.total_mass = 0.2 * static_cast<double>(n);
  options.step = is_implicit ? 0.01 : 0.001;
  options.stiffness = is_implicit ? 30000 : 3000;
  options.damping = integrator == DynamicsIntegrator::explicit_euler ? 3 : 1;
  double volume = 0;
  for (const Tet& t : subject.mesh.tets) volume += tet_volume(t, subject.mesh.vertices);
  const double edge = std::cbrt(volume / static_cast<double>(subject.mesh.tets.size()) * 6 * std::sqrt(2.0));
  options.youngs_modulus = 0.5 * options.stiffness / edge;
  options.stiffness_damping = options.damping / options.stiffness;
  DynamicsScene scene;
  std::vector<Vec3> x = subject.mesh.vertices;
  const double height = bounds(subject.mesh).size().z;
  for (std::size_t v = 0; v < n; ++v) {
    if (x[v].z <= 0.05 * height) scene.fixed.push_back(static_cast<std::uint32_t>(v));
    x[v].z *= 1.1;
  }
  SoftBody body(subject.mesh, options, scene);
  body.set_state(x, std::vector<Vec3>(n));
  double best = 1e300, cpu = 1e300;
  int frames = 0, iterations = 0;
  try {
    for (const double begin = seconds(); seconds() - begin < patience || frames == 0;) {
      const int some = is_implicit ? 2 : 10;
      const double before = seconds(), used = process_cpu_seconds();
      for (int k = 0; k < some; ++k) iterations += body.step().iterations;
      best = std::min(best, (seconds() - before) / some), cpu = std::min(cpu, (process_cpu_seconds() - used) / some);
      frames += some;
    }
  } catch (const Error& error) {
    fmt::print("| {} | | {} | {} | {} |\n", subject.name, kIntegrators[static_cast<int>(integrator)],
               model == SoftBodyModel::springs ? "springs" : "elasticity", error.what());
    return;
  }
  fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} | {:.0f} | {:.0f} | {} |\n", subject.name, subject.mesh.tets.size(),
             model == SoftBodyModel::springs ? "springs" : "elasticity", kIntegrators[static_cast<int>(integrator)],
             1000 * best, 1000 * cpu, 1 / best, static_cast<double>(iterations) / frames,
             model == SoftBodyModel::springs ? subject.thesis[static_cast<int>(integrator)] : "");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  [[maybe_unused]] const std::filesystem::path folder = argc > 1 ? argv[1] : "../shared/data/tets";
  const double patience = argc > 2 ? std::atof(argv[2]) : 2;
  std::vector<Subject> subjects;
  subjects.push_back({"box of 24 × 26 × 30 cells (thesis: knee, 112,299)",
                      of_size_one(box_of_tets({0, 0, 0}, {24, 26, 30}, 24, 26, 30)),
                      {"169", "119", "119", "22"}});
  fmt::print(
      "{} threads\n\n| mesh | tetrahedra | model | integrator | ms | CPU ms | frames/s | iterations | thesis "
      "|\n|---|---|---|---|---|---|---|---|---|\n",
      thread_count());
  for (const Subject& s : subjects) {
    for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
      for (int k = 0; k < 4; ++k) measure(s, model, static_cast<DynamicsIntegrator>(k), patience);
    }
  }
}
