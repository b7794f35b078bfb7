// E57 (ASTM E2807): scans of terrestrial scanners with their poses.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/io/color_bytes.h"
#include "sansmesh/io/e57/e57_scans.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/frame_view.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::inline v1::io {
namespace {

/// Numbers are decoded in blocks that fit into the nearest cache, several blocks per task.
constexpr std::size_t kDecodedAtOnce = 1024, kDecodedPerTask = std::size_t{1} << 14;
/// Translations of global coordinates are whole multiples of this length; positions of scanners never are.
constexpr double kCoordinateShift = 100;
/// A grid of rows and columns has at most this number of cells per sample.
constexpr std::uint64_t kCellsPerSample = 8;

/// Calls decode(first, n) for blocks of the numbers [0, total).
template <class Decode>
void decode_blocks(std::size_t total, Decode&& decode) {
  parallel_ranges(0, total, kDecodedPerTask, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; i += kDecodedAtOnce) decode(i, std::min(kDecodedAtOnce, to - i));
  });
}

/// Calls use(i, v) with the three numbers of each record.
template <class Use>
void decode_triples(const E57Section& section, const std::array<std::size_t, 3>& fields, std::size_t total, Use&& use) {
  const E57Column columns[] = {section.column(fields[0]), section.column(fields[1]), section.column(fields[2])};
  decode_blocks(total, [&](std::size_t first, std::size_t n) {
    double block[3][kDecodedAtOnce];
    for (std::size_t k = 0; k < 3; ++k) columns[k].reals(first, n, block[k]);
    for (std::size_t i = 0; i < n; ++i) use(first + i, Vec3{block[0][i], block[1][i], block[2][i]});
  });
}

template <class Use>
void decode_whole(const E57Section& section, std::size_t field, std::size_t total, Use&& use) {
  const E57Column column = section.column(field);
  decode_blocks(total, [&](std::size_t first, std::size_t n) {
    std::int64_t block[kDecodedAtOnce];
    column.integers(first, n, block);
    for (std::size_t i = 0; i < n; ++i) use(first + i, block[i]);
  });
}

/// The smallest type that holds all integers of a range.
NumberType whole_type(std::int64_t lowest, std::int64_t highest) {
  const auto fits = [&]<class T>(T) {
    return lowest >= std::int64_t{std::numeric_limits<T>::min()} &&
           highest <= std::int64_t{std::numeric_limits<T>::max()};
  };
  if (fits(std::uint8_t{})) return NumberType::u8;
  if (fits(std::int8_t{})) return NumberType::i8;
  if (fits(std::uint16_t{})) return NumberType::u16;
  if (fits(std::int16_t{})) return NumberType::i16;
  if (fits(std::uint32_t{})) return NumberType::u32;
  if (fits(std::int32_t{})) return NumberType::i32;
  return NumberType::i64;
}

/// Names of the attributes; empty for fields that are used otherwise. Names of LAS are used where the meaning is equal.
std::string attribute_name(const std::string& field) {
  static constexpr std::pair<std::string_view, std::string_view> names[] = {{"rowIndex", "row"},
                                                                            {"columnIndex", "column"},
                                                                            {"returnIndex", "return_number"},
                                                                            {"returnCount", "number_of_returns"},
                                                                            {"timeStamp", "time_stamp"},
                                                                            {"isIntensityInvalid", ""},
                                                                            {"isColorInvalid", ""},
                                                                            {"isTimeStampInvalid", ""},
                                                                            {"cartesianInvalidState", ""},
                                                                            {"sphericalInvalidState", ""}};
  for (const auto& [from, to] : names)
    if (field == from) return std::string(to);
  return field;
}

class E57Reader {
 public:
  E57Reader(const Input& in, const E57Pages& pages, E57Content content)
      : in_(in), pages_(pages), content_(std::move(content)), bytes_left_(in.bytes.size()) {}

  PointSet read() {
    const std::vector<E57Scan>& scans = content_.scans;
    if (scans.empty()) in_.fail("holds no points");
    std::uint64_t total = 0;
    for (const E57Scan& scan : scans) {
      total += std::min<std::uint64_t>(scan.records, 0xffffffffu);
      if (total > 0xfffffffeu)
        in_.fail(fmt::format("holds {} points up to scan {}; at most 4,294,967,294 are supported",
                             grouped(std::max(total, scan.records)), scan.name));
    }
    if (scans.size() >= PointSet::kUnknownScan) in_.fail("more than 65,534 scans");
    // Eight points a byte are possible, but only in files that are not worth a reservation.
    if (total <= in_.bytes.size()) world_.reserve(static_cast<std::size_t>(total));
    for (const E57Scan& scan : scans) read_scan(scan);
    return assemble();
  }

