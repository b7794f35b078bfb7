#include "sansmesh/deform.h"

#include <fmt/core.h>

#include <optional>
#include <string_view>
#include <vector>

#include "sansmesh/core/option_text.h"
#include "sansmesh/deform/cuts/mesh_occluder.h"
#include "sansmesh/deform/cuts/planar_occluder.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"

namespace sansmesh::inline v1 {
namespace {

[[noreturn]] void bad_cut(const std::string& text, const std::string& cause) {
  throw ArgumentError(fmt::format("`cut` {}: {}", printable(text, 60), cause));
}

std::vector<Vec3> vectors_of(const std::string& text, std::string_view words) {
  std::vector<Vec3> vectors;
  for (const std::string& part : parts_between(words, ';')) {
    const auto v = numbers_in(part, 3);
    if (!v) bad_cut(text, fmt::format("'{}' is not x,y,z", without_blanks(part)));
    vectors.push_back({(*v)[0], (*v)[1], (*v)[2]});
  }
  return vectors;
}

/// Calls `make`; errors of its numbers become errors of the cut.
template <class Make>
std::shared_ptr<const Occluder> made(const std::string& text, Make make) {
  try {
    return make();
  } catch (const ArgumentError& error) {
    bad_cut(text, error.what());
  }
}

}  // namespace

std::shared_ptr<const Occluder> read_cut(const std::string& text, const Box3& domain) {
  const std::string_view all = without_blanks(text);
  const auto inner = [&](std::string_view name) -> std::optional<std::string_view> {
    if (!all.starts_with(name) || all.size() < name.size() + 2 || all[name.size()] != '(') return std::nullopt;
    if (all.back() != ')') bad_cut(text, "')' is missing at its end");
    return all.substr(name.size() + 1, all.size() - name.size() - 2);
  };
  if (const auto words = inner("half-plane")) {
    const std::vector<Vec3> v = vectors_of(text, *words);
    if (v.size() != 3)
      bad_cut(text, "a half-plane is a point of its edge; its normal; and the direction in which it extends");
    return made(text, [&] { return half_plane(v[0], v[1], v[2]); });
  }
  if (const auto words = inner("polygon")) {
    std::vector<std::vector<Vec3>> loops;
    for (const std::string& loop : parts_between(*words, '|')) loops.push_back(vectors_of(text, loop));
    return made(text, [&] { return polygon_occluder(loops); });
  }
  if (all.find('(') != std::string_view::npos) bad_cut(text, "neither half-plane(…), polygon(…) nor a mesh file");
  const std::string file(all);
  try {
    return mesh_occluder(read_mesh(file), {.domain = domain});
  } catch (const ArgumentError& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace sansmesh::inline v1
