// Files of fitted volumes: sections and the description in JSON (docs/formats/smv.md).
#include "sansmesh/dataset/volume_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/section_file.h"
#include "sansmesh/volume/grid/check_volume.h"
#include "sansmesh/volume/reconstruction.h"

namespace sansmesh::inline v1 {
namespace {

/// Written in a fixed order, but read into maps, which find the fields of a hostile description quickly.
using Json = nlohmann::ordered_json;
using ReadJson = nlohmann::json;

constexpr const char* kVolumeKind = "fitted volume";
/// Limits of the description: bytes, and depth of nested arrays.
constexpr std::size_t kMostDescription = std::size_t{16} << 20;
constexpr int kDeepest = 8;
/// The number of sections left for arrays.
constexpr std::size_t kMostArrays = 200;
/// Far above real arrays, and small enough for products with numbers of samples.
constexpr std::size_t kMostComponents = 1 << 16;

/// JSON has no numbers that are not finite; the reader of each field knows which one null is.
Json json_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(); }

double real_of(const ReadJson& json) {
  if (!json.is_number()) throw DataError("a number is missing in its description");
  return json.get<double>();
}

double real_or(const ReadJson& json, double otherwise) { return json.is_null() ? otherwise : real_of(json); }

std::size_t count_of(const ReadJson& json) {
  if (!json.is_number_unsigned()) throw DataError("a number in its description is not whole or negative");
  return json.get<std::size_t>();
}

/// Printed text has one line.
std::string line_of(const ReadJson& json) { return printable(json.get<std::string>()); }

template <class T>
Json json_if(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json json_of(const VolumeReconstructionOptions& o) {
  return {{"method", *o.method},
          {"degree", json_if(o.degree)},
          {"iterations", json_if(o.iterations)},
          {"shape", json_if(o.epsilon)},
          {"order", json_if(o.order)},
          {"radius", json_if(o.radius)},
          {"robust", json_if(o.robust)},
          {"spherical", json_if(o.spherical)},
          {"interpolate", json_if(o.interpolate)},
          {"b", o.b},
          {"c", o.c},
          {"smoothing", json_if(o.smoothing)},
          {"centres", o.cell_values ? Json(*o.cell_values == CellValues::centres) : Json()},
          {"logarithm", json_if(o.logarithm)}};
}

VolumeReconstructionOptions reconstruction_of(const ReadJson& json) {
  const auto whole = [&](const char* name) -> std::optional<int> {
    const ReadJson& j = json.at(name);
    return j.is_null() ? std::nullopt : std::optional(static_cast<int>(std::min<std::size_t>(count_of(j), 1 << 20)));
  };
  const auto real = [&](const char* name) -> std::optional<double> {
    const ReadJson& j = json.at(name);
    return j.is_null() ? std::nullopt : std::optional(real_of(j));
  };
  VolumeReconstructionOptions o;
  o.method = std::string(volume_method(json.at("method").get<std::string>()).name);
  o.degree = whole("degree");
  o.iterations = whole("iterations");
  o.epsilon = real("shape");
  o.order = whole("order");
  o.radius = real("radius");
  if (!json.at("robust").is_null()) o.robust = json.at("robust").get<bool>();
  // Older files do not have this field.
  if (json.contains("spherical") && !json.at("spherical").is_null()) o.spherical = json.at("spherical").get<bool>();
  const auto flag = [&](const char* name) -> std::optional<bool> {
    return json.contains(name) && !json.at(name).is_null() ? std::optional(json.at(name).get<bool>()) : std::nullopt;
  };
  if (const auto centres = flag("centres")) o.cell_values = *centres ? CellValues::centres : CellValues::means;
  o.logarithm = flag("logarithm");
  o.interpolate = flag("interpolate");
  o.b = real_of(json.at("b"));
  o.c = real_of(json.at("c"));
  // Samples of older files were used as they are.
  o.smoothing = json.contains("smoothing") ? real("smoothing") : std::optional(0.0);
  o.validate();
  return o;
}

Json json_of(const VolumeFacts& f) {
  return {{"grid", f.grid},
          {"blocks", f.blocks},
          {"levels", f.levels},
          {"points", f.points},
          {"cells", f.cells},
          {"merged", f.merged},
          {"hidden", f.hidden},
          {"overlapped", f.overlapped},
          {"degenerate", f.degenerate},
          {"inverted", f.inverted},
          {"not_finite", f.not_finite},
          {"parts", f.parts},
          {"layer", json_or_null(f.layer)},
          {"least_spacing", json_or_null(f.least_spacing)},
          {"median_spacing", json_or_null(f.median_spacing)},
          {"most_spacing", json_or_null(f.most_spacing)},
          {"aspect", json_or_null(f.aspect)}};
}

VolumeFacts facts_of(const ReadJson& json) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  VolumeFacts f;
  f.grid = line_of(json.at("grid"));
  f.unstructured = f.grid == "unstructured";  // the file has no other field for it
  f.blocks = count_of(json.at("blocks"));
  f.levels = count_of(json.at("levels"));
  f.points = count_of(json.at("points"));
  f.cells = count_of(json.at("cells"));
  f.merged = count_of(json.at("merged"));
  f.hidden = count_of(json.at("hidden"));
  f.overlapped = count_of(json.at("overlapped"));
  f.degenerate = count_of(json.at("degenerate"));
  f.inverted = count_of(json.at("inverted"));
  f.not_finite = count_of(json.at("not_finite"));
  f.parts = count_of(json.at("parts"));
  f.layer = real_or(json.at("layer"), kInfinity);
  f.least_spacing = real_or(json.at("least_spacing"), kInfinity);
  f.median_spacing = real_or(json.at("median_spacing"), kInfinity);
  f.most_spacing = real_or(json.at("most_spacing"), kInfinity);
  f.aspect = real_or(json.at("aspect"), kInfinity);
  return f;
}

Json json_of(const DatasetArray& a) {
  Json least = Json::array(), most = Json::array();
  for (const double v : a.least) least.push_back(json_or_null(v));
  for (const double v : a.most) most.push_back(json_or_null(v));
  return {{"name", printable(a.name)},
          {"type", name_of(a.type)},
          {"components", a.components},
          {"least", least},
          {"most", most},
          {"not_finite", a.not_finite}};
}

NumberType type_of_name(const std::string& name) {
  for (int k = 0; k <= static_cast<int>(NumberType::f64); ++k)
    if (name_of(static_cast<NumberType>(k)) == name) return static_cast<NumberType>(k);
  throw DataError("an array has numbers of an unknown type");
}

DatasetArray array_of(const ReadJson& json, bool in_cells) {
  DatasetArray a;
  a.name = line_of(json.at("name"));
  a.of = in_cells ? Association::cells : Association::points;
  a.type = type_of_name(json.at("type").get<std::string>());
  a.components = count_of(json.at("components"));
  if (a.name.empty() || a.components == 0 || a.components > kMostComponents)
    throw DataError("an array has no name or an impossible number of components");
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const ReadJson& v : json.at("least")) a.least.push_back(real_or(v, kNone));
  for (const ReadJson& v : json.at("most")) a.most.push_back(real_or(v, kNone));
  if (a.least.size() != a.components || a.most.size() != a.components)
    throw DataError("the range of an array does not fit its components");
  a.not_finite = count_of(json.at("not_finite"));
  return a;
}

