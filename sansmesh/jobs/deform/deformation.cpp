// Deformations of space.
#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/deform.h"
#include "sansmesh/deform/handles/handle_motion.h"
#include "sansmesh/deform/handles/handle_shapes.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/deform/mls/mls_deformation.h"
#include "sansmesh/error.h"
#include "sansmesh/field/inverse_map.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kInverseTolerance = 1e-9;  // share of the map's size
constexpr double kBallShare = 0.008;        // radius of drawn handles as a share of the object

}  // namespace

struct Deformation::State {
  std::string name;
  std::vector<Handle> handles = {};
  MlsDeformationOptions options = {};
  std::vector<std::shared_ptr<const Occluder>> cuts = {};
  DeformationMaps whole = {};  ///< at share 1

  DeformationMaps at(double share) const {
    std::vector<Handle> now = sansmesh::handles_at(handles, share);
    try {
      auto forward = std::make_shared<const MlsDeformation>(reversed(now), options, cuts);
      return {std::make_shared<const MlsDeformation>(std::move(now), options, cuts), std::move(forward)};
    } catch (const ArgumentError& error) {
      if (name.empty()) throw;
      throw FileError(name, error.what());
    }
  }
};

Deformation::Deformation(std::vector<Handle> handles, const MlsDeformationOptions& options,
                         std::vector<std::shared_ptr<const Occluder>> cuts, std::string name) {
  options.validate();
  auto state =
      std::make_shared<State>(State{.name = std::move(name), .handles = std::move(handles), .options = options});
  state->cuts = std::move(cuts);
  state->whole = state->at(1);
  state_ = std::move(state);
}

Deformation::Deformation(std::shared_ptr<const SpaceMap> backward, std::string name) {
  auto state = std::make_shared<State>(State{.name = std::move(name)});
  auto forward = std::make_shared<const InverseMap>(backward, kInverseTolerance);
  state->whole = {std::move(backward), std::move(forward)};
  state_ = std::move(state);
}

Deformation::Deformation(const GridBlock& displacements, std::string name)
    : Deformation(std::make_shared<const DisplacementMap>(displacement_map_of(displacements)), std::move(name)) {}

DeformationMaps Deformation::at(double share) const {
  return !has_handles() || share == 1 ? state_->whole : state_->at(share);
}

std::vector<Handle> Deformation::handles_at(double share) const { return sansmesh::handles_at(state_->handles, share); }
bool Deformation::has_handles() const { return !state_->handles.empty(); }
const std::vector<std::shared_ptr<const Occluder>>& Deformation::cuts() const { return state_->cuts; }
const std::string& Deformation::name() const { return state_->name; }
const MlsDeformationOptions& Deformation::options() const { return state_->options; }

std::optional<Box3> Deformation::box_of(const DeformationMaps& maps, const Box3& box) const {
  if (!has_handles() || !is_finite(box.lower) || !is_finite(box.upper) || box.empty()) return std::nullopt;
  constexpr int kPoints = 9;
  std::vector<Vec3> x;
  const Vec3 step = box.size() * (1.0 / (kPoints - 1));
  for (int l = 0; l < kPoints; ++l)
    for (int j = 0; j < kPoints; ++j)
      for (int i = 0; i < kPoints; ++i) x.push_back(box.lower + Vec3{i * step.x, j * step.y, l * step.z});
  std::vector<Vec3> moved(x.size());
  maps.forward->query({.points = x}, {.values = moved});
  const Box3 found = finite_bounds(moved);
  return found.empty() ? std::nullopt : std::optional(found);
}

TriangleMesh Deformation::handle_shapes_at(double share, double size) const {
  HandleShapeOptions options;
  options.radius = kBallShare * size;
  return handle_shapes(handles_at(share), options);
}

std::string Deformation::words() const {
  if (!has_handles()) return "by a displacement map";
  const MlsDeformationOptions& of = options();
  return fmt::format("{}, {}{}{}", counted(state_->handles.size(), "handle"), kind_word(of.kind),
                     of.kind == DeformationKind::nonlinear ? fmt::format(" of degree {}", of.degree) : "",
                     cuts().empty() ? "" : ", " + counted(cuts().size(), "cut"));
}

const ReportSchema& Deformation::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const Deformation& r) { return value_if(!r.has_handles(), r.name()); }>(
          {.name = "map", .text = "File of the displacement map"}),
      reported<[](const Deformation& r) { return value_if(r.has_handles(), r.handles_at(0).size()); }>(
          {.name = "handles", .text = "Handles"}),
      reported<[](const Deformation& r) { return value_if(r.has_handles(), r.name()); }>(
          {.name = "file", .text = "File of the handles"}),
      reported<[](const Deformation& r) {
        return value_if(r.has_handles(), std::string(kind_word(r.options().kind)));
      }>({.name = "kind", .text = "Kind of the deformation"}),
      reported<[](const Deformation& r) {
        return value_if(r.has_handles() && r.options().kind == DeformationKind::nonlinear, r.options().degree);
      }>({.name = "degree", .text = "Degree of its polynomials"}),
      reported<[](const Deformation& r) { return value_if(r.has_handles(), r.options().alpha); }>(
          {.name = "alpha", .text = "Exponent of the weights"}),
      reported<[](const Deformation& r) { return value_if(!r.cuts().empty(), r.cuts().size()); }>(
          {.name = "cuts", .text = "Cuts"}),
      reported<[](const Deformation& r) { return value_if(!r.cuts().empty(), r.options().damping); }>(
          {.name = "damping", .text = "Damping across cuts"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
