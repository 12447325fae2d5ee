// Differences of two runs of materials, sample by sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "common/core/few_samples.h"
#include "common/core/text.h"
#include "common/data/macro_result.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/kinds/material/summary.h"
#include "pipelines/report/run_data.h"

namespace softgrain {

namespace {

/// A number of one curve; empty where it has none.
struct NumberOfCurve {
  const char* name;
  std::function<std::optional<double>(const MacroCurve&)> of;
};

const std::vector<NumberOfCurve>& numbers_of_curves() {
  static const std::vector<NumberOfCurve> numbers{
      {"solid fraction at the start",
       [](const MacroCurve& c) -> std::optional<double> {
         const auto at = c.more.find(kSolidFraction);
         return at == c.more.end() || at->second.empty() ? std::nullopt : std::optional(at->second.front());
       }},
      {"axial stress over E at the end",
       [](const MacroCurve& c) -> std::optional<double> {
         return c.stress_axial.empty() ? std::nullopt : std::optional(c.stress_axial.back() / c.start.youngs_modulus);
       }},
      {"lateral over axial stress at the end",
       [](const MacroCurve& c) -> std::optional<double> {
         const bool bears = !c.stress_axial.empty() && !c.stress_lateral.empty() && c.stress_axial.back() > 0.0;
         return bears ? std::optional(c.stress_lateral.back() / c.stress_axial.back()) : std::nullopt;
       }},
      {"coordination number at the start", [](const MacroCurve& c) -> std::optional<double> {
         return c.coordination.empty() ? std::nullopt : std::optional(c.coordination.front());
       }}};
  return numbers;
}

/// The values of both, of the samples that both have.
struct PairedSamples {
  std::vector<double> a;
  std::vector<double> b;
};

PairedSamples samples_of(const NumberOfCurve& number, const std::vector<MacroCurve>& a,
                         const std::vector<MacroCurve>& b) {
  std::map<std::int64_t, double> known;
  for (const MacroCurve& c : a)
    if (const auto value = number.of(c); c.usable && value) known[c.sample] = *value;
  PairedSamples out;
  for (const MacroCurve& c : b) {
    const auto value = number.of(c);
    const auto partner = known.find(c.sample);
    if (!c.usable || !value || partner == known.end()) continue;
    out.a.push_back(partner->second);
    out.b.push_back(*value);
  }
  return out;
}

/// Why samples of the same number are no pairs: they are drawn from other random numbers.
std::string why_not_paired(const std::vector<std::string>& keys) {
  std::string others;
  for (const std::string& key : keys)
    if (key == "seed" || key == "samples" || key == "grains.count") append_part(others, key, ", ");
  return others.empty() ? "" : "the runs differ in " + others;
}

PairedNumber difference_of(const NumberOfCurve& number, const std::string& of, const std::vector<MacroCurve>& a,
                           const std::vector<MacroCurve>& b, bool paired) {
  const std::string name = number.name + of;
  const PairedSamples samples = samples_of(number, a, b);
  if (paired) return paired_number(name, "", samples.a, samples.b);
  const auto values_of = [&](const std::vector<MacroCurve>& curves) {
    std::vector<double> values;
    for (const MacroCurve& c : curves)
      if (const auto value = number.of(c); c.usable && value) values.push_back(*value);
    return values;
  };
  const std::vector<double> of_a = values_of(a);
  const std::vector<double> of_b = values_of(b);
  PairedNumber out = unpaired_number(name, "", mean_estimate(mean_error(of_a)), mean_estimate(mean_error(of_b)));
  const Estimate d = difference_of_means(of_a, of_b);
  out.low = d.low;
  out.high = d.high;
  return out;
}

}  // namespace

PairedSummary material_differences(const report::RunData& a, const report::RunData& b,
                                   const std::vector<std::string>& keys) {
  PairedSummary out;
  out.reason = why_not_paired(keys);
  out.paired = out.reason.empty();
  const auto variants_a = a.summary_as<MaterialSummary>().variants;
  const auto variants_b = b.summary_as<MaterialSummary>().variants;
  for (const MaterialVariantSummary& va : variants_a) {
    const auto vb = std::ranges::find(variants_b, va.name, &MaterialVariantSummary::name);
    if (vb == variants_b.end() || va.file.empty() || vb->file.empty()) continue;
    const auto* curves_a = a.file(va.file, load_macro);
    const auto* curves_b = b.file(vb->file, load_macro);
    if (curves_a == nullptr || curves_b == nullptr) continue;
    const std::string of = va.name == kMaterialEngine ? "" : " (" + va.name + ")";
    for (const NumberOfCurve& number : numbers_of_curves()) {
      PairedNumber n = difference_of(number, of, *curves_a, *curves_b, out.paired);
      if (std::isfinite(n.difference)) out.numbers.push_back(std::move(n));
    }
  }
  if (out.paired)
    out.method =
        "samples of the same seed and number. Packings scatter by chance after the first contacts: a small "
        "change of sizes or friction leaves little in common";
  return out;
}

}  // namespace softgrain
