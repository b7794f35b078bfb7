#include "sansmesh/data/reference_system.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "sansmesh/core/option_text.h"
#include "sansmesh/data/wkt_tree.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kMetre = "metre", kFoot = "foot", kSurveyFoot = "US survey foot", kDegree = "degree";
constexpr double kFootLength = 0.3048, kSurveyFootLength = 1200.0 / 3937;
constexpr double kSameUnit = 1e-9;  ///< relative difference of equal units: the two feet differ by 2e-6
constexpr double kDegreeAngle = std::numbers::pi / 180, kSameAngle = 1e-4;
constexpr std::size_t kLongestName = 200, kLongestText = std::size_t{1} << 20;
constexpr int kUserDefined = 32767;

// GeoTIFF keys (OGC 19-008).
enum GeoKey : unsigned {
  kModelType = 1024,
  kCitation = 1026,
  kGeographicCode = 2048,
  kGeographicCitation = 2049,
  kProjectedCode = 3072,
  kProjectedCitation = 3073,
  kLinearUnit = 3076,
  kLinearUnitLength = 3077,
  kVerticalCode = 4096,
  kVerticalCitation = 4097,
  kVerticalUnit = 4099
};
enum GeoModel : int { kProjectedModel = 1, kGeographicModel = 2, kGeocentricModel = 3 };

/// A unit of length; `metres` 0: an angle or unknown.
struct SystemUnit {
  std::string name;
  double metres = 0;
};

SystemUnit unit_of_length(double metres, const std::string& given) {
  const auto is = [&](double length) { return std::abs(metres / length - 1) < kSameUnit * 100; };
  if (is(1)) return {std::string(kMetre), 1};
  if (is(kFootLength)) return {std::string(kFoot), kFootLength};
  if (is(kSurveyFootLength)) return {std::string(kSurveyFoot), kSurveyFootLength};
  return {given.empty() ? fmt::format("{:g} m", metres) : given, metres};
}

/// Names of the degree differ ("Degree" of ESRI), its size does not.
SystemUnit unit_of_angle(double radians, const std::string& given) {
  return {std::abs(radians / kDegreeAngle - 1) < kSameAngle ? std::string(kDegree) : given, 0};
}

/// Units by their EPSG code.
SystemUnit unit_of_code(int code) {
  if (code == 9001) return {std::string(kMetre), 1};
  if (code == 9002) return {std::string(kFoot), kFootLength};
  if (code == 9003) return {std::string(kSurveyFoot), kSurveyFootLength};
  if (code == 9102) return {std::string(kDegree), 0};
  return {};
}

/// Datum and zone of UTM systems.
struct UtmZone {
  const char *datum, *wkt_datum, *spheroid;
  int datum_code, zone;
  bool south = false;
};

std::optional<UtmZone> utm_zone(int code) {
  constexpr const char *wgs_datum = "WGS_1984", *wgs_spheroid = "SPHEROID[\"WGS 84\",6378137,298.257223563]";
  constexpr const char* grs = "SPHEROID[\"GRS 1980\",6378137,298.257222101]";
  if (code >= 32601 && code <= 32660) return UtmZone{"WGS 84", wgs_datum, wgs_spheroid, 4326, code - 32600};
  if (code >= 32701 && code <= 32760) return UtmZone{"WGS 84", wgs_datum, wgs_spheroid, 4326, code - 32700, true};
  if (code >= 25828 && code <= 25838)
    return UtmZone{"ETRS89", "European_Terrestrial_Reference_System_1989", grs, 4258, code - 25800};
  if (code >= 26901 && code <= 26923) return UtmZone{"NAD83", "North_American_Datum_1983", grs, 4269, code - 26900};
  return std::nullopt;
}

std::string utm_name(const UtmZone& z) {
  return fmt::format("{} / UTM zone {}{}", z.datum, z.zone, z.south ? "S" : "N");
}

