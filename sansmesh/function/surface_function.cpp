#include "sansmesh/surface_function.h"
#include "sansmesh/core/option_text.h"

#include <utility>

#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_file.h"

namespace sansmesh::inline v1 {

SurfaceFunction::SurfaceFunction(FittedFunction fitted)
    : fitted_(std::make_shared<const FittedFunction>(std::move(fitted))) {}

std::shared_ptr<const ScalarField> SurfaceFunction::field() const {
  return std::make_shared<const PlacedField>(fitted_, fitted_->field, fitted_->frame);
}

Box3 SurfaceFunction::bounds() const {
  const Box3f box = sansmesh::bounds(*fitted_->samples);
  return fitted_->frame.to_input(box.empty() ? fitted_->field.bounds() : Box3{Vec3(box.lower), Vec3(box.upper)});
}

std::size_t SurfaceFunction::samples() const { return fitted_->samples->size(); }

const std::vector<std::string>& SurfaceFunction::history() const { return fitted_->history; }

bool is_function_file(const std::string& file) {
  const std::string name = lower_case(file);
  return name.ends_with(".smf") || name.ends_with(".smf.gz");
}

SurfaceFunction read_function(const std::string& file) { return SurfaceFunction(read_fitted_function(file)); }

void write_function(const std::string& file, const SurfaceFunction& function, bool with_samples) {
  write_fitted_function(file, function.fitted(), with_samples);
}

}  // namespace sansmesh::inline v1
