// Words that users write for the values of an enumeration.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/core/error.h"

namespace sansmesh {

template <class Value>
struct Named {
  Value value;
  const char* name;
};

/// "a, b, c"
inline std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

template <class Value, std::size_t kCount>
std::vector<std::string> names_of(const Named<Value> (&table)[kCount]) {
  std::vector<std::string> names;
  names.reserve(kCount);
  for (const Named<Value>& n : table) names.emplace_back(n.name);
  return names;
}

/// Throws ArgumentError that names `what` it should be and the choices.
template <class Value, std::size_t kCount>
Value value_of(const Named<Value> (&table)[kCount], const char* what, const std::string& name) {
  for (const Named<Value>& n : table)
    if (name == n.name) return n.value;
  throw ArgumentError(std::string("unknown ") + what + " '" + name + "': known are " + listed(names_of(table)));
}

}  // namespace sansmesh
