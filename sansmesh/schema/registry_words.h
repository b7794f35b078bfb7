// Names of a registry as the words of an option.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/option.h"
#include "sansmesh/schema/registry.h"

namespace sansmesh::inline v1 {

/// For fields whose words are known only at run time: `option<&Options::method, ListedWords<names>>`, whose `choices`
/// are names().
template <const std::vector<std::string_view>& (*list)()>
struct ListedWords {
  static constexpr auto kind = OptionKind::choice;

  static const std::vector<std::string_view>& names() { return list(); }
  static OptionValue get(const std::string& name) {
    for (std::size_t i = 0; i < names().size(); ++i)
      if (names()[i] == name) return static_cast<std::int64_t>(i);
    return name;  // unknown name: see option_value
  }
  static std::string from(const OptionValue& value) {
    return std::string(names().at(static_cast<std::size_t>(std::get<std::int64_t>(value))));
  }
};

/// Names of a registry. Programs must add entries before options are read.
template <class Entry>
const std::vector<std::string_view>& registry_names() {
  static const std::vector<std::string_view> list = [] {
    std::vector<std::string_view> all;
    for (const Entry* const entry : Entry::registry().all()) all.emplace_back(entry->name);
    return all;
  }();
  return list;
}
/// Names with summaries, for entries that have a `summary`: "euler (first order), rk4 (fourth order)".
template <class Entry>
std::string registry_summaries() {
  std::string text;
  for (const Entry* const entry : Entry::registry().all())
    text += (text.empty() ? "" : ", ") + std::string(entry->name) + " (" + std::string(entry->summary) + ")";
  return text;
}
template <class Entry>
using RegistryWords = ListedWords<registry_names<Entry>>;

}  // namespace sansmesh::inline v1
