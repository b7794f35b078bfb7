#include "cli/input/cloud_input.h"

#include <fmt/core.h>

#include "cli/line/command_line.h"
#include "cli/line/schema_options.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/points/cloud_files.h"
#include "sansmesh/points/ground/classify_ground.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::cli {
namespace {

/// Parses the value of --class or --without-class.
PointClasses classes_of(const std::string& list) {
  try {
    return parse_point_classes(list);
  } catch (const ArgumentError& error) {
    throw ValueError(error.what());
  }
}

}  // namespace

CloudScale::CloudScale(const PointSet& points) : spacing(estimate_spacing(points)), noise(measure_noise(points)) {}

std::string CloudScale::noise_words() const { return sansmesh::noise_words(noise, spacing); }

const ReportSchema& CloudScale::schema() {
  static constexpr ReportRow rows[] = {
      reported<&CloudScale::spacing>({.text = "Spacing of the points", .unit = "length"}),
      reported_inline<&CloudScale::noise>()};
  return report_schema<rows>();
}

std::string CloudInput::name() const {
  if (files.size() == 1) return files[0];
  return fmt::format("{} and {}", files[0], counted(files.size() - 1, "other file"));
}

bool CloudInput::is_function() const {
  if (files.size() != 1 || !is_function_file(files[0])) return false;
  if (classes) throw ArgumentError("--class and --without-class are for points: the input is a function");
  if (part.box || part.resolution)
    throw ArgumentError("--read-box and --read-spacing are for points: the input is a function");
  return true;
}

PointSet CloudInput::read(Console& console, ReadReport& report) const {
  console.progress().begin("read");
  const std::vector<std::string> all = io::list_cloud_files(files);
  PointSet points = read_merged(all, &report, part);
  if (all.size() == 1)
    console.warn(all[0], report.warnings);
  else
    console.warn(report.warnings);
  if (names_system && report.reference) console.print(fmt::format("{}: {}", name(), system_words(*report.reference)));
  if (classes) {
    const std::size_t given = points.size();
    try {
      console.note(name(), select_classes(points, *classes, console.progress()));
    } catch (const DataError& error) {
      throw FileError(name(), console.in_flags(error.what()));
    }
    console.print(fmt::format("{}: {} of {} are of the selected classes", name(), grouped(points.size()),
                              counted(given, "point")));
  }
  return points;
}

template <class Files>
void add_surface_input(CommandLine& c, const std::string& name, Files& files, const std::string& what) {
  c.add_option(name, files, what).reads(endings_read(kPoints | kFunction)).required();
}
template void add_surface_input(CommandLine&, const std::string&, std::string&, const std::string&);
template void add_surface_input(CommandLine&, const std::string&, std::vector<std::string>&, const std::string&);

void add_cloud_input(CommandLine& c, CloudInput& input, const std::string& what, bool as_one) {
  add_surface_input(c, "input", input.files,
                    what + (as_one ? "; several files (tiles), folders, patterns and lists are read as one" : ""));
  add_selection_options(c, input);
}

void add_selection_options(CommandLine& c, CloudInput& input, const std::string& of) {
  c.add_option_function(
       "--class",
       [&input](const std::string& list) {
         const PointClasses wanted = classes_of(list);
         input.classes = input.classes ? *input.classes & wanted : wanted;
         input.with = list;
       },
       "Keep only points" + of + " of these classes, separated by commas: names (ground, building) or numbers (2, 3-5)")
      .type_name("CLASSES")
      .group("Input");
  c.add_option_function(
       "--without-class",
       [&input](const std::string& list) {
         const PointClasses unwanted = classes_of(list);
         input.classes = input.classes ? *input.classes & ~unwanted : ~unwanted;
         input.without = list;
       },
       "Drop points" + of + " of these classes: noise")
      .type_name("CLASSES")
      .group("Input");
  add_schema(c, input.part, {.group = "Input", .before = [of](std::string_view) {
                               return of.empty() ? of : "For points" + of + ": ";
                             }});
}

}  // namespace sansmesh::cli
