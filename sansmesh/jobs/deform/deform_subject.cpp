// Objects that can be deformed.
#include <algorithm>
#include <filesystem>
#include <system_error>

#include "sansmesh/convert.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/deform.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/io/grids/write_volume.h"
#include "sansmesh/surface_function.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

DeformAim deform_aim(const std::string& file) {
  if (file.ends_with(".png")) return DeformAim::picture;
  return file.ends_with(".svg") || file.ends_with(".csv") ? DeformAim::sections : DeformAim::shape;
}

DeformKind deform_kind(const std::vector<std::string>& names) {
  if (names.size() == 1) {
    const std::string& name = names[0];
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored)) {
      if (parse_isosurface_name(name) || name.find_first_of("()|&~+ ") != std::string::npos) return DeformKind::solid;
      throw FileError(name, "does not exist");
    }
    if (is_function_file(name)) return DeformKind::solid;
  }
  return std::all_of(names.begin(), names.end(), is_volume_name) ? DeformKind::volume : DeformKind::points;
}

void check_deformed(const std::string& file, DeformKind kind) {
  const DeformAim aim = deform_aim(file);
  if (aim != DeformAim::shape) return check_writable(file, aim == DeformAim::picture ? "image" : "text");
  if (kind == DeformKind::volume) return check_volume_writable(file);
  if (kind == DeformKind::solid) return check_writable(file, "mesh");
  check_converted(file, false);
}

Box3 bounds_of(const PointSet& points) { return finite_bounds(points.origin, points.positions); }

Box3 bounds_of(const DeformSubject& subject) {
  if (const auto* const points = std::get_if<PointSet>(&subject)) return bounds_of(*points);
  if (const auto* const solid = std::get_if<SolidModel>(&subject)) return solid->bounds();
  return std::get<DeformableVolume>(subject).samples->bounds();
}

DeformResult deform(const DeformSubject& subject, const std::string& name, const Deformation& deformation,
                    DeformAim aim, const DeformOptions& options, const UsePose& use, Progress& progress) {
  if (const auto* const points = std::get_if<PointSet>(&subject))
    return deform(*points, name, deformation, aim, options, use, progress);
  if (const auto* const solid = std::get_if<SolidModel>(&subject))
    return deform(*solid, deformation, aim, options, use, progress);
  return deform(std::get<DeformableVolume>(subject), deformation, aim, options, use, progress);
}

}  // namespace sansmesh::inline v1
