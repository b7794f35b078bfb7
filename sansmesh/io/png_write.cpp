// PNG through libpng, first into memory, so that the file appears whole.
#include <png.h>

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/image.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1 {

void write_image(const std::string& file, const Image& image) {
  if (io::ending(file) != "png") check_writable(file, "image");
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw ArgumentError("write_image: the image has no pixels or not width × height of them");
  }
  std::vector<std::array<std::uint8_t, 4>> levels(image.pixels.size());
  parallel_for(0, levels.size(), 1 << 14, [&](std::size_t i) {
    for (std::size_t c = 0; c < 4; ++c) levels[i][c] = to_byte(image.pixels[i][c]);
  });
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGBA;
  // The bound suffices for any content, so compression runs once.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, levels.data(), 0, nullptr)) {
    const std::string message = png.message;
    png_image_free(&png);
    throw FileError(file, "cannot be encoded as PNG (" + message + ")");
  }
  bytes.resize(size);
  io::write_whole(file, {std::move(bytes)});
}

}  // namespace sansmesh::inline v1
