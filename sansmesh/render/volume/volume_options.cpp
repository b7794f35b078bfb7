#include "sansmesh/volume_look.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_words.h"
#include "sansmesh/render/volume/transfer_presets.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMostSurfaces = 16;

std::optional<double> number_in_text(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string_view> pieces_of(std::string_view text, char between) {
  std::vector<std::string_view> pieces;
  for (;;) {
    const std::size_t at = text.find(between);
    pieces.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return pieces;
    text.remove_prefix(at + 1);
  }
}

std::optional<Vec3> direction_of(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  if (text == "x") return Vec3{1, 0, 0};
  if (text == "y") return Vec3{0, 1, 0};
  if (text == "z") return Vec3{0, 0, 1};
  const auto parts = pieces_of(text, ',');
  if (parts.size() != 3) return std::nullopt;
  Vec3 n;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = number_in_text(parts[k]);
    if (!value) return std::nullopt;
    n[k] = *value;
  }
  if (!(norm(n) > 0)) return std::nullopt;
  return n;
}

/// One of the presets; an empty name is none.
struct PresetOption {
  static constexpr auto kind = OptionKind::choice;
  static OptionValue get(const std::string& name) {
    const auto known = transfer_function_presets();
    const auto at = std::find(known.begin(), known.end(), name);
    return at == known.end() ? OptionValue() : OptionValue(static_cast<std::int64_t>(at - known.begin()));
  }
  static std::string from(const OptionValue& value) {
    return std::string(transfer_function_presets()[static_cast<std::size_t>(std::get<std::int64_t>(value))]);
  }
};

struct CutOption {
  static constexpr auto kind = OptionKind::texts;
  static OptionValue get(const std::vector<VolumeCut>& cuts) {
    std::vector<std::string> words;
    words.reserve(cuts.size());
    for (const VolumeCut& c : cuts) {
      const std::string along = fmt::format("{},{},{}", c.normal.x, c.normal.y, c.normal.z);
      words.push_back(std::isinf(c.thickness) ? fmt::format("{}>{}", along, c.offset)
                                              : fmt::format("{}<{}<{}", c.offset, along, c.offset + c.thickness));
    }
    return words;
  }
  static std::vector<VolumeCut> from(const OptionValue& value) {
    std::vector<VolumeCut> cuts;
    for (const std::string& word : std::get<std::vector<std::string>>(value)) cuts.push_back(volume_cut_of(word));
    return cuts;
  }
};

}  // namespace

std::string text_of_option(const IsoSurface& iso) {
  return fmt::format("{}:{}:{}", iso.value, iso.color ? hex_of_color(*iso.color) : "", iso.opacity);
}

IsoSurface iso_surface_of(const std::string& text) {
  const auto fail = [&] {
    throw ArgumentError("an iso-surface is VALUE, VALUE:#rrggbb or VALUE:#rrggbb:OPACITY, not '" + printable(text, 60) +
                        "'");
  };
  const auto parts = pieces_of(text, ':');
  IsoSurface iso;
  const auto value = number_in_text(parts[0]);
  if (!value || parts.size() > 3) fail();
  iso.value = *value;
  if (parts.size() > 1 && !parts[1].empty()) {
    iso.color = color_of_hex(parts[1]);
    if (!iso.color) fail();
  }
  if (parts.size() > 2) {
    const auto opacity = number_in_text(parts[2]);
    if (!opacity) fail();
    iso.opacity = *opacity;
    check_range("opacity of an iso-surface", iso.opacity, 0, 1);
  }
  return iso;
}

