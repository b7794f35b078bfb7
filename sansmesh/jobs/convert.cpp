#include "sansmesh/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Does a step; what is to be said comes back.
struct DoStep {
  CloudOrMesh& data;

  std::string about(const AffineMap& map, const std::optional<Vec3>& place, bool center) const {
    if (center) return move_all(data, map.about(data.bounds().center()));
    return move_all(data, place ? map.about(*place) : map);
  }

  std::string operator()(const TransformStep& s) const { return move_all(data, s.inverse ? s.map.inverse() : s.map); }
  std::string operator()(const TranslateStep& s) const { return move_all(data, AffineMap::translation(s.by)); }
  std::string operator()(const CenterStep&) const {
    return move_all(data, AffineMap::translation(-data.bounds().center()));
  }
  std::string operator()(const RotateStep& s) const {
    return about(AffineMap::rotation(s.axis, s.degrees), s.about, s.about_center);
  }
  std::string operator()(const ScaleStep& s) const {
    return about(AffineMap::scaling(s.factors), s.about, s.about_center);
  }
  std::string operator()(const AxesStep& s) const { return move_all(data, axes_map(s.axes)); }
  std::string operator()(const UpStep& s) const {
    return move_all(data, axes_map(s.to == StepUp::z ? "x,-z,y" : "x,z,-y"));
  }
  std::string operator()(const UnitStep& s) const {
    const double factor = meters_of_unit(s.from) / meters_of_unit(s.to);
    return move_all(data, AffineMap::scaling({factor, factor, factor}));
  }
  std::string operator()(const CropStep& s) const { return crop_to_box(data, s.box, s.inside); }
  std::string operator()(const SpacingStep& s) const { return keep_apart(data, s.distance); }
  std::string operator()(const CountStep& s) const { return keep_count(data, s.count); }
  std::string operator()(const EveryStep& s) const { return keep_every(data, s.every); }
  std::string operator()(const ChooseStep& s) const { return choose_attributes(data, s.names, s.keep); }
  std::string operator()(const WeldStep& s) const { return weld_places(data, s.distance); }
  std::string operator()(const FlipStep& s) const { return flip_sides(data, s.faces, s.normals); }
};

/// "`box` leaves nothing …".
std::string in_accents(std::string_view name) { return "`" + std::string(name) + "`"; }

ConvertedBy do_step(CloudOrMesh& data, const ConvertStep& step) {
  ConvertedBy done{.step = step_name(step), .remark = {}, .triangles = {}};
  const Box3 box = data.bounds();
  const std::string before = data.size_words();
  try {
    done.remark = std::visit(DoStep{data}, step);
  } catch (const DataError& error) {
    const std::string cause = error.what();
    const bool sentence = cause.starts_with("a ") || cause.starts_with("there ");
    throw DataError(in_accents(done.step) + (sentence ? ": " : " ") + cause);
  }
  if (data.size() == 0 || (data.is_mesh && data.mesh.triangles.empty()))
    throw DataError(fmt::format(
        "{} leaves nothing of {} between ({:.10g}, {:.10g}, {:.10g}) and ({:.10g}, {:.10g}, {:.10g})",
        in_accents(done.step), before, box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z));
  done.size = data.size();
  if (data.is_mesh) done.triangles = data.mesh.triangles.size();
  return done;
}

}  // namespace

const OptionSchema& ConvertOptions::schema() {
  using O = ConvertOptions;
  static constexpr OptionRow rows[] = {
      option<&O::vertices_only>({.text = "Of a mesh the vertices alone", .old_name = "points"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void ConvertOptions::validate() const {
  for (const ConvertStep& step : steps) validate_step(step);
}

ConvertResult convert(PointSet read, const ConvertOptions& options, Progress& progress) {
  options.validate();
  ConvertResult result{CloudOrMesh(std::move(read)), {}, {}};
  CloudOrMesh& data = result.data;
  result.report.size_words = data.size_words();
  result.report.size = data.size(), result.report.triangles = data.mesh.triangles.size();
  if (options.vertices_only) data.make_points();
  for (const ConvertStep& step : options.steps) {
    progress.begin(std::string(step_name(step)));
    result.report.steps.push_back(do_step(data, step));
  }
  if (data.nonmanifold_edges_of_weld > 0)
    result.notes.push_back(
        {.code = "nonmanifold_weld",
         .text = fmt::format("`weld` has made {} of three triangles or more: the mesh is not manifold there",
                             counted(data.nonmanifold_edges_of_weld, "edge")),
         .remedy = {}});
  if (!data.unturned.empty())
    result.notes.push_back({.code = "unturned",
                            .text = fmt::format("attributes of three numbers are not turned: {}",
                                                printable(fmt::format("{}", fmt::join(data.unturned, ", ")))),
                            .remedy = {}});
  return result;
}

}  // namespace sansmesh::inline v1
