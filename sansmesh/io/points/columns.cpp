#include "sansmesh/io/points/columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>
#include <set>
#include <variant>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/io/color_bytes.h"
#include "sansmesh/io/points/assemble_points.h"

namespace sansmesh::inline v1::io {
namespace {

/// Calls use(at) with at(i) -> Vec3. `use` is compiled once for each of `types`, the common types of three equal
/// columns, and once for all others.
template <NumberType... types, class Use>
void with_triples(const Column (&c)[3], Use&& use) {
  const bool uniform = c[0].type == c[1].type && c[1].type == c[2].type && c[0].stride == c[1].stride &&
                       c[1].stride == c[2].stride && c[0].swap == c[1].swap && c[1].swap == c[2].swap;
  const auto by = [&](auto at) {
    const char* const x = c[0].at;
    const char* const y = c[1].at;
    const char* const z = c[2].at;
    const std::size_t stride = c[0].stride;
    use([=](std::size_t i) {
      const std::size_t o = i * stride;
      return Vec3{static_cast<double>(at(x + o)), static_cast<double>(at(y + o)), static_cast<double>(at(z + o))};
    });
    return true;
  };
  const auto is = [&]<NumberType type>() {
    using T = typename std::variant_alternative_t<static_cast<std::size_t>(type), AttributeValues>::value_type;
    return c[0].type == type && (c[0].swap ? by(Loader<T, true>{}) : by(Loader<T, false>{}));
  };
  if (uniform && (is.template operator()<types>() || ...)) return;
  use([&c](std::size_t i) { return Vec3{c[0][i], c[1][i], c[2][i]}; });
}

/// Limit of arrays, so that a header of many names does not take too long.
constexpr std::size_t kMostAttributes = 4096;

/// Converts to the nearest value of T; 0 for NaN if T has none.
template <class T>
T nearest_value(double v) {
  if constexpr (std::is_floating_point_v<T>)
    return static_cast<T>(v);
  else
    return whole_part<T>(std::nearbyint(v));
}

/// "velocity", 2 for "velocity_2"; empty for names without a number, or with a leading 0.
std::optional<std::pair<std::string_view, std::size_t>> numbered(std::string_view name) {
  const std::size_t bar = name.rfind('_');
  if (bar == std::string_view::npos || bar == 0 || bar + 1 == name.size() || name.size() - bar > 6) return std::nullopt;
  std::size_t number = 0;
  for (const char c : name.substr(bar + 1)) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + static_cast<std::size_t>(c - '0');
  }
  if (name[bar + 1] == '0' && name.size() - bar > 2) return std::nullopt;
  return std::pair(name.substr(0, bar), number);
}

Attribute decode(const NamedColumns& columns, std::size_t n) {
  Attribute a{columns.name, empty_values(columns.type), columns.components.size()};
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        values.resize(n * a.components);
        for (std::size_t c = 0; c < a.components; ++c) {
          const Column& column = columns.components[c];
          T* const out = values.data() + c;
          if (column.type == columns.type) {
            parallel_for(0, n, 1 << 15, [&](std::size_t i) {
              const char* const p = column.at + i * column.stride;
              out[i * a.components] = column.swap ? load<T, true>(p) : load<T>(p);
            });
          } else {
            parallel_for(0, n, 1 << 15, [&](std::size_t i) { out[i * a.components] = nearest_value<T>(column[i]); });
          }
        }
      },
      a.values);
  return a;
}

}  // namespace

AttributeTable decode_attributes(const Input& in, const std::vector<NamedColumns>& columns, std::size_t n, bool join) {
  AttributeTable table;
  std::set<std::string, std::less<>> names;
  for (std::size_t k = 0; k < columns.size();) {
    NamedColumns group = columns[k++];
    if (group.name.empty()) continue;
    const auto single = [&](std::size_t i, std::string_view name, std::size_t number) {
      if (i >= columns.size() || columns[i].type != group.type || columns[i].components.size() != 1) return false;
      return numbered(columns[i].name) == std::optional(std::pair(name, number));
    };
    const auto taken = [&](std::string_view name) {
      return std::any_of(columns.begin(), columns.end(), [&](const NamedColumns& c) { return c.name == name; });
    };
    if (const auto first = numbered(group.name);
        join && first && first->second == 0 && single(k, first->first, 1) && !taken(first->first)) {
      const std::string name(first->first);
      for (; single(k, name, group.components.size()); ++k) group.components.push_back(columns[k].components[0]);
      group.name = name;
    }
    if (table.size() == kMostAttributes) {
      in.warn(fmt::format("more than {} attributes: the others were left out", grouped(kMostAttributes)));
      break;
    }
    if (!names.insert(group.name).second) {
      in.warn(fmt::format("'{}' occurs twice: the second one was left out", printable(group.name, 80)));
      continue;
    }
    table.set(decode(group, n));
  }
  return table;
}

