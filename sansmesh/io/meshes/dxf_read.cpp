// Lines of drawings: LINE, POLYLINE and LWPOLYLINE of the entities of a text DXF (AutoCAD DXF Reference, "ENTITIES").
#include <fmt/core.h>

#include <cmath>
#include <string>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/io/meshes/line_input.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

/// Flags of group 70: closed; a mesh of vertices; a control point of a spline.
constexpr int kClosed = 1, kMeshFlags = 16 | 64, kControlPoint = 16;

class DxfReader {
 public:
  explicit DxfReader(const Input& in) : in_(in), text_(without_byte_order_mark(in.bytes)) {}

  PolylineSet read() {
    if (in_.bytes.starts_with("AutoCAD Binary DXF")) in_.fail("is a binary DXF file; text DXF is read");
    std::string_view section;
    bool named = false;
    while (next()) {
      if (code_ == 0) {
        if (section == "ENTITIES") end_entity();
        named = value_ == "SECTION";
        if (value_ == "ENDSEC") section = {};
        if (section == "ENTITIES") begin_entity();
        if (value_ == "EOF") break;
      } else if (named && code_ == 2) {
        section = value_, named = false, sections_ = true, entities_ |= section == "ENTITIES";
      } else if (section == "ENTITIES") {
        property();
      } else if (section == "HEADER") {
        variable();
      }
    }
    if (!section.empty()) in_.fail("truncated: its last section does not end");
    if (!entities_) in_.fail(sections_ ? "holds no section ENTITIES" : "is no DXF file: it has no section");
    if (unit_ > 0) in_.warn(fmt::format("states a unit ($INSUNITS {}): coordinates were taken as they are", unit_));
    if (paper_lines_) in_.unread("lines of the paper space");
    if (tilted_) in_.unread("polylines in tilted planes");
    if (arcs_) in_.unread("arcs of polylines, which became straight");
    if (!others_.empty()) in_.unread("entities that are not lines: " + others_);
    PolylineSet lines;
    lines.offsets = std::move(offsets_);
    place_lines(lines, positions_);
    return lines;
  }

 private:
  /// Reads a group: a line with its code and a line with its value.
  bool next() {
    if (text_.at_end()) return false;
    TextScanner number(text_.line());
    ++line_;
    number.skip_blanks();
    if (number.at_end() && text_.at_end()) return false;
    if (!number.number(code_)) in_.fail(fmt::format("line {}: is no code of a DXF group", grouped(line_)));
    if (text_.at_end()) in_.fail("truncated: the last DXF group has no value");
    value_ = without_blanks(text_.line());
    ++line_;
    return true;
  }

  /// A variable of the header. Unit 0 is none.
  void variable() {
    if (code_ == 9) in_units_ = value_ == "$INSUNITS";
    if (code_ == 70 && in_units_) unit_ = index_in<int>(number(), 0, 0xffff);
  }

  double number() const {
    double x = 0;
    if (!TextScanner(value_).number(x) || !(std::abs(x) <= kLargestCoordinate))
      in_.fail(fmt::format("line {}: '{}' is no number", grouped(line_), printable(std::string(value_), 40)));
    return x;
  }

  void begin_entity() {
    if (in_polyline_ && value_ != "VERTEX" && value_ != "SEQEND")
      in_.fail(fmt::format("line {}: a POLYLINE without SEQEND", grouped(line_)));
    entity_ = value_, at_ = {}, end_ = {}, flags_ = 0, started_ = false, given_ = 0;
    if (value_ == "POLYLINE" || value_ == "LWPOLYLINE" || value_ == "LINE") {
      line_of_.clear(), line_flags_ = 0, elevation_ = 0, paper_ = false, out_ = {0, 0, 1};
      in_polyline_ = value_ == "POLYLINE";
    } else if (value_ != "VERTEX" && value_ != "SEQEND" && value_ != "ENDSEC") {
      note_other();
    }
  }

  void note_other() {
    const std::string name = printable(std::string(entity_), 20);
    if (others_.size() < 60 && (", " + others_ + ",").find(", " + name + ",") == std::string::npos)
      others_ += (others_.empty() ? "" : ", ") + name;
  }