std::string section_of_array(std::size_t k) { return fmt::format("ARRAY{}", k); }

/// A section, or an empty array if an optional section is absent.
template <class T>
std::vector<T> optional_section(const SectionFile& file, const char* name) {
  return file.has(name) ? file.array<T>(name).copy() : std::vector<T>();
}

/// Numbers of a lattice besides its axes.
constexpr std::size_t kLatticeNumbers = 18;

std::vector<double> lattice_numbers(const Lattice& lattice) {
  std::vector<double> numbers;
  for (const Vec3& d : lattice.directions) numbers.insert(numbers.end(), {d.x, d.y, d.z});
  numbers.insert(numbers.end(), {lattice.origin.x, lattice.origin.y, lattice.origin.z});
  numbers.insert(numbers.end(), lattice.lower.begin(), lattice.lower.end());
  numbers.insert(numbers.end(), lattice.upper.begin(), lattice.upper.end());
  return numbers;
}

Lattice lattice_of(const SectionFile& file, bool uniform) {
  const SharedArray<double> numbers = file.array<double>("LATTICE");
  if (numbers.size() != kLatticeNumbers) throw DataError("its lattice is not complete");
  const auto vector = [&](std::size_t k) { return Vec3{numbers[k], numbers[k + 1], numbers[k + 2]}; };
  Lattice lattice;
  for (std::size_t k = 0; k < 3; ++k) lattice.directions[k] = vector(3 * k);
  lattice.origin = vector(9);
  std::copy_n(numbers.begin() + 12, 3, lattice.lower.begin());
  std::copy_n(numbers.begin() + 15, 3, lattice.upper.begin());
  for (std::size_t k = 0; k < 3; ++k) lattice.axes[k] = file.array<double>(fmt::format("AXIS{}", k)).copy();
  lattice.uniform = uniform;
  return lattice;
}

