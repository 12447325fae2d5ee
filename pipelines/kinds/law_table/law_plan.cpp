#include "pipelines/kinds/law_table/law_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "calibrate/next_measurements.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/card_text.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/law/law_draws.h"

namespace softgrain {

namespace {

/// Depths up to which a configuration may be pressed in, over the overlap at the end of its loading. A configuration of
/// several stages always goes all its way.
constexpr std::array kDepths{0.5, 0.75, 1.0};

using Curves = std::vector<const MacroCurve*>;

LawForm form_of(const LawTable& table, const std::vector<MacroCurve>& curves, const WantedForm& wanted) {
  const auto drawn = [&](LawForm form) {
    return std::any_of(curves.begin(), curves.end(), [&](const MacroCurve& c) {
      return c.usable && !c.drawn_axial.empty() && c.law.form == form && c.law.solid_fraction > 0.0;
    });
  };
  const LawForm best = main_entry(table).best;
  for (const LawForm form : {wanted.value_or(best), LawForm::directional, LawForm::isotropic, LawForm::pair})
    if (drawn(form) && (!wanted || form == *wanted)) return form;
  throw InputError(
      fmt::format("law plan: no curve of that run has error bars of {} law of a table: run it with macro.bands (or "
                  "macrosim --bands N) and this table",
                  wanted ? "the " + to_string(*wanted) : std::string("any")));
}

Curves drawn_curves(const std::vector<MacroCurve>& curves, LawForm form) {
  Curves out;
  for (const MacroCurve& c : curves)
    if (c.usable && !c.drawn_axial.empty() && c.law.form == form && c.law.solid_fraction > 0.0) out.push_back(&c);
  for (const MacroCurve* c : out)
    if (c->drawn_axial.size() != out.front()->drawn_axial.size())
      throw InputError("law plan: curves of the run have unequal numbers of draws");
  return out;
}

/// Axial stresses of every draw, each curve over its root mean square and all curves of one weight.
std::vector<std::vector<double>> predictions(const Curves& curves) {
  std::vector<std::vector<double>> out(curves.front()->drawn_axial.size());
  for (const MacroCurve* c : curves) {
    double squares = 0.0;
    for (const double s : c->stress_axial) squares += s * s;
    const double scale = squares > 0.0 ? 1.0 / std::sqrt(squares * static_cast<double>(curves.size())) : 0.0;
    for (std::size_t r = 0; r < out.size(); ++r)
      for (const double s : c->drawn_axial[r]) out[r].push_back(scale * s);
  }
  return out;
}

/// Square root of the sum of variances over the draws.
double deviation(const std::vector<std::vector<double>>& rows) {
  double sum = 0.0;
  for (std::size_t k = 0; k < rows.front().size(); ++k) {
    std::vector<double> column;
    for (const std::vector<double>& row : rows) column.push_back(row[k]);
    sum += std::pow(mean_error(column).deviation, 2);
  }
  return std::sqrt(sum);
}

/// What the table knows of a configuration.
class KnownErrors {
 public:
  KnownErrors(const MultiContactLaw& law, int packings) : law_(law), packings_(packings) {
    std::vector<double> scatters;
    for (const ConfigurationError& e : law.errors)
      if (e.noise > 0.0) scatters.push_back(scatter_of(e));
    usual_ = scatters.empty() ? 0.2 : quantile(scatters, 0.5);
  }
  [[nodiscard]] const ConfigurationError* find(const std::string& name) const {
    for (const ConfigurationError& e : law_.errors)
      if (e.name == name) return &e;
    return nullptr;
  }
  /// Packings that the table has of a configuration; `else_` where the table does not know it.
  [[nodiscard]] std::int64_t packings(const ConfigurationError* known, std::int64_t else_) const {
    if (known == nullptr) return else_;
    return known->packings > 0 ? known->packings : packings_;
  }
  [[nodiscard]] double scatter(const ConfigurationError* known) const {
    return known != nullptr && known->noise > 0.0 ? scatter_of(*known) : usual_;
  }

