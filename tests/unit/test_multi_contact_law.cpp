// Law tables: what is written is read to the last bit, damage is refused where it stands, entries are interpolated.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/text_file.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using synthetic::law_entry;
using synthetic::unknown;

void expect_same(const Estimate& a, const Estimate& b) {
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.standard_error, b.standard_error);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
}

void expect_same(const PartnerRow& a, const PartnerRow& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.ratio, b.ratio);
  expect_same(a.weight, b.weight);
  expect_same(a.exponent, b.exponent);
  EXPECT_EQ(a.overlap_max, b.overlap_max);
  EXPECT_EQ(a.error, b.error);
}

void expect_same(const ConfigurationError& a, const ConfigurationError& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.use, b.use);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.end_ratio, b.end_ratio);
  EXPECT_EQ(a.noise, b.noise);
  EXPECT_EQ(a.packings, b.packings);
  ASSERT_EQ(a.offset.has_value(), b.offset.has_value());
  if (!a.offset) return;
  EXPECT_EQ(a.offset->force, b.offset->force);
  EXPECT_EQ(a.offset->onset, b.offset->onset);
}

void expect_same(const MultiContactLaw& a, const MultiContactLaw& b) {
  EXPECT_EQ(a.form, b.form);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reason, b.reason);
  for (const MultiContactParameterName& p : kMultiContactParameters) expect_same(a.*p.estimate, b.*p.estimate);
  ASSERT_EQ(a.partners.size(), b.partners.size());
  for (std::size_t k = 0; k < a.partners.size(); ++k) expect_same(a.partners[k], b.partners[k]);
  ASSERT_EQ(a.errors.size(), b.errors.size());
  for (std::size_t k = 0; k < a.errors.size(); ++k) expect_same(a.errors[k], b.errors[k]);
  EXPECT_EQ(a.error_fitted, b.error_fitted);
  EXPECT_TRUE(a.error_held_out == b.error_held_out || (std::isnan(a.error_held_out) && std::isnan(b.error_held_out)));
  EXPECT_EQ(a.error_cross, b.error_cross);
  EXPECT_EQ(a.criterion, b.criterion);
  EXPECT_EQ(a.parameters, b.parameters);
}

void expect_same(const SoftParticleSpec& a, const SoftParticleSpec& b) {
  EXPECT_EQ(a.shell_radius, b.shell_radius);
  EXPECT_EQ(a.youngs_modulus, b.youngs_modulus);
  EXPECT_EQ(a.poisson_ratio, b.poisson_ratio);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.restitution, b.restitution);
  EXPECT_EQ(a.exponent, b.exponent);
  EXPECT_EQ(a.polydispersity, b.polydispersity);
  EXPECT_EQ(a.rmax_over_shell, b.rmax_over_shell);
  EXPECT_EQ(a.beta, b.beta);
  EXPECT_EQ(a.trials, b.trials);
  EXPECT_EQ(a.placement, b.placement);
}

void expect_same(const LawTableEntry& a, const LawTableEntry& b) {
  expect_same(a.spec, b.spec);
  EXPECT_EQ(a.solid_fraction, b.solid_fraction);
  EXPECT_EQ(a.solid_fraction_error, b.solid_fraction_error);
  EXPECT_EQ(a.grains, b.grains);
  EXPECT_EQ(a.packings, b.packings);
  EXPECT_EQ(a.relaxation, b.relaxation);
  EXPECT_EQ(a.volume_max, b.volume_max);
  EXPECT_EQ(a.overlap_max, b.overlap_max);
  EXPECT_EQ(a.grain_overlap_max, b.grain_overlap_max);
  for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft}) {
    expect_same((a.*slide).kt_ratio, (b.*slide).kt_ratio);
    expect_same((a.*slide).friction, (b.*slide).friction);
    EXPECT_EQ((a.*slide).rolls, (b.*slide).rolls);
    if (!(a.*slide).rolls) continue;
    expect_same((a.*slide).rolling, (b.*slide).rolling);
    expect_same((a.*slide).rolling_friction, (b.*slide).rolling_friction);
  }
  expect_same(a.unloading, b.unloading);
  for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft}) {
    EXPECT_EQ((a.*slide).has_unloading, (b.*slide).has_unloading);
    expect_same((a.*slide).unloading, (b.*slide).unloading);
  }
  EXPECT_EQ(a.best, b.best);
  ASSERT_EQ(a.laws.size(), b.laws.size());
  for (std::size_t k = 0; k < a.laws.size(); ++k) expect_same(a.laws[k], b.laws[k]);
}

