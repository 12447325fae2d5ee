// Models of a resolved material: made from its packings and run, or without bodies of their own by the equation of
// state at the mean density.
#include "pipelines/kinds/material_models/models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/core/text.h"
#include "common/packing/grading.h"
#include "macrosim/body_contacts.h"
#include "macrosim/cell_specimen.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/law/law_draws.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

namespace {

const MacroSpec& spec_of(const VariantResult& truth) { return truth.variant->setup.spec; }
double cut_of(const MaterialModel& m, const VariantResult& truth) { return m.split * spec_of(truth).solid_radius_max; }

/// What is common to the runs of one model: its name in files and progress, one sample at a time.
struct OneSample {
  const MaterialModel& model;
  const VariantResult& truth;
  const Run& run;
  SubstituteRuns& substitutes;
  std::string draw{};  ///< of the card, in the names of its files and in progress; empty: the card itself

  /// Bodies in places of their own, which no loading moves.
  [[nodiscard]] MacroPacking own_packing(const std::string& key, const std::function<MacroPacking()>& make) const {
    return kept_packing(key, SharedResults::name("model_packing", key), run, make);
  }
  [[nodiscard]] MacroPacking own_packing(const MacroSpec& spec, std::size_t sample) const {
    return own_packing(packing_key(spec, run.seed, sample), [&] { return make_packing(spec, run.seed, sample); });
  }

