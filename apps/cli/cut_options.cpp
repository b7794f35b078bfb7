#include "cut_options.h"

#include <fmt/core.h>

#include <string_view>

#include "command_line.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/deform/mesh_occluder.h"
#include "sansmesh/deform/planar_occluder.h"
#include "sansmesh/io/io.h"

namespace sansmesh::cli {
namespace {

[[noreturn]] void bad_cut(const std::string& text, const std::string& cause) {
  throw ArgumentError(fmt::format("--cut {}: {}", printable(text, 60), cause));
}

std::vector<std::string_view> parts_of(std::string_view text, char between) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t end = text.find(between, at);
    parts.push_back(text.substr(at, end == std::string_view::npos ? end : end - at));
    if (end == std::string_view::npos) return parts;
    at = end + 1;
  }
}

Vec3 vector_of(const std::string& text, std::string_view words) {
  const auto v = numbers_in(words, 3);
  if (!v) bad_cut(text, fmt::format("'{}' is not x,y,z", without_blanks(words)));
  return {(*v)[0], (*v)[1], (*v)[2]};
}

std::vector<Vec3> vectors_of(const std::string& text, std::string_view words) {
  std::vector<Vec3> vectors;
  for (const std::string_view part : parts_of(words, ';')) vectors.push_back(vector_of(text, part));
  return vectors;
}

}  // namespace

void CutArguments::check() const {
  require(!cuts.empty() || damping == 1, "--cut-damping needs --cut");
  require(!cuts.empty() || !open, "--cut-open needs --cut");
  require(damping >= 1 && damping <= 1e6, "--cut-damping must lie in 1..1000000");
}

void add_cut_options(CommandLine& c, CutArguments& cuts) {
  const char* const group = "Cuts";
  c.add_option(
       "--cut", cuts.cuts,
       "What handles do not reach through: 'half-plane(POINT; NORMAL; INTO)' with the edge through POINT across "
       "INTO, 'polygon(x,y,z; x,y,z; …)', or a mesh; may be repeated")
      .type_name("CUT")
      .repeated()
      .group(group);
  c.add_option("--cut-damping", cuts.damping,
               "How much less what lies behind a cut follows: influence falls with distance/(distance + FACTOR · "
               "detour); >= 1 [1]")
      .type_name("FACTOR")
      .group(group);
  c.add_flag("--cut-open", cuts.open, "Closed meshes stay open along cuts: without faces there").group(group);
}

std::shared_ptr<const Occluder> cut_of(const std::string& text, const Box3& domain) {
  const std::string_view all = without_blanks(text);
  const auto inner = [&](std::string_view name) -> std::optional<std::string_view> {
    if (!all.starts_with(name) || all.size() < name.size() + 2 || all[name.size()] != '(') return std::nullopt;
    if (all.back() != ')') bad_cut(text, "there is no ')' at its end");
    return all.substr(name.size() + 1, all.size() - name.size() - 2);
  };
  try {
    if (const auto words = inner("half-plane")) {
      const std::vector<Vec3> v = vectors_of(text, *words);
      if (v.size() != 3)
        bad_cut(text, "a half-plane is a point of its edge; its normal; and the direction it extends in");
      return half_plane(v[0], v[1], v[2]);
    }
    if (const auto words = inner("polygon")) {
      std::vector<std::vector<Vec3>> loops;
      for (const std::string_view loop : parts_of(*words, '|')) loops.push_back(vectors_of(text, loop));
      return polygon_occluder(loops);
    }
  } catch (const ArgumentError& error) {
    const std::string what = error.what();
    if (what.starts_with("--cut ")) throw;
    bad_cut(text, what);
  }
  if (all.find('(') != std::string_view::npos)
    bad_cut(text, "neither half-plane(…), polygon(…) nor the name of a mesh");
  MeshOccluderOptions options;
  options.domain = domain;
  try {
    return mesh_occluder(read_mesh(std::string(all)), options);
  } catch (const ArgumentError& error) {
    throw FileError(std::string(all), error.what());
  }
}

}  // namespace sansmesh::cli
