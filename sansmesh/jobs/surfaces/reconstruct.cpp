#include "sansmesh/reconstruct.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/option.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/points.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/surfaces/fit_words.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/model/surface_domain.h"
#include "sansmesh/points/orientation/orient_words.h"
#include "sansmesh/points/remedies.h"

namespace sansmesh::inline v1 {
namespace {

using namespace detail;

/// Mesh error of surfaces without an error estimate, as factors of spacing and noise.
constexpr double kErrorOverSpacing = 0.037, kErrorOverNoise = 0.1;

PreparedCloud prepare(PointSet points, const CloudPreparation& use, Progress& progress, ReconstructReport& r) {
  PreparedCloud cloud = prepare_cloud(std::move(points), use, progress, ClutterUse::leave_out);
  r.estimated_normals = cloud.estimated_normals;
  r.oriented_by = cloud.oriented_by;
  r.alignment = cloud.alignment;
  return cloud;
}

/// Options of the surface, with the options of the fit that it uses.
SurfaceOptions surface_options(const ReconstructOptions& options) {
  SurfaceOptions o = options.surface;
  const SurfaceMethod& method = surface_method(o.method);
  if (options.fit.error && method.uses_option("error")) o.error = options.fit.error;
  if (options.fit.depth && method.uses_option("depth")) o.depth = options.fit.depth;
  if (!options.fit.sharp && method.uses_option("smooth")) o.smooth = true;
  return o;
}

/// Reconstructs a surface other than the partition of unity: meshes it in blocks refined by curvature down to the
/// sample spacing, and cuts it off where the samples end.
void reconstruct_surface(PointSet points, const ReconstructOptions& options, Progress& progress,
                         ReconstructResult& result) {
  ReconstructReport& r = result.report;
  const SurfaceOptions choice = surface_options(options);
  const MeshOptions& asked = options.mesh;
  const SurfaceModel model =
      make_surface_model(prepare(std::move(points), options.cloud, progress, r), choice, progress);
  const SurfaceTraits traits = model.traits();
  add_notes(result.notes, model.notes());
  r.spacing = model.report().spacing;
  r.noise = model.report().noise;
  const LocalFrame& frame = model.frame();
  const double spacing = frame.from_input(r.spacing);
  const double mesh_error = asked.mesh_error
                                ? frame.from_input(*asked.mesh_error)
                                : std::max(kErrorOverSpacing * spacing, frame.from_input(kErrorOverNoise * r.noise));
  r.mesh_error = frame.to_input(mesh_error);
  PolygonizeOptions meshing = meshing_options(asked, mesh_error, traits.creases);
  const ScalarField& field = model.field(progress);
  meshing.placement = model.placement(progress);
  meshing.seeds = model.seeds();
  PointSet feet = model.feet(progress);
  progress.begin("choose blocks");
  BlockTree blocks = model.blocks_for(feet, mesh_error);
  progress.begin("find borders");
  std::optional<double> fill, trim;
  if (asked.fill_holes) fill = std::min(frame.from_input(*asked.fill_holes), blocks.edge());
  if (asked.trim)
    trim = *asked.trim > 0 ? frame.from_input(*asked.trim) : std::max(4 * spacing, 6 * frame.from_input(r.noise));
  std::optional<bool> solid;
  if (options.fit.open) solid = !*options.fit.open;
  // Feet beyond the samples belong to filled holes.
  feet.positions.resize(std::min(feet.size(), model.points().size()));
  feet.normals.resize(feet.size());
  const SurfaceDomain domain(field, feet, spacing, fill, trim, solid, traits.closes_holes);
  domain.refine(blocks, asked.block_depth.value_or(BlockTree::kMaxLevel));
  if (trim || !domain.solid() || !traits.closes_holes) meshing.domain = &domain;
  r.open = domain.ends();
  r.block_depth = blocks.depth();
  TriangleMesh& mesh = result.mesh = cut_out(field, blocks, asked, meshing, progress, r);

  progress.begin("finish mesh");
  finish_mesh(mesh, model.points(), spacing, frame.from_input(r.noise), mesh_error, frame, asked, r);
  mark_confidence(mesh, model.points(), spacing, frame.from_input(r.noise), frame, asked, r);
  move_to_input(mesh, frame);
  add_notes(result.notes, r.notes);
  progress.finish();
}

/// Largest number of samples for which remedies are tried.
constexpr std::size_t kMostTried = 1000000;

/// Whether a surface of the samples with other options is near all but a few of them.
bool keeps_samples(const FittedFunction& function, const ReconstructOptions& options, Progress& progress) {
  PreparedCloud cloud;
  cloud.points = *function.samples;
  cloud.frame = function.frame;
  MeshReport r;
  try {
    if (options.cloud.remove_outliers.value_or(false)) {
      leave_out_outliers(cloud, true, ClutterUse::keep, progress);
      if (cloud.points.size() == function.samples->size()) return false;
    }
    mesh_function(fit_surface_function(std::move(cloud), options.fit, progress), options.mesh, progress, &r);
  } catch (const DataError&) {
    return false;
  }
  return !lost_samples(r);
}

/// Names the option that leaves out lost samples or gives them a surface, if a trial confirms it.
void find_remedy(const FittedFunction& function, const ReconstructOptions& options, Progress& progress,
                 MeshReport& report) {
  Note* const note = lost_samples(report);
  if (!note || !note->remedy.empty() || options.fit.is_paper() || function.samples->size() > kMostTried) return;
  const auto helps = [&](const Remedy& remedy, const ReconstructOptions& other) {
    if (!keeps_samples(function, other, progress)) return false;
    note->remedy = remedy.text;
    return true;
  };
  ReconstructOptions plain = options;
  plain.mesh.carry_colors = plain.mesh.measure_quality = false;
  plain.mesh.confidence = false;
  ReconstructOptions other = plain;
  if (!options.cloud.remove_outliers) {
    other.cloud.remove_outliers = true;
    if (helps(remedy("lost_samples", "remove_outliers"), other)) return;
    other = plain;
  }
  other.fit.open = true;
  if (!options.fit.open.value_or(false)) helps(remedy("lost_samples", "open"), other);
}

}  // namespace

const OptionSchema& ReconstructOptions::schema() {
  using O = ReconstructOptions;
  static const OptionRow rows[] = {
      option_group<&O::cloud>(CloudPreparation::schema().rows), option_group<&O::fit>(FitOptions::schema().rows),
      option_group<&O::mesh>(MeshOptions::schema().rows), option_group<&O::surface>(SurfaceOptions::schema().rows)};
  return option_schema<rows>();
}

void ReconstructOptions::validate() const {
  surface.validate();
  if (other_surface()) {
    const SurfaceMethod& method = surface_method(surface.method);
    const auto refuse = [&](std::string_view option) {
      throw ArgumentError(fmt::format("`{}` applies to the partition, not to the surface {}", option, method.name));
    };
    if (mesh.mesher == Mesher::walk) refuse("mesher = walk");
    for (const std::string_view option : options_set(fit)) {
      if (option == "open" || ((option == "error" || option == "depth") && method.uses_option(option))) continue;
      if (option == "sharp" && method.uses_option("smooth")) continue;
      refuse(option == "sharp" ? "sharp = false" : option == "fit" ? "fit = paper" : option);
    }
  }
  fit.validate();
  mesh.validate();
  const bool walks = mesh.mesher == Mesher::walk || (mesh.mesher == Mesher::automatic && fit.is_paper());
  if (walks) mesh.validate_walk();
  if (!walks && mesh.enhance && mesh.displacement > 0)
    throw ArgumentError("`displacement` needs `enhance = false`: enhancement reverses it");
}

ReconstructResult reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress) {
  options.validate();
  ReconstructResult result;
  ReconstructReport& r = result.report;
  if (options.other_surface()) {
    reconstruct_surface(std::move(points), options, progress, result);
    return result;
  }
  const FittedFunction function =
      fit_surface_function(prepare(std::move(points), options.cloud, progress, r), options.fit, progress);
  const PartitionReport& f = function.field.report();
  result.mesh = mesh_function(function, options.mesh, progress, &r);
  find_remedy(function, options, progress, r);
  r.spacing = function.frame.to_input(f.spacing);
  r.noise = function.frame.to_input(f.noise);
  r.fits = f.functions;
  r.fit_depth = f.depth;
  r.fits_of_degree = f.functions_of_degree;
  r.paper = function.paper;
  r.open_share = f.area > 0 ? f.open_area / f.area : 0;
  r.mean_winding_number = f.mean_winding_number;
  add_notes(result.notes, function.notes);
  add_notes(result.notes, r.notes);
  return result;
}

