// What the parts of `sansmesh deform` share.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloud_input.h"
#include "console.h"
#include "deform_input.h"
#include "option_groups.h"
#include "sansmesh/core/box.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/deform/folds.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/render_options.h"
#include "volume_colors.h"
#include "volume_input.h"

namespace sansmesh::cli {

struct DeformArguments {
  VolumeInput input;  ///< its files are also those of clouds, or an expression
  DeformationInput deformation;
  std::string output;
  int frames = 0;
  std::optional<int> displacement_map;  ///< nodes along the longest side

  PictureArguments picture;
  std::string background = "gradient";
  bool draw_handles = false, draw_folds = false;

  std::optional<double> bend;  ///< of meshes
  bool ascii = false;

  CsgMeshOptions mesh;  ///< of functions
  std::optional<ComponentChoice> components;
  std::vector<std::string> planes;
  std::string unit;

  std::vector<double> size;  ///< of volumes
  bool all_arrays = false, nan = false, exact = false, no_shading = false, no_bar = false;
  std::vector<std::string> clips;
  VolumeColors colors;
  int map_nodes = 96;

  bool to_picture() const { return output.ends_with(".png"); }
  bool to_section() const { return output.ends_with(".svg") || output.ends_with(".csv"); }
  /// Of frame k of those that there are.
  double share(int k) const { return frames > 0 ? static_cast<double>(k) / (frames - 1) : 1; }
  int poses() const { return frames > 0 ? frames : 1; }
  std::string file(int k) const { return frames > 0 ? frame_name(output, k) : output; }
};

/// What a command says of all poses in the end.
struct DeformResult {
  std::vector<std::string> files;
  Json input, output;
  std::vector<std::string> lines;
};

/// Where space is folded, of all poses the one that is folded most.
class FoldWatch {
 public:
  /// Looks at a map in a box: that of what is seen through it, or of what is moved by it. Returns the folds as
  /// something to see, which is empty where there are none.
  TriangleMesh look(const SpaceMap& map, const Box3& box, Progress& progress);
  /// Warns of what was found; its numbers go to the result.
  void report(const std::string& name, DeformResult& result, Console& console) const;

 private:
  FoldReport worst_;
};

DeformResult deform_points(const DeformArguments& a, const OpenDeformation& deformation, Console& console);
DeformResult deform_solid(const DeformArguments& a, const OpenDeformation& deformation, Console& console);
DeformResult deform_volume(const DeformArguments& a, const OpenDeformation& deformation, Console& console);

/// Looks of a picture, with the view as it was chosen.
RenderOptions deform_look(const DeformArguments& a);
/// Corners of a box.
void add_corners(const Box3& box, std::vector<Vec3>& places);
/// Surfaces, and beside them handles and folds as far as they are asked for, framed by `places` and the handles.
Image picture_beside(std::vector<PictureSurface> surfaces, const DeformArguments& a, const OpenDeformation& deformation,
                     double share, std::vector<Vec3> places, const TriangleMesh& folds, Progress& progress);

}  // namespace sansmesh::cli
