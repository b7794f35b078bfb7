#include "sansmesh/volume_look.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sansmesh/core/json_text-inl.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/color_words.h"

namespace sansmesh::inline v1 {
namespace {

using TransferJson = nlohmann::ordered_json;

constexpr int kTransferVersion = 1;
constexpr int kCurved = 16;  // line segments that approximate a curve between two points

[[noreturn]] void transfer_error(const std::string& cause) { throw ArgumentError(cause); }

double transfer_number(const TransferJson& json, const std::string& where) {
  if (!json.is_number()) transfer_error(where + " must be a number");
  return json.get<double>();
}

const TransferJson& transfer_list(const TransferJson& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) transfer_error(fmt::format("'{}' is missing", key));
  if (!found->is_array()) transfer_error(fmt::format("'{}' must be a list", key));
  return *found;
}

Vec3f transfer_color(const std::string& text, const std::string& where) {
  const auto color = color_of_hex(text);
  if (!color) transfer_error(where + ": colours are written as \"#rrggbb\"");
  return *color;
}

TransferFunction own_transfer_function(const TransferJson& json) {
  constexpr std::array<std::string_view, 6> kKnown{"version",          "name",   "mixing",
                                                   "reference_length", "colors", "opacities"};
  for (const auto& [key, value] : json.items())
    if (std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) {
      std::string all;
      for (const std::string_view k : kKnown) all += (all.empty() ? "" : ", ") + std::string(k);
      transfer_error(fmt::format("unknown field '{}'; known: {}", printable(key, 40), all));
    }
  if (!json.contains("version")) transfer_error("'version' is missing");
  if (json["version"] != kTransferVersion) transfer_error(fmt::format("'version' must be {}", kTransferVersion));
  TransferFunction f;
  if (json.contains("name")) {
    if (!json["name"].is_string()) transfer_error("'name' must be a text");
    f.name = json["name"].get<std::string>();
  }
  if (json.contains("mixing")) {
    const TransferJson& mixing = json["mixing"];
    if (mixing != "rgb" && mixing != "lab" && mixing != "step")
      transfer_error("'mixing' must be \"lab\", \"rgb\" or \"step\"");
    f.mixing = mixing == "rgb" ? ColorMixing::rgb : mixing == "lab" ? ColorMixing::lab : ColorMixing::step;
  }
  if (json.contains("reference_length"))
    f.reference_length = transfer_number(json["reference_length"], "'reference_length'");
  std::size_t at = 0;
  for (const TransferJson& p : transfer_list(json, "colors")) {
    const std::string where = fmt::format("colour {}", ++at);
    if (p.is_array() && p.size() == 2 && p[1].is_string()) {
      f.colors.push_back({transfer_number(p[0], where), transfer_color(p[1].get<std::string>(), where)});
    } else if (p.is_array() && p.size() == 4) {
      std::array<double, 4> n{};
      for (std::size_t k = 0; k < 4; ++k) n[k] = transfer_number(p[k], where);
      f.colors.push_back({n[0], Vec3f(Vec3{n[1], n[2], n[3]})});
    } else {
      transfer_error(where + " must be [value, \"#rrggbb\"] or [value, red, green, blue]");
    }
  }
  at = 0;
  for (const TransferJson& p : transfer_list(json, "opacities")) {
    const std::string where = fmt::format("opacity {}", ++at);
    if (!p.is_array() || p.size() != 2) transfer_error(where + " must be [value, opacity]");
    f.opacities.push_back({transfer_number(p[0], where), transfer_number(p[1], where)});
  }
  return f;
}

/// The numbers of one of ParaView's lists, `each` per point.
std::vector<double> paraview_numbers(const TransferJson& json, const char* key, std::size_t each) {
  const TransferJson& list = transfer_list(json, key);
  if (list.empty() || list.size() % each != 0)
    transfer_error(fmt::format("'{}' must hold {} numbers per point, not {} in total", key, each, list.size()));
  std::vector<double> numbers;
  for (const TransferJson& n : list) numbers.push_back(transfer_number(n, fmt::format("'{}'", key)));
  return numbers;
}

/// Opacity between two of ParaView's points: the curve reaches the mean at `midpoint`, and approaches a step with
/// growing sharpness.
double paraview_opacity(double a, double b, double t, double midpoint, double sharpness) {
  midpoint = std::clamp(midpoint, 1e-5, 1 - 1e-5);
  t = t < midpoint ? 0.5 * t / midpoint : 0.5 + 0.5 * (t - midpoint) / (1 - midpoint);
  if (sharpness > 0.99) return t < 0.5 ? a : b;
  if (sharpness < 0.01) return a + (b - a) * t;
  t = t < 0.5 ? 0.5 * std::pow(2 * t, 1 + 10 * sharpness) : 1 - 0.5 * std::pow(2 * (1 - t), 1 + 10 * sharpness);
  const double t2 = t * t, t3 = t2 * t, slope = (1 - sharpness) * (b - a);
  const double value =
      (2 * t3 - 3 * t2 + 1) * a + (3 * t2 - 2 * t3) * b + (t3 - 2 * t2 + t) * slope + (t3 - t2) * slope;
  return std::clamp(value, std::min(a, b), std::max(a, b));
}

TransferFunction paraview_transfer_function(const TransferJson& json) {
  if (!json.is_object()) transfer_error("a colour map must be an object");
  if (json.contains("IndexedColors") && !json.contains("RGBPoints"))
    transfer_error("a colour map of indexed colours is for categories, not for a volume");
  TransferFunction f;
  if (json.contains("Name") && json["Name"].is_string()) f.name = json["Name"].get<std::string>();
  std::string space = "RGB";
  if (json.contains("ColorSpace")) {
    if (!json["ColorSpace"].is_string()) transfer_error("'ColorSpace' must be a text");
    space = json["ColorSpace"].get<std::string>();
  }
  const std::vector<double> rgb = paraview_numbers(json, "RGBPoints", 4);
  for (std::size_t i = 0; i < rgb.size(); i += 4)
    f.colors.push_back({rgb[i], Vec3f(Vec3{rgb[i + 1], rgb[i + 2], rgb[i + 3]})});
  if (space == "Lab" || space == "CIELAB" || space == "Lab/CIEDE2000" || space == "CIEDE2000") {
    f.mixing = ColorMixing::lab;
  } else if (space == "RGB") {
    f.mixing = ColorMixing::rgb;
  } else if (space == "Step") {
    f.mixing = ColorMixing::step;
  } else if (space == "Diverging" || space == "HSV") {
    f.mixing = ColorMixing::rgb;
    std::vector<ColorPoint> fine;
    for (std::size_t i = 0; i + 1 < f.colors.size(); ++i) {
      const ColorPoint &a = f.colors[i], &b = f.colors[i + 1];
      for (int k = 0; k < kCurved; ++k) {
        const double t = k / static_cast<double>(kCurved);
        fine.push_back({a.value + t * (b.value - a.value),
                        space == "HSV" ? mix_hsv(a.color, b.color, t) : mix_diverging(a.color, b.color, t)});
      }
    }
    fine.push_back(f.colors.back());
    f.colors = std::move(fine);
  } else {
    transfer_error("unknown 'ColorSpace' '" + printable(space, 40) + "': RGB, Lab, CIEDE2000, HSV, Diverging or Step");
  }
  if (!json.contains("Points")) {
    f.opacities = {{f.colors.front().value, 0}, {f.colors.back().value, 0.2}};
    return f;
  }
  const std::vector<double> points = paraview_numbers(json, "Points", 4);
  for (std::size_t i = 0; i + 4 < points.size(); i += 4) {
    const double midpoint = points[i + 2], sharpness = points[i + 3];
    const bool straight = std::abs(midpoint - 0.5) < 1e-6 && sharpness < 0.01;
    const int pieces = straight ? 1 : kCurved;
    for (int k = 0; k < pieces; ++k) {
      const double t = k / static_cast<double>(pieces);
      f.opacities.push_back({points[i] + t * (points[i + 4] - points[i]),
                             paraview_opacity(points[i + 1], points[i + 5], t, midpoint, sharpness)});
    }
  }
  f.opacities.push_back({points[points.size() - 4], points[points.size() - 3]});
  return f;
}

}  // namespace

