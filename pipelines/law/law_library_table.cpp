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

void require_same_shell(const LawLibrary& library, const LawTableEntry& entry, const std::string& source) {
  if (entry.spec.sizes) throw InputError(source + ": sizes of another law than P(r) ~ r^-b have no place in a library");
  if (entry.spec.rmax_over_shell != library.rmax_over_shell || entry.spec.beta != library.beta)
    throw InputError(fmt::format("{}: rmax_over_shell = {}, beta = {}; this library has {}, {}", source,
                                 entry.spec.rmax_over_shell, entry.spec.beta, library.rmax_over_shell, library.beta));
}

std::vector<LibraryPartner> partners_of(const MultiContactLaw& law) {
  std::vector<LibraryPartner> out;
  for (const PartnerRow& row : law.partners) out.push_back({row.kind, row.ratio});
  return out;
}

/// Why a law is no row; empty: it is one.
std::string unfit(const LawTableEntry& entry, const MultiContactLaw* law) {
  if (const std::string text = not_measured_text(entry); !text.empty()) return text;
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

/// Value and interval of one number from its draws. The interval holds the value where draws lean to one side.
Estimate drawn_estimate(double value, const std::vector<std::vector<double>>& draws, std::size_t k) {
  std::vector<double> column;
  for (const std::vector<double>& d : draws) column.push_back(d[k]);
  const double deviation = mean_error(column).deviation_or_zero();
  return {value, deviation, std::min(quantile(column, 0.025), value), std::max(quantile(column, 0.975), value)};
}

}  // namespace

std::string not_measured_text(const LawTableEntry& entry) {
  if (entry.source == TableSource::measured) return "";
  if (entry.source == TableSource::combined) return "corrected by a library already";
  return "concluded from a " + to_string(entry.source) + ", not measured";
}

MultiContactLaw law_of_answer(const LawLibrary& library, const LibraryAnswer& answer, double poisson_ratio, int draws) {
  const std::size_t count = library.law_numbers();
  std::vector<double> mean;
  for (std::size_t k = 0; k < count; ++k) mean.push_back(answer.numbers[k].value);
  const std::vector<double> c = law_covariance(answer, count);
  MultiContactLaw law;
  law.form = LawForm::isotropic;
  for (std::size_t k = 0; k < library.partners.size(); ++k)
    law.partners.push_back(
        {library.partners[k].kind, library.partners[k].ratio, {}, {}, answer.range.partner_overlap_max[k], 0.0});
  const std::vector<double> numbers = law_numbers_of(library.partners, mean, poisson_ratio);
  // Whoever takes refits of a table widens them by this, see few_samples_factor(): errors of the library hold it
  // already.
  const double widening = factor_of_several(answer.range.packings);
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
  const OwnNumbers numbers = own_numbers(library.partners, entry);
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
  LawTableEntry e;
  e.spec = spec_of_answer(library, answer, matter);
  e.source = of_press_test(answer) ? TableSource::press_test : TableSource::library;
  e.solid_fraction = answer.at.solid_fraction;
  e.solid_fraction_error = answer.solid_fraction_error;
  e.main = true;
  e.packings = answer.range.packings;
  e.relaxation =
      fmt::format("{}interpolated between {} measured materials; {}", of_press_test(answer) ? "of a press test, " : "",
                  library.materials.size(), nearest_text(library, answer));
  if (const std::string means = means_text(answer); !means.empty()) append_part(e.relaxation, means);
  e.volume_max = answer.range.volume_max;
  e.overlap_max = answer.range.overlap_max;
  e.grain_overlap_max = answer.range.grain_overlap_max;
  e.best = LawForm::isotropic;
  MultiContactLaw law = law_of_answer(library, answer, matter.poisson_ratio, draws);
  const auto side = answer.numbers.begin() + static_cast<std::ptrdiff_t>(library.law_numbers());
  set_side_numbers({side, answer.numbers.end()}, e, law);
  e.laws = {std::move(law)};
  LawTable table;
  table.entries = {std::move(e)};
  return table;
}

}  // namespace softgrain
