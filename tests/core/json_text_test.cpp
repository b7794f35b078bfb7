// Error messages for invalid JSON.
#include "sansmesh/core/json_text-inl.h"

#include <gtest/gtest.h>

#include "support/clean_text.h"

namespace sansmesh::inline v1 {
namespace {

std::string error_of(const std::string& text) {
  try {
    detail::parse_json<nlohmann::ordered_json>(text);
  } catch (const ArgumentError& error) {
    EXPECT_TRUE(test::is_clean(error.what())) << error.what();
    EXPECT_EQ(std::string(error.what()).find("exception"), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST(JsonText, NamesThePlaceAndTheCause) {
  EXPECT_EQ(error_of("{\"a\": [1, 2]}"), "");
  EXPECT_EQ(error_of("{\n  \"a\": 1,\n}"), "is not JSON: unexpected '}' at line 3, column 1");
  EXPECT_EQ(error_of("{\n  \"a\": [1,\n"), "is not JSON: it ends unexpectedly at line 2, column 10");
  EXPECT_EQ(error_of(" \n"), "is not JSON: it is blank");
  EXPECT_EQ(error_of(""), "is not JSON: it is blank");
  EXPECT_EQ(error_of("[1e999]"), "contains a number that is too large");
  EXPECT_EQ(error_of("[\"\xff\"]"), "is not JSON: line 1, column 3 is not valid UTF-8");
  EXPECT_EQ(error_of("[\"a\nb\"]"),
            "is not JSON: at line 1, column 4 a string is unterminated or contains a control character");
  EXPECT_NE(error_of("\x1b[31m"), "");
}

TEST(JsonText, AnyTruncationAndAnyByteIsOneLine) {
  const std::string text = R"({"version": 1, "steps": [{"select": {"ball": {"center": [0, -1.5e3, 2]}}}, true, null]})";
  for (std::size_t n = 0; n < text.size(); ++n) {
    EXPECT_NE(error_of(text.substr(0, n)), "") << n;
    for (const char c : {'\0', '\n', '"', '}', '\xff', '\x80'}) {
      std::string changed = text;
      changed[n] = c;
      (void)error_of(changed);
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
