// sansmesh render: a picture of a mesh, a cloud or a function.
#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/io.h"
#include "sansmesh/surface_function.h"
#include "schema_options.h"
#include "surface_options.h"

namespace sansmesh::cli {
namespace {

struct RenderArguments {
  CloudInput input;
  std::string output;
  PictureArguments picture;
  std::string background = "gradient";
  SurfaceArguments of_samples;
  PictureOptions options;
  bool as_one = false;
};

struct WrittenPictures {
  std::vector<std::string> files;
  int width = 0, height = 0;
};

PictureOptions complete_options(const RenderArguments& a) {
  PictureOptions options = a.options;
  options.look.picture = a.picture.chosen();
  set_background(options.look.picture, a.background);
  options.surface = a.of_samples.chosen();
  options.validate();
  return options;
}

/// The files of each object.
std::vector<CloudInput> inputs_of(const RenderArguments& a, const PictureOptions& options) {
  if (a.as_one || options.surface || options.splats) return {a.input};
  std::vector<CloudInput> inputs(a.input.files.size(), a.input);
  for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i].files = {a.input.files[i]};
  return inputs;
}

PictureObject open_object(const CloudInput& input, bool with_lines, Console& console, ReadReport& read) {
  const std::string& file = input.files[0];
  PictureObject object{.name = input.name(), .title = std::filesystem::path(file).filename().string()};
  if (input.is_function()) {
    read.format = "function";
    object.function = read_function(file);
    return object;
  }
  object.points = input.read(console, read);
  if (with_lines && input.files.size() == 1 && (file.ends_with(".vtp") || file.ends_with(".vtp.gz")))
    object.lines = read_lines(file);
  return object;
}

void say_surface(const RenderArguments& a, const RenderReport& r, const ReadReport& read, Console& console,
                 Json& json) {
  const SurfaceReport& s = *r.surface;
  const SurfaceMethod& method = surface_method(s.method);
  console.say(fmt::format("{}: {}, {}, spacing {}, noise {}", a.input.name(), counted(s.samples, "sample"), method.name,
                          length(s.spacing), length(s.noise)));
  if (s.smoothing > 0)
    console.say(fmt::format(
        "weights {:.2f} spacings wide{}", s.smoothing,
        method.uses_option("order")
            ? fmt::format(", order {}, {}", s.order, counted(static_cast<unsigned>(s.iterations), "iteration"))
            : std::string()));
  json["input"] = a.input.json();
  json["input"]["format"] = read.format;
  json["input"]["samples"] = s.samples;
  json["surface"] = {{"method", method.name},    {"spacing", s.spacing}, {"noise", s.noise},
                     {"smoothing", s.smoothing}, {"order", s.order},     {"iterations", s.iterations}};
  if (r.splats) json["splats"] = *r.splats;
  if (r.rays)
    json["rays"] = {{"cast", r.rays->rays},
                    {"hit", r.rays->hits},
                    {"evaluations", r.rays->hit_evaluations + r.rays->miss_evaluations}};
  for (const Progress::Timing& t : console.progress().timings())
    json["stages"].push_back({{"stage", t.stage}, {"wall_s", t.wall_seconds}, {"cpu_s", t.cpu_seconds}});
}

Json objects_json(const std::vector<DrawnObject>& objects, const std::vector<CloudInput>& inputs) {
  Json list = Json::array();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const DrawnObject& o = objects[i];
    Json json = inputs[i].json();
    json["kind"] = object_word(o.kind);
    json["name"] = o.title;
    json["color"] = o.color;
    json["opacity"] = o.opacity;
    list.push_back(std::move(json));
  }
  return list;
}

void report_pictures(const WrittenPictures& p, const RenderReport& r, Console& console, Json& json) {
  const std::string size = fmt::format("{} × {} pixels", p.width, p.height);
  const std::string of = r.objects.empty() ? size : fmt::format("{}, {}", counted(r.objects.size(), "object"), size);
  console.say(p.files.size() == 1 ? p.files[0] + ": " + of
                                  : fmt::format("{} … {}: {} each", p.files.front(), p.files.back(), of));
  json["output"] = {{"files", p.files}, {"width", p.width}, {"height", p.height}};
  if (p.files.size() == 1) json["output"]["file"] = p.files[0];
  console.say_json(json);
  console.print_timings();
}

