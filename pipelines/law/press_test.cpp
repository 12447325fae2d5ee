#include "pipelines/law/press_test.h"

#include <algorithm>

#include "calibrate/experiment_fit.h"
#include "common/core/error.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

/// What the file must say and does not is told with an example.
std::vector<ForceCurves> curves_with_comments(const std::string& path, const ForceCurveOptions& options) {
  try {
    return read_force_curve_files({path}, options);
  } catch (const InputError& e) {
    const std::string what = e.what();
    if (what.find("write a comment") == std::string::npos) throw;
    throw InputError(what + "; press_test.csv, beside the scenes that softgrain examples lists, is an example");
  }
}

}  // namespace

LawCard card_of_press_test(const std::string& path) {
  ForceCurveOptions options;
  options.unloading = Unloading::fit;
  options.by_options = false;
  ExperimentFit fit = fit_experiment(curves_with_comments(path, options), {}, true);
  const auto unusable =
      std::ranges::find_if(fit.card.pairs, [](const PairLaw& law) { return !has_numbers(law.status); });
  if (unusable != fit.card.pairs.end())
    throw InputError(path + ": no law can be fitted: " + to_string(unusable->status) + " (" + unusable->reason + ")");
  fit.card.notes = std::move(fit.remarks);
  return std::move(fit.card);
}

FittedLaw load_or_fit_law(const std::string& path) {
  if (is_curve_file(path)) return {card_of_press_test(path), path, read_text(path)};
  return load_law(path);
}

}  // namespace softgrain
