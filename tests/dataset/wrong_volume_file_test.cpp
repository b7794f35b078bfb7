// Reading damaged files of fitted volumes, and files with correct checksums and wrong contents, throws exactly one
// FileError.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "io/io_test_tools.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/io/section_file.h"
#include "support/section_bytes.h"
#include "volume/volume_grids.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using Json = nlohmann::json;

std::string fitted_bytes(const GridData& data, const std::string& method) {
  const Folder folder;
  Progress progress;
  VolumeDataset dataset(data);
  VolumeReconstructionOptions options;
  options.method = method;
  write_volume_file(folder / "f.smv", dataset.fit("f", options, true, progress));
  return slurp(folder / "f.smv");
}

class WrongVolumeFile : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    GridData cells = bent_grid({5, 5, 4}, linear_function);
    cells.blocks[0].point_arrays.clear();
    mesh_ = fitted_bytes(cells, "mls-detail");  // cell values: has all sections but one
    lattice_ = fitted_bytes(lattice_grid({4, 5, 3}, linear_function), "mls-detail");
  }

  void expect_bad(const std::string& bytes, const std::string& part, const std::string& what) {
    SCOPED_TRACE(what);
    const std::string file = folder_.put("bad.smv", bytes);
    expect_file_error(file, part, [&] { read_volume_file(file); });
  }
  /// One element of a section changed by `edit(element)`.
  template <class T, class Edit>
  void expect_bad_element(const std::string& good, const std::string& name, std::size_t i, Edit&& edit) {
    std::vector<RawSection> sections = unpacked(good);
    bool found = false;
    for (RawSection& s : sections) {
      if (s.name != name) continue;
      found = true;
      T value = number_at<T>(s.bytes, i * sizeof(T));
      edit(value);
      put_number(s.bytes, i * sizeof(T), value);
    }
    ASSERT_TRUE(found) << name;
    expect_bad(packed(sections, "SMV", 0), "damaged: ", name);
  }
  template <class Edit>
  void expect_bad_meta(Edit&& edit, const std::string& what) {
    std::vector<RawSection> sections = unpacked(mesh_);
    Json json = Json::parse(sections[0].bytes);
    edit(json);
    sections[0].bytes = json.dump();
    expect_bad(packed(sections, "SMV", 0), "damaged: ", "META: " + what);
  }

  static std::string mesh_, lattice_;
  Folder folder_;
};
std::string WrongVolumeFile::mesh_, WrongVolumeFile::lattice_;

TEST_F(WrongVolumeFile, GoodIsRead) {
  EXPECT_EQ(read_volume_file(folder_.put("a.smv", packed(unpacked(mesh_), "SMV", 0))).volume->size(), 4u * 4 * 3);
  EXPECT_EQ(read_volume_file(folder_.put("b.smv", packed(unpacked(lattice_), "SMV", 9))).volume->size(), 4u * 5 * 3);
}

TEST_F(WrongVolumeFile, TruncatedOrGarbledBytes) {
  for (const std::string* const good : {&mesh_, &lattice_}) {
    for (std::size_t n = 1; n < good->size(); n += n < 200 ? 7 : 1 + good->size() / 40)
      expect_bad(good->substr(0, n), n < 8 ? "is not a fitted volume" : "truncated", std::to_string(n) + " bytes");
    expect_bad(*good + std::string(64, '\0'), "damaged", "longer");
    // Checksums cover the sections; the bytes in between are unused.
    const std::vector<RawSection> sections = unpacked(*good);
    std::size_t table = kHeaderBytes;
    for (const RawSection& s : sections) {
      const auto at = number_at<std::uint64_t>(*good, table + kEntryOffsetAt);
      table += kEntryBytes;
      if (s.bytes.empty()) continue;
      std::string garbled = *good;
      garbled[at + s.bytes.size() / 2] = static_cast<char>(garbled[at + s.bytes.size() / 2] ^ 0x10);
      expect_bad(garbled, "damaged: the checksum of section " + s.name, s.name);
    }
    for (std::size_t at = 0; at < table; at += 5) {
      if (at >= 28 && at < 56) continue;
      std::string garbled = *good;
      garbled[at] = static_cast<char>(garbled[at] ^ 0x04);
      expect_bad(garbled, "", "byte " + std::to_string(at));
    }
  }
}

