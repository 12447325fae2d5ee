#include "pipelines/kinds/recipe/difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "calibrate/bootstrap.h"
#include "calibrate/rod_packing.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/random.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "pipelines/kinds/recipe/law.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/kinds/recipe/run.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kRecipeDifference{80};

/// Two recipes that errors cannot be paired of; says why.
struct NotPaired : InputError {
  using InputError::InputError;
};

/// One of both runs: scene, summary, and the curves of its packings by variant.
struct MixRun {
  RecipeScene scene;
  RecipeSummary summary;
  std::vector<VariantResult> results;

  [[nodiscard]] const MaterialVariant& variant(std::size_t v) const { return scene.material.variants[v]; }
};

/// The check may have failed without the rest: it is the last packing.
void drop_missing_check(MixRun& run, const std::set<std::string>& measured) {
  if (!run.scene.checked || measured.contains(run.variant(*run.scene.checked).name)) return;
  run.scene.material.variants.pop_back();
  run.scene.checked.reset();
  run.scene.checked_levels = 0;
}

MixRun load_mix(const report::RunData& data) {
  const auto any = data.summary_as<AnySummary>();
  if (!any.provenance || any.provenance->scene.empty()) throw NotPaired(data.directory + " does not hold its scene");
  MixRun out{read_recipe_scene(Scene::parse(any.provenance->scene, data.directory + "/summary.json")),
             data.summary_as<RecipeSummary>(),
             {}};
  if (!out.summary.recipe.onset) throw NotPaired(data.directory + " has no law");
  std::set<std::string> measured;
  for (const MaterialVariantSummary& v : out.summary.material.variants) measured.insert(v.name);
  drop_missing_check(out, measured);
  for (const MaterialVariant& v : out.scene.material.variants) {
    const auto& all = out.summary.material.variants;
    const auto at = std::ranges::find(all, v.name, &MaterialVariantSummary::name);
    if (at == all.end()) throw NotPaired(data.directory + " lacks the packing " + v.name);
    out.results.push_back({&v, at->file, load_macro(data.directory + "/" + at->file), nullptr});
  }
  return out;
}

/// Whether a key says what is mixed, and not how it is packed, tested and fitted.
bool is_of_the_mix(const std::string& key) {
  static const std::vector<std::string> mix{"constituent.",     "constituent[",        "grains.sizes",
                                            "grains.exponent",  "grains.ratio",        "grains.radius_max",
                                            "material.density", "levels.cut_diameters"};
  return std::ranges::any_of(mix, [&](const std::string& start) { return key.starts_with(start); });
}

void require_one_protocol(const std::vector<std::string>& keys) {
  std::string others;
  for (const std::string& key : keys)
    if (!is_of_the_mix(key)) append_part(others, key, ", ");
  if (!others.empty()) throw NotPaired("the runs differ in more than their mix (" + others + ")");
}

void require_alike(const MixRun& a, const MixRun& b) {
  if (a.scene.levels.size() != b.scene.levels.size())
    throw NotPaired(fmt::format("A has {} levels, B {}; the same [levels] cut_diameters for both make them alike",
                                a.scene.levels.size(), b.scene.levels.size()));
}

bool same_curves(const VariantResult& a, const VariantResult& b) {
  if (a.curves.size() != b.curves.size()) return false;
  for (std::size_t k = 0; k < a.curves.size(); ++k)
    if (a.curves[k].stress_axial != b.curves[k].stress_axial) return false;
  return true;
}

/// Variants of A and B in the same place of their recipes, each once.
std::vector<std::pair<std::size_t, std::size_t>> places_of(const RecipeScene& a, const RecipeScene& b) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  std::set<std::size_t> taken_a;
  std::set<std::size_t> taken_b;
  const auto add = [&](std::size_t va, std::size_t vb) {
    if (taken_a.contains(va) || taken_b.contains(vb)) return;
    taken_a.insert(va);
    taken_b.insert(vb);
    out.emplace_back(va, vb);
  };
  for (std::size_t k = 0; k < a.levels.size(); ++k) add(a.slice[k], b.slice[k]);
  for (std::size_t k = 0; k + 1 < a.levels.size(); ++k)
    for (std::size_t m = 0; m < a.mixtures.size(); ++m) add(a.mixed[k][m], b.mixed[k][m]);
  return out;
}

