// Law cards: the form of the law, exact round trips, strict reading of what people may edit.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "common/core/error.h"
#include "common/data/law_band.h"
#include "common/data/law_card.h"
#include "common/io/text_file.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

/// The published soft-solid law [SP 1.5] in units of E Rs^2 = 128 N, made continuous.
ThresholdPowerLaw published_law() {
  ThresholdPowerLaw law;
  law.a = {73.669 / 128.0, 0.01, 0.55, 0.6};
  law.b = {2.799, 0.05, 2.7, 2.9};
  law.delta = {0.065, 0.002, 0.06, 0.07};
  law.c = {-law.a.value * std::pow(law.delta.value, law.b.value), 1e-5, -4e-4, -1e-4};
  return law;
}

PairLaw sample_pair(PairKind kind) {
  PairLaw pair;
  pair.kind = kind;
  pair.status = LawStatus::good;
  pair.reason = "words with \"quotes\", a \\ and a\nline";
  pair.normal = pair.tangential_initial = pair.tangential_secant = published_law();
  pair.has_tangential_secant = true;
  pair.secant_angle_deg = 1.0;
  pair.covariance.resize(49);
  for (std::size_t k = 0; k < 49; ++k) pair.covariance[k] = 1e-3 / static_cast<double>(k + 3);
  pair.delta_min = 0.1;
  pair.delta_max = 0.3;
  pair.max_overlap = 0.5;
  pair.packings = 32;
  pair.points = 160;
  pair.chi2_per_dof = 1.0 / 3.0;
  pair.quality = 0.7;
  pair.table.delta = {0.1, 0.2};
  pair.table.force_mean = {0.1 / 3.0, 0.2};
  pair.table.force_deviation = {0.01, std::nan("")};
  return pair;
}

