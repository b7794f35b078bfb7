// The commands: arguments in, an exit code out. Errors are thrown; main() turns them into one line and a code.
#pragma once

#include <optional>
#include <string>

#include "command.h"
#include "console.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/render/mesh_preview.h"
#include "sansmesh/render/surface_picture.h"
#include "sansmesh/surface/curvature.h"
#include "sansmesh/surface/lop.h"
#include "sansmesh/surface_model.h"

namespace sansmesh::cli {

struct ReconstructArguments {
  std::string input, output, preview;
  bool ascii = false;
  ReconstructOptions options;
};
void run_reconstruct(const ReconstructArguments& arguments, Console& console);

struct NormalsArguments {
  std::string input, output;
  bool ascii = false;
  bool keep = false;  ///< orient the file's normals instead of estimating new ones
  bool orient = true;
  NormalOptions options;
};
void run_normals(const NormalsArguments& arguments, Console& console);

struct EvaluateArguments {
  std::string surface, reference;
  std::size_t samples = 300000;
};
void run_evaluate(const EvaluateArguments& arguments, Console& console);

struct InfoArguments {
  std::string input;
};
void run_info(const InfoArguments& arguments, Console& console);

struct RenderArguments {
  std::string input, output;
  RenderOptions options;
  std::optional<SurfaceOptions> surface;  ///< cast rays at this surface of the samples
  SurfaceRenderOptions surface_options;   ///< what it has beyond `options`
  std::string color_by;                   ///< mean, gaussian, k1, k2: curvature as colour; empty: the samples' colours
  std::optional<double> color_range;      ///< curvature with the full colour
  int frames = 0;                         ///< of a turntable; 0: one picture
};
void run_render(const RenderArguments& arguments, Console& console);
void run_surface_picture(const RenderArguments& arguments, Console& console);

struct ProjectArguments {
  std::string input, onto, output;
  std::string method = "curvature";  ///< a projection, an implicit surface, or lop
  bool ascii = false;
  SurfaceOptions surface;
  LopOptions lop;
  int steps = 10;
  double tolerance = 1e-3;            ///< over the spacing
  std::optional<std::size_t> points;  ///< resample to about so many
};
void run_project(const ProjectArguments& arguments, Console& console);

struct CurvatureArguments {
  std::string input, output, preview;
  std::string color_by = "mean";
  std::optional<double> color_range;
  bool ascii = false;
  CurvatureOptions options;
};
void run_curvature(const CurvatureArguments& arguments, Console& console);

struct AdviseArguments {
  std::string input;
};
void run_advise(const AdviseArguments& arguments, Console& console);

Command add_csg(CLI::App& app);
Command add_fit(CLI::App& app);
Command add_mesh(CLI::App& app);
Command add_eval(CLI::App& app);
Command add_edit(CLI::App& app);
Command add_diagnose(CLI::App& app);
Command add_section(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_measure(CLI::App& app);

/// Throws FileError early if no function file of that name can be written.
void check_function_writable(const std::string& file);

}  // namespace sansmesh::cli
