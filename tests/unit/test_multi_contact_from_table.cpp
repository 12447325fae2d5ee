// From a law table to the contact loop: choices, refusals, and the same forces as the prediction.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/dynamics/force_pass.h"
#include "macrosim/macro_system.h"
#include "pipelines/law/named_laws.h"
#include "tests/support/synthetic_multi_contact.h"

namespace softgrain {
namespace {

using synthetic::law_entry;

using Directional = SoftMultiContact<LawForm::directional, false>;

TEST(MultiContactFromTable, FrictionAsMeasuredOrAsChosen) {
  const LawTableEntry entry = law_entry();
  MultiContactChoices choices;
  choices.modulus = 3e5;
  MultiContactLaws laws = make_multi_contact_laws(entry, choices);
  EXPECT_EQ(std::get<Directional>(laws.soft_plane).friction, entry.slide_plane.friction.value);
  EXPECT_EQ(std::get<Directional>(laws.soft_solid).friction, entry.slide_solid.friction.value);
  EXPECT_EQ(std::get<Directional>(laws.solid_soft).friction, entry.slide_solid.friction.value);
  EXPECT_EQ(std::get<Directional>(laws.soft_soft).friction, entry.slide_soft.friction.value);
  EXPECT_EQ(std::get<Directional>(laws.soft_soft).kt_ratio, entry.slide_soft.kt_ratio.value);
  EXPECT_EQ(std::get<Directional>(laws.soft_plane).modulus, 3e5);
  choices.friction = 0.0;
  laws = make_multi_contact_laws(entry, choices);
  for (const AnyLaw& law : {laws.soft_plane, laws.soft_solid, laws.solid_soft, laws.soft_soft})
    EXPECT_EQ(std::get<Directional>(law).friction, 0.0);
}

TEST(MultiContactFromTable, WhoIsSoft) {
  const MultiContactLaws laws = make_multi_contact_laws(law_entry(), {});
  EXPECT_TRUE(std::get<Directional>(laws.soft_solid).i_is_soft);
  EXPECT_FALSE(std::get<Directional>(laws.soft_solid).j_is_soft);
  EXPECT_FALSE(std::get<Directional>(laws.solid_soft).i_is_soft);
  EXPECT_TRUE(std::get<Directional>(laws.solid_soft).j_is_soft);
  EXPECT_TRUE(std::get<Directional>(laws.soft_soft).i_is_soft);
  EXPECT_TRUE(std::get<Directional>(laws.soft_soft).j_is_soft);
}

TEST(MultiContactFromTable, FormAndUnloadingChooseTheTypeOfTheLaw) {
  const LawTableEntry entry = law_entry();
  const auto law = [&](LawForm form, bool unloading) {
    MultiContactChoices choices;
    choices.form = form;
    choices.unloading = unloading;
    return make_multi_contact_laws(entry, choices).soft_soft;
  };
  EXPECT_TRUE((std::holds_alternative<SoftMultiContact<LawForm::pair, false>>(law(LawForm::pair, false))));
  EXPECT_TRUE((std::holds_alternative<SoftMultiContact<LawForm::isotropic, false>>(law(LawForm::isotropic, false))));
  EXPECT_TRUE((std::holds_alternative<SoftMultiContact<LawForm::directional, true>>(law(LawForm::directional, true))));
  EXPECT_EQ((std::get<SoftMultiContact<LawForm::isotropic, true>>(law(LawForm::isotropic, true)).unloading),
            entry.unloading.value);
}

TEST(MultiContactFromTable, EveryKindOfNeighbourComesBackInItsOwnWay) {
  LawTableEntry entry = law_entry();
  entry.slide_solid.unloading.value = 1.25;
  entry.slide_solid.has_unloading = true;
  MultiContactChoices choices;
  choices.form = LawForm::isotropic;
  choices.unloading = true;
  const MultiContactLaws laws = make_multi_contact_laws(entry, choices);
  const auto unloading = [](const AnyLaw& law) {
    return std::get<SoftMultiContact<LawForm::isotropic, true>>(law).unloading;
  };
  EXPECT_EQ(unloading(laws.soft_plane), entry.unloading.value);
  EXPECT_EQ(unloading(laws.soft_solid), 1.25);
  EXPECT_EQ(unloading(laws.solid_soft), 1.25);
  EXPECT_EQ(unloading(laws.soft_soft), entry.unloading.value);
}

/// What was not measured to roll rolls freely under a law whose others do not.
TEST(MultiContactFromTable, RollingComesWhereItWasMeasuredAndIsAsked) {
  LawTableEntry entry = law_entry();
  const std::string before = numbers_of(entry, LawForm::directional);
  entry.slide_soft.rolling.value = 0.004;
  entry.slide_soft.rolling_friction.value = 0.12;
  entry.slide_soft.rolls = true;
  EXPECT_NE(numbers_of(entry, LawForm::directional), before) << "other forces, another name";
  MultiContactChoices choices;
  const MultiContactLaws laws = make_multi_contact_laws(entry, choices);
  using Rolling = SoftMultiContact<LawForm::directional, false, true>;
  EXPECT_EQ(std::get<Rolling>(laws.soft_soft).rolling, 0.004);
  EXPECT_EQ(std::get<Rolling>(laws.soft_soft).rolling_friction, 0.12);
  EXPECT_EQ(std::get<Rolling>(laws.soft_plane).rolling, 0.0);
  choices.rolling = false;
  EXPECT_TRUE(std::holds_alternative<Directional>(make_multi_contact_laws(entry, choices).soft_soft));
}

TEST(MultiContactFromTable, WhatIsNotUsableIsRefused) {
  const auto refused = [](const LawTableEntry& entry, LawForm form, const std::string& word) {
    MultiContactChoices choices;
    choices.form = form;
    try {
      (void)make_multi_contact_laws(entry, choices);
      ADD_FAILURE() << word;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  LawTableEntry entry = law_entry();
  LawTableEntry two = entry;
  two.laws.pop_back();
  refused(two, LawForm::directional, "no law of the form \"directional\"; there is pair, isotropic");
  entry.laws[1].status = LawStatus::no_threshold_crossing;
  entry.laws[1].reason = "the threshold lies beyond";
  refused(entry, LawForm::isotropic, "the threshold lies beyond");
  entry.laws[2].partners.resize(2);  // solid rows only
  refused(entry, LawForm::directional, "no soft neighbours");
  entry.laws[0].partners.erase(entry.laws[0].partners.begin(), entry.laws[0].partners.begin() + 2);
  refused(entry, LawForm::pair, "no solid neighbours");
}

/// A soft particle and fixed neighbours of all kinds that are blind to each other.
class PredictionAndLoop : public ::testing::TestWithParam<LawForm> {
 protected:
  static constexpr double kRadius = 0.013;
  static constexpr double kModulus = 4.2e5;

  void SetUp() override {
    entry_ = law_entry();
    MultiContactChoices choices;
    choices.form = GetParam();
    choices.modulus = kModulus;
    const MultiContactLaws laws = make_multi_contact_laws(entry_, choices);
    for (const char* name : {"centre", "solid", "soft", "wall"})
      system_.materials.push_back({name, 2500.0, kModulus, 0.3, false});
    system_.laws = LawSet(4);
    system_.laws.set(0, 1, laws.soft_solid, true);
    system_.laws.set(1, 0, laws.solid_soft, true);
    system_.laws.set(0, 2, laws.soft_soft);
    system_.laws.set(0, 3, laws.soft_plane);
  }

  Slot add(const Vec3& x, double r, std::int32_t material) {
    NewBody<3> body;
    body.x = x;
    body.r = r;
    body.mass = body.inertia = 1.0;
    body.material = material;
    return add_grain(system_.particles, body);
  }
  Slot add(const MultiContactPartner& p, double overlap) {
    const Vec3 x = p.direction * (kRadius * (1.0 + p.ratio - overlap));
    if (p.kind != PartnerKind::plane) return add(x, kRadius * p.ratio, p.kind == PartnerKind::solid ? 1 : 2);
    NewBody<3> plane;
    plane.x = x;
    plane.material = 3;
    return add_plane(system_.particles, plane, -p.direction);
  }

  LawTableEntry entry_;
  System3 system_;
};

TEST_P(PredictionAndLoop, GiveTheSameForces) {
  // The first one comes before the centre in the list, where the order of the bodies is the other way round.
  const std::vector<MultiContactPartner> partners{
      {PartnerKind::solid, 3.0, {{1.0, 0.0, 0.0}}},    {PartnerKind::soft, 1.7, {{-1.0, 0.0, 0.0}}},
      {PartnerKind::solid, 0.4, {{0.0, 0.6, 0.8}}},    {PartnerKind::soft, 0.6, {{0.0, -0.8, 0.6}}},
      {PartnerKind::solid, 200.0, {{0.0, 0.8, -0.6}}}, {PartnerKind::plane, 0.0, {{0.0, 0.0, -1.0}}},
      {PartnerKind::plane, 0.0, {{0.48, -0.6, -0.64}}}};
  const std::vector<double> overlap{0.15, 0.31, 0.13, 0.22, 0.05, 0.11, 0.17};
  std::vector<Slot> slots{add(partners[0], overlap[0])};
  const Slot centre = add(Vec3{}, kRadius, 0);
  for (std::size_t k = 1; k < partners.size(); ++k) slots.push_back(add(partners[k], overlap[k]));
  force_pass(system_, 0.0);
  const auto expected = multi_contact_forces(multi_contact_model(*entry_.find(GetParam())), partners, overlap);
  Vec3 sum{};
  for (std::size_t k = 0; k < partners.size(); ++k) {
    const Vec3 force = system_.particles.force[static_cast<std::size_t>(slots[k])];
    const double wanted = kModulus * kRadius * kRadius * expected[k];
    EXPECT_NEAR(dot(force, partners[k].direction), wanted, 1e-12 * kModulus * kRadius * kRadius) << k;
    EXPECT_NEAR(norm(force), wanted, 1e-12 * kModulus * kRadius * kRadius) << k;
    sum += force;
  }
  EXPECT_GT(expected[1], 1e-4);
  const Vec3 on_centre = system_.particles.force[static_cast<std::size_t>(centre)];
  EXPECT_LT(norm(sum + on_centre), 1e-12 * norm(on_centre));
}

/// One neighbour alone: all forms are the pair law of its kind.
TEST_P(PredictionAndLoop, OneNeighbourFeelsThePairLaw) {
  MultiContactLaw pair = *entry_.find(GetParam());
  pair.form = LawForm::pair;
  const MultiContactPartner p{PartnerKind::soft, 1.7, {{0.0, 0.6, 0.8}}};
  add(Vec3{}, kRadius, 0);
  const Slot slot = add(p, 0.33);
  force_pass(system_, 0.0);
  const double expected = multi_contact_forces(multi_contact_model(pair), {p}, {0.33})[0];
  const Vec3 force = system_.particles.force[static_cast<std::size_t>(slot)];
  EXPECT_GT(expected, 1e-4);
  EXPECT_NEAR(dot(force, p.direction), kModulus * kRadius * kRadius * expected, 1e-12 * kModulus * kRadius * kRadius);
}

INSTANTIATE_TEST_SUITE_P(Forms, PredictionAndLoop,
                         ::testing::Values(LawForm::pair, LawForm::isotropic, LawForm::directional));

MacroSpec spec_of_table() {
  MacroSpec spec;
  spec.friction = law_entry().spec.friction;
  spec.poisson_ratio = law_entry().spec.poisson_ratio;
  spec.wall_friction = 0.07;
  return spec;
}

LawSources sources(WantedForm form = {}) {
  LawSources out;
  out.laws = {{LawTable{1, {law_entry()}}}};
  out.forms = {form};
  return out;
}

TEST(TableLawOfAScene, WallFrictionIsThatOfTheScene) {
  const NamedLaws law = scene_law(sources(), spec_of_table(), 0.7, "law");
  EXPECT_EQ(law.name, "law");
  EXPECT_EQ(law.form, LawForm::directional);
  EXPECT_EQ(std::get<Directional>(law.laws.soft_wall).friction, 0.07);
  EXPECT_EQ(std::get<Directional>(law.laws.soft_wall).kt_ratio, law_entry().slide_plane.kt_ratio.value);
  EXPECT_EQ(std::get<Directional>(law.laws.soft_solid).friction, law_entry().slide_solid.friction.value);
  LawSources chosen = sources(LawForm::isotropic);
  chosen.friction = 0.11;
  const NamedLaws bag = scene_law(chosen, spec_of_table(), 0.7, "law");
  EXPECT_EQ(bag.form, LawForm::isotropic);
  EXPECT_EQ((std::get<SoftMultiContact<LawForm::isotropic, false>>(bag.laws.soft_soft).friction), 0.11);
  EXPECT_EQ((std::get<SoftMultiContact<LawForm::isotropic, false>>(bag.laws.soft_wall).friction), 0.07);
}

/// The number changes what tells laws apart; without it they have the names that they had.
TEST(TableLawOfAScene, AMemoryOfParticlesIsPartOfTheLaw) {
  using Isotropic = SoftMultiContact<LawForm::isotropic, false>;
  LawSources chosen = sources(LawForm::isotropic);
  const NamedLaws off = scene_law(chosen, spec_of_table(), 0.7, "law");
  EXPECT_FALSE(std::get<Isotropic>(off.laws.soft_wall).remembers());
  chosen.unloading_ratio = 1.3;
  const NamedLaws on = scene_law(chosen, spec_of_table(), 0.7, "law");
  for (const AnyLaw& law : {on.laws.soft_solid, on.laws.solid_soft, on.laws.soft_wall, on.laws.soft_soft}) {
    EXPECT_EQ(std::get<Isotropic>(law).unloading_ratio, 1.3);
    EXPECT_TRUE(std::get<Isotropic>(law).remembers());
  }
  EXPECT_NE(on.identity.hash, off.identity.hash);
  EXPECT_NE(on.tag, off.tag);
  chosen.unloading_ratio = 1.4;
  EXPECT_NE(scene_law(chosen, spec_of_table(), 0.7, "law").identity.hash, on.identity.hash);
  EXPECT_NE(scene_law(chosen, spec_of_table(), 0.7, "law").tag, on.tag);
}

TEST(TableLawOfAScene, AMemoryOfParticlesGoesWithOnePressureAlone) {
  for (const LawForm form : {LawForm::pair, LawForm::isotropic, LawForm::directional})
    for (const bool unloading : {false, true}) {
      MultiContactChoices choices;
      choices.form = form;
      choices.unloading = unloading;
      choices.unloading_ratio = 1.3;
      if (form == LawForm::isotropic && !unloading)
        EXPECT_NO_THROW((void)make_multi_contact_laws(law_entry(), choices));
      else
        EXPECT_THROW((void)make_multi_contact_laws(law_entry(), choices), InputError) << to_string(form) << unloading;
    }
}

/// Forces change by a fifth for 0.01 in solid fraction, so that a law of other contents is named.
TEST(TableLawOfAScene, OtherContentsAreNamed) {
  const double its = law_entry().solid_fraction;
  System3 nothing;
  const auto note_of = [&](double contents) {
    return scene_law(sources(), spec_of_table(), contents, "law").note(nothing);
  };
  const std::string said = "the contents of the twins have " + fmt::format("{:.4f}", its + 0.01);
  EXPECT_NE(note_of(its + 0.01).find(said), std::string::npos) << note_of(its + 0.01);
  EXPECT_EQ(note_of(its + 0.004).find("contents of the twins"), std::string::npos);
  EXPECT_EQ(note_of(0.0).find("contents of the twins"), std::string::npos) << "no contents";
}

TEST(TableLawOfAScene, OtherGrainsAreRefused) {
  MacroSpec spec = spec_of_table();
  spec.friction = 0.5;
  EXPECT_THROW((void)scene_law(sources(), spec, 0.7, "law"), InputError);
  spec = spec_of_table();
  spec.poisson_ratio = 0.2;
  EXPECT_THROW((void)scene_law(sources(), spec, 0.7, "law"), InputError);
  EXPECT_THROW((void)scene_law(sources(), spec_of_table(), 0.5, "law"), InputError);
}

/// Four bodies in a box that they overlap.
System3 small_scene(double modulus) {
  MacroSpec spec = spec_of_table();
  spec.youngs_modulus = modulus;
  MacroPacking packing;
  packing.low = {{0.0, 0.0, 0.0}};
  packing.high = {{0.036, 0.036, 0.036}};
  packing.bodies = {{{{0.0085, 0.0085, 0.0085}}, 0.01, true},
                    {{{0.0255, 0.0085, 0.0085}}, 0.01, false},
                    {{{0.0085, 0.0255, 0.0085}}, 0.01, true},
                    {{{0.0085, 0.0085, 0.0255}}, 0.0095, false}};
  System3 s = make_law_system(spec, packing, scene_law(sources(), spec, 0.7, "law").laws, 0.7).system;
  force_pass(s, 0.0);
  return s;
}

TEST(TableLawOfAScene, ForcesScaleWithE) {
  const System3 one = small_scene(5e5);
  const System3 four = small_scene(2e6);
  for (std::size_t k = 0; k < one.particles.force.size(); ++k) {
    const Vec3 a = one.particles.force[k];
    const Vec3 b = four.particles.force[k];
    EXPECT_EQ(a * 4.0, b) << k;
  }
  EXPECT_GT(norm(static_cast<Vec3>(one.particles.force[0])), 1e-3);
  EXPECT_FALSE(one.contacts.particle_sum.empty());
}

/// A wall that is less rough than grains counts less: between planes without friction and those with that of the
/// grains.
TEST(MultiContactFromTable, WallsCountByTheirFriction) {
  LawTableEntry entry = law_entry();
  entry.spec.friction = 0.3;
  const auto plane = [&](double wall_friction) {
    MultiContactChoices choices;
    choices.modulus = 1.0;
    choices.wall_friction = wall_friction;
    return std::get<Directional>(make_multi_contact_laws(entry, choices).soft_plane).partner.at(0.0);
  };
  EXPECT_EQ(plane(0.0).a, 1.0) << "not measured: like any plane";
  for (MultiContactLaw& law : entry.laws) {
    PartnerRow row;
    row.kind = PartnerKind::plane;
    row.ratio = 0.0;
    row.weight.value = 0.64;
    row.exponent.value = 1.2;
    law.partners.push_back(row);
  }
  EXPECT_EQ(plane(-1.0).a, 1.0);
  EXPECT_NEAR(plane(0.0).a, 0.64, 1e-12);
  EXPECT_NEAR(plane(0.0).b, 1.2, 1e-12);
  EXPECT_NEAR(plane(0.15).a, 0.8, 1e-12);
  EXPECT_NEAR(plane(0.15).b, 1.1, 1e-12);
  EXPECT_EQ(plane(0.3).a, 1.0);
  EXPECT_EQ(plane(0.9).b, 1.0);
  MultiContactChoices choices;
  choices.modulus = 1.0;
  choices.wall_friction = 0.0;
  EXPECT_EQ(std::get<Directional>(make_multi_contact_laws(entry, choices).soft_solid).partner.at(0.0).a, 1.0)
      << "shells do not";
}

}  // namespace
}  // namespace softgrain
