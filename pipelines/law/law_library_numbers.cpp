#include "pipelines/law/law_library_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/draws.h"
#include "common/contact/multi_contact_prediction.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/data/multi_contact_replicates.h"

namespace softgrain {

namespace {

constexpr double kForceAt = 0.35;  ///< D at which the force of a plane stands for a
constexpr double kLensAt = 0.02;   ///< v at which nu stands for w
constexpr double kLeastB = 1.01;
constexpr double kMostDelta = 0.3;
/// Errors of the form below these are not told from the scatter of packings: of forces, and of onsets [D].
constexpr double kLeastShare = 0.03;
constexpr double kLeastOnset = 1e-3;
const double kNotKnown = std::nan("");

/// One measured number of an entry: value, error, whether it was measured.
struct SideNumber {
  const char* name;
  Estimate SlideLaw::*estimate;
  SlideLaw LawTableEntry::*slide;
  double least = 0.0;
};
constexpr std::array<SideNumber, 14> kSideNumbers{
    {{"kt/kn plane", &SlideLaw::kt_ratio, &LawTableEntry::slide_plane},
     {"friction plane", &SlideLaw::friction, &LawTableEntry::slide_plane},
     {"rolling plane", &SlideLaw::rolling, &LawTableEntry::slide_plane},
     {"rolling friction plane", &SlideLaw::rolling_friction, &LawTableEntry::slide_plane},
     {"kt/kn solid", &SlideLaw::kt_ratio, &LawTableEntry::slide_solid},
     {"friction solid", &SlideLaw::friction, &LawTableEntry::slide_solid},
     {"rolling solid", &SlideLaw::rolling, &LawTableEntry::slide_solid},
     {"rolling friction solid", &SlideLaw::rolling_friction, &LawTableEntry::slide_solid},
     {"unloading solid", &SlideLaw::unloading, &LawTableEntry::slide_solid, 1.0},
     {"kt/kn soft", &SlideLaw::kt_ratio, &LawTableEntry::slide_soft},
     {"friction soft", &SlideLaw::friction, &LawTableEntry::slide_soft},
     {"rolling soft", &SlideLaw::rolling, &LawTableEntry::slide_soft},
     {"rolling friction soft", &SlideLaw::rolling_friction, &LawTableEntry::slide_soft},
     {"unloading soft", &SlideLaw::unloading, &LawTableEntry::slide_soft, 1.0}}};
constexpr std::array kFormNumbers{"unloading plane", "ln error, in proportion", "ln error, sheared",
                                  "ln error of onset", kTrialsNumber};

bool is_rolling(const SideNumber& n) {
  return n.estimate == &SlideLaw::rolling || n.estimate == &SlideLaw::rolling_friction;
}

/// Moments are over E; in the library over E* = E/(1 - nu^2).
double modulus_share(const SideNumber& n, double poisson_ratio) {
  return n.estimate == &SlideLaw::rolling ? 1.0 - poisson_ratio * poisson_ratio : 1.0;
}

bool was_measured(const SideNumber& n, const SlideLaw& slide) {
  if (is_rolling(n)) return slide.rolls;
  if (n.estimate == &SlideLaw::unloading) return slide.has_unloading;
  return slide.measured;
}

/// Root mean square of what a law is off by on configurations that its fit did not see, the noise taken off.
double unseen_error(const MultiContactLaw& law, bool in_proportion) {
  double sum = 0.0;
  int n = 0;
  for (const ConfigurationError& e : law.errors) {
    if (e.use != MultiContactUse::predicted || e.in_proportion != in_proportion) continue;
    sum += std::max(e.error * e.error - e.noise * e.noise, 0.0);
    ++n;
  }
  return n > 0 ? std::log(std::max(std::sqrt(sum / n), kLeastShare)) : kNotKnown;
}

double onset_error(const MultiContactLaw& law) {
  double sum = 0.0;
  int n = 0;
  for (const ConfigurationError& e : law.errors)
    if (e.use == MultiContactUse::predicted && e.offset) {
      sum += e.offset->onset * e.offset->onset;
      ++n;
    }
  return n > 0 ? std::log(std::max(std::sqrt(sum / n), kLeastOnset)) : kNotKnown;
}

Estimate estimate_of(const LibraryNumber& n, double least, double share) {
  const double value = std::max(n.value, least) / share;
  const double error = n.deviation / share;
  return {value, error, std::max(least, value - kNormal95 * error), value + kNormal95 * error};
}

/// What stands in where too few materials have a number: as fit_sides() does.
void substitute_slides(LawTableEntry& entry) {
  if (!entry.slide_plane.measured)
    entry.slide_plane.kt_ratio = entry.slide_plane.friction = {0.3, kInfinity, -kInfinity, kInfinity};
  if (!entry.slide_plane.measured) entry.slide_plane.friction.value = entry.spec.friction;
  const auto as = [](SlideLaw& slide, const SlideLaw& other) {
    if (slide.measured) return;
    slide.kt_ratio = {other.kt_ratio.value, kInfinity, -kInfinity, kInfinity};
    slide.friction = {other.friction.value, kInfinity, -kInfinity, kInfinity};
  };
  as(entry.slide_solid, entry.slide_plane);
  as(entry.slide_soft, entry.slide_solid);
}

/// Root mean square of an error of which the logarithm is known to a deviation: that of a log-normal distribution.
double from_logarithm(const LibraryNumber& logarithm) {
  const double deviation = std::isfinite(logarithm.deviation) ? logarithm.deviation : 0.0;
  return std::exp(logarithm.value + deviation * deviation);
}

ConfigurationError form_error(const std::string& name, const LibraryNumber& error, const LibraryNumber& onset,
                              bool in_proportion) {
  ConfigurationError out;
  out.name = name;
  out.use = MultiContactUse::predicted;
  out.error = from_logarithm(error);
  out.end_ratio = 1.0;
  if (std::isfinite(onset.value)) out.offset = FormOffset{0.0, from_logarithm(onset)};
  out.in_proportion = in_proportion;
  return out;
}

void set_form_numbers(const LibraryNumber* n, LawTableEntry& entry, MultiContactLaw& law) {
  entry.unloading_measured = std::isfinite(n[0].value);
  entry.unloading =
      entry.unloading_measured ? estimate_of(n[0], 1.0, 1.0) : Estimate{1.0, kInfinity, -kInfinity, kInfinity};
  law.errors.clear();
  if (std::isfinite(n[1].value)) law.errors.push_back(form_error("library, in proportion", n[1], n[3], true));
  if (std::isfinite(n[2].value)) law.errors.push_back(form_error("library, sheared", n[2], n[3], false));
  double sum = 0.0;
  for (const ConfigurationError& e : law.errors) sum += e.error * e.error;
  if (!law.errors.empty())
    law.error_fitted = law.error_held_out = std::sqrt(sum / static_cast<double>(law.errors.size()));
  if (std::isfinite(n[4].value)) entry.spec.trials = std::max<std::int64_t>(1, std::llround(std::exp(n[4].value)));
}

}  // namespace

std::vector<std::string> side_names() {
  std::vector<std::string> out;
  for (const SideNumber& n : kSideNumbers) out.emplace_back(n.name);
  out.insert(out.end(), kFormNumbers.begin(), kFormNumbers.end());
  return out;
}

std::vector<double> library_numbers(const std::vector<LibraryPartner>& partners, const MultiContactLaw& law,
                                    const std::vector<double>& numbers, double poisson_ratio) {
  const double a = numbers[0] * (1.0 - poisson_ratio * poisson_ratio);
  const double b = numbers[1];
  const double delta = numbers[2];
  const double rise = std::pow(kForceAt, b) - std::pow(delta, b);
  std::vector<double> out{rise > 0.0 && a > 0.0 ? std::log(a * rise) : kNotKnown, b, delta};
  const std::size_t planes = kMultiContactParameters.size();
  double exponent = kNotKnown;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    double weight = kNotKnown;
    for (std::size_t r = 0; r < law.partners.size(); ++r) {
      const PartnerRow& row = law.partners[r];
      if (row.kind != partners[k].kind || std::abs(row.ratio - partners[k].ratio) > kSameRatio) continue;
      weight = std::log(numbers[planes + 2 * r]);
      exponent = numbers[planes + 2 * r + 1];
    }
    out.push_back(weight + exponent * std::log(kLensAt));
    if (k + 1 < partners.size() && partners[k + 1].kind == partners[k].kind) continue;
    out.push_back(exponent);
    exponent = kNotKnown;
  }
  return out;
}

