#include "sansmesh/io/transform_file.h"

#include "io_test_tools.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

const AffineMap kMap{{0.1, 0.2, 1.0 / 3}, {-0.5, 2, 0}, {0, 1e-9, -3}, {512345.678, -1e7, 0}};

TEST(TransformFile, ReadsBackWhatItWrote) {
  const Folder folder;
  for (const char* name : {"t.txt", "t.json"}) {
    write_transform(folder / name, kMap);
    EXPECT_EQ(read_transform(folder / name), kMap) << name;
  }
}

TEST(TransformFile, ReadsWhatOthersWrite) {
  const Folder folder;
  const AffineMap shift = AffineMap::translation({4, 5, 6});
  for (const char* text :
       {"1.000000 0.000000 0.000000 4.000000\n0 1 0 5\n0 0 1 6\n0 0 0 1\n",
        "\xef\xbb\xbf[1,0,0,4, 0,1,0,5, 0,0,1,6, 0,0,0,1]", "# moves\r\n1,0,0,4\r\n0,1,0,5 // y\r\n0,0,1,6\r\n",
        "[[1,0,0,4],[0,1,0,5],[0,0,1,6],[0,0,0,1]]", "{\"matrix\": [1,0,0,4, 0,1,0,5, 0,0,1,6, 0,0,0,1]}"}) {
    (void)folder.put("t", text);
    EXPECT_EQ(read_transform(folder / "t"), shift) << text;
  }
}

TEST(TransformFile, SaysWhatIsWrong) {
  const Folder folder;
  const auto message = [&](const std::string& text) -> std::string {
    (void)folder.put("t", text);
    try {
      (void)read_transform(folder / "t");
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("1 0 0 0\n0 1 0 0\n").find("8 numbers"), std::string::npos);
  EXPECT_NE(message("1 0 0 x\n").find("not 'x'"), std::string::npos);
  EXPECT_NE(message("1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n").find("transpose"), std::string::npos);
  EXPECT_NE(message("1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 2\n").find("0 0 0 1"), std::string::npos);
  EXPECT_NE(message("1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n").find("no inverse"), std::string::npos);
  EXPECT_NE(message("[[1, 2").find("JSON"), std::string::npos);
  EXPECT_NE(message("{\"a\": 1}").find("matrix"), std::string::npos);
  EXPECT_NE(message("1e999 0 0 0 0 1 0 0 0 0 1 0").find("finite"), std::string::npos);
}

}  // namespace
}  // namespace sansmesh::inline v1
