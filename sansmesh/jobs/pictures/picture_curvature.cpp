#include "sansmesh/jobs/pictures/picture_curvature.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/points/shape/face_shape.h"
#include "sansmesh/surface/sample_curvature.h"
#include "sansmesh/surface/vertex_curvature.h"

namespace sansmesh::inline v1 {
namespace {

/// Step of differences of normals in sample spacings, which resolves details and ignores noise.
constexpr double kCurvatureStep = 1;

/// Curvature of a field; a projection is first wrapped as a field.
class ModelCurvature final : public CurvatureField {
 public:
  ModelCurvature(const SurfaceModel& model, double step, Progress& progress)
      : signed_distance_(model.projection() ? std::make_unique<ProjectionField>(*model.projection()) : nullptr),
        curvatures_(signed_distance_ ? *signed_distance_ : model.field(progress), step) {}
  void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                std::span<PrincipalCurvatures> curvatures) const override {
    curvatures_.evaluate(x, normals, curvatures);
  }

 private:
  std::unique_ptr<ProjectionField> signed_distance_;
  LevelSetCurvature curvatures_;
};

}  // namespace

bool wants_curvature(const RenderOptions& options) {
  return options.look.lines != PictureLook::Lines::none ||
         (options.look.accessibility && options.look.curvature_shading > 0);
}

std::unique_ptr<CurvatureField> curvature_of_surface(const SurfaceModel& model, Progress& progress) {
  const SurfaceReport& report = model.report();
  double spacing = model.frame().from_input(std::max(report.spacing, 2 * report.noise));
  if (!(spacing > 0)) {  // no samples were kept
    std::vector<float> radii = model.balls().radii;
    spacing = static_cast<double>(median(radii));
  }
  return std::make_unique<ModelCurvature>(model, kCurvatureStep * spacing, progress);
}

std::unique_ptr<CurvatureField> curvature_at_samples(const SurfaceModel& model, Progress& progress) {
  progress.begin("curvature");
  CurvatureOptions options;
  options.noise = model.frame().from_input(model.report().noise);
  return std::make_unique<SampleCurvature>(model.points(), LocalFrame{}, options, progress);
}

std::optional<CurvedVertices> curved_vertices(const PointSet& mesh, const CloudPreparation& use, Progress& progress) {
  if (mesh.triangles.empty() || use.faces == FaceUse::ignore) return std::nullopt;
  if (use.faces == FaceUse::automatic && face_samples_wanted(mesh) == 0) return std::nullopt;
  CloudPreparation own = use;
  own.faces = FaceUse::vertices;
  PreparedCloud cloud = prepare_cloud(mesh, own, progress);
  progress.begin("curvature");
  CurvedVertices made{std::move(cloud.points), cloud.frame, {}};
  made.curvatures = estimate_vertex_curvatures(made.points, {}, progress);
  return made;
}

std::unique_ptr<CurvatureField> curvature_of_samples(const PointSet& points, const CloudPreparation& use,
                                                     Progress& progress) {
  if (points.size() < kFewestSamples) return nullptr;
  try {
    if (const auto mesh = curved_vertices(points, use, progress))
      return std::make_unique<SampleCurvature>(mesh->points, mesh->curvatures, mesh->frame);
    const PreparedCloud cloud = prepare_cloud(points, use, progress);
    progress.begin("curvature");
    CurvatureOptions options;
    options.noise = cloud.noise;
    return std::make_unique<SampleCurvature>(cloud.points, cloud.frame, options, progress);
  } catch (const DataError&) {
    return nullptr;  // points without a surface still have silhouettes
  }
}

}  // namespace sansmesh::inline v1
