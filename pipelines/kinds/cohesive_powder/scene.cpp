// Reads scenes of kind "cohesive-powder", and says what follows from them: softgrain check.
#include "pipelines/kinds/cohesive_powder/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/hdf5_file.h"
#include "common/io/text_file.h"
#include "common/packing/grading_scene.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/report/number_format.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

/// Bounds of a stiffness over that by which the adhesion (or the pressure) presses, and of other numbers of the
/// protocol: beyond it they mean nothing, and their products are no numbers.
constexpr double kLeastStiffness = 1.0;
constexpr double kLargestStiffness = 1e12;
constexpr double kLongest = 1e12;  // [T0]
constexpr double kLargest = 1e6;
constexpr double kSmallest = 1e-3;  // diameter over the largest; the time step is as small

void read_disks(const SceneTable& t, PowderSpec& spec) {
  spec.disks = t.count({"count", "disks per packing"}, 2, 1000000, spec.disks);
  spec.diameter_min =
      t.number({"diameter_min", "smallest diameter over a, the largest; diameters are uniform between both"},
               Unit::none, Range::closed(kSmallest, 1.0), spec.diameter_min);
  spec.sizes = read_sizes(
      t, {"sizes", "another distribution, by area, instead of `diameter_min`; its largest size is a", "none"},
      {"diameter_min"}, 2);
  if (spec.sizes) {
    spec.diameter_min = spec.sizes->smallest() / spec.sizes->largest();
    if (spec.diameter_min < kSmallest)
      t.add_error("sizes", fmt::format("the smallest disk is {:.3g} of the largest: must be at least {:g}",
                                       spec.diameter_min, kSmallest));
  }
  spec.solid_fraction = t.number({"solid_fraction", "Phi_I, solid fraction at the start"}, Unit::none,
                                 Range{0.0, 0.9, true, true}, spec.solid_fraction);
}

void read_contact(const SceneTable& t, PowderSpec& spec) {
  spec.cohesive = t.flag({"cohesive", "adhesion F0 or none"}, spec.cohesive);
  spec.stiffness = t.number({"kappa", "stiffness a K_N/F0; without cohesion K_N/P"}, Unit::none,
                            Range::closed(kLeastStiffness, kLargestStiffness), spec.stiffness);
  spec.stiffness_ratio =
      t.number({"kt_ratio", "K_T/K_N"}, Unit::none, Range{0.0, 100.0, true, false}, spec.stiffness_ratio);
  spec.friction =
      t.number({"mu", "friction; 0 omits tangential springs and spins"}, Unit::none, Range::friction(), spec.friction);
  spec.damping = t.number({"zeta", "damping, as a fraction of critical damping"}, Unit::none, Range::closed(0.0, 100.0),
                          spec.damping);
  spec.range =
      t.number({"range", "range D0 of the attraction, over a"}, Unit::none, Range{0.0, 0.5, true, false}, spec.range);
  spec.rolling = t.flag({"rolling", "rolling resistance"}, spec.rolling);
  spec.rolling_stiffness = t.number({"rolling_stiffness", "with `rolling = true`: stiffness K_r [N m] over a^2 K_N"},
                                    Unit::none, Range{0.0, kLargest, true, false}, spec.rolling_stiffness);
  spec.rolling_friction =
      t.number({"rolling_friction",
                "with `rolling = true`: mu_r [m] over mu a; the rolling moment is at most mu_r K_N h at the overlap h"},
               Unit::none, Range::closed(0.0, kLargest), spec.rolling_friction);
  if (!spec.rolling)
    t.refuse({"rolling_stiffness", "rolling_friction"}, "goes with rolling = true: nothing resists rolling here");
}

/// L/a of the start.
double start_edge(const PowderSpec& spec) {
  double area = 0.0;
  for (const double d : drawn_diameters(spec, 1, 0)) area += 0.25 * std::numbers::pi * d * d;
  return std::sqrt(area / spec.solid_fraction);
}

