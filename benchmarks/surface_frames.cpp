// Benchmark of pictures directly from samples: seconds per frame beside tables 4.1 and 4.2 and the GPU figures of
// tejada2008 (400 × 300 pixels on a 3.4 GHz CPU and 512 × 512 on a GeForce 8800 Ultra).
//
//   benchmark_surface_frames [DATA_FOLDER] [RUNS]
//
// DATA_FOLDER contains the models (../shared/data/points); missing data sets are replaced by stand-ins with the same
// number of points, which the table marks. A frame includes everything from rays to shaded pixels, one ray per pixel,
// without shadows, but neither fitting nor the trees over the samples, as in the thesis.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "sansmesh/io.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "timing.h"

namespace sansmesh::inline v1 {
namespace {

struct Cloud {
  const char* thesis;   // name and size in the thesis
  const char* file;     // our file
  std::size_t samples;  // number of samples on its faces; 0: its vertices
  const char* note;
};

struct Row {
  std::size_t cloud;
  const char* method;
  const char* thesis_method;
  double thesis_seconds;
  int width, height;
  int order = 0, iterations = 0;
  bool sharp = false;
};

const Cloud kClouds[] = {
    {"Stanford Bunny 35K", "bun_zipper.ply", 0, "the same, 35,947"},
    {"Horse 48K", "horse.ply", 0, "the same, 48,485"},
    {"Fan Disk 103K", "fandisk.off", 103000, "sampled"},
    {"Armadillo 172K", "armadillo_43k.obj", 172000, "sampled"},
    {"Stanford Dragon 400K", "dragon_vrip_res3.ply", 400000, "sampled from the reduced mesh"},
    {"Cube 6K", "cube.pwn", 6000, "every eighth sample"},
    {"Fan Disc 26K", "fandisk.off", 26000, "sampled"},
    {"Skeleton Hand 109K", "armadillo_43k.obj", 109000, "Armadillo in its place, sampled"},
    {"Fertility 107K", "fertility_4k.off", 107000, "sampled from the reduced mesh"},
    {"Buste 125K", "max-planck_5k.obj", 125000, "Max Planck in its place, sampled"},
};

std::vector<Row> rows() {
  std::vector<Row> r;
  // Table 4.1, 400 × 300.
  const double t41[5][5] = {{30, 29, 103, 107, 126},
                            {50, 52, 183, 283, 389},
                            {30, 30, 79, 97, 109},
                            {30, 32, 106, 152, 236},
                            {116, 120, 361, 499, 778}};
  for (std::size_t c = 0; c < 5; ++c) {
    r.push_back({c, "adamson", "Adamson", t41[c][0], 400, 300});
    r.push_back({c, "kolluri", "Kolluri", t41[c][1], 400, 300});
    const int iterations[] = {1, 3, 10};
    for (std::size_t k = 0; k < 3; ++k) r.push_back({c, "amls", "AMLS", t41[c][2 + k], 400, 300, 6, iterations[k]});
  }
  // Table 4.2; "a smaller viewport": 400 × 300 here.
  const std::size_t of[] = {5, 6, 0, 3};
  const double t42[4][4] = {{6, 140, 14, 24}, {17, 234, 21, 32}, {20, 503, 30, 45}, {16, 122, 17, 23}};
  for (std::size_t k = 0; k < 4; ++k) {
    r.push_back({of[k], "adamson", "Adamson", t42[k][0], 400, 300});
    r.push_back({of[k], "alexa", "MLS, degree 2", t42[k][1], 400, 300});
    r.push_back({of[k], "amls", "approx. O(h^6)", t42[k][2], 400, 300, 6, 0});
    r.push_back({of[k], "amls", "approx., sharp", t42[k][3], 400, 300, 6, 0, true});
  }
  // GPU, 512 × 512.
  r.push_back({0, "alexa", "MLS on the GPU", 1 / 5.6, 512, 512});
  r.push_back({1, "alexa", "MLS on the GPU", 1 / 4.54, 512, 512});
  r.push_back({7, "alexa", "MLS on the GPU", 1 / 2.22, 512, 512});
  r.push_back({8, "kolluri", "Kolluri on the GPU", 1 / 4.36, 512, 512});
  r.push_back({9, "kolluri", "Kolluri on the GPU", 1 / 2.19, 512, 512});
  // The curvature-driven projection against Alexa's: the thesis reports a factor of 1.5 to 2.5.
  for (const std::size_t c : {std::size_t{0}, std::size_t{1}, std::size_t{7}})
    r.push_back({c, "curvature", "(Alexa here)", 0, 512, 512});
  return r;
}

PointSet load(const std::string& folder, const Cloud& cloud) {
  PointSet points = read_points(folder + "/" + cloud.file);
  if (cloud.samples == 0) return points;
  if (!points.triangles.empty()) return sample_faces(points, cloud.samples);
  const std::size_t step = points.size() / cloud.samples;
  PointSet some;
  some.origin = points.origin;
  for (std::size_t i = 0; i < points.size(); i += step) some.positions.push_back(points.positions[i]);
  return some;
}

void run(const std::string& folder, int runs) {
  std::printf("%-22s %-10s %9s %8s %6s %11s %11s %8s  %s\n", "cloud", "surface", "pixels", "covered", "evals",
              "s a frame", "thesis s", "ratio", "note");
  double alexa[std::size(kClouds)] = {};
  for (const Row& row : rows()) {
    const Cloud& cloud = kClouds[row.cloud];
    SurfaceOptions options;
    options.method = row.method;
    if (row.sharp) options.sharp = SharpFormula::bilateral;
    if (options.method == "amls") options.order = row.order, options.iterations = row.iterations, options.smoothing = 1;
    Progress progress;
    const SurfaceModel model = make_surface_model(load(folder, cloud), options, progress);
    SurfaceCastOptions cast;
    cast.normals = model.normals();
    const SurfaceCaster caster = model.projection() ? SurfaceCaster(*model.projection(), model.balls(), cast)
                                                    : SurfaceCaster(model.field(progress), model.balls(), cast);
    SurfaceRenderOptions picture;
    picture.picture.view.width = row.width, picture.picture.view.height = row.height;
    picture.plain = true;
    CastCounts before;
    const double best = fastest_of(runs, [&] {
                          before = caster.counts();
                          render_surface(caster, model.points().positions, nullptr, picture, progress);
                        }).wall;
    CastCounts counts = caster.counts();
    counts.hits -= before.hits, counts.hit_evaluations -= before.hit_evaluations;
    std::string name = row.method;
    if (name == "amls") name += "-" + std::to_string(row.iterations) + (row.sharp ? "#" : "");
    double reference = row.thesis_seconds;
    if (name == "alexa" && row.width == 512) alexa[row.cloud] = best;
    if (name == "curvature") reference = alexa[row.cloud];
    std::printf(
        "%-22s %-10s %4dx%-4d %6.1f %% %6.1f %11.4f %11.4f %8.1f  %s; %s\n", cloud.thesis, name.c_str(), row.width,
        row.height, 100.0 * static_cast<double>(counts.hits) / (row.width * row.height),
        static_cast<double>(counts.hit_evaluations) / static_cast<double>(std::max<std::uint64_t>(1, counts.hits)),
        best, reference, reference / best, row.thesis_method, cloud.note);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1

int main(int argc, char** argv) {
  try {
    sansmesh::run(argc > 1 ? argv[1] : "../shared/data/points", argc > 2 ? std::max(1, std::atoi(argv[2])) : 5);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_surface_frames: %s\n", error.what());
    return 1;
  }
}