double root_mean(const std::vector<double>& squares) {
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return squares.empty() ? 0.0 : std::sqrt(std::max(0.0, sum) / static_cast<double>(squares.size()));
}

/// Onsets of the groups in a replicate, which are behind ln K and n.
std::vector<double> replicate_of(const StateFit& fit, std::size_t r) {
  return {fit.replicates[r].begin() + 2, fit.replicates[r].end()};
}

/// A number by both ways of joining levels, the estimate and the replicates.
struct ByBoth {
  double levels = kNaN;
  double rods = kNaN;
  std::vector<double> by_levels;
  std::vector<double> by_rods;
};

/// A number of one mix from its onset and K and n of the fit; `draw`: which replicate, kMeanDraw: the estimate.
using NumberOf = std::function<double(double onset, double modulus, double exponent, std::size_t draw)>;
constexpr auto kMeanDraw = static_cast<std::size_t>(-1);
double onset_itself(double onset, double /*modulus*/, double /*exponent*/, std::size_t /*draw*/) { return onset; }

/// Numbers of the stages that both have, with the errors of independent runs; nothing without [[stage]].
std::vector<PairedNumber> stage_numbers(const RecipeOutcome& a, const RecipeOutcome& b) {
  std::vector<PairedNumber> out;
  if (!a.staged || !b.staged) return out;
  const std::size_t stages = std::min(a.staged->stages.size(), b.staged->stages.size());
  for (std::size_t k = 0; k < stages; ++k) {
    const std::vector<StageQuantity> of_a = quantities_of(a.staged->stages[k]);
    const std::vector<StageQuantity> of_b = quantities_of(b.staged->stages[k]);
    for (std::size_t q = 0; q < of_a.size(); ++q)
      if (of_a[q].name == of_b[q].name && std::isfinite(of_a[q].value.value) && std::isfinite(of_b[q].value.value))
        out.push_back(unpaired_number(of_a[q].name, of_a[q].unit, of_a[q].value, of_b[q].value));
  }
  return out;
}

/// What both mixes come to by one fit.
class RecipePair {
 public:
  RecipePair(MixRun a, MixRun b) : a_(std::move(a)), b_(std::move(b)), places_(places_of(a_.scene, b_.scene)) {
    fit_jointly();
    find_pairs();
    share_all_residuals();
    forms_a_ = std::make_unique<LevelForms>(a_.scene, own_a_);
    forms_b_ = std::make_unique<LevelForms>(b_.scene, own_b_);
  }

  [[nodiscard]] PairedSummary summary() const;

 private:
  /// Packings in the same place of both recipes.
  struct Pair {
    std::size_t group_a;  ///< place among the groups of own_a_
    std::size_t group_b;
    bool same;  ///< one packing
    RodCurve rods_a;
    RodCurve rods_b;
    double moved;  ///< moved_share() of their sizes
  };

  [[nodiscard]] std::string group_a(std::size_t v) const { return "A " + a_.variant(v).name; }
  [[nodiscard]] std::string group_b(std::size_t v) const {
    const auto same = shared_.find(v);
    return same == shared_.end() ? "B " + b_.variant(v).name : group_a(same->second);
  }
  [[nodiscard]] StateForm form() const { return a_.scene.material.equation.form; }
  void fit_jointly();
  [[nodiscard]] StateFit side_of(const MixRun& run, bool of_a) const;
  void find_pairs();
  [[nodiscard]] double common_gap(const std::vector<double>& a, const std::vector<double>& b) const;
  void find_slope(const std::vector<double>& a, const std::vector<double>& b);
  [[nodiscard]] std::array<std::vector<double>, 2> residuals(const std::vector<double>& a,
                                                             const std::vector<double>& b) const;
  [[nodiscard]] std::vector<double> residual_slopes(const std::array<std::vector<double>, 2>& residual) const;
  void share_residuals(std::vector<double>& a, std::vector<double>& b, double change) const;
  void share_all_residuals();
  [[nodiscard]] ByBoth onsets(bool of_a, std::size_t first, std::size_t count) const;
  [[nodiscard]] ByBoth difference(const ByBoth& a, const ByBoth& b, const NumberOf& of_a, const NumberOf& of_b) const;
  [[nodiscard]] PairedNumber number(const std::string& name, const Estimate& a, const Estimate& b,
                                    const ByBoth& d) const;
  [[nodiscard]] double share_of_rods() const;
  [[nodiscard]] static std::vector<double> end_ratios(const MixRun& run);
  [[nodiscard]] PairedNumber ratio_difference() const;
  [[nodiscard]] std::array<double, 2> common_stresses(double start) const;
  [[nodiscard]] WholeLaw law_of(const MixRun& run, const StateFit& own) const;
  [[nodiscard]] NumberOf modulus_of_law(const WholeLaw& law, double strain, std::array<double, 2> stresses,
                                        double ratio_error) const;
  [[nodiscard]] std::optional<PairedNumber> modulus_difference(const ByBoth& a, const ByBoth& b,
                                                               double ratio_error) const;
  void add_loading(const RecipeOutcome& a, const RecipeOutcome& b, const ByBoth& of_a, const ByBoth& of_b,
                   PairedSummary& out) const;
  void add_check(std::vector<PairedNumber>& out) const;

