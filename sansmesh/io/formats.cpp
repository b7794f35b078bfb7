#include "sansmesh/io/formats.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/volume_readers.h"

namespace sansmesh::inline v1 {
namespace {

constexpr unsigned kCloudOrMesh = kPoints | kMesh;
/// Points with attributes are scattered samples of a volume as well.
constexpr unsigned kSamples = kCloudOrMesh | kVolume;
constexpr std::string_view kConvertMesh = "reading this format is not supported; convert it to PLY or OBJ first";
constexpr std::string_view kUnpackOrConvert =
    "this kind of file is not supported; convert or unpack it first (gzip is unpacked on the fly)";

constexpr FormatInfo kFormats[] = {
    {.id = FormatId::ply,
     .name = "PLY",
     .endings = "ply",
     .reads = kSamples,
     .written = {{{"ply", kCloudOrMesh | kLines}}},
     .read_points = io::read_ply,
     .write_mesh = io::mesh_to_ply,
     .write_points = io::points_to_ply,
     .write_lines = io::lines_to_ply},
    {.id = FormatId::obj,
     .name = "OBJ",
     .endings = "obj",
     .reads = kSamples,
     .written = {{{"obj", kCloudOrMesh}}},
     .read_points = io::read_obj,
     .write_mesh = io::mesh_to_obj,
     .write_points = io::points_to_obj,
     .mesh_room = FormatRoom::colors,
     .points_room = FormatRoom::colors},
    {.id = FormatId::off,
     .name = "OFF",
     .endings = "off coff noff cnoff",
     .reads = kSamples,
     .written = {{{"off", kMesh}}},
     .read_points = io::read_off,
     .write_mesh = io::mesh_to_off,
     .mesh_room = FormatRoom::colors},
    {.id = FormatId::stl,
     .name = "STL",
     .endings = "stl",
     .reads = kSamples,
     .written = {{{"stl", kMesh}}},
     .read_points = io::read_stl,
     .write_mesh = io::mesh_to_stl,
     .mesh_room = FormatRoom::positions},
    {.id = FormatId::glb,
     .name = "glTF",
     .endings = "glb gltf",
     .written = {{{"glb", kMesh}}},
     .remedy = kConvertMesh,
     .write_mesh = io::mesh_to_glb,
     .mesh_room = FormatRoom::colors_and_few_floats},
    {.id = FormatId::vtp,
     .name = "VTK XML polydata",
     .endings = "vtp",
     .reads = kSamples | kLines,
     .written = {{{"vtp", kCloudOrMesh | kLines}}},
     .read_points = io::read_vtp,
     .write_mesh = io::mesh_to_vtp,
     .write_points = io::points_to_vtp,
     .write_lines = io::lines_to_vtp},
    {.id = FormatId::pcd,
     .name = "PCD",
     .endings = "pcd",
     .reads = kSamples,
     .written = {{{"pcd", kPoints}}},
     .read_points = io::read_pcd,
     .write_points = io::points_to_pcd},
    {.id = FormatId::las,
     .name = "LAS",
     .endings = "las",
     .reads = kSamples,
     .written = {{{"las", kPoints}}},
     .read_points = io::read_las,
     .write_points = io::points_to_las,
     .points_room = FormatRoom::all_but_normals},
    {.id = FormatId::csv,
     .name = "CSV",
     .endings = "csv tsv",
     .reads = kSamples,
     .written = {{{"csv", kPoints | kLines}}},
     .read_points = io::read_table,
     .write_points = io::points_to_csv,
     .write_lines = io::lines_to_csv},
    {.id = FormatId::table,
     .name = "XYZ",
     .endings = "xyz txt asc pts pwn xyzn npts xyzrgb dat",
     .reads = kSamples,
     .written = {{{"xyz", kPoints}}},
     .read_points = io::read_table,
     .write_points = io::points_to_xyz,
     .points_room = FormatRoom::colors},
    {.id = FormatId::conf,
     .name = "Stanford alignment",
     .endings = "conf",
     .reads = kSamples,
     .read_points = io::read_conf},
    {FormatId::metaimage, "MetaImage", "mhd mha", kVolume, {{{"mhd", kVolume}, {"mha", kVolume}}}},
    {FormatId::nrrd, "NRRD", "nrrd nhdr", kVolume, {{{"nrrd", kVolume}}}},
    {FormatId::raw, "raw numbers", "raw", kVolume},
    {FormatId::plot3d, "PLOT3D", "bin x p3d grd fmt q", kVolume},
    {FormatId::vtk_xml,
     "VTK XML",
     "vti vtr vts vtu vtm vtmb vthb vth pvti pvtr pvts pvtu vtpc vtpd",
     kVolume,
     {{{"vti", kVolume}, {"vtu", kTetrahedra}}},
     "vtk"},
    {FormatId::vtk_legacy,
     "VTK legacy",
     "vtk",
     kVolume,
     {},
     "vtk",
     "this kind of VTK file is read as a volume only; convert it to VTP or PLY for points or a mesh"},
    {FormatId::exodus, "Exodus", "ex2 exo exii e g", kVolume, {}, "vtk"},
    {FormatId::ensight, "EnSight", "case encas", kVolume, {}, "vtk"},
    {FormatId::cgns, "CGNS", "cgns", kVolume, {}, "vtk"},
    {FormatId::openfoam, "OpenFOAM", "foam", kVolume, {}, "vtk"},
    {FormatId::pvd, "ParaView collection", "pvd", kVolume},
    {FormatId::series, "series of files", "series", kVolume},
    {FormatId::dicom, "DICOM", "dcm dicom", kVolume, {}, "vtk"},
    {FormatId::nek_field, "Nek5000", "", kVolume},
    {FormatId::nek_series, "Nek5000 series", "nek5000 nek3d nek2d", kVolume},
    {FormatId::gmsh, "Gmsh", "msh", kVolume | kTetrahedra},
    {FormatId::medit, "Medit", "mesh meshb", kVolume | kTetrahedra},
    {FormatId::tetgen, "TetGen", "node ele", kVolume | kTetrahedra},
    {FormatId::vega, "Vega", "veg", kVolume | kTetrahedra},
    {FormatId::function,
     "function",
     "smf",
     kFunction,
     {{{"smf", kFunction}}},
     {},
     "is a function, not points or a mesh: a mesh can be made of it"},
    {FormatId::fitted_volume, "fitted volume", "smv", kVolume, {{{"smv", kVolume}}}},
    {FormatId::png, "PNG", "png", 0, {{{"png", kPicture}}}, {}, "is a picture"},
    {FormatId::laz, "LAZ", "laz", 0, {}, {}, "LAZ (compressed LAS) is not supported; decompress it to LAS first"},
    {FormatId::e57, "E57", "e57", 0, {}, {}, "E57 is not supported; convert it to PLY, LAS or XYZ first"},
    {FormatId::scene, "scene", "fbx dae 3ds 3mf usd usdz", 0, {}, {}, kConvertMesh},
    {FormatId::archive, "archive", "pcap rcp rcs ptx zip 7z xz bz2 zst rar", 0, {}, {}, kUnpackOrConvert},
};

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

bool has_ending(const FormatInfo& format, std::string_view ending) {
  const auto endings = words_of(format.endings);
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

void add_ending(std::string_view ending, std::vector<std::string>& list) {
  std::string with_dot = "." + std::string(ending);
  if (std::find(list.begin(), list.end(), with_dot) == list.end()) list.push_back(std::move(with_dot));
}

/// The same among the library's own formats.
std::optional<FormatId> own_format_of_content(std::string_view bytes) {
  const auto begins = [&](std::string_view s) { return bytes.starts_with(s); };
  if (begins("ply\n") || begins("ply\r")) return FormatId::ply;
  if (begins("LASF")) return FormatId::las;
  if (begins("ASTM-E57")) return FormatId::e57;
  if (begins("glTF")) return FormatId::glb;
  if (begins("# .PCD") || begins("VERSION 0.7\n") || begins("VERSION .7\n")) return FormatId::pcd;
  if (begins("OFF\n") || begins("OFF\r") || begins("OFF ") || begins("COFF") || begins("NOFF")) return FormatId::off;
  if (bytes.substr(0, 4096).find("<VTKFile") != std::string_view::npos) return FormatId::vtk_xml;
  if (begins("# vtk DataFile")) return FormatId::vtk_legacy;
  if (begins("NRRD000")) return FormatId::nrrd;
  if (begins("ObjectType") || begins("NDims")) return FormatId::metaimage;
  if (bytes.size() > 132 && bytes.substr(128, 4) == "DICM") return FormatId::dicom;
  if (begins("\x89HDF\r\n\x1a\n") || begins("CDF\x01") || begins("CDF\x02") || begins("CDF\x05"))
    return FormatId::exodus;
  if (begins("#std ")) return FormatId::nek_field;
  if (begins("$MeshFormat")) return FormatId::gmsh;
  if (bytes.substr(0, 64).find("ADF Database") != std::string_view::npos) return FormatId::cgns;
  return std::nullopt;
}

}  // namespace

Registry<FormatInfo>& FormatInfo::registry() {
  static Registry<FormatInfo> all("format", {kFormats});
  return all;
}

std::vector<const FormatInfo*> formats() { return FormatInfo::registry().all(); }

namespace {

const FormatInfo* own_format(FormatId id) { return formats()[static_cast<std::size_t>(id)]; }

}  // namespace

const FormatInfo* format_of_name(const std::string& file, unsigned content) {
  const std::string ending = io::ending(file);
  if (ending.empty()) return nullptr;
  for (const FormatInfo* const f : formats())
    if (has_ending(*f, ending) && (content == 0 || (f->reads & content) != 0)) return f;
  if ((content == 0 || (content & kVolume) != 0) && io::is_nek_field_name(ending))
    return own_format(FormatId::nek_field);
  return nullptr;
}

const FormatInfo* format_of_content(std::string_view bytes) {
  if (const auto own = own_format_of_content(bytes)) return own_format(*own);
  for (const FormatInfo* const f : formats())
    if (f->recognizes && f->recognizes(bytes)) return f;
  return nullptr;
}

std::vector<std::string> endings_read(unsigned content) {
  std::vector<std::string> list;
  for (const FormatInfo* const f : formats())
    if ((f->reads & content) != 0)
      for (const std::string_view ending : words_of(f->endings)) add_ending(ending, list);
  return list;
}

std::vector<std::string> endings_written(unsigned content) {
  std::vector<std::string> list;
  for (const FormatInfo* const f : formats())
    for (const WrittenAs& as : f->written)
      if ((as.content & content) != 0) add_ending(as.ending, list);
  return list;
}

std::string listed_endings(const std::vector<std::string>& endings) {
  std::string text;
  for (const std::string& ending : endings) text += (text.empty() ? "" : " ") + ending;
  return text;
}

}  // namespace sansmesh::inline v1