  /// Every sample may have a setup of its own: its share of fines, its start.
  MacroCurve test(MacroSetup setup, const MacroPacking& packing, std::size_t sample, const NamedLaws* law) const {
    setup.samples = 1;
    setup.kept_states = 0;
    setup.twins.clear();
    // Names have no '+': of "m" on "x-y" and "m-x" on "y" neither goes on from the checkpoints of the other.
    std::string name = fmt::format("{}+{}+{}", model.name, truth.variant->name, sample);
    if (!draw.empty()) name += "+" + draw;
    const std::vector<MacroPacking> packings{packing};
    std::vector<NamedLaws> laws;
    if (law != nullptr) laws.push_back(*law);
    const std::string progress = fmt::format("model {} of {}, sample {}{}", model.name, truth.variant->name, sample,
                                             draw.empty() ? "" : ", " + draw);
    MacroCurve c = std::move(run_engines({setup, packings, {}, run.seed, name, progress}, laws, run, "").front());
    c.sample = static_cast<std::int64_t>(sample);
    c.engine = model.name;
    return c;
  }
};

MacroPacking in_box_of(const MacroPacking& packing, std::vector<MacroBody> bodies) {
  MacroPacking out;
  out.low = packing.low;
  out.high = packing.high;
  out.bodies = std::move(bodies);
  return out;
}

constexpr RandomPurpose kShellRadii{71};

/// b of the sizes that a model draws by itself: that of the material; where there is none, what scenes mean that say
/// nothing.
double drawn_exponent(const MacroSpec& spec) { return exponent_of(spec).value_or(MacroSpec{}.exponent); }

CoarseAndFine parted_or_refused(const MacroPacking& packing, double cut) {
  CoarseAndFine parts = parted(packing, cut);
  if (parts.coarse.empty() || !(parts.fines_volume > 0.0))
    throw UnusableResult("the material has no grains on one side of the split");
  return parts;
}

/// Steps as they are recorded: cells need no smaller ones.
MacroSetup coarse_steps(MacroSetup setup) {
  setup.spec.increments_per_step = 1;
  for (MacroStage& stage : setup.spec.stages) stage.increments_per_step = 1;
  return setup;
}

/// Number of bodies of a mixture such that about as many of them as in the truth are coarse.
std::int64_t bodies_for(MacroSpec spec, double cut, std::size_t coarse, std::uint64_t seed) {
  constexpr std::int64_t kTrial = 4000;
  spec.bodies = kTrial;
  double found = 0.0;
  for (const MacroBody& b : drawn_bodies(spec, seed, 0)) found += !b.soft && b.r >= cut ? 1.0 : 0.0;
  if (!(found > 0.0)) throw UnusableResult("a coarse-grained substitute of this material has hardly any coarse grains");
  return std::max<std::int64_t>(30, std::llround(static_cast<double>(kTrial) * static_cast<double>(coarse) / found));
}

MacroCurve cells_of(const OneSample& one, std::size_t sample) {
  if (any_slides(stages_of(spec_of(one.truth)))) throw UnusableResult("cells are rectangular: they do not slide");
  const MaterialModel& m = one.model;
  const MacroPacking& whole = one.truth.packings->at(sample);
  const CoarseAndFine parts = parted_or_refused(whole, cut_of(m, one.truth));
  MacroSetup setup = coarse_steps(one.truth.variant->setup);
  const bool by_density = m.start == ModelStart::density;
  setup.spec.cells = CellMatter{*m.card, parts.share(), 0.0, by_density, known_preparation(*m.card, setup.spec)};
  setup.spec.bodies = static_cast<std::int64_t>(parts.coarse.size());
  if (m.places == ModelPlaces::truth) return one.test(setup, in_box_of(whole, parts.coarse), sample, nullptr);
  if (by_density) setup.spec.cells->solid_fraction = whole.solid_fraction();
  take_sizes(setup.spec,
             Grading::classes(pieces_between(sizes_of(spec_of(one.truth)), cut_of(m, one.truth), kInfinity)));
  if (m.soft_share > 0.0) {
    setup.spec.soft_share = m.soft_share;
    setup.spec.exponent = drawn_exponent(spec_of(one.truth));
    setup.spec.soft_radius_max = m.radii[1] * spec_of(one.truth).solid_radius_max;
    setup.spec.soft_polydispersity = m.radii[1] / m.radii[0];
    setup.spec.bodies = bodies_for(setup.spec, cut_of(m, one.truth), parts.coarse.size(), one.run.seed);
  }
  return one.test(setup, one.own_packing(setup.spec, sample), sample, nullptr);
}

MacroCurve coarse_of(const OneSample& one, std::size_t sample) {
  const MacroPacking& whole = one.truth.packings->at(sample);
  const CoarseAndFine parts = parted_or_refused(whole, cut_of(one.model, one.truth));
  MacroSetup setup = one.truth.variant->setup;
  setup.spec.bodies = static_cast<std::int64_t>(parts.coarse.size());
  const NamedLaws laws = no_soft_laws();
  return one.test(setup, in_box_of(whole, parts.coarse), sample, &laws);
}

MacroCurve raw_substitute_of(const OneSample& one, std::size_t sample) {
  const MaterialModel& m = one.model;
  const MacroSpec& truth = spec_of(one.truth);
  const double cut = cut_of(m, one.truth);
  const double smallest = m.smallest * truth.solid_radius_max;
  const CoarseAndFine parts = parted_or_refused(one.truth.packings->at(sample), cut);
  MacroSetup setup = one.truth.variant->setup;
  const auto fines = pieces_between(Grading::power_law(drawn_exponent(truth), smallest, cut), 0.0, kInfinity);
  take_sizes(setup.spec, mixture_of(pieces_between(sizes_of(truth), cut, kInfinity), fines, parts.share()));
  setup.spec.bodies = bodies_for(setup.spec, cut, parts.coarse.size(), one.run.seed);
  const NamedLaws laws = no_soft_laws();
  return one.test(setup, one.own_packing(setup.spec, sample), sample, &laws);
}

MacroCurve substitute_of(const OneSample& one, std::size_t sample) {
  const MaterialModel& m = one.model;
  const std::tuple key{m.split, m.smallest, sample};
  auto raw = one.substitutes.find(key);
  if (raw == one.substitutes.end()) raw = one.substitutes.emplace(key, raw_substitute_of(one, sample)).first;
  MacroCurve c = raw->second;
  c.engine = m.name;
  if (m.mapped) map_by_state(*m.card, one.truth.curves[sample], spec_of(one.truth).start_pressure, c);
  return c;
}

/// The fines' volume in shells of the solid fraction that the law was measured with; packed with the coarse grains as
/// hard spheres, brought into the box of the truth, shells then scaled.
MacroCurve shells_of(const OneSample& one, std::size_t sample) {
  const MaterialModel& m = one.model;
  const MacroPacking& whole = one.truth.packings->at(sample);
  const CoarseAndFine parts = parted_or_refused(whole, cut_of(m, one.truth));
  const double inside = law_fraction(*m.law, 0.0) > 0.0 ? law_fraction(*m.law, 0.0) : 1.0;
  MacroSetup setup = one.truth.variant->setup;
  const double largest = setup.spec.solid_radius_max;
  const double exponent = drawn_exponent(setup.spec);
  const Grading shells = Grading::power_law(exponent, m.radii[0] * largest, m.radii[1] * largest);
  const std::string key =
      fmt::format("{}shells for fines below {:.17g}, radii {:.17g} to {:.17g}, b = {:.17g}, solid inside {:.17g}\n",
                  packing_key(setup.spec, one.run.seed, sample), m.split, m.radii[0], m.radii[1], exponent, inside);
  MacroPacking packing = one.own_packing(key, [&] {
    return pack_bodies(setup.spec, with_shells(parts.coarse, shells, parts.fines_volume / inside, one.run.seed, sample),
                       one.run.seed, sample);
  });
  setup.spec.bodies = static_cast<std::int64_t>(packing.bodies.size());
  bring_into_volume(packing, whole.size()[0] * whole.size()[1] * whole.size()[2], m.scale);
  const NamedLaws law = scene_law(*m.law, setup.spec, inside, m.name);
  return one.test(setup, packing, sample, &law);
}

MacroCurve mean_field_of(const OneSample& one, std::size_t sample) {
  const MacroCurve& truth = one.truth.curves[sample];
  const double pressure = spec_of(one.truth).start_pressure;
  const CellCard& card = *one.model.card;
  if (is_shear(truth.test)) throw UnusableResult("a mean field does not apply to shear");
  if (truth.test == MacroTest::stages)
    throw UnusableResult("a mean field does not apply to tests in stages, such as unloading");
  double onset = kNaN;
  if (one.model.start == ModelStart::density) {
    const CoarseAndFine parts =
        parted_or_refused(one.truth.packings->at(sample), card.split * spec_of(one.truth).solid_radius_max);
    onset = onset_by_card(card, parts.share(), known_preparation(card, spec_of(one.truth)));
  }
  MacroCurve c = mean_field(card, truth, pressure, onset);
  c.engine = one.model.name;
  return c;
}

MacroCurve curve_of(const OneSample& one, std::size_t sample) {
  switch (one.model.kind) {
    case ModelKind::cells:
      return cells_of(one, sample);
    case ModelKind::substitute:
      return substitute_of(one, sample);
    case ModelKind::mean_field:
      return mean_field_of(one, sample);
    case ModelKind::coarse:
      return coarse_of(one, sample);
    case ModelKind::shells:
      return shells_of(one, sample);
  }
  return {};
}

}  // namespace

