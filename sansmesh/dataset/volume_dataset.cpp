#include "sansmesh/dataset/volume_dataset.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/dataset/joined_arrays.h"
#include "sansmesh/error.h"
#include "sansmesh/field/volume_component.h"
#include "sansmesh/volume/smoothed_values.h"

namespace sansmesh::inline v1 {
namespace {

/// Adds a block's array to the summary of the arrays of its name.
void take_in(const Attribute& a, Association of, const std::vector<std::uint8_t>& hidden,
             std::vector<DatasetArray>& arrays) {
  const auto same = [&](const DatasetArray& d) { return d.name == a.name && d.of == of; };
  auto found = std::find_if(arrays.begin(), arrays.end(), same);
  if (found == arrays.end()) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    arrays.push_back({a.name, of, a.type(), a.components, std::vector<double>(a.components, kInfinity),
                      std::vector<double>(a.components, -kInfinity), 0});
    found = arrays.end() - 1;
  }
  const std::size_t components = std::min(found->components, a.components);
  for (std::size_t row = 0; row < a.rows(); ++row) {
    if (!hidden.empty() && hidden[row] != 0) continue;
    for (std::size_t c = 0; c < components; ++c) {
      const double v = a.number(row * a.components + c);
      if (!std::isfinite(v)) {
        ++found->not_finite;
        continue;
      }
      found->least[c] = std::min(found->least[c], v);
      found->most[c] = std::max(found->most[c], v);
    }
  }
}

/// Preference for an array as the default.
int suits(const DatasetArray& a) {
  int points = 0;
  if (a.components == 1 && a.least[0] < a.most[0]) points += 8;
  if (is_real(a.type)) points += 4;
  if (a.components == 1) points += 2;
  if (a.of == Association::points) points += 1;
  return points;
}

std::string names_of(const std::vector<DatasetArray>& arrays) {
  std::string names;
  for (const DatasetArray& a : arrays) {
    const bool again = std::any_of(arrays.data(), &a, [&](const DatasetArray& b) { return b.name == a.name; });
    if (!again) names += (names.empty() ? "" : ", ") + a.name;
  }
  return names;
}

/// Whether a fitted volume was made with the given options. Absent options match any value.
bool is_held(const FittedVolume& fitted, const std::string& array, const VolumeReconstructionOptions& asked) {
  const VolumeReconstructionOptions& held = fitted.chosen;
  const auto same = [](const auto& wanted, const auto& there) { return !wanted || wanted == there; };
  if (array != fitted.array || !same(asked.cell_values, held.cell_values) || !same(asked.logarithm, held.logarithm) ||
      !same(asked.smoothing, held.smoothing))
    return false;
  if (!asked.method) return true;
  return asked.method == held.method && same(asked.degree, held.degree) && same(asked.iterations, held.iterations) &&
         same(asked.epsilon, held.epsilon) && same(asked.order, held.order) && same(asked.radius, held.radius) &&
         same(asked.robust, held.robust) && same(asked.interpolate.value_or(true), held.interpolate.value_or(true)) &&
         (!asked.spherical || *asked.spherical == held.spherical.value_or(false)) && asked.b == held.b &&
         asked.c == held.c;
}

}  // namespace

VolumeDataset::VolumeDataset(FittedVolume fitted) : arrays_(fitted.arrays), fitted_(std::move(fitted)) {
  data_.format = "fitted volume of " + fitted_->source;
  data_.time = fitted_->time;
  data_.notes = fitted_->notes;
  volumes_[fitted_->volume->in_cells ? 1 : 0] = fitted_->volume;
  while (arrays_.at(default_).name != fitted_->array) ++default_;
}

VolumeDataset::VolumeDataset(GridData data) : data_(std::move(data)) {
  for (const GridBlock& b : data_.blocks) {
    for (const Attribute& a : b.point_arrays) take_in(a, Association::points, b.hidden_points, arrays_);
    for (const Attribute& a : b.cell_arrays) take_in(a, Association::cells, b.hidden_cells, arrays_);
  }
  for (DatasetArray& a : arrays_)
    for (std::size_t c = 0; c < a.components; ++c)
      if (a.least[c] > a.most[c]) a.least[c] = a.most[c] = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 1; k < arrays_.size(); ++k)
    if (suits(arrays_[k]) > suits(arrays_[default_])) default_ = k;
}

