// Benchmark of pictures of a volume during deformation: frames per second (tejada2008, 6.4.3, on a graphics card).
//
//   benchmark_deformed_frames VOLUME [SIZE] [NODES] [FRAMES] [PRESET] [STEP]
//
// VOLUME is baked once, at its own resolution or, if its longest side has fewer than 256 points, resampled to 256
// first. Then 15 rigid handles lean and rotate its upper end in FRAMES (12) poses. A frame consists of the map with
// NODES (64) points along the longest side, the structure for empty-space leaping, and SIZE × SIZE (512) pixels, one
// ray each, in steps of STEP (3) cells. The effect of half the step is reported in levels of 0..255.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/deform/handles/handle_motion.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/deform/mls/mls_deformation.h"
#include "sansmesh/field/deformed_volume.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "timing.h"

namespace {

using namespace sansmesh;

/// Eight handles fix the lower half, seven at the upper end rotate about its centre as one body.
std::vector<Handle> leaning(const Box3& box) {
  constexpr double kAngle = 0.6;
  const Vec3 c = box.center(), s = box.size();
  std::vector<Handle> handles;
  const auto at = [&](double u, double v, double w) { return box.lower + Vec3{u * s.x, v * s.y, w * s.z}; };
  for (const double w : {0.0, 0.45})
    for (int i = 0; i < 4; ++i) {
      Handle h;
      h.p = h.q = at(i & 1, i / 2, w);
      handles.push_back(h);
    }
  for (const auto& [u, v] :
       {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.5}, {0.5, 0.0}, {0.0, 0.5}}) {
    Handle h;
    h.p = at(u, v, 1);
    const Vec3 d = h.p - c;
    h.q = c +
          Vec3{std::cos(kAngle) * d.x + std::sin(kAngle) * d.z, d.y, -std::sin(kAngle) * d.x + std::cos(kAngle) * d.z};
    h.group = "top";
    handles.push_back(h);
  }
  return handles;
}

std::shared_ptr<const VolumeField> field_of(VolumeDataset& data, Progress& progress) {
  VolumeReconstructionOptions options;
  options.method = "cubic";
  return data.field({data.default_array().name, {}, false}, options, progress);
}

/// The volume, baked, and what all pictures of it share.
struct Subject {
  std::shared_ptr<const VolumeField> baked;
  Box3 box;
  std::vector<Vec3> framed;
  VolumePictureOptions look;
};

Subject open_subject(const std::string& file, int size, const std::string& preset, double step, Progress& progress) {
  VolumeDataset data(read_volume(file));
  std::shared_ptr<const VolumeField> field = field_of(data, progress);
  auto samples = data.volume(data.default_array().name, progress);
  std::unique_ptr<VolumeDataset> finer;
  std::size_t longest = 0;
  for (const std::vector<double>& axis : samples->lattice->axes) longest = std::max(longest, axis.size());
  if (longest < 256) {
    ResampleOptions options;
    options.size = {256};
    GridData grid;
    grid.blocks.push_back(resample_volume(*field, data.default_array().name, options, progress));
    grid.blocks[0].point_arrays.erase("inside");
    finer = std::make_unique<VolumeDataset>(std::move(grid));
    field = field_of(*finer, progress);
    samples = finer->volume(finer->default_array().name, progress);
  }
  const ValueHistogram values = value_histogram(*field, 60000, samples->positions);
  const double begin = process_cpu_seconds();
  const auto baked = std::make_shared<const BakedVolume>(*field, BakeOptions{}, progress);
  fmt::print("{}: {} samples, baked in {:.2f} CPU s, off by {:.3f} % on average; {} threads\n", file, samples->size(),
             process_cpu_seconds() - begin, 100 * baked->report().error_mean, thread_count());
  Subject subject{baked, field->bounds(), {}, {}};
  VolumePictureOptions& look = subject.look;
  look.picture.view.width = look.picture.view.height = size;
  look.picture.quality.samples = 1, look.step = step, look.least_light = 0.02;  // settings of interaction with a handle
  look.picture.view.up = UpAxis::z;
  look.picture.view.direction = {40, 20};
  look.picture.view.steady = true;
  look.transfer =
      preset.empty() ? suggest_transfer_function(values, true).function : transfer_function_preset(preset, values);
  const auto& [lower, upper] = subject.box;
  for (int i = 0; i < 8; ++i)
    subject.framed.push_back({(i & 1 ? upper : lower).x, (i & 2 ? upper : lower).y, (i & 4 ? upper : lower).z});
  return subject;
}

