#include "pipelines/kinds/cohesive_powder/variants.h"

#include <array>
#include <cmath>

#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// A number of a sample; NaN where there is none.
struct Quantity {
  const char* name;
  double (*of)(const PackSummary&);
};

/// Shares beyond the last that is given are 0.
template <std::size_t kNeighbours>
double share(const PackSummary& s) {
  const std::vector<double>& shares = s.contacts.shares;
  if (shares.empty()) return kNaN;
  return kNeighbours < shares.size() ? shares[kNeighbours] : 0.0;
}

/// h or k of one of the matrices.
template <std::int64_t Rigidity::*kMember, std::optional<Rigidity> PowderRigidity::*kMatrix>
double rigidity(const PackSummary& s) {
  if (!s.analysis.rigidity) return kNaN;
  const auto& matrix = (*s.analysis.rigidity).*kMatrix;
  return matrix ? static_cast<double>((*matrix).*kMember) : kNaN;
}

template <std::int64_t Rigidity::*kMember>
double rigidity_fixed(const PackSummary& s) {
  return s.analysis.rigidity ? static_cast<double>(s.analysis.rigidity->fixed.*kMember) : kNaN;
}

/// Interactions per disk of one sort; of all of them it is z.
template <std::int64_t PowderContacts::*kSort>
double coordination_of(const PackSummary& s) {
  const auto all = static_cast<double>(s.contacts.contacts + s.contacts.distant);
  return all > 0.0 ? s.contacts.coordination * static_cast<double>(s.contacts.*kSort) / all : kNaN;
}

constexpr auto kH = &Rigidity::indeterminacy;
constexpr auto kK = &Rigidity::floppy;
constexpr auto kFree = &PowderRigidity::free;
constexpr auto kBackbone = &PowderRigidity::backbone;

constexpr const char* kPasses = "loop_passes";

constexpr std::array kQuantities{
    Quantity{"Phi", [](const PackSummary& s) { return s.fraction; }},
    Quantity{"z", [](const PackSummary& s) { return s.contacts.coordination; }},
    Quantity{"z_plus", coordination_of<&PowderContacts::repulsive>},
    Quantity{"z_minus", coordination_of<&PowderContacts::tensile>},
    Quantity{"z_zero", coordination_of<&PowderContacts::unstressed>},
    Quantity{"z_star", [](const PackSummary& s) { return s.contacts.coordination_backbone; }},
    Quantity{"x_0", share<0>},
    Quantity{"x_1", share<1>},
    Quantity{"x_2", share<2>},
    Quantity{"x_3", share<3>},
    Quantity{"x_4", share<4>},
    Quantity{"x_5", share<5>},
    Quantity{"x_6", share<6>},
    Quantity{"mean_normal", [](const PackSummary& s) { return s.contacts.mean_normal; }},
    Quantity{"mean_repulsive", [](const PackSummary& s) { return s.contacts.mean_repulsive; }},
    Quantity{"mean_tensile", [](const PackSummary& s) { return s.contacts.mean_tensile; }},
    Quantity{"quadratic_mean_normal", [](const PackSummary& s) { return s.contacts.square_mean_normal; }},
    Quantity{"repulsive", [](const PackSummary& s) { return static_cast<double>(s.contacts.repulsive); }},
    Quantity{"tensile", [](const PackSummary& s) { return static_cast<double>(s.contacts.tensile); }},
    Quantity{"unstressed", [](const PackSummary& s) { return static_cast<double>(s.contacts.unstressed); }},
    Quantity{"distant", [](const PackSummary& s) { return static_cast<double>(s.contacts.distant); }},
    Quantity{"rattlers", [](const PackSummary& s) { return static_cast<double>(s.contacts.rattlers); }},
    Quantity{"zero_share", [](const PackSummary& s) { return s.analysis.forces.zero_share.value_or(kNaN); }},
    Quantity{"rumpf_ratio", [](const PackSummary& s) { return s.analysis.rumpf_ratio.value_or(kNaN); }},
    Quantity{"F_perc", [](const PackSummary& s) { return s.analysis.percolation.either.value_or(kNaN); }},
    Quantity{"solid_fraction_3d", [](const PackSummary& s) { return s.analysis.solid_fraction_3d; }},
    Quantity{"bulk", [](const PackSummary& s) { return s.analysis.moduli ? s.analysis.moduli->bulk : kNaN; }},
    Quantity{"shear", [](const PackSummary& s) { return s.analysis.moduli ? s.analysis.moduli->shear : kNaN; }},
    Quantity{"h", rigidity_fixed<kH>},
    Quantity{"k", rigidity_fixed<kK>},
    Quantity{"h_free", rigidity<kH, kFree>},
    Quantity{"k_free", rigidity<kK, kFree>},
    Quantity{"h_backbone", rigidity<kH, kBackbone>},
    Quantity{"k_backbone", rigidity<kK, kBackbone>},
    Quantity{"R_w", [](const PackSummary& s) { return s.holes ? s.holes->mean_radius : kNaN; }},
    Quantity{kPasses, [](const PackSummary& s) { return static_cast<double>(s.loop_passes); }}};