bool VolumeDataset::join(const std::string& text) {
  for (const std::string& names : {text, text.substr(0, text.rfind(':'))}) {
    if (std::any_of(arrays_.begin(), arrays_.end(), [&](const DatasetArray& a) { return a.name == names; }))
      return true;
    auto joined = joined_array(arrays_, names);
    if (!joined || fitted_ || volumes_[0] || volumes_[1]) continue;
    join_arrays(data_, names);
    arrays_.push_back(std::move(*joined));
    return true;
  }
  return false;
}

const DatasetArray& VolumeDataset::default_array() const {
  if (arrays_.empty()) throw DataError("holds no arrays: there is nothing to reconstruct");
  return arrays_[default_];
}

const DatasetArray& VolumeDataset::array(const std::string& name, const std::string& option) const {
  const DatasetArray* found = nullptr;
  for (const DatasetArray& a : arrays_)
    if (a.name == name && (!found || a.of == Association::points)) found = &a;
  if (arrays_.empty())
    throw ArgumentError(
        fmt::format("`{}`: there is no array named '{}': the data holds none", option, printable(name, 60)));
  if (!found)
    throw ArgumentError(fmt::format("`{}`: there is no array named '{}'; {} {}", option, printable(name, 60),
                                    fitted_ ? "this fitted volume holds" : "there are", names_of(arrays_)));
  return *found;
}

ArrayChoice VolumeDataset::choose(const std::string& text, const std::string& option) const {
  const auto exists = [&](const std::string& name) {
    return std::any_of(arrays_.begin(), arrays_.end(), [&](const DatasetArray& a) { return a.name == name; });
  };
  const std::size_t colon = text.rfind(':');
  if (exists(text) || colon == std::string::npos || !exists(text.substr(0, colon)))
    return {array(text, option).name, {}, false};
  ArrayChoice choice{text.substr(0, colon), {}, false};
  const std::size_t components = array(choice.array).components;
  const std::string word = text.substr(colon + 1);
  if (word == "magnitude") {
    choice.magnitude = components > 1;
    return choice;
  }
  std::size_t k = components;
  if (word.size() == 1 && word[0] >= 'x' && word[0] <= 'z') {
    k = static_cast<std::size_t>(word[0] - 'x');
  } else {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), k);
    if (error != std::errc() || end != word.data() + word.size()) k = components;
  }
  if (k >= components)
    throw ArgumentError(fmt::format("`{}`: '{}' names no component: {} has {} (0 to {}, or magnitude)", option,
                                    printable(text, 60), printable(choice.array, 60), components, components - 1));
  choice.component = k;
  return choice;
}

std::shared_ptr<const SampledVolume> VolumeDataset::volume(const std::string& name, Progress& progress) {
  return volume(array(name).of, progress);
}

std::shared_ptr<const SampledVolume> VolumeDataset::volume(Association of, Progress& progress) {
  auto& volume = volumes_[of == Association::points ? 0 : 1];
  if (volume) return volume;
  if (fitted_)
    throw DataError(of == Association::points ? "a fitted volume that holds no values of points"
                                              : "a fitted volume that holds no values of cells");
  volume = std::make_shared<const SampledVolume>(assemble_volume(data_, of, progress));
  const bool done = std::all_of(arrays_.begin(), arrays_.end(), [&](const DatasetArray& a) {
    return volumes_[a.of == Association::points ? 0 : 1] != nullptr;
  });
  if (done) data_.blocks = {};
  return volume;
}

const SampleNoise& VolumeDataset::noise(const std::string& array, const VolumeValues& values, Progress& progress) {
  auto found = noise_.find(array);
  if (found == noise_.end())
    found = noise_.emplace(array, noise_of_values(*volume(array, progress), values, progress)).first;
  return found->second;
}

