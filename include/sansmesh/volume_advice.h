// Recommended results and methods for a volume (tejada2008, figure 7.2).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// Properties of the input.
struct VolumeAdviceInput {
  bool values = true;                      ///< the volume has an array; bare meshes have none
  bool vectors = false;                    ///< this or another array has two or three components: a flow
  std::size_t steps = 1;                   ///< number of time steps
  bool lattice = false;                    ///< the samples form a lattice
  bool body = false;                       ///< the cells can represent a deformable body
  VolumeTraits traits;                     ///< traits of the array; ignored without values
  VolumeReconstructionChoice recommended;  ///< recommended reconstruction; ignored without values
};

/// A recommended result.
struct VolumeRecommendation {
  /// Values at points, a uniform grid, a surface, …
  enum class Aim { values, grid, surface, border, picture, lines, flow_surface, flow_picture, deformation, forces };
  Aim aim;                  ///< recommended result
  std::string why;          ///< one sentence without a full stop
  bool by_samples = false;  ///< surface: from the samples by moving least squares, not from the reconstruction
};

/// Recommendations, most requested first; never empty for volumes with values or a body.
SANSMESH_API std::vector<VolumeRecommendation> advise_volume(const VolumeAdviceInput& offer);

/// values, grid, surface, border, …
SANSMESH_API const char* aim_word(VolumeRecommendation::Aim aim);

}  // namespace sansmesh::inline v1
