#include "pipelines/kinds/macro/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "macrosim/cell_specimen.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/lammps_run/lammps_program.h"
#include "macrosim/test_protocol.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"
#include "pipelines/law/law_draws.h"
#include "pipelines/law/law_values.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// Grains in a soft particle of the published kind.
constexpr double kGrainsPerSoft = 400.0;
/// Above it the pair law, measured with one contact, is far off.
constexpr double kMultiContactedShare = 0.05;

/// Numbers of bodies in one sample.
struct BodyCounts {
  double all = 0.0;
  double soft = 0.0;
};

BodyCounts counts_of(const std::vector<MacroBody>& bodies) {
  return {static_cast<double>(bodies.size()),
          static_cast<double>(std::ranges::count_if(bodies, [](const MacroBody& b) { return b.soft; }))};
}

/// Counts the bodies of the samples that the run draws. Samples by construction must be packed to be counted, so only
/// the first one is.
std::vector<BodyCounts> count_bodies(const MacroSetup& setup, std::uint64_t seed) {
  if (setup.given) return {counts_of(setup.given->bodies)};
  if (setup.spec.construction == Construction::voids && !setup.spec.cells)
    return {counts_of(make_packing(setup.spec, seed, 0).bodies)};
  std::vector<BodyCounts> out;
  double drawn = 0.0;
  for (std::int64_t k = 0; k < setup.samples && drawn < kMostDrawn; ++k) {
    out.push_back(counts_of(drawn_bodies(setup.spec, seed, static_cast<std::uint64_t>(k))));
    drawn += out.back().all;
  }
  return out;
}

BodyCounts mean_of(const std::vector<BodyCounts>& samples) {
  BodyCounts mean;
  for (const BodyCounts& one : samples) {
    mean.all += one.all / static_cast<double>(samples.size());
    mean.soft += one.soft / static_cast<double>(samples.size());
  }
  return mean;
}

/// Grains inside so many soft particles.
double inner_grains(const MacroContent& content, double soft) {
  if (content.grains.empty() || static_cast<std::int64_t>(content.grains.size()) < content.contents)
    return soft * content.grains_per_soft;
  double sum = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(soft); ++k)
    sum += static_cast<double>(content.grains[k % content.grains.size()]);
  return sum;
}

/// "104", or "101 to 106".
std::string range_text(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *least == *most ? fmt::format("{:.0f}", *least) : fmt::format("{:.0f} to {:.0f}", *least, *most);
}

std::string load_text(const MacroSpec& spec) {
  const AffineOverlap overlap = affine_overlap(spec);
  return fmt::format(
      "overlaps at the end, were all bodies to move with the box: h/R = {:.2g} in the mean, {:.2g} along the "
      "load",
      overlap.mean, overlap.largest);
}

void beyond_range(const std::string& what, double asked, double end, Extrapolation beyond, Findings& out) {
  if (!(end > 0.0) || !(asked > end)) return;
  const char* then = beyond == Extrapolation::error   ? "the run will end there"
                     : beyond == Extrapolation::clamp ? "forces will stay at that of the end"
                                                      : "the law will be extrapolated";
  out.warn(fmt::format("{}: about {:.2g} at the end of the test, measured up to {:.2g}: {}", what, asked, end, then));
}

void check_card_law(const LawCard& card, const LawSources& laws, const MacroSpec& spec, Findings& out) {
  const AffineOverlap overlap = affine_overlap(spec);
  for (const PairKind kind : kPairKinds) {
    const PairLaw* law = card.find(kind);
    if (law == nullptr) continue;
    const Extrapolation beyond = laws.beyond.value_or(law->beyond);
    out.add_once("law " + to_string(kind),
                 {{"status", to_string(law->status)}, {"delta_max", law->delta_max}, {"beyond", to_string(beyond)}},
                 fmt::format("law {}: {}, fitted up to Delta = {:.3g}", to_string(kind), to_string(law->status),
                             law->delta_max));
    beyond_range(to_string(kind) + " Delta along the load", overlap.largest, law->delta_max, beyond, out);
    if (law->status == LawStatus::underdetermined)
      out.warn("the " + to_string(kind) + " law is underdetermined: " + law->reason);
  }
  (void)pair_law_of(card, spec, "law", laws.beyond);  // says what is not usable
  if (spec.soft_share > kMultiContactedShare)
    out.warn(fmt::format(
        "soft particles hold {:.0f} % of the bodies' volume and will have several neighbours each: {}; take a "
        "law table",
        100.0 * spec.soft_share, pair_law_remark()));
}

