// Meaning of the columns of a text table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/core/option_text.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

inline constexpr int no_column = -1;

/// Columns in the order x y z, nx ny nz, red green blue.
struct ColumnMeaning {
  static constexpr int kinds = 9;
  int column[kinds] = {no_column, no_column, no_column, no_column, no_column,
                       no_column, no_column, no_column, no_column};
  /// Columns with other names, from left to right.
  struct Other {
    int column;
    std::string name;
  };
  std::vector<Other> others;
  bool has(int first) const { return column[first] >= 0 && column[first + 1] >= 0 && column[first + 2] >= 0; }
  void set(int first, int at) {
    for (int k = 0; k < 3; ++k) column[first + k] = at + k;
  }
};

/// Iterates over the fields of a row. With ' ' as separator, runs of blanks separate; otherwise every separator does.
class TableRow {
 public:
  TableRow(std::string_view line, char separator) : scan_(line), separator_(separator) {}

  std::optional<std::string_view> field() {
    if (separator_ == ' ') {
      const std::string_view w = scan_.word();
      return w.empty() ? std::nullopt : std::optional(w);
    }
    if (done_) return std::nullopt;
    const std::string_view rest = scan_.rest();
    const std::size_t stop = rest.find(separator_);
    const std::string_view f = without_blanks(rest.substr(0, stop));
    if (stop == std::string_view::npos)
      done_ = true;
    else
      scan_ = TextScanner(rest.substr(stop + 1));
    if (done_ && f.empty()) return std::nullopt;  // a separator at the line's end
    return f;
  }

 private:
  TextScanner scan_;
  char separator_;
  bool done_ = false;
};

/// ';', ',' or ' ' (any blanks).
char guess_separator(std::string_view line);

/// The meaning of a line of names if it names x, y and z.
std::optional<ColumnMeaning> meaning_of_names(std::string_view line);

/// Guesses the columns of a file without names from its first rows (at least one; all of the same length).
/// `normals_by_ending`: the file's ending shows that normals follow the positions.
ColumnMeaning meaning_of_values(const std::vector<std::vector<double>>& rows, bool normals_by_ending);

}  // namespace sansmesh::inline v1::io
