#include "sansmesh/deform/handle_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "sansmesh/core/json_text-inl.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using HandleJson = nlohmann::ordered_json;

/// Errors name the file, the handle and the key.
struct HandlePlace {
  const std::string& file;
  std::string where;

  [[noreturn]] void fail(const std::string& cause) const {
    throw FileError(file, where.empty() ? cause : where + ": " + cause);
  }
};

void check_keys(const HandleJson& json, std::initializer_list<std::string_view> known, const HandlePlace& at) {
  for (const auto& [key, value] : json.items())
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      std::string all;
      for (const std::string_view k : known) all += (all.empty() ? "" : ", ") + std::string(k);
      at.fail(fmt::format("unknown key '{}'; known: {}", printable(key, 40), all));
    }
}

double handle_number(const HandleJson& json, const char* key, const HandlePlace& at) {
  if (!json.is_number() || !std::isfinite(json.get<double>())) at.fail(fmt::format("'{}' must be a number", key));
  return json.get<double>();
}

Vec3 handle_vector(const HandleJson& json, const char* key, const HandlePlace& at) {
  if (!json.is_array() || json.size() != 3) at.fail(fmt::format("'{}' must be three numbers, [x, y, z]", key));
  Vec3 v;
  for (std::size_t k = 0; k < 3; ++k) v[k] = handle_number(json[k], key, at);
  return v;
}

constexpr double kRounding = 1e-15;

/// The direction with length 1. One that has it but for rounding stays as it is: files read back as they were written.
Vec3 unit_direction(const Vec3& v) { return std::abs(norm(v) - 1) <= kRounding ? v : normalized(v); }

Vec3 handle_direction(const HandleJson& json, const char* key, const HandlePlace& at) {
  const Vec3 v = handle_vector(json, key, at);
  if (!(norm(v) > 0)) at.fail(fmt::format("'{}' holds a direction of length 0", key));
  return unit_direction(v);
}

/// The objects `before` and `after` of a direction or a frame.
std::array<const HandleJson*, 2> before_after(const HandleJson& json, const char* key, const HandlePlace& at) {
  if (!json.is_object()) at.fail(fmt::format("'{}' must be an object with 'before' and 'after'", key));
  check_keys(json, {"before", "after"}, {at.file, fmt::format("{}, '{}'", at.where, key)});
  for (const char* const side : {"before", "after"})
    if (!json.contains(side)) at.fail(fmt::format("'{}' lacks '{}'", key, side));
  return {&json["before"], &json["after"]};
}

/// Three directions at right angles to each other, and right-handed: a little off by rounding is put right.
std::array<Vec3, 3> frame_of(const HandleJson& json, const HandlePlace& at) {
  constexpr double kOff = 1e-3;
  if (!json.is_array() || json.size() != 3) at.fail("'frame' must hold three directions before and three after");
  std::array<Vec3, 3> f;
  for (std::size_t k = 0; k < 3; ++k) f[k] = handle_direction(json[k], "frame", at);
  if (std::abs(dot(f[0], f[1])) > kOff || std::abs(dot(f[1], f[2])) > kOff || std::abs(dot(f[2], f[0])) > kOff)
    at.fail("the directions of 'frame' must be at right angles to each other");
  if (const double off = dot(f[0], f[1]); std::abs(off) > kRounding) f[1] = unit_direction(f[1] - f[0] * off);
  const Vec3 third = cross(f[0], f[1]);
  if (dot(third, f[2]) < 0) at.fail("the directions of 'frame' must be right-handed: a turn cannot mirror");
  f[2] = third;
  return f;
}

Handle handle_of(const HandleJson& json, const HandlePlace& at) {
  if (!json.is_object()) at.fail("must be an object with 'p' and 'q'");
  check_keys(json, {"p", "q", "p_end", "q_end", "weight", "group", "reach", "normal", "frame"}, at);
  if (!json.contains("p")) at.fail("'p', its place before, is missing");
  Handle h;
  h.p = handle_vector(json["p"], "p", at);
  h.q = json.contains("q") ? handle_vector(json["q"], "q", at) : h.p;
  if (json.contains("p_end")) {
    h.p_end = handle_vector(json["p_end"], "p_end", at);
    if (json.contains("q") != json.contains("q_end"))
      at.fail(json.contains("q") ? "'q_end', the place of the segment's end after, is missing"
                                 : "'q', the place of the segment's begin after, is missing");
    h.q_end = json.contains("q_end") ? handle_vector(json["q_end"], "q_end", at) : *h.p_end;
    if (*h.p_end == h.p) at.fail("the segment has no length: 'p_end' is 'p'");
  } else if (json.contains("q_end")) {
    at.fail("'q_end' needs 'p_end'");
  }
  if (json.contains("weight")) {
    h.weight = handle_number(json["weight"], "weight", at);
    if (!(h.weight > 0)) at.fail("'weight' must be positive");
  }
  if (json.contains("reach")) {
    h.reach = handle_number(json["reach"], "reach", at);
    if (!(*h.reach > 0)) at.fail("'reach' must be a positive length");
  }
  if (json.contains("group")) {
    if (!json["group"].is_string()) at.fail("'group' must be a text");
    h.group = json["group"].get<std::string>();
  }
  if (json.contains("normal") && json.contains("frame")) at.fail("give 'normal' or 'frame', not both");
  if (json.contains("normal")) {
    const auto [before, after] = before_after(json["normal"], "normal", at);
    h.directions = {{handle_direction(*before, "normal", at), handle_direction(*after, "normal", at)}};
  }
  if (json.contains("frame")) {
    const auto [before, after] = before_after(json["frame"], "frame", at);
    const std::array<Vec3, 3> a = frame_of(*before, at), b = frame_of(*after, at);
    for (std::size_t k = 0; k < 3; ++k) h.directions.push_back({a[k], b[k]});
  }
  if (h.reach && h.directions.empty()) at.fail("'reach' is of a 'normal' or a 'frame': there is none");
  return h;
}

