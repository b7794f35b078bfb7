#include "sansmesh/attribute_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kGrain = 16384;

template <std::size_t... i>
constexpr bool in_order(std::index_sequence<i...>) {
  return ((number_type_of<typename std::variant_alternative_t<i, AttributeValues>::value_type>() ==
           static_cast<NumberType>(i)) &&
          ...);
}
static_assert(in_order(std::make_index_sequence<std::variant_size_v<AttributeValues>>{}));

template <class T>
constexpr T unknown() {
  if constexpr (std::is_floating_point_v<T>) return std::numeric_limits<T>::quiet_NaN();
  return 0;
}

/// Array with the same name and number of components and the numbers make(old numbers).
template <class Make>
Attribute remade(const Attribute& a, Make&& make) {
  return {a.name, std::visit([&](const auto& v) -> AttributeValues { return make(v); }, a.values), a.components};
}

bool alike(const Attribute& a, const Attribute* b) {
  return b && a.values.index() == b->values.index() && a.components == b->components;
}

}  // namespace

AttributeValues empty_values(NumberType type) {
  switch (type) {
    case NumberType::i8:
      return std::vector<std::int8_t>{};
    case NumberType::u8:
      return std::vector<std::uint8_t>{};
    case NumberType::i16:
      return std::vector<std::int16_t>{};
    case NumberType::u16:
      return std::vector<std::uint16_t>{};
    case NumberType::i32:
      return std::vector<std::int32_t>{};
    case NumberType::u32:
      return std::vector<std::uint32_t>{};
    case NumberType::i64:
      return std::vector<std::int64_t>{};
    case NumberType::u64:
      return std::vector<std::uint64_t>{};
    case NumberType::f32:
      return std::vector<float>{};
    case NumberType::f64:
      break;
  }
  return std::vector<double>{};
}

const Attribute* AttributeTable::find(std::string_view name) const {
  const auto found = std::find_if(arrays_.begin(), arrays_.end(), [&](const Attribute& a) { return a.name == name; });
  return found == arrays_.end() ? nullptr : &*found;
}

void AttributeTable::set(Attribute attribute) {
  if (attribute.name.empty()) throw ArgumentError("an attribute needs a name");
  const std::string name = printable(attribute.name, 80);
  if (attribute.components == 0) throw ArgumentError("attribute '" + name + "' has no components");
  if (attribute.size() % attribute.components != 0)
    throw ArgumentError("attribute '" + name + "': " + std::to_string(attribute.size()) + " numbers are not rows of " +
                        std::to_string(attribute.components));
  const auto found =
      std::find_if(arrays_.begin(), arrays_.end(), [&](const Attribute& a) { return a.name == attribute.name; });
  const std::size_t others = arrays_.size() - (found != arrays_.end() ? 1 : 0);
  if (others > 0) {
    const Attribute& other = found == arrays_.begin() ? arrays_.back() : arrays_.front();
    if (other.rows() != attribute.rows())
      throw ArgumentError("attribute '" + name + "' has " + std::to_string(attribute.rows()) + " rows, '" +
                          printable(other.name, 80) + "' has " + std::to_string(other.rows()));
  }
  if (found != arrays_.end())
    *found = std::move(attribute);
  else
    arrays_.push_back(std::move(attribute));
}

bool AttributeTable::erase(std::string_view name) {
  return std::erase_if(arrays_, [&](const Attribute& a) { return a.name == name; }) > 0;
}

void AttributeTable::check_rows(std::size_t rows, std::string_view of) const {
  for (const Attribute& a : arrays_) {
    if (a.size() != rows * a.components)
      throw ArgumentError("attribute '" + printable(a.name, 80) + "' has " + std::to_string(a.rows()) + " rows for " +
                          std::to_string(rows) + " " + std::string(of));
  }
}

void AttributeTable::remove_rows(std::span<const std::uint8_t> mask) {
  check_rows(mask.size(), "entries of a mask");
  for (Attribute& a : arrays_) {
    const std::size_t width = a.components;
    std::visit(
        [&](auto& values) {
          std::size_t kept = 0;
          for (std::size_t i = 0; i < mask.size(); ++i) {
            if (mask[i]) continue;
            for (std::size_t c = 0; c < width; ++c) values[kept * width + c] = values[i * width + c];
            ++kept;
          }
          values.resize(kept * width);
        },
        a.values);
  }
}

AttributeTable AttributeTable::taken(std::span<const std::uint32_t> rows) const {
  AttributeTable result;
  for (const Attribute& a : arrays_) {
    const std::size_t width = a.components;
    result.arrays_.push_back(remade(a, [&](const auto& values) {
      std::decay_t<decltype(values)> out(rows.size() * width);
      parallel_for(0, rows.size(), kGrain, [&](std::size_t i) {
        for (std::size_t c = 0; c < width; ++c) out[i * width + c] = values[rows[i] * width + c];
      });
      return out;
    }));
  }
  return result;
}

void AttributeTable::append_copy(std::size_t row) { append_between(row, row, 0); }

void AttributeTable::append_between(std::size_t a, std::size_t b, float t) {
  for (Attribute& array : arrays_) {
    const std::size_t width = array.components;
    std::visit(
        [&](auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          for (std::size_t c = 0; c < width; ++c) {
            const T from = values[a * width + c], to = values[b * width + c];
            if constexpr (std::is_floating_point_v<T>)
              values.push_back(t <= 0   ? from
                               : t >= 1 ? to
                                        : from * (T(1) - static_cast<T>(t)) + to * static_cast<T>(t));
            else
              values.push_back(t <= 0.5f ? from : to);
          }
        },
        array.values);
  }
}

