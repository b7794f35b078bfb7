#include "sansmesh/render/surface/picture_surfaces.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/mesh_scene.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/splat/splat_scene.h"
#include "sansmesh/render/surface/surface_scene.h"
#include "sansmesh/render/volume/volume_picture.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSheetsApart = 2e-5;  // share of the diagonal: closer sheets may be the same one

/// Whether the painter averages over neighbouring pixels.
bool soft_light(const RenderOptions& options) {
  return options.look.shadows || options.look.ground || options.quality.occlusion_rays > 0;
}

/// A surface whose caster has local coordinates.
class CastScene final : public PictureScene {
 public:
  CastScene(const SurfaceCaster& caster, const PictureFrame& frame, const Camera& camera, const ColorField* colors,
            const SurfaceRenderOptions& options)
      : options_(options), scene_(caster, frame, camera, colors, options_) {}
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override {
    scene_.closest(rays, points);
  }
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override {
    scene_.blocked(rays, answers);
  }

 private:
  SurfaceRenderOptions options_;
  SurfaceScene scene_;
};

/// A scene shared by pictures, with or without streaks along its flow.
class FlowScene final : public PictureScene {
 public:
  FlowScene(std::shared_ptr<const PictureScene> scene, const Camera& camera,
            const std::optional<FlowTextureOptions>& streaks, const RenderOptions& picture)
      : scene_(std::move(scene)) {
    if (!streaks) return;
    // Then each query ray equals the texture's ray of that pixel, and there are no queries beyond the border.
    one_a_pixel_ = picture.quality.samples == 1 && !soft_light(picture);
    texture_.emplace(*scene_, camera, picture.view.width, picture.view.height, one_a_pixel_);
    texture_->convolve(*streaks);
  }
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override {
    if (one_a_pixel_) {
      for (std::size_t i = 0; i < rays.size(); ++i)
        points[i] = texture_->first_point(rays.origin(i), rays.directions[i]);
      return;
    }
    scene_->closest(rays, points);
    for (std::size_t i = 0; texture_ && i < rays.size(); ++i)
      if (points[i]) points[i]->color *= texture_->factor(rays.origin(i), rays.directions[i], *points[i]);
  }
  void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const override {
    scene_->layers(rays, first, points);
    for (std::size_t i = 0; texture_ && i < rays.size(); ++i)
      for (std::size_t k = first[i]; k < first[i + 1]; ++k)
        points[k].color *= texture_->factor(rays.origin(i), rays.directions[i], points[k]);
  }
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override {
    scene_->blocked(rays, answers);
  }

 private:
  std::shared_ptr<const PictureScene> scene_;
  std::optional<FlowTexture> texture_;
  bool one_a_pixel_ = false;
};

class CombinedScene final : public PictureScene {
 public:
  explicit CombinedScene(std::vector<std::unique_ptr<PictureScene>> scenes) : scenes_(std::move(scenes)) {}
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override {
    scenes_[0]->closest(rays, points);
    std::vector<std::optional<SurfacePoint>> others(rays.size());
    for (std::size_t s = 1; s < scenes_.size(); ++s) {
      scenes_[s]->closest(rays, others);
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (others[i] && (!points[i] || others[i]->distance < points[i]->distance)) points[i] = others[i];
    }
  }
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override {
    scenes_[0]->blocked(rays, answers);
    std::vector<std::uint8_t> others(rays.size());
    for (std::size_t s = 1; s < scenes_.size(); ++s) {
      scenes_[s]->blocked(rays, others);
      for (std::size_t i = 0; i < rays.size(); ++i) answers[i] |= others[i];
    }
  }

 private:
  std::vector<std::unique_ptr<PictureScene>> scenes_;
};