CellList cells_of(const SectionFile& file) {
  CellList cells;
  cells.shapes = file.array<CellShape>("SHAPE").copy();
  cells.corners = file.array<std::uint32_t>("CELL").copy();
  cells.first.reserve(cells.shapes.size() + 1);
  for (const CellShape shape : cells.shapes) {
    if (shape > CellShape::hexahedron) throw DataError("a cell has an unknown shape");
    cells.first.push_back(cells.first.back() + corner_count(shape));
  }
  return cells;
}

/// Family and orders of a cell of higher order, a byte each.
std::uint32_t number_of_kind(const HigherOrderKind& kind) {
  std::uint32_t number = static_cast<std::uint32_t>(kind.family);
  for (std::uint32_t k = 0; k < 3; ++k) number |= std::uint32_t{kind.orders[k]} << (8 * k + 8);
  return number;
}

HigherOrderCells higher_of(const SectionFile& file) {
  HigherOrderCells higher;
  if (!file.has("HIGHOF")) return higher;
  higher.of_piece = file.array<std::uint32_t>("HIGHOF").copy();
  higher.nodes = file.array<std::uint32_t>("HIGHNODE").copy();
  for (const std::uint32_t number : file.array<std::uint32_t>("HIGHKIND").view()) {
    HigherOrderKind kind;
    const std::uint32_t family = number & 255u;
    if (family > static_cast<std::uint32_t>(HigherOrderFamily::pyramid_13))
      throw DataError("a cell of higher order is of an unknown kind");
    kind.family = static_cast<HigherOrderFamily>(family);
    for (std::uint32_t k = 0; k < 3; ++k) kind.orders[k] = static_cast<std::uint8_t>(number >> (8 * k + 8) & 255u);
    higher.kinds.push_back(kind);
    higher.first.push_back(higher.first.back() + node_count(kind));
  }
  return higher;
}

std::shared_ptr<const SampledVolume> samples_of(const SectionFile& file, const ReadJson& json,
                                                const std::vector<DatasetArray>& arrays) {
  auto volume = std::make_shared<SampledVolume>();
  volume->in_cells = json.at("in_cells").get<bool>();
  volume->scattered = json.at("scattered").get<bool>();
  volume->facts = facts_of(json.at("facts"));
  if (file.has("LATTICE")) {
    volume->lattice = lattice_of(file, json.at("uniform").get<bool>());
  } else {
    volume->positions = file.array<Vec3>("POSITION").copy();
    volume->cells = cells_of(file);
    volume->higher = higher_of(file);
    volume->corners = optional_section<Vec3>(file, "CORNER");
    volume->cell_sample = optional_section<std::uint32_t>(file, "CELLSAMP");
    volume->stars.entries = file.array<std::uint32_t>("STAR").copy();
    volume->stars.first = file.array<std::uint64_t>("STARBEG").copy();
  }
  volume->part = optional_section<std::uint32_t>(file, "PART");
  volume->block = optional_section<std::uint16_t>(file, "BLOCK");
  volume->level = optional_section<std::uint8_t>(file, "LEVEL");
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    Attribute attribute{arrays[k].name, empty_values(arrays[k].type), arrays[k].components};
    std::visit(
        [&](auto& numbers) {
          using T = typename std::decay_t<decltype(numbers)>::value_type;
          numbers = file.array<T>(section_of_array(k)).copy();
        },
        attribute.values);
    if (volume->attributes.find(attribute.name)) throw DataError("two of its arrays have the same name");
    volume->attributes.set(std::move(attribute));
  }
  check_volume(*volume);
  return volume;
}

ReconstructionCoefficients coefficients_of(const SectionFile& file, std::size_t components) {
  ReconstructionCoefficients c;
  c.polynomials.components = components;
  if (file.has("METRIC")) c.polynomials.metrics = file.array<StarMetric>("METRIC");
  c.polynomials.constants = file.array<double>("CONSTANT");
  c.polynomials.degrees = file.array<std::uint8_t>("DEGREE");
  c.polynomials.first = file.array<std::uint64_t>("COEFFBEG");
  c.polynomials.coefficients = file.array<float>("COEFF");
  c.polynomials.trust = file.array<float>("TRUST");
  if (file.has("RADIUS")) c.radii = file.array<float>("RADIUS");
  return c;
}

const DatasetArray& reconstructed(const FittedVolume& fitted) {
  for (const DatasetArray& a : fitted.arrays)
    if (a.name == fitted.array) return a;
  throw DataError("the reconstructed array is missing");
}

