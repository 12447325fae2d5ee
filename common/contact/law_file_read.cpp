// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/contact/law_set.h"
#include "common/core/error.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

/// One [[law]]: every key that is asked for must be there, and no other.
class Reader {
 public:
  Reader(const toml::table& table, std::string origin) : table_(table), origin_(std::move(origin)) {
    name = text("name");
    origin_ += ": law '" + name + "'";
  }

  [[nodiscard]] bool has(const char* key) const { return table_.contains(key); }
  std::string text(const char* key) {
    const auto value = node(key).value<std::string>();
    if (!value) fail(key, "must be a text");
    return *value;
  }
  bool flag(const char* key) {
    const auto value = node(key).value<bool>();
    if (!value) fail(key, "must be true or false");
    return *value;
  }
  double value(const char* key) { return finite(key, number(key)); }
  double not_negative(const char* key) {
    const double x = value(key);
    if (x < 0.0) fail(key, "must not be negative");
    return x;
  }
  double positive(const char* key) {
    const double x = value(key);
    if (!(x > 0.0)) fail(key, "must be above 0");
    return x;
  }
  std::vector<double> values(const char* key) {
    const toml::array* array = node(key).as_array();
    if (array == nullptr) fail(key, "must be a list of numbers");
    std::vector<double> out;
    for (const auto& element : *array) {
      const auto x = element.value<double>();
      if (!x) fail(key, "must be a list of numbers");
      out.push_back(finite(key, *x));
    }
    return out;
  }
  std::vector<double> three(const char* key) {
    auto out = values(key);
    if (out.size() != 3) fail(key, "needs three numbers");
    return out;
  }
  LawRange range() {
    LawRange out;
    out.end = number("range_end");
    if (!(out.end > 0.0)) fail("range_end", "must be above 0");
    out.beyond = word<Extrapolation>("beyond");
    return out;
  }
  template <NamedEnum Enum>
  Enum word(const char* key) {
    if (const auto value = parse_enum<Enum>(text(key))) return *value;
    std::string known;  // no fmt: LAMMPS is built with this file
    for (const EnumName<Enum>& one : enum_names<Enum>)
      known += (known.empty() ? "" : &one == &enum_names<Enum>.back() ? " or " : ", ") + std::string(one.text);
    fail(key, "must be " + known);
  }
  MonotoneCurve curve(const char* points, const char* key) {
    const auto x = values(points);
    const auto y = values(key);
    if (x.empty() && y.empty()) return {};
    try {
      return {x, y};
    } catch (const std::invalid_argument& e) {
      fail(key, e.what());
    }
  }
  void finish() const {
    for (const auto& [key, ignored] : table_)
      if (asked_.count(std::string(key.str())) == 0) fail(std::string(key.str()).c_str(), "is no key of this law");
  }
  [[noreturn]] void fail(const char* key, const std::string& problem) const {
    throw InputError(origin_ + ": key '" + key + "' " + problem);
  }

  std::string name;

 private:
  toml::node_view<const toml::node> node(const char* key) {
    asked_.insert(key);
    if (!table_.contains(key)) fail(key, "is missing");
    return table_[key];
  }
  double number(const char* key) {
    const auto value = node(key).value<double>();
    if (!value || std::isnan(*value)) fail(key, "must be a number");
    return *value;
  }
  double finite(const char* key, double x) const {
    if (!std::isfinite(x)) fail(key, "must be finite");
    return x;
  }

  const toml::table& table_;
  std::string origin_;
  std::set<std::string> asked_;
};

/// Of laws that resist rolling.
RollingResistance read_rolling_resistance(Reader& r) {
  if (!r.has("rolling_friction")) return {};
  return {r.positive("rolling_friction"), r.positive("rolling_stiffness"), r.not_negative("rolling_damping")};
}

AnyLaw read_hertz(Reader& r) {
  HertzCoefficients k;
  k.inverse_d = r.positive("inverse_d");
  k.shear = r.not_negative("shear");
  k.friction = r.not_negative("friction");
  k.damping = r.not_negative("damping");
  k.rolling = read_rolling_resistance(r);
  const auto kind = r.word<Tangential>("tangential");
  if (kind == Tangential::none && k.rolling.friction > 0.0) r.fail("rolling_friction", "needs a tangential spring");
  return hertz_law(k, kind);
}

template <bool kRolling>
AnyLaw read_linear_spring(Reader& r) {
  LinearSpringLaw<kRolling> law;
  law.normal = r.positive("normal");
  law.tangential = r.not_negative("tangential");
  law.friction = r.not_negative("friction");
  law.damping = r.not_negative("damping");
  law.rolling = read_rolling_resistance(r);
  return law;
}

AnyLaw read_linear(Reader& r) {
  return r.has("rolling_friction") ? read_linear_spring<true>(r) : read_linear_spring<false>(r);
}

/// The branch of a law that unloads along one of its own.
UnloadingBranch read_branch(Reader& r, double loading_exponent) {
  const UnloadingBranch branch{r.not_negative("residual"), r.positive("unloading_exponent")};
  if (branch.residual > kLargestResidual) r.fail("residual", fmt::format("must be at most {:g}", kLargestResidual));
  if (branch.exponent < least_unloading_exponent(branch.residual, loading_exponent))
    r.fail("unloading_exponent", "is too small: cycles would give back more than they took");
  return branch;
}