/// Keys of before, whose numbers meant something else. `valid`: the other tables have no errors.
void refuse_old_keys(const SceneTable& t, const PowderSpec& spec, bool valid) {
  const bool all_valid = valid && !t.has_errors();
  const auto refuse = [&](const Key& key, const char* meant, const char* now, const char* means, bool grows) {
    if (!t.has(key.name)) return;
    const double length = all_valid ? start_edge(spec) : 0.0;
    const double old = t.number(key, Unit::none, Range::not_negative(), 0.0);
    std::string text = fmt::format("this key was {}; now it is {}, {}", meant, now, means);
    if (length > 0.0)
      text +=
          fmt::format(": {} would be {} = {} (L/a = {} at the start)", report::format_number(old, 4), now,
                      report::format_number(grows ? old * length : old / length, 3), report::format_number(length, 3));
    t.add_error(key.name, text);
  };
  refuse(Key::of_before("cell_mass"), "the inertia of the cell over (sum of m)/(L/a)", "cell_inertia",
         "over the sum of m", false);
  refuse(Key::of_before("strain_rate_cap"), "a largest strain rate, over 1/T0", "edge_speed_cap",
         "the largest |dL/dt| in a/T0", true);
}

void read_protocol(const SceneTable& t, PowderSetup& setup) {
  PowderProtocol& p = setup.protocol;
  const bool aggregates = p.method == 2;
  p.edge_speed_cap = t.number({"edge_speed_cap", "largest |dL/dt| of a cell edge of length L, in a/T0; 0: none",
                               "0 for method 1, 0.05 for method 2"},
                              Unit::none, Range::closed(0.0, kLargest), aggregates ? 0.05 : 0.0);
  if (!aggregates) t.refuse({"aggregation_kappa", "stiffening_time"}, "only method 2 has disks that aggregate first");
  if (!aggregates) return;
  p.aggregation_kappa = t.number({"aggregation_kappa", "method 2: stiffness during aggregation; 0: `kappa`"},
                                 Unit::none, Range::closed(0.0, kLargestStiffness), 0.0);
  if (p.aggregation_kappa > 0.0 && p.aggregation_kappa < kLeastStiffness)
    t.add_error("aggregation_kappa",
                fmt::format("must be 0, or from {:g} to {:g}", kLeastStiffness, kLargestStiffness));
  if (p.aggregation_kappa == 0.0) t.refuse({"stiffening_time"}, "nothing stiffens without an aggregation_kappa");
  if (p.aggregation_kappa > 0.0)
    p.stiffening_time = t.number(
        {"stiffening_time", "method 2 with `aggregation_kappa`: time in T0 in which the stiffness grows to `kappa`"},
        Unit::none, Range{0.0, kLongest, true, false}, p.stiffening_time);
}

/// Reads `pressures`: they rise to a largest one and, where that is not the last, fall from there.
void read_pressures(const SceneTable& t, PowderSetup& setup) {
  if (!t.has("pressures")) return;
  t.refuse({"pressure"}, "\"pressures\" says them all: leave one of the two out");
  const std::vector<double> p = t.numbers({"pressures",
                                           "instead of `pressure`: a list of P*, each held until equilibrium; they "
                                           "increase to a largest one and may then decrease",
                                           "none"},
                                          Unit::none, Range{0.0, kLargestStiffness, true, false});
  if (p.empty()) {
    t.add_error("pressures", "needs at least one pressure");
    return;
  }
  const auto top = std::max_element(p.begin(), p.end());
  const bool up = std::adjacent_find(p.begin(), top, std::greater_equal<>()) == top;
  const bool down = std::adjacent_find(top, p.end(), std::less_equal<>()) == p.end();
  if (!up || !down)
    t.add_error("pressures",
                "must rise to a largest one and may fall from there, each but once: consolidation and its "
                "unloading");
  setup.protocol.pressures = p;
  setup.spec.pressure = p.back();
}

