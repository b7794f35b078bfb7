#include "sansmesh/deform/handles/handle_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "sansmesh/core/json_fields-inl.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using detail::JsonFields;
using detail::JsonValue;

constexpr double kRounding = 1e-15;

/// Normalises a direction unless it is unit up to rounding, so that files are read back exactly.
Vec3 unit_direction(const Vec3& v) { return std::abs(norm(v) - 1) <= kRounding ? v : normalized(v); }

Vec3 unit_direction_of(const JsonFields& f, const char* key) {
  const Vec3 v = f.vector(key);
  if (!(norm(v) > 0)) f.fail(fmt::format("'{}' has no direction", key));
  return unit_direction(v);
}

/// Three orthogonal, right-handed directions; rounding errors are corrected.
std::array<Vec3, 3> frame_of(const JsonFields& f, const char* key) {
  constexpr double kOff = 1e-3;
  const JsonValue& json = f.at(key);
  if (!json.is_array() || json.size() != 3) f.fail(fmt::format("'{}' must hold three directions", key));
  std::array<Vec3, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::optional<Vec3> v = detail::json_vector(json[k]);
    if (!v || !(norm(*v) > 0)) f.fail(fmt::format("'{}' must hold three directions of three numbers", key));
    axes[k] = unit_direction(*v);
  }
  const auto [a, b, c] = axes;
  if (std::abs(dot(a, b)) > kOff || std::abs(dot(b, c)) > kOff || std::abs(dot(c, a)) > kOff)
    f.fail(fmt::format("the directions of '{}' must be at right angles to each other", key));
  if (const double off = dot(a, b); std::abs(off) > kRounding) axes[1] = unit_direction(b - a * off);
  const Vec3 third = cross(axes[0], axes[1]);
  if (dot(third, c) < 0)
    f.fail(fmt::format("the directions of '{}' must be right-handed: a rotation cannot mirror", key));
  axes[2] = third;
  return axes;
}

Handle handle_of(const JsonFields& f) {
  Handle h;
  h.p = f.vector("p");
  h.q = f.has("q") ? f.vector("q") : h.p;
  if (f.has("p_end")) {
    h.p_end = f.vector("p_end");
    if (f.has("q") != f.has("q_end"))
      f.fail(f.has("q") ? "'q_end', the segment's end after the deformation, is missing"
                        : "'q', the segment's begin after the deformation, is missing");
    h.q_end = f.has("q_end") ? f.vector("q_end") : *h.p_end;
    if (*h.p_end == h.p) f.fail("the segment has no length: 'p_end' is 'p'");
  } else if (f.has("q_end")) {
    f.fail("'q_end' needs 'p_end'");
  }
  if (f.has("weight")) h.weight = f.number("weight");
  if (!(h.weight > 0)) f.fail("'weight' must be positive");
  f.get("reach", h.reach, &JsonFields::number);
  if (h.reach && !(*h.reach > 0)) f.fail("'reach' must be a positive length");
  if (f.has("group")) h.group = f.text("group");
  if (f.has("normal") && f.has("frame")) f.fail("give 'normal' or 'frame', not both");
  if (f.has("normal")) {
    const JsonFields n(f.at("normal"), f.where("normal"), {"before", "after"});
    h.directions = {{unit_direction_of(n, "before"), unit_direction_of(n, "after")}};
  }
  if (f.has("frame")) {
    const JsonFields n(f.at("frame"), f.where("frame"), {"before", "after"});
    const std::array<Vec3, 3> a = frame_of(n, "before"), b = frame_of(n, "after");
    for (std::size_t k = 0; k < 3; ++k) h.directions.push_back({a[k], b[k]});
  }
  if (h.reach && h.directions.empty()) f.fail("'reach' needs a 'normal' or a 'frame'");
  return h;
}

std::vector<Handle> handles_of_json(const std::string& text) {
  const JsonValue json = detail::parse_json_once(text);
  const JsonFields file(json, "", {"handles"});
  if (!file.at("handles").is_array()) file.fail("'handles' must be a list");
  std::vector<Handle> handles;
  for (const JsonValue& h : file.at("handles"))
    handles.push_back(handle_of({h,
                                 fmt::format("handle {}", handles.size() + 1),
                                 {"p", "q", "p_end", "q_end", "weight", "group", "reach", "normal", "frame"}}));
  return handles;
}

/// Parses the numbers of a row; false if a word is not a number.
bool numbers_of(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  const char *at = line.data(), *const end = at + line.size();
  for (;;) {
    while (at < end && blank(*at)) ++at;
    if (at == end) return true;
    if (*at == '+') ++at;
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) return false;
    numbers.push_back(value);
    at = next;
    while (at < end && blank(*at)) ++at;
    if (at < end && (*at == ',' || *at == ';')) {
      ++at;
      continue;
    }
    if (at < end && !blank(at[-1])) return false;
  }
}

/// Whether a row begins with a number, as opposed to column names.
bool row_of_numbers(std::string_view row) {
  const std::size_t first = row.find_first_not_of(" \t\r+-.");
  return first != std::string_view::npos && row[first] >= '0' && row[first] <= '9';
}