void check_fitted(const FittedVolume& fitted) {
  const DatasetArray& array = reconstructed(fitted);
  if (volume_method(*fitted.chosen.method).fits == fitted.coefficients.empty())
    throw DataError("its coefficients are not those of its reconstruction");
  if (!fitted.coefficients.empty()) fitted.coefficients.check(*fitted.volume, array.components, *fitted.chosen.method);
  const SharedArray<double>& smoothed = fitted.coefficients.smoothed;
  if (smoothed.empty()) return;
  if (smoothed.size() != fitted.volume->size() * array.components)
    throw DataError("its smoothed samples are not as many as its samples");
  if (!std::all_of(smoothed.begin(), smoothed.end(), [](double v) { return std::isfinite(v); }))
    throw DataError("a smoothed sample is not finite");
  if (!(fitted.chosen.smoothing > 0)) throw DataError("it has smoothed samples without smoothing");
}

/// `kinds` holds bytes of a section.
void add_samples(const SampledVolume& volume, std::vector<std::uint32_t>& kinds, std::vector<FileSection>& sections) {
  sections.push_back(section_of("POSITION", std::span(volume.positions)));
  sections.push_back(section_of("SHAPE", std::span(volume.cells.shapes)));
  sections.push_back(section_of("CELL", std::span(volume.cells.corners)));
  if (!volume.cell_sample.empty()) {
    sections.push_back(section_of("CORNER", std::span(volume.corners)));
    sections.push_back(section_of("CELLSAMP", std::span(volume.cell_sample)));
  }
  if (!volume.higher.empty()) {
    for (const HigherOrderKind& kind : volume.higher.kinds) kinds.push_back(number_of_kind(kind));
    sections.push_back(section_of("HIGHOF", std::span(volume.higher.of_piece)));
    sections.push_back(section_of("HIGHKIND", std::span<const std::uint32_t>(kinds)));
    sections.push_back(section_of("HIGHNODE", std::span(volume.higher.nodes)));
  }
  sections.push_back(section_of("STARBEG", std::span(volume.stars.first)));
  sections.push_back(section_of("STAR", std::span(volume.stars.entries)));
}

void add_coefficients(const ReconstructionCoefficients& c, std::vector<FileSection>& sections) {
  if (!c.polynomials.metrics.empty()) sections.push_back(section_of("METRIC", c.polynomials.metrics.view()));
  sections.push_back(section_of("CONSTANT", c.polynomials.constants.view()));
  sections.push_back(section_of("DEGREE", c.polynomials.degrees.view()));
  sections.push_back(section_of("COEFFBEG", c.polynomials.first.view()));
  sections.push_back(section_of("COEFF", c.polynomials.coefficients.view()));
  sections.push_back(section_of("TRUST", c.polynomials.trust.view()));
  if (!c.radii.empty()) sections.push_back(section_of("RADIUS", c.radii.view()));
}

}  // namespace

bool is_volume_file(const std::string& file) { return io::ending(file) == "smv"; }