 private:
  /// Scatter of the force of single packings.
  [[nodiscard]] double scatter_of(const ConfigurationError& e) const {
    return std::sqrt(static_cast<double>(e.packings > 0 ? e.packings : packings_)) * e.noise;
  }

  const MultiContactLaw& law_;
  std::int64_t packings_;
  double usual_ = 0.0;
};

bool same_loading(const MultiContactConfiguration& a, const MultiContactConfiguration& b) {
  const auto same = [](const MultiContactPartner& x, const MultiContactPartner& y) {
    return x.kind == y.kind && x.ratio == y.ratio && x.smooth == y.smooth && x.direction == y.direction && x.on == y.on;
  };
  return a.centre_free == b.centre_free && a.stages.front().overlap == b.stages.front().overlap &&
         std::equal(a.partners.begin(), a.partners.end(), b.partners.begin(), b.partners.end(), same);
}

/// Loadings of the scene that a fit of this form takes, each once.
std::vector<MultiContactConfiguration> loadings(const MultiContactSetup& setup, const KnownErrors& known) {
  std::vector<MultiContactConfiguration> out;
  for (const MultiContactConfiguration& c : setup.configurations) {
    const ConfigurationError* error = known.find(c.name);
    if (c.held_out || (error != nullptr && error->use != MultiContactUse::fitted)) continue;
    MultiContactConfiguration load = loading_part(c);
    load.name = c.name;
    if (std::none_of(out.begin(), out.end(), [&](const MultiContactConfiguration& o) { return same_loading(o, load); }))
      out.push_back(std::move(load));
  }
  return out;
}

struct Candidates {
  std::vector<PlanCandidate> told;
  std::vector<PressedNeighbours> states;
  std::vector<Measurable> measurables;
};

Candidates candidates_of(const MultiContactSetup& setup, const KnownErrors& known, const LawDraws& law) {
  constexpr double kTrialSeconds = 0.3;
  const double pass = try_soft_particle(setup.spec, setup.seed, kTrialSeconds).pass_seconds;
  Candidates out;
  for (const MultiContactConfiguration& c : loadings(setup, known))
    for (const double depth : kDepths) {
      if (depth < 1.0 && c.stages.size() > 1) continue;
      const MultiContactConfiguration part = cut_short(c, depth);
      const std::vector<double>& overlap = part.stages.back().overlap;
      const ConfigurationError* error = known.find(c.name);
      out.told.push_back({c.name, depth, *std::max_element(overlap.begin(), overlap.end()), known.scatter(error),
                          error != nullptr, known.packings(error, setup.least_packings(c)),
                          seconds_per_packing(part, setup, pass), 1.0});
      out.states.push_back({part.partners, overlap});
    }
  const std::vector<double> best = law.multi_contact_forces(law.numbers, out.states);
  for (const PlanCandidate& c : out.told) out.measurables.push_back({{}, c.scatter, c.seconds});
  for (const std::vector<double>& numbers : law.draws) {
    const std::vector<double> forces = law.multi_contact_forces(numbers, out.states);
    // Below a hundredth of the force it tells nothing: the logarithm stays bounded.
    for (std::size_t k = 0; k < forces.size(); ++k)
      out.measurables[k].drawn.push_back(std::log(std::max(forces[k], 0.0) + 0.01 * best[k] + 1e-12));
  }
  return out;
}

/// Blocks of the same candidate together, in the order in which they came first.
std::vector<PlanStep> steps_of(const std::vector<PlannedBlock>& blocks) {
  std::vector<PlanStep> out;
  for (const PlannedBlock& b : blocks) {
    auto found = std::find_if(out.begin(), out.end(), [&](const PlanStep& s) { return s.candidate == b.measurable; });
    if (found == out.end()) found = out.insert(out.end(), PlanStep{b.measurable, 0, 0.0, 1.0});
    found->packings += b.measurements;
    found->seconds += b.cost;
  }
  return out;
}

/// Core seconds of packings of all configurations alike, as deep as they go, that come to this share.
double seconds_alike(const std::vector<std::vector<double>>& predicted, const std::vector<PlanCandidate>& told,
                     const std::vector<Measurable>& all, double share) {
  std::vector<Measurable> deepest;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (told[k].depth == 1.0) deepest.push_back(all[k]);
  double seconds = 0.0;
  for (const Measurable& m : deepest) seconds += m.cost;
  const auto share_of = [&](std::int64_t packings) {
    NextMeasurements plan(predicted, deepest);
    for (std::size_t k = 0; k < deepest.size(); ++k) plan.measure(k, packings);
    return plan.share();
  };
  constexpr std::int64_t kMost = 4096;
  if (share_of(kMost) > share) return kNaN;
  std::int64_t low = 0;
  std::int64_t high = kMost;
  while (high - low > 1) {
    const std::int64_t middle = (low + high) / 2;
    (share_of(middle) <= share ? high : low) = middle;
  }
  return seconds * static_cast<double>(high);
}

LawDraws draws_of(const FittedLaw& law, const MacroCurve& curve, std::size_t draws) {
  LawSources sources;
  sources.laws = {law};
  sources.solid_fraction = curve.law.solid_fraction;
  NamedLaws named;
  named.name = curve.engine;
  named.form = *curve.law.form;
  return law_draws(sources, named, MacroSpec{}, 0.0, static_cast<std::int64_t>(draws));
}

std::string depth_text(const PlanCandidate& c) { return fmt::format("{:.3f}", c.overlap); }

}  // namespace

bool same_draws(const FittedLaw& a, const FittedLaw& b, const std::vector<MacroCurve>& curves, WantedForm form) {
  const Curves drawn = drawn_curves(curves, form_of(*a.table(), curves, form));
  const std::size_t n = drawn.front()->drawn_axial.size();
  const LawDraws one = draws_of(a, *drawn.front(), n);
  const LawDraws other = draws_of(b, *drawn.front(), n);
  return one.numbers == other.numbers && one.draws == other.draws;
}

LawPlan plan_law(const FittedLaw& table, const MultiContactSetup& candidates, const std::vector<MacroCurve>& curves,
                 const LawPlanWish& wish) {
  const LawForm form = form_of(*table.table(), curves, wish.form);
  const Curves drawn = drawn_curves(curves, form);
  LawPlan plan;
  plan.engine = drawn.front()->engine;
  plan.curves = drawn.size();
  plan.draws = drawn.front()->drawn_axial.size();
  plan.block = wish.block;
  const LawDraws law = draws_of(table, *drawn.front(), plan.draws);
  plan.discrepancy = law.discrepancy;
  const auto predicted = predictions(drawn);
  plan.law_part = deviation(predicted);
  std::string ignored;
  LawSources sources;
  sources.laws = {table};
  const LawTableEntry entry = law_entry(sources, drawn.front()->law.solid_fraction, ignored);
  const KnownErrors known(*entry.find(form), std::max(entry.packings, 1));
  Candidates all = candidates_of(candidates, known, law);
  const NextMeasurements outset(predicted, all.measurables);
  for (std::size_t k = 0; k < all.told.size(); ++k) all.told[k].share = outset.share_after(k, wish.block);
  constexpr std::size_t kMostBlocks = 200;
  const auto blocks =
      plan_greedily(NextMeasurements(predicted, all.measurables), all.measurables, wish.block, wish.share, kMostBlocks);
  plan.steps = steps_of(blocks);
  NextMeasurements after(predicted, all.measurables);
  for (PlanStep& s : plan.steps) {
    after.measure(s.candidate, s.packings);
    s.share = after.share();
    plan.seconds += s.seconds;
  }
  plan.share = after.share();
  plan.even_seconds = blocks.empty() ? kNaN : seconds_alike(predicted, all.told, all.measurables, plan.share);
  plan.candidates = std::move(all.told);
  if (plan.share > wish.share)
    plan.remarks.push_back(fmt::format(
        "{:.2g} of the law part was wanted and is out of reach: what these configurations tell of the law is not all "
        "that the scene asks of it",
        wish.share));
  if (plan.discrepancy > plan.law_part)
    plan.remarks.push_back(
        "what the form of the law is off by is more than what its packings leave open: more packings narrow the "
        "smaller part of the error bars");
  return plan;
}

std::string plan_text(const LawPlan& plan) {
  std::string text = fmt::format(
      "{}: {} draws on {}. Axial stress, standard deviations:\n"
      "  {:5.2f} %  its packings leave open: further packings narrow this\n"
      "  {:5.2f} %  its form is off by on what its fit did not see: they do not\n\n",
      plan.engine, plan.draws, counted(plan.curves, "curve"), 100.0 * plan.law_part, 100.0 * plan.discrepancy);
  std::vector<const PlanCandidate*> order;
  for (const PlanCandidate& c : plan.candidates) order.push_back(&c);
  const auto rate = [](const PlanCandidate* c) { return (1.0 - c->share) / c->seconds; };
  std::stable_sort(order.begin(), order.end(),
                   [&](const PlanCandidate* a, const PlanCandidate* b) { return rate(a) > rate(b); });
  constexpr std::size_t kShown = 12;
  text += fmt::format("{} packings more of one configuration (of {} looked at, the best per second first):\n",
                      plan.block, order.size());
  text += fmt::format("  {:<36} {:>7} {:>9} {:>8} {:>9}\n", "", "h/Rs", "core s", "scatter", "narrower");
  for (std::size_t k = 0; k < std::min(kShown, order.size()); ++k)
    text += fmt::format("  {:<36} {:>7} {:>9.3g} {:>6.0f} %{} {:>7.2f} %\n", order[k]->configuration,
                        depth_text(*order[k]), static_cast<double>(plan.block) * order[k]->seconds,
                        100.0 * order[k]->scatter, order[k]->measured ? " " : "?", 100.0 * (1.0 - order[k]->share));
  text += plan.steps.empty() ? "\nnothing helps\n" : "\nplan, one after the other:\n";
  for (const PlanStep& s : plan.steps) {
    const PlanCandidate& c = plan.candidates[s.candidate];
    text += fmt::format("  {:<36} {:>7} {:>9.3g} s {:>4} packings, then {:.2f} %\n", c.configuration, depth_text(c),
                        s.seconds, s.packings, 100.0 * plan.law_part * s.share);
  }
  if (!plan.steps.empty()) {
    const std::string even = std::isfinite(plan.even_seconds)
                                 ? fmt::format("; packings of all configurations alike take {:.3g}, {:.2g} times that",
                                               plan.even_seconds, plan.even_seconds / plan.seconds)
                                 : std::string("; packings of all configurations alike do not come to that");
    text += fmt::format("all: {:.3g} core seconds{}\n", plan.seconds, even);
  }
  for (const std::string& r : plan.remarks) text += "note: " + r + "\n";
  return text;
}

std::string plan_scene_text(const LawPlan& plan) {
  std::string text = fmt::format(
      "# What `softgrain law plan` found for the error bars of {} curves: packings in all of each configuration, "
      "so deep.\n",
      plan.curves);
  for (const std::string& r : plan.remarks) text += "# note: " + r + "\n";
  // `packings` of a table is a total: that of the tables before it, deepest first, counts.
  std::vector<const PlanStep*> steps;
  for (const PlanStep& s : plan.steps) steps.push_back(&s);
  std::stable_sort(steps.begin(), steps.end(), [&](const PlanStep* a, const PlanStep* b) {
    return plan.candidates[a->candidate].depth > plan.candidates[b->candidate].depth;
  });
  std::map<std::string, std::int64_t> total;
  for (const PlanStep* one : steps) {
    const PlanStep& s = *one;
    const PlanCandidate& c = plan.candidates[s.candidate];
    std::int64_t& all = total.try_emplace(c.configuration, c.packings).first->second;
    all += s.packings;
    text += fmt::format("[[plan]]\nconfiguration = {}\n", quoted(c.configuration));
    if (c.depth < 1.0) text += fmt::format("depth = {}\n", c.depth);
    text += fmt::format("packings = {}\n", all);
  }
  return text;
}

}  // namespace softgrain