void AttributeTable::append(const AttributeTable& other, std::span<const std::uint32_t> rows) {
  for (Attribute& a : arrays_) {
    const Attribute* const from = other.find(a.name);
    const std::size_t width = a.components;
    std::visit(
        [&](auto& values) {
          using Values = std::decay_t<decltype(values)>;
          if (!alike(a, from)) {
            values.insert(values.end(), rows.size() * width, unknown<typename Values::value_type>());
            return;
          }
          const Values& source = std::get<Values>(from->values);
          values.reserve(values.size() + rows.size() * width);
          for (const std::uint32_t row : rows)
            for (std::size_t c = 0; c < width; ++c) values.push_back(source[row * width + c]);
        },
        a.values);
  }
}

AttributeTable AttributeTable::blended(std::size_t share, std::span<const std::uint32_t> rows,
                                       std::span<const double> weights) const {
  AttributeTable result;
  const std::size_t n = share > 0 ? rows.size() / share : 0;
  for (const Attribute& a : arrays_) {
    const std::size_t width = a.components;
    result.arrays_.push_back(remade(a, [&](const auto& values) {
      using T = typename std::decay_t<decltype(values)>::value_type;
      std::vector<T> out(n * width);
      parallel_for(0, n, kGrain, [&](std::size_t i) {
        const std::uint32_t* const row = rows.data() + i * share;
        const double* const weight = weights.data() + i * share;
        if constexpr (std::is_floating_point_v<T>) {
          for (std::size_t c = 0; c < width; ++c) {
            double sum = 0;
            for (std::size_t j = 0; j < share; ++j)
              if (weight[j] > 0) sum += weight[j] * static_cast<double>(values[row[j] * width + c]);
            out[i * width + c] = static_cast<T>(sum);
          }
        } else {
          const auto heaviest = static_cast<std::size_t>(std::max_element(weight, weight + share) - weight);
          for (std::size_t c = 0; c < width; ++c) out[i * width + c] = values[row[heaviest] * width + c];
        }
      });
      return out;
    }));
  }
  return result;
}

AttributeTable AttributeTable::means(std::span<const std::uint32_t> group, std::span<const double> weight,
                                     std::size_t groups) const {
  AttributeTable result;
  if (arrays_.empty()) return result;
  std::vector<std::uint32_t> heaviest(groups, 0);
  std::vector<double> largest(groups, -1);
  for (std::size_t r = 0; r < group.size(); ++r) {
    const std::uint32_t g = group[r];
    if (weight[r] > largest[g]) largest[g] = weight[r], heaviest[g] = static_cast<std::uint32_t>(r);
  }
  for (const Attribute& a : arrays_) {
    const std::size_t width = a.components;
    result.arrays_.push_back(remade(a, [&](const auto& values) {
      using T = typename std::decay_t<decltype(values)>::value_type;
      std::vector<T> out(groups * width);
      if constexpr (std::is_floating_point_v<T>) {
        std::vector<double> sum(groups * width, 0), known(groups * width, 0);
        for (std::size_t r = 0; r < group.size(); ++r)
          for (std::size_t c = 0; c < width; ++c) {
            const auto value = static_cast<double>(values[r * width + c]);
            if (std::isnan(value)) continue;  // unknown
            sum[group[r] * width + c] += weight[r] * value;
            known[group[r] * width + c] += weight[r];
          }
        for (std::size_t i = 0; i < out.size(); ++i)
          out[i] = known[i] > 0 ? static_cast<T>(sum[i] / known[i]) : unknown<T>();
      } else {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = values[heaviest[i / width] * width + i % width];
      }
      return out;
    }));
  }
  return result;
}

AttributeTable join_rows(std::span<const AttributeTable* const> tables, std::span<const std::size_t> rows) {
  const std::size_t total = std::accumulate(rows.begin(), rows.end(), std::size_t{0});
  AttributeTable all;
  for (const AttributeTable* const table : tables) {
    for (const Attribute& a : *table) {
      if (all.find(a.name)) continue;
      all.set(remade(a, [&](const auto& values) {
        using Values = std::decay_t<decltype(values)>;
        Values out;
        out.reserve(total * a.components);
        for (std::size_t k = 0; k < tables.size(); ++k) {
          const Attribute* const from = tables[k]->find(a.name);
          if (alike(a, from)) {
            const Values& source = std::get<Values>(from->values);
            out.insert(out.end(), source.begin(), source.end());
          } else {
            out.resize(out.size() + rows[k] * a.components, unknown<typename Values::value_type>());
          }
        }
        return out;
      }));
    }
  }
  return all;
}

std::vector<std::string> keep_common(AttributeTable& a, std::span<const AttributeTable* const> others) {
  std::vector<std::string> gone;
  for (const Attribute& array : a) {
    const bool common = std::all_of(others.begin(), others.end(),
                                    [&](const AttributeTable* other) { return alike(array, other->find(array.name)); });
    if (!common) gone.push_back(array.name);
  }
  for (const std::string& name : gone) a.erase(name);
  return gone;
}

}  // namespace sansmesh::inline v1
