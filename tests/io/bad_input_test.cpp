// Damaged input: each damage causes one FileError that names the file, without crash, hang, memory beyond the file's
// size or leftover files.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "sample_files.h"
#include "sansmesh/image.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Reads; true on success. Anything but a FileError fails the test.
bool readable(const std::string& file) {
  try {
    const PointSet p = read_points(file);
    EXPECT_GT(p.size(), 0u);
    for (const auto& t : p.triangles) {
      for (const std::uint32_t v : t) EXPECT_LT(v, p.size());
    }
    EXPECT_TRUE(p.normals.empty() || p.normals.size() == p.size());
    EXPECT_TRUE(p.colors.empty() || p.colors.size() == p.size());
    EXPECT_NO_THROW(p.attributes.check_rows(p.size(), "points"));
    EXPECT_NO_THROW(p.triangle_attributes.check_rows(p.triangles.size(), "triangles"));
    EXPECT_TRUE(p.scan_of_point.empty() || p.scan_of_point.size() == p.size());
    return true;
  } catch (const FileError& e) {
    EXPECT_EQ(std::string(e.what()).rfind(file + ": ", 0), 0u) << e.what();
    EXPECT_TRUE(is_clean(e.what())) << e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << file << ": another exception: " << e.what();
  }
  return false;
}

