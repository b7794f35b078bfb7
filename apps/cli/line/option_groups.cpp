#include "cli/line/option_groups.h"

#include <limits>
#include <vector>

#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"

namespace sansmesh::cli {

void require(bool ok, const char* message) {
  if (!ok) throw ArgumentError(message);
}

std::vector<Vec3> query_points(const std::vector<double>& v) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
    points.push_back({v[i], v[i + 1], v[i + 2]});
    if (!is_finite(points.back())) throw ArgumentError("--at must be three finite numbers");
  }
  return points;
}

void add_function_input(CommandLine& c, std::string& file) {
  c.add_option("input", file, "Function, .smf").reads({".smf"}).required();
}

void add_picture_output(CommandLine& c, std::string& file) {
  c.add_option("-o,--output", file, "Picture to write: .png").writes({".png"}).required();
}

void add_points_output(CommandLine& c, std::string& file) {
  c.add_option("-o,--output", file, "Points to write: " + listed_endings(endings_written(kPoints)))
      .writes(endings_written(kPoints))
      .required();
}

void add_ascii_flag(CommandLine& c, bool& ascii, const std::string& group) {
  c.add_flag("--ascii", ascii, "Write text where the format also has a binary form").group(group);
}

void add_nan_flag(CommandLine& c, double& outside, const std::string& group) {
  c.add_flag_callback(
       "--nan", [&outside] { outside = std::numeric_limits<double>::quiet_NaN(); },
       "Set values outside the volume to NaN: --outside nan")
      .group(group);
}

void add_drawing_unit(CommandLine& c, std::string& unit, const std::string& group) {
  c.add_option("--unit", unit, "Unit that makes the drawing true to scale: mm, cm or in")
      .type_name("UNIT")
      .one_of({"mm", "cm", "in"})
      .group(group);
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

void MeshOutput::write_preview(const TriangleMesh& mesh, Console& console) const {
  if (preview.empty()) return;
  const RenderOptions look = picture.chosen();
  picture.write(preview, render_mesh(mesh, look, console.progress()), look);
}

void MeshOutput::write(const TriangleMesh& mesh, Console& console) const {
  write_preview(mesh, console);
  console.progress().begin("write");
  warn_of_system(file, mesh.reference.get(), console);
  write_mesh(file, mesh, {.ascii = ascii});
  report_mesh(file, mesh, console);
}

void add_mesh_output(CommandLine& c, MeshOutput& o, bool required, const OtherOutput& other) {
  c.announce({report_of<WrittenMesh>("output")});
  std::vector<std::string> endings = endings_written(kMesh);
  std::string what = "Mesh to write: " + listed_endings(endings);
  if (!other.ending.empty()) endings.push_back(other.ending), what += ", or " + other.what + ": " + other.ending;
  const Option file = c.add_option("-o,--output", o.file, what).writes(endings);
  if (required) file.required();
  add_preview_option(c, o.preview, "the mesh");
  add_ascii_flag(c, o.ascii);
  add_picture_options(c, o.picture);
  add_wireframe_options(c, o.picture.options);
}

void add_cloud_options(CommandLine& c, CloudPreparation& o) {
  add_schema(c, o, {.only = {"faces", "normals", "orient_by", "align"}});
}

void add_fit_options(CommandLine& c, FitOptions& o) { add_schema(c, o, {.group = "Fit"}); }

void add_mesh_options(CommandLine& c, MeshOptions& o) {
  add_schema(c, o, {.only = {"components", "close_handles", "fill_holes", "trim", "confidence", "quality"}});
  add_schema(
      c, o,
      {.group = "Mesh", .only = {"mesher", "mesh_error", "triangles", "enhance", "displacement", "carry_colors"}});
}

}  // namespace sansmesh::cli