/// Ratios of radii between neighbours of a soft particle and itself that a scene can have.
void check_ratios(const MacroSpec& spec, const MultiContactLaw& law, Findings& out) {
  const auto compare = [&](PartnerKind kind, double low, double high) {
    const std::vector<PartnerRow> rows = law.rows(kind);
    if (rows.empty()) {
      out.warn(fmt::format("the law knows no {} neighbours", to_string(kind)));
      return;
    }
    const double first = rows.front().ratio;
    // Very large solid spheres are planes, which the law knows.
    const double last = kind == PartnerKind::soft ? rows.back().ratio : HUGE_VAL;
    out.facts["ratios " + to_string(kind)] = {low, high};
    if (low < first * (1.0 - 1e-9) || high > last * (1.0 + 1e-9))
      out.warn(fmt::format(
          "{} neighbours of ratio {:.3g} to {:.3g} may meet; the table has {:.3g} to {:.3g}, and the nearest "
          "row is used beyond",
          to_string(kind), low, high, first, rows.back().ratio));
  };
  const double soft_min = spec.soft_radius_max / spec.soft_polydispersity;
  const double solid_min = spec.solid_radius_max / spec.solid_polydispersity;
  compare(PartnerKind::solid, solid_min / spec.soft_radius_max, spec.solid_radius_max / soft_min);
  compare(PartnerKind::soft, 1.0, spec.soft_polydispersity);
}

/// S of a soft particle between six planes at the mean overlap, against what was measured.
void check_volume(const LawTable& table, const LawSources& laws, LawForm form, double fraction, const MacroSpec& spec,
                  Findings& out) {
  law::MultiContactQuestion q;
  q.form = form;
  q.arrangement = Arrangement::cube;
  q.solid_fraction = fraction;
  q.range = laws.range;
  q.beyond = laws.beyond;
  const AffineOverlap overlap = affine_overlap(spec);
  const law::MultiContactAnswer answer = law::multi_contact_values(table, q, {overlap.mean});
  const Extrapolation beyond = laws.beyond.value_or(answer.entry.beyond);
  const double volume = answer.points.front().volume;
  out.add("law_volume", {{"expected", volume}, {"measured", answer.entry.volume_max}},
          fmt::format(
              "{}: lost volume of a soft particle between six neighbours at the mean overlap {:.2g}, measured up to "
              "{:.2g}",
              to_string(answer.form), volume, answer.entry.volume_max));
  beyond_range("lost volume of soft particles", volume, answer.entry.volume_max, beyond, out);
  beyond_range("overlaps of single soft contacts along the load", overlap.largest, answer.entry.overlap_max, beyond,
               out);
  const MultiContactLaw& law = *answer.entry.find(answer.form);
  if (law.status != LawStatus::good)
    out.warn("the " + to_string(answer.form) + " law is " + to_string(law.status) + ": " + law.reason);
}

/// Whether the check made all contents of soft particles that the run will make.
bool all_made(const MacroContent& content) {
  return content.contents > 0 && static_cast<std::int64_t>(content.grains.size()) >= content.contents;
}