class LawCardFile : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() / ("softgrain_card_" + std::to_string(::getpid()));
    fs::create_directories(directory_);
    card_.relaxation = "damped";
    card_.spec.shell_radius = 0.016;
    card_.pairs = {sample_pair(PairKind::soft_solid), sample_pair(PairKind::soft_soft)};
    card_.pairs[1].status = LawStatus::no_threshold_crossing;
    card_.pairs[1].normal.a = {std::nan(""), std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  void TearDown() override { fs::remove_all(directory_); }
  [[nodiscard]] std::string path() const { return (directory_ / "law.toml").string(); }

  /// Message of the error when `from` in the card is replaced by `to`.
  [[nodiscard]] std::string message_after(const std::string& from, const std::string& to) const {
    save_card(card_, path());
    std::string text = read_text(path());
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    write_text_atomic(path(), text.replace(place, from.size(), to));
    try {
      (void)load_card(path());
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  LawCard card_;

 private:
  fs::path directory_;
};

void expect_equal(const ThresholdPowerLaw& a, const ThresholdPowerLaw& b) {
  for (const auto& field :
       {&ThresholdPowerLaw::a, &ThresholdPowerLaw::b, &ThresholdPowerLaw::c, &ThresholdPowerLaw::delta}) {
    EXPECT_EQ((a.*field).value, (b.*field).value);
    EXPECT_EQ((a.*field).standard_error, (b.*field).standard_error);
    EXPECT_EQ((a.*field).low, (b.*field).low);
    EXPECT_EQ((a.*field).high, (b.*field).high);
  }
}

TEST(ThresholdPowerLaw, IsZeroBelowAndContinuousAtTheThreshold) {
  const ThresholdPowerLaw law = published_law();
  EXPECT_EQ(law.value(0.0), 0.0);
  EXPECT_EQ(law.value(0.0649999), 0.0);
  EXPECT_NEAR(law.value(0.065), 0.0, 1e-16);
  EXPECT_EQ(law.derivative(0.06), 0.0);
  EXPECT_NEAR(128.0 * law.value(0.2), 73.669 * std::pow(0.2, 2.799) - 0.035, 1e-4);
}

TEST(ThresholdPowerLaw, DerivativeIsThatOfTheValue) {
  const ThresholdPowerLaw law = published_law();
  for (const double d : {0.07, 0.1, 0.25, 0.5}) {
    const double h = 1e-6;
    EXPECT_NEAR(law.derivative(d), (law.value(d + h) - law.value(d - h)) / (2.0 * h), 1e-8) << d;
  }
}

/// Cards of earlier versions do not say how soft particles were turned: all at once. They are read, and say so.
TEST_F(LawCardFile, SaysHowSoftParticlesWereTurned) {
  save_card(card_, path());
  EXPECT_EQ(load_card(path()).turn, TurnProtocol::slow);
  EXPECT_NE(measured_text(load_card(path())).find("kt by a slow turn"), std::string::npos);
  EXPECT_FALSE(has_frozen_kt(load_card(path())));
  EXPECT_EQ(message_after("turn = \"slow turn\"", ""), "");
  EXPECT_EQ(load_card(path()).turn, TurnProtocol::frozen);
  EXPECT_TRUE(has_frozen_kt(load_card(path())));
  EXPECT_NE(message_after("turn = \"slow turn\"", "turn = \"quick turn\""), "");
}

TEST_F(LawCardFile, RoundTripIsExact) {
  save_card(card_, path());
  const LawCard in = load_card(path());
  EXPECT_EQ(in.relaxation, "damped");
  EXPECT_EQ(in.spec.shell_radius, 0.016);
  EXPECT_EQ(in.spec.trials, card_.spec.trials);
  ASSERT_EQ(in.pairs.size(), 2U);
  const PairLaw* pair = in.find(PairKind::soft_solid);
  ASSERT_NE(pair, nullptr);
  const PairLaw& out = card_.pairs[0];
  expect_equal(pair->normal, out.normal);
  expect_equal(pair->tangential_secant, out.tangential_secant);
  EXPECT_EQ(pair->status, out.status);
  EXPECT_EQ(pair->reason, out.reason);
  EXPECT_EQ(pair->covariance, out.covariance);
  EXPECT_EQ(pair->delta_max, out.delta_max);
  EXPECT_EQ(pair->packings, out.packings);
  EXPECT_EQ(pair->chi2_per_dof, out.chi2_per_dof);
  EXPECT_FALSE(pair->has_tangential_initial);
  EXPECT_TRUE(pair->has_tangential_secant);
  EXPECT_EQ(pair->table.delta, out.table.delta);
  EXPECT_EQ(pair->table.force_mean, out.table.force_mean);
  EXPECT_TRUE(std::isnan(pair->table.force_deviation[1]));
  EXPECT_TRUE(pair->table.kt_secant_mean.empty());
}

TEST_F(LawCardFile, UnusableLawsKeepWhatIsNotKnown) {
  save_card(card_, path());
  const LawCard in = load_card(path());
  const PairLaw* pair = in.find(PairKind::soft_soft);
  ASSERT_NE(pair, nullptr);
  EXPECT_EQ(pair->status, LawStatus::no_threshold_crossing);
  EXPECT_TRUE(std::isnan(pair->normal.a.value));
  EXPECT_EQ(pair->normal.a.low, -std::numeric_limits<double>::infinity());
}

TEST_F(LawCardFile, AnAssumedTangentialStiffnessIsWritten) {
  save_card(card_, path());
  EXPECT_EQ(read_text(path()).find("tangential_assumed"), std::string::npos);
  card_.pairs[0].has_tangential_secant = false;
  card_.spec.poisson_ratio = 0.2;
  save_card(card_, path());
  EXPECT_NE(read_text(path()).find("[pair.tangential_assumed]\nkt_ratio = 0.88888"), std::string::npos);
  EXPECT_NEAR(load_card(path()).pairs[0].kt_ratio, 1.6 / 1.8, 1e-15);
  EXPECT_NE(message_after("kt_ratio = 0.8", "kt_ratio = 20.8").find("kt_ratio = 20.8"), std::string::npos);
}

/// A file name may be any bytes; a card that holds the command must stay TOML.
TEST_F(LawCardFile, ACommandThatIsNoUtf8CanBeReadBack) {
  Provenance provenance = build_provenance();
  provenance.command = "softgrain calibrate M\xfcller.csv";
  card_.pairs[0].reason = "of M\xfcller";
  save_card(card_, path(), provenance);
  EXPECT_EQ(load_card(path()).pairs[0].reason, "of M\ufffdller");
}

TEST_F(LawCardFile, CardAloneIsEnough) {
  save_card(card_, path());
  fs::remove(fs::path(path()).replace_extension(".h5"));
  const LawCard in = load_card(path());
  expect_equal(in.pairs[0].normal, card_.pairs[0].normal);
  EXPECT_TRUE(in.pairs[0].table.delta.empty());
}

/// Where its intervals come from decides how wide they are: Student's t of few packings, or many residuals.
TEST_F(LawCardFile, TheOriginOfIntervalsNeedsNoTable) {
  card_.intervals = std::string(kFromSamples) + "; " + kFromResiduals;
  card_.pairs[0].band_origin = kFromResiduals;
  card_.pairs[0].packings = 2;
  card_.pairs[1].band_origin = kFromSamples;
  save_card(card_, path());
  const auto with_table = load_card(path());
  fs::remove(fs::path(path()).replace_extension(".h5"));
  const LawCard alone = load_card(path());
  EXPECT_EQ(alone.pairs[0].band_origin, kFromResiduals);
  EXPECT_EQ(alone.pairs[1].band_origin, kFromSamples);
  const auto a = slope_interval(with_table.pairs[0], LawPart::normal, 0.15);
  const auto b = slope_interval(alone.pairs[0], LawPart::normal, 0.15);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->high, b->high);
  // A card of one kind says it once.
  card_.intervals = kFromResiduals;
  card_.pairs.resize(1);
  save_card(card_, path());
  fs::remove(fs::path(path()).replace_extension(".h5"));
  EXPECT_EQ(load_card(path()).pairs[0].band_origin, kFromResiduals);
}

TEST_F(LawCardFile, ShowsDimensionalValuesAndProvenance) {
  save_card(card_, path());
  const std::string text = read_text(path());
  EXPECT_NE(text.find("# 73.669 N"), std::string::npos);
  EXPECT_NE(text.find("N/degree"), std::string::npos);
  EXPECT_NE(text.find("smaller shell"), std::string::npos);
  EXPECT_NE(text.find("commit = "), std::string::npos);
}

TEST_F(LawCardFile, EditedMistakesAreNamedWithLine) {
  const std::string unknown = message_after("delta_max", "delta_maxi");
  EXPECT_NE(unknown.find("law.toml:"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("missing key 'delta_max'"), std::string::npos) << unknown;
  EXPECT_NE(message_after("friction = 0.3", "friction = -0.3").find("friction = -0.3: must be at least 0"),
            std::string::npos);
  EXPECT_NE(message_after("schema = 1", "schema = 2").find("schema = 2"), std::string::npos);
  EXPECT_NE(message_after("kind = \"soft-solid\"", "kind = \"soft-solit\"").find("nearest is \"soft-solid\""),
            std::string::npos);
  EXPECT_NE(message_after("kind = \"soft-soft\"", "kind = \"soft-solid\"").find("given before"), std::string::npos);
  EXPECT_NE(message_after("restitution", "extra = 1\nrestitution").find("unknown key 'extra' in [measurement]"),
            std::string::npos);
}

TEST_F(LawCardFile, ALawThatJumpsIsRefused) {
  EXPECT_NE(message_after("[pair.normal.delta]\nvalue = 0.065", "[pair.normal.delta]\nvalue = 0.1").find("-a delta^b"),
            std::string::npos);
}

/// Numbers that fit each other and still are those of no contact.
TEST_F(LawCardFile, AbsurdLawsAreRefused) {
  const auto with = [&](double a, double b, double delta) {
    card_.pairs[0].normal = published_law();
    card_.pairs[0].normal.a.value = a;
    card_.pairs[0].normal.b.value = b;
    card_.pairs[0].normal.delta.value = delta;
    card_.pairs[0].normal.c.value = -a * std::pow(delta, b);
    return message_after("schema = 1", "schema = 1");
  };
  EXPECT_EQ(with(0.5, 2.8, 0.065), "");
  EXPECT_NE(with(-0.5, 2.8, 0.065).find("value = -0.5: must be above 0"), std::string::npos);
  EXPECT_NE(with(0.0, 2.8, 0.065).find("value = 0: must be above 0"), std::string::npos);
  EXPECT_NE(with(0.5, 2.8, 2.0).find("value = 2: must be"), std::string::npos);
  EXPECT_NE(with(0.5, 80.0, 0.065).find("value = 80: must be"), std::string::npos);
  EXPECT_NE(with(0.5, 2.8, 0.4).find("must be below delta_max = 0.3"), std::string::npos);
  (void)with(0.5, 2.8, 0.065);
  card_.pairs[0].tangential_secant.a.value *= -1.0;
  card_.pairs[0].tangential_secant.c.value *= -1.0;
  EXPECT_NE(message_after("schema = 1", "schema = 1").find("must be above 0"), std::string::npos) << "kt < 0";
}

/// The .h5 of another law beside a card is no table of it.
TEST_F(LawCardFile, ATableOfAnotherCardIsRefused) {
  card_.pairs[0].band_delta = {0.1, 0.2};
  card_.pairs[0].bands = {{"normal", {0.0, 0.1}, {0.1, 0.2}}};
  const fs::path other = fs::path(path()).parent_path() / "other.toml";
  LawCard changed = card_;
  changed.pairs[0].normal.a.standard_error *= 2.0;
  save_card(changed, other.string());
  save_card(card_, path());
  EXPECT_EQ(load_card(path()).pairs[0].bands.size(), 1U);
  EXPECT_TRUE(load_card(path()).notes.empty());
  const fs::path table = fs::path(path()).replace_extension(".h5");
  fs::copy_file(fs::path(other).replace_extension(".h5"), table, fs::copy_options::overwrite_existing);
  try {
    (void)load_card(path());
    FAIL() << "the table of another card was taken";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("law.h5: this file belongs to another law"), std::string::npos) << e.what();
  }

  // Of a card that was edited the bands are not used, and it says so.
  save_card(card_, path());
  std::string text = read_text(path());
  text.replace(text.find("[pair.normal.b]\nvalue = 2.799"), 29, "[pair.normal.b]\nvalue = 2.8");
  const double c = -card_.pairs[0].normal.a.value * std::pow(0.065, 2.8);
  const std::size_t at = text.find("[pair.normal.c]\nvalue = ") + 24;
  text.replace(at, text.find("  #", at) - at, std::to_string(c * 1e6) + "e-6");
  write_text_atomic(path(), text);
  const LawCard edited = load_card(path());
  EXPECT_TRUE(edited.pairs[0].bands.empty());
  ASSERT_EQ(edited.notes.size(), 1U);
  EXPECT_NE(edited.notes[0].find("soft-solid normal"), std::string::npos) << edited.notes[0];
}

TEST_F(LawCardFile, DamagedTablesAndMissingCardsAreFileTrouble) {
  save_card(card_, path());
  const fs::path table = fs::path(path()).replace_extension(".h5");
  fs::resize_file(table, fs::file_size(table) / 2);
  EXPECT_THROW((void)load_card(path()), IoError);
  EXPECT_THROW((void)load_card("/nowhere/law.toml"), IoError);
}

}  // namespace
}  // namespace softgrain