/// Empty for placeholders of other programs.
std::string clean_name(const std::string& name) {
  return name == "unnamed" || name == "unknown" ? std::string() : printable(name, kLongestName);
}

/// Letters and digits of a name, with years of two digits: "NAD_1983_UTM_Zone_10N" and "NAD83 / UTM zone 10N" are one.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string_view datum : {"nad1983", "nad1927", "wgs1984", "etrs1989"})
    if (plain.starts_with(datum)) plain.erase(datum.find("19"), 2);
  return plain;
}

bool is_vertical(const WktNode& node) { return node.keyword.starts_with("VERT") && node.keyword != "VERT_DATUM"; }

int code_of(const WktNode& node) {
  const WktNode* const id = node.child({"AUTHORITY", "ID"});
  if (!id || id->values.size() < 2 || id->values[0] != "EPSG") return 0;
  const long code = std::strtol(id->values[1].c_str(), nullptr, 10);
  return code > 0 && code < 1000000 ? static_cast<int>(code) : 0;
}

SystemUnit unit_of(const WktNode& node) {
  const bool angles = node.keyword.starts_with("GEOG") || node.keyword == "BASEGEOGCRS";
  const auto read = [&](const WktNode* unit) -> std::optional<SystemUnit> {
    if (!unit || unit->values.size() < 2) return std::nullopt;
    const double size = std::strtod(unit->values[1].c_str(), nullptr);
    if (angles || unit->keyword == "ANGLEUNIT") return unit_of_angle(size, clean_name(unit->name()));
    if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
    return unit_of_length(size, clean_name(unit->name()));
  };
  if (const auto unit = read(node.child({"LENGTHUNIT", "UNIT", "ANGLEUNIT"}))) return *unit;
  for (const WktNode& axis : node.children)
    if (axis.keyword == "AXIS")
      if (const auto unit = read(axis.child({"LENGTHUNIT", "UNIT", "ANGLEUNIT"}))) return *unit;
  return angles ? SystemUnit{std::string(kDegree), 0} : SystemUnit{};
}

bool describe_wkt(const WktNode& root, ReferenceSystem& system) {
  static constexpr std::string_view horizontal[] = {"PROJ", "GEOG", "GEOD", "GEOC", "LOCAL_CS", "ENG", "DERIVEDPROJ"};
  const auto is_horizontal = [](const WktNode& node) {
    return std::any_of(std::begin(horizontal), std::end(horizontal),
                       [&](std::string_view start) { return node.keyword.starts_with(start); });
  };
  const auto take = [&](const WktNode& node) {
    SystemUnit unit = unit_of(node);
    if (is_vertical(node)) {
      system.vertical_code = code_of(node);
      system.vertical_unit = std::move(unit.name), system.vertical_metres = unit.metres;
    } else {
      system.code = code_of(node);
      system.unit = std::move(unit.name), system.metres = unit.metres;
    }
  };
  system.name = clean_name(root.name());
  if (is_horizontal(root) || is_vertical(root)) return take(root), true;
  if (root.keyword == "BOUNDCRS") {
    const WktNode* const source = root.child({"SOURCECRS"});
    return source && !source->children.empty() && describe_wkt(source->children[0], system);
  }
  if (root.keyword != "COMPD_CS" && root.keyword != "COMPOUNDCRS") return false;
  for (const WktNode& part : root.children)
    if (is_horizontal(part) || is_vertical(part)) take(part);
  return true;
}

