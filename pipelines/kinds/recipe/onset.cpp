#include "pipelines/kinds/recipe/onset.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "calibrate/bootstrap.h"
#include "calibrate/compressible_packing.h"
#include "calibrate/rod_packing.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

double void_ratio(double onset) { return 1.0 / onset - 1.0; }

/// The least of f over [low, high], by Brent's method from the best of some points.
double least_of(const std::function<double(double)>& f, double low, double high) {
  [[maybe_unused]] static const auto previous = gsl_set_error_handler_off();  // a flat function is told by status
  constexpr int kPoints = 40;
  double best = low;
  for (int k = 0; k <= kPoints; ++k) {
    const double x = low + (high - low) * k / kPoints;
    if (f(x) < f(best)) best = x;
  }
  const double step = (high - low) / kPoints;
  const double from = std::max(low, best - step);
  const double to = std::min(high, best + step);
  if (!(best > from && best < to)) return best;
  gsl_function function{[](double x, void* p) { return (*static_cast<const std::function<double(double)>*>(p))(x); },
                        const_cast<std::function<double(double)>*>(&f)};
  const std::unique_ptr<gsl_min_fminimizer, void (*)(gsl_min_fminimizer*)> search(
      gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), gsl_min_fminimizer_free);
  if (gsl_min_fminimizer_set(search.get(), &function, best, from, to) != GSL_SUCCESS) return best;
  constexpr int kMost = 100;
  for (int k = 0; k < kMost; ++k) {
    if (gsl_min_fminimizer_iterate(search.get()) != GSL_SUCCESS) break;
    if (gsl_min_fminimizer_x_upper(search.get()) - gsl_min_fminimizer_x_lower(search.get()) < 1e-6) break;
  }
  return gsl_min_fminimizer_x_minimum(search.get());
}

/// Onsets by variant: one estimate, or one replicate.
using Onsets = std::vector<double>;

}  // namespace

struct LevelForms::Parts {
  Parts(const RecipeScene& s, const StateFit& fit) : scene(s), degrees(fit.degrees) {
    const auto& variants = scene.material.variants;
    estimate.assign(variants.size(), 0.0);
    measured.resize(variants.size());
    replicates.assign(fit.replicates.size(), Onsets(variants.size(), 0.0));
    std::vector<double> error(variants.size(), 1.0);
    for (std::size_t v = 0; v < variants.size(); ++v) {
      if (variants[v].same_packings) continue;
      const StateGroup* group = fit.find(variants[v].name);
      if (group == nullptr) throw UnusableResult(variants[v].name + " bears at too few points to tell its onset");
      estimate[v] = group->onset.value;
      measured[v] = group->onset;
      error[v] = std::isfinite(group->onset.standard_error) && group->onset.standard_error > 0.0
                     ? group->onset.standard_error
                     : 1.0;
      const auto place = 2 + static_cast<std::size_t>(group - fit.groups.data());
      for (std::size_t r = 0; r < replicates.size(); ++r) replicates[r][v] = fit.replicates[r][place];
      if (scene.checked == v) continue;
      rods.emplace_back(v, RodCurve(*variants[v].setup.spec.solid_sizes));
    }
    const auto gap_of = [&](const Onsets& onsets) {
      std::vector<RodOnset> packings;
      for (const auto& [v, curve] : rods) packings.push_back({&curve, onsets[v], error[v]});
      return fitted_gap(packings);
    };
    gap = gap_of(estimate);
    for (const Onsets& r : replicates) gaps.push_back(gap_of(r));
    double square = 0.0;
    for (const auto& [v, curve] : rods) square += std::pow(estimate[v] - curve.at(gap), 2);
    deviation = std::sqrt(square / static_cast<double>(rods.size()));
  }

  /// w of a level over the share of fines.
  [[nodiscard]] double beside(std::size_t level, double share, const Onsets& onsets) const {
    const double fines = void_ratio(onsets[scene.slice[level + 1]]);
    std::vector<double> x{0.0};
    std::vector<double> w{void_ratio(onsets[scene.slice[level]]) / fines};
    for (std::size_t m = 0; m < scene.mixtures.size(); ++m) {
      const double ratio = scene.mixtures[m] / (1.0 - scene.mixtures[m]);
      x.push_back(scene.mixtures[m]);
      w.push_back(void_ratio(onsets[scene.mixed[level][m]]) * (1.0 + ratio) / fines - ratio);
    }
    return straight(x, w, share);
  }

  [[nodiscard]] double by_levels(std::size_t first, std::size_t count, const Onsets& onsets) const {
    const std::size_t last = first + count - 1;
    double e = void_ratio(onsets[scene.slice[last]]);
    double volume = scene.levels[last].share;
    for (std::size_t k = last; k-- > first;) {
      const double ratio = volume / scene.levels[k].share;
      e *= (beside(k, ratio / (1.0 + ratio), onsets) + ratio) / (1.0 + ratio);
      volume += scene.levels[k].share;
    }
    return 1.0 / (1.0 + std::max(e, 0.0));
  }

