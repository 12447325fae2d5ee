// Numbers of result files that must be finite, and those that need not be.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/data/law_card_format.h"
#include "common/data/multi_contact_replicates.h"
#include "macrosim/body_contacts.h"
#include "macrosim/macro_packing.h"
#include "pipelines/kinds/material/equation.h"
#include "pipelines/kinds/material/scene.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using Edit = std::function<void(test::Hdf5Edit&)>;

/// The message of IoError; empty where the file is read.
std::string refusal_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const IoError& e) {
    return e.what();
  }
  return "";
}

class ResultValues : public testing::Test {
 protected:
  /// What check_table() has against a card's .h5 after these changes.
  std::string card(const LawCard& written, const Edit& edit) const {
    save_card(written, directory_.file("law.toml"));
    return edited("law.h5", edit, check_table);
  }
  std::string table(const Edit& edit) const {
    LawTable all{1, {synthetic::law_entry()}};
    for (MultiContactLaw& law : all.entries[0].laws) law.replicates.assign(2, multi_contact_numbers(law));
    save_law_table(all, directory_.file("law_table.toml"));
    return edited("law_table.h5", edit, check_replicates);
  }
  std::string packing(const MacroPacking& written, const Edit& edit) const {
    {
      h5::AtomicFile file(directory_.file("packing.h5"));
      write_macro_packing(file.root().create("sample_0"), written);
      file.commit();
    }
    return edited("packing.h5", edit,
                  [](const std::string& path) { (void)read_macro_packing(h5::open_file(path).open("sample_0")); });
  }

 private:
  std::string edited(const std::string& name, const Edit& edit,
                     const std::function<void(const std::string&)>& read) const {
    const std::string path = directory_.file(name);
    {
      test::Hdf5Edit file(path);
      edit(file);
    }
    return refusal_of([&] { read(path); });
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ResultValues, AFitThatFailedMayHaveAnyNumbers) {
  const Edit nothing_known = [](test::Hdf5Edit& f) { f.set("soft-soft/normal/a", 0, kNaN); };
  LawCard c = synthetic::card();
  EXPECT_NE(card(c, nothing_known), "");
  c.pairs[1].status = LawStatus::no_threshold_crossing;
  EXPECT_EQ(card(c, nothing_known), "");
  EXPECT_NE(card(c, [](test::Hdf5Edit& f) { f.set("soft-solid/normal/a", 0, kNaN); }), "") << "that of the other pair";
}

TEST_F(ResultValues, ErrorsOfParametersMayBeInfinite) {
  EXPECT_EQ(card(synthetic::card(), [](test::Hdf5Edit& f) { f.set("soft-solid/normal/b", 1, kInfinity); }), "");
  EXPECT_EQ(table([](test::Hdf5Edit& f) { f.set("entry_0/directional/parameters", 1, kInfinity); }), "");
  EXPECT_NE(table([](test::Hdf5Edit& f) { f.set("entry_0/directional/parameters", 0, kInfinity); }), "");
}

/// No run takes another form of a table unless it is asked for.
TEST_F(ResultValues, OfATableTheBestFormMustBeKnown) {
  const auto parameter = [](const std::string& form) {
    return [form](test::Hdf5Edit& f) { f.set("entry_0/" + form + "/parameters", 0, kNaN); };
  };
  EXPECT_NE(table(parameter("directional")), "");
  EXPECT_EQ(table(parameter("pair")), "");
}

TEST_F(ResultValues, HistoriesAndCornersOfPackings) {
  MacroPacking p;
  p.high = {{1.0, 1.0, 1.0}};
  p.bodies = {{{{0.3, 0.5, 0.5}}, 0.1, false}, {{{0.5, 0.5, 0.5}}, 0.1, false}};
  p.springs = {{0, 1, {{1e-4, 0.0, 0.0}}, {{0.0, 1e-3, 0.0}}}};
  EXPECT_EQ(packing(p, [](test::Hdf5Edit&) {}), "");
  const auto expect = [&](const std::string& set, std::size_t place, double value, const std::string& words) {
    const std::string found = packing(p, [&](test::Hdf5Edit& f) { f.set("sample_0/" + set, place, value); });
    EXPECT_NE(found.find(words), std::string::npos) << set << ": " << found;
  };
  expect("springs", 1, kNaN, "'springs' or 'rolls' holds a number that is not finite");
  expect("rolls", 2, kInfinity, "'springs' or 'rolls' holds a number that is not finite");
  expect("box", 0, kNaN, "'box' holds a number that is not finite");
  expect("bodies", 7, kNaN, "a radius that is not above 0");
}

/// Files that name no stages need not have the stress of each axis: sides then bear the same.
TEST(ResultCurves, MeanStressesWithoutThoseOfEachAxis) {
  MacroCurve c;
  c.strain = {0.0, 0.1};
  c.stress_axial = {3.0, 9.0};
  c.stress_lateral = {3.0, 6.0};
  EXPECT_EQ(mean_stresses(c), (std::vector<double>{3.0, 7.0}));
  c.stress_x = {3.0, 4.0};
  c.stress_y = {3.0, 2.0};
  EXPECT_EQ(mean_stresses(c), (std::vector<double>{3.0, 5.0}));
  c.stress_y.clear();
  EXPECT_EQ(mean_stresses(c), (std::vector<double>{3.0, 7.0}));
}

/// Nothing says whether such a curve compresses.
TEST(ResultCurves, WithoutStagesNoneTakesPartInTheEquationOfState) {
  MacroCurve c;
  for (int k = 0; k < 5; ++k) {
    c.strain.push_back(0.01 * k);
    c.stress_axial.push_back(1.0 + k);
    c.more[kSolidFraction].push_back(0.6 + 0.01 * k);
  }
  c.stress_lateral = c.stress_axial;
  c.start.youngs_modulus = 1e6;
  EXPECT_TRUE(state_curve(c, "", 1.0).phi.empty());
  c.stages = {StageRecord{}};
  c.stage.assign(c.strain.size(), 0.0);
  EXPECT_EQ(state_curve(c, "", 1.0).phi.size(), 5U);
}

}  // namespace
}  // namespace softgrain