/// "EPSG:25832", "EPSG:25832+7837".
std::optional<ReferenceSystem> system_of_code(std::string_view text) {
  const std::string upper = upper_case(text);
  for (const std::string_view prefix : {"URN:OGC:DEF:CRS:EPSG::", "EPSG:"}) {
    if (!upper.starts_with(prefix) || upper.size() > 40) continue;
    char* rest = nullptr;
    const long code = std::strtol(upper.c_str() + prefix.size(), &rest, 10);
    long vertical = 0;
    if (*rest == '+') vertical = std::strtol(rest + 1, &rest, 10);
    if (*rest != '\0' || code <= 0 || code > 999999 || vertical < 0 || vertical > 999999) return std::nullopt;
    ReferenceSystem system;
    system.code = static_cast<int>(code), system.vertical_code = static_cast<int>(vertical);
    if (const auto zone = utm_zone(system.code)) system.name = utm_name(*zone), system.unit = kMetre, system.metres = 1;
    return system;
  }
  return std::nullopt;
}

std::string_view without_padding(std::string_view text) {
  const auto is_padding = [](char c) { return c == '\0' || std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && is_padding(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_padding(text.back())) text.remove_suffix(1);
  return text;
}

/// Values of GeoTIFF keys.
class GeoKeys {
 public:
  GeoKeys(std::span<const std::uint16_t> keys, std::span<const double> doubles, std::string_view ascii)
      : keys_(keys), doubles_(doubles), ascii_(ascii) {}

  int number(unsigned key) const {
    const std::size_t at = find(key);
    return at != 0 && keys_[at + 1] == 0 ? keys_[at + 3] : 0;
  }
  double real(unsigned key) const {
    const std::size_t at = find(key);
    return at != 0 && keys_[at + 1] == 34736 && keys_[at + 3] < doubles_.size() ? doubles_[keys_[at + 3]] : 0;
  }
  std::string text(unsigned key) const {
    const std::size_t at = find(key);
    if (at == 0 || keys_[at + 1] != 34737 || keys_[at + 3] >= ascii_.size()) return {};
    const std::string_view found = ascii_.substr(keys_[at + 3], keys_[at + 2]);
    return clean_name(std::string(without_padding(found.substr(0, found.find_first_of(std::string_view("|\0", 2))))));
  }

 private:
  /// Position of the key's four numbers; 0 if it is absent.
  std::size_t find(unsigned key) const {
    for (std::size_t at = 4; at + 4 <= keys_.size(); at += 4)
      if (keys_[at] == key) return at;
    return 0;
  }

  std::span<const std::uint16_t> keys_;
  std::span<const double> doubles_;
  std::string_view ascii_;
};

std::optional<ReferenceSystem> describe_keys(const GeoKeys& keys) {
  const int model = keys.number(kModelType), vertical = keys.number(kVerticalCode);
  const auto known = [](int code) { return code == kUserDefined ? 0 : code; };
  ReferenceSystem system;
  system.code = known(keys.number(model == kProjectedModel ? kProjectedCode : kGeographicCode));
  system.vertical_code = known(vertical);
  for (const unsigned key : {model == kProjectedModel ? kProjectedCitation : kGeographicCitation, kCitation})
    if (system.name.empty()) system.name = keys.text(key);
  const auto zone = model == kProjectedModel ? utm_zone(system.code) : std::nullopt;
  if (zone) system.name = utm_name(*zone);
  const int linear = keys.number(kLinearUnit);
  SystemUnit unit = linear == kUserDefined && keys.real(kLinearUnitLength) > 0
                        ? unit_of_length(keys.real(kLinearUnitLength), {})
                        : unit_of_code(linear);
  if (unit.name.empty() && (zone || model == kGeocentricModel)) unit = {std::string(kMetre), 1};
  if (model == kGeographicModel) unit = {std::string(kDegree), 0};
  system.unit = unit.name, system.metres = unit.metres;
  const SystemUnit height = unit_of_code(keys.number(kVerticalUnit));
  system.vertical_unit = height.name, system.vertical_metres = height.metres;
  if (model == 0 && system.code == 0 && system.name.empty() && system.unit.empty()) return std::nullopt;
  return system;
}

/// What a system states, the most important part first.
auto knowledge(const ReferenceSystem& s) {
  return std::tuple(s.code != 0, !s.name.empty(), s.vertical_code != 0, !s.wkt.empty(), !s.geo_keys.empty(),
                    !s.unit.empty(), !s.vertical_unit.empty());
}

/// Whether no comparison tells the systems apart.
bool is_described_alike(const ReferenceSystem& a, const ReferenceSystem& b) {
  const auto compared = [](const ReferenceSystem& s) {
    return std::tie(s.code, s.vertical_code, s.metres, s.vertical_metres, s.unit, s.name);
  };
  return compared(a) == compared(b) && knowledge(a) == knowledge(b);
}

/// Whether heights have a known unit, which is not the horizontal one.
bool has_own_heights(const ReferenceSystem& system) {
  return system.vertical_metres > 0 && system.vertical_unit != system.unit;
}

/// Systems in other units than metres have no code: it implies the unit.
std::string wkt_of_zone(const UtmZone& zone, const ReferenceSystem& system) {
  const bool in_metres = system.metres == 0 || system.metres == 1;
  const double metres = in_metres ? 1 : system.metres;
  return fmt::format(
      "PROJCS[\"{}\",GEOGCS[\"{}\",DATUM[\"{}\",{}],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433],"
      "AUTHORITY[\"EPSG\",\"{}\"]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],"
      "PARAMETER[\"central_meridian\",{}],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",{:.15g}],"
      "PARAMETER[\"false_northing\",{:.15g}],UNIT[\"{}\",{:.15g}],AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH]{}]",
      utm_name(zone), zone.datum, zone.wkt_datum, zone.spheroid, zone.datum_code, 6 * zone.zone - 183, 500000 / metres,
      (zone.south ? 10000000 : 0) / metres, in_metres ? kMetre : system.unit, metres,
      in_metres ? fmt::format(",AUTHORITY[\"EPSG\",\"{}\"]", system.code) : std::string());
}

