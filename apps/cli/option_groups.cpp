#include "option_groups.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/meshing/component_words.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/triangulation/block_tree.h"
#include "schema_options.h"

namespace sansmesh::cli {

ComponentChoice parse_components(const std::string& text) {
  ComponentChoice choice;
  in_words_of_the_line([&] { option_of_text(text, choice); });
  return choice;
}

void require(bool ok, const char* message) {
  if (!ok) throw ArgumentError(message);
}

std::vector<Vec3> places_at(const std::vector<double>& v) {
  std::vector<Vec3> places;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
    places.push_back({v[i], v[i + 1], v[i + 2]});
    if (!is_finite(places.back())) throw ArgumentError("--at must be three finite numbers");
  }
  return places;
}

void add_ascii_flag(CommandLine& c, bool& ascii) {
  c.add_flag("--ascii", ascii, "Write text where the format also has a binary form");
}

void MeshOutput::check() const {
  check_writable(file, "mesh");
  check_preview();
}

void MeshOutput::check_preview() const {
  picture.chosen().validate();
  require(!preview.empty() || !picture.any(), "options of the picture need --preview");
  if (!preview.empty()) check_writable(preview, "image");
}

void MeshOutput::write(const TriangleMesh& mesh, Progress& progress) const {
  Image image;
  const RenderOptions look = picture.chosen();
  if (!preview.empty()) image = render_mesh(mesh, look, progress);
  progress.begin("write");
  write_mesh(file, mesh, {.ascii = ascii});
  if (!preview.empty()) picture.write(preview, image, look);
}

void say_aspect_ratios(const MeshReport& report, Console& console) {
  console.say(fmt::format("aspect ratio {:.3f} ± {:.3f} before enhancement, {:.3f} ± {:.3f} after",
                          report.aspect_mean_before, report.aspect_deviation_before, report.aspect_mean,
                          report.aspect_deviation));
}

void add_mesh_output(CommandLine& c, MeshOutput& o, bool required) {
  const Option file =
      c.add_option("-o,--output", o.file, "Mesh to write: .ply .obj .stl .off .glb .vtp").type_name("FILE");
  if (required) file.required();
  add_preview_option(c, o.preview, "the mesh");
  add_ascii_flag(c, o.ascii);
  add_picture_options(c, o.picture);
  add_wireframe_options(c, o.picture.options);
}

const char* quantity_word(CurvatureQuantity quantity) {
  return kCurvatureWords[static_cast<std::size_t>(quantity)].data();
}

namespace {

std::vector<std::pair<std::string, CurvatureQuantity>> quantity_words() {
  std::vector<std::pair<std::string, CurvatureQuantity>> words;
  for (const auto q :
       {CurvatureQuantity::mean, CurvatureQuantity::gaussian, CurvatureQuantity::k1, CurvatureQuantity::k2})
    words.emplace_back(quantity_word(q), q);
  return words;
}

}  // namespace

CurvatureQuantity curvature_quantity(const std::string& word) {
  for (const auto& [name, quantity] : quantity_words())
    if (name == word) return quantity;
  throw ArgumentError("unknown curvature: " + word);
}

bool is_curvature(const std::string& word) {
  const auto words = quantity_words();
  return std::any_of(words.begin(), words.end(), [&](const auto& w) { return w.first == word; });
}

double curvature_range(double range, CurvatureQuantity quantity, double unit) {
  return range * (quantity == CurvatureQuantity::gaussian ? unit * unit : unit);
}

void add_color_range(CommandLine& c, std::optional<double>& range, const std::string& group) {
  c.add_option("--color-range", range,
               "Curvature that gets the full colour, 1/length or, for gaussian, 1/length² [from data]")
      .type_name("VALUE")
      .positive()
      .group(group);
}

