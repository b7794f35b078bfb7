// Function files: sections and the description in JSON (docs/formats/smf.md).
#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/reference_text.h"
#include "sansmesh/io/section_file.h"

namespace sansmesh::inline v1 {
namespace {

/// Written in a fixed order, but read into maps, which find the fields of a malicious description quickly.
using Json = nlohmann::ordered_json;
using ReadJson = nlohmann::json;
using Color = std::array<std::uint8_t, 3>;

constexpr const char* kKind = "partition of unity";
/// Kind of published blends, without the precautions of the default: older readers must not mistake one for the other.
constexpr const char* kPlainKind = "plain partition of unity";
constexpr std::size_t kMostLevels = 22;
/// Limits of the description: bytes, and nesting of arrays.
constexpr std::size_t kMostText = std::size_t{16} << 20;
constexpr int kMostNested = 8;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

/// A number as written; the conversions of the parser would silently wrap and overflow.
double number(const ReadJson& json) {
  if (!json.is_number()) throw DataError("a number is missing in its description");
  return json.get<double>();
}

template <class T>
T whole(const ReadJson& json) {
  if (!json.is_number_unsigned() ||
      json.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<T>::max()))
    throw DataError("a number in its description is not whole, negative or far too large");
  return static_cast<T>(json.get<std::uint64_t>());
}

float single(const ReadJson& json) {
  const double x = number(json);
  if (!(std::abs(x) <= 1e30)) throw DataError("a number in its description is far too large");
  return static_cast<float>(x);
}

template <class T, class Get>
std::optional<T> unless_null(const ReadJson& json, Get&& get) {
  return json.is_null() ? std::nullopt : std::optional<T>(get(json));
}

ReadJson parsed(std::string_view text) {
  if (text.size() > kMostText) throw DataError("its description is too long");
  return ReadJson::parse(text, [](int depth, ReadJson::parse_event_t, ReadJson&) {
    if (depth > kMostNested) throw DataError("its description is nested too deeply");
    return true;
  });
}

template <class T>
Json to_json(const VecT<T>& v) {
  return {v.x, v.y, v.z};
}

Vec3 vector_of(const ReadJson& json) { return {number(json.at(0)), number(json.at(1)), number(json.at(2))}; }

Json to_json(const PartitionOptions& o) {
  return {{"max_depth", optional_json(o.max_depth)},
          {"error", optional_json(o.error)},
          {"support", optional_json(o.support)},
          {"max_degree", o.max_degree},
          {"min_samples", o.min_samples},
          {"max_samples", o.max_samples},
          {"coverage", o.coverage},
          {"max_eccentricity", o.max_eccentricity},
          {"sharp", o.sharp},
          {"open", o.open ? Json(*o.open) : Json()}};
}

PartitionOptions options_of(const ReadJson& json) {
  PartitionOptions o;
  o.max_depth = unless_null<int>(json.at("max_depth"), whole<int>);
  o.error = unless_null<double>(json.at("error"), number);
  o.support = unless_null<double>(json.at("support"), number);
  o.max_degree = whole<int>(json.at("max_degree"));
  o.min_samples = whole<int>(json.at("min_samples"));
  o.max_samples = whole<int>(json.at("max_samples"));
  for (std::size_t d = 0; d < o.coverage.size(); ++d) o.coverage[d] = number(json.at("coverage").at(d));
  o.max_eccentricity = number(json.at("max_eccentricity"));
  json.at("sharp").get_to(o.sharp);
  if (json.contains("open") && !json.at("open").is_null()) o.open = json.at("open").get<bool>();  // since 1.2
  return o;
}

Json to_json(const PartitionReport& r) {
  return {{"noise", r.noise},
          {"error", r.error},
          {"accuracy", r.accuracy},
          {"area", r.area},
          {"spacing", r.spacing},
          {"depth", r.depth},
          {"functions", r.functions},
          {"functions_of_degree", r.functions_of_degree},
          {"creased", r.creased},
          {"open_area", r.open_area},
          {"behind", r.mean_winding_number}};
}

Json to_json(const PaperOptions& o) {
  return {{"threshold", o.threshold},
          {"max_depth", o.max_depth},
          {"max_degree", o.max_degree},
          {"support", o.support},
          {"coverage", o.coverage}};
}

PaperOptions paper_of(const ReadJson& json) {
  PaperOptions o;
  o.threshold = number(json.at("threshold"));
  o.max_depth = whole<int>(json.at("max_depth"));
  o.max_degree = whole<int>(json.at("max_degree"));
  o.support = number(json.at("support"));
  for (std::size_t d = 0; d < o.coverage.size(); ++d) o.coverage[d] = number(json.at("coverage").at(d));
  return o;
}

PartitionReport report_of(const ReadJson& json) {
  PartitionReport r;
  r.noise = number(json.at("noise"));
  r.error = number(json.at("error"));
  r.accuracy = number(json.at("accuracy"));
  r.area = number(json.at("area"));
  r.spacing = number(json.at("spacing"));
  r.depth = whole<int>(json.at("depth"));
  r.functions = whole<std::size_t>(json.at("functions"));
  for (std::size_t d = 0; d < r.functions_of_degree.size(); ++d)
    r.functions_of_degree[d] = whole<std::size_t>(json.at("functions_of_degree").at(d));
  r.creased = whole<std::size_t>(json.at("creased"));
  if (json.contains("behind")) {  // since 1.2
    r.open_area = number(json.at("open_area"));
    r.mean_winding_number = number(json.at("behind"));
  }
  return r;
}

Json to_json(const ScaleBasis& b) {
  return {{"sort_depth", b.sort_depth}, {"tried", b.tried},     {"finest", b.finest}, {"variance", b.variance},
          {"accepted", b.accepted},     {"support", b.support}, {"fit", b.fit},       {"height", b.height}};
}

ScaleBasis basis_of(const ReadJson& json) {
  ScaleBasis b;
  b.sort_depth = whole<int>(json.at("sort_depth"));
  b.tried = whole<int>(json.at("tried"));
  b.finest = whole<int>(json.at("finest"));
  b.variance = number(json.at("variance"));
  b.accepted = number(json.at("accepted"));
  b.support = b.fit = number(json.at("support"));
  if (json.contains("fit")) {  // since 1.2
    b.fit = number(json.at("fit"));
    b.height = number(json.at("height"));
  }
  return b;
}

/// Printed lines are sanitised to one line each.
std::vector<std::string> history_of(const ReadJson& json) {
  auto lines = json.get<std::vector<std::string>>();
  for (std::string& line : lines) line = printable(line);
  return lines;
}

/// One array for all levels.
template <class T, class Get>
std::vector<T> joined(const PartitionData& data, Get&& get) {
  std::vector<T> all;
  for (const PartitionData::Flatness& f : data.flatness) {
    const SharedArray<T>& level = get(f);
    all.insert(all.end(), level.begin(), level.end());
  }
  return all;
}

/// Takes the next `n` elements of an array that holds several.
template <class T>
class Cutter {
 public:
  explicit Cutter(SharedArray<T> all) : all_(std::make_shared<const SharedArray<T>>(std::move(all))) {}
  SharedArray<T> next(std::size_t n) {
    if (n > all_->size() - at_) throw DataError("the levels of its tree do not fit their arrays");
    at_ += n;
    return {all_->view().subspan(at_ - n, n), all_};
  }
  bool at_end() const { return at_ == all_->size(); }

