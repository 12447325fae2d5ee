// Values of cards and tables against the laws of the contact loop, intervals, and what is said beyond the range.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/text_file.h"
#include "pipelines/law/law_difference.h"
#include "pipelines/law/law_values.h"
#include "pipelines/law/value_output.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using law::LawPoint;
using law::Where;

constexpr double kExact = 1e-12;

LawCard published() { return load_card(std::string(SOFTGRAIN_SOURCE_DIR) + "/results/published/law.toml"); }

TEST(CardValues, AreThoseOfTheContactLaw) {
  const LawCard card = published();
  const std::vector<double> deltas{0.02, 0.09, 0.11, 0.2, 0.27, 0.39};
  constexpr double kModulus = 3.7e6;
  constexpr double kRadius = 0.0081;
  for (const PairKind kind : {PairKind::soft_solid, PairKind::soft_soft}) {
    const std::vector<LawPoint> points = law::card_values(card, kind, deltas);
    for (const bool secant : {false, true}) {
      const SoftContact contact = make_soft_contact(card, kind, kModulus, 0.3, 0.0, secant);
      for (std::size_t k = 0; k < deltas.size(); ++k) {
        ContactState<3> s;
        s.overlap = deltas[k] * kRadius;
        s.normal[0] = 1.0;
        s.constants = contact.pair_constants({kRadius, 2.0 * kRadius, 0.0, 0.0});
        const ContactResponse<3> r = contact.evaluate(s);
        const double force = kModulus * kRadius * kRadius * points[k].force.value;
        const double stiffness = kModulus * kRadius * points[k].stiffness.value;
        const auto& kt = secant ? points[k].tangential_secant : points[k].tangential_initial;
        ASSERT_TRUE(kt.has_value());
        EXPECT_NEAR(force, r.elastic_force, kExact * r.elastic_force);
        EXPECT_NEAR(stiffness, r.normal_stiffness, kExact * r.normal_stiffness);
        EXPECT_NEAR(kModulus * kRadius * kt->value, r.tangential_stiffness, kExact * r.tangential_stiffness);
      }
    }
  }
}

TEST(CardValues, TheSlopeIsTheDerivative) {
  constexpr double kStep = 1e-6;
  for (const double d : {0.12, 0.2, 0.29}) {
    const auto p = law::card_values(published(), PairKind::soft_solid, {d - kStep, d, d + kStep});
    EXPECT_NEAR((p[2].force.value - p[0].force.value) / (2.0 * kStep), p[1].stiffness.value, 1e-7);
  }
}

TEST(CardValues, BeyondTheRange) {
  const LawCard card = published();
  const std::vector<double> deltas{0.05, 0.3, 3.0 * 0.1, 0.4};
  const auto at = [&](Extrapolation beyond) { return law::card_values(card, PairKind::soft_solid, deltas, beyond); };
  const auto extrapolated = at(Extrapolation::extrapolate);
  EXPECT_EQ(extrapolated[0].where, Where::no_contact);
  EXPECT_EQ(extrapolated[1].where, Where::inside);
  EXPECT_EQ(extrapolated[2].where, Where::inside);
  EXPECT_EQ(extrapolated[3].where, Where::beyond);
  EXPECT_FALSE(extrapolated[3].refused);
  EXPECT_GT(extrapolated[3].force.value, extrapolated[1].force.value);
  const auto clamped = at(Extrapolation::clamp);
  EXPECT_EQ(clamped[3].force.value, clamped[1].force.value);
  EXPECT_EQ(clamped[3].stiffness.value, 0.0) << "the derivative of a constant force";
  EXPECT_GT(clamped[2].stiffness.value, 0.0);
  EXPECT_EQ(law::where_text(clamped[3]), "beyond range: clamped");
  // Nothing says how far off a law is where nobody measured it: no interval, whatever the law does there.
  for (const auto* points : {&extrapolated, &clamped}) {
    const LawPoint& beyond = (*points)[3];
    EXPECT_TRUE((*points)[1].force.interval && (*points)[1].stiffness.interval);
    EXPECT_FALSE(beyond.force.interval || beyond.stiffness.interval);
    EXPECT_FALSE(beyond.tangential_initial->interval || beyond.tangential_secant->interval);
  }
  const law::ValueTable far{"soft-solid", LawStatus::good, "", Extrapolation::extrapolate, false, extrapolated};
  EXPECT_TRUE(law::values_json(far, {})["values"][3]["force_interval"].is_null());
  EXPECT_NE(law::values_csv({far}, {}).find(",,,beyond range: extrapolated"), std::string::npos);
  EXPECT_NE(law::values_text(far, {}).find("no interval beyond the measured range"), std::string::npos);
  const auto refused = at(Extrapolation::error);
  EXPECT_FALSE(refused[1].refused);
  EXPECT_TRUE(refused[3].refused);
  const law::ValueTable table{"soft-solid", LawStatus::good, "", Extrapolation::error, false, refused};
  EXPECT_TRUE(law::values_json(table, {})["values"][3]["force"].is_null());
  EXPECT_NE(law::values_csv({table}, {}).find(",0.4,0.4,,,,,,,,,,,,,beyond range: refused"), std::string::npos);
}