 private:
  void read_scan(const E57Scan& scan) {
    const E57Section section(in_, pages_, scan.offset, scan.records, scan.fields, scan.name);
    // Scans that share bytes could have any number of points in a small file.
    if (section.size() > bytes_left_)
      in_.fail(fmt::format("malformed E57: the points of scan {} overlap those of other scans", scan.name));
    bytes_left_ -= section.size();
    const auto n = static_cast<std::size_t>(scan.records);
    const std::size_t first = world_.size();
    world_.resize(first + n);
    sizes_.push_back(n);
    const bool spherical = read_positions(scan, section, n, &world_[first]);
    find_scanner(scan, section, spherical, std::span<const Vec3>(world_).subspan(first));
    colors_ += read_colors(scan, section, n, first);
    normals_ += read_normals(scan, section, n, first);
    tables_.push_back(read_attributes(scan, section, n));
  }

  /// Positions, and which of them are marked as invalid. Returns whether they are spherical coordinates.
  bool read_positions(const E57Scan& scan, const E57Section& section, std::size_t n, Vec3* out) {
    const E57Pose pose = scan.pose.value_or(E57Pose{});
    const bool moved = scan.pose && (pose.is_rotated() || pose.translation != Vec3{});
    const auto cartesian = scan.find("cartesianX", "cartesianY", "cartesianZ");
    const auto spherical = scan.find("sphericalRange", "sphericalAzimuth", "sphericalElevation");
    if (cartesian) {
      decode_triples(section, *cartesian, n, [&](std::size_t i, const Vec3& p) { out[i] = moved ? pose.apply(p) : p; });
    } else if (spherical) {
      decode_triples(section, *spherical, n, [&](std::size_t i, const Vec3& p) {
        const double flat = p.x * std::cos(p.z);
        const Vec3 q{flat * std::cos(p.y), flat * std::sin(p.y), p.x * std::sin(p.z)};
        out[i] = moved ? pose.apply(q) : q;
      });
    } else {
      in_.fail(fmt::format("scan {} has neither Cartesian nor spherical coordinates", scan.name));
    }
    if (const auto state = scan.find(cartesian ? "cartesianInvalidState" : "sphericalInvalidState");
        state && scan.fields[*state].is_whole()) {
      if (invalid_.size() < world_.size()) invalid_.resize(world_.size());
      std::uint8_t* const invalid = invalid_.data() + (world_.size() - n);
      decode_whole(section, *state, n, [&](std::size_t i, std::int64_t s) { invalid[i] = s != 0; });
    }
    return !cartesian;
  }

  /// The scanner is at the origin of a scan's own coordinates if these are spherical or the scan has a pose that can be
  /// a scanner's, or if the samples, in rows and columns, are seen from there. Programs also write registered scans
  /// without a pose, and shifts of global coordinates as poses.
  void find_scanner(const E57Scan& scan, const E57Section& section, bool spherical, std::span<const Vec3> world) {
    const Vec3 eye = scan.pose ? scan.pose->translation : Vec3{};
    bool is_known = spherical;
    if (scan.pose && !is_known) {
      is_known = scan.pose->is_rotated();
      for (std::size_t k = 0; k < 3; ++k) is_known |= std::fmod(eye[k], kCoordinateShift) != 0;
    }
    if (!is_known) is_known = is_seen_from(scan, section, eye, world);
    if (is_known) eyes_.push_back(eye);
    eye_known_.push_back(is_known);
  }

