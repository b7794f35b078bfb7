// Reads deformations: handles, two registered meshes, or displacement maps.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/deform.h"
#include "sansmesh/deform/handles/handle_file.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/jobs/deform/deform_parts.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kDefaultHandles = 30;  // for registered pairs
constexpr double kCutRoom = 0.25;            // margin around handles in which detours around mesh cuts are found

/// "before.ply,after.ply"
struct TwoFiles {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const std::vector<std::string>& files) { return fmt::format("{}", fmt::join(files, ",")); }
  static std::vector<std::string> from(const OptionValue& value) {
    const auto& text = std::get<std::string>(value);
    return text.empty() ? std::vector<std::string>() : between_commas(text);
  }
};

/// "10,200"
struct VertexNumbers {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const std::vector<std::uint32_t>& vertices) {
    return fmt::format("{}", fmt::join(vertices, ","));
  }
  static std::vector<std::uint32_t> from(const OptionValue& value) {
    std::vector<std::uint32_t> vertices;
    const auto& text = std::get<std::string>(value);
    if (text.empty()) return vertices;
    for (const std::string& word : between_commas(text)) {
      const auto v = whole_in(word, 0, std::numeric_limits<std::uint32_t>::max());
      if (!v)
        throw ArgumentError(ArgumentFault{.field = {},
                                          .value = "'" + printable(word, 60) + "'",
                                          .allowed = "numbers of vertices, which count from 0"});
      vertices.push_back(static_cast<std::uint32_t>(*v));
    }
    return vertices;
  }
};

std::vector<Handle> pair_handles(const DeformationInput& input) {
  const PointSet before = read_points(input.handles_from[0]), after = read_points(input.handles_from[1]);
  const std::vector<std::uint32_t> vertices =
      input.vertices.empty() ? spread_vertices_of(before, input.handle_count.value_or(kDefaultHandles))
                             : input.vertices;
  try {
    return handles_of_pair(before, after, vertices);
  } catch (const ArgumentError& error) {
    throw ArgumentError(fmt::format("`handles_from`: {},{}: {}", printable(input.handles_from[0], 100),
                                    printable(input.handles_from[1], 100), error.what()));
  }
}

Deformation read_map(const std::string& file) {
  const GridData data = read_volume(file);
  if (data.blocks.size() != 1) throw FileError(file, "a displacement map is a single lattice");
  try {
    return Deformation(data.blocks[0], file);
  } catch (const DataError& error) {
    throw FileError(file, error.what());
  } catch (const ArgumentError& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace

const OptionSchema& DeformationInput::schema() {
  using O = DeformationInput;
  static const OptionRow rows[] = {
      option<&O::handles>(
          {.text = "Handles, p moves to q: JSON, or a table px,py,pz,qx,qy,qz[,weight]", .unit = "file"}),
      option<&O::handles_from, TwoFiles>(
          {.text = "Two meshes whose vertices correspond: before.ply,after.ply", .unit = "a,b"}),
      option<&O::vertices, VertexNumbers>(
          {.text = "For `handles_from`: vertices that are handles, counted from 0: 10,200",
           .unit = "numbers",
           .needs = "handles_from"}),
      option<&O::handle_count>({.text = "Number of handles, spread evenly",
                                .from_data = "30",
                                .range = at_least(1),
                                .needs = "handles_from",
                                .excludes = "vertices"}),
      option<&O::map>(
          {.text = "Displacement map instead of handles (.vti, as written by `displacement_map`)", .unit = "file"}),
      option_group<&O::by>(MlsDeformationOptions::schema().rows),
      option<&O::cuts>({.text = "Cut that handles do not act across: 'half-plane(POINT; NORMAL; INTO)' with the edge "
                                "through POINT across INTO, 'polygon(x,y,z; x,y,z; …)', or a mesh; may be repeated",
                        .unit = "cut",
                        .name = "cut"})};
  return option_schema<rows>();
}

void DeformationInput::validate() const {
  validate_options(*this);
  if (!handles.empty() + !handles_from.empty() + !map.empty() != 1)
    throw ArgumentError("give one of `handles`, `handles_from` and `map`");
  if (!handles_from.empty() && handles_from.size() != 2)
    throw ArgumentError("`handles_from` takes two files: before.ply,after.ply");
  const MlsDeformationOptions defaults;
  if (by.damping != defaults.damping && cuts.empty()) throw ArgumentError("`cut_damping` needs `cut`");
  if (!map.empty() && !cuts.empty()) throw ArgumentError("`cut` needs handles: the file of a map contains its gaps");
  if (!map.empty() && !options_set(by).empty())
    throw ArgumentError(fmt::format("`{}` needs handles: not with `map`", options_set(by)[0]));
  if (by.degree != defaults.degree && by.kind != DeformationKind::nonlinear)
    throw ArgumentError("`degree` needs `kind = nonlinear`");
}

Deformation read_deformation(const DeformationInput& input, Progress& progress) {
  input.validate();
  progress.begin("read");
  if (!input.map.empty()) return read_map(input.map);
  const bool pair = input.handles.empty();
  std::vector<Handle> handles = pair ? pair_handles(input) : read_handles(input.handles);
  Box3 domain;
  for (const Handle& h : handles)
    for (const Vec3& x : {h.p, h.q, h.p_end.value_or(h.p), h.q_end.value_or(h.q)}) domain.extend(x);
  std::vector<std::shared_ptr<const Occluder>> cuts;
  cuts.reserve(input.cuts.size());
  for (const std::string& text : input.cuts) cuts.push_back(read_cut(text, with_margin(domain, kCutRoom)));
  return Deformation(std::move(handles), input.by, std::move(cuts),
                     pair ? input.handles_from[0] + "," + input.handles_from[1] : input.handles);
}

}  // namespace sansmesh::inline v1
