// Attributes as columns of one number each: how formats of rows hold them.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/attribute_table.h"

namespace sansmesh::inline v1::io {

/// One component of an attribute.
struct OutputColumn {
  std::string name;  ///< one word, no two alike in either case
  const Attribute* attribute = nullptr;
  std::size_t component = 0;

  NumberType type() const { return attribute->type(); }
  /// Appends the number of a row as text, the shortest that reads back as the same; returns the new end.
  char* put_text(char* p, std::size_t row) const;
  /// Appends its bytes.
  char* put_bytes(char* p, std::size_t row) const;
};

/// A name as one word for a header of words: blanks, separators and quotes become '_'.
std::string one_word(std::string_view name);

/// The columns of a table, components one after the other as name_0, name_1, … Names become single words, and get a
/// number where another column has them; `taken`: names of the columns before (in lower case).
std::vector<OutputColumn> output_columns(const AttributeTable& table, const std::vector<std::string>& taken = {});

/// Bytes that one row takes.
std::size_t row_bytes(const std::vector<OutputColumn>& columns);

}  // namespace sansmesh::inline v1::io
