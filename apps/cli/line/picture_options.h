// Options of all commands that make pictures.
#pragma once

#include <string>
#include <utility>

#include "cli/line/command_line.h"
#include "cli/report/console.h"
#include "cli/report/told_files.h"
#include "sansmesh/image.h"
#include "sansmesh/render_options.h"

namespace sansmesh::cli {

/// A picture, by the options that all commands that draw one share.
struct PictureArguments {
  RenderOptions options;
  ViewOptions place;

  bool has_view() const { return place.has_direction(); }
  /// Whether anything was chosen that only means something where there is a picture.
  bool any() const { return !options_set(options).empty() || !options_set(place).empty(); }
  /// Throws ArgumentError for a part of the picture that is none.
  RenderOptions chosen() const { return place.applied_to(options); }
  /// Throws ArgumentError where frames would differ in size.
  void check_frames(bool several) const { place.check_frames(several); }
  /// Of a picture that was made with these options the part that was asked for. Throws ArgumentError where that does
  /// not lie in the picture.
  Image part(const Image& image, const RenderOptions& made_with) const { return place.part_of(image, made_with); }
  /// Writes that part and returns it. Throws FileError as well.
  Image write(const std::string& file, const Image& image, const RenderOptions& made_with) const;
};
/// Pictures that a command writes: one, or the frames of a motion, which stay there if a later one fails.
class PictureFiles {
 public:
  PictureFiles(const PictureArguments& arguments, std::string output, bool several, Console& console)
      : arguments_(arguments), output_(std::move(output)), several_(several), console_(console) {}
  /// Writes the next picture, or the part of it that --crop asks for.
  void write(const Image& image, const RenderOptions& made_with);
  /// The same, for jobs that hand pictures over.
  UsePicture writer();
  const WrittenPictures& written() const { return written_; }

 private:
  const PictureArguments& arguments_;
  std::string output_;
  bool several_;
  Console& console_;
  WrittenPictures written_;
};

/// --background
void add_background_option(CommandLine& command, PictureArguments& arguments);
/// --width, --height, --view, --azimuth, --elevation, --z-up, --field-of-view, --orthographic, --scale-bar, --look-at,
/// --zoom, --look-radius, --clip-box, --crop
void add_picture_options(CommandLine& command, PictureArguments& arguments);
/// --wireframe, --wire-width, --wire-color
void add_wireframe_options(CommandLine& command, RenderOptions& options);
/// --lines, --line-width, --line-strength, --line-color
void add_line_options(CommandLine& command, PictureArguments& arguments);
/// --accessibility, --bend-light
void add_accessibility_options(CommandLine& command, PictureArguments& arguments);
/// --preview FILE: also draws `what`.
void add_preview_option(CommandLine& command, std::string& file, const std::string& what);

}  // namespace sansmesh::cli
