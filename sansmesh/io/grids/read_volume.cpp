// Chooses the reader of a volume: by the first bytes of its file if these are unique, else by its ending.
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/io/grids/fill_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "sansmesh/data/grid_limits.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/grids/adf_size.h"
#include "sansmesh/io/grids/netcdf_size.h"
#include "sansmesh/io/grids/time_steps.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/grids/vtk_module.h"
#include "sansmesh/io/grids/vtk_size.h"
#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/points/cloud_files.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1 {
namespace {

using io::Input;

std::string known_volume_endings() {
  std::string known;
  for (const FormatInfo* const f : formats())
    if ((f->reads & kVolume) != 0 && (f->reads & kPoints) == 0 && !f->endings.empty())
      known += std::string(f->endings) + " ";
  known.pop_back();
  return known + ", and those of points";
}

/// Files of points are scattered samples: all of their readers count as one here.
std::optional<FormatId> volume_format_of_name(const std::string& file) {
  const FormatInfo* const found = format_of_name(file, kVolume);
  if (!found) return std::nullopt;
  return found == format_of_name(file, kPoints) ? FormatId::table : found->id;
}

/// The type in the root element of a VTK XML file; empty if there is none. Throws FileError for AMR levels in versions
/// of the format that VTK no longer reads, and may crash on.
std::string vtk_xml_type(const Input& in) {
  if (in.bytes.substr(0, 4096).find("<VTKFile") == std::string_view::npos) return {};
  ReadReport ignored;
  const Input head{in.file, in.bytes.substr(in.bytes.find("<VTKFile"), 4096), ignored};
  io::XmlScanner xml(head);
  const auto tag = xml.next();
  if (!tag) return {};
  const std::string type((*tag)["type"]);
  double version = 0;
  io::TextScanner text((*tag)["version"]);
  if ((type.ends_with("AMR") || type.ends_with("HierarchicalBoxDataSet")) && (!text.number(version) || version < 1.1))
    in.fail("holds levels in a version of the format before 1.1, which is not supported: write it again with ParaView");
  return type;
}

std::optional<FormatId> format_of_volume(const Input& in, const std::string& xml_type) {
  const auto by_name = volume_format_of_name(in.file);
  if (xml_type == "PolyData" || xml_type == "PPolyData") return FormatId::table;
  if (xml_type == "Collection") return FormatId::pvd;
  if (!xml_type.empty()) return FormatId::vtk_xml;
  const FormatInfo* const found = format_of_content(in.bytes);
  switch (const FormatId by_content = found ? found->id : FormatId::archive; by_content) {
    case FormatId::exodus:  // HDF5 and NetCDF also hold other data
      return by_name == FormatId::cgns ? *by_name : by_content;
    case FormatId::vtk_legacy:
    case FormatId::nrrd:
    case FormatId::metaimage:
    case FormatId::dicom:
    case FormatId::nek_field:
    case FormatId::gmsh:
    case FormatId::cgns:
      return by_content;
    default:
      break;
  }
  const std::string name = io::ending(in.file);
  if (name == "xyz" || name == "g" || name == "dat") return io::is_plot3d(in) ? FormatId::plot3d : by_name;
  if (!by_name && io::is_plot3d(in)) return FormatId::plot3d;
  return by_name;
}

GridData scattered_points(const std::string& file, ReadReport& report) {
  const PointSet points = io::read_points_of_volume(file, report);
  GridData data;
  data.format = report.format;
  GridBlock& block = data.blocks.emplace_back();
  block.kind = GridKind::scattered;
  block.points.reserve(points.size());
  for (const Vec3f& p : points.positions) block.points.push_back(points.origin + Vec3(p));
  block.point_arrays = points.attributes;
  const auto add = [&](const char* name, auto values) {
    if (!block.point_arrays.find(name)) block.point_arrays.set(name, std::move(values), 3);
  };
  if (points.has_normals()) {
    std::vector<float> flat;
    for (const Vec3f& n : points.normals) flat.insert(flat.end(), {n.x, n.y, n.z});
    add("normal", std::move(flat));
  }
  if (points.has_colors()) {
    std::vector<std::uint8_t> flat;
    for (const auto& c : points.colors) flat.insert(flat.end(), c.begin(), c.end());
    add("color", std::move(flat));
  }
  return data;
}

GridData read_collection(const Input& in, const VolumeReadOptions& options, ReadReport& report);

/// Checks the beginning of a file that the module reads, so that damage is reported before VTK allocates memory.
void check_vtk_file(const Input& in, FormatId format, const std::string& xml_type) {
  switch (format) {
    case FormatId::vtk_xml:
      if (xml_type.empty()) in.fail("is not a file of VTK's in XML, as its ending says it should be");
      return io::check_vtk_xml_size(in);
    case FormatId::vtk_legacy:
      if (!in.bytes.starts_with("# vtk DataFile")) in.fail("does not begin with '# vtk DataFile', as its ending says");
      return io::check_vtk_legacy_size(in);
    case FormatId::exodus:
      if (in.bytes.starts_with("CDF")) return io::check_netcdf_size(in);
      if (in.bytes.starts_with("\x89HDF")) return;
      in.fail("is neither Exodus (NetCDF, HDF5) nor PLOT3D of a size that fits its header");
    case FormatId::cgns:
      if (in.bytes.substr(0, 64).find("ADF Database") != std::string_view::npos) io::check_adf_size(in);
      return;
    default:
      return;
  }
}

std::optional<io::VtkFormat> vtk_format(FormatId format) {
  constexpr std::pair<FormatId, io::VtkFormat> formats[] = {
      {FormatId::vtk_xml, io::VtkFormat::xml},   {FormatId::vtk_legacy, io::VtkFormat::legacy},
      {FormatId::exodus, io::VtkFormat::exodus}, {FormatId::ensight, io::VtkFormat::ensight},
      {FormatId::cgns, io::VtkFormat::cgns},     {FormatId::openfoam, io::VtkFormat::openfoam},
      {FormatId::dicom, io::VtkFormat::dicom}};
  for (const auto& [id, vtk] : formats)
    if (id == format) return vtk;
  return std::nullopt;
}

RawLayout named_layout(const Input& in) {
  const auto layout = io::raw_layout_of_name(in.file);
  if (!layout)
    in.fail(
        "holds numbers without a header: give their layout, or name it like engine_256x256x128_uint8.raw, or "
        "write a MetaImage header (.mhd) for it");
  return *layout;
}

/// Reads formats with a single step.
GridData read_single_step(const Input& in, FormatId format, const VolumeReadOptions& options) {
  io::check_time_step(in.file, options.time_step, 1);
  switch (format) {
    case FormatId::raw:
      return io::read_raw(in, options.raw.given() ? options.raw : named_layout(in));
    case FormatId::plot3d:
      return io::read_plot3d(in, options.solution);
    case FormatId::table:
      return scattered_points(in.file, in.report);
    case FormatId::nek_field:
      return io::read_nek_field(in);
    case FormatId::gmsh:
      return io::read_gmsh(in);
    case FormatId::medit:
      return io::read_medit(in);
    case FormatId::tetgen:
      return io::read_tetgen_pair(in);
    default:
      return io::read_vega(in);
  }
}

GridData read_any_volume(const std::string& file, const VolumeReadOptions& options, ReadReport& report,
                         bool inside_collection) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return io::read_by_vtk({file, io::VtkFormat::dicom, {}, options.time_step});
  // OpenFOAM users open an empty file of this kind only to name its folder.
  if (volume_format_of_name(file) == FormatId::openfoam && std::filesystem::exists(file, ignored))
    return io::read_by_vtk({file, io::VtkFormat::openfoam, {}, options.time_step});
  const io::FileContent content(file);
  const Input in{file, content.bytes(), report};
  if (options.raw.given()) return read_single_step(in, FormatId::raw, options);
  const std::string xml_type = vtk_xml_type(in);
  const FormatId format = format_of_volume(in, xml_type).value_or(FormatId::archive);
  if (const auto vtk = vtk_format(format)) {
    check_vtk_file(in, format, xml_type);
    if (content.gzipped()) in.fail("files of this format are not read gzipped: unpack it first");
    return io::read_by_vtk({file, *vtk, xml_type, options.time_step});
  }
  switch (format) {
    case FormatId::metaimage:
      return io::read_metaimage(in, options.time_step);
    case FormatId::nrrd:
      return io::read_nrrd(in, options.time_step);
    case FormatId::nek_series:
      return io::read_nek_series(in, options.time_step);
    case FormatId::pvd:
    case FormatId::series:
      if (inside_collection) in.fail("is a collection inside another one");
      return read_collection(in, options, report);
    case FormatId::fitted_volume:
      in.fail("is a fitted volume, which holds samples and no grid: it is read on its own");
    case FormatId::raw:
    case FormatId::plot3d:
    case FormatId::table:
    case FormatId::nek_field:
    case FormatId::gmsh:
    case FormatId::medit:
    case FormatId::tetgen:
    case FormatId::vega:
      return read_single_step(in, format, options);
    default:
      break;
  }
  const std::string name = io::ending(file);
  in.fail(name.empty() ? "has no ending and its content is of no known format; known endings: " + known_volume_endings()
                       : "unknown ending '." + name.substr(0, 20) + "'; known: " + known_volume_endings());
}