/// What the law of a table is off by. One from a library was fitted to nothing: the library says its error.
std::string table_error_text(const LawTableEntry& entry, const MultiContactLaw& law) {
  if (std::isfinite(law.error_cross)) return "off by " + cross_text(law);
  const double off = form_discrepancy(law);
  if (entry.source == TableSource::measured || !(off > 0.0) || !std::isfinite(off)) return "its error is not known";
  return fmt::format(
      "off by about {:.2g} % by the library (laws of its materials, or an own table, on what their fits "
      "did not see)",
      100.0 * off);
}

/// Some contents stand for all: a mean solid fraction outside the table is no refusal yet.
void check_table_law(const LawTable& table, const LawSources& given, WantedForm form, const MacroSpec& spec,
                     const MacroContent& content, Findings& out) {
  const double contents_fraction = content.solid_fraction;
  LawSources laws = given;
  laws.range = RangePolicy::clamp;
  const NamedLaws named = law_of_form(laws, form, spec, contents_fraction);  // says what is not usable
  std::string remark;
  const LawTableEntry entry = law_entry(laws, contents_fraction, remark);
  const MultiContactLaw& law = *entry.find(named.form);
  json facts = json_of(named.identity);
  facts["error_cross"] = law.error_cross;
  out.add_once("law", facts,
               fmt::format("law: {}{}; {}", identity_text(named.identity),
                           entry.main ? ", the main entry of the table" : "", table_error_text(entry, law)));
  const bool of_content = !laws.solid_fraction && contents_fraction > 0.0;
  if (!remark.empty())
    out.warn(!of_content
                 ? remark
                 : fmt::format("mean of {} of {} contents: {}{}", content.grains.size(), content.contents, remark,
                               given.range != RangePolicy::reject ? ""
                               : all_made(content)                ? "; the run will refuse it"
                                                                  : "; the run will refuse a mean outside the table"));
  check_ratios(spec, law, out);
  check_volume(table, laws, named.form, entry.solid_fraction, spec, out);
}

/// What the card says of the specimen before anything is placed.
void check_cells(const CellMatter& matter, const MacroSpec& spec, Findings& out) {
  const CellCard& card = matter.card;
  require_same_grains(card, spec);
  const double mixture = matter.share / (1.0 - matter.share);
  const double pressure = spec.start_pressure * spec.youngs_modulus;
  const double natural = (1.0 + mixture) / room_at_pressure(fines_law_of(card, spec.youngs_modulus, matter.preparation),
                                                            mixture, 1.0, pressure);
  out.add("cell_law", {{"form", to_string(card.form)}, {"K", card.modulus.value}, {"n", card.exponent.value}},
          fmt::format("law: cells of fines, {} form, K = {}, n = {}; {}", to_string(card.form),
                      interval_text(card.modulus), interval_text(card.exponent), kMatterWithoutShells));
  out.add("E", spec.youngs_modulus,
          fmt::format("E of the grains {:.4g} Pa, their density {:g} kg/m^3{}", spec.youngs_modulus, spec.density,
                      is_known(card.youngs_modulus) && card.youngs_modulus != spec.youngs_modulus
                          ? fmt::format("; the card was measured with {:.4g} Pa", card.youngs_modulus)
                          : ""));
  out.add("natural_solid_fraction", natural,
          fmt::format("at p/E = {:.3g} the card gives this mixture a solid fraction of {:.4f}", spec.start_pressure,
                      natural));
  if (const double factor = void_ratio_factor(card, matter.preparation).value_or(1.0); factor != 1.0)
    out.add("void_ratio_factor", factor,
            fmt::format("the material is prepared '{}', the card '{}': its void ratios times {:.4g}",
                        matter.preparation, card.preparation, factor));
  if (mixture > card.mixture_high)
    out.warn(fmt::format("fines are {:.3g} times the volume of coarse grains; the card was measured up to {:.3g}",
                         mixture, card.mixture_high));
  if (const std::string text = compression_only_text(spec); !text.empty()) out.warn(text);
  if (const std::string text = other_preparation_text(spec); !text.empty()) out.warn(text);
}

