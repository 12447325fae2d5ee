#include "pipelines/compare/macro_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/text.h"
#include "common/data/macro_band.h"
#include "macrosim/twin_places.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/stage_match.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

namespace {

double last(const std::vector<double>& values) { return values.empty() ? kNaN : values.back(); }

double ratio(double a, double b) { return b != 0.0 ? a / b : kNaN; }

double lateral_ratio(const MacroCurve& c) { return ratio(last(c.stress_lateral), last(c.stress_axial)); }

/// The part of a shear test after its preload: strain from 0.
std::pair<std::vector<double>, std::vector<double>> sheared(const MacroCurve& c) {
  std::pair<std::vector<double>, std::vector<double>> out;
  const std::vector<double> deviator = deviators(c);
  for (std::size_t k = 0; k < std::min(c.strain.size(), deviator.size()); ++k) {
    if (c.strain[k] < 0.0) continue;
    out.first.push_back(c.strain[k]);
    out.second.push_back(deviator[k]);
  }
  return out;
}

/// NaN where curves cannot be compared.
double difference(const std::vector<double>& xa, const std::vector<double>& a, const std::vector<double>& xb,
                  const std::vector<double>& b) {
  try {
    return relative_difference(xa, a, xb, b);
  } catch (const InputError&) {
    return kNaN;
  }
}

/// NaN where curves cannot be compared, and where the test imposes it throughout.
double stage_difference(const MacroCurve& c, const MacroCurve& twin, ComparedStress what) {
  const auto column = [&](const MacroCurve& of) {
    return what == ComparedStress::axial ? of.stress_axial : deviators(of);
  };
  try {
    return staged_difference(match_stages(c, twin), column(c), column(twin), what);
  } catch (const InputError&) {
    return kNaN;
  }
}

double axial_difference(const MacroCurve& c, const MacroCurve& twin) {
  if (by_stages(c.test) && by_stages(twin.test)) return stage_difference(c, twin, ComparedStress::axial);
  return difference(c.strain, c.stress_axial, twin.strain, twin.stress_axial);
}

double strain_error(const MacroCurve& c, const MacroCurve& twin) {
  if (!by_stages(c.test) || !by_stages(twin.test)) return kNaN;
  try {
    return strain_difference(match_stages(c, twin), c, twin);
  } catch (const InputError&) {
    return kNaN;
  }
}

/// Whether the stress that a test ends with along z is one that was asked for.
bool ends_imposed(const MacroCurve& c) {
  const std::vector<bool> given = imposed_points(c, ComparedStress::axial);
  return !given.empty() && given.back();
}

double deviator_difference(const MacroCurve& c, const MacroCurve& twin) {
  if (by_stages(c.test)) return stage_difference(c, twin, ComparedStress::deviator);
  if (!is_shear(c.test)) return kNaN;
  const auto [xa, a] = sheared(c);
  const auto [xb, b] = sheared(twin);
  return difference(xa, a, xb, b);
}

/// Empty where the mean is zero: nothing is relative to it.
std::vector<double> over_mean(std::vector<double> forces) {
  const double mean = mean_and_variation(forces).first;
  if (mean == 0.0) return {};
  for (double& f : forces) f /= mean;
  return forces;
}

using Curves = std::vector<const MacroCurve*>;

Curves usable_of(const std::vector<MacroCurve>& curves, const std::string& engine) {
  Curves out;
  for (const MacroCurve& c : curves)
    if (c.usable && c.engine == engine && !c.strain.empty()) out.push_back(&c);
  return out;
}

MeanError mean_of(const Curves& curves, const std::function<double(const MacroCurve&)>& value) {
  return finite_mean(curves, [&](const MacroCurve* c) { return value(*c); });
}

/// Pairs of curves of the same sample.
using Pairs = std::vector<std::pair<const MacroCurve*, const MacroCurve*>>;

Pairs pair_up(const Curves& engine, const Curves& twin) {
  Pairs out;
  for (const MacroCurve* c : engine)
    for (const MacroCurve* t : twin)
      if (c->sample == t->sample) out.emplace_back(c, t);
  return out;
}

MeanError mean_of(const Pairs& pairs, const std::function<double(const MacroCurve&, const MacroCurve&)>& value) {
  return finite_mean(pairs, [&](const auto& pair) { return value(*pair.first, *pair.second); });
}

/// Replaces a column by its mean over the curves; false where these do not have the same points.
bool take_mean(const Curves& curves, std::vector<double> MacroCurve::*column, MacroCurve& out) {
  std::vector<double> mean((curves.front()->*column).size(), 0.0);
  for (const MacroCurve* c : curves) {
    if ((c->*column).size() != mean.size()) return false;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += (c->*column)[i] / static_cast<double>(curves.size());
  }
  out.*column = std::move(mean);
  return true;
}

/// Mean stresses and strains; empty where the curves do not have the same points.
std::optional<MacroCurve> mean_curve(const Curves& curves) {
  MacroCurve out = *curves.front();
  for (const auto column : {&MacroCurve::strain, &MacroCurve::strain_x, &MacroCurve::strain_y, &MacroCurve::strain_z,
                            &MacroCurve::stress_x, &MacroCurve::stress_y, &MacroCurve::stress_axial})
    if (!take_mean(curves, column, out)) return std::nullopt;
  return out;
}

/// Relative L2 difference of mean curves; its error is that of curves that differ by the standard error of the mean of
/// the paired differences, point by point: what means of equal expectation come to.
MeanError difference_of_means(const Pairs& pairs) {
  MeanError out{0, kNaN, kNaN, kNaN};
  if (pairs.empty()) return out;
  Curves mine;
  Curves twins;
  for (const auto& [c, t] : pairs) mine.push_back(c), twins.push_back(t);
  const auto a = mean_curve(mine);
  const auto b = mean_curve(twins);
  if (!a || !b) return out;
  const double value = axial_difference(*a, *b);
  if (!std::isfinite(value)) return out;
  out.n = pairs.size();
  out.mean = value;
  if (pairs.size() < 2) return out;
  MacroCurve off = *b;
  std::vector<std::vector<double>> at_points;  // of the engine, where its twin has points
  for (const auto& [c, t] : pairs) at_points.push_back(values_at_points(*c, c->stress_axial, *t));
  for (std::size_t i = 0; i < off.stress_axial.size(); ++i) {
    std::vector<double> apart;
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (std::isfinite(at_points[k][i])) apart.push_back(at_points[k][i] - pairs[k].second->stress_axial[i]);
    if (apart.size() > 1) off.stress_axial[i] += mean_error(apart).error;
  }
  out.error = axial_difference(off, *b);
  return out;
}

/// Law over twin, forces of all recorded points.
double places_ratio(const MacroCurve& twin, const std::string& engine, const char* partner) {
  const auto sum = [&](const std::string& name) {
    const auto column = twin.more.find(places_column(name, partner));
    double total = 0.0;
    if (column != twin.more.end())
      for (const double f : column->second) total += f;
    return total;
  };
  return ratio(sum(engine), sum(twin.engine));
}

double own_noise(const MacroCurve& c) {
  const auto again = c.more.find(kAgainAxial);
  if (again == c.more.end()) return kNaN;
  MacroCurve second = c;
  second.stress_axial = again->second;
  return axial_difference(second, c) / std::numbers::sqrt2;
}

/// A multi-contact law goes over its contacts once for the sums of each particle and once for the forces.
double visits(const MacroCurve& c) {
  const bool multi_contact = c.law.form && *c.law.form != LawForm::pair;
  return (multi_contact ? 2.0 : 1.0) * static_cast<double>(c.cost.contact_evaluations);
}

TwinErrors errors_against(const Pairs& pairs) {
  using C = const MacroCurve&;
  TwinErrors e;
  e.pairs = pairs.size();
  e.staged = !pairs.empty() && by_stages(pairs.front().first->test);
  e.axial = mean_of(pairs, axial_difference);
  e.axial_of_mean = difference_of_means(pairs);
  e.axial_end = mean_of(
      pairs, [](C c, C t) { return ends_imposed(c) ? kNaN : ratio(last(c.stress_axial), last(t.stress_axial)); });
  e.deviator = mean_of(pairs, deviator_difference);
  e.strains = mean_of(pairs, strain_error);
  e.unloading = mean_of(pairs, unloading_ratio);
  e.lateral_ratio = mean_of(pairs, [](C c, C t) { return lateral_ratio(c) - lateral_ratio(t); });
  e.coordination = mean_of(pairs, [](C c, C t) { return last(c.coordination_bodies) - last(t.coordination_bodies); });
  e.fabric = mean_of(pairs, [](C c, C t) { return last(c.fabric_bodies) - last(t.fabric_bodies); });
  e.force_mean = mean_of(pairs, [](C c, C t) {
    return ratio(mean_and_variation(c.body_forces).first, mean_and_variation(t.body_forces).first);
  });
  e.force_distance =
      mean_of(pairs, [](C c, C t) { return kolmogorov_smirnov(over_mean(c.body_forces), over_mean(t.body_forces)); });
  Cost engine;
  Cost twin;
  double mine = 0.0;
  double theirs = 0.0;
  for (const auto& [c, t] : pairs) {
    engine += c->cost, twin += t->cost;
    mine += visits(*c), theirs += visits(*t);
  }
  e.speedup_seconds = ratio(twin.seconds, engine.seconds);
  e.speedup_evaluations = ratio(theirs, mine);
  return e;
}

EngineScore score_of(const std::vector<MacroCurve>& curves, const std::string& engine) {
  using C = const MacroCurve&;
  const Curves mine = usable_of(curves, engine);
  EngineScore s;
  s.engine = engine;
  s.samples = mine.size();
  s.axial = mean_of(mine, [](C c) { return last(c.stress_axial); });
  s.lateral_ratio = mean_of(mine, lateral_ratio);
  s.coordination = mean_of(mine, [](C c) { return last(c.coordination_bodies); });
  s.fabric = mean_of(mine, [](C c) { return last(c.fabric_bodies); });
  s.force_mean = mean_of(mine, [](C c) { return mean_and_variation(c.body_forces).first; });
  s.force_variation = mean_of(mine, [](C c) { return mean_and_variation(c.body_forces).second; });
  s.contact_evaluations = mean_of(mine, visits).mean;
  s.noise = mean_of(mine, own_noise);
  s.band_width = mean_of(mine, end_band_width);
  const Pairs with_twins = pair_up(mine, usable_of(curves, to_string(Twin::shelled)));
  s.coverage = mean_of(with_twins, [](C c, C t) { return share_in_band(c, t, false); });
  s.coverage_end = mean_of(with_twins, [](C c, C t) { return share_in_band(c, t, true); });
  const auto at_places = [&](const char* partner) {
    const bool law = !s.twin();
    return law ? mean_of(usable_of(curves, to_string(Twin::shelled)),
                         [&](C c) { return places_ratio(c, engine, partner); })
               : MeanError{0, kNaN, kNaN, kNaN};
  };
  s.places = {at_places("solid"), at_places("wall"), at_places("soft")};
  s.seconds = mean_of(mine, [](C c) { return c.cost.seconds; }).mean;
  const auto against = [&](Twin twin) {
    return s.twin() == twin ? TwinErrors{} : errors_against(pair_up(mine, usable_of(curves, to_string(twin))));
  };
  s.shelled = against(Twin::shelled);
  s.free = against(Twin::free);
  return s;
}

std::string cell(const MeanError& m, int digits = 4) {
  return m.n == 0 ? "" : with_error(m.mean, if_finite(m.error), {.value = {digits}});
}

std::string cell(double value) { return rounded_text(value, {3}, ""); }

void add_cells(const TwinErrors& e, std::vector<std::string>& row) {
  for (const MeanError* m : {&e.axial, &e.axial_of_mean, &e.axial_end, &e.deviator, &e.strains, &e.unloading,
                             &e.lateral_ratio, &e.coordination, &e.fabric, &e.force_mean, &e.force_distance})
    row.push_back(cell(*m, 3));
  row.push_back(e.pairs > 0 ? cell(e.speedup_evaluations) : "");
  row.push_back(e.pairs > 0 ? cell(e.speedup_seconds) : "");
}

}  // namespace

