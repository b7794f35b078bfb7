// Fuzz target: reading any text of a small format (scripts, tables, alignments, option values) yields usable numbers or
// a one-line error, and written text reads back the same. The first byte selects the format.
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/deform/handles/handle_file.h"
#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/points/point_table.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/tets/vertex_list.h"
#include "sansmesh/io/transform_file.h"
#include "sansmesh/points/cleaning/point_classes.h"
#include "sansmesh/render/scene/color_words.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/volume_look.h"
#include "target.h"

using namespace sansmesh;
using fuzz::demand;

namespace {

// Files named in a text are searched for in a folder that does not exist.
const std::string kFile = "/nonexistent-folder/fuzz.file";

bool is_color(const Vec3f& c) { return is_finite(c) && c.x >= 0 && c.y >= 0 && c.z >= 0; }

void read_handle_text(const std::string& text) {
  const std::vector<Handle> handles = parse_handles(text, kFile);
  demand(!handles.empty(), "no handles");
  for (const Handle& h : handles) {
    demand(is_finite(h.p) && is_finite(h.q) && std::isfinite(h.weight) && h.weight > 0, "a handle is not finite");
    demand(h.p_end.has_value() == h.q_end.has_value(), "a segment has one end");
    for (const TurnedDirection& d : h.directions)
      demand(std::abs(norm(d.before) - 1) < 1e-6 && std::abs(norm(d.after) - 1) < 1e-6, "a direction is not unit");
  }
  const std::string written = handles_json(handles);
  demand(handles_json(parse_handles(written, kFile)) == written, "handles do not read back the same");
}

void read_scene(const std::string& text, bool z_up) {
  static const TetMesh body{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}, {}, {}};
  SceneVertices vertices;
  vertices.mesh = &body;
  vertices.find = [](std::uint64_t number) {
    if (number >= body.vertices.size()) throw DataError("there is no vertex " + std::to_string(number));
    return static_cast<std::uint32_t>(number);
  };
  vertices.list = [](const std::string& file) -> std::vector<std::uint64_t> { throw FileError(file, "no such file"); };
  const SceneScript script = parse_scene_script(text, vertices, z_up);
  for (const std::optional<double>& n :
       {script.step, script.duration, script.frames_per_second, script.unit, script.stiffness, script.damping,
        script.young, script.poisson, script.density, script.mass, script.tolerance, script.friction})
    demand(!n || std::isfinite(*n), "a number of a scene is not finite");
  demand(!script.gravity || is_finite(*script.gravity), "gravity is not finite");
  scaled(script.scene, 0.01);
}

void read_transfer(const std::string& text) {
  const TransferFunction f = parse_transfer_function(text, kFile);
  f.validate();
  const auto [lower, upper] = f.range();
  demand(std::isfinite(lower) && std::isfinite(upper) && lower <= upper, "a range that is none");
  for (const double value : {lower, upper, 0.5 * lower + 0.5 * upper, -1e300, 1e300}) {
    demand(is_color(f.color(value)), "a colour is not finite");
    demand(f.opacity(value) >= 0 && f.opacity(value) <= 1, "an opacity is none");
  }
  const std::string written = transfer_function_json(f);
  demand(transfer_function_json(parse_transfer_function(written, kFile)) == written,
         "a transfer function does not read back the same");
}

void read_edits(const std::string& text) {
  const std::string written = edit_script(parse_edit_script(text));
  demand(edit_script(parse_edit_script(written)) == written, "edits do not read back the same");
}

void read_series(const io::Input& in, bool pvd) {
  for (const io::PvdEntry& entry : pvd ? io::read_pvd(in) : io::read_file_series(in))
    demand(!entry.file.empty() && std::isfinite(entry.time), "a step without a file, or without a time");
}

void read_map(const std::string& text) {
  const AffineMap map = parse_transform(text, kFile);
  for (const Vec3& v : {map.x, map.y, map.z, map.shift}) demand(is_finite(v), "a matrix is not finite");
}

void read_drawing(const io::Input& in, bool obj) {
  const PolylineSet lines = obj ? io::read_obj_lines(in) : io::read_dxf_lines(in);
  demand(is_finite(lines.origin) && lines.offsets.back() == lines.positions.size(), "lines that are none");
  for (std::size_t i = 0; i < lines.size(); ++i)
    demand(lines.offsets[i] < lines.offsets[i + 1], "a line without points");
}

/// Reads one word of a command line.
void read_word(const std::string& text, std::size_t which) {
  switch (which) {
    case 0: {
      const IsoSurface iso = iso_surface_of(text);
      demand(std::isfinite(iso.value) && iso.opacity >= 0 && iso.opacity <= 1, "an iso-surface that is none");
      break;
    }
    case 1: {
      const VolumeCut cut = volume_cut_of(text);
      demand(is_finite(cut.normal) && !(cut.normal == Vec3{}) && !std::isnan(cut.offset) && cut.thickness > 0,
             "a cut that is none");
      break;
    }
    case 2:
      color_of_hex(text);
      break;
    case 3:
      if (const auto name = parse_isosurface_name(text))
        demand(!name->file.empty() && std::isfinite(name->value), "an isosurface that is none");
      break;
    case 4:
      demand(parse_point_classes(text).any(), "no classes");
      break;
    case 5:
      for (const Vec3& p : parse_seeds(text, {{0, 0, 0}, {1, 1, 1}}).points)
        demand(is_finite(p), "a seed is not finite");
      break;
    case 6: {
      const CutPlane plane = parse_plane(text);
      demand(is_finite(plane.normal) && std::isfinite(plane.offset), "a plane is not finite");
      break;
    }
    default:
      if (const auto layout = io::raw_layout_of_name(text))
        demand(layout->dims[0] > 0 && layout->dims[1] > 0 && layout->dims[2] > 0 && layout->components > 0,
               "a layout that is none");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2 || size > 20000) return 0;
  const ThreadScope one(1);
  const fuzz::ExactBytes bytes(data + 1, size - 1);
  const std::string text(bytes.view());
  ReadReport report;
  const io::Input in{kFile, bytes.view(), report};
  fuzz::ends_well([&] {
    switch (data[0] % 12) {
      case 0:
        return read_handle_text(text);
      case 1:
        return read_scene(text, data[0] >= 128);
      case 2:
        return read_transfer(text);
      case 3:
        return read_edits(text);
      case 4:
        return read_series(in, false);
      case 5:
        return read_series(in, true);
      case 6:
        return fuzz::check_points(io::read_conf(in));
      case 7:
        return read_map(text);
      case 8:
        return demand(!parse_point_table(bytes.view(), kFile).empty(), "no points");
      case 9:
        return demand(!parse_vertex_list(bytes.view(), kFile).empty(), "no vertices");
      case 11:
        return read_drawing(io::Input{kFile, bytes.view().substr(1), report}, text[0] == 'o');
      default:
        return read_word(text.substr(1), static_cast<std::uint8_t>(text[0]) % 8);
    }
  });
  fuzz::check_report(report);
  return 0;
}