constexpr const char* kSeconds = "seconds";  // stands beside the samples
constexpr const char* kDimension = "dF";     // these of the common fit of I(k)
constexpr const char* kLength = "xi";
constexpr const char* kLambda = "lambda";  // these of the common consolidation
constexpr const char* kAlpha = "alpha";
constexpr const char* kDensest = "Phi_max";

void add_mean(VariantEntry& entry, const char* name, const std::vector<double>& values) {
  Tally sample;
  for (const double x : values)
    if (std::isfinite(x)) sample.add(x);
  const MeanError m = sample.statistics();
  if (m.n > 0) entry.values[name] = {m.mean, m.deviation, m.n, m.error};
}

/// Adds the means over the samples at rest.
void add_values(VariantEntry& entry, const PowderSummary& powder) {
  std::vector<const PackSummary*> usable;
  std::vector<double> seconds;
  for (std::size_t k = 0; k < powder.samples.size(); ++k) {
    if (!powder.samples[k].usable) continue;
    usable.push_back(&powder.samples[k]);
    if (k < powder.seconds.size()) seconds.push_back(powder.seconds[k]);
  }
  entry.usable_samples = usable.size();
  for (const Quantity& q : kQuantities) {
    std::vector<double> values;
    for (const PackSummary* s : usable) values.push_back(q.of(*s));
    add_mean(entry, q.name, values);
  }
  add_mean(entry, kSeconds, seconds);
  const auto add = [&](const char* name, const auto& n) {
    entry.values[name] = {n.value, kNaN, usable.size(), n.error};
  };
  if (powder.scattering && powder.scattering->fit.usable) {
    add(kDimension, powder.scattering->fit.dimension);
    add(kLength, powder.scattering->fit.length);
  }
  if (!powder.consolidation || !powder.consolidation->usable) return;
  add(kLambda, powder.consolidation->slope);
  if (powder.consolidation->exponent) add(kAlpha, *powder.consolidation->exponent);
  if (powder.consolidation->densest) add(kDensest, *powder.consolidation->densest);
}

/// One side's error alone would flatter or blame, so it takes both for the difference in errors.
void add_published(VariantEntry& entry, const std::vector<PublishedValue>& values) {
  for (const PublishedValue& v : values) {
    entry.published[v.quantity] = {v.value, v.error.value_or(kNaN)};
    if (!entry.values.contains(v.quantity)) continue;
    const QuantityMean ours = entry.ours(v.quantity);
    PublishedDifference& off = entry.difference[v.quantity];
    off.value = ours.mean - v.value;
    if (const double combined = std::hypot(ours.error, v.error.value_or(kNaN)); combined > 0.0)
      off.in_errors = off.value / combined;
  }
}

std::string reason_of(const VariantRun& ended) {
  if (is_good(ended.run.status)) return "";
  std::string out;
  for (const std::string& text : ended.run.remarks.value_or(std::vector<std::string>{})) {
    const bool tells = ended.powder.samples.empty() || text.find("not at rest") != std::string::npos;
    if (tells) append_part(out, text);
  }
  return out;
}

}  // namespace

const std::vector<const char*>& powder_quantities() {
  static const std::vector<const char*> names = [] {
    std::vector<const char*> out;
    for (const Quantity& q : kQuantities) out.push_back(q.name);
    for (const char* name : {kSeconds, kDimension, kLength, kLambda, kAlpha, kDensest}) out.push_back(name);
    return out;
  }();
  return names;
}

std::vector<const char*> powder_comparable() {
  std::vector<const char*> out;
  for (const char* name : powder_quantities())
    if (std::string(name) != kPasses && std::string(name) != kSeconds) out.push_back(name);
  return out;
}

VariantEntry powder_variant_entry(const PowderVariant& variant, const VariantRun* ended) {
  VariantEntry entry;
  entry.name = variant.name;
  entry.title = variant.setup.title;
  entry.disks = variant.setup.spec.disks;
  entry.samples = variant.setup.samples;
  if (ended != nullptr) {
    entry.status = ended->powder.head.status;
    entry.reason = reason_of(*ended);
    entry.commit = ended->run.commit;
    add_values(entry, ended->powder);
  }
  add_published(entry, variant.published);
  return entry;
}

}  // namespace softgrain
