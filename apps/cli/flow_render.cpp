// sansmesh flow render: pictures of stream, path, streak and time surfaces.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "commands.h"
#include "flow_surface_input.h"
#include "option_groups.h"
#include "picture_contents.h"
#include "sansmesh/core/error.h"
#include "sansmesh/data/image.h"
#include "sansmesh/io/io.h"
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/jobs/volume_subject.h"
#include "sansmesh/mesh/arrows.h"
#include "sansmesh/render/picture_notes.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/transfer_presets.h"
#include "sansmesh/render/volume_picture.h"

namespace sansmesh::cli {
namespace {

constexpr double kDark = 0.45;          // of the range of values: colours that are left out below it
constexpr double kScaleEnd = 0.01;      // share of the particles beyond each end of the scale of colours
constexpr double kMostTurn = 3600;      // degrees
constexpr int kLeastBesideBars = 100;   // pixels
constexpr double kArrowSpacing = 0.06;  // of the surface's diagonal
constexpr double kArrowLength = 0.7;    // of their distance
constexpr Vec3f kArrowColor{0.13f, 0.12f, 0.12f};

struct FlowRenderArguments {
  FlowSurfaceInput input;
  std::string output, color_by = "time", label, unit, title, background = "gradient", volume, preset;
  std::vector<std::string> isos;
  PictureContents contents;
  PictureArguments picture;
  FlowLook look;
  FlowTextureOptions streaks;
  double volume_opacity = 1, turn = 0;
  bool smooth = false, no_bar = false;
  std::optional<double> arrows;          // distance between them; 0: of our choice
  std::vector<IsoSurface> iso_surfaces;  // of `isos`
  int frames = 0;

