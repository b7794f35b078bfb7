// A function as an asset: fitted once, kept in a file, looked over, mended, and its mesh brought up to date.
#include <cstdio>

#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/io.h"

using namespace sansmesh;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s SCAN FUNCTION.smf\n", argv[0]);
    return 2;
  }
  try {
    Progress progress;
    write_function(argv[2], fit_surface_function(read_points(argv[1]), {}, progress));

    const FittedFunction function = read_function(argv[2]);
    const TriangleMesh mesh = mesh_function(function, {}, progress);

    // Where does it look suspicious?
    const Diagnosis diagnosis = diagnose_function(function, {}, progress);
    std::printf("%zu suspicious places, largest gradient %.2f\n", diagnosis.places.size(), diagnosis.largest_gradient);

    // Planes in a ball around the first vertex, a tenth of the shape wide. The mesh is made anew only there.
    FunctionEditor editor(function);
    Edit flatten;
    flatten.select.ball = {mesh.origin + Vec3(mesh.vertices[0]), 0.05 * Vec3(bounds(mesh).size()).y};
    flatten.action = SetDegree{1};
    const EditReport report = editor.apply(flatten, progress);
    MeshUpdate update;
    const TriangleMesh edited = update_mesh(editor.function(), mesh, editor.changed(), {}, progress, &update);
    std::printf("%s; %zu of %zu triangles are new\n", report.what.c_str(), update.added, edited.triangles.size());

    editor.apply({{}, Undo{}}, progress);
    return update.local && report.chosen > 0 && editor.changed().empty() ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