TEST(CardValues, IntervalsFromTheBandAndElseFromTheCovariance) {
  PairLaw pair = *published().find(PairKind::soft_solid);
  const auto linear = value_interval(pair, LawPart::normal, 0.2);
  ASSERT_TRUE(linear.has_value());
  EXPECT_EQ(linear->origin, kFromCovariance);
  const auto band = linearised_band(pair, LawPart::normal, {0.2});
  EXPECT_EQ(linear->low, band->low.front());
  EXPECT_EQ(linear->high, band->high.front());
  pair.band_delta = {0.0, 0.1, 0.3};
  pair.bands = {{"normal", {0.0, 1.0, 2.0}, {0.0, 3.0, 5.0}}};
  const auto stored = value_interval(pair, LawPart::normal, 0.2);
  EXPECT_EQ(stored->origin, kFromPackings);
  EXPECT_NEAR(stored->low, 1.5, kExact);
  EXPECT_NEAR(stored->high, 4.0, kExact);
  EXPECT_EQ(value_interval(pair, LawPart::normal, 0.3)->high, 5.0);
  EXPECT_EQ(value_interval(pair, LawPart::normal, 0.31)->origin, kFromCovariance);
  EXPECT_EQ(value_interval(pair, LawPart::tangential_initial, 0.2)->origin, kFromCovariance);
  pair.covariance.clear();
  EXPECT_FALSE(value_interval(pair, LawPart::normal, 0.31).has_value());
  EXPECT_FALSE(slope_interval(pair, LawPart::normal, 0.2).has_value());
}

TEST(CardValues, TheIntervalOfTheSlopeFollowsFromTheCovariance) {
  PairLaw pair = *published().find(PairKind::soft_solid);
  pair.covariance.assign(49, 0.0);
  constexpr double kError = 1e-4;
  pair.covariance[8] = kError * kError;  // only b uncertain
  ThresholdPowerLaw up = pair.normal;
  ThresholdPowerLaw down = pair.normal;
  up.b.value += 1e-6;
  down.b.value -= 1e-6;
  const double by_b = (up.derivative(0.2) - down.derivative(0.2)) / 2e-6;
  const auto at = slope_interval(pair, LawPart::normal, 0.2);
  // Student's t of seven packings.
  EXPECT_NEAR(0.5 * (at->high - at->low), 2.446912 * std::abs(by_b) * kError, 1e-9);
  pair.band_origin = kFromResiduals;
  const auto many = slope_interval(pair, LawPart::normal, 0.2);
  EXPECT_NEAR(0.5 * (many->high - many->low), 1.959964 * std::abs(by_b) * kError, 1e-9);
}

