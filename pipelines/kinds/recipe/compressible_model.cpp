#include "pipelines/kinds/recipe/compressible_model.h"

#include <fmt/format.h>

#include <algorithm>

#include "calibrate/compressible_packing.h"
#include "calibrate/rod_packing.h"

namespace softgrain {

CompressibleModelSummary compressible_model(const Grading& sizes, double gap) {
  CompressibleModelSummary out;
  out.one_size = RodCurve(Grading::list({1.0})).at(gap);
  const auto with = [&](double index) {
    constexpr double kMost = 0.999;  // beta is a solid fraction, whatever the gap
    const double beta = std::min(kMost, virtual_fraction_of(out.one_size, index));
    return compressible_packing(packing_classes(sizes, beta), index);
  };
  out.poured = with(kPouringIndex);
  out.vibrated_pressed = with(kVibratedPressedIndex);
  return out;
}

std::string compressible_model_text(const CompressibleModelSummary& m) {
  return fmt::format("{:.4f} (K = {:g}) and {:.4f} (K = {:g}), beta from grains of one size ({:.4f})", m.poured,
                     kPouringIndex, m.vibrated_pressed, kVibratedPressedIndex, m.one_size);
}

}  // namespace softgrain