  const RecipeScene& scene;
  int degrees;  ///< degrees of freedom of the scatter of replicates
  Onsets estimate;
  std::vector<Estimate> measured;
  std::vector<Onsets> replicates;
  std::vector<std::pair<std::size_t, RodCurve>> rods;
  double gap = 0.0;
  std::vector<double> gaps;
  double deviation = 0.0;
  double share_of_rods = 0.5;
};

double straight(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto above = std::upper_bound(x.begin(), x.end(), at);
  if (above == x.begin()) return y.front();
  if (above == x.end()) return y.back();
  const auto k = static_cast<std::size_t>(above - x.begin());
  return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1]);
}

double fitted_gap(const std::vector<RodOnset>& packings) {
  return least_of(
      [&](double gap) {
        double sum = 0.0;
        for (const RodOnset& p : packings) sum += std::pow((p.onset - p.curve->at(gap)) / p.error, 2);
        return sum;
      },
      RodCurve::kLeastGap, RodCurve::kLargestGap);
}

LevelForms::LevelForms(const RecipeScene& scene, const StateFit& fit) : parts_(std::make_unique<Parts>(scene, fit)) {}
LevelForms::~LevelForms() = default;

FormReplicates LevelForms::by_both_forms(std::size_t first, std::size_t count) const {
  FormReplicates out;
  if (count == 1) {
    out.levels = out.rods = own_onset(first);
    for (const Onsets& r : parts_->replicates) out.by_levels.push_back(r[parts_->scene.slice[first]]);
    out.by_rods = out.by_levels;
    return out;
  }
  // Chords of four decades: so many that the finest are among them.
  constexpr std::size_t kRods = 20000;
  const RodCurve rods(joined(parts_->scene.levels, first, count), kRods);
  out.levels = parts_->by_levels(first, count, parts_->estimate);
  out.rods = rods.at(parts_->gap);
  for (std::size_t r = 0; r < parts_->replicates.size(); ++r) {
    out.by_levels.push_back(parts_->by_levels(first, count, parts_->replicates[r]));
    out.by_rods.push_back(rods.at(parts_->gaps[r]));
  }
  return out;
}

OnsetByForms LevelForms::joined_onset(std::size_t first, std::size_t count, double widen) const {
  if (count == 1) {
    const Estimate& own = parts_->measured[parts_->scene.slice[first]];
    return {own.value, own.value, own};
  }
  const FormReplicates both = by_both_forms(first, count);
  const std::vector<double>& levels = both.by_levels;
  const std::vector<double>& by_rods = both.by_rods;
  OnsetByForms out{both.levels, both.rods, {}};
  Estimate& e = out.onset;
  e.value = out.levels + parts_->share_of_rods * (out.rods - out.levels);
  if (levels.empty() || parts_->degrees < 1) {
    e = {e.value, kInfinity, -kInfinity, kInfinity};
    return out;
  }
  const double students = student_over_normal(parts_->degrees);
  const auto interval = [&](double value, const std::vector<double>& replicates) {
    const auto [low, high] = interval95(replicates);
    return widened(value, low, high, students, true);
  };
  const auto [levels_low, levels_high] = interval(out.levels, levels);
  const auto [rods_low, rods_high] = interval(out.rods, by_rods);
  const double misfit = kNormal95 * parts_->deviation;
  // Replicates need not lie about the estimate: both forms are inside, and with them the value.
  e.low = std::max(0.0, std::min({levels_low, rods_low - misfit, out.levels, out.rods}) - widen);
  e.high = std::min(1.0, std::max({levels_high, rods_high + misfit, out.levels, out.rods}) + widen);
  e.standard_error = 0.5 * (e.high - e.low) / kNormal95;
  return out;
}

void LevelForms::lean(std::size_t count, double measured, double error) {
  constexpr double kTau = 0.3;
  const OnsetByForms forms = joined_onset(0, count);
  const double apart = forms.rods - forms.levels;
  const double known = std::isfinite(error) ? error : 0.0;
  const double noise = known * known + parts_->deviation * parts_->deviation;
  const double off = measured - 0.5 * (forms.rods + forms.levels);
  const double pull = kTau * kTau * apart;
  if (pull * apart + noise > 0.0)
    parts_->share_of_rods = std::clamp(0.5 + pull * off / (pull * apart + noise), 0.0, 1.0);
}

double LevelForms::share_of_rods() const { return parts_->share_of_rods; }
double LevelForms::own_onset(std::size_t level) const { return parts_->estimate[parts_->scene.slice[level]]; }
double LevelForms::gap() const { return parts_->gap; }
double LevelForms::rods_deviation() const { return parts_->deviation; }
std::vector<double> LevelForms::rod_residuals() const {
  std::vector<double> out(parts_->estimate.size(), kNaN);
  for (const auto& [v, curve] : parts_->rods) out[v] = parts_->estimate[v] - curve.at(parts_->gap);
  return out;
}

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
