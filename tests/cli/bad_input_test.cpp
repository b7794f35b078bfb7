// Tests of bad input: one line with file and cause, the right exit code, no output file.
#include <sys/stat.h>

#include "run_tool.h"

namespace sansmesh::test {
namespace {

struct Bad {
  const char* name;
  const char* file;     ///< as given to the tool
  std::string content;  ///< written under that name unless "absent"
  const char* cause;    ///< part of the message
};

const char* const kHeader =
    "ply\nformat binary_little_endian 1.0\nelement vertex %\n"
    "property float x\nproperty float y\nproperty float z\nend_header\n";

std::string header(const std::string& count) {
  std::string text = kHeader;
  return text.replace(text.find('%'), 1, count);
}

std::vector<Bad> bad_inputs() {
  std::string line, coincident;
  for (int i = 0; i < 100; ++i) {
    line += std::to_string(i) + " " + std::to_string(2 * i) + " 5\n";
    coincident += "1 2 3\n";
  }
  return {
      {"Missing", "absent.ply", "absent", "no such file"},
      {"Empty", "in.ply", "", "empty"},
      {"EmptyTable", "in.xyz", "", "empty"},
      {"OnlyComments", "in.xyz", "# nothing\n# here\n", "no points"},
      {"TruncatedHeader", "in.ply", "ply\nformat ascii 1.0\nelement ver", "header"},
      {"TruncatedBody", "in.ply", header("1000") + std::string(500, '\1'), "truncated"},
      {"AbsurdCount", "in.ply", header("99999999999999") + std::string(500, '\1'), "99999999999999"},
      {"NegativeCount", "in.ply", header("-5"), "-5"},
      {"Garbage", "in.xyz", "the quick brown fox\njumps over\nthe lazy dog\n", "in.xyz"},
      {"BinaryGarbage", "in.dat", std::string("\x7f\x45\x4c\x46\0\0\0\1\2\3", 10), "in.dat"},
      {"UnknownEnding", "in.docx", "hello", "docx"},
      {"AllNotANumber", "in.xyz", "nan nan nan\nnan nan nan\nnan nan nan\nnan nan nan\n", "finite"},
      {"OnePoint", "in.xyz", "1 2 3\n", "1 point"},
      {"ThreePoints", "in.xyz", "1 2 3\n4 5 6\n7 8 0\n", "3 points"},
      {"Coincident", "in.xyz", coincident, "coincide"},
      {"Collinear", "in.xyz", line, "line"},
  };
}

class BadInput : public ToolTest, public ::testing::WithParamInterface<Bad> {};

TEST_P(BadInput, IsOneLineAndLeavesNothing) {
  const Bad& bad = GetParam();
  if (bad.content != "absent") write(bad.file, bad.content);
  const auto before = listing();
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"reconstruct", bad.file, "-o", "out.ply", "--preview", "out.png"},
        std::vector<std::string>{"reconstruct", bad.file, "-o", "out.ply", "--json", "--threads", "2"}}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    const bool json = std::find(command.begin(), command.end(), "--json") != command.end();
    if (json)
      EXPECT_EQ(nlohmann::json::parse(outcome.out)["error"]["exit_code"], 1) << outcome.out;
    else
      EXPECT_EQ(outcome.out, "");
    std::string last = outcome.err;  // warnings may precede it
    while (std::count(last.begin(), last.end(), '\n') > 1) last.erase(0, last.find('\n') + 1);
    EXPECT_EQ(last.find("sansmesh: "), 0u) << outcome.err;
    EXPECT_NE(last.find(bad.file), std::string::npos) << outcome.err;
    EXPECT_NE(last.find(bad.cause), std::string::npos) << outcome.err;
    EXPECT_EQ(listing(), before);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BadInput, ::testing::ValuesIn(bad_inputs()),
                         [](const auto& tested) { return std::string(tested.param.name); });

struct Wrong {
  const char* name;
  std::vector<std::string> arguments;
  const char* cause;
};

class WrongOptions : public ToolTest, public ::testing::WithParamInterface<Wrong> {};