void check_laws_of(const LawSources& laws, const MacroSpec& spec, const MacroContent& content, Findings& out) {
  if (spec.cells) return check_cells(*spec.cells, spec, out);
  if (spec.soft_share > 0.0) out.add("picture", "shells", kMatterInShells);
  for (const WantedForm form : laws.forms) {
    const FittedLaw& law = laws.serving(form);
    if (const LawCard* card = law.card())
      check_card_law(*card, laws, spec, out);
    else
      check_table_law(*law.table(), laws, form, spec, content, out);
  }
}

/// A scene that LAMMPS prepares: what it takes there, and whether it is here.
void check_lammps(const MacroSetup& setup, const BodyCounts& count, Findings& out) {
  // Measured with a million bodies on two ranks.
  constexpr double kFileBytes = 91.0;
  constexpr double kRankBytes = 2200.0;
  if (setup.spec.preparation != Preparation::lammps) return;
  const double files = count.all * kFileBytes * static_cast<double>(setup.samples);
  out.add("engine", "lammps",
          "runs with --engine lammps alone: bodies are placed here, LAMMPS compacts and strains them");
  out.add("lammps_file_bytes", files, fmt::format("bodies for LAMMPS: about {:.3g} MB of text", files / 1e6));
  out.add("lammps_bytes", count.all * kRankBytes,
          fmt::format("memory in LAMMPS: about {:.3g} MB over all ranks", count.all * kRankBytes / 1e6));
  try {
    const std::string program = lammps::find_program();
    if (program.empty())
      out.warn(lammps::missing_text());
    else
      out.add("lammps_program", program, "LAMMPS: " + program);
  } catch (const InputError& e) {
    out.warn(e.what());
  }
}

void tell_preparation(const MacroSetup& setup, Findings& out) {
  const MacroSpec& spec = setup.spec;
  if (setup.given || spec.preparation == Preparation::lammps) return;
  const PreparationProtocol& p = spec.protocol;
  std::string how = fmt::format("preparation {}: ", to_string(spec.preparation));
  if (spec.construction == Construction::mixed)
    how += fmt::format("bodies begin at {:g} of the box, ", p.start_fraction);
  if (p.coarse_share < 1.0)
    how += fmt::format("the largest {:g} of their volume jam, the others grow between them, ", p.coarse_share);
  if (p.inertial_number > 0.0)
    how +=
        fmt::format("the box shrinks at inertial number {:g} (restitution {:g}), ", p.inertial_number, p.restitution);
  how += fmt::format(
      "all relax with mu = {:g} under {:g} E{}, to {:g} of {}", p.friction, spec.start_pressure,
      p.first_pressure > 1.0 ? fmt::format(" (from {:g} times that)", p.first_pressure) : "", p.tolerance,
      spec.balance == Balance::own_load ? "the mean contact force, or of what a body bears itself where that is more"
                                        : "the mean contact force");
  out.add("preparation", to_string(spec.preparation), how);
  if (!setup.density) return;
  const DensityTarget& target = *setup.density;
  out.add("target_density",
          {{"solid_fraction", target.solid_fraction(spec.density)}, {"solid_fraction_tolerance", target.tolerance}},
          fmt::format("target {}, met by a friction while packed between 0 and {:g}: 1 to {} preparations of each "
                      "sample, usually about {}",
                      target.text(spec.density), p.friction, kMostDensityTries, kUsualDensityTries));
}

