#include "pipelines/kinds/macro/bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/draws.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

namespace {

constexpr double kFarAlong = 1.5;  ///< standard deviations: where a component is tried; 95 % of draws are within 2
constexpr std::size_t kMostComponents = 4;
constexpr double kShareHeld = 0.95;  ///< share of the scatter of forces that the components must hold

constexpr double kOneWay = 2.0;  ///< standard deviations within which a change of the law moves the stress one way

/// Runs of a band on one sample: as a change of the law goes, so does the stress. Two runs at +-kFarAlong of a
/// component give its slope and its bend. Paths of packings jump now and then, so that one of three runs has slipped at
/// some point and the others have not: hence the bound of the bend.
struct Curvature {
  double slope = 0.0;
  double curvature = 0.0;

  Curvature(double stress, double below, double above)
      : slope((above - below) / (2.0 * kFarAlong)),
        curvature(std::clamp((above + below - 2.0 * stress) / (2.0 * kFarAlong * kFarAlong),
                             -std::abs(slope) / (2.0 * kOneWay), std::abs(slope) / (2.0 * kOneWay))) {}
  [[nodiscard]] double at(double s) const { return s * (slope + curvature * s); }
};

bool like(const MacroCurve& variant, const MacroCurve& curve, BandOf of) {
  return variant.usable && banded_stress(variant, of).size() == banded_stress(curve, of).size();
}

/// The runs that one law needs, and what to make of them.
class DrawnBand {
 public:
  DrawnBand(const LawDraws& draws, const MacroSetup& setup) : draws_(draws), setup_(setup) {
    record_.engine = draws.law.name;
    record_.estimator = setup.band_estimator;
    record_.draws = static_cast<std::int64_t>(draws.draws.size());
    record_.origin = draws.origin;
    record_.discrepancy = draws.off.empty() ? kNaN : draws.discrepancy;
    record_.discrepancy_origin = draws.discrepancy_origin;
    if (setup.band_estimator == BandEstimator::draws) {
      for (const std::vector<double>& numbers : draws.draws) variants_.push_back(draws.with(numbers));
    } else {
      std::vector<std::vector<double>> effects;
      for (const std::vector<double>& numbers : draws.draws) effects.push_back(draws.effects(numbers));
      components_ = effect_components(draws.draws, effects, kMostComponents, kShareHeld);
      record_.components = static_cast<std::int64_t>(components_.direction.size());
      record_.explained = components_.explained;
      add_variants(components_.direction);
    }
    first_off_ = variants_.size();
    add_variants(draws.off);
    record_.runs = static_cast<std::int64_t>(variants_.size());
  }

  [[nodiscard]] const std::vector<NamedLaws>& variants() const { return variants_; }
  [[nodiscard]] const BandRecord& record() const { return record_; }

  /// `ran`: the variants on the sample of this curve, in their order.
  void add(const std::vector<const MacroCurve*>& ran, double noise, MacroCurve& curve) {
    record_.noise = noise;
    for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
      const auto bad = std::ranges::find_if(ran, [&](const MacroCurve* c) { return !like(*c, curve, of); });
      if (bad != ran.end()) {
        append_part(curve.note, "no band: with some draw of the law the test did not come to its end" +
                                    ((*bad)->note.empty() ? std::string() : " (" + (*bad)->note + ")"));
        return;
      }
      const std::vector<double>& stress = banded_stress(curve, of);
      const std::vector<std::vector<double>> draws = drawn(ran, stress, of);
      if (of == BandOf::axial) curve.drawn_axial = draws;
      std::vector<MacroBand> parts;
      const auto add_part = [&](BandPart part, MacroBand band) {
        set_band(curve, of, part, band);
        parts.push_back(std::move(band));
      };
      add_part(BandPart::law, law_part(draws, stress));
      if (first_off_ < ran.size()) add_part(BandPart::discrepancy, discrepancy_part(ran, stress, of));
      if (noise > 0.0) add_part(BandPart::noise, noise_part(stress, noise));
      set_band(curve, of, BandPart::all, together(stress, parts));
    }
  }

