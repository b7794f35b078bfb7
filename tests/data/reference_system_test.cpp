// Reference systems: texts of both generations, GeoTIFF keys, codes, and when two systems are equal.
#include "sansmesh/data/reference_system.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "sansmesh/data/wkt_tree.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr const char* kUtm =
    R"wkt(PROJCS["NAD83 / UTM zone 10N",GEOGCS["NAD83",DATUM["North_American_Datum_1983",SPHEROID["GRS 1980",6378137,298.257222101,AUTHORITY["EPSG","7019"]],AUTHORITY["EPSG","6269"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4269"]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",-123],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AXIS["Northing",NORTH],AUTHORITY["EPSG","26910"]])wkt";
constexpr const char* kFeet =
    R"wkt(PROJCS["NAD_1983_HARN_Lambert_Conformal_Conic",GEOGCS["GCS_North_American_1983_HARN",DATUM["NAD83_High_Accuracy_Regional_Network",SPHEROID["GRS_1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic_2SP"],UNIT["foot",0.3048,AUTHORITY["EPSG","9002"]]])wkt";
constexpr const char* kCompound =
    R"wkt(COMPD_CS["NAD83 / Oregon LCC (m) + NAVD88 height (ftUS)",PROJCS["NAD83 / Oregon LCC (m)",GEOGCS["NAD83",UNIT["degree",0.0174532925199433]],UNIT["metre",1],AUTHORITY["EPSG","2991"]],VERT_CS["NAVD88 height (ftUS)",VERT_DATUM["North American Vertical Datum 1988",2005],UNIT["US survey foot",0.304800609601219],AXIS["Up",UP],AUTHORITY["EPSG","6360"]]])wkt";
constexpr const char* kNewer =
    R"wkt(PROJCRS["ETRS89 / UTM zone 32N",BASEGEOGCRS["ETRS89",DATUM["European Terrestrial Reference System 1989",ELLIPSOID["GRS 1980",6378137,298.257222101,LENGTHUNIT["metre",1]]],PRIMEM["Greenwich",0,ANGLEUNIT["degree",0.0174532925199433]]],CONVERSION["UTM zone 32N",METHOD["Transverse Mercator"]],CS[Cartesian,2],AXIS["(E)",east,ORDER[1],LENGTHUNIT["metre",1]],AXIS["(N)",north,ORDER[2],LENGTHUNIT["metre",1]],ID["EPSG",25832]])wkt";
constexpr const char* kAngles =
    R"wkt(GEOGCS["WGS 84",DATUM["WGS_1984"],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]])wkt";

TEST(ReferenceSystem, TextsGiveNamesCodesAndUnits) {
  const auto utm = system_of_text(kUtm), feet = system_of_text(kFeet), compound = system_of_text(kCompound),
             newer = system_of_text(kNewer), angles = system_of_text(kAngles);
  ASSERT_TRUE(utm && feet && compound && newer && angles);
  EXPECT_EQ(system_words(*utm), "NAD83 / UTM zone 10N (EPSG:26910), unit metre");
  EXPECT_EQ(utm->wkt, kUtm);
  EXPECT_EQ(system_words(*feet), "NAD_1983_HARN_Lambert_Conformal_Conic, unit foot");
  EXPECT_DOUBLE_EQ(feet->metres, 0.3048);
  EXPECT_EQ(compound->code, 2991);
  EXPECT_EQ(compound->vertical_code, 6360);
  EXPECT_EQ(unit_words(*compound), "unit metre, heights in US survey foot");
  EXPECT_EQ(system_words(*newer), "ETRS89 / UTM zone 32N (EPSG:25832), unit metre");
  EXPECT_EQ(angles->unit, "degree");
  EXPECT_EQ(angles->metres, 0);
  EXPECT_EQ(system_words(*system_of_text("PROJCS[\"unnamed\",UNIT[\"m\",1],AUTHORITY[\"EPSG\",\"2056\"]]")),
            "EPSG:2056, unit metre");
}

