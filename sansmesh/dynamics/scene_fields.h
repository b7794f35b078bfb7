// JSON of scenes: objects all of whose keys must be known, with errors that tell the place.
#pragma once

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/core/vec.h"

namespace sansmesh::detail {

using SceneJson = nlohmann::ordered_json;

/// Throws ArgumentError for what is no JSON, and for a key that an object has twice: one of them would win unnoticed.
SceneJson parse_scene_json(const std::string& text);

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

/// The entries of a list, with the place of each; anything else stands for a list of it alone. An empty list, which
/// would say nothing, is an error.
std::vector<std::pair<std::string, const SceneJson*>> scene_entries(const SceneJson& json, const std::string& where);

}  // namespace sansmesh::detail
