// What one variant of a powder came to, in short, and the entries of all as tables.
#include "pipelines/kinds/cohesive_powder/variants.h"

#include <fmt/format.h>

#include <algorithm>
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

namespace {

/// What a table for people shows of a variant beside Phi and z.
constexpr std::array kShown{"z_star",       "x_0",         "x_1",         "x_2",        "mean_normal", "mean_repulsive",
                            "mean_tensile", "rumpf_ratio", "F_perc",      "zero_share", "bulk",        "shear",
                            "lambda",       "alpha",       "Phi_max",     "h",          "k",           "dF",
                            "xi",           "R_w",         "loop_passes", "seconds"};

/// Phi and z always, others where the publication gives them for a variant.
std::vector<std::string> compared(const std::vector<VariantEntry>& entries) {
  std::vector<std::string> out;
  for (const std::string name : powder_comparable())
    if (name == "Phi" || name == "z" ||
        std::ranges::any_of(entries, [&](const VariantEntry& e) { return e.published.contains(name); }))
      out.push_back(name);
  return out;
}

/// A number in full precision; empty where it is not finite.
std::string exact(double x) { return std::isfinite(x) ? nlohmann::json(x).dump() : ""; }

constexpr NumberForm kFourDecimals{4, true};

/// "0.7105 +- 0.0011"; empty where there is no value.
std::string ours(const VariantEntry& entry, const std::string& quantity, const NumberForm& form) {
  const QuantityMean own = entry.ours(quantity);
  return with_error(own.mean, if_finite(own.error), {.value = form, .undefined = ""});
}

std::string theirs(const VariantEntry& entry, const std::string& quantity) {
  const auto published = entry.theirs(quantity);
  return with_error(published.value, if_finite(published.error), {.value = {5}, .undefined = ""});
}

/// "+0.0012 (0.8 errors)"
std::string difference(const VariantEntry& entry, const std::string& quantity) {
  const PublishedDifference off = entry.off(quantity);
  const std::string errors = rounded_text(off.in_errors, {1, true, true}, "");
  return rounded_text(off.value, {2, false, true}, "") + (errors.empty() ? "" : " (" + errors + ")");
}

std::string samples_text(const VariantEntry& entry) {
  return fmt::format("{}/{}", entry.usable_samples, entry.samples);
}

}  // namespace

TextTable powder_data_table(const std::vector<VariantEntry>& entries) {
  TextTable table{{"name", "status", "reason", "disks", "samples", "usable_samples"}, {}};
  for (const std::string name : powder_quantities())
    for (const char* ending : {"", "_deviation", "_error"}) table.header.push_back(name + ending);
  const std::vector<std::string> published = compared(entries);
  for (const std::string& name : published)
    for (const char* ending : {"_published", "_published_error", "_difference", "_difference_in_errors"})
      table.header.push_back(name + ending);
  for (const VariantEntry& e : entries) {
    std::vector<std::string> row{e.name,
                                 to_string(e.status),
                                 e.reason,
                                 std::to_string(e.disks),
                                 std::to_string(e.samples),
                                 std::to_string(e.usable_samples)};
    for (const char* name : powder_quantities())
      for (const double x : {e.ours(name).mean, e.ours(name).deviation, e.ours(name).error}) row.push_back(exact(x));
    for (const std::string& name : published)
      for (const double x : {e.theirs(name).value, e.theirs(name).error, e.off(name).value, e.off(name).in_errors})
        row.push_back(exact(x));
    table.rows.push_back(std::move(row));
  }
  return table;
}

TextTable powder_console_table(const std::vector<VariantEntry>& entries) {
  TextTable table{{"variant", "status", "at rest"}, {}};
  const std::vector<std::string> published = compared(entries);
  for (const std::string& name : published)
    for (const char* ending : {"", " published", " difference (in errors)"}) table.header.push_back(name + ending);
  std::vector<std::string> others(kShown.begin(), kShown.end());
  std::erase_if(others, [&](const std::string& name) { return std::ranges::find(published, name) != published.end(); });
  table.header.insert(table.header.end(), others.begin(), others.end());
  for (const VariantEntry& e : entries) {
    std::vector<std::string> row{e.name, to_string(e.status), samples_text(e)};
    for (const std::string& name : published)
      row.insert(row.end(), {ours(e, name, kFourDecimals), theirs(e, name), difference(e, name)});
    for (const std::string& name : others) row.push_back(ours(e, name, {4}));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string powder_variant_line(const VariantEntry& entry) {
  std::string line = entry.name + ": ";
  if (entry.status == RunStatus::not_run) return line + "not run\n";
  for (const std::string& name : compared({entry})) {
    const std::string published = theirs(entry, name);
    line += fmt::format("{} {}{}, ", name, ours(entry, name, kFourDecimals),
                        published.empty() ? "" : " (published " + published + ")");
  }
  line += samples_text(entry) + " samples at rest";
  return line + (entry.reason.empty() ? "" : "; NOT USABLE: " + entry.reason) + "\n";
}

}  // namespace softgrain
