// sansmesh deform: volumes, resampled or drawn through the map.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "deform.h"
#include "picture_contents.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/deform/cut_map.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/field/deformed_volume.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/field/map_gaps.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/write_volume.h"
#include "sansmesh/mesh/deformed_mesh.h"
#include "sansmesh/mesh/refine_edges.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/transfer_presets.h"
#include "sansmesh/render/value_histogram.h"
#include "sansmesh/render/volume_picture.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kHistogramPoints = 60000;
constexpr double kSideTriangles = 1.0 / 24;  // of the diagonal: edges of the volume's outside that are bent with it
constexpr double kBoundaryShare = 1e-7;      // of the diagonal: to which it is carried
constexpr double kRoom = 0.02;               // around the box for which a map is sampled

/// The outside of a box.
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

/// The outside of the volume after the deformation, where all of it was found.
std::optional<TriangleMesh> moved_boundary(TriangleMesh mesh, const DeformationMaps& maps, double diagonal) {
  refine_edges(mesh, kSideTriangles * diagonal, 400000);
  MeshDeformReport report;
  mesh = deform_mesh(std::move(mesh), InverseMap(maps.backward, kBoundaryShare * diagonal, maps.forward), {}, &report);
  if (report.undefined > 0 || report.turned > 0) return std::nullopt;
  return mesh;
}

ResampleOptions resample_options(const DeformArguments& a) {
  ResampleOptions options;
  for (const double n : a.size)
    require(n >= 1 && n <= 65536 && n == std::floor(n), "--size must be whole numbers from 1 to 65536");
  require(a.size.size() <= 1 || a.size.size() == 3, "--size is one number or three");
  if (!a.size.empty()) options.size.assign(a.size.begin(), a.size.end());
  options.box = a.mesh.box;
  if (a.nan) options.outside = std::numeric_limits<double>::quiet_NaN();
  options.validate();
  return options;
}

/// Resampled volumes, all arrays in one file.
void write_resampled(const DeformArguments& a, const std::string& file,
                     std::span<const std::shared_ptr<const VolumeField>> fields, std::span<const std::string> names,
                     const DeformationMaps& maps, const OpenDeformation& deformation, DeformResult& result,
                     Console& console) {
  ResampleOptions options = resample_options(a);
  GridBlock block;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const DeformedVolume field(fields[i], maps.backward, deformation.box_of(maps, fields[i]->bounds()), options.box);
    if (!options.box) options.box = field.bounds();
    GridBlock one = resample_volume(field, names[i], options, console.progress());
    if (i == 0) {
      block = std::move(one);
    } else {
      for (const Attribute& array : one.point_arrays)
        if (array.name == names[i]) block.point_arrays.set(array);
    }
  }
  console.progress().begin("write");
  write_volume(file, block);
  const auto* inside = block.point_arrays.find<std::uint8_t>("inside");
  const double share =
      inside ? static_cast<double>(std::count(inside->begin(), inside->end(), 1)) / static_cast<double>(inside->size())
             : 1;
  const std::vector<std::size_t> size{block.axes[0].size(), block.axes[1].size(), block.axes[2].size()};
  result.lines = {fmt::format("{} × {} × {} values, {:.1f} % in the volume", size[0], size[1], size[2], 100 * share)};
  result.output = {{"size", size}, {"inside", share}, {"arrays", std::vector<std::string>(names.begin(), names.end())}};
}

VolumePictureOptions picture_options(const DeformArguments& a) {
  VolumePictureOptions o;
  static_cast<RenderOptions&>(o) = deform_look(a);
  a.colors.put_into(o);
  for (const std::string& text : a.clips) o.cuts.push_back(volume_cut_of(text));
  o.shading = !a.no_shading;
  o.color_bar = !a.no_bar;
  o.steady = a.frames > 0;
  o.validate();
  return o;
}

}  // namespace