class MultiContactLawIo : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return directory_.file("law_table.toml"); }

  /// The text of a good table of two entries with the first `from` after `after` replaced is refused with these words.
  void expect_refused(const std::string& after, const std::string& from, const std::string& to,
                      const std::vector<std::string>& words) {
    std::string text = law_table_text({1, {law_entry(0.7), law_entry(0.75, 0.01)}}, build_provenance(), "");
    const auto start = text.find(after);
    ASSERT_NE(start, std::string::npos) << after;
    const auto at = text.find(from, start);
    ASSERT_NE(at, std::string::npos) << from;
    refused(text.replace(at, from.size(), to), words);
  }
  void refused(const std::string& text, const std::vector<std::string>& words) {
    write_text_atomic(path(), text);
    try {
      (void)load_law_table(path());
      ADD_FAILURE() << "accepted, " << words.front();
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("law_table.toml"), std::string::npos) << e.what();
      for (const std::string& word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " not in: " << e.what();
    }
  }

  test::TemporaryDirectory directory_;
};

TEST_F(MultiContactLawIo, RoundTripIsExact) {
  LawTable table{1, {law_entry(0.7), law_entry(0.1 * 7.5, 1e-3 / 3.0)}};
  table.entries[0].slide_soft = {unknown(0.3), unknown(0.25)};
  table.entries[1].slide_solid.rolling = {0.01 / 3.0, 1e-3, 0.001, 0.005};
  table.entries[1].slide_solid.rolling_friction = {0.1 / 3.0, 1e-2, 0.01, 0.05};
  table.entries[1].slide_solid.rolls = true;
  table.entries[1].slide_soft.unloading = {5.0 / 3.0, 0.1, 1.4, 1.9};
  table.entries[1].slide_soft.has_unloading = true;
  table.entries[0].laws[1].status = LawStatus::underdetermined;
  table.entries[0].laws[1].reason = "planes: \"3 of 6\" \\ more";
  table.entries[0].laws[1].criterion = HUGE_VAL;
  table.entries[0].laws[1].errors[0].offset = FormOffset{-0.1 / 3.0, 0.01 / 3.0};
  table.entries[1].laws[2].partners.pop_back();
  table.entries[1].laws[2].errors.clear();
  table.entries[1].laws[2].error_held_out = std::nan("");
  save_law_table(table, path());
  const LawTable read = load_law_table(path());
  EXPECT_EQ(read.schema, 1);
  ASSERT_EQ(read.entries.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) expect_same(table.entries[k], read.entries[k]);
}

TEST_F(MultiContactLawIo, TheGridHoldsTheForcesOfTheLaw) {
  const LawTableEntry entry = law_entry();
  save_law_table({1, {entry}}, path());
  const h5::Group group = h5::open_file(directory_.file("law_table.h5")).open("entry_0").open("isotropic");
  const auto overlap = group.doubles("overlap");
  const auto force = group.doubles("force");
  ASSERT_EQ(overlap.size(), 5U * 51U);  // one plane, two solid, two soft
  const MultiContactModel model = multi_contact_model(*entry.find(LawForm::isotropic));
  const MultiContactPartner soft{PartnerKind::soft, 1.0, {{1.0, 0.0, 0.0}}};
  EXPECT_EQ(overlap[50], entry.overlap_max);
  EXPECT_EQ(force[3 * 51 + 37], multi_contact_forces(model, {soft}, {overlap[3 * 51 + 37]})[0]);
  EXPECT_GT(force[3 * 51 + 50], 0.0);
}