std::vector<MacroBody> with_shells(std::vector<MacroBody> coarse, const Grading& shells, double volume,
                                   std::uint64_t seed, std::size_t sample) {
  RandomStream random(seed, kShellRadii, sample);
  const double mean = kSphereVolume * shells.mean_volume();
  std::vector<double> radii = shells.draw(static_cast<std::size_t>(std::max(1.0, std::round(volume / mean))), random);
  double drawn = 0.0;
  for (const double r : radii) drawn += kSphereVolume * cube(r);
  for (const double r : radii) coarse.push_back({{}, r * std::cbrt(volume / drawn), true});
  std::stable_sort(coarse.begin(), coarse.end(), [](const MacroBody& a, const MacroBody& b) { return a.r > b.r; });
  return coarse;
}

void bring_into_volume(MacroPacking& packing, double volume, double scale) {
  packing.springs.clear();
  const double factor = std::cbrt(volume / (packing.size()[0] * packing.size()[1] * packing.size()[2]));
  for (MacroBody& b : packing.bodies) {
    b.x = packing.low + (b.x - packing.low) * factor;
    if (b.soft) b.r *= scale;
  }
  packing.high = packing.low + packing.size() * factor;
}

CoarseAndFine parted(const MacroPacking& packing, double cut) {
  CoarseAndFine out;
  for (const MacroBody& b : packing.bodies) {
    const double v = kSphereVolume * cube(b.r);
    if (b.r >= cut) out.coarse.push_back(b);
    (b.r >= cut ? out.coarse_volume : out.fines_volume) += v;
  }
  return out;
}