/// Whether the cell can close at the speed that it is allowed, in the time and in a day.
void check_cap(const SceneTable& t, const PowderSetup& setup, bool valid) {
  const double cap = setup.protocol.edge_speed_cap;
  if (!valid || t.has_errors() || !(cap > 0.0) || !(setup.largest_stress() > 0.0)) return;
  constexpr double kDense = 0.85;        // no pack of disks is denser
  constexpr double kPairSeconds = 2e-8;  // of one core, and 2 pairs per disk
  constexpr double kDay = 86400.0;
  const double way = start_edge(setup.spec) * (1.0 - std::sqrt(setup.spec.solid_fraction / kDense));
  const double time = way / cap;
  const double seconds = time / setup.time_step() * 2.0 * static_cast<double>(setup.spec.disks) * kPairSeconds;
  if (time > setup.options.time_max)
    t.add_error("edge_speed_cap",
                fmt::format("the cell would need {} T0 to close by {} a, a phase ends after time_max = {}: allow at "
                            "least {} a/T0, or more time",
                            report::format_number(time, 3), report::format_number(way, 3),
                            report::format_number(setup.options.time_max, 4),
                            report::format_number(way / setup.options.time_max, 2)));
  else if (seconds > kDay)
    t.add_error("edge_speed_cap",
                fmt::format("the cell would need about {} days of one core to close: allow at least "
                            "{} a/T0",
                            report::format_number(seconds / kDay, 2), report::format_number(cap * seconds / kDay, 2)));
}

/// `valid`: [contact] has no errors.
void read_assembly(const SceneTable& t, PowderSetup& setup, bool valid) {
  setup.protocol.method = static_cast<int>(
      t.count({"method",
               "1: disks start at rest and the pressure acts at once; 2: disks first aggregate in a fixed cell, then "
               "the cell is released (contacts stiffen there if `aggregation_kappa` is given), then the pressure acts"},
              1, 2, 1));
  for (const char* key : {"pressure", "pressures"})
    if (valid && !setup.spec.cohesive && t.has(key))
      t.add_error(key, "without cohesion P a is the unit of force: the stiffness kappa = K_N/P says how hard it is");
  if (valid && !setup.spec.cohesive && setup.protocol.method == 2)
    t.add_error("method", "disks without cohesion do not aggregate");
  setup.spec.pressure = t.number({"pressure", "pressure P* = P a/F0; refused without cohesion"}, Unit::none,
                                 Range::closed(0.0, kLargestStiffness), setup.spec.pressure);
  read_pressures(t, setup);
  if (valid && setup.protocol.method == 1 && setup.spec.cohesive && setup.spec.pressure == 0.0)
    t.add_error("pressure", "method 1 starts at rest: without pressure nothing moves");
  setup.spec.start_speed = setup.protocol.method == 2
                               ? t.number({"start_speed",
                                           "method 2: root mean square V0 of each velocity component, over sqrt(F0 "
                                           "D0/m); that of the speed is sqrt 2 V0"},
                                          Unit::none, Range{0.0, kLargest, true, false}, 9.48)
                               : 0.0;
  if (t.has_errors()) (void)t.has("start_speed");
  refuse_old_keys(t, setup.spec, valid);
  read_protocol(t, setup);
  setup.options.cell_inertia =
      t.number({"cell_inertia",
                "inertia Mc of the cell over the mass of all disks: Mc d^2eps/dt^2 = P - "
                "stress; eps is the strain since the start of the phase"},
               Unit::none, Range::closed(1.0 / kLargest, kLargest), setup.options.cell_inertia);
  setup.options.step = t.number({"step", "time step over sqrt(m_min/K_N), m_min the smallest mass"}, Unit::none,
                                Range::closed(1e-6, 0.5), setup.options.step);
  setup.options.settle_drag =
      t.number({"settle_drag",
                "drag on the last vibrations, in 1/T0; 0: none, as published, which takes three to ten times as long"},
               Unit::none, Range::closed(0.0, 10.0), setup.options.settle_drag);
  setup.options.settle_kinetic = t.number(
      {"settle_kinetic", "the drag starts only when the kinetic energy per disk is also below this, in F1^2/K_N"},
      Unit::none, Range::closed(0.0, kLargest), setup.options.settle_kinetic);
  setup.options.settle_after =
      t.number({"settle_after", "the drag starts when cell or contacts have not changed for this time, in T0"},
               Unit::none, Range::closed(0.0, kLongest), setup.options.settle_after);
  setup.options.time_max = t.number({"time_max", "longest phase, in T0"}, Unit::none, Range{0.0, kLongest, true, false},
                                    setup.options.time_max);
  setup.options.record_every = t.number({"record_every", "time between recorded points, in T0"}, Unit::none,
                                        Range{0.0, kLongest, true, false}, setup.options.record_every);
  check_cap(t, setup, valid);
}

