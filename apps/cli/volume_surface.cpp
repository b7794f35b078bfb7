// sansmesh volume surface: isosurfaces and surfaces of high gradient straight from the samples of a volume.
#include <fmt/core.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/volume_surface.h"
#include "sansmesh/io/io.h"
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/render/surface_caster.h"
#include "sansmesh/render/surface_picture.h"
#include "sansmesh/render/transfer_presets.h"
#include "sansmesh/surface/bilateral_normals.h"
#include "sansmesh/surface/curvature_colors.h"
#include "sansmesh/volume/volume_values.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

constexpr const char* kCurvatures = "mean, gaussian, k1, k2";

struct VolumeSurfaceArguments {
  VolumeInput input;
  std::optional<double> value;
  bool high_gradient = false, predictor_only = false, corrector_only = false, all_sheets = false;
  bool global_maximum = false, sharp = false, quick = false;
  VolumeSurfaceOptions options;
  MeshOutput mesh;
  MeshOptions meshing;
  std::string output, points, color_by, background = "gradient";
  std::optional<double> distance, color_range;
  PictureArguments picture;
  std::string unit;
  bool no_bar = false;
  SurfaceRenderOptions look;
  int frames = 0;
};

bool is_picture(const std::string& file) { return file.size() > 4 && file.compare(file.size() - 4, 4, ".png") == 0; }

/// Colours by another array of the volume; positions in coordinates of the surface.
class ArrayColors : public ColorField {
 public:
  ArrayColors(std::shared_ptr<const VolumeField> field, const Placement& place)
      : field_(std::move(field)), place_(place) {}
  /// The colours span what the array has at these places.
  void span(std::span<const Vec3> x) { colors_ = transfer_function_preset("flow", value_histogram(values(x))); }
  std::pair<double, double> range() const { return colors_.range(); }
  /// What there is of the array at these places.
  ColorBar bar(std::span<const Vec3> x, const std::string& title) const {
    const std::vector<double> v = values(x);
    const auto [lower, upper] = range();
    ColorBar bar{colors_, title, {}};
    for (const double value : v) {
      bar.ends.below = bar.ends.below || value < lower;
      bar.ends.above = bar.ends.above || value > upper;
    }
    return bar;
  }
  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override {
    const std::vector<double> v = values(x);
    for (std::size_t i = 0; i < x.size(); ++i) colors[i] = colors_.color(v[i]);
  }

 private:
  std::vector<double> values(std::span<const Vec3> x) const {
    std::vector<Vec3> input(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) input[i] = place_.to_input(x[i]);
    std::vector<double> v(x.size());
    field_->evaluate(input, {v, {}, {}, {}});
    return v;
  }

  std::shared_ptr<const VolumeField> field_;
  Placement place_;
  TransferFunction colors_;
};

VolumeSurfaceOptions chosen_options(const VolumeSurfaceArguments& a, OpenVolume& volume) {
  VolumeSurfaceOptions o = a.options;
  o.predictor = !a.corrector_only, o.corrector = !a.predictor_only;
  o.separate_sheets = !a.all_sheets, o.local_maximum = !a.global_maximum;
  if (a.high_gradient) {
    o.kind = VolumeSurfaceOptions::Kind::high_gradient;
    return o;
  }
  const DatasetArray& array = volume.dataset().array(volume.choice().array);
  if (!a.value && (array.components > 1)) throw ArgumentError("--value is needed for arrays of several components");
  o.value = a.value ? *a.value : volume.model().middle_value();
  return o;
}

/// One a sample, finite: of a component, or lengths of vectors.
std::vector<double> chosen_values(const SampledVolume& samples, const ArrayChoice& choice) {
  const VolumeValues all = volume_values(samples, choice.array);
  if (all.components == 1) return all.values;
  std::vector<double> values(samples.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::span<const double> v = all.of(i);
    values[i] = choice.component ? v[*choice.component] : vector_length(v);
  }
  return values;
}

/// The standard deviation of noise: what parabolas through the samples around leave, where planes leave as much.
double noise_of(const VolumeTraits& traits) { return traits.resolved() ? 0 : traits.noise * traits.range; }

