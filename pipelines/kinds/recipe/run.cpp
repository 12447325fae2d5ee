#include "pipelines/kinds/recipe/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/kinds/recipe/law.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/kinds/recipe/stages.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

/// Everything that a run of a recipe makes, step by step.
class RecipeRun {
 public:
  RecipeRun(RecipeScene scene, const Run& run) : scene_(std::move(scene)), run_(run) {}

  RecipeSummary finish() {
    for (const std::string& doubt : scene_.doubts) run_.context.say(doubt);
    VariantRuns measured_variants = run_variants(scene_.material, run_);
    results_ = std::move(measured_variants.results);
    MaterialOutcome measured = summarise(scene_.material, results_, run_);
    summary_.material = std::move(measured.summary);
    for (const std::string& raised : scene_.raised) head().remarks.push_back(raised);
    if (const GrainMaterials& materials = spec_.grain_materials; !materials.empty()) {
      summary_.material.youngs_modulus = scene_.youngs_modulus;
      head().remarks.push_back(materials_text(materials, scene_.youngs_modulus));
    }
    const bool complete = take_failures(measured_variants.failures);
    // Of dozens of packings the one that holds most of the curve.
    std::erase_if(head().sizes, [](const SizesSummary& sizes) { return !sizes.of.starts_with("check"); });
    describe();
    write_text_atomic(run_.path("material.csv"), as_csv(points_of(results_)));
    if (complete) run_.guard([&] { put_together(measured.states); });
    return std::move(summary_);
  }

 private:
  RecipeOutcome& out() { return summary_.recipe; }
  SummaryHead& head() { return summary_.material.head; }

  /// Whether all that the law needs was measured: it can do without its check, which is the last packing.
  bool take_failures(const std::vector<VariantFailure>& failures) {
    bool complete = true;
    bool check_failed = false;
    for (const VariantFailure& f : failures) {
      const bool check = scene_.checked && f.variant == &scene_.material.variants[*scene_.checked];
      head().mark_unusable(f.problem + (check ? " ([check] grains)" : " ([grains] count)"));
      complete = complete && check;
      check_failed = check_failed || check;
    }
    if (check_failed) drop_check();
    if (!complete)
      head().remarks.push_back(
          "no law: packings are missing; those that were measured are in material.csv and "
          "material_NAME.h5");
    return complete;
  }

  /// Its packing is the last variant: pointers to the others stay valid.
  void drop_check() {
    scene_.material.variants.pop_back();
    scene_.checked.reset();
    scene_.checked_levels = 0;
  }

  void describe() {
    const bool alike = spec_.grain_materials.empty();
    for (const Constituent& c : scene_.constituents) {
      ConstituentSummary s{c.name, c.mass_share, c.density, c.volume_share};
      if (!alike) {
        s.youngs_modulus = c.youngs_modulus;
        s.poisson_ratio = c.poisson_ratio;
        s.friction = c.friction;
      }
      out().constituents.push_back(std::move(s));
    }
    out().span = scene_.sizes.largest() / scene_.sizes.smallest();
  }

  void put_together(const std::optional<StateFit>& states) {
    if (!states || !states->usable) return head().mark_unusable("no law: the equation of state is not usable");
    LevelForms forms(scene_, *states);
    out().gap = forms.gap();
    out().rods_deviation = forms.rods_deviation();
    const double widen = check(forms, *states);
    add_levels(forms, widen);
    if (staged()) press_by_stages(*states, forms.joined_onset(0, scene_.levels.size(), widen).onset);
    law_ = whole_law(*states, widen, forms);
    write_material_card(scene_, law_, run_.path(kMaterialCardFile), run_.provenance);
    head().files["material_card"] = run_.path(kMaterialCardFile);
    out().onset = law_.onset;
    out().solid_fraction = solid_fraction_of(law_);
    out().compressible_model = compressible_model(scene_.sizes, forms.gap());
    count_grains();
    load(forms, *states, widen);
  }

  [[nodiscard]] bool staged() const { return spec_.test == MacroTest::stages; }

  /// Where all levels were packed together, what they did stands beside it.
  void press_by_stages(const StateFit& states, const Estimate& onset) {
    const bool whole = scene_.checked && scene_.checked_levels == scene_.levels.size();
    out().staged = whole_under_stages(paths_of(scene_, results_, states), onset,
                                      whole ? results_[*scene_.checked].curves : std::vector<MacroCurve>{});
    if (out().staged->points.empty())
      throw UnusableResult(
          "no packing came to the end of all stages; a lower stress, more max_passes ([test]) or more "
          "grains ([grains] count) may do");
    std::vector<NamedTangent> tangents;
    for (const RecipeStageSummary& s : out().staged->stages) {
      tangents.push_back({s.name, "first", s.tangent_begin.predicted.value});
      tangents.push_back({s.name, "last", s.tangent_end.predicted.value});
    }
    if (std::string text = negative_tangents_text(tangents); !text.empty()) head().warnings.push_back(std::move(text));
    write_text_atomic(run_.path("recipe_stages.csv"), as_csv(stages_table(*out().staged)));
    head().files["stages"] = run_.path("recipe_stages.csv");
  }

