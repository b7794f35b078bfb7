// DICOM slices read by the VTK module.
#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "support/places.h"
#include "vtk_test_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Geometry of slices of 4 x 3 numbers: a frame, and steps between columns, rows and slices.
struct SlicePlan {
  Vec3 origin{-20, 35, 100}, along_row{1, 0, 0}, along_column{0, 1, 0}, from_slice_to_slice{0, 0, 2};
  double column_step = 0.5, row_step = 0.75;
  bool placed = true;
  int columns = 4;
  std::string syntax = "1.2.840.10008.1.2.1";  ///< explicit little endian
  std::size_t missing = 0, behind = 0;         ///< missing bytes of the pixels, and of a tag behind them

  Vec3 place(int i, int j, double k) const {
    return origin + along_row * (column_step * i) + along_column * (row_step * j) + from_slice_to_slice * k;
  }
};
int slice_number(int i, int j, int k) { return 100 * k + 10 * j + i; }

/// A slice in explicit little endian; `at` is its index with equal steps, `name` the number in the file.
std::string dicom_slice(const SlicePlan& plan, int k, double at, int name) {
  const auto element = [](unsigned group, unsigned tag, const std::string& kind, std::string value) {
    if (value.size() % 2 == 1) value += kind == "UI" ? '\0' : ' ';
    std::string s = raw(static_cast<std::uint16_t>(group)) + raw(static_cast<std::uint16_t>(tag)) + kind;
    if (kind == "OW") return s + std::string(2, '\0') + raw(static_cast<std::uint32_t>(value.size())) + value;
    return s + raw(static_cast<std::uint16_t>(value.size())) + value;
  };
  const auto whole = [](int v) { return raw(static_cast<std::uint16_t>(v)); };
  const auto numbers = [](const std::vector<double>& values) {
    std::string text;
    for (const double v : values) {
      char word[32];
      std::snprintf(word, sizeof word, "%.8g", v);
      text += (text.empty() ? "" : "\\") + std::string(word);
    }
    return text;
  };
  std::string pixels;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < plan.columns; ++i) pixels += whole(slice_number(i, j, k));
  pixels.resize(pixels.size() - plan.missing);
  const Vec3 p = plan.place(0, 0, at), &r = plan.along_row, &c = plan.along_column;
  const std::string syntax = element(2, 0x10, "UI", plan.syntax);
  const std::string lies = element(0x20, 0x32, "DS", numbers({p.x, p.y, p.z})) +
                           element(0x20, 0x37, "DS", numbers({r.x, r.y, r.z, c.x, c.y, c.z}));
  return std::string(128, '\0') + "DICM" + element(2, 0, "UL", raw(static_cast<std::uint32_t>(syntax.size()))) +
         syntax + element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(8, 0x60, "CS", "CT") +
         element(0x18, 0x50, "DS", "2") + element(0x20, 0xe, "UI", "1.2.3") +
         element(0x20, 0x13, "IS", std::to_string(name)) + (plan.placed ? lies : "") +
         element(0x28, 2, "US", whole(1)) + element(0x28, 4, "CS", "MONOCHROME2") +
         element(0x28, 0x10, "US", whole(3)) + element(0x28, 0x11, "US", whole(plan.columns)) +
         element(0x28, 0x30, "DS", numbers({plan.row_step, plan.column_step})) + element(0x28, 0x100, "US", whole(16)) +
         element(0x28, 0x101, "US", whole(16)) + element(0x28, 0x102, "US", whole(15)) +
         element(0x28, 0x103, "US", whole(0)) + element(0x7fe0, 0x10, "OW", pixels) +
         (plan.behind > 0 ? element(0xfffc, 0xfffc, "OW", std::string(plan.behind, '\0')) : "");
}

/// A tag of group 28, instead of the slice's own value.
std::string with_word(std::string slice, unsigned tag, unsigned value) {
  const std::string name = raw(std::uint16_t{0x28}) + raw(static_cast<std::uint16_t>(tag)) + "US";
  return slice.replace(slice.find(name) + 8, 2, raw(static_cast<std::uint16_t>(value)));
}