ComparedQuantity headline_of(const TwinErrors& e) {
  if (e.deviator.n > 0 && e.staged) return {"deviator", e.deviator};
  if (e.axial.n > 0) return {"stress", e.axial};
  return {"strain along axes that go by stress", e.strains};
}

std::pair<double, double> mean_and_variation(const std::vector<double>& forces) {
  const MeanError m = mean_error(forces);
  return {m.mean, ratio(m.deviation, m.mean)};
}

double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b) {
  const auto unordered = [](const std::vector<double>& v) {
    return std::ranges::any_of(v, [](double x) { return std::isnan(x); });
  };
  if (a.empty() || b.empty() || unordered(a) || unordered(b)) return kNaN;
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double worst = 0.0;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    const double at = std::min(a[i], b[j]);
    while (i < a.size() && a[i] <= at) ++i;
    while (j < b.size() && b[j] <= at) ++j;
    worst = std::max(worst, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                     static_cast<double>(j) / static_cast<double>(b.size())));
  }
  return worst;
}

std::vector<EngineScore> score_engines(const std::vector<MacroCurve>& curves) {
  std::vector<EngineScore> scores;
  for (const MacroCurve& first : curves) {
    const auto known = [&](const EngineScore& s) { return s.engine == first.engine; };
    if (std::ranges::none_of(scores, known)) scores.push_back(score_of(curves, first.engine));
  }
  return scores;
}