TEST_F(MultiContactLawIo, MissingAndUnknownKeysAreNamed) {
  expect_refused("[[entry]]", "packings = 12\n", "", {"packings"});
  expect_refused("[[entry]]", "overlap_max = ", "overlap_mix = 0.1\noverlap_max = ", {"overlap_mix", "overlap_max"});
  expect_refused("[[entry.law]]", "delta = ", "# delta = ", {"delta"});
  expect_refused("[entry.slide_solid]", "[entry.slide_solid]", "[entry.slide_stone]", {"slide_solid"});
  expect_refused("[[entry.law.partner]]", "error = ", "eror = ", {"error"});
}

TEST_F(MultiContactLawIo, NumbersOutOfRangeAreRefusedWhereTheyStand) {
  expect_refused("[[entry.law]]", "delta = { value = 0.08", "delta = { value = 1.0", {"value = 1", "below 1"});
  expect_refused("[[entry.law]]", "b = { value = 2.8", "b = { value = -2.8", {"value = -2.8"});
  expect_refused("[[entry.law.partner]]", "weight = { value = 0.7", "weight = { value = 0", {"value = 0"});
  expect_refused("unloading", "value = 1.5", "value = 0.5", {"value = 0.5"});
  expect_refused("[[entry]]", "solid_fraction = 0.7", "solid_fraction = 1.7", {"solid_fraction = 1.7"});
}

TEST_F(MultiContactLawIo, NumbersOfNoContactAreRefused) {
  expect_refused("[[entry.law]]", "a = { value = 0.7", "a = { value = -0.7", {"value = -0.7", "above 0"});
  expect_refused("[[entry.law]]", "a = { value = 0.7", "a = { value = 0.0", {"value = 0:", "above 0"});
  expect_refused("[[entry.law]]", "b = { value = 2.8", "b = { value = 200.0", {"value = 200:", "at most 50"});
  expect_refused("[[entry.law]]", "m0 = { value = 1.0", "m0 = { value = 1e6", {"value = 1000000:"});
  expect_refused("kt_ratio", "value = 0.3", "value = -0.3", {"value = -0.3"});
  expect_refused("kt_ratio", "value = 0.3", "value = 1e9", {"value = 1000000000:"});
  expect_refused("[[entry]]", "overlap_max = 0.28", "overlap_max = 28.0", {"overlap_max = 28:", "from 0 to 2"});
}

/// Draws took the distance to an end on the wrong side for a negative error.
TEST_F(MultiContactLawIo, AnIntervalThatDoesNotHoldItsValueIsRefused) {
  expect_refused("[[entry.law]]", "low = 0.6", "low = 0.7", {"low = 0.73", "must not be above value = 0.7", "-inf"});
  expect_refused("[[entry.law]]", "high = 0.7", "high = 0.6", {"high = 0.67", "must not be below value = 0.7", "inf"});
  expect_refused("[[entry.law]]", "low = 0.6", "low = 9.6", {"low = 9.63", "must not be above the high end"});
  expect_refused("kt_ratio", "low = 0.", "low = 0.9", {"low = 0.9", "must not be above"});
}

