// Edit scripts: JSON input and output (docs/formats/edit-script.md).
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "sansmesh/core/json_fields-inl.h"
#include "sansmesh/error.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/partition/edit/partition_edit.h"

namespace sansmesh::inline v1 {
namespace {

using Fields = detail::JsonFields;
using Json = detail::JsonValue;

constexpr int kVersion = 1;

/// Detects duplicate fields of an object during parsing, where the last one would silently win.
class TwiceGiven {
 public:
  /// Callback of the parser; true: continue.
  bool operator()(Json::parse_event_t event, const Json& parsed) {
    using Event = Json::parse_event_t;
    if (event == Event::key) {
      Object& object = *open_.back().object;
      object.last = parsed.get_ref<const std::string&>();
      if (!object.keys.insert(object.last).second && what_.empty())
        what_ = fmt::format("{}: '{}' is given twice", where(), printable(object.last, 40));
    } else if (event == Event::object_end || event == Event::array_end) {
      open_.pop_back();
    } else {
      if (!open_.empty()) ++open_.back().elements;
      if (event != Event::value) open_.push_back({event == Event::object_start ? std::make_unique<Object>() : nullptr});
    }
    return true;
  }
  /// Description of the first duplicate in one line; empty: none.
  const std::string& what() const { return what_; }

 private:
  struct Object {
    std::set<std::string> keys;
    std::string last;
  };
  /// An enclosing object or list of the parser's position.
  struct Open {
    std::unique_ptr<Object> object;  ///< null: a list
    std::size_t elements = 0;        ///< number of elements of a list so far
  };

  /// "step 3.select", as in the other errors.
  std::string where() const {
    const bool in_steps = open_.size() > 2 && open_[0].object && open_[0].object->last == "steps" && !open_[1].object;
    std::string location = in_steps ? fmt::format("step {}", open_[1].elements) : "the script";
    for (std::size_t i = in_steps ? 2 : 0; i + 1 < std::min<std::size_t>(open_.size(), 8); ++i)
      if (open_[i].object) location += "." + printable(open_[i].object->last, 40);
    return location;
  }

