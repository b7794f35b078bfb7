// Objects of JSON with known keys: typed values, and errors that name the place. Only for sources, like
// json_text-inl.h.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
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

using OrderedJson = nlohmann::ordered_json;

/// Throws ArgumentError, in one line, for a key that is not known.
inline void check_known_keys(const OrderedJson& json, std::initializer_list<std::string_view> known,
                             const std::string& where) {
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string all;
    for (const std::string_view k : known) all += (all.empty() ? "" : ", ") + std::string(k);
    throw ArgumentError(
        fmt::format("{}{}unknown key '{}'; known: {}", where, where.empty() ? "" : ": ", printable(key, 40), all));
  }
}

/// An object whose keys are all known. Errors are ArgumentErrors that begin with the place.
class JsonFields {
 public:
  JsonFields(const OrderedJson& json, std::string where, std::initializer_list<std::string_view> known)
      : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("must be an object");
    check_known_keys(json, known, where_);
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ArgumentError(where_.empty() ? cause : where_ + ": " + cause);
  }
  bool has(const char* key) const { return json_.contains(key); }
  /// The place of a value.
  std::string where(const char* key) const { return where_.empty() ? std::string(key) : where_ + "." + key; }
  const OrderedJson& at(const char* key) const {
    if (!has(key)) fail(fmt::format("'{}' is missing", key));
    return json_.at(key);
  }
  double number(const char* key) const {
    const OrderedJson& v = at(key);
    if (!v.is_number() || !std::isfinite(v.get<double>())) fail(fmt::format("'{}' must be a number", key));
    return v.get<double>();
  }
  int whole(const char* key) const {
    const double v = number(key);
    if (v != std::floor(v) || std::abs(v) > 1e9) fail(fmt::format("'{}' must be a whole number", key));
    return static_cast<int>(v);
  }
  bool flag(const char* key) const {
    if (!at(key).is_boolean()) fail(fmt::format("'{}' must be true or false", key));
    return at(key).get<bool>();
  }
  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(fmt::format("'{}' must be a text", key));
    return at(key).get<std::string>();
  }
  Vec3 vector(const char* key) const {
    const OrderedJson& v = at(key);
    const auto finite = [](const OrderedJson& c) { return c.is_number() && std::isfinite(c.get<double>()); };
    if (!v.is_array() || v.size() != 3 || !std::all_of(v.begin(), v.end(), finite))
      fail(fmt::format("'{}' must be three numbers", key));
    return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
  }
  /// A vector of length 1.
  Vec3 direction(const char* key) const {
    const Vec3 v = vector(key);
    if (!(norm(v) > 0)) fail(fmt::format("'{}' has no direction", key));
    return normalized(v);
  }
  template <class T, class Get>
  void get(const char* key, std::optional<T>& value, Get&& how) const {
    if (has(key)) value = (this->*how)(key);
  }

 private:
  const OrderedJson& json_;
  std::string where_;
};

/// Parses JSON in which no object has a key twice, because the last one would silently win. Throws ArgumentError, with
/// the place: keys joined by ".", and the numbers of list elements, as in "steps 2.select".
inline OrderedJson parse_json_once(std::string_view text, bool comments = false) {
  struct Object {
    std::set<std::string> keys;
    std::string last;
  };
  struct Level {
    std::unique_ptr<Object> object;  // null: a list
    std::size_t elements = 0;        // of a list so far
  };
  constexpr std::size_t kShown = 8;
  std::vector<Level> open;
  std::string error;
  const auto look = [&](int, OrderedJson::parse_event_t event, OrderedJson& parsed) {
    using Event = OrderedJson::parse_event_t;
    if (event == Event::key) {
      Object& object = *open.back().object;
      object.last = parsed.get_ref<const std::string&>();
      if (object.keys.insert(object.last).second || !error.empty()) return true;
      std::string where;
      for (std::size_t i = 0; i + 1 < std::min(open.size(), kShown); ++i)
        where += open[i].object ? (where.empty() ? "" : ".") + printable(open[i].object->last, 40)
                                : fmt::format("{}{}", where.empty() ? "" : " ", open[i].elements);
      error = fmt::format("{}{}'{}' is given twice", where, where.empty() ? "" : ": ", printable(object.last, 40));
    } else if (event == Event::object_end || event == Event::array_end) {
      open.pop_back();
    } else {
      if (!open.empty()) ++open.back().elements;
      if (event != Event::value) open.push_back({event == Event::object_start ? std::make_unique<Object>() : nullptr});
    }
    return true;
  };
  OrderedJson json = parse_json<OrderedJson>(text, look, comments);
  if (!error.empty()) throw ArgumentError(error);
  return json;
}

}  // namespace sansmesh::inline v1::detail