namespace {

/// Largest over smallest radius of the grains below this share of the largest; 0: there are none.
double span_of_fines(const MacroSpec& spec, double split) {
  const Grading sizes = sizes_of(spec);
  double largest = 0.0;
  for (const SizePiece& p : pieces_between(sizes, 0.0, split * spec.solid_radius_max))
    largest = std::max(largest, p.high);
  return largest / sizes.smallest();
}

/// The factor by which void ratios of the card are taken for the preparation of the material; empty where none is.
std::string factor_text(const MaterialModel& model, const MacroSpec& spec) {
  const bool by_density = model.kind == ModelKind::mean_field && model.start == ModelStart::density;
  if (model.kind != ModelKind::cells && !by_density) return "";
  const std::string known = known_preparation(*model.card, spec);
  if (known.empty()) return "";
  return fmt::format(" (void ratios times {:.4g})", *void_ratio_factor(*model.card, known));
}

/// What a model draws by a power law of its own; null: nothing.
const char* drawn_by(const MaterialModel& model) {
  if (model.kind == ModelKind::substitute) return "fines";
  if (model.kind == ModelKind::shells) return "shells";
  return model.kind == ModelKind::cells && model.soft_share > 0.0 ? "soft particles" : nullptr;
}

}  // namespace

std::string assumed_exponent(const MaterialModel& model, const MacroSpec& spec) {
  const char* const drawn = drawn_by(model);
  if (drawn == nullptr || exponent_of(spec)) return "";
  return fmt::format("the sizes of the material are no single power law: those of its {} are drawn from r^-{:g}", drawn,
                     drawn_exponent(spec));
}

std::string other_fines(const MaterialModel& model, const MacroSpec& spec) {
  if (!model.card) return "";
  const CellCard& card = *model.card;
  std::string text;
  const auto add = [&text](const std::string& one) { append_part(text, one); };
  const double span = span_of_fines(spec, model.kind == ModelKind::cells ? model.split : card.split);
  constexpr double kAlike = 0.1;
  if (span > 0.0 && std::abs(span / card.fines_ratio - 1.0) > kAlike)
    add(fmt::format("the card is of fines of ratio {:.3g}, these have {:.3g}", card.fines_ratio, span));
  if (card.preparation != to_string(spec.preparation))
    add(fmt::format("the card is of fines prepared '{}', these are '{}'{}", card.preparation,
                    to_string(spec.preparation), factor_text(model, spec)));
  return text;
}