  MixRun a_;
  MixRun b_;
  std::vector<std::pair<std::size_t, std::size_t>> places_;  ///< variants of A and B in the same place
  std::map<std::size_t, std::size_t> shared_;                ///< variants of B that are packings of A
  StateFit joint_;
  StateFit plain_a_;  ///< the joint fit for the packings of A
  StateFit plain_b_;
  StateFit own_a_;  ///< the same with shared residuals
  StateFit own_b_;
  std::vector<Pair> pairs_;  ///< by places_
  double slope_ = 0.0;
  double deviation_ = 0.0;  ///< root mean square of the residuals about rods
  std::unique_ptr<LevelForms> forms_a_;
  std::unique_ptr<LevelForms> forms_b_;
  std::vector<double> of_rods_;  ///< normal draws, one a replicate
  std::vector<double> of_ratio_;
};

StateFit RecipePair::side_of(const MixRun& run, bool of_a) const {
  StateFit out;
  out.usable = true;
  out.message = joint_.message;
  out.modulus = joint_.modulus;
  out.exponent = joint_.exponent;
  out.degrees = joint_.degrees;
  for (const std::vector<double>& r : joint_.replicates) out.replicates.push_back({r[0], r[1]});
  for (std::size_t v = 0; v < run.scene.material.variants.size(); ++v) {
    const StateGroup* group = joint_.find(of_a ? group_a(v) : group_b(v));
    if (group == nullptr) continue;
    out.groups.push_back(*group);
    out.groups.back().name = run.variant(v).name;
    const auto place = 2 + static_cast<std::size_t>(group - joint_.groups.data());
    for (std::size_t r = 0; r < out.replicates.size(); ++r) out.replicates[r].push_back(joint_.replicates[r][place]);
  }
  return out;
}

void RecipePair::fit_jointly() {
  for (const auto& [va, vb] : places_)
    if (a_.variant(va).setup.spec.solid_sizes == b_.variant(vb).setup.spec.solid_sizes &&
        same_curves(a_.results[va], b_.results[vb]))
      shared_[vb] = va;
  if (same_curves(a_.results[kSheared], b_.results[kSheared])) shared_[kSheared] = kSheared;
  std::vector<StateCurve> curves;
  const auto add = [&](const VariantResult& r, const std::string& group) {
    for (const MacroCurve& c : r.curves)
      if (takes_part(c)) curves.push_back(state_curve(c, group, r.variant->setup.spec.solid_polydispersity));
  };
  for (std::size_t v = 0; v < a_.results.size(); ++v) add(a_.results[v], group_a(v));
  for (std::size_t v = 0; v < b_.results.size(); ++v)
    if (!shared_.contains(v)) add(b_.results[v], group_b(v));
  joint_ = fit_equation_of_state(curves, {.form = form(),
                                          .replicates = static_cast<int>(a_.scene.material.equation.replicates),
                                          .seed = a_.scene.material.seed});
  if (!joint_.usable) throw NotPaired("no equation of state fits the packings of both: " + joint_.message);
  own_a_ = plain_a_ = side_of(a_, true);
  own_b_ = plain_b_ = side_of(b_, false);
}

