// The law of all neighbours from one press test: a synthetic library whose numbers are functions of the press and of
// the friction gives them back, says what the test's own errors add, and refuses what no material gave.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/law/law_library_press.h"
#include "pipelines/law/law_library_scene.h"
#include "tests/support/synthetic_library.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

/// What a press on a material of the synthetic library gives: with its friction it tells force and onset of the law.
PressNumbers press_of(const LibraryPoint& p) {
  const double deep = synthetic::library_force(p) + 0.4 * p.friction / (p.friction + 0.15);
  return {deep, deep - 1.2 - 4.0 * (synthetic::library_onset(p) - 0.14)};
}

const LawLibrary& pressed_library() {
  static const LawLibrary made = [] {
    LawLibrary out = synthetic::law_library(16);
    for (LibraryMaterial& m : out.materials) m.press = press_of(m.at);
    out.press_checks = out.checks;
    return out;
  }();
  return made;
}

const LibraryPoint kInside{0.35, 3.1, 8.0, 0.64};

std::string complaint(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

void expect_says(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(PressLibrary, AMaterialIsKnownByItsPressTestAlone) {
  for (const LibraryPoint& p : {kInside, LibraryPoint{0.1, 3.6, 5.0, 0.67}, LibraryPoint{0.6, 2.8, 11.0, 0.62}}) {
    const LibraryAnswer a = ask_by_press_test(pressed_library(), {press_of(p), {}, p.friction});
    EXPECT_NEAR(a.numbers[0].value, synthetic::library_force(p), 0.05);
    EXPECT_NEAR(a.numbers[1].value, synthetic::library_exponent(p), 0.05);
    EXPECT_NEAR(a.numbers[2].value, synthetic::library_onset(p), 0.005);
    EXPECT_NEAR(a.at.solid_fraction, p.solid_fraction, 0.01);
    EXPECT_TRUE(std::isnan(a.at.exponent));
    EXPECT_TRUE(of_press_test(a));
    EXPECT_TRUE(std::isnan(a.numbers.back().value)) << "trials of grains that are not known";
  }
}

TEST(PressLibrary, ErrorsOfTheTestWidenTheAnswer) {
  PressQuestion q{press_of(kInside), {}, kInside.friction};
  const double sure = ask_by_press_test(pressed_library(), q).numbers[0].deviation;
  for (const double off : {-0.2, 0.2}) q.draws.push_back({q.numbers.ln_deep + off, q.numbers.ln_shallow + off});
  const LibraryAnswer unsure = ask_by_press_test(pressed_library(), q);
  EXPECT_NEAR(unsure.numbers[0].deviation, std::hypot(sure, 0.2), 0.01);
  EXPECT_NEAR(unsure.numbers[2].deviation,
              ask_by_press_test(pressed_library(), {q.numbers, {}, 0.35}).numbers[2].deviation, 2e-3)
      << "the onset goes by the ratio of both forces alone";
}

TEST(PressLibrary, ErrorsOfTheTestAndOfTheLibraryAddInSquares) {
  PressQuestion q{press_of(kInside), {}, kInside.friction};
  const double sure = ask_by_press_test(pressed_library(), q).numbers[0].deviation;
  for (const double off : {-sure, sure}) q.draws.push_back({q.numbers.ln_deep + off, q.numbers.ln_shallow + off});
  EXPECT_NEAR(ask_by_press_test(pressed_library(), q).numbers[0].deviation, std::sqrt(2.0) * sure, 0.1 * sure)
      << "neither of them stands for both";
}

TEST(PressLibrary, RefusesWhatNoMaterialGave) {
  PressNumbers hard = press_of(kInside);
  hard.ln_deep += 3.0;
  hard.ln_shallow += 3.0;
  expect_says(complaint([&] {
                (void)ask_by_press_test(pressed_library(), {hard, {}, 0.35});
              }),
              "no measured material gave such a press test");
  double least = kInfinity;
  double most = 0.0;
  for (const LibraryMaterial& m : pressed_library().materials) {
    const double ratio = std::exp(m.press->ln_shallow - m.press->ln_deep);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  expect_says(complaint([&] {
                (void)ask_by_press_test(pressed_library(), {hard, {}, 0.35});
              }),
              fmt::format("{:.2g} to {:.2g} of that at 0.2", least, most));
  expect_says(complaint([&] {
                (void)ask_by_press_test(pressed_library(), {press_of(kInside), {}, 5.0});
              }),
              "mu = 5: measured from 0 to 0.8");
  // Each refusal says what to look at or to do.
  const auto refused = [&](const PressNumbers& n, double mu) {
    return complaint([&] { (void)ask_by_press_test(pressed_library(), {n, {}, mu}); });
  };
  expect_says(refused(hard, 0.35), "look at E and Rs");
  expect_says(refused(hard, 0.35), "without the library: law = ");
  PressNumbers even = press_of(kInside);
  even.ln_shallow = even.ln_deep - 0.1;
  expect_says(refused(even, 0.35), "rises too evenly");
  PressNumbers late = press_of(kInside);
  late.ln_shallow = late.ln_deep - 6.0;
  expect_says(refused(late, 0.35), "rises too late");
  expect_says(refused(press_of(kInside), 5.0), "give mu of the grains from that range");
  LawLibrary alike = pressed_library();
  for (LibraryMaterial& m : alike.materials) m.at.friction = 0.35;
  EXPECT_NO_THROW((void)ask_by_press_test(alike, {press_of(kInside), {}, 0.35}));
  expect_says(complaint([&] {
                (void)ask_by_press_test(alike, {press_of(kInside), {}, 0.6});
              }),
              "mu = 0.6: all materials of this library have 0.35");
  LawLibrary old = pressed_library();
  old.materials[3].press.reset();
  expect_says(complaint([&] { (void)ask_by_press_test(old, {press_of(kInside), {}, 0.35}); }), "collect it again");
  EXPECT_TRUE(check_press_tests(old).empty());
}

TEST(PressLibrary, LeavingMaterialsOut) {
  const std::vector<LibraryCheck> checks = check_press_tests(pressed_library());
  ASSERT_FALSE(checks.empty());
  EXPECT_LT(checks[0].error, 0.05);
  EXPECT_GT(checks[0].error_of_mean, 0.15);
}

TEST(PressLibrary, SurvivesItsFile) {
  const LawLibrary back =
      read_library(Scene::parse(library_text(pressed_library(), build_provenance()), "library.toml"));
  ASSERT_EQ(back.press_checks.size(), back.names().size());
  for (std::size_t k = 0; k < back.materials.size(); ++k) {
    ASSERT_TRUE(back.materials[k].press);
    EXPECT_NEAR(back.materials[k].press->ln_shallow, pressed_library().materials[k].press->ln_shallow, 1e-6);
  }
}

TEST(PressLibrary, NumbersOfACurve) {
  const auto n = press_numbers(2.0, 3.0, 0.1, 0.5);
  ASSERT_TRUE(n);
  EXPECT_NEAR(std::exp(n->ln_deep), 2.0 * (0.027 - 0.001) * 0.75, 1e-15);
  EXPECT_NEAR(std::exp(n->ln_shallow), 2.0 * (0.008 - 0.001) * 0.75, 1e-15);
  EXPECT_FALSE(press_numbers(2.0, 3.0, 0.2, 0.5)) << "no force at Delta = 0.2";
  EXPECT_FALSE(press_numbers(-2.0, 3.0, 0.1, 0.5));
}

/// A press test with exactly this curve; E = 0.5 MPa, Rs = 16 mm, nu = 0.3.
std::string press_test(const std::string& path, const PressNumbers& n, const std::string& comments, int points = 15) {
  const double b = std::log(std::exp(n.ln_deep - n.ln_shallow)) / std::log(1.5);
  std::string text =
      "# kind = soft-solid\n# Rs = 16 mm\n# E = 0.5 MPa\n# nu = 0.3\n" + comments + "sample,Delta,Fn [N]\n";
  for (const char* sample : {"A", "B"})
    for (int k = 1; k <= points; ++k) {
      const double delta = 0.02 * k;
      const double force = 5e5 * 2.56e-4 / 0.91 * std::exp(n.ln_deep) * std::pow(delta / 0.3, b);
      text += fmt::format("{},{:.3f},{:.9g}\n", sample, delta, force * (*sample == 'A' ? 1.01 : 0.99));
    }
  write_text_atomic(path, text);
  return path;
}

TEST(PressLibrary, ATableOfAPressTestBecomesALaw) {
  const test::TemporaryDirectory directory;
  const PressNumbers n = press_of(kInside);
  const std::string path = press_test(directory.path() + "/press.csv", n, "# density = 2400 kg/m^3\n");
  expect_says(complaint([&] { (void)law_of_press_test(pressed_library(), path, std::nullopt); }),
              "needs the friction of the grains");
  const PressTestLaw law = law_of_press_test(pressed_library(), path, 0.35);
  EXPECT_NEAR(law.question.numbers.ln_deep, n.ln_deep, 0.02);
  EXPECT_NEAR(law.question.numbers.ln_shallow, n.ln_shallow, 0.05);
  EXPECT_FALSE(law.question.draws.empty());
  EXPECT_NEAR(law.answer.numbers[0].value, synthetic::library_force(kInside), 0.08);
  const LawTableEntry& entry = law.table.entries.front();
  EXPECT_EQ(entry.source, TableSource::press_test);
  EXPECT_EQ(entry.spec.density, 2400.0);
  EXPECT_EQ(entry.spec.friction, 0.35);
  EXPECT_GT(entry.solid_fraction_error, 0.0);
  EXPECT_FALSE(packing_known(entry.spec));
  save_law_table(law.table, directory.path() + "/law_table.toml");
  const LawTable back = load_law_table(directory.path() + "/law_table.toml");
  EXPECT_EQ(back.entries.front().source, TableSource::press_test);
  EXPECT_FALSE(packing_known(back.entries.front().spec));
  const std::string said = press_test(directory.path() + "/said.csv", n, "# mu = 0.35\n");
  EXPECT_EQ(law_of_press_test(pressed_library(), said, std::nullopt).answer.numbers[0].value,
            law_of_press_test(pressed_library(), said, 0.35).answer.numbers[0].value);
  expect_says(complaint([&] { (void)law_of_press_test(pressed_library(), said, 0.5); }), "says mu = 0.35, but 0.5");
  expect_says(complaint([&] { (void)law_of_press_test(pressed_library(), said, 0.5); }), "leave one of them out");
  std::string pulled = read_text(said);
  for (std::size_t at = pulled.find("A,"); at != std::string::npos; at = pulled.find("A,", at + 1))
    pulled.insert(pulled.find(',', at + 2) + 1, "-");
  for (std::size_t at = pulled.find("B,"); at != std::string::npos; at = pulled.find("B,", at + 1))
    pulled.insert(pulled.find(',', at + 2) + 1, "-");
  write_text_atomic(directory.path() + "/pulled.csv", pulled);
  expect_says(complaint([&] { (void)card_of_press_test(directory.path() + "/pulled.csv"); }), "look at sign and unit");
}

TEST(PressLibrary, SaysWhatTheTestItselfLeavesOpen) {
  const test::TemporaryDirectory directory;
  const PressNumbers n = press_of(kInside);
  const auto remarks = [&](const std::string& path) {
    return join_text(law_of_press_test(pressed_library(), path, 0.35).remarks, "|");
  };
  const std::string deep = remarks(press_test(directory.path() + "/deep.csv", n, ""));
  EXPECT_EQ(deep.find("is extrapolated"), std::string::npos) << deep;
  expect_says(deep, "law of the press test: underdetermined (");
  const std::string shallow = remarks(press_test(directory.path() + "/shallow.csv", n, "", 9));
  expect_says(shallow, "ends at Delta = 0.18: its force at 0.3 is extrapolated");
  LawCard card = card_of_press_test(directory.path() + "/deep.csv");
  const auto scatter = [&] {
    double sum = 0.0;
    const PressQuestion q = press_question(card, 0.35, "card");
    for (const PressNumbers& draw : q.draws) sum += std::abs(draw.ln_deep - q.numbers.ln_deep);
    return sum / static_cast<double>(q.draws.size());
  };
  const auto with_samples = [&](int samples) {
    for (PairLaw& law : card.pairs) {
      law.band_origin = kFromSamples;
      law.packings = samples;
    }
    return scatter();
  };
  const double of_two = with_samples(2);
  EXPECT_GT(of_two, 3.0 * with_samples(1000)) << "Student's t of two samples";
  for (PairLaw& law : card.pairs) law.covariance.assign(49, 0.0);
  EXPECT_TRUE(press_question(card, 0.35, "card").draws.empty());
}

TEST(PressLibrary, ScenesNameThePressTest) {
  const test::TemporaryDirectory directory;
  write_text_atomic(directory.path() + "/library.toml", library_text(pressed_library(), build_provenance()));
  (void)press_test(directory.path() + "/press.csv", press_of(kInside), "# mu = 0.35\n");
  const auto law_of = [&](const std::string& keys) {
    const std::string scene = directory.path() + "/scene.toml";
    write_text_atomic(scene, "kind = \"macro\"\n[library]\n" + keys);
    return law_at(Scene::load(scene).root(), directory.path() + "/library.toml");
  };
  const FittedLaw law = law_of("press_test = \"press.csv\"\n");
  ASSERT_NE(law.table(), nullptr);
  EXPECT_EQ(law.table()->entries.front().source, TableSource::press_test);
  expect_says(law.remark, "press test: F (1 - nu^2)/(E Rs^2) = ");
  expect_says(complaint([&] { (void)law_of("press_test = \"press.csv\"\nratio = 6.0\n"); }),
              "goes without press_test, whose table says what is known");
  expect_says(complaint([&] { (void)law_of("press_test = \"none.csv\"\n"); }), "none.csv");
}

}  // namespace
}  // namespace softgrain