/// Oblique: a frame rotated about all axes.
SlicePlan oblique_plan() {
  SlicePlan plan;
  plan.along_row = normalized(Vec3{0.8, 0.5, -0.2});
  plan.along_column = normalized(cross(Vec3{0.3, -0.2, 0.9}, plan.along_row));
  plan.from_slice_to_slice = cross(plan.along_row, plan.along_column) * 1.25;
  return plan;
}

void put_slices(const Folder& folder, const SlicePlan& plan, const std::vector<double>& at) {
  std::filesystem::create_directories(folder / "ct");
  const int n = static_cast<int>(at.size());
  for (int k = 0; k < n; ++k)  // not in the order of names or numbers
    folder.put("ct/slice" + std::to_string((k * 2 + 1) % n) + ".dcm",
               dicom_slice(plan, k, at[static_cast<std::size_t>(k)], (k * 2 + 2) % n));
}

void expect_slices(const GridData& data, const SlicePlan& plan, const std::vector<double>& at) {
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  ASSERT_EQ(point_count(b), 12 * at.size());
  for (std::size_t n = 0; n < point_count(b); ++n) {
    const int i = static_cast<int>(n % 4), j = static_cast<int>(n / 4 % 3), k = static_cast<int>(n / 12);
    EXPECT_NEAR(norm(place(b, n) - plan.place(i, j, at[static_cast<std::size_t>(k)])), 0, 1e-4) << n;
    EXPECT_EQ(number(b.point_arrays, "DICOMImage", n), slice_number(i, j, k)) << n;
  }
}

TEST(VtkVolumes, DicomSlicesLieWhereTheySay) {
  for (const SlicePlan& plan : {SlicePlan{}, oblique_plan()}) {
    const Folder folder;
    const std::vector<double> at{0, 1, 2, 3, 4};
    put_slices(folder, plan, at);
    const GridData data = read_volume(folder / "ct");
    expect_slices(data, plan, at);
    EXPECT_EQ(data.blocks[0].kind, GridKind::lattice);
    EXPECT_TRUE(data.notes.empty());
    for (std::size_t k = 1; k < 5; ++k)
      EXPECT_NEAR(data.blocks[0].axes[2][k], static_cast<double>(k) * norm(plan.from_slice_to_slice), 1e-4);
    // One of them as a single file.
    const GridData one = read_volume(folder / "ct/slice1.dcm");
    expect_slices(one, plan, {0});
  }
}

TEST(VtkVolumes, DicomSlicesMayBeUnevenOrShifted) {
  const Folder folder;
  const std::vector<double> uneven{0, 1, 3, 3.5, 6};
  put_slices(folder, oblique_plan(), uneven);
  const GridData data = read_volume(folder / "ct");
  expect_slices(data, oblique_plan(), uneven);
  EXPECT_EQ(data.blocks[0].kind, GridKind::lattice);
  EXPECT_EQ(data.notes.size(), 1u);
  SlicePlan tilted = oblique_plan();
  tilted.from_slice_to_slice += tilted.along_column * 0.4;
  const Folder other;
  const std::vector<double> at{0, 1, 2, 3, 4};
  put_slices(other, tilted, at);
  const GridData shifted = read_volume(other / "ct");
  expect_slices(shifted, tilted, at);
  EXPECT_EQ(shifted.blocks[0].kind, GridKind::curvilinear);
}

