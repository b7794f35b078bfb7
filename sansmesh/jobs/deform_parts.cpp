#include "sansmesh/jobs/deform_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/folds.h"
#include "sansmesh/deform/handle_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFoldPoints = 33;  // along the longest side
constexpr double kFlatBox = 1e-3;        // of the diagonal

}  // namespace

TriangleMesh FoldWatch::look(const SpaceMap& map, const Box3& box, Progress& progress) {
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper)) return {};
  Box3 wide = box;
  const double least = std::max(kFlatBox * box.diagonal(), std::numeric_limits<double>::min());
  for (std::size_t k = 0; k < 3; ++k)  // of what is flat, too
    if (wide.upper[k] - wide.lower[k] < least) wide.lower[k] -= least, wide.upper[k] += least;
  FoldReport found = find_folds(map, wide, lattice_sizes(wide, kFoldPoints), progress);
  TriangleMesh shapes = fold_shapes(found);
  if (found.share > worst_.share) worst_ = std::move(found);
  return shapes;
}

void FoldWatch::add_note(const std::string& name, std::vector<Note>& notes) const {
  if (worst_.folds.empty()) return;
  const Vec3& center = worst_.folds[0].center;
  notes.push_back(
      {.code = "folded",
       .text = fmt::format("space is folded on {:.2g} % of what was looked at, in {}, the largest about "
                           "({:.4g}, {:.4g}, {:.4g}): handles move across each other there",
                           100 * worst_.share, counted(worst_.folds.size(), "place"), center.x, center.y, center.z),
       .remedy = "move them less, or in several steps, or take a smaller `alpha`",
       .of = name});
}

Box3 with_room(const Box3& box, double share) {
  const Vec3 room = Vec3{1, 1, 1} * (share * box.diagonal());
  return {box.lower - room, box.upper + room};
}

void add_corners(const Box3& box, std::vector<Vec3>& places) {
  for (int c = 0; c < 8; ++c)
    places.push_back(
        {(c & 1 ? box.upper : box.lower).x, (c & 2 ? box.upper : box.lower).y, (c & 4 ? box.upper : box.lower).z});
}

void add_vertices(const TriangleMesh& mesh, std::vector<Vec3>& places) {
  for (const Vec3f& v : mesh.vertices)
    if (is_finite(v)) places.push_back(mesh.origin + Vec3(v));
}

std::vector<Vec3> places_of_poses(const Deformation& deformation, const Box3& before, const DeformOptions& options,
                                  bool unknown_as_before) {
  std::vector<Vec3> places;
  if (!options.frames) return places;
  for (const double share : {0.0, 0.5, 1.0})
    if (const auto box = deformation.box_of(deformation.at(share), before))
      add_corners(*box, places);
    else if (unknown_as_before)
      add_corners(before, places);
  return places;
}

Image picture_of_pose(std::vector<PictureSurface> surfaces, const DeformOptions& options,
                      const Deformation& deformation, double share, std::vector<Vec3> places, const TriangleMesh& folds,
                      Progress& progress) {
  RenderOptions picture = options.look.picture;
  picture.view.steady = options.frames.has_value();
  if (options.draw_handles && deformation.has_handles()) {
    Box3 box;
    for (const Vec3& p : places) box.extend(p);
    const TriangleMesh shapes = deformation.handle_shapes_at(share, box.diagonal());
    Box3 of_handles;
    std::vector<Vec3> vertices;
    add_vertices(shapes, vertices);
    for (const Vec3& p : vertices) of_handles.extend(p);
    add_corners(of_handles, places);
    surfaces.push_back(surface_in_picture(shapes, picture));
  }
  if (options.draw_folds && !folds.triangles.empty()) surfaces.push_back(surface_in_picture(folds, picture));
  return render_surfaces(surfaces, places, false, picture, progress);
}

}  // namespace sansmesh::inline v1
