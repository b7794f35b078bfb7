#include "volume_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "command_line.h"
#include "option_values.h"
#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/volume_file.h"

namespace sansmesh::cli {
namespace {

std::string method_names() {
  std::string names;
  for (const ReconstructionInfo& m : reconstruction_methods())
    names += fmt::format("{}{}", names.empty() ? "" : ", ", m.name);
  return names;
}

}  // namespace

std::string VolumeInput::name() const {
  if (files.size() == 1) return files[0];
  return fmt::format("{} and {}", files[0], counted(files.size() - 1, "other file"));
}

Json VolumeInput::json() const { return files.size() == 1 ? Json{{"file", files[0]}} : Json{{"files", files}}; }

void add_volume_files(CommandLine& c, VolumeInput& input) {
  c.add_option("data", input.files, "Volume; several files are its blocks").type_name("DATA").required();
  add_raw_options(c, input.read);
}

void add_raw_options(CommandLine& c, VolumeReadOptions& options) {
  const auto raw = [&options]() -> RawLayout& {
    if (!options.raw) options.raw.emplace();
    return *options.raw;
  };
  c.add_option_function(
       "--dims",
       [raw](const std::string& text) {
         std::array<std::size_t, 3> dims{};
         std::string numbers = text;
         std::replace(numbers.begin(), numbers.end(), 'x', ',');
         const std::vector<std::string> words = between_commas(numbers);
         for (std::size_t k = 0; k < 3; ++k) {
           const auto n =
               words.size() == 3 ? whole_in(words[k], 1, std::numeric_limits<long long>::max()) : std::nullopt;
           if (!n) throw must_be("three numbers such as 256x256x128", text);
           dims[k] = static_cast<std::size_t>(*n);
         }
         raw().dims = dims;
       },
       "Raw files: numbers of values along x, y and z")
      .type_name("NXxNYxNZ")
      .group("Raw files");
  std::vector<std::string> types;
  for (int k = 0; k <= static_cast<int>(NumberType::f64); ++k) types.emplace_back(name_of(static_cast<NumberType>(k)));
  c.add_option_function(
       "--type",
       [raw, types](const std::string& text) {
         raw().type = static_cast<NumberType>(std::find(types.begin(), types.end(), text) - types.begin());
       },
       "Of raw values: int8, uint8, int16, …, float, double [uint8]")
      .one_of(types)
      .type_name("TYPE")
      .group("Raw files");
  c.add_option_function(
       "--spacing",
       [raw](const std::vector<double>& steps) {
         for (const double s : steps)
           if (!(s > 0)) throw ValueError("must be three positive lengths");
         raw().spacing = {steps[0], steps[1], steps[2]};
       },
       "Of raw values along x, y and z [1,1,1]")
      .numbers(3)
      .type_name("LENGTHS")
      .group("Raw files");
  c.add_flag_callback(
       "--big-endian", [raw] { raw().big_endian = true; }, "Raw values have their high byte first")
      .group("Raw files");
  c.add_option("--step", options.time_step, "Which of several steps in time, from 0 [0]").type_name("NUMBER");
  c.add_option_function(
       "--fill-value",
       [&options](const std::string& text) {
         if (text == "none") {
           options.fill.usual = false;
           return;
         }
         const auto value = number_in(text);
         if (!value) throw ValueError(fmt::format("must be a number, or none, not {}", in_quotes(text)));
         options.fill.values.push_back(*value);
       },
       "This number stands for missing values, as usual ones (9.96921e36, -9999, …) do where they stand apart; none: "
       "they do not; may be repeated")
      .repeated()
      .type_name("VALUE");
}

void add_volume_input(CommandLine& c, VolumeInput& input) {
  add_volume_files(c, input);
  add_volume_array(c, input);
  c.add_option("--degree", input.method.degree,
               "Highest degree of polynomials, 0..4 (mls, mls-detail), 1..5 (lagrange)")
      .type_name("DEGREE")
      .group("Reconstruction");
  c.add_option("--iterations", input.method.iterations, "Times that residuals are added (amls), 0..100")
      .type_name("COUNT")
      .group("Reconstruction");
  c.add_option("--shape", input.method.shape, "ε of amls, 0.05..10: small is smooth")
      .type_name("NUMBER")
      .group("Reconstruction");
  c.add_option("--order", input.method.order, "Of amls: 2, 4 or 6").type_name("ORDER").group("Reconstruction");
  c.add_flag_callback(
       "--spherical", [&input] { input.method.spherical = true; },
       "Of amls: balls as supports, not ellipsoids; for comparison, not for uniform and rectilinear grids")
      .group("Reconstruction");
  c.add_option("--radius", input.method.radius, "Of supports in spacings, 1..10 (mls, rbf, shepard)")
      .type_name("NUMBER")
      .group("Reconstruction");
}

void add_volume_array(CommandLine& c, VolumeInput& input) {
  c.add_option("--array", input.array, "Array, or a component of it: NAME, NAME:0, NAME:x, NAME:magnitude [a scalar]")
      .type_name("NAME");
  c.add_option_function(
       "--method",
       [&input](const std::string& name) {
         try {
           input.method.method = reconstruction_of_name(name);
           input.chosen = true;
         } catch (const ArgumentError&) {
           throw ValueError(fmt::format("must be one of {}, not {}", method_names(), name));
         }
       },
       fmt::format("Reconstruction: {} [from grid, resolution and noise]", method_names()))
      .one_of(listed_words(method_names()))
      .type_name("NAME")
      .group("Reconstruction");
}

OpenVolume::OpenVolume(const VolumeInput& input, Console& console) : input_(input), console_(console) {
  const ReconstructionOptions& m = input.method;
  m.validate();
  if (!input.chosen && (m.degree || m.iterations || m.shape || m.order || m.radius || m.spherical))
    throw ArgumentError("--degree, --iterations, --shape, --order, --spherical and --radius need --method");
  console.progress().begin("read");
  ReadReport read;
  if (std::any_of(input.files.begin(), input.files.end(), is_volume_file)) {
    if (input.files.size() > 1) throw FileError(input.name(), "a fitted volume (.smv) is whole: it is read on its own");
    if (input.read.raw)
      throw ArgumentError("`dims`, `type` and `spacing` are for raw files, not for fitted volumes (.smv)");
    if (input.read.time_step > 0) throw ArgumentError("`time_step`: a fitted volume (.smv) holds a single step");
    if (!input.read.fill.usual || !input.read.fill.values.empty())
      throw ArgumentError("`fill_values` are told to volume fit: in a fitted volume (.smv) they are missing already");
    dataset_ = std::make_unique<VolumeDataset>(read_volume_file(input.files[0]));
  } else {
    dataset_ = std::make_unique<VolumeDataset>(input.files.size() == 1 ? read_volume(input.files[0], input.read, &read)
                                                                       : read_volumes(input.files, input.read, &read));
  }
  if (dataset_->arrays().empty() && !input.may_be_bare) {
    std::string cause = "holds no arrays: there is nothing to reconstruct";
    for (const std::string& note : dataset_->notes()) cause += "; " + note;
    throw FileError(input.name(), cause);
  }
  console.warn(input.name(), dataset_->notes());
  if (!input.array.empty())
    choice_ = dataset_->choose(input.array);
  else if (!dataset_->arrays().empty())
    choice_ = {dataset_->default_array().name, {}, false};
}

std::string OpenVolume::array_name() const {
  if (choice_.magnitude) return choice_.array + "_magnitude";
  return choice_.component ? fmt::format("{}_{}", choice_.array, *choice_.component) : choice_.array;
}

std::shared_ptr<const SampledVolume> OpenVolume::samples() {
  if (samples_) return samples_;
  try {
    samples_ = dataset_->arrays().empty() ? dataset_->volume(Association::points, console_.progress())
                                          : dataset_->volume(choice_.array, console_.progress());
  } catch (const DataError& error) {
    throw FileError(input_.name(), console_.in_flags(error.what()));
  }
  return samples_;
}

std::shared_ptr<const VolumeField> OpenVolume::field(const ArrayChoice& choice) {
  samples();
  std::shared_ptr<const VolumeField> field;
  try {
    dataset_->default_array();  // there must be one
    ReconstructionReport report;
    field = dataset_->field(choice, options_for(choice.array), console_.progress(), &report);
    if (!fitted_) report_ = report;
    fitted_ = true;
    console_.warn(input_.name(), report.notes);
  } catch (const DataError& error) {
    throw FileError(input_.name(), console_.in_flags(error.what()));
  }
  return field;
}

FittedVolume OpenVolume::fit(bool all) {
  if (choice_.component || choice_.magnitude)
    throw ArgumentError(
        fmt::format("`array`: all components are fitted together; choose one where the file is used ({}, not {})",
                    choice_.array, input_.array));
  samples();
  FittedVolume fitted;
  try {
    dataset_->default_array();  // there must be one
    fitted = dataset_->fit(choice_.array, options_for(choice_.array), all, console_.progress(), &report_);
    fitted_ = true;
  } catch (const DataError& error) {
    throw FileError(input_.name(), console_.in_flags(error.what()));
  }
  console_.warn(input_.name(), report_.notes);
  return fitted;
}

ReconstructionOptions OpenVolume::options_for(const std::string& array) {
  ReconstructionOptions options = input_.method;
  if (input_.chosen) return options;
  if (const FittedVolume* const fitted = dataset_->fitted(); fitted && fitted->array == array) {
    options.method = fitted->options.method;
    options.b = fitted->options.b, options.c = fitted->options.c;
    return options;
  }
  options.method = suited().method;
  return options;
}

std::shared_ptr<const Isosurface> OpenVolume::isosurface(double value) {
  const DatasetArray& array = dataset_->array(choice_.array);
  if (array.components > 1 && !choice_.component && !choice_.magnitude)
    throw ArgumentError(fmt::format("`array`: {} has {} components: choose one ({}:0, {}:magnitude, …)", array.name,
                                    array.components, array.name, array.name));
  const auto values = field();
  console_.progress().begin("find surface");
  try {
    return std::make_shared<const Isosurface>(
        samples(), values, [&](std::size_t i) { return sample_value(i); }, value);
  } catch (const DataError& error) {
    throw FileError(input_.name(), console_.in_flags(error.what()));
  }
}

const VolumeTraits& OpenVolume::traits() {
  if (!traits_) {
    const auto volume = samples();
    try {
      dataset_->default_array();  // there must be one
      traits_ = measure_volume_traits(*volume, volume_values(*volume, choice_.array), console_.progress());
    } catch (const DataError& error) {
      throw FileError(input_.name(), console_.in_flags(error.what()));
    }
    suited_ = choose_reconstruction(*volume, *traits_);
  }
  return *traits_;
}

const ReconstructionChoice& OpenVolume::suited() {
  traits();
  return suited_;
}

void OpenVolume::say_method() const {
  const std::string_view name = info_of(report_.options.method).name;
  console_.say(traits_ ? fmt::format("{}: by {}, since it is {}", array_name(), name, suited_.why)
                       : fmt::format("{}: by {}", array_name(), name));
}

double OpenVolume::sample_value(std::size_t i) {
  const Attribute& a = *samples()->attributes.find(choice_.array);
  if (choice_.component) return a.number(i * a.components + *choice_.component);
  if (a.components == 1) return a.number(i);
  std::array<double, 16> few;
  std::vector<double> many(a.components > few.size() ? a.components : 0);
  const std::span<double> v = many.empty() ? std::span(few).first(a.components) : std::span(many);
  for (std::size_t c = 0; c < v.size(); ++c) v[c] = a.number(i * v.size() + c);
  return vector_length(v);
}

double OpenVolume::middle_value() const {
  const DatasetArray& a = dataset_->array(choice_.array);
  const std::size_t c = choice_.component.value_or(0);
  if (std::isnan(a.least[c]))
    throw FileError(input_.name(), fmt::format("array '{}' has no finite value", printable(a.name, 60)));
  return 0.5 * (a.least[c] + a.most[c]);
}

Json OpenVolume::json() const {
  Json json = input_.json();
  json["format"] = dataset_->format();
  json["array"] = choice_.array;
  if (fitted_) json["method"] = info_of(report_.options.method).name;
  if (traits_) json["why"] = suited_.why;
  if (samples_) {
    json["samples"] = samples_->size();
    json["grid"] = samples_->facts.grid;
  }
  json["notes"] = report_.notes;
  return json;
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
  OpenVolume volume(input, console);
  NamedIsosurface named;
  named.surface = volume.isosurface(name.value);
  named.json = volume.json();
  named.json["value"] = name.value;
  return named;
}

ArrayChoice as_scalar(ArrayChoice choice, OpenVolume& volume) {
  choice.magnitude = choice.magnitude || (!choice.component && volume.dataset().array(choice.array).components > 1);
  return choice;
}

}  // namespace sansmesh::cli
