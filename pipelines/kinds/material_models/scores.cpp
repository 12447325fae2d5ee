// Curves of models beside the truth.
#include "pipelines/kinds/material_models/models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "pipelines/compare/stage_match.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/macro/scene.h"

namespace softgrain {

namespace {

using Column = std::vector<double> (*)(const MacroCurve&);

/// Mean of a column over the curves, at the points that all of them have.
std::vector<double> mean_of(const std::vector<MacroCurve>& curves, Column column) {
  std::vector<double> sum(column(curves.front()).size(), 0.0);
  for (const MacroCurve& c : curves) {
    const std::vector<double> values = column(c);
    sum.resize(std::min(sum.size(), values.size()));
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[k];
  }
  for (double& v : sum) v /= static_cast<double>(curves.size());
  return sum;
}

std::vector<double> axial_of(const MacroCurve& c) { return c.stress_axial; }
std::vector<double> lateral_of(const MacroCurve& c) { return c.stress_lateral; }
std::vector<double> strain_of(const MacroCurve& c) { return c.strain_z; }
std::vector<double> ratio_of(const MacroCurve& c) { return stress_ratios(c); }

/// Samples that both truth and model came through, side by side.
struct Pairs {
  std::vector<MacroCurve> truth;
  std::vector<MacroCurve> model;
  std::vector<std::size_t> sample;
};

Pairs pairs_of(const ModelRun& run, std::string& remark) {
  Pairs out;
  for (std::size_t k = 0; k < std::min(run.curves.size(), run.truth->curves.size()); ++k) {
    const MacroCurve& t = run.truth->curves[k];
    const MacroCurve& m = run.curves[k];
    const bool whole = m.usable && m.strain.size() == t.strain.size();
    if (t.usable && whole) {
      out.truth.push_back(t);
      out.model.push_back(m);
      out.sample.push_back(k);
      if (!m.note.empty()) append_part(remark, fmt::format("sample {}: {}", k, m.note));
    } else if (t.usable) {
      append_part(remark, fmt::format("sample {} left out: {}", k, m.note.empty() ? "it ends early" : m.note));
    }
  }
  return out;
}

/// Points that a test in stages does not impose, of a column of each side.
struct FreeColumns {
  std::vector<double> model;
  std::vector<double> truth;
  std::size_t first = 0;  ///< place in these columns of the point that was meant
};

FreeColumns without_imposed(const std::vector<double>& model, const std::vector<double>& truth,
                            const std::vector<bool>& given, std::size_t first) {
  FreeColumns out;
  for (std::size_t k = 0; k < std::min(model.size(), truth.size()); ++k) {
    if (k < given.size() && given[k]) continue;
    out.first += k < first ? 1 : 0;
    out.model.push_back(model[k]);
    out.truth.push_back(truth[k]);
  }
  return out;
}

double free_difference(const std::vector<double>& model, const std::vector<double>& truth,
                       const std::vector<bool>& given, std::size_t first) {
  const FreeColumns columns = without_imposed(model, truth, given, first);
  return relative_difference(columns.model, columns.truth, columns.first);
}

/// Standard error of an error that every pair has by itself; NaN with one.
double scatter_of(const Pairs& pairs, Column column, const std::vector<bool>& given, std::size_t first) {
  std::vector<double> errors;
  for (std::size_t k = 0; k < pairs.truth.size(); ++k)
    errors.push_back(free_difference(column(pairs.model[k]), column(pairs.truth[k]), given, first));
  return errors.size() > 1 ? mean_error(errors).error : kNaN;
}

double excess(const std::vector<double>& model, const std::vector<double>& truth, std::size_t k) {
  return k < model.size() && k < truth.size() && truth[k] != 0.0 ? model[k] / truth[k] - 1.0 : kNaN;
}

/// The first point from this strain of the first stage on; past the end where there is none.
std::size_t point_at(const std::vector<double>& strain, double wanted) {
  for (std::size_t k = 0; k < strain.size(); ++k)
    if (strain[k] >= wanted * (1.0 - 1e-9)) return k;
  return strain.size();
}

/// Secant over the first unloading, mean over the samples; NaN where there is none.
double unloading_of(const std::vector<MacroCurve>& curves) {
  double sum = 0.0;
  double samples = 0.0;
  for (const MacroCurve& c : curves) {
    for (const StageResult& s : stage_results(c))
      if (s.record.kind == StageKind::unload) {
        sum += s.modulus;
        samples += 1.0;
        break;
      }
  }
  return sum / samples;
}

double error_at(const std::vector<MacroCurve>& curves, std::size_t k) {
  std::vector<double> values;
  for (const MacroCurve& c : curves)
    if (k < c.stress_axial.size()) values.push_back(c.stress_axial[k]);
  if (values.size() < 2) return kNaN;
  const MeanError m = mean_error(values);
  return m.error / m.mean;
}

/// Points of a stage without the one at which it begins.
std::vector<std::size_t> points_of_stage(const MacroCurve& c, std::size_t stage) {
  std::vector<std::size_t> out;
  for (std::size_t k = 1; k < std::min(c.stage.size(), c.strain_z.size()); ++k)
    if (c.stage[k] == static_cast<double>(stage)) out.push_back(k);
  return out;
}

/// Points of the first stage that shears by straining z, with the one at which it begins, and of the stages of its kind
/// behind it that go on the same way: a test may be said in parts. Empty without any.
std::vector<std::size_t> sheared_points(const MacroCurve& c) {
  std::vector<std::size_t> out;
  const auto first =
      std::ranges::find_if(c.stages, [](const StageRecord& s) { return shears(s.kind) && !slides(s.kind); });
  bool shortens = true;
  for (auto stage = first; stage != c.stages.end() && stage->kind == first->kind; ++stage) {
    const std::vector<std::size_t> own = points_of_stage(c, static_cast<std::size_t>(stage - c.stages.begin()));
    if (own.empty()) break;
    const bool this_way = c.strain_z[own.back()] > c.strain_z[own.front() - 1];
    if (out.empty()) {
      out.push_back(own.front() - 1);
      shortens = this_way;
    }
    if (this_way != shortens) break;
    out.insert(out.end(), own.begin(), own.end());
  }
  return out;
}

/// Nominal strain of z since the first of these points.
std::vector<double> strain_since(const std::vector<double>& strain, const std::vector<std::size_t>& points) {
  std::vector<double> out;
  for (const std::size_t k : points) out.push_back(1.0 - (1.0 - strain[k]) / (1.0 - strain[points.front()]));
  return out;
}

/// Mean loss of volume between two points over the volume at the first.
double volume_lost(const std::vector<MacroCurve>& curves, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (const MacroCurve& c : curves) {
    if (std::min({c.strain_x.size(), c.strain_y.size(), c.strain_z.size()}) <= to) return kNaN;
    const auto volume = [&](std::size_t k) {
      return (1.0 - c.strain_x[k]) * (1.0 - c.strain_y[k]) * (1.0 - c.strain_z[k]);
    };
    sum += 1.0 - volume(to) / volume(from);
  }
  return sum / static_cast<double>(curves.size());
}

/// q/p and volume in the first stage that shears.
void add_shear(const Pairs& pairs, const std::vector<double>& strain, ModelScore& s) {
  const std::vector<std::size_t> points = sheared_points(pairs.truth.front());
  if (points.empty() || points.back() >= strain.size()) return;
  const std::vector<double> since = strain_since(strain, points);
  const auto q_truth = values_at(mean_of(pairs.truth, ratio_of), points);
  const auto q_model = values_at(mean_of(pairs.model, ratio_of), points);
  s.ratio_at_2 = excess(q_model, q_truth, point_at(since, 0.02));
  s.ratio_at_6 = excess(q_model, q_truth, point_at(since, 0.06));
  if (pairs.truth.front().stages[static_cast<std::size_t>(pairs.truth.front().stage[points.back()])].kind ==
      StageKind::triaxial)
    s.volume = volume_lost(pairs.model, points.front(), points.back()) -
               volume_lost(pairs.truth, points.front(), points.back());
}

Cost total(const std::vector<MacroCurve>& curves, Cost MacroCurve::*part) {
  Cost sum;
  for (const MacroCurve& c : curves) sum += c.*part;
  return sum;
}

/// Cost of the truth over that of the model.
void add_costs(const Pairs& pairs, ModelScore& s) {
  const Cost truth = total(pairs.truth, &MacroCurve::cost);
  const Cost model = total(pairs.model, &MacroCurve::cost);
  const double truth_preparation = total(pairs.truth, &MacroCurve::preparation).seconds;
  const double model_preparation = total(pairs.model, &MacroCurve::preparation).seconds;
  s.evaluations = static_cast<double>(truth.contact_evaluations) / static_cast<double>(model.contact_evaluations);
  s.seconds = truth.seconds / model.seconds;
  s.seconds_all = (truth.seconds + truth_preparation) / (model.seconds + model_preparation);
  if (model.contact_evaluations == 0) s.evaluations = s.seconds = s.seconds_all = kInfinity;
}

/// The draws of one sample that came through all its points.
std::vector<const MacroCurve*> whole_draws(const ModelRun& run, std::size_t sample, std::size_t points) {
  std::vector<const MacroCurve*> out;
  for (const std::vector<MacroCurve>& draw : run.drawn)
    if (const MacroCurve& c = draw[sample]; c.usable && c.stress_axial.size() == points) out.push_back(&c);
  return out;
}

/// Half width of their 95 % band at every point, by Student's t; empty with fewer than two draws.
std::vector<double> half_widths(const std::vector<const MacroCurve*>& draws, std::size_t points) {
  if (draws.size() < 2) return {};
  std::vector<double> out;
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> values;
    for (const MacroCurve* c : draws) values.push_back(c->stress_axial[k]);
    out.push_back(student95(static_cast<double>(values.size() - 1)) * mean_error(values).deviation);
  }
  return out;
}

/// Width of the band and share of the points in it; NaN without draws. Draws that break off are counted in the remark:
/// a band of the others may be too narrow.
void add_band(const ModelRun& run, const Pairs& pairs, const std::vector<bool>& given, std::size_t first,
              ModelScore& s) {
  double width2 = 0.0;
  double size2 = 0.0;
  double points = 0.0;
  double held = 0.0;
  std::size_t broke_off = 0;
  for (std::size_t pair = 0; pair < pairs.truth.size(); ++pair) {
    const std::vector<double>& truth = pairs.truth[pair].stress_axial;
    const std::vector<double>& model = pairs.model[pair].stress_axial;
    const std::vector<const MacroCurve*> draws = whole_draws(run, pairs.sample[pair], model.size());
    broke_off += run.drawn.size() - draws.size();
    const std::vector<double> half = half_widths(draws, model.size());
    for (std::size_t k = first; k < half.size(); ++k) {
      if (k < given.size() && given[k]) continue;
      width2 += half[k] * half[k];
      size2 += truth[k] * truth[k];
      points += 1.0;
      held += std::abs(truth[k] - model[k]) <= half[k] ? 1.0 : 0.0;
    }
  }
  s.band = size2 > 0.0 ? std::sqrt(width2 / size2) : kNaN;
  s.inside = points > 0.0 ? held / points : kNaN;
  if (broke_off > 0)
    append_part(s.remark, fmt::format("{} of {} curves of draws of the card break off: the band is without them",
                                      broke_off, run.drawn.size() * pairs.truth.size()));
}

std::string percent(double x) { return percent_text(x, {1, true, true}, "-"); }
std::string times(double x) { return rounded_text(x, {3}, "-"); }

}  // namespace