std::vector<Handle> handles_of_json(const std::string& text, const std::string& name) {
  const HandlePlace file{name, {}};
  HandleJson json;
  try {
    // Of two keys in an object the last would win, silently.
    std::vector<std::set<std::string>> keys;
    json = detail::parse_json<HandleJson>(text, [&](int, HandleJson::parse_event_t event, HandleJson& value) {
      if (event == HandleJson::parse_event_t::object_start) keys.emplace_back();
      if (event == HandleJson::parse_event_t::object_end) keys.pop_back();
      if (event == HandleJson::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
        file.fail(fmt::format("key '{}' stands twice in an object", printable(value.get<std::string>(), 40)));
      return true;
    });
  } catch (const ArgumentError& error) {
    file.fail(error.what());
  }
  if (!json.is_object()) file.fail("must be an object with 'handles'");
  check_keys(json, {"handles"}, file);
  if (!json.contains("handles") || !json["handles"].is_array()) file.fail("'handles' must be a list");
  std::vector<Handle> handles;
  for (const HandleJson& h : json["handles"])
    handles.push_back(handle_of(h, {name, fmt::format("handle {}", handles.size() + 1)}));
  return handles;
}

/// The numbers of a row; nothing where a word is none.
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

/// Whether a row begins like one of numbers, so that it is no names of columns.
bool row_of_numbers(std::string_view row) {
  const std::size_t first = row.find_first_not_of(" \t\r+-.");
  return first != std::string_view::npos && row[first] >= '0' && row[first] <= '9';
}

std::vector<Handle> handles_of_table(const std::string& text, const std::string& name) {
  std::vector<Handle> handles;
  std::vector<double> n;
  std::size_t line = 0;
  bool named = false;  // the names of the columns have been passed
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view row(text.data() + begin, end - begin);
    begin = end + 1;
    ++line;
    const std::size_t first = row.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || row[first] == '#') continue;
    const HandlePlace at{name, fmt::format("line {}", line)};
    if (!numbers_of(row, n)) {
      if (handles.empty() && !named && !row_of_numbers(row)) {
        named = true;
        continue;
      }
      at.fail("must hold numbers: px,py,pz,qx,qy,qz and maybe a weight");
    }
    if (n.size() != 6 && n.size() != 7)
      at.fail(fmt::format("must hold px,py,pz,qx,qy,qz and maybe a weight, not {}", counted(n.size(), "number")));
    Handle h;
    h.p = {n[0], n[1], n[2]}, h.q = {n[3], n[4], n[5]};
    if (n.size() == 7) h.weight = n[6];
    if (!(h.weight > 0)) at.fail("the weight must be positive");
    handles.push_back(h);
  }
  return handles;
}

HandleJson json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

std::vector<Handle> parse_handles(const std::string& whole, const std::string& name) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";  // that some editors put before UTF-8
  const std::string text = whole.starts_with(kMark) ? whole.substr(kMark.size()) : whole;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw FileError(name, "is empty");
  std::vector<Handle> handles =
      text[first] == '{' || text[first] == '[' ? handles_of_json(text, name) : handles_of_table(text, name);
  if (handles.empty()) throw FileError(name, "holds no handles");
  return handles;
}

std::vector<Handle> read_handles(const std::string& file) { return parse_handles(read_text(file), file); }

std::string handles_json(std::span<const Handle> handles) {
  HandleJson all = HandleJson::array();
  for (const Handle& h : handles) {
    HandleJson one;
    one["p"] = json_of(h.p), one["q"] = json_of(h.q);
    if (h.p_end) one["p_end"] = json_of(*h.p_end);
    if (h.q_end) one["q_end"] = json_of(*h.q_end);
    if (h.weight != 1) one["weight"] = h.weight;
    if (!h.group.empty()) one["group"] = h.group;
    if (h.reach) one["reach"] = *h.reach;
    if (h.directions.size() == 1)
      one["normal"] = {{"before", json_of(h.directions[0].before)}, {"after", json_of(h.directions[0].after)}};
    if (h.directions.size() == 3) {
      HandleJson before, after;
      for (const TurnedDirection& d : h.directions)
        before.push_back(json_of(d.before)), after.push_back(json_of(d.after));
      one["frame"] = {{"before", before}, {"after", after}};
    }
    all.push_back(std::move(one));
  }
  return HandleJson{{"handles", std::move(all)}}.dump(2, ' ', false, HandleJson::error_handler_t::replace) + "\n";
}

std::vector<Handle> handles_of_pair(const PointSet& before, const PointSet& after,
                                    std::span<const std::uint32_t> vertices) {
  if (before.size() != after.size())
    throw ArgumentError(fmt::format("registered meshes have as many vertices, but one has {} and the other {}",
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
  // Squared distance from the chosen ones; from the mean while there are none.
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
