// sansmesh volume probe: values and gradients of a volume at points.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/point_table.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

/// So many points are printed as well.
constexpr std::size_t kPrintedProbes = 20;

struct ProbeArguments {
  VolumeInput input;
  std::string points, output;
  std::vector<double> at;
};

/// Names of the array's numbers: itself, or NAME_0, NAME_1, …
std::vector<std::string> names_of(const std::string& array, std::size_t components) {
  if (components == 1) return {array};
  std::vector<std::string> names;
  names.reserve(components);
  for (std::size_t c = 0; c < components; ++c) names.push_back(fmt::format("{}_{}", array, c));
  return names;
}

/// A name as a field of a table: quoted where it has to be.
std::string csv_name(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string table_of(const std::vector<std::string>& names, const std::vector<Vec3>& x, const std::vector<double>& v,
                     const std::vector<Vec3>& g, const std::vector<std::uint8_t>& inside) {
  std::string text = "x,y,z";
  for (const std::string& name : names)
    text += fmt::format(",{},{},{},{}", csv_name(name), csv_name(name + "_dx"), csv_name(name + "_dy"),
                        csv_name(name + "_dz"));
  text += ",inside\n";
  const std::size_t n = names.size();
  for (std::size_t i = 0; i < x.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{},{},{}", x[i].x, x[i].y, x[i].z);
    for (std::size_t c = 0; c < n; ++c) {
      const Vec3& d = g[i * n + c];
      fmt::format_to(std::back_inserter(text), ",{},{},{},{}", v[i * n + c], d.x, d.y, d.z);
    }
    fmt::format_to(std::back_inserter(text), ",{}\n", inside[i]);
  }
  return text;
}

void run_probe(const ProbeArguments& a, Console& console) {
  if (a.points.empty() == a.at.empty()) throw ArgumentError("where? Give either --points FILE or --at x,y,z");
  if (!a.output.empty()) {
    if (!a.output.ends_with(".csv")) throw FileError(a.output, "tables are written as .csv");
    check_writable(a.output, "text");
  }
  const std::vector<Vec3> x = a.points.empty() ? places_at(a.at) : read_point_table(a.points);
  require(!a.output.empty() || x.size() <= kPrintedProbes || console.options().json,
          "so many points need a table to write: -o FILE.csv");
  OpenVolume volume(a.input, console);
  const auto field = volume.field();
  console.progress().begin("probe");
  const std::size_t n = x.size(), components = field->components();
  std::vector<double> values(n * components);
  std::vector<Vec3> gradients(n * components);
  std::vector<std::uint8_t> inside(n);
  field->evaluate(x, {values, gradients, inside, {}});
  const std::vector<std::string> names = names_of(volume.array_name(), components);
  if (!a.output.empty()) {
    console.progress().begin("write");
    write_text(a.output, table_of(names, x, values, gradients, inside));
  }
  console.progress().finish();

  const auto within = static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
  volume.say_method();
  console.say(fmt::format("{}: {}, {} in the volume", a.input.name(), counted(n, "point"), grouped(within)));
  Json json = {{"input", volume.json()}, {"points", n}, {"inside", within}};
  if (n <= kPrintedProbes) {
    json["values"] = Json::array();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < components; ++c) {
        const Vec3& g = gradients[i * components + c];
        const double v = values[i * components + c];
        console.say(fmt::format("({:.8g}, {:.8g}, {:.8g})  {} {:.8g}  gradient ({:.6g}, {:.6g}, {:.6g}){}", x[i].x,
                                x[i].y, x[i].z, names[c], v, g.x, g.y, g.z, inside[i] ? "" : "  outside"));
        json["values"].push_back({{"at", {x[i].x, x[i].y, x[i].z}},
                                  {"name", names[c]},
                                  {"value", v},
                                  {"gradient", {g.x, g.y, g.z}},
                                  {"inside", inside[i] != 0}});
      }
  }
  if (!a.output.empty()) {
    console.say(fmt::format("{}: {}", a.output, counted(n, "row")));
    json["output"] = {{"file", a.output}};
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_volume_probe(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("probe", "Values and gradients of a volume at points");
  auto a = std::make_shared<ProbeArguments>();
  add_volume_input(c, a->input);
  c.add_option("--points", a->points, "Where: a table with columns x, y, z, or any file of points").type_name("FILE");
  c.add_option("--at", a->at, "Where: at this place, x,y,z; may be repeated").numbers(3).repeated().type_name("POINT");
  c.add_option("-o,--output", a->output, "Table to write (.csv): x,y,z,NAME,NAME_dx,NAME_dy,NAME_dz,inside")
      .type_name("FILE");
  c.footer(std::string(kReadableVolumes) +
           "\n\nOne row a point, in their order. Outside of the volume `inside` is 0; values there go on from its "
           "boundary.\n\nExamples:\n"
           "  sansmesh volume probe fire.vtu --array t --at 0.5,0.5,0.5\n"
           "  sansmesh volume probe post.bin --points where.csv --array Density -o density.csv");
  return {&c, [a](Console& console) { run_probe(*a, console); }};
}

}  // namespace sansmesh::cli
