#include "pipelines/law/law_draws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibrate/draws.h"
#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/data/card_text.h"
#include "common/data/multi_contact_replicates.h"
#include "microsim/multi_contact_arrangements.h"
#include "pipelines/law/cell_draws.h"

namespace softgrain {

namespace {

/// Overlaps at which a law is asked what it says, over the radius of the soft particle.
constexpr std::array kProbes{0.05, 0.08, 0.12, 0.16, 0.20, 0.25};

/// Logarithms of forces; what is far below the largest of the law as it is counts as equally small.
class LogForces {
 public:
  explicit LogForces(const std::vector<double>& best) {
    for (const double f : best) floor_ = std::max(floor_, 0.01 * f);
  }
  [[nodiscard]] std::vector<double> operator()(std::vector<double> forces) const {
    for (double& f : forces) f = std::log(std::max(f, 0.0) + floor_);
    return forces;
  }

 private:
  double floor_ = 1e-300;
};

// Of tables: a, b, delta, m0, m1, m2, then weight and exponent of every row. a and the weights are positive.
bool is_logarithm(std::size_t k) {
  const std::size_t planes = kMultiContactParameters.size();
  return k == 0 || (k >= planes && (k - planes) % 2 == 0);
}

std::vector<double> with_logarithms(std::vector<double> numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (is_logarithm(k)) numbers[k] = std::log(numbers[k]);
  return numbers;
}

MultiContactLaw law_of_numbers(const MultiContactLaw& law, std::vector<double> numbers) {
  constexpr double kLeastExponent = 1.01;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (is_logarithm(k)) numbers[k] = std::exp(numbers[k]);
  numbers[1] = std::max(numbers[1], kLeastExponent);
  numbers[2] = std::max(numbers[2], 0.0);
  return with_numbers(law, numbers);
}

/// Forces on the first of several neighbours around the soft particle: for each kind of neighbour, two arrangements and
/// the overlaps kProbes.
std::vector<double> multi_contact_probes(const MultiContactLaw& law) {
  const MultiContactModel model = multi_contact_model(law);
  std::vector<double> out;
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid, PartnerKind::soft})
    for (const Arrangement around : {Arrangement::tetrahedron, Arrangement::random_8}) {
      std::vector<MultiContactPartner> partners;
      for (const Vec3& d : directions_of(around)) partners.push_back({kind, kind == PartnerKind::plane ? 0.0 : 1.0, d});
      for (const double h : kProbes)
        out.push_back(multi_contact_forces(model, partners, std::vector<double>(partners.size(), h)).front());
    }
  return out;
}

const MultiContactLaw& drawn_law_of(const LawTableEntry& entry, LawForm form) {
  const MultiContactLaw* law = entry.find(form);
  if (law == nullptr) throw InputError("law table: no law of the form \"" + to_string(form) + "\"");
  return *law;
}