TEST(ReferenceSystem, DegreesHaveManyNames) {
  const auto angles = system_of_text(kAngles);
  for (const char* const unit : {R"("Degree",0.0174532925199433)", R"("DEGREES",0.01745329)"}) {
    const auto same = system_of_text(fmt::format("GEOGCS[\"WGS 84\",UNIT[{}],AUTHORITY[\"EPSG\",\"4326\"]]", unit));
    ASSERT_TRUE(same);
    EXPECT_EQ(same->unit, "degree");
    EXPECT_TRUE(may_be_equal(same.get(), angles.get()));
  }
  EXPECT_EQ(system_of_text(R"(GEOGCS["NTF",UNIT["grad",0.015707963267949]])")->unit, "grad");
}

TEST(ReferenceSystem, HeightsOfEsriAreASecondText) {
  const std::string projected = R"(PROJCS["NAD_1983_UTM_Zone_10N",GEOGCS["a"],UNIT["Meter",1.0]])",
                    heights = R"(VERTCS["NAVD88",VDATUM["b"],UNIT["Foot_US",0.3048006096012192]])";
  const auto both = system_of_text(projected + ",\n" + heights);
  ASSERT_TRUE(both);
  EXPECT_EQ(system_words(*both), "NAD_1983_UTM_Zone_10N, unit metre, heights in US survey foot");
  for (const std::string& rest : {std::string(","), "," + projected, heights, "," + heights + "," + heights})
    EXPECT_FALSE(system_of_text(projected + rest)) << rest;
}

TEST(ReferenceSystem, CodesAlone) {
  const auto zone = system_of_text(" EPSG:32733\n"), other = system_of_text("epsg:2056+5728");
  ASSERT_TRUE(zone && other);
  EXPECT_EQ(system_words(*zone), "WGS 84 / UTM zone 33S (EPSG:32733), unit metre");
  EXPECT_EQ(system_words(*other), "EPSG:2056+5728, unit unknown");
  // The text made for other programs is WKT of the same system.
  const auto again = system_of_text(wkt_of(*zone));
  ASSERT_TRUE(again);
  EXPECT_EQ(system_words(*again), system_words(*zone));
  EXPECT_EQ(wkt_of(*other), "");
}

TEST(ReferenceSystem, DamagedTextsAreNone) {
  for (const std::string& text : {std::string(), std::string("  "), std::string("EPSG:"), std::string("EPSG:1x"),
                                  std::string(kUtm).substr(0, 200), std::string("PROJCS"), std::string("PROJCS[\"a\""),
                                  std::string("SOMETHING[\"a\",1]"), std::string(1000, '['), std::string("1 2 3")})
    EXPECT_FALSE(system_of_text(text)) << text;
  std::string deep;
  for (int k = 0; k < 1000; ++k) deep += "PROJCS[";
  EXPECT_FALSE(parse_wkt(deep));
}

TEST(ReferenceSystem, GeoTiffKeys) {
  const std::vector<std::uint16_t> utm = {1,  1, 0,    4, 1024, 0,     1,    1, 1026, 34737,
                                          21, 0, 3072, 0, 1,    26910, 3076, 0, 1,    9001};
  const auto system = system_of_keys(utm, {}, "NAD83 / UTM zone 10N|NAD83|");
  ASSERT_TRUE(system);
  EXPECT_EQ(system_words(*system), "NAD83 / UTM zone 10N (EPSG:26910), unit metre");
  EXPECT_EQ(system->geo_keys, utm);
  const std::vector<std::uint16_t> feet = {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32767, 3076, 0, 1, 9003};
  EXPECT_EQ(system_words(*system_of_keys(feet, {}, {})), "unnamed system, unit US survey foot");
  EXPECT_EQ(system_words(*system_of_keys(feet, {}, {}, kUtm)), "NAD83 / UTM zone 10N (EPSG:26910), unit metre");
  EXPECT_FALSE(system_of_keys({}, {}, {}));
  // Positions beyond the arrays.
  const std::vector<std::uint16_t> bad = {1, 1,    0, 9, 1024,  0,    1,     1, 1026, 34737, 60000,
                                          9, 3076, 0, 1, 32767, 3077, 34736, 1, 7,    3072};
  EXPECT_TRUE(system_of_keys(bad, {}, "x"));
}

