#include "pipelines/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "calibrate/experiment_fit.h"
#include "common/data/law_words.h"
#include "common/io/text_file.h"
#include "pipelines/law/law_fit.h"
#include "pipelines/law/law_library_press.h"
#include "pipelines/report/report.h"

namespace softgrain {

namespace {

struct CurveSettings {
  FitOptions fit;
  ForceCurveOptions curves;
  bool mirror = false;
};

/// An option of the command line with a unit.
std::optional<double> quantity(const char* option, const std::string& text, Unit unit) {
  if (text.empty()) return std::nullopt;
  double value = 0.0;
  try {
    value = parse_quantity(text, unit);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{} {}: {}", option, text, e.what()));
  }
  if (!(value > 0.0)) throw InputError(fmt::format("{} {}: must be above 0", option, text));
  return value;
}

CurveSettings read_settings(const SceneTable& t, const CommonOptions& options) {
  CurveSettings s;
  s.fit = read_fit_settings(t);
  s.curves.unloading = t.choice<Unloading>({"unloading",
                                            "points whose overlap does not rise: `fit` an unloading branch to them, "
                                            "`drop` them or `refuse` them"},
                                           Unloading::fit);
  s.mirror = t.flag(
      {"mirror",
       "true: derive the kind of contact that was not measured by symmetry (two equal particles each take half of the "
       "overlap), since macro scenes need both; real grains interlock, so the law is marked as not measured"},
      false);
  s.fit.subtract_offset =
      t.choice({"offset",
                "a force read without contact (before touch or below the threshold, at least three readings): "
                "`subtract` it from all forces of its sample, with a remark, or `keep` it"},
               {"subtract", "keep"}, "subtract") == "subtract";
  s.curves.initial_angle_deg = s.fit.initial_angle_deg;
  s.curves.secant_angle_deg = s.fit.secant_angle_deg.value_or(s.curves.secant_angle_deg);
  t.finish();
  if (!options.kind.empty()) {
    s.curves.kind = parse_enum<PairKind>(options.kind);
    if (!s.curves.kind) throw InputError("--kind " + options.kind + ": must be soft-solid or soft-soft");
  }
  s.curves.shell_radius = quantity("--radius", options.radius, Unit::length);
  s.curves.youngs_modulus = quantity("--modulus", options.modulus, Unit::pressure);
  return s;
}

/// More points than these in all are not drawn, nor more samples: a page must open, and nobody sees them one by one.
constexpr std::size_t kMostDrawn = 4000;
constexpr std::size_t kMostSamples = 100;

/// Numbers of at most `most` of n points: both ends, and the lowest and the highest force of every even stretch, so
/// that points far from the law are among them.
std::vector<std::size_t> drawn_points(const std::vector<ForcePoint>& points, std::size_t most) {
  const std::size_t n = points.size();
  std::vector<std::size_t> out;
  if (n <= most) {
    for (std::size_t k = 0; k < n; ++k) out.push_back(k);
    return out;
  }
  const std::size_t stretches = std::max<std::size_t>(most / 2, 2) - 1;
  out.push_back(0);
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(s * n / stretches);
    const auto end = points.begin() + static_cast<std::ptrdiff_t>((s + 1) * n / stretches);
    const auto [low, high] =
        std::minmax_element(begin, end, [](const ForcePoint& a, const ForcePoint& b) { return a.force < b.force; });
    for (const auto at : {std::min(low, high), std::max(low, high)})
      if (const auto k = static_cast<std::size_t>(at - points.begin()); k > out.back()) out.push_back(k);
  }
  if (out.back() != n - 1) out.push_back(n - 1);
  return out;
}

DrawnSample drawn(const ForceCurves& kind, const ForceCurve& s, std::size_t most) {
  DrawnSample one{kind.kind, s.name, {}, {}, {}, s.normal.size(), s.tangential.size()};
  const auto add = [&](const ForcePoint& p) {
    one.delta.push_back(p.delta);
    one.force.push_back(p.force);
    if (kind.has_errors) one.error.push_back(p.error);
  };
  for (const std::size_t k : drawn_points(s.normal, most)) add(s.normal[k]);
  for (const UnloadedCurve& u : s.unloaded) {
    one.points = one.points.value_or(0) + u.points.size();
    for (const std::size_t k : drawn_points(u.points, most)) add(u.points[k]);
  }
  return one;
}

/// The measured points as the report draws them; each sample says how many it has.
std::vector<DrawnSample> drawn_samples(const std::vector<ForceCurves>& curves) {
  std::size_t samples = 0;
  for (const ForceCurves& kind : curves) samples += kind.samples.size();
  const std::size_t most = std::min(samples, kMostSamples);
  std::vector<DrawnSample> out;
  std::size_t number = 0;
  for (const ForceCurves& kind : curves)
    for (const ForceCurve& s : kind.samples) {
      const bool chosen = number * most / samples != (number + 1) * most / samples;  // evenly spread
      ++number;
      if (chosen) out.push_back(drawn(kind, s, kMostDrawn / most));
    }
  return out;
}

/// How many of the measured points the summary and the report hold, when not all.
void note_thinned(const std::vector<ForceCurves>& curves, const std::vector<DrawnSample>& drawn,
                  std::vector<std::string>& remarks) {
  std::size_t points = 0;
  std::size_t samples = 0;
  std::size_t kept = 0;
  for (const ForceCurves& kind : curves) {
    samples += kind.samples.size();
    for (const ForceCurve& s : kind.samples) {
      points += s.normal.size();
      for (const UnloadedCurve& u : s.unloaded) points += u.points.size();
    }
  }
  for (const DrawnSample& one : drawn) kept += one.delta.size();
  if (kept < points)
    remarks.push_back(
        fmt::format("{} of {} points (of {} of {} samples) are drawn and in the summary; the fit is to all", kept,
                    points, drawn.size(), samples));
}

std::string force_line(const FitReport& report, const SoftParticleSpec& spec) {
  const std::string line = verdict_text(report.law) + "\n";
  if (report.law.normal.b.value <= 0.0) return line;
  return line + normal_law_text(report, spec) + (report.law.unloading ? "  " + unloading_text(report.law) + "\n" : "");
}

/// Macro scenes ask for both kinds of contact.
void add_missing_kind(const ExperimentFit& fit, std::vector<std::string>& remarks) {
  if (fit.card.pairs.size() > 1) return;
  const bool solid = fit.card.pairs.front().kind == PairKind::soft_solid;
  remarks.push_back(
      fmt::format("a macro scene needs the law of {} contacts too: give their measurements as another file, or take "
                  "them from these "
                  "by symmetry with --set mirror=true",
                  solid ? "soft-soft" : "soft-solid"));
}

/// What a macro run takes for the friction between particles.
std::string friction_text(const SoftParticleSpec& spec) {
  return is_known(spec.friction)
             ? fmt::format("friction of a macro run: mu = {:g} of the table, unless macro.mu says another",
                           spec.friction)
             : fmt::format(
                   "the table gives no friction (a comment \"# mu = ...\"): a macro run takes mu = {:g}, unless "
                   "macro.mu says another",
                   MacroSpec{}.friction);
}

}  // namespace