/// Whether the text is of the first form, without heights.
bool may_precede_heights(const std::string& text) { return text.starts_with("PROJCS[") || text.starts_with("GEOGCS["); }

/// Compound of a horizontal system and heights of which the unit is known. The name stays: files without codes are
/// compared by it.
std::string with_heights(const std::string& text, const ReferenceSystem& system) {
  std::string name;
  for (const char c : system.name) name.append(c == '"' ? 2 : 1, c);
  return fmt::format(
      "COMPD_CS[\"{}\",{},VERT_CS[\"heights\",VERT_DATUM[\"unknown\",2005],UNIT[\"{}\",{:.15g}],AXIS[\"Up\",UP]{}]]",
      name, text, system.vertical_unit, system.vertical_metres,
      system.vertical_code == 0 ? std::string() : fmt::format(",AUTHORITY[\"EPSG\",\"{}\"]", system.vertical_code));
}

}  // namespace

SharedSystem system_of_text(std::string_view text) {
  text = without_padding(text);
  if (text.empty() || text.size() > kLongestText) return nullptr;
  if (auto system = system_of_code(text)) return std::make_shared<const ReferenceSystem>(std::move(*system));
  const auto root = parse_wkt(text);
  ReferenceSystem system;
  if (!root || !describe_wkt(*root, system)) return nullptr;
  system.wkt = std::string(text);
  return std::make_shared<const ReferenceSystem>(std::move(system));
}

SharedSystem system_of_keys(std::span<const std::uint16_t> keys, std::span<const double> doubles,
                            std::string_view ascii, std::string_view text) {
  auto stated = describe_keys(GeoKeys(keys, doubles, ascii));
  SharedSystem of_text = system_of_text(text);
  if (!stated) return of_text;
  ReferenceSystem system = of_text ? *of_text : *stated;
  if (system.code == 0) system.code = stated->code;
  if (system.vertical_code == 0) system.vertical_code = stated->vertical_code;
  if (system.vertical_unit.empty())
    system.vertical_unit = stated->vertical_unit, system.vertical_metres = stated->vertical_metres;
  system.geo_keys.assign(keys.begin(), keys.end());
  system.geo_doubles.assign(doubles.begin(), doubles.end());
  system.geo_ascii = std::string(ascii);
  return std::make_shared<const ReferenceSystem>(std::move(system));
}

