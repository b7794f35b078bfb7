#include "deform_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "command_line.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/handle_file.h"
#include "sansmesh/deform/handle_motion.h"
#include "sansmesh/deform/handle_shapes.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/read_volume.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kUsualHandles = 30;   // of registered pairs
constexpr double kInverseTolerance = 1e-9;  // of the size of a map that is given
constexpr double kCutRoom = 0.25;           // around handles, where ways around meshes are found
constexpr double kBallShare = 0.008;        // radius of drawn handles, of what is drawn

const char* kind_word(DeformationKind kind) {
  switch (kind) {
    case DeformationKind::affine:
      return "affine";
    case DeformationKind::similarity:
      return "similarity";
    case DeformationKind::rigid:
      return "rigid";
    case DeformationKind::nonlinear:
      break;
  }
  return "nonlinear";
}

std::vector<std::uint32_t> vertices_of(const std::string& list) {
  std::vector<std::uint32_t> vertices;
  for (const std::string& word : between_commas(list)) {
    const auto v = whole_in(word, 0, std::numeric_limits<std::uint32_t>::max());
    if (!v) throw ArgumentError(fmt::format("--vertices: '{}' is no number of a vertex (they count from 0)", word));
    vertices.push_back(static_cast<std::uint32_t>(*v));
  }
  return vertices;
}

std::vector<Handle> pair_handles(const DeformationInput& input) {
  const std::vector<std::string> files = between_commas(input.pair);
  const PointSet before = read_points(files[0]), after = read_points(files[1]);
  const std::vector<std::uint32_t> vertices =
      input.vertices.empty() ? spread_vertices_of(before, input.handle_count > 0 ? input.handle_count : kUsualHandles)
                             : vertices_of(input.vertices);
  try {
    return handles_of_pair(before, after, vertices);
  } catch (const ArgumentError& error) {
    throw ArgumentError(fmt::format("--handles-from {}: {}", input.pair, error.what()));
  }
}

