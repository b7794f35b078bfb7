#include "sansmesh/jobs/deformation.h"

#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/deform/handle_motion.h"
#include "sansmesh/deform/handle_shapes.h"
#include "sansmesh/deform/mls_deformation.h"
#include "sansmesh/error.h"
#include "sansmesh/field/inverse_map.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kInverseTolerance = 1e-9;  // of the size of a map that is given
constexpr double kBallShare = 0.008;        // radius of drawn handles, of what is drawn

}  // namespace

Deformation::Deformation(std::vector<Handle> handles, const MlsDeformationOptions& options,
                         std::vector<std::shared_ptr<const Occluder>> cuts, std::string name)
    : name_(std::move(name)), handles_(std::move(handles)), options_(options), cuts_(std::move(cuts)) {
  options_.validate();
  whole_ = at(1);
}

Deformation::Deformation(std::shared_ptr<const DisplacementMap> map, std::string name) : name_(std::move(name)) {
  auto forward = std::make_shared<const InverseMap>(map, kInverseTolerance);
  whole_ = {std::move(map), std::move(forward)};
}

DeformationMaps Deformation::at(double share) const {
  if (whole_.backward && (!has_handles() || share == 1)) return whole_;
  std::vector<Handle> now = handles_at(share);
  try {
    auto forward = std::make_shared<const MlsDeformation>(reversed(now), options_, cuts_);
    return {std::make_shared<const MlsDeformation>(std::move(now), options_, cuts_), std::move(forward)};
  } catch (const ArgumentError& error) {
    if (name_.empty()) throw;
    throw FileError(name_, error.what());
  }
}

std::vector<Handle> Deformation::handles_at(double share) const { return sansmesh::handles_at(handles_, share); }

std::optional<Box3> Deformation::box_of(const DeformationMaps& maps, const Box3& box) const {
  if (!has_handles() || !is_finite(box.lower) || !is_finite(box.upper) || box.empty()) return std::nullopt;
  constexpr int kPoints = 9;
  std::vector<Vec3> x;
  const Vec3 step = box.size() * (1.0 / (kPoints - 1));
  for (int l = 0; l < kPoints; ++l)
    for (int j = 0; j < kPoints; ++j)
      for (int i = 0; i < kPoints; ++i) x.push_back(box.lower + Vec3{i * step.x, j * step.y, l * step.z});
  std::vector<Vec3> moved(x.size());
  maps.forward->map(x, {moved, {}, {}, {}});
  Box3 found;
  for (const Vec3& p : moved)
    if (is_finite(p)) found.extend(p);
  if (found.empty()) return std::nullopt;
  return found;
}

TriangleMesh Deformation::handle_shapes_at(double share, double size) const {
  HandleShapeOptions options;
  options.radius = kBallShare * size;
  return handle_shapes(handles_at(share), options);
}

std::string Deformation::words() const {
  if (!has_handles()) return "by a displacement map";
  return fmt::format("{}, {}{}{}", counted(handles_.size(), "handle"), kind_word(options_.kind),
                     options_.kind == DeformationKind::nonlinear ? fmt::format(" of degree {}", options_.degree) : "",
                     cuts_.empty() ? "" : ", " + counted(cuts_.size(), "cut"));
}

Box3 with_room(const Box3& box, double share) {
  const Vec3 room = Vec3{1, 1, 1} * (share * box.diagonal());
  return {box.lower - room, box.upper + room};
}

namespace {

constexpr ReportRow kDeformationRows[] = {
    reported<[](const Deformation& r) { return told_if(!r.has_handles(), r.name()); }>(
        {.name = "map", .text = "File of the map of displacements"}),
    reported<[](const Deformation& r) { return told_if(r.has_handles(), r.handles_at(0).size()); }>(
        {.name = "handles", .text = "Handles"}),
    reported<[](const Deformation& r) { return told_if(r.has_handles(), r.name()); }>(
        {.name = "file", .text = "File of the handles"}),
    reported<[](const Deformation& r) { return told_if(r.has_handles(), std::string(kind_word(r.options().kind))); }>(
        {.name = "kind", .text = "Kind of the deformation"}),
    reported<[](const Deformation& r) {
      return told_if(r.has_handles() && r.options().kind == DeformationKind::nonlinear, r.options().degree);
    }>({.name = "degree", .text = "Degree of its polynomials"}),
    reported<[](const Deformation& r) { return told_if(r.has_handles(), r.options().alpha); }>(
        {.name = "alpha", .text = "Exponent of the weights"}),
    reported<[](const Deformation& r) { return told_if(!r.cuts().empty(), r.cuts().size()); }>(
        {.name = "cuts", .text = "Cuts"}),
    reported<[](const Deformation& r) { return told_if(!r.cuts().empty(), r.options().damping); }>(
        {.name = "damping", .text = "Damping of what crosses cuts"})};

}  // namespace

const ReportSchema& Deformation::schema() {
  static constexpr ReportSchema schema{kDeformationRows};
  return schema;
}

}  // namespace sansmesh::inline v1
