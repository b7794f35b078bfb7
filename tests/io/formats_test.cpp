#include "sansmesh/io/formats.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"

namespace sansmesh::test {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

TEST(Formats, StandInTheOrderOfTheirNumbers) {
  const std::vector<const FormatInfo*> all = formats();
  constexpr auto numbered = static_cast<std::size_t>(FormatId::added);
  ASSERT_GE(all.size(), numbered);
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(all[i]->id), std::min(i, numbered)) << all[i]->name;
}

/// Variants for writing: the reader is that of the format they belong to.
bool is_written_cloud(const FormatInfo& format) { return format.write_points != nullptr; }

TEST(Formats, EveryEndingNamesOneFormatForEachContent) {
  for (const FormatInfo* const f : formats()) {
    std::string endings(f->endings);
    for (std::size_t at = 0; at < endings.size();) {
      const std::size_t end = std::min(endings.find(' ', at), endings.size());
      const std::string file = "a." + endings.substr(at, end - at);
      if ((f->reads & kPoints) != 0) EXPECT_EQ(format_of_name(file, kPoints), f) << file;
      if ((f->reads & kVolume) != 0) EXPECT_EQ(format_of_name(file, kVolume), f) << file;
      if (f->reads == 0 && !is_written_cloud(*f)) EXPECT_EQ(format_of_name(file), f) << file;
      at = end + 1;
    }
    // Unsupported formats come with advice.
    if (f->reads == 0 && !is_written_cloud(*f)) EXPECT_FALSE(f->remedy.empty()) << f->name;
  }
  EXPECT_FALSE(format_of_name("a.nothing"));
  EXPECT_FALSE(format_of_name("a"));
  EXPECT_EQ(format_of_name("A.PLY.gz")->id, FormatId::ply);
  EXPECT_EQ(format_of_name("flow0.f00001")->id, FormatId::nek_field);
}

TEST(Formats, WhatIsListedAsWrittenIsWritten) {
  for (const std::string& ending : endings_written(kMesh)) EXPECT_TRUE(is_written("a" + ending, "mesh")) << ending;
  for (const std::string& ending : endings_written(kPoints)) EXPECT_TRUE(is_written("a" + ending, "points")) << ending;
  for (const std::string& ending : endings_written(kLines)) EXPECT_TRUE(is_written("a" + ending, "lines")) << ending;
  for (const FormatInfo* const f : formats())
    for (const WrittenAs& as : f->written) {
      const std::string file = "a." + std::string(as.ending);
      EXPECT_EQ((as.content & kMesh) != 0, is_written(file, "mesh")) << file;
      EXPECT_EQ((as.content & kPoints) != 0, is_written(file, "points")) << file;
      EXPECT_EQ((as.content & kLines) != 0, is_written(file, "lines")) << file;
    }
  EXPECT_EQ(endings_written(kPicture), std::vector<std::string>{".png"});
  EXPECT_TRUE(contains(endings_read(kTetrahedra), ".veg"));
}

TEST(Formats, ContentTellsBeyondDoubtOrNothing) {
  EXPECT_EQ(format_of_content("ply\nformat ascii 1.0\n")->id, FormatId::ply);
  EXPECT_EQ(format_of_content("LASF\1\2")->id, FormatId::las);
  EXPECT_EQ(format_of_content("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">")->id, FormatId::vtk_xml);
  EXPECT_EQ(format_of_content("NRRD0004\n")->id, FormatId::nrrd);
  EXPECT_EQ(format_of_content("$MeshFormat\n4.1 0 8\n")->id, FormatId::gmsh);
  EXPECT_FALSE(format_of_content("plywood\n"));
  EXPECT_FALSE(format_of_content("1 2 3\n"));
  EXPECT_FALSE(format_of_content(""));
}

TEST(Formats, PointsAreNoVolumeByTheirNames) {
  for (const char* file : {"a.ply", "a.xyz", "a.las", "a.vtp", "a.dat", "a.conf", "a.nothing"})
    EXPECT_FALSE(is_volume_name(file)) << file;
  for (const char* file : {"a.vti", "a.mhd", "a.case", "a.msh", "a.smv", "a.g", "flow.nek5000"})
    EXPECT_TRUE(is_volume_name(file)) << file;
}

}  // namespace
}  // namespace sansmesh::test
