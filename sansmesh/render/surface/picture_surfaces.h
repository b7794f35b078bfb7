// Factories of surfaces of all kinds for one picture.
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

/// A surface without a mesh, with local coordinates in `frame`. Caster and colours (which may be null) must outlive the
/// pictures.
SceneFactory scene_factory(const SurfaceCaster& caster, const LocalFrame& frame, const ColorField* colors,
                           const SurfaceRenderOptions& options);

/// Appearance of a surface with a flow along it.
struct FlowLook {
  std::optional<FlowTextureOptions> texture = FlowTextureOptions{};  ///< none: no streaks
  /// Share of light that the surface blocks where it faces the viewer, 0..1; it increases at oblique angles, as for
  /// glass.
  double opacity = 1;
  bool splats = false;  ///< draws the vertices as blended discs (SplatScene) instead of the triangles
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A surface with a flow along it.
struct FlowSubject {
  TriangleMesh mesh;
  std::vector<Vec3f> vectors;  ///< at the vertices, of any length; in unsteady flows at the vertex' own time
  std::vector<std::int32_t>
      fronts;  ///< fronts of the vertices: neighbouring numbers are neighbours in time; only for splats
};

/// A flow surface for several pictures: all pictures with the same frame share their data.
class DrawnFlow {
 public:
  /// `options`: those of the pictures; their size determines the size of the streaks. Throws ArgumentError unless there
  /// is one vector per vertex.
  DrawnFlow(FlowSubject subject, const RenderOptions& options);
  /// Throws ArgumentError for bad options, and for splats unless there is one front per vertex.
  SceneFactory surface(const FlowLook& look) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// Picture of the surfaces, lit as in render_mesh(), with shadows. `points` (at least one finite, in the coordinates of
/// the surfaces) determine the frame. With `translucent`, surfaces with an opacity below 1 transmit light; then without
/// shadows and ground. Throws DataError if there is nothing to frame, ArgumentError for bad options.
Image render_surfaces(std::span<const SceneFactory> surfaces, std::span<const Vec3> points, bool translucent,
                      const RenderOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
