#include "picture_contents.h"

#include <utility>

#include "command_line.h"
#include "sansmesh/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/render/surface_caster.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::cli {

/// Samples of a surface, or a function, that is seen without a mesh.
struct PictureContents::SeenSurface {
  SurfaceModel model;
  SurfaceCaster caster;

  explicit SeenSurface(SurfaceModel made, Progress& progress) : model(std::move(made)), caster(cast(model, progress)) {}
  static SurfaceCaster cast(const SurfaceModel& model, Progress& progress) {
    return model.projection() ? SurfaceCaster(*model.projection(), model.balls(), {})
                              : SurfaceCaster(model.field(progress), model.balls(), {});
  }
};

PictureContents::PictureContents() = default;
PictureContents::~PictureContents() = default;

void PictureContents::add_options(CommandLine& c) {
  c.add_option("--mesh", meshes_, "Mesh in the same picture; may be repeated").type_name("FILE").repeated();
  c.add_option("--points", clouds_, "Samples of a surface, or a function (.smf), in the same picture without a mesh")
      .type_name("FILE")
      .repeated();
}

std::vector<PictureSurface> PictureContents::read(const RenderOptions& options, Console& console) {
  std::vector<PictureSurface> surfaces;
  Progress& progress = console.progress();
  for (const std::string& file : meshes_) try {
      surfaces.push_back(surface_in_picture(read_mesh(file), options));
    } catch (const DataError& error) {
      throw FileError(file, error.what());
    }
  SurfaceRenderOptions surface;
  surface.picture = options;
  for (const std::string& file : clouds_) try {
      seen_.push_back(std::make_unique<SeenSurface>(
          is_function_file(file) ? make_surface_model(read_function(file).fitted())
                                 : make_surface_model(read_points(file), SurfaceOptions{}, progress),
          progress));
      const SeenSurface& s = *seen_.back();
      console.warn(file, s.model.warnings());
      surfaces.push_back(surface_in_picture(s.caster, s.model.place(), s.model.colors(), surface));
    } catch (const DataError& error) {
      throw FileError(file, error.what());
    }
  return surfaces;
}

}  // namespace sansmesh::cli
