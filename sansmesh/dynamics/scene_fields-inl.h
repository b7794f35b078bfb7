// JSON of scenes: objects all of whose keys must be known, with errors that tell the place.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/core/json_text-inl.h"
#include "sansmesh/error.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

using SceneJson = nlohmann::ordered_json;

/// An object of the scene. All members throw ArgumentError that begins with the place.
class SceneFields {
 public:
  SceneFields(const SceneJson& json, std::string where, std::initializer_list<std::string_view> known);

  [[noreturn]] void fail(const std::string& cause) const;
  bool has(const char* key) const;
  std::string where(const char* key) const { return where_.empty() ? std::string(key) : where_ + "." + key; }
  const SceneJson& at(const char* key) const;
  double number(const char* key) const;
  int whole(const char* key) const;
  std::string text(const char* key) const;
  Vec3 vector(const char* key) const;
  Vec3 direction(const char* key) const;  ///< of length 1
  template <class T, class Get>
  void get(const char* key, std::optional<T>& value, Get&& how) const {
    if (has(key)) value = (this->*how)(key);
  }

 private:
  const SceneJson& json_;
  std::string where_;
};

/// Throws ArgumentError for what is no JSON, and for a key that an object has twice: one of them would win unnoticed.
inline SceneJson parse_scene_json(const std::string& text) {
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
  auto json = parse_json<SceneJson>(text, look, true);
  if (!twice.empty()) throw ArgumentError(fmt::format("'{}' is given twice", printable(twice, 40)));
  return json;
}

inline SceneFields::SceneFields(const SceneJson& json, std::string where, std::initializer_list<std::string_view> known)
    : json_(json), where_(std::move(where)) {
  if (!json.is_object()) fail("must be an object");
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string all;
    for (const std::string_view k : known) all += (all.empty() ? "" : ", ") + std::string(k);
    fail(fmt::format("unknown key '{}'; known: {}", printable(key, 40), all));
  }
}

inline void SceneFields::fail(const std::string& cause) const {
  throw ArgumentError(where_.empty() ? cause : where_ + ": " + cause);
}

inline bool SceneFields::has(const char* key) const { return json_.contains(key); }

inline const SceneJson& SceneFields::at(const char* key) const {
  if (!has(key)) fail(fmt::format("'{}' is missing", key));
  return json_.at(key);
}

inline double SceneFields::number(const char* key) const {
  const SceneJson& v = at(key);
  if (!v.is_number() || !std::isfinite(v.get<double>())) fail(fmt::format("'{}' must be a number", key));
  return v.get<double>();
}

inline int SceneFields::whole(const char* key) const {
  const double v = number(key);
  if (v != std::floor(v) || std::abs(v) > 1e9) fail(fmt::format("'{}' must be a whole number", key));
  return static_cast<int>(v);
}

inline std::string SceneFields::text(const char* key) const {
  const SceneJson& v = at(key);
  if (!v.is_string()) fail(fmt::format("'{}' must be a text", key));
  return v.get<std::string>();
}

inline Vec3 SceneFields::vector(const char* key) const {
  const SceneJson& v = at(key);
  const auto finite = [](const SceneJson& c) { return c.is_number() && std::isfinite(c.get<double>()); };
  if (!v.is_array() || v.size() != 3 || !std::all_of(v.begin(), v.end(), finite))
    fail(fmt::format("'{}' must be three numbers", key));
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

inline Vec3 SceneFields::direction(const char* key) const {
  const Vec3 v = vector(key);
  if (!(norm(v) > 0)) fail(fmt::format("'{}' has no direction", key));
  return normalized(v);
}

/// The entries of a list, with the place of each; anything else stands for a list of it alone. An empty list, which
/// would say nothing, is an error.
inline std::vector<std::pair<std::string, const SceneJson*>> scene_entries(const SceneJson& json,
                                                                           const std::string& where) {
  std::vector<std::pair<std::string, const SceneJson*>> all;
  if (!json.is_array()) return {{where, &json}};
  if (json.empty()) throw ArgumentError(where + ": the list is empty");
  all.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k) all.emplace_back(fmt::format("{} {}", where, k + 1), &json[k]);
  return all;
}

}  // namespace sansmesh::inline v1::detail
