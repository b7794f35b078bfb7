#include "sansmesh/jobs/motion/motion_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/animation.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/tets/write_tets.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::inline v1 {
namespace {

bool any_ends_with(const std::vector<std::string>& outputs, const char* ending) {
  return std::any_of(outputs.begin(), outputs.end(), [&](const std::string& o) { return io::ending(o) == ending; });
}

void check_frames_writable(const std::string& output) {
  const std::string first = motion_frame_name(output, 0), ending = io::ending(output);
  if (ending == "vtu") return check_tets_writable(first);
  if (ending == "png") return check_writable(first, "image");
  if (!is_written(first, "mesh"))
    throw FileError(
        output,
        fmt::format("no writer for frames with the ending '.{}'; known: .vtu, {} (the surface), .png (pictures)",
                    ending, fmt::join(endings_written(kMesh), " ")));
  check_writable(first, "mesh");
}

/// Collection file of all tetrahedral frames: NAME.pvd for NAME.vtu.
std::string collection_of(const std::string& output) {
  return std::filesystem::path(output).replace_extension(".pvd").string();
}

/// Also writes the .pvd of all frames or, after an error, of those that were written.
std::vector<std::string> write_tet_frames(const std::string& output, const Motion& motion, const MotionUse& use,
                                          Progress& progress) {
  std::vector<std::string> files;
  std::vector<TimedFile> series;
  series.reserve(motion.frames());
  for (std::size_t k = 0; k < motion.frames(); ++k)
    series.push_back({motion.time(k), std::filesystem::path(motion_frame_name(output, k)).filename().string()});
  // Written first to reserve its space on the disk.
  const std::string collection = collection_of(output);
  write_collection(collection, series);
  TetMesh frame = motion.rest();
  const std::vector<Vec3> at_rest = motion.positions(0);  // rounded like all frames
  progress.begin("writing tetrahedra", motion.frames());
  std::size_t k = 0;
  try {
    for (; k < motion.frames(); ++k) {
      frame.vertices = motion.positions(k);
      std::vector<float> velocity, displacement;
      for (std::size_t v = 0; v < frame.vertices.size(); ++v) {
        const Vec3f u = motion.velocities(k)[v], d = Vec3f(frame.vertices[v] - at_rest[v]);
        velocity.insert(velocity.end(), {u.x, u.y, u.z});
        displacement.insert(displacement.end(), {d.x, d.y, d.z});
      }
      frame.attributes.set("velocity", std::move(velocity), 3);
      frame.attributes.set("displacement", std::move(displacement), 3);
      files.push_back(motion_frame_name(output, k));
      if (use.before_more && k > 0) use.before_more();
      write_tets(files.back(), frame);
      progress.advance();
    }
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    series.resize(k);
    write_collection(collection, series);
    throw;
  }
  files.push_back(collection);
  return files;
}

std::vector<std::string> write_surfaces(const std::string& output, const Motion& motion, const CarriedSurface& surface,
                                        bool ascii, const MotionUse& use, Progress& progress) {
  std::vector<std::string> files;
  progress.begin("writing meshes", motion.frames());
  for (std::size_t k = 0; k < motion.frames(); ++k) {
    files.push_back(motion_frame_name(output, k));
    if (use.before_more && k > 0) use.before_more();
    write_mesh(files.back(), surface.at(motion, k), {.ascii = ascii});
    progress.advance();
  }
  return files;
}

void write_pictures(const MotionFiles& m, const Motion& motion, const MotionUse& use, std::vector<std::string>& files,
                    Progress& progress) {
  std::optional<Animation> animation;
  if (!m.animation.empty()) animation.emplace(1 / use.frame_time);
  for (std::size_t k = 0; k < motion.frames(); ++k) {
    Image image = use.pictures->draw(k, progress);
    if (use.part) image = use.part(image);
    for (const std::string& o : m.outputs)
      if (io::ending(o) == "png") {
        files.push_back(motion_frame_name(o, k));
        if (use.before_more && k > 0) use.before_more();
        write_image(files.back(), image);
      }
    if (animation) animation->add(image);
  }
  if (!animation) return;
  animation->write(m.animation);
  files.push_back(m.animation);
}

}  // namespace

bool MotionFiles::draws() const { return !animation.empty() || any_ends_with(outputs, "png"); }

KeptMotion MotionFiles::kept() const {
  return {.positions = draws() || !outputs.empty(), .velocities = any_ends_with(outputs, "vtu")};
}

void MotionFiles::check() const {
  if (outputs.empty() && animation.empty() && energies.empty())
    throw ArgumentError("nothing to write: give `output`, `animation` or `energies`");
  for (const std::string& o : outputs) check_frames_writable(o);
  if (!animation.empty()) check_writable(animation, "image");
  if (!energies.empty()) check_writable(energies, "text");
}

void MotionFiles::check(const SimulationPlan& plan, const std::vector<std::string>& inputs) const {
  std::vector<std::string> names{animation, energies};
  for (const std::string& o : outputs) {
    for (std::size_t k = 0; k < plan.frames; ++k) names.push_back(motion_frame_name(o, k));
    if (io::ending(o) == "vtu") names.push_back(collection_of(o));
  }
  check_inputs_stay(inputs, names);
  if (!animation.empty()) Animation(1 / plan.frame_time);
}

std::vector<std::string> write_motion(const MotionFiles& m, const SimulateResult& made, const CarriedSurface& surface,
                                      const MotionUse& use, Progress& progress) {
  const Motion& motion = made.motion;
  std::vector<std::string> files;
  for (const std::string& o : m.outputs) {
    if (io::ending(o) == "png") continue;
    for (std::string& file : io::ending(o) == "vtu" ? write_tet_frames(o, motion, use, progress)
                                                    : write_surfaces(o, motion, surface, m.ascii, use, progress))
      files.push_back(std::move(file));
  }
  if (m.draws()) write_pictures(m, motion, use, files, progress);
  if (m.energies.empty()) return files;
  write_text(m.energies, made.report.table());
  files.push_back(m.energies);
  return files;
}

}  // namespace sansmesh::inline v1