void warn_of_scene(const MacroSetup& setup, const BodyCounts& count, Findings& out) {
  if (count.soft < count.all) out.warn_of_metres("the largest solid grain", setup.spec.solid_radius_max);
  if (count.soft > 0.0) out.warn_of_metres("the largest soft particle", setup.spec.soft_radius_max);
  out.warn_of_grains(setup.spec.youngs_modulus, setup.spec.density);
  constexpr double kFew = 50.0;
  if (count.all < kFew)
    out.warn(fmt::format("{:.0f} bodies are few: most touch a wall, and samples will differ widely", count.all));
  if (setup.samples < 3 && count.all < 4.0 * kFew)
    out.warn(
        fmt::format("{} of {:.0f} bodies: no way to tell scatter from difference; the scatter of stress is "
                    "about 10 %",
                    counted(setup.samples, "sample"), count.all));
  if (setup.spec.soft_share > 0.0 && count.soft < 1.0)
    out.warn("soft_share is so small that the scene has no soft particle");
  constexpr double kLargeStep = 0.01;
  for (const MacroStage& stage : stages_of(setup.spec)) {
    double step = 0.0;
    for (const AxisDrive& drive : stage.axis)
      if (!drive.by_stress)
        step = std::max(step, std::abs(drive.value) / static_cast<double>(stage.steps * stage.increments_per_step));
    step = std::max(step, std::abs(shear_increment(stage)));
    if (step > kLargeStep)
      out.warn(fmt::format(
          "{}an increment strains by {:.2g}: bodies jump by a good part of an overlap; more steps or "
          "increments_per_step",
          setup.spec.test == MacroTest::stages ? fmt::format("stage '{}': ", stage.record.name) : "", step));
  }
}

std::string test_text(const MacroSpec& spec) {
  if (spec.test != MacroTest::stages)
    return fmt::format("{} test to a strain of {}", to_string(spec.test), spec.strain_end);
  std::string names;
  for (const MacroStage& stage : spec.stages) append_part(names, stage.record.name, ", ");
  return fmt::format("test in {}: {}", counted(spec.stages.size(), "stage"), names);
}

}  // namespace

AffineOverlap affine_overlap(const MacroSpec& spec) {
  if (spec.test == MacroTest::stages) {
    const RoughStrains rough = rough_strains(spec);
    return {2.0 / 3.0 * rough.largest_volumetric, 2.0 * rough.largest_axial};
  }
  const double strain = is_shear(spec.test) ? spec.strain_end + spec.preload : spec.strain_end;
  const double along = 2.0 * strain;
  if (spec.test == MacroTest::isotropic) return {along, along};
  if (spec.test == MacroTest::oedometric) return {along / 3.0, along};
  return {2.0 * spec.preload, along};
}

MacroContent content_of(const SoftParticleSpec& spec, std::int64_t count, std::uint64_t seed) {
  constexpr double kBudget = 0.2;
  return content_of(try_soft_particle(spec, seed, kBudget), spec, count, seed);
}

MacroContent content_of(const MeasureTrial& trial, const SoftParticleSpec& spec, std::int64_t count,
                        std::uint64_t seed) {
  constexpr double kBudget = 2.0;  // core seconds
  const auto first = static_cast<double>(trial.packing.radius.size());
  MacroContent out;
  out.contents = count;
  out.grain_pass_seconds = trial.pass_seconds / first;
  out.smallest_grain = *std::min_element(trial.packing.radius.begin(), trial.packing.radius.end());
  double fraction = trial.packing.solid_fraction();
  double sum = first;
  out.grains.push_back(static_cast<std::int64_t>(trial.packing.radius.size()));
  double spent = 0.0;
  for (std::int64_t k = 1; k < count && spent < kBudget; ++k)
    spent += core_seconds_of([&] {
      const ShellPacking one = generate_shell_packing(spec, seed, static_cast<std::uint64_t>(k));
      out.grains.push_back(static_cast<std::int64_t>(one.radius.size()));
      fraction += one.solid_fraction();
      sum += static_cast<double>(one.radius.size());
    });
  out.grains_per_soft = sum / static_cast<double>(out.grains.size());
  out.solid_fraction = fraction / static_cast<double>(out.grains.size());
  return out;
}

