// From where a picture is taken, and which part of it is kept.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/image.h"
#include "sansmesh/option.h"
#include "sansmesh/render/picture_crop.h"
#include "sansmesh/render/render_options.h"

namespace sansmesh::inline v1 {

enum class NamedView : std::uint8_t { front, back, left, right, top, bottom, iso };

/// A part of a picture: the box, or what is not background.
struct PictureCrop {
  std::optional<PixelBox> box = {};
  friend bool operator==(const PictureCrop&, const PictureCrop&) = default;
};
// As an option: "LEFT,TOP,WIDTH,HEIGHT" or "content".
std::string text_of_option(const PictureCrop& crop);
void option_of_text(std::string_view text, PictureCrop& crop);

struct ViewOptions {
  std::optional<NamedView> view = {};
  std::optional<double> azimuth = {}, elevation = {};  ///< without `view`; default: those of RenderOptions
  bool z_up = false;
  std::optional<PictureCrop> crop = {};

  static const OptionSchema& schema();
  /// Tells whether a direction was chosen.
  bool has_direction() const { return view || azimuth || elevation; }
  /// The options as seen so. Throws ArgumentError for a part that does not lie in the picture.
  RenderOptions applied_to(RenderOptions options) const;
  /// Throws ArgumentError where several pictures would differ in size.
  void check_frames(bool several) const;
  /// Of a picture that was made with these options the part that was asked for. Throws ArgumentError where that does
  /// not lie in it.
  Image part_of(const Image& image, const RenderOptions& made_with) const;
};

}  // namespace sansmesh::inline v1