/// Any scene with transmission of light.
class TranslucentScene final : public PictureScene {
 public:
  TranslucentScene(std::unique_ptr<PictureScene> scene, float opacity, float apart)
      : scene_(std::move(scene)), opacity_(opacity), apart_(apart) {}
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override {
    scene_->closest(rays, points);
  }
  void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const override {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    const std::size_t n = rays.size();
    std::vector<RayPoint> found;
    std::vector<std::uint32_t> active(n);
    std::iota(active.begin(), active.end(), 0u);
    std::vector<float> left(n, 1), near(n, 0);
    if (!rays.near.empty()) near.assign(rays.near.begin(), rays.near.end());
    std::vector<Vec3f> origins, directions;
    std::vector<float> from, until;
    std::vector<std::optional<SurfacePoint>> hits;
    for (int round = 0; round < kMostSheets && !active.empty(); ++round) {
      origins.clear(), directions.clear(), from.clear(), until.clear();
      if (rays.origins.size() == 1) origins.push_back(rays.origins[0]);
      for (const std::uint32_t i : active) {
        if (rays.origins.size() != 1) origins.push_back(rays.origin(i));
        directions.push_back(rays.directions[i]);
        from.push_back(near[i]), until.push_back(rays.far.empty() ? kFar : rays.far[i]);
      }
      hits.assign(active.size(), {});
      scene_->closest({origins, directions, from, until}, hits);
      std::size_t kept = 0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        if (!hits[k]) continue;
        const std::uint32_t i = active[k];
        SurfacePoint& point = hits[k].value();
        point.opacity = sheet_opacity(opacity_, dot(point.normal, rays.directions[i]));
        found.push_back({i, point});
        left[i] *= 1 - point.opacity;
        near[i] = point.distance + apart_;
        if (left[i] >= kLeastThrough) active[kept++] = i;
      }
      active.resize(kept);
    }
    sort_into_layers(found, n, first, points);
  }
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override {
    scene_->blocked(rays, answers);
  }

 private:
  std::unique_ptr<PictureScene> scene_;
  float opacity_, apart_;
};

/// An invisible volume around translucent surfaces.
class ClearVolume final : public VolumeField {
 public:
  explicit ClearVolume(const Box3& box) : box_(box) {}
  std::size_t components() const override { return 1; }
  Box3 bounds() const override { return box_; }
  void evaluate(std::span<const Vec3> /*x*/, const VolumeFieldValues& values) const override {
    std::fill(values.values.begin(), values.values.end(), 0.0);
    std::fill(values.gradients.begin(), values.gradients.end(), Vec3{});
    std::fill(values.inside.begin(), values.inside.end(), std::uint8_t{1});
  }
  void spacing(std::span<const Vec3> /*x*/, std::span<double> found) const override {
    std::fill(found.begin(), found.end(), box_.diagonal());
  }
  void ranges(std::span<const Box3> /*boxes*/, std::span<ValueRange> found) const override {
    std::fill(found.begin(), found.end(), ValueRange{0, 0});
  }

 private:
  Box3 box_;
};

}  // namespace

void FlowLook::validate() const {
  if (texture) texture->validate();
  check_range("opacity", opacity, 0, 1);
}

SceneFactory scene_factory(const TriangleMesh& mesh, const RenderOptions& options) {
  options.validate();
  auto shared = std::make_shared<const TriangleMesh>(mesh);
  make_subject(*shared, options);  // throws if there is nothing to draw
  return [shared, options](const PictureFrame& frame, const Camera& camera) {
    return std::make_unique<MeshScene>(make_subject(*shared, options, frame), options, camera);
  };
}

SceneFactory scene_factory(const SurfaceCaster& caster, const LocalFrame& local, const ColorField* colors,
                           const SurfaceRenderOptions& options) {
  options.validate();
  SurfaceRenderOptions own = options;
  own.picture.look.shadows = false;
  return [&caster, local, colors, own](const PictureFrame& frame, const Camera& camera) {
    const PictureFrame placed{local.from_input(frame.center), local.from_input(frame.size)};
    return std::make_unique<CastScene>(caster, placed, camera, colors, own);
  };
}

