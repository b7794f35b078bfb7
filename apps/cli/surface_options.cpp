#include "surface_options.h"

#include <CLI/CLI.hpp>

#include "sansmesh/core/error.h"
#include "sansmesh/core/names.h"

namespace sansmesh::cli {

SurfaceOptions SurfaceArguments::details() const {
  SurfaceOptions o = options;
  o.separate_sheets = !no_sheets;
  return o;
}

std::optional<SurfaceOptions> SurfaceArguments::chosen() const {
  const SurfaceOptions none;
  SurfaceOptions o = details();
  if (!name.empty()) {
    o.method = name;
    if (o.method == "partition" && o.sharp)
      throw ArgumentError("--sharp is for other surfaces than partition, which finds creases by itself");
    o.validate();
    return o;
  }
  if (o.smoothing || o.width || o.order || o.iterations || o.diffusion != none.diffusion || no_sheets || o.sharp)
    throw ArgumentError(
        "--sharp, --smoothing, --bandwidth, --order, --iterations, --diffusion and --no-sheets need --surface NAME");
  return std::nullopt;
}

void add_surface_details(CLI::App& c, SurfaceArguments& a) {
  SurfaceOptions& o = a.options;
  c.add_flag("--sharp", o.sharp, "Edges and corners: normals that turn sharply (bilateral)")->group("Surface");
  c.add_option("--smoothing", o.smoothing, "Width of the weights over the spacing of the samples, 0.5..20 [from data]")
      ->type_name("RATIO")
      ->group("Surface");
  c.add_option("--bandwidth", o.width, "Width of the weights as one length, in place of --smoothing")
      ->type_name("LENGTH")
      ->group("Surface");
  c.add_option("--order", o.order, "amls: order of the approximation, 2, 4 or 6 [from data]")
      ->type_name("ORDER")
      ->group("Surface");
  c.add_option("--iterations", o.iterations, "amls: 0 smooths most, many interpolate [from data]")
      ->type_name("COUNT")
      ->group("Surface");
  c.add_option("--diffusion", o.diffusion, "curvature: how much less samples far off count: none, soft or hard [none]")
      ->type_name("CHOICE")
      ->group("Surface");
  c.add_flag("--no-sheets", a.no_sheets, "Samples on the other side of a thin part count too")->group("Surface");
  c.add_flag("--remove-outliers", o.remove_outliers, "Leave out samples that belong to no surface, such as strays")
      ->group("Surface");
}

void add_surface(CLI::App& c, SurfaceArguments& a, const std::string& what) {
  c.add_option("--surface", a.name, what + ": " + listed(surface_names()))->type_name("NAME")->group("Surface");
  add_surface_details(c, a);
}

}  // namespace sansmesh::cli