  std::vector<Open> open_;
  std::string what_;
};

EditSelection selection_of(const Json& json, const std::string& where) {
  const Fields f(json, where,
                 {"ball", "box", "half_space", "coverage", "coverage_below", "error_above", "samples_below",
                  "level_from", "level_to", "sheet_at", "sheets"});
  EditSelection s;
  if (f.has("ball")) {
    const Fields b(f.at("ball"), where + ".ball", {"center", "radius"});
    s.ball = {b.vector("center"), b.number("radius")};
  }
  if (f.has("box")) {
    const Fields b(f.at("box"), where + ".box", {"lower", "upper"});
    s.box = Box3{b.vector("lower"), b.vector("upper")};
  }
  if (f.has("half_space")) {
    const Fields b(f.at("half_space"), where + ".half_space", {"point", "normal"});
    s.half_space = {b.vector("point"), b.vector("normal")};
  }
  if (f.has("coverage")) {
    const Json& v = f.at("coverage");
    const bool numbers = v.is_array() && v.size() == 3 && v[0].is_number() && v[1].is_number() && v[2].is_number();
    if (v != "fails" && !numbers) f.fail("'coverage' must be \"fails\" or three numbers");
    s.coverage_fails = kThesisCoverage;
    for (std::size_t d = 0; numbers && d < 3; ++d) (*s.coverage_fails)[d] = v[d].get<double>();
  }
  f.get("coverage_below", s.coverage_below, &Fields::number);
  f.get("error_above", s.error_above, &Fields::number);
  f.get("samples_below", s.samples_below, &Fields::integer);
  f.get("level_from", s.level_from, &Fields::integer);
  f.get("level_to", s.level_to, &Fields::integer);
  f.get("sheet_at", s.sheet_at, &Fields::vector);
  if (f.has("sheets")) {
    const Json& v = f.at("sheets");
    s.spurious_sheets = v == "spurious";
    s.all_but_largest = v == "all but largest";
    if (!s.spurious_sheets && !s.all_but_largest) f.fail("'sheets' must be \"spurious\" or \"all but largest\"");
  }
  try {
    s.validate();
  } catch (const ArgumentError& error) {
    f.fail(error.what());
  }
  return s;
}

Refit refit_of(const Json& json, const std::string& where) {
  const Fields f(json, where, {"max_degree", "max_depth", "error", "support", "sharp"});
  Refit r;
  f.get("max_degree", r.max_degree, &Fields::integer);
  f.get("max_depth", r.max_depth, &Fields::integer);
  f.get("error", r.error, &Fields::number);
  f.get("support", r.support, &Fields::number);
  f.get("sharp", r.sharp, &Fields::boolean);
  PartitionOptions o;
  o.max_depth = r.max_depth, o.error = r.error, o.support = r.support;
  if (r.max_degree) o.max_degree = *r.max_degree;
  try {
    o.validate();
  } catch (const ArgumentError& error) {
    f.fail(error.what());
  }
  return r;
}

Edit edit_of(const Json& json, const std::string& where) {
  const Fields f(json, where, {"select", "degree", "refit", "constant", "remove", "undo", "note"});
  Edit edit;
  int actions = 0;
  const auto is = [&](const char* key) { return f.has(key) && ++actions; };
  if (is("degree")) {
    const bool automatic = f.at("degree") == "auto";
    const int degree = automatic ? kAutomaticDegree : f.integer("degree");
    if (!automatic && (degree < 0 || degree > 4)) f.fail("'degree' must be \"auto\" or lie in 0..4");
    edit.action = SetDegree{degree};
  }
  if (is("refit")) edit.action = refit_of(f.at("refit"), where + ".refit");
  if (is("constant")) {
    const Json& v = f.at("constant");
    if (v == "outside")
      edit.action = SetConstant{1};
    else if (v == "inside")
      edit.action = SetConstant{-1};
    else if (v == "auto")
      edit.action = SetConstant{1, true};
    else if (v.is_number())
      edit.action = SetConstant{v.get<double>()};
    else
      f.fail("'constant' must be \"outside\", \"inside\", \"auto\" or a number (in radii of the supports)");
    const double value = std::abs(std::get<SetConstant>(edit.action).value);
    if (!(value >= kLeastConstant && value <= kMostConstant))
      f.fail(fmt::format("'constant' must lie between {} and {} radii of a support, positive or negative",
                         kLeastConstant, kMostConstant));
  }
  if (is("remove")) {
    if (!f.boolean("remove")) f.fail("'remove' can only be true");
    edit.action = RemoveSupports{};
  }
  if (is("undo")) {
    edit.action = Undo{f.integer("undo")};
    if (std::get<Undo>(edit.action).steps < 1) f.fail("'undo' must be at least 1");
  }
  if (actions != 1) f.fail("needs one of degree, refit, constant, remove, undo");
  const bool undo = std::holds_alternative<Undo>(edit.action);
  if (undo == f.has("select"))
    f.fail(undo ? "'undo' takes no 'select'" : "'select' is missing ({} selects everything)");
  if (!undo) edit.select = selection_of(f.at("select"), where + ".select");
  return edit;
}

/// Omits unset fields.
template <class T>
void put(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

Json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json to_json(const EditSelection& s) {
  Json json = Json::object();
  if (s.ball) json["ball"] = {{"center", to_json(s.ball->center)}, {"radius", s.ball->radius}};
  if (s.box) json["box"] = {{"lower", to_json(s.box->lower)}, {"upper", to_json(s.box->upper)}};
  if (s.half_space)
    json["half_space"] = {{"point", to_json(s.half_space->point)}, {"normal", to_json(s.half_space->normal)}};
  if (s.coverage_fails) json["coverage"] = *s.coverage_fails;
  put(json, "coverage_below", s.coverage_below);
  put(json, "error_above", s.error_above);
  put(json, "samples_below", s.samples_below);
  put(json, "level_from", s.level_from);
  put(json, "level_to", s.level_to);
  if (s.sheet_at) json["sheet_at"] = to_json(*s.sheet_at);
  // The largest sheet is never spurious.
  if (s.spurious_sheets)
    json["sheets"] = "spurious";
  else if (s.all_but_largest)
    json["sheets"] = "all but largest";
  return json;
}

Json to_json(const Refit& r) {
  Json json = Json::object();
  put(json, "max_degree", r.max_degree);
  put(json, "max_depth", r.max_depth);
  put(json, "error", r.error);
  put(json, "support", r.support);
  put(json, "sharp", r.sharp);
  return json;
}

}  // namespace

std::vector<Edit> parse_edit_script(const std::string& text) {
  TwiceGiven twice;
  const auto json = detail::parse_json<Json>(
      text, [&](int, Json::parse_event_t event, const Json& parsed) { return twice(event, parsed); });
  if (!twice.what().empty()) throw ArgumentError(twice.what());
  const Fields f(json, "the script", {"version", "steps", "function", "note"});
  if (f.integer("version") != kVersion)
    f.fail(fmt::format("version {} is not known, only {}", f.integer("version"), kVersion));
  if (!f.has("steps") || !f.at("steps").is_array()) f.fail("'steps' must be a list");
  std::vector<Edit> edits;
  int number = 0;
  for (const Json& step : f.at("steps")) edits.push_back(edit_of(step, fmt::format("step {}", ++number)));
  return edits;
}

std::string edit_script(const std::vector<Edit>& edits) {
  Json steps = Json::array();
  for (const Edit& edit : edits) {
    Json step = Json::object();
    if (!std::holds_alternative<Undo>(edit.action)) step["select"] = to_json(edit.select);
    if (const auto* a = std::get_if<SetDegree>(&edit.action)) {
      if (a->degree == kAutomaticDegree)
        step["degree"] = "auto";
      else
        step["degree"] = a->degree;
    }
    if (const auto* a = std::get_if<Refit>(&edit.action)) step["refit"] = to_json(*a);
    if (const auto* a = std::get_if<SetConstant>(&edit.action)) {
      if (a->automatic)
        step["constant"] = "auto";
      else
        step["constant"] = a->value;
    }
    if (std::holds_alternative<RemoveSupports>(edit.action)) step["remove"] = true;
    if (const auto* a = std::get_if<Undo>(&edit.action)) step["undo"] = a->steps;
    steps.push_back(std::move(step));
  }
  return Json{{"version", kVersion}, {"steps", steps}}.dump(2) + "\n";
}

}  // namespace sansmesh::inline v1