/// Rods of all pairs of packings, and where their onsets are among the groups of both sides.
void RecipePair::find_pairs() {
  const auto place_in = [](const StateFit& fit, const std::string& name) {
    const StateGroup* group = fit.find(name);
    if (group == nullptr) throw NotPaired("the packing " + name + " bears at too few points");
    return static_cast<std::size_t>(group - fit.groups.data());
  };
  for (const auto& [va, vb] : places_) {
    const Grading& sizes_a = *a_.variant(va).setup.spec.solid_sizes;
    const Grading& sizes_b = *b_.variant(vb).setup.spec.solid_sizes;
    pairs_.push_back({place_in(own_a_, a_.variant(va).name), place_in(own_b_, b_.variant(vb).name),
                      shared_.contains(vb), RodCurve(sizes_a), RodCurve(sizes_b), moved_share(sizes_a, sizes_b)});
  }
}

/// One gap for the packings of both; onsets by groups of either side.
double RecipePair::common_gap(const std::vector<double>& a, const std::vector<double>& b) const {
  const auto error = [](const StateGroup& g) {
    const double e = g.onset.standard_error;
    return std::isfinite(e) && e > 0.0 ? e : 1.0;
  };
  std::vector<RodOnset> packings;
  for (const Pair& p : pairs_) {
    packings.push_back({&p.rods_a, a[p.group_a], error(own_a_.groups[p.group_a])});
    if (!p.same) packings.push_back({&p.rods_b, b[p.group_b], error(own_b_.groups[p.group_b])});
  }
  return fitted_gap(packings);
}

/// Shares the residuals of all pairs about the rods of one gap; `change`: of residuals, for all of the volume moved.
void RecipePair::share_residuals(std::vector<double>& a, std::vector<double>& b, double change) const {
  const double gap = common_gap(a, b);
  for (const Pair& p : pairs_) {
    const PackingPair shared =
        with_common_residual({a[p.group_a], b[p.group_b], p.rods_a.at(gap), p.rods_b.at(gap)}, change * p.moved);
    a[p.group_a] = shared.a;
    b[p.group_b] = shared.b;
  }
}

/// Onsets less those of rods of one gap, by variant of A and of B, before they are shared.
std::array<std::vector<double>, 2> RecipePair::residuals(const std::vector<double>& a,
                                                         const std::vector<double>& b) const {
  const double gap = common_gap(a, b);
  std::array<std::vector<double>, 2> out{std::vector<double>(a_.results.size(), 0.0),
                                         std::vector<double>(b_.results.size(), 0.0)};
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    out[0][places_[p].first] = a[pairs_[p].group_a] - pairs_[p].rods_a.at(gap);
    out[1][places_[p].second] = b[pairs_[p].group_b] - pairs_[p].rods_b.at(gap);
  }
  return out;
}

/// How residuals change from one mixture of two levels to the next, in units of the share of fines.
std::vector<double> RecipePair::residual_slopes(const std::array<std::vector<double>, 2>& residual) const {
  std::vector<double> out;
  for (std::size_t side = 0; side < 2; ++side) {
    const RecipeScene& scene = (side == 0 ? a_ : b_).scene;
    for (std::size_t k = 0; k + 1 < scene.levels.size(); ++k) {
      std::vector<std::pair<double, double>> points{{0.0, residual[side][scene.slice[k]]}};
      for (std::size_t m = 0; m < scene.mixtures.size(); ++m)
        points.emplace_back(scene.mixtures[m], residual[side][scene.mixed[k][m]]);
      points.emplace_back(1.0, residual[side][scene.slice[k + 1]]);
      for (std::size_t p = 1; p < points.size(); ++p)
        out.push_back((points[p].second - points[p - 1].second) / (points[p].first - points[p - 1].first));
    }
  }
  return out;
}

/// Root mean square of these slopes without the scatter of packings, and of the residuals.
void RecipePair::find_slope(const std::vector<double>& a, const std::vector<double>& b) {
  const auto residual = residuals(a, b);
  std::vector<double> squares;
  for (const auto& [va, vb] : places_) {
    squares.push_back(residual[0][va] * residual[0][va]);
    squares.push_back(residual[1][vb] * residual[1][vb]);
  }
  deviation_ = root_mean(squares);
  const std::vector<double> slopes = residual_slopes(residual);
  std::vector<Tally> scatter(slopes.size());
  for (std::size_t r = 0; r < joint_.replicates.size(); ++r) {
    const std::vector<double> drawn = residual_slopes(residuals(replicate_of(own_a_, r), replicate_of(own_b_, r)));
    for (std::size_t k = 0; k < drawn.size(); ++k) scatter[k].add(drawn[k]);
  }
  squares.clear();
  for (std::size_t k = 0; k < slopes.size(); ++k)
    squares.push_back(slopes[k] * slopes[k] - std::pow(scatter[k].statistics().deviation_or_zero(), 2));
  slope_ = root_mean(squares);
}