void read_structure(const SceneTable& t, PowderStructureOptions& o) {
  o.scattering =
      t.flag({"scattering",
              "analysis of the intensity I(k) of the density field, with fractal dimension and correlation length"},
             o.scattering);
  o.holes = t.flag({"holes", "analysis of the holes: their radii"}, o.holes);
  o.mesh = t.number({"mesh", "of `scattering` and `holes`: cells of the density field per a"}, Unit::none,
                    Range{5.0, 1000.0, false, false}, o.mesh);
  o.fit_k_max = t.number({"fit_k_max", "of `scattering`: largest wave number k of the fit, times a", "pi"}, Unit::none,
                         Range{0.0, 100.0, true, false}, o.fit_k_max);
  if (!o.scattering) t.refuse({"fit_k_max"}, "goes with scattering = true: nothing is fitted here");
  if (!o.scattering && !o.holes) t.refuse({"mesh"}, "goes with scattering or holes, which are found on the mesh");
}

}  // namespace

double PowderSetup::largest_stress() const {
  double most = 0.0;
  for (const PowderPhase& phase : phases()) most = std::max(most, phase.pressure);
  return most;
}

std::string powder_text(const PowderSetup& setup) {
  const std::string states = setup.states.empty() ? "" : short_hash(read_text(setup.states));
  return sizes_text(setup.spec) + (setup.protocol.method == 2 ? "V0 per component\n" : "") + states;
}

std::vector<DrawnSizes> drawn_sizes(const PowderSetup& setup, std::uint64_t seed) {
  if (!setup.spec.sizes || !setup.states.empty()) return {};
  const double largest = setup.spec.sizes->largest();
  DrawnSizes sizes{.of = "disks", .asked = *setup.spec.sizes, .samples = {}, .unit = "a", .scale = 0.5 / largest};
  for (std::int64_t k = 0; k < setup.samples; ++k) {
    sizes.samples.push_back(drawn_diameters(setup.spec, seed, static_cast<std::uint64_t>(k)));
    for (double& d : sizes.samples.back()) d *= largest;
  }
  return {sizes};
}

PowderSetup read_powder(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    (void)root.choice(kKindKey, {"cohesive-powder"});
    PowderSetup setup;
    setup.title = root.title();
    setup.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
    setup.samples = root.count({"samples", "number of packings"}, 1, 10000, 1);
    read_disks(root.table_or_empty({"disks", "disks of a packing; a is the largest diameter"}), setup.spec);
    const SceneTable contact = root.table_or_empty({"contact",
                                                    "contact law of the disks: adhesion force F0 (P a without "
                                                    "cohesion), normal and tangential stiffness K_N, K_T"});
    read_contact(contact, setup.spec);
    read_assembly(root.table_or_empty({"assembly",
                                       "protocol of the packing; T0 = sqrt(m a/F0), m is the mass of a disk of "
                                       "diameter a, F1 the larger of F0 and P a"}),
                  setup, !contact.has_errors());
    const SceneTable analysis = root.table_or_empty({"analysis", "what is found out about the packings"});
    setup.rigidity = analysis.flag(
        {"rigidity",
         "analysis of self-stresses `h` and floppy modes `k`, and whether the springs make the packing rigid"},
        setup.rigidity);
    setup.states =
        analysis.has("states")
            ? scene.resolve(analysis.filled_text(
                  {"states", "`powder.h5` of an earlier run; its states are analysed and no new packings are made",
                   "none"}))
            : "";
    read_structure(analysis, setup.structure);
    // What is not there shows before any work.
    if (!analysis.has_errors() && !setup.states.empty()) (void)h5::open_file(setup.states);
    return setup;
  });
}