DeformResult deform_volume(const DeformArguments& a, const OpenDeformation& deformation, Console& console) {
  require(!a.bend, "--refine is for meshes");
  require(!a.to_section(), "sections are of functions: DATA[ARRAY=VALUE] is one of a volume");
  require(!a.all_arrays || a.input.array.empty(), "give --array or --all-arrays, not both");
  VolumePictureOptions look;
  if (a.to_picture())
    look = picture_options(a);
  else
    check_volume_writable(a.output), resample_options(a);
  require(!a.all_arrays || a.output.ends_with(".vti"), "--all-arrays needs a format of several arrays: -o FILE.vti");
  OpenVolume volume(a.input, console);
  Progress& progress = console.progress();
  const auto samples = volume.samples();
  std::vector<std::shared_ptr<const VolumeField>> fields;
  std::vector<std::string> names;
  if (a.all_arrays) {
    for (const DatasetArray& array : volume.dataset().arrays())
      if (volume.dataset().volume(array.name, progress) == samples) {
        fields.push_back(volume.field({array.name, {}, false}));
        names.push_back(array.name);
      }
  } else {
    fields.push_back(volume.field(a.to_picture() ? as_scalar(volume.choice(), volume) : volume.choice()));
    names.push_back(volume.array_name());
  }

  DeformResult result;
  FoldWatch folds;
  const Box3 before = fields[0]->bounds();
  std::vector<Vec3> framed;
  if (a.to_picture()) {
    if (!look.transfer) {
      const ValueHistogram values = value_histogram(*fields[0], kHistogramPoints, samples->positions);
      look.transfer = look.preset.empty() ? suggest_transfer_function(values, samples->lattice.has_value()).function
                                          : transfer_function_preset(look.preset, values);
      look.preset.clear();
    }
    if (look.color_title.empty()) look.color_title = names[0];
    if (!a.picture.has_view())
      if (const auto view = view_of_layer(samples->bounds(), look.up)) look.view = *view;
    if (a.frames > 0)
      for (const double share : {0.0, 0.5, 1.0})
        add_corners(deformation.box_of(deformation.at(share), before).value_or(before), framed);
  }
  for (int k = 0; k < a.poses(); ++k) {
    const DeformationMaps maps = deformation.at(a.share(k));
    result.files.push_back(a.file(k));
    const std::string& file = result.files.back();
    if (!a.to_picture()) {
      folds.look(*maps.backward, box_before(*maps.backward, before, deformation.box_of(maps, before)), progress);
      try {
        write_resampled(a, file, fields, names, maps, deformation, result, console);
      } catch (const DataError& error) {
        throw FileError(a.input.name(), error.what());
      }
      continue;
    }
    const Box3 box = box_before(*maps.backward, before, deformation.box_of(maps, before));
    const TriangleMesh folded = folds.look(*maps.backward, box, progress);
    std::shared_ptr<const SpaceMap> seen_by = maps.backward;
    if (!a.exact && a.deformation.map.empty()) {
      const Box3 wide = with_room(box, kRoom);
      const std::array<std::size_t, 3> sizes = lattice_sizes(wide, static_cast<std::size_t>(a.map_nodes));
      if (deformation.cuts().empty()) {
        seen_by = std::make_shared<const DisplacementMap>(displacement_map(*maps.backward, wide, sizes, progress));
      } else {
        seen_by = std::make_shared<const CutMap>(maps.backward, deformation.cuts(), wide, sizes, progress);
      }
    }
    const MapGaps gaps(seen_by, box);
    const bool torn = seen_by->has_gaps();
    const DeformedVolume field(fields[0], seen_by, {}, box);
    VolumeSubject subject;
    TriangleMesh boundary;
    VolumeSubject plain = volume_subject(*samples, boundary);
    progress.begin("boundary");
    std::optional<TriangleMesh> outside;
    if (torn) {
      subject.gap = &gaps;  // the outside is torn, too: the field says what is inside
    } else {
      outside = moved_boundary(plain.boundary ? std::move(boundary) : box_mesh(before), {seen_by, maps.forward},
                               before.diagonal());
    }
    if (outside) subject.boundary = &*outside;
    subject.image = plain.image;
    subject.field = &field;
    std::vector<Vec3> places;
    for (const Vec3f& v : outside ? outside->vertices : std::vector<Vec3f>{})
      places.push_back(outside->origin + Vec3(v));
    subject.places = places;
    std::vector<Vec3> framed_here = framed;
    if (framed.empty() && torn) add_corners(deformation.box_of(maps, before).value_or(box), framed_here);
    subject.framed = framed_here;
    if (a.draw_folds && !folded.triangles.empty())
      subject.surfaces.push_back(surface_in_picture(folded, deform_look(a)));
    if (a.draw_handles && deformation.has_handles())
      subject.surfaces.push_back(surface_in_picture(deformation.shapes(a.share(k), before.diagonal()), deform_look(a)));
    const VolumePicture picture(std::move(subject), progress);
    VolumePictureReport report;
    a.picture.write(file, picture.render(look, progress, &report), look);
    if (!outside && !torn)
      report.notes.emplace_back("the outside of the volume is folded or torn: its sides are drawn a step at a time");
    console.warn(a.input.name(), report.notes);
    result.output = {{"rays", report.rays}, {"evaluations", report.evaluations}};
  }
  volume.say_method();
  result.input = volume.json();
  folds.report(a.input.name(), result, console);
  return result;
}

}  // namespace sansmesh::cli