void RecipePair::share_all_residuals() {
  const auto onsets = [](const StateFit& fit) {
    std::vector<double> out;
    for (const StateGroup& g : fit.groups) out.push_back(g.onset.value);
    return out;
  };
  std::vector<double> a = onsets(own_a_);
  std::vector<double> b = onsets(own_b_);
  find_slope(a, b);
  share_residuals(a, b, 0.0);
  for (std::size_t g = 0; g < a.size(); ++g) own_a_.groups[g].onset.value = a[g];
  for (std::size_t g = 0; g < b.size(); ++g) own_b_.groups[g].onset.value = b[g];
  for (std::size_t r = 0; r < joint_.replicates.size(); ++r) {
    RandomStream random(a_.scene.material.seed, kRecipeDifference, r);
    a = replicate_of(own_a_, r);
    b = replicate_of(own_b_, r);
    share_residuals(a, b, slope_ * random.normal());
    std::copy(a.begin(), a.end(), own_a_.replicates[r].begin() + 2);
    std::copy(b.begin(), b.end(), own_b_.replicates[r].begin() + 2);
    of_rods_.push_back(random.normal());
    of_ratio_.push_back(random.normal());
  }
}

/// Of levels from `first` on: A - B, and what the rods may be off by for one mix more than for the other.
ByBoth RecipePair::onsets(bool of_a, std::size_t first, std::size_t count) const {
  FormReplicates f = (of_a ? forms_a_ : forms_b_)->by_both_forms(first, count);
  if (!of_a && count > 1) {
    const double moved = moved_share(joined(a_.scene.levels, first, count), joined(b_.scene.levels, first, count));
    const double change = std::min(slope_ * moved, std::sqrt(2.0) * deviation_);
    for (std::size_t r = 0; r < f.by_rods.size(); ++r) f.by_rods[r] += change * of_rods_[r];
  }
  return {f.levels, f.rods, std::move(f.by_levels), std::move(f.by_rods)};
}

ByBoth RecipePair::difference(const ByBoth& a, const ByBoth& b, const NumberOf& of_a, const NumberOf& of_b) const {
  ByBoth out;
  const double k = joint_.modulus.value;
  const double n = joint_.exponent.value;
  out.levels = of_a(a.levels, k, n, kMeanDraw) - of_b(b.levels, k, n, kMeanDraw);
  out.rods = of_a(a.rods, k, n, kMeanDraw) - of_b(b.rods, k, n, kMeanDraw);
  for (std::size_t r = 0; r < joint_.replicates.size(); ++r) {
    const double drawn_k = std::exp(joint_.replicates[r][0]);
    const double drawn_n = joint_.replicates[r][1];
    out.by_levels.push_back(of_a(a.by_levels[r], drawn_k, drawn_n, r) - of_b(b.by_levels[r], drawn_k, drawn_n, r));
    out.by_rods.push_back(of_a(a.by_rods[r], drawn_k, drawn_n, r) - of_b(b.by_rods[r], drawn_k, drawn_n, r));
  }
  return out;
}

PairedNumber RecipePair::number(const std::string& name, const Estimate& a, const Estimate& b, const ByBoth& d) const {
  PairedNumber out = unpaired_number(name, "", a, b);
  out.pairs = static_cast<std::int64_t>(pairs_.size());
  out.difference = d.levels + share_of_rods() * (d.rods - d.levels);
  out.low = -kInfinity;
  out.high = kInfinity;
  out.error = kInfinity;
  if (joint_.degrees < 1) return out;
  const double students = student_over_normal(joint_.degrees);
  const auto interval = [&](double value, std::vector<double> replicates) {
    std::erase_if(replicates, [](double x) { return !std::isfinite(x); });
    const auto [low, high] = interval95(replicates);
    return widened(value, low, high, students, false);
  };
  const auto [levels_low, levels_high] = interval(d.levels, d.by_levels);
  const auto [rods_low, rods_high] = interval(d.rods, d.by_rods);
  // As with one recipe: both ways are inside, and with them the value.
  out.low = std::min({levels_low, rods_low, d.levels, d.rods});
  out.high = std::max({levels_high, rods_high, d.levels, d.rods});
  out.error = 0.5 * (out.high - out.low) / kNormal95;
  return out;
}