void append_blocks(GridData& all, GridData part, const std::string& name) {
  for (GridBlock& block : part.blocks) {
    block.name = block.name.empty() ? name : name + "/" + block.name;
    all.blocks.push_back(std::move(block));
  }
  all.notes.insert(all.notes.end(), part.notes.begin(), part.notes.end());
  if (all.format.find(part.format) == std::string::npos) all.format += (all.format.empty() ? "" : ", ") + part.format;
  if (all.times.empty()) all.times = std::move(part.times);
  if (!all.time) all.time = part.time;
}

GridData read_collection(const Input& in, const VolumeReadOptions& options, ReadReport& report) {
  const bool series = volume_format_of_name(in.file) == FormatId::series;
  const std::vector<io::PvdEntry> entries = series ? io::read_file_series(in) : io::read_pvd(in);
  GridData all;
  for (const io::PvdEntry& e : entries) all.times.push_back(e.time);
  std::sort(all.times.begin(), all.times.end());
  all.times.erase(std::unique(all.times.begin(), all.times.end()), all.times.end());
  io::check_time_step(in.file, options.time_step, all.times.size());
  all.time = all.times[options.time_step];
  for (const io::PvdEntry& e : entries) {
    if (e.time != *all.time) continue;
    append_blocks(all, read_any_volume(e.file, {}, report, true), std::filesystem::path(e.file).stem().string());
  }
  all.format = (series ? "series of files, " : "ParaView collection, ") + all.format;
  return all;
}

