// Function files: sections and the description in JSON (docs/formats/smf.md).
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/section_file.h"
#include "sansmesh/surface_function.h"

namespace sansmesh {
namespace {

using Json = nlohmann::ordered_json;
using Color = std::array<std::uint8_t, 3>;

constexpr const char* kKind = "partition of unity";
constexpr std::size_t kMostLevels = 22;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

template <class T>
std::optional<T> optional_value(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional<T>(json.get<T>());
}

template <class T>
Json to_json(const VecT<T>& v) {
  return {v.x, v.y, v.z};
}

template <class T>
VecT<T> vector_of(const Json& json) {
  return {json.at(0).get<T>(), json.at(1).get<T>(), json.at(2).get<T>()};
}

Json to_json(const PartitionOptions& o) {
  return {{"max_depth", optional_json(o.max_depth)},
          {"error", optional_json(o.error)},
          {"support", optional_json(o.support)},
          {"max_degree", o.max_degree},
          {"min_samples", o.min_samples},
          {"max_samples", o.max_samples},
          {"coverage", o.coverage},
          {"max_eccentricity", o.max_eccentricity},
          {"sharp", o.sharp}};
}

PartitionOptions options_of(const Json& json) {
  PartitionOptions o;
  o.max_depth = optional_value<int>(json.at("max_depth"));
  o.error = optional_value<double>(json.at("error"));
  o.support = optional_value<double>(json.at("support"));
  json.at("max_degree").get_to(o.max_degree);
  json.at("min_samples").get_to(o.min_samples);
  json.at("max_samples").get_to(o.max_samples);
  json.at("coverage").get_to(o.coverage);
  json.at("max_eccentricity").get_to(o.max_eccentricity);
  json.at("sharp").get_to(o.sharp);
  return o;
}

Json to_json(const PartitionReport& r) {
  return {{"noise", r.noise},         {"error", r.error},
          {"accuracy", r.accuracy},   {"area", r.area},
          {"spacing", r.spacing},     {"depth", r.depth},
          {"functions", r.functions}, {"functions_of_degree", r.functions_of_degree},
          {"creased", r.creased}};
}

PartitionReport report_of(const Json& json) {
  PartitionReport r;
  json.at("noise").get_to(r.noise);
  json.at("error").get_to(r.error);
  json.at("accuracy").get_to(r.accuracy);
  json.at("area").get_to(r.area);
  json.at("spacing").get_to(r.spacing);
  json.at("depth").get_to(r.depth);
  json.at("functions").get_to(r.functions);
  json.at("functions_of_degree").get_to(r.functions_of_degree);
  json.at("creased").get_to(r.creased);
  return r;
}

Json to_json(const ScaleBasis& b) {
  return {{"sort_depth", b.sort_depth}, {"tried", b.tried},       {"finest", b.finest},
          {"variance", b.variance},     {"accepted", b.accepted}, {"support", b.support}};
}

ScaleBasis basis_of(const Json& json) {
  ScaleBasis b;
  json.at("sort_depth").get_to(b.sort_depth);
  json.at("tried").get_to(b.tried);
  json.at("finest").get_to(b.finest);
  json.at("variance").get_to(b.variance);
  json.at("accepted").get_to(b.accepted);
  json.at("support").get_to(b.support);
  return b;
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

/// The next `n` elements of an array that holds several.
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

void read_flatness(const SectionFile& file, const Json& json, PartitionData& data) {
  const auto sizes = json.at("levels").get<std::vector<std::size_t>>();
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

PointSet read_samples(const SectionFile& file) {
  PointSet samples;
  if (!file.has("POSITION")) return samples;
  samples.positions = file.array<Vec3f>("POSITION").copy();
  const std::size_t n = samples.size();
  read_samples(file, "NORMAL", n, samples.normals);
  read_samples(file, "COLOR", n, samples.colors);
  for (const std::vector<Vec3f>* vectors : {&samples.positions, &samples.normals})
    for (const Vec3f& v : *vectors)
      if (!is_finite(v)) throw DataError("its samples are not all finite");
  if (samples.normals.size() != n) throw DataError("its samples have no normals");
  return samples;
}

}  // namespace

bool is_function_file(const std::string& file) {
  const auto ends = [&](const char* ending) { return file.ends_with(ending); };
  return ends(".smf") || ends(".smf.gz") || ends(".SMF");
}

void write_function(const std::string& file, const SurfaceFunction& function, bool with_samples) {
  const PartitionData& data = function.field.data();
  Json levels = Json::array();
  for (const PartitionData::Flatness& f : data.flatness) levels.push_back(f.code.size());
  const Json json = {{"kind", kKind},
                     {"origin", to_json(function.origin)},
                     {"unit", function.unit},
                     {"field_origin", to_json(data.origin)},
                     {"cube", {{"lower", to_json(data.lower)}, {"edge", data.edge}}},
                     {"options", to_json(data.options)},
                     {"report", to_json(data.report)},
                     {"basis", to_json(data.basis)},
                     {"levels", levels},
                     {"history", function.history}};
  const std::string text = json.dump(1);
  const auto code = joined<std::uint64_t>(
      data, [](const auto& f) -> const auto& { return f.code; });
  const auto gap = joined<float>(
      data, [](const auto& f) -> const auto& { return f.gap; });
  const auto child = joined<std::uint32_t>(
      data, [](const auto& f) -> const auto& { return f.child; });
  std::vector<Section> sections{{"META", 1, text},
                                section_of("FUNCTION", data.functions.view()),
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

SurfaceFunction read_function(const std::string& name) {
  const SectionFile file(name);
  try {
    const Json json = Json::parse(file.text("META"));
    if (json.at("kind").get<std::string>() != kKind)
      throw DataError(fmt::format("holds a {}, not a {}", json.at("kind").get<std::string>().substr(0, 40), kKind));
    PartitionData data;
    data.origin = vector_of<double>(json.at("field_origin"));
    data.lower = vector_of<float>(json.at("cube").at("lower"));
    json.at("cube").at("edge").get_to(data.edge);
    data.options = options_of(json.at("options"));
    data.report = report_of(json.at("report"));
    data.basis = basis_of(json.at("basis"));
    data.functions = file.array<LocalFunction>("FUNCTION");
    data.supports = file.array<Support>("SUPPORT");
    read_flatness(file, json, data);
    data.validate();
    auto samples = std::make_shared<PointSet>(read_samples(file));
    samples->origin = data.origin;
    const Vec3 origin = vector_of<double>(json.at("origin"));
    const double unit = json.at("unit").get<double>();
    if (!is_finite(origin) || !(unit > 1e-60 && unit < 1e60)) throw DataError("its place in the input makes no sense");
    return {PartitionOfUnity(std::move(data)),
            origin,
            unit,
            std::move(samples),
            json.at("history").get<std::vector<std::string>>(),
            {}};
  } catch (const nlohmann::json::exception&) {
    throw FileError(name, "damaged: its description (section META) makes no sense");
  } catch (const ArgumentError& error) {
    throw FileError(name, fmt::format("damaged: {}", error.what()));
  } catch (const DataError& error) {
    throw FileError(name, fmt::format("damaged: {}", error.what()));
  }
}

}  // namespace sansmesh