/// The map of a pose on a lattice around the deformed box, which `near` receives.
DisplacementMap map_of_pose(const Subject& s, const std::vector<Handle>& handles, std::size_t nodes, Box3& near,
                            Progress& progress) {
  const MlsDeformation backward(handles, {}), forward(reversed(handles), {});
  std::vector<Vec3> corners(8);
  forward.map(s.framed, {corners, {}, {}, {}});
  for (const Vec3& p : corners) near.extend(p);
  const Vec3 room = Vec3{1, 1, 1} * (0.05 * s.box.diagonal());
  near = {near.lower - room, near.upper + room};
  std::array<std::size_t, 3> sizes{};
  const Vec3 size = near.size();
  for (std::size_t a = 0; a < 3; ++a)
    sizes[a] = std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(static_cast<double>(nodes) * size[a] /
                                                                             std::max({size.x, size.y, size.z}))));
  return displacement_map(backward, near, sizes, progress);
}

void measure(const Subject& s, bool deformed, std::size_t nodes, int frames, Progress& progress) {
  const std::vector<Handle> handles = leaning(s.box);
  Image image;
  double map = 0, picture = 0, rays = 0, all = 0, wall = 0, evaluations = 0;
  for (int k = 0; k <= frames; ++k) {
    const Time start = now();
    const double t0 = start.cpu;
    std::shared_ptr<const VolumeField> seen = s.baked;
    double t1 = t0;
    if (deformed) {
      Box3 near;
      const auto lattice = std::make_shared<const DisplacementMap>(
          map_of_pose(s, handles_at(handles, static_cast<double>(k) / frames), nodes, near, progress));
      t1 = process_cpu_seconds();
      seen = std::make_shared<const DeformedVolume>(s.baked, lattice, std::nullopt, near);
    }
    VolumeSubject subject;
    subject.field = seen.get();
    subject.framed = s.framed;
    const VolumePicture drawn(std::move(subject), progress);
    const double t2 = process_cpu_seconds();
    VolumePictureReport report;
    image = drawn.render(s.look, progress, &report);
    const double t3 = process_cpu_seconds();
    if (k == 0) continue;  // the first run touches new memory
    map += t1 - t0, picture += t2 - t1, rays += t3 - t2, all += t3 - t0;
    wall += now().wall - start.wall;
    evaluations += static_cast<double>(report.evaluations);
  }
  fmt::print(
      "{:10} {:6.3f} CPU s a frame ({:.3f} s): map {:.3f}, preparing {:.3f}, rays {:.3f}; {:.2f} M evaluations\n",
      deformed ? "deformed" : "as it is", all / frames, wall / frames, map / frames, picture / frames, rays / frames,
      evaluations / frames / 1e6);
  if (!deformed) {
    VolumeSubject last;
    last.field = s.baked.get(), last.framed = s.framed;
    VolumePictureReport report;
    VolumePicture(last, progress).render(s.look, progress, &report, true);
    fmt::print("           steps: {:.2f} levels on average\n", report.step_error_mean);
  }
  write_image(deformed ? "deformed_frame.png" : "frame.png", image);
}

void run(const std::string& file, int size, std::size_t nodes, int frames, const std::string& preset, double step) {
  Progress progress;
  const Subject subject = open_subject(file, size, preset, step, progress);
  for (const bool deformed : {false, true}) measure(subject, deformed, nodes, frames, progress);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print("benchmark_deformed_frames VOLUME [SIZE] [NODES] [FRAMES] [PRESET] [STEP]\n");
    return 2;
  }
  run(argv[1], argc > 2 ? std::atoi(argv[2]) : 512, static_cast<std::size_t>(argc > 3 ? std::atoi(argv[3]) : 64),
      argc > 4 ? std::atoi(argv[4]) : 12, argc > 5 ? argv[5] : "", argc > 6 ? std::atof(argv[6]) : 3);
  return 0;
}
