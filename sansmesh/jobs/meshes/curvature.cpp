#include "sansmesh/points.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/image.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/pictures.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/surface/curvature.h"
#include "sansmesh/surface/vertex_curvature.h"

namespace sansmesh::inline v1 {
namespace {

/// Input with the normals that were used, and the curvatures at each sample or vertex.
struct CurvedInput {
  PointSet points;
  std::vector<FittedCurvatures> curvatures;
  double noise = 0;

  bool is_mesh() const { return !points.triangles.empty(); }
};

/// Curvatures of a mesh are at all its vertices in order, however few they are.
CurvedInput curvatures_of(PointSet given, CurvatureOptions options, Progress& progress, std::vector<Note>& notes) {
  const bool is_mesh = !given.triangles.empty();
  const char* const kRow = "row of the file";
  CloudPreparation use;
  PointSet mesh;
  if (is_mesh) {
    use.faces = FaceUse::vertices;
    mesh = given;
    std::vector<std::uint32_t> rows(given.size());
    std::iota(rows.begin(), rows.end(), 0u);
    given.attributes.set(kRow, std::move(rows));
  }
  PreparedCloud cloud = prepare_cloud(std::move(given), use, progress);
  add_notes(notes, std::move(cloud.notes));
  if (options.noise)
    options.noise = cloud.frame.from_input(*options.noise);
  else  // measured unless normals are given
    options.noise = is_mesh ? known_noise(cloud.points) : *cloud.noise;
  if (options.bandwidth) options.bandwidth = cloud.frame.from_input(*options.bandwidth);
  progress.begin("curvature");
  CurvedInput made;
  made.noise = cloud.frame.to_input(*options.noise);
  made.curvatures = is_mesh ? estimate_vertex_curvatures(cloud.points, options, progress)
                            : estimate_curvatures(cloud.points, options, progress);
  const auto unit = static_cast<float>(cloud.frame.unit);
  for (FittedCurvatures& c : made.curvatures) c.k1 /= unit, c.k2 /= unit, c.offset *= unit;
  if (!is_mesh) {
    made.points = std::move(cloud.points);
    move_to_input(made.points, cloud.frame);
    return made;
  }
  const std::vector<FittedCurvatures> found = std::exchange(made.curvatures, {});
  made.curvatures.resize(mesh.size());
  mesh.normals.resize(mesh.size());
  const std::vector<std::uint32_t>& rows = *cloud.points.attributes.find<std::uint32_t>(kRow);
  for (std::size_t i = 0; i < found.size(); ++i) {
    made.curvatures[rows[i]] = found[i];
    mesh.normals[rows[i]] = cloud.points.normals[i];
  }
  made.points = std::move(mesh);
  return made;
}

void add_curvature_attributes(CurvedInput& to) {
  const auto add = [&](const char* name, auto value) {
    std::vector<float> values(to.curvatures.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(to.curvatures[i]);
    to.points.attributes.set(name, std::move(values));
  };
  add("k1", [](const PrincipalCurvatures& c) { return c.k1; });
  add("k2", [](const PrincipalCurvatures& c) { return c.k2; });
  add("mean_curvature", mean_curvature);
  add("gaussian_curvature", gaussian_curvature);
  add("curvedness", curvedness);
  add("shape_index", shape_index);
  const char* const axis = "xyz";
  for (std::size_t k = 0; k < 3; ++k)
    add(fmt::format("d1{}", axis[k]).c_str(), [k](const PrincipalCurvatures& c) { return c.direction1[k]; });
  for (std::size_t k = 0; k < 3; ++k)
    add(fmt::format("d2{}", axis[k]).c_str(), [k](const PrincipalCurvatures& c) { return c.direction2[k]; });
}

/// Colours the samples by the shown quantity and computes its statistics.
void show_curvature(CurvedInput& made, const CurvatureMapOptions& options, CurvatureReport& r) {
  std::vector<float> values, sizes;
  for (const PrincipalCurvatures& c : made.curvatures) {
    r.undefined += !c.defined;
    if (!c.defined) continue;
    values.push_back(curvature_quantity(c, options.color_by));
    sizes.push_back(std::abs(values.back()));
  }
  r.q05 = static_cast<double>(quantile(values, 0.05)), r.median = static_cast<double>(quantile(values, 0.5));
  r.q95 = static_cast<double>(quantile(values, 0.95));
  r.color_range = options.color_range.value_or(static_cast<double>(quantile(sizes, 0.95)));
  r.beyond_range =
      std::any_of(sizes.begin(), sizes.end(), [&](float s) { return static_cast<double>(s) > r.color_range; });
  const auto scale = static_cast<float>(r.color_range);
  made.points.colors.resize(made.points.size());
  for (std::size_t i = 0; i < made.points.size(); ++i) {
    Vec3f color{0.5f, 0.5f, 0.5f};
    if (made.curvatures[i].defined)
      color = diverging_color(scale > 0 ? curvature_quantity(made.curvatures[i], options.color_by) / scale : 0);
    made.points.colors[i] = to_bytes(color);
  }
}

}  // namespace

const OptionSchema& CurvatureMapOptions::schema() {
  using O = CurvatureMapOptions;
  static const OptionRow rows[] = {
      option<&O::color_by>({.text = "Quantity shown by colours", .unit = "quantity", .choices = kCurvatureWords}),
      option<&O::color_range>({.text = "Curvature with the full colour, 1/length or, for gaussian, 1/length²",
                               .unit = "value",
                               .from_data = "from data",
                               .range = positive()}),
      option_group<&O::estimation>(CurvatureOptions::schema().rows), option<&O::bar>({.text = "Omit the colour bar"}),
      option<&O::unit>({.text = "Unit of lengths at the colour bar", .unit = "unit"})};
  return option_schema<rows>();
}

void CurvatureMapOptions::validate() const {
  validate_options(*this);
  estimation.validate();
}

CurvatureResult curvature(PointSet points, const CurvatureMapOptions& options, Progress& progress) {
  options.validate();
  CurvatureResult result;
  CurvatureReport& r = result.report;
  CurvedInput made = curvatures_of(std::move(points), options.estimation, progress, result.notes);
  r.color_by = options.color_by;
  r.mesh = made.is_mesh();
  r.noise = made.noise;
  add_curvature_attributes(made);
  show_curvature(made, options, r);
  result.points = std::move(made.points);
  return result;
}

MapPicture draw_curvature(const CurvatureResult& made, const CurvatureMapOptions& options, const RenderOptions& picture,
                          Progress& progress) {
  const CurvatureReport& r = made.report;
  std::optional<ColorBar> bar;
  if (options.bar) bar = curvature_bar(r.color_by, r.color_range, options.unit, r.beyond_range);
  MapPicture drawn{.image = {}, .made_with = picture};
  reserve_width(drawn.made_with, bar);
  drawn.image = beside_bar(render_mesh(to_mesh(made.points), drawn.made_with, progress), bar, drawn.made_with);
  return drawn;
}

std::vector<std::string> summary_of(const CurvatureResult& made) {
  const CurvatureReport& r = made.report;
  const auto words = [&](std::size_t count) { return counted(count, r.mesh ? "vertex" : "sample"); };
  std::vector<std::string> lines{
      fmt::format("{}, noise {}", words(made.points.size()), length_words(r.noise)),
      fmt::format("{} curvature: 5 % below {}, half below {}, 95 % below {} ({})", quantity_word(r.color_by),
                  length_words(r.q05), length_words(r.median), length_words(r.q95),
                  r.color_by == CurvatureQuantity::gaussian ? "1/length²" : "1/length, positive where convex")};
  if (r.undefined > 0) lines.push_back(words(r.undefined) + " without enough neighbours: zero");
  return lines;
}

const ReportSchema& CurvatureReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&CurvatureReport::noise>({.text = "Noise of the samples", .unit = "length"}),
      reported<&CurvatureReport::undefined>({.text = "Samples with too few neighbours, set to zero"}),
      reported<&CurvatureReport::color_by>({.text = "Quantity shown by colours", .choices = kCurvatureWords}),
      reported<&CurvatureReport::q05>(
          {.name = "quantiles.q05", .text = "5 % of its values are below", .unit = "1/length, of gaussian 1/length²"}),
      reported<&CurvatureReport::median>({.name = "quantiles.median",
                                          .text = "Half of its values are below",
                                          .unit = "1/length, of gaussian 1/length²"}),
      reported<&CurvatureReport::q95>(
          {.name = "quantiles.q95", .text = "95 % of its values are below", .unit = "1/length, of gaussian 1/length²"}),
      reported<&CurvatureReport::color_range>(
          {.text = "Value with the full colour", .unit = "1/length, of gaussian 1/length²"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