/// Refits of another table are none of this one; after an edit they are not used, and the table says so.
TEST_F(MultiContactLawIo, TheFileOfAnotherTableIsRefused) {
  LawTable table{1, {law_entry(0.7)}};
  MultiContactLaw& law = table.entries[0].laws[0];
  law.replicates = {multi_contact_numbers(law), multi_contact_numbers(law)};
  save_law_table(table, path());
  LawTable read = load_law_table(path());
  read_replicates(read, path());
  EXPECT_EQ(read.entries[0].laws[0].replicates.size(), 2U);
  EXPECT_TRUE(read.notes.empty());

  const std::string own = read_text(path());
  std::string text = own;
  text.replace(text.find("a = { value = 0.7"), 17, "a = { value = 0.75");
  write_text_atomic(path(), text);
  LawTable edited = load_law_table(path());
  read_replicates(edited, path());
  EXPECT_TRUE(edited.entries[0].laws[0].replicates.empty());
  ASSERT_EQ(edited.notes.size(), 1U);
  EXPECT_NE(edited.notes[0].find("pair law"), std::string::npos) << edited.notes[0];

  table.entries[0].packings += 1;
  save_law_table(table, path());
  write_text_atomic(path(), own);
  LawTable other = load_law_table(path());
  try {
    read_replicates(other, path());
    FAIL() << "the refits of another table were taken";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("law_table.h5: this file belongs to another law"), std::string::npos);
  }
}

/// A kind of neighbour that was not unloaded comes back as planes do, between entries too.
TEST(LawTableEntryAt, TheUnloadingBranchOfAKindStandsBesideThatOfPlanes) {
  LawTable table{1, {law_entry(0.7), law_entry(0.75)}};
  table.entries[1].slide_soft.unloading = table.entries[1].unloading;
  table.entries[1].slide_soft.unloading.value = 1.9;
  table.entries[1].slide_soft.has_unloading = true;
  std::string remark;
  const LawTableEntry at = entry_at(table, 0.725, RangePolicy::reject, remark);
  EXPECT_GT(at.unloading_of(at.slide_soft).value, table.entries[0].unloading.value + 0.1);
  EXPECT_LT(at.unloading_of(at.slide_soft).value, 1.8);
  EXPECT_DOUBLE_EQ(at.unloading_of(at.slide_solid).value, at.unloading.value);
  EXPECT_NE(numbers_of(table.entries[1], LawForm::isotropic), numbers_of(law_entry(0.75), LawForm::isotropic));
}

/// What one entry does not know is not known between entries.
TEST(LawTableEntryAt, AnUnknownErrorStaysUnknown) {
  LawTable table{1, {law_entry(0.7), law_entry(0.75, 0.01)}};
  table.entries[1].unloading = unknown(1.5);
  std::string remark;
  EXPECT_TRUE(std::isinf(entry_at(table, 0.72, RangePolicy::reject, remark).unloading.standard_error));
}

TEST_F(MultiContactLawIo, RatiosAreOrdered) {
  expect_refused("[[entry.law.partner]]", "ratio = 2.0", "ratio = 0.4", {"ratios of one kind must ascend"});
  expect_refused("[[entry.law.partner]]", "ratio = 2.0", "ratio = 0.5", {"ratios of one kind must ascend"});
  expect_refused("kind = \"soft\"", "ratio = 1.0", "ratio = 0.9", {"larger over smaller"});
}

TEST_F(MultiContactLawIo, EntriesMustMakeSense) {
  LawTableEntry entry = law_entry();
  entry.laws.erase(entry.laws.begin() + 1);
  entry.best = LawForm::isotropic;
  refused(law_table_text({1, {entry}}, build_provenance(), ""), {"best", "no form"});
  refused(law_table_text({1, {law_entry(0.7), law_entry(0.7)}}, build_provenance(), ""), {"must ascend"});
  refused(law_table_text({1, {law_entry(0.75), law_entry(0.7)}}, build_provenance(), ""), {"must ascend"});
  refused(law_table_text({1, {}}, build_provenance(), ""), {"[[entry]]"});
  expect_refused("schema", "schema = 1", "schema = 2", {"schema"});
  expect_refused("[[entry.law]]", "\"pair\"", "\"pear\"", {"pear", "pair"});
}