std::string volume_text(const ModelScore& s) {
  return std::isfinite(s.volume) ? fmt::format("{:+.2f} %", 100.0 * s.volume) : "";
}

double relative_difference(const std::vector<double>& model, const std::vector<double>& truth, std::size_t first) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t k = first; k < std::min(model.size(), truth.size()); ++k) {
    difference += (model[k] - truth[k]) * (model[k] - truth[k]);
    size += truth[k] * truth[k];
  }
  return size > 0.0 ? std::sqrt(difference / size) : kNaN;
}

ModelScore score(const ModelRun& run, bool blind) {
  ModelScore s{.variant = run.truth->variant->name,
               .model = run.model->name,
               .kind = run.model->kind,
               .blind = blind,
               .remark = run.refusal};
  const Pairs pairs = pairs_of(run, s.remark);
  if (pairs.truth.empty()) return s;
  const std::vector<MacroCurve>& truth = pairs.truth;
  s.samples = static_cast<std::int64_t>(truth.size());
  s.bodies = pairs.model.front().bodies;
  const auto strain = mean_of(truth, strain_of);
  const std::size_t first = point_at(strain, 0.01);
  const std::size_t two = point_at(strain, 0.02);
  const auto end = static_cast<std::size_t>(std::max_element(strain.begin(), strain.end()) - strain.begin());
  const auto t = mean_of(truth, axial_of);
  const auto m = mean_of(pairs.model, axial_of);
  // What the test imposes both have: it says nothing of a model.
  const std::vector<bool> axial = imposed_points(truth.front(), ComparedStress::axial);
  const std::vector<bool> lateral = imposed_points(truth.front(), ComparedStress::lateral);
  const auto free = [&](std::size_t k) { return k < axial.size() && !axial[k]; };
  s.axial = free_difference(m, t, axial, first);
  s.lateral = free_difference(mean_of(pairs.model, lateral_of), mean_of(truth, lateral_of), lateral, first);
  s.axial_error = scatter_of(pairs, axial_of, axial, first);
  s.lateral_error = scatter_of(pairs, lateral_of, lateral, first);
  s.axial_at_2 = free(two) ? excess(m, t, two) : kNaN;
  s.axial_at_end = free(end) ? excess(m, t, end) : kNaN;
  s.truth_error = error_at(truth, end);
  add_shear(pairs, strain, s);
  s.unloading = unloading_of(pairs.model) / unloading_of(truth) - 1.0;
  add_band(run, pairs, axial, first, s);
  add_costs(pairs, s);
  if (!run.remark.empty()) append_part(s.remark, run.remark);
  return s;
}

