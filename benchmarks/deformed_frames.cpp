// Pictures of a volume while it is deformed: frames a second (METHODS §7.1; thesis 6.4.3 on a graphics card).
//
//   benchmark_deformed_frames VOLUME [SIZE] [NODES] [FRAMES] [PRESET] [STEP]
//
// VOLUME is baked once, at its own resolution or, where its longest side has fewer than 256 points, resampled to 256
// before. Then its upper end leans and turns by 15 handles, rigid, in FRAMES (12) poses. A frame is all that a new pose
// needs: the map with NODES (64) points along the longest side, its picture with what leaps over the empty parts, and
// SIZE × SIZE (512) pixels, one ray each, in steps of STEP (3) cells. What steps of half the length would change is
// told, too, in levels of 0..255.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/handle_motion.h"
#include "sansmesh/deform/mls_deformation.h"
#include "sansmesh/field/deformed_volume.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/render/volume/volume_picture.h"

namespace {

using namespace sansmesh;

/// Eight handles hold the lower half, seven at the upper end turn about its middle as one body.
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
  ReconstructionOptions options;
  options.method = "cubic";
  return data.field({data.default_array().name, {}, false}, options, progress);
}

void run(const std::string& file, int size, std::size_t nodes, int frames, const std::string& preset, double step) {
  Progress progress;
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
  double begin = process_cpu_seconds();
  BakeOptions bake;
  const auto baked = std::make_shared<const BakedVolume>(*field, bake, progress);
  fmt::print("{}: {} samples, baked in {:.2f} CPU s, off by {:.3f} % on average; {} threads\n", file, samples->size(),
             process_cpu_seconds() - begin, 100 * baked->report().error_mean, thread_count());

  VolumePictureOptions look;
  look.picture.view.width = look.picture.view.height = size;
  look.picture.quality.samples = 1, look.step = step, look.least_light = 0.02;  // while a handle is held
  look.picture.view.up = UpAxis::z;
  look.picture.view.direction = {40, 20};
  look.picture.view.steady = true;
  look.transfer =
      preset.empty() ? suggest_transfer_function(values, true).function : transfer_function_preset(preset, values);
  const Box3 box = field->bounds();
  std::vector<Vec3> framed;
  for (int i = 0; i < 8; ++i)
    framed.push_back(
        {(i & 1 ? box.upper : box.lower).x, (i & 2 ? box.upper : box.lower).y, (i & 4 ? box.upper : box.lower).z});
  const std::vector<Handle> handles = leaning(box);
  Image image;
  for (const bool deformed : {false, true}) {
    double map = 0, picture = 0, rays = 0, all = 0, wall = 0, evaluations = 0;
    for (int k = 0; k <= frames; ++k) {
      const auto clock = std::chrono::steady_clock::now();
      const double t0 = process_cpu_seconds();
      std::shared_ptr<const VolumeField> seen = baked;
      double t1 = t0;
      if (deformed) {
        const double share = static_cast<double>(k) / frames;
        const MlsDeformation backward(handles_at(handles, share), {});
        const MlsDeformation forward(reversed(handles_at(handles, share)), {});
        std::vector<Vec3> corners(8);
        forward.map(framed, {corners, {}, {}, {}});
        Box3 near;
        for (const Vec3& p : corners) near.extend(p);
        const Vec3 room = Vec3{1, 1, 1} * (0.05 * box.diagonal());
        near = {near.lower - room, near.upper + room};
        std::array<std::size_t, 3> sizes{};
        const Vec3 s = near.size();
        for (std::size_t a = 0; a < 3; ++a)
          sizes[a] = std::max<std::size_t>(
              2, static_cast<std::size_t>(std::lround(static_cast<double>(nodes) * s[a] / std::max({s.x, s.y, s.z}))));
        const auto lattice = std::make_shared<const DisplacementMap>(displacement_map(backward, near, sizes, progress));
        t1 = process_cpu_seconds();
        seen = std::make_shared<const DeformedVolume>(baked, lattice, std::nullopt, near);
      }
      VolumeSubject subject;
      subject.field = seen.get();
      subject.framed = framed;
      const VolumePicture drawn(std::move(subject), progress);
      const double t2 = process_cpu_seconds();
      VolumePictureReport report;
      image = drawn.render(look, progress, &report);
      const double t3 = process_cpu_seconds();
      if (k == 0) continue;  // memory that is touched for the first time
      map += t1 - t0, picture += t2 - t1, rays += t3 - t2, all += t3 - t0;
      wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
      evaluations += static_cast<double>(report.evaluations);
    }
    fmt::print(
        "{:10} {:6.3f} CPU s a frame ({:.3f} s): map {:.3f}, preparing {:.3f}, rays {:.3f}; {:.2f} M evaluations\n",
        deformed ? "deformed" : "as it is", all / frames, wall / frames, map / frames, picture / frames, rays / frames,
        evaluations / frames / 1e6);
    VolumeSubject last;
    last.field = baked.get(), last.framed = framed;
    if (!deformed) {
      VolumePictureReport report;
      VolumePicture(last, progress).render(look, progress, &report, true);
      fmt::print("           steps: {:.2f} levels on average\n", report.step_error_mean);
    }
    write_image(deformed ? "deformed_frame.png" : "frame.png", image);
  }
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
