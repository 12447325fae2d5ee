// Models of a material: what needs no run, against closed forms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <tuple>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/particles.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/material_models/models.h"
#include "pipelines/kinds/material_models/scene.h"
#include "pipelines/kinds/material_models/summary.h"

namespace softgrain {
namespace {

CellCard card_of(StateForm form) {
  CellCard card;
  card.form = form;
  card.modulus.value = 0.05;
  card.exponent.value = 2.0;
  card.void_ratio.value = 0.6;
  card.excess_alone.value = 0.62;
  card.excess_many.value = 0.3;
  card.excess_decay.value = 0.35;
  card.lateral_ratio.value = 0.5;
  return card;
}

/// A curve of a mixture that jams at `onset` and follows the law of the card exactly, oedometric.
MacroCurve exact(const CellCard& card, double start, double onset) {
  MacroCurve c;
  c.start.youngs_modulus = 1e6;
  for (const double e : {0.0, 0.02, 0.05}) {
    const double phi = start / (1.0 - e);
    const double x = card.form == StateForm::porosity ? (phi - onset) / (1.0 - onset)
                                                      : 1.0 - (1.0 / phi - 1.0) / (1.0 / onset - 1.0);
    const double p = 1e6 * card.modulus.value * x * x;
    c.strain.push_back(e);
    c.strain_z.push_back(e);
    c.strain_x.push_back(0.0);
    c.strain_y.push_back(0.0);
    const bool alike = e == 0.0;
    c.stress_axial.push_back(alike ? p : 1.5 * p);
    for (auto* column : {&c.stress_lateral, &c.stress_x, &c.stress_y}) column->push_back(alike ? p : 0.75 * p);
    c.more[kSolidFraction].push_back(phi);
  }
  return c;
}

class MeanFields : public testing::TestWithParam<StateForm> {};

TEST_P(MeanFields, GiveBackWhatFollowsTheirLaw) {
  const CellCard card = card_of(GetParam());
  const MacroCurve truth = exact(card, 0.66, 0.64);
  const double start = (truth.stress_axial[0] + 2.0 * truth.stress_x[0]) / 3e6;
  const MacroCurve by_pressure = mean_field(card, truth, start, kNaN);
  const MacroCurve by_density = mean_field(card, truth, kNaN, 0.64);
  const MacroCurve off = mean_field(card, truth, kNaN, 0.645);
  for (std::size_t k = 0; k < truth.strain.size(); ++k) {
    EXPECT_NEAR(by_pressure.stress_axial[k] / truth.stress_axial[k], 1.0, 1e-9) << k;
    EXPECT_NEAR(by_density.stress_lateral[k] / truth.stress_lateral[k], 1.0, 1e-9) << k;
    EXPECT_LT(off.stress_axial[k], 0.95 * truth.stress_axial[k]) << k;
  }
}

/// A substitute of another onset, from the same start pressure: mapped, it is the truth.
TEST_P(MeanFields, MapStandInsOntoTheTruth) {
  const CellCard card = card_of(GetParam());
  const MacroCurve truth = exact(card, 0.66, 0.64);
  const double start = (truth.stress_axial[0] + 2.0 * truth.stress_x[0]) / 3e6;
  const double x = std::sqrt(start / 0.05);
  const double onset = 0.6;
  const double phi =
      GetParam() == StateForm::porosity ? onset + x * (1.0 - onset) : 1.0 / (1.0 + (1.0 / onset - 1.0) * (1.0 - x));
  MacroCurve other = exact(card, phi, onset);
  other.stress_axial_contacts = other.stress_axial;
  EXPECT_GT(std::abs(other.stress_axial[2] / truth.stress_axial[2] - 1.0), 0.05);
  map_by_state(card, truth, start, other);
  for (std::size_t k = 0; k < truth.strain.size(); ++k)
    EXPECT_NEAR(other.stress_axial[k] / truth.stress_axial[k], 1.0, 1e-9) << k;
  EXPECT_EQ(other.stress_axial_contacts, other.stress_axial);
}
INSTANTIATE_TEST_SUITE_P(Forms, MeanFields, testing::Values(StateForm::porosity, StateForm::pores));

TEST(MaterialModels, TheOnsetOfTheCardIsThatOfItsPores) {
  const CellCard card = card_of(StateForm::porosity);
  EXPECT_NEAR(onset_by_card(card, 1.0), 1.0 / 1.6, 1e-12);   // fines alone
  EXPECT_NEAR(onset_by_card(card, 1e-9), 1.0 / 1.62, 1e-6);  // coarse grains alone
  const double ratio = 0.4 / 0.6;
  const double pores = 0.6 * 0.4 + 0.6 * (0.3 + 0.32 * std::exp(-ratio / 0.35));
  EXPECT_NEAR(onset_by_card(card, 0.4), 1.0 / (1.0 + pores), 1e-12);
}

/// A factor of a preparation is one on all pores; without one the card's preparation stands for that of the material.
TEST(MaterialModels, TheOnsetOfAnotherPreparationHasItsFactorOnAllPores) {
  CellCard card = card_of(StateForm::porosity);
  card.preparation = "fast";
  card.preparations = {{"slow", {0.975, 0.003, 0.96, 0.99}}};
  for (const double share : {0.1, 0.4, 1.0}) {
    const double pores = 1.0 / onset_by_card(card, share) - 1.0;
    EXPECT_NEAR(1.0 / onset_by_card(card, share, "slow") - 1.0, 0.975 * pores, 1e-12) << share;
    EXPECT_EQ(onset_by_card(card, share, "fast"), onset_by_card(card, share)) << share;
  }
  EXPECT_THROW((void)onset_by_card(card, 0.4, "dense"), InputError);
  MacroSpec spec;
  MaterialModel model{.name = "m", .kind = ModelKind::cells};
  for (const auto& [preparation, known, words] :
       {std::tuple{Preparation::fast, "fast", ""},
        {Preparation::slow, "slow", "these are 'slow' (void ratios times 0.975)"},
        {Preparation::dense, "", "these are 'dense'"}}) {
    spec.preparation = preparation;
    EXPECT_EQ(known_preparation(card, spec), known);
    model.card = card;
    model.card->fines_ratio = 0.0;
    EXPECT_NE(other_fines(model, spec).find(words), std::string::npos) << other_fines(model, spec);
  }
  model.kind = ModelKind::substitute;
  spec.preparation = Preparation::slow;
  EXPECT_EQ(other_fines(model, spec).find("void ratios"), std::string::npos) << "it starts from the pressure";
}

/// Nothing of what the packing answered passes for an answer of the card.
TEST(MaterialModels, MeanFieldsHoldNothingOfTheTruth) {
  const CellCard card = card_of(StateForm::porosity);
  MacroCurve truth = exact(card, 0.66, 0.64);
  truth.stage.assign(3, 0.0);
  for (auto* column : {&truth.stress_deviator, &truth.stress_axial_contacts, &truth.coordination, &truth.fabric,
                       &truth.residual, &truth.coordination_bodies, &truth.fabric_bodies})
    column->assign(3, 7.0);
  truth.body_forces = {7.0};
  truth.preparation.seconds = 7.0;
  truth.grains = 7;
  const MacroCurve c = mean_field(card, truth, kNaN, 0.645);
  EXPECT_EQ(c.strain, truth.strain);
  EXPECT_EQ(c.stage, truth.stage);
  for (const auto* column : {&c.fabric, &c.coordination_bodies, &c.fabric_bodies, &c.body_forces})
    EXPECT_TRUE(column->empty());
  for (const auto* column : {&c.coordination, &c.residual}) EXPECT_EQ(*column, std::vector<double>(3, 0.0));
  EXPECT_EQ(c.stress_axial_contacts, c.stress_axial);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(c.stress_deviator[k], c.stress_axial[k] - c.stress_x[k]) << k;
  EXPECT_EQ(c.preparation.seconds, 0.0);
  EXPECT_EQ(c.grains, 0);
}

/// Where cells part the grains, not where the card was measured.
TEST(MaterialModels, FinesAreThoseBelowTheSplitOfTheModel) {
  MacroSpec spec;
  spec.solid_radius_max = 0.016;
  spec.solid_polydispersity = 6.0;
  MaterialModel model{.name = "m", .kind = ModelKind::cells, .split = 0.6};
  model.card = card_of(StateForm::porosity);
  model.card->split = 1.0 / 3.0;
  model.card->fines_ratio = 2.0;
  model.card->preparation = to_string(spec.preparation);
  EXPECT_NE(other_fines(model, spec).find("ratio 2, these have 3.6"), std::string::npos) << other_fines(model, spec);
  model.split = 1.0 / 3.0;
  EXPECT_EQ(other_fines(model, spec), "");
  model.kind = ModelKind::mean_field;
  model.split = 0.6;
  EXPECT_EQ(other_fines(model, spec), "") << "a mean field has no split of its own";
  take_sizes(spec, Grading::classes({{0.008, 0.016, 3.5, 0.6}, {0.002, 0.004, 3.5, 0.4}}));
  model.kind = ModelKind::cells;
  model.split = 0.45;
  EXPECT_EQ(other_fines(model, spec), "") << "between a quarter and a half of the largest there is nothing";
}

TEST(MaterialModels, DrawnSizesHaveTheExponentOfTheMaterialOrSayWhich) {
  MacroSpec spec;
  take_sizes(spec, Grading::power_law(2.0, 0.004, 0.016));
  MaterialModel model{.name = "m", .kind = ModelKind::substitute};
  EXPECT_EQ(exponent_of(spec), 2.0);
  EXPECT_EQ(assumed_exponent(model, spec), "");
  take_sizes(spec, Grading::fuller(0.5, 0.004, 0.016));
  EXPECT_EQ(exponent_of(spec), 3.5);
  EXPECT_EQ(assumed_exponent(model, spec), "");
  take_sizes(spec, Grading::sieve_curve({0.004, 0.008, 0.016}, {0.0, 0.3, 1.0}));
  for (const auto& [kind, what] : {std::pair{ModelKind::substitute, "fines"}, {ModelKind::shells, "shells"}}) {
    model.kind = kind;
    EXPECT_NE(assumed_exponent(model, spec).find(std::string(what) + " are drawn from r^-3.5"), std::string::npos);
  }
  model.kind = ModelKind::cells;
  EXPECT_EQ(assumed_exponent(model, spec), "");
  model.soft_share = 0.1;
  EXPECT_NE(assumed_exponent(model, spec), "");
}

TEST(MaterialModels, GrainsArePartedByTheirRadius) {
  MacroPacking packing;
  for (const double r : {3.0, 2.0, 1.0, 0.5}) packing.bodies.push_back({{}, r, false});
  const CoarseAndFine parts = parted(packing, 2.0);
  EXPECT_EQ(parts.coarse.size(), 2U);
  EXPECT_NEAR(parts.coarse_volume, kSphereVolume * 35.0, 1e-9);
  EXPECT_NEAR(parts.share(), 1.125 / 36.125, 1e-12);
}

TEST(MaterialModels, TheirErrorIsRelativeToTheTruth) {
  EXPECT_NEAR(relative_difference({9.0, 1.1, 2.2}, {1.0, 1.0, 2.0}, 1), 0.1, 1e-12);
  EXPECT_NEAR(relative_difference({1.0, 3.0}, {1.0, 4.0, 7.0}, 0), std::sqrt(1.0 / 17.0), 1e-12);
  EXPECT_TRUE(std::isnan(relative_difference({1.0}, {1.0}, 1)));
}

/// A sample that either did not come through has no part in errors or costs.
TEST(MaterialModels, ErrorsAndCostsAreOfTheSameSamples) {
  const CellCard card = card_of(StateForm::porosity);
  const auto sample = [&](double stress, double seconds, std::int64_t evaluations, bool usable) {
    MacroCurve c = exact(card, 0.66, 0.64);
    for (double& s : c.stress_axial) s *= stress;
    c.stages = {StageRecord{}};
    c.stage.assign(c.strain.size(), 0.0);
    c.usable = usable;
    c.note = usable ? "" : "broke off";
    c.cost.seconds = seconds;
    c.cost.contact_evaluations = evaluations;
    c.preparation.seconds = 3.0 * seconds;
    return c;
  };
  const MaterialVariant variant{"v", {}};
  const MaterialModel model{.name = "m"};
  VariantResult truth{&variant, "", {}, nullptr};
  truth.curves = {sample(1.0, 8.0, 600, true), sample(1.0, 100.0, 9999, true), sample(1.0, 70.0, 7777, false)};
  ModelRun run{&model, &truth, {}, "", ""};
  run.curves = {sample(1.1, 2.0, 30, true), sample(3.0, 50.0, 1, false), sample(5.0, 9.0, 5, true)};
  const ModelScore s = score(run, false);
  EXPECT_EQ(s.samples, 1);
  EXPECT_NEAR(s.axial, 0.1, 1e-12);
  EXPECT_NEAR(s.axial_at_end, 0.1, 1e-12);
  EXPECT_EQ(s.evaluations, 20.0);
  EXPECT_EQ(s.seconds, 4.0);
  EXPECT_EQ(s.seconds_all, 4.0);
  EXPECT_EQ(s.remark, "sample 1 left out: broke off");
  const TextTable table = table_of({s});
  EXPECT_EQ(table.header.back(), "remark");
  EXPECT_EQ(table.rows.front().back(), s.remark);
}

/// 2 % isotropic, then a triaxial stage whose q/p at the k-th per cent of its own strain is k times `ratio`.
MacroCurve preloaded_triaxial(double ratio, double lateral_strain) {
  MacroCurve c;
  c.stages = {StageRecord{.name = "load", .kind = StageKind::isotropic, .way = StageKind::isotropic},
              StageRecord{.name = "shear", .kind = StageKind::triaxial, .way = StageKind::triaxial}};
  for (const double e : {0.0, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09}) {
    const double sheared = std::max(0.0, e - 0.02);
    const double q = 100.0 * ratio * sheared * 3.0;  // p is 3 throughout
    c.strain.push_back(e);
    c.strain_z.push_back(e);
    for (auto* column : {&c.strain_x, &c.strain_y}) column->push_back(std::min(e, 0.02) - lateral_strain * sheared);
    c.stress_axial.push_back(3.0 + 2.0 * q / 3.0);
    for (auto* column : {&c.stress_lateral, &c.stress_x, &c.stress_y}) column->push_back(3.0 - q / 3.0);
    c.stage.push_back(e > 0.02 ? 1.0 : 0.0);
  }
  c.cost.contact_evaluations = 1;
  return c;
}

/// q/p at 2 % was that at the end of the preload, and was compared in tests without stages alone.
TEST(MaterialModels, ShearIsComparedFromTheBeginOfItsStage) {
  const MaterialVariant variant{"v", {}};
  const MaterialModel model{.name = "m"};
  VariantResult truth{&variant, "", {}, nullptr};
  ModelRun run{&model, &truth, {}, "", ""};
  truth.curves = {preloaded_triaxial(0.01, 0.3)};
  run.curves = {preloaded_triaxial(0.012, 0.1)};
  for (MacroCurve* c : {&truth.curves.front(), &run.curves.front()})
    for (std::size_t k = 0; k < c->strain.size(); ++k)  // the model is right at the beginning of the stage
      if (c->strain[k] < 0.035) {
        const MacroCurve right = preloaded_triaxial(0.01, 0.3);
        c->stress_axial[k] = right.stress_axial[k];
        c->stress_x[k] = c->stress_y[k] = right.stress_x[k];
      }
  const ModelScore s = score(run, false);
  EXPECT_NEAR(s.ratio_at_2, 0.2, 1e-12);
  EXPECT_NEAR(s.ratio_at_6, 0.2, 1e-12);
  const auto lost = [](double lateral) {
    const double side = (0.98 + 0.07 * lateral) / 0.98;
    return 1.0 - side * side * 0.91 / 0.98;
  };
  EXPECT_NEAR(s.volume, lost(0.1) - lost(0.3), 1e-12);
  EXPECT_NE(console_summary({s}).find(", volume lost +2.6"), std::string::npos) << console_summary({s});

  run.curves.front().strain_x.clear();
  EXPECT_TRUE(std::isnan(score(run, false).volume));
  for (MacroCurve* c : {&truth.curves.front(), &run.curves.front()}) c->stages[1].kind = StageKind::oedometric;
  EXPECT_TRUE(std::isnan(score(run, false).ratio_at_6));
}

/// Two stages of 3 and 4 % are one of 7 %: nothing was compared at 6 %. One that goes back is another test.
TEST(MaterialModels, ShearInTwoPartsIsComparedAsInOne) {
  const MaterialVariant variant{"v", {}};
  const MaterialModel model{.name = "m"};
  const auto scored = [&](const auto& edit) {
    VariantResult truth{&variant, "", {}, nullptr};
    ModelRun run{&model, &truth, {}, "", ""};
    truth.curves = {preloaded_triaxial(0.01, 0.3)};
    run.curves = {preloaded_triaxial(0.012, 0.1)};
    for (MacroCurve* c : {&truth.curves.front(), &run.curves.front()}) edit(*c);
    return score(run, false);
  };
  const auto in_parts = [](MacroCurve& c) {
    c.stages.push_back(c.stages.back());
    for (std::size_t k = 0; k < c.stage.size(); ++k)
      if (c.strain[k] > 0.055) c.stage[k] = 2.0;
  };
  const ModelScore whole = scored([](MacroCurve&) {});
  const ModelScore parts = scored(in_parts);
  EXPECT_EQ(parts.ratio_at_2, whole.ratio_at_2);
  EXPECT_EQ(parts.ratio_at_6, whole.ratio_at_6);
  EXPECT_EQ(parts.volume, whole.volume);
  const ModelScore back = scored([&](MacroCurve& c) {
    in_parts(c);
    for (std::size_t k = 0; k < c.stage.size(); ++k)
      if (c.stage[k] == 2.0) c.strain[k] = c.strain_z[k] = 0.1 - c.strain[k];
  });
  EXPECT_EQ(back.ratio_at_2, whole.ratio_at_2);
  EXPECT_TRUE(std::isnan(back.ratio_at_6));
  EXPECT_NE(console_summary({back}).find(", q/p at 2 and 6 % "), std::string::npos) << console_summary({back});
}

/// The report of a run of an earlier version said that the volume of all its models was right, "+0.00 %".
TEST(MaterialModels, WhatAnEarlierVersionDidNotCompareIsNotDefined) {
  const auto earlier = record_of<ModelScore>({{"model", "m"}, {"samples", 2}, {"q_over_p_at_2", 0.1}});
  EXPECT_EQ(earlier.samples, 2);
  EXPECT_EQ(earlier.ratio_at_2, 0.1);
  EXPECT_TRUE(std::isnan(earlier.volume));
  EXPECT_EQ(volume_text(earlier), "");
}

/// A mean field was "- times faster".
TEST(MaterialModels, CostIsSaidOfModelsThatEvaluateSomething) {
  ModelScore s;
  s.samples = 1;
  s.remark = "a remark";
  s.evaluations = s.seconds = 8.0;
  EXPECT_NE(console_summary({s}).find("; 8 times fewer evaluations, 8 times faster; a remark\n"), std::string::npos);
  s.evaluations = s.seconds = kInfinity;
  EXPECT_EQ(console_summary({s}).find("times"), std::string::npos) << console_summary({s});
  EXPECT_NE(console_summary({s}).find("; a remark\n"), std::string::npos);
}

/// What a scene with one model is refused for; empty: it is read.
std::string complaint_of_model(const std::string& model) {
  const std::string cards = std::string(SOFTGRAIN_SOURCE_DIR) + "/results/material_law/";
  std::string text = "kind = \"material-models\"\n[grains]\ncount = 700\n[[model]]\nname = \"m\"\n" + model;
  for (std::size_t at = 0; (at = text.find("CARDS/")) != std::string::npos;) text.replace(at, 6, cards);
  try {
    (void)read_material_models_scene(Scene::parse(text, "s"));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(MaterialModelsScene, BandsGoWithModelsThatTakeTheNumbersOfACard) {
  const std::string with = "card = \"CARDS/cell_law_memory.toml\"\nbands = 8\n";
  for (const char* kind : {"cells", "mean-field"})
    EXPECT_EQ(complaint_of_model("kind = \"" + std::string(kind) + "\"\n" + with), "");
  EXPECT_NE(complaint_of_model("kind = \"substitute\"\nmapped = true\n" + with).find("bands = 8: does not go with"),
            std::string::npos);
  EXPECT_NE(complaint_of_model("kind = \"coarse\"\nbands = 8\n").find("bands = 8: does not go with"),
            std::string::npos);
  const std::string none = complaint_of_model("kind = \"cells\"\ncard = \"CARDS/cell_law.toml\"\nbands = 8\n");
  EXPECT_NE(none.find("the card of the cell law has no [correlation]"), std::string::npos) << none;
}

/// Draws at 1 -+ 0.1 of the model have the deviation 0.1 sqrt(8/7) of eight, and Student's 95 % of seven degrees is
/// 2.3646. What the truth is off at each sample decides whether it lies within; a draw that broke off has no part.
class BandsOfModels : public testing::Test {
 protected:
  BandsOfModels() {
    truth_.curves = {sample(1.0, false), sample(0.8), sample(1.3)};
    run_.curves = {sample(1.0), sample(1.0), sample(1.0)};
    for (int k = 0; k < 8; ++k) {
      const double off = k % 2 == 0 ? 0.9 : 1.1;
      run_.drawn.push_back({sample(5.0 * off), sample(off), sample(off)});
    }
  }
  static MacroCurve sample(double stress, bool usable = true) {
    MacroCurve c = exact(card_of(StateForm::porosity), 0.66, 0.64);
    for (double& s : c.stress_axial) s *= stress;
    c.stages = {StageRecord{}};
    c.stage.assign(c.strain.size(), 0.0);
    c.usable = usable;
    return c;
  }
  template <class Change>
  void change_all(const Change& change) {
    for (auto* curves : {&truth_.curves, &run_.curves})
      for (MacroCurve& c : *curves) change(c);
    for (auto& curves : run_.drawn)
      for (MacroCurve& c : curves) change(c);
  }

  const double half_ = 2.364624 * 0.1 * std::sqrt(8.0 / 7.0);
  const MaterialVariant variant_{"v", {}};
  const MaterialModel model_{.name = "m", .bands = 9};
  VariantResult truth_{&variant_, "", {}, nullptr};
  ModelRun run_{&model_, &truth_, {}, "", ""};
};

TEST_F(BandsOfModels, AreThoseOfTheDrawsSampleBySample) {
  const ModelScore s = score(run_, false);
  EXPECT_NEAR(s.band, half_ * std::sqrt(2.0 / (0.8 * 0.8 + 1.3 * 1.3)), 1e-6);
  EXPECT_EQ(s.inside, 0.5);  // 0.2 is within 0.253, 0.3 is not
  EXPECT_EQ(s.remark, "");
  run_.drawn.clear();
  EXPECT_TRUE(std::isnan(score(run_, false).band));
}

/// Eight draws were asked for, and the band was that of fewer without a word.
TEST_F(BandsOfModels, SayHowManyDrawsBrokeOff) {
  run_.drawn.push_back({sample(7.0), sample(7.0, false), sample(7.0)});
  run_.drawn.back()[2].stress_axial.pop_back();
  const ModelScore s = score(run_, false);
  EXPECT_NEAR(s.band, half_ * std::sqrt(2.0 / (0.8 * 0.8 + 1.3 * 1.3)), 1e-6);
  EXPECT_EQ(s.remark, "2 of 18 curves of draws of the card break off: the band is without them");
  run_.drawn.erase(run_.drawn.begin(), run_.drawn.begin() + 8);
  EXPECT_TRUE(std::isnan(score(run_, false).band));
  EXPECT_TRUE(std::isnan(score(run_, false).inside));
}

/// Errors have no part below 1 % strain, and bands none either.
TEST_F(BandsOfModels, BeginAtOnePerCentStrain) {
  for (auto& curves : run_.drawn)
    for (MacroCurve& c : curves) c.stress_axial.front() *= 30.0;
  truth_.curves[1].stress_axial.front() *= 100.0;
  const ModelScore s = score(run_, false);
  EXPECT_NEAR(s.band, half_ * std::sqrt(2.0 / (0.8 * 0.8 + 1.3 * 1.3)), 1e-6);
  EXPECT_EQ(s.inside, 0.5);
}

/// What the test imposes both have.
TEST_F(BandsOfModels, LeaveOutStressesThatTheTestImposes) {
  change_all([](MacroCurve& c) {
    c.test = MacroTest::stages;
    c.stages.assign(2, StageRecord{});
    c.stages[0].by_stress = std::array<bool, 3>{};
    c.stages[1].by_stress = std::array<bool, 3>{false, false, true};
    c.stage = {0.0, 0.0, 1.0};
  });
  truth_.curves[1].stress_axial.back() *= 10.0;
  truth_.curves[2].stress_axial[1] = run_.curves[2].stress_axial[1];
  const ModelScore s = score(run_, false);
  EXPECT_NEAR(s.band, half_ * std::sqrt(2.0 / (0.8 * 0.8 + 1.0)), 1e-6);
  EXPECT_EQ(s.inside, 1.0);
}

}  // namespace
}  // namespace softgrain