double RecipePair::share_of_rods() const {
  const auto of = [](const MixRun& run) {
    return run.summary.recipe.check ? run.summary.recipe.check->share_of_rods : 0.5;
  };
  return 0.5 * (of(a_) + of(b_));
}

/// Lateral over axial stress at the end of the test, of the usable samples of the packing that stands for the whole.
std::vector<double> RecipePair::end_ratios(const MixRun& run) {
  std::vector<double> out;
  for (const MacroCurve& c : run.results[lateral_packing(run.scene)].curves)
    if (c.usable && !c.stress_axial.empty() && c.stress_axial.back() > 0.0)
      out.push_back(c.stress_lateral.back() / c.stress_axial.back());
  return out;
}

PairedNumber RecipePair::ratio_difference() const {
  const Estimate& a = a_.summary.recipe.lateral_ratio;
  const Estimate& b = b_.summary.recipe.lateral_ratio;
  PairedNumber out = unpaired_number("lateral over axial stress at the end (K0)", "", a, b);
  const std::vector<double> of_a = end_ratios(a_);
  const std::vector<double> of_b = end_ratios(b_);
  if (of_a.size() < 2 || of_b.size() < 2) return out;
  const Estimate d = of_a == of_b ? Estimate{0.0, 0.0, 0.0, 0.0} : difference_of_means(of_a, of_b);
  out.error = d.standard_error;
  out.low = out.difference + (d.low - d.value);
  out.high = out.difference + (d.high - d.value);
  return out;
}

/// Axial stresses over E between which both moduli are.
std::array<double, 2> RecipePair::common_stresses(double start) const {
  const MacroSpec& spec = a_.variant(0).setup.spec;
  if (spec.modulus_stress[1] > 0.0)
    return {spec.modulus_stress[0] / spec.youngs_modulus, spec.modulus_stress[1] / spec.youngs_modulus};
  double to = kInfinity;
  for (const MixRun* run : {&a_, &b_})
    if (const auto& m = run->summary.recipe.curves.front().modulus) to = std::min(to, m->to);
  return {std::max(start, 0.5 * to), to};
}

WholeLaw RecipePair::law_of(const MixRun& run, const StateFit& own) const {
  WholeLaw law;
  law.form = form();
  law.shape = shape_of(run.scene, run.results, own);
  law.start_pressure = run.variant(0).setup.spec.start_pressure;
  return law;
}

NumberOf RecipePair::modulus_of_law(const WholeLaw& law, double strain, std::array<double, 2> stresses,
                                    double ratio_error) const {
  return [=, this](double onset, double k, double n, std::size_t draw) {
    WholeLaw drawn = law;
    drawn.modulus.value = k;
    drawn.exponent.value = n;
    drawn.onset = {onset, kInfinity, -kInfinity, kInfinity};
    if (draw != kMeanDraw)
      for (double& ratio : drawn.shape.ratio) ratio = std::max(0.0, ratio + ratio_error * of_ratio_[draw]);
    constexpr std::int64_t kSteps = 16;
    std::vector<RecipeCurve> curve{curve_of(drawn, strain, kSteps)};
    (void)set_moduli(curve, stresses);
    return curve.front().modulus ? curve.front().modulus->value : kNaN;
  };
}

/// A modulus with the relative error that its run gave it between its own stresses.
Estimate with_relative_error(double value, const RecipeCurve& curve) {
  if (!curve.modulus || !std::isfinite(curve.modulus->low)) return {value, kNaN, kNaN, kNaN};
  const SecantModulus& m = *curve.modulus;
  return {value, value / m.value * 0.5 * (m.high - m.low) / kNormal95, value / m.value * m.low,
          value / m.value * m.high};
}