std::string wkt_of(const ReferenceSystem& system) {
  std::string text = system.wkt;
  if (text.empty()) {
    const auto zone = utm_zone(system.code);
    const bool in_metres = system.metres == 0 || system.metres == 1;
    // A code says more about heights than text can be made of, unless the text must state units.
    if (!zone || (system.vertical_code != 0 && in_metres && !has_own_heights(system))) return {};
    text = wkt_of_zone(*zone, system);
  } else if (const SharedSystem stated = system_of_text(text); !stated || !stated->vertical_unit.empty()) {
    return text;
  }
  return has_own_heights(system) && may_precede_heights(text) ? with_heights(text, system) : text;
}

std::string unit_words(const ReferenceSystem& system) {
  std::string words = system.unit.empty() ? "unit unknown" : "unit " + system.unit;
  if (!system.vertical_unit.empty() && system.vertical_unit != system.unit)
    words += ", heights in " + system.vertical_unit;
  return words;
}

std::string system_words(const ReferenceSystem& system) {
  std::string code = system.code == 0 ? std::string() : fmt::format("EPSG:{}", system.code);
  if (system.vertical_code != 0)
    code +=
        code.empty() ? fmt::format("heights EPSG:{}", system.vertical_code) : fmt::format("+{}", system.vertical_code);
  std::string words = system.name.empty() ? code : system.name;
  if (!system.name.empty() && !code.empty()) words += " (" + code + ")";
  if (words.empty()) words = "unnamed system";
  return words + ", " + unit_words(system);
}

bool may_be_equal(const ReferenceSystem* a, const ReferenceSystem* b) {
  if (!a || !b || a == b) return true;
  const auto differ = [](int x, int y) { return x != 0 && y != 0 && x != y; };
  const auto units_differ = [](double x, double y) { return x > 0 && y > 0 && std::abs(x / y - 1) > kSameUnit * 100; };
  if (differ(a->code, b->code) || differ(a->vertical_code, b->vertical_code)) return false;
  if (units_differ(a->metres, b->metres) || units_differ(a->vertical_metres, b->vertical_metres)) return false;
  if ((a->unit == kDegree) != (b->unit == kDegree) && !a->unit.empty() && !b->unit.empty()) return false;
  if (a->code != 0 && a->code == b->code) return true;
  return a->name.empty() || b->name.empty() || plain_name(a->name) == plain_name(b->name);
}

const CommonSystem::Stated* CommonSystem::add(const std::string& name, const SharedSystem& system) {
  if (!system) return nullptr;
  bool is_known = false;
  for (const Stated& s : different_) {
    if (!may_be_equal(s.system.get(), system.get())) return &s;
    is_known = is_known || is_described_alike(*s.system, *system);
  }
  if (!is_known) different_.push_back({name, system});
  return nullptr;
}

SharedSystem CommonSystem::system() const {
  const auto less = [](const Stated& a, const Stated& b) { return knowledge(*a.system) < knowledge(*b.system); };
  const auto most = std::max_element(different_.begin(), different_.end(), less);
  return most == different_.end() ? nullptr : most->system;
}

void require_same_system(const ReferenceSystem* a, std::string_view a_is, const ReferenceSystem* b,
                         std::string_view b_is) {
  if (may_be_equal(a, b)) return;
  throw DataError(
      fmt::format("the coordinate reference systems differ: {} is in {}, {} in {}; coordinates are not converted: "
                  "reproject one of them first",
                  a_is, system_words(*a), b_is, system_words(*b)));
}

}  // namespace sansmesh::inline v1