std::vector<Handle> handles_of_table(const std::string& text) {
  std::vector<Handle> handles;
  std::vector<double> n;
  std::size_t line = 0;
  bool named = false;  // the header row has been skipped
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view row(text.data() + begin, end - begin);
    begin = end + 1;
    ++line;
    const std::size_t first = row.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || row[first] == '#') continue;
    const auto fail = [line](const std::string& cause) {
      throw ArgumentError(fmt::format("line {}: {}", line, cause));
    };
    if (!numbers_of(row, n)) {
      if (handles.empty() && !named && !row_of_numbers(row)) {
        named = true;
        continue;
      }
      fail("must hold numbers: px,py,pz,qx,qy,qz and maybe a weight");
    }
    if (n.size() != 6 && n.size() != 7)
      fail(fmt::format("must hold px,py,pz,qx,qy,qz and maybe a weight, not {}", counted(n.size(), "number")));
    Handle h;
    h.p = {n[0], n[1], n[2]}, h.q = {n[3], n[4], n[5]};
    if (n.size() == 7) h.weight = n[6];
    if (!(h.weight > 0)) fail("the weight must be positive");
    handles.push_back(h);
  }
  return handles;
}

JsonValue json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

std::vector<Handle> parse_handles(const std::string& whole, const std::string& name) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";  // byte order mark before UTF-8
  const std::string text = whole.starts_with(kMark) ? whole.substr(kMark.size()) : whole;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw FileError(name, "is empty");
  try {
    std::vector<Handle> handles =
        text[first] == '{' || text[first] == '[' ? handles_of_json(text) : handles_of_table(text);
    if (handles.empty()) throw ArgumentError("holds no handles");
    return handles;
  } catch (const ArgumentError& error) {
    throw FileError(name, error.what());
  }
}

std::vector<Handle> read_handles(const std::string& file) { return parse_handles(read_text(file), file); }

std::string handles_json(std::span<const Handle> handles) {
  JsonValue all = JsonValue::array();
  for (const Handle& h : handles) {
    JsonValue one;
    one["p"] = json_of(h.p), one["q"] = json_of(h.q);
    if (h.p_end) one["p_end"] = json_of(*h.p_end);
    if (h.q_end) one["q_end"] = json_of(*h.q_end);
    if (h.weight != 1) one["weight"] = h.weight;
    if (!h.group.empty()) one["group"] = h.group;
    if (h.reach) one["reach"] = *h.reach;
    if (h.directions.size() == 1)
      one["normal"] = {{"before", json_of(h.directions[0].before)}, {"after", json_of(h.directions[0].after)}};
    if (h.directions.size() == 3) {
      JsonValue before, after;
      for (const TurnedDirection& d : h.directions)
        before.push_back(json_of(d.before)), after.push_back(json_of(d.after));
      one["frame"] = {{"before", before}, {"after", after}};
    }
    all.push_back(std::move(one));
  }
  return JsonValue{{"handles", std::move(all)}}.dump(2, ' ', false, JsonValue::error_handler_t::replace) + "\n";
}

std::vector<Handle> handles_of_pair(const PointSet& before, const PointSet& after,
                                    std::span<const std::uint32_t> vertices) {
  if (before.size() != after.size())
    throw ArgumentError(fmt::format("registered meshes need equal numbers of vertices, not {} and {}",
                                    grouped(before.size()), grouped(after.size())));
  std::vector<Handle> handles;
  for (const std::uint32_t v : vertices) {
    if (v >= before.size())
      throw ArgumentError(fmt::format("there is no vertex {}: they are numbered from 0 to {}", v, before.size() - 1));
    Handle h;
    h.p = before.origin + Vec3(before.positions[v]), h.q = after.origin + Vec3(after.positions[v]);
    if (!is_finite(h.p) || !is_finite(h.q)) throw ArgumentError(fmt::format("vertex {} is not finite", v));
    handles.push_back(std::move(h));
  }
  return handles;
}

std::vector<std::uint32_t> spread_vertices_of(const PointSet& points, std::size_t count) {
  std::vector<std::uint32_t> chosen;
  const std::size_t n = points.size();
  Vec3 mean;
  std::size_t finite = 0;
  for (const Vec3f& p : points.positions)
    if (is_finite(p)) mean += Vec3(p), ++finite;
  if (finite == 0) return chosen;
  mean = mean / static_cast<double>(finite);
  // Squared distance from the chosen vertices; initially from the mean.
  std::vector<double> away(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (is_finite(points.positions[i])) away[i] = squared_norm(Vec3(points.positions[i]) - mean);
  while (chosen.size() < count) {
    const auto farthest = std::max_element(away.begin(), away.end());
    if (!(*farthest > 0) && !chosen.empty()) break;
    const auto v = static_cast<std::size_t>(farthest - away.begin());
    chosen.push_back(static_cast<std::uint32_t>(v));
    const bool first = chosen.size() == 1;
    for (std::size_t i = 0; i < n; ++i) {
      if (!is_finite(points.positions[i])) continue;
      const double d = squared_norm(Vec3(points.positions[i]) - Vec3(points.positions[v]));
      away[i] = first ? d : std::min(away[i], d);
    }
  }
  return chosen;
}

}  // namespace sansmesh::inline v1
