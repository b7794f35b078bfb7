// Files of moving objects: tetrahedra, collections of steps, animated PNG.
#include <zlib.h>

#include "io_test_tools.h"
#include "sansmesh/io/animation.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/io/tets/write_tets.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

TetMesh two_tets() {
  TetMesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  m.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  m.attributes.set("velocity", std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, 3);
  m.tet_attributes.set("part & parcel", std::vector<std::int32_t>{4, 5});
  return m;
}

TEST(TetFrames, AreReadBackByVtk) {
  if (std::string why; !has_vtk_readers(&why)) GTEST_SKIP() << why;
  const Folder folder;
  TetMesh mesh = two_tets();
  // More than one compressed block.
  for (int k = 0; k < 20000; ++k) mesh.tets.push_back(mesh.tets[static_cast<std::size_t>(k % 2)]);
  mesh.tet_attributes.clear();
  write_tets(folder / "a_0000.vtu", mesh);
  for (Vec3& p : mesh.vertices) p += Vec3{4e6, 0, 0};  // requires double precision
  write_tets(folder / "a_0001.vtu", mesh);
  const TimedFile files[] = {{0, "a_0000.vtu"}, {0.25, "a_0001.vtu"}};
  write_collection(folder / "a.pvd", files);
  VolumeReadOptions second;
  second.time_step = 1;
  const GridData data = read_volume(folder / "a.pvd", second);
  EXPECT_EQ(data.times, (std::vector<double>{0, 0.25}));
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  ASSERT_EQ(b.cells.size(), mesh.tets.size());
  for (std::size_t v = 0; v < 5; ++v) EXPECT_EQ(b.points[v], mesh.vertices[v]);
  for (std::size_t t = 0; t < mesh.tets.size(); t += 999)
    for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(b.cells[t][c], mesh.tets[t][c]);
  EXPECT_EQ(b.point_arrays.find("velocity")->number(14), 15);
  const GridData first = read_volume(folder / "a.pvd");
  EXPECT_EQ(first.blocks[0].points[4], (Vec3{1, 1, 1}));
}

TEST(TetFrames, WhatCannotBeWritten) {
  const Folder folder;
  TetMesh mesh = two_tets();
  expect_file_error(folder / "a.vtk", "known: .vtu", [&] { check_tets_writable(folder / "a.vtk"); });
  expect_file_error(folder / "none/a.vtu", "folder does not exist", [&] { write_tets(folder / "none/a.vtu", mesh); });
  mesh.tets[0][2] = 5;
  EXPECT_THROW(write_tets(folder / "a.vtu", mesh), ArgumentError);
  mesh = two_tets();
  mesh.vertices.pop_back();
  EXPECT_THROW(write_tets(folder / "a.vtu", mesh), ArgumentError);
  EXPECT_EQ(folder.entries(), 0u);
}

/// Chunks of a PNG with correct checksums.
std::vector<std::pair<std::string, std::string>> chunks_of(const std::string& file) {
  const std::string s = slurp(file);
  EXPECT_EQ(s.substr(0, 8), "\x89PNG\r\n\x1a\n");
  const auto number = [&](std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 4; ++k) v = v << 8 | static_cast<unsigned char>(s[at + k]);
    return v;
  };
  std::vector<std::pair<std::string, std::string>> all;
  for (std::size_t at = 8; at + 12 <= s.size();) {
    const std::size_t size = number(at);
    all.emplace_back(s.substr(at + 4, 4), s.substr(at + 8, size));
    EXPECT_EQ(number(at + 8 + size),
              crc32(0, reinterpret_cast<const Bytef*>(s.data() + at + 4), static_cast<uInt>(size + 4)));
    at += 12 + size;
  }
  return all;
}

std::uint32_t word(const std::string& s, std::size_t k) {
  std::uint32_t v = 0;
  for (std::size_t c = 0; c < 4; ++c) v = v << 8 | static_cast<unsigned char>(s[4 * k + c]);
  return v;
}