 private:
  std::shared_ptr<const SharedArray<T>> all_;
  std::size_t at_ = 0;
};

void read_flatness(const SectionFile& file, const ReadJson& json, PartitionData& data) {
  std::vector<std::size_t> sizes;
  for (const ReadJson& size : json.at("levels")) sizes.push_back(whole<std::size_t>(size));
  if (sizes.empty() || sizes.size() > kMostLevels) throw DataError("its tree has an impossible number of levels");
  Cutter<std::uint64_t> code(file.array<std::uint64_t>("LEVCODE"));
  Cutter<float> gap(file.array<float>("LEVGAP"));
  Cutter<std::uint32_t> child(file.array<std::uint32_t>("LEVCHILD"));
  for (std::size_t l = 0; l < sizes.size(); ++l) {
    PartitionData::Flatness level;
    level.code = code.next(sizes[l]);
    level.gap = gap.next(sizes[l]);
    if (l + 1 < sizes.size()) level.child = child.next(sizes[l] + 1);
    data.flatness.push_back(std::move(level));
  }
  if (!code.at_end() || !gap.at_end() || !child.at_end())
    throw DataError("the levels of its tree do not fit their arrays");
}

template <class T>
void read_samples(const SectionFile& file, const char* name, std::size_t n, std::vector<T>& values) {
  if (!file.has(name)) return;
  const SharedArray<T> stored = file.array<T>(name);
  if (stored.size() != n) throw DataError(fmt::format("its section {} does not fit the samples", name));
  values = stored.copy();
}

PointSet read_samples(const SectionFile& file, const PartitionData& data) {
  PointSet samples;
  samples.origin = data.origin;
  if (!file.has("POSITION")) return samples;
  samples.positions = file.array<Vec3f>("POSITION").copy();
  const std::size_t n = samples.size();
  read_samples(file, "NORMAL", n, samples.normals);
  read_samples(file, "COLOR", n, samples.colors);
  if (samples.normals.size() != n) throw DataError("its samples have no normals");
  for (const Vec3f& p : samples.positions)
    if (!(norm(p - data.lower) <= 8 * data.edge)) throw DataError("its samples are not where its functions are");
  for (const Vec3f& v : samples.normals)
    if (!(squared_norm(v) <= 1.01f)) throw DataError("the normals of its samples are invalid");
  return samples;
}

}  // namespace

