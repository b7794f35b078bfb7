// Surfaces that a command puts into a picture beside what it draws.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "console.h"
#include "sansmesh/render/picture_surfaces.h"

namespace sansmesh::cli {

class CommandLine;

class PictureContents {
 public:
  PictureContents();
  ~PictureContents();
  /// --mesh, --points
  void add_options(CommandLine& command);
  bool empty() const { return meshes_.empty() && clouds_.empty(); }
  /// Reads them; what they need lives as long as this. Throws FileError.
  std::vector<PictureSurface> read(const RenderOptions& options, Console& console);

 private:
  struct SeenSurface;
  std::vector<std::string> meshes_, clouds_;
  std::vector<std::unique_ptr<SeenSurface>> seen_;
};

}  // namespace sansmesh::cli
