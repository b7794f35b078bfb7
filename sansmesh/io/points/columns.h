// Decodes tables of records, the layout of binary formats, to a PointSet.
#pragma once

#include "sansmesh/io/binary.h"
#include "sansmesh/io/input.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

/// Columns of a table by meaning; absent ones are empty.
struct CloudColumns {
  Column position[3];
  Column normal[3];
  Column color[3];
  bool whole_colors = false;  ///< real colour columns hold whole numbers: 1 is nearly black, not full
  bool wide_colors = false;   ///< colours have 16 bits even if none exceeds 255

  bool has_normals() const { return normal[0] && normal[1] && normal[2]; }
  bool has_colors() const { return color[0] && color[1] && color[2]; }
};

/// Decodes `n` records in parallel into positions, normals and colours. Positions are `scale` * value + `offset` per
/// axis. Colours: 8 bits unchanged, 16 bits or more if any value exceeds 255, reals as fractions if none exceeds 1.
void decode_columns(const Input& in, const CloudColumns& columns, std::size_t n, PointSet& points,
                    const Vec3& scale = {1, 1, 1}, const Vec3& offset = {});

/// Named columns without a meaning for the reader, which become an attribute.
struct NamedColumns {
  std::string name;
  NumberType type;                 ///< type of the attribute; text columns hold cells of cell_type()
  std::vector<Column> components;  ///< at least one
};

/// Attributes of n records. If `join`, neighbouring single columns of one type named name_0, name_1, … become one
/// attribute with several components. Columns without a name are left out, also, with a warning, those with a duplicate
/// name.
AttributeTable decode_attributes(const Input& in, const std::vector<NamedColumns>& columns, std::size_t n,
                                 bool join = true);

/// Joins the rows of several tables. Attributes that some of them lack are left out with a warning that names the
/// `parts` ("scans").
AttributeTable join_tables(const Input& in, std::vector<AttributeTable> tables, std::string_view parts);

/// Text is read into tables of 8-byte cells: doubles, except that integers of 64 bits are stored as they are (a double
/// would round them).
inline NumberType cell_type(NumberType type) {
  return type == NumberType::i64 || type == NumberType::u64 ? type : NumberType::f64;
}

/// Reads the next number of `text` into a cell. False if there is none.
bool read_cell(TextScanner& text, NumberType type, double& cell);

/// The number at `p` as a cell.
double load_cell(const char* p, NumberType type, bool swap);

/// The number of a cell, rounded to a double.
double cell_number(double cell, NumberType type);

}  // namespace sansmesh::inline v1::io
