#include "cli/line/height_output.h"

#include <fmt/core.h>

#include <filesystem>

#include "cli/line/command_line.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/file_reports.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/points/cloud_files.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::cli {

const ReportSchema& WrittenHeights::schema() {
  static constexpr ReportRow rows[] = {reported<&WrittenHeights::file>({.text = "Height grid, or a tile of it"}),
                                       reported<&WrittenHeights::cells>({.text = "Cells in the file"})};
  return report_schema<rows>();
}

bool HeightOutput::is_grid(const std::string& file) {
  const std::string name = lower_case(file);
  return name.ends_with(".tif") || name.ends_with(".tiff");
}

void HeightOutput::check(const std::string& output, std::optional<double> tile_size,
                         const std::vector<std::string>& inputs) const {
  options.validate();
  HeightGridUse{tile_size, {}}.validate(options);
  if (!is_grid(output)) {
    require(breaklines.empty() && contours.empty() && hillshade.empty() && options_set(options).empty(),
            "--cell, --gap, --interval, --breaklines, --contours and --hillshade need a height grid: -o FILE.tif");
    return;
  }
  std::vector<std::string> all = io::list_cloud_files(inputs);
  all.push_back(breaklines);
  check_inputs_stay(all, {output, contours, hillshade});
  check_writable(output, "text");
  if (!contours.empty()) check_contours_writable(contours);
  if (!hillshade.empty()) check_writable(hillshade, "image");
}

HeightGridUse HeightOutput::use(std::optional<double> tile_size, Console& console) const {
  HeightGridUse made{tile_size, {}};
  if (breaklines.empty()) return made;
  ReadReport read;
  made.breaklines = read_lines(breaklines, &read);
  console.warn(breaklines, read.warnings);
  for (const std::string& what : read.unread) console.warn(breaklines, {"not read: " + what});
  if (made.breaklines.size() == 0) throw FileError(breaklines, "holds no lines (.dxf, .obj and .vtp files may)");
  return made;
}

void HeightOutput::write(const std::string& output, const HeightGridResult& made, std::optional<double> tile_size,
                         const std::vector<std::string>& inputs, std::vector<std::string>& summary,
                         Console& console) const {
  console.progress().begin("write");
  console.report(made.report, "heights");
  std::vector<WrittenHeights> files;
  const auto write_grid = [&](const std::string& file, const HeightGrid& grid) {
    write_height_grid(file, grid);
    files.push_back({file, grid.heights.pixels.size()});
  };
  const std::string words = summary_of(made.report)[0];
  if (tile_size) {
    const std::vector<HeightTile> tiles = split_height_grid(made.grid, *tile_size);
    std::vector<std::string> places;
    places.reserve(tiles.size());
    for (const HeightTile& tile : tiles) places.push_back(tile.place);
    const std::vector<std::string> names = names_of_parts(output, tiles.size(), places, inputs, console);
    for (std::size_t k = 0; k < tiles.size(); ++k) write_grid(names[k], tiles[k].grid);
    summary.push_back(fmt::format("{}: {}, in {} of {:.10g}", WrittenPictures{names}.words(), words,
                                  counted(tiles.size(), "tile"), *tile_size));
  } else {
    write_grid(output, made.grid);
    summary.push_back(output + ": " + words);
    console.report_value("heights.file", output);
  }
  console.report(files, "heights.files");
  if (!contours.empty()) {
    const std::size_t lines = write_contours(contours, made.grid, made.report.interval);
    summary.push_back(
        fmt::format("{}: {}, every {:.6g}", contours, counted(lines, "contour line"), made.report.interval));
    console.report_value("contours.file", contours);
    console.report_value("contours.lines", lines);
  }
  if (hillshade.empty()) return;
  const Image picture = hillshade_of(made.grid);
  write_image(hillshade, picture);
  const WrittenPictures written{{hillshade}, picture.width, picture.height};
  summary.push_back(written.size_line());
  console.report_value("hillshade.file", hillshade);
}

void add_height_output(CommandLine& c, HeightOutput& o, bool of_samples) {
  add_schema(c, o.options,
             {.group = "Height grid",
              .without = of_samples ? std::vector<std::string_view>() : std::vector<std::string_view>{"gap"}});
  if (of_samples)
    c.add_option("--breaklines", o.breaklines, "Lines at which height or slope jumps: .dxf .obj .vtp")
        .reads({".dxf", ".obj", ".vtp"})
        .group("Height grid");
  c.add_option("--contours", o.contours, "Contour lines of the height grid to write (.svg .dxf .vtp .ply .csv)")
      .writes({".svg", ".dxf", ".vtp", ".ply", ".csv"})
      .group("Height grid");
  c.add_option("--hillshade", o.hillshade, "Picture of the height grid, lit from the north-west, to write (.png)")
      .writes({".png"})
      .group("Height grid");
  c.announce({report_of<HeightGridReport>("heights"), value_of<std::string>("heights.file", "Height grid"),
              reports_of<WrittenHeights>("heights.files"), value_of<std::string>("contours.file", "Contour lines"),
              value_of<std::size_t>("contours.lines", "Number of contour lines"),
              value_of<std::string>("hillshade.file", "Picture of the height grid")});
}

std::vector<std::string> names_of_parts(const std::string& output, std::size_t parts,
                                        const std::vector<std::string>& places, const std::vector<std::string>& inputs,
                                        Console& console) {
  std::vector<std::string> names(parts);
  for (std::size_t k = 0; k < parts; ++k)
    names[k] = places.empty() ? part_name(output, k + 1, parts) : tile_name(output, places[k]);
  check_inputs_stay(io::list_cloud_files(inputs), names);
  if (!places.empty()) {
    const std::vector<std::string> others = other_tiles(output, names);
    if (!others.empty())
      console.warn(others[0], {(others.size() > 1 ? "and " + counted(others.size() - 1, "other file") + " are tiles"
                                                  : std::string("is a tile")) +
                               " of another run: read with the new ones, samples count twice"});
    return names;
  }
  std::error_code none;
  const std::string beyond = part_name(output, parts + 1, parts);
  if (std::filesystem::exists(beyond, none))
    console.warn(beyond, {"is not one of the " + counted(parts, "part") + ", and existed before"});
  return names;
}

}  // namespace sansmesh::cli
