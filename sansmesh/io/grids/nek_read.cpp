// Nek5000: spectral elements, each a grid of Gauss–Lobatto–Legendre points, in one file (or several parts) per step; a
// text file names the files of a series.
// Layout: Neko's documentation, appendix "Neko .fld field format"; Nek5000 users' list, November 2013 (P. Fischer).
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/grids/header_fields.h"
#include "sansmesh/io/grids/time_steps.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kNekHeader = 132;  ///< bytes of text, before a float that shows the byte order
constexpr double kNekTest = 6.54321;

struct NekHeader {
  std::size_t real = 4;               ///< bytes per number
  std::array<std::size_t, 3> dims{};  ///< points per element
  std::uint64_t elements = 0;         ///< in this file
  std::uint64_t all = 0;              ///< in the step
  std::size_t part = 0, parts = 1;    ///< number of this file, and of files per step
  double time = 0;
  bool coordinates = false, velocity = false, pressure = false, temperature = false;
  std::size_t scalars = 0;
  bool swap = false;

  std::size_t axes() const { return dims[2] > 1 ? 3 : 2; }
  std::size_t points() const { return dims[0] * dims[1] * dims[2]; }  ///< per element
  /// Numbers per point.
  std::size_t numbers() const {
    return (coordinates ? axes() : 0) + (velocity ? axes() : 0) + pressure + temperature + scalars;
  }
  /// Whether the numbers of both can be joined: the parts of a step.
  bool laid_out_as(const NekHeader& other) const {
    const auto layout = [](const NekHeader& h) {
      return std::tie(h.real, h.dims, h.all, h.parts, h.coordinates, h.velocity, h.pressure, h.temperature, h.scalars);
    };
    return layout(*this) == layout(other);
  }
};

/// The letters of the available fields: X, U, P, T, S and two digits.
void parse_nek_fields(const Input& in, std::string_view code, NekHeader& h) {
  for (std::size_t k = 0; k < code.size(); ++k) {
    if (code[k] == 'X') {
      h.coordinates = true;
    } else if (code[k] == 'U') {
      h.velocity = true;
    } else if (code[k] == 'P') {
      h.pressure = true;
    } else if (code[k] == 'T') {
      h.temperature = true;
    } else if (TextScanner digits(code.substr(std::min(k + 1, code.size()), 2)); code[k] == 'S') {
      if (!digits.number(h.scalars)) in.fail("its header has no number of scalars");
      k = static_cast<std::size_t>(digits.position() - code.data()) - 1;
    } else {
      in.fail(fmt::format("its header names an unknown field: '{}'", code.substr(k, 1)));
    }
  }
}

NekHeader parse_nek_header(const Input& in) {
  if (!in.bytes.starts_with("#std")) in.fail("does not begin with '#std', as fields of Nek5000 do");
  if (in.bytes.size() < kNekHeader + 4) in.fail_truncated(kNekHeader + 4 - in.bytes.size(), true);
  NekHeader h;
  TextScanner s(in.bytes.substr(4, kNekHeader - 4));
  std::int64_t step = 0;
  if (!s.number(h.real) || !s.number(h.dims[0]) || !s.number(h.dims[1]) || !s.number(h.dims[2]) ||
      !s.number(h.elements) || !s.number(h.all) || !s.number(h.time) || !s.number(step) || !s.number(h.part) ||
      !s.number(h.parts))
    in.fail("its header cannot be understood: numbers are missing");
  if (h.real != 4 && h.real != 8) in.fail(fmt::format("its header gives numbers of {} bytes, not 4 or 8", h.real));
  if (h.dims[0] < 2 || h.dims[1] < 2 || h.dims[2] < 1 || std::max({h.dims[0], h.dims[1], h.dims[2]}) > 1000)
    in.fail(fmt::format("its header gives elements of {} x {} x {} points", h.dims[0], h.dims[1], h.dims[2]));
  if (h.elements == 0) in.fail("its header gives no elements");
  if (h.parts < 1) h.parts = 1;
  parse_nek_fields(in, s.word(), h);
  const char* const test = in.bytes.data() + kNekHeader;
  const auto fits = [](float v) { return std::abs(static_cast<double>(v) - kNekTest) < 1e-4; };
  if (!fits(load<float>(test))) {
    if (!fits(load<float, true>(test))) in.fail("the number behind its header is 6.54321 in no byte order");
    h.swap = true;
  }
  return h;
}