TextTable table_of(const std::vector<ModelScore>& scores) {
  TextTable out{{"variant",
                 "model",
                 "kind",
                 "blind",
                 "samples",
                 "bodies",
                 "axial",
                 "axial standard error",
                 "lateral",
                 "lateral standard error",
                 "axial at 2 %",
                 "axial at the end",
                 "q/p at 2 %",
                 "q/p at 6 %",
                 "volume",
                 "unloading modulus",
                 "standard error of the truth",
                 "band",
                 "inside",
                 "evaluations",
                 "seconds",
                 "seconds with preparation",
                 "remark"},
                {}};
  for (const ModelScore& s : scores) {
    std::vector<std::string> row{s.variant,
                                 s.model,
                                 to_string(s.kind),
                                 s.blind ? "yes" : "no",
                                 std::to_string(s.samples),
                                 std::to_string(s.bodies)};
    for (const double x :
         {s.axial, s.axial_error, s.lateral, s.lateral_error, s.axial_at_2, s.axial_at_end, s.ratio_at_2, s.ratio_at_6,
          s.volume, s.unloading, s.truth_error, s.band, s.inside, s.evaluations, s.seconds, s.seconds_all})
      row.push_back(std::isfinite(x) ? fmt::format("{:.4g}", x) : "");
    row.push_back(s.remark);
    out.rows.push_back(std::move(row));
  }
  return out;
}

