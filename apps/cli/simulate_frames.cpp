#include "simulate_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "picture_options.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/write_tets.h"

namespace sansmesh::cli {
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

/// With the .pvd of all frames, or if not all can be written, of those that are.
std::vector<std::string> write_tet_frames(const std::string& output, const Motion& motion, Console& console) {
  std::vector<std::string> files;
  std::vector<TimedFile> series;
  series.reserve(motion.frames());
  for (std::size_t k = 0; k < motion.frames(); ++k)
    series.push_back({motion.time(k), std::filesystem::path(motion_frame_name(output, k)).filename().string()});
  // First of all, so that there is room for it when the disk is full.
  const std::string collection = std::filesystem::path(output).replace_extension(".pvd").string();
  write_collection(collection, series);
  TetMesh frame = motion.rest();
  const std::vector<Vec3> at_rest = motion.positions(0);  // rounded as those of all frames
  console.progress().begin("writing tetrahedra", motion.frames());
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
      if (k > 0) console.keep_frames();
      write_tets(files.back(), frame);
      console.progress().advance();
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

}  // namespace

std::string motion_frame_name(const std::string& output, std::size_t frame) { return frame_name(output, frame, 4); }

bool SimulateArguments::draws() const { return !animation.empty() || any_ends_with(outputs, "png"); }
bool SimulateArguments::writes_tets() const { return any_ends_with(outputs, "vtu"); }

void SimulateArguments::check() const {
  require(!outputs.empty() || !animation.empty() || !energies.empty(),
          "nothing would be written: --output, --animation or --energies is wanted");
  for (const std::string& o : outputs) check_frames_writable(o);
  if (!animation.empty()) check_writable(animation, "image");
  if (!energies.empty()) check_writable(energies, "text");
  require(volume_file.empty() || draws(), "--embedded-volume needs pictures: --output NAME.png or --animation");
  require(!volume_file.empty() || (colors.usual() && volume.array.empty()),
          "--array, --preset, --transfer, --opacity-factor and --iso belong to --embedded-volume");
  options.validate();
  picture.chosen().validate();
  picture.check_frames(true);
}

void SimulateArguments::check_overwriting(std::size_t frames) const {
  const auto place = [](const std::string& file) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(file, ignored);
  };
  std::set<std::filesystem::path> inputs;
  for (const std::string& file : {tets, forces, fixed, surface, volume_file, colors.transfer})
    if (!file.empty()) inputs.insert(place(file));
  const auto check = [&](const std::string& file) {
    if (inputs.contains(place(file))) throw FileError(file, "is an input, which a result would overwrite");
  };
  for (const std::string& o : outputs)
    for (std::size_t k = 0; k < frames; ++k) check(motion_frame_name(o, k));
  if (!animation.empty()) check(animation);
  if (!energies.empty()) check(energies);
}

std::vector<std::string> write_outputs(const SimulateArguments& a, const Motion& motion, const CarriedSurface& surface,
                                       PicturesToDraw& draw, Console& console) {
  Progress& progress = console.progress();
  std::vector<std::string> files;
  for (const std::string& o : a.outputs) {
    if (io::ending(o) == "png") continue;
    if (io::ending(o) == "vtu") {
      for (std::string& file : write_tet_frames(o, motion, console)) files.push_back(std::move(file));
      continue;
    }
    progress.begin("writing meshes", motion.frames());
    for (std::size_t k = 0; k < motion.frames(); ++k) {
      files.push_back(motion_frame_name(o, k));
      if (k > 0) console.keep_frames();
      write_mesh(files.back(), surface.at(motion, k), {.ascii = a.ascii});
      progress.advance();
    }
  }
  if (!draw.pictures) return files;
  for (std::size_t k = 0; k < motion.frames(); ++k) {
    const Image image = a.picture.part(draw.pictures->draw(k, progress), a.picture.chosen());
    for (const std::string& o : a.outputs)
      if (io::ending(o) == "png") {
        files.push_back(motion_frame_name(o, k));
        if (k > 0) console.keep_frames();
        write_image(files.back(), image);
      }
    if (draw.animation) draw.animation->add(image);
  }
  if (draw.animation) {
    draw.animation->write(a.animation);
    files.push_back(a.animation);
  }
  return files;
}

}  // namespace sansmesh::cli
