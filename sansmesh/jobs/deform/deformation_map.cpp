// Displacement map of a deformation.
#include <fmt/core.h>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/deform.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/error.h"
#include "sansmesh/field/map_stretch.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/write_volume.h"
#include "sansmesh/jobs/deform/deform_parts.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/measure/section_text.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMapMargin = 0.1;  // share of the diagonal
constexpr int kDefaultMapNodes = 64;

}  // namespace

const OptionSchema& DeformationMapOptions::schema() {
  using O = DeformationMapOptions;
  static constexpr OptionRow rows[] = {
      option<&O::nodes>(
          {.text = "Write the displacement map (-o MAP.vti), with this number of nodes along the longest side",
           .range = {2, 1024},
           .name = "displacement_map"}),
      option<&O::box>({.text = "Box of the map", .from_data = "that of the deformed object"})};
  return option_schema<rows>();
}

DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before, const std::string& name,
                                     const DeformationMapOptions& options, Progress& progress) {
  validate_options(options);
  if (!is_finite(before.lower) || !is_finite(before.upper) || before.empty())
    throw ArgumentError("`displacement_map` needs a bounded input");
  const DeformationMaps maps = deformation.at(1);
  const Box3 box = options.box ? *options.box : with_name(name, [&] {
    return with_margin(preimage_box(*maps.backward, before, deformation.box_of(maps, before)), kMapMargin);
  });
  const DisplacementMap map = displacement_map(
      *maps.backward, box, lattice_sizes(box, static_cast<std::size_t>(options.nodes.value_or(kDefaultMapNodes))),
      progress);
  FoldWatch folds;
  folds.look(*maps.backward, box, progress);
  DeformationMapResult result{displacement_block(map), {}, {}};
  result.report.folds = folds.worst();
  for (std::size_t a = 0; a < 3; ++a) result.report.size[a] = result.block.axes[a].size();
  folds.add_note(name, result.notes);
  return result;
}

void write_pose(const std::string& file, const DeformedPose& pose, bool ascii, const std::string& unit) {
  struct Write {
    const std::string& file;
    bool ascii;
    const std::string& unit;

    void operator()(const PointSet& points) const { write_points(file, points, {ascii}); }
    void operator()(const TriangleMesh& mesh) const { write_mesh(file, mesh, {ascii}); }
    void operator()(const std::vector<Section>& sections) const {
      write_text(file, file.ends_with(".svg") ? section_svg(sections, {.unit = unit}) : section_csv(sections));
    }
    void operator()(const GridBlock& block) const { write_volume(file, block); }
    void operator()(const DeformedPicture& picture) const { write_image(file, picture.image); }
  };
  std::visit(Write{file, ascii, unit}, pose);
}

namespace {

std::string size_line(const DeformReport& r) {
  if (r.inside) return lattice_words(r.size, *r.inside);
  return fmt::format("{} × {} × {} displacements", r.size[0], r.size[1], r.size[2]);
}

std::string count_line(const DeformReport& r) {
  const std::string triangles = counted(r.triangles, "triangle");
  if (r.mesh_of_open) return triangles + ", its surface bounds no solid: its mesh was deformed";
  if (r.solid)
    return fmt::format("{}, {} vertices in {}{}", triangles, grouped(r.vertices),
                       counted(r.solid->components, "component"), r.solid->closed ? ", closed" : ", not closed");
  if (r.triangles == 0) return counted(r.vertices, "point");
  return fmt::format("{}, {}{}", triangles, counted(r.vertices, "vertex"),
                     r.added > 0 ? fmt::format(" ({} added)", grouped(r.added)) : "");
}

}  // namespace

std::vector<std::string> summary_of(const DeformReport& r) {
  std::vector<std::string> lines;
  lines.reserve(r.sections.size() + 2);
  for (const Section& section : r.sections) lines.push_back(section_words(section));
  if (r.vertices > 0) lines.push_back(count_line(r));
  if (r.solid) lines.push_back(area_words(r.solid->area, r.solid->volume));
  if (r.cut && r.cut->edges == 0) lines.emplace_back("no cut intersects it");
  if (r.cut && r.cut->edges > 0)
    lines.push_back(fmt::format("opened along {}, {} on cut faces", counted(r.cut->edges, "edge"),
                                counted(r.cut->faces, "triangle")));
  if (r.size[0] > 0) lines.push_back(size_line(r));
  return lines;
}

const ReportSchema& DeformableVolume::schema() {
  static constexpr ReportRow rows[] = {reported<&DeformableVolume::arrays>({.text = "Arrays"})};
  return report_schema<rows>();
}

const ReportSchema& DeformReport::schema() {
  static constexpr ReportRow rows[] = {
      reported_inline<&DeformReport::folds>(),
      reported<[](const DeformReport& r) { return value_if(r.vertices > 0, r.vertices); }>(
          {.name = "vertices", .text = "Vertices or points"}),
      reported<[](const DeformReport& r) { return value_if(r.vertices > 0, r.triangles); }>(
          {.name = "triangles", .text = "Triangles"}),
      reported<[](const DeformReport& r) { return value_if(!r.solid && r.vertices > 0, r.added); }>(
          {.name = "added", .text = "Triangles added at edges that bend"}),
      reported<[](const DeformReport& r) { return value_if(!r.solid && r.vertices > 0, r.turned); }>(
          {.name = "turned", .text = "Vertices where the map reverses orientation"}),
      reported<[](const DeformReport& r) { return value_if(!r.solid && r.vertices > 0, r.undefined); }>(
          {.name = "undefined", .text = "Vertices that do not move, since the map is not defined there"}),
      reported<&DeformReport::cut>({.text = "Opening of a mesh along cuts"}),
      reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->components) : std::nullopt; }>(
          {.name = "components", .text = "Connected components of a solid"}),
      reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->closed) : std::nullopt; }>(
          {.name = "closed", .text = "Whether the mesh of a solid is closed"}),
      reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->cell) : std::nullopt; }>(
          {.name = "cell", .text = "Edge of the smallest blocks of a solid", .unit = "length"}),
      reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->area) : std::nullopt; }>(
          {.name = "area", .text = "Area of a solid", .unit = "length²"}),
      reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->volume) : std::nullopt; }>(
          {.name = "volume", .text = "Volume of a solid", .unit = "length³"}),
      reported<&DeformReport::sections>({.text = "Sections"}),
      reported<[](const DeformReport& r) { return value_if(r.size[0] > 0, r.size); }>(
          {.name = "size", .text = "Lattice points of a volume along the axes"}),
      reported<&DeformReport::inside>({.text = "Share of these inside the volume", .unit = "share"}),
      reported<[](const DeformReport& r) { return value_if(r.rays > 0, r.rays); }>(
          {.name = "rays", .text = "Rays of pictures of volumes"}),
      reported<[](const DeformReport& r) { return value_if(r.rays > 0, r.evaluations); }>(
          {.name = "evaluations", .text = "Evaluations along these rays"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
