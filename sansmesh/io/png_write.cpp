// PNG through libpng, into memory first: the file then appears whole.
#include <png.h>

#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"

namespace sansmesh {

void write_image(const std::string& file, const Image& image) {
  if (io::ending(file) != "png") check_writable(file, "image");
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw ArgumentError("write_image: the image has no pixels or not width × height of them");
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGBA;
  // The bound is enough for any content, so compression runs once.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr)) {
    const std::string message = png.message;
    png_image_free(&png);
    throw FileError(file, "cannot be encoded as PNG (" + message + ")");
  }
  bytes.resize(size);
  io::write_whole(file, {std::move(bytes)});
}

}  // namespace sansmesh
