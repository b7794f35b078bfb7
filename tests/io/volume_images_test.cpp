// Images: MetaImage, NRRD and raw numbers.
#include <zlib.h>

#include <numeric>

#include "volume_test_tools.h"

namespace sansmesh::inline v1 {
namespace {

/// Position of entry i in the lattice of 5 × 4 × 3 that `counting(60)` fills.
Vec3 place_of(std::size_t i) {
  const std::size_t y = i / 5 % 4, z = i / 20;
  return {static_cast<double>(i % 5), static_cast<double>(y), static_cast<double>(z)};
}

using namespace test;

std::vector<double> counting(std::size_t n) {
  std::vector<double> v(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = static_cast<double>((7 * i) % 120);
  return v;
}

std::string deflated(const std::string& bytes, bool gzip) {
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, 9, Z_DEFLATED, gzip ? 31 : 15, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(bytes.size() + 200, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  out.resize(out.size() - z.avail_out);
  deflateEnd(&z);
  return out;
}

struct NamedType {
  NumberType type;
  const char *met, *nrrd, *name;
  std::string (*bytes)(const std::vector<double>&, bool);
};
const NamedType kTypes[] = {
    {NumberType::i8, "MET_CHAR", "signed char", "int8", packed<std::int8_t>},
    {NumberType::u8, "MET_UCHAR", "uchar", "uint8", packed<std::uint8_t>},
    {NumberType::i16, "MET_SHORT", "short", "int16", packed<std::int16_t>},
    {NumberType::u16, "MET_USHORT", "unsigned short", "uint16", packed<std::uint16_t>},
    {NumberType::i32, "MET_INT", "int", "int32", packed<std::int32_t>},
    {NumberType::u32, "MET_UINT", "uint32_t", "uint32", packed<std::uint32_t>},
    {NumberType::i64, "MET_LONG_LONG", "int64", "int64", packed<std::int64_t>},
    {NumberType::u64, "MET_ULONG_LONG", "unsigned long long", "uint64", packed<std::uint64_t>},
    {NumberType::f32, "MET_FLOAT", "float", "float32", packed<float>},
    {NumberType::f64, "MET_DOUBLE", "double", "float64", packed<double>},
};

/// Whether a volume of 5 x 4 x 3 points has the numbers of counting() in order, and this type.
void expect_counting(const GridData& data, NumberType type, std::size_t components = 1) {
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  ASSERT_EQ(point_count(b), 60u);
  const Attribute* const a = b.point_arrays.find("value");
  ASSERT_NE(a, nullptr);
  EXPECT_EQ(a->type(), type);
  EXPECT_EQ(a->components, components);
  const std::vector<double> expected = counting(60 * components);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(a->number(i), expected[i]);
}

TEST(MetaImage, AllTypesAndByteOrdersInOneFileAndInTwo) {
  const Folder folder;
  for (const NamedType& t : kTypes) {
    for (const bool big : {false, true}) {
      const std::string head = std::string("ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = ") + t.met +
                               "\nElementByteOrderMSB = " + (big ? "True" : "False") + "\n";
      const std::string bytes = t.bytes(counting(60), big);
      expect_counting(read_volume(folder.put("a.mha", head + "ElementDataFile = LOCAL\n" + bytes)), t.type);
      folder.put("b.raw", bytes);
      expect_counting(read_volume(folder.put("b.mhd", head + "ElementDataFile = b.raw\n")), t.type);
      folder.put("c.zraw", deflated(bytes, false));
      expect_counting(read_volume(folder.put("c.mhd", head + "CompressedData = True\nElementDataFile = c.zraw\n")),
                      t.type);
    }
  }
}

TEST(MetaImage, PointsLieWhereSpacingOffsetAndMatrixSay) {
  const Folder folder;
  // Rotated by 90° around z, mirrored along the third axis.
  const GridData data = read_volume(
      folder.put("a.mha",
                 "NDims = 3\nDimSize = 5 4 3\nElementType = MET_UCHAR\nElementSpacing = 0.5 2 3\nOffset = 10 20 30\n"
                 "TransformMatrix = 0 1 0 -1 0 0 0 0 -1\nElementDataFile = LOCAL\n" +
                     packed<std::uint8_t>(counting(60))));
  const GridBlock& b = data.blocks[0];
  ASSERT_EQ(b.kind, GridKind::lattice);
  for (std::size_t i = 0; i < 60; ++i) {
    const auto [x, y, z] = place_of(i);
    EXPECT_LT(norm(place(b, i) - Vec3{10 - 2 * y, 20 + 0.5 * x, 30 - 3 * z}), 1e-12);
  }
}

TEST(MetaImage, ChannelsListsPatternsTextAndHeadersToSkip) {
  const Folder folder;
  const std::string head = "NDims = 3\nDimSize = 5 4 3\nElementType = MET_USHORT\n";
  expect_counting(read_volume(folder.put("rgb.mha", head + "ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n" +
                                                        packed<std::uint16_t>(counting(180)))),
                  NumberType::u16, 3);
  const std::string bytes = packed<std::uint16_t>(counting(60));
  for (int k = 0; k < 3; ++k)
    folder.put("slice" + std::to_string(k + 1) + ".raw", bytes.substr(static_cast<std::size_t>(k) * 40, 40));
  const NumberType u16 = NumberType::u16;
  expect_counting(
      read_volume(folder.put("l.mhd", head + "ElementDataFile = LIST\nslice1.raw\nslice2.raw\nslice3.raw\n")), u16);
  expect_counting(read_volume(folder.put("p.mhd", head + "ElementDataFile = slice%d.raw 1 3 1\n")), u16);
  folder.put("h.raw", "a header of its own" + bytes);
  expect_counting(read_volume(folder.put("h.mhd", head + "HeaderSize = 19\nElementDataFile = h.raw\n")), u16);
  expect_counting(read_volume(folder.put("m.mhd", head + "HeaderSize = -1\nElementDataFile = h.raw\n")), u16);
  std::string text;
  for (const double v : counting(60)) text += std::to_string(static_cast<int>(v)) + (text.size() % 3 ? " " : "\n");
  expect_counting(read_volume(folder.put("t.mha", head + "BinaryData = False\nElementDataFile = LOCAL\n" + text)), u16);
}

TEST(MetaImage, PlanesAndSteps) {
  const Folder folder;
  const GridData plane = read_volume(folder.put(
      "a.mha", "NDims = 2\nDimSize = 5 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string(20, 'x')));
  EXPECT_EQ(plane.blocks[0].axes[2].size(), 1u);
  const std::string file =
      folder.put("b.mha", "NDims = 4\nDimSize = 5 4 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
                              std::string(60, 'x') + packed<std::uint8_t>(counting(60)));
  expect_counting(read_volume(file, {.time_step = 1}), NumberType::u8);
  EXPECT_THROW(read_volume(file, {.time_step = 2}), ArgumentError);
}

TEST(Nrrd, AllTypesByteOrdersAndEncodings) {
  const Folder folder;
  for (const NamedType& t : kTypes) {
    for (const bool big : {false, true}) {
      const std::string head = std::string("NRRD0004\n# a comment\ntype: ") + t.nrrd +
                               "\ndimension: 3\nsizes: 5 4 3\nkey:=value\nendian: " + (big ? "big" : "little") + "\n";
      const std::string bytes = t.bytes(counting(60), big);
      expect_counting(read_volume(folder.put("a.nrrd", head + "encoding: raw\n\n" + bytes)), t.type);
      expect_counting(read_volume(folder.put("b.nrrd", head + "encoding: gzip\n\n" + deflated(bytes, true))), t.type);
      folder.put("c.raw", "1234" + bytes);
      expect_counting(read_volume(folder.put("c.nhdr", head + "encoding: raw\nbyte skip: 4\ndata file: c.raw\n")),
                      t.type);
      expect_counting(read_volume(folder.put("d.nhdr", head + "encoding: raw\nbyte skip: -1\ndata file: c.raw\n")),
                      t.type);
      folder.put("e.raw.gz", deflated(bytes, true));
      expect_counting(read_volume(folder.put("e.nhdr", head + "encoding: gz\ndata file: e.raw.gz\n\n")), t.type);
    }
    std::string text, hex;
    for (const double v : counting(60)) text += std::to_string(static_cast<int>(v)) + "\n";
    for (const char c : t.bytes(counting(60), false)) {
      char two[3];
      std::snprintf(two, sizeof two, "%02x", static_cast<unsigned char>(c));
      hex += two;
    }
    const std::string head = std::string("NRRD0001\ntype: ") + t.nrrd + "\ndimension: 3\nsizes: 5 4 3\nencoding: ";
    expect_counting(read_volume(folder.put("t.nrrd", head + "ascii\n\n" + text)), t.type);
    expect_counting(read_volume(folder.put("h.nrrd", head + "hex\nendian: little\n\n" + hex)), t.type);
  }
}

TEST(Nrrd, DirectionsShearedOnesToo) {
  const Folder folder;
  const std::string head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: raw\nspace origin: (1,2,3)\n";
  const std::string bytes = packed<std::uint8_t>(counting(60));
  const auto check = [&](const std::string& directions, GridKind kind, const Vec3& a, const Vec3& b, const Vec3& c) {
    const GridData data = read_volume(folder.put("a.nrrd", head + "space directions: " + directions + "\n\n" + bytes));
    expect_counting(data, NumberType::u8);
    const GridBlock& block = data.blocks[0];
    EXPECT_EQ(block.kind, kind);
    for (std::size_t i = 0; i < 60; ++i) {
      const auto [x, y, z] = place_of(i);
      EXPECT_LT(norm(place(block, i) - (Vec3{1, 2, 3} + a * x + b * y + c * z)), 1e-12);
    }
  };
  check("(0,2,0) (-1,0,0) (0,0,0.5)", GridKind::lattice, {0, 2, 0}, {-1, 0, 0}, {0, 0, 0.5});
  check("(1,0,0) (0.5,1,0) (0,0,2)", GridKind::curvilinear, {1, 0, 0}, {0.5, 1, 0}, {0, 0, 2});
}

TEST(Nrrd, ComponentsOnAnyAxisAndSteps) {
  const Folder folder;
  const std::vector<double> numbers = counting(180);
  const auto bytes_of = [&](std::size_t inner) {  // the components after `inner` points
    std::vector<double> moved(180);
    for (std::size_t i = 0; i < 60; ++i) {
      for (std::size_t c = 0; c < 3; ++c) moved[(i / inner * 3 + c) * inner + i % inner] = numbers[i * 3 + c];
    }
    return packed<std::uint8_t>(moved);
  };
  const std::string head = "NRRD0004\ntype: uchar\ndimension: 4\nencoding: raw\n";
  expect_counting(
      read_volume(folder.put("a.nrrd", head + "sizes: 3 5 4 3\nkinds: vector domain domain domain\n\n" + bytes_of(1))),
      NumberType::u8, 3);
  expect_counting(
      read_volume(folder.put("b.nrrd", head + "sizes: 5 4 3 3\nkinds: domain domain domain vector\n\n" + bytes_of(60))),
      NumberType::u8, 3);
  expect_counting(
      read_volume(folder.put(
          "c.nrrd", head + "sizes: 5 3 4 3\nspace directions: (1,0,0) none (0,1,0) (0,0,1)\n\n" + bytes_of(5))),
      NumberType::u8, 3);
  const std::string series = folder.put("d.nrrd", head + "sizes: 5 4 3 2\nkinds: space space space list\n\n" +
                                                      std::string(60, 'x') + packed<std::uint8_t>(counting(60)));
  expect_counting(read_volume(series, {.time_step = 1}), NumberType::u8);
  EXPECT_THROW(read_volume(series, {.time_step = 2}), ArgumentError);
}

TEST(RawImage, ByItsNameAndByItsLayout) {
  const Folder folder;
  for (const NamedType& t : kTypes) {
    const std::string bytes = t.bytes(counting(60), false);
    expect_counting(read_volume(folder.put(std::string("vol_5x4x3_") + t.name + ".raw", bytes)), t.type);
    expect_counting(read_volume(folder.put(std::string("vol_5x4x3_") + t.name + ".raw.gz", deflated(bytes, true))),
                    t.type);
    RawLayout layout;
    layout.dims = {5, 4, 3}, layout.type = t.type, layout.big_endian = true, layout.header_bytes = 2;
    layout.spacing = {2, 1, 1};
    const GridData data = read_volume(folder.put("any.thing", "ab" + t.bytes(counting(60), true)), {.raw = layout});
    expect_counting(data, t.type);
    EXPECT_EQ(place(data.blocks[0], 4), (Vec3{8, 0, 0}));
  }
  expect_no_volume(folder.put("vol_5x4x3_uint8.raw", std::string(59, 'x')), "truncated");
  expect_no_volume(folder.put("vol_5x4x3_uint8.raw", std::string(61, 'x')), "1 more");
  expect_no_volume(folder.put("vol.raw", std::string(60, 'x')), "without a header");
  EXPECT_THROW(read_volume(folder.put("vol_5x4x3_uint8.raw", std::string(60, 'x')), {.time_step = 1}), ArgumentError);
  RawLayout none;
  none.dims = {5, 0, 3};
  EXPECT_THROW(read_volume(folder / "vol.raw", {.raw = none}), ArgumentError);
}

TEST(Images, EveryTruncationIsAnErrorAndNothingGarbledDoesHarm) {
  const Folder folder;
  const std::string bytes = packed<std::uint16_t>(counting(60));
  const std::pair<const char*, std::string> samples[] = {
      {"a.mha",
       "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = MET_USHORT\nElementDataFile = LOCAL\n" + bytes},
      {"b.mha",
       "NDims = 3\nDimSize = 5 4 3\nElementType = MET_USHORT\nCompressedData = True\nElementDataFile = LOCAL\n" +
           deflated(bytes, false)},
      {"c.nrrd", "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 5 4 3\nendian: big\nencoding: raw\n\n" + bytes},
      {"d.nrrd",
       "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 5 4 3\nendian: big\nencoding: gzip\n\n" + deflated(bytes, true)},
  };
  std::mt19937 random(5);
  for (const auto& [name, content] : samples) {
    ASSERT_TRUE(volume_readable(folder.put(name, content))) << name;
    for (std::size_t n = 0; n < content.size(); n += n < 120 ? 1 : 7)
      EXPECT_FALSE(volume_readable(folder.put(name, content.substr(0, n)))) << n;
    for (int k = 0; k < 200; ++k) {
      std::string garbled = content;
      for (int j = 0; j < 3; ++j) garbled[random() % garbled.size()] = static_cast<char>(random() % 256);
      volume_readable(folder.put(name, garbled));
    }
  }
}

TEST(Images, WhatHeadersMayNotSay) {
  const Folder folder;
  const std::string end = "ElementDataFile = LOCAL\n" + std::string(60, 'x'), size = "NDims = 3\nDimSize = 5 4 3\n";
  const auto meta = [&](const std::string& head, const std::string& part) {
    expect_no_volume(folder.put("a.mha", head + end), part);
  };
  meta("DimSize = 5 4 3\nElementType = MET_UCHAR\n", "NDims");
  meta("NDims = 3\nElementType = MET_UCHAR\n", "DimSize");
  meta("NDims = 3\nDimSize = 5 4\nElementType = MET_UCHAR\n", "3 numbers");
  meta("NDims = 3\nDimSize = 5 -4 3\nElementType = MET_UCHAR\n", "impossible size");
  meta("NDims = 3\nDimSize = 1e12 1e12 1e12\nElementType = MET_UCHAR\n", "impossible size");
  meta(size, "ElementType");
  meta(size + "ElementType = MET_STRING\n", "MET_STRING");
  meta(size + "ElementType = MET_UCHAR\nElementSpacing = 1 0 1\n", "spacing");
  meta(size + "ElementType = MET_UCHAR\nElementSpacing = 1 x 1\n", "3 numbers");
  meta(size + "ElementType = MET_UCHAR\nTransformMatrix = 1 0 0 1 0 0 0 0 1\n", "plane");
  expect_file_error(folder / "gone.raw", "no such file", [&] {
    read_volume(folder.put("b.mhd", size + "ElementType = MET_UCHAR\nElementDataFile = gone.raw\n"));
  });
  const auto nrrd = [&](const std::string& head, const std::string& part) {
    expect_no_volume(folder.put("a.nrrd", "NRRD0004\n" + head + "\n" + std::string(60, 'x')), part);
  };
  nrrd("dimension: 3\nsizes: 5 4 3\n", "type");
  nrrd("type: block\ndimension: 3\nsizes: 5 4 3\n", "block");
  nrrd("type: uchar\nsizes: 5 4 3\n", "dimension");
  nrrd("type: uchar\ndimension: 3\n", "sizes");
  nrrd("type: short\ndimension: 3\nsizes: 5 2 3\n", "endian");
  nrrd("type: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: bzip2\n", "bzip2");
  nrrd("type: uchar\ndimension: 3\nsizes: 5 4 3\nspace directions: (1,0,0) (0,1,0)\n", "each axis");
  expect_no_volume(folder.put("unknown", std::string(60, 'x')), "no ending");
  expect_no_volume(folder.put("a.unknown", std::string(60, 'x')), "unknown ending");
  expect_no_volume(folder.put("empty.mhd", ""), "empty");
  expect_no_volume(folder / "gone.mhd", "no such file");
}

}  // namespace
}  // namespace sansmesh::inline v1
