// Own packings correct the library: one normal distribution, whose mean and covariance are those of closed forms, with
// the weight of either side; contradictions are said, and without the library nothing changes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/law_table/law_prior.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/pipeline/scene.h"
#include "pipelines/law/law_draws.h"
#include "pipelines/law/law_library.h"
#include "pipelines/law/law_library_numbers.h"
#include "tests/support/every_kind.h"
#include "tests/support/synthetic_library.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_law_table.h"

namespace softgrain {
namespace {

const LibraryPoint kAsked{0.45, 3.2, 7.0, 0.66};

const LawLibrary& prior_library() {
  static const LawLibrary made = synthetic::law_library(16);
  return made;
}

std::string refusal_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

void expect_said(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

/// An entry whose refits differ in a alone: ln F of a plane is what they tell. `spread`: standard deviation of ln a.
LawTableEntry entry_of_one_number(double ln_factor, double spread) {
  LawTableEntry e = synthetic::library_entry(kAsked, 0.02, 5);
  MultiContactLaw& law = e.laws.front();
  law.errors.clear();
  std::vector<double> numbers = multi_contact_numbers(law);
  numbers[0] *= std::exp(ln_factor);
  std::vector<std::vector<double>> refits;
  for (int r = 0; r < 40; ++r) {
    refits.push_back(numbers);
    refits.back()[0] *= std::exp(r % 2 == 0 ? spread : -spread);
  }
  law = with_numbers(law, numbers);
  law.replicates = refits;
  e.slide_plane.measured = e.slide_solid.measured = e.slide_soft.measured = false;
  e.unloading_measured = false;
  return e;
}

/// The answer of the library without correlations, but for `rho` between the force of a plane and b.
LibraryAnswer answer_with(double rho) {
  LibraryAnswer out = ask_library(prior_library(), kAsked);
  const std::size_t count = prior_library().law_numbers();
  std::fill(out.correlations.begin(), out.correlations.end(), 0.0);
  for (std::size_t k = 0; k < count; ++k) out.correlations[k * count + k] = 1.0;
  out.correlations[1] = out.correlations[count] = rho;
  return out;
}

double deviation_of(const LawTableEntry& e) { return own_numbers(prior_library().partners, e).errors[0]; }

TEST(LawLibraryOwn, OfIndependentNumbersBothCountByTheirVariances) {
  const LibraryAnswer library = answer_with(0.0);
  const LawTableEntry own = entry_of_one_number(0.3, 0.08);
  const double y = own_numbers(prior_library().partners, own).values[0];
  const double s = deviation_of(own);
  EXPECT_NEAR(s, 0.08 * std::sqrt(40.0 / 39.0) * few_samples_factor(24), 1e-9);
  const CorrectedAnswer both = corrected(prior_library(), library, own);
  const LibraryNumber& n = library.numbers[0];
  const double w = n.deviation * n.deviation / (n.deviation * n.deviation + s * s);
  EXPECT_NEAR(both.answer.numbers[0].value, w * y + (1.0 - w) * n.value, 1e-9);
  EXPECT_NEAR(both.answer.numbers[0].deviation, std::sqrt(1.0 / (1.0 / (n.deviation * n.deviation) + 1.0 / (s * s))),
              1e-9);
  const PriorNumber& said = both.prior.numbers.front();
  EXPECT_EQ(said.name, "ln force");
  EXPECT_NEAR(said.own_weight, w, 1e-9);
  EXPECT_NEAR(said.own, y, 1e-12);
  EXPECT_NEAR(said.own_error, s, 1e-12);
  EXPECT_EQ(said.library, n.value);
  EXPECT_EQ(said.library_error, n.deviation);
  for (std::size_t k = 1; k < prior_library().law_numbers(); ++k) {
    EXPECT_NEAR(both.answer.numbers[k].value, library.numbers[k].value, 1e-9) << library.numbers[k].name;
    EXPECT_NEAR(both.answer.numbers[k].deviation, library.numbers[k].deviation, 1e-9) << library.numbers[k].name;
  }
}

TEST(LawLibraryOwn, WhatWasNotMeasuredMovesByItsCorrelation) {
  constexpr double kRho = -0.7;
  const LibraryAnswer library = answer_with(kRho);
  const LawTableEntry own = entry_of_one_number(0.3, 0.02);
  const CorrectedAnswer both = corrected(prior_library(), library, own);
  const LibraryNumber& force = library.numbers[0];
  const LibraryNumber& b = library.numbers[1];
  const double s = deviation_of(own);
  const double w = force.deviation * force.deviation / (force.deviation * force.deviation + s * s);
  const double slope = kRho * b.deviation / force.deviation;
  EXPECT_NEAR(both.answer.numbers[1].value, b.value + slope * (both.answer.numbers[0].value - force.value), 1e-9);
  EXPECT_NEAR(both.answer.numbers[1].deviation, b.deviation * std::sqrt(1.0 - kRho * kRho * w), 1e-9);
  EXPECT_NEAR(both.prior.numbers[1].own_weight, kRho * kRho * w, 1e-9);
  EXPECT_TRUE(std::isnan(both.prior.numbers[1].own)) << "it was not measured";
}

TEST(LawLibraryOwn, ErrorsHoldWhatTheFormDoesNotGiveBack) {
  MultiContactLaw law;
  EXPECT_EQ(own_error_factor(law), 1.0) << "nothing is known of it";
  law.error_cross = 0.2;
  law.errors = {{"a", MultiContactUse::fitted, 0.1, 1.0, 0.03},
                {"b", MultiContactUse::fitted, 0.1, 1.0, 0.05},
                {"c", MultiContactUse::predicted, 0.5, 1.0, 0.5}};
  EXPECT_NEAR(own_error_factor(law), 0.2 / std::sqrt((0.03 * 0.03 + 0.05 * 0.05) / 2.0), 1e-12);
  law.error_cross = 0.01;
  EXPECT_EQ(own_error_factor(law), 1.0) << "packings scatter at least";
  LawTableEntry own = entry_of_one_number(0.3, 0.02);
  const double s = deviation_of(own);
  own.laws.front().error_cross = 0.2;
  own.laws.front().errors = {{"a", MultiContactUse::fitted, 0.1, 1.0, 0.05}};
  const CorrectedAnswer both = corrected(prior_library(), answer_with(0.0), own);
  EXPECT_NEAR(both.prior.own_factor, 4.0, 1e-12);
  EXPECT_NEAR(both.prior.numbers[0].own_error, 4.0 * s, 1e-12);
}

TEST(LawLibraryOwn, ANeighbourThatTheLibraryLacksKeepsWhatWasMeasured) {
  LawTableEntry own = synthetic::library_entry(kAsked, 0.02, 77);
  MultiContactLaw& law = own.laws.front();
  PartnerRow row = law.partners.front();
  row.ratio = 7.0;
  law.partners.push_back(row);
  RandomStream random(9, RandomPurpose::test, 3);
  for (std::vector<double>& r : law.replicates) {
    const double weight = r[6];
    const double exponent = r[7];
    r.push_back(weight * std::exp(0.05 * random.normal()));
    r.push_back(exponent);
  }
  const CorrectedAnswer both = corrected(prior_library(), ask_library(prior_library(), kAsked), own);
  ASSERT_EQ(both.library.partners.size(), prior_library().partners.size() + 1);
  const auto at = std::ranges::find(both.prior.numbers, "ln nu, solid 7", &PriorNumber::name);
  ASSERT_NE(at, both.prior.numbers.end());
  EXPECT_NEAR(at->value, at->own, at->own_error) << "it moves by what its errors share with others alone";
  EXPECT_TRUE(std::isnan(at->library));
  EXPECT_EQ(at->own_weight, 1.0);
  const LawTableEntry entry = combined_entry(both, own);
  const auto rows = entry.find(LawForm::isotropic)->rows(PartnerKind::solid);
  EXPECT_EQ(rows.back().ratio, 7.0);
  EXPECT_EQ(rows.back().overlap_max, row.overlap_max);
}

TEST(LawLibraryOwn, TheEntryIsTheOwnOneWithTheLawOfBoth) {
  const LawTableEntry own = synthetic::library_entry(kAsked, 0.02, 77);
  const CorrectedAnswer both = corrected(prior_library(), ask_library(prior_library(), kAsked), own);
  LawTableEntry entry = combined_entry(both, own, 200);
  EXPECT_EQ(entry.source, TableSource::combined);
  EXPECT_EQ(entry.best, LawForm::isotropic);
  EXPECT_EQ(entry.packings, own.packings);
  EXPECT_EQ(entry.solid_fraction, own.solid_fraction);
  EXPECT_EQ(entry.spec.trials, own.spec.trials);
  const MultiContactLaw& law = *entry.find(LawForm::isotropic);
  const std::vector<double> back =
      library_numbers(both.library.partners, law, multi_contact_numbers(law), own.spec.poisson_ratio);
  for (std::size_t k = 0; k < back.size(); ++k)
    EXPECT_NEAR(back[k], both.answer.numbers[k].value, 1e-9) << both.answer.numbers[k].name;
  std::vector<double> forces;
  for (const std::vector<double>& r : law.replicates)
    forces.push_back(library_numbers(both.library.partners, law, r, own.spec.poisson_ratio)[0]);
  ASSERT_EQ(forces.size(), 200U);
  EXPECT_NEAR(few_samples_factor(24) * mean_error(forces).deviation, both.answer.numbers[0].deviation,
              0.2 * both.answer.numbers[0].deviation);
  const test::TemporaryDirectory directory;
  save_law_table({.entries = {entry}}, directory.path() + "/both.toml");
  const LawTableEntry read = load_law_table(directory.path() + "/both.toml").entries.front();
  EXPECT_EQ(read.source, TableSource::combined);
  ASSERT_TRUE(read.prior);
  ASSERT_EQ(read.prior->numbers.size(), entry.prior->numbers.size());
  for (std::size_t k = 0; k < read.prior->numbers.size(); ++k) {
    EXPECT_EQ(read.prior->numbers[k].name, entry.prior->numbers[k].name);
    EXPECT_NEAR(read.prior->numbers[k].own_weight, entry.prior->numbers[k].own_weight, 1e-3);
    EXPECT_EQ(std::isfinite(read.prior->numbers[k].own), std::isfinite(entry.prior->numbers[k].own));
  }
  std::string why;
  EXPECT_FALSE(library_row(prior_library(), entry, "x", why));
  expect_said(why, "corrected by a library already");
}

TEST(LawLibraryOwn, OwnPackingsCorrectAndContradict) {
  LibraryAnswer prior = ask_library(prior_library(), kAsked);
  prior.by_mean = {"b", "ln trials"};
  LibraryPoint other = kAsked;
  other.solid_fraction += 0.002;
  const CorrectedAnswer near = corrected(prior_library(), prior, synthetic::library_entry(other, 0.02, 77));
  EXPECT_EQ(contradictions_text(near), "");
  expect_said(near.remark, "corrected by 24 own packings of solid fraction 0.6620");
  EXPECT_LT(near.answer.numbers[0].deviation, prior.numbers[0].deviation);
  EXPECT_TRUE(near.answer.by_mean.empty()) << "what was measured is no mean of others";
  other.solid_fraction = 0.75;
  const CorrectedAnswer far = corrected(prior_library(), prior, synthetic::library_entry(other, 0.005, 78));
  expect_said(contradictions_text(far), "own measurements contradict the library: ln force");
  EXPECT_NEAR(far.answer.numbers[0].value, synthetic::library_force(other), 0.2) << "what is measured well has its way";
}

TEST(LawLibraryOwn, TheErrorOfTheFormIsThatOfTheOwnPackings) {
  LawTableEntry own = synthetic::library_entry(kAsked, 0.02, 77);
  own.laws.front().errors = {{"sheared", MultiContactUse::predicted, 0.25, 1.0, 0.0, 24, FormOffset{0.1, 0.02}, false}};
  LibraryAnswer prior = ask_library(prior_library(), kAsked);
  const std::vector<std::string> names = prior_library().names();
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  prior.numbers[at("ln error, in proportion")].value = std::log(0.08);
  prior.numbers[at("ln error, in proportion")].deviation = 0.2;
  prior.numbers[at("ln error, sheared")].value = std::log(0.1);
  prior.numbers[at("ln error, sheared")].deviation = 0.3;
  prior.by_mean = {"ln error, sheared", "ln error, in proportion"};
  const CorrectedAnswer both = corrected(prior_library(), prior, own);
  const LibraryAnswer& a = both.answer;
  EXPECT_NEAR(a.numbers[at("ln error, sheared")].value, std::log(0.25), 1e-12);
  EXPECT_EQ(a.numbers[at("ln error, sheared")].deviation, 0.0);
  EXPECT_NEAR(a.numbers[at("ln error, in proportion")].value, std::log(0.08), 1e-12) << "the own table has none";
  EXPECT_EQ(a.by_mean, std::vector<std::string>{"ln error, in proportion"});
  expect_said(contradictions_text(both), "ln error, sheared");
  const MultiContactLaw law = table_of(both, {}).entries.front().laws.front();
  EXPECT_NEAR(form_discrepancy(law), 0.25, 1e-9) << "the larger of the two";
}

TEST(LawLibraryOwn, NumbersBesideTheLawCountByTheirVariances) {
  LawTableEntry own = synthetic::library_entry(kAsked, 0.02, 77);
  own.slide_plane.kt_ratio = {0.2, 0.05, 0.1, 0.3};
  LibraryAnswer prior = ask_library(prior_library(), kAsked);
  const auto at = std::ranges::find(prior.numbers, "kt/kn plane", &LibraryNumber::name);
  ASSERT_NE(at, prior.numbers.end());
  at->value = 0.3;
  at->deviation = 0.1;
  const CorrectedAnswer both = corrected(prior_library(), prior, own);
  const LibraryNumber& n = both.answer.numbers[static_cast<std::size_t>(at - prior.numbers.begin())];
  EXPECT_NEAR(n.value, 0.8 * 0.2 + 0.2 * 0.3, 1e-12) << "errors of 0.05 and 0.1: weights as 4 and 1";
  EXPECT_NEAR(n.deviation, std::sqrt(1.0 / (1.0 / (0.05 * 0.05) + 1.0 / (0.1 * 0.1))), 1e-12);
}

TEST(LawLibraryOwn, BothReachAsFarAsTheFartherOne) {
  const LawTableEntry own = synthetic::library_entry(kAsked, 0.02, 77);
  LibraryAnswer prior = ask_library(prior_library(), kAsked);
  prior.range.volume_max = own.volume_max + 0.1;
  prior.range.overlap_max = own.overlap_max - 0.01;
  prior.range.grain_overlap_max = own.grain_overlap_max + 0.01;
  const LawTableEntry entry = combined_entry(corrected(prior_library(), prior, own), own);
  EXPECT_EQ(entry.volume_max, own.volume_max + 0.1);
  EXPECT_EQ(entry.overlap_max, own.overlap_max);
  EXPECT_EQ(entry.grain_overlap_max, own.grain_overlap_max + 0.01);
  prior.range.overlap_max = own.overlap_max + 0.01;
  EXPECT_EQ(combined_entry(corrected(prior_library(), prior, own), own).overlap_max, own.overlap_max + 0.01);
}

/// The stiffness against rolling goes with E/(1 - nu^2) as forces do; shares of forces stay.
TEST(LawLibraryOwn, MomentsOfAnotherPoissonRatioAreScaledAsForces) {
  LawTableEntry measured = synthetic::library_entry(kAsked, 0.02, 77, 0.3);
  measured.slide_plane.rolls = true;
  measured.slide_plane.rolling = {0.4, 0.02, 0.36, 0.44};
  measured.slide_plane.rolling_friction = {0.05, 0.01, 0.03, 0.07};
  const SideNumbers sides = side_numbers(measured, measured.laws.front());
  const std::vector<std::string> names = side_names();
  const auto rolling = static_cast<std::size_t>(std::ranges::find(names, "rolling plane") - names.begin());
  ASSERT_LT(rolling + 1, names.size());
  EXPECT_NEAR(sides.values[rolling], 0.4 * 0.91, 1e-12);
  EXPECT_NEAR(sides.errors[rolling], 0.02 * 0.91, 1e-12);
  EXPECT_EQ(sides.values[rolling + 1], 0.05);
  std::vector<LibraryNumber> numbers;
  for (std::size_t k = 0; k < names.size(); ++k) numbers.push_back({names[k], sides.values[k], sides.errors[k]});
  LawTableEntry other = synthetic::library_entry(kAsked, 0.02, 77, 0.45);
  set_side_numbers(numbers, other, other.laws.front());
  EXPECT_NEAR(other.slide_plane.rolling.value, 0.4 * 0.91 / (1.0 - 0.45 * 0.45), 1e-12);
  EXPECT_NEAR(other.slide_plane.rolling_friction.value, 0.05, 1e-12);
}

TEST(LawLibraryOwn, AnOwnTableIsOfTheMaterialThatWasAskedFor) {
  LawTable own;
  for (const double fraction : {0.62, 0.655, 0.70}) {
    LibraryPoint p = kAsked;
    p.solid_fraction = fraction;
    own.entries.push_back(synthetic::library_entry(p, 0.02, 5));
  }
  own.entries.back().main = true;
  EXPECT_EQ(own_entry(prior_library(), kAsked, own, "my.toml").solid_fraction, 0.655)
      << "the nearest, not the main one";
  const auto refusal = [&](const LibraryPoint& asked, const LawTable& table) {
    return refusal_of([&] { (void)own_entry(prior_library(), asked, table, "my.toml"); });
  };
  LibraryPoint rounded = kAsked;
  rounded.polydispersity = 7.004;
  EXPECT_EQ(refusal(rounded, own), "");
  const std::string other = refusal({0.2, 3.0, 6.0, 0.58}, own);
  expect_said(other, "my.toml: is of another material: mu = 0.45, asked 0.2");
  expect_said(other, "exponent = 3.2, asked 3");
  expect_said(other, "ratio = 7, asked 6");
  expect_said(other, "its nearest solid fraction is 0.6200, asked 0.5800");
  own.entries[1].source = TableSource::library;
  expect_said(refusal(kAsked, own), "my.toml: no table of own packings: concluded from a library, not measured");
  own.entries[1].source = TableSource::combined;
  expect_said(refusal(kAsked, own), "my.toml: no table of own packings: corrected by a library already");
  own.entries[1].source = TableSource::measured;
  for (LawTableEntry& e : own.entries) e.spec.rmax_over_shell = 0.3;
  expect_said(refusal(kAsked, own), "rmax_over_shell = 0.3, the library has 0.5");
  for (LawTableEntry& e : own.entries) e.spec.exponent = std::nan("");
  expect_said(refusal(kAsked, own), "exponent = nan, asked 3.2");
}

/// A table of two entries as a scene fits it.
MultiContactLawFit fitted_table(double second) {
  MultiContactLawFit out;
  for (const double fraction : {0.66, second}) {
    LibraryPoint p = kAsked;
    p.solid_fraction = fraction;
    out.table.entries.push_back(synthetic::library_entry(p, 0.02, 5));
  }
  return out;
}

TEST(LawLibraryOwn, ScenesCombineEveryEntryOrNone) {
  MultiContactLawFit fit = fitted_table(0.68);
  const std::string before = law_table_text(fit.table, {}, "");
  combine_with_prior(fit, std::nullopt, {}, {});
  EXPECT_EQ(law_table_text(fit.table, {}, ""), before) << "no library: nothing changes";
  EXPECT_TRUE(fit.remarks.empty() && fit.warnings.empty());
  combine_with_prior(fit, prior_library(), {}, {});
  EXPECT_TRUE(fit.warnings.empty()) << fit.warnings.front();
  ASSERT_EQ(fit.remarks.size(), 2U);
  expect_said(fit.remarks.front(), "solid fraction 0.660: 24 packings correct a library of 32 materials");
  expect_said(fit.remarks.front(), "own weight: ln force ");
  for (const LawTableEntry& e : fit.table.entries) EXPECT_TRUE(e.prior.has_value());

  MultiContactLawFit outside = fitted_table(0.9);
  const std::string alone = law_table_text(outside.table, {}, "");
  combine_with_prior(outside, prior_library(), {}, {});
  EXPECT_EQ(law_table_text(outside.table, {}, ""), alone);
  ASSERT_EQ(outside.warnings.size(), 1U);
  expect_said(outside.warnings.front(),
              "[prior] has no part, the law is that of the packings alone: at solid fraction "
              "0.900: law library: solid fraction = 0.9: measured from");
}

TEST(LawLibraryOwn, AnotherShellIsThatOfThePackingsAlone) {
  MultiContactLawFit fit = fitted_table(0.68);
  for (LawTableEntry& e : fit.table.entries) e.spec.beta = 8.0;
  const std::string alone = law_table_text(fit.table, {}, "");
  combine_with_prior(fit, prior_library(), {}, {});
  EXPECT_EQ(law_table_text(fit.table, {}, ""), alone);
  ASSERT_EQ(fit.warnings.size(), 1U);
  expect_said(fit.warnings.front(), "it holds no such soft particles: beta = 8, the library has 3");
}

TEST(LawLibraryOwn, ScenesSayWhatContradicts) {
  MultiContactLawFit fit = fitted_table(0.68);
  for (LawTableEntry& e : fit.table.entries) e.spec.friction = 0.0;  // of another material than was measured
  combine_with_prior(fit, prior_library(), {}, {});
  ASSERT_EQ(fit.warnings.size(), 2U);
  expect_said(fit.warnings.front(), "solid fraction 0.660: own measurements contradict the library: ");
  expect_said(fit.warnings.front(), "measure more packings, or leave [prior] out");
}

TEST(LawLibraryOwn, ScenesReadTheLibrary) {
  const test::TemporaryDirectory directory;
  write_text_atomic(directory.path() + "/library.toml", library_text(prior_library(), build_provenance()));
  const auto read = [&](const std::string& more) {
    return read_law_table(Scene::parse(test::kTinyLawTable + more, directory.path() + "/scene.toml"));
  };
  const std::string here = "[prior]\nlibrary = \"library.toml\"\n";
  EXPECT_FALSE(read("[calibrate]\nmin_packings = 2\n").prior);
  EXPECT_EQ(read("[calibrate]\nmin_packings = 2\n" + here).prior->materials.size(), 32U);
  EXPECT_EQ(read("[calibrate]\nmin_packings = 2\n[prior]\nlibrary = \".\"\n").prior->materials.size(), 32U)
      << "a folder";
  const auto refused = [&](const std::string& more) { return refusal_of([&] { (void)read(more); }); };
  expect_said(refused("[calibrate]\nmin_packings = 2\n[prior]\nlibrary = \"none.toml\"\n"), "there is no such file");
  write_text_atomic(directory.path() + "/other.toml", "title = \"a note\"\n");
  expect_said(refused("[calibrate]\nmin_packings = 2\n[prior]\nlibrary = \"other.toml\"\n"),
              "is no library of law tables");
  expect_said(refused("[calibrate]\nmin_packings = 2\nbest = \"pair\"\n" + here), "a library holds isotropic laws");
  expect_said(refused("[calibrate]\nmin_packings = 2\nreplicates = 5\n" + here), "[prior] needs 10 at least");
  expect_said(refused("[calibrate]\nmin_packings = 2\n" + here + "libary = \".\"\n"), "libary");
}

TEST(LawLibraryOwn, APipelineNeedsPackingsOfManyNeighbours) {
  const std::string text = test::starter_scene("pipeline") + "[prior]\nlibrary = \"shipped\"\n";
  expect_said(refusal_of([&] { (void)read_pipeline_setup(Scene::parse(text, "scene.toml")); }),
              "goes with [[configuration]]: packings measured with many neighbours correct a library");
}

}  // namespace
}  // namespace softgrain