void draw(const VolumeSurfaceArguments& a, const VolumeSurface& surface, OpenVolume& volume, Console& console,
          Json& json) {
  Progress& progress = console.progress();
  SurfaceRenderOptions look = a.look;
  static_cast<RenderOptions&>(look) = a.picture.chosen();
  set_background(look, a.background);
  look.plain = a.quick, look.steady = a.frames > 0;
  look.validate();
  a.picture.check_frames(a.frames > 0);
  const Placement& place = surface.place();
  move_from_input(look, place);
  PointSet points;
  if (!a.color_by.empty() || a.sharp) points = surface.feet();
  std::unique_ptr<ColorField> colors;
  std::optional<ColorBar> bar;
  if (is_curvature(a.color_by)) {
    CurvatureColorOptions o;
    o.quantity = curvature_quantity(a.color_by);
    if (a.color_range) o.range = curvature_range(*a.color_range, o.quantity, place.unit);
    auto of_curvature = std::make_unique<CurvatureColors>(points, o, progress);
    bar = curvature_bar(o.quantity, curvature_range(of_curvature->range(), o.quantity, 1 / place.unit), a.unit, true);
    colors = std::move(of_curvature);
  } else if (!a.color_by.empty()) {
    auto of_array = std::make_unique<ArrayColors>(volume.field(scalar_choice(a.color_by, volume, "color_by")), place);
    const std::vector<Vec3> x(points.positions.begin(), points.positions.end());
    of_array->span(x);
    bar = of_array->bar(x, with_unit(a.color_by, a.unit));
    json["colors"] = {{"array", a.color_by}, {"lower", of_array->range().first}, {"upper", of_array->range().second}};
    colors = std::move(of_array);
  }
  std::optional<BilateralNormals> normals;
  SurfaceCastOptions cast;
  if (a.sharp) {
    normals.emplace(prepare_samples(points, progress), BilateralOptions{});
    cast.normals = &*normals;
  }
  const SurfaceCaster caster(surface.field(), surface.balls(), cast);
  if (a.no_bar) bar.reset();
  leave_room(look, bar);
  std::vector<std::string> files;
  Image written;
  const std::vector<ViewDirection> views = turntable(look.view, std::max(1, a.frames));
  for (std::size_t k = 0; k < views.size(); ++k) {
    look.view = views[k];
    files.push_back(a.frames > 0 ? frame_name(a.output, k) : a.output);
    if (files.size() > 1) console.keep_frames();
    written = a.picture.write(
        files.back(),
        beside_bar(render_surface(caster, surface.balls().centers, colors.get(), look, progress), bar, look), look);
  }
  const CastCounts counts = caster.counts();
  json["rays"] = {
      {"cast", counts.rays}, {"hit", counts.hits}, {"evaluations", counts.hit_evaluations + counts.miss_evaluations}};
  json["output"] = {{"files", files}, {"width", written.width}, {"height", written.height}};
  console.say(
      fmt::format("{}: {} × {} pixels", files.size() == 1 ? files[0] : a.output, written.width, written.height));
}