TEST(ReferenceSystem, AllPairsOfInputsAreCompared) {
  const auto unit = system_of_text("LOCAL_CS[\"\",UNIT[\"metre\",1]]"), a = system_of_text("EPSG:25832"),
             b = system_of_text("EPSG:25833");
  ASSERT_TRUE(unit && may_be_equal(unit.get(), a.get()) && may_be_equal(unit.get(), b.get()));
  CommonSystem common;
  EXPECT_FALSE(common.system());
  EXPECT_FALSE(common.add("none", nullptr));
  EXPECT_FALSE(common.add("unit", unit));
  EXPECT_EQ(common.system(), unit);
  EXPECT_FALSE(common.add("a", a));
  EXPECT_FALSE(common.add("again", system_of_text("EPSG:25832")));
  EXPECT_EQ(common.system(), a);
  const CommonSystem::Stated* const other = common.add("b", b);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->name, "a");
  EXPECT_EQ(common.system(), a);
}

TEST(ReferenceSystem, TextsStateTheUnitsOfKeys) {
  const auto keys = [](std::uint16_t unit, std::uint16_t heights, std::uint16_t unit_of_heights) {
    return std::vector<std::uint16_t>{1,    1, 0, 5,    1024, 0, 1, 1,       3072, 0, 1, 26910,
                                      3076, 0, 1, unit, 4096, 0, 1, heights, 4099, 0, 1, unit_of_heights};
  };
  const auto again = [](const SharedSystem& system) {
    const auto read = system_of_text(wkt_of(*system));
    EXPECT_TRUE(read && may_be_equal(read.get(), system.get()));
    return read ? system_words(*read) : std::string();
  };
  EXPECT_EQ(again(system_of_keys(keys(9003, 0, 0), {}, {})), "NAD83 / UTM zone 10N, unit US survey foot");
  EXPECT_EQ(again(system_of_keys(keys(9002, 6360, 9003), {}, {})),
            "NAD83 / UTM zone 10N (heights EPSG:6360), unit foot, heights in US survey foot");
  EXPECT_EQ(again(system_of_keys(keys(9001, 0, 9003), {}, {})),
            "NAD83 / UTM zone 10N (EPSG:26910), unit metre, heights in US survey foot");
  // The text of the file has no heights.
  EXPECT_EQ(again(system_of_keys(keys(9001, 0, 9003), {}, {}, kUtm)),
            "NAD83 / UTM zone 10N (EPSG:26910), unit metre, heights in US survey foot");
  EXPECT_EQ(wkt_of(*system_of_keys(keys(9001, 0, 9001), {}, {}, kUtm)), kUtm);
}

TEST(ReferenceSystem, DifferentSystemsAreNamed) {
  const auto utm = system_of_text(kUtm), feet = system_of_text(kFeet), code = system_of_text("EPSG:26910"),
             other = system_of_text("EPSG:26911");
  EXPECT_TRUE(may_be_equal(utm.get(), nullptr));
  EXPECT_TRUE(may_be_equal(utm.get(), code.get()));
  EXPECT_FALSE(may_be_equal(code.get(), other.get()));
  const auto same = system_of_text("PROJCS[\"NAD_1983_UTM_Zone_10N\",UNIT[\"Meter\",1.0]]");
  EXPECT_TRUE(may_be_equal(utm.get(), same.get()));
  EXPECT_FALSE(may_be_equal(utm.get(), feet.get()));
  EXPECT_NO_THROW(require_same_system(utm.get(), "a", code.get(), "b"));
  try {
    require_same_system(utm.get(), "a.las", feet.get(), "b.las");
    FAIL();
  } catch (const DataError& error) {
    const std::string what = error.what();
    for (const char* part : {"a.las", "b.las", "NAD83 / UTM zone 10N", "unit foot"})
      EXPECT_NE(what.find(part), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