std::vector<double> law_numbers_of(const std::vector<LibraryPartner>& partners, const std::vector<double>& numbers,
                                   double poisson_ratio) {
  const double b = std::max(numbers[1], kLeastB);
  const double delta = std::clamp(numbers[2], 0.0, kMostDelta);
  const double a = std::exp(numbers[0]) / (std::pow(kForceAt, b) - std::pow(delta, b));
  std::vector<double> out{a / (1.0 - poisson_ratio * poisson_ratio), b, delta, 1.0, 0.0, 0.0};
  std::size_t next = 3;
  for (std::size_t k = 0; k < partners.size();) {
    std::size_t end = k;
    while (end < partners.size() && partners[end].kind == partners[k].kind) ++end;
    const double exponent = std::clamp(numbers[next + end - k], 0.1, 10.0);
    for (; k < end; ++k, ++next) {
      out.push_back(std::exp(numbers[next] - exponent * std::log(kLensAt)));
      out.push_back(exponent);
    }
    ++next;
  }
  return out;
}

SideNumbers side_numbers(const LawTableEntry& entry, const MultiContactLaw& law) {
  SideNumbers out;
  const auto add = [&](bool measured, double value, double error) {
    out.values.push_back(measured && std::isfinite(error) ? value : kNotKnown);
    out.errors.push_back(measured && std::isfinite(error) ? error : kNotKnown);
  };
  for (const SideNumber& n : kSideNumbers) {
    const SlideLaw& slide = entry.*n.slide;
    const Estimate& e = slide.*n.estimate;
    const double share = modulus_share(n, entry.spec.poisson_ratio);
    add(was_measured(n, slide), e.value * share, e.standard_error * share);
  }
  add(entry.unloading_measured, entry.unloading.value, entry.unloading.standard_error);
  const double trials = std::log(static_cast<double>(std::max<std::int64_t>(entry.spec.trials, 1)));
  for (const double x : {unseen_error(law, true), unseen_error(law, false), onset_error(law), trials})
    add(std::isfinite(x), x, 0.0);
  return out;
}

