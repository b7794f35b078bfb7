#include "simulate_frames.h"

#include <filesystem>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/write_tets.h"

namespace sansmesh::cli {
namespace {

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

std::vector<std::string> write_outputs(const SimulateArguments& a, const Motion& motion, const CarriedSurface& surface,
                                       const DynamicsScene& scene, PicturesToDraw& draw, Console& console) {
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
  draw.pictures->frame(scene);
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
