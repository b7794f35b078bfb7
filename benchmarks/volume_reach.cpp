// Benchmark of operations on a volume after reading, for the comparison with VTK in benchmarks/volume_reach.
//
//   benchmark_volume_reach frames FILE... ARRAY METHOD   pictures of 512 × 512 pixels, one ray a pixel: direct ones,
//   the
//                                                        interactive ones of a baked field, and what comes before them
//   benchmark_volume_reach probe FILE... ARRAY METHOD POINTS VALUES
//                                                        POINTS: x, y, z as doubles, one after the other; values go to
//                                                        VALUES, as doubles
//   benchmark_volume_reach memory FILE... ARRAY METHOD   resident memory after reading, after fitting, and the peaks
//
// ARRAY "-" is the default one. Prints one object of JSON. Frames are the fastest of five, after one that is not
// counted.
#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "timing.h"

namespace {

using namespace sansmesh;

/// Resident bytes, and their maximum so far.
double resident() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  statm >> pages >> pages;
  return pages * 4096;
}
double peak() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}
/// Resets the maximum.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }
double peak_since() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
  return peak();
}

struct Volume {
  Progress progress;
  std::unique_ptr<VolumeDataset> data;
  std::shared_ptr<const SampledVolume> samples;
  std::string array;
  VolumeReconstructionOptions options;

  Volume(const std::vector<std::string>& files, const std::string& wanted, const std::string& method) {
    data = std::make_unique<VolumeDataset>(read_volumes(files));
    array = wanted == "-" ? data->default_array().name : wanted;
    samples = data->volume(array, progress);
    options.method = method;
  }
  std::shared_ptr<const VolumeField> field(VolumeReconstructionReport* report = nullptr) {
    ArrayChoice choice = data->choose(array);
    if (data->array(choice.array).components > 1 && !choice.component) choice.magnitude = true;
    return data->field(choice, options, progress, report);
  }
};

void frames(Volume& volume) {
  std::shared_ptr<const VolumeField> field;
  VolumeReconstructionReport report;
  const Time fit = time_of([&] { field = volume.field(&report); });
  TriangleMesh boundary;
  if (!volume.samples->lattice) boundary = volume_boundary(*volume.samples);
  VolumePictureOptions options;
  options.picture.view.width = options.picture.view.height = 512;
  options.picture.quality.samples = 1;
  const auto picture_of = [&](const VolumeField& shown) {
    VolumeSubject subject;
    subject.field = &shown;
    subject.samples = volume.samples->positions;
    if (!boundary.triangles.empty()) subject.boundary = &boundary;
    return std::make_unique<VolumePicture>(std::move(subject), volume.progress);
  };
  struct Frames {
    Time before, first, best;
    VolumePictureReport report;
  };
  const auto run = [&](const VolumeField& shown, const VolumePictureOptions& how) {
    Frames f;
    std::unique_ptr<VolumePicture> picture;
    f.before = time_of([&] { picture = picture_of(shown); });
    f.first = time_of([&] { picture->render(how, volume.progress, &f.report); });
    f.best = {1e300, 1e300};
    for (int k = 0; k < 5; ++k) {
      const Time s = time_of([&] { picture->render(how, volume.progress); });
      f.best = {std::min(f.best.wall, s.wall), std::min(f.best.cpu, s.cpu)};
    }
    return f;
  };
  const Frames direct = run(*field, options);
  std::unique_ptr<BakedVolume> baked;
  BakeOptions bake;
  bake.samples = volume.samples->positions;
  const Time baking = time_of([&] { baked = std::make_unique<BakedVolume>(*field, bake, volume.progress); });
  VolumePictureOptions quick = options;
  quick.step = 1.5, quick.least_light = 0.01;  // settings of --baked
  quick.transfer = direct.report.transfer;
  const Frames interactive = run(*baked, quick);

  const auto as_json = [](const Frames& f) {
    return fmt::format(
        R"({{"prepare_cpu":{:.4f},"first_wall":{:.4f},"first_cpu":{:.4f},"wall":{:.4f},"cpu":{:.4f},"rays":{},"evaluations":{}}})",
        f.before.cpu, f.first.wall, f.first.cpu, f.best.wall, f.best.cpu, f.report.rays, f.report.evaluations);
  };
  const VolumePicture picture({field.get(), nullptr, boundary.triangles.empty() ? nullptr : &boundary, {}, {}},
                              volume.progress);
  const Camera camera = picture.camera(options);
  const PictureFrame frame = picture.frame();
  const auto vector = [](const Vec3& v) { return fmt::format("[{:.9g},{:.9g},{:.9g}]", v.x, v.y, v.z); };
  std::string colors, opacities;
  for (const ColorPoint& p : direct.report.transfer.colors)
    colors += fmt::format("{}[{:.9g},{:.6g},{:.6g},{:.6g}]", colors.empty() ? "" : ",", p.value, p.color.x, p.color.y,
                          p.color.z);
  for (const OpacityPoint& p : direct.report.transfer.opacities)
    opacities += fmt::format("{}[{:.9g},{:.6g}]", opacities.empty() ? "" : ",", p.value, p.opacity);
  fmt::print(
      R"({{"array":"{}","samples":{},"fit_wall":{:.4f},"fit_cpu":{:.4f},"shape":{},"iterations":{},"bake_wall":{:.4f},"bake_cpu":{:.4f},"bricks":{},"bake_error":{:.6f},"direct":{},"interactive":{},"camera":{{"position":{},"center":{},"up":{},"half_height":{:.9g}}},"unit":{:.9g},"colors":[{}],"opacities":[{}]}})"
      "\n",
      volume.array, volume.samples->size(), fit.wall, fit.cpu, report.options.epsilon.value_or(0),
      report.options.iterations.value_or(0), baking.wall, baking.cpu, baked->report().bricks,
      baked->report().error_mean, as_json(direct), as_json(interactive),
      vector(frame.center + Vec3(camera.position) * frame.size),
      vector(frame.center + (Vec3(camera.position) - Vec3(camera.backward)) * frame.size), vector(Vec3(camera.up)),
      camera.half_height, direct.report.transfer.reference_length.value_or(volume.samples->bounds().diagonal() / 50),
      colors, opacities);
}

