// LAS and LAZ output: version 1.2 if its point formats hold everything, else 1.4. Attributes without a field in a
// record become "extra bytes", which the header describes.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/laz/copc_tree.h"
#include "sansmesh/io/laz/write_laz.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/points/las_reference.h"

namespace sansmesh::inline v1::io {

using laz::LasSteps;

namespace {

/// Attributes with a field in the record; null if they are missing or do not fit.
struct LasFields {
  const Attribute *intensity, *return_number, *returns, *classification, *synthetic, *overlap, *scan_angle, *source,
      *user_data, *time, *infrared;

  std::array<const Attribute*, 11> all() const {
    return {intensity,  return_number, returns,   classification, synthetic, overlap,
            scan_angle, source,        user_data, time,           infrared};
  }
};

/// The attribute of that name if it consists of integers in 0..most.
const Attribute* whole_attribute(const AttributeTable& table, const char* name, double most) {
  const Attribute* const a = table.find(name);
  if (!a || a->components != 1 || is_real(a->type())) return nullptr;
  for (std::size_t i = 0; i < a->size(); ++i)
    if (!(a->number(i) >= 0 && a->number(i) <= most)) return nullptr;
  return a;
}

constexpr double kAngleStep = 0.006;  // degrees, of formats from 6 on

/// Angles must be exactly representable: whole degrees in the older formats, multiples of the step in the others. Other
/// programs read the field, not extra bytes: octrees, which have no older format, round angles.
const Attribute* angle_attribute(const AttributeTable& table, bool wide, bool rounded) {
  const Attribute* const a = table.find("scan_angle");
  if (!a || a->components != 1) return nullptr;
  for (std::size_t i = 0; i < a->size(); ++i) {
    const double v = a->number(i), steps = std::round(v / kAngleStep);
    const bool fits =
        wide ? std::abs(steps) <= 30000 && (rounded || static_cast<float>(kAngleStep * steps) == static_cast<float>(v))
             : v == std::round(v) && v >= -128 && v <= 127;
    if (!fits) return nullptr;
  }
  return a;
}

LasFields las_fields(const AttributeTable& table, bool wide, bool octree = false) {
  const auto whole = [&](const char* name, double most) { return whole_attribute(table, name, most); };
  const Attribute* const time = table.find("gps_time");
  return {.intensity = whole("intensity", 65535),
          .return_number = whole("return_number", wide ? 15 : 7),
          .returns = whole("number_of_returns", wide ? 15 : 7),
          .classification = whole("classification", wide ? 255 : 31),
          .synthetic = whole("synthetic", 1),
          .overlap = wide ? whole("overlap", 1) : nullptr,
          .scan_angle = angle_attribute(table, wide, octree),
          .source = whole("point_source_id", 65535),
          .user_data = whole("user_data", 255),
          .time = time && time->components == 1 && time->type() == NumberType::f64 ? time : nullptr,
          .infrared = wide ? whole("near_infrared", 65535) : nullptr};
}

/// Whether the older point formats have fields for the same attributes as the newer ones.
bool older_do(const AttributeTable& table) {
  const auto older = las_fields(table, false).all(), newer = las_fields(table, true).all();
  for (std::size_t k = 0; k < older.size(); ++k)
    if (newer[k] && !older[k]) return false;
  return true;
}

/// Numbers after those of the point format: one to three, one in octrees, since programs that read these know no more.
struct ExtraBytes {
  const Attribute* attribute;
  std::size_t first, components;
  std::string name;
};

std::vector<ExtraBytes> extra_bytes(const AttributeTable& table, const LasFields& fields, std::size_t most) {
  std::vector<ExtraBytes> extras;
  const auto placed = fields.all();
  for (const Attribute& a : table) {
    if (std::find(placed.begin(), placed.end(), &a) != placed.end()) continue;
    if (a.components <= most) {
      extras.push_back({&a, 0, a.components, a.name});
      continue;
    }
    for (std::size_t c = 0; c < a.components; ++c) extras.push_back({&a, c, 1, a.name + "_" + std::to_string(c)});
  }
  return extras;
}

/// 10 to an integer power.
double power_of_ten(int power) {
  const std::string text = "1e" + std::to_string(power);
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Scale and offset of the 32-bit coordinates.
struct LasScale {
  Vec3 offset;
  double step = 0.001;
  Box3 box;  ///< box of the written points
};

/// Whether all coordinates are multiples of a step, up to the rounding of the cloud's floats.
bool is_on_grid(const PointSet& points, const Vec3& offset, double step) {
  return parallel_reduce(
      points.size(), 1 << 15, true,
      [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          for (std::size_t k = 0; k < 3; ++k) {
            const double p = static_cast<double>(points.positions[i][k]), x = points.origin[k] + p;
            const double rounding = std::abs(p) * 0x1p-24 + std::abs(x) * 0x1p-50;
            if (std::abs(std::remainder(x - offset[k], step)) > rounding) return false;
          }
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

/// The largest step of 1, 1/2 or 1/4 decimal unit of which all coordinates are multiples, as in most surveys: their
/// integers stay as they were, and compress well. Otherwise a step below the resolution of the cloud's floats: less
/// than a quarter of the difference of adjacent floats at its edge. 2^31 steps reach far beyond the cloud.
LasScale las_scale(const PointSet& points) {
  LasScale s;
  for (const Vec3f& p : points.positions) {
    if (!is_finite(p)) throw ArgumentError("LAS cannot hold positions that are not finite");
    s.box.extend(points.origin + Vec3(p));
  }
  if (s.box.empty()) return s;
  double extent = 0, farthest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    extent = std::max(extent, s.box.upper[k] - s.box.lower[k]);
    farthest = std::max({farthest, std::abs(s.box.upper[k]), std::abs(s.box.lower[k])});
  }
  extent = std::max(extent, farthest * 1e-9);
  const int finest = extent > 0 ? index_in<int>(std::floor(std::log10(extent * 0x1p-26)), -300, 300) : -3;
  const double coarse = power_of_ten(finest) * 1e7;
  for (std::size_t k = 0; k < 3; ++k) s.offset[k] = std::round(s.box.center()[k] / coarse) * coarse;
  for (int power = finest + 7; power > finest; --power)
    for (const double part : {1.0, 0.5, 0.25})
      if (s.step = part * power_of_ten(power); is_on_grid(points, s.offset, s.step)) return s;
  s.step = power_of_ten(finest);
  return s;
}

template <class T>
void put_at(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
T value_of(const Attribute* a, std::size_t i) {
  return a ? static_cast<T>(a->number(i)) : T{};
}

constexpr std::size_t kWideHeaderBytes = 375;
constexpr std::size_t kDescribed = 192, kMostDescribed = 340;

/// The header's records that describe the extra bytes.
std::string describe_extras(const std::vector<ExtraBytes>& extras) {
  constexpr std::uint8_t codes[] = {2, 1, 4, 3, 6, 5, 8, 7, 9, 10};  // in the order of NumberType
  std::string all;
  for (std::size_t first = 0; first < extras.size(); first += kMostDescribed) {
    const std::size_t count = std::min(kMostDescribed, extras.size() - first);
    std::string record(kVlrHead + count * kDescribed, '\0');
    record.replace(2, 9, "LASF_Spec");
    put_at(record, 18, std::uint16_t{4});
    put_at(record, 20, static_cast<std::uint16_t>(count * kDescribed));
    for (std::size_t k = 0; k < count; ++k) {
      const ExtraBytes& e = extras[first + k];
      const std::size_t at = kVlrHead + k * kDescribed;
      record[at + 2] =
          static_cast<char>(codes[static_cast<std::size_t>(e.attribute->type())] + 10 * (e.components - 1));
      record.replace(at + 4, std::min<std::size_t>(32, e.name.size()), e.name, 0, 32);
    }
    all += record;
  }
  return all;
}

/// Format of the records and their contents.
struct LasLayout {
  bool wide = false, colors = false;  ///< `wide`: LAS 1.4
  unsigned format = 0;
  std::size_t record = 0;  ///< bytes
  LasFields fields;
  std::vector<ExtraBytes> extras;
  LasScale scale;
};

LasLayout las_layout(const PointSet& points, bool octree = false) {
  LasLayout l;
  l.wide = octree || !older_do(points.attributes), l.colors = points.has_colors();
  l.fields = las_fields(points.attributes, l.wide, octree);
  l.extras = extra_bytes(points.attributes, l.fields, octree ? 1 : 3);
  const unsigned colors = l.colors ? 2 : 0;
  l.format = l.wide ? (l.fields.infrared ? 8 : l.colors ? 7 : 6) : (l.fields.time ? 1u : 0u) + colors;
  l.record = kLasRecordBytes[l.format];
  for (const ExtraBytes& e : l.extras) l.record += e.components * size_of(e.attribute->type());
  if (l.record > 0xffff)
    throw ArgumentError("LAS holds at most 65,535 bytes of a point, not " + grouped(l.record) + "; write a PLY file");
  l.scale = las_scale(points);
  return l;
}

/// The header with the descriptions of extra bytes.
std::string las_header(const LasLayout& l, std::size_t n, const ReferenceSystem* reference) {
  const LasFields& f = l.fields;
  const LasScale& scale = l.scale;
  std::string header(l.wide ? kWideHeaderBytes : kLasHeaderBytes, '\0');
  std::string described = describe_extras(l.extras);
  const std::vector<std::string> system =
      reference ? las_reference_records(*reference, l.wide) : std::vector<std::string>();
  // The wide formats require the bit for WKT, unless there are only GeoTIFF keys.
  bool is_wkt = l.wide && system.empty();
  for (const std::string& record : system) {
    described += record;
    is_wkt |= l.wide && load<std::uint16_t>(record.data() + 18) == kWktRecord;
  }
  header.replace(0, 4, "LASF");
  header[24] = 1, header[25] = l.wide ? 4 : 2;
  header.replace(26, 5, "OTHER"), header.replace(58, 8, "sansmesh");
  // Times outside of a week are adjusted standard times, which are negative before September 2011.
  bool beyond = false;
  for (std::size_t i = 0; f.time && i < n; ++i) beyond |= !(f.time->number(i) >= 0 && f.time->number(i) <= 7 * 86400);
  put_at(header, 6, static_cast<std::uint16_t>((beyond ? 1 : 0) | (is_wkt ? 16 : 0)));
  put_at(header, 94, static_cast<std::uint16_t>(header.size()));
  put_at(header, 96, static_cast<std::uint32_t>(header.size() + described.size()));
  put_at(header, 100,
         static_cast<std::uint32_t>((l.extras.size() + kMostDescribed - 1) / kMostDescribed + system.size()));
  header[104] = static_cast<char>(l.format);
  put_at(header, 105, static_cast<std::uint16_t>(l.record));
  std::array<std::uint64_t, 16> of_return{};
  for (std::size_t i = 0; i < n; ++i) ++of_return[value_of<std::size_t>(f.return_number, i) & 15];
  if (l.wide)
    put_at(header, 247, std::uint64_t{n});
  else
    put_at(header, 107, static_cast<std::uint32_t>(n));
  for (std::size_t k = 1; k <= (l.wide ? 15u : 5u); ++k) {
    if (l.wide)
      put_at(header, 255 + 8 * (k - 1), of_return[k]);
    else
      put_at(header, 111 + 4 * (k - 1), static_cast<std::uint32_t>(of_return[k]));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    // From the rounded coordinates in the records: no point may be outside.
    const auto recorded = [&](double x) {
      return static_cast<double>(std::llround((x - scale.offset[k]) / scale.step)) * scale.step + scale.offset[k];
    };
    put_at(header, 131 + 8 * k, scale.step), put_at(header, 155 + 8 * k, scale.offset[k]);
    put_at(header, 179 + 16 * k, n > 0 ? recorded(scale.box.upper[k]) : 0);
    put_at(header, 187 + 16 * k, n > 0 ? recorded(scale.box.lower[k]) : 0);
  }
  return header + described;
}

LasSteps las_steps(const LasLayout& l, const PointSet& points, std::size_t i) {
  const Vec3 x = points.origin + Vec3(points.positions[i]);
  LasSteps steps;
  for (std::size_t k = 0; k < 3; ++k)
    steps[k] = whole_part<std::int32_t>(std::round((x[k] - l.scale.offset[k]) / l.scale.step));
  return steps;
}

/// Writes the record of point i; returns its end.
char* put_las_record(const LasLayout& l, const PointSet& points, std::size_t i, char* p) {
  const LasFields& f = l.fields;
  for (const std::int32_t step : las_steps(l, points, i)) p = put_bytes(p, step);
  p = put_bytes(p, value_of<std::uint16_t>(f.intensity, i));
  const auto number = value_of<unsigned>(f.return_number, i), returns = value_of<unsigned>(f.returns, i);
  const auto flags = value_of<unsigned>(f.synthetic, i);
  const auto category = value_of<unsigned>(f.classification, i);
  const auto byte = [&](unsigned value) { p = put_bytes(p, static_cast<std::uint8_t>(value)); };
  if (l.wide) {
    byte(number | returns << 4), byte(flags | value_of<unsigned>(f.overlap, i) << 3), byte(category);
    byte(value_of<unsigned>(f.user_data, i));
    p = put_bytes(p, static_cast<std::int16_t>(std::lround(value_of<double>(f.scan_angle, i) / kAngleStep)));
  } else {
    byte(number | returns << 3), byte(category | flags << 5);
    p = put_bytes(p, static_cast<std::int8_t>(value_of<double>(f.scan_angle, i)));
    byte(value_of<unsigned>(f.user_data, i));
  }
  p = put_bytes(p, value_of<std::uint16_t>(f.source, i));
  if (l.wide || f.time) p = put_bytes(p, value_of<double>(f.time, i));
  for (std::size_t k = 0; l.format != 6 && (l.colors || l.wide) && k < 3; ++k)
    p = put_bytes(p, static_cast<std::uint16_t>(l.colors ? points.colors[i][k] << 8 : 0));
  if (f.infrared) p = put_bytes(p, value_of<std::uint16_t>(f.infrared, i));
  for (const ExtraBytes& e : l.extras)
    std::visit(
        [&](const auto& values) {
          for (std::size_t c = 0; c < e.components; ++c)
            p = put_bytes(p, values[i * e.attribute->components + e.first + c]);
        },
        e.attribute->values);
  return p;
}

}  // namespace

std::vector<std::string> points_to_las(const PointSet& points, const WriteOptions&) {
  const LasLayout l = las_layout(points);
  std::vector<std::string> parts{las_header(l, points.size(), points.reference.get())};
  append_rows(parts, points.size(), l.record, [&](std::size_t i, char* p) { return put_las_record(l, points, i, p); });
  return parts;
}

namespace {

/// Range of times, for the description of the octree.
void set_times(const LasLayout& l, std::size_t n, laz::CopcDescription& d) {
  if (!l.fields.time || n == 0) return;
  d.first_time = d.last_time = l.fields.time->number(0);
  for (std::size_t i = 1; i < n; ++i) {
    const double t = l.fields.time->number(i);
    d.first_time = std::min(d.first_time, t), d.last_time = std::max(d.last_time, t);
  }
}

}  // namespace

std::vector<std::string> points_to_copc(const PointSet& points, const WriteOptions&) {
  const LasLayout l = las_layout(points, true);
  laz::LazLayout packed = laz::laz_layout(l.format, l.record);
  packed.chunk_points = laz::kVariableChunks;
  std::vector<LasSteps> steps(points.size());
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = las_steps(l, points, i);
  const laz::CopcTree tree = laz::make_copc_tree(steps);
  std::vector<std::uint32_t> order;
  std::vector<std::size_t> first{0};
  for (const laz::CopcNode& node : tree.nodes) {
    order.insert(order.end(), node.points.begin(), node.points.end());
    first.push_back(order.size());
  }
  std::string header = las_header(l, points.size(), points.reference.get());
  // The description of the octree comes first.
  header.insert(kWideHeaderBytes, laz::kCopcVlrBytes, '\0');
  header += laz::laz_vlr(packed);
  std::vector<std::string> parts =
      laz::laz_chunks(packed, first, header.size(), [&](std::size_t a, std::size_t b, char* p) {
        for (std::size_t k = a; k < b; ++k) p = put_las_record(l, points, order[k], p);
      });
  std::vector<laz::CopcChunk> chunks;
  std::uint64_t at = header.size() + parts[0].size();
  for (std::size_t k = 0; k < tree.nodes.size(); ++k) {
    chunks.push_back({at, parts[k + 1].size()});
    at += parts[k + 1].size();
  }
  at += parts.back().size();
  const std::string page = laz::copc_page(tree.nodes, chunks), head = laz::copc_evlr_head(page.size());
  laz::CopcDescription d{l.scale.offset + tree.center * l.scale.step, tree.half_size * l.scale.step,
                         tree.spacing * l.scale.step, at + head.size(), page.size()};
  set_times(l, points.size(), d);
  header.replace(kWideHeaderBytes, laz::kCopcVlrBytes, laz::copc_vlr(d));
  header[104] = static_cast<char>(l.format | 0x80);
  put_at(header, 96, static_cast<std::uint32_t>(header.size()));
  put_at(header, 100, load<std::uint32_t>(header.data() + 100) + 2);
  put_at(header, 235, at), put_at(header, 243, std::uint32_t{1});
  parts.insert(parts.begin(), std::move(header));
  parts.push_back(head + page);
  return parts;
}

std::vector<std::string> points_to_laz(const PointSet& points, const WriteOptions&) {
  const LasLayout l = las_layout(points);
  const laz::LazLayout packed = laz::laz_layout(l.format, l.record);
  std::vector<std::string> parts{las_header(l, points.size(), points.reference.get()) + laz::laz_vlr(packed)};
  std::string& header = parts[0];
  header[104] = static_cast<char>(l.format | 0x80);
  put_at(header, 96, static_cast<std::uint32_t>(header.size()));
  put_at(header, 100, load<std::uint32_t>(header.data() + 100) + 1);
  std::vector<std::string> rest =
      laz::laz_points(packed, points.size(), header.size(), [&](std::size_t first, std::size_t last, char* p) {
        for (std::size_t i = first; i < last; ++i) p = put_las_record(l, points, i, p);
      });
  std::move(rest.begin(), rest.end(), std::back_inserter(parts));
  return parts;
}

}  // namespace sansmesh::inline v1::io