/// The fields of one step, element by element.
template <class T>
struct NekFields {
  NekHeader header;
  std::vector<std::uint32_t> elements;   ///< their numbers in the whole mesh
  std::vector<T> coordinates, velocity;  ///< 3 per point
  std::vector<T> pressure, temperature;  ///< 1 per point
  std::vector<std::vector<T>> scalars;
};

template <class T>
class NekFile {
 public:
  NekFile(const Input& in, const NekHeader& header) : in_(in), h_(header) {
    const std::uint64_t field = h_.points() * h_.real;
    std::uint64_t needed = kNekHeader + 4;
    constexpr std::uint64_t kMost = std::uint64_t{1} << 60;
    if (h_.elements > kMost) in.fail("its header gives an impossible number of values");
    if (h_.elements > in.bytes.size() / 4) in.fail_short(h_.elements * 4 + needed, in.bytes.size(), true);
    needed += 4 * h_.elements;
    if (field * h_.numbers() > 0 && h_.elements > kMost / (field * h_.numbers()))
      in.fail("its header gives an impossible number of values");
    needed += h_.elements * field * h_.numbers();
    if (in.bytes.size() < needed) in.fail_short(needed, in.bytes.size());
    // In 3-D files, the least and greatest value of each field in each element may follow.
    const std::uint64_t more = in.bytes.size() - needed, bounds = h_.elements * 8 * h_.numbers();
    if (more != 0 && more != bounds) in.warn(fmt::format("{} bytes after the numbers are ignored", grouped(more)));
  }

  void append_to(NekFields<T>& all) {
    at_ = in_.bytes.data() + kNekHeader + 4;
    for (std::uint64_t e = 0; e < h_.elements; ++e, at_ += 4)
      all.elements.push_back(h_.swap ? load<std::uint32_t, true>(at_) : load<std::uint32_t>(at_));
    if (h_.coordinates) append(h_.axes(), all.coordinates);
    if (h_.velocity) append(h_.axes(), all.velocity);
    if (h_.pressure) append(1, all.pressure);
    if (h_.temperature) append(1, all.temperature);
    all.scalars.resize(h_.scalars);
    for (std::vector<T>& scalar : all.scalars) append(1, scalar);
  }

 private:
  /// Each element stores all first components, then all second ones …; vectors are padded to three components.
  void append(std::size_t components, std::vector<T>& to) {
    const std::size_t n = h_.points(), width = components == 1 ? 1 : 3, first = to.size();
    to.resize(first + h_.elements * n * width);
    T* out = to.data() + first;
    for (std::uint64_t e = 0; e < h_.elements; ++e, out += n * width)
      for (std::size_t c = 0; c < components; ++c)
        for (std::size_t i = 0; i < n; ++i, at_ += sizeof(T))
          out[i * width + c] = h_.swap ? load<T, true>(at_) : load<T>(at_);
  }

  const Input& in_;
  NekHeader h_;
  const char* at_ = nullptr;
};

/// A pattern such as "flow%01d.f%05d": part and step. A single number is the step; three are the part's folder, the
/// part and the step.
class NekStep {
 public:
  NekStep(const Input& in, std::string_view pattern, std::int64_t step) : in_(in), pattern_(pattern), step_(step) {
    numbers_ = count();
    if (numbers_ < 1 || numbers_ > 3) in.fail("its filetemplate must have one to three numbers (%01d, %05d)");
  }

