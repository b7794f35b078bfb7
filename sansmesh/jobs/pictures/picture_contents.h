// Additional surfaces from files in a picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/surface/picture_surfaces.h"

namespace sansmesh::inline v1 {

struct PictureContentsOptions {
  std::vector<std::string> meshes = {};
  std::vector<std::string> points = {};  ///< samples of surfaces, or functions, drawn without a mesh

  static const OptionSchema& schema();
};

/// Owns the surfaces.
class PictureContents {
 public:
  /// Throws FileError.
  PictureContents(const PictureContentsOptions& options, const RenderOptions& look, Progress& progress);
  ~PictureContents();
  PictureContents(PictureContents&&) noexcept;

  const std::vector<SceneFactory>& surfaces() const { return surfaces_; }
  /// "surface": notes on surfaces without a mesh.
  const std::vector<Note>& notes() const { return notes_; }

 private:
  struct SeenSurface;
  void add_points(const std::string& file, const RenderOptions& look, Progress& progress);

  std::vector<std::unique_ptr<SeenSurface>> seen_;
  std::vector<SceneFactory> surfaces_;
  std::vector<Note> notes_;
};

}  // namespace sansmesh::inline v1
