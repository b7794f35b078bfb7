#include "cli/line/picture_options.h"

#include "cli/line/help_levels.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::cli {

Image PictureArguments::write(const std::string& file, const Image& image, const RenderOptions& made_with) const {
  Image written = part(image, made_with);
  write_image(file, written);
  return written;
}

void PictureFiles::write(const Image& image, const RenderOptions& made_with) {
  written_.files.push_back(several_ ? frame_name(output_, written_.files.size()) : output_);
  if (written_.files.size() > 1) console_.keep_frames();
  console_.progress().begin("write");
  const Image part = arguments_.write(written_.files.back(), image, made_with);
  written_.width = part.width, written_.height = part.height;
}

UsePicture PictureFiles::writer() {
  return [this](std::size_t, const Image& image, const RenderOptions& made_with) { write(image, made_with); };
}

void add_background_option(CommandLine& c, PictureArguments& a) {
  add_schema(c, a.options, {.group = "Picture", .only = {"background"}});
}

void add_picture_options(CommandLine& c, PictureArguments& a) {
  const char* const group = kViewGroup;
  add_schema(c, a.options, {.group = group, .only = {"width", "height"}});
  add_schema(c, a.view, {.group = group, .without = {"crop"}});
  add_schema(c, a.options, {.group = group, .only = {"field_of_view", "orthographic"}});
  add_schema(c, a.options, {.group = group, .only = {"scale_bar"}});
  add_schema(c, a.options, {.group = group, .only = {"look_at", "zoom", "look_radius", "clip_box"}});
  add_schema(c, a.view, {.group = group, .only = {"crop"}});
}

void add_wireframe_options(CommandLine& c, RenderOptions& o) {
  add_schema(c, o, {.group = "Picture", .only = {"wireframe", "wire_width", "wire_color"}});
}

void add_line_options(CommandLine& c, PictureArguments& a) {
  add_schema(c, a.options, {.group = "Picture", .only = {"lines", "line_width", "line_strength", "line_color"}});
}

void add_accessibility_options(CommandLine& c, PictureArguments& a) {
  add_schema(c, a.options, {.group = "Picture", .only = {"accessibility", "curvature_shading"}});
}

void add_preview_option(CommandLine& c, std::string& file, const std::string& what) {
  c.add_option("--preview", file, "Also draw " + what + " into this PNG").writes({".png"});
}

}  // namespace sansmesh::cli
