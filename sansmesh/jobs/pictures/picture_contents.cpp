#include "sansmesh/jobs/pictures/picture_contents.h"

#include <utility>

#include "sansmesh/io.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::inline v1 {

/// Samples of a surface, or a function, drawn without a mesh.
struct PictureContents::SeenSurface {
  SurfaceModel model;
  SurfaceCaster caster;

  explicit SeenSurface(SurfaceModel made, Progress& progress) : model(std::move(made)), caster(cast(model, progress)) {}
  static SurfaceCaster cast(const SurfaceModel& model, Progress& progress) {
    return model.projection() ? SurfaceCaster(*model.projection(), model.balls(), {})
                              : SurfaceCaster(model.field(progress), model.balls(), {});
  }
};

const OptionSchema& PictureContentsOptions::schema() {
  using O = PictureContentsOptions;
  static constexpr OptionRow rows[] = {
      option<&O::meshes>({.text = "Mesh in the same picture; may be repeated", .unit = "file", .name = "mesh"}),
      option<&O::points>(
          {.text = "Samples of a surface, or a function (.smf), drawn in the same picture without a mesh",
           .unit = "file"})};
  return option_schema<rows>();
}

PictureContents::PictureContents(const PictureContentsOptions& options, const RenderOptions& look, Progress& progress) {
  for (const std::string& file : options.meshes)
    with_file(file, [&] { surfaces_.push_back(scene_factory(read_mesh(file), look)); });
  for (const std::string& file : options.points) with_file(file, [&] { add_points(file, look, progress); });
}

PictureContents::~PictureContents() = default;
PictureContents::PictureContents(PictureContents&&) noexcept = default;

void PictureContents::add_points(const std::string& file, const RenderOptions& look, Progress& progress) {
  SurfaceRenderOptions surface;
  surface.picture = look;
  seen_.push_back(std::make_unique<SeenSurface>(is_function_file(file)
                                                    ? make_surface_model(read_function(file).fitted())
                                                    : make_surface_model(read_points(file), SurfaceOptions{}, progress),
                                                progress));
  const SeenSurface& s = *seen_.back();
  add_notes(notes_, s.model.notes(), file);
  surfaces_.push_back(scene_factory(s.caster, s.model.frame(), s.model.colors(), surface));
}

}  // namespace sansmesh::inline v1
