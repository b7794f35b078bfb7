// Facts of samples that pictures of their volume need, besides fields.
#pragma once

#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// `boundary` becomes the volume's where its box does not tell where it ends; it and the samples must outlive the
/// picture.
VolumeSubject volume_subject(const SampledVolume& samples, TriangleMesh& boundary);

}  // namespace sansmesh::inline v1
