// LAZ: compression and decompression of all point formats, chunk tables, damaged files, files of other programs.
#include "laz_test_tools.h"
#include "oracle.h"
#include "sansmesh/box.h"
#include "sansmesh/io/laz/chunk_table.h"
#include "sansmesh/io/laz/integer_model.h"
#include "sansmesh/io/laz/layered_chunk.h"
#include "sansmesh/io/laz/pointwise_chunk.h"
#include "sansmesh/io/laz/read_laz.h"
#include "sansmesh/threads.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using namespace io::laz;

void expect_same_cloud(const PointSet& a, const PointSet& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.attributes, b.attributes);
}

TEST(Laz, ChunksKeepEveryByte) {
  for (unsigned format = 0; format <= 10; ++format) {
    for (const std::size_t n : {std::size_t{1}, std::size_t{2}, std::size_t{3000}}) {
      SCOPED_TRACE(std::to_string(format) + ", " + std::to_string(n));
      const std::size_t extra = format % 3, length = kRecordOfFormat[format] + extra;
      LazLayout layout = laz_layout(format, length);
      for (const bool fixed : {false, true}) {  // versions 2 and 1, or 3 and 4
        layout.fixed_channels = fixed, layout.first_version = fixed;
        const std::string records = survey_records(format, extra, n);
        std::string packed, padded, back(records.size(), '\x11');
        std::size_t used = 0;
        if (layout.layered) {
          encode_layered(layout, records.data(), n, packed);
          padded = packed + "rest";
          LayeredChunk chunk(layout, padded, n, back.data());
          ASSERT_TRUE(chunk.decode_positions() && chunk.decode_rest());
          used = chunk.length();
        } else {
          encode_pointwise(layout, records.data(), n, packed);
          used = decode_pointwise(layout, packed + "rest", n, back.data());
        }
        EXPECT_EQ(used, packed.size());
        EXPECT_EQ(back, records);
        if (n > 1000) {
          EXPECT_LT(packed.size(), records.size() * 7 / 10);
        }
      }
    }
  }
}

TEST(Laz, FilesEqualUncompressedOnes) {
  const Folder folder;
  for (unsigned minor = 0; minor <= 4; ++minor) {
    for (unsigned format = 0; format <= last_point_format(minor); ++format) {
      SCOPED_TRACE(std::to_string(minor) + ", format " + std::to_string(format));
      const std::size_t length = kRecordOfFormat[format];
      const std::string records = survey_records(format, 0, 2500, false);
      ReadReport report;
      const PointSet plain = read_points(folder.put("a.las", las_with_records(minor, format, records, length)));
      const PointSet packed =
          read_points(folder.put("a.laz", las_with_records(minor, format, records, length, true)), &report);
      EXPECT_EQ(report.format, "LAZ 1." + std::to_string(minor));
      expect_same_cloud(packed, plain);
      const unsigned version = format < 6 ? 1 : 4;
      const std::string other = compress_las(las_with_records(minor, format, records, length), 700, version);
      expect_same_cloud(read_points(folder.put("b.laz", other)), plain);
    }
  }
}

TEST(Laz, SameForAnyNumberOfThreads) {
  const Folder folder;
  const std::string file =
      folder.put("a.laz", las_with_records(4, 7, survey_records(7, 0, 9000), kRecordOfFormat[7], true));
  const auto with = [&](unsigned threads) {
    const ThreadScope scope(threads);
    return read_points(file);
  };
  expect_same_cloud(with(1), with(2));
}

/// The position of the chunk table may be at the end of the file, or missing if the writer was interrupted.
TEST(Laz, ChunkTables) {
  const Folder folder;
  for (const unsigned format : {3u, 8u}) {
    const std::size_t length = kRecordOfFormat[format];
    const std::string records = survey_records(format, 0, 2500, false);
    const std::string good = las_with_records(4, format, records, length, true);
    const PointSet expected = read_points(folder.put("good.laz", good));
    const auto begin = static_cast<std::size_t>(load_number<std::uint32_t>(good, 96));
    const auto table = load_number<std::int64_t>(good, begin);
    std::string piped = good;
    piped.replace(begin, 8, raw(std::int64_t{-1}));
    expect_same_cloud(read_points(folder.put("piped.laz", piped + raw(table))), expected);

    std::string cut = good.substr(0, static_cast<std::size_t>(table));
    cut.replace(begin, 8, raw(static_cast<std::int64_t>(begin)));
    ReadReport report;
    expect_same_cloud(read_points(folder.put("cut.laz", cut), &report), expected);
    EXPECT_EQ(report.warnings, std::vector<std::string>{"its writer was interrupted before it wrote the chunk table"});
  }
}