void probe(Volume& volume, const std::string& points, const std::string& out) {
  std::ifstream file(points, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::size_t>(file.tellg());
  std::vector<Vec3> x(size / sizeof(Vec3));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(x.data()), static_cast<std::streamsize>(x.size() * sizeof(Vec3)));
  if (!file) throw FileError(points, "cannot be read");
  std::shared_ptr<const VolumeField> field;
  const Time fit = time_of([&] { field = volume.field(); });
  const std::size_t c = field->components();
  std::vector<double> values(x.size() * c);
  std::vector<std::uint8_t> inside(x.size());
  const Time first = time_of([&] { field->evaluate(x, {values, {}, inside}); });
  const Time again = time_of([&] { field->evaluate(x, {values, {}, inside}); });
  std::ofstream(out, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(double)));
  fmt::print(
      R"({{"samples":{},"points":{},"inside":{},"fit_cpu":{:.4f},"ask_cpu":{:.4f},"ask_wall":{:.4f},"again_cpu":{:.4f}}})"
      "\n",
      volume.samples->size(), x.size(), std::count(inside.begin(), inside.end(), 1), fit.cpu, first.cpu, first.wall,
      again.cpu);
}

void memory(const std::vector<std::string>& files, const std::string& array, const std::string& method) {
  std::unique_ptr<Volume> volume;
  const Time reading = time_of([&] { volume = std::make_unique<Volume>(files, array, method); });
  const double read_peak = peak(), data = resident();
  forget_peak();
  std::shared_ptr<const VolumeField> field;
  const Time fit = time_of([&] { field = volume->field(); });
  const double fitted = resident(), fit_peak = peak_since();
  const Box3 box = volume->samples->bounds();
  std::vector<Vec3> x(100000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t k = i * 7919 % volume->samples->size();
    x[i] = volume->samples->position(k) * 0.999 + box.center() * 0.001;
  }
  std::vector<double> values(x.size() * field->components());
  const Time ask = time_of([&] { field->evaluate(x, {values}); });
  const auto n = static_cast<double>(volume->samples->size());
  fmt::print(
      R"({{"samples":{},"cells":{},"read_cpu":{:.2f},"read_peak_mb":{:.0f},"data_mb":{:.0f},"data_bytes":{:.0f},"fit_cpu":{:.2f},"fit_wall":{:.2f},"field_bytes":{:.0f},"fit_peak_bytes":{:.0f},"peak_mb":{:.0f},"ask_cpu":{:.3f}}})"
      "\n",
      volume->samples->size(), volume->samples->cells.size(), reading.cpu, read_peak / 1e6, data / 1e6, data / n,
      fit.cpu, fit.wall, (fitted - data) / n, (fit_peak - data) / n, peak() / 1e6, ask.cpu);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::vector<std::string> a(argv + 1, argv + argc);
    const std::string what = a.empty() ? "" : a[0];
    const std::size_t after = what == "probe" ? 4 : 2;
    if ((what != "frames" && what != "probe" && what != "memory") || a.size() < after + 2)
      throw ArgumentError("frames, probe or memory, then files, array and method: see the beginning of its source");
    const std::vector<std::string> files(a.begin() + 1, a.end() - static_cast<std::ptrdiff_t>(after));
    const std::vector<std::string> rest(a.end() - static_cast<std::ptrdiff_t>(after), a.end());
    if (what == "memory") {
      memory(files, rest[0], rest[1]);
      return 0;
    }
    Volume volume(files, rest[0], rest[1]);
    if (what == "frames")
      frames(volume);
    else
      probe(volume, rest[2], rest[3]);
  } catch (const std::exception& e) {
    fmt::print(stderr, "benchmark_volume_reach: {}\n", e.what());
    return 1;
  }
  return 0;
}