VolumeCut volume_cut_of(const std::string& text) {
  const auto fail = [&] {
    throw ArgumentError("a cut is written as x>1, y<2, -1<z<2 or NX,NY,NZ>OFFSET (the removed part), not '" +
                        printable(text, 60) + "'");
  };
  VolumeCut cut;
  if (const auto parts = pieces_of(text, '>'); parts.size() == 2) {
    const auto n = direction_of(parts[0]);
    const auto offset = number_in_text(parts[1]);
    if (!n || !offset) fail();
    cut.normal = *n, cut.offset = *offset;
    return cut;
  }
  const auto parts = pieces_of(text, '<');
  if (parts.size() == 2) {
    const auto n = direction_of(parts[0]);
    const auto offset = number_in_text(parts[1]);
    if (!n || !offset) fail();
    cut.normal = -*n, cut.offset = -*offset;
    return cut;
  }
  if (parts.size() != 3) fail();
  const auto n = direction_of(parts[1]);
  const auto low = number_in_text(parts[0]), high = number_in_text(parts[2]);
  if (!n || !low || !high || !(*high > *low)) fail();
  cut.normal = *n, cut.offset = *low, cut.thickness = *high - *low;
  return cut;
}

const OptionSchema& VolumePictureOptions::schema() {
  using O = VolumePictureOptions;
  static const OptionRow rows[] = {
      option_group<&O::picture>(RenderOptions::schema().rows),
      option<&O::preset, PresetOption>(
          {.text = "Colours and opacities: ct-bone, ct-soft-tissue, mr, flow, diverging, gray",
           .unit = "name",
           .from_data = "from the values' histogram",
           .choices = transfer_function_presets()}),
      option<&O::opacity_factor>({.text = "Multiplies the opacity; 0: iso-surfaces and clip faces only",
                                  .unit = "factor",
                                  .range = {.least = 0, .most = 1000},
                                  .old_name = "opacity"}),
      option<&O::isos>({.text = "Surface of a value: V, V:#rrggbb, V:#rrggbb:OPACITY; may be repeated",
                        .unit = "value",
                        .name = "iso"}),
      option<&O::clips, CutOption>(
          {.text = "Removes a half-space or slab: 'x>1.5', '-1<z<2', '1,1,0>3'; may be repeated",
           .unit = "place",
           .name = "clip",
           .old_name = "cut"}),
      option<&O::clip_faces>({.text = "Faces of `clip` do not show their values", .old_name = "no_cut_faces"}),
      option<&O::shading>({.text = "Plain colours of the transfer function, without light"}),
      option<&O::color_title>({.text = "Title of the colour bar", .from_data = "the array's name", .name = "label"}),
      option<&O::title>({.text = "Title above the picture"})};
  static const OptionSchema schema{rows};
  return schema;
}

void VolumePictureOptions::validate() const {
  picture.validate();
  if (transfer) transfer->validate();
  if (transfer && !preset.empty()) throw ArgumentError("`preset` and `transfer` exclude each other");
  if (!preset.empty()) {
    const auto known = transfer_function_presets();
    if (std::find(known.begin(), known.end(), preset) == known.end())
      transfer_function_preset(preset, ValueHistogram{});  // throws with the list of known presets
  }
  check_range("opacity_factor", opacity_factor, 0, 1000);
  check_range("step", step, 0.05, 4);
  check_range("least_light", least_light, 0, 0.1);
  check_range("pixel_error", pixel_error, 0, 255);
  if (isos.size() > kMostSurfaces)
    throw ArgumentError(fmt::format("`isos` may hold {} surfaces, not {}", kMostSurfaces, isos.size()));
  if (clips.size() > kMostSurfaces)
    throw ArgumentError(fmt::format("`clip` may be given {} times, not {}", kMostSurfaces, clips.size()));
  for (const IsoSurface& iso : isos) {
    if (!std::isfinite(iso.value)) throw ArgumentError("`isos`: values must be finite");
    check_range("isos.opacity", iso.opacity, 0, 1);
    if (iso.color)
      for (std::size_t k = 0; k < 3; ++k) check_range("isos.color", static_cast<double>((*iso.color)[k]), 0, 1);
  }
  for (const VolumeCut& cut : clips) {
    if (!is_finite(cut.normal) || !(norm(cut.normal) > 0))
      throw ArgumentError("`clip`: a normal must have a direction");
    if (!std::isfinite(cut.offset)) throw ArgumentError("`clip`: offsets must be finite");
    if (!(cut.thickness > 0))
      throw ArgumentError(fmt::format("`clip`: a thickness must be positive, not {:g}", cut.thickness));
  }
}

}  // namespace sansmesh::inline v1
