#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/dynamics/tet_map.h"
#include "sansmesh/field/deformed_volume.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/simulate.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kVolumeRim = 0.01;  ///< share of the diagonal by which the tetrahedra may extend beyond their volume
constexpr Vec3f kFloorColor{0.62f, 0.66f, 0.72f};
constexpr Vec3f kSphereColor{0.45f, 0.58f, 0.78f};
constexpr int kFramingDirections = 200;
constexpr double kFloorSize = 1.1;  ///< radius of the floor, as a share of the diagonal of the motion

/// Farthest points in many directions: a frame that contains them contains all points.
class FarthestPoints {
 public:
  FarthestPoints() : most_(kFramingDirections, -std::numeric_limits<double>::infinity()), points_(kFramingDirections) {
    for (int k = 0; k < kFramingDirections; ++k) {
      const double z = 1 - (2 * k + 1.0) / kFramingDirections, r = std::sqrt(1 - z * z);
      const double phi = k * std::numbers::pi * (3 - std::sqrt(5.0));
      directions_.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
  }
  void add(const Vec3& x) {
    for (std::size_t k = 0; k < directions_.size(); ++k)
      if (const double d = dot(x, directions_[k]); d > most_[k]) most_[k] = d, points_[k] = x;
  }
  const std::vector<Vec3>& points() const { return points_; }

 private:
  std::vector<Vec3> directions_;
  std::vector<double> most_;
  std::vector<Vec3> points_;
};

TriangleMesh ball_mesh(const Vec3& center, double radius) {
  constexpr std::uint32_t rings = 32, around = 64;
  TriangleMesh m;
  m.origin = center;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * j / around;
      m.vertices.push_back(
          Vec3f(Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)} * radius));
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around, c = a + around, d = b + around;
      if (i > 0) m.triangles.push_back({a, c, b});
      if (i + 1 < rings) m.triangles.push_back({b, c, d});
    }
  return m;
}

/// Part of a plane below the motion.
TriangleMesh floor_mesh(const FloorObstacle& floor, const Box3& box) {
  const Vec3 n = normalized(floor.normal);
  const Vec3 side = std::abs(n.x) < 0.9 ? normalized(cross(n, Vec3{1, 0, 0})) : normalized(cross(n, Vec3{0, 1, 0}));
  const Vec3 other = cross(n, side);
  TriangleMesh m;
  m.origin = box.center() - n * dot(box.center() - floor.point, n);
  const double radius = kFloorSize * box.diagonal();
  constexpr std::uint32_t around = 128;
  m.vertices.push_back({});
  for (std::uint32_t k = 0; k < around; ++k) {
    const double phi = 2 * std::numbers::pi * k / around;
    m.vertices.push_back(Vec3f(side * (radius * std::cos(phi)) + other * (radius * std::sin(phi))));
    m.triangles.push_back({0, k + 1, (k + 1) % around + 1});
  }
  return m;
}

/// Whether the tetrahedra extend beyond the volume.
bool reaches_beyond(const Box3& body, const Box3& volume) {
  const double rim = kVolumeRim * body.diagonal();
  for (std::size_t k = 0; k < 3; ++k)
    if (body.lower[k] < volume.lower[k] - rim || body.upper[k] > volume.upper[k] + rim) return true;
  return false;
}

}  // namespace

struct MotionPictures::State {
  std::shared_ptr<const TetMesh> rest;
  DynamicsScene scene;
  std::optional<CarriedSurface> surface;
  std::optional<CarriedVolume> volume;
  RenderOptions options;
  std::vector<Note> notes;
  Motion motion;
  std::vector<Vec3> framed;
  std::vector<TriangleMesh> obstacles;
  TriangleMesh boundary;  ///< boundary of the volume in the current frame
  std::vector<std::uint32_t> sources;
};

CarriedVolume carried_volume(const VolumeModel& volume, Progress& progress, std::vector<Note>& notes) {
  CarriedVolume carried;
  carried.field = volume.field(volume.as_scalar(volume.choice()), progress, notes);
  carried.image = volume.samples(progress)->lattice.has_value();
  return carried;
}

