// Surfaces of all kinds that stand in one picture.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/field/color_field.h"
#include "sansmesh/image.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/flow_texture.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/render_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A surface without a mesh, whose coordinates lie at `place` in those of the picture. Caster and colours (which may be
/// null) must outlive the pictures.
PictureSurface surface_in_picture(const SurfaceCaster& caster, const LocalFrame& frame, const ColorField* colors,
                                  const SurfaceRenderOptions& options);

/// How a surface with a flow along it looks.
struct FlowLook {
  std::optional<FlowTextureOptions> texture = FlowTextureOptions{};  ///< none: smooth
  /// Share of the light from behind that is kept back where the surface is seen at right angles, 0..1; at others it is
  /// more, as of a sheet of glass.
  double opacity = 1;
  bool splats = false;  ///< draws the vertices as discs that blend (SplatScene), not the triangles
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A surface with a flow along it.
struct FlowSubject {
  TriangleMesh mesh;
  std::vector<Vec3f> vectors;        ///< at its vertices, of any length; of unsteady flows those of their own time
  std::vector<std::int32_t> fronts;  ///< of its vertices: neighbouring numbers are neighbours in time; only for splats
};

/// A surface of a flow that is drawn several times: all pictures with the same frame share what they can.
class DrawnFlow {
 public:
  /// `options`: those of the pictures, whose size the streaks have. Throws ArgumentError unless there is a vector for
  /// each vertex.
  DrawnFlow(FlowSubject subject, const RenderOptions& options);
  /// Throws ArgumentError for a bad look, and unless for splats there is a front for each vertex.
  PictureSurface surface(const FlowLook& look) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// Surfaces alone, lit as render_mesh() does, shadows included. `points` frame them (at least one finite), in the
/// coordinates of the surfaces. With `translucent` light comes through those with an opacity below 1: then without
/// shadows and ground. Throws DataError where there is nothing to frame, ArgumentError for bad options.
Image render_surfaces(std::span<const PictureSurface> surfaces, std::span<const Vec3> points, bool translucent,
                      const RenderOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
