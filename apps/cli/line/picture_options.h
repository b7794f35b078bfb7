// Options of all commands that draw pictures.
#pragma once

#include <string>
#include <utility>

#include "cli/line/command_line.h"
#include "cli/report/console.h"
#include "cli/report/file_reports.h"
#include "sansmesh/image.h"
#include "sansmesh/render_options.h"

namespace sansmesh::cli {

/// Picture options shared by all commands that draw.
struct PictureArguments {
  RenderOptions options;
  ViewOptions view;

  bool has_view() const { return view.has_direction(); }
  /// True if an option was given that applies to pictures only.
  bool any() const { return !options_set(options).empty() || !options_set(view).empty(); }
  /// Throws ArgumentError for an impossible part of the picture.
  RenderOptions chosen() const { return view.applied_to(options); }
  /// Throws ArgumentError if frames would differ in size.
  void check_frames(bool several) const { view.check_frames(several); }
  /// The requested part of a picture made with these options. Throws ArgumentError if it is outside the picture.
  Image part(const Image& image, const RenderOptions& made_with) const { return view.part_of(image, made_with); }
  /// Writes that part and returns it. Also throws FileError.
  Image write(const std::string& file, const Image& image, const RenderOptions& made_with) const;
};
/// Pictures that a command writes: one, or frames, which are kept if a later one fails.
class PictureFiles {
 public:
  PictureFiles(const PictureArguments& arguments, std::string output, bool several, Console& console)
      : arguments_(arguments), output_(std::move(output)), several_(several), console_(console) {}
  /// Writes the next picture, cropped to --crop.
  void write(const Image& image, const RenderOptions& made_with);
  /// The same as a callback for jobs.
  UsePicture writer();
  const WrittenPictures& written() const { return written_; }

 private:
  const PictureArguments& arguments_;
  std::string output_;
  bool several_;
  Console& console_;
  WrittenPictures written_;
};

/// Adds --background.
void add_background_option(CommandLine& command, PictureArguments& arguments);
/// Adds --width, --height, --view, --azimuth, --elevation, --z-up, --field-of-view, --orthographic, --scale-bar,
/// --look-at, --zoom, --look-radius, --clip-box, --crop.
void add_picture_options(CommandLine& command, PictureArguments& arguments);
/// Adds --wireframe, --wire-width, --wire-color.
void add_wireframe_options(CommandLine& command, RenderOptions& options);
/// Adds --lines, --line-width, --line-strength, --line-color.
void add_line_options(CommandLine& command, PictureArguments& arguments);
/// Adds --accessibility, --curvature-shading.
void add_accessibility_options(CommandLine& command, PictureArguments& arguments);
/// Adds --preview FILE, which also draws `what`.
void add_preview_option(CommandLine& command, std::string& file, const std::string& what);

}  // namespace sansmesh::cli
