#include "sansmesh/dynamics/scene_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "sansmesh/core/error.h"

namespace sansmesh::detail {

SceneJson parse_scene_json(const std::string& text) {
  std::vector<std::set<std::string>> open;
  std::string twice;
  const auto look = [&](int, SceneJson::parse_event_t event, SceneJson& parsed) {
    using Event = SceneJson::parse_event_t;
    if (event == Event::object_start) open.emplace_back();
    if (event == Event::object_end) open.pop_back();
    if (event == Event::key && !open.back().insert(parsed.get_ref<const std::string&>()).second && twice.empty())
      twice = parsed.get_ref<const std::string&>();
    return true;
  };
  SceneJson json;
  try {
    json = SceneJson::parse(text, look, true, true);
  } catch (const SceneJson::exception& error) {
    const std::string what = error.what();
    const std::size_t at = what.find("parse error");
    throw ArgumentError("is no JSON: " + printable(at == std::string::npos ? what : what.substr(at), 200));
  }
  if (!twice.empty()) throw ArgumentError(fmt::format("'{}' is given twice", printable(twice, 40)));
  return json;
}

SceneFields::SceneFields(const SceneJson& json, std::string where, std::initializer_list<std::string_view> known)
    : json_(json), where_(std::move(where)) {
  if (!json.is_object()) fail("must be an object");
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string all;
    for (const std::string_view k : known) all += (all.empty() ? "" : ", ") + std::string(k);
    fail(fmt::format("unknown key '{}'; known: {}", printable(key, 40), all));
  }
}

void SceneFields::fail(const std::string& cause) const {
  throw ArgumentError(where_.empty() ? cause : where_ + ": " + cause);
}

bool SceneFields::has(const char* key) const { return json_.contains(key); }

const SceneJson& SceneFields::at(const char* key) const {
  if (!has(key)) fail(fmt::format("'{}' is missing", key));
  return json_.at(key);
}

double SceneFields::number(const char* key) const {
  const SceneJson& v = at(key);
  if (!v.is_number() || !std::isfinite(v.get<double>())) fail(fmt::format("'{}' must be a number", key));
  return v.get<double>();
}

int SceneFields::whole(const char* key) const {
  const double v = number(key);
  if (v != std::floor(v) || std::abs(v) > 1e9) fail(fmt::format("'{}' must be a whole number", key));
  return static_cast<int>(v);
}

std::string SceneFields::text(const char* key) const {
  const SceneJson& v = at(key);
  if (!v.is_string()) fail(fmt::format("'{}' must be a text", key));
  return v.get<std::string>();
}

Vec3 SceneFields::vector(const char* key) const {
  const SceneJson& v = at(key);
  const auto finite = [](const SceneJson& c) { return c.is_number() && std::isfinite(c.get<double>()); };
  if (!v.is_array() || v.size() != 3 || !std::all_of(v.begin(), v.end(), finite))
    fail(fmt::format("'{}' must be three numbers", key));
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

Vec3 SceneFields::direction(const char* key) const {
  const Vec3 v = vector(key);
  if (!(norm(v) > 0)) fail(fmt::format("'{}' has no direction", key));
  return normalized(v);
}

std::vector<std::pair<std::string, const SceneJson*>> scene_entries(const SceneJson& json, const std::string& where) {
  std::vector<std::pair<std::string, const SceneJson*>> all;
  if (!json.is_array()) return {{where, &json}};
  if (json.empty()) throw ArgumentError(where + ": the list is empty");
  all.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k) all.emplace_back(fmt::format("{} {}", where, k + 1), &json[k]);
  return all;
}

}  // namespace sansmesh::detail
