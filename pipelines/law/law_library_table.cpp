// From law tables to rows of a library, and from answers of a library to a law table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/draws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/multi_contact_replicates.h"
#include "pipelines/law/law_library.h"
#include "pipelines/law/law_library_numbers.h"
#include "pipelines/law/law_library_press.h"

namespace softgrain {

namespace {

constexpr double kWorstUnseen = 0.5;  ///< error on unseen configurations above which a law is no row

LibraryPoint library_point_of(const LawTableEntry& entry) {
  return {entry.spec.friction, entry.spec.exponent, entry.spec.polydispersity, entry.solid_fraction};
}

void require_same_shell(const LawLibrary& library, const LawTableEntry& entry, const std::string& source) {
  if (entry.spec.sizes) throw InputError(source + ": sizes of another law than P(r) ~ r^-b have no place in a library");
  if (entry.spec.rmax_over_shell != library.rmax_over_shell || entry.spec.beta != library.beta)
    throw InputError(fmt::format("{}: rmax_over_shell = {}, beta = {}; this library has {}, {}", source,
                                 entry.spec.rmax_over_shell, entry.spec.beta, library.rmax_over_shell, library.beta));
}

/// Whether a number of a table is the one that was asked for: what somebody gives is rounded.
bool is_same(double measured, double asked) {
  constexpr double kRounding = 1e-3;
  return std::abs(measured - asked) <= kRounding * std::max(1.0, std::abs(asked));
}

/// In what an own table differs from the library and the material that was asked for; empty: in nothing.
std::string differences_of(const LawLibrary& library, const LibraryPoint& at, const LawTableEntry& own) {
  std::string out;
  const LibraryPoint measured = library_point_of(own);
  for (const LibraryVariable& v : kLibraryVariables)
    if (v.value != &LibraryPoint::solid_fraction && !is_same(measured.*v.value, at.*v.value))
      append_part(out, fmt::format("{} = {:.6g}, asked {:.6g}", v.name, measured.*v.value, at.*v.value));
  if (!(std::abs(own.solid_fraction - at.solid_fraction) <= kReachOfPackings))
    append_part(out, fmt::format("its nearest solid fraction is {:.4f}, asked {:.4f}: must be at most {:g} apart",
                                 own.solid_fraction, at.solid_fraction, kReachOfPackings));
  if (own.spec.sizes) append_part(out, "grain sizes of another law than P(r) ~ r^-b");
  const auto shell = [&](const char* name, double its, double of_library) {
    if (!is_same(its, of_library))
      append_part(out, fmt::format("{} = {:g}, the library has {:g}", name, its, of_library));
  };
  shell("rmax_over_shell", own.spec.rmax_over_shell, library.rmax_over_shell);
  shell("beta", own.spec.beta, library.beta);
  return out;
}

std::vector<LibraryPartner> partners_of(const MultiContactLaw& law) {
  std::vector<LibraryPartner> out;
  for (const PartnerRow& row : law.partners) out.push_back({row.kind, row.ratio});
  return out;
}

/// Why a law is no row; empty: it is one.
std::string unfit(const LawTableEntry& entry, const MultiContactLaw* law) {
  if (entry.source != TableSource::measured) return "concluded from a " + to_string(entry.source) + ", not measured";
  if (law == nullptr) return "no isotropic law";
  if (law->status != LawStatus::good && law->status != LawStatus::inaccurate) return to_string(law->status);
  if (law->error_held_out > kWorstUnseen)
    return fmt::format("{:.0f} % off on unseen configurations", 100.0 * law->error_held_out);
  if (law->replicates.size() < kEnoughReplicates)
    return fmt::format("{} refits; {} are needed", law->replicates.size(), kEnoughReplicates);
  return entry.solid_fraction > 0.0 ? "" : "no solid fraction";
}

/// Empty where no law of pairs was fitted. It is always inaccurate, being off where there are more neighbours.
std::optional<PressNumbers> press_numbers_of(const LawTableEntry& entry) {
  const MultiContactLaw* law = entry.find(LawForm::pair);
  if (law == nullptr || !(has_numbers(law->status) || law->status == LawStatus::inaccurate)) return std::nullopt;
  return press_numbers(law->a.value, law->b.value, law->delta.value, entry.spec.poisson_ratio);
}

/// Covariance, row-major, from deviations and correlations of the first numbers.
std::vector<double> covariance_of(const std::vector<double>& deviations, const std::vector<double>& correlations) {
  const std::size_t n = deviations.size();
  std::vector<double> out(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out[i * n + j] = correlations[i * n + j] * deviations[i] * deviations[j];
  return out;
}

std::vector<double> deviations_of(const LibraryAnswer& answer, std::size_t count) {
  std::vector<double> out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(answer.numbers[k].deviation);
  return out;
}

/// Value and interval of one number from its draws.
Estimate drawn_estimate(double value, const std::vector<std::vector<double>>& draws, std::size_t k) {
  std::vector<double> column;
  for (const std::vector<double>& d : draws) column.push_back(d[k]);
  const double deviation = mean_error(column).deviation_or_zero();
  return {value, deviation, quantile(column, 0.025), quantile(column, 0.975)};
}

MultiContactLaw law_of_answer(const LawLibrary& library, const LibraryAnswer& answer, double poisson_ratio, int draws) {
  const std::size_t count = library.law_numbers();
  std::vector<double> mean;
  for (std::size_t k = 0; k < count; ++k) mean.push_back(answer.numbers[k].value);
  const std::vector<double> c = covariance_of(deviations_of(answer, count), answer.correlations);
  MultiContactLaw law;
  law.form = LawForm::isotropic;
  for (std::size_t k = 0; k < library.partners.size(); ++k)
    law.partners.push_back({library.partners[k].kind,
                            library.partners[k].ratio,
                            {},
                            {},
                            library.materials[answer.nearest].partner_overlap_max[k],
                            0.0});
  const std::vector<double> numbers = law_numbers_of(library.partners, mean, poisson_ratio);
  // Whoever takes refits of a table widens them by this, see few_samples_factor(): errors of the library hold it
  // already.
  const double widening = factor_of_several(library.materials[answer.nearest].packings);
  std::vector<std::vector<double>> drawn;
  for (std::vector<double>& draw : normal_draws(mean, c, draws, 1)) {
    drawn.push_back(law_numbers_of(library.partners, draw, poisson_ratio));
    for (std::size_t k = 0; k < count; ++k) draw[k] = mean[k] + (draw[k] - mean[k]) / widening;
    law.replicates.push_back(law_numbers_of(library.partners, draw, poisson_ratio));
  }
  const std::size_t planes = kMultiContactParameters.size();
  for (std::size_t k = 0; k < planes; ++k)
    law.*kMultiContactParameters[k].estimate = drawn_estimate(numbers[k], drawn, k);
  for (std::size_t r = 0; r < law.partners.size(); ++r) {
    law.partners[r].weight = drawn_estimate(numbers[planes + 2 * r], drawn, planes + 2 * r);
    law.partners[r].exponent = drawn_estimate(numbers[planes + 2 * r + 1], drawn, planes + 2 * r + 1);
  }
  law.parameters = 3;
  return law;
}

/// What the measured numbers of a table say of a material: of the law, then of all else.
struct OwnNumbers {
  std::vector<double> values;
  std::vector<double> errors;
  std::vector<double> correlations;
};

OwnNumbers own_numbers(const LawLibrary& library, const LawTableEntry& own) {
  const MultiContactLaw* law = own.find(LawForm::isotropic);
  if (law == nullptr) throw InputError("law library: the own table has no isotropic law");
  if (law->replicates.size() < kEnoughReplicates)
    throw InputError(
        fmt::format("law library: the own table has {} refits of its isotropic law; {} are needed (the "
                    ".h5 beside it holds them)",
                    law->replicates.size(), kEnoughReplicates));
  const RefitSpread spread = refit_spread(library.partners, own, *law);
  OwnNumbers out{library_numbers(library.partners, *law, multi_contact_numbers(*law), own.spec.poisson_ratio),
                 spread.errors, spread.correlations};
  const SideNumbers side = side_numbers(own, *law);
  out.values.insert(out.values.end(), side.values.begin(), side.values.end());
  out.errors.insert(out.errors.end(), side.errors.begin(), side.errors.end());
  return out;
}

/// Numbers of the law that own measurements tell: one whose refits do not scatter was not fitted.
std::vector<std::size_t> told_of_law(const OwnNumbers& own, std::size_t law_numbers) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < law_numbers; ++k)
    if (std::isfinite(own.values[k]) && std::isfinite(own.errors[k]) && own.errors[k] > 0.0) out.push_back(k);
  return out;
}

/// The same of all else. Errors of the form and trials have no error of their own: they are as measured.
std::vector<std::size_t> told_of_sides(const OwnNumbers& own, std::size_t law_numbers) {
  std::vector<std::size_t> out;
  for (std::size_t k = law_numbers; k < own.values.size(); ++k)
    if (std::isfinite(own.values[k]) && std::isfinite(own.errors[k])) out.push_back(k);
  return out;
}

/// A number of the library and one of own packings, weighted by their variances.
void correct_side(LibraryNumber& n, double value, double error) {
  const double variance = n.deviation * n.deviation;
  const double share = std::isfinite(n.value) && error > 0.0 ? variance / (variance + error * error) : 1.0;
  n.value = share < 1.0 ? n.value + share * (value - n.value) : value;
  n.deviation = std::sqrt(share) * error;
}

void compare_with_own(const LibraryAnswer& prior, const OwnNumbers& own, const std::vector<std::size_t>& told,
                      std::vector<std::string>& remarks) {
  constexpr double kMost = 3.0;
  for (const std::size_t k : told) {
    const LibraryNumber& n = prior.numbers[k];
    if (!std::isfinite(n.value)) continue;
    const double off = (own.values[k] - n.value) / std::hypot(own.errors[k], n.deviation);
    if (std::abs(off) > kMost)
      remarks.push_back(
          fmt::format("own measurements contradict the library: {} {:.4g}, library {:.4g}, {:.1f} "
                      "standard deviations apart",
                      n.name, own.values[k], n.value, std::abs(off)));
  }
}

}  // namespace

