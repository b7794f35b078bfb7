#include "motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <utility>

#include "picture_contents.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/dynamics/tet_map.h"
#include "sansmesh/field/deformed_volume.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/volume_picture.h"

namespace sansmesh::cli {
namespace {

constexpr Vec3f kFloorColor{0.62f, 0.66f, 0.72f};
constexpr Vec3f kSphereColor{0.45f, 0.58f, 0.78f};
constexpr int kFramingDirections = 200;
constexpr double kFloorSize = 1.1;  ///< its radius, of the diagonal of all that moves

/// The farthest of all points in many directions: what frames them frames all.
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

void color(TriangleMesh& mesh, const Vec3f& c) {
  mesh.colors.assign(mesh.vertices.size(), {to_byte(c.x), to_byte(c.y), to_byte(c.z)});
}

/// The part of a plane around where the body goes.
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

}  // namespace

Motion::Motion(const TetMesh& rest, bool with_positions, bool with_velocities)
    : rest_(rest), origin_(bounds(rest).center()), with_positions_(with_positions), with_velocities_(with_velocities) {}

double Motion::bytes(std::size_t frames) const {
  const int vectors = (with_positions_ ? 1 : 0) + (with_velocities_ ? 1 : 0);
  return static_cast<double>(vectors * sizeof(Vec3f)) * static_cast<double>(frames) *
         static_cast<double>(rest_.vertices.size());
}

void Motion::add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit) {
  times_.push_back(time);
  std::vector<Vec3f>& x = positions_.emplace_back();
  if (with_positions_) {
    x.reserve(positions.size());
    for (const Vec3& p : positions) x.push_back(Vec3f(p / unit - origin_));
  }
  std::vector<Vec3f>& v = velocities_.emplace_back();
  if (!with_velocities_) return;
  v.reserve(velocities.size());
  for (const Vec3& p : velocities) v.push_back(Vec3f(p / unit));
}

std::vector<Vec3> Motion::positions(std::size_t frame) const {
  std::vector<Vec3> x;
  x.reserve(positions_[frame].size());
  for (const Vec3f& p : positions_[frame]) x.push_back(origin_ + Vec3(p));
  return x;
}

CarriedSurface::CarriedSurface(const TetMesh& rest) { surface_ = boundary_mesh(rest, rest.vertices, &sources_); }

CarriedSurface::CarriedSurface(const TetMesh& rest, TriangleMesh surface) : surface_(std::move(surface)) {
  std::vector<Vec3> x;
  x.reserve(surface_.vertices.size());
  for (const Vec3f& p : surface_.vertices) x.push_back(surface_.origin + Vec3(p));
  embedding_.emplace(rest, x);
  for (const Vec3f& n : surface_.normals) normals_.push_back(Vec3(n));
}

TriangleMesh CarriedSurface::at(const Motion& motion, std::size_t frame) const {
  const std::vector<Vec3> x = motion.positions(frame);
  TriangleMesh m = surface_;
  m.origin = motion.origin();
  if (!embedding_) {
    for (std::size_t v = 0; v < m.vertices.size(); ++v) m.vertices[v] = Vec3f(x[sources_[v]] - m.origin);
    return m;
  }
  const std::vector<Vec3> moved = embedding_->positions(x);
  for (std::size_t v = 0; v < m.vertices.size(); ++v) m.vertices[v] = Vec3f(moved[v] - m.origin);
  if (!normals_.empty()) {
    const std::vector<Vec3> turned = embedding_->normals(x, normals_);
    for (std::size_t v = 0; v < m.normals.size(); ++v) m.normals[v] = Vec3f(turned[v]);
  }
  return m;
}

struct MotionPictures::Volume {
  OpenVolume open;
  std::shared_ptr<const VolumeField> field;
  VolumePictureOptions options;
  TriangleMesh boundary;  ///< of the frame that is drawn
  std::vector<std::uint32_t> sources;