TEST_F(WrongVolumeFile, OtherKindsOfFiles) {
  expect_bad("solid thing\n", "is not a fitted volume (.smv)", "text");
  expect_bad(packed(unpacked(mesh_)), "is not a fitted volume (.smv)", "function");
  std::string newer = mesh_;
  put_number<std::uint32_t>(newer, kMajorAt, 2);
  mend_checksums(newer);
  expect_bad(newer, "newer version", "version 2");
  const std::string file = folder_.put("f.smv", mesh_), missing = folder_ / "missing.smv";
  expect_file_error(missing, "", [&] { read_volume_file(missing); });
  expect_file_error(file, "read on its own", [&] { read_volume(file); });
  EXPECT_TRUE(is_volume_name(file));
}

TEST_F(WrongVolumeFile, MissingOrResizedSections) {
  for (const std::string* const good : {&mesh_, &lattice_}) {
    const std::vector<RawSection> sections = unpacked(*good);
    for (std::size_t k = 0; k < sections.size(); ++k) {
      const std::string& name = sections[k].name;
      std::vector<RawSection> fewer = sections;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
      expect_bad(packed(fewer, "SMV", 0), "", "without " + name);
      std::vector<RawSection> shorter = sections;
      std::string& bytes = shorter[k].bytes;
      bytes.resize(bytes.size() - shorter[k].element_size);
      expect_bad(packed(shorter, "SMV", 0), "damaged", "shorter " + name);
      std::vector<RawSection> other = sections;
      other[k].element_size = 1 + other[k].element_size % 2;
      other[k].bytes.resize(other[k].bytes.size() / 2 * 2);
      if (name != "META") expect_bad(packed(other, "SMV", 0), "", "other elements of " + name);
    }
  }
}

TEST_F(WrongVolumeFile, Samples) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -1e200}) {
    expect_bad_element<double>(mesh_, "POSITION", 4, [&](double& x) { x = bad; });
    expect_bad_element<double>(mesh_, "CORNER", 10, [&](double& x) { x = bad; });
    for (const std::size_t k : {0, 9, 12, 15})
      expect_bad_element<double>(lattice_, "LATTICE", k, [&](double& x) { x = bad; });
    expect_bad_element<double>(lattice_, "AXIS1", 2, [&](double& x) { x = bad; });
  }
  expect_bad_element<double>(lattice_, "AXIS0", 1, [](double& x) { x = 0; });
  expect_bad_element<double>(lattice_, "LATTICE", 12, [](double& x) { x = 0.5; });
  expect_bad_element<double>(lattice_, "LATTICE", 15, [](double& x) { x = 0.5; });
  expect_bad_element<std::uint8_t>(mesh_, "SHAPE", 3, [](std::uint8_t& s) { s = 4; });
  expect_bad_element<std::uint8_t>(mesh_, "SHAPE", 3, [](std::uint8_t& s) { s = 1; });
  for (const std::uint32_t bad : {100000u, ~0u}) {
    expect_bad_element<std::uint32_t>(mesh_, "CELL", 5, [&](std::uint32_t& c) { c = bad; });
    expect_bad_element<std::uint32_t>(mesh_, "CELLSAMP", 5, [&](std::uint32_t& c) { c = bad; });
    expect_bad_element<std::uint32_t>(mesh_, "STAR", 5, [&](std::uint32_t& c) { c = bad; });
  }
  expect_bad_element<std::uint32_t>(mesh_, "STAR", 1, [](std::uint32_t& c) { c = 0; });
  for (const std::size_t k : {0, 1, 10})
    expect_bad_element<std::uint64_t>(mesh_, "STARBEG", k, [](std::uint64_t& at) { at = ~std::uint64_t{0}; });
  expect_bad_element<std::uint64_t>(mesh_, "STARBEG", 2, [](std::uint64_t& at) { at = 0; });
}

TEST_F(WrongVolumeFile, Coefficients) {
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf}) {
    expect_bad_element<float>(mesh_, "METRIC", 12, [&](float& x) { x = bad; });
    expect_bad_element<float>(mesh_, "RADIUS", 3, [&](float& x) { x = bad; });
    expect_bad_element<float>(mesh_, "TRUST", 3, [&](float& x) { x = bad; });
    for (const std::string* const good : {&mesh_, &lattice_}) {
      expect_bad_element<float>(*good, "COEFF", 20, [&](float& x) { x = bad; });
      expect_bad_element<double>(*good, "CONSTANT", 2, [&](double& x) { x = static_cast<double>(bad); });
    }
  }
  expect_bad_element<float>(mesh_, "RADIUS", 3, [](float& x) { x = 0; });
  expect_bad_element<float>(mesh_, "TRUST", 3, [](float& x) { x = 1.5f; });
  for (const std::uint8_t bad : {5, 255})
    expect_bad_element<std::uint8_t>(mesh_, "DEGREE", 3, [&](std::uint8_t& d) { d = bad; });
  expect_bad_element<std::uint8_t>(mesh_, "DEGREE", 3, [](std::uint8_t& d) { d = d == 1 ? 2 : 1; });
  for (const std::size_t k : {0, 1, 48})
    expect_bad_element<std::uint64_t>(mesh_, "COEFFBEG", k, [](std::uint64_t& at) { at += 3; });
}