  std::size_t numbers() const { return numbers_; }

  std::string file(std::size_t part) const {
    std::string name;
    std::size_t k = 0;
    for (std::size_t i = 0; i < pattern_.size(); ++i) {
      if (pattern_[i] != '%') {
        name += pattern_[i];
        continue;
      }
      std::size_t width = 0;
      for (++i; i < pattern_.size() && pattern_[i] >= '0' && pattern_[i] <= '9'; ++i)
        width = std::min<std::size_t>(20, 10 * width + static_cast<std::size_t>(pattern_[i] - '0'));
      const std::int64_t number = ++k == numbers_ ? step_ : static_cast<std::int64_t>(part);
      name += fmt::format("{:0{}d}", number, std::max<std::size_t>(1, width));
    }
    return beside(in_, name);
  }

 private:
  /// Throws FileError for conversions other than %d with optional digits.
  std::size_t count() const {
    std::size_t numbers = 0;
    for (std::size_t i = 0; i < pattern_.size(); ++i) {
      if (pattern_[i] != '%') continue;
      for (++i; i < pattern_.size() && pattern_[i] >= '0' && pattern_[i] <= '9';) ++i;
      if (i >= pattern_.size() || pattern_[i] != 'd') in_.fail("its filetemplate has a % that is not of %d");
      ++numbers;
    }
    return numbers;
  }

  const Input& in_;
  std::string_view pattern_;
  std::int64_t step_;
  std::size_t numbers_ = 0;
};

/// Throws FileError naming `file` if the number of distinct elements differs from the header.
void check_nek_elements(const std::string& file, const NekHeader& header, std::vector<std::uint32_t> elements) {
  std::sort(elements.begin(), elements.end());
  const auto count = static_cast<std::uint64_t>(std::unique(elements.begin(), elements.end()) - elements.begin());
  if (count != header.all)
    throw FileError(file, fmt::format("holds {} of {} elements{}", grouped(count), grouped(header.all),
                                      header.parts > 1 ? ", with the other parts of its step" : ""));
}

template <class T>
NekFields<T> read_nek_step(const NekStep& step, const NekHeader& first, ReadReport& report) {
  NekFields<T> all;
  all.header = first;
  for (std::size_t part = 0; part < first.parts; ++part) {
    const std::string name = step.file(part);
    const FileContent content(name);
    const Input in{name, content.bytes(), report};
    const NekHeader h = parse_nek_header(in);
    if (!h.laid_out_as(first)) in.fail("has another layout than the first part of its step");
    NekFile<T>(in, h).append_to(all);
  }
  check_nek_elements(step.file(0), first, all.elements);
  return all;
}

/// Reads only the header of uncompressed files: the steps of a series are numerous and large.
NekHeader nek_header_of(const std::string& file, ReadReport& report) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) {
    std::string head(kNekHeader + 4, '\0');
    std::ifstream stream(file, std::ios::binary);
    if (stream.read(head.data(), static_cast<std::streamsize>(head.size())) && head.starts_with("#std"))
      return parse_nek_header({file, head, report});
  }
  const FileContent content(file);
  return parse_nek_header({file, content.bytes(), report});
}