ScoreTable score_table(const std::vector<EngineScore>& scores) {
  ScoreTable table;
  table.header = {"engine",
                  "samples",
                  "axial stress [Pa]",
                  "lateral/axial",
                  "coordination",
                  "fabric",
                  "mean force [N]",
                  "force variation",
                  "contact evaluations",
                  "seconds",
                  "noise",
                  "half band / stress",
                  "points of the twin in band",
                  "end of the twin in band"};
  for (const char* partner : kPlacesPartners)
    table.header.push_back(fmt::format("force on {} at the twin's places: law/twin", partner));
  for (const auto& [ignored, twin] : enum_names<Twin>)
    for (const char* what :
         {"stress error", "stress error of the mean", "end stress ratio", "deviator error", "strain error",
          "unloading modulus ratio", "lateral/axial difference", "coordination difference", "fabric difference",
          "mean force ratio", "force KS distance", "fewer evaluations", "faster"})
      table.header.push_back(fmt::format("{}: {}", twin, what));
  for (const EngineScore& s : scores) {
    std::vector<std::string> row{s.engine, std::to_string(s.samples)};
    for (const MeanError* m :
         {&s.axial, &s.lateral_ratio, &s.coordination, &s.fabric, &s.force_mean, &s.force_variation})
      row.push_back(cell(*m));
    row.push_back(cell(s.contact_evaluations));
    row.push_back(cell(s.seconds));
    for (const MeanError* m :
         {&s.noise, &s.band_width, &s.coverage, &s.coverage_end, &s.places.solid, &s.places.wall, &s.places.soft})
      row.push_back(cell(*m, 3));
    add_cells(s.shelled, row);
    add_cells(s.free, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace softgrain
