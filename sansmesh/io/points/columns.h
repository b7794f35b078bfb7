// A cloud as a table of records, the way binary formats hold it, and its way into a PointSet.
#pragma once

#include "sansmesh/io/binary.h"
#include "sansmesh/io/input.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

/// Which columns of a table mean what; absent ones are empty.
struct CloudColumns {
  Column position[3];
  Column normal[3];
  Column color[3];
  bool whole_colors = false;  ///< colour columns of a real type hold whole numbers: 1 is nearly black, not full

  bool has_normals() const { return normal[0] && normal[1] && normal[2]; }
  bool has_colors() const { return color[0] && color[1] && color[2]; }
};

/// Decodes `n` records in parallel into positions, normals and colours. Positions are `scale` * value + `offset` per
/// axis. Colours: 8 bits as they are, 16 bits or more if any value exceeds 255, reals as fractions if none exceeds 1.
void decode_columns(const Input& in, const CloudColumns& columns, std::size_t n, PointSet& points,
                    const Vec3& scale = {1, 1, 1}, const Vec3& offset = {});

/// Columns that mean nothing to a reader but have a name: what becomes an attribute.
struct NamedColumns {
  std::string name;
  NumberType type;                 ///< of the attribute; columns of text hold its numbers as `cell_type` says
  std::vector<Column> components;  ///< at least one
};

/// Attributes of n records. If `join`, neighbouring single columns of one type named name_0, name_1, … become one
/// attribute of several components. What has no name is left out, and so is, with a warning, what has the name of
/// another.
AttributeTable decode_attributes(const Input& in, const std::vector<NamedColumns>& columns, std::size_t n,
                                 bool join = true);

/// The rows of several tables one after the other; what not all of them have is left out with a warning that names the
/// `parts` ("scans").
AttributeTable join_tables(const Input& in, std::vector<AttributeTable> tables, std::string_view parts);

/// Text is read into tables of 8-byte cells: doubles, but integers of 64 bits as they are (a double would round them).
inline NumberType cell_type(NumberType type) {
  return type == NumberType::i64 || type == NumberType::u64 ? type : NumberType::f64;
}

/// Reads the number that comes next in `text` into a cell. False where there is none.
bool read_cell(TextScanner& text, NumberType type, double& cell);

/// The number at `p` as a cell.
double load_cell(const char* p, NumberType type, bool swap);

/// The number that a cell holds, rounded to a double.
double cell_number(double cell, NumberType type);

}  // namespace sansmesh::inline v1::io
