// Benchmark of pictures of flow surfaces: frames per second without and with streaks (tejada2008, 5.3: 63.9 and 26.4 on
// a graphics card).
//
//   benchmark_flow_frames [SIZE] [FRAMES]
//
// The stream surface of 256 particles on 256 fronts in a tornado, from FRAMES (40) views of SIZE × SIZE (512) pixels. A
// frame includes everything from rays to shaded pixels, one ray per pixel, without shadows, but neither the surface nor
// its tree.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "timing.h"

namespace {

using namespace sansmesh;

void run(int size, int frames) {
  const auto flow = analytic_flow("tornado");
  FlowSurfaceOptions options;
  options.duration = 3;
  options.front_step = 3.0 / 255;
  Progress progress;
  const FlowSurface surface = flow_surface(*flow, {{{0.2, 0.5, 0.05}, {0.8, 0.45, 0.1}}, false}, options, progress);
  FlowSubject subject{surface.mesh, {}, {}};
  std::vector<Vec3> places;
  for (const FlowPoint& p : surface.points) {
    subject.vectors.emplace_back(p.velocity);
    subject.fronts.push_back(p.front);
    if (surface.points.size() < 1000 || p.particle % 7 == 0)
      places.push_back(p.position);  // enough to determine the frame
  }
  RenderOptions picture;
  picture.view.width = picture.view.height = size;
  picture.look.shadows = picture.look.ground = false;
  picture.quality.samples = 1;
  picture.quality.occlusion_rays = 0;
  picture.view.up = UpAxis::z;
  picture.look.background = Background::solid({1, 1, 1});
  fmt::print("{} triangles, {} x {} pixels, {} threads\n", surface.mesh.triangles.size(), size, size, thread_count());
  for (const bool splats : {false, true})
    for (const bool streaks : {false, true}) {
      FlowLook flow_look;
      flow_look.splats = splats;
      if (!streaks) flow_look.texture.reset();
      const SceneFactory drawn = DrawnFlow(subject, picture).surface(flow_look);
      std::vector<double> times;
      double cpu = 0, covered = 0;
      for (int k = 0; k <= frames; ++k) {
        picture.view.direction = {360.0 * k / frames, 60};
        const Time start = now();
        const Image image = render_surfaces({&drawn, 1}, places, false, picture, progress);
        if (k == 0) continue;  // builds the tree
        const Time time = now() - start;
        times.push_back(time.wall), cpu += time.cpu;
        for (const Rgba& p : image.pixels) covered += p != image.pixels[0];
      }
      std::sort(times.begin(), times.end());
      const double median = times[times.size() / 2];
      fmt::print("{:6} {:10} {:7.1f} ms a frame (median), {:6.1f} a second; {:7.1f} CPU ms; {:4.1f} % covered\n",
                 splats ? "splats" : "mesh", streaks ? "streaks" : "smooth", 1e3 * median, 1 / median,
                 1e3 * cpu / frames, 100 * covered / frames / size / size);
    }
}

}  // namespace

int main(int argc, char** argv) {
  run(argc > 1 ? std::atoi(argv[1]) : 512, argc > 2 ? std::atoi(argv[2]) : 40);
  return 0;
}