/// The same bands after saving and reading, none when the card was edited.
TEST(CardValues, BandsComeWithTheCardUnlessItWasEdited) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("law.toml");
  LawCard card = published();
  for (PairLaw& pair : card.pairs) {
    pair.band_delta = {0.0, 0.2, 0.4};
    pair.bands = {{"normal", {0.0, 0.1, 0.2}, {0.0, 0.3, 0.4}}};
  }
  card.pairs[1].band_origin = kFromResiduals;
  save_card(card, path);
  const std::string id = load_card(path).table_id;
  EXPECT_EQ(value_interval(load_card(path).pairs[0], LawPart::normal, 0.1)->origin, kFromPackings);
  std::string text = read_text(path);
  const std::size_t at = text.find("value = 0.8294");
  ASSERT_NE(at, std::string::npos);
  write_text_atomic(path, text.replace(at, 14, "value = 0.8295"));
  EXPECT_THROW((void)load_card(path), InputError);  // c must fit
  card.pairs[0].normal.a.value *= 1.01;
  card.pairs[0].normal.c.value *= 1.01;
  const std::string other = directory.file("other.toml");
  save_card(card, other);
  std::string edited = read_text(other);
  const std::string its_own = load_card(other).table_id;
  write_text_atomic(path, edited.replace(edited.find(its_own), its_own.size(), id));
  EXPECT_EQ(value_interval(load_card(path).pairs[0], LawPart::normal, 0.1)->origin, kFromCovariance);
  EXPECT_EQ(value_interval(load_card(path).pairs[1], LawPart::normal, 0.1)->origin, kFromResiduals);
}

struct Asked {
  LawForm form;
  Arrangement arrangement;
  PartnerKind partner;
  double ratio;
};

class MultiContactValues : public ::testing::TestWithParam<Asked> {
 protected:
  void SetUp() override {
    entry_ = synthetic::law_entry();
    entry_.volume_max = 0.5;
    question_.form = GetParam().form;
    question_.arrangement = GetParam().arrangement;
    question_.partner = GetParam().partner;
    question_.ratio = GetParam().ratio;
  }
  [[nodiscard]] std::vector<double> predicted(const std::vector<double>& overlap) const {
    std::vector<MultiContactPartner> partners;
    for (const Vec3& d : directions_of(question_.arrangement))
      partners.push_back({question_.partner, question_.partner == PartnerKind::plane ? 0.0 : question_.ratio, d});
    return multi_contact_forces(multi_contact_model(*entry_.find(*question_.form)), partners, overlap);
  }
  LawTableEntry entry_;
  law::MultiContactQuestion question_;
};