/// Grids between the points of elements, as one list of cells; points on element borders are duplicated.
template <class T>
void add_nek_cells(const NekFields<T>& fields, GridBlock& block) {
  const auto [nx, ny, nz] = fields.header.dims;
  const std::size_t n = fields.header.points();
  block.kind = GridKind::unstructured;
  block.points.resize(fields.elements.size() * n);
  for (std::size_t i = 0; i < block.points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) block.points[i][k] = static_cast<double>(fields.coordinates[3 * i + k]);
  for (std::size_t e = 0; e < fields.elements.size(); ++e) {
    const auto at = [&, first = e * n](std::size_t i, std::size_t j, std::size_t k) {
      return static_cast<std::uint32_t>(first + i + fields.header.dims[0] * (j + fields.header.dims[1] * k));
    };
    for (std::size_t k = 0; k + 1 < std::max<std::size_t>(2, nz); ++k)
      for (std::size_t j = 0; j + 1 < ny; ++j)
        for (std::size_t i = 0; i + 1 < nx; ++i) {
          const std::array ring{at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)};
          if (nz == 1)
            block.flat_cells.push_back(ring);
          else
            block.cells.add(CellShape::hexahedron,
                            std::array{ring[0], ring[1], ring[2], ring[3], at(i, j, k + 1), at(i + 1, j, k + 1),
                                       at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
        }
  }
}

/// Coordinates from another step, whose elements may have another order.
template <class T>
void take_nek_coordinates(const Input& in, const NekFields<T>& from, NekFields<T>& to) {
  if (to.elements.size() > from.elements.size())  // some are duplicates
    in.fail(fmt::format("one of its steps has {} elements, the one with their coordinates {}",
                        grouped(to.elements.size()), grouped(from.elements.size())));
  std::map<std::uint32_t, std::size_t> where;
  for (std::size_t e = 0; e < from.elements.size(); ++e) where[from.elements[e]] = e;
  const std::size_t n = 3 * from.header.points();
  to.coordinates.resize(to.elements.size() * n);
  for (std::size_t e = 0; e < to.elements.size(); ++e) {
    const auto found = where.find(to.elements[e]);
    if (found == where.end() || from.header.dims != to.header.dims)
      in.fail("its steps do not have the same elements, and not all of them have coordinates");
    std::copy_n(from.coordinates.begin() + static_cast<std::ptrdiff_t>(found->second * n), n,
                to.coordinates.begin() + static_cast<std::ptrdiff_t>(e * n));
  }
}

template <class T>
GridData nek_volume(const Input& in, NekFields<T> fields) {
  const NekHeader& h = fields.header;
  if (fields.elements.size() * h.points() > 0xfffffff0u / 2) in.fail("holds more points than can be used");
  GridData data;
  GridBlock& block = data.blocks.emplace_back();
  add_nek_cells(fields, block);
  if (h.velocity) block.point_arrays.set("Velocity", std::move(fields.velocity), 3);
  if (h.pressure) block.point_arrays.set("Pressure", std::move(fields.pressure));
  if (h.temperature) block.point_arrays.set("Temperature", std::move(fields.temperature));
  for (std::size_t k = 0; k < h.scalars; ++k)
    block.point_arrays.set(fmt::format("S{:02}", k + 1), std::move(fields.scalars[k]));
  data.time = h.time;
  data.format = fmt::format("Nek5000, {} elements of {} x {}{} points", grouped(fields.elements.size()), h.dims[0],
                            h.dims[1], h.dims[2] > 1 ? fmt::format(" x {}", h.dims[2]) : "");
  return data;
}

template <class T>
GridData nek_field(const Input& in, const NekHeader& header) {
  NekFields<T> fields;
  fields.header = header;
  NekFile<T>(in, header).append_to(fields);
  check_nek_elements(in.file, header, fields.elements);
  return nek_volume(in, std::move(fields));
}

/// `mesh` is the step with the coordinates, which may be the step itself.
template <class T>
GridData nek_step(const Input& in, const NekStep& step, const NekHeader& header, const NekStep& mesh,
                  const NekHeader& mesh_header) {
  NekFields<T> fields = read_nek_step<T>(step, header, in.report);
  if (!header.coordinates) take_nek_coordinates(in, read_nek_step<T>(mesh, mesh_header, in.report), fields);
  return nek_volume(in, std::move(fields));
}

/// A step and its header, or the reason why it cannot be read, which is reported only if the step is needed.
struct NekSeriesStep {
  NekStep step;
  NekHeader header;
  std::exception_ptr wrong = nullptr;

  const NekHeader& checked() const {
    if (wrong) std::rethrow_exception(wrong);
    return header;
  }
};

NekSeriesStep look_at_nek_step(const Input& in, const NekStep& step) {
  NekSeriesStep found{step, {}};
  found.header.time = std::numeric_limits<double>::quiet_NaN();
  try {
    const NekHeader header = nek_header_of(found.step.file(0), in.report);
    if (found.step.numbers() == 1 && header.parts > 1)
      in.fail("its steps have several parts, but its filetemplate has no number for them");
    found.header = header;
  } catch (const FileError&) {
    found.wrong = std::current_exception();
  }
  return found;
}

struct NekSeries {
  std::string_view pattern;
  std::int64_t first = 0, steps = 0;
};

NekSeries parse_nek_series(const Input& in) {
  NekSeries series;
  std::map<std::string_view, std::string_view> fields;
  TextScanner text(in.bytes);
  while (!text.at_end()) {
    TextScanner line(text.line());
    std::string_view name = line.word();
    if (name.ends_with(':')) name.remove_suffix(1);
    fields.emplace(name, line.word());
  }
  const auto whole = [&](std::string_view name, std::int64_t least) {
    TextScanner number(fields[name]);
    std::int64_t value = 0;
    if (!number.number(value) || !number.at_end() || value < least || value > 10000000)
      in.fail(fmt::format("gives no {}: a whole number from {} on", name, least));
    return value;
  };
  series.pattern = fields["filetemplate"];
  if (series.pattern.empty()) in.fail("gives no filetemplate: the pattern of the names of its files");
  series.first = whole("firsttimestep", 0);
  series.steps = whole("numtimesteps", 1);
  return series;
}

}  // namespace

