// Splits attributes into columns of one number each, for formats of rows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/attribute_table.h"

namespace sansmesh::inline v1::io {

/// One component of an attribute.
struct OutputColumn {
  std::string name;  ///< one word, unique regardless of case
  const Attribute* attribute = nullptr;
  std::size_t component = 0;

  NumberType type() const { return attribute->type(); }
  /// Appends the number of a row as text, the shortest that reads back as the same; returns the new end.
  char* put_text(char* p, std::size_t row) const;
  /// Appends its bytes.
  char* put_bytes(char* p, std::size_t row) const;
};

/// A name as one word for headers: blanks, separators and quotes become '_'.
std::string one_word(std::string_view name);

/// The columns of a table; components are adjacent as name_0, name_1, … Names become single words and receive a number
/// if another column or one of `taken` (in lower case) has the same.
std::vector<OutputColumn> output_columns(const AttributeTable& table, const std::vector<std::string>& taken = {});

/// Bytes of one row.
std::size_t row_bytes(const std::vector<OutputColumn>& columns);

}  // namespace sansmesh::inline v1::io
