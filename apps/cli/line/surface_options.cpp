#include "cli/line/surface_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "cli/line/command_line.h"
#include "cli/line/schema_options.h"
#include "sansmesh/error.h"
#include "sansmesh/schema/registry_words.h"

namespace sansmesh::cli {

std::optional<SurfaceOptions> SurfaceArguments::chosen() const {
  if (!method) {
    std::string given;
    for (const std::string_view option : options_set(options))
      given += (given.empty() ? "`" : ", `") + std::string(option) + "`";
    if (!given.empty())
      throw ArgumentError(given + (given.find(',') == std::string::npos ? " needs" : " need") + " --surface NAME");
    return std::nullopt;
  }
  SurfaceOptions o = options;
  o.method = *method;
  o.validate();
  return o;
}

namespace {

/// "amls: " for an option that one or two surfaces use.
std::string users_of(std::string_view option) {
  const std::string users = surfaces_that_use(option);
  return std::count(users.begin(), users.end(), ',') < 2 ? users + ": " : "";
}

}  // namespace

void add_surface_details(CommandLine& c, SurfaceOptions& options, CloudPreparation& cloud) {
  std::vector<std::string_view> without{"method"};
  // reconstruct also has them for the partition.
  if (c.has("--depth")) without.insert(without.end(), {"error", "depth", "smooth"});
  add_schema(c, options, {.group = "Surface", .without = without, .before = users_of});
  add_schema(c, cloud, {.group = "Surface", .only = {"remove_outliers"}});
}

namespace {

/// Adds --surface for a text or an optional text.
template <class Name>
void add_surface_name(CommandLine& c, Name& name, const std::string& what, const std::string& usual) {
  const std::vector<std::string_view>& names = registry_names<SurfaceMethod>();
  c.add_option("--surface", name, what + ": " + SurfaceMethod::registry().names() + usual)
      .one_of({names.begin(), names.end()})
      .type_name("NAME")
      .group("Surface");
}

}  // namespace

void add_surface(CommandLine& c, SurfaceOptions& surface, CloudPreparation& cloud, const std::string& what) {
  add_surface_name(c, surface.method, what, " [" + surface.method + "]");
  add_surface_details(c, surface, cloud);
}

void add_surface(CommandLine& c, SurfaceArguments& a, CloudPreparation& cloud, const std::string& what) {
  add_surface_name(c, a.method, what, "");
  add_surface_details(c, a.options, cloud);
}

std::string surface_list() {
  std::string text = "\n\nSurfaces:";
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all())
    text += fmt::format("\n  {:<12}{}", method->name, method->summary);
  return text;
}

}  // namespace sansmesh::cli