/// Chunks of any size may be empty: those after them begin behind their bytes.
TEST(Laz, EmptyChunks) {
  constexpr std::int32_t entries[][2] = {{10, 100}, {0, 50}, {0, 0}, {5, 200}};  // points, bytes
  ArithmeticEncoder encoder;
  const auto model = std::make_unique<IntegerModel<32, 2>>();
  std::int32_t points = 0, bytes = 0;
  for (const auto& entry : entries) {
    points = model->code(encoder, points, entry[0], 0);
    bytes = model->code(encoder, bytes, entry[1], 1);
  }
  const std::string file = raw(std::int64_t{358}) + std::string(350, '\0') + raw(std::uint32_t{0}) +
                           raw(std::uint32_t{4}) + encoder.finish();
  const std::string name = "a.laz";
  ReadReport report;
  io::LasHeader header;
  header.count = 15, header.record = 20;
  LazLayout layout = laz_layout(0, 20);
  layout.chunk_points = kVariableChunks;
  const std::vector<Chunk> chunks = read_chunk_table({name, file, report}, header, layout).chunks;
  ASSERT_EQ(chunks.size(), 2u);
  EXPECT_EQ(chunks[0].begin, 8u);
  EXPECT_EQ(chunks[1].begin, 158u);
  EXPECT_EQ(chunks[1].bytes, 200u);
  EXPECT_EQ(chunks[1].points, 5u);
}

/// The oldest files have one chunk for all points and no table.
TEST(Laz, OneChunk) {
  const Folder folder;
  const std::string records = survey_records(1, 0, 500);
  std::string file = las_with_records(1, 1, records, 28, true, 5000);
  const PointSet expected = read_points(folder.put("chunks.laz", file));
  const auto begin = static_cast<std::size_t>(load_number<std::uint32_t>(file, 96));
  const auto table = static_cast<std::size_t>(load_number<std::int64_t>(file, begin));
  file = file.substr(0, begin) + file.substr(begin + 8, table - begin - 8);
  file[227 + 54] = 1;  // compressor
  expect_same_cloud(read_points(folder.put("one.laz", file)), expected);
}

TEST(Laz, BadFiles) {
  const Folder folder;
  for (const unsigned format : {3u, 7u}) {
    const std::string good =
        las_with_records(4, format, survey_records(format, 0, 2500, false), kRecordOfFormat[format], true);
    const auto refuse = [&](const std::string& content, const std::string& part) {
      expect_unreadable(folder.put("a.laz", content), part);
    };
    const auto with = [&](std::size_t at, const std::string& bytes) {
      return std::string(good).replace(at, bytes.size(), bytes);
    };
    const std::size_t vlr = 375, begin = load_number<std::uint32_t>(good, 96);
    refuse(with(vlr + 18, raw(std::uint16_t{1})), "the record that describes the compression is missing");
    refuse(with(vlr + 54, raw(std::uint16_t{7})), "unsupported LAZ compressor 7");
    refuse(with(vlr + 54 + 38, raw(std::uint16_t{9})), "unsupported version 9");
    refuse(with(vlr + 54 + 36, raw(std::uint16_t{19})), "does not fit point format");
    refuse(with(247, raw(std::uint64_t{1} << 39)), "points cannot be in");
    refuse(with(247, raw(std::uint64_t{3501})), "announces 3,501 points, but its chunks hold 2,800");
    refuse(with(begin, raw(std::uint64_t{0})), "its chunk table is before the points");
    refuse(with(begin, raw(std::uint64_t{1} << 40)), "truncated");
    refuse(good.substr(0, good.size() / 2), "truncated");
    refuse(good.substr(0, begin + 20), "truncated");
    std::string flipped = good;
    for (std::size_t i = begin + 300; i < begin + 900; ++i) flipped[i] = static_cast<char>(~flipped[i]);
    try {
      read_points(folder.put("a.laz", flipped));  // flipped bits may be other points
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("chunk 1 of 4 is damaged"), std::string::npos) << error.what();
    }
  }
}

TEST(Laz, WritesWhatItReads) {
  const Folder folder;
  for (const unsigned format : {0u, 3u, 6u, 7u, 8u}) {
    SCOPED_TRACE(format);
    const std::size_t length = kRecordOfFormat[format];
    const PointSet cloud =
        read_points(folder.put("in.las", las_with_records(4, format, survey_records(format, 0, 3000, false), length)));
    write_points(folder / "out.laz", cloud);
    write_points(folder / "out.las", cloud);
    ReadReport report;
    const PointSet packed = read_points(folder / "out.laz", &report);
    EXPECT_EQ(report.format.substr(0, 3), "LAZ");
    EXPECT_TRUE(report.warnings.empty());
    expect_same_cloud(packed, read_points(folder / "out.las"));
    EXPECT_LT(std::filesystem::file_size(folder / "out.laz"), std::filesystem::file_size(folder / "out.las"));
  }
}

