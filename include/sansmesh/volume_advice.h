// What can be made of a volume, and by which method: METHODS §8, figure 7.2 of [tejada2008].
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/reconstruction_options.h"

namespace sansmesh::inline v1 {

/// What there is to work with.
struct VolumeOffer {
  bool values = true;           ///< an array at all; bare meshes have none
  bool vectors = false;         ///< the array, or another one, has two or three components: a flow
  std::size_t steps = 1;        ///< in time
  bool lattice = false;         ///< the samples lie on one
  bool body = false;            ///< the cells may be a body that moves
  VolumeTraits traits;          ///< of the array; not looked at without values
  ReconstructionChoice suited;  ///< likewise
};

/// Something to make of it.
struct VolumeRecommendation {
  /// Values at points, a uniform grid, a surface, …
  enum class Aim { values, grid, surface, border, picture, lines, flow_surface, flow_picture, deformation, forces };
  Aim aim;                  ///< what to make
  std::string why;          ///< one sentence without an end
  bool by_samples = false;  ///< of a surface: from the samples by moving least squares, not from the reconstruction
};

/// What is asked for most first; never empty where there are values or a body.
SANSMESH_API std::vector<VolumeRecommendation> advise_volume(const VolumeOffer& offer);

/// values, grid, surface, border, …
SANSMESH_API const char* aim_word(VolumeRecommendation::Aim aim);

}  // namespace sansmesh::inline v1