TEST_P(WrongOptions, AreUsageErrors) {
  write("in.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  const auto before = listing();
  const Outcome outcome = run(GetParam().arguments);
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(GetParam().cause), std::string::npos) << outcome.err;
  EXPECT_EQ(listing(), before);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, WrongOptions,
    ::testing::Values(
        Wrong{"NoOutput", {"reconstruct", "in.xyz"}, "--output"},
        Wrong{"NoInput", {"reconstruct", "-o", "out.ply"}, "input"},
        Wrong{"UnknownCommand", {"rebuild", "in.xyz"}, "rebuild"},
        Wrong{"UnknownOption", {"reconstruct", "in.xyz", "-o", "out.ply", "--sharpness"}, "--sharpness"},
        Wrong{"Depth", {"reconstruct", "in.xyz", "-o", "out.ply", "--depth", "40"}, "depth"},
        Wrong{"DepthWord", {"reconstruct", "in.xyz", "-o", "out.ply", "--depth", "deep"}, "deep"},
        Wrong{"Error", {"reconstruct", "in.xyz", "-o", "out.ply", "--error", "-1"}, "error"},
        Wrong{"ErrorNan", {"reconstruct", "in.xyz", "-o", "out.ply", "--error", "nan"}, "error"},
        Wrong{"Support", {"reconstruct", "in.xyz", "-o", "out.ply", "--support", "99"}, "support"},
        Wrong{"Degree", {"reconstruct", "in.xyz", "-o", "out.ply", "--degree", "0"}, "degree"},
        Wrong{"MeshError", {"reconstruct", "in.xyz", "-o", "out.ply", "--mesh-error", "0"}, "--mesh-error"},
        Wrong{"Trim", {"reconstruct", "in.xyz", "-o", "out.ply", "--trim", "-3"}, "trim"},
        Wrong{"Components", {"reconstruct", "in.xyz", "-o", "out.ply", "--components", "0"}, "components"},
        Wrong{"Faces", {"reconstruct", "in.xyz", "-o", "out.ply", "--faces", "both"}, "ignore"},
        Wrong{"Threads", {"reconstruct", "in.xyz", "-o", "out.ply", "--threads", "0"}, "--threads"},
        Wrong{"Neighbours", {"normals", "in.xyz", "-o", "out.ply", "--neighbours", "2"}, "neighbours"},
        Wrong{"Samples", {"assess", "in.xyz", "in.xyz", "--samples", "0"}, "--samples"},
        Wrong{"Width", {"render", "in.xyz", "-o", "out.png", "--width", "0"}, "width"},
        Wrong{"View", {"render", "in.xyz", "-o", "out.png", "--view", "inside"}, "inside"}),
    [](const auto& tested) { return std::string(tested.param.name); });

class BadOutput : public ToolTest {};

TEST_F(BadOutput, IsFoundBeforeTheWork) {
  write("in.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  std::filesystem::create_directory(path("folder.ply"));
  const auto before = listing();
  for (const auto& [file, cause] :
       std::vector<std::pair<std::string, std::string>>{{"out.docx", "docx"},
                                                        {"out", "ending"},
                                                        {"no/such/out.ply", "folder does not exist"},
                                                        {"folder.ply", "directory"},
                                                        {"", "name"}}) {
    const Outcome outcome = run({"reconstruct", "in.xyz", "-o", file});
    EXPECT_EQ(outcome.code, 1) << file;
    EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << file << ": " << outcome.err;
    EXPECT_EQ(listing(), before);
  }
  const Outcome preview = run({"reconstruct", "in.xyz", "-o", "out.ply", "--preview", "out.jpg"});
  EXPECT_EQ(preview.code, 1);
  EXPECT_NE(preview.err.find("out.jpg"), std::string::npos);
  EXPECT_EQ(listing(), before);
}

TEST_F(BadOutput, AFailureLeavesTheOldFileAsItWas) {
  write("in.xyz", "1 2 3\n");
  write("out.ply", "precious");
  EXPECT_EQ(run({"reconstruct", "in.xyz", "-o", "out.ply"}).code, 1);
  EXPECT_EQ(slurp(path("out.ply")), "precious");
}

}  // namespace
}  // namespace sansmesh::test
