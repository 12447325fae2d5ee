// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "common/contact/law_set.h"

namespace softgrain {

namespace {

/// The shortest text that reads back to the same number.
std::string number(double x) {
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, x).ptr;
  std::string out(text, end);
  if (out.find_first_of(".e") == std::string::npos) out += ".0";
  return out;
}

std::string list(const std::vector<double>& values) {
  std::string out = "[";
  for (const double x : values) out += (out.size() > 1 ? ", " : "") + number(x);
  return out + "]";
}

/// One [[law]], line by line.
class Writer {
 public:
  Writer(std::string& out, const std::string& name, LawType type) : out_(out) {
    out_ += "\n[[law]]\n";
    text("name", name);
    text("type", to_string(type));
  }

  void text(const char* key, const std::string& value) { line(key, '"' + value + '"'); }
  void flag(const char* key, bool value) { line(key, value ? "true" : "false"); }
  void value(const char* key, double x) { line(key, number(x)); }
  void values(const char* key, const std::vector<double>& x) { line(key, list(x)); }
  void range(const LawRange& range) {
    value("range_end", range.end);
    text("beyond", to_string(range.beyond));
  }

 private:
  void line(const char* key, const std::string& value) { out_ += std::string(key) + " = " + value + "\n"; }

  std::string& out_;
};

void write_rolling_resistance(Writer& w, const RollingResistance& rolling) {
  w.value("rolling_friction", rolling.friction);
  w.value("rolling_stiffness", rolling.stiffness);
  w.value("rolling_damping", rolling.damping);
}

template <Tangential kTangential, bool kDamped, bool kRolling>
void write(std::string& out, const std::string& name, const HertzMindlin<kTangential, kDamped, kRolling>& law) {
  Writer w(out, name, LawType::hertz);
  w.text("tangential", to_string(kTangential));
  w.value("inverse_d", law.k.inverse_d);
  w.value("shear", law.k.shear);
  w.value("friction", law.k.friction);
  w.value("damping", law.k.damping);
  if (kRolling) write_rolling_resistance(w, law.k.rolling);
}

template <bool kRolling>
void write(std::string& out, const std::string& name, const LinearSpringLaw<kRolling>& law) {
  Writer w(out, name, LawType::linear);
  w.value("normal", law.normal);
  w.value("tangential", law.tangential);
  w.value("friction", law.friction);
  w.value("damping", law.damping);
  if (kRolling) write_rolling_resistance(w, law.rolling);
}

void write_soft(Writer& w, const SoftContact& law) {
  w.values("normal", {law.normal.a, law.normal.b, law.normal.c});
  w.values("tangential", {law.tangential.a, law.tangential.b, law.tangential.c});
  w.value("delta", law.delta);
  w.value("modulus", law.modulus);
  w.value("friction", law.friction);
  w.value("damping", law.damping);
  w.flag("first_is_soft", law.i_is_soft);
  w.flag("second_is_soft", law.partner_is_soft);
  w.range(law.range);
}

void write(std::string& out, const std::string& name, const SoftContact& law) {
  Writer w(out, name, LawType::soft);
  write_soft(w, law);
}

void write(std::string& out, const std::string& name, const SoftUnloading& law) {
  Writer w(out, name, LawType::soft);
  write_soft(w, law);
  w.value("residual", law.branch.residual);
  w.value("unloading_exponent", law.branch.exponent);
}

template <LawForm kLawForm, bool kUnloading, bool kRolling>
void write(std::string& out, const std::string& name, const SoftMultiContact<kLawForm, kUnloading, kRolling>& law) {
  Writer w(out, name, LawType::multi_contact);
  w.text("form", to_string(kLawForm));
  w.flag("unloading", kUnloading);
  w.values("pressure", {law.form.pressure.a, law.form.pressure.b, law.form.pressure.delta});
  w.values("coupling", {law.form.coupling.m0, law.form.coupling.m1, law.form.coupling.m2});
  w.range(law.form.pressure.range);
  w.values("log_ratio", law.partner.log_weight.points());
  w.values("log_weight", law.partner.log_weight.values());
  w.values("exponent_log_ratio", law.partner.exponent.points());
  w.values("exponent", law.partner.exponent.values());
  w.value("common_exponent", law.partner.common_exponent);
  if (law.partner.plane_weight != 1.0) w.value("plane_weight", law.partner.plane_weight);
  w.value("modulus", law.modulus);
  w.value("friction", law.friction);
  w.value("kt_ratio", law.kt_ratio);
  w.value("retreat", law.unloading);
  if (law.unloading_ratio != 1.0) w.value("unloading_ratio", law.unloading_ratio);
  if (kRolling) {
    w.value("rolling", law.rolling);
    w.value("rolling_friction", law.rolling_friction);
  }
  w.flag("first_is_soft", law.i_is_soft);
  w.flag("second_is_soft", law.j_is_soft);
}

template <bool kFriction, bool kRolling>
void write(std::string& out, const std::string& name, const CohesiveDisk<kFriction, kRolling>& law) {
  Writer w(out, name, LawType::cohesive);
  w.flag("slides", kFriction);
  w.flag("rolls", kRolling);
  w.value("normal", law.normal);
  w.value("tangential", law.tangential);
  w.value("friction", law.friction);
  w.value("damping", law.damping);
  w.value("adhesion", law.adhesion);
  w.value("range", law.range);
  w.value("rolling", law.rolling);
  w.value("rolling_limit", law.rolling_limit);
}

/// Of laws whose bodies are alike; those with soft sides have their own below.
template <class Law>
AnyLaw mirror(Law law) {
  if constexpr (std::derived_from<Law, SoftContact>) {
    if (!law.partner_is_soft) law.i_is_soft = !law.i_is_soft;
  } else {
    static_assert(!Law::traits.is_fitted, "a law that says which bodies are soft needs a mirror() of its own");
  }
  return law;
}

template <LawForm kLawForm, bool kUnloading, bool kRolling>
AnyLaw mirror(SoftMultiContact<kLawForm, kUnloading, kRolling> law) {
  std::swap(law.i_is_soft, law.j_is_soft);
  return law;
}

}  // namespace

std::string laws_text(const std::vector<LawFileEntry>& laws) {
  std::string out =
      "# Contact laws of softgrain, numbers as the contact loop takes them [SI].\n"
      "softgrain_laws = 1\n";
  for (const auto& [name, law] : laws) {
    const std::string& text = name;
    std::visit([&](const auto& l) { write(out, text, l); }, law);
  }
  return out;
}

AnyLaw mirrored(const AnyLaw& law) {
  return std::visit([](const auto& l) { return mirror(l); }, law);
}

}  // namespace softgrain