std::optional<PairedNumber> RecipePair::modulus_difference(const ByBoth& a, const ByBoth& b, double ratio_error) const {
  const RecipeCurve& curve_a = a_.summary.recipe.curves.front();
  const RecipeCurve& curve_b = b_.summary.recipe.curves.front();
  if (curve_a.axial.empty() || curve_b.axial.empty()) return std::nullopt;
  WholeLaw law_a = law_of(a_, plain_a_);
  WholeLaw law_b = law_of(b_, plain_b_);
  if (law_a.shape.strain != law_b.shape.strain) return std::nullopt;
  for (std::size_t k = 0; k < law_a.shape.strain.size(); ++k)
    law_a.shape.factor[k] = law_b.shape.factor[k] = 0.5 * (law_a.shape.factor[k] + law_b.shape.factor[k]);
  const auto stresses = common_stresses(std::max(curve_a.axial.front(), curve_b.axial.front()));
  const NumberOf of_a = modulus_of_law(law_a, curve_a.strain.back(), stresses, 0.0);
  const NumberOf of_b = modulus_of_law(law_b, curve_b.strain.back(), stresses, ratio_error);
  const ByBoth d = difference(a, b, of_a, of_b);
  const double t = share_of_rods();
  const double k = joint_.modulus.value;
  const double n = joint_.exponent.value;
  const double at_a = of_a(a.levels + t * (a.rods - a.levels), k, n, kMeanDraw);
  const double at_b = of_b(b.levels + t * (b.rods - b.levels), k, n, kMeanDraw);
  if (!std::isfinite(at_a) || !std::isfinite(at_b) || !std::isfinite(d.levels) || !std::isfinite(d.rods))
    return std::nullopt;
  return number(
      fmt::format("constrained modulus over E, material law, from {:.3g} to {:.3g} E", stresses[0], stresses[1]),
      with_relative_error(at_a, curve_a), with_relative_error(at_b, curve_b), d);
}

/// Check and prediction of the check, where both resolved as many levels.
void RecipePair::add_check(std::vector<PairedNumber>& out) const {
  const auto& a = a_.summary.recipe.check;
  const auto& b = b_.summary.recipe.check;
  if (!a || !b || !a_.scene.checked || !b_.scene.checked || a_.scene.checked_levels != b_.scene.checked_levels) return;
  out.push_back(unpaired_number(fmt::format("onset of the {} coarsest levels, all grains", a->levels), "", a->measured,
                                b->measured));
  const ByBoth of_a = onsets(true, 0, a_.scene.checked_levels);
  const ByBoth of_b = onsets(false, 0, b_.scene.checked_levels);
  out.push_back(number(fmt::format("onset of the {} coarsest levels, predicted", a->levels), a->predicted.onset,
                       b->predicted.onset, difference(of_a, of_b, onset_itself, onset_itself)));
}

/// Modulus and K0: of stages as of independent runs, since their curves are those of packings and not of one fit.
void RecipePair::add_loading(const RecipeOutcome& a, const RecipeOutcome& b, const ByBoth& of_a, const ByBoth& of_b,
                             PairedSummary& out) const {
  if (a.staged || b.staged) {
    for (PairedNumber& n : stage_numbers(a, b)) out.numbers.push_back(std::move(n));
    out.method += "; numbers of stages have the errors of independent runs";
    return;
  }
  const PairedNumber ratio = ratio_difference();
  if (auto modulus = modulus_difference(of_a, of_b, std::isfinite(ratio.error) ? ratio.error : 0.0))
    out.numbers.push_back(*modulus);
  out.numbers.push_back(ratio);
}