LawLibrary library_like(const LawTableEntry& entry) {
  LawLibrary out;
  out.partners = partners_of(*entry.find(LawForm::isotropic));
  out.rmax_over_shell = entry.spec.rmax_over_shell;
  out.beta = entry.spec.beta;
  return out;
}

std::optional<LibraryMaterial> library_row(const LawLibrary& library, const LawTableEntry& entry,
                                           const std::string& source, std::string& why) {
  const MultiContactLaw* law = entry.find(LawForm::isotropic);
  why = unfit(entry, law);
  if (!why.empty()) return std::nullopt;
  require_same_shell(library, entry, source);
  if (partners_of(*law) != library.partners)
    throw InputError(source + ": measured with other kinds or sizes of neighbours than the library");
  LibraryMaterial m;
  m.source = source;
  m.at = library_point_of(entry);
  m.packings = entry.packings;
  const OwnNumbers numbers = own_numbers(library, entry);
  m.numbers = numbers.values;
  m.errors = numbers.errors;
  m.correlations = numbers.correlations;
  m.volume_max = entry.volume_max;
  m.overlap_max = entry.overlap_max;
  m.grain_overlap_max = entry.grain_overlap_max;
  for (const PartnerRow& row : law->partners) m.partner_overlap_max.push_back(row.overlap_max);
  m.press = press_numbers_of(entry);
  if (std::isfinite(m.numbers[0])) return m;
  why = "its threshold lies beyond the depth at which laws are compared";
  return std::nullopt;
}