const ReportSchema& ReconstructReport::schema() {
  static constexpr ReportRow rows[] = {
      reported_base<MeshReport, ReconstructReport>(),
      reported<&ReconstructReport::noise>(
          {.name = "deviation", .text = "Standard deviation of the samples from the surface", .unit = "length"}),
      reported<&ReconstructReport::estimated_normals>(
          {.name = "normals.estimated", .text = "Whether normals were estimated"}),
      reported<&ReconstructReport::oriented_by>({.name = "normals.oriented_by",
                                                 .text = "Source of the signs of normals; null: the input",
                                                 .choices = kOrientByWords}),
      reported<[](const ReconstructReport& r) { return value_if(!r.alignment.empty(), r.alignment); }>(
          {.name = "alignment", .text = "Registration of scans, as text"}),
      reported<&ReconstructReport::fits>({.text = "Local fits"}),
      reported<&ReconstructReport::fit_depth>({.text = "Deepest level of their tree"}),
      reported<&ReconstructReport::fits_of_degree>({.text = "Local fits of degree 0 to 4"}),
      reported<&ReconstructReport::paper>({.text = "Construction of blocks, for fits by a published method"}),
      reported<&ReconstructReport::open_share>({.text = "Share of the surface that bounds no solid", .unit = "share"}),
      reported<&ReconstructReport::mean_winding_number>(
          {.name = "winding_number_behind", .text = "Mean winding number behind the samples"})};
  return report_schema<rows>();
}

