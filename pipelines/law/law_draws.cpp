#include "pipelines/law/law_draws.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calibrate/draws.h"
#include "calibrate/experiment_fit.h"
#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/data/card_text.h"
#include "common/data/multi_contact_replicates.h"
#include "microsim/multi_contact_arrangements.h"
#include "pipelines/law/law_fit.h"

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
        fmt::format("bands = {}: {} keeps {} refits of its {} law; allowed: at most {}{}", count, own.path, kept,
                    to_string(form), kept,
                    table.entries.front().source == TableSource::measured
                        ? ", or more refits by \"softgrain calibrate multi_contact.h5 --set replicates=...\""
                        : ""));
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
  const bool measured = entry.source == TableSource::measured;
  const char* from = measured                                ? "refits to packings drawn with replacement"
                     : entry.source == TableSource::combined ? "draws of packings and a library together"
                                                             : "draws of a library";
  out.origin = fmt::format("{} {}", count, from);
  out.discrepancy = form_discrepancy(best);
  out.discrepancy_origin =
      measured ? "configurations that the fit did not see"
               : "the library: laws of its materials, or an own table, on configurations that their fits did not see";
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
constexpr std::size_t kPlaceOfDelta = 2;

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

// Of unloading branches, behind the numbers of all pairs: residual and exponent of each.
constexpr std::size_t kBranchNumbers = 2;

bool is_by_symmetry_of(const PairLaw* measured, const PairLaw& law) {
  return measured != nullptr && measured->unloading &&
         measured->unloading->residual.value == law.unloading->residual.value;
}

void set_branch(UnloadingLaw& branch, double residual, double exponent, double loading_exponent) {
  branch.residual.value = std::clamp(residual, 0.0, kLargestResidual);
  branch.exponent.value = std::max(exponent, least_unloading_exponent(branch.residual.value, loading_exponent));
}

LawCard card_of_numbers(const LawCard& card, const std::vector<double>& numbers) {
  LawCard out = card;
  std::size_t branch = card.pairs.size() * kPairNumbers;
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
    if (!p.unloading) continue;
    set_branch(*p.unloading, numbers[branch], numbers[branch + 1], p.normal.b.value);
    branch += kBranchNumbers;
  }
  return out;
}

/// Normal draws of the branch, by the half-width of its intervals, which holds Student's t; errors that are not known
/// scatter nothing. The error of the threshold, which that of the residual holds, comes with `thresholds`, drawn
/// before.
std::vector<std::vector<double>> branch_draws(const PairLaw& p, const std::vector<double>& thresholds,
                                              std::uint64_t stream) {
  const auto deviation = [](const Estimate& e) {
    const double above = (e.high - e.value) / kNormal95;
    const double below = (e.value - e.low) / kNormal95;
    const double one = std::max(std::isfinite(above) ? above : 0.0, std::isfinite(below) ? below : 0.0);
    return one > 0.0 ? one : std::isfinite(e.standard_error) ? e.standard_error : 0.0;
  };
  constexpr double kMostCorrelation = 0.999;  // of two samples it is 1, which has no draws
  const UnloadingLaw& u = *p.unloading;
  const Estimate& delta = p.normal.delta;
  const double slope = u.deepest > delta.value && std::isfinite(delta.standard_error)
                           ? residual_slope(u.residual.value, u.deepest, delta.value)
                           : 0.0;
  const double taken = slope != 0.0 ? slope * delta.standard_error : 0.0;
  const double r = deviation(u.residual);
  const double own = std::sqrt(std::max(0.0, r * r - taken * taken));
  const double m = deviation(u.exponent);
  const double most = kMostCorrelation * own * m;
  const double both = std::clamp(u.correlation * r * m, -most, most);
  auto out = normal_draws({u.residual.value, u.exponent.value}, {own * own, both, both, m * m},
                          static_cast<std::int64_t>(thresholds.size()), stream);
  for (std::size_t k = 0; k < out.size(); ++k) out[k][0] += slope * (std::max(thresholds[k], 0.0) - delta.value);
  return out;
}

std::vector<double> with_pair_logarithms(std::vector<double> numbers) {
  for (std::size_t j = 0; j < kPairNumbers; ++j)
    if (kPairLogarithm[j] && numbers[j] > 0.0) numbers[j] = std::log(numbers[j]);
  return numbers;
}

/// The law of the other kind that this one follows from by symmetry; none where it does not, or no longer: people edit
/// cards.
const PairLaw* mirrored_from(const LawCard& card, const PairLaw& law) {
  constexpr double kRounding = 1e-9;
  if (!is_by_symmetry(law)) return nullptr;
  for (const PairLaw& other : card.pairs) {
    if (other.kind == law.kind || is_by_symmetry(other)) continue;
    std::array<double, kPairNumbers> numbers{};
    std::ranges::copy(pair_numbers(other), numbers.begin());
    const std::vector<double> own = pair_numbers(law);
    if (std::ranges::equal(mirrored_numbers(numbers, other.kind), own,
                           [](double a, double b) { return std::abs(a - b) <= kRounding * std::abs(b); }))
      return &other;
  }
  return nullptr;
}

/// Draws of the law that follows by symmetry from another one, from the draws of that: they are off together.
std::vector<std::vector<double>> mirrored_draws(const PairLaw& measured, std::vector<std::vector<double>> draws) {
  const std::vector<double> best = pair_numbers(measured);
  for (std::vector<double>& draw : draws) {
    std::array<double, kPairNumbers> numbers{};
    for (std::size_t j = 0; j < kPairNumbers; ++j)
      numbers[j] = kPairLogarithm[j] && best[j] > 0.0 ? std::exp(draw[j]) : draw[j];
    const auto turned = mirrored_numbers(numbers, measured.kind);
    draw = with_pair_logarithms({turned.begin(), turned.end()});
  }
  return draws;
}

