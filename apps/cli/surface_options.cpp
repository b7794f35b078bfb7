#include "surface_options.h"

#include <fmt/core.h>

#include <vector>

#include "command_line.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"

namespace sansmesh::cli {
namespace {

/// Of all options of surfaces, what the tool calls them.
std::string flags() {
  std::string text;
  for (std::size_t i = 0; i < kSurfaceOptions; ++i) {
    const auto option = static_cast<SurfaceOption>(i);
    const std::string flag =
        option == SurfaceOption::separate_sheets ? "--no-sheets" : std::string("--") + field_name(option);
    text += (i == 0 ? "" : i + 1 == kSurfaceOptions ? " and " : ", ") + flag;
  }
  return text;
}

}  // namespace

std::optional<SurfaceOptions> SurfaceArguments::chosen() const {
  if (!method) {
    for (std::size_t i = 0; i < kSurfaceOptions; ++i)
      if (options.is_set(static_cast<SurfaceOption>(i))) throw ArgumentError(flags() + " need --surface NAME");
    return std::nullopt;
  }
  SurfaceOptions o = options;
  o.method = *method;
  o.validate();
  return o;
}

void add_surface_details(CommandLine& c, SurfaceArguments& a, CloudUse& cloud) {
  using Diffusion = SurfaceOptions::Diffusion;
  SurfaceOptions& o = a.options;
  const auto of = [](SurfaceOption option) { return heeded_by(option) + ": "; };
  c.add_flag("--sharp", o.sharp, "Edges and corners: normals that turn sharply (bilateral)").group("Surface");
  c.add_option("--smoothing", o.smoothing, "Width of the weights over the spacing of the samples, 0.5..20 [from data]")
      .type_name("RATIO")
      .group("Surface");
  c.add_option("--bandwidth", o.bandwidth, "Width of the weights as one length, in place of --smoothing")
      .type_name("LENGTH")
      .group("Surface");
  c.add_option("--order", o.order, of(SurfaceOption::order) + "order of the approximation, 2, 4 or 6 [from data]")
      .type_name("ORDER")
      .group("Surface");
  c.add_option("--iterations", o.iterations,
               of(SurfaceOption::iterations) + "0 smooths most, many interpolate [from data]")
      .type_name("COUNT")
      .group("Surface");
  c.add_choice<Diffusion>(
       "--diffusion", o.diffusion, {{"none", Diffusion::none}, {"soft", Diffusion::soft}, {"hard", Diffusion::hard}},
       of(SurfaceOption::diffusion) + "how much less samples far off count: none, soft or hard [none]")
      .type_name("CHOICE")
      .group("Surface");
  c.add_flag_callback(
       "--no-sheets", [&o] { o.separate_sheets = false; }, "Samples on the other side of a thin part count too")
      .group("Surface");
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