  void property() {
    switch (code_) {
      case 10:
        if (entity_ == "LWPOLYLINE") add_light_vertex();
        at_.x = number(), started_ = true, given_ |= 1;
        break;
      case 20:
        at_.y = number(), given_ |= 2;
        break;
      case 30:
        at_.z = number();
        break;
      case 11:
        end_.x = number(), given_ |= 4;
        break;
      case 21:
        end_.y = number(), given_ |= 8;
        break;
      case 31:
        end_.z = number();
        break;
      case 38:
        elevation_ = number();
        break;
      case 42:
        arcs_ = arcs_ || ((entity_ == "VERTEX" || entity_ == "LWPOLYLINE") && number() != 0);
        break;
      case 67:
        paper_ = number() != 0;
        break;
      case 210:
      case 220:
      case 230:
        if (entity_ == "LWPOLYLINE" || entity_ == "POLYLINE")
          out_[static_cast<std::size_t>(code_ - 210) / 10] = number();
        break;
      case 70:
        flags_ = index_in<int>(number(), 0, 0xffff);
        break;
      default:
        break;
    }
  }

  void add_light_vertex() {
    if (started_) line_of_.push_back({at_.x, at_.y, 0});
  }

  void end_entity() {
    if (entity_ == "LINE") {
      if (given_ != 15) in_.fail(fmt::format("line {}: a LINE before it lacks an end", grouped(line_)));
      line_of_ = {at_, end_};
      add_line();
    } else if (entity_ == "LWPOLYLINE") {
      add_light_vertex();
      for (Vec3& p : line_of_) p.z = elevation_;
      line_flags_ = flags_;
      place_flat();
      add_line();
    } else if (entity_ == "POLYLINE") {
      line_flags_ = flags_, elevation_ = at_.z;
    } else if (entity_ == "VERTEX" && in_polyline_) {
      // A flat polyline has its height itself.
      const bool flat = (line_flags_ & 8) == 0;
      if ((flags_ & kControlPoint) == 0) line_of_.push_back({at_.x, at_.y, flat && at_.z == 0 ? elevation_ : at_.z});
    } else if (entity_ == "SEQEND" && in_polyline_) {
      in_polyline_ = false;
      if ((line_flags_ & kMeshFlags) != 0) {
        entity_ = "POLYLINE meshes", note_other();
      } else {
        if ((line_flags_ & 8) == 0) place_flat();
        add_line();
      }
    }
    entity_ = {};
  }

  /// Flat polylines have coordinates of their plane, which may face down: x and z have the opposite signs there.
  void place_flat() {
    if (out_.x != 0 || out_.y != 0) line_of_.clear(), tilted_ = true;
    if (out_.z < 0)
      for (Vec3& p : line_of_) p = {-p.x, p.y, -p.z};
  }

  void add_line() {
    if (paper_ && !line_of_.empty()) line_of_.clear(), paper_lines_ = true;
    if (line_of_.empty()) return;
    if ((line_flags_ & kClosed) != 0) line_of_.push_back(line_of_.front());
    positions_.insert(positions_.end(), line_of_.begin(), line_of_.end());
    offsets_.push_back(positions_.size());
    line_of_.clear();
  }

  const Input& in_;
  TextScanner text_;
  std::uint64_t line_ = 0;
  int code_ = 0;
  std::string_view value_, entity_;
  // The entity, and the line that it belongs to.
  Vec3 at_{}, end_{}, out_{0, 0, 1};
  unsigned given_ = 0;  ///< bits of the given coordinates of both ends
  int flags_ = 0, line_flags_ = 0;
  double elevation_ = 0;
  int unit_ = 0;
  bool in_units_ = false, paper_ = false, paper_lines_ = false, tilted_ = false;
  bool started_ = false, in_polyline_ = false, arcs_ = false, sections_ = false, entities_ = false;
  std::vector<Vec3> line_of_, positions_;
  std::vector<std::size_t> offsets_{0};
  std::string others_;
};

}  // namespace

PolylineSet read_dxf_lines(const Input& in) {
  in.report.format = "DXF";
  return DxfReader(in).read();
}

}  // namespace sansmesh::inline v1::io