std::shared_ptr<const VolumeField> VolumeDataset::field(const ArrayChoice& choice,
                                                        const VolumeReconstructionOptions& options, Progress& progress,
                                                        VolumeReconstructionReport* report) {
  VolumeReconstructionReport own;
  ReconstructionCoefficients kept;
  std::shared_ptr<const VolumeField> field = reconstruct(choice.array, options, progress, report ? *report : own, kept);
  if (field->components() == 1 || (!choice.component && !choice.magnitude)) return field;
  struct OwnedComponent {
    std::shared_ptr<const VolumeField> field;
    VolumeComponent component{*field};
  };
  auto owned = std::make_shared<OwnedComponent>(OwnedComponent{field, VolumeComponent(*field, choice.component)});
  return {owned, &owned->component};
}

std::unique_ptr<VolumeField> VolumeDataset::reconstruct(const std::string& array,
                                                        const VolumeReconstructionOptions& options, Progress& progress,
                                                        VolumeReconstructionReport& report,
                                                        ReconstructionCoefficients& kept) {
  options.validate();
  const auto samples = volume(array, progress);
  const auto noise = noise_.find(array);
  const SampleNoise* const known = noise == noise_.end() ? nullptr : &noise->second;
  if (!fitted_ || array != fitted_->array)
    return reconstruct_volume(samples, array, options, progress, &report, &kept, known);
  // Neither noise nor smoothed samples depend on the method.
  const bool held = is_held(*fitted_, array, options);
  VolumeReconstructionOptions used = options;
  if (!options.smoothing || options.smoothing == fitted_->chosen.smoothing) {
    used.smoothing = fitted_->chosen.smoothing;
    kept.smoothed = fitted_->coefficients.smoothed, kept.noise = fitted_->coefficients.noise;
  }
  if (!held) return reconstruct_volume(samples, array, used, progress, &report, &kept, known);
  kept = fitted_->coefficients;
  // Coefficients belong to the options chosen; without coefficients the method chooses again from the same data.
  used = kept.empty() ? fitted_->options : fitted_->chosen;
  used.smoothing = fitted_->chosen.smoothing;
  return reconstruct_volume(samples, array, used, progress, &report, &kept, known);
}

FittedVolume VolumeDataset::fit(const std::string& array, const VolumeReconstructionOptions& options, bool all,
                                Progress& progress, VolumeReconstructionReport* report) {
  const DatasetArray chosen = this->array(array);
  VolumeReconstructionReport own;
  VolumeReconstructionReport& r = report ? *report : own;
  FittedVolume result;
  result.coefficients.keep_smoothed = true;
  reconstruct(array, options, progress, r, result.coefficients);
  result.volume = volume(array, progress);
  result.array = array;
  result.options = fitted_ && is_held(*fitted_, array, options) ? fitted_->options : options;
  result.options.method = r.options.method;
  result.chosen = r.options;
  for (const DatasetArray& a : arrays_)
    if (all ? a.of == chosen.of && result.volume->attributes.find(a.name) : a.name == array && a.of == chosen.of)
      result.arrays.push_back(a);
  result.source = fitted_ ? fitted_->source : data_.format;
  result.time = data_.time;
  result.notes = data_.notes;
  return result;
}

std::optional<IsosurfaceName> parse_isosurface_name(const std::string& text) {
  if (!text.ends_with(']')) return std::nullopt;
  const std::size_t open = text.rfind('['), equals = text.rfind('=');
  if (open == std::string::npos || equals == std::string::npos || equals < open) return std::nullopt;
  IsosurfaceName name{text.substr(0, open), text.substr(open + 1, equals - open - 1), 0};
  const std::string value = text.substr(equals + 1, text.size() - equals - 2);
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), name.value);
  if (name.file.empty() || name.array.empty() || error != std::errc() || end != value.data() + value.size() ||
      !std::isfinite(name.value))
    throw ArgumentError(fmt::format("'{}' is no isosurface: those are written FILE[ARRAY=VALUE]", printable(text, 80)));
  return name;
}

}  // namespace sansmesh::inline v1