/// Uses all blocks together: a value that is separate in one block may not be in another.
GridData with_fill_values(GridData data, const FillValueOptions& fill) {
  const std::vector<std::string> lines = mark_fill_values(data, fill);
  data.notes.insert(data.notes.end(), lines.begin(), lines.end());
  return data;
}

void check_points(const std::string& file, const GridData& data) {
  for (const GridBlock& block : data.blocks) {
    if (!block.points.empty() || block.kind == GridKind::lattice) return;
  }
  throw FileError(file, "holds no points");
}

/// For files that could also be tables of points, which begin with an integer only by chance.
bool holds_plot3d(const std::string& file) {
  try {
    const io::FileContent content(file);
    const std::string_view bytes = content.bytes();
    const bool text = bytes.substr(0, 4096).find('\0') == std::string_view::npos;
    const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    if (text && begin == std::string_view::npos) return false;
    const std::string_view rest = bytes.substr(text ? begin : 0);
    const std::size_t digits = rest.find_first_not_of("0123456789");
    if (text && (digits == 0 || (digits != std::string_view::npos && rest[digits] == '.'))) return false;
    ReadReport ignored;
    return io::is_plot3d({file, bytes, ignored});
  } catch (const FileError&) {
    return false;  // its reader reports the reason
  }
}

/// The volume as in the file, including fill values.
GridData read_whole(const std::string& file, const VolumeReadOptions& options, ReadReport& r) {
  r = {};
  GridData data = read_any_volume(file, options, r, false);
  check_points(file, data);
  if (const std::string cause = out_of_limits(data); !cause.empty()) throw FileError(file, cause);
  data.notes.insert(data.notes.end(), r.warnings.begin(), r.warnings.end());
  r.format = data.format;
  return data;
}

}  // namespace

GridData read_volume(const std::string& file, const VolumeReadOptions& options, ReadReport* report) {
  options.validate();
  ReadReport own;
  return with_fill_values(read_whole(file, options, report ? *report : own), options.fill);
}

GridData read_volumes(const std::vector<std::string>& files, const VolumeReadOptions& options, ReadReport* report) {
  if (files.empty()) throw ArgumentError("read_volumes: no files");
  options.validate();
  ReadReport own;
  ReadReport& all_report = report ? *report : own;
  all_report = {};
  GridData all;
  std::size_t parts = 0;
  for (std::size_t k = 0; k < files.size(); ++k) {
    VolumeReadOptions of_file = options;
    // A grid followed by its solution.
    if (of_file.solution.empty() && k + 1 < files.size()) {
      std::error_code ignored;
      const std::string solution = io::plot3d_solution_of(files[k]);
      if (!solution.empty() && std::filesystem::equivalent(solution, files[k + 1], ignored))
        of_file.solution = solution;
    }
    ReadReport r;
    GridData part = read_whole(files[k], of_file, r);
    for (const std::string& w : r.warnings) all_report.warnings.push_back(printable(files[k], 200) + ": " + w);
    if (of_file.solution != options.solution) ++k;
    ++parts;
    if (parts == 1 && k + 1 == files.size()) {
      all_report.format = part.format;
      return with_fill_values(std::move(part), options.fill);
    }
    append_blocks(all, std::move(part), std::filesystem::path(files[k]).stem().string());
  }
  all.format = fmt::format("{} files, {}", parts, all.format);
  all_report.format = all.format;
  return with_fill_values(std::move(all), options.fill);
}

bool is_volume_name(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) return !io::is_cloud_folder(file);  // slices of DICOM
  const auto format = volume_format_of_name(file);
  return format && format != FormatId::table;
}

bool holds_volume(const std::string& file) {
  if (is_volume_name(file)) return true;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  const FormatInfo* const by_name = format_of_name(file, kPoints);
  return by_name && by_name->id == FormatId::table && holds_plot3d(file);
}

bool has_vtk_readers(std::string* why_not) {
  std::string cause;
  const bool there = io::load_vtk_module(cause) != nullptr;
  if (why_not) *why_not = cause;
  return there;
}

}  // namespace sansmesh::inline v1
