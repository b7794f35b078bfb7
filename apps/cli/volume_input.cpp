#include "volume_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "command_line.h"
#include "sansmesh/core/error.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

/// Errors of the data, which begin with the name, as those of its files.
template <class Call>
auto of_file(const VolumeModel& volume, Console& console, Call call) {
  try {
    return call();
  } catch (const DataError& error) {
    const std::string text = error.what(), name = printable(volume.name(), 200) + ": ";
    throw FileError(volume.name(), console.in_flags(text.starts_with(name) ? text.substr(name.size()) : text));
  }
}

}  // namespace

Json VolumeInput::json() const { return files.size() == 1 ? Json{{"file", files[0]}} : Json{{"files", files}}; }

VolumeModel VolumeInput::open(Console& console) const {
  VolumeModel volume = open_volume(files, *this, console.progress());
  console.note(volume.name(), volume.notes());
  return volume;
}

void add_volume_files(CommandLine& c, VolumeInput& input) {
  c.add_option("data", input.files, "Volume; several files are its blocks").type_name("DATA").required();
  add_raw_options(c, input.read);
}

void add_raw_options(CommandLine& c, VolumeReadOptions& options) {
  add_schema(c, options.raw, {.group = "Raw files"});
  add_schema(c, options, {.only = {"time_step", "solution", "fill_value"}});
}

void add_volume_input(CommandLine& c, VolumeInput& input) {
  add_volume_files(c, input);
  add_schema<VolumeModelOptions>(c, input, {.only = {"array"}});
  add_schema(c, input.reconstruction, {.group = "Reconstruction"});
}

void add_volume_array(CommandLine& c, VolumeInput& input) {
  add_schema<VolumeModelOptions>(c, input, {.only = {"array"}});
  add_schema(c, input.reconstruction, {.group = "Reconstruction", .only = {"method"}});
}

std::string method_line(const VolumeModel& volume) {
  const ReconstructionReport& r = volume.report();
  return fmt::format("{}: by {}{}", volume.array_name(), r.options.method.value(),
                     r.why.empty() ? "" : ", since it is " + r.why);
}

Json json_of_volume(const VolumeInput& input, VolumeModel& volume, Progress& progress) {
  const ReconstructionReport& r = volume.report();
  Json json = input.json();
  json["format"] = volume.dataset().format();
  json["array"] = volume.choice().array;
  if (r.options.method) json["method"] = *r.options.method;
  if (!r.why.empty()) json["why"] = r.why;
  const auto samples = volume.samples(progress);
  json["samples"] = samples->size();
  json["grid"] = samples->facts.grid;
  json["notes"] = r.notes;
  return json;
}

OpenVolume::OpenVolume(const VolumeInput& input, Console& console)
    : input_(input), console_(console), model_(input.open(console)) {}

std::shared_ptr<const SampledVolume> OpenVolume::samples() {
  return of_file(model_, console_, [&] { return model_.samples(console_.progress()); });
}

std::shared_ptr<const VolumeField> OpenVolume::field(const ArrayChoice& choice) {
  std::vector<Note> notes;
  auto field = of_file(model_, console_, [&] { return model_.field(choice, console_.progress(), notes); });
  console_.note(model_.name(), notes);
  return field;
}

std::shared_ptr<const Isosurface> OpenVolume::isosurface(double value) {
  std::vector<Note> notes;
  auto surface = of_file(model_, console_, [&] { return model_.isosurface(value, console_.progress(), notes); });
  console_.note(model_.name(), notes);
  return surface;
}

bool names_volume(std::vector<std::string>& files) {
  const bool said = files.size() > 1 && files[0] == "data";
  if (said) files.erase(files.begin());
  return said || std::all_of(files.begin(), files.end(), is_volume_name);
}

NamedIsosurface open_isosurface(const IsosurfaceName& name, Console& console) {
  VolumeInput input;
  input.files = {name.file};
  input.array = name.array;
  VolumeModel volume = input.open(console);
  std::vector<Note> notes;
  NamedIsosurface named{volume.isosurface(name.value, console.progress(), notes), {}};
  console.note(volume.name(), notes);
  named.json = json_of_volume(input, volume, console.progress());
  named.json["value"] = name.value;
  return named;
}

}  // namespace sansmesh::cli
