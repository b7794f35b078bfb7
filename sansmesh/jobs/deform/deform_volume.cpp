// Deformation of volumes: resampling and pictures.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/deform/maps/cut_map.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/error.h"
#include "sansmesh/field/deformed_volume.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/field/map_gaps.h"
#include "sansmesh/jobs/deform/deform_parts.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/volumes/volume_subject.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/render/volume/volume_picture.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kHistogramPoints = 60000;
constexpr double kSideTriangles = 1.0 / 24;  // longest edge of the deformed boundary, as a share of the diagonal
constexpr std::size_t kMostSideTriangles = 400000;
constexpr double kBoundaryShare = 1e-7;  // accuracy of the inverse map, as a share of the diagonal
constexpr double kMapRoom = 0.02;        // margin of the sampled map around the box, as a share of the diagonal

/// Surface of a box.
TriangleMesh box_mesh(const Box3& box) {
  TriangleMesh mesh;
  mesh.origin = box.center();
  std::vector<Vec3> corners;
  add_corners(box, corners);
  for (const Vec3& c : corners) mesh.vertices.push_back(Vec3f(c - mesh.origin));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Boundary of the volume after the deformation, unless the inverse fails somewhere.
std::optional<TriangleMesh> moved_boundary(TriangleMesh mesh, const DeformationMaps& maps, double diagonal) {
  refine_edges(mesh, kSideTriangles * diagonal, kMostSideTriangles);
  MeshDeformReport report;
  mesh = deform_mesh(std::move(mesh), InverseMap(maps.backward, kBoundaryShare * diagonal, maps.forward), {}, &report);
  if (report.undefined > 0 || report.turned > 0) return std::nullopt;
  return mesh;
}

/// Data that all poses of a volume share.
class VolumePoses {
 public:
  VolumePoses(const DeformableVolume& volume, const Deformation& deformation, const DeformOptions& options,
              Progress& progress)
      : volume_(volume),
        deformation_(deformation),
        options_(options),
        look_(options.look),
        progress_(progress),
        before_(volume.fields.at(0)->bounds()) {}

  /// Chooses colours, title and view unless they are given.
  void choose_look() {
    const SampledVolume& samples = *volume_.samples;
    if (!look_.transfer) {
      const ValueHistogram values = value_histogram(*volume_.fields[0], kHistogramPoints, samples.positions);
      look_.transfer = look_.preset.empty() ? suggest_transfer_function(values, samples.lattice.has_value()).function
                                            : transfer_function_preset(look_.preset, values);
      look_.preset.clear();
    }
    if (look_.color_title.empty()) look_.color_title = volume_.arrays.at(0);
    if (options_.default_view)
      if (const auto view = view_of_layer(samples.bounds(), look_.picture.view.up))
        look_.picture.view.direction = *view;
    look_.picture.view.steady = options_.frames.has_value();
    if (look_.color_bar) reserve_width(look_.picture, ColorBar{*look_.transfer, look_.color_title, {}});
    framed_ = points_of_poses(deformation_, before_, options_, true);
  }

  /// Resamples all arrays on one lattice.
  GridBlock resampled(int k) {
    const DeformationMaps maps = deformation_.at(options_.share(k));
    folds_.look(*maps.backward, box_at(maps), progress_);
    ResampleOptions options = options_.lattice;
    options.box = options_.box;
    GridBlock block;
    for (std::size_t i = 0; i < volume_.fields.size(); ++i) {
      const auto& field = volume_.fields[i];
      const std::string& name = volume_.arrays.at(i);
      const DeformedVolume deformed(field, maps.backward, deformation_.box_of(maps, field->bounds()), options.box);
      if (!options.box) options.box = deformed.bounds();
      GridBlock one = resample_volume(deformed, name, options, progress_);
      if (i == 0) {
        block = std::move(one);
        continue;
      }
      for (const Attribute& array : one.point_arrays)
        if (array.name == name) block.point_arrays.set(array);
    }
    DeformReport& r = result_.report;
    for (std::size_t a = 0; a < 3; ++a) r.size[a] = block.axes[a].size();
    if (const auto* inside = block.point_arrays.find<std::uint8_t>("inside"))
      r.inside =
          static_cast<double>(std::count(inside->begin(), inside->end(), 1)) / static_cast<double>(inside->size());
    return block;
  }

  DeformedPicture picture(int k) {
    const double share = options_.share(k);
    const DeformationMaps maps = deformation_.at(share);
    const Box3 box = box_at(maps);
    const TriangleMesh folded = folds_.look(*maps.backward, box, progress_);
    const std::shared_ptr<const SpaceMap> seen_by = seen_through(maps, box);
    const MapGaps gaps(seen_by, box);
    const bool torn = seen_by->has_gaps();
    const DeformedVolume field(volume_.fields[0], seen_by, {}, box);
    VolumeSubject subject;
    TriangleMesh boundary;
    VolumeSubject plain = volume_subject(*volume_.samples, boundary);
    progress_.begin("boundary");
    std::optional<TriangleMesh> outside;
    if (torn)
      subject.gap = &gaps;  // the boundary is torn too: the field defines the inside
    else
      outside = moved_boundary(plain.boundary ? std::move(boundary) : box_mesh(before_), {seen_by, maps.forward},
                               before_.diagonal());
    if (outside) subject.boundary = &*outside;
    subject.image = plain.image;
    subject.field = &field;
    std::vector<Vec3> vertices, framed = framed_;
    if (outside) add_finite_points(outside->origin, outside->vertices, vertices);
    subject.samples = vertices;
    if (framed.empty() && torn) add_corners(deformation_.box_of(maps, before_).value_or(box), framed);
    subject.framed = framed;
    if (options_.draw_folds && !folded.triangles.empty())
      subject.surfaces.push_back(scene_factory(folded, look_.picture));
    if (options_.draw_handles && deformation_.has_handles())
      subject.surfaces.push_back(
          scene_factory(deformation_.handle_shapes_at(share, before_.diagonal()), look_.picture));
    const VolumePicture picture(std::move(subject), progress_);
    VolumePictureReport report;
    DeformedPicture made{picture.render(look_, progress_, &report),
                         options_.look.picture.view.width - look_.picture.view.width};
    if (!outside && !torn)
      report.notes.emplace_back(
          "the boundary of the volume is folded or torn: its sides have the resolution of ray steps");
    add_notes(result_.notes, "picture", report.notes, volume_.name);
    result_.report.rays = report.rays, result_.report.evaluations = report.evaluations;
    return made;
  }

  DeformResult result() {
    folds_.add_note(volume_.name, result_.notes);
    result_.report.folds = folds_.worst();
    return std::move(result_);
  }

 private:
  Box3 box_at(const DeformationMaps& maps) const {
    return preimage_box(*maps.backward, before_, deformation_.box_of(maps, before_));
  }

  /// Returns a sampled map, since the exact deformation is too slow for every step of every ray.
  std::shared_ptr<const SpaceMap> seen_through(const DeformationMaps& maps, const Box3& box) const {
    if (options_.exact_deformation || !deformation_.has_handles()) return maps.backward;
    const Box3 wide = with_margin(box, kMapRoom);
    const std::array<std::size_t, 3> sizes = lattice_sizes(wide, static_cast<std::size_t>(options_.map_nodes));
    if (deformation_.cuts().empty())
      return std::make_shared<const DisplacementMap>(displacement_map(*maps.backward, wide, sizes, progress_));
    return std::make_shared<const CutMap>(maps.backward, deformation_.cuts(), wide, sizes, progress_);
  }

  const DeformableVolume& volume_;
  const Deformation& deformation_;
  const DeformOptions& options_;
  VolumePictureOptions look_;
  Progress& progress_;
  Box3 before_;
  std::vector<Vec3> framed_;
  FoldWatch folds_;
  DeformResult result_;
};

}  // namespace

