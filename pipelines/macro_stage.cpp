#include "pipelines/macro_stage.h"

#include <fmt/format.h>
#include <omp.h>

#include "common/contact/soft_contact_from_card.h"
#include "common/dynamics/force_pass.h"
#include "common/io/progress.h"
#include "common/state/system_io.h"
#include "macrosim/compression.h"
#include "pipelines/parallel_tasks.h"

namespace softgrain {

namespace {

const char* const kCurveArrays[] = {"strain", "axial", "lateral", "axial_contacts", "coordination", "residual"};

std::vector<double>* curve_array(MacroCurve& c, int k) {
  std::vector<double>* const all[] = {&c.strain,       &c.stress_axial, &c.stress_lateral, &c.stress_axial_contacts,
                                      &c.coordination, &c.residual};
  return all[k];
}

void write_progress(const h5::Group& group, const CompressionState& state) {
  MacroCurve curve = state.curve;
  for (int k = 0; k < 6; ++k) group.write(kCurveArrays[k], *curve_array(curve, k));
  group.write("cost", std::vector<double>{static_cast<double>(curve.cost.loop_passes),
                                          static_cast<double>(curve.cost.contact_evaluations), curve.cost.seconds});
  group.attribute("usable", std::int64_t{curve.usable ? 1 : 0});
  group.attribute("note", curve.note);
  write_system(group.create("system"), state.macro.system);
}

void read_progress(const h5::Group& group, CompressionState& state) {
  for (int k = 0; k < 6; ++k) *curve_array(state.curve, k) = group.doubles(kCurveArrays[k]);
  const auto cost = group.doubles("cost");
  state.curve.cost = {static_cast<std::int64_t>(cost.at(0)), static_cast<std::int64_t>(cost.at(1)), cost.at(2)};
  state.curve.usable = group.integer("usable") != 0;
  state.curve.note = group.text("note");
  read_system(group.open("system"), state.macro.system);
}

/// What the tasks share.
struct Stage {
  const MacroSetup& setup;
  const LawCard& card;
  const SoftLaws& laws;
  double inner_solid_fraction;
  const std::vector<ShellPacking>& contents;
  std::uint64_t seed;
  const TaskStore& store;
  const std::vector<MacroPacking>& packings;
};

std::int32_t law_of(const System3& s, const ContactRecord<3>& c) {
  const auto& material = s.particles.material;
  return s.laws.index(material[static_cast<std::size_t>(c.i)], material[static_cast<std::size_t>(c.j)]);
}

double reference_radius(const System3& s, const SoftContact& law, const ContactRecord<3>& c) {
  const double rj = c.j < s.particles.grains ? s.particles.sphere[static_cast<std::size_t>(c.j)].r : 0.0;
  return law.pair_constants({s.particles.sphere[static_cast<std::size_t>(c.i)].r, rj, 0.0, 0.0}).a;
}

/// Largest Delta among the soft contacts of a law run, against the range its laws were fitted in; empty when inside.
std::string extrapolation_note(const System3& s, const LawCard& card) {
  double beyond = 0.0;
  std::string note;
  for (const ContactRecord<3>& c : contact_records(s)) {
    const auto* soft = std::get_if<SoftContact>(&s.laws.law(law_of(s, c)));
    if (soft == nullptr) continue;
    const double delta = c.overlap / reference_radius(s, *soft, c);
    const PairLaw* law = card.find(soft->partner_is_soft ? PairKind::soft_soft : PairKind::soft_solid);
    if (law == nullptr || delta - law->delta_max <= beyond) continue;
    beyond = delta - law->delta_max;
    note = fmt::format(
        "soft contacts reach Delta = {:.2f} at the end, the {} law was fitted up to {:.2f} and is extrapolated", delta,
        to_string(law->kind), law->delta_max);
  }
  return note;
}

MacroCurve run_one(const Stage& stage, std::int64_t sample, bool resolved, Progress& progress) {
  const MacroSpec& spec = stage.setup.spec;
  const MacroPacking& packing = stage.packings[static_cast<std::size_t>(sample)];
  CompressionState state;
  state.macro = resolved
                    ? make_shelled_system(spec, packing, stage.contents, stage.seed, static_cast<std::uint64_t>(sample))
                    : make_law_system(spec, packing, stage.laws, stage.inner_solid_fraction);
  state.curve = begin_curve(spec, packing, state.macro, resolved ? "shelled" : "law", sample);
  const std::string task = "macro-" + state.curve.engine + "-" + std::to_string(sample);
  stage.store.load(task, [&](const h5::Group& g) { read_progress(g, state); });
  double done = static_cast<double>(state.curve.strain.size()) / static_cast<double>(spec.steps + 1);
  progress.advance(done);
  compress(state, spec, [&](const CompressionState& s, double share) {
    stage.store.save(task, [&](const h5::Group& g) { write_progress(g, s); });
    progress.advance(share - done);
    done = share;
  });
  if (!resolved && state.curve.note.empty()) state.curve.note = extrapolation_note(state.macro.system, stage.card);
  return state.curve;
}

/// Samples in parallel when there are enough of them for all threads, else one after another with threads inside.
void over_samples(std::int64_t samples, const std::function<void(std::int64_t)>& task) {
  if (samples >= omp_get_max_threads()) {
    parallel_tasks(samples, task);
  } else {
    for (std::int64_t k = 0; k < samples; ++k) task(k);
  }
}

SoftLaws laws_from_card(const LawCard& card, const MacroSpec& spec) {
  return {make_soft_contact(card, PairKind::soft_solid, spec.youngs_modulus, spec.friction, 0.0, spec.kt_secant),
          make_soft_contact(card, PairKind::soft_soft, spec.youngs_modulus, spec.friction, 0.0, spec.kt_secant)};
}

double mean_solid_fraction(const std::vector<ShellPacking>& contents) {
  double sum = 0.0;
  for (const ShellPacking& p : contents) sum += p.solid_fraction();
  // Without contents the mass of soft particles is that of a solid of the same size; quasi-static results do not depend
  // on it.
  return contents.empty() ? 1.0 : sum / static_cast<double>(contents.size());
}

std::vector<MacroPacking> make_packings(const MacroSetup& setup, std::uint64_t seed, const RunContext& context,
                                        const Provenance& provenance) {
  std::vector<MacroPacking> packings(static_cast<std::size_t>(setup.samples));
  Progress progress("preparing macro samples", static_cast<double>(setup.samples), context.quiet());
  over_samples(setup.samples, [&](std::int64_t k) {
    packings[static_cast<std::size_t>(k)] = make_macro_packing(setup.spec, seed, static_cast<std::uint64_t>(k));
    progress.advance();
  });
  h5::AtomicFile file(context.path("macro_initial.h5"));
  write_provenance(file.root(), provenance);
  for (std::size_t k = 0; k < packings.size(); ++k)
    write_macro_packing(file.root().create("sample_" + std::to_string(k)), packings[k]);
  file.commit();
  return packings;
}

}  // namespace

std::vector<MacroCurve> run_macro_stage(const MacroSetup& setup, const LawCard& card,
                                        const std::vector<ShellPacking>& contents, std::uint64_t seed,
                                        const TaskStore& store, const RunContext& context,
                                        const Provenance& provenance) {
  const SoftLaws laws = laws_from_card(card, setup.spec);
  const auto packings = make_packings(setup, seed, context, provenance);
  const Stage stage{setup, card, laws, mean_solid_fraction(contents), contents, seed, store, packings};
  const auto n = static_cast<std::size_t>(setup.samples);
  std::vector<MacroCurve> curves(setup.resolved ? 2 * n : n);
  {
    Progress progress("macro with laws", static_cast<double>(n), context.quiet());
    over_samples(setup.samples,
                 [&](std::int64_t k) { curves[static_cast<std::size_t>(k)] = run_one(stage, k, false, progress); });
  }
  if (setup.resolved) {
    Progress progress("resolved twins", static_cast<double>(n), context.quiet());
    over_samples(setup.samples,
                 [&](std::int64_t k) { curves[n + static_cast<std::size_t>(k)] = run_one(stage, k, true, progress); });
  }
  save_macro(curves, context.path("macro.h5"), provenance);
  return curves;
}

}  // namespace softgrain