namespace {

/// What a sample holds; soft particles are spoken of where there are some.
void tell_bodies(const MacroSetup& setup, const std::vector<BodyCounts>& samples, Findings& out) {
  std::vector<double> all;
  std::vector<double> soft;
  json facts = json::array();
  for (const BodyCounts& one : samples) {
    all.push_back(one.all);
    soft.push_back(one.soft);
    facts.push_back({{"bodies", one.all}, {"soft", one.soft}});
  }
  out.facts["macro_samples"] = facts;
  const bool any = *std::max_element(soft.begin(), soft.end()) > 0.0;
  const bool estimated = static_cast<std::int64_t>(samples.size()) < setup.samples;
  out.add("macro_bodies", mean_of(samples).all,
          fmt::format("macro: {} of {}{} bodies{}{}, {}", counted(setup.samples, "sample"), estimated ? "about " : "",
                      range_text(all), setup.spec.boundary == Boundary::periodic ? " in a periodic cell" : "",
                      any ? fmt::format(", {}{} of them soft", estimated ? "about " : "", range_text(soft)) : "",
                      test_text(setup.spec)));
}

void tell_twins(const MacroSetup& setup, const std::vector<BodyCounts>& samples, const MacroContent& content,
                Findings& out) {
  if (setup.twins.empty()) return;
  std::vector<double> grains;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    grains.push_back(samples[k].all - samples[k].soft + inner_grains(content, samples[k].soft));
    out.facts["macro_samples"][k]["grains_inside"] = inner_grains(content, samples[k].soft);
  }
  const bool exact = all_made(content) && static_cast<std::int64_t>(samples.size()) == setup.samples;
  for (const Twin twin : setup.twins)
    out.lines += fmt::format("  resolved twin ({}): {}{} grains per sample\n", to_string(twin), exact ? "" : "about ",
                             range_text(grains));
  const double most = *std::max_element(grains.begin(), grains.end());
  const double memory = macro_memory(most);
  out.facts["twin_grains"] = grains.front();
  out.add("twin_bytes", memory, fmt::format("memory of a twin: about {:.1f} MB", memory / 1e6));
}

}  // namespace

void check_macro(const MacroSetup& setup, MacroContent content, const LawSources* laws, std::uint64_t seed,
                 Findings& out) {
  const std::vector<BodyCounts> samples = count_bodies(setup, seed);
  const BodyCounts count = mean_of(samples);
  content.bodies = count.all;
  content.soft = count.soft;
  tell_bodies(setup, samples, out);
  const AffineOverlap overlap = affine_overlap(setup.spec);
  out.add("affine_overlap", {{"mean", overlap.mean}, {"largest", overlap.largest}}, load_text(setup.spec));
  tell_twins(setup, samples, content, out);
  tell_preparation(setup, out);
  warn_of_scene(setup, count, out);
  check_lammps(setup, count, out);
  if (laws != nullptr) check_laws_of(*laws, setup.spec, content, out);
  spend_on_macro(setup, content, laws, seed, out);
}

void check_macro_scene(const MacroScene& macro, Findings& out) {
  if (const std::string assumed = assumed_text(macro.setup); !assumed.empty()) out.warn(assumed);
  if (const std::string doubt = room_doubt(macro.setup, macro.seed, "bodies"); !doubt.empty())
    out.warn(doubt + " (key macro.bodies)");
  add_sizes(out, drawn_sizes(macro.setup, macro.seed));
  if (macro.law_file.empty()) {
    out.warn("no law named: macrosim will need --law; give it here too to see what the scene asks of it");
    check_macro(macro.setup, {.grains_per_soft = kGrainsPerSoft}, nullptr, macro.seed, out);
    return;
  }
  out.add("law_file", macro.law_file, "law from " + macro.law_file);
  for (const FittedLaw& law : macro.law.laws)
    if (!law.remark.empty()) out.add("law_library", law.remark, "law library: " + law.remark);
  check_macro(macro.setup,
              macro.setup.twins.empty() ? MacroContent{} : content_of(macro.spec, macro.contents, macro.seed),
              &macro.law, macro.seed, out);
}

}  // namespace softgrain