  Volume(const CarriedVolume& carried, const Motion& motion, Console& console) : open(carried.input, console) {
    try {
      open.dataset().default_array();  // there must be one
      field = open.field(as_scalar(open.choice(), open));
    } catch (const DataError& error) {
      throw FileError(carried.input.name(), error.what());
    }
    carried.colors.put_into(options);
    boundary = boundary_mesh(motion.rest(), motion.rest().vertices, &sources);
    const Box3 body = bounds(motion.rest()), all = field->bounds();
    const double rim = 0.01 * body.diagonal();
    for (std::size_t k = 0; k < 3; ++k)
      if (body.lower[k] < all.lower[k] - rim || body.upper[k] > all.upper[k] + rim) {
        console.warn(carried.input.name(), {"does not reach everywhere in the tetrahedra: its values go on beyond it"});
        break;
      }
  }
};

MotionPictures::MotionPictures(const Motion& motion, const CarriedSurface* surface, const CarriedVolume& volume,
                               const RenderOptions& options, Console& console)
    : motion_(motion), surface_(surface), options_(options) {
  if (!volume.wanted()) return;
  volume_ = std::make_unique<Volume>(volume, motion, console);
  static_cast<RenderOptions&>(volume_->options) = options_;
  volume_->options.validate();
}

void MotionPictures::frame(const DynamicsScene& scene) {
  FarthestPoints farthest;
  Box3 box;
  for (std::size_t frame = 0; frame < motion_.frames(); ++frame) {
    if (surface_) {
      const TriangleMesh m = surface_->at(motion_, frame);
      for (const Vec3f& p : m.vertices) farthest.add(m.origin + Vec3(p));
    } else {
      for (const Vec3& p : motion_.positions(frame)) farthest.add(p);
    }
  }
  for (const Vec3& p : farthest.points()) box.extend(p);
  for (const SphereObstacle& s : scene.spheres) {
    obstacles_.push_back(ball_mesh(s.center, s.radius));
    color(obstacles_.back(), kSphereColor);
    // Spheres larger than the motion frame nothing.
    if (2 * s.radius < box.diagonal())
      for (int k = 0; k < 6; ++k) {
        Vec3 d{};
        d[static_cast<std::size_t>(k / 2)] = k % 2 ? s.radius : -s.radius;
        farthest.add(s.center + d);
      }
  }
  for (const FloorObstacle& f : scene.floors) {
    obstacles_.push_back(floor_mesh(f, box));
    color(obstacles_.back(), kFloorColor);
  }
  framed_ = farthest.points();
  if (scene.floors.empty()) return;
  options_.ground = false;
  if (volume_) volume_->options.ground = false;
}

MotionPictures::~MotionPictures() = default;

Image MotionPictures::draw(std::size_t frame, Progress& progress) {
  std::vector<PictureSurface> surfaces;
  RenderOptions colored = options_;
  colored.use_colors = true;
  colored.wireframe = RenderOptions::Wireframe::none;
  surfaces.reserve(obstacles_.size() + 1);
  for (const TriangleMesh& m : obstacles_) surfaces.push_back(surface_in_picture(m, colored));
  if (surface_) surfaces.push_back(surface_in_picture(surface_->at(motion_, frame), options_));
  if (!volume_) return render_surfaces(surfaces, framed_, false, false, options_, progress);
  Volume& v = *volume_;
  const std::vector<Vec3> x = motion_.positions(frame);
  Box3 box;
  for (const Vec3& p : x) box.extend(p);
  v.boundary.origin = motion_.origin();
  for (std::size_t k = 0; k < v.sources.size(); ++k)
    v.boundary.vertices[k] = Vec3f(x[v.sources[k]] - v.boundary.origin);
  const DeformedVolume field(v.field, std::make_shared<TetMap>(motion_.rest().tets, x, motion_.rest().vertices), box,
                             box);
  VolumeSubject subject;
  subject.field = &field;
  subject.boundary = &v.boundary;
  subject.surfaces = std::move(surfaces);
  subject.places = x;
  subject.framed = framed_;
  subject.image = v.open.samples()->lattice.has_value();
  VolumePictureReport report;
  Image image = render_volume(subject, v.options, progress, &report);
  // The colours of the first frame are those of all.
  v.options.transfer = report.transfer;
  v.options.preset.clear();
  return image;
}

std::string motion_frame_name(const std::string& output, std::size_t frame) {
  const std::filesystem::path path(output);
  return (path.parent_path() / fmt::format("{}_{:04}{}", path.stem().string(), frame, path.extension().string()))
      .string();
}

}  // namespace sansmesh::cli