/// Draws of pair number k of the card.
std::vector<std::vector<double>> draws_of_pair(const LawCard& card, std::size_t k, std::int64_t count) {
  const PairLaw* measured = mirrored_from(card, card.pairs[k]);
  if (measured == nullptr) return pair_draws(card.pairs[k], count, k + 1);
  const auto place = static_cast<std::size_t>(measured - card.pairs.data());
  return mirrored_draws(*measured, pair_draws(*measured, count, place + 1));
}

std::vector<double> card_probes(const LawCard& card) {
  std::vector<double> out;
  for (const PairLaw& p : card.pairs)
    for (const double h : kProbes) out.push_back(p.normal.value(h));
  for (const PairLaw& p : card.pairs) {
    if (!p.unloading) continue;
    const double length = (1.0 - p.unloading->residual.value) * (kProbes.back() - p.normal.delta.value);
    for (const double h : kProbes) {
      const double share = 1.0 - (kProbes.back() - h) / length;
      const double force = p.normal.value(kProbes.back());
      out.push_back(share > 0.0 ? force * std::pow(share, p.unloading->exponent.value) : 0.0);
    }
  }
  return out;
}

/// Adds the draws of all unloading branches; one that follows by symmetry is drawn with the other.
void add_branches(const LawCard& card, LawDraws& out) {
  constexpr std::uint64_t kStream = 101;  // apart from those of pairs
  for (std::size_t k = 0; k < card.pairs.size(); ++k) {
    const PairLaw& p = card.pairs[k];
    if (!p.unloading) continue;
    const PairLaw* measured = mirrored_from(card, p);
    const bool together = is_by_symmetry_of(measured, p);
    const std::size_t place = together ? static_cast<std::size_t>(measured - card.pairs.data()) : k;
    std::vector<double> thresholds;
    for (const std::vector<double>& draw : out.draws) thresholds.push_back(draw[k * kPairNumbers + kPlaceOfDelta]);
    const auto own = branch_draws(p, thresholds, kStream + place);
    for (std::size_t r = 0; r < own.size(); ++r) out.draws[r].insert(out.draws[r].end(), own[r].begin(), own[r].end());
    out.numbers.insert(out.numbers.end(), {p.unloading->residual.value, p.unloading->exponent.value});
  }
}

LawDraws card_draws(const LawCard& of, const LawSources& sources, const NamedLaws& named, const MacroSpec& spec,
                    std::int64_t count) {
  LawCard card = of;
  if (!sources.card_unloading)
    for (PairLaw& p : card.pairs) p.unloading.reset();
  LawDraws out;
  out.law = named;
  out.draws.resize(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < card.pairs.size(); ++k) {
    const auto own = draws_of_pair(card, k, count);
    for (std::size_t r = 0; r < own.size(); ++r) out.draws[r].insert(out.draws[r].end(), own[r].begin(), own[r].end());
    std::vector<double> numbers = pair_numbers(card.pairs[k]);
    for (std::size_t j = 0; j < numbers.size(); ++j)
      if (kPairLogarithm[j]) numbers[j] = std::log(std::max(numbers[j], 1e-300));
    out.numbers.insert(out.numbers.end(), numbers.begin(), numbers.end());
  }
  add_branches(card, out);
  out.origin = fmt::format("{} draws from the covariance of the law card", count);
  out.discrepancy_origin = "not known: a law card has no configurations that its fit did not see";
  const LogForces log_forces(card_probes(card));
  out.effects = [=](const std::vector<double>& numbers) {
    return log_forces(card_probes(card_of_numbers(card, numbers)));
  };
  out.with = [=, beyond = sources.beyond, unloading = sources.card_unloading](const std::vector<double>& numbers) {
    NamedLaws law = pair_law_of(card_of_numbers(card, numbers), spec, named.name, beyond, unloading);
    law.tag = law.identity.hash;
    return law;
  };
  return out;
}

}  // namespace

bool has_draws(const PairLaw& law) {
  return law.covariance.size() == kPairNumbers * kPairNumbers &&
         std::ranges::all_of(law.covariance, [](double c) { return std::isfinite(c); }) &&
         std::ranges::any_of(law.covariance, [](double c) { return c != 0.0; });
}

// The variance of a logarithm is that of the number over its square.
std::vector<std::vector<double>> pair_draws(const PairLaw& p, std::int64_t count, std::uint64_t stream) {
  std::vector<double> mean = pair_numbers(p);
  std::vector<double> covariance = p.covariance;
  if (!has_draws(p))
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

std::int64_t read_draw_count(const SceneTable& table, const Key& key, std::int64_t most, std::int64_t otherwise) {
  constexpr std::int64_t kFewest = 8;
  const std::int64_t draws = table.count(key, 0, most, otherwise);
  if (draws > 0 && draws < kFewest)
    table.add_error(key.name,
                    fmt::format("{} draws say nothing of a 95 % band: 0 (none), or at least {}", draws, kFewest));
  return draws;
}

LawDraws law_draws(const LawSources& sources, const NamedLaws& law, const MacroSpec& spec, double contents_fraction,
                   std::int64_t count) {
  if (sources.cells() != nullptr)
    return complaining_of(sources.laws.front(), [&] { return cell_draws(*sources.cells(), law.name, count); });
  if (const LawCard* card = sources.serving(law.form).card()) return card_draws(*card, sources, law, spec, count);
  return table_draws(sources, law, spec, contents_fraction, count);
}

}  // namespace softgrain