void run_volume_surface(VolumeSurfaceArguments& a, Console& console) {
  require(!a.output.empty() || !a.points.empty(), "--output or --points is needed");
  require(!(a.high_gradient && a.value), "--value and --high-gradient exclude each other");
  require(!(a.predictor_only && a.corrector_only), "--predictor-only and --corrector-only exclude each other");
  require(a.high_gradient || !(a.global_maximum || a.options.least_gradient),
          "--global-maximum and --least-gradient need --high-gradient");
  require(a.frames == 0 || a.frames >= 2, "--frames must be at least 2");
  const bool picture = is_picture(a.output);
  require(picture || (a.color_by.empty() && a.frames == 0 && !a.sharp),
          "--color-by, --sharp and --frames need a picture");
  require(picture || !a.picture.any(), "options of the picture need one: -o FILE.png");
  require(!a.color_by.empty() || (a.unit.empty() && !a.no_bar), "--unit and --no-bar are of the bar of --color-by");
  require(!a.distance || !a.points.empty(), "--distance needs --points");
  require(!a.distance || *a.distance > 0, "--distance must be positive");
  require(a.output != a.points, "--output and --points are the same file");
  require(!a.color_range || is_curvature(a.color_by), "--color-range needs --color-by with a curvature");
  a.mesh.file = a.output;
  if (picture)
    check_writable(a.output, "image");
  else if (!a.output.empty())
    a.mesh.check();
  if (!a.points.empty()) check_writable(a.points, "points");

  a.meshing.validate();
  if (picture) a.picture.chosen().validate();
  OpenVolume volume(a.input, console);
  Progress& progress = console.progress();
  volume.dataset().default_array();
  const VolumeSurfaceOptions options = chosen_options(a, volume);
  options.validate();
  if (!a.color_by.empty() && !is_curvature(a.color_by)) scalar_choice(a.color_by, volume, "color_by");
  const auto samples = volume.samples();
  const VolumeTraits& traits = volume.model().traits(progress);
  const std::vector<double> values = chosen_values(*samples, volume.choice());
  Json json = {{"input", volume.json()}};
  try {
    const VolumeSurface surface = make_volume_surface(samples, values, noise_of(traits), options, progress);
    const VolumeSurfaceReport& r = surface.report();
    console.say(fmt::format(
        "{}: {}, {} of {} ({})", a.input.name(),
        a.high_gradient ? fmt::format("steepest {}, from {:.4g} per length", volume.array_name(), r.least_gradient)
                        : fmt::format("{} = {:.6g}{}", volume.array_name(), options.value,
                                      a.value ? "" : " (the middle of its range)"),
        counted(r.samples, "sample"), grouped(samples->size()), samples->facts.grid));
    console.say(fmt::format("spacing {}, weights {:.2f} spacings wide{}", length(r.spacing), r.smoothing,
                            r.noise_distance > 0
                                ? fmt::format(", noise moves the surface by {}", length(r.noise_distance))
                                : std::string()));
    if (!samples->lattice && traits.resolved())
      console.say("the values are smooth between samples: sansmesh volume isosurface follows them more closely");
    json["surface"] = {{"kind", a.high_gradient ? "high-gradient" : "isovalue"},
                       {"samples", r.samples},
                       {"spacing", r.spacing},
                       {"smoothing", r.smoothing},
                       {"slope", r.slope},
                       {"noise", r.noise},
                       {"beta", r.beta ? Json(*r.beta) : Json()},
                       {"least_gradient", r.least_gradient}};
    if (!a.high_gradient) json["value"] = options.value;
    std::optional<PointSet> points;
    if (!a.points.empty()) points = sample_volume_surface(surface, a.distance, progress);
    if (picture) {
      draw(a, surface, volume, console, json);
    } else if (!a.output.empty()) {
      MeshReport made;
      const TriangleMesh mesh = mesh_volume_surface(surface, a.meshing, progress, &made);
      console.warn(a.input.name(), made.warnings);
      a.mesh.write(mesh, progress);
      const MeshSize size = measure_size(mesh);
      console.say(fmt::format("{}: {}, {} vertices in {}{}", a.output, counted(mesh.triangles.size(), "triangle"),
                              grouped(mesh.vertices.size()),
                              counted(static_cast<std::size_t>(made.components), "component"),
                              made.open ? ", with borders" : ", closed"));
      console.say(made.open ? fmt::format("area {:.6g}", size.area)
                            : fmt::format("area {:.6g}, volume {:.6g}", size.area, size.volume));
      json["area"] = size.area;
      json["volume"] = made.open ? Json() : Json(size.volume);
      json["output"] = {{"file", a.output},
                        {"vertices", mesh.vertices.size()},
                        {"triangles", mesh.triangles.size()},
                        {"components", made.components},
                        {"closed", !made.open}};
    }
    if (points) {
      write_points(a.points, *points, {});
      console.say(fmt::format("{}: {}", a.points, counted(points->size(), "point")));
      json["points"] = {{"file", a.points}, {"points", points->size()}};
    }
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  progress.finish();
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_volume_surface(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("surface", "Volume on any grid → smooth surface by moving least squares");
  auto shared = std::make_shared<VolumeSurfaceArguments>();
  VolumeSurfaceArguments& a = *shared;
  add_volume_input(c, a.input);
  c.add_option("-o,--output", a.output, "Picture (.png) or mesh (.ply, .obj, .stl, …) to write").type_name("FILE");
  c.add_option("--points", a.points, "Also or only: points spread evenly over the surface, with normals")
      .type_name("FILE");
  c.add_option("--distance", a.distance, "Between these points [the spacing of the samples]").type_name("LENGTH");
  c.add_option("--value", a.value, "Isosurface of this value [the middle of the array's range]").type_name("NUMBER");
  c.add_flag("--high-gradient", a.high_gradient, "Where the array changes most: borders of materials, at any value");
  const char* const weights = "Weights";
  c.add_option("--beta", a.options.beta,
               "Width of the weights: of values in their unit [by the slope at each sample], of gradients as a share, "
               "0.01..1 [0.35]")
      .type_name("NUMBER")
      .group(weights);
  c.add_option("--smoothing", a.options.smoothing,
               "h of the weights by distance, in spacings, 0.5..20 [2, more with noise]")
      .type_name("NUMBER")
      .group(weights);
  c.add_option("--least-gradient", a.options.least_gradient, "Of a border, with --high-gradient [from the noise]")
      .type_name("NUMBER")
      .group(weights);
  c.add_flag("--global-maximum", a.global_maximum,
             "With --high-gradient: gradients over the largest of the volume, not of the surroundings")
      .group(weights);
  c.add_flag("--predictor-only", a.predictor_only, "Quick: without the weights by distance").group(weights);
  c.add_flag("--corrector-only", a.corrector_only, "Without the first guess").group(weights);
  c.add_flag("--alternating", a.options.alternating, "Predictor: direction and offset in turns, as in the source")
      .group(weights);
  c.add_flag("--line-search", a.options.line_search, "Corrector: offset by minimisation along the normal")
      .group(weights);
  c.add_flag("--all-sheets", a.all_sheets, "Samples count wherever they face").group(weights);
  c.add_flag("--exact", a.options.exact,
             "Pictures and meshes project at every place, not from paraboloids at the feet of samples")
      .group(weights);
  c.add_option("--color-by", a.color_by, fmt::format("Array of the volume, or curvature: {}", kCurvatures))
      .type_name("NAME")
      .group("Picture");
  add_color_range(c, a.color_range, "Picture");
  c.add_flag("--sharp", a.sharp, "Normals turn sharply at edges and corners").group("Picture");
  c.add_flag("--quick", a.quick, "One ray a pixel, no shadows").group("Picture");
  add_background_option(c, a.background);
  c.add_option("--frames", a.frames, "Turntable: so many pictures around the up axis, NAME_000.png, …")
      .type_name("COUNT")
      .group("Picture");
  add_picture_options(c, a.picture);
  add_bar_options(c, a.no_bar, a.unit, "the array, or of lengths in curvatures");
  c.add_option("--mesh-error", a.meshing.mesh_error, "Accepted mean distance between mesh and surface")
      .type_name("LENGTH")
      .group("Mesh");
  c.add_option("--triangles", a.meshing.triangles, "At most this many triangles").type_name("COUNT").group("Mesh");
  c.add_option_function(
       "--components", [shared](const std::string& text) { shared->meshing.components = parse_components(text); },
       "Parts to keep: auto (all that the weights can tell), all, largest or a number [auto]")
      .type_name("CHOICE")
      .group("Mesh");
  c.add_flag("--ascii", a.mesh.ascii, "Write text, not binary").group("Mesh");
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume surface head.mhd --value 1150 -o skull.png\n"
           "  sansmesh volume surface engine.nrrd --high-gradient -o engine.ply\n"
           "  sansmesh volume surface fire.vtu --array t --value 1000 --color-by mfrac -o hot.png");
  return {&c, [shared](Console& console) { run_volume_surface(*shared, console); }};
}

}  // namespace sansmesh::cli
