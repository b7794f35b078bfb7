#include "sansmesh/jobs/deform/deform_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/deform/handles/handle_shapes.h"
#include "sansmesh/deform/maps/box_lattice.h"
#include "sansmesh/deform/maps/folds.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFoldPoints = 33;  // lattice points along the longest side
constexpr double kFlatBox = 1e-3;        // least thickness as a share of the diagonal

}  // namespace

TriangleMesh FoldWatch::look(const SpaceMap& map, const Box3& box, Progress& progress) {
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper)) return {};
  Box3 wide = box;
  const double least = std::max(kFlatBox * box.diagonal(), std::numeric_limits<double>::min());
  for (std::size_t k = 0; k < 3; ++k)  // flat boxes have a thickness too
    if (wide.upper[k] - wide.lower[k] < least) wide.lower[k] -= least, wide.upper[k] += least;
  FoldReport found = find_folds(map, wide, lattice_sizes(wide, kFoldPoints), progress);
  TriangleMesh shapes = fold_shapes(found);
  if (found.share > worst_.share) worst_ = std::move(found);
  return shapes;
}

void FoldWatch::add_note(const std::string& name, std::vector<Note>& notes) const {
  if (worst_.folds.empty()) return;
  notes.push_back({.code = "folded",
                   .text = fmt::format("space folds in {:.2g} % of the box, in {}, the largest at about "
                                       "{}: handles move across each other there",
                                       100 * worst_.share, counted(worst_.folds.size(), "place"),
                                       point_words(worst_.folds[0].center, 4)),
                   .remedy = "move them less, or in several steps, or take a smaller `alpha`",
                   .of = name});
}

void add_corners(const Box3& box, std::vector<Vec3>& points) {
  for (int c = 0; c < 8; ++c) points.push_back(box_corner(box, c));
}

std::vector<Vec3> points_of_poses(const Deformation& deformation, const Box3& before, const DeformOptions& options,
                                  bool unknown_as_before) {
  std::vector<Vec3> framed;
  if (!options.frames) return framed;
  for (const double share : {0.0, 0.5, 1.0})
    if (const auto box = deformation.box_of(deformation.at(share), before))
      add_corners(*box, framed);
    else if (unknown_as_before)
      add_corners(before, framed);
  return framed;
}

Image picture_of_pose(std::vector<SceneFactory> surfaces, const DeformOptions& options, const Deformation& deformation,
                      double share, std::vector<Vec3> framed, const TriangleMesh& folds, Progress& progress) {
  RenderOptions picture = options.look.picture;
  picture.view.steady = options.frames.has_value();
  if (options.draw_handles && deformation.has_handles()) {
    Box3 box;
    for (const Vec3& p : framed) box.extend(p);
    const TriangleMesh shapes = deformation.handle_shapes_at(share, box.diagonal());
    add_corners(finite_bounds(shapes.origin, shapes.vertices), framed);
    surfaces.push_back(scene_factory(shapes, picture));
  }
  if (options.draw_folds && !folds.triangles.empty()) surfaces.push_back(scene_factory(folds, picture));
  return render_surfaces(surfaces, framed, false, picture, progress);
}

}  // namespace sansmesh::inline v1
