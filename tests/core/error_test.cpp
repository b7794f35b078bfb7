// Escaping of text from files and users in error messages.
#include "sansmesh/error.h"

#include <gtest/gtest.h>

#include <random>

#include "support/clean_text.h"

namespace sansmesh::inline v1 {
namespace {

using test::is_clean;

TEST(Printable, LeavesTextAlone) {
  for (const char* text :
       {"", "plain text: 'x' \\ \"y\"", "Größe 3 × 4 ± 0.1°", "点群", "a 🦉 b", "\u00a0\u2027\u202a"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, EscapesWhatIsNoTextOfOneLine) {
  EXPECT_EQ(printable("a\nb\tc\r"), "a\\x0ab\\x09c\\x0d");
  EXPECT_EQ(printable(std::string_view("\0\x7f\x1b[2J", 6)), "\\x00\\x7f\\x1b[2J");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\xc2\\x9b31m");  // the one-character escape sequence
  EXPECT_EQ(printable("\u2028\u2029"), "\\xe2\\x80\\xa8\\xe2\\x80\\xa9");
  EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(printable("\x80 \xbf"), "\\x80 \\xbf");  // continuation bytes without a start
  EXPECT_EQ(printable("\xc3"), "\\xc3");             // incomplete sequence
  EXPECT_EQ(printable("\xe4\xb8z"), "\\xe4\\xb8z");
  EXPECT_EQ(printable("\xc0\xaf\xe0\x80\xaf"), "\\xc0\\xaf\\xe0\\x80\\xaf");  // overlong encoding
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");                    // surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");           // beyond Unicode
}

TEST(Printable, WhateverTheBytes) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text(random() % 60, '\0');
    for (char& c : text)
      c = static_cast<char>(random() % 3 == 0 ? random() : "\xc3\xa9\xe2\x80\xa9\xf0\x9f\xa6\x89z"[random() % 10]);
    const std::string shown = printable(text);
    EXPECT_TRUE(is_clean(shown)) << shown;
    EXPECT_EQ(printable(shown), shown);
    if (is_clean(text)) {
      EXPECT_EQ(shown, text);
    }
    EXPECT_TRUE(is_clean(printable(text, random() % 30)));
  }
}

TEST(Printable, LeavesOutTheMiddle) {
  EXPECT_EQ(printable("abcdefghij", 10), "abcdefghij");
  EXPECT_EQ(printable("abcdefghijk", 10), "abcdef…ijk");
  EXPECT_EQ(printable("éééééééé", 4), "éé…é");
  EXPECT_EQ(printable("\n\n\n\n\n\n\n\n", 4), "\\x0a\\x0a…\\x0a");
  EXPECT_EQ(printable("abc", 1), "…");
  EXPECT_EQ(printable("abc", 0), "");
  const std::string cut = printable("begin" + std::string(1000000, 'x') + "end", 7);
  EXPECT_EQ(cut, "begi…nd");
}

TEST(FileError, IsOnePrintableLine) {
  const FileError error("a\nb.ply", "unknown '\x1b[31m" + std::string(100000, '\xff') + "' of the file");
  const std::string what = error.what();
  EXPECT_EQ(what.rfind("a\\x0ab.ply: unknown '\\x1b[31m\\xff", 0), 0u) << what;
  EXPECT_TRUE(what.ends_with("\\xff' of the file")) << what;
  EXPECT_TRUE(is_clean(what));
  EXPECT_LT(what.size(), 4000u);
  EXPECT_EQ(error.file(), "a\nb.ply");
}

TEST(FileError, KeepsItsNameHoweverLong) {
  const std::string name = std::string(3000, 'n') + ".ply";
  EXPECT_EQ(std::string(FileError(name, "no such file").what()), name + ": no such file");
}

}  // namespace
}  // namespace sansmesh::inline v1