void add_cloud_options(CommandLine& c, CloudUse& o) {
  c.add_choice<FaceUse>("--faces", o.faces,
                        {{"auto", FaceUse::automatic}, {"ignore", FaceUse::ignore}, {"sample", FaceUse::sample}},
                        "Of a mesh: sample its faces, ignore them, or auto (sample where vertices are sparse) [auto]")
      .type_name("CHOICE");
  c.add_choice<NormalUse>(
       "--normals", o.normals,
       {{"auto", NormalUse::automatic}, {"given", NormalUse::as_given}, {"estimate", NormalUse::estimate}},
       "Use given ones as they are, estimate new ones, or auto (turn given ones if need be) [auto]")
      .type_name("CHOICE");
  add_orient_by(c, o.orient_by);
  c.add_flag("--align", o.align, "Move scans that do not quite fit together onto each other");
}

void add_orient_by(CommandLine& c, OrientBy& by) {
  std::vector<std::pair<std::string, OrientBy>> words;
  for (const OrientBy one :
       {OrientBy::automatic, OrientBy::scanner, OrientBy::rows, OrientBy::flight, OrientBy::up, OrientBy::propagation})
    words.emplace_back(orient_by_word(one), one);
  c.add_choice<OrientBy>("--orient-by", by, words, "From what normals get their signs [auto: the first that is known]")
      .type_name("CHOICE");
}

std::string normals_made(bool estimated, const std::optional<OrientBy>& oriented_by) {
  return fmt::format("{}{}", estimated ? "estimated" : "as given",
                     oriented_by ? fmt::format(", oriented {}", orientation_words(*oriented_by)) : "");
}

Json normals_made_json(bool estimated, const std::optional<OrientBy>& oriented_by) {
  return {{"estimated", estimated}, {"oriented_by", oriented_by ? Json(orient_by_word(*oriented_by)) : Json()}};
}