void write_volume_file(const std::string& file, const FittedVolume& fitted) {
  const SampledVolume& volume = *fitted.volume;
  // Refuse to write files that could not be read.
  try {
    check_volume(volume);
    check_fitted(fitted);
    if (fitted.arrays.size() > kMostArrays)
      throw DataError(
          fmt::format("there are {} arrays, more than the {} that fit into a file", fitted.arrays.size(), kMostArrays));
  } catch (const DataError& error) {
    throw FileError(file, fmt::format("cannot hold this volume: {}", error.what()));
  }
  Json arrays = Json::array();
  std::set<std::string> names;
  for (const DatasetArray& a : fitted.arrays) {
    arrays.push_back(json_of(a));
    if (!names.insert(printable(a.name)).second)
      throw FileError(file, fmt::format("cannot hold this volume: there are two arrays {}", a.name));
  }
  Json notes = Json::array();
  for (const std::string& note : fitted.notes) notes.push_back(printable(note));
  Json json = {
      {"kind", kVolumeKind},
      {"source", printable(fitted.source)},
      {"time", json_if(fitted.time)},
      {"in_cells", volume.in_cells},
      {"scattered", volume.scattered},
      {"uniform", volume.lattice && volume.lattice->uniform},
      {"facts", json_of(volume.facts)},
      {"arrays", arrays},
      {"reconstruction",
       {{"array", printable(fitted.array)}, {"options", json_of(fitted.options)}, {"chosen", json_of(fitted.chosen)}}},
      {"notes", notes}};
  if (!fitted.coefficients.scales.empty()) json["reconstruction"]["scales"] = fitted.coefficients.scales;
  if (!fitted.coefficients.smoothed.empty()) json["reconstruction"]["noise"] = fitted.coefficients.noise;
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  std::vector<FileSection> sections{{"META", 1, text}};
  std::vector<double> lattice;
  std::vector<std::uint32_t> kinds;
  if (volume.lattice) {
    lattice = lattice_numbers(*volume.lattice);
    sections.push_back(section_of("LATTICE", std::span<const double>(lattice)));
    for (std::size_t k = 0; k < 3; ++k)
      sections.push_back(section_of(fmt::format("AXIS{}", k), std::span(volume.lattice->axes[k])));
  } else {
    add_samples(volume, kinds, sections);
  }
  if (!volume.part.empty()) sections.push_back(section_of("PART", std::span(volume.part)));
  if (!volume.block.empty()) sections.push_back(section_of("BLOCK", std::span(volume.block)));
  if (!volume.level.empty()) sections.push_back(section_of("LEVEL", std::span(volume.level)));
  for (std::size_t k = 0; k < fitted.arrays.size(); ++k) {
    const Attribute* const attribute = volume.attributes.find(fitted.arrays[k].name);
    if (!attribute || attribute->type() != fitted.arrays[k].type ||
        attribute->components != fitted.arrays[k].components)
      throw FileError(file, fmt::format("cannot hold this volume: it has no such array {}", fitted.arrays[k].name));
    std::visit([&](const auto& numbers) { sections.push_back(section_of(section_of_array(k), std::span(numbers))); },
               attribute->values);
  }
  if (!fitted.coefficients.empty()) add_coefficients(fitted.coefficients, sections);
  if (!fitted.coefficients.smoothed.empty())
    sections.push_back(section_of("SMOOTHED", fitted.coefficients.smoothed.view()));
  write_sections(file, sections, kVolumeSections);
}

FittedVolume read_volume_file(const std::string& file) { return read_volume_file(SectionFile(file, kVolumeSections)); }

FittedVolume read_volume_file(const SectionFile& file) {
  try {
    const std::string_view text = file.text("META");
    if (text.size() > kMostDescription) throw DataError("its description is too long");
    const ReadJson json = ReadJson::parse(text, [](int depth, ReadJson::parse_event_t, ReadJson&) {
      if (depth > kDeepest) throw DataError("its description is nested too deeply");
      return true;
    });
    if (json.at("kind").get<std::string>() != kVolumeKind)
      throw FileError(file.file(), fmt::format("holds something else than a {}", kVolumeKind));
    FittedVolume fitted;
    fitted.source = line_of(json.at("source"));
    if (!json.at("time").is_null()) fitted.time = real_of(json.at("time"));
    for (const ReadJson& note : json.at("notes")) fitted.notes.push_back(line_of(note));
    if (json.at("arrays").size() > kMostArrays) throw DataError("it has too many arrays");
    const bool in_cells = json.at("in_cells").get<bool>();
    for (const ReadJson& array : json.at("arrays")) fitted.arrays.push_back(array_of(array, in_cells));
    const ReadJson& reconstruction = json.at("reconstruction");
    fitted.array = line_of(reconstruction.at("array"));
    fitted.options = reconstruction_of(reconstruction.at("options"));
    fitted.chosen = reconstruction_of(reconstruction.at("chosen"));
    const DatasetArray& array = reconstructed(fitted);
    fitted.volume = samples_of(file, json, fitted.arrays);
    if (file.has("COEFF")) fitted.coefficients = coefficients_of(file, array.components);
    if (file.has("SMOOTHED")) {
      fitted.coefficients.smoothed = file.array<double>("SMOOTHED");
      fitted.coefficients.noise = real_of(reconstruction.at("noise"));
    }
    if (reconstruction.contains("scales"))
      for (const ReadJson& s : reconstruction.at("scales")) fitted.coefficients.scales.push_back(real_of(s));
    if (fitted.options.method != fitted.chosen.method) throw DataError("it has two methods");
    check_fitted(fitted);
    return fitted;
  } catch (const nlohmann::json::exception&) {
    throw FileError(file.file(), "damaged: its description (section META) makes no sense");
  } catch (const ArgumentError& error) {
    throw FileError(file.file(), fmt::format("damaged: {}", error.what()));
  } catch (const DataError& error) {
    throw FileError(file.file(), fmt::format("damaged: {}", error.what()));
  }
}

}  // namespace sansmesh::inline v1