void write_fitted_function(const std::string& file, const FittedFunction& function, bool with_samples) {
  const PartitionData& data = function.field.data();
  // An unreadable file is never written.
  try {
    data.validate();
  } catch (const Error& error) {
    throw FileError(file, fmt::format("cannot hold this function: {}", error.what()));
  }
  Json levels = Json::array();
  for (const PartitionData::Flatness& f : data.flatness) levels.push_back(f.code.size());
  Json json = {{"kind", data.paper ? kPlainKind : kKind},
               {"origin", to_json(function.frame.origin)},
               {"unit", function.frame.unit},
               {"field_origin", to_json(data.origin)},
               {"cube", {{"lower", to_json(data.lower)}, {"edge", data.edge}}},
               {"options", to_json(data.options)},
               {"report", to_json(data.report)},
               {"basis", to_json(data.basis)},
               {"levels", levels},
               {"history", function.history}};
  if (function.samples->of_faces) json["of_faces"] = true;
  if (const std::string system = io::system_line(function.frame.reference.get()); !system.empty()) json["crs"] = system;
  if (data.paper) json["paper"] = to_json(*data.paper);
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  const auto code = joined<std::uint64_t>(
      data, [](const auto& f) -> const auto& { return f.code; });
  const auto gap = joined<float>(
      data, [](const auto& f) -> const auto& { return f.gap; });
  const auto child = joined<std::uint32_t>(
      data, [](const auto& f) -> const auto& { return f.child; });
  std::vector<FileSection> sections{{"META", 1, text},
                                    section_of("FUNCTION", data.functions.view()),
                                    section_of("SLOPE", data.slopes.view()),
                                    section_of("SUPPORT", data.supports.view()),
                                    section_of("LEVCODE", std::span(code)),
                                    section_of("LEVGAP", std::span(gap)),
                                    section_of("LEVCHILD", std::span(child))};
  const PointSet& samples = *function.samples;
  if (with_samples && samples.size() > 0) {
    sections.push_back(section_of("POSITION", std::span(samples.positions)));
    sections.push_back(section_of("NORMAL", std::span(samples.normals)));
    if (samples.has_colors()) sections.push_back(section_of("COLOR", std::span(samples.colors)));
  }
  write_sections(file, sections);
}

FittedFunction read_fitted_function(const std::string& file) { return read_fitted_function(SectionFile(file)); }

FittedFunction read_fitted_function(const SectionFile& file) {
  try {
    const ReadJson json = parsed(file.text("META"));
    const auto kind = json.at("kind").get<std::string>();
    if (kind != kKind && kind != kPlainKind)
      throw FileError(file.file(), fmt::format("holds another kind of function than a {}", kKind));
    PartitionData data;
    if (kind == kPlainKind) data.paper = paper_of(json.at("paper"));
    data.origin = vector_of(json.at("field_origin"));
    const ReadJson& cube = json.at("cube");
    for (std::size_t k = 0; k < 3; ++k) data.lower[k] = single(cube.at("lower").at(k));
    data.edge = single(cube.at("edge"));
    data.options = options_of(json.at("options"));
    data.report = report_of(json.at("report"));
    data.basis = basis_of(json.at("basis"));
    data.functions = file.array<LocalFunction>("FUNCTION");
    data.supports = file.array<Support>("SUPPORT");
    read_flatness(file, json, data);
    if (file.has("SLOPE")) {
      data.slopes = file.array<float>("SLOPE");
      if (data.slopes.size() != data.functions.size()) throw DataError("its slopes do not fit its functions");
    }
    data.validate();
    auto samples = std::make_shared<PointSet>(read_samples(file, data));
    samples->of_faces = json.contains("of_faces") && json.at("of_faces").get<bool>();  // since 1.2; not for clouds
    LocalFrame frame{vector_of(json.at("origin")), number(json.at("unit"))};
    if (const auto system = json.find("crs"); system != json.end())  // since 1.3
      frame.reference = system_of_text(system->get<std::string>());
    int exponent = 0;
    if (!(norm(frame.origin) <= 1e30 && frame.unit > 1e-60 && frame.unit < 1e30) ||
        std::frexp(frame.unit, &exponent) != 0.5)
      throw DataError("its position in the input is invalid");
    std::vector<std::string> history = history_of(json.at("history"));
    return {PartitionOfUnity(std::move(data)), frame, std::move(samples), std::move(history), {}, {}};
  } catch (const nlohmann::json::exception&) {
    throw FileError(file.file(), "damaged: its description (section META) is invalid");
  } catch (const ArgumentError& error) {
    throw FileError(file.file(), fmt::format("damaged: {}", error.what()));
  } catch (const DataError& error) {
    throw FileError(file.file(), fmt::format("damaged: {}", error.what()));
  }
}

}  // namespace sansmesh::inline v1