/// Runs `action` in a child process; failures there are failures here.
template <class Action>
void in_child(Action&& action) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    action();
    std::fflush(nullptr);
    ::_exit(::testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

long peak_megabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

class EveryFormat : public ::testing::TestWithParam<SampleFile> {
 protected:
  void SetUp() override {
    for (const SampleFile& s : sample_files()) folder_.put(s.name, s.content);  // an alignment needs its scans
  }
  Folder folder_;
};
std::string sample_name(const ::testing::TestParamInfo<SampleFile>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Bad, EveryFormat, ::testing::ValuesIn(sample_files()), sample_name);

TEST_P(EveryFormat, GoodIsReadWithoutWarning) {
  ReadReport report;
  EXPECT_GT(read_points(folder_ / GetParam().name, &report).size(), 2u);
  EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
  EXPECT_FALSE(report.format.empty());
}

TEST_P(EveryFormat, MissingEmptyOrAFolder) {
  const std::string name = GetParam().name;
  expect_unreadable(folder_ / ("no" + name), "no such file");
  expect_unreadable(folder_ / ("nowhere/" + name), "no such file");
  expect_unreadable(folder_.put("empty." + name, ""), "is empty");
  std::filesystem::create_directory(folder_ / ("folder." + name));
  expect_unreadable(folder_ / ("folder." + name), "is a directory");
}

TEST_P(EveryFormat, CutAnywhere) {
  const std::string name = "cut." + GetParam().name;
  const std::string& content = GetParam().content;
  const std::size_t step = 1 + content.size() / 150;
  for (std::size_t size = 1; size < content.size(); size += size < 150 ? 1 : step) {
    const bool good = readable(folder_.put(name, content.substr(0, size)));
    if (GetParam().binary) {
      EXPECT_FALSE(good) << "cut at " << size << " of " << content.size();
    }
  }
}

TEST_P(EveryFormat, Garbage) {
  std::mt19937 random(11);
  std::string noise(3000, '\0'), text(3000, ' ');
  for (char& c : noise) c = static_cast<char>(random());
  for (char& c : text) c = "abcdefg h,.;\n"[random() % 13];
  const std::string name = GetParam().name;
  EXPECT_FALSE(readable(folder_.put("noise." + name, noise)));
  EXPECT_FALSE(readable(folder_.put("text." + name, text)));
  EXPECT_FALSE(readable(folder_.put("zeros." + name, std::string(3000, '\0'))));
  EXPECT_FALSE(readable(folder_.put("line." + name, std::string(3000, 'x'))));
}

TEST_P(EveryFormat, DamagedBytes) {
  const std::string name = "damaged." + GetParam().name;
  const std::string& content = GetParam().content;
  std::mt19937 random(5);
  const auto any = [&](std::size_t n) { return std::size_t{random()} % n; };
  const long before = peak_megabytes();
  for (int trial = 0; trial < 200; ++trial) {
    std::string s = content;
    for (std::size_t k = 1 + any(3); k > 0; --k) {
      // Half of the damage is within the header, which is most sensitive.
      const std::size_t at = any(trial % 2 ? s.size() : std::min<std::size_t>(s.size(), 400));
      switch (any(6)) {
        case 0:
          s[at] = static_cast<char>(random());
          break;
        case 1:
          s[at] = "0123456789"[any(10)];
          break;
        case 2:
          s.erase(at, 1 + any(8));
          break;
        case 3:
          s.insert(at, std::string(1 + any(12), "9-\xff\0 "[any(5)]));
          break;
        case 4:
          s.insert(at, s.substr(any(s.size()), any(40)));
          break;
        default:
          s.replace(at, std::min<std::size_t>(4, s.size() - at), "\xff\xff\xff\x7f");
      }
      if (s.empty()) s.assign(1, 'x');
    }
    readable(folder_.put(name, s));
  }
  EXPECT_LT(peak_megabytes() - before, 300);
}

TEST_P(EveryFormat, AnotherFormatsContent) {
  for (const SampleFile& other : sample_files()) readable(folder_.put("other." + GetParam().name, other.content));
}

// Control characters for terminals, and invalid UTF-8.
TEST(Excerpts, OfDamagedFilesArePrintable) {
  const std::string bad = "\x1b[31m\a\x7f\xc2\x9b\xff", shown = "\\x1b[31m\\x07\\x7f\\xc2\\x9b\\xff";
  const std::string ply = "ply\nformat ascii 1.0\n", xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n";
  const Folder folder;
  expect_unreadable(folder.put("keyword.ply", ply + bad + " 1\nend_header\n"), shown);
  expect_unreadable(folder.put("type.ply", ply + "element vertex 1\nproperty " + bad + " x\nend_header\n"), shown);
  expect_unreadable(folder.put("format.ply", "ply\nformat " + bad + " 1.0\n"), shown);
  expect_unreadable(folder.put("number.ply", ply + "element vertex 1\n" + xyz + "end_header\n1 2 " + bad + "\n"),
                    shown);
  const auto other = [&](const std::string& name) {  // an element without numbers
    return ply + "element " + name + " 1\n" + xyz + "element vertex 1\n" + xyz + "end_header\n1 2 z\n1 2 3\n";
  };
  expect_unreadable(folder.put("name.ply", other(bad)), shown);
  expect_unreadable(folder.put("data.pcd", pcd + "DATA " + bad + "\n"), shown);
  expect_unreadable(folder.put("number.pcd", pcd + "DATA ascii\n1 2 " + bad + "\n"), shown);
  expect_unreadable(folder.put("type.vtp", "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + bad + "\">\n"), shown);
  expect_unreadable(folder.put("scan.conf", "bmesh " + bad + ".ply 0 0 0 0 0 0 1\n"), shown);
  const std::string message = expect_unreadable(folder.put("long.ply", other(std::string(4000, 'q'))), "qq…qq");
  EXPECT_LT(message.size(), 2000u + folder.path().string().size());
}

// ------------------------------------------------------------------------------------------------- absurd sizes

TEST(AbsurdSizes, CostNoMemory) {
  const Folder folder;
  const long before = peak_megabytes();
  for (const char* count : {"1000000000", "4294967295", "4294967296", "1000000000000", "9223372036854775807",
                            "18446744073709551615", "99999999999999999999999"}) {
    for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      const std::string head = std::string("ply\nformat ") + encoding + " 1.0\nelement vertex ";
      const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
      EXPECT_FALSE(readable(folder.put("a.ply", head + count + "\n" + xyz + "end_header\n0 0 0\n1 1 1\n")));
      EXPECT_FALSE(readable(folder.put("b.ply", head + count + "\nend_header\n0 0 0\n")));
      EXPECT_FALSE(
          readable(folder.put("c.ply", head + "1\n" + xyz + "element face " + count +
                                           "\nproperty list uchar int vertex_indices\nend_header\n0 0 0 123456")));
      EXPECT_FALSE(
          readable(folder.put("d.ply", head + count + "\nproperty list uchar int a\n" + xyz + "end_header\n0 0 0")));
    }
    EXPECT_FALSE(readable(folder.put("a.off", std::string("OFF\n") + count + " 1 0\n0 0 0\n")));
    EXPECT_FALSE(readable(folder.put("b.off", std::string("OFF\n1 ") + count + " 0\n0 0 0\n")));
    EXPECT_FALSE(readable(folder.put("c.off", std::string("OFF\n1 1 0\n0 0 0\n") + count + " 0 0 0\n")));
    EXPECT_FALSE(readable(folder.put("a.pwn", std::string(count) + "\n0 0 0\n1 1 1\n")));
    for (const char* kind : {"ascii", "binary", "binary_compressed"}) {
      EXPECT_FALSE(readable(folder.put("a.pcd", make_pcd(kind, 10, count))));
    }
  }
  for (const std::uint64_t count : {std::uint64_t{1} << 31, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    EXPECT_FALSE(readable(folder.put("a.las", make_las(4, 6, count))));
  }
  EXPECT_LT(peak_megabytes() - before, 100);
}

TEST(AbsurdSizes, GzipBombIsRefused) {
  const Folder folder;
  // 300 MB of zeros from 300 kB, behind a header that accepts them.
  std::string bomb;
  {
    const std::string block(10 << 20, '\0');
    const std::string packed = gzip(block);
    bomb = gzip(
        "ply\nformat binary_little_endian 1.0\nelement vertex 20000000\nproperty double x\nproperty double y\n"
        "property double z\nend_header\n");
    for (int k = 0; k < 30; ++k) bomb += packed;
  }
  expect_unreadable(folder.put("a.ply.gz", bomb), "refused");
}

// ------------------------------------------------------------------------------------------------------ reading

TEST(Reading, UnknownEndingsNameTheKnownOnes) {
  const Folder folder;
  const std::string rows = "1 2 3\n4 5 6\n";
  for (const char* name : {"a.docx", "a.", "a", "a.xyz2", "a.gz"})
    expect_unreadable(folder.put(name, rows), "ply obj off");
  expect_unreadable(folder.put("a.laz", rows), "is not a LAS file");
  expect_unreadable(folder.put("a.e57", rows), "E57");
  expect_unreadable(folder.put("a.fbx", rows), "convert it");
  expect_unreadable(folder.put("a.glb", rows), "no JSON");
  expect_file_error("(no name)", "the name of the file is empty", [] { read_points(""); });
}

TEST(Reading, ContentDecidesWhereTheEndingIsWrong) {
  const Folder folder;
  for (const char* name : {"a.obj", "a.dat", "a", "a.unknown"}) {
    ReadReport report;
    EXPECT_EQ(read_points(folder.put(name, tetrahedron_ply(Ply::big)), &report).size(), 4u);
    EXPECT_EQ(report.format, "PLY binary big endian");
    EXPECT_EQ(report.warnings.size(), std::string(name) == "a.obj" || std::string(name) == "a.dat" ? 1u : 0u);
  }
}

TEST(Reading, MeshesNeedFaces) {
  const Folder folder;
  const std::string file = folder.put("a.xyz", "1 2 3\n4 5 6\n");
  expect_file_error(file, "no faces", [&] { read_mesh(file); });
}

TEST(Reading, DevicesAreRefused) { expect_unreadable("/dev/zero", "device"); }

// ------------------------------------------------------------------------------------------------------ writing

const char* const mesh_names[] = {"m.ply", "m.obj", "m.stl", "m.off", "m.glb", "m.ply.gz"};
const char* const point_names[] = {"p.ply", "p.obj", "p.xyz", "p.csv", "p.pcd", "p.xyz.gz"};

/// Every writer on `folder`/its name must fail with `part` in the message.
void expect_unwritable(const std::string& folder, const std::string& part) {
  for (const char* name : mesh_names) {
    const std::string file = folder + "/" + name;
    expect_file_error(file, part, [&] { write_mesh(file, made_mesh()); });
    expect_file_error(file, "cannot be written", [&] { check_writable(file, "mesh"); });
  }
  for (const char* name : point_names) {
    const std::string file = folder + "/" + name;
    expect_file_error(file, part, [&] { write_points(file, made_points()); });
    expect_file_error(file, "cannot be written", [&] { check_writable(file, "points"); });
  }
  const std::string image = folder + "/i.png", text = folder + "/t.json";
  expect_file_error(image, part, [&] { write_image(image, Image(2, 2)); });
  expect_file_error(text, part, [&] { write_text(text, "{}"); });
  expect_file_error(image, "cannot be written", [&] { check_writable(image, "image"); });
  expect_file_error(text, "cannot be written", [&] { check_writable(text, "text"); });
}

TEST(Writing, MissingFolder) {
  const Folder folder;
  expect_unwritable(folder / "nowhere", "its folder does not exist");
  folder.put("file", "not a folder");
  expect_unwritable(folder / "file", "folder");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Writing, ForbiddenFolder) {
  const Folder folder;
  std::filesystem::create_directory(folder / "closed");
  folder.put("closed/m.ply", "old");
  ::chmod((folder / "closed/m.ply").c_str(), 0444);
  ::chmod((folder / "closed").c_str(), 0555);
  ::chmod(folder.path().c_str(), 0755);
  // Root may write anywhere, so an unprivileged child process tries.
  in_child([&] {
    if (::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) {
      ADD_FAILURE() << "cannot give up privileges";
      return;
    }
    expect_unwritable(folder / "closed", "permission denied");
  });
  ::chmod((folder / "closed").c_str(), 0755);
  EXPECT_EQ(slurp(folder / "closed/m.ply"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "closed"), {}), 1);
}