namespace {

/// Whether the surface bounds a solid, and why.
std::string openness_words(const ReconstructReport& r, std::optional<bool> asked) {
  if (asked) return *asked ? "open, as requested: the surface ends where the samples end" : "closed, as requested";
  const std::string why = fmt::format("winding number {:.2f} behind the samples", r.mean_winding_number);
  if (r.open_share <= 0) return fmt::format("closed ({})", why);
  if (r.open_share > 0.995) return fmt::format("open ({}): the surface ends where the samples end", why);
  return fmt::format("{:.0f} % open ({}): there the surface ends where the samples end", 100 * r.open_share, why);
}

}  // namespace

std::vector<std::string> summary_of(const ReconstructReport& r, const ReconstructOptions& options) {
  const bool other = options.other_surface();
  std::vector<std::string> lines{fmt::format(
      "{}, meshed in {} down to depth {}",
      other ? options.surface.method : fmt::format("{} down to depth {}", counted(r.fits, "local fit"), r.fit_depth),
      counted(r.blocks, "block"), r.block_depth)};
  if (r.paper)
    for (std::string& line : paper_words(*r.paper, r.fits_of_degree)) lines.push_back(std::move(line));
  if (r.simplices > 0) lines.push_back("traversed " + grouped(r.simplices) + " simplices");
  lines.push_back(normals_made(r.estimated_normals, r.oriented_by));
  if (!r.alignment.empty()) lines.push_back(r.alignment);
  if (!other && !r.paper) lines.push_back(openness_words(r, options.fit.open));
  if (r.closed_handles > 0)
    lines.push_back(fmt::format("genus {}: {} without samples closed", *r.genus, counted(r.closed_handles, "handle")));
  else if (r.genus.value_or(0) > 0)
    lines.push_back(fmt::format("genus {}", *r.genus));
  return lines;
}

}  // namespace sansmesh::inline v1