namespace {

/// What is known of the soft particle: of a press test not what is inside.
SoftParticleSpec spec_of_answer(const LawLibrary& library, const LibraryAnswer& answer, const LibraryMatter& matter) {
  SoftParticleSpec s = unknown_soft_particle(matter.shell_radius, matter.youngs_modulus);
  s.poisson_ratio = matter.poisson_ratio;
  s.density = matter.density;
  s.restitution = matter.restitution;
  s.friction = answer.at.friction;
  if (of_press_test(answer)) return s;
  s.exponent = answer.at.exponent;
  s.polydispersity = answer.at.polydispersity;
  s.rmax_over_shell = library.rmax_over_shell;
  s.beta = library.beta;
  s.placement = Placement::voids;
  return s;
}

}  // namespace

LawTable table_of(const LawLibrary& library, const LibraryAnswer& answer, const LibraryMatter& matter, int draws) {
  const LibraryMaterial& nearest = library.materials[answer.nearest];
  LawTableEntry e;
  e.spec = spec_of_answer(library, answer, matter);
  e.source = of_press_test(answer) ? TableSource::press_test : TableSource::library;
  e.solid_fraction = answer.at.solid_fraction;
  e.solid_fraction_error = answer.solid_fraction_error;
  e.main = true;
  e.packings = nearest.packings;
  e.relaxation =
      fmt::format("{}interpolated between {} measured materials; {}", of_press_test(answer) ? "of a press test, " : "",
                  library.materials.size(), nearest_text(library, answer));
  if (const std::string means = means_text(answer); !means.empty()) append_part(e.relaxation, means);
  e.volume_max = nearest.volume_max;
  e.overlap_max = nearest.overlap_max;
  e.grain_overlap_max = nearest.grain_overlap_max;
  e.best = LawForm::isotropic;
  MultiContactLaw law = law_of_answer(library, answer, matter.poisson_ratio, draws);
  const auto side = answer.numbers.begin() + static_cast<std::ptrdiff_t>(library.law_numbers());
  set_side_numbers({side, answer.numbers.end()}, e, law);
  e.laws = {std::move(law)};
  LawTable table;
  table.entries = {std::move(e)};
  return table;
}