TEST(Writing, FullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const Folder folder;
  for (const char* name : mesh_names) {
    std::filesystem::create_symlink("/dev/full", folder / name);
    expect_file_error(folder / name, "the disk is full", [&] { write_mesh(folder / name, made_mesh()); });
    EXPECT_TRUE(std::filesystem::is_symlink(folder / name));
  }
}

TEST(Writing, FileSizeLimitLeavesNothingBehind) {
  const Folder folder;
  const std::string old = folder.put("m.ply", "old");
  in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    limit.rlim_cur = limit.rlim_max = 1000;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    for (const char* name : mesh_names) {
      expect_file_error(folder / name, "cannot be written", [&] { write_mesh(folder / name, made_mesh()); });
    }
    for (const char* name : point_names) {
      expect_file_error(folder / name, "cannot be written", [&] { write_points(folder / name, made_points()); });
    }
  });
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_EQ(slurp(old), "old");
}

TEST(Writing, AFolderHasTheName) {
  const Folder folder;
  for (const char* name : mesh_names) {
    std::filesystem::create_directory(folder / name);
    expect_file_error(folder / name, "it is a directory", [&] { write_mesh(folder / name, made_mesh()); });
    expect_file_error(folder / name, "it is a directory", [&] { check_writable(folder / name, "mesh"); });
  }
}