namespace {

using nlohmann::json;

std::string check_setup(const PowderSetup& setup, json& facts) {
  const double step = setup.time_step();
  const auto phases = static_cast<double>(setup.phases().size());
  facts["samples"] = setup.samples;
  facts["disks"] = setup.spec.disks;
  facts["time_step"] = step;
  facts["steps_max"] = phases * setup.options.time_max / step;
  return fmt::format("{} of {} disks, {}; time step {:.3g} T0 or a little more, at most {:.3g} steps each\n",
                     counted(setup.samples, "sample"), setup.spec.disks, counted(std::llround(phases), "phase"), step,
                     phases * setup.options.time_max / step);
}

/// Overlap of a contact at rest: adhesion presses by F0, the load by about P a, over K_N.
double expected_overlap(const PowderSetup& setup) {
  const double force = (setup.spec.cohesive ? 1.0 : 0.0) + setup.largest_stress();
  return force / setup.spec.stiffness;
}

/// Small, soft samples that are assembled the same way.
struct PowderTrial {
  double disks = 0.0;
  double pass_seconds = 0.0;   ///< core seconds per loop pass
  std::vector<double> time{};  ///< mean duration of each phase [T0]
};

/// Assembles a sample as far as a short time budget allows.
PowderState assemble_in_a_moment(const PowderSpec& spec, const std::vector<PowderPhase>& phases,
                                 const PowderSetup& setup, std::uint64_t sample) {
  constexpr double kBudget = 0.8;
  PowderState state = start_powder(spec, setup.seed, sample);
  PowderOptions options = setup.options;
  options.record_every = std::min(options.record_every, PowderOptions{}.record_every);  // when it is looked at
  const double start = thread_seconds();
  RunControl<PowderState> control;
  control.save = [&](const PowderState&) {
    if (thread_seconds() - start > kBudget) throw TrialOver{};
  };
  try {
    (void)run_powder(state, spec, phases, options, control);
  } catch (const TrialOver&) {
  } catch (const UnusableResult&) {  // the run will say so
  }
  return state;
}

/// What every phase took; of what did not get to its end the mean, on a scale of ratios, of what was seen and what it
/// may take.
std::vector<double> phase_times(const PowderState& state, std::size_t phases, double time_max) {
  std::vector<double> out(phases, 0.0);
  double before = 0.0;
  for (const PowderPoint& p : state.points) {
    out[static_cast<std::size_t>(p.phase)] += p.time - before;
    before = p.time;
  }
  for (auto k = static_cast<std::size_t>(state.phase); k < phases; ++k)
    out[k] = std::sqrt(std::max(out[k], 1.0) * time_max);
  return out;
}

/// Single samples of this size differ by a third.
PowderTrial try_assembly(const PowderSetup& setup) {
  constexpr std::int64_t kDisks = 100;
  constexpr double kSoft = 100.0;  // kappa
  constexpr std::uint64_t kSamples = 2;
  PowderSpec spec = setup.spec;
  spec.disks = std::min(spec.disks, kDisks);
  spec.stiffness = std::min(spec.stiffness, kSoft);
  // Rolling is as stiff as it will be: soft, it would swing for longer than anything else. Soft aggregates do.
  if (!(setup.protocol.aggregation_kappa > 0.0)) spec.rolling_stiffness *= setup.spec.stiffness / spec.stiffness;
  PowderProtocol protocol = setup.protocol;
  protocol.aggregation_kappa = 0.0;
  // The edges of a small cell have a shorter way: they go at the strain rate of the cell that is asked about.
  protocol.edge_speed_cap *= std::sqrt(static_cast<double>(spec.disks) / static_cast<double>(setup.spec.disks));
  const std::vector<PowderPhase> phases = powder_phases(spec, protocol);
  PowderTrial t{.disks = static_cast<double>(spec.disks)};
  t.time.assign(phases.size(), 0.0);
  double passes = 0.0;
  const double seconds = core_seconds_of([&] {
    for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
      const PowderState state = assemble_in_a_moment(spec, phases, setup, sample);
      const std::vector<double> times = phase_times(state, phases.size(), setup.options.time_max);
      for (std::size_t k = 0; k < phases.size(); ++k) t.time[k] += times[k] / static_cast<double>(kSamples);
      passes += static_cast<double>(state.system.cost.loop_passes);
    }
  });
  t.pass_seconds = seconds / std::max(passes, 1.0);
  return t;
}

/// Time until disks rest in a phase [T0]: that of the trial, longer in larger samples (1.2 to 1.4 times for four times
/// as many disks), once contacts have stiffened, which they do not in the trial.
double expected_time(const PowderSetup& setup, const PowderTrial& trial, const PowderPhase& phase, double of_trial) {
  const double larger = std::pow(static_cast<double>(setup.spec.disks) / trial.disks, 0.2);
  return std::min(phase.stiffening + of_trial * larger, setup.options.time_max);
}

