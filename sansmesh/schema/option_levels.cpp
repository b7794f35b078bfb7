#include "sansmesh/schema/option_levels.h"

#include <algorithm>
#include <span>

namespace sansmesh::inline v1 {
namespace {

/// Names of options, separated by blanks.
struct OptionsOfJob {
  std::string_view job, options;
};

/// Basic options of jobs with more than twenty options besides view options. Other jobs show all.
constexpr OptionsOfJob kFirst[] = {
    {"reconstruct",
     "output preview class components open closed fill-holes trim faces normals orient-by align mesh-error triangles "
     "no-colors confidence surface sharp ascii remove-outliers"},
    {"render",
     "output as-one class color opacity name color-by color-range no-bar unit surface sharp splats quick frames "
     "wireframe lines accessibility background flat"},
    {"project",
     "output onto method point-count class without-class smoothing bandwidth weights sharp remove-outliers radius "
     "repulsion lop-steps most-steps tolerance ascii"},
    {"mesh",
     "output preview box components fill-holes trim confidence no-confidence quality mesh-error triangles no-enhance "
     "no-colors block-depth wireframe ascii"},
    {"compare",
     "output preview align from find-scale within color-range max-distance skip-border on refine histogram class "
     "without-class unit wireframe ascii"},
    {"deform",
     "output handles handles-from handle-count vertices map kind alpha frames cut refine resolution cell plane array "
     "size preset iso draw-handles draw-folds"},
    {"simulate",
     "output animation forces energies embedded-mesh fixed model stiffness young poisson damping density unit duration "
     "fps frames embedded-volume preset background ascii"},
    {"convert",
     "output class transform translate center rotate scale up unit to-unit box point-spacing point-count keep "
     "drop weld flip split tile-size ascii"},
    {"volume fit", "output array all-arrays method degree radius time-step fill-value dims type spacing"},
    {"volume probe", "output at points array method degree radius time-step fill-value dims type spacing"},
    {"volume resample",
     "output size box gradients outside nan array method degree radius time-step fill-value dims type spacing"},
    {"volume smooth", "output array all-arrays deviations smoothing time-step fill-value dims type spacing"},
    {"volume isosurface",
     "output preview value array method closed carry components mesh-error triangles no-enhance cell unsteady frames "
     "times time-step fill-value dims type ascii"},
    {"volume render",
     "output array method preset opacity-factor iso transfer clip opacity-by quick mesh points axes label unit "
     "no-bar title background frames time-step"},
    {"volume surface",
     "output points-output point-spacing value high-gradient array method color-by color-range sharp quick smoothing "
     "least-gradient components mesh-error triangles background frames no-bar ascii"},
    {"flow lines",
     "output preview seeds kind direction duration length start interval unsteady times array carry color-by "
     "tube-radius background integrator step-length tolerance ascii"},
    {"flow surface",
     "output preview seeds kind particles direction duration length start sweep unsteady times array alpha integrator "
     "step-length tolerance wireframe ascii"},
    {"flow render",
     "output seeds kind particles duration length unsteady array color-by no-streaks streak-length opacity arrows "
     "frames turn volume-array preset iso mesh background"}};

/// Options that select variants of the published methods, for comparisons.
constexpr std::string_view kOfProjections = "normal reference-plane polynomial flow diffusion diffusion-threshold tau";
constexpr std::string_view kOfReconstructions =
    "spherical no-spherical robust no-robust interpolate no-interpolate b c";
constexpr OptionsOfJob kOfSources[] = {
    {"reconstruct", "fit threshold coverage mesher displacement"},
    {"fit", "fit threshold coverage"},
    {"mesh", "mesher displacement"},
    {"render", "rays"},
    {"curvature", "tau"},
    {"volume surface", "global-maximum all-sheets predictor-only corrector-only alternating line-search"},
    {"flow surface", "interpolated"},
    {"flow render", "interpolated splats"}};

std::string_view found(std::span<const OptionsOfJob> table, std::string_view job) {
  for (const OptionsOfJob& entry : table)
    if (entry.job == job) return entry.options;
  return {};
}

std::vector<std::string_view> words_in(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

}  // namespace

std::vector<std::string_view> basic_options(std::string_view job) { return words_in(found(kFirst, job)); }

std::vector<std::string_view> source_options(std::string_view job, bool has_surface) {
  std::vector<std::string_view> options = words_in(found(kOfSources, job));
  const auto add = [&](std::string_view more) {
    for (const std::string_view word : words_in(more)) options.push_back(word);
  };
  if (has_surface || job == "project") add(kOfProjections);
  if (job.starts_with("volume ") || job.starts_with("flow ")) add(kOfReconstructions);
  return options;
}

}  // namespace sansmesh::inline v1