  /// The coarsest levels with all their grains, which say what form the rest leans to; what intervals are widened by.
  double check(LevelForms& forms, const StateFit& states) {
    if (!scene_.checked) return 0.0;
    const MaterialVariant& v = scene_.material.variants[*scene_.checked];
    const StateGroup* group = states.find(v.name);
    if (group == nullptr) return 0.0;
    RecipeCheckSummary c;
    c.levels = static_cast<std::int64_t>(scene_.checked_levels);
    c.grains = v.setup.spec.bodies;
    c.span = v.setup.spec.solid_polydispersity;
    c.measured = group->onset;
    c.predicted = forms.joined_onset(0, scene_.checked_levels);
    c.outside = std::max({0.0, c.predicted.onset.low - c.measured.value, c.measured.value - c.predicted.onset.high});
    if (c.outside > 0.0)
      head().remarks.push_back(fmt::format(
          "the check of {} levels lies {:.4f} outside the interval of its prediction: the interval of the whole is "
          "widened by as much at both ends",
          c.levels, c.outside));
    check_lateral_ratio(c);
    c.weighs = tells_ways(scene_);
    if (c.weighs)
      forms.lean(scene_.checked_levels, c.measured.value, c.measured.standard_error);
    else
      head().remarks.push_back(kTwoLevelsTellNothing);
    c.share_of_rods = forms.share_of_rods();
    out().check = c;
    return c.outside;
  }

  void check_lateral_ratio(RecipeCheckSummary& c) {
    const std::vector<double> samples = end_ratios(results_[*scene_.checked]);
    if (samples.empty()) return;
    c.lateral_ratio = {predicted_lateral_ratio(scene_, results_, scene_.checked_levels), mean_error(samples)};
    if (!c.lateral_ratio->inside())
      head().remarks.push_back(fmt::format("K0 of the check, {:.3f}, lies outside the interval of its prediction, {}",
                                           c.lateral_ratio->measured->mean, interval_text(c.lateral_ratio->predicted)));
  }

  void add_levels(const LevelForms& forms, double widen) {
    for (std::size_t k = 0; k < scene_.levels.size(); ++k) {
      const RecipeLevel& level = scene_.levels[k];
      RecipeLevelSummary s;
      s.level = static_cast<std::int64_t>(k) + 1;
      s.diameter_low = 2.0 * level.low;
      s.diameter_high = 2.0 * level.high;
      s.share = level.share;
      s.packing = scene_.material.variants[scene_.slice[k]].name;
      s.onset = forms.own_onset(k);
      s.with_finer = forms.joined_onset(k, scene_.levels.size() - k, widen);
      out().levels.push_back(s);
    }
    for (std::size_t k = 0; k + 1 < out().levels.size(); ++k) {
      const double fines = fines_over_coarse(scene_, k) / out().levels[k + 1].with_finer.onset.value;
      out().levels[k].filling = fines / (1.0 / out().levels[k].onset - 1.0);
    }
  }

  WholeLaw whole_law(const StateFit& states, double widen, const LevelForms& forms) {
    WholeLaw law;
    law.form = scene_.material.equation.form;
    law.modulus = states.modulus;
    law.exponent = states.exponent;
    law.onset = forms.joined_onset(0, scene_.levels.size(), widen).onset;
    law.shape = out().staged ? shape_of_stages(*out().staged) : shape_of(scene_, results_, states);
    law.start_pressure = scene_.material.variants.front().setup.spec.start_pressure;
    std::tie(law.pressure_low, law.pressure_high) = std::tuple_cat(pressure_range(results_));
    out().lateral_ratio = lateral_ratio(law.shape);
    return law;
  }

