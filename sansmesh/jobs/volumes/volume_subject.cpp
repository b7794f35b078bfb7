#include "sansmesh/jobs/volumes/volume_subject.h"

#include "sansmesh/volume/grid/volume_boundary.h"

namespace sansmesh::inline v1 {

VolumeSubject volume_subject(const SampledVolume& samples, TriangleMesh& boundary) {
  VolumeSubject subject;
  subject.samples = samples.positions;
  subject.image = samples.lattice.has_value();
  // The bounding box of a lattice with oblique axes is not its boundary.
  bool box = samples.lattice.has_value();
  for (std::size_t k = 0; k < 3 && box; ++k)
    for (std::size_t c = 0; c < 3; ++c) box = box && (c == k || samples.lattice->directions[k][c] == 0);
  if (box) return subject;
  boundary = volume_boundary(samples);
  subject.boundary = &boundary;
  return subject;
}

}  // namespace sansmesh::inline v1
