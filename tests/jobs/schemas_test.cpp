// Tests of schemas of composed options: every part has its rows, which set the part's fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sansmesh/flow_pictures.h"
#include "sansmesh/functions.h"
#include "sansmesh/option.h"
#include "sansmesh/pictures.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::test {
namespace {

template <class T>
std::vector<std::string> names_of() {
  T options;
  std::vector<std::string> names;
  for_each_option(T::schema(), &options, [&](const OptionRow& row, void*) { names.emplace_back(row.name); });
  return names;
}

template <class T>
void set_all(T& options, std::string_view name, const OptionValue& value) {
  for_each_option(T::schema(), &options, [&](const OptionRow& row, void* owner) {
    if (row.name == name) set_option(row, owner, value);
  });
}

template <class T>
class PicturesOf : public testing::Test {};
using PictureTypes = testing::Types<SurfaceRenderOptions, VolumePictureOptions, LinePictureOptions, FlowPictureOptions>;
TYPED_TEST_SUITE(PicturesOf, PictureTypes);

TYPED_TEST(PicturesOf, ViewLookAndQualityAreRowsOnce) {
  std::vector<std::string> names = names_of<TypeParam>();
  for (const char* const name : {"width", "orthographic", "background", "shadows", "antialiasing", "scale_bar"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  TypeParam options;
  set_all(options, "width", std::int64_t{320});
  set_all(options, "background", std::string("#204060"));
  EXPECT_EQ(options.picture.view.width, 320);
  EXPECT_EQ(options.picture.look.effective_background().kind, Background::Kind::solid);
  EXPECT_THROW(set_all(options, "width", std::int64_t{0}), ArgumentError);
}

TEST(ReconstructSchema, EachPartHasItsRows) {
  const std::vector<std::string> names = names_of<ReconstructOptions>();
  for (const char* const name : {"normals", "threshold", "mesh_error", "method"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  EXPECT_EQ(std::count(names.begin(), names.end(), "error"), 2) << "of the fit and of other surfaces";
  ReconstructOptions options;
  set_all(options, "mesh_error", 0.25);
  EXPECT_EQ(options.mesh.mesh_error, 0.25);
  const std::vector<std::string> fit = names_of<FitFunctionOptions>();
  EXPECT_EQ(std::count(fit.begin(), fit.end(), "mesh_error"), 0);
  EXPECT_EQ(std::count(fit.begin(), fit.end(), "error"), 1);
}

}  // namespace
}  // namespace sansmesh::test