AnyLaw read_soft(Reader& r) {
  SoftContact law;
  const auto normal = r.three("normal");
  const auto tangential = r.three("tangential");
  law.normal = {normal[0], normal[1], normal[2]};
  law.tangential = {tangential[0], tangential[1], tangential[2]};
  law.delta = r.not_negative("delta");
  law.modulus = r.positive("modulus");
  law.friction = r.not_negative("friction");
  law.damping = r.not_negative("damping");
  law.i_is_soft = r.flag("first_is_soft");
  law.partner_is_soft = r.flag("second_is_soft") && law.i_is_soft;
  law.range = r.range();
  if (!r.has("residual") && !r.has("unloading_exponent")) return law;
  return SoftUnloading{law, read_branch(r, law.normal.b)};
}

template <LawForm kLawForm, bool kUnloading, bool kRolling>
AnyLaw read_multi_contact_law(Reader& r) {
  SoftMultiContact<kLawForm, kUnloading, kRolling> law;
  const auto pressure = r.three("pressure");
  const auto coupling = r.three("coupling");
  law.form.pressure = {pressure[0], pressure[1], pressure[2], r.range()};
  law.form.coupling = {coupling[0], coupling[1], coupling[2]};
  law.partner.log_weight = r.curve("log_ratio", "log_weight");
  law.partner.exponent = r.curve("exponent_log_ratio", "exponent");
  law.partner.common_exponent = r.positive("common_exponent");
  if (r.has("plane_weight")) law.partner.plane_weight = r.positive("plane_weight");
  law.modulus = r.positive("modulus");
  law.friction = r.not_negative("friction");
  law.kt_ratio = r.not_negative("kt_ratio");
  law.unloading = r.positive("retreat");
  if (r.has("unloading_ratio"))
    r.fail("unloading_ratio", "is a memory of whole particles, which runs of our own engine alone have: leave it out");
  if (kRolling) {
    law.rolling = r.not_negative("rolling");
    law.rolling_friction = r.not_negative("rolling_friction");
  }
  law.i_is_soft = r.flag("first_is_soft");
  law.j_is_soft = r.flag("second_is_soft");
  if (!law.i_is_soft && !law.j_is_soft) r.fail("first_is_soft", "or second_is_soft must be true");
  return law;
}

template <LawForm kLawForm, bool kUnloading>
AnyLaw read_rolling(Reader& r) {
  return r.has("rolling") ? read_multi_contact_law<kLawForm, kUnloading, true>(r)
                          : read_multi_contact_law<kLawForm, kUnloading, false>(r);
}

template <LawForm kLawForm>
AnyLaw read_multi_contact_form(Reader& r) {
  return r.flag("unloading") ? read_rolling<kLawForm, true>(r) : read_rolling<kLawForm, false>(r);
}

AnyLaw read_multi_contact(Reader& r) {
  const auto form = r.word<LawForm>("form");
  if (form == LawForm::pair) return read_multi_contact_form<LawForm::pair>(r);
  return form == LawForm::isotropic ? read_multi_contact_form<LawForm::isotropic>(r)
                                    : read_multi_contact_form<LawForm::directional>(r);
}

template <bool kFriction, bool kRolling>
AnyLaw read_disk(Reader& r) {
  CohesiveDisk<kFriction, kRolling> law;
  law.normal = r.positive("normal");
  law.tangential = r.not_negative("tangential");
  law.friction = r.not_negative("friction");
  law.damping = r.not_negative("damping");
  law.adhesion = r.not_negative("adhesion");
  law.range = r.not_negative("range");
  law.rolling = r.not_negative("rolling");
  law.rolling_limit = r.not_negative("rolling_limit");
  if (law.adhesion > 0.0 && !(law.range > 0.0)) r.fail("range", "must be above 0 where there is adhesion");
  if (kRolling && !(law.rolling > 0.0)) r.fail("rolling", "must be above 0 where disks resist rolling");
  return law;
}

AnyLaw read_cohesive(Reader& r) {
  const bool slides = r.flag("slides");
  const bool rolls = r.flag("rolls");
  if (rolls && !slides) r.fail("rolls", "needs slides = true: its limit is a share of friction");
  if (rolls) return read_disk<true, true>(r);
  return slides ? read_disk<true, false>(r) : read_disk<false, false>(r);
}

AnyLaw read_law(Reader& r) {
  switch (r.word<LawType>("type")) {
    case LawType::hertz:
      return read_hertz(r);
    case LawType::linear:
      return read_linear(r);
    case LawType::soft:
      return read_soft(r);
    case LawType::cohesive:
      return read_cohesive(r);
    default:
      return read_multi_contact(r);
  }
}

}  // namespace

std::vector<LawFileEntry> parse_laws(const std::string& text, const std::string& origin) {
  const toml::table table = parse_toml(text, origin);
  if (table["softgrain_laws"].value<std::int64_t>() != 1)
    throw InputError(origin + ": no laws file of softgrain (softgrain_laws = 1 is missing)");
  const toml::array* laws = table["law"].as_array();
  if (laws == nullptr || laws->empty()) throw InputError(origin + ": holds no [[law]]");
  std::vector<LawFileEntry> out;
  for (const auto& node : *laws) {
    if (!node.is_table()) throw InputError(origin + ": law must be a table");
    Reader reader(*node.as_table(), origin);
    const auto same = [&](const LawFileEntry& other) { return other.first == reader.name; };
    if (std::any_of(out.begin(), out.end(), same)) reader.fail("name", "is there twice");
    AnyLaw law = read_law(reader);
    reader.finish();
    out.emplace_back(reader.name, std::move(law));
  }
  return out;
}

}  // namespace softgrain