TEST(VtkVolumes, DicomFoldersOfUnlikeOrDamagedSlicesAreRefused) {
  const Folder folder;
  put_slices(folder, {}, {0, 1, 2});
  const std::string twice = folder.put("ct/more.dcm", dicom_slice({}, 7, 1, 7));
  expect_no_volume(folder / "ct", "several slices at one position");
  folder.put("ct/more.dcm", dicom_slice(oblique_plan(), 7, 9, 7));
  expect_no_volume(folder / "ct", "different sizes or directions");
  SlicePlan wide;
  wide.columns = 6;
  folder.put("ct/more.dcm", dicom_slice(wide, 7, 9, 7));
  expect_no_volume(folder / "ct", "different sizes or directions");
  SlicePlan packed;
  packed.syntax = "1.2.840.10008.1.2.4.50";
  folder.put("ct/more.dcm", dicom_slice(packed, 7, 9, 7));
  expect_no_volume(folder / "ct", "compressed");
  std::filesystem::remove(twice);
  VolumeReadOptions second;
  second.time_step = 1;
  EXPECT_THROW(read_volume(folder / "ct", second), ArgumentError);
}

TEST(VtkVolumes, DicomSlicesThatVtkWouldReadBeyondAreRefused) {
  const Folder folder;
  std::filesystem::create_directories(folder / "ct");
  const auto refused = [&](const std::string& slice, const std::string& part) {
    folder.put("ct/one.dcm", slice);
    expect_no_volume(folder / "ct", part);
    expect_no_volume(folder / "ct", "one.dcm");
  };
  SlicePlan large, short_tag, trailing;
  large.columns = 400;
  refused(dicom_slice(large, 7, 9, 7).substr(0, 1500), "truncated slice");
  const std::string whole = dicom_slice({}, 7, 9, 7);
  refused(whole.substr(0, whole.size() - 10), "truncated slice");
  refused(whole.substr(0, whole.size() - 24), "truncated slice");
  refused(whole.substr(0, whole.size() - 36), "truncated slice");
  // The file is long enough, but its pixels are too few.
  short_tag.missing = 10, short_tag.behind = 400;
  refused(dicom_slice(short_tag, 7, 9, 7), "truncated slice");
  refused(with_word(with_word(whole, 0x10, 65535), 0x11, 65535), "truncated slice");
  refused(with_word(whole, 0x11, 0), "without pixels");
  refused(with_word(whole, 0x100, 32), "32 bits");
  refused(with_word(whole, 0x100, 12), "12 bits");
  refused(whole + whole.substr(whole.size() - 36), "several images");
  // Data after the pixels are harmless.
  trailing.behind = 400;
  const std::string fine = dicom_slice(trailing, 0, 0, 7);
  folder.put("ct/one.dcm", fine);
  expect_slices(read_volume(folder / "ct"), {}, {0});
  folder.put("ct/one.dcm", fine.substr(0, fine.size() - 100));
  expect_slices(read_volume(folder / "ct"), {}, {0});
}

TEST(VtkVolumes, DicomSlicesAtNoFiniteNumbersAreRefused) {
  const Folder folder;
  const auto refused = [&](const SlicePlan& plan) {
    put_slices(folder, {}, {0, 1, 2});
    folder.put("ct/odd.dcm", dicom_slice(plan, 7, 9, 7));
    expect_no_volume(folder / "ct", "not finite");
    expect_no_volume(folder / "ct", "odd.dcm");
  };
  SlicePlan place, step, direction;
  place.origin.y = std::numeric_limits<double>::quiet_NaN();
  step.row_step = std::numeric_limits<double>::infinity();
  direction.along_row.x = std::numeric_limits<double>::quiet_NaN();
  refused(place);
  refused(step);
  refused(direction);
}

TEST(VtkVolumes, DicomSlicesWithoutPlacesAreStacked) {
  SlicePlan plan;
  plan.placed = false;
  const Folder folder;
  put_slices(folder, plan, {0, 1, 2});
  const GridData data = read_volume(folder / "ct");
  ASSERT_EQ(data.blocks.size(), 1u);
  EXPECT_EQ(point_count(data.blocks[0]), 36u);
  EXPECT_EQ(data.notes.size(), 1u);
  std::set<double> all;
  for (std::size_t i = 0; i < 36; ++i) all.insert(data.blocks[0].point_arrays[0].number(i));
  EXPECT_EQ(all.size(), 36u);
}

}  // namespace
}  // namespace sansmesh::inline v1