void set_side_numbers(const std::vector<LibraryNumber>& numbers, LawTableEntry& entry, MultiContactLaw& law) {
  for (SlideLaw LawTableEntry::*slide :
       {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft})
    (entry.*slide).measured = (entry.*slide).rolls = (entry.*slide).has_unloading = true;
  for (std::size_t k = 0; k < kSideNumbers.size(); ++k) {
    const SideNumber& n = kSideNumbers[k];
    SlideLaw& slide = entry.*n.slide;
    if (std::isfinite(numbers[k].value)) {
      slide.*n.estimate = estimate_of(numbers[k], n.least, modulus_share(n, entry.spec.poisson_ratio));
      continue;
    }
    bool& measured = is_rolling(n)                        ? slide.rolls
                     : n.estimate == &SlideLaw::unloading ? slide.has_unloading
                                                          : slide.measured;
    measured = false;
  }
  entry.slide_plane.has_unloading = false;  // that of planes is LawTableEntry::unloading
  substitute_slides(entry);
  set_form_numbers(numbers.data() + kSideNumbers.size(), entry, law);
}

RefitSpread refit_spread(const std::vector<LibraryPartner>& partners, const LawTableEntry& entry,
                         const MultiContactLaw& law) {
  std::vector<std::vector<double>> draws;
  for (const std::vector<double>& one : law.replicates)
    draws.push_back(library_numbers(partners, law, one, entry.spec.poisson_ratio));
  const std::size_t size = library_numbers(partners, law, multi_contact_numbers(law), 0.0).size();
  const double factor = few_samples_factor(static_cast<std::size_t>(std::max(entry.packings, 2)));
  RefitSpread out;
  for (std::size_t k = 0; k < size; ++k) {
    const MeanError e = finite_mean(draws, [k](const std::vector<double>& d) { return d[k]; });
    out.errors.push_back(e.n >= kEnoughReplicates && e.deviation > 0.0 ? factor * e.deviation : kNotKnown);
  }
  for (std::vector<double>& d : draws)
    for (double& x : d) x = std::isfinite(x) ? x : 0.0;
  out.correlations = correlations(draws, size);
  return out;
}

LibraryPoint library_point_of(const LawTableEntry& entry) {
  return {entry.spec.friction, entry.spec.exponent, entry.spec.polydispersity, entry.solid_fraction};
}

OwnNumbers own_numbers(const std::vector<LibraryPartner>& partners, const LawTableEntry& own) {
  const MultiContactLaw* law = own.find(LawForm::isotropic);
  if (law == nullptr) throw InputError("law library: the own table has no isotropic law");
  if (law->replicates.size() < kEnoughReplicates)
    throw InputError(
        fmt::format("law library: the own table has {} refits of its isotropic law; {} are needed (the "
                    ".h5 beside it holds them)",
                    law->replicates.size(), kEnoughReplicates));
  const RefitSpread spread = refit_spread(partners, own, *law);
  OwnNumbers out{library_numbers(partners, *law, multi_contact_numbers(*law), own.spec.poisson_ratio), spread.errors,
                 spread.correlations};
  const SideNumbers side = side_numbers(own, *law);
  out.values.insert(out.values.end(), side.values.begin(), side.values.end());
  out.errors.insert(out.errors.end(), side.errors.begin(), side.errors.end());
  return out;
}

std::vector<double> covariance_of(const std::vector<double>& deviations, const std::vector<double>& correlations) {
  const std::size_t n = deviations.size();
  std::vector<double> out(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out[i * n + j] = correlations[i * n + j] * deviations[i] * deviations[j];
  return out;
}

std::vector<double> law_covariance(const LibraryAnswer& answer, std::size_t count) {
  std::vector<double> deviations;
  for (std::size_t k = 0; k < count; ++k) deviations.push_back(answer.numbers[k].deviation);
  return covariance_of(deviations, answer.correlations);
}

}  // namespace softgrain