  bool in_volume() const { return !volume.empty() || !isos.empty(); }
};

/// The surface as it is drawn, with what its colours mean.
struct DrawnSurface {
  FlowSubject subject;
  std::optional<TransferFunction> colors;
  std::string title;
};

/// The array that --color-by names, if it is one. Throws ArgumentError.
std::optional<ArrayChoice> color_array(const std::string& by, OpenFlow& flow) {
  if (by == "time" || by == "speed" || by == "seed" || by == "none") return std::nullopt;
  OpenVolume* const volume = flow.volume();
  require(volume != nullptr, "--color-by an array needs a steady flow of a file");
  return scalar_choice(by, *volume, "color_by");
}

/// Values that the colours stand for; none without.
std::vector<double> color_values(const std::string& by, const std::optional<ArrayChoice>& array,
                                 const FlowSurface& surface, OpenFlow& flow) {
  std::vector<double> values;
  if (by == "none") return values;
  values.resize(surface.points.size());
  if (array) {
    std::vector<Vec3> x;
    x.reserve(surface.points.size());
    for (const FlowPoint& p : surface.points) x.push_back(p.position);
    flow.volume()->field(*array)->evaluate(x, {values, {}, {}, {}});
    return values;
  }
  std::transform(surface.points.begin(), surface.points.end(), values.begin(), [&](const FlowPoint& p) {
    return by == "time" ? p.t : by == "seed" ? p.s : norm(p.velocity);
  });
  return values;
}

/// Without what few particles have, which would take the colours from all others.
std::pair<double, double> scale_ends(std::vector<double> values) {
  const auto at = [&](double share) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const double lower = at(kScaleEnd), upper = at(1 - kScaleEnd);
  return lower < upper ? std::pair(lower, upper) : std::pair(at(0), at(1));
}

/// Those of the preset "flow" but for its darkest: on those neither light nor streaks would be seen.
TransferFunction light_colors(const ValueHistogram& values) {
  TransferFunction colors = transfer_function_preset("flow", values);
  const auto [lower, upper] = colors.range();
  const TransferFunction wide = colors.over(lower - kDark * (upper - lower), upper);
  for (ColorPoint& p : colors.colors) p.color = wide.color(p.value);
  return colors;
}

DrawnSurface drawn_surface(const FlowRenderArguments& a, const FlowSurface& surface,
                           const std::optional<ArrayChoice>& array, OpenFlow& flow) {
  DrawnSurface drawn{{surface.mesh, {}, {}}, {}, with_unit(a.label.empty() ? a.color_by : a.label, a.unit)};
  FlowSubject& subject = drawn.subject;
  double fastest = 0;
  for (const FlowPoint& p : surface.points) fastest = std::max(fastest, norm(p.velocity));
  for (const FlowPoint& p : surface.points) {
    subject.vectors.push_back(fastest > 0 ? Vec3f(p.velocity / fastest) : Vec3f{});
    subject.fronts.push_back(p.front);
  }
  const std::vector<double> values = color_values(a.color_by, array, surface, flow);
  subject.mesh.colors.clear();
  if (values.empty()) return drawn;
  ValueHistogram histogram = value_histogram(values);
  if (a.color_by != "time" && a.color_by != "seed") {
    std::tie(histogram.lower, histogram.upper) = scale_ends(values);
    histogram.least = std::max(histogram.least, histogram.lower);
    histogram.most = std::min(histogram.most, histogram.upper);
  }
  const bool signs = histogram.least < 0 && histogram.most > 0 && a.color_by != "time";
  drawn.colors = signs ? transfer_function_preset("diverging", histogram) : light_colors(histogram);
  subject.mesh.colors.reserve(values.size());
  for (const double v : values) {
    const Vec3f c = drawn.colors->color(v);
    subject.mesh.colors.push_back({to_byte(c.x), to_byte(c.y), to_byte(c.z)});
  }
  return drawn;
}

/// Arrows along the flow, half sunk into the surface: they are seen from both sides.
TriangleMesh arrows_on(const FlowSurface& surface, double spacing) {
  const double size = bounds(surface.mesh).diagonal();
  if (spacing > size)
    throw ArgumentError(fmt::format("--arrows {:g} is more than the surface's diagonal, {:.6g}", spacing, size));
  if (spacing == 0) spacing = kArrowSpacing * size;
  std::vector<Vec3> positions, vectors;
  for (const std::uint32_t v : spread_vertices(surface.mesh, spacing)) {
    const FlowPoint& p = surface.points[v];
    vectors.push_back(p.velocity);
    positions.push_back(p.position - normalized(p.velocity) * (0.5 * kArrowLength * spacing));
  }
  ArrowOptions options;
  options.length = kArrowLength * spacing;
  return arrows(positions, vectors, options);
}

/// The volume that the surface stands in: seen through, with iso-surfaces.
class VolumeAround {
 public:
  VolumeAround(const FlowRenderArguments& a, OpenVolume& volume, Progress& progress) : samples_(volume.samples()) {
    const std::string name = a.volume.empty() ? volume.choice().array : a.volume;
    field_ = volume.field(scalar_choice(name, volume, "volume"));
    options_.color_title = name;
    options_.color_bar = !a.no_bar && !a.volume.empty() && a.volume_opacity > 0;
    options_.opacity_scale = a.volume.empty() ? 0 : a.volume_opacity;
    options_.isos = a.iso_surfaces;
    options_.validate();
    VolumeSubject subject = volume_subject(*samples_, boundary_);
    subject.field = field_.get();
    subject.image = false;
    picture_.emplace(std::move(subject), progress);
    const ValueHistogram& values = picture_->histogram();
    options_.transfer = a.preset.empty() ? suggest_transfer_function(values, false).function
                                         : transfer_function_preset(a.preset, values);
  }
  Image render(const RenderOptions& look, bool steady, std::vector<PictureSurface> surfaces, Progress& progress) {
    static_cast<RenderOptions&>(options_) = look;
    options_.steady = steady;
    picture_->set_surfaces(std::move(surfaces));
    return picture_->render(options_, progress);
  }
  /// Pixels that its colour bar takes.
  int bar_width(int height) const {
    return options_.color_bar ? value_bar_width(height, *options_.transfer, options_.color_title) : 0;
  }

