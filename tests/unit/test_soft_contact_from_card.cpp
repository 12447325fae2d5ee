// A law card becomes the law of the loop, or is refused with the reason.
#include "common/contact/make_laws.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "common/data/law_words.h"

namespace {

using namespace softgrain;

LawCard card_with(PairKind kind, LawStatus status) {
  PairLaw law;
  law.kind = kind;
  law.status = status;
  law.reason = "because";
  law.normal.a.value = 0.6;
  law.normal.b.value = 2.2;
  law.normal.delta.value = 0.05;
  law.normal.c.value = -0.6 * std::pow(0.05, 2.2);
  law.tangential_initial = law.normal;
  law.tangential_initial.a.value = 1.5;
  law.tangential_secant = law.normal;
  law.tangential_secant.a.value = 1.2;
  law.has_tangential_initial = law.has_tangential_secant = true;
  LawCard card;
  card.pairs.push_back(law);
  return card;
}

ContactState<3> pressed(const SoftContact& law, double ratio) {
  ContactState<3> state;
  state.constants = law.pair_constants({0.02, 0.03, 1.0, 1.0});
  state.overlap = ratio * state.constants.a;
  state.normal = {{1.0, 0.0, 0.0}};
  return state;
}

TEST(SoftContactFromCard, ScalesWithModulusAndRadius) {
  const LawCard card = card_with(PairKind::soft_soft, LawStatus::good);
  const SoftContact law = make_soft_contact(card, PairKind::soft_soft, 4e5, 0.3, 0.1, false);
  EXPECT_TRUE(law.partner_is_soft);
  const auto r = law.evaluate(pressed(law, 0.3));
  EXPECT_NEAR(r.elastic_force, 4e5 * 0.02 * 0.02 * (0.6 * std::pow(0.3, 2.2) - 0.6 * std::pow(0.05, 2.2)), 1e-12);
  EXPECT_NEAR(r.tangential_stiffness, 4e5 * 0.02 * 1.5 * (std::pow(0.3, 2.2) - std::pow(0.05, 2.2)), 1e-9);
  EXPECT_EQ(law.evaluate(pressed(law, 0.05)).elastic_force, 0.0) << "zero at the threshold";
  EXPECT_EQ(law.evaluate(pressed(law, 0.04)).elastic_force, 0.0);
  const SoftContact secant = make_soft_contact(card, PairKind::soft_soft, 4e5, 0.3, 0.1, true);
  EXPECT_LT(secant.evaluate(pressed(secant, 0.3)).tangential_stiffness, r.tangential_stiffness);
}

/// Without a measured kt there was none at all, and mu of a scene changed no digit.
TEST(SoftContactFromCard, AStiffnessThatWasNotMeasuredIsAssumed) {
  LawCard card = card_with(PairKind::soft_soft, LawStatus::good);
  card.pairs[0].has_tangential_initial = card.pairs[0].has_tangential_secant = false;
  card.spec.poisson_ratio = 0.2;
  for (const bool secant : {false, true}) {
    const SoftContact law = make_soft_contact(card, PairKind::soft_soft, 4e5, 0.3, 0.1, secant);
    for (const double ratio : {0.06, 0.3}) {
      const auto r = law.evaluate(pressed(law, ratio));
      EXPECT_GT(r.normal_stiffness, 0.0);
      EXPECT_NEAR(r.tangential_stiffness / r.normal_stiffness, 2.0 * 0.8 / 1.8, 1e-12);
    }
    EXPECT_EQ(law.evaluate(pressed(law, 0.04)).tangential_stiffness, 0.0);
  }
  card.spec.poisson_ratio = std::nan("");
  EXPECT_NEAR(assumed_kt_ratio(card, card.pairs[0]), 1.4 / 1.7, 1e-15);
  card.pairs[0].kt_ratio = 0.5;
  const SoftContact said = make_soft_contact(card, PairKind::soft_soft, 4e5, 0.3, 0.1, false);
  const auto r = said.evaluate(pressed(said, 0.3));
  EXPECT_NEAR(r.tangential_stiffness / r.normal_stiffness, 0.5, 1e-12);
  EXPECT_NE(kt_remark(card).find("kt = 0.5 dFn/dh is assumed"), std::string::npos);
  card.pairs[0].has_tangential_secant = true;
  EXPECT_EQ(kt_remark(card), "");
  card.turn = TurnProtocol::frozen;
  EXPECT_NE(kt_remark(card).find("frozen turn"), std::string::npos);
  card.relaxation = kExperiment;
  EXPECT_EQ(kt_remark(card), "");
}

TEST(SoftContactFromCard, UnusableLawsAreRefused) {
  const auto make = [](const LawCard& card, PairKind kind) {
    return make_soft_contact(card, kind, 1e5, 0.3, 0.0, false);
  };
  for (const LawStatus status : {LawStatus::no_threshold_crossing, LawStatus::not_run})
    EXPECT_THROW((void)make(card_with(PairKind::soft_solid, status), PairKind::soft_solid), InputError)
        << to_string(status);
  EXPECT_NO_THROW((void)make(card_with(PairKind::soft_solid, LawStatus::underdetermined), PairKind::soft_solid));
  EXPECT_THROW((void)make(card_with(PairKind::soft_solid, LawStatus::good), PairKind::soft_soft), InputError);
  LawCard broken = card_with(PairKind::soft_solid, LawStatus::good);
  broken.pairs[0].normal.b.value = std::nan("");
  EXPECT_THROW((void)make(broken, PairKind::soft_solid), InputError);
}

}  // namespace