PairedSummary RecipePair::summary() const {
  const RecipeOutcome& a = a_.summary.recipe;
  const RecipeOutcome& b = b_.summary.recipe;
  const std::size_t levels = a_.scene.levels.size();
  const ByBoth of_a = onsets(true, 0, levels);
  const ByBoth of_b = onsets(false, 0, levels);
  const double p = a_.variant(0).setup.spec.start_pressure;
  const NumberOf fraction = [&](double onset, double k, double n, std::size_t) {
    return state_phi(form(), k, n, onset, p);
  };
  PairedSummary out;
  out.paired = true;
  const std::size_t same = shared_.size() - shared_.count(kSheared);
  out.method = fmt::format(
      "{} of {} packings are the same in both{}; {:.3g} % of the solid volume have another size; differences "
      "are by one fit to the packings of both, so they are not quite those of the values",
      same, pairs_.size(), same < pairs_.size() ? ", what others lie off their rods is shared" : "",
      100.0 * moved_share(joined(a_.scene.levels, 0, levels), joined(b_.scene.levels, 0, levels)));
  out.numbers.push_back(number("solid fraction at the start", *a.solid_fraction, *b.solid_fraction,
                               difference(of_a, of_b, fraction, fraction)));
  add_loading(a, b, of_a, of_b, out);
  out.numbers.push_back(
      number("onset of the whole", *a.onset, *b.onset, difference(of_a, of_b, onset_itself, onset_itself)));
  for (std::size_t k = 1; k < levels; ++k)
    out.numbers.push_back(
        number(k + 1 == levels ? fmt::format("onset of level {} alone", k + 1)
                               : fmt::format("onset of levels {} to {}", k + 1, levels),
               a.levels[k].with_finer.onset, b.levels[k].with_finer.onset,
               difference(onsets(true, k, levels - k), onsets(false, k, levels - k), onset_itself, onset_itself)));
  add_check(out.numbers);
  return out;
}

/// What the summaries say, as of independent runs.
PairedSummary independent_summary(const RecipeOutcome& a, const RecipeOutcome& b, const std::string& reason) {
  PairedSummary out;
  out.reason = reason;
  if (a.solid_fraction && b.solid_fraction)
    out.numbers.push_back(unpaired_number("solid fraction at the start", "", *a.solid_fraction, *b.solid_fraction));
  for (PairedNumber& n : stage_numbers(a, b)) out.numbers.push_back(std::move(n));
  const bool staged = a.staged || b.staged;
  const auto modulus = [&](const RecipeOutcome& r) -> const SecantModulus* {
    return staged || r.curves.empty() || !r.curves.front().modulus ? nullptr : &*r.curves.front().modulus;
  };
  if (modulus(a) != nullptr && modulus(b) != nullptr)
    out.numbers.push_back(unpaired_number("constrained modulus over E, material law, each between its own stresses", "",
                                          with_relative_error(modulus(a)->value, a.curves.front()),
                                          with_relative_error(modulus(b)->value, b.curves.front())));
  if (a.onset && b.onset && !staged)
    out.numbers.push_back(
        unpaired_number("lateral over axial stress at the end (K0)", "", a.lateral_ratio, b.lateral_ratio));
  if (a.onset && b.onset) out.numbers.push_back(unpaired_number("onset of the whole", "", *a.onset, *b.onset));
  return out;
}

}  // namespace

double moved_share(const Grading& a, const Grading& b) {
  constexpr int kBins = 4000;
  const double low = 0.999 * std::min(a.smallest(), b.smallest());
  const double high = 1.001 * std::max(a.largest(), b.largest());
  double sum = 0.0;
  double before = 0.0;
  for (int k = 1; k <= kBins; ++k) {
    const double r = low * std::pow(high / low, static_cast<double>(k) / kBins);
    const double ahead = a.passing(r) - b.passing(r);
    sum += std::abs(ahead - before);
    before = ahead;
  }
  return 0.5 * sum;
}

PackingPair with_common_residual(PackingPair pair, double change) {
  const double residual = 0.5 * (pair.a - pair.rods_a + pair.b - pair.rods_b);
  pair.a = pair.rods_a + residual + 0.5 * change;
  pair.b = pair.rods_b + residual - 0.5 * change;
  return pair;
}

PairedSummary recipe_differences(const report::RunData& a, const report::RunData& b,
                                 const std::vector<std::string>& keys) {
  std::string reason;
  try {
    require_one_protocol(keys);
    MixRun run_a = load_mix(a);
    MixRun run_b = load_mix(b);
    require_alike(run_a, run_b);
    return RecipePair(std::move(run_a), std::move(run_b)).summary();
  } catch (const InputError& e) {
    reason = e.what();
  } catch (const UnusableResult& e) {
    reason = e.what();
  } catch (const IoError& e) {  // runs that were kept without the files of their packings
    reason = e.what();
  }
  return independent_summary(a.summary_as<RecipeSummary>().recipe, b.summary_as<RecipeSummary>().recipe, reason);
}

}  // namespace softgrain
