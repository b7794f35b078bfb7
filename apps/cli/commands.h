// The commands: arguments in, an exit code out. Errors are thrown; main() turns them into one line and a code.
#pragma once

#include <optional>
#include <string>

#include "console.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/render/mesh_preview.h"

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
};
void run_render(const RenderArguments& arguments, Console& console);

}  // namespace sansmesh::cli