TEST_P(MultiContactValues, AreThoseOfThePrediction) {
  for (const double delta : {0.05, 0.15, 0.22}) {
    const law::MultiContactAnswer answer = law::multi_contact_values({1, {entry_}}, question_, {delta});
    std::vector<double> overlap = depth_shares(question_.arrangement, question_.shallow);
    for (double& h : overlap) h *= delta;
    const std::vector<double> expected = predicted(overlap);
    const LawPoint& p = answer.points.front();
    ASSERT_EQ(p.forces.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR(p.forces[k], expected[k], kExact * std::abs(expected[k]));
    EXPECT_EQ(p.force.value, p.forces.front());
    // The first neighbour moves alone.
    constexpr double kStep = 1e-6;
    std::vector<double> up = overlap;
    std::vector<double> down = overlap;
    up[0] += kStep;
    down[0] -= kStep;
    const double slope = (predicted(up)[0] - predicted(down)[0]) / (2.0 * kStep);
    EXPECT_NEAR(p.stiffness.value, std::max(slope, 0.0), 1e-5 * std::max(std::abs(slope), 1e-3));
  }
}

INSTANTIATE_TEST_SUITE_P(FormsAndNeighbours, MultiContactValues,
                         ::testing::Values(Asked{LawForm::pair, Arrangement::one, PartnerKind::plane, 1.0},
                                           Asked{LawForm::pair, Arrangement::cube, PartnerKind::solid, 0.7},
                                           Asked{LawForm::isotropic, Arrangement::tetrahedron, PartnerKind::plane, 1.0},
                                           Asked{LawForm::isotropic, Arrangement::octant, PartnerKind::soft, 0.5},
                                           Asked{LawForm::directional, Arrangement::cube, PartnerKind::plane, 1.0},
                                           Asked{LawForm::directional, Arrangement::random_8, PartnerKind::solid, 1.3},
                                           Asked{LawForm::directional, Arrangement::beside_five, PartnerKind::soft,
                                                 2.0}),
                         [](const auto& i) {
                           std::string name =
                               to_string(i.param.form) + to_string(i.param.arrangement) + to_string(i.param.partner);
                           std::erase(name, '-');
                           return name;
                         });

TEST(MultiContactTables, IntervalsAreThoseOfTheReplicates) {
  LawTableEntry entry = synthetic::law_entry();
  entry.volume_max = 0.5;
  MultiContactLaw& directional = entry.laws[2];
  for (int r = 0; r <= 40; ++r) {  // forces scale with a
    std::vector<double> numbers = multi_contact_numbers(directional);
    numbers[0] *= 0.8 + 0.01 * r;
    directional.replicates.push_back(numbers);
  }
  law::MultiContactQuestion q;
  q.arrangement = Arrangement::octant;
  const law::MultiContactAnswer answer = law::multi_contact_values({1, {entry}}, q, {0.2});
  const law::Quantity& force = answer.points[0].force;
  EXPECT_EQ(answer.replicates, 41u);
  ASSERT_TRUE(force.interval.has_value());
  // Quantile p of n numbers in order: number p (n + 1), between 1 and 2 here; then as far as few packings leave open.
  const double few = few_samples_factor(static_cast<std::size_t>(entry.packings));
  EXPECT_NEAR(force.interval->low, std::pow(0.8005, few) * force.value, 1e-12);
  EXPECT_NEAR(force.interval->high, std::pow(1.1995, few) * force.value, 1e-12);
  // None beyond what was measured, by depth or by volume.
  const law::MultiContactAnswer deep = law::multi_contact_values({1, {entry}}, q, {0.2, 1.9});
  EXPECT_EQ(deep.points[1].where, Where::beyond);
  EXPECT_TRUE(deep.points[0].force.interval && deep.points[0].stiffness.interval);
  EXPECT_FALSE(deep.points[1].force.interval || deep.points[1].stiffness.interval);
  q.form = LawForm::isotropic;
  EXPECT_FALSE(law::multi_contact_values({1, {entry}}, q, {0.2}).points[0].force.interval.has_value());
}

/// kt = (kt/kn) kn is no better known than kt/kn alone, whose interval is widened for few packings.
TEST(MultiContactTables, TheIntervalOfKtHoldsThatOfItsRatio) {
  LawTableEntry entry = synthetic::law_entry();
  entry.volume_max = 0.5;
  entry.slide_plane.kt_ratio = {0.3, 0.03, 0.1, 0.6};  // four packings: wider than its scatter
  MultiContactLaw& directional = entry.laws[2];
  const auto kt = [&](double scatter) {
    directional.replicates.clear();
    for (int r = 0; r <= 40; ++r) {
      directional.replicates.push_back(multi_contact_numbers(directional));
      directional.replicates.back()[0] *= 1.0 + scatter * (r - 20) / 20.0;
    }
    return *law::multi_contact_values({1, {entry}}, {}, {0.2}).points[0].tangential_secant;
  };
  const law::Quantity sure = kt(1e-6);
  ASSERT_TRUE(sure.interval);
  EXPECT_NEAR(sure.interval->low, sure.value / 3.0, 1e-4 * sure.value);
  EXPECT_NEAR(sure.interval->high, 2.0 * sure.value, 1e-4 * sure.value);
  const law::Quantity both = kt(0.2);
  EXPECT_LT(both.interval->low, sure.interval->low);
  EXPECT_GT(both.interval->low, 0.0);
  EXPECT_GT(both.interval->high, sure.interval->high);
}

// The law knows the lost volume alone: a single cap deeper than any that was measured is not clamped before its volume
// is.
TEST(MultiContactTables, AreClampedByTheLostVolume) {
  LawTableEntry entry = synthetic::law_entry();
  entry.volume_max = 0.5;
  law::MultiContactQuestion q;
  q.beyond = Extrapolation::clamp;
  const double end = law::multi_contact_values({1, {entry}}, q, {}).overlap_max;
  const std::vector<LawPoint> points = law::multi_contact_values({1, {entry}}, q, {0.9 * end, 1.1 * end, 1.9}).points;
  ASSERT_LT(points[1].volume, 0.5);
  EXPECT_EQ(law::where_text(points[0]), "");
  EXPECT_EQ(law::where_text(points[1]), "beyond range: extrapolated");
  EXPECT_EQ(law::where_text(points[2]), "beyond range: clamped");
}

TEST(MultiContactTables, ReplicatesAreKeptBesideTheTableAndBelongToItsNumbers) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("law_table.toml");
  LawTable table{1, {synthetic::law_entry(0.7), synthetic::law_entry(0.75, 0.02)}};
  for (LawTableEntry& e : table.entries)
    e.laws[1].replicates = {multi_contact_numbers(e.laws[1]),
                            multi_contact_numbers(synthetic::multi_contact_law(LawForm::isotropic, 0.03))};
  save_law_table(table, path);
  LawTable read = load_law_table(path);
  EXPECT_TRUE(read.entries[0].laws[1].replicates.empty());
  read_replicates(read, path);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(read.entries[k].laws[1].replicates, table.entries[k].laws[1].replicates);
  EXPECT_TRUE(read.entries[0].laws[2].replicates.empty());
  EXPECT_EQ(replicate_count(read, LawForm::isotropic), 2u);
  EXPECT_EQ(replicate_count(read, LawForm::pair), 0u);
  const LawTable drawn = replicate_of(read, LawForm::isotropic, 1);
  EXPECT_EQ(multi_contact_numbers(drawn.entries[0].laws[1]), table.entries[0].laws[1].replicates[1]);
  EXPECT_EQ(multi_contact_numbers(drawn.entries[0].laws[0]), multi_contact_numbers(table.entries[0].laws[0]));
  LawTable edited = load_law_table(path);
  edited.entries[0].laws[1].b.value *= 1.01;
  read_replicates(edited, path);
  EXPECT_TRUE(edited.entries[0].laws[1].replicates.empty());
  EXPECT_FALSE(edited.entries[1].laws[1].replicates.empty());
}

