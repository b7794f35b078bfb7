// Pictures of an object from all sides.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Text and range of the option `frames` of static pictures.
inline constexpr OptionFacts kTurntable{.text = "Number of pictures of a turntable around the up axis: NAME_000.png, …",
                                        .unit = "count",
                                        .range = {2, 100000}};

/// Draws one picture, or all of a turntable, and passes them to `use`. `draw` receives the options with their view.
template <class Draw>
void draw_turntable(RenderOptions picture, const std::optional<int>& frames, const UsePicture& use, const Draw& draw) {
  std::size_t number = 0;
  for (const ViewDirection& view : turntable(picture.view.direction, frames.value_or(1))) {
    picture.view.direction = view;
    use(number++, draw(picture), picture);
  }
}

}  // namespace sansmesh::inline v1
