// Which method suits these samples? What is measured, what follows from it, and the commands to run.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/advise/traits.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/point_set.h"

namespace sansmesh {

struct Recommendation {
  enum class Aim { mesh, picture, curvature, points } aim;
  std::string surface;  ///< partition or another name of `surface_names`; empty for steps before
  /// Commands of the tool, to be run one after the other.
  std::vector<std::string> commands;
  std::string why;  ///< one sentence
};

struct Advice {
  CloudTraits traits;
  /// What was seen, one line each, in the order of importance.
  std::vector<std::string> findings;
  /// What to do, the first choice first; one entry at least for a mesh, a picture and curvatures each.
  std::vector<Recommendation> recommendations;
  std::vector<std::string> warnings;  ///< of cleaning
};

/// What METHODS §8 and docs/methods/which-method.md say about such traits. Commands name the file `input`.
Advice advise(const CloudTraits& traits, const std::string& input);

/// Both.
Advice advise(const PointSet& points, Progress& progress, const std::string& input = "scan.ply");

/// What the tool calls it: mesh, picture, …
const char* aim_word(Recommendation::Aim aim);

}  // namespace sansmesh