SceneFactory translucent(SceneFactory surface, double opacity, double apart) {
  check_range("opacity", opacity, 0, 1);
  return [surface = std::move(surface), opacity, apart](const PictureFrame& frame, const Camera& camera) {
    const double sheets = std::max(kSheetsApart, apart / frame.size);
    return std::make_unique<TranslucentScene>(surface(frame, camera), static_cast<float>(opacity),
                                              static_cast<float>(sheets));
  };
}

struct DrawnFlow::State {
  FlowSubject subject;
  RenderOptions options;
  std::mutex mutex;
  PictureFrame frame;
  bool splats = false;
  double opacity = 1;
  std::shared_ptr<const PictureScene> scene;  // for the values above

  std::shared_ptr<const PictureScene> scene_of(const PictureFrame& wanted, const Camera& camera, const FlowLook& look) {
    const std::lock_guard lock(mutex);
    if (scene && frame.center == wanted.center && frame.size == wanted.size && splats == look.splats &&
        opacity == look.opacity && options.look.wireframe == PictureLook::Wireframe::none)
      return scene;
    frame = wanted, splats = look.splats, opacity = look.opacity;
    if (splats) {
      scene = std::make_shared<const SplatScene>(
          splats_at_vertices(subject.mesh, subject.vectors, subject.fronts, options, frame),
          static_cast<float>(opacity));
    } else {
      Subject drawn = make_subject(subject.mesh, options, frame, subject.vectors);
      drawn.opacity = static_cast<float>(opacity);
      scene = std::make_shared<const MeshScene>(std::move(drawn), options, camera);
    }
    return scene;
  }
};

DrawnFlow::DrawnFlow(FlowSubject subject, const RenderOptions& options) : state_(std::make_shared<State>()) {
  options.validate();
  check_argument(subject.vectors.size() == subject.mesh.vertices.size(), "there must be a vector for each vertex");
  state_->subject = std::move(subject);
  state_->options = options;
}

SceneFactory DrawnFlow::surface(const FlowLook& look) const {
  look.validate();
  const FlowSubject& subject = state_->subject;
  check_argument(!look.splats || subject.fronts.size() == subject.mesh.vertices.size(),
                 "splats need a front for each vertex");
  return [state = state_, look](const PictureFrame& frame, const Camera& camera) {
    return std::make_unique<FlowScene>(state->scene_of(frame, camera, look), camera, look.texture, state->options);
  };
}

Image render_surfaces(std::span<const SceneFactory> surfaces, std::span<const Vec3> points, bool translucent,
                      const RenderOptions& options, Progress& progress) {
  options.validate();
  if (surfaces.empty()) throw DataError("nothing to draw: no surfaces");
  const Box3 box = finite_bounds(points);
  const PictureFrame frame = frame_of_points(box);
  if (translucent) {
    const double wide = 1e-3 * frame.size;
    const Vec3 rim{wide, wide, wide};  // flat content has no inside
    const ClearVolume field({box.lower - rim, box.upper + rim});
    VolumePictureOptions o;
    o.picture = options;
    o.opacity_factor = 0;
    o.clip_faces = false;
    o.transfer = TransferFunction{{}, {{0, {}}, {1, {}}}, {{0, 0}, {1, 0}}};
    VolumeSubject subject;
    subject.field = &field;
    subject.framed = points;
    subject.surfaces.assign(surfaces.begin(), surfaces.end());
    return render_volume(subject, o, progress);
  }
  std::vector<Vec3f> placed;
  for (const Vec3& p : points)
    if (is_finite(p)) placed.push_back(frame.to_picture(p));
  const Camera camera = picture_camera(placed, frame, options);
  progress.begin("preparing");
  std::vector<std::unique_ptr<PictureScene>> scenes;
  for (const SceneFactory& surface : surfaces) scenes.push_back(surface(frame, camera));
  const CombinedScene scene(std::move(scenes));
  return paint_scene(scene, camera, frame, options, soft_light(options), placed, 0, progress);
}

}  // namespace sansmesh::inline v1
