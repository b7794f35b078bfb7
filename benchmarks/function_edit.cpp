// Benchmark of edits of a fitted function with an update of its mesh, against fitting and meshing everything.
//
//   benchmark_function_edit CLOUD [ROUNDS]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "timing.h"

namespace {

using namespace sansmesh;

void print(const std::string& what, const Time& t, const Time& whole) {
  std::printf("%-46s %8.3f s wall %8.3f s CPU   1/%-6.1f 1/%-6.1f\n", what.c_str(), t.wall, t.cpu, whole.wall / t.wall,
              whole.cpu / t.cpu);
}

struct Trial {
  const char* name;
  decltype(Edit::action) action;
};

void run(const std::string& file, int rounds) {
  const PointSet cloud = read_points(file);
  Progress progress;
  Time start = now();
  const FittedFunction function = fit_surface_function(cloud, {}, progress);
  const Time fit = now() - start;
  start = now();
  const TriangleMesh mesh = mesh_function(function, {}, progress);
  const Time meshing = now() - start, whole = fit + meshing;
  const std::size_t supports = function.field.report().functions;
  std::printf("%s: %zu points, %zu supports, %zu triangles\n", file.c_str(), cloud.size(), supports,
              mesh.triangles.size());
  print("fit", fit, whole);
  print("mesh", meshing, whole);

  // A ball around a sample with about half a percent of the supports.
  const PartitionData& data = function.field.data();
  const Vec3f middle = data.supports[data.supports.size() / 3].foot;
  std::vector<float> distance;
  for (const Support& s : data.supports) distance.push_back(norm(s.foot - middle));
  std::nth_element(distance.begin(), distance.begin() + static_cast<std::ptrdiff_t>(supports / 200), distance.end());
  Edit edit;
  edit.select.ball = {function.frame.to_input(data.origin + Vec3(middle)),
                      function.frame.to_input(static_cast<double>(distance[supports / 200]))};
  const Trial trials[] = {{"degree 1", SetDegree{1}},
                          {"refit, wide supports", Refit{{}, {}, {}, 1.9, {}}},
                          {"set to outside", SetConstant{1}},
                          {"removed", RemoveSupports{}}};
  for (const Trial& trial : trials) {
    edit.action = trial.action;
    Time best_edit, best_mesh;
    MeshUpdate update;
    std::size_t chosen = 0;
    bool closed = false;
    for (int round = 0; round < rounds; ++round) {
      FunctionEditor editor({PartitionOfUnity(data), function.frame, function.samples, {}, {}, {}});
      TriangleMesh before = mesh;
      start = now();
      chosen = editor.apply(edit, progress).chosen;
      const Time editing = now() - start;
      start = now();
      const TriangleMesh after =
          update_mesh(editor.function(), std::move(before), editor.changed(), {}, progress, &update);
      const Time updating = now() - start;
      if (round == 0 || (editing + updating).wall < (best_edit + best_mesh).wall)
        best_edit = editing, best_mesh = updating;
      closed = measure_topology(after).closed();
    }
    std::printf("%s: %zu supports, %s, %zu triangles out, %zu in, %s\n", trial.name, chosen,
                update.local ? "local" : "all anew", update.removed, update.added, closed ? "closed" : "NOT CLOSED");
    print("  edit", best_edit, whole);
    print("  mesh brought up to date", best_mesh, whole);
    print("  both", best_edit + best_mesh, whole);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: benchmark_function_edit CLOUD [ROUNDS]\n");
    return 2;
  }
  try {
    run(argv[1], argc > 2 ? std::max(1, std::atoi(argv[2])) : 3);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_function_edit: %s\n", error.what());
    return 1;
  }
}