LawDraws table_draws(const LawSources& sources, const NamedLaws& named, const MacroSpec& spec, double fraction,
                     std::int64_t count) {
  const LawForm form = named.form;
  FittedLaw own = sources.serving(form);
  read_refits(own);
  const LawTable& table = *own.table();
  const std::size_t kept = replicate_count(table, form);
  if (kept == 0)
    throw InputError(
        fmt::format("bands: {} keeps no refits of its {} law: the .h5 beside it holds them; \"softgrain "
                    "calibrate multi_contact.h5\" makes both from the measurements",
                    own.path, to_string(form)));
  if (static_cast<std::size_t>(count) > kept)
    throw InputError(
        fmt::format("bands = {}: {} keeps {} refits of its {} law; allowed: at most {}, or more refits by "
                    "\"softgrain calibrate multi_contact.h5 --set replicates=...\"",
                    count, own.path, kept, to_string(form), kept));
  std::string ignored;
  const LawTableEntry entry = law_entry(sources, fraction, ignored);
  const MultiContactLaw best = drawn_law_of(entry, form);
  LawDraws out;
  out.law = named;
  out.numbers = with_logarithms(multi_contact_numbers(best));
  // Refits to few packings scatter too little.
  const double factor = factor_of_several(entry.packings);
  LawSources drawn = sources;
  for (std::size_t r = 0; r < static_cast<std::size_t>(count); ++r) {
    drawn.laws = {{replicate_of(table, form, r)}};
    out.draws.push_back(
        with_logarithms(multi_contact_numbers(drawn_law_of(law_entry(drawn, fraction, ignored), form))));
    for (std::size_t k = 0; k < out.numbers.size(); ++k)
      out.draws.back()[k] = out.numbers[k] + factor * (out.draws.back()[k] - out.numbers[k]);
  }
  out.origin = fmt::format("{} refits to packings drawn with replacement", count);
  out.discrepancy = form_discrepancy(best);
  out.discrepancy_origin = "configurations that the fit did not see";
  const LogForces log_forces(multi_contact_probes(best));
  out.multi_contact_forces = [=](const std::vector<double>& numbers, const std::vector<PressedNeighbours>& states) {
    const MultiContactModel model = multi_contact_model(law_of_numbers(best, numbers));
    std::vector<double> sums;
    for (const PressedNeighbours& s : states) {
      const std::vector<double> forces = softgrain::multi_contact_forces(model, s.partners, s.overlap);
      sums.push_back(std::accumulate(forces.begin(), forces.end(), 0.0));
    }
    return sums;
  };
  out.effects = [=](const std::vector<double>& numbers) {
    return log_forces(multi_contact_probes(law_of_numbers(best, numbers)));
  };
  for (const FormOffset& o : form_offsets(best)) {
    std::vector<double> direction(out.numbers.size(), 0.0);
    direction[0] = o.force;
    direction[2] = o.onset;
    out.off.push_back(std::move(direction));
  }
  out.with = [=](const std::vector<double>& numbers) {
    LawSources one = sources;
    LawTableEntry changed = entry;
    for (MultiContactLaw& law : changed.laws)
      if (law.form == form) law = law_of_numbers(best, numbers);
    one.laws = {{LawTable{.entries = {changed}}}};
    one.solid_fraction = changed.solid_fraction;
    NamedLaws law = law_of_form(one, form, spec, 0.0);
    law.name = named.name;
    return law;
  };
  return out;
}

// Of cards: for each kind of pair the normal law's a, b, delta and those of both tangential ones, as in
// kLawParameterNames; a as logarithms.
constexpr std::size_t kPairNumbers = kLawParameterNames.size();
constexpr std::array<bool, kPairNumbers> kPairLogarithm{true, false, false, true, false, true, false};

std::vector<double> pair_numbers(const PairLaw& p) {
  return {p.normal.a.value,
          p.normal.b.value,
          p.normal.delta.value,
          p.tangential_initial.a.value,
          p.tangential_initial.b.value,
          p.tangential_secant.a.value,
          p.tangential_secant.b.value};
}

void set_part(ThresholdPowerLaw& part, double a, double b, double delta) {
  part.a.value = a;
  part.b.value = b;
  part.delta.value = delta;
  part.c.value = -a * std::pow(delta, b);
}

LawCard card_of_numbers(const LawCard& card, const std::vector<double>& numbers) {
  LawCard out = card;
  for (std::size_t k = 0; k < out.pairs.size(); ++k) {
    PairLaw& p = out.pairs[k];
    std::vector<double> n(numbers.begin() + static_cast<std::ptrdiff_t>(k * kPairNumbers),
                          numbers.begin() + static_cast<std::ptrdiff_t>((k + 1) * kPairNumbers));
    for (std::size_t j = 0; j < n.size(); ++j)
      if (kPairLogarithm[j]) n[j] = std::exp(n[j]);
    const double delta = std::max(n[2], 0.0);
    set_part(p.normal, n[0], std::max(n[1], 1.01), delta);
    if (p.has_tangential_initial) set_part(p.tangential_initial, n[3], n[4], delta);
    if (p.has_tangential_secant) set_part(p.tangential_secant, n[5], n[6], delta);
  }
  return out;
}

