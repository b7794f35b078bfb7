#include "surface_options.h"

#include <fmt/core.h>

#include <vector>

#include "command_line.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"

namespace sansmesh::cli {

std::string flag_of(SurfaceOption option) {
  if (option == SurfaceOption::separate_sheets) return "--no-sheets";
  if (option == SurfaceOption::max_depth) return "--depth";
  return std::string("--") + field_name(option);
}

namespace {

/// Of all options of surfaces that are given by flags of surfaces, what the tool calls them.
std::string flags(const SurfaceOptions& given) {
  std::string text;
  for (std::size_t i = 0; i < kSurfaceOptions; ++i) {
    const auto option = static_cast<SurfaceOption>(i);
    if (given.is_set(option)) text += (text.empty() ? "" : ", ") + flag_of(option);
  }
  return text;
}

}  // namespace

std::optional<SurfaceOptions> SurfaceArguments::chosen() const {
  if (!method) {
    if (const std::string given = flags(options); !given.empty())
      throw ArgumentError(given + (given.find(',') == std::string::npos ? " needs" : " need") + " --surface NAME");
    return std::nullopt;
  }
  SurfaceOptions o = options;
  o.method = *method;
  o.validate();
  return o;
}

void add_surface_details(CommandLine& c, SurfaceArguments& a, CloudUse& cloud) {
  using Diffusion = SurfaceOptions::Diffusion;
  using Flow = SurfaceOptions::Flow;
  using Normal = SurfaceOptions::Normal;
  using Plane = SurfaceOptions::Plane;
  using Polynomial = SurfaceOptions::Polynomial;
  using SharpFormula = SurfaceOptions::SharpFormula;
  SurfaceOptions& o = a.options;
  const auto of = [](SurfaceOption option) { return heeded_by(option) + ": "; };
  c.add_option_function(
       "--sharp",
       [&o](const std::string& weights) {
         o.sharp = true;
         o.sharp_formula = weights == "laguerre" ? SharpFormula::laguerre : SharpFormula::bilateral;
       },
       "Edges and corners: normals that turn sharply, with bilateral or laguerre weights [without a word: bilateral]")
      .one_of({"bilateral", "laguerre"})
      .without_value("bilateral")
      .type_name("WEIGHTS")
      .group("Surface");
  c.add_option("--smoothing", o.smoothing, "Width of the weights over the spacing of the samples, 0.5..20 [from data]")
      .type_name("RATIO")
      .group("Surface");
  c.add_option("--bandwidth", o.bandwidth, "Width of the weights as one length, in place of --smoothing")
      .type_name("LENGTH")
      .group("Surface");
  c.add_choice<SurfaceWeights>(
       "--weights", o.weights, {{"compact", SurfaceWeights::compact}, {"gaussian", SurfaceWeights::gaussian}},
       "compact: as wide as the spacing asks for; gaussian: exp(-d^2/h^2) with one h for the cloud [compact]")
      .type_name("CHOICE")
      .group("Surface");
  c.add_option("--order", o.order, of(SurfaceOption::order) + "order of the approximation, 2, 4 or 6 [from data]")
      .type_name("ORDER")
      .group("Surface");
  c.add_option("--iterations", o.iterations,
               of(SurfaceOption::iterations) + "0 smooths most, many interpolate [from data]")
      .type_name("COUNT")
      .group("Surface");
  c.add_option("--epsilon", o.epsilon, of(SurfaceOption::epsilon) + "shape parameter beside the width, 0.05..20 [1]")
      .type_name("NUMBER")
      .group("Surface");
  c.add_choice<Normal>("--normal", o.normal, {{"covariance", Normal::covariance}, {"iterated", Normal::iterated}},
                       "adamson: covariance, the direction of least weighted covariance [mean normal]; amls: iterated, "
                       "the normals approximated as the values are [gradient]")
      .type_name("CHOICE")
      .group("Surface");
  c.add_choice<Plane>("--plane", o.plane, {{"iterated", Plane::iterated}, {"nonlinear", Plane::nonlinear}},
                      of(SurfaceOption::plane) +
                          "the plane by weights about its own foot, six times, or by nonlinear "
                          "minimisation [iterated]")
      .type_name("CHOICE")
      .group("Surface");
  c.add_choice<Polynomial>("--polynomial", o.polynomial,
                           {{"1", Polynomial::linear},
                            {"2", Polynomial::quadratic},
                            {"3", Polynomial::cubic},
                            {"4", Polynomial::quartic},
                            {"incomplete", Polynomial::incomplete}},
                           of(SurfaceOption::polynomial) + "degree over the plane, or incomplete: x^2, y^2, xy, 1 [2]")
      .type_name("DEGREE")
      .group("Surface");
  c.add_choice<Flow>("--flow", o.flow, {{"fit", Flow::fit}, {"normal", Flow::normal}, {"free", Flow::free}},
                     of(SurfaceOption::flow) +
                         "onto the surface by the fit, or by diffusion to its fixed point, along "
                         "the normal or free, which is slow and has no picture [fit]")
      .type_name("CHOICE")
      .group("Surface");
  c.add_choice<Diffusion>(
       "--diffusion", o.diffusion, {{"none", Diffusion::none}, {"soft", Diffusion::soft}, {"hard", Diffusion::hard}},
       of(SurfaceOption::diffusion) + "how much less samples far off count: none, soft or hard [none]")
      .type_name("CHOICE")
      .group("Surface");
  c.add_option("--threshold", o.threshold,
               of(SurfaceOption::threshold) + "curvature from which --diffusion acts, over that of the width [1]")
      .type_name("NUMBER")
      .group("Surface");
  c.add_option("--tau", o.tau, of(SurfaceOption::tau) + "exponent of the M-like weights, 1..3 [2]")
      .type_name("EXPONENT")
      .group("Surface");
  c.add_flag_callback(
       "--no-sheets", [&o] { o.separate_sheets = false; }, "Samples on the other side of a thin part count too")
      .group("Surface");
  // reconstruct has them for the partition as well.
  if (!c.has("--depth")) {
    c.add_option("--error", o.error,
                 of(SurfaceOption::error) + "accepted distance of samples from the shape of their cell [from data]")
        .type_name("LENGTH")
        .group("Surface");
    c.add_option("--depth", o.max_depth,
                 of(SurfaceOption::max_depth) + "deepest level of the octree, " + depth_range() + " [14]")
        .type_name("LEVEL")
        .group("Surface");
    c.add_flag("--smooth", o.smooth, of(SurfaceOption::smooth) + "do not look for edges and corners").group("Surface");
  }
  c.add_flag("--remove-outliers", cloud.remove_outliers, "Leave out samples that belong to no surface, such as strays")
      .group("Surface");
}

void add_surface(CommandLine& c, SurfaceArguments& a, CloudUse& cloud, const std::string& what) {
  std::vector<std::pair<std::string, SurfaceMethod>> names;
  for (const SurfaceMethodInfo& info : surface_methods()) names.emplace_back(info.name, info.method);
  c.add_choice("--surface", a.method, names, what + ": " + surface_method_names()).type_name("NAME").group("Surface");
  add_surface_details(c, a, cloud);
}

std::string surface_list() {
  std::string text = "\n\nSurfaces:";
  for (const SurfaceMethodInfo& info : surface_methods()) text += fmt::format("\n  {:<12}{}", info.name, info.summary);
  return text;
}

}  // namespace sansmesh::cli