/// Inverts PNG's filters according to its specification.
std::vector<std::uint8_t> unfiltered(const std::string& packed, std::size_t width, std::size_t height,
                                     std::size_t pixel) {
  std::vector<std::uint8_t> rows((width * pixel + 1) * height);
  uLongf size = static_cast<uLongf>(rows.size());
  EXPECT_EQ(
      uncompress(rows.data(), &size, reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size())),
      Z_OK);
  EXPECT_EQ(size, rows.size());
  std::vector<std::uint8_t> out(width * pixel * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* const in = rows.data() + y * (width * pixel + 1);
    for (std::size_t i = 0; i < width * pixel; ++i) {
      std::uint8_t* const o = out.data() + y * width * pixel + i;
      const int a = i >= pixel ? o[-static_cast<std::ptrdiff_t>(pixel)] : 0;
      const int b = y > 0 ? o[-static_cast<std::ptrdiff_t>(width * pixel)] : 0;
      const int c = i >= pixel && y > 0 ? o[-static_cast<std::ptrdiff_t>(width * pixel + pixel)] : 0;
      const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      const int guess[] = {0, a, b, (a + b) / 2, pa <= pb && pa <= pc ? a : pb <= pc ? b : c};
      *o = static_cast<std::uint8_t>(in[i + 1] + guess[in[0]]);
    }
  }
  return out;
}

Image picture(int frame, bool clear) {
  Image image(23, 17);
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 23; ++x)
      image.at(x, y) = {from_byte(static_cast<std::uint8_t>(10 * x)), from_byte(static_cast<std::uint8_t>(x * y % 256)),
                        0.25f, clear ? from_byte(static_cast<std::uint8_t>(15 * y)) : 1.f};
  // A moving square.
  for (int y = 4; y < 8; ++y)
    for (int x = 3 + frame; x < 8 + frame; ++x) image.at(x, y)[2] = 1;
  return image;
}

TEST(AnimatedPng, ShowsWhatWasAdded) {
  const Folder folder;
  for (const bool clear : {false, true}) {
    Animation animation(12.5);
    for (const int frame : {0, 1, 1, 5}) animation.add(picture(frame, clear));
    animation.write(folder / "a.png");
    const auto chunks = chunks_of(folder / "a.png");
    std::vector<std::string> names;
    for (const auto& c : chunks) names.push_back(c.first);
    EXPECT_EQ(names, (std::vector<std::string>{"IHDR", "acTL", "fcTL", "IDAT", "fcTL", "fdAT", "fcTL", "fdAT", "fcTL",
                                               "fdAT", "IEND"}));
    EXPECT_EQ(word(chunks[1].second, 0), 4u);
    const std::size_t pixel = clear ? 4 : 3;
    EXPECT_EQ(chunks[0].second[9], clear ? 6 : 2);
    // Played according to the specification, each frame equals the added picture.
    std::vector<std::uint8_t> screen(23 * 17 * pixel);
    std::uint32_t sequence = 0;
    std::size_t at = 2;
    for (const int frame : {0, 1, 1, 5}) {
      const std::string& control = chunks[at].second;
      EXPECT_EQ(word(control, 0), sequence++);
      const std::size_t w = word(control, 1), h = word(control, 2), x0 = word(control, 3), y0 = word(control, 4);
      EXPECT_DOUBLE_EQ((static_cast<unsigned char>(control[20]) * 256.0 + static_cast<unsigned char>(control[21])) /
                           (static_cast<unsigned char>(control[22]) * 256.0 + static_cast<unsigned char>(control[23])),
                       1 / 12.5);
      std::string data = chunks[at + 1].second;
      if (at > 2) {
        EXPECT_EQ(word(data, 0), sequence++);
        data = data.substr(4);
        EXPECT_LT(w * h, 23u * 17 / 4);
      }
      at += 2;
      const std::vector<std::uint8_t> part = unfiltered(data, w, h, pixel);
      for (std::size_t y = 0; y < h; ++y)
        std::copy_n(part.begin() + static_cast<std::ptrdiff_t>(y * w * pixel), w * pixel,
                    screen.begin() + static_cast<std::ptrdiff_t>(((y0 + y) * 23 + x0) * pixel));
      const Image wanted = picture(frame, clear);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < wanted.pixels.size(); ++i)
        for (std::size_t c = 0; c < pixel; ++c) wrong += screen[i * pixel + c] != to_byte(wanted.pixels[i][c]);
      EXPECT_EQ(wrong, 0u) << frame;
    }
  }
}

TEST(AnimatedPng, WhatCannotBe) {
  const Folder folder;
  EXPECT_THROW(Animation(0), ArgumentError);
  Animation animation(30);
  EXPECT_THROW(animation.write(folder / "a.png"), ArgumentError);
  animation.add(picture(0, false));
  EXPECT_THROW(animation.add(Image(4, 4)), ArgumentError);
  expect_file_error(folder / "a.gif", "'.gif'", [&] { animation.write(folder / "a.gif"); });
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