TransferFunction parse_transfer_function(std::string_view text, const std::string& file) {
  try {
    const auto json = detail::parse_json<TransferJson>(text);
    TransferFunction f;
    if (json.is_array()) {
      if (json.empty()) transfer_error("the list of colour maps is empty");
      f = paraview_transfer_function(json[0]);
    } else if (!json.is_object()) {
      transfer_error("a transfer function must be an object");
    } else {
      f = json.contains("RGBPoints") || json.contains("ColorSpace") ? paraview_transfer_function(json)
                                                                    : own_transfer_function(json);
    }
    f.validate();
    return f;
  } catch (const ArgumentError& error) {
    throw FileError(file, error.what());
  }
}

TransferFunction read_transfer_function(const std::string& file) {
  return parse_transfer_function(read_text(file), file);
}

std::string transfer_function_json(const TransferFunction& f) {
  TransferJson json;
  json["version"] = kTransferVersion;
  json["name"] = f.name;
  json["mixing"] = f.mixing == ColorMixing::rgb ? "rgb" : f.mixing == ColorMixing::lab ? "lab" : "step";
  if (f.reference_length) json["reference_length"] = *f.reference_length;
  json["colors"] = TransferJson::array();
  for (const ColorPoint& p : f.colors) json["colors"].push_back({p.value, p.color.x, p.color.y, p.color.z});
  json["opacities"] = TransferJson::array();
  for (const OpacityPoint& p : f.opacities) json["opacities"].push_back({p.value, p.opacity});
  return json.dump(2, ' ', false, TransferJson::error_handler_t::replace) + "\n";
}

}  // namespace sansmesh::inline v1