  bool is_seen_from(const E57Scan& scan, const E57Section& section, const Vec3& eye,
                    std::span<const Vec3> world) const {
    const auto row = scan.find("rowIndex"), column = scan.find("columnIndex");
    if (!row || !column || !scan.fields[*row].is_whole() || !scan.fields[*column].is_whole()) return false;
    const std::size_t n = world.size();
    std::vector<std::int64_t> rows(n), columns(n);
    decode_whole(section, *row, n, [&](std::size_t i, std::int64_t r) { rows[i] = r; });
    decode_whole(section, *column, n, [&](std::size_t i, std::int64_t c) { columns[i] = c; });
    const auto [top, bottom] = std::minmax_element(rows.begin(), rows.end());
    const auto [left, right] = std::minmax_element(columns.begin(), columns.end());
    const std::uint64_t height = static_cast<std::uint64_t>(*bottom) - static_cast<std::uint64_t>(*top) + 1,
                        width = static_cast<std::uint64_t>(*right) - static_cast<std::uint64_t>(*left) + 1;
    if (height < 2 || width < 2 || height > kCellsPerSample * n || width > kCellsPerSample * n / height) return false;
    const bool has_states = invalid_.size() == world_.size();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3f> grid(static_cast<std::size_t>(height * width), Vec3f{nan, nan, nan});
    for (std::size_t i = 0; i < n; ++i) {
      if (has_states && invalid_[world_.size() - n + i] != 0) continue;
      const std::uint64_t cell =
          static_cast<std::uint64_t>(rows[i] - *top) * width + static_cast<std::uint64_t>(columns[i] - *left);
      grid[static_cast<std::size_t>(cell)] = Vec3f(world[i] - eye);
    }
    const auto view = measure_frame(grid, static_cast<std::size_t>(width), Vec3f{});
    return view && view->seen_from_eye;
  }

  bool read_colors(const E57Scan& scan, const E57Section& section, std::size_t n, std::size_t first) {
    const auto fields = scan.find("colorRed", "colorGreen", "colorBlue");
    if (!fields) return false;
    double least[3], scale[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const E57Field& f = scan.fields[(*fields)[k]];
      double largest = 255;
      least[k] = 0;
      if (const auto& limits = scan.color_limits[k])
        least[k] = (*limits)[0], largest = (*limits)[1];
      else if (f.least && *f.largest > *f.least)
        least[k] = *f.least, largest = *f.largest;
      else if (!f.is_whole())
        largest = 1;
      scale[k] = 255 / (largest - least[k]);
    }
    all_.colors.resize(first + n);
    decode_triples(section, *fields, n, [&](std::size_t i, const Vec3& c) {
      all_.colors[first + i] = {to_byte(c.x - least[0], scale[0]), to_byte(c.y - least[1], scale[1]),
                                to_byte(c.z - least[2], scale[2])};
    });
    return true;
  }

  bool read_normals(const E57Scan& scan, const E57Section& section, std::size_t n, std::size_t first) {
    const auto fields = scan.find("nor:normalX", "nor:normalY", "nor:normalZ");
    if (!fields) return false;
    const E57Pose pose = scan.pose.value_or(E57Pose{});
    all_.normals.resize(first + n);
    decode_triples(section, *fields, n, [&](std::size_t i, const Vec3& v) {
      all_.normals[first + i] = Vec3f(pose.is_rotated() ? pose.rotate(v) : v);
    });
    return true;
  }

  AttributeTable read_attributes(const E57Scan& scan, const E57Section& section, std::size_t n) {
    AttributeTable table;
    for (std::size_t f = 0; f < scan.fields.size(); ++f) {
      const E57Field& field = scan.fields[f];
      const std::string& name = field.name;
      if (field.kind == E57Kind::text) {
        note_unread("texts of points");
        continue;
      }
      if (name.starts_with("is") && name.ends_with("Invalid") && field.bits() > 0)
        note_unread("flags of invalid colours, intensities and times");
      const bool used = name.starts_with("cartesian") || name.starts_with("spherical") || name.starts_with("color") ||
                        name.starts_with("nor:normal");
      const std::string as = used ? std::string() : attribute_name(name);
      // A constant field has no data of samples.
      if (as.empty() || field.bits() == 0 || table.find(as)) continue;
      table.set(read_attribute(field, section.column(f), as, n));
    }
    return table;
  }

  static Attribute read_attribute(const E57Field& field, const E57Column& column, const std::string& name,
                                  std::size_t n) {
    // Returns count from 0 here, and from 1 in LAS and in this library.
    const std::int64_t shift = field.name == "returnIndex" ? 1 : 0;
    const std::int64_t highest = std::min(field.highest, std::numeric_limits<std::int64_t>::max() - shift) + shift;
    const NumberType type = field.kind == E57Kind::integer  ? whole_type(field.lowest, highest)
                            : field.kind == E57Kind::real32 ? NumberType::f32
                                                            : NumberType::f64;
    Attribute a{name, empty_values(type), 1};
    std::visit(
        [&](auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          values.resize(n);
          decode_blocks(n, [&](std::size_t first, std::size_t count) {
            if constexpr (std::is_floating_point_v<T>) {
              double block[kDecodedAtOnce];
              column.reals(first, count, block);
              for (std::size_t i = 0; i < count; ++i)
                values[first + i] = static_cast<T>(block[i] + static_cast<double>(shift));
            } else {
              std::int64_t block[kDecodedAtOnce];
              column.integers(first, count, block);
              const auto more = static_cast<std::uint64_t>(shift);
              for (std::size_t i = 0; i < count; ++i)
                values[first + i] = static_cast<T>(static_cast<std::uint64_t>(block[i]) + more);
            }
          });
        },
        a.values);
    return a;
  }

