// A deformation as a map of displacements.
#include <utility>

#include "sansmesh/deform.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/error.h"
#include "sansmesh/field/map_stretch.h"
#include "sansmesh/io.h"
#include "sansmesh/io/write_volume.h"
#include "sansmesh/jobs/deform_parts.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/measure/section_text.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMapMargin = 0.1;  // of the diagonal
constexpr int kUsualMapNodes = 64;

}  // namespace

const OptionSchema& DeformationMapOptions::schema() {
  using O = DeformationMapOptions;
  static constexpr OptionRow rows[] = {
      option<&O::nodes>({.text = "Writes the map instead (-o MAP.vti), with so many nodes along the longest side",
                         .range = {2, 1024},
                         .name = "displacement_map"}),
      option<&O::box>({.text = "What it covers", .from_data = "where what is deformed comes to lie"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before, const std::string& name,
                                     const DeformationMapOptions& options, Progress& progress) {
  validate_options(options);
  if (!is_finite(before.lower) || !is_finite(before.upper) || before.empty())
    throw ArgumentError("`displacement_map` needs an input that ends somewhere, for its box");
  const DeformationMaps maps = deformation.at(1);
  const Box3 box = options.box ? *options.box : with_name(name, [&] {
    return with_room(box_before(*maps.backward, before, deformation.box_of(maps, before)), kMapMargin);
  });
  const DisplacementMap map =
      displacement_map(*maps.backward, box,
                       lattice_sizes(box, static_cast<std::size_t>(options.nodes.value_or(kUsualMapNodes))), progress);
  FoldWatch folds;
  folds.look(*maps.backward, box, progress);
  DeformationMapResult result{displacement_block(map), folds.worst(), {}};
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

Box3 bounds_of(const PointSet& points) {
  Box3 box;
  for (const Vec3f& p : points.positions)
    if (is_finite(p)) box.extend(points.origin + Vec3(p));
  return box;
}

namespace {

constexpr ReportRow kDeformReportRows[] = {
    reported_beside<&DeformReport::folds>(),
    reported<[](const DeformReport& r) { return told_if(r.vertices > 0, r.vertices); }>(
        {.name = "vertices", .text = "Vertices or points"}),
    reported<[](const DeformReport& r) { return told_if(r.vertices > 0, r.triangles); }>(
        {.name = "triangles", .text = "Triangles"}),
    reported<[](const DeformReport& r) { return told_if(!r.solid && r.vertices > 0, r.added); }>(
        {.name = "added", .text = "Triangles that were added where edges bend"}),
    reported<[](const DeformReport& r) { return told_if(!r.solid && r.vertices > 0, r.turned); }>(
        {.name = "turned", .text = "Vertices at which space is turned inside out"}),
    reported<[](const DeformReport& r) { return told_if(!r.solid && r.vertices > 0, r.undefined); }>(
        {.name = "undefined", .text = "Vertices that stay, since the map is not defined there"}),
    reported<&DeformReport::cut>({.text = "How a mesh was opened along cuts"}),
    reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->components) : std::nullopt; }>(
        {.name = "components", .text = "Connected parts, of solids"}),
    reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->closed) : std::nullopt; }>(
        {.name = "closed", .text = "Whether the mesh is closed, of solids"}),
    reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->cell) : std::nullopt; }>(
        {.name = "cell", .text = "Edge of the smallest blocks, of solids", .unit = "length"}),
    reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->area) : std::nullopt; }>(
        {.name = "area", .text = "Area, of solids", .unit = "length²"}),
    reported<[](const DeformReport& r) { return r.solid ? std::optional(r.solid->volume) : std::nullopt; }>(
        {.name = "volume", .text = "Volume, of solids", .unit = "length³"}),
    reported<&DeformReport::sections>({.text = "Sections"}),
    reported<[](const DeformReport& r) { return told_if(r.size[0] > 0, r.size); }>(
        {.name = "size", .text = "Points of the lattice along its axes, of volumes"}),
    reported<&DeformReport::inside>({.text = "Share of these in the volume", .unit = "share"}),
    reported<[](const DeformReport& r) { return told_if(r.rays > 0, r.rays); }>(
        {.name = "rays", .text = "Rays, of pictures of volumes"}),
    reported<[](const DeformReport& r) { return told_if(r.rays > 0, r.evaluations); }>(
        {.name = "evaluations", .text = "Evaluations for these"})};

}  // namespace

const ReportSchema& DeformableVolume::schema() {
  static constexpr ReportRow rows[] = {reported<&DeformableVolume::arrays>({.text = "Arrays"})};
  static constexpr ReportSchema schema{rows};
  return schema;
}

const ReportSchema& DeformReport::schema() {
  static constexpr ReportSchema schema{kDeformReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