DeformableVolume deformable_volume(const VolumeModel& volume, DeformAim aim, bool all, Progress& progress,
                                   std::vector<Note>& notes) {
  DeformableVolume found{volume.name(), volume.samples(progress), {}, {}};
  const auto add = [&](const ArrayChoice& choice, const std::string& name) {
    found.fields.push_back(volume.field(choice, progress, notes));
    found.arrays.push_back(name);
  };
  if (!all) {
    add(aim == DeformAim::picture ? volume.as_scalar(volume.choice()) : volume.choice(), volume.array_name());
    return found;
  }
  for (const DatasetArray& array : volume.arrays())
    if (dataset_of(volume).volume(array.name, progress) == found.samples) add({array.name, {}, false}, array.name);
  return found;
}

DeformResult deform(const DeformableVolume& volume, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress) {
  options.validate(aim, deformation);
  if (options.refine) throw ArgumentError("`refine` is for meshes");
  if (aim == DeformAim::sections)
    throw ArgumentError("sections need functions or solids: an isosurface of a volume is one");
  VolumePoses poses(volume, deformation, options, progress);
  if (aim == DeformAim::picture) with_name(volume.name, [&] { poses.choose_look(); });
  const auto pose_at = [&](int k) -> DeformedPose {
    if (aim == DeformAim::picture) return poses.picture(k);
    return poses.resampled(k);
  };
  for (int k = 0; k < options.poses(); ++k) use(k, with_name(volume.name, [&] { return pose_at(k); }));
  return poses.result();
}

}  // namespace sansmesh::inline v1
