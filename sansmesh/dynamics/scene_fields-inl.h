// JSON of scenes: lists that may be single entries.
#pragma once

#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/json_fields-inl.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {

using SceneFields = JsonFields;
using SceneJson = OrderedJson;

/// The entries of a list, with the place of each; a value that is no list is its only entry. An empty list is an error.
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
