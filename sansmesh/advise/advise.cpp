#include "sansmesh/advice.h"

#include <fmt/core.h>

#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/remedies.h"

namespace sansmesh::inline v1 {
namespace {

using Aim = Recommendation::Aim;

// Thresholds of traits; docs/methods/which-method.md has the measurements on either side.
constexpr double kStray = 0.001;       // share of outliers
constexpr double kNoisy = 0.1;         // noise over spacing
constexpr double kVeryNoisy = 0.5;     // single samples are unreliable above it
constexpr double kSharp = 1;           // length of the creases over the diagonal
constexpr double kSharpShare = 0.01;   // and share of samples next to them: fewer are random,
constexpr double kSharpByNoise = 0.1;  // more likely with noise
constexpr double kBorder = 1;          // length of the borders over the diagonal
constexpr double kBorderShare = 0.003;
constexpr double kPartOpen = 0.005, kAllOpen = 0.995;  // share of the area that bounds no solid
constexpr double kPartInward = 0.02;                   // share of the samples
constexpr double kUneven = 3;           // 95 % over 5 % quantile of the spacing; 1.5 for random positions
constexpr std::size_t kLarge = 300000;  // samples
constexpr std::size_t kFew = 1000, kFewForNoise = 10000;

struct Judgement {
  bool stray, noisy, very_noisy, sharp, border, open, all_open, holes, uneven, large, few;
};

Judgement judge(const CloudTraits& t) {
  return {.stray = t.outliers >= kStray,
          .noisy = t.noise_known && t.noise_ratio() >= kNoisy,
          .very_noisy = t.noise_known && t.noise_ratio() >= kVeryNoisy,
          .sharp = t.crease_length >= kSharp && t.creases >= kSharpShare + kSharpByNoise * t.noise_ratio(),
          .border = t.border_length >= kBorder && t.borders >= kBorderShare,
          .open = t.open >= kPartOpen,
          .all_open = t.open >= kAllOpen,
          .holes = t.open_edges > 0,
          .uneven = t.density_ratio >= kUneven,
          .large = t.samples >= kLarge,
          .few = t.samples < kFew};
}

std::string percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

std::vector<std::string> findings_of(const CloudTraits& t, const Judgement& j) {
  std::vector<std::string> lines;
  if (j.stray) lines.push_back(fmt::format("stray samples: {} belong to no surface", percent(t.outliers)));
  if (j.noisy)
    lines.push_back(fmt::format("{}noisy: the samples are {:.2g} spacings off the surface", j.very_noisy ? "very " : "",
                                t.noise_ratio()));
  else if (!t.noise_known && t.step > 0)
    lines.push_back(fmt::format("coordinates have steps of {:.2g} spacings, which hide the noise", t.step / t.spacing));
  else if (!t.noise_known)
    lines.push_back(fmt::format("noise cannot be distinguished from shape{}: it is {:.2g} spacings at most",
                                t.samples < kFewForNoise ? " with so few samples" : "", t.most_noise / t.spacing));
  else
    lines.push_back(t.noise_ratio() < 0.005 ? std::string("no noise")
                                            : fmt::format("low noise: {:.2g} spacings", t.noise_ratio()));
  if (j.sharp)
    lines.push_back(fmt::format("sharp edges: {} of the samples are next to one, total length about {:.1f} diagonals",
                                percent(t.creases), t.crease_length));
  else if (!t.creases_known)
    lines.push_back("sharp edges cannot be distinguished from noise");
  if (j.open)
    lines.push_back(fmt::format("open: {} bounds no solid, and ends where the samples end",
                                j.all_open ? "the surface" : fmt::format("{:.0f} % of the surface", 100 * t.open)));
  if (j.holes)
    lines.push_back(fmt::format("borders or holes: {} of the faces in {}", counted(t.open_edges, "open edge"),
                                counted(t.open_loops, "loop")));
  if (j.border)
    lines.push_back(
        fmt::format("borders or holes: {} of the samples are next to one, total length about {:.1f} diagonals",
                    percent(t.borders), t.border_length));
  if (j.uneven)
    lines.push_back(
        fmt::format("uneven: samples are {:.1f} times farther apart in some parts than in others", t.density_ratio));
  switch (t.normals) {
    case OrientationCheck::missing:
      lines.push_back("no normals: every command estimates and orients them");
      break;
    case OrientationCheck::unoriented:
      lines.push_back(t.orientation.related < kLeastRelated
                          ? "the normals are unrelated to those of neighbouring samples: every command estimates others"
                          : "the normals are not oriented consistently: every command orients them again");
      break;
    case OrientationCheck::inward:
      lines.push_back("the normals point inward: every command turns them");
      break;
    case OrientationCheck::oriented:
      break;
  }
  if (t.normals == OrientationCheck::oriented && t.orientation.inward > kPartInward)
    lines.push_back(fmt::format("the normals of {} of the samples point inward: nested parts, or wrong normals",
                                percent(t.orientation.inward)));
  if (j.few) lines.push_back("few samples: no method can recover detail between them");
  return lines;
}

Recommendation mesh(const Judgement& j) {
  // A surface that ends with its samples has no walls between stray samples, and their small parts are removed; thin
  // twigs and wires are not stray.
  const bool strays_go = j.stray && !j.open;
  std::string why = std::string(j.open ? "" : "closed, and ") +
                    "of all methods measured the smallest error with the fewest triangles and the least time";
  if (j.sharp)
    why = "represents creases, so that edges stay sharp; the other methods round them";
  else if (j.noisy)
    why = "supports adapt to the noise: the smallest error of all methods measured";
  else if (j.large)
    why = "the other methods need many times the time for so many samples";
  if (strays_go) why += "; without the stray samples, which would ruin a closed surface";
  if (j.open)
    why += fmt::format("; it ends where the samples end ({}, {})", remedy("advice_open", "open").text,
                       remedy("advice_open", "fill_holes").text);
  else if (j.border || j.holes)
    why += fmt::format("; borders and holes are closed ({})", remedy("advice_closed", "open").text);
  return {.aim = Aim::mesh, .surface = "partition", .remove_outliers = strays_go, .why = std::move(why)};
}

Recommendation picture(const Judgement& j) {
  return {.aim = Aim::picture,
          .surface = "apss",
          .sharp = j.sharp,
          .remove_outliers = j.stray,
          .why = j.sharp ? "no mesh is needed, and bilateral normals turn sharply at edges"
                         : "no mesh is needed: rays meet algebraic spheres fitted to the samples"};
}

Recommendation curvature(const Judgement& j) {
  return {.aim = Aim::curvature,
          .surface = "curvature",
          .why = j.noisy ? "the curvature-driven projection omits the nearest samples, whose noise disturbs curvatures "
                           "most"
                         : "principal curvatures and directions at every sample"};
}

Recommendation points(const Judgement& j) {
  return {.aim = Aim::points,
          .surface = "partition",
          .remove_outliers = j.stray,
          .why = "moves the samples onto the most accurate surface, which removes noise of positions and normals"};
}

Recommendation solid(const Judgement& j) {
  return {.aim = Aim::solid,
          .surface = "partition",
          .remove_outliers = j.stray && !j.open,
          .why = j.all_open ? "a function for block-wise editing; it bounds no solid, so that unions and differences "
                              "mean little"
                            : "a function that is negative inside, for block-wise editing, unions and differences with "
                              "others"};
}

Recommendation deformation() {
  return {.aim = Aim::deformation,
          .surface = "partition",
          .why = "moving least squares moves the samples with the handles: no mesh is needed"};
}

}  // namespace

const char* aim_word(Aim aim) {
  switch (aim) {
    case Aim::mesh:
      return "mesh";
    case Aim::picture:
      return "picture";
    case Aim::curvature:
      return "curvature";
    case Aim::points:
      return "points";
    case Aim::solid:
      return "solid";
    case Aim::deformation:
      return "deform";
  }
  return "";
}

Advice advise(const CloudTraits& traits) {
  const Judgement j = judge(traits);
  Advice advice;
  advice.traits = traits;
  advice.findings = findings_of(traits, j);
  advice.recommendations.push_back(mesh(j));
  advice.recommendations.push_back(picture(j));
  if (j.noisy) advice.recommendations.push_back(points(j));
  advice.recommendations.push_back(curvature(j));
  advice.recommendations.push_back(solid(j));
  advice.recommendations.push_back(deformation());
  return advice;
}

std::vector<std::string> summary_of(const Advice& advice) {
  const CloudTraits& t = advice.traits;
  const NoiseEstimate noise{t.noise, t.most_noise, t.noise_known, t.step};
  std::vector<std::string> lines{fmt::format("{}, spacing {}, noise {}", counted(t.samples, "sample"),
                                             length_words(t.spacing), noise_words(noise, t.spacing))};
  for (const std::string& finding : advice.findings) lines.push_back("  " + finding);
  return lines;
}

Advice advise(const PointSet& points, Progress& progress) {
  std::vector<Note> notes;
  Advice advice = advise(measure_traits(points, progress, &notes));
  advice.notes = std::move(notes);
  return advice;
}

namespace {

constexpr ReportRow kAdviceRows[] = {reported<&Advice::traits>({.text = "Traits of the samples"}),
                                     reported<&Advice::findings>({.text = "Observations as text"})};

}  // namespace

const ReportSchema& Advice::schema() {
  static constexpr ReportSchema schema{kAdviceRows};
  return schema;
}

}  // namespace sansmesh::inline v1