const LawTableEntry& own_entry(const LawLibrary& library, const LibraryPoint& at, const LawTable& own,
                               const std::string& source) {
  const LawTableEntry& out = *std::ranges::min_element(
      own.entries, {}, [&](const LawTableEntry& e) { return std::abs(e.solid_fraction - at.solid_fraction); });
  if (const std::string other = differences_of(library, at, out); !other.empty())
    throw InputError(source + ": is of another material: " + other);
  return out;
}

LibraryAnswer corrected(const LawLibrary& library, const LibraryAnswer& prior, const LawTableEntry& own,
                        std::vector<std::string>& remarks) {
  const OwnNumbers numbers = own_numbers(library, own);
  remarks.push_back(
      fmt::format("corrected by {} own packings of solid fraction {:.4f}", own.packings, own.solid_fraction));
  const std::size_t count = library.law_numbers();
  const std::vector<std::size_t> of_law = told_of_law(numbers, count);
  const std::vector<std::size_t> of_sides = told_of_sides(numbers, count);
  compare_with_own(prior, numbers, of_law, remarks);
  compare_with_own(prior, numbers, of_sides, remarks);
  LibraryAnswer out = prior;
  NormalNumbers before{{}, covariance_of(deviations_of(prior, count), prior.correlations)};
  for (std::size_t k = 0; k < count; ++k) before.mean.push_back(prior.numbers[k].value);
  std::vector<double> own_errors(numbers.errors.begin(), numbers.errors.begin() + static_cast<std::ptrdiff_t>(count));
  for (double& e : own_errors) e = std::isfinite(e) ? e : 0.0;
  const NormalNumbers after =
      updated(before, of_law, {numbers.values, covariance_of(own_errors, numbers.correlations)});
  for (std::size_t k = 0; k < count; ++k) {
    out.numbers[k].value = after.mean[k];
    out.numbers[k].deviation = std::sqrt(std::max(after.covariance[k * count + k], 0.0));
  }
  out.correlations = correlations_of(after.covariance, count);
  for (const std::size_t k : of_sides) correct_side(out.numbers[k], numbers.values[k], numbers.errors[k]);
  for (const auto& told : {of_law, of_sides})
    for (const std::size_t k : told) std::erase(out.by_mean, out.numbers[k].name);
  return out;
}

}  // namespace softgrain
