// Answers of a library corrected by own packings of the same material.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "calibrate/draws.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "pipelines/law/law_library.h"
#include "pipelines/law/law_library_numbers.h"

namespace softgrain {

namespace {

constexpr double kMostApart = 3.0;  ///< standard deviations beyond which two measurements contradict each other
/// Deviation of what a library says of a neighbour that it does not have, about what was measured: ln nu and m are
/// measured to 0.1 and better, so that it has no weight.
constexpr double kNoKnowledge = 3.0;

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
  if (const std::string other = other_shell_text(library, own.spec); !other.empty()) append_part(out, other);
  return out;
}

/// The library with the neighbours that an own law alone has, solid ones, soft ones, then planes, by ratio.
LawLibrary with_neighbours_of(const MultiContactLaw& own, LawLibrary library) {
  const auto place = [](const LibraryPartner& p) {
    return std::tuple{p.kind == PartnerKind::plane, p.kind == PartnerKind::soft, p.ratio};
  };
  for (const PartnerRow& row : own.partners) {
    const auto same = [&](const LibraryPartner& p) {
      return p.kind == row.kind && std::abs(p.ratio - row.ratio) <= kSameRatio;
    };
    const bool determined = std::isfinite(row.weight.standard_error) && row.weight.standard_error > 0.0;
    if (determined && std::ranges::none_of(library.partners, same)) library.partners.push_back({row.kind, row.ratio});
  }
  std::ranges::sort(library.partners, {}, place);
  return library;
}

/// An answer in the order of a library that has more neighbours; what is not known of these is what was measured, with
/// kNoKnowledge.
LibraryAnswer in_order_of(const LawLibrary& wide, const LawLibrary& narrow, const LibraryAnswer& answer,
                          const OwnNumbers& own) {
  const std::vector<std::string> names = wide.names();
  const std::size_t count = wide.law_numbers();
  const std::size_t before = narrow.law_numbers();
  std::vector<std::size_t> from;
  LibraryAnswer out = answer;
  out.numbers.clear();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto at = std::ranges::find(answer.numbers, names[k], &LibraryNumber::name);
    from.push_back(static_cast<std::size_t>(at - answer.numbers.begin()));
    const bool known = at != answer.numbers.end();
    out.numbers.push_back(known ? *at : LibraryNumber{names[k], own.values[k], kNoKnowledge});
  }
  out.correlations.assign(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      out.correlations[i * count + j] = i == j ? 1.0
                                        : from[i] < before && from[j] < before
                                            ? answer.correlations[from[i] * before + from[j]]
                                            : 0.0;
  return out;
}

/// Both were measured: as far as the farther one.
LibraryRange joint_range(const LawLibrary& wide, const LawLibrary& narrow, const LibraryRange& range,
                         const LawTableEntry& own, const MultiContactLaw& law) {
  LibraryRange out{own.packings,
                   std::max(own.volume_max, range.volume_max),
                   std::max(own.overlap_max, range.overlap_max),
                   std::max(own.grain_overlap_max, range.grain_overlap_max),
                   {}};
  for (const LibraryPartner& p : wide.partners) {
    double most = 0.0;
    for (std::size_t k = 0; k < narrow.partners.size(); ++k)
      if (narrow.partners[k] == p) most = std::max(most, range.partner_overlap_max[k]);
    for (const PartnerRow& row : law.partners)
      if (row.kind == p.kind && std::abs(row.ratio - p.ratio) <= kSameRatio) most = std::max(most, row.overlap_max);
    out.partner_overlap_max.push_back(most);
  }
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

/// All numbers of the law together, with their covariances.
void correct_law(LibraryAnswer& answer, const OwnNumbers& own, const std::vector<std::size_t>& told,
                 std::size_t count) {
  NormalNumbers before{{}, law_covariance(answer, count)};
  for (std::size_t k = 0; k < count; ++k) before.mean.push_back(answer.numbers[k].value);
  std::vector<double> errors(own.errors.begin(), own.errors.begin() + static_cast<std::ptrdiff_t>(count));
  for (double& e : errors) e = std::isfinite(e) ? e : 0.0;
  const NormalNumbers after = updated(before, told, {own.values, covariance_of(errors, own.correlations)});
  for (std::size_t k = 0; k < count; ++k) {
    answer.numbers[k].value = after.mean[k];
    answer.numbers[k].deviation = std::sqrt(std::max(after.covariance[k * count + k], 0.0));
  }
  answer.correlations = correlations_of(after.covariance, count);
}

std::vector<std::string> contradictions(const LibraryAnswer& library, const OwnNumbers& own,
                                        const std::vector<std::size_t>& told) {
  std::vector<std::string> out;
  for (const std::size_t k : told) {
    const LibraryNumber& n = library.numbers[k];
    if (!std::isfinite(n.value) || n.name == kTrialsNumber) continue;  // trials make packings, no forces
    const double apart = std::abs(own.values[k] - n.value) / std::hypot(own.errors[k], n.deviation);
    if (apart > kMostApart)
      out.push_back(fmt::format("{} {:.4g}, library {:.4g}, {:.1f} standard deviations apart", n.name, own.values[k],
                                n.value, apart));
  }
  return out;
}

/// Number by number; `told`: those of own packings. `known`: names that the library has.
std::vector<PriorNumber> number_by_number(const LibraryAnswer& before, const LibraryAnswer& after,
                                          const OwnNumbers& own, const std::vector<std::size_t>& told,
                                          const std::vector<std::string>& known) {
  std::vector<PriorNumber> out;
  for (std::size_t k = 0; k < after.numbers.size(); ++k) {
    const LibraryNumber& n = after.numbers[k];
    if (!std::isfinite(n.value)) continue;
    PriorNumber one;
    one.name = n.name;
    one.value = n.value;
    one.error = n.deviation;
    if (std::ranges::find(told, k) != told.end()) {
      one.own = own.values[k];
      one.own_error = own.errors[k];
    }
    const LibraryNumber& its = before.numbers[k];
    if (std::isfinite(its.value) && std::ranges::find(known, n.name) != known.end()) {
      one.library = its.value;
      one.library_error = its.deviation;
    }
    const double left = its.deviation > 0.0 ? n.deviation / its.deviation : 1.0;
    one.own_weight = std::isfinite(one.library) ? std::clamp(1.0 - left * left, 0.0, 1.0) : 1.0;
    out.push_back(std::move(one));
  }
  return out;
}

/// Own configurations keep their errors; of ways of which none was held out the library says how far off the form is.
std::vector<ConfigurationError> errors_of(const MultiContactLaw& own, const MultiContactLaw& of_answer) {
  std::vector<ConfigurationError> out = own.errors;
  for (const ConfigurationError& e : of_answer.errors)
    if (std::ranges::none_of(own.errors, [&](const ConfigurationError& its) {
          return its.use == MultiContactUse::predicted && its.in_proportion == e.in_proportion;
        }))
      out.push_back(e);
  return out;
}

}  // namespace

std::string other_shell_text(const LawLibrary& library, const SoftParticleSpec& spec) {
  std::string out;
  if (spec.sizes) append_part(out, "grain sizes of another law than P(r) ~ r^-b");
  const auto shell = [&](const char* name, double its, double of_library) {
    if (!is_same(its, of_library))
      append_part(out, fmt::format("{} = {:g}, the library has {:g}", name, its, of_library));
  };
  shell("rmax_over_shell", spec.rmax_over_shell, library.rmax_over_shell);
  shell("beta", spec.beta, library.beta);
  return out;
}

const LawTableEntry& own_entry(const LawLibrary& library, const LibraryPoint& at, const LawTable& own,
                               const std::string& source) {
  const LawTableEntry& out = *std::ranges::min_element(
      own.entries, {}, [&](const LawTableEntry& e) { return std::abs(e.solid_fraction - at.solid_fraction); });
  if (const std::string text = not_measured_text(out); !text.empty())
    throw InputError(fmt::format("{}: no table of own packings: {}", source, text));
  if (const std::string other = differences_of(library, at, out); !other.empty())
    throw InputError(source + ": is of another material: " + other);
  return out;
}

double own_error_factor(const MultiContactLaw& law) {
  double noise = 0.0;
  int n = 0;
  for (const ConfigurationError& e : law.errors) {
    if (e.use != MultiContactUse::fitted) continue;
    noise += e.noise * e.noise;
    ++n;
  }
  if (!std::isfinite(law.error_cross) || !(noise > 0.0)) return 1.0;
  return std::max(1.0, law.error_cross / std::sqrt(noise / n));
}

CorrectedAnswer corrected(const LawLibrary& library, const LibraryAnswer& prior, const LawTableEntry& own) {
  const MultiContactLaw* law = own.find(LawForm::isotropic);
  if (law == nullptr) throw InputError("law library: the own table has no isotropic law");
  CorrectedAnswer out{
      with_neighbours_of(*law, library), {}, {library.path, prior.distance, own_error_factor(*law), {}}, {}, ""};
  OwnNumbers numbers = own_numbers(out.library.partners, own);
  const std::size_t count = out.library.law_numbers();
  for (std::size_t k = 0; k < count; ++k) numbers.errors[k] *= out.prior.own_factor;
  const LibraryAnswer before = in_order_of(out.library, library, prior, numbers);
  const std::vector<std::size_t> of_law = told_of_law(numbers, count);
  const std::vector<std::size_t> of_sides = told_of_sides(numbers, count);
  std::vector<std::size_t> told = of_law;
  told.insert(told.end(), of_sides.begin(), of_sides.end());
  out.answer = before;
  correct_law(out.answer, numbers, of_law, count);
  for (const std::size_t k : of_sides) correct_side(out.answer.numbers[k], numbers.values[k], numbers.errors[k]);
  for (const std::size_t k : told) std::erase(out.answer.by_mean, out.answer.numbers[k].name);
  out.answer.range = joint_range(out.library, library, prior.range, own, *law);
  out.contradicted = contradictions(before, numbers, told);
  out.prior.numbers = number_by_number(before, out.answer, numbers, told, library.names());
  out.remark = fmt::format("corrected by {} own packings of solid fraction {:.4f}", own.packings, own.solid_fraction);
  return out;
}

std::string contradictions_text(const CorrectedAnswer& answer) {
  if (answer.contradicted.empty()) return "";
  return "own measurements contradict the library: " + join_text(answer.contradicted, "; ");
}

LawTable table_of(const CorrectedAnswer& corrected, const LibraryMatter& matter, int draws) {
  LawTable out = table_of(corrected.library, corrected.answer, matter, draws);
  LawTableEntry& e = out.entries.front();
  e.source = TableSource::combined;
  e.prior = corrected.prior;
  append_part(e.relaxation, corrected.remark);
  return out;
}

LawTableEntry combined_entry(const CorrectedAnswer& corrected, const LawTableEntry& own, int draws) {
  const MultiContactLaw& before = *own.find(LawForm::isotropic);
  MultiContactLaw law = law_of_answer(corrected.library, corrected.answer, own.spec.poisson_ratio, draws);
  LawTableEntry out = own;
  const auto side = corrected.answer.numbers.begin() + static_cast<std::ptrdiff_t>(corrected.library.law_numbers());
  set_side_numbers({side, corrected.answer.numbers.end()}, out, law);
  out.spec = own.spec;
  law.status = before.status;
  law.reason = before.reason;
  law.errors = errors_of(before, law);
  law.error_fitted = before.error_fitted;
  if (std::isfinite(before.error_held_out)) law.error_held_out = before.error_held_out;
  law.error_cross = before.error_cross;
  law.criterion = before.criterion;
  law.replicates_failed = before.replicates_failed;
  for (PartnerRow& row : law.partners)
    for (const PartnerRow& its : before.partners)
      if (its.kind == row.kind && std::abs(its.ratio - row.ratio) <= kSameRatio) row.error = its.error;
  out.volume_max = corrected.answer.range.volume_max;
  out.overlap_max = corrected.answer.range.overlap_max;
  out.grain_overlap_max = corrected.answer.range.grain_overlap_max;
  out.source = TableSource::combined;
  out.prior = corrected.prior;
  out.best = LawForm::isotropic;
  for (MultiContactLaw& one : out.laws)
    if (one.form == LawForm::isotropic) one = law;
  return out;
}

}  // namespace softgrain