 private:
  void add_variants(const std::vector<std::vector<double>>& directions) {
    for (const std::vector<double>& direction : directions)
      for (const double s : {-kFarAlong, kFarAlong}) variants_.push_back(draws_.with(along(direction, s)));
  }
  [[nodiscard]] std::vector<double> along(const std::vector<double>& direction, double s) const {
    std::vector<double> numbers = draws_.numbers;
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] += s * direction[k];
    return numbers;
  }

  /// Stress of every draw at every point.
  [[nodiscard]] std::vector<std::vector<double>> drawn(const std::vector<const MacroCurve*>& ran,
                                                       const std::vector<double>& stress, BandOf of) const {
    std::vector<std::vector<double>> out;
    if (setup_.band_estimator == BandEstimator::draws) {
      for (std::size_t r = 0; r < draws_.draws.size(); ++r) out.push_back(banded_stress(*ran[r], of));
      return out;
    }
    out.assign(components_.scores.size(), stress);
    for (std::size_t c = 0; c < components_.direction.size(); ++c)
      for (std::size_t k = 0; k < stress.size(); ++k) {
        const Curvature curvature(stress[k], banded_stress(*ran[2 * c], of)[k], banded_stress(*ran[2 * c + 1], of)[k]);
        for (std::size_t r = 0; r < out.size(); ++r) out[r][k] += curvature.at(components_.scores[r][c]);
      }
    return out;
  }

  [[nodiscard]] static MacroBand law_part(const std::vector<std::vector<double>>& draws,
                                          const std::vector<double>& stress) {
    MacroBand band;
    for (std::size_t k = 0; k < stress.size(); ++k) {
      std::vector<double> values;
      for (const std::vector<double>& draw : draws) values.push_back(draw[k]);
      band.low.push_back(std::min(stress[k], quantile(values, 0.025)));
      band.high.push_back(std::max(stress[k], quantile(values, 0.975)));
    }
    return band;
  }
  /// Ways in which the form may be off are independent of each other.
  [[nodiscard]] MacroBand discrepancy_part(const std::vector<const MacroCurve*>& ran, const std::vector<double>& stress,
                                           BandOf of) const {
    std::vector<MacroBand> ways;
    for (std::size_t v = first_off_; v < ran.size(); v += 2) {
      MacroBand& band = ways.emplace_back();
      for (std::size_t k = 0; k < stress.size(); ++k) {
        const Curvature curvature(stress[k], banded_stress(*ran[v], of)[k], banded_stress(*ran[v + 1], of)[k]);
        const auto [low, high] = std::minmax({curvature.at(-kNormal95), curvature.at(kNormal95)});
        band.low.push_back(stress[k] + std::min(low, 0.0));
        band.high.push_back(stress[k] + std::max(high, 0.0));
      }
    }
    return together(stress, ways);
  }
  [[nodiscard]] static MacroBand noise_part(const std::vector<double>& stress, double noise) {
    MacroBand band;
    for (const double s : stress) {
      band.low.push_back(s - kNormal95 * noise * std::abs(s));
      band.high.push_back(s + kNormal95 * noise * std::abs(s));
    }
    return band;
  }

  const LawDraws& draws_;
  const MacroSetup& setup_;
  EffectComponents components_;
  std::vector<NamedLaws> variants_;
  std::size_t first_off_ = 0;  ///< variants from here on: of the form
  BandRecord record_;
};

/// Relative standard deviation of a run, from the samples of an engine that were run twice; 0 where none was.
double noise_of(const std::vector<MacroCurve>& curves, const std::string& engine) {
  std::vector<double> squares;
  for (const MacroCurve& c : curves) {
    const auto again = c.more.find(kAgainAxial);
    if (c.engine != engine || again == c.more.end()) continue;
    double apart = 0.0;
    double all = 0.0;
    for (std::size_t k = 0; k < c.stress_axial.size(); ++k) {
      apart += std::pow(again->second[k] - c.stress_axial[k], 2);
      all += std::pow(c.stress_axial[k], 2);
    }
    if (all > 0.0) squares.push_back(0.5 * apart / all);
  }
  return squares.empty() ? 0.0 : std::sqrt(mean_error(squares).mean);
}

double students(std::size_t samples) { return samples > 1 ? student95(static_cast<double>(samples - 1)) : kNaN; }

}  // namespace

std::vector<LawDraws> draws_for(const MacroSetup& setup, const LawSources& sources, const std::vector<NamedLaws>& laws,
                                double contents_fraction) {
  std::vector<LawDraws> out;
  if (setup.bands > 0)
    for (const NamedLaws& law : laws)
      out.push_back(law_draws(sources, law, setup.spec, contents_fraction, setup.bands));
  return out;
}

std::vector<BandRecord> add_bands(const MacroRuns& runs, const std::vector<LawDraws>& laws, const Run& run,
                                  std::vector<MacroCurve>& curves) {
  std::vector<BandRecord> records;
  for (const LawDraws& draws : laws) {
    DrawnBand band(draws, runs.setup);
    const std::vector<MacroCurve> ran = run_laws(runs, band.variants(), ": bands, " + draws.law.name, run);
    const double noise = noise_of(curves, draws.law.name);
    for (MacroCurve& c : curves) {
      if (c.engine != draws.law.name || !c.usable) continue;
      std::vector<const MacroCurve*> own;
      for (const MacroCurve& v : ran)
        if (v.sample == c.sample) own.push_back(&v);
      band.add(own, noise, c);
    }
    records.push_back(band.record());
  }
  return records;
}

