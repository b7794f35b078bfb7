#include "sansmesh/io/animation.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kPngLevel = 6;

void put_whole(std::string& to, std::uint32_t v, int bytes = 4) {
  for (int k = bytes - 1; k >= 0; --k) to += static_cast<char>(v >> (8 * k) & 0xff);
}

/// Appends a chunk: length, type, data and checksum.
void put_chunk(std::string& to, const char* type, std::string_view data) {
  put_whole(to, static_cast<std::uint32_t>(data.size()));
  const std::size_t first = to.size();
  to += type;
  to += data;
  put_whole(
      to, static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(to.data() + first), to.size() - first)));
}

std::uint8_t paeth(int left, int above, int corner) {
  const int p = left + above - corner;
  const int a = std::abs(p - left), b = std::abs(p - above), c = std::abs(p - corner);
  return static_cast<std::uint8_t>(a <= b && a <= c ? left : b <= c ? above : corner);
}

/// A row after the PNG filter (of five) that leaves the smallest numbers, preceded by the filter's number.
void filter_row(const std::vector<std::uint8_t>& row, const std::vector<std::uint8_t>& above, std::size_t pixel,
                std::uint8_t* out) {
  std::size_t best = 0;
  std::uint64_t least = ~std::uint64_t{0};
  const auto filtered = [&](std::size_t filter, std::size_t i) {
    const int left = i >= pixel ? row[i - pixel] : 0, corner = i >= pixel ? above[i - pixel] : 0;
    const int guess = filter == 0   ? 0
                      : filter == 1 ? left
                      : filter == 2 ? above[i]
                      : filter == 3 ? (left + above[i]) / 2
                                    : paeth(left, above[i], corner);
    return static_cast<std::uint8_t>(row[i] - guess);
  };
  for (std::size_t filter = 0; filter < 5; ++filter) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      sum += static_cast<std::uint64_t>(std::abs(static_cast<std::int8_t>(filtered(filter, i))));
    if (sum < least) least = sum, best = filter;
  }
  out[0] = static_cast<std::uint8_t>(best);
  for (std::size_t i = 0; i < row.size(); ++i) out[i + 1] = filtered(best, i);
}

}  // namespace

Animation::Animation(double frames_per_second) : rate_(frames_per_second) {
  if (!(frames_per_second >= 0.01 && frames_per_second <= 1000)) throw ArgumentError("`fps` must be in 0.01..1000");
}

void Animation::add(const Image& picture) {
  if (picture.width <= 0 || picture.height <= 0 ||
      picture.pixels.size() != static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height))
    throw ArgumentError("a picture of an animation has no pixels or not width × height of them");
  std::vector<std::array<std::uint8_t, 4>> levels(picture.pixels.size());
  parallel_for(0, levels.size(), 1 << 14, [&](std::size_t i) {
    for (std::size_t c = 0; c < 4; ++c) levels[i][c] = to_byte(picture.pixels[i][c]);
  });
  if (frames_.empty()) {
    width_ = static_cast<std::uint32_t>(picture.width), height_ = static_cast<std::uint32_t>(picture.height);
    opaque_ = std::all_of(levels.begin(), levels.end(), [](const auto& p) { return p[3] == 255; });
  } else if (static_cast<std::uint32_t>(picture.width) != width_ ||
             static_cast<std::uint32_t>(picture.height) != height_) {
    throw ArgumentError("the pictures of an animation must have the same size");
  }
  // The changed rectangle; one pixel if nothing changes.
  Frame f{0, 0, width_, height_, {}};
  if (!frames_.empty()) {
    std::uint32_t x0 = width_, x1 = 0, y0 = height_, y1 = 0;
    for (std::uint32_t y = 0; y < height_; ++y)
      for (std::uint32_t x = 0; x < width_; ++x) {
        const std::size_t i = std::size_t{y} * width_ + x;
        if (levels[i] == last_[i]) continue;
        x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
      }
    f = x1 > x0 ? Frame{x0, y0, x1 - x0, y1 - y0, {}} : Frame{0, 0, 1, 1, {}};
  }
  const std::size_t pixel = opaque_ ? 3 : 4, row_bytes = pixel * f.width;
  std::vector<std::uint8_t> rows((row_bytes + 1) * f.height);
  parallel_for(0, f.height, 16, [&](std::size_t y) {
    std::vector<std::uint8_t> row(row_bytes), above(row_bytes, 0);
    const auto read = [&](std::size_t line, std::vector<std::uint8_t>& to) {
      for (std::size_t x = 0; x < f.width; ++x)
        for (std::size_t c = 0; c < pixel; ++c) to[x * pixel + c] = levels[(f.y + line) * width_ + f.x + x][c];
    };
    read(y, row);
    if (y > 0) read(y - 1, above);
    filter_row(row, above, pixel, rows.data() + y * (row_bytes + 1));
  });
  uLongf length = compressBound(static_cast<uLong>(rows.size()));
  f.packed.resize(length);
  if (compress2(reinterpret_cast<Bytef*>(f.packed.data()), &length, rows.data(), static_cast<uLong>(rows.size()),
                kPngLevel) != Z_OK)
    throw Error("a picture cannot be compressed");
  f.packed.resize(length);
  frames_.push_back(std::move(f));
  last_ = std::move(levels);
}

void Animation::write(const std::string& file) const {
  if (io::ending(file) != "png") check_writable(file, "image");
  if (frames_.empty()) throw ArgumentError("the animation has no pictures");
  std::string bytes = "\x89PNG\r\n\x1a\n", chunk;
  put_whole(chunk, width_);
  put_whole(chunk, height_);
  chunk += {8, static_cast<char>(opaque_ ? 2 : 6), 0, 0, 0};
  put_chunk(bytes, "IHDR", chunk);
  chunk.clear();
  put_whole(chunk, static_cast<std::uint32_t>(frames_.size()));
  put_whole(chunk, 0);  // repeated endlessly
  put_chunk(bytes, "acTL", chunk);
  std::uint32_t sequence = 0;
  // Seconds as a fraction of 16 bits each.
  const std::uint32_t bottom = rate_ >= 1 ? index_in<std::uint32_t>(std::round(1000 * rate_), 1000, 60000)
                                          : index_in<std::uint32_t>(65000 * rate_, 1, 1000);
  const auto top = index_in<std::uint32_t>(std::round(bottom / rate_), 1, 65535);
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    const Frame& f = frames_[k];
    chunk.clear();
    put_whole(chunk, sequence++);
    for (const std::uint32_t v : {f.width, f.height, f.x, f.y}) put_whole(chunk, v);
    put_whole(chunk, std::min<std::uint32_t>(top, 65535), 2);
    put_whole(chunk, bottom, 2);
    chunk += {0, 0};  // disposal: keep the frame; blending: replace what is below
    put_chunk(bytes, "fcTL", chunk);
    if (k == 0) {
      put_chunk(bytes, "IDAT", f.packed);
      continue;
    }
    chunk.clear();
    put_whole(chunk, sequence++);
    put_chunk(bytes, "fdAT", chunk + f.packed);
  }
  put_chunk(bytes, "IEND", {});
  io::write_whole(file, {std::move(bytes)});
}

}  // namespace sansmesh::inline v1
