// Similar words for mistyped ones.
#include "sansmesh/core/similar_words.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sansmesh::test {
namespace {

using Words = std::vector<std::string>;

TEST(SimilarWords, LettersLeftOutAddedExchangedOrWrong) {
  const Words known{"front", "top", "isometric"};
  EXPECT_EQ(similar_words("tpo", known), Words{"top"});
  EXPECT_EQ(similar_words("fornt", known), Words{"front"});
  EXPECT_EQ(similar_words("Isometrik", known), Words{"isometric"});
  EXPECT_TRUE(similar_words("quaternion", known).empty());
  EXPECT_TRUE(similar_words("", known).empty());
}

TEST(SimilarWords, CapitalsUnderscoresAndDashesInFrontDoNotCount) {
  EXPECT_EQ(word_distance("MESH_ERROR", "--mesh-error"), 0);
  EXPECT_EQ(word_distance("mesh", "tetrahedra"), -1);
  EXPECT_LT(word_distance("mesh-eror", "mesh-error"), word_distance("mesh", "mesh-error"));
}

TEST(SimilarWords, ThreeAtMostTheBestFirst) {
  const Words found = similar_words("point", {"points", "pointed", "point-a", "point-b", "joint"});
  EXPECT_LE(found.size(), 3u);
  EXPECT_EQ(found.front(), "points");
}

TEST(SimilarWords, AreOfferedInASentence) {
  EXPECT_EQ(did_you_mean("tpo", {"front", "top"}), " (did you mean top?)");
  EXPECT_EQ(did_you_mean("xyz", {"front", "top"}), "");
  EXPECT_EQ(joined_by_or({"a", "b", "c"}), "a, b or c");
}

}  // namespace
}  // namespace sansmesh::test