std::string console_summary(const std::vector<ModelScore>& scores) {
  std::string text;
  for (const ModelScore& s : scores) {
    text += fmt::format("{}{}, {}: ", s.variant, s.blind ? " (blind)" : "", s.model);
    if (s.samples == 0) {
      text += s.remark + "\n";
      continue;
    }
    text += fmt::format("axial {}, lateral {}, at 2 % {}, at the end {}", percent(s.axial), percent(s.lateral),
                        percent(s.axial_at_2), percent(s.axial_at_end));
    if (std::isfinite(s.ratio_at_2) || std::isfinite(s.ratio_at_6))
      text += fmt::format(", q/p at 2 and 6 % {} and {}", percent(s.ratio_at_2), percent(s.ratio_at_6));
    if (std::isfinite(s.volume)) text += ", volume lost " + volume_text(s) + " of the volume";
    if (std::isfinite(s.unloading)) text += ", unloading modulus " + percent(s.unloading);
    if (std::isfinite(s.band))
      text += fmt::format("; 95 % band ±{:.0f} % of the axial stress, which holds {:.0f} % of the points",
                          100.0 * s.band, 100.0 * s.inside);
    if (std::isfinite(s.evaluations))  // a mean field evaluates nothing
      text += fmt::format("; {} times fewer evaluations, {} times faster", times(s.evaluations), times(s.seconds));
    text += (s.remark.empty() ? "" : "; " + s.remark) + "\n";
  }
  return text;
}

}  // namespace softgrain