TEST(MultiContactTables, WhatWasNotMeasuredIsSaid) {
  const LawTable table{1, {synthetic::law_entry()}};
  law::MultiContactQuestion q;
  q.arrangement = Arrangement::cube;
  const law::MultiContactAnswer planes = law::multi_contact_values(table, q, {0.1, 0.27});
  EXPECT_EQ(planes.points[0].where, Where::inside);
  EXPECT_EQ(planes.points[1].where, Where::beyond);  // by volume
  q.arrangement = Arrangement::one;
  EXPECT_EQ(law::multi_contact_values(table, q, {0.3}).points[0].where, Where::beyond);  // by depth
  q.partner = PartnerKind::soft;
  q.ratio = 5.0;
  EXPECT_NE(law::multi_contact_values(table, q, {0.1}).remark.find("ratio 5 was not measured"), std::string::npos);
  q.solid_fraction = 0.5;
  EXPECT_THROW((void)law::multi_contact_values(table, q, {0.1}), InputError);
  q.range = RangePolicy::clamp;
  EXPECT_NE(law::multi_contact_values(table, q, {0.1}).remark.find("nearest entry"), std::string::npos);
}

TEST(LawDifferences, OfACardWithItself) {
  const FittedLaw file{published()};
  const auto same = law::law_differences(file, file);
  ASSERT_EQ(same.size(), 6u);
  for (const law::LawDifference& d : same) {
    EXPECT_EQ(d.root_mean_square, 0.0);
    for (const law::DifferenceRow& r : d.rows) EXPECT_TRUE(r.known && r.within);
  }
}

TEST(LawDifferences, InPerCentAndAgainstIntervals) {
  LawCard changed = published();
  for (PairLaw& pair : changed.pairs) {
    pair.normal.a.value *= 2.0;
    pair.normal.c.value *= 2.0;
    pair.delta_max *= 0.9;
  }
  const auto differences = law::law_differences({published()}, {changed});
  const law::LawDifference& force = differences.front();
  EXPECT_NEAR(force.high, 0.27, kExact);
  EXPECT_NEAR(force.rows.back().relative, 1.0, kExact);
  EXPECT_FALSE(force.rows.back().within);
  EXPECT_NEAR(force.root_mean_square, 1.0, kExact);
  EXPECT_TRUE(differences[1].rows.back().within);  // kt is the same
}

}  // namespace
}  // namespace softgrain