TEST(LawTableEntryAt, TheEntriesThemselvesAreExact) {
  const LawTable table{1, {law_entry(0.68, -0.01), law_entry(0.7), law_entry(0.75, 0.02)}};
  for (const LawTableEntry& e : table.entries) {
    std::string remark;
    const LawTableEntry at = entry_at(table, e.solid_fraction, RangePolicy::reject, remark);
    for (std::size_t k = 0; k < e.laws.size(); ++k)
      for (const MultiContactParameterName& p : kMultiContactParameters)
        EXPECT_DOUBLE_EQ((at.laws[k].*p.estimate).value, (e.laws[k].*p.estimate).value);
    EXPECT_DOUBLE_EQ(at.laws[2].partners[3].weight.value, e.laws[2].partners[3].weight.value);
    EXPECT_DOUBLE_EQ(at.slide_soft.friction.value, e.slide_soft.friction.value);
    EXPECT_DOUBLE_EQ(at.unloading.value, e.unloading.value);
    EXPECT_DOUBLE_EQ(at.volume_max, e.volume_max);
    EXPECT_EQ(remark, "");
  }
}

TEST(LawTableEntryAt, BetweenEntriesEveryParameterIsMonotone) {
  const LawTable table{1, {law_entry(0.68, -0.02), law_entry(0.69, -0.019), law_entry(0.75, 0.02)}};
  double a = 0.0;
  double w = 0.0;
  for (int k = 0; k <= 70; ++k) {
    std::string remark;
    const LawTableEntry e = entry_at(table, 0.68 + 0.001 * k, RangePolicy::reject, remark);
    EXPECT_GE(e.laws[2].a.value, a);
    EXPECT_GE(e.laws[1].partners[0].weight.value, w);
    a = e.laws[2].a.value;
    w = e.laws[1].partners[0].weight.value;
    EXPECT_GE(a, 0.68 - 1e-12);
    EXPECT_LE(a, 0.72 + 1e-12);
  }
  EXPECT_NEAR(a, 0.72, 1e-12);
}

TEST(LawTableEntryAt, OutsideTheTable) {
  const LawTable one{1, {law_entry(0.7)}};
  std::string remark;
  EXPECT_EQ(entry_at(one, 0.719, RangePolicy::reject, remark).solid_fraction, 0.7);
  EXPECT_EQ(remark, "");
  EXPECT_THROW((void)entry_at(one, 0.721, RangePolicy::reject, remark), InputError);
  EXPECT_EQ(entry_at(one, 0.8, RangePolicy::clamp, remark).solid_fraction, 0.7);
  EXPECT_NE(remark.find("0.800"), std::string::npos) << remark;
  EXPECT_NE(remark.find("nearest entry"), std::string::npos) << remark;
  const LawTable two{1, {law_entry(0.7), law_entry(0.75, 0.02)}};
  remark.clear();
  EXPECT_DOUBLE_EQ(entry_at(two, 0.76, RangePolicy::reject, remark).laws[0].a.value, 0.72);  // means scatter
  EXPECT_EQ(remark, "");
  EXPECT_THROW((void)entry_at(two, 0.6, RangePolicy::reject, remark), InputError);
  EXPECT_DOUBLE_EQ(entry_at(two, 0.6, RangePolicy::clamp, remark).laws[0].a.value, 0.7);
  EXPECT_NE(remark, "");
  EXPECT_THROW((void)entry_at({1, {}}, 0.6, RangePolicy::clamp, remark), InputError);
}