/// Passes of a phase that begins with contacts of stiffness `before`.
double expected_passes(const PowderSetup& setup, const PowderPhase& phase, double before, double time) {
  const double per_time = 1.0 / (setup.options.step * setup.spec.diameter_min);  // at stiffness 1
  const double rise = std::log(phase.stiffness / before);
  const bool stiffens = phase.stiffening > 0.0 && rise != 0.0;
  const double stiffening = stiffens ? std::min(phase.stiffening, time) : 0.0;
  const double between = stiffens ? 2.0 * (std::sqrt(phase.stiffness) - std::sqrt(before)) / rise : 0.0;
  return per_time * (stiffening * between + (time - stiffening) * std::sqrt(phase.stiffness));
}

void spend_on_assembly(const PowderSetup& setup, Findings& out) {
  if (!setup.states.empty()) return;  // nothing is assembled
  const PowderTrial trial = try_assembly(setup);
  const std::vector<PowderPhase> phases = setup.phases();
  double passes = 0.0;
  double before = phases.front().stiffness;
  for (std::size_t k = 0; k < phases.size(); ++k) {
    passes += expected_passes(setup, phases[k], before, expected_time(setup, trial, phases[k], trial.time[k]));
    before = phases[k].stiffness;
  }
  out.spend("assembly", trial.pass_seconds * static_cast<double>(setup.spec.disks) / trial.disks * passes *
                            static_cast<double>(setup.samples));
}

void warn_of_setup(const PowderSetup& setup, const std::string& name, Findings& out) {
  const std::string of = name.empty() ? "" : name + ": ";
  constexpr double kChatter = 0.147;
  if (setup.options.step > kChatter)
    out.warn(of +
             fmt::format("step = {}: above {} the dashpots of the smallest disks are unstable, contacts chatter and a "
                         "sample never rests",
                         setup.options.step, kChatter));
  constexpr double kSoft = 0.01;
  const double overlap = expected_overlap(setup);
  if (overlap > kSoft)
    out.warn(of + fmt::format("contacts overlap by about {:.2g} a at rest: kappa = {:.3g} is soft for this pressure",
                              overlap, setup.spec.stiffness));
  if (setup.spec.cohesive && overlap > 0.0 && setup.spec.range < 1.0 / setup.spec.stiffness)
    out.warn(of +
             fmt::format("the range of attraction ({:.3g} a) is shorter than the overlap that adhesion makes ({:.3g} "
                         "a)",
                         setup.spec.range, 1.0 / setup.spec.stiffness));
  if (setup.samples < 3)
    out.warn(of + fmt::format("{}: no scatter to judge differences by; the published means are over four",
                              counted(setup.samples, "sample")));
  constexpr std::int64_t kFew = 300;
  if (setup.spec.disks < kFew)
    out.warn(of + fmt::format("{} disks are few: chains of force span so small a cell", setup.spec.disks));
}

void check_one(const PowderSetup& setup, Findings& out) {
  out.lines += "  " + check_setup(setup, out.facts);
  const double overlap = expected_overlap(setup);
  out.add("overlap", overlap, fmt::format("contacts overlap by about {:.2g} of the largest diameter at rest", overlap));
  add_sizes(out, drawn_sizes(setup, setup.seed));
  warn_of_setup(setup, "", out);
  spend_on_assembly(setup, out);
}

}  // namespace

void check_powder(const Scene& scene, Findings& out) {
  if (!has_powder_variants(scene)) {
    check_one(read_powder(scene), out);
    return;
  }
  for (const PowderVariant& v : read_powder_variants(scene)) {
    json one{{"name", v.name}, {"picked", v.picked}};
    out.lines += fmt::format("  {}{}: {}", v.name, v.picked ? "" : " (left out)", check_setup(v.setup, one));
    out.facts["variants"].push_back(one);
    if (!v.picked) continue;
    warn_of_setup(v.setup, v.name, out);
    spend_on_assembly(v.setup, out);
  }
}

}  // namespace softgrain
