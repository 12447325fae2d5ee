// Exported pair tables, read back from their text: geometry, force = -dE/dr, and the laws behind them.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "pipelines/law/pair_table.h"
#include "tests/support/synthetic_multi_contact.h"

namespace softgrain {
namespace {

struct ReadTable {
  std::size_t n = 0;
  double low = 0.0;
  double high = 0.0;
  double slope_low = 0.0;
  double slope_high = 1.0;
  std::vector<double> r, energy, force;
};

/// As LAMMPS reads it: keyword, parameters, blank line, N rows.
std::map<std::string, ReadTable> read_lammps(const std::string& text) {
  std::map<std::string, ReadTable> out;
  std::istringstream in(text);
  std::string line;
  EXPECT_TRUE(std::getline(in, line) && line.find("UNITS: si") != std::string::npos);
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    ReadTable& t = out[line];
    std::string word[3];
    std::getline(in, line);
    std::istringstream(line) >> word[0] >> t.n >> word[1] >> t.low >> t.high >> word[2] >> t.slope_low >> t.slope_high;
    EXPECT_EQ(word[0] + word[1] + word[2], "NRFPRIME");
    std::getline(in, line);
    EXPECT_TRUE(line.empty());
    for (std::size_t k = 1; k <= t.n; ++k) {
      std::size_t index = 0;
      double r = 0.0, e = 0.0, f = 0.0;
      std::getline(in, line);
      std::istringstream(line) >> index >> r >> e >> f;
      EXPECT_EQ(index, k);
      t.r.push_back(r);
      t.energy.push_back(e);
      t.force.push_back(f);
    }
  }
  return out;
}

/// force = -dE/dr by central differences; where the force has a kink (thresholds, ends of ranges) they are off by as
/// much as the force bends there.
void expect_derivative(const std::vector<double>& energy, const std::vector<double>& force, double step,
                       double tolerance) {
  for (std::size_t k = 1; k + 1 < force.size(); ++k) {
    const double bend = std::abs(force[k + 1] - 2.0 * force[k] + force[k - 1]);
    EXPECT_NEAR(-(energy[k + 1] - energy[k - 1]) / (2.0 * step), force[k], tolerance + 0.5 * bend) << k;
  }
}

/// Ascending even steps, zero at touch, and the trapezoid of the force is the energy.
void expect_sound(const ReadTable& t, double touch) {
  ASSERT_EQ(t.r.size(), t.n);
  EXPECT_EQ(t.r.front(), t.low);
  EXPECT_EQ(t.r.back(), t.high);
  EXPECT_NEAR(t.high, touch, 1e-15);
  EXPECT_EQ(t.energy.back(), 0.0);
  EXPECT_EQ(t.force.back(), 0.0);
  EXPECT_EQ(t.slope_high, 0.0);
  const double step = (t.high - t.low) / static_cast<double>(t.n - 1);
  const double scale = t.force.front();
  EXPECT_GT(scale, 0.0);
  for (std::size_t k = 1; k < t.n; ++k) EXPECT_NEAR(t.r[k] - t.r[k - 1], step, 1e-9 * step);
  expect_derivative(t.energy, t.force, step, 2e-5 * scale);
  // One-sided, second order.
  const double slope = (-3.0 * t.force[0] + 4.0 * t.force[1] - t.force[2]) / (2.0 * step);
  EXPECT_NEAR(t.slope_low, slope, 1e-3 * std::abs(slope));
}

FittedLaw published() { return load_law(std::string(SOFTGRAIN_SOURCE_DIR) + "/results/published/law.toml"); }

law::PairTableChoice choice() {
  law::PairTableChoice c;
  c.modulus = 2e6;
  c.radius = 0.01;
  c.ratios = {1.0, 0.5, 3.0};
  return c;
}

TEST(PairTable, OfACard) {
  const FittedLaw file = published();
  const auto tables = read_lammps(law::lammps_text(law::pair_tables(file, choice()), {"a remark"}));
  ASSERT_EQ(tables.size(), 6u);
  for (const double ratio : choice().ratios) {
    const std::string text = ratio == 0.5 ? "0.5" : (ratio == 1.0 ? "1" : "3");
    const double touch = 0.01 * (1.0 + ratio);
    expect_sound(tables.at("SOFT_SOLID_" + text), touch);
    expect_sound(tables.at("SOFT_SOFT_" + text), touch);
    const ReadTable& solid = tables.at("SOFT_SOLID_" + text);
    EXPECT_NEAR(touch - solid.low, 0.3 * 0.01, 1e-15);
    const PairLaw& law = *file.card()->find(PairKind::soft_solid);
    for (std::size_t k = 0; k < solid.n; k += 50) {
      const double expected = 2e6 * 1e-4 * std::max(law.normal.value((touch - solid.r[k]) / 0.01), 0.0);
      EXPECT_NEAR(solid.force[k], expected, 1e-10 * solid.force.front());
    }
    // Soft-soft: Delta over the smaller radius.
    EXPECT_NEAR(touch - tables.at("SOFT_SOFT_" + text).low, 0.4 * 0.01 * std::min(1.0, ratio), 1e-15);
  }
}

TEST(PairTable, OfALawTable) {
  LawTableEntry entry = synthetic::law_entry();
  entry.volume_max = 0.5;
  entry.laws[2].partners[0].overlap_max = 0.8;  // or the smaller ones never press hard enough
  entry.laws[2].partners[3].overlap_max = 0.6;
  const FittedLaw file{LawTable{1, {entry}}};
  law::PairTableChoice c = choice();
  c.ratios = {1.0, 0.5, 2.0};
  const auto tables = read_lammps(law::lammps_text(law::pair_tables(file, c), {}));
  ASSERT_EQ(tables.size(), 6u);
  const MultiContactModel model = multi_contact_model(*entry.find(entry.best));
  for (const double ratio : c.ratios) {
    const std::string text = ratio == 0.5 ? "0.5" : (ratio == 1.0 ? "1" : "2");
    const double touch = 0.01 * (1.0 + ratio);
    for (const auto& [name, kind] :
         {std::pair{"SOFT_SOLID_", PartnerKind::solid}, std::pair{"SOFT_SOFT_", PartnerKind::soft}}) {
      const ReadTable& t = tables.at(name + text);
      expect_sound(t, touch);
      for (std::size_t k = 0; k < t.n; k += 50) {
        const double h = (touch - t.r[k]) / 0.01;
        const double expected =
            2e6 * 1e-4 * multi_contact_forces(model, {{kind, ratio, {{1.0, 0.0, 0.0}}}}, {h}).front();
        EXPECT_NEAR(t.force[k], expected, 1e-10 * t.force.front());
      }
    }
  }
}

TEST(PairTable, AClampedLawStaysConstantAndItsEnergyGoesOn) {
  law::PairTableChoice c = choice();
  c.ratios = {1.0};
  c.beyond = Extrapolation::clamp;
  c.delta_max = 0.45;
  c.kinds = {PairKind::soft_solid};
  const law::PairTable t = law::pair_tables(published(), c).front();
  EXPECT_EQ(t.force[0], t.force[1]);
  EXPECT_EQ(t.slope_low, 0.0) << "of a constant force";
  EXPECT_NE(t.meaning.find(" m, clamped beyond: "), std::string::npos) << t.meaning;
  EXPECT_NEAR((t.energy[0] - t.energy[1]) / (t.r[1] - t.r[0]), t.force[0], 1e-6 * t.force[0]);
  LawTableEntry entry = synthetic::law_entry();
  entry.volume_max = 0.01;
  const law::PairTable clamped = law::pair_tables({LawTable{1, {entry}}}, c).front();
  EXPECT_NE(clamped.meaning.find("extrapolated beyond, clamped above a lost volume of 0.01 R^3"), std::string::npos);
  const double step = clamped.r[1] - clamped.r[0];
  expect_derivative(clamped.energy, clamped.force, step, 2e-4 * clamped.force.front());
}

TEST(PairTable, WhatCannotBe) {
  law::PairTableChoice c = choice();
  c.beyond = Extrapolation::error;
  c.delta_max = 0.5;
  EXPECT_THROW((void)law::pair_tables(published(), c), InputError);
  c.beyond = Extrapolation::extrapolate;
  c.delta_max = 1.0;
  c.ratios = {0.01};
  EXPECT_THROW((void)law::pair_tables(published(), c), InputError);
  c.delta_max.reset();
  c.ratios = {1.0, 1.0000001};  // one section name; LAMMPS reads the first
  EXPECT_THROW((void)law::pair_tables(published(), c), InputError);
}

}  // namespace
}  // namespace softgrain
