// Laws as text for other engines: what is written is read to the last bit, damage is refused where it stands.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/contact/law_set.h"
#include "common/core/error.h"

namespace softgrain {
namespace {

std::vector<LawFileEntry> every_law() {
  const Material m{"m", 2500.0, 5e5, 0.3, false};
  SoftContact soft;
  soft.normal = {0.8, 3.1, -0.8 * std::pow(0.075, 3.1)};
  soft.tangential = {0.5, 1.0 / 3.0, -1e-300};
  soft.delta = 0.075;
  soft.modulus = 5e5;
  soft.friction = 0.3;
  soft.damping = 0.1;
  soft.range = {0.3, Extrapolation::error};
  SoftContact both = soft;
  both.partner_is_soft = true;
  both.range = {};
  SoftMultiContact<LawForm::directional, true> multi_contact;
  multi_contact.form.pressure = {0.8, 3.0, 0.07, {0.1, Extrapolation::clamp}};
  multi_contact.form.coupling = {0.8, 0.15, 0.1};
  multi_contact.partner.log_weight = MonotoneCurve({-1.3, 0.0, 1.3}, {-0.9, -0.5, -0.1});
  multi_contact.partner.exponent = MonotoneCurve({-1.3, 0.0}, {1.3, 1.2});
  multi_contact.partner.common_exponent = 1.25;
  multi_contact.modulus = 5e5;
  multi_contact.friction = 0.3;
  multi_contact.kt_ratio = 0.4;
  multi_contact.unloading = 1.7;
  SoftMultiContact<LawForm::directional, true, true> rolling;
  rolling.form = multi_contact.form;
  rolling.partner = multi_contact.partner;
  rolling.partner.plane_weight = 0.8;
  rolling.modulus = 5e5;
  rolling.unloading = 1.2;
  rolling.rolling = 0.005;
  rolling.rolling_friction = 0.13;
  SoftMultiContact<LawForm::isotropic, false> bag;
  bag.form = multi_contact.form;
  bag.modulus = 1.0;
  bag.j_is_soft = true;
  SoftMultiContact<LawForm::pair, false> pair;
  pair.form = multi_contact.form;
  pair.modulus = 1.0;
  pair.i_is_soft = false;
  pair.j_is_soft = true;
  return {{"mindlin", hertz_law(HertzCoefficients::of(m, m, 0.3, 0.5), false)},
          {"rescaled", hertz_law(HertzCoefficients::of(m, m, 0.3, 1.0), true)},
          {"smooth", hertz_law(HertzCoefficients::of(m, m, 0.0, 1.0), false)},
          {"spring", LinearSpring{2e3, 1e3, 0.4, 0.2}},
          {"soft", soft},
          {"soft both", both},
          {"crowd", multi_contact},
          {"crowd that rolls", rolling},
          {"isotropic", bag},
          {"pair", pair},
          {"disk", CohesiveDisk<false, false>{1e3, 0.0, 0.0, 0.1, 0.2, 1e-5, 0.0, 0.0}},
          {"disk that slides", CohesiveDisk<true, false>{1e3, 5e2, 0.3, 0.1, 0.0, 0.0, 0.0, 0.0}},
          {"disk that rolls", CohesiveDisk<true, true>{1e3, 5e2, 0.3, 0.1, 0.2, 1e-5, 1e-4, 2e-5}},
          {"mindlin that rolls", hertz_law(HertzCoefficients::of(m, m, 0.3, 0.5, {0.1, 0.7, 0.4}), false)},
          {"rescaled that rolls", hertz_law(HertzCoefficients::of(m, m, 0.3, 1.0, {0.2, 1.0, 1.0}), true)},
          {"spring that rolls", LinearSpringLaw<true>{2e3, 1e3, 0.4, 0.2, {0.3, 1.5, 0.0}}},
          {"soft that unloads", SoftUnloading{soft, {0.1, 2.9}}},
          {"soft both that unload", SoftUnloading{both, {1.0 / 3.0, 7.0 / 3.0}}}};
}

TEST(LawFile, ReadsBackToTheSameBits) {
  const std::string text = laws_text(every_law());
  const auto again = parse_laws(text, "laws.toml");
  ASSERT_EQ(again.size(), every_law().size());
  for (std::size_t k = 0; k < again.size(); ++k) {
    EXPECT_EQ(again[k].first, every_law()[k].first);
    EXPECT_EQ(again[k].second.index(), every_law()[k].second.index()) << again[k].first;
  }
  EXPECT_EQ(laws_text(again), text);  // numbers are written so that other bits are another text
  EXPECT_EQ(std::get<SoftContact>(again[5].second).range.end, std::numeric_limits<double>::infinity());
  EXPECT_EQ(std::get<SoftContact>(again[4].second).tangential.b, 1.0 / 3.0);
}

TEST(LawFile, MirroredTwiceIsTheSame) {
  for (const auto& [name, law] : every_law()) {
    EXPECT_EQ(laws_text({{name, mirrored(mirrored(law))}}), laws_text({{name, law}}));
    const bool turns = name == "soft" || name == "crowd" || name == "crowd that rolls" || name == "pair" ||
                       name == "soft that unloads";
    EXPECT_EQ(laws_text({{name, mirrored(law)}}) != laws_text({{name, law}}), turns) << name;
  }
}

/// What reading this text says.
std::string complaint(const std::string& text) {
  try {
    (void)parse_laws(text, "laws.toml");
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Other programs that read laws have no state of whole particles.
TEST(LawFile, AMemoryOfParticlesIsWrittenAndRefused) {
  SoftMultiContact<LawForm::isotropic, false> law;
  law.modulus = 1.0;
  const std::string without = laws_text({{"law", law}});
  EXPECT_EQ(without.find("unloading_ratio"), std::string::npos);
  law.unloading_ratio = 1.3;
  const std::string with = laws_text({{"law", law}});
  EXPECT_EQ(with, replaced(without, "retreat = 1.0\n", "retreat = 1.0\nunloading_ratio = 1.3\n"));
  EXPECT_EQ(laws_text({{"law", mirrored(mirrored(law))}}), with);
  EXPECT_EQ(complaint(without), "");
  EXPECT_NE(complaint(with).find("key 'unloading_ratio' is a memory of whole particles"), std::string::npos);
}

TEST(LawFile, SaysWhatIsWrong) {
  const std::string text = laws_text(every_law());
  EXPECT_NE(complaint("").find("no laws file"), std::string::npos);
  EXPECT_NE(complaint("softgrain_laws = 1\n").find("no [[law]]"), std::string::npos);
  EXPECT_NE(complaint("softgrain_laws = [").find("laws.toml:1: not valid TOML"), std::string::npos);
  for (const auto& [from, to, expected] : std::vector<std::array<std::string, 3>>{
           {"friction = 0.3", "friction = -0.3", "law 'mindlin': key 'friction' must not be negative"},
           {"friction = 0.3", "frictoin = 0.3", "key 'friction' is missing"},
           {"friction = 0.3", "friction = 0.3\nmore = 1", "key 'more' is no key of this law"},
           {"name = \"smooth\"", "name = \"mindlin\"", "is there twice"},
           {"type = \"linear\"", "type = \"cubic\"", "must be hertz, linear, soft, multi-contact"},
           {"modulus = 5e+05", "modulus = inf", "must be finite"},
           {"modulus = 5e+05", "modulus = 0", "must be above 0"},
           {"beyond = \"error\"", "beyond = \"never\"", "must be error, clamp or extrapolate"},
           {"log_ratio = [-1.3, 0.0, 1.3]", "log_ratio = [-1.3, 0.0, 0.0]", "ascending"},
           {"log_ratio = [-1.3, 0.0, 1.3]", "log_ratio = [-1.3, true]", "must be a list of numbers"},
           {"pressure = [0.8, 3.0, 0.07]", "pressure = [0.8, 3.0]", "needs three numbers"},
           {"range = 1e-05", "range = 0.0", "law 'disk': key 'range' must be above 0"},
           {"rolling = 1e-04", "rolling = 0.0", "key 'rolling' must be above 0"},
           {"form = \"isotropic\"", "form = \"sack\"", "must be pair, isotropic or directional"}})
    EXPECT_NE(complaint(replaced(text, from, to)).find(expected), std::string::npos)
        << to << " gave: " << complaint(replaced(text, from, to));
}

}  // namespace
}  // namespace softgrain
