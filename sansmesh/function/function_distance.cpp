#include "sansmesh/function/function_distance.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/mesh_field.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"

namespace sansmesh::inline v1 {
namespace {

/// Error of this mesh over that of a normal mesh: offsets magnify errors of normals.
constexpr double kFinerMesh = 0.2;
/// Distance from the surface, in spacings, at which the function determines the side, and least magnitude of its value
/// there.
constexpr double kBeside = 1, kSoundShare = 0.25;

/// Fits have creases of more than 30 degrees. Creases shorter than kLeastCrease spacings are noise.
constexpr double kFunctionCrease = 30, kLeastCrease = 5;

TriangleMesh whole_mesh(const FittedFunction& function, Progress& progress) {
  MeshOptions options;
  options.components.kind = ComponentChoice::Kind::all;
  options.carry_colors = false;
  options.mesher = Mesher::blocks;
  options.mesh_error = kFinerMesh * function.frame.to_input(default_mesh_error(function.field.report()));
  return mesh_function(function, options, progress);
}

}  // namespace

struct FunctionDistance::Parts {
  Parts(std::shared_ptr<const FittedFunction> f, Progress& progress)
      : function(std::move(f)), field(function->field, function->frame) {
    TriangleMesh mesh = whole_mesh(*function, progress);
    closed = measure_topology(mesh).closed();
    const double spacing = function->frame.to_input(function->field.report().spacing);
    distance = std::make_unique<MeshField>(
        std::move(mesh),
        MeshField::Options{
            .rounded = true, .smooth = true, .crease_angle = kFunctionCrease, .least_crease = kLeastCrease * spacing});
    near = std::max(kBeside * spacing, 1e-6 * distance->bounds().diagonal());
  }

  /// For an open mesh the side is that of the function next to the closest point, because normals at a border are
  /// misleading. Returns 1 or -1, the factor of the values.
  std::vector<double> sides(std::span<const Vec3> x, std::span<const double> values,
                            std::span<const Vec3> gradients) const {
    std::vector<Vec3> beside(x.begin(), x.end());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (std::abs(values[i]) > near) beside[i] = x[i] - gradients[i] * (values[i] - std::copysign(near, values[i]));
    std::vector<double> side(x.size());
    field.evaluate(beside, side);
    for (std::size_t i = 0; i < x.size(); ++i)
      side[i] = std::abs(side[i]) > kSoundShare * near && (side[i] < 0) != (values[i] < 0) ? -1 : 1;
    return side;
  }

  std::shared_ptr<const FittedFunction> function;
  PlacedField field;
  std::unique_ptr<const MeshField> distance;
  bool closed = false;
  double near = 0;  ///< about one spacing
};

FunctionDistance::FunctionDistance(std::shared_ptr<const FittedFunction> function, Progress& progress)
    : parts_(std::make_shared<Parts>(std::move(function), progress)) {}

Box3 FunctionDistance::bounds() const { return parts_->closed ? parts_->distance->bounds() : parts_->field.bounds(); }
bool FunctionDistance::closed() const { return parts_->closed; }
std::uint32_t FunctionDistance::pieces() const { return parts_->distance->pieces(); }

void FunctionDistance::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  if (parts_->closed) return parts_->distance->evaluate(x, values, gradients);
  std::vector<Vec3> own(gradients.empty() ? x.size() : 0);
  const std::span<Vec3> slopes = gradients.empty() ? std::span(own) : gradients;
  parts_->distance->evaluate(x, values, slopes);
  const std::vector<double> side = parts_->sides(x, values, slopes);
  for (std::size_t i = 0; i < x.size(); ++i) {
    values[i] *= side[i];
    if (!gradients.empty()) gradients[i] = gradients[i] * side[i];
  }
}

void FunctionDistance::active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const {
  parts_->distance->active(x, piece);
}

void FunctionDistance::evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                                      std::span<Vec3> gradients) const {
  parts_->distance->evaluate_piece(piece, x, values, gradients);
}

std::optional<double> FunctionDistance::slope_bound() const {
  return parts_->closed ? std::optional<double>(1) : std::nullopt;
}

Solid function_distance_solid(std::shared_ptr<const FittedFunction> function, Progress& progress) {
  auto distance = std::make_shared<const FunctionDistance>(std::move(function), progress);
  return distance->closed() ? csg::distance_leaf(std::move(distance)) : csg::leaf(std::move(distance));
}

}  // namespace sansmesh::inline v1
