// A job with its options and its command: moves points along an axis.
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/line/command.h"
#include "cli/line/schema_options.h"
#include "cli/report/file_reports.h"
#include "sansmesh/io.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {
namespace {

enum class Axis { x, y, z };
constexpr std::string_view kAxes[] = {"x", "y", "z"};

struct ShiftOptions {
  double distance = 1;  ///< length
  Axis axis = Axis::z;

  static const OptionSchema& schema();
};

constexpr OptionRow kRows[] = {
    option<&ShiftOptions::distance>({.text = "How far all points move", .unit = "length", .range = {-1e6, 1e6}}),
    option<&ShiftOptions::axis>({.text = "Along which axis", .choices = kAxes})};
constexpr OptionSchema kSchema{kRows};

const OptionSchema& ShiftOptions::schema() { return kSchema; }

PointSet shift(PointSet points, const ShiftOptions& options, Progress& progress) {
  validate_options(options);
  progress.check();
  points.origin[static_cast<std::size_t>(options.axis)] += options.distance;
  return points;
}

struct ShiftArguments {
  cli::CloudInput input;
  std::string output;
  ShiftOptions options;
};

cli::Command add_shift(cli::CommandLine& app) {
  cli::CommandLine& c = app.add_subcommand("shift", "Points → the same points elsewhere");
  auto a = std::make_shared<ShiftArguments>();
  cli::add_cloud_input(c, a->input, "Points");
  c.add_option("-o,--output", a->output, "Points to write").writes().required();
  cli::add_schema(c, a->options);
  c.announce({cli::report_of<cli::WrittenPoints>("output")});
  return {&c, [a](cli::Console& console) {
            ReadReport read;
            const PointSet moved = shift(a->input.read(console, read), a->options, console.progress());
            write_points(a->output, moved);
            console.report(cli::WrittenPoints{a->output, moved.size()}, "output");
          }};
}

const Registered<cli::CommandEntry> command({.name = "shift", .add = add_shift});

}  // namespace
}  // namespace sansmesh::inline v1
