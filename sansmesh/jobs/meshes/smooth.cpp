#include "sansmesh/mesh/edit/smooth_mesh.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "sansmesh/core/number_words.h"

namespace sansmesh::inline v1 {
namespace {

/// Share of the diagonal above which a move is not noise.
constexpr double kFarMove = 0.01;

}  // namespace

SmoothResult smooth(TriangleMesh mesh, const SmoothOptions& options, Progress& progress) {
  SmoothResult result;
  result.mesh = std::move(mesh);
  const SmoothReport& r = result.report = smooth_mesh(result.mesh, options, progress);
  if (r.shortened)
    result.notes.push_back(
        {.code = "shortened",
         .text = fmt::format("waves of {} are too long for {} rounds: its edges are {} long on average",
                             length_words(*options.shorter_than), grouped(static_cast<std::size_t>(r.iterations)),
                             length_words(r.mean_edge))});
  const double diagonal = bounds(result.mesh).diagonal();
  if (diagonal > 0 && r.rms_move > kFarMove * diagonal)
    result.notes.push_back(
        {.code = "moved_far",
         .text =
             fmt::format("moved by {:.1f} % of the diagonal, at most by {:.1f} %: with edges of {}, smoothing removes "
                         "shape as well",
                         100 * r.rms_move / diagonal, 100 * r.largest_move / diagonal, length_words(r.mean_edge)),
         .remedy = options.creases ? "" : "`iterations = 2`, `creases`, or more triangles"});
  return result;
}

std::vector<std::string> summary_of(const SmoothReport& r) {
  const auto change = [](double before, double after) { return 100 * (after - before) / std::abs(before); };
  std::string size = fmt::format("area {:+.3f} %", change(r.area_before, r.area_after));
  if (r.volume_before && r.volume_after)
    size += fmt::format(", volume {:+.3f} %", change(std::abs(*r.volume_before), std::abs(*r.volume_after)));
  const std::string kept = r.crease_angle > 0 ? fmt::format(", creases of more than {:.0f}° kept", r.crease_angle) : "";
  return {fmt::format("{} vertices, edges {} long on average", grouped(r.vertices), length_words(r.mean_edge)),
          fmt::format("moved by {} (root mean square), at most {}; {} at borders and nonmanifold edges did not move",
                      length_words(r.rms_move), length_words(r.largest_move), grouped(r.fixed)),
          std::move(size), counted(static_cast<std::size_t>(r.iterations), "round") + kept};
}

}  // namespace sansmesh::inline v1
