// Folders, patterns and lists of files as one cloud.
#include "sansmesh/io/points/cloud_files.h"

#include "io_test_tools.h"
#include "sansmesh/box.h"
#include "sansmesh/io/points/merge_points.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Four tiles of a cloud in survey coordinates, and the whole cloud.
struct Tiles {
  Folder folder;
  PointSet whole;
  std::vector<std::string> names;

  explicit Tiles(const std::string& ending = ".las") {
    std::filesystem::create_directory(folder / "tiles");
    std::mt19937 random(5);
    std::uniform_int_distribution<int> steps(0, 99999);
    whole.origin = {600000, 4000000, 0};
    for (int i = 0; i < 4000; ++i)
      whole.positions.push_back(
          Vec3f(Vec3{double(steps(random)), double(steps(random)), double(steps(random))} * 0.01));
    for (std::size_t k = 0; k < 4; ++k) {
      PointSet tile;
      tile.origin = whole.origin;
      tile.positions.assign(whole.positions.begin() + static_cast<std::ptrdiff_t>(1000 * k),
                            whole.positions.begin() + static_cast<std::ptrdiff_t>(1000 * (k + 1)));
      // Written in another order than that of the names.
      const std::string name = folder / ("tiles/" + std::string(1, "cadb"[k]) + ending);
      write_points(name, tile);
      names.push_back(name);
    }
    std::sort(names.begin(), names.end());
  }
};

TEST(CloudFiles, FoldersPatternsAndListsAreSorted) {
  const Tiles t;
  t.folder.put("tiles/notes.txt", "flown in May");
  t.folder.put("tiles/.hidden.las", "x");
  std::filesystem::create_directory(t.folder / "tiles/more.las");
  EXPECT_EQ(io::list_cloud_files({t.folder / "tiles"}), t.names);
  EXPECT_EQ(io::list_cloud_files({t.folder / "tiles/*.las"}), t.names);
  EXPECT_EQ(io::list_cloud_files({t.folder / "tiles/[ab].las"}), (std::vector{t.names[0], t.names[1]}));
  const std::string list = t.folder.put("a.lst", "# two tiles\r\ntiles/d.las\r\n\n  tiles/a.las  \n");
  EXPECT_EQ(io::list_cloud_files({list}), (std::vector{t.names[3], t.names[0]}));
  EXPECT_EQ(io::list_cloud_files({t.folder.put("b.txt", "tiles/*.las\n")}), t.names);
  EXPECT_EQ(io::list_cloud_files({t.folder.put("c.list", "tiles\n")}), t.names);
  // A table of points is no list.
  const std::string table = t.folder.put("d.txt", "1 2 3\n4 5 6\n");
  EXPECT_EQ(io::list_cloud_files({table, "absent.las"}), (std::vector<std::string>{table, "absent.las"}));
}

/// Only the names of a list are patterns, not its folder.
TEST(CloudFiles, ListsInFoldersWithBrackets) {
  const Tiles t;
  const std::string run = t.folder / "run[2]*\\";
  std::filesystem::create_directory(t.folder / "run2");
  std::filesystem::copy(t.names[0], t.folder / "run2/a.las");
  std::filesystem::create_directory(run);
  std::filesystem::copy(t.names[1], run + "/b.las");
  const std::string list = t.folder.put("run[2]*\\/tiles.lst", "*.las\n");
  EXPECT_EQ(io::list_cloud_files({list}), std::vector{run + "/b.las"});
  const std::string bad = t.folder.put("run[2]*\\/bad.lst", "c.las\n");
  expect_file_error(bad, "which does not exist", [&] { io::list_cloud_files({bad}); });
}