 private:
  std::shared_ptr<const SampledVolume> samples_;
  std::shared_ptr<const VolumeField> field_;
  TriangleMesh boundary_;
  VolumePictureOptions options_;
  std::optional<VolumePicture> picture_;
};

/// What can be said before anything is read.
void check_arguments(FlowRenderArguments& a) {
  check_writable(a.output, "image");
  check_flow_surface(a.input);
  const FlowTextureOptions usual;
  require(
      !a.smooth || (a.streaks.streak_length == usual.streak_length && a.streaks.streak_width == usual.streak_width &&
                    a.streaks.streak_contrast == usual.streak_contrast),
      "--streak-length, --streak-width and --streak-contrast mean nothing with --smooth");
  if (!a.smooth)
    a.look.texture = a.streaks;
  else
    a.look.texture.reset();
  a.look.validate();
  a.picture.chosen().validate();
  a.picture.check_frames(a.frames > 0);
  require(a.frames == 0 || a.frames >= 2, "--frames must be at least 2");
  require(!a.arrows || (std::isfinite(*a.arrows) && *a.arrows >= 0), "--arrows must be a length, or 0");
  require(a.turn == 0 || a.frames > 0, "--turn needs --frames");
  require(std::abs(a.turn) <= kMostTurn, "--turn must be from -3600 to 3600");
  require(a.frames == 0 || !a.smooth || a.turn != 0, "--frames moves streaks: with --smooth it needs --turn");
  require(!a.volume.empty() || (a.preset.empty() && a.volume_opacity == 1),
          "--volume-preset and --volume-opacity need --volume");
  require(!a.in_volume() || !a.input.flow.unsteady, "--volume and --iso need a steady flow");
  require((a.label.empty() && a.unit.empty()) || !(a.no_bar || a.color_by == "none"),
          "--label and --unit stand at the colour bar: not with --no-bar, nor with --color-by none");
  for (const std::string& text : a.isos) a.iso_surfaces.push_back(iso_surface_of(text));
}

void run_flow_render(FlowRenderArguments& a, Console& console) {
  check_arguments(a);
  Progress& progress = console.progress();
  OpenFlow flow(a.input.flow, console);
  require(!a.in_volume() || flow.volume(), "--volume and --iso need a flow of a file");
  const std::optional<ArrayChoice> color = color_array(a.color_by, flow);
  RenderOptions look = a.picture.chosen();
  set_background(look, a.background);
  std::vector<PictureSurface> beside = a.contents.read(look, console);
  std::vector<std::string> files;
  try {
    std::optional<VolumeAround> around;
    if (a.in_volume()) around.emplace(a, *flow.volume(), progress);
    const FlowSurface surface = trace_flow_surface(a.input, flow, console);
    if (surface.mesh.triangles.empty()) throw DataError("the surface is empty");
    DrawnSurface drawn = drawn_surface(a, surface, color, flow);
    std::vector<Vec3> places;
    Box3 box;
    places.reserve(surface.points.size());
    for (const FlowPoint& p : surface.points) {
      places.push_back(p.position);
      box.extend(p.position);
    }
    if (!a.picture.has_view())
      if (const auto view = view_of_layer(box, look.up)) look.view = *view;
    const bool bar = drawn.colors && !a.no_bar;
    const int bars = (bar ? value_bar_width(look.height, *drawn.colors, drawn.title) : 0) +
                     (around ? around->bar_width(look.height) : 0);
    if (bars > 0 && look.width < bars + kLeastBesideBars)
      throw ArgumentError(fmt::format("--width {} is too narrow: colour bars take {} of it", look.width, bars));
    look.width -= bars;
    if (a.arrows) {
      RenderOptions dark = look;
      dark.surface_color = kArrowColor;
      beside.push_back(surface_in_picture(arrows_on(surface, *a.arrows), dark));
    }
    const DrawnFlow sheet(std::move(drawn.subject), look);
    const ViewDirection first = look.view;
    const bool steady = a.turn != 0, translucent = a.look.opacity < 1;
    for (int k = 0; k < std::max(1, a.frames); ++k) {
      const double share = a.frames > 0 ? static_cast<double>(k) / a.frames : 0;
      look.view.azimuth = first.azimuth + std::remainder(a.turn * share, 360);
      FlowLook frame = a.look;
      if (frame.texture && a.frames > 0) frame.texture->phase = share;
      std::vector<PictureSurface> surfaces = beside;
      surfaces.push_back(sheet.surface(frame));
      Image image = around ? around->render(look, steady, std::move(surfaces), progress)
                           : render_surfaces(surfaces, places, translucent, steady, look, progress);
      if (!a.title.empty()) draw_title(image, a.title);
      const Image paper = paper_beside(look);
      if (bar) image = beside_value_bar(image, *drawn.colors, drawn.title, {}, &paper);
      files.push_back(a.frames > 0 ? frame_name(a.output, k) : a.output);
      if (files.size() > 1) console.keep_frames();
      a.picture.write(files.back(), image, look);
    }
    progress.finish();
    say_flow_surface(surface, flow, console);
    console.say(
        fmt::format("{}: {} × {} pixels", files.size() == 1 ? files[0] : a.output, look.width + bars, look.height));
    console.say_json({{"input", flow.json()},
                      {"surface", flow_surface_json(surface)},
                      {"output", {{"files", files}, {"width", look.width + bars}, {"height", look.height}}}});
  } catch (const DataError& error) {
    throw flow.error(error);
  }
  console.print_timings();
}

}  // namespace

Command add_flow_render(CommandLine& flow) {
  CommandLine& c = flow.add_subcommand("render", "Flow and a seed curve → picture of the surface, with streaks");
  auto shared = std::make_shared<FlowRenderArguments>();
  FlowRenderArguments& a = *shared;
  add_flow_surface_input(c, a.input);
  c.add_option("-o,--output", a.output, "Picture to write: .png").type_name("FILE").required();
  const char* const look = "Look";
  c.add_flag("--smooth", a.smooth, "Without streaks along the flow (line integral convolution)").group(look);
  c.add_option("--streak-length", a.streaks.streak_length, "Of the streaks, 1..1000 [40]")
      .type_name("PIXELS")
      .group(look);
  c.add_option("--streak-width", a.streaks.streak_width, "Of the streaks, 0.5..100 [1.5]")
      .type_name("PIXELS")
      .group(look);
  c.add_option("--streak-contrast", a.streaks.streak_contrast, "Of the streaks, 0..1 [0.4]")
      .type_name("SHARE")
      .group(look);
  c.add_flag("--splats", a.look.splats, "Particles as discs that blend, as in the source, not the mesh").group(look);
  c.add_option("--opacity", a.look.opacity, "Of the surface where it is seen at right angles, 0..1 [1]")
      .type_name("SHARE")
      .group(look);
  c.add_option("--arrows", a.arrows,
               "Arrows along the flow, so far apart, as --arrows=0.1 [0 or no value: from the surface's size]")
      .type_name("LENGTH")
      .without_value("0")
      .group(look);
  c.add_option("--color-by", a.color_by, "time, speed, seed (place on the curve), none, or another array [time]")
      .type_name("NAME")
      .group(look);
  c.add_option("--frames", a.frames, "So many pictures, NAME_000.png, …, in which the streaks move with the flow")
      .type_name("COUNT")
      .group(look);
  c.add_option("--turn", a.turn, "With --frames: by so much the view goes around [0]").type_name("DEGREES").group(look);
  const char* const beside = "Beside the surface";
  c.add_option("--volume", a.volume, "Array that is seen through around it").type_name("NAME").group(beside);
  c.add_option("--volume-preset", a.preset, "Its colours and opacities, as of volume render")
      .type_name("NAME")
      .group(beside);
  c.add_option("--volume-opacity", a.volume_opacity, "Multiplies its opacity [1]").type_name("FACTOR").group(beside);
  c.add_option("--iso", a.isos,
               "Surface of a value of that array (else of the speed): V, V:#rrggbb, V:#rrggbb:OPACITY; may be repeated")
      .type_name("VALUE")
      .repeated()
      .group(beside);
  a.contents.add_options(c);
  c.add_flag("--no-bar", a.no_bar, "Without the colour bar").group("Picture");
  c.add_option("--label", a.label, "Of the colour bar: what is shown [what --color-by says]")
      .type_name("TEXT")
      .group("Picture");
  c.add_option("--unit", a.unit, "Of what is shown, at the colour bar").type_name("UNIT").group("Picture");
  c.add_option("--title", a.title, "Above the picture").type_name("TEXT").group("Picture");
  add_background_option(c, a.background);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(std::string(kFlowsByFormula) +
           "Examples:\n"
           "  sansmesh flow render office.vtk --seeds 'line(0.5,0.5,1, 4,4,1, 200)' -o stream.png --mesh walls.ply\n"
           "  sansmesh flow render tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.2, 100)' --time 5 -o t.png "
           "--opacity 0.5\n"
           "  sansmesh flow render eddies.nek5000 --unsteady --seeds 'line(1,1,0, 5,5,0, 200)' -o path.png "
           "--frames 24");
  return {&c, [shared](Console& console) { run_flow_render(*shared, console); }};
}

}  // namespace sansmesh::cli
