// Facts about samples for pictures of their volume.
#pragma once

#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Computes `boundary` if the box of the volume is not its boundary. `boundary` and the samples must outlive the
/// picture.
VolumeSubject volume_subject(const SampledVolume& samples, TriangleMesh& boundary);

}  // namespace sansmesh::inline v1
