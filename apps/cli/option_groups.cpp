#include "option_groups.h"

#include <fmt/core.h>

#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "schema_options.h"

namespace sansmesh::cli {

void require(bool ok, const char* message) {
  if (!ok) throw ArgumentError(message);
}

std::vector<Vec3> places_at(const std::vector<double>& v) {
  std::vector<Vec3> places;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
    places.push_back({v[i], v[i + 1], v[i + 2]});
    if (!is_finite(places.back())) throw ArgumentError("--at must be three finite numbers");
  }
  return places;
}

void add_ascii_flag(CommandLine& c, bool& ascii) {
  c.add_flag("--ascii", ascii, "Write text where the format also has a binary form");
}

void MeshOutput::check() const {
  check_writable(file, "mesh");
  check_preview();
}

void MeshOutput::check_preview() const {
  picture.chosen().validate();
  require(!preview.empty() || !picture.any(), "options of the picture need --preview");
  if (!preview.empty()) check_writable(preview, "image");
}

void MeshOutput::write(const TriangleMesh& mesh, Progress& progress) const {
  Image image;
  const RenderOptions look = picture.chosen();
  if (!preview.empty()) image = render_mesh(mesh, look, progress);
  progress.begin("write");
  write_mesh(file, mesh, {.ascii = ascii});
  if (!preview.empty()) picture.write(preview, image, look);
}

void say_aspect_ratios(const MeshReport& report, Console& console) {
  console.say(fmt::format("aspect ratio {:.3f} ± {:.3f} before enhancement, {:.3f} ± {:.3f} after",
                          report.aspect_mean_before, report.aspect_deviation_before, report.aspect_mean,
                          report.aspect_deviation));
}

void add_mesh_output(CommandLine& c, MeshOutput& o, bool required) {
  const Option file =
      c.add_option("-o,--output", o.file, "Mesh to write: " + listed_endings(endings_written(kMesh))).type_name("FILE");
  if (required) file.required();
  add_preview_option(c, o.preview, "the mesh");
  add_ascii_flag(c, o.ascii);
  add_picture_options(c, o.picture);
  add_wireframe_options(c, o.picture.options);
}

void add_bar_options(CommandLine& c, bool& no_bar, std::string& unit, const std::string& of) {
  c.add_flag("--no-bar", no_bar, "Without the colour bar").group("Picture");
  c.add_option("--unit", unit, "Of " + of + ", at the colour bar").type_name("UNIT").group("Picture");
}

void add_cloud_options(CommandLine& c, CloudUse& o) {
  add_schema(c, o, {.only = {"faces", "normals", "orient_by", "align"}});
}

std::string normals_made(bool estimated, const std::optional<OrientBy>& oriented_by) {
  return fmt::format("{}{}", estimated ? "estimated" : "as given",
                     oriented_by ? fmt::format(", oriented {}", orientation_words(*oriented_by)) : "");
}

Json normals_made_json(bool estimated, const std::optional<OrientBy>& oriented_by) {
  return {{"estimated", estimated}, {"oriented_by", oriented_by ? Json(orient_by_word(*oriented_by)) : Json()}};
}

std::vector<std::string> paper_words(const PaperReport& r, const FitsOfDegree& fits) {
  return {fmt::format("{} planes, {} of degree 2, {} of degree 3, {} of degree 4, {} constants; {} planes are borrowed "
                      "from the nearest samples",
                      grouped(fits[1]), grouped(fits[2]), grouped(fits[3]), grouped(fits[4]), grouped(fits[0]),
                      grouped(r.borrowed)),
          fmt::format("{}: {} subdivided for two sheets, {} for too many samples; of those with few samples {} "
                      "subdivided, {} not, since their children are worse; {} above the threshold; {} by balance alone",
                      counted(r.blocks, "block"), grouped(r.two_sheets), grouped(r.too_many), grouped(r.not_worse),
                      grouped(r.kept), grouped(r.above), grouped(r.balanced))};
}

Json paper_json(const PaperReport& r) {
  return {{"blocks", r.blocks},     {"fitted", r.fitted},       {"borrowed", r.borrowed}, {"two_sheets", r.two_sheets},
          {"too_many", r.too_many}, {"not_worse", r.not_worse}, {"kept", r.kept},         {"above", r.above},
          {"balanced", r.balanced}};
}

void add_fit_options(CommandLine& c, FitOptions& o) { add_schema(c, o, {.group = "Fit"}); }

void add_mesh_options(CommandLine& c, MeshOptions& o) {
  add_schema(c, o, {.only = {"components", "fill_holes", "trim", "confidence", "quality"}});
  add_schema(
      c, o,
      {.group = "Mesh", .only = {"mesher", "mesh_error", "triangles", "enhance", "displacement", "carry_colors"}});
}

}  // namespace sansmesh::cli