MotionPictures::MotionPictures(const SimulationPlan& plan, std::optional<CarriedSurface> surface,
                               std::optional<CarriedVolume> volume, RenderOptions options)
    : state_(std::make_unique<State>()) {
  options.validate();
  if (plan.z_up) options.view.up = UpAxis::z;
  State& s = *state_;
  s.rest = plan.rest, s.scene = plan.scene, s.surface = std::move(surface), s.volume = std::move(volume),
  s.options = options;
  if (!s.volume) return;
  s.volume->look.picture = options;
  s.volume->look.validate();
  s.boundary = boundary_mesh(*s.rest, s.rest->vertices, &s.sources);
  if (reaches_beyond(bounds(*s.rest), s.volume->field->bounds()))
    s.notes.push_back({.code = "volume_ends", .text = "does not cover all tetrahedra: its values are extrapolated"});
}

MotionPictures::~MotionPictures() = default;
MotionPictures::MotionPictures(MotionPictures&&) noexcept = default;
MotionPictures& MotionPictures::operator=(MotionPictures&&) noexcept = default;

const std::vector<Note>& MotionPictures::notes() const { return state_->notes; }

void MotionPictures::show(Motion motion) {
  State& s = *state_;
  const DynamicsScene& scene = s.scene;
  s.motion = std::move(motion);
  FarthestPoints farthest;
  Box3 box;
  for (std::size_t frame = 0; frame < s.motion.frames(); ++frame) {
    if (s.surface) {
      const TriangleMesh m = s.surface->at(s.motion, frame);
      for (const Vec3f& p : m.vertices) farthest.add(m.origin + Vec3(p));
    } else {
      for (const Vec3& p : s.motion.positions(frame)) farthest.add(p);
    }
  }
  for (const Vec3& p : farthest.points()) box.extend(p);
  for (const SphereObstacle& sphere : scene.spheres) {
    s.obstacles.push_back(ball_mesh(sphere.center, sphere.radius));
    s.obstacles.back().colors.assign(s.obstacles.back().vertices.size(), to_bytes(kSphereColor));
    // Spheres larger than the motion do not affect the frame.
    if (2 * sphere.radius < box.diagonal())
      for (int k = 0; k < 6; ++k) {
        Vec3 d{};
        d[static_cast<std::size_t>(k / 2)] = k % 2 ? sphere.radius : -sphere.radius;
        farthest.add(sphere.center + d);
      }
  }
  for (const FloorObstacle& f : scene.floors) {
    s.obstacles.push_back(floor_mesh(f, box));
    s.obstacles.back().colors.assign(s.obstacles.back().vertices.size(), to_bytes(kFloorColor));
  }
  s.framed = farthest.points();
  if (scene.floors.empty()) return;
  s.options.look.ground = false;
  if (s.volume) s.volume->look.picture.look.ground = false;
}

Image MotionPictures::draw(std::size_t frame, Progress& progress) {
  State& s = *state_;
  std::vector<SceneFactory> surfaces;
  RenderOptions colored = s.options;
  colored.look.use_colors = true;
  colored.look.wireframe = PictureLook::Wireframe::none;
  surfaces.reserve(s.obstacles.size() + 1);
  for (const TriangleMesh& m : s.obstacles) surfaces.push_back(scene_factory(m, colored));
  if (s.surface) surfaces.push_back(scene_factory(s.surface->at(s.motion, frame), s.options));
  if (!s.volume) return render_surfaces(surfaces, s.framed, false, s.options, progress);
  const std::vector<Vec3> x = s.motion.positions(frame);
  Box3 box;
  for (const Vec3& p : x) box.extend(p);
  s.boundary.origin = s.motion.origin();
  for (std::size_t k = 0; k < s.sources.size(); ++k)
    s.boundary.vertices[k] = Vec3f(x[s.sources[k]] - s.boundary.origin);
  const DeformedVolume field(s.volume->field, std::make_shared<TetMap>(s.rest->tets, x, s.rest->vertices), box, box);
  VolumeSubject subject;
  subject.field = &field;
  subject.boundary = &s.boundary;
  subject.surfaces = std::move(surfaces);
  subject.samples = x;
  subject.framed = s.framed;
  subject.image = s.volume->image;
  VolumePictureReport report;
  Image image = render_volume(subject, s.volume->look, progress, &report);
  // All frames use the colours of the first.
  s.volume->look.transfer = report.transfer;
  s.volume->look.preset.clear();
  return image;
}

}  // namespace sansmesh::inline v1