std::vector<BandedEnd> banded_ends(const std::vector<MacroCurve>& curves) {
  std::vector<BandedEnd> out;
  std::vector<std::string> seen;
  for (const MacroCurve& first : curves) {
    if (std::ranges::find(seen, first.engine) != seen.end()) continue;
    seen.push_back(first.engine);
    for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
      BandedEnd end{of, first.engine};
      std::vector<double> stress;
      double low[2] = {0.0, 0.0};
      double high[2] = {0.0, 0.0};
      double noise_of = 0.0;
      bool known = true;  // the discrepancy
      for (const MacroCurve& c : curves_of(curves, first.engine)) {
        const auto law = band_of(c, of, BandPart::law);
        const auto off = band_of(c, of, BandPart::discrepancy);
        if (!c.usable || !law) continue;
        if (const auto part = band_of(c, of, BandPart::noise)) noise_of = 0.5 * (part->high.back() - part->low.back());
        const double own = banded_stress(c, of).back();
        stress.push_back(own);
        const EndStrain last = strain_at_end(c);
        end.strain = last.value;
        end.strain_name = last.name;
        ++end.count;
        if (!c.law_beyond.empty() && !c.law_evaluations.empty() && c.law_evaluations.back() > 0.0)
          end.beyond = std::max(end.beyond, c.law_beyond.back() / c.law_evaluations.back());
        low[0] += own - law->low.back(), high[0] += law->high.back() - own;
        if (off) low[1] += own - off->low.back(), high[1] += off->high.back() - own;
        known = known && off.has_value();
      }
      if (stress.empty()) continue;
      const auto n = static_cast<double>(stress.size());
      const MeanError mean = mean_error(stress);
      end.stress = mean.mean;
      end.law = 0.5 * (low[0] + high[0]) / n;
      end.discrepancy = known ? 0.5 * (low[1] + high[1]) / n : kNaN;
      end.samples = students(stress.size()) * mean.error;
      const double spread = std::isfinite(end.samples) ? end.samples : 0.0;
      const double noise = stress.size() == 1 ? noise_of : 0.0;  // several samples show it by their spread
      const double below = std::hypot(std::hypot(low[0] / n, low[1] / n), std::hypot(spread, noise));
      end.low = end.stress - below;
      end.high = end.stress + std::hypot(std::hypot(high[0] / n, high[1] / n), std::hypot(spread, noise));
      end.determined = below < end.stress || !(end.stress > 0.0);
      if (!end.determined) end.low = end.high = kNaN;
      if (end.determined) end.low = std::max(0.0, end.low);
      out.push_back(end);
    }
  }
  return out;
}

std::string banded_text(const BandedEnd& e) {
  const auto share = [&](double half) { return e.stress > 0.0 ? 100.0 * half / e.stress : kNaN; };
  const std::string interval = e.determined ? fmt::format("95 % {:.4g} to {:.4g}", e.low, e.high)
                                            : std::string("not determined: its error is as large as itself");
  const std::string beyond = e.beyond > 0.0
                                 ? fmt::format(
                                       "; at least: {:.2g} % of the contacts are beyond what the law was measured for, "
                                       "where no error is known",
                                       100.0 * e.beyond)
                                 : "";
  return fmt::format("{}: {} stress at {} {:.4g}: {:.4g} Pa, {} (law {:.2g} %, discrepancy {}, {}{})", e.engine,
                     to_string(e.of), e.strain_name, e.strain, e.stress, interval, share(e.law),
                     std::isnan(e.discrepancy) ? "unknown" : fmt::format("{:.2g} %", share(e.discrepancy)),
                     std::isfinite(e.samples) ? fmt::format("{} samples {:.2g} %", e.count, share(e.samples))
                                              : "samples unknown: one alone",
                     beyond);
}

std::string bands_text(const std::vector<BandRecord>& bands, const std::vector<BandedEnd>& ends) {
  std::string text;
  for (const BandedEnd& e : ends) text += banded_text(e) + "\n";
  for (const BandRecord& b : bands) {
    const std::string way = b.components > 0
                                ? fmt::format("{} per sample along {}, {:.0f} % of its scatter", counted(b.runs, "run"),
                                              counted(b.components, "component"), 100.0 * b.explained)
                                : counted(b.runs, "run") + " per sample";
    const std::string off = b.discrepancy > 0.0
                                ? fmt::format("{:.2g} %, from {}", 100.0 * b.discrepancy, b.discrepancy_origin)
                                : b.discrepancy_origin;
    text += fmt::format("bands of {}: {}, by {}; discrepancy: {}\n", b.engine, b.origin, way, off);
  }
  return text;
}

std::vector<std::string> missing_bands(const std::vector<BandRecord>& bands, const std::vector<BandedEnd>& ends) {
  std::vector<std::string> out;
  for (const BandRecord& b : bands)
    if (std::ranges::none_of(ends, [&](const BandedEnd& e) { return e.engine == b.engine; }))
      out.push_back(fmt::format(
          "{} has no interval: not every run with a draw of the law came to the end of the test (a note says which "
          "did not); strain less, or change the seed",
          b.engine));
  return out;
}

}  // namespace softgrain
