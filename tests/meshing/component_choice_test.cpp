#include "sansmesh/mesh_options.h"

#include <gtest/gtest.h>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

TEST(ComponentWords, GoThereAndBack) {
  for (const char* const word : {"auto", "all", "largest", "7"}) {
    ComponentChoice choice;
    option_of_text(word, choice);
    EXPECT_EQ(text_of_option(choice), word);
  }
  ComponentChoice one;
  option_of_text("1", one);
  EXPECT_EQ(one.kind, ComponentChoice::Kind::count);
  for (const char* const word : {"", "0", "-1", "2.5", "most", "99999999999"})
    EXPECT_THROW(option_of_text(word, one), ArgumentError) << word;
}

}  // namespace
}  // namespace sansmesh::inline v1