bool are_curve_files(const CommonOptions& options) {
  const auto curves = std::count_if(options.inputs.begin(), options.inputs.end(), is_curve_file);
  if (curves != 0 && curves != static_cast<std::ptrdiff_t>(options.inputs.size()))
    throw InputError("calibrate: tables of an experiment and files of this program need a run each");
  if (curves == 0)
    for (const auto& [option, value] : {std::pair{"--kind", &options.kind}, std::pair{"--radius", &options.radius},
                                        std::pair{"--modulus", &options.modulus}})
      if (!value->empty())
        throw InputError(fmt::format("calibrate: {} is for tables of an experiment (.csv, .tsv, .txt, .dat)", option));
  return curves != 0;
}

ExitStatus calibrate_curves(const CommonOptions& options) {
  const Scene scene = Scene::parse("", "calibrate", options.overrides);
  CurveSettings settings = scene.read([&](const SceneTable& root) { return read_settings(root, options); });
  const std::vector<ForceCurves> curves = read_force_curve_files(options.inputs, settings.curves);
  require_inputs_stay(options, {"log.txt"});
  const RunContext run(options, "calibrate", calibrate_name(options));
  settings.fit.seed = run.seed(settings.fit.seed);
  const ExperimentFit fit = fit_experiment(curves, settings.fit, settings.mirror);
  const Provenance provenance = run.provenance(scene, settings.fit.seed);
  save_card(fit.card, run.path("law.toml"), provenance);

  ExperimentSummary summary;
  std::vector<std::string>& remarks = summary.head.remarks;
  remarks = fit.remarks;
  for (const ForceCurves& kind : fit.curves) {
    if (const std::string doubt = touch_doubt(kind); !doubt.empty())
      summary.head.warnings.push_back(to_string(kind.kind) + ": " + doubt);
    for (const std::string& one : implausible_forces(kind))
      summary.head.warnings.push_back(to_string(kind.kind) + ": " + one);
  }
  add_missing_kind(fit, remarks);
  remarks.push_back(friction_text(fit.card.spec));
  if (const std::string remark = kt_remark(fit.card); !remark.empty()) summary.head.warnings.push_back(remark);
  std::string console;
  for (const FitReport& r : fit.reports) {
    console += force_line(r, fit.card.spec);
    if (r.law.status == LawStatus::good || is_by_symmetry(r.law)) continue;
    summary.head.status = RunStatus::not_usable;
    remarks.insert(remarks.begin(),
                   fmt::format("{} law: {}: {}", to_string(r.law.kind), to_string(r.law.status), r.law.reason));
  }
  summary.experiment = drawn_samples(fit.curves);
  note_thinned(fit.curves, summary.experiment, remarks);
  console += "law card: " + run.path("law.toml") + "; report: " + run.path("report.html") + "\n";
  summary.inputs = options.inputs;
  summary.relaxation = fit.card.relaxation;
  summary.intervals = fit.card.intervals;
  summary.laws = summary_of(fit.card);
  run.finish(json_of(summary), provenance, console);
  write_report(run.directory());
  return summary.head.status == RunStatus::good ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
