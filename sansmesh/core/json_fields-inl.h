// JSON objects whose keys must all be known, with errors that name the location. Only for sources, as json_text-inl.h.
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

using JsonValue = nlohmann::ordered_json;

/// Three finite numbers.
inline std::optional<Vec3> json_vector(const JsonValue& v) {
  const auto finite = [](const JsonValue& c) { return c.is_number() && std::isfinite(c.get<double>()); };
  if (!v.is_array() || v.size() != 3 || !std::all_of(v.begin(), v.end(), finite)) return std::nullopt;
  return Vec3{v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

/// An object with some of the keys `known`. All members throw ArgumentError that begins with the location.
class JsonFields {
 public:
  JsonFields(const JsonValue& json, std::string where, std::initializer_list<std::string_view> known)
      : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("must be an object");
    for (const auto& [key, value] : json.items()) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      std::string all;
      for (const std::string_view k : known) all += (all.empty() ? "" : ", ") + std::string(k);
      fail(fmt::format("unknown key '{}'; known: {}", printable(key, 40), all));
    }
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ArgumentError(where_.empty() ? cause : where_ + ": " + cause);
  }
  bool has(const char* key) const { return json_.contains(key); }
  std::string where(const char* key) const { return where_.empty() ? std::string(key) : where_ + "." + key; }
  const JsonValue& at(const char* key) const {
    if (!has(key)) fail(fmt::format("'{}' is missing", key));
    return json_.at(key);
  }
  double number(const char* key) const {
    const JsonValue& v = at(key);
    if (!v.is_number() || !std::isfinite(v.get<double>())) fail(fmt::format("'{}' must be a number", key));
    return v.get<double>();
  }
  int whole(const char* key) const {
    const double v = number(key);
    if (v != std::floor(v) || std::abs(v) > 1e9) fail(fmt::format("'{}' must be a whole number", key));
    return static_cast<int>(v);
  }
  bool boolean(const char* key) const {
    const JsonValue& v = at(key);
    if (!v.is_boolean()) fail(fmt::format("'{}' must be true or false", key));
    return v.get<bool>();
  }
  std::string text(const char* key) const {
    const JsonValue& v = at(key);
    if (!v.is_string()) fail(fmt::format("'{}' must be a text", key));
    return v.get<std::string>();
  }
  Vec3 vector(const char* key) const {
    if (const std::optional<Vec3> v = json_vector(at(key))) return *v;
    fail(fmt::format("'{}' must be three numbers", key));
  }
  Vec3 direction(const char* key) const {  ///< unit vector
    const Vec3 v = vector(key);
    if (!(norm(v) > 0)) fail(fmt::format("'{}' has no direction", key));
    return normalized(v);
  }
  template <class T, class Get>
  void get(const char* key, std::optional<T>& value, Get&& how) const {
    if (has(key)) value = (this->*how)(key);
  }

 private:
  const JsonValue& json_;
  std::string where_;
};

/// Throws ArgumentError for invalid JSON and for a duplicate key, which would otherwise override the first silently.
inline JsonValue parse_json_once(std::string_view text, bool comments = false) {
  std::vector<std::set<std::string>> open;
  std::string twice;
  const auto look = [&](int, JsonValue::parse_event_t event, JsonValue& parsed) {
    using Event = JsonValue::parse_event_t;
    if (event == Event::object_start) open.emplace_back();
    if (event == Event::object_end) open.pop_back();
    if (event == Event::key && !open.back().insert(parsed.get_ref<const std::string&>()).second && twice.empty())
      twice = parsed.get_ref<const std::string&>();
    return true;
  };
  auto json = parse_json<JsonValue>(text, look, comments);
  if (!twice.empty()) throw ArgumentError(fmt::format("'{}' is given twice", printable(twice, 40)));
  return json;
}

/// The entries of a list with the location of each; anything else counts as a list of one entry. An empty list is an
/// error, because it has no effect.
inline std::vector<std::pair<std::string, const JsonValue*>> json_entries(const JsonValue& json,
                                                                          const std::string& where) {
  std::vector<std::pair<std::string, const JsonValue*>> all;
  if (!json.is_array()) return {{where, &json}};
  if (json.empty()) throw ArgumentError(where + ": the list is empty");
  all.reserve(json.size());
  for (std::size_t k = 0; k < json.size(); ++k) all.emplace_back(fmt::format("{} {}", where, k + 1), &json[k]);
  return all;
}

}  // namespace sansmesh::inline v1::detail