TEST(Laz, BoxesSelectWhileReading) {
  const Folder folder;
  for (const unsigned format : {1u, 6u}) {
    const std::size_t length = kRecordOfFormat[format];
    const std::string records = survey_records(format, 0, 5000, false);
    for (const bool packed : {false, true}) {
      const std::string file =
          folder.put(packed ? "a.laz" : "a.las", las_with_records(4, format, records, length, packed));
      const PointSet all = read_points(file);
      const Box3 box{{5.0005, -0.5005, 17.0005}, {40.0005, 0.5005, 19.7005}};  // between the steps of the file
      std::vector<Vec3> inside;
      for (const Vec3f& p : all.positions)
        if (const Vec3 q = all.origin + Vec3(p); box.contains(q)) inside.push_back(q);
      ASSERT_GT(inside.size(), 10u);
      const PointSet some = read_points(file, nullptr, {.box = box});
      ASSERT_EQ(some.size(), inside.size());
      for (std::size_t i = 0; i < inside.size(); ++i)
        ASSERT_LT(norm(some.origin + Vec3(some.positions[i]) - inside[i]), 1e-3);
      expect_file_error(file, "holds no points in the box", [&] {
        read_points(file, nullptr, {.box = Box3{{1e7, 1e7, 1e7}, {2e7, 2e7, 2e7}}});
      });
    }
  }
}

/// A box does not lift the limit on the sum of all chunks.
TEST(Laz, ChunksAreLimitedTogether) {
  const std::string name = "a.laz", bytes(100000, '\0');
  ReadReport report;
  const io::Input in{name, bytes, report, {}, 0, {.box = Box3{{0, 0, 0}, {1, 1, 1}}}};
  io::LasHeader header;
  header.format = 0, header.record = 20, header.scale = {1, 1, 1};
  const std::vector<Chunk> chunks(6, Chunk{0, 20000, 20000000});
  expect_file_error(name, "60,000,000 points cannot be in 100,000 bytes",
                    [&] { read_chunks(in, header, laz_layout(0, 20), chunks); });
}

/// Files of other programs; the pairs have the same points.
TEST(Laz, FilesOfOthers) {
  struct Pair {
    const char *packed, *plain;
    std::size_t points;
  };
  for (const Pair& pair : {Pair{"survey/autzen_trim.laz", "lidar_autzen_trim.las", 110000},
                           Pair{"survey/extrabytes.laz", "survey/extrabytes.las", 1065},
                           Pair{"survey/point-color-time.laz", "survey/point-color-time.las", 1065}}) {
    if (!std::filesystem::exists(shared_points(pair.packed)))
      GTEST_SKIP() << shared_points(pair.packed) << " is absent";
    SCOPED_TRACE(pair.packed);
    const PointSet packed = read_points(shared_points(pair.packed)), plain = read_points(shared_points(pair.plain));
    EXPECT_EQ(packed.size(), pair.points);
    expect_same_cloud(packed, plain);
  }
  const PointSet whole = read_points(shared_points("survey/lone-star.laz"));
  std::vector<std::string> tiles;
  for (const char k : {'1', '2', '3', '4'})
    tiles.push_back(shared_points(std::string("survey/lone-star-") + k + ".laz"));
  const PointSet joined = read_merged(tiles);
  ASSERT_EQ(whole.size(), joined.size());
  const auto sorted = [](const PointSet& p) {
    std::vector<std::array<double, 3>> all;
    for (const Vec3f& q : p.positions) {
      const Vec3 w = p.origin + Vec3(q);
      all.push_back({std::round(w.x * 4000), std::round(w.y * 4000), std::round(w.z * 4000)});  // steps of the files
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(sorted(whole), sorted(joined));
  expect_unreadable(shared_points("survey/no-points-1.3.laz"), "holds no points");
}

/// laz-perf decompresses files of this library to the same bytes, and others to what this library reads.
TEST(LazOracle, AgreesWithLazPerf) {
  const Folder folder;
  for (const unsigned format : {0u, 1u, 2u, 3u, 6u, 7u, 8u}) {
    SCOPED_TRACE(format);
    const std::size_t extra = format % 3, length = kRecordOfFormat[format] + extra;
    const std::string records = survey_records(format, extra, 2500);
    const std::string file = folder.put("a.laz", las_with_records(4, format, records, length, true));
    bool absent = false;
    const std::string theirs = run_oracle("laz_perf.mjs", "'" + file + "'", absent);
    if (absent) GTEST_SKIP() << "node or its package laz-perf is not installed: scripts/install-deps oracles";
    EXPECT_TRUE(theirs == records);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
