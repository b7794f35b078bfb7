#include "sansmesh/io/points/las_reference.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::string_view kProjection = "LASF_Projection";
constexpr std::uint16_t kKeys = 34735, kDoubles = 34736, kAscii = 34737;
constexpr unsigned kWktBit = 16;
constexpr std::size_t kLongestPayload = 0xffff;

template <class T>
std::vector<T> numbers_of(const LasVlr* vlr) {
  if (!vlr) return {};
  std::vector<T> numbers(vlr->payload.size() / sizeof(T));
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = load<T>(&vlr->payload[k * sizeof(T)]);
  return numbers;
}

std::string record_of(std::uint16_t id, std::string_view payload) {
  std::string record(kVlrHead, '\0');
  record.replace(2, kProjection.size(), kProjection);
  std::memcpy(record.data() + 18, &id, 2);
  const auto length = static_cast<std::uint16_t>(payload.size());
  std::memcpy(record.data() + 20, &length, 2);
  record += payload;
  return record;
}

template <class T>
std::string_view bytes_of(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

/// GeoTIFF keys that state the codes and units.
std::vector<std::uint16_t> keys_of_codes(const ReferenceSystem& s) {
  std::vector<std::uint16_t> keys = {1, 1, 0, 0};
  const auto add = [&](std::uint16_t key, int value) {
    keys.insert(keys.end(), {key, 0, 1, static_cast<std::uint16_t>(value)});
    ++keys[3];
  };
  const auto unit = [](const std::string& name) {
    return name == "metre" ? 9001 : name == "foot" ? 9002 : name == "US survey foot" ? 9003 : 0;
  };
  const bool angles = s.unit == "degree";
  add(1024, angles ? 2 : 1), add(1025, 1);
  add(angles ? 2048 : 3072, s.code);
  if (!angles && unit(s.unit) != 0) add(3076, unit(s.unit));
  if (s.vertical_code != 0) add(4096, s.vertical_code);
  if (unit(s.vertical_unit) != 0) add(4099, unit(s.vertical_unit));
  return keys;
}

/// Whether a record has more than padding.
bool states_something(const LasVlr* text, const LasVlr* keys) {
  const auto is_padding = [](char c) { return c == '\0' || c == ' ' || c == '\n'; };
  return (text && !std::all_of(text->payload.begin(), text->payload.end(), is_padding)) ||
         (keys && keys->payload.size() >= 8 && load<std::uint16_t>(&keys->payload[6]) > 0);
}

SharedSystem stated_system(const LasHeader& header) {
  const auto text_of = [&](std::string_view user) {
    const LasVlr* const vlr = header.find(user, kWktRecord);
    return vlr ? vlr->payload : std::string_view();
  };
  const std::string_view text = text_of(kProjection), older = text_of("liblas");
  if ((header.global_encoding & kWktBit) != 0)
    if (SharedSystem system = system_of_text(text)) return system;
  const LasVlr* const ascii = header.find(kProjection, kAscii);
  return system_of_keys(numbers_of<std::uint16_t>(header.find(kProjection, kKeys)),
                        numbers_of<double>(header.find(kProjection, kDoubles)),
                        ascii ? ascii->payload : std::string_view(), system_of_text(text) ? text : older);
}

}  // namespace

SharedSystem las_reference(const Input& in, const LasHeader& header) {
  SharedSystem system = stated_system(header);
  if (!system && states_something(header.find(kProjection, kWktRecord), header.find(kProjection, kKeys)))
    in.unread("a reference system in an unknown form");
  return system;
}

std::vector<std::string> las_reference_records(const ReferenceSystem& system, bool wide) {
  std::vector<std::string> records;
  const std::string wkt = wkt_of(system);
  const bool has_wkt = !wkt.empty() && wkt.size() < kLongestPayload;
  if (has_wkt) records.push_back(record_of(kWktRecord, wkt + '\0'));
  if (wide && has_wkt) return records;
  std::vector<std::uint16_t> keys = system.geo_keys;
  if (keys.empty() && system.code > 0 && system.code < 0xffff && system.vertical_code < 0xffff)
    keys = keys_of_codes(system);
  if (keys.empty() || bytes_of(keys).size() > kLongestPayload ||
      bytes_of(system.geo_doubles).size() > kLongestPayload || system.geo_ascii.size() > kLongestPayload)
    return records;
  records.push_back(record_of(kKeys, bytes_of(keys)));
  if (system.geo_keys.empty()) return records;
  if (!system.geo_doubles.empty()) records.push_back(record_of(kDoubles, bytes_of(system.geo_doubles)));
  if (!system.geo_ascii.empty()) records.push_back(record_of(kAscii, system.geo_ascii));
  return records;
}

}  // namespace sansmesh::inline v1::io
