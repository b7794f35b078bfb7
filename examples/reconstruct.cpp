// Reads a scan, reconstructs a mesh and writes it.
//
//   example_reconstruct SCAN MESH
#include "sansmesh/reconstruct.h"

#include <cstdio>

#include "sansmesh/error.h"
#include "sansmesh/io.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_reconstruct SCAN MESH\n");
    return 2;
  }
  try {
    const sansmesh::PointSet scan = sansmesh::read_points(argv[1]);

    sansmesh::ReconstructOptions options;  // every default is derived from the data
    sansmesh::Progress progress;
    const auto [mesh, report, notes] = sansmesh::reconstruct(scan, options, progress);

    sansmesh::write_mesh(argv[2], mesh);
    std::printf("%zu points, %g apart -> %zu triangles in %d part(s)\n", scan.size(), report.spacing,
                mesh.triangles.size(), report.components);
  } catch (const sansmesh::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