void run_render(const RenderArguments& a, Console& console) {
  const PictureOptions options = complete_options(a);
  a.picture.check_frames(options.frames.has_value());
  check_writable(a.output, "image");
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const std::vector<CloudInput> inputs = inputs_of(a, options);
  std::vector<PictureObject> objects;
  objects.reserve(inputs.size());
  for (const CloudInput& input : inputs)
    objects.push_back(open_object(input, !options.surface && !options.splats, console, read));
  WrittenPictures written;
  const auto write = [&](std::size_t frame, const Image& image, const RenderOptions& made_with) {
    written.files.push_back(options.frames ? frame_name(a.output, frame) : a.output);
    if (written.files.size() > 1) console.keep_frames();
    progress.begin("write");
    const Image part = a.picture.write(written.files.back(), image, made_with);
    written.width = part.width, written.height = part.height;
  };
  const RenderResult made = render(std::move(objects), options, write, progress);
  progress.finish();
  console.note(a.input.name(), made.notes);
  Json json;
  if (made.report.surface) say_surface(a, made.report, read, console, json);
  if (!made.report.objects.empty()) json["objects"] = objects_json(made.report.objects, inputs);
  report_pictures(written, made.report, console, json);
}

}  // namespace

Command add_render(CommandLine& app) {
  CommandLine& c = app.add_subcommand("render", "Mesh, points or function → picture");
  auto shared = std::make_shared<RenderArguments>();
  RenderArguments& a = *shared;
  c.add_option("input", a.input.files,
               "Meshes, points or functions (.smf): several are objects of one picture, but with --as-one or --surface")
      .type_name("FILE")
      .required();
  add_class_options(c, a.input);
  c.add_option("-o,--output", a.output, "Picture to write: .png").type_name("FILE").required();
  add_picture_options(c, a.picture);
  add_background_option(c, a.background);
  add_schema(c, a.picture.options, {.group = "Picture", .only = {"smooth", "shadows"}});
  add_schema(c, a.picture.options, {.group = "Picture", .only = {"antialiasing"}});
  add_schema(c, a.picture.options, {.group = "Picture", .only = {"point_radius"}});
  add_surface(c, a.of_samples, a.options.cloud, "Cast rays at this surface of the samples, without a mesh");
  add_wireframe_options(c, a.picture.options);
  add_line_options(c, a.picture);
  add_accessibility_options(c, a.picture);
  add_schema(c, a.options, {.group = "Objects", .only = {"color", "opacity", "name", "legend"}});
  c.add_flag("--as-one", a.as_one, "Several files (tiles) are one object").group("Objects");
  add_schema(c, a.options, {.group = "Colours", .only = {"color_by", "color_range", "bar", "unit"}});
  const std::vector<std::string_view> of_light = {"reflection", "transmission", "refraction_index"};
  add_schema(c, a.options.look, {.group = "Surface", .only = of_light});
  add_schema(c, a.options, {.group = "Surface", .only = {"rays"}});
  add_schema(c, a.options.look, {.group = "Surface", .only = {"exact_shadows", "quick"}});
  add_schema(c, a.options, {.group = "Surface", .only = {"splats", "frames"}});
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh render surface.ply -o surface.png --view front\n"
           "  sansmesh render part.stl -o part.png --orthographic --scale-bar=mm --wireframe\n"
           "  sansmesh render a.ply b.ply scan.smf -o all.png --color red --color '#4080ff' --opacity 1 --opacity 0.4\n"
           "  sansmesh render curved.ply -o k1.png --color-by k1 --look-at 1,0,2 --look-radius 0.5\n"
           "  sansmesh render scan.ply -o scan.png --surface apss\n"
           "  sansmesh render scan.ply -o splats.png --splats\n"
           "  sansmesh render mesh.ply -o drawing.png --lines\n"
           "  sansmesh render mesh.ply -o open.png --accessibility\n"
           "  sansmesh render part.xyz -o part.png --surface amls --sharp --color-by mean\n"
           "  sansmesh render scan.ply -o turn.png --surface curvature --frames 72");
  return {&c, [shared](Console& console) { run_render(*shared, console); }};
}

}  // namespace sansmesh::cli