std::shared_ptr<const DisplacementMap> read_map(const std::string& file) {
  const GridData data = read_volume(file);
  if (data.blocks.size() != 1) throw FileError(file, "a displacement map is a single lattice");
  try {
    return std::make_shared<const DisplacementMap>(displacement_map_of(data.blocks[0]));
  } catch (const DataError& error) {
    throw FileError(file, error.what());
  } catch (const ArgumentError& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace

Box3 with_room(const Box3& box, double share) {
  const Vec3 room = Vec3{1, 1, 1} * (share * box.diagonal());
  return {box.lower - room, box.upper + room};
}

void DeformationInput::check() const {
  const int sources = !handles.empty() + !pair.empty() + !map.empty();
  require(sources == 1, "one of --handles, --handles-from and --map says how to deform");
  require(pair.empty() || between_commas(pair).size() == 2, "--handles-from takes two files: before.ply,after.ply");
  require(!pair.empty() || (vertices.empty() && handle_count == 0),
          "--vertices and --handle-count need --handles-from");
  require(vertices.empty() || handle_count == 0, "give --vertices or --handle-count, not both");
  require(map.empty() || (!kind && !degree && !alpha), "--kind, --degree and --alpha are of handles: not with --map");
  require(!degree || kind == DeformationKind::nonlinear, "--degree needs --kind nonlinear");
  require(map.empty() || cuts.cuts.empty(), "--cut is of handles: a map has its gaps in the file");
  cuts.check();
}

void add_deformation_options(CommandLine& c, DeformationInput& input) {
  const char* const group = "Deformation";
  c.add_option("--handles", input.handles, "Where places went: JSON, or a table px,py,pz,qx,qy,qz[,weight]")
      .type_name("FILE")
      .group(group);
  c.add_option("--handles-from", input.pair, "Two meshes whose vertices correspond: before.ply,after.ply")
      .type_name("A,B")
      .group(group);
  c.add_option("--vertices", input.vertices, "Of --handles-from: which vertices are handles, counted from 0: 10,200")
      .type_name("NUMBERS")
      .group(group);
  c.add_option("--handle-count", input.handle_count, "Instead: so many, far from each other [30]")
      .type_name("COUNT")
      .group(group);
  c.add_option("--map", input.map, "Instead of handles: a displacement map (.vti, as --displacement-map writes it)")
      .type_name("FILE")
      .group(group);
  c.add_choice<DeformationKind>("--kind", input.kind,
                                {{"affine", DeformationKind::affine},
                                 {"similarity", DeformationKind::similarity},
                                 {"rigid", DeformationKind::rigid},
                                 {"nonlinear", DeformationKind::nonlinear}},
                                "What it is made of around each place: affine, similarity (turns and scales), rigid "
                                "(turns), nonlinear (bends) [rigid]")
      .type_name("KIND")
      .group(group);
  c.add_option("--degree", input.degree, "Of nonlinear: 2 (from 9 handles on) or 3 (19) [2]")
      .type_name("DEGREE")
      .group(group);
  c.add_option("--alpha", input.alpha,
               "How local it is: weights are 1/distance^(2 alpha), 0.5..8, with segments 1..8 [1]")
      .type_name("NUMBER")
      .group(group);
  add_cut_options(c, input.cuts);
}

OpenDeformation::OpenDeformation(const DeformationInput& input, Console& console) {
  console.progress().begin("read");
  if (input.kind) options_.kind = *input.kind;
  if (input.degree) options_.degree = *input.degree;
  if (input.alpha) options_.alpha = *input.alpha;
  options_.damping = input.cuts.damping;
  options_.validate();
  if (!input.map.empty()) {
    file_ = input.map;
    map_ = read_map(input.map);
    return;
  }
  file_ = input.handles.empty() ? input.pair : input.handles;
  handles_ = input.handles.empty() ? pair_handles(input) : read_handles(input.handles);
  Box3 domain;
  for (const Handle& h : handles_)
    for (const Vec3& x : {h.p, h.q, h.p_end.value_or(h.p), h.q_end.value_or(h.q)}) domain.extend(x);
  for (const std::string& text : input.cuts.cuts) cuts_.push_back(cut_of(text, with_room(domain, kCutRoom)));
}

DeformationMaps OpenDeformation::at(double share) const {
  if (map_) return {map_, std::make_shared<const InverseMap>(map_, kInverseTolerance)};
  std::vector<Handle> now = sansmesh::handles_at(handles_, share);
  try {
    auto forward = std::make_shared<const MlsDeformation>(reversed(now), options_, cuts_);
    return {std::make_shared<const MlsDeformation>(std::move(now), options_, cuts_), std::move(forward)};
  } catch (const ArgumentError& error) {
    throw FileError(file_, error.what());
  }
}

std::vector<Handle> OpenDeformation::handles_at(double share) const { return sansmesh::handles_at(handles_, share); }

std::optional<Box3> OpenDeformation::box_of(const DeformationMaps& maps, const Box3& box) const {
  if (map_ || !is_finite(box.lower) || !is_finite(box.upper) || box.empty()) return std::nullopt;
  constexpr int kPoints = 9;
  std::vector<Vec3> x;
  const Vec3 step = box.size() * (1.0 / (kPoints - 1));
  for (int l = 0; l < kPoints; ++l)
    for (int j = 0; j < kPoints; ++j)
      for (int i = 0; i < kPoints; ++i) x.push_back(box.lower + Vec3{i * step.x, j * step.y, l * step.z});
  std::vector<Vec3> moved(x.size());
  maps.forward->map(x, {moved, {}, {}, {}});
  Box3 found;
  for (const Vec3& p : moved)
    if (is_finite(p)) found.extend(p);
  if (found.empty()) return std::nullopt;
  return found;
}

TriangleMesh OpenDeformation::shapes(double share, double size) const {
  HandleShapeOptions options;
  options.radius = kBallShare * size;
  return handle_shapes(handles_at(share), options);
}

std::string OpenDeformation::words() const {
  if (map_) return "by a displacement map";
  return fmt::format("{}, {}{}{}", counted(handles_.size(), "handle"), kind_word(options_.kind),
                     options_.kind == DeformationKind::nonlinear ? fmt::format(" of degree {}", options_.degree) : "",
                     cuts_.empty() ? "" : ", " + counted(cuts_.size(), "cut"));
}

Json OpenDeformation::json() const {
  if (map_) return {{"map", file_}};
  Json json = {{"handles", handles_.size()}, {"file", file_}, {"kind", kind_word(options_.kind)}};
  if (options_.kind == DeformationKind::nonlinear) json["degree"] = options_.degree;
  json["alpha"] = options_.alpha;
  if (!cuts_.empty()) json["cuts"] = cuts_.size(), json["damping"] = options_.damping;
  return json;
}

}  // namespace sansmesh::cli