AttributeTable join_tables(const Input& in, std::vector<AttributeTable> tables, std::string_view parts) {
  if (tables.empty()) return {};
  std::vector<const AttributeTable*> others;
  std::set<std::string> gone;
  for (std::size_t k = 1; k < tables.size(); ++k) {
    others.push_back(&tables[k]);
    for (const Attribute& a : tables[k])
      if (!tables[0].find(a.name)) gone.insert(a.name);
  }
  AttributeTable all = std::move(tables[0]);
  for (const std::string& name : keep_common(all, others)) gone.insert(name);
  for (const AttributeTable* other : others) {
    if (all.empty()) break;
    std::vector<std::uint32_t> rows((*other)[0].rows());
    std::iota(rows.begin(), rows.end(), 0u);
    all.append(*other, rows);
  }
  for (const std::string& name : gone)
    in.warn(fmt::format("only some of the {} have '{}', or of another type: left out", parts, printable(name, 80)));
  return all;
}

bool read_cell(TextScanner& text, NumberType type, double& cell) {
  const auto read_whole = [&](auto value) {
    TextScanner ahead = text;
    if (ahead.number(value)) {
      const std::string_view after = ahead.rest();
      if (after.empty() || (after[0] != '.' && after[0] != 'e' && after[0] != 'E')) {
        text = ahead;
        cell = std::bit_cast<double>(value);
        return true;
      }
    }
    double real = 0;
    if (!text.number(real)) return false;
    cell = std::bit_cast<double>(nearest_value<decltype(value)>(real));
    return true;
  };
  if (type == NumberType::i64) return read_whole(std::int64_t{});
  if (type == NumberType::u64) return read_whole(std::uint64_t{});
  return text.number(cell);
}

double load_cell(const char* p, NumberType type, bool swap) {
  if (type == NumberType::i64 || type == NumberType::u64)
    return std::bit_cast<double>(swap ? load<std::uint64_t, true>(p) : load<std::uint64_t>(p));
  return load_number(p, type, swap);
}

double cell_number(double cell, NumberType type) {
  if (type == NumberType::i64) return static_cast<double>(std::bit_cast<std::int64_t>(cell));
  if (type == NumberType::u64) return static_cast<double>(std::bit_cast<std::uint64_t>(cell));
  return cell;
}

void decode_columns(const Input& in, const CloudColumns& columns, std::size_t n, PointSet& points, const Vec3& scale,
                    const Vec3& offset) {
  const std::size_t grain = 1 << 14;
  with_triples<NumberType::f32, NumberType::f64, NumberType::i32>(columns.position, [&](auto at) {
    if (scale == Vec3{1, 1, 1} && offset == Vec3{}) {
      store_positions(in, points, n, at);
    } else {
      store_positions(in, points, n, [&](std::size_t i) {
        const Vec3 p = at(i);
        return Vec3{p.x * scale.x + offset.x, p.y * scale.y + offset.y, p.z * scale.z + offset.z};
      });
    }
  });
  if (columns.has_normals()) {
    points.normals.resize(n);
    with_triples<NumberType::f32, NumberType::f64>(columns.normal, [&](auto at) {
      parallel_for(0, n, grain, [&](std::size_t i) { points.normals[i] = Vec3f(at(i)); });
    });
  }
  if (columns.has_colors()) {
    const NumberType type = columns.color[0].type;
    points.colors.resize(n);
    with_triples<NumberType::u8, NumberType::u16, NumberType::f32>(columns.color, [&](auto at) {
      double factor = columns.wide_colors ? color_scale(65535, false) : 1;
      if (type != NumberType::u8 && !columns.wide_colors) {
        const double largest = parallel_reduce(
            n, 1 << 16, 0.0,
            [&](std::size_t first, std::size_t last) {
              double m = 0;
              for (std::size_t i = first; i < last; ++i) {
                const Vec3 c = at(i);
                m = std::max({m, c.x, c.y, c.z});
              }
              return m;
            },
            [](double a, double b) { return std::max(a, b); });
        factor = color_scale(largest, is_real(type) && !columns.whole_colors);
      }
      parallel_for(0, n, grain, [&](std::size_t i) {
        const Vec3 c = at(i);
        points.colors[i] = {to_byte(c.x, factor), to_byte(c.y, factor), to_byte(c.z, factor)};
      });
    });
  }
}

}  // namespace sansmesh::inline v1::io