TEST_F(WrongVolumeFile, RandomBytesWithCorrectChecksums) {
  std::mt19937 random(11);
  std::size_t read = 0;
  for (int k = 0; k < 200; ++k) {
    std::vector<RawSection> sections = unpacked(k % 2 == 0 ? mesh_ : lattice_);
    RawSection& s = sections[random() % sections.size()];
    for (int flips = 0; flips < 3; ++flips) s.bytes[random() % s.bytes.size()] ^= static_cast<char>(1 << random() % 8);
    const std::string file = folder_.put("bad.smv", packed(sections, "SMV", 0));
    try {
      // Volumes that were read can be evaluated, with any result.
      VolumeDataset dataset(read_volume_file(file));
      Progress progress;
      const auto field = dataset.field({dataset.fitted()->array, {}, false}, dataset.fitted()->options, progress);
      const std::vector<Vec3> x{field->bounds().center(), field->bounds().lower, {0.3, 0.4, 0.6}, {1e9, 0, 0}};
      std::vector<double> values(x.size());
      std::vector<std::uint8_t> inside(x.size(), 7);
      field->evaluate(x, {values, {}, inside});
      for (const std::uint8_t in : inside) EXPECT_LE(in, 1) << s.name;
      ++read;
    } catch (const FileError& error) {
      EXPECT_TRUE(is_clean(error.what())) << error.what();
    }
  }
  EXPECT_GT(read, 10u);
  EXPECT_LT(read, 190u);
}

TEST_F(WrongVolumeFile, Descriptions) {
  const Json good = Json::parse(unpacked(mesh_)[0].bytes), flat = good.flatten();
  const Json all_wrong[] = {nullptr, true, -1, "text", Json::array(), Json::object()};
  for (const auto& [path, value] : flat.items()) {
    for (const Json& wrong : all_wrong) {
      // Names and notes may be any text, and other values may be valid by chance: then reading must give a valid
      // volume.
      std::vector<RawSection> sections = unpacked(mesh_);
      Json json = good;
      json[Json::json_pointer(path)] = wrong;
      sections[0].bytes = json.dump();
      const std::string file = folder_.put("bad.smv", packed(sections, "SMV", 0));
      try {
        EXPECT_EQ(read_volume_file(file).volume->size(), 4u * 4 * 3) << path;
      } catch (const FileError& error) {
        EXPECT_TRUE(is_clean(error.what())) << error.what();
      } catch (const std::exception& error) {
        ADD_FAILURE() << path << " = " << wrong << ": " << error.what();
      }
    }
  }
  for (const auto& [key, value] : good.items())
    if (key != "uniform") expect_bad_meta([k = key](Json& j) { j.erase(k); }, "without " + key);
  expect_bad_meta([](Json& j) { j["reconstruction"]["array"] = "g"; }, "array");
  expect_bad_meta([](Json& j) { j["reconstruction"]["chosen"]["method"] = "linear"; }, "method");
  expect_bad_meta([](Json& j) { j["reconstruction"]["options"]["method"] = "magic"; }, "method");
  expect_bad_meta([](Json& j) { j["reconstruction"]["chosen"]["degree"] = 9; }, "degree");
  expect_bad_meta([](Json& j) { j["arrays"][0]["components"] = 3; }, "components");
  expect_bad_meta([](Json& j) { j["arrays"][0]["components"] = ~std::uint64_t{0}; }, "components");
  expect_bad_meta([](Json& j) { j["arrays"][0]["type"] = "half"; }, "type");
  expect_bad_meta([](Json& j) { j["arrays"] = Json::array(); }, "arrays");
  for (const std::string& text : {std::string(), std::string("{"), std::string(1 << 20, '['), std::string(64, '\0')}) {
    std::vector<RawSection> sections = unpacked(mesh_);
    sections[0].bytes = text;
    expect_bad(packed(sections, "SMV", 0), "damaged", "text");
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
