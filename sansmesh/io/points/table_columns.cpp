#include "sansmesh/io/points/table_columns.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/option_text.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

char guess_separator(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  if (line.find(',') != std::string_view::npos && line.find('\t') == std::string_view::npos) return ',';
  return ' ';
}

std::optional<ColumnMeaning> meaning_of_names(std::string_view line) {
  while (!line.empty() && (TextScanner::is_blank(line.front()) || std::strchr("#/%!", line.front())))
    line.remove_prefix(1);
  static constexpr const char* names[ColumnMeaning::kinds] = {
      " x easting east px pos_x position_x x_coord ",
      " y northing north py pos_y position_y y_coord ",
      " z elevation height altitude pz pos_z position_z z_coord ",
      " nx normal_x normalx ",
      " ny normal_y normaly ",
      " nz normal_z normalz ",
      " r red ",
      " g green ",
      " b blue "};
  ColumnMeaning m;
  TableRow row(line, guess_separator(line));
  int column = 0;
  std::vector<std::string> given;
  for (auto f = row.field(); f; f = row.field(), ++column) {
    std::string label(*f);
    std::erase(label, '"'), std::erase(label, '\'');
    std::string name = lower_case(label);
    name = name.substr(0, name.find_first_of("[("));  // a unit
    while (!name.empty() && TextScanner::is_blank(name.back())) name.pop_back();
    given.push_back(std::move(label));
    for (int k = 0; k < ColumnMeaning::kinds && !name.empty() && name.find(' ') == std::string::npos; ++k) {
      if (m.column[k] < 0 && std::string_view(names[k]).find(" " + name + " ") != std::string_view::npos)
        m.column[k] = column;
    }
  }
  if (!m.has(0)) return std::nullopt;
  // Two components of a normal are ordinary numbers.
  for (const int first : {3, 6}) {
    if (!m.has(first)) std::fill(m.column + first, m.column + first + 3, no_column);
  }
  for (int c = 0; c < column; ++c) {
    if (std::find(m.column, m.column + ColumnMeaning::kinds, c) == m.column + ColumnMeaning::kinds)
      m.others.push_back({c, given[static_cast<std::size_t>(c)]});
  }
  return m;
}

ColumnMeaning meaning_of_values(const std::vector<std::vector<double>>& rows, bool normals_by_ending) {
  ColumnMeaning m;
  m.set(0, 0);
  const int columns = static_cast<int>(rows.front().size());
  const auto share = [&](int first, auto&& holds) {
    if (first + 3 > columns) return false;
    std::size_t yes = 0;
    for (const auto& r : rows) yes += holds(Vec3{r[first], r[first + 1], r[first + 2]});
    return 20 * yes >= 19 * rows.size();
  };
  const auto unit = [&](int first) {
    return share(first, [](const Vec3& v) { return std::abs(norm(v) - 1) < 0.05 || v == Vec3{}; });
  };
  const auto color = [&](int first) {
    return share(first, [](const Vec3& v) {
      for (const double c : {v.x, v.y, v.z}) {
        if (!(c >= 0 && c <= 255 && c == std::floor(c))) return false;
      }
      return true;
    });
  };
  const auto opaque = [&](std::size_t column) {
    return std::all_of(rows.begin(), rows.end(), [&](const auto& r) { return r[column] == 255; });
  };
  if (columns < 6) return m;
  const bool normals_first = normals_by_ending || unit(3);
  if (normals_first) {
    m.set(3, 3);
    if (color(6)) m.set(6, 6);
  } else if (columns == 7 && color(4) && !(color(3) && opaque(6))) {
    // x y z intensity r g b (PTS). With integer intensities of 0..255 it could also be r g b intensity, which is much
    // rarer; a last column of only 255 is the opacity of r g b a.
    m.set(6, 4);
  } else if (color(3)) {
    m.set(6, 3);
    if (unit(6)) m.set(3, 6);
  }
  return m;
}

}  // namespace sansmesh::inline v1::io