void add_box_option(CommandLine& c, std::optional<Box3>& box, const std::string& what) {
  c.add_option_function(
       "--box",
       [&box](const std::vector<double>& v) {
         box = Box3{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
       },
       what)
      .numbers(6)
      .type_name("BOX");
}

std::string depth_range() { return std::to_string(kLeastDepth) + ".." + std::to_string(kMostDepth); }

PaperCoverage parse_coverage(const std::string& text) {
  if (text == "thesis") return kThesisCoverage;
  if (text == "paper") return kPaperCoverage;
  if (text == "none") return kNoCoverage;
  const auto shares = numbers_in(text, std::tuple_size_v<PaperCoverage>);
  if (!shares) throw must_be("thesis, paper, none or three numbers with commas between them", text);
  PaperCoverage coverage{};
  std::copy(shares->begin(), shares->end(), coverage.begin());
  return coverage;
}

std::vector<std::string> paper_words(const PaperReport& r, const FitsOfDegree& fits) {
  return {fmt::format("{} planes, {} of degree 2, {} of degree 3, {} of degree 4, {} constants; {} planes are borrowed "
                      "from the nearest samples",
                      grouped(fits[1]), grouped(fits[2]), grouped(fits[3]), grouped(fits[4]), grouped(fits[0]),
                      grouped(r.borrowed)),
          fmt::format("{}: {} subdivided for two sheets, {} for too many samples; of those with few samples {} "
                      "subdivided, {} not, since their children are worse; {} above the threshold; {} by balance alone",
                      counted(r.blocks, "block"), grouped(r.two_sheets), grouped(r.too_many), grouped(r.not_worse),
                      grouped(r.kept), grouped(r.above), grouped(r.balanced))};
}

Json paper_json(const PaperReport& r) {
  return {{"blocks", r.blocks},     {"fitted", r.fitted},       {"borrowed", r.borrowed}, {"two_sheets", r.two_sheets},
          {"too_many", r.too_many}, {"not_worse", r.not_worse}, {"kept", r.kept},         {"above", r.above},
          {"balanced", r.balanced}};
}

void add_fit_options(CommandLine& c, FitOptions& o) {
  c.add_choice<FitMethod>(
       "--fit", o.fit, {{"partition", FitMethod::partition}, {"paper", FitMethod::paper}},
       "Our own partition of unity, or that of the paper and the thesis, as they describe it [partition]")
      .type_name("CHOICE")
      .group("Fit");
  c.add_option("--threshold", o.threshold,
               "With --fit paper: accepted rms error of a local fit over the diagonal of the samples [0.002]")
      .type_name("RATIO")
      .group("Fit");
  c.add_option_function(
       "--coverage", [&o](const std::string& text) { o.coverage = parse_coverage(text); },
       "With --fit paper: share of a support that samples have to cover for degrees 2, 3 and 4: thesis (.4,.8,.85), "
       "paper (.85,.9,.95), none or three numbers [thesis]")
      .type_name("CHOICE")
      .group("Fit");
  c.add_option("--depth", o.max_depth,
               "Deepest level of the tree of blocks, " + depth_range() + " [from data; 9 with --fit paper]")
      .type_name("LEVEL")
      .group("Fit");
  c.add_option("--error", o.error,
               "Accepted rms error of a local fit (mpu: largest distance of a sample) [from the noise]")
      .type_name("LENGTH")
      .group("Fit");
  c.add_option("--support", o.support,
               "Radius of a support over the radius of its block, 1.1..2 [1.5, up to 2.5 with noise]")
      .type_name("RATIO")
      .group("Fit");
  c.add_option("--degree", o.max_degree, "Largest degree of the local polynomials, 1..4 [4]")
      .type_name("DEGREE")
      .group("Fit");
  c.add_flag_callback(
       "--open", [&o] { o.open = true; }, "The surface bounds no solid: it ends where the samples end [from data]")
      .excludes("--closed")
      .group("Fit");
  c.add_flag_callback(
       "--closed", [&o] { o.open = false; },
       "The surface is closed, also where there are no samples (with --surface: but for wide holes) [from data]")
      .group("Fit");
  c.add_flag_callback(
       "--smooth", [&o] { o.sharp = false; }, "Do not look for creases and corners")
      .group("Fit");
}

void add_mesh_options(CommandLine& c, MeshOptions& o) {
  c.add_option_function(
       "--components", [&o](const std::string& text) { o.components = parse_components(text); },
       "Parts to keep: auto (those that enough samples stand for), all, largest or a number [auto]")
      .type_name("CHOICE");
  c.add_option("--fill-holes", o.fill_holes,
               "Where the surface ends with its samples: close holes up to so wide [gaps between scan lines]")
      .type_name("LENGTH");
  c.add_option("--trim", o.trim, "Cut the surface off where no sample is as near as this [without a value: from data]")
      .type_name("LENGTH")
      .without_value("0");
  c.add_flag_callback(
       "--confidence", [&o] { o.confidence = true; },
       "Write how far each vertex is from the nearest sample, and its confidence, 0..1 [if the surface is open]")
      .excludes("--no-confidence");
  c.add_flag_callback(
      "--no-confidence", [&o] { o.confidence = false; }, "Do not write that");
  c.add_flag("--quality", o.measure_quality, "Print aspect ratios of the triangles before and after enhancement");
  c.add_choice<Mesher>(
       "--mesher", o.mesher, {{"auto", Mesher::automatic}, {"blocks", Mesher::blocks}, {"walk", Mesher::walk}},
       "Whole blocks, enhanced; or the walk of the paper from simplex to simplex, as it is; auto: the walk after --fit "
       "paper, else blocks [auto]")
      .type_name("CHOICE")
      .group("Mesh");
  c.add_option("--mesh-error", o.mesh_error,
               "Mean distance accepted between mesh and surface: larger is coarser [from data]")
      .type_name("LENGTH")
      .group("Mesh");
  c.add_option("--triangles", o.triangles, "Simplify until there are no more triangles than this")
      .type_name("COUNT")
      .group("Mesh");
  c.add_flag_callback(
       "--no-enhance", [&o] { o.enhance = false; }, "No clustering, smoothing or simplification of triangles")
      .group("Mesh");
  c.add_option("--displacement", o.displacement,
               "With --no-enhance, or the walk: lattice steps back from the surface, 0..1 [0]")
      .type_name("RATIO")
      .group("Mesh");
  c.add_flag_callback(
       "--no-colors", [&o] { o.carry_colors = false; }, "Leave out the samples' colours")
      .group("Mesh");
}

}  // namespace sansmesh::cli