TEST(LawTableEntryAt, UnlikeEntriesAreRefused) {
  const auto refused = [](const LawTableEntry& second, const std::string& word) {
    std::string remark;
    try {
      (void)entry_at({1, {law_entry(0.7), second}}, 0.72, RangePolicy::reject, remark);
      ADD_FAILURE() << word;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  LawTableEntry fewer = law_entry(0.75);
  fewer.laws[1].partners.pop_back();
  refused(fewer, "neighbours");
  LawTableEntry others = law_entry(0.75);
  others.laws[2].partners[1].ratio = 3.0;
  refused(others, "neighbours");
  LawTableEntry forms = law_entry(0.75);
  forms.laws.pop_back();
  refused(forms, "neighbours");
  LawTableEntry grains = law_entry(0.75);
  grains.spec.friction = 0.5;
  refused(grains, "grains");
}

TEST(LawTableEntryAt, ALawIsAsGoodAsTheWorstEntry) {
  LawTable table{1, {law_entry(0.7), law_entry(0.75)}};
  table.entries[1].laws[0].status = LawStatus::no_threshold_crossing;
  table.entries[1].laws[0].reason = "too shallow";
  std::string remark;
  const LawTableEntry e = entry_at(table, 0.71, RangePolicy::reject, remark);
  EXPECT_EQ(e.laws[0].status, LawStatus::no_threshold_crossing);
  EXPECT_EQ(e.laws[0].reason, "too shallow");
  EXPECT_EQ(e.laws[1].status, LawStatus::good);
}

TEST(LawTableEntryAt, AnEntryKnowsNothingOfItsNeighbours) {
  LawTable table{1, {law_entry(0.7), law_entry(0.75, 0.02)}};
  table.entries[0].laws[0].status = LawStatus::no_threshold_crossing;
  std::string remark;
  const LawTableEntry at = entry_at(table, 0.75, RangePolicy::reject, remark, kReachOfNumbers);
  EXPECT_EQ(at.laws[0].status, LawStatus::good);
  for (const MultiContactLaw& law : at.laws)
    EXPECT_EQ(numbers_of(at, law.form), numbers_of(table.entries[1], law.form));
}

TEST(LawTableEntryAt, ANumberThatSomebodyGivesIsRoundedAtMost) {
  const LawTable table{1, {law_entry(0.70004), law_entry(0.75, 0.02)}};
  std::string remark;
  EXPECT_EQ(entry_at(table, 0.7, RangePolicy::reject, remark, kReachOfNumbers).solid_fraction, 0.70004);
  EXPECT_EQ(remark, "");
  EXPECT_THROW((void)entry_at(table, 0.755, RangePolicy::reject, remark, kReachOfNumbers), InputError);
  EXPECT_THROW((void)entry_at(table, std::nan(""), RangePolicy::reject, remark), InputError);
}

/// Forces on a plane alone, on six, on one solid sphere and one soft one, at some overlaps.
std::vector<double> forces_of(const LawTableEntry& e, LawForm form) {
  const MultiContactModel model = multi_contact_model(*e.find(form));
  std::vector<double> out;
  for (const auto& [around, kind, ratio] :
       {std::tuple{Arrangement::one, PartnerKind::plane, 0.0}, std::tuple{Arrangement::cube, PartnerKind::plane, 0.0},
        std::tuple{Arrangement::one, PartnerKind::solid, 1.0},
        std::tuple{Arrangement::cube, PartnerKind::solid, 1.0}}) {
    std::vector<MultiContactPartner> partners;
    for (const Vec3& d : directions_of(around)) partners.push_back({kind, ratio, d});
    for (const double h : {0.14, 0.18, 0.22, 0.26})
      out.push_back(multi_contact_forces(model, partners, std::vector<double>(partners.size(), h)).front());
  }
  return out;
}

/// Of a table that was measured: a committed one of before, with two solid fractions.
TEST(LawTableEntryAt, AMeasuredTableIsAContinuousLawBetweenItsEntries) {
  const LawTable table = load_law_table(SOFTGRAIN_REFERENCE_DIR "/law/two_fractions.toml");
  ASSERT_EQ(table.entries.size(), 2U);
  const double low = table.entries[0].solid_fraction;
  const double high = table.entries[1].solid_fraction;
  constexpr int kSteps = 64;
  for (const auto& [form, name] : enum_names<LawForm>) {
    const std::vector<double> loose = forces_of(table.entries[0], form);
    const std::vector<double> dense = forces_of(table.entries[1], form);
    std::vector<double> before = loose;
    for (int k = 0; k <= kSteps; ++k) {
      std::string remark;
      const double x = k == kSteps ? high : low + (high - low) * k / kSteps;
      const std::vector<double> at = forces_of(entry_at(table, x, RangePolicy::reject, remark), form);
      EXPECT_EQ(remark, "") << x;
      for (std::size_t n = 0; n < at.size(); ++n) {
        const auto [least, most] = std::minmax({loose[n], dense[n]});
        EXPECT_GE(at[n], least * (1.0 - 1e-3)) << name << ", force " << n << " at " << x;
        EXPECT_LE(at[n], most * (1.0 + 1e-3)) << name << ", force " << n << " at " << x;
        EXPECT_LE(std::abs(at[n] - before[n]), 3.0 * (most - least) / kSteps + 1e-12) << name << ", force " << n;
      }
      if (k == 0) {
        EXPECT_EQ(at, loose);
      }
      if (k == kSteps) {
        EXPECT_EQ(at, dense);
      }
      before = at;
    }
  }
}

TEST(LawTableEntryAt, NumbersBetweenDegenerateFitsAreNoLawBetweenThem) {
  // Much the same force at h/Rs = 0.28 from a and b far apart: half way between them it is another one.
  LawTableEntry steep = law_entry(0.75);
  for (MultiContactLaw& law : steep.laws) {
    law.b.value = 5.0;
    law.a.value = 0.7 * std::pow(0.28, 2.8 - 5.0);
  }
  const LawTable table{1, {law_entry(0.7), steep}};
  std::string remark;
  (void)entry_at(table, 0.725, RangePolicy::reject, remark);
  EXPECT_NE(remark.find("is not between those of the entries at 0.7000 and 0.7500"), std::string::npos) << remark;
  remark.clear();
  (void)entry_at(table, 0.75, RangePolicy::reject, remark);
  EXPECT_EQ(remark, "");
  LawTable forms{1, {law_entry(0.7), law_entry(0.75, 0.01)}};
  forms.entries[1].best = LawForm::isotropic;
  (void)entry_at(forms, 0.72, RangePolicy::reject, remark);
  EXPECT_NE(remark.find("prefer different forms (directional and isotropic)"), std::string::npos) << remark;
}

TEST(LawTableMainEntry, IsTheMarkedOneElseTheOneOfMostConfigurations) {
  LawTable table{1, {law_entry(0.65), law_entry(0.7), law_entry(0.75)}};
  table.entries[1].packings = 13;
  EXPECT_EQ(main_entry(table).solid_fraction, 0.7) << "of as many configurations the one of most packings";
  for (MultiContactLaw& law : table.entries[2].laws)
    law.errors.push_back({"two", MultiContactUse::fitted, 0.1, 1.0, 0.1});
  EXPECT_EQ(main_entry(table).solid_fraction, 0.75);
  table.entries[0].main = true;
  EXPECT_EQ(main_entry(table).solid_fraction, 0.65);
  EXPECT_THROW((void)main_entry({1, {}}), InputError);
  const LawTable committed = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  EXPECT_NEAR(main_entry(committed).solid_fraction, 0.7044, 1e-4);
}

TEST_F(MultiContactLawIo, TheMainEntryIsKept) {
  LawTable table{1, {law_entry(0.7), law_entry(0.75)}};
  EXPECT_EQ(law_table_text(table, build_provenance(), "").find("main"), std::string::npos);
  table.entries[0].main = true;
  save_law_table(table, path());
  EXPECT_TRUE(load_law_table(path()).entries[0].main);
  EXPECT_FALSE(load_law_table(path()).entries[1].main);
  table.entries[1].main = true;
  refused(law_table_text(table, build_provenance(), ""), {"main", "another entry"});
}

}  // namespace
}  // namespace softgrain
