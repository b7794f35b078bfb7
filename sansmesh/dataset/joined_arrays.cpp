#include "sansmesh/dataset/joined_arrays.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "sansmesh/core/option_text.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<std::string> listed_names(const std::string& text) {
  std::vector<std::string> names;
  std::size_t first = 0;
  for (std::size_t comma; (comma = text.find(',', first)) != std::string::npos; first = comma + 1)
    names.push_back(text.substr(first, comma - first));
  names.push_back(text.substr(first));
  return names;
}

template <class T>
std::vector<T> interleaved(std::span<const Attribute* const> parts) {
  const std::size_t n = parts.size(), rows = parts[0]->rows();
  std::vector<T> values(n * rows);
  for (std::size_t k = 0; k < n; ++k)
    std::visit(
        [&](const auto& numbers) {
          parallel_ranges(0, rows, 1 << 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) values[i * n + k] = static_cast<T>(numbers[i]);
          });
        },
        parts[k]->values);
  return values;
}

/// Adds the array of vectors. False if the table lacks an array of one number for one of the names.
bool join_in(AttributeTable& arrays, const std::string& name, const std::vector<std::string>& names) {
  std::vector<const Attribute*> parts;
  for (const std::string& part : names) {
    const Attribute* const a = arrays.find(part);
    if (!a || a->components != 1) return false;
    parts.push_back(a);
  }
  const bool floats =
      std::all_of(parts.begin(), parts.end(), [](const Attribute* a) { return a->type() == NumberType::f32; });
  if (floats)
    arrays.set(name, interleaved<float>(parts), names.size());
  else
    arrays.set(name, interleaved<double>(parts), names.size());
  return true;
}

}  // namespace

void join_arrays(GridData& data, const std::string& names) {
  const std::vector<std::string> parts = listed_names(names);
  if (parts.size() < 2) return;
  for (const GridBlock& block : data.blocks)
    if (block.point_arrays.find(names) || block.cell_arrays.find(names)) return;
  bool of_points = false;
  for (GridBlock& block : data.blocks) of_points = join_in(block.point_arrays, names, parts) || of_points;
  if (of_points) return;
  for (GridBlock& block : data.blocks) join_in(block.cell_arrays, names, parts);
}

std::string vector_components(std::span<const DatasetArray> arrays) {
  const auto exists = [&](const std::string& name, Association of) {
    return std::any_of(arrays.begin(), arrays.end(),
                       [&](const DatasetArray& a) { return a.name == name && a.of == of && a.components == 1; });
  };
  std::string best;
  int most = 0;
  constexpr std::array<std::string_view, 4> kAxes{"xyz", "XYZ", "uvw", "UVW"};
  for (const DatasetArray& a : arrays)
    for (const std::string_view axes : kAxes)
      for (std::size_t at = a.name.find(axes[0]); at != std::string::npos; at = a.name.find(axes[0], at + 1)) {
        // u is a letter of many words; arrays named x, y and z are coordinates.
        if ((axes[0] == 'u' || axes[0] == 'U') != (a.name.size() == 1)) continue;
        // Rows of tensors are no vectors: stress_xx.
        const auto is_axis = [&](std::size_t k) { return k < a.name.size() && axes.find(a.name[k]) != axes.npos; };
        if (a.name.size() > 1 && (is_axis(at + 1) || (at > 0 && is_axis(at - 1)))) continue;
        std::string second = a.name, third = a.name;
        second[at] = axes[1], third[at] = axes[2];
        if (!exists(a.name, a.of) || !exists(second, a.of)) continue;
        const bool three = exists(third, a.of);
        // Two numbers alone may be indices.
        const std::string name = lower_case(a.name);
        if (!three && a.name.size() > 1 && name.find('v') == std::string::npos) continue;
        const int suits = 1 + (name.find("vel") != std::string::npos ? 4 : 0) + (three ? 2 : 0);
        if (suits <= most) continue;
        most = suits;
        best = a.name + "," + second + (three ? "," + third : "");
      }
  return best;
}

std::optional<DatasetArray> joined_array(std::span<const DatasetArray> arrays, const std::string& names) {
  const std::vector<std::string> parts = listed_names(names);
  if (parts.size() < 2) return std::nullopt;
  for (const Association of : {Association::points, Association::cells}) {
    DatasetArray joined{names, of, NumberType::f32, 0, {}, {}, 0};
    for (const std::string& name : parts) {
      const auto part = std::find_if(arrays.begin(), arrays.end(), [&](const DatasetArray& a) {
        return a.name == name && a.components == 1 && a.of == of;
      });
      if (part == arrays.end()) break;
      if (part->type != NumberType::f32) joined.type = NumberType::f64;
      ++joined.components;
      joined.least.push_back(part->least[0]), joined.most.push_back(part->most[0]);
      joined.not_finite += part->not_finite;
    }
    if (joined.components == parts.size()) return joined;
  }
  return std::nullopt;
}

}  // namespace sansmesh::inline v1