  void note_unread(const std::string& what) {
    if (std::find(in_.report.unread.begin(), in_.report.unread.end(), what) == in_.report.unread.end())
      in_.unread(what);
  }

  PointSet assemble() {
    const std::size_t n = world_.size(), scans = sizes_.size();
    in_.report.format = fmt::format("E57, {}", counted(scans, "scan"));
    if (content_.empty_scans > 0) in_.warn(fmt::format("{} without points", counted(content_.empty_scans, "scan")));
    if (content_.pictures > 0) in_.unread(counted(content_.pictures, "picture"));
    number_scans();
    drop_partial(all_.colors, colors_, "colours");
    drop_partial(all_.normals, normals_, "normals");
    std::vector<const AttributeTable*> tables;
    tables.reserve(tables_.size());
    for (const AttributeTable& table : tables_) tables.push_back(&table);
    all_.attributes = join_rows(tables, sizes_);
    tables_.clear();
    // Invalid points, mostly zeros, must not decide on the origin of survey coordinates.
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    store_positions(in_, all_, n, [&](std::size_t i) {
      return i < invalid_.size() && invalid_[i] != 0 ? Vec3{nan, nan, nan} : world_[i];
    });
    std::vector<Vec3>().swap(world_);
    for (const Vec3& eye : eyes_) all_.scanners.push_back(Vec3f(eye - all_.origin));
    drop_invalid();
    finish(in_, all_);
    all_.reference = system_of_text(content_.reference_system);
    if (!all_.reference && !content_.reference_system.empty()) in_.unread("a reference system that is no WKT");
    return std::move(all_);
  }

  /// Scans with a known scanner have the first numbers.
  void number_scans() {
    const std::size_t scans = sizes_.size();
    all_.scan_names.resize(scans);
    all_.scan_of_point.reserve(world_.size());
    std::size_t with_eye = 0, without = eyes_.size();
    for (std::size_t s = 0; s < scans; ++s) {
      const std::size_t number = eye_known_[s] ? with_eye++ : without++;
      all_.scan_names[number] = content_.scans[s].name;
      all_.scan_of_point.insert(all_.scan_of_point.end(), sizes_[s], static_cast<std::uint16_t>(number));
    }
  }

  /// Leaves out an array that only some scans have.
  template <class T>
  void drop_partial(std::vector<T>& array, std::size_t scans_with, const char* what) const {
    if (scans_with == sizes_.size()) return;
    array.clear();
    if (scans_with > 0) in_.warn(fmt::format("only {} of {} scans have {}: left out", scans_with, sizes_.size(), what));
  }

  void drop_invalid() {
    const auto bad = static_cast<std::size_t>(std::count(invalid_.begin(), invalid_.end(), 1));
    if (bad == 0) return;
    const std::size_t n = all_.size();
    if (bad == n) in_.fail(fmt::format("holds no points: all {} are marked as invalid", grouped(n)));
    invalid_.resize(n);
    remove_samples(all_, invalid_);
    in_.warn(
        fmt::format("{} of {} points are marked as invalid (no return) and were left out", grouped(bad), grouped(n)));
  }

  const Input& in_;
  const E57Pages& pages_;
  E57Content content_;
  PointSet all_;
  std::vector<Vec3> world_;
  std::vector<std::uint8_t> invalid_;  ///< shorter than world_ if no further scan has invalid points
  std::vector<std::size_t> sizes_;     ///< records of each scan
  std::vector<Vec3> eyes_;             ///< known scanner positions
  std::vector<bool> eye_known_;        ///< a value per scan
  std::vector<AttributeTable> tables_;
  std::uint64_t bytes_left_;              ///< bytes of the file that no section of points has used
  std::size_t colors_ = 0, normals_ = 0;  ///< scans that have them
};

}  // namespace

PointSet read_e57(const Input& in) {
  const E57Pages pages(in);
  const E57Bytes xml = pages.xml();
  return E57Reader(in, pages, describe_scans(in, xml.view())).read();
}

}  // namespace sansmesh::inline v1::io
