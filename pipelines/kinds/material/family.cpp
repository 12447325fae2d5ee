// Which variants of a material differ in the span of their sizes alone.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "common/core/text.h"
#include "macrosim/preparation.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/material/scene.h"

namespace softgrain {

namespace {

/// "nu", "0.3".
struct Property {
  std::string name;
  std::string value;
};

/// The law of the sizes without its ends; those of sieve curves, classes and lists are the law.
std::string law_of_sizes(const MacroSpec& spec) {
  if (const auto b = exponent_of(spec)) return fmt::format("b = {:g}", *b);  // however the scene says it
  const GradingForm form = spec.solid_sizes->form();
  std::string text = to_string(form);
  if (form == GradingForm::classes || form == GradingForm::sieve_curve || form == GradingForm::list) return text;
  std::istringstream lines(spec.solid_sizes->text());
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("form") && !line.starts_with("radius_min") && !line.starts_with("radius_max"))
      text += ", " + line;
  return text;
}

/// Sizes that no law with two ends describes.
std::string whole_sizes(const MacroSpec& spec) {
  if (exponent_of(spec)) return "";
  const GradingForm form = spec.solid_sizes->form();
  const bool whole = form == GradingForm::classes || form == GradingForm::sieve_curve || form == GradingForm::list;
  return whole ? spec.solid_sizes->text() : "";
}

std::string stage_text(const MacroStage& stage) {
  std::string text = stage.record.name;
  for (const AxisDrive& axis : stage.axis)
    text += fmt::format(" {}{:g}", axis.by_stress ? "stress " : "", axis.as_at >= 0 ? 0.0 : axis.value);
  if (stage.shear != 0.0) text += fmt::format(" shear {:g}", stage.shear);
  return text + fmt::format(" in {} x {}, tolerance {:g}", stage.steps, stage.increments_per_step, stage.tolerance);
}

std::string test_text(const MacroSpec& spec) { return join_text(stages_of(spec), "; ", stage_text); }

std::string number(double value) { return fmt::format("{:g}", value); }

/// What may differ in the tests of packings.
std::vector<Property> properties_of_test(const MaterialVariant& v) {
  return {{"force_floor", number(v.setup.spec.force_floor)}, {"test", test_text(v.setup.spec)}};
}

/// All that may differ in the packings, beside what always stands in the name of a family.
std::vector<Property> properties_of_packings(const MaterialVariant& v) {
  const MacroSpec& s = v.setup.spec;
  const PreparationProtocol& p = s.protocol;
  return {{"E [Pa]", number(s.youngs_modulus)},
          {"nu", number(s.poisson_ratio)},
          {"mu_r", number(s.rolling.friction)},
          {"kr_ratio", number(s.rolling.friction > 0.0 ? s.rolling.stiffness : 1.0)},
          {"density", number(s.density)},
          {"start_pressure", number(s.start_pressure)},
          {"start_fraction", number(p.start_fraction)},
          {"inertial_number", number(p.inertial_number)},
          {"compaction_mu", number(p.friction)},
          {"compaction_restitution", number(p.restitution)},
          {"coarse_share", number(p.coarse_share)},
          {"first_pressure", number(p.first_pressure)},
          {"preparation_tolerance", number(p.tolerance)},
          {"preparation_passes", std::to_string(p.max_passes)},
          {"balance", std::string(to_string(s.balance))},
          {"target solid fraction", v.setup.density ? number(v.setup.density->solid_fraction(s.density)) : "none"},
          {"solid_fraction_tolerance", v.setup.density ? number(v.setup.density->tolerance) : "none"},
          {"sizes of", whole_sizes(s)}};
}

/// ", NAME = VALUE" of the properties that differ between variants, those of `all` that `counts`.
std::string differing(const MaterialVariant& variant, const std::vector<MaterialVariant>& all,
                      std::vector<Property> (*properties)(const MaterialVariant&),
                      const std::function<bool(const MaterialVariant&)>& counts) {
  std::string text;
  const std::vector<Property> own = properties(variant);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const auto differs = [&](const MaterialVariant& v) { return counts(v) && properties(v)[k].value != own[k].value; };
    if (std::ranges::none_of(all, differs)) continue;
    if (own[k].name == "sizes of")  // their text is long
      text += own[k].value.empty() ? "" : ", sizes of " + (variant.packings.empty() ? variant.name : variant.packings);
    else
      text += ", " + own[k].name + " = " + own[k].value;
  }
  return text;
}

/// What differs between tests of the same loading.
std::string differing_tests(const MaterialVariant& variant, const std::vector<MaterialVariant>& all) {
  return differing(variant, all, properties_of_test,
                   [&](const MaterialVariant& v) { return v.loading == variant.loading; });
}

}  // namespace

std::string material_family(const MaterialVariant& variant, const std::vector<MaterialVariant>& all) {
  const MacroSpec& spec = variant.setup.spec;
  return fmt::format("{}, mu = {:g}, {}", to_string(spec.preparation), spec.friction, law_of_sizes(spec)) +
         differing(variant, all, properties_of_packings, [](const MaterialVariant&) { return true; }) +
         (variant.loading.empty() ? differing_tests(variant, all) : "");
}

std::string test_family(const MaterialVariant& variant, const std::vector<MaterialVariant>& all) {
  return variant.loading.empty() ? "" : differing_tests(variant, all);
}

std::string family_of(const MaterialVariant& variant, const std::vector<MaterialVariant>& all) {
  return material_family(variant, all) + (variant.loading.empty() ? "" : ", " + variant.loading) +
         test_family(variant, all);
}

}  // namespace softgrain