TEST(CloudFiles, TilesGiveTheCloudOfTheMergedFile) {
  for (const char* ending : {".las", ".ply", ".xyz"}) {
    SCOPED_TRACE(ending);
    const Tiles t(ending);
    PointSet sorted = t.whole;
    sorted.positions.clear();
    for (const std::size_t k : {1, 3, 0, 2})  // a b c d
      sorted.positions.insert(sorted.positions.end(), t.whole.positions.begin() + static_cast<std::ptrdiff_t>(1000 * k),
                              t.whole.positions.begin() + static_cast<std::ptrdiff_t>(1000 * (k + 1)));
    const std::string merged = t.folder / (std::string("merged") + ending);
    write_points(merged, sorted);
    const PointSet one = read_points(merged), many = read_merged({t.folder / "tiles"});
    EXPECT_EQ(one.origin, many.origin);
    EXPECT_EQ(one.positions, many.positions);
  }
}

TEST(CloudFiles, TheFolderOfAListIsNoPattern) {
  const Tiles t;
  for (const std::string folder : {"run[2]", "run*", "run\\?"}) {
    std::filesystem::rename(t.folder / "tiles", t.folder / folder);
    const std::string list = t.folder.put(folder + "/a.lst", "[ab].las\n");
    EXPECT_EQ(io::list_cloud_files({list}),
              (std::vector{t.folder / (folder + "/a.las"), t.folder / (folder + "/b.las")}));
    t.folder.put(folder + "/a.lst", "e.las\n");
    expect_file_error(list, "line 1 names", [&] { io::list_cloud_files({list}); });
    std::filesystem::rename(t.folder / folder, t.folder / "tiles");
  }
}

TEST(CloudFiles, NoPointIsReadTwice) {
  const Tiles t;
  std::filesystem::create_symlink(t.names[0], t.folder / "link.las");
  EXPECT_EQ(io::list_cloud_files({t.folder / "tiles", t.folder / "tiles/../tiles/b.las", t.folder / "link.las"}),
            t.names);
  const std::string list = t.folder.put("a.lst", "tiles/b.las\ntiles/*.las\n");
  EXPECT_EQ(io::list_cloud_files({list}), (std::vector{t.names[1], t.names[0], t.names[2], t.names[3]}));
  // The same points, compressed.
  for (const std::string copy : {"tiles/b.laz", "tiles/b.copc.laz", "tiles/b.las.gz"}) {
    const std::string made = t.folder.put(copy, "x");
    for (const std::string name : {"tiles", "tiles/*.la*"})
      expect_file_error(t.folder / name, "which seem to be the same points",
                        [&] { io::list_cloud_files({t.folder / name}); });
    std::filesystem::remove(made);
  }
}

/// The headers and the box give the origin, so that the files are read once.
TEST(CloudFiles, OriginOfSelectedPointsIsKnownBefore) {
  const Tiles t;
  const Box3 box{{600100, 4000100, 100}, {600500, 4000500, 500}};
  const PointSet some = read_merged({t.folder / "tiles"}, nullptr, {.box = box});
  EXPECT_GT(some.size(), 100u);
  EXPECT_EQ(io::stated_origin(t.names, box), some.origin);
  EXPECT_NE(io::stated_origin(t.names), some.origin);
  EXPECT_EQ(io::stated_origin(t.names, Box3{{0, 0, 0}, {1, 1, 1}}), std::nullopt);
}

TEST(CloudFiles, NamesWithoutFilesAreErrors) {
  const Tiles t;
  const auto expect = [&](const std::string& name, const std::string& part) {
    expect_file_error(name, part, [&] { io::list_cloud_files({name}); });
  };
  expect(t.folder / "tiles/*.laz", "no file matches the pattern");
  expect(t.folder.put("a.lst", "tiles/a.las\ntiles/e.las\n"), "line 2 names");
  expect(t.folder.put("b.lst", "# nothing\n"), "is a list of files without names");
  std::filesystem::create_directory(t.folder / "empty");
  expect(t.folder / "empty", "is a folder without points or meshes");
  t.folder.put("tiles/result.ply", "ply");
  expect(t.folder / "tiles", "files of several formats (4 LAS, 1 PLY); a pattern selects some: ");
  EXPECT_TRUE(io::is_cloud_folder(t.folder / "tiles"));
  EXPECT_FALSE(io::is_cloud_folder(t.folder / "empty"));
}

}  // namespace
}  // namespace sansmesh::inline v1