  /// What the law stands for, and what it would take to resolve it.
  void count_grains() {
    const double solid = out().solid_fraction->value;
    for (std::size_t k = 0; k < scene_.levels.size(); ++k) {
      const double volume = mean_grain_volume(scene_.levels[k].pieces);
      out().levels[k].grains = solid * scene_.levels[k].share / volume;
      out().grains_per_cubic_metre += out().levels[k].grains;
    }
    constexpr double kCoarse = 100.0;
    const double third = scene_.sizes.largest() / 3.0;
    double number = 0.0;
    for (const RecipeLevel& level : levels_of(scene_.sizes, {third}))
      if (level.low >= third * (1.0 - 1e-9)) number += level.share / mean_grain_volume(level.pieces);
    const double all = 1.0 / mean_grain_volume(scene_.sizes.pieces());
    out().resolved_grains = kCoarse * all / number;
    double grains = 0.0;
    double evaluations = 0.0;
    for (const VariantResult& r : results_)
      for (const MacroCurve& c : r.curves) {
        if (!r.variant->same_packings) grains += static_cast<double>(r.variant->setup.spec.bodies);
        evaluations += static_cast<double>(c.cost.contact_evaluations);
        if (!r.variant->same_packings) evaluations += static_cast<double>(c.preparation.contact_evaluations);
      }
    out().resolved_evaluations = evaluations / grains * out().resolved_grains;
  }

  /// So far that pores do not vanish.
  [[nodiscard]] double strain() const {
    if (scene_.macro.strain > 0.0) return scene_.macro.strain;
    if (staged()) return shape_of_stages(*summary_.recipe.staged).strain.front();  // at the highest stress
    return std::min(scene_.material.variants.front().setup.spec.strain_end,
                    0.5 * (1.0 - summary_.recipe.solid_fraction->value));
  }

  void load(const LevelForms& forms, const StateFit& states, double widen) {
    const double end = strain();
    out().curves.push_back(staged() ? curve_of_stages(*out().staged, scene_.youngs_modulus) : curve_of(law_, end, 16));
    if (scene_.checked && scene_.checked_levels == scene_.levels.size())
      out().curves.push_back(mean_curve("all grains", results_[*scene_.checked].curves));
    const MaterialLaw fitted = fit_coarsest(scene_, results_, states, run_.seed);
    summary_.law = fitted.summary;
    if (!fitted.problems.empty())
      head().warnings.push_back(no_cell_law_text(fitted.problems, staged(), scene_.shells.levels > 0));
    ShellLevels shells;
    if (scene_.shells.levels > 0) shells = measure_shells();
    if (fitted.problems.empty()) {
      const CellCard card =
          among_all_fines(scene_, fitted.card, forms.joined_onset(1, scene_.levels.size() - 1, widen));
      write_cell_card(card, run_.path(kCellLawFile), run_.provenance);
      summary_.law.of_pair = std::exchange(summary_.law.numbers, {});
      for (const CellCardNumber& n : numbers_of(card)) summary_.law.numbers.push_back({n.key, n.estimate});
      head().files["cell_law"] = run_.path(kCellLawFile);
      std::vector<MacroCurve> kept;
      out().curves.push_back(press_in_cells(scene_, card, end, run_, kept));
      if (!shells.table.entries.empty())
        out().curves.push_back(press_with_shells(scene_, card, shells.table, end, run_, kept));
      say_of(kept);
      if (!kept.empty()) {
        save_macro(kept, run_.path("recipe_macro.h5"), run_.provenance);
        head().files["macro"] = run_.path("recipe_macro.h5");
      }
    }
    add_moduli();
    judge(end);
    write_text_atomic(run_.path("recipe.csv"), as_csv(table()));
    head().files["curves"] = run_.path("recipe.csv");
  }

  /// What runs that can be used say of themselves, as pressures beyond those that their law was fitted to; what is
  /// wrong with others their curves say.
  void say_of(std::vector<MacroCurve> kept) {
    std::erase_if(kept, [](const MacroCurve& c) { return !c.usable; });
    for (std::string& note : run_notes(kept, "")) head().remarks.push_back(std::move(note));
    for (std::string& warning : run_warnings(kept, "")) head().warnings.push_back(std::move(warning));
  }

  /// Without what follows the highest stress: the loading that laws without unloading go through too.
  static void up_to_highest(RecipeCurve& c) {
    const auto points = static_cast<std::size_t>(std::ranges::max_element(c.axial) - c.axial.begin()) + 1;
    for (auto* column : {&c.strain, &c.axial, &c.lateral, &c.low, &c.high})
      if (column->size() > points) column->resize(points);
  }

  void add_moduli() {
    const double modulus = scene_.youngs_modulus;
    std::array<double, 2> interval = spec_.modulus_stress;
    if (staged()) interval = {out().staged->stages.front().stress_from, out().staged->stages.front().stress_to};
    std::vector<RecipeCurve> curves = out().curves;
    if (staged()) std::ranges::for_each(curves, up_to_highest);
    const auto [from, to] = set_moduli(curves, {interval[0] / modulus, interval[1] / modulus});
    for (std::size_t k = 0; k < curves.size(); ++k) out().curves[k].modulus = curves[k].modulus;
    for (const RecipeCurve& c : out().curves)
      if (!c.modulus && !c.axial.empty())
        head().remarks.push_back(
            fmt::format("{}: constrained modulus not determined: its axial stress does not go through {} and {} ({})",
                        c.name, pressure_text(from * modulus), pressure_text(to * modulus),
                        staged() ? "modulus_stress of the first stage" : "test.modulus_stress"));
  }