GridData read_nek_field(const Input& in) {
  const NekHeader h = parse_nek_header(in);
  if (!h.coordinates) in.fail("holds no coordinates: name the file of its series (.nek5000)");
  if (h.parts > 1) in.fail("is one of several parts: name the file of its series (.nek5000)");
  return h.real == 8 ? nek_field<double>(in, h) : nek_field<float>(in, h);
}

GridData read_nek_series(const Input& in, std::size_t wanted) {
  const NekSeries series = parse_nek_series(in);
  std::vector<NekSeriesStep> steps;
  std::error_code ignored;
  for (std::int64_t k = 0; k < series.steps; ++k) {
    NekStep step(in, series.pattern, series.first + k);
    if (k > 0 && !std::filesystem::exists(step.file(0), ignored)) {
      in.warn(fmt::format("announces {} steps, but only {} have files", series.steps, k));
      break;
    }
    steps.push_back(look_at_nek_step(in, step));
    if (k == 0 && !std::filesystem::exists(steps[0].step.file(0), ignored)) steps[0].checked();
  }
  check_time_step(in.file, wanted, steps.size());
  const NekHeader& header = steps[wanted].checked();
  // The first step has coordinates, and later steps if they have changed.
  std::size_t mesh = wanted;
  while (mesh > 0 && !steps[mesh].checked().coordinates) --mesh;
  const NekHeader& mesh_header = steps[mesh].checked();
  if (!mesh_header.coordinates) in.fail("no step up to the requested one has coordinates");
  if (mesh_header.real != header.real) in.fail("its steps have numbers of different sizes");
  const auto read = header.real == 8 ? nek_step<double> : nek_step<float>;
  GridData data = read(in, steps[wanted].step, header, steps[mesh].step, mesh_header);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    data.times.push_back(steps[k].header.time);
    if (steps[k].wrong) in.warn(fmt::format("the file of step {} cannot be read", k));
  }
  if (data.times.size() == 1) data.times.clear();
  return data;
}

bool is_nek_field_name(const std::string& ending) {
  return ending.size() == 6 && ending[0] == 'f' && ending.find_first_not_of("0123456789", 1) == std::string::npos;
}

}  // namespace sansmesh::inline v1::io
