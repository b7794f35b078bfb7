// A function as an asset: fits it, stores it in a file, diagnoses and repairs it, and updates its mesh.
#include <cstdio>

#include "sansmesh/functions.h"
#include "sansmesh/io.h"

using namespace sansmesh;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s SCAN FUNCTION.smf\n", argv[0]);
    return 2;
  }
  try {
    Progress progress;
    write_function(argv[2], fit_function(read_points(argv[1]), {}, progress).function);

    const SurfaceFunction function = read_function(argv[2]);
    const TriangleMesh mesh = mesh_of_function(function, {}, progress).mesh;

    // Find doubtful regions.
    const Diagnosis diagnosis = diagnose(function, {}, progress).diagnosis;
    std::printf("%zu suspicious regions, largest gradient %.2f\n", diagnosis.regions.size(),
                diagnosis.largest_gradient);

    // Replace the fits in a ball around the first vertex, a tenth of the shape wide, by planes. Only that part is
    // meshed again.
    Edit flatten;
    flatten.select.ball = {mesh.origin + Vec3(mesh.vertices[0]), 0.05 * Vec3(bounds(mesh).size()).y};
    flatten.action = SetDegree{1};
    const EditedFunction edited = edit({.function = function, .mesh = mesh}, {flatten}, true, progress);
    std::printf("%s; %zu of %zu triangles are new\n", edited.steps[0].what.c_str(), edited.update.added,
                edited.mesh.triangles.size());
    return edited.update.local && edited.steps[0].chosen > 0 ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
