// Cost and errors of pictures of volumes.
//
//   benchmark_volume_pictures [OPTION...] FILE...
//
//     --size N         pixels of a side [512]
//     --samples N      rays per pixel in each direction [3]
//     --step X         length of a step in spacings [1]
//     --pixel-error X  error in levels of 255 at which a pixel has enough rays [0.4]; 0: all pixels have all rays
//     --save FOLDER    keeps the pictures there, as rows of floats
//     --against FOLDER prints the errors against pictures kept there, in levels of 255
//     --azimuth X      direction of the view, degrees [35]
//
// Prints CPU seconds of reading, of the field, of the first picture and of the next one, which is the same again.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sansmesh/volume_pictures.h"
#include "sansmesh/volumes.h"
#include "timing.h"

namespace sansmesh::inline v1 {
namespace {

struct Settings {
  VolumePicturesOptions options;
  std::string save, against;
  std::vector<std::string> files;
};

std::string kept(const std::string& folder, const std::string& file) {
  return folder + "/" + std::filesystem::path(file).stem().string() + ".floats";
}

std::vector<float> channels_of(const Image& image) {
  std::vector<float> channels;
  channels.reserve(3 * image.pixels.size());
  for (const Rgba& p : image.pixels)
    for (std::size_t k = 0; k < 3; ++k) channels.push_back(255 * std::clamp(p[k], 0.0f, 1.0f));
  return channels;
}

/// Root mean square, 99.9 % quantile and largest of all differences.
std::string errors_against(const std::string& file, const std::vector<float>& channels) {
  std::ifstream in(file, std::ios::binary);
  std::vector<float> truth(channels.size());
  in.read(reinterpret_cast<char*>(truth.data()), static_cast<std::streamsize>(sizeof(float) * truth.size()));
  if (!in) return "no picture to compare with";
  std::vector<double> errors(truth.size());
  double squares = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors[i] = std::abs(static_cast<double>(channels[i] - truth[i]));
    squares += errors[i] * errors[i];
  }
  std::sort(errors.begin(), errors.end());
  return fmt::format("{:.3f} | {:.1f} | {:.1f}", std::sqrt(squares / static_cast<double>(errors.size())),
                     errors[errors.size() * 999 / 1000], errors.back());
}

void draw(const std::string& file, const Settings& settings) {
  Progress progress;
  Time last = now();
  const auto lap = [&] {
    const double spent = (now() - last).cpu;
    last = now();
    return spent;
  };
  const VolumeModel volume = open_volume({file}, {}, progress);
  const double read = lap();
  VolumePictures pictures(volume, settings.options, {}, progress);
  const double field = lap();
  const ViewDirection view = pictures.look().picture.view.direction;
  Image image = pictures.render(view, progress);
  const double first = lap();
  image = pictures.render(view, progress);
  const double next = lap();
  const std::vector<float> channels = channels_of(image);
  if (!settings.save.empty()) {
    std::ofstream out(kept(settings.save, file), std::ios::binary);
    out.write(reinterpret_cast<const char*>(channels.data()),
              static_cast<std::streamsize>(sizeof(float) * channels.size()));
  }
  const VolumePictureReport& report = pictures.report();
  fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {} |{}\n",
             std::filesystem::path(file).stem().string(), read, field, first, read + field + first, next, report.rays,
             report.evaluations,
             settings.against.empty() ? "" : " " + errors_against(kept(settings.against, file), channels) + " |");
  std::fflush(stdout);
}

}  // namespace
}  // namespace sansmesh::inline v1

int main(int count, char** words) {
  using namespace sansmesh;
  Settings s;
  VolumePictureOptions& look = s.options.look;
  look.picture.view.width = look.picture.view.height = 512;
  look.picture.look.background = Background::solid({1, 1, 1});
  s.options.bar = false;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word.rfind("--", 0) != 0) {
      s.files.push_back(word);
      continue;
    }
    const std::string value = ++i < count ? words[i] : "";
    if (word == "--size") look.picture.view.width = look.picture.view.height = std::stoi(value);
    if (word == "--samples") look.picture.quality.samples = std::stoi(value);
    if (word == "--step") look.step = std::stod(value);
#ifndef BENCH_BASE
    if (word == "--pixel-error") look.pixel_error = std::stod(value);
#endif
    if (word == "--save") s.save = value;
    if (word == "--against") s.against = value;
    if (word == "--azimuth") look.picture.view.direction.azimuth = std::stod(value), s.options.default_view = false;
  }
  fmt::print("| volume | read | field | picture | first picture | next | rays | evaluations |{}\n",
             s.against.empty() ? "" : " rms | 99.9 % | largest |");
  for (const std::string& file : s.files) {
    try {
      draw(file, s);
    } catch (const std::exception& e) {
      fmt::print("| {} | {}\n", file, e.what());
    }
  }
}