  ShellLevels measure_shells() {
    try {
      ShellLevels shells = run_shells(scene_, run_);
      out().shells = shells.levels;
      head().files["shell_law"] = run_.path("law_table.toml");
      for (const std::string& remark : shells.remarks) head().remarks.push_back(remark);
      if (!shells.usable) head().status = RunStatus::not_usable;
      return shells;
    } catch (const UnusableResult& e) {
      head().mark_unusable("no shell law: " + std::string(e.what()));
    } catch (const InputError& e) {  // a law that misses what the next level asks of it
      head().mark_unusable("no shell law: " + std::string(e.what()));
    }
    return {};
  }

  /// What a reader must not overlook.
  void judge(double end) {
    for (const RecipeCurve& c : out().curves)
      if (!c.problem.empty()) head().mark_unusable(c.name + ": " + c.problem);
    // With stages the cell law is beside the result, and a warning says why there is none.
    if (!staged() && (summary_.law.numbers.empty() || !summary_.law.usable)) head().status = RunStatus::not_usable;
    const RecipeCurve& whole = out().curves.front();
    const double p = (whole.axial.back() + 2.0 * whole.lateral.back()) / 3.0;
    if (!staged() && p > kHardlyBeyond * law_.pressure_high)
      head().remarks.push_back(
          fmt::format("at a strain of {:.3g} the pressure is {:.2g} E, above all that the equation "
                      "of state was fitted to ({:.2g} E): it is extrapolated there, without an interval",
                      end, p, law_.pressure_high));
  }

  static std::string end_of_band(const std::vector<double>& ends, std::size_t k, double unit) {
    return k < ends.size() && std::isfinite(ends[k]) ? fmt::format("{:.8g}", unit * ends[k]) : "";
  }

  [[nodiscard]] TextTable table() const {
    TextTable t{{"curve", "strain", "axial/E", "lateral/E", "axial_low/E", "axial_high/E"}, {}};
    if (staged()) t.header = {"curve", "strain", "axial [Pa]", "lateral [Pa]", "axial_low [Pa]", "axial_high [Pa]"};
    const double unit = staged() ? scene_.youngs_modulus : 1.0;
    for (const RecipeCurve& c : summary_.recipe.curves)
      for (std::size_t k = 0; k < c.strain.size(); ++k)
        t.rows.push_back({c.name, fmt::format("{:.6g}", c.strain[k]), fmt::format("{:.8g}", unit * c.axial[k]),
                          fmt::format("{:.8g}", unit * c.lateral[k]), end_of_band(c.low, k, unit),
                          end_of_band(c.high, k, unit)});
    return t;
  }

  RecipeScene scene_;
  /// Material and test of the whole.
  const MacroSpec spec_ = test_of_whole(scene_.material.variants.front().setup.spec, scene_.youngs_modulus);
  const Run& run_;
  std::vector<VariantResult> results_;
  WholeLaw law_;
  RecipeSummary summary_;
};

RunInputs inputs_of(const RecipeScene& recipe) {
  return {.seed = recipe.material.seed, .text = sizes_text(recipe.material)};
}

Outcome run_recipe(const RecipeScene& recipe, const Run& run) {
  const RecipeSummary summary = RecipeRun(recipe, run).finish();
  return {json_of(summary), console_summary(summary)};
}

/// As SceneKind::starter.
constexpr const char* kRecipeStarter = R"(title = "A small recipe"
seed = 1
[grains]
count = 150
ratio = 2.2
[levels]
ratio = 1.6
mixtures = [0.25, 0.5, 0.75]
[law]
cells = 40
shear_strain = 0.04
[packing]
preparation = "fast"
[test]
steps = 4
increments_per_step = 2
strain = 0.05
preload_steps = 1
[check]
grains = 300
[macro]
grains = 40
samples = 1
)";

}  // namespace

SceneKind recipe_kind() {
  return scene_kind(TypedKind<RecipeScene>{.name = "recipe",
                                           .command = "run",
                                           .read = read_recipe_scene,
                                           .inputs = inputs_of,
                                           .run = run_recipe,
                                           .check = check_recipe,
                                           .results = recipe_results(),
                                           .summary = members_of<RecipeSummary>,
                                           .keeps = {.measurements = true, .packings = true},
                                           .starter = kRecipeStarter});
}

}  // namespace softgrain