/// Normal in the logarithm of what is positive: its variance there is that of the number over its square.
std::vector<std::vector<double>> pair_draws(const PairLaw& p, std::int64_t count, std::uint64_t stream) {
  std::vector<double> mean = pair_numbers(p);
  std::vector<double> covariance = p.covariance;
  if (covariance.size() != kPairNumbers * kPairNumbers ||
      std::ranges::all_of(covariance, [](double c) { return c == 0.0; }))
    throw InputError("bands: the law card has no covariance of its " + to_string(p.kind) +
                     " law: calibrate it from measurements of several packings (\"softgrain calibrate\")");
  if (p.band_origin != kFromResiduals && p.packings > 1) {
    const double students = student_over_normal(p.packings - 1);  // of few packings, as in intervals
    for (double& c : covariance) c *= students * students;
  }
  for (std::size_t j = 0; j < kPairNumbers; ++j) {
    if (!kPairLogarithm[j] || !(mean[j] > 0.0)) continue;
    for (std::size_t i = 0; i < kPairNumbers; ++i) {
      covariance[i * kPairNumbers + j] /= mean[j];
      covariance[j * kPairNumbers + i] /= mean[j];
    }
    mean[j] = std::log(mean[j]);
  }
  return normal_draws(mean, covariance, count, stream);
}

std::vector<double> card_probes(const LawCard& card) {
  std::vector<double> out;
  for (const PairLaw& p : card.pairs)
    for (const double h : kProbes) out.push_back(p.normal.value(h));
  return out;
}

LawDraws card_draws(const LawCard& card, const LawSources& sources, const NamedLaws& named, const MacroSpec& spec,
                    std::int64_t count) {
  LawDraws out;
  out.law = named;
  out.draws.resize(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < card.pairs.size(); ++k) {
    const auto own = pair_draws(card.pairs[k], count, k + 1);
    for (std::size_t r = 0; r < own.size(); ++r) out.draws[r].insert(out.draws[r].end(), own[r].begin(), own[r].end());
    std::vector<double> numbers = pair_numbers(card.pairs[k]);
    for (std::size_t j = 0; j < numbers.size(); ++j)
      if (kPairLogarithm[j]) numbers[j] = std::log(std::max(numbers[j], 1e-300));
    out.numbers.insert(out.numbers.end(), numbers.begin(), numbers.end());
  }
  out.origin = fmt::format("{} draws from the covariance of the law card", count);
  out.discrepancy_origin = "not known: a law card has no configurations that its fit did not see";
  const LogForces log_forces(card_probes(card));
  out.effects = [=](const std::vector<double>& numbers) {
    return log_forces(card_probes(card_of_numbers(card, numbers)));
  };
  out.with = [=, beyond = sources.beyond](const std::vector<double>& numbers) {
    NamedLaws law = pair_law_of(card_of_numbers(card, numbers), spec, named.name, beyond);
    law.tag = law.identity.hash;
    return law;
  };
  return out;
}

}  // namespace

double form_discrepancy(const MultiContactLaw& law) {
  std::array<std::vector<double>, 2> squares;  // out of proportion, in proportion
  for (const ConfigurationError& e : law.errors)
    if (e.use == MultiContactUse::predicted)
      squares[e.in_proportion ? 1 : 0].push_back(e.error * e.error - e.noise * e.noise);
  if (squares[0].empty() && squares[1].empty()) return std::isfinite(law.error_cross) ? law.error_cross : 0.0;
  double worst = 0.0;
  for (const std::vector<double>& path : squares)
    if (!path.empty()) worst = std::max(worst, mean_error(path).mean);
  return std::sqrt(worst);
}

std::vector<FormOffset> form_offsets(const MultiContactLaw& law) {
  std::vector<double> onsets;
  for (const ConfigurationError& e : law.errors)
    if (e.use == MultiContactUse::predicted && e.offset) onsets.push_back(e.offset->onset * e.offset->onset);
  std::vector<FormOffset> out;
  if (const double force = form_discrepancy(law); force > 0.0) out.push_back({force, 0.0});
  if (const double onset = std::sqrt(mean_error(onsets).mean); onset > 0.0) out.push_back({0.0, onset});
  return out;
}

LawDraws law_draws(const LawSources& sources, const NamedLaws& law, const MacroSpec& spec, double contents_fraction,
                   std::int64_t count) {
  if (sources.cells() != nullptr) return cell_draws(*sources.cells(), law.name, count);
  if (const LawCard* card = sources.serving(law.form).card()) return card_draws(*card, sources, law, spec, count);
  return table_draws(sources, law, spec, contents_fraction, count);
}

}  // namespace softgrain