namespace {

std::vector<MacroCurve> curves_of(const OneSample& one) {
  std::vector<MacroCurve> out;
  for (std::size_t k = 0; k < one.truth.packings->size(); ++k) out.push_back(curve_of(one, k));
  return out;
}

/// Why a model is none for this material; empty: it is one.
std::string refusal_of(const std::function<void()>& go) {
  try {
    go();
  } catch (const UnusableResult& e) {
    return e.what();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

void run_draws(const OneSample& one, ModelRun& out) {
  const LawDraws draws = cell_draws(*one.model.card, one.model.name, one.model.bands);
  std::string why;
  std::size_t refused = 0;
  for (std::size_t k = 0; k < draws.draws.size(); ++k) {
    MaterialModel model = one.model;
    model.card = draws.with(draws.draws[k]).cells;
    const OneSample drawn{model, one.truth, one.run, one.substitutes, fmt::format("draw-{}", k + 1)};
    std::vector<MacroCurve> curves;
    const std::string refusal = refusal_of([&] { curves = curves_of(drawn); });
    if (refusal.empty()) {
      out.drawn.push_back(std::move(curves));
    } else {
      ++refused;
      why = refusal;
    }
  }
  if (refused > 0)
    append_part(out.remark,
                fmt::format("{} of {} draws of the card give no curve ({})", refused, draws.draws.size(), why));
}

}  // namespace

ModelRun run_model(const MaterialModel& model, const VariantResult& truth, const Run& run,
                   SubstituteRuns& substitutes) {
  ModelRun out{&model, &truth, {}, "", other_fines(model, spec_of(truth))};
  if (const std::string assumed = assumed_exponent(model, spec_of(truth)); !assumed.empty())
    append_part(out.remark, assumed);
  const OneSample one{model, truth, run, substitutes};
  out.refusal = refusal_of([&] { out.curves = curves_of(one); });
  if (out.refusal.empty() && model.bands > 0) run_draws(one, out);
  return out;
}

namespace {

/// Argument x of the equation of state K x^n for a mixture with this solid fraction.
double state_of(const CellCard& card, double solid_fraction, double onset) {
  if (card.form == StateForm::porosity) return (solid_fraction - onset) / (1.0 - onset);
  return 1.0 - (1.0 / solid_fraction - 1.0) / (1.0 / onset - 1.0);
}

double pressure_at(const CellCard& card, double state) {
  return state > 0.0 ? card.modulus.value * std::pow(state, card.exponent.value) : 0.0;
}

/// Where the mixture jams that bears `pressure` over E at this solid fraction.
double onset_of(const CellCard& card, double solid_fraction, double pressure) {
  return onset_at(card.form, card.modulus.value, card.exponent.value, solid_fraction, pressure);
}

/// The test of a curve and its strains, without what the packing answered.
MacroCurve without_results(const MacroCurve& c) {
  MacroCurve out;
  out.test = c.test;
  out.boundary = c.boundary;
  out.sample = c.sample;
  out.start = c.start;
  out.preload = c.preload;
  out.stages = c.stages;
  out.strain = c.strain;
  out.stage = c.stage;
  out.strain_x = c.strain_x;
  out.strain_y = c.strain_y;
  out.strain_z = c.strain_z;
  out.solid_fraction = c.solid_fraction;
  out.coordination.assign(c.strain.size(), 0.0);  // of no bodies, all at rest
  out.residual.assign(c.strain.size(), 0.0);
  return out;
}

double solid_fraction_at(const MacroCurve& c, std::size_t point) {
  const double at_start = c.more.at(kSolidFraction).front();
  return at_start / ((1.0 - c.strain_x[point]) * (1.0 - c.strain_y[point]) * (1.0 - c.strain_z[point]));
}

}  // namespace

std::string known_preparation(const CellCard& card, const MacroSpec& spec) {
  const std::string own = to_string(spec.preparation);
  return void_ratio_factor(card, own) ? own : "";
}

double onset_by_card(const CellCard& card, double share, const std::string& preparation) {
  const FinesLaw law = fines_law_of(card, 1.0, preparation);
  const double coarse = 1.0 - share;
  const double pores = law.void_ratio * share + (coarse > 0.0 ? law.excess.volume(share, coarse) : 0.0);
  return 1.0 / (1.0 + pores);
}

MacroCurve mean_field(const CellCard& card, const MacroCurve& truth, double pressure, double onset) {
  MacroCurve out = without_results(truth);
  const double e = truth.start.youngs_modulus;
  if (std::isnan(onset)) onset = onset_of(card, truth.more.at(kSolidFraction).front(), pressure);
  for (std::size_t k = 0; k < truth.strain.size(); ++k) {
    const double p = e * pressure_at(card, state_of(card, solid_fraction_at(truth, k), onset));
    const bool alike = truth.strain_x[k] == truth.strain_z[k];
    const double ratio = alike ? 1.0 : card.lateral_ratio.value;
    const double axial = 3.0 * p / (1.0 + 2.0 * ratio);
    out.stress_axial.push_back(axial);
    out.stress_axial_contacts.push_back(axial);
    for (auto* column : {&out.stress_lateral, &out.stress_x, &out.stress_y}) column->push_back(ratio * axial);
    out.stress_deviator.push_back(axial - ratio * axial);
    out.more[kSolidFraction].push_back(solid_fraction_at(truth, k));
  }
  return out;
}

void map_by_state(const CellCard& card, const MacroCurve& truth, double pressure, MacroCurve& substitute) {
  const double onset_t = onset_of(card, truth.more.at(kSolidFraction).front(), pressure);
  const double onset_s = onset_of(card, substitute.more.at(kSolidFraction).front(), pressure);
  const std::size_t points = std::min(truth.strain.size(), substitute.strain.size());
  for (std::size_t k = 0; k < points; ++k) {
    const double own = pressure_at(card, state_of(card, solid_fraction_at(substitute, k), onset_s));
    // Along the strain of the substitute, so that both lose the same share of their volume.
    const double phi = truth.more.at(kSolidFraction).front() * solid_fraction_at(substitute, k) /
                       substitute.more.at(kSolidFraction).front();
    const double factor = own > 0.0 ? pressure_at(card, state_of(card, phi, onset_t)) / own : 1.0;
    for (std::vector<double>* column :
         {&substitute.stress_axial, &substitute.stress_axial_contacts, &substitute.stress_lateral, &substitute.stress_x,
          &substitute.stress_y, &substitute.stress_deviator})
      if (k < column->size()) (*column)[k] *= factor;
  }
}

}  // namespace softgrain