TEST(Writing, UnknownEndingsNameTheKnownOnes) {
  const Folder folder;
  for (const char* name : {"m.xyz", "m.las", "m", "m.", "m.ply.bak", ".ply/"}) {
    expect_file_error(folder / name, "", [&] { write_mesh(folder / name, made_mesh()); });
  }
  expect_file_error(folder / "m.xyz", ".ply .obj .off .stl .glb", [&] { check_writable(folder / "m.xyz", "mesh"); });
  expect_file_error(folder / "p.stl", ".ply .obj .vtp .pcd .las", [&] { check_writable(folder / "p.stl", "points"); });
  expect_file_error(folder / "p.stl", ".ply", [&] { write_points(folder / "p.stl", made_points()); });
  expect_file_error("(no name)", "empty", [&] { write_text("", "x"); });
  EXPECT_THROW(check_writable(folder / "a.ply", "song"), ArgumentError);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Writing, InconsistentDataIsRefusedAndTheOldFileStays) {
  const Folder folder;
  for (const char* name : mesh_names) {
    folder.put(name, "old");
    TriangleMesh mesh = made_mesh();
    mesh.normals.pop_back();
    EXPECT_THROW(write_mesh(folder / name, mesh), ArgumentError);
    mesh = made_mesh();
    mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.vertices.size())});
    EXPECT_THROW(write_mesh(folder / name, mesh), ArgumentError);
    EXPECT_EQ(slurp(folder / name), "old");
  }
  EXPECT_EQ(folder.entries(), std::size(mesh_names));
}

TEST(Writing, ReplacesThroughLinksAndKeepsTheMode) {
  const Folder folder;
  folder.put("real.ply", "old");
  ::chmod((folder / "real.ply").c_str(), 0640);
  std::filesystem::create_symlink("real.ply", folder / "link.ply");
  write_mesh(folder / "link.ply", made_mesh());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.ply"));
  EXPECT_EQ(read_mesh(folder / "real.ply").vertices, made_mesh().vertices);
  struct stat info {};
  ::stat((folder / "real.ply").c_str(), &info);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(Writing, CheckLeavesNoTrace) {
  const Folder folder;
  check_writable(folder / "m.ply", "mesh");
  check_writable(folder / "p.xyz.gz", "points");
  check_writable(folder / "i.png", "image");
  check_writable(folder / "t.anything", "text");
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
