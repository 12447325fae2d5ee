// Strict reading of a law card: what is unknown, missing or inconsistent is an error with file and line.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/data/card_text.h"
#include "common/data/law_card_format.h"
#include "common/io/scene.h"

namespace softgrain {

namespace {

/// c may differ from -a delta^b by rounding only.
constexpr double kContinuityTolerance = 1e-6;

Estimate read_estimate(const SceneTable& table, const Range& range, bool must_be_known) {
  Estimate e;
  e.value = must_be_known ? table.number("value", Unit::none, range) : read_real(table, "value", Range::any());
  (void)table.choice("unit", {"1"});
  e.standard_error = read_real(table, "standard_error", Range::not_negative());
  const SceneTable interval = table.table("interval_95");
  e.low = read_real(interval, "low", Range::any());
  e.high = read_real(interval, "high", Range::any());
  if (e.low > e.high) interval.throw_error("low", "must not be above the high end");
  return e;
}

/// `must_be_known`: the law is used, so its numbers must be finite and make a continuous law that pushes.
ThresholdPowerLaw read_law(const SceneTable& table, bool must_be_known) {
  ThresholdPowerLaw law;
  law.a = read_estimate(table.table("a"), Range::positive(), must_be_known);
  law.b = read_estimate(table.table("b"), Range{0.0, kLargestExponent, true, false}, must_be_known);
  law.c = read_estimate(table.table("c"), Range::any(), must_be_known);
  law.delta = read_estimate(table.table("delta"), Range{0.0, kThresholdsBelow, false, true}, must_be_known);
  if (!must_be_known) return law;
  const double expected = -law.a.value * std::pow(law.delta.value, law.b.value);
  if (std::abs(law.c.value - expected) > kContinuityTolerance * std::abs(expected))
    table.table("c").throw_error("value", fmt::format("must be -a delta^b = {}, or the law jumps at delta", expected));
  return law;
}

std::vector<double> read_covariance(const SceneTable& pair) {
  std::vector<double> covariance;
  if (!pair.has("covariance")) return covariance;
  const SceneTable table = pair.table("covariance");
  for (const char* name : kLawParameterNames) {
    const std::vector<double> row = table.numbers(name, Unit::none);
    if (row.size() != kLawParameterNames.size())
      table.throw_error(name, fmt::format("must have {} entries", kLawParameterNames.size()));
    covariance.insert(covariance.end(), row.begin(), row.end());
  }
  return covariance;
}

void read_validity(const SceneTable& table, PairLaw& law) {
  law.delta_min = table.number("delta_min", Unit::none, Range::closed(0.0, kLargestDelta));
  law.delta_max = table.number("delta_max", Unit::none, Range::closed(0.0, kLargestDelta));
  if (law.delta_max < law.delta_min) table.throw_error("delta_max", "must not be below delta_min");
  law.max_overlap = read_real(table, "max_overlap", Range::not_negative());
  law.beyond = read_beyond(table).value_or(Extrapolation::extrapolate);
}

void read_tangential(const SceneTable& table, ThresholdPowerLaw& law, double& angle, bool& fitted, bool good) {
  fitted = table.flag("fitted", false);
  angle = table.number("angle_deg", Unit::angle_degree, Range::positive());
  law = read_law(table, good && fitted);
}

UnloadingLaw read_unloading(const SceneTable& table, const ThresholdPowerLaw& loading) {
  constexpr double kRounding = 1e-9;
  constexpr std::int64_t kMany = std::numeric_limits<int>::max();
  UnloadingLaw u;
  u.samples = static_cast<int>(table.count("samples", 0, kMany));
  u.points = static_cast<int>(table.count("points", 0, kMany));
  u.correlation = table.number("correlation", Unit::none, Range::closed(-1.0, 1.0));
  u.residual = read_estimate(table.table("residual"), Range::closed(0.0, kLargestResidual), true);
  u.exponent = read_estimate(table.table("exponent"), Range{1.0, kLargestExponent, false, false}, true);
  if (table.has("deepest"))
    u.deepest = table.number("deepest", Unit::none, Range::above(loading.delta.value));
  const double least = least_unloading_exponent(u.residual.value, loading.b.value);
  if (u.exponent.value < least * (1.0 - kRounding))
    table.table("exponent")
        .throw_error("value",
                     fmt::format("must be at least {:.6g} with this residual and b = {:.6g}: with less, cycles would "
                                 "give back more than they took",
                                 least, loading.b.value));
  return u;
}

/// `intervals` of the card, where the pair does not say its own.
PairLaw read_pair(const SceneTable& table, const std::string& intervals) {
  constexpr std::int64_t kMany = std::numeric_limits<int>::max();
  PairLaw law;
  law.kind = table.choice<PairKind>("kind");
  law.status = table.choice(
      "status", {LawStatus::good, LawStatus::no_threshold_crossing, LawStatus::underdetermined, LawStatus::not_run});
  law.reason = table.text("reason", "");
  law.band_origin = table.text("interval_95", intervals);
  law.packings = static_cast<int>(table.count("packings", 0, kMany));
  law.points = static_cast<int>(table.count("points", 0, kMany));
  law.chi2_per_dof = read_real(table, "chi2_per_dof", Range::not_negative());
  law.quality = read_real(table, "quality", Range::closed(0.0, 1.0));
  read_validity(table.table("validity"), law);
  // Of an underdetermined law there may be no numbers at all, written as zeros.
  const bool none = law.status == LawStatus::underdetermined &&
                    read_real(table.table("normal").table("b"), "value", Range::any()) == 0.0;
  const bool good = law.status == LawStatus::good || (law.status == LawStatus::underdetermined && !none);
  law.normal = read_law(table.table("normal"), good);
  if (law.status == LawStatus::good && !(law.normal.delta.value < law.delta_max))
    table.table("normal").table("delta").throw_error(
        "value", fmt::format("must be below delta_max = {}: a good law has a force in the range it was fitted to",
                             law.delta_max));
  read_tangential(table.table("tangential_initial"), law.tangential_initial, law.initial_angle_deg,
                  law.has_tangential_initial, good);
  read_tangential(table.table("tangential_secant"), law.tangential_secant, law.secant_angle_deg,
                  law.has_tangential_secant, good);
  if (table.has("tangential_assumed"))
    law.kt_ratio = table.table("tangential_assumed").number("kt_ratio", Unit::none, Range::closed(0.0, 2.0));
  if (good && table.has("unloading")) law.unloading = read_unloading(table.table("unloading"), law.normal);
  law.covariance = read_covariance(table);
  return law;
}

}  // namespace

LawCard read_card_text(const Scene& file) {
  const SceneTable root = file.root();
  LawCard card;
  card.schema = static_cast<int>(root.count("schema", kSchemaVersion, kSchemaVersion));
  card.table_id = read_words(root, {"form", "Delta", "normal", "tangential", "interval_95"});
  card.intervals = root.table_or_empty("definitions").text("interval_95", card.intervals);
  const SceneTable measurement = root.table("measurement");
  card.relaxation = measurement.text("relaxation");
  if (!card.from_experiment()) card.turn = measurement.choice<TurnProtocol>("turn", TurnProtocol::frozen);
  card.spec = read_spec_text(measurement, card.from_experiment());
  for (const SceneTable& pair : root.tables("pair")) {
    const PairLaw law = read_pair(pair, card.intervals);
    if (card.find(law.kind) != nullptr) pair.throw_error("kind", "this pair kind was given before");
    card.pairs.push_back(law);
  }
  root.finish();
  return card;
}

}  // namespace softgrain
