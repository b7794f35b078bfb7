// Options of deformations, whatever is deformed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/render/volume_options.h"
#include "sansmesh/repair.h"
#include "sansmesh/solid_measures.h"

namespace sansmesh::inline v1 {

/// What is made of a thing that is deformed: the same kind of thing (of a solid a mesh), its sections, or a picture.
enum class DeformAim : std::uint8_t { shape, sections, picture };

struct DeformOptions {
  std::optional<int> frames = {};  ///< so many poses from before to after, 2 or more; default: that after it alone

  std::optional<double> refine = {};  ///< of meshes: edges are cut in half first that bend by more than this (length)
  bool cut_open = false;              ///< closed meshes stay open along cuts

  std::optional<int> resolution = {};  ///< of solids, as CsgMeshOptions has it; of sections squares
  std::optional<double> cell = {}, simplify = {};
  std::optional<ComponentChoice> components = {};  ///< default: automatic with functions, else all
  std::vector<CutPlane> planes = {};               ///< of sections; default: three through the middle
  std::optional<Box3> box = {};                    ///< after the deformation: what ends there

  ResampleOptions lattice = {};  ///< of volumes: its `size` and `outside`

  /// Of volumes in pictures: nodes along the longest side of the map that they are seen through, 8..512.
  int map_nodes = 96;
  bool exact = false;  ///< in pictures: straight through the deformation, and of solids without a mesh
  bool draw_handles = false, draw_folds = false;
  VolumePictureOptions look = {};  ///< of pictures: all but of volumes its RenderOptions alone
  bool any_view = true;            ///< nobody chose the view: that of a thin volume looks straight at it

  /// Without `look`.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and for such as mean nothing to the aim.
  void validate(DeformAim aim) const;
  int poses() const { return frames.value_or(1); }
  /// Of the way, at a pose.
  double share(int pose) const { return frames ? static_cast<double>(pose) / (*frames - 1) : 1; }
};

}  // namespace sansmesh::inline v1
