// Errors of the ground filter on reference samples of the ISPRS test (sithole2004), as given and perturbed.
#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "sansmesh/io.h"
#include "sansmesh/points/ground/find_ground.h"

namespace {

using namespace sansmesh;

struct Labelled {
  Vec3 at;
  bool ground;
};

std::vector<Labelled> read_labelled(const std::string& folder, const std::string& number) {
  const PointSet all = read_points(folder + "/lidar_samp" + number + ".pcd");
  const PointSet ground = read_points(folder + "/lidar_samp" + number + "_ground.pcd");
  const auto key = [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); };
  std::map<std::tuple<double, double, double>, int> left;
  for (const Vec3f& p : ground.positions) ++left[key(ground.origin + Vec3(p))];
  std::vector<Labelled> samples;
  for (const Vec3f& p : all.positions) {
    const Vec3 at = all.origin + Vec3(p);
    const auto found = left.find(key(at));
    const bool is_ground = found != left.end() && found->second-- > 0;
    samples.push_back({at, is_ground});
  }
  return samples;
}

std::vector<Labelled> perturbed(const std::vector<Labelled>& given, std::string_view how) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> gauss(0, 0.05);
  std::vector<Labelled> samples;
  const Vec3 corner = given.front().at;
  for (const Labelled& s : given) {
    Vec3 p = s.at - corner;
    if (how == "half" && uniform(random) > 0.5) continue;
    if (how == "quarter" && uniform(random) > 0.25) continue;
    if (how == "rotated")
      p = {std::cos(0.5) * p.x - std::sin(0.5) * p.y, std::sin(0.5) * p.x + std::cos(0.5) * p.y, p.z};
    if (how == "noise") p = p + Vec3{gauss(random), gauss(random), gauss(random)};
    if (how == "feet") p = p / 0.3048;
    samples.push_back({p, s.ground});
  }
  return samples;
}

/// Prints shares of rejected ground and accepted objects, and Cohen's kappa, in %; returns the latter.
double report(const std::vector<Labelled>& samples) {
  PointSet points;
  for (const Labelled& s : samples) points.positions.emplace_back(s.at);
  Progress progress;
  const std::vector<std::uint8_t> found = find_ground(points, progress).ground;
  double kept = 0, rejected = 0, accepted = 0, dropped = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    (samples[i].ground ? found[i] ? kept : rejected : found[i] ? accepted : dropped) += 1;
  const double n = kept + rejected + accepted + dropped, agreed = (kept + dropped) / n;
  const double chance = ((kept + rejected) * (kept + accepted) + (accepted + dropped) * (rejected + dropped)) / (n * n);
  const double kappa = 100 * (agreed - chance) / (1 - chance);
  fmt::print("  {:5.2f} {:5.2f} {:5.2f}", 100 * rejected / (kept + rejected), 100 * accepted / (accepted + dropped),
             kappa);
  return kappa;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "../shared/data/points";
  if (!std::filesystem::exists(folder + "/lidar_samp11.pcd")) {
    fmt::print("no reference samples in {}: skipped\n", folder);
    return 0;
  }
  fmt::print("rejected ground, accepted objects, kappa in % of samples 11, 31, 51, 53; mean kappa\n");
  for (const std::string_view how : {"given", "rotated", "half", "quarter", "noise", "feet"}) {
    fmt::print("{:8}", how);
    double sum = 0;
    for (const char* number : {"11", "31", "51", "53"}) sum += report(perturbed(read_labelled(folder, number), how));
    fmt::print("  {:5.2f}\n", sum / 4);
  }
}
