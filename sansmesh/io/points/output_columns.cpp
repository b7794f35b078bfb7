#include "sansmesh/io/points/output_columns.h"

#include <unordered_set>

#include "sansmesh/core/option_text.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1::io {

char* OutputColumn::put_text(char* p, std::size_t row) const {
  const std::size_t i = row * attribute->components + component;
  return std::visit([&](const auto& values) { return put(p, values[i]); }, attribute->values);
}

char* OutputColumn::put_bytes(char* p, std::size_t row) const {
  const std::size_t i = row * attribute->components + component;
  return std::visit([&](const auto& values) { return io::put_bytes(p, values[i]); }, attribute->values);
}

std::string one_word(std::string_view name) {
  std::string word(name);
  for (char& c : word) {
    const bool tears =
        static_cast<unsigned char>(c) <= ' ' || c == '\x7f' || c == ',' || c == ';' || c == '"' || c == '\'';
    if (tears) c = '_';
  }
  return word;
}

std::vector<OutputColumn> output_columns(const AttributeTable& table, const std::vector<std::string>& taken) {
  std::unordered_set<std::string> used(taken.begin(), taken.end());
  std::vector<OutputColumn> columns;
  for (const Attribute& a : table) {
    const std::string word = one_word(a.name);
    // All components receive the same number, so that they are one attribute when read again.
    const auto name = [&](const std::string& base, std::size_t c) {
      return a.components == 1 ? base : base + "_" + std::to_string(c);
    };
    std::string base = word;
    for (std::size_t number = 2;; ++number) {
      bool free = true;
      for (std::size_t c = 0; c < a.components; ++c) free = free && used.count(lower_case(name(base, c))) == 0;
      if (free) break;
      base = word + "_" + std::to_string(number);
    }
    for (std::size_t c = 0; c < a.components; ++c) {
      columns.push_back({name(base, c), &a, c});
      used.insert(lower_case(columns.back().name));
    }
  }
  return columns;
}

std::size_t row_bytes(const std::vector<OutputColumn>& columns) {
  std::size_t sum = 0;
  for (const OutputColumn& c : columns) sum += size_of(c.type());
  return sum;
}

}  // namespace sansmesh::inline v1::io
