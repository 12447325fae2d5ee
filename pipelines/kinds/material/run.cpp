#include "pipelines/kinds/material/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/io/text_file.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro/twin_cache.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

NamedLaws no_soft_laws() {
  NamedLaws laws;
  laws.name = kMaterialEngine;
  laws.laws = pair_soft_laws({}, {}, 0.0);
  return laws;
}

namespace {

/// A scene without variants has one name, which says nothing.
std::string file_of(const std::string& name, const std::string& kind) {
  return name == kMaterialEngine ? kind + ".h5" : kind + "_" + name + ".h5";
}

const std::string& packings_name(const MaterialVariant& v) { return v.packings.empty() ? v.name : v.packings; }

std::string folder_of(const MaterialVariant& v) { return v.name == kMaterialEngine ? "lammps" : "lammps-" + v.name; }

LammpsRuns lammps_runs(const MaterialScene& scene, const MaterialVariant& v, const NamedLaws& laws, const Run& run) {
  return {v.setup, laws, 1.0, scene.title, lammps_identity(run.provenance, v.name), v.name, folder_of(v)};
}

using Packings = std::shared_ptr<const std::vector<MacroPacking>>;

/// Packings as they are handed to a test: in contact, or with preparation "lammps" only placed. A failure says what to
/// do.
Packings packings_of(const MaterialVariant& v, const std::string& title, const Run& run) {
  const std::string file = file_of(packings_name(v), "material_initial");
  try {
    auto packings =
        std::make_shared<const std::vector<MacroPacking>>(prepare_packings(v.setup, run, file, title + ": preparing"));
    if (v.setup.spec.preparation != Preparation::lammps) save_packings(*packings, run, file);
    return packings;
  } catch (const DensityNotReached&) {  // says what to do
    throw;
  } catch (const UnusableResult& e) {
    throw UnusableResult(std::string(e.what()) +
                         "; more preparation_passes, a larger preparation_tolerance or another seed may do");
  } catch (const InputError& e) {  // the cell became too small for its grains
    throw UnusableResult(std::string(e.what()) + "; more grains (count) make a larger cell");
  }
}

/// What LAMMPS prepared is that of this test alone: others begin where bodies were placed.
std::vector<RunOutcome> outcomes_of_lammps(const MaterialScene& scene, const MaterialVariant& v,
                                           const LammpsEngine& lammps, const Run& run,
                                           std::vector<MacroPacking> packings) {
  const NamedLaws laws = no_soft_laws();
  const LammpsRuns runs = lammps_runs(scene, v, laws, run);
  write_lammps_files(runs, packings, run.context);
  auto outcomes = run_with_lammps(runs, lammps, packings, run.context);
  if (v.setup.spec.preparation == Preparation::lammps && !v.same_packings)
    save_packings(packings, run, file_of(packings_name(v), "material_initial"));
  return outcomes;
}

/// Curves of all samples: from --law-cache, or run now and kept there when all are usable; pictures want a run.
std::vector<MacroCurve> kept_tests(const MacroRuns& runs, const Run& run,
                                   const std::function<std::vector<MacroCurve>()>& go) {
  const std::string& directory = run.context.law_cache();
  if (directory.empty() || runs.setup.kept_states > 0) return go();
  const std::size_t samples = runs.packings.size();
  const KeptForm<std::vector<MacroCurve>> form{
      "material test",
      "material",
      "tested again",
      [samples](const h5::Group& g) {
        std::vector<MacroCurve> curves;
        for (std::size_t k = 0; k < samples; ++k)
          curves.push_back(read_macro_curve(g.open(fmt::format("sample_{}", k))));
        return curves;
      },
      [](const h5::Group& g, const std::vector<MacroCurve>& curves) {
        for (std::size_t k = 0; k < curves.size(); ++k)
          write_macro_curve(g.create(fmt::format("sample_{}", k)), curves[k]);
      },
      [](const std::vector<MacroCurve>& curves) {
        return std::ranges::all_of(curves, [](const MacroCurve& c) { return c.usable; });
      }};
  std::string key;
  for (std::size_t k = 0; k < samples; ++k) key += test_key(runs.setup, runs.packings[k], static_cast<std::int64_t>(k));
  return run.get_or_make(form, "", directory, key, go);
}

VariantResult run_variant(const MaterialScene& scene, const MaterialVariant& v,
                          const std::optional<LammpsEngine>& lammps, const Run& run,
                          const std::vector<MacroPacking>& packings) {
  VariantResult r{&v, file_of(v.name, "material"), {}, nullptr};
  const std::string title = packing_title(scene.variants, v);
  const MacroRuns runs{v.setup, packings, {}, run.seed, v.name, title + ": testing"};
  const std::string states = file_of(v.name, "states_material");
  r.curves = lammps ? run_engines(runs, {}, run, states, outcomes_of_lammps(scene, v, *lammps, run, packings))
                    : kept_tests(runs, run, [&] { return run_engines(runs, {no_soft_laws()}, run, states); });
  for (std::size_t k = 0; k < r.curves.size(); ++k) {
    r.curves[k].law = {};
    r.curves[k].density = packings[k].density;  // a kept test may be of another target that the same packing met
  }
  save_macro(r.curves, run.path(r.file), run.provenance);
  return r;
}

std::optional<MeanError> mean_at_start(const std::vector<MacroCurve>& curves,
                                       const std::function<const std::vector<double>&(const MacroCurve&)>& column) {
  std::vector<double> values;
  for (const MacroCurve& c : curves)
    if (c.usable && !column(c).empty()) values.push_back(column(c).front());
  return values.empty() ? std::nullopt : std::optional(mean_error(values));
}

MaterialVariantSummary summary_of(const VariantResult& r) {
  const MacroSpec& spec = r.variant->setup.spec;
  MaterialVariantSummary s;
  s.name = r.variant->name;
  s.file = r.file;
  s.grains = spec.bodies;
  s.youngs_modulus = spec.youngs_modulus;
  s.size_ratio = spec.solid_polydispersity;
  s.preparation = spec.preparation;
  s.friction = spec.friction;
  if (spec.rolling.friction > 0.0) s.rolling_friction = spec.rolling.friction;
  const auto more = [&](const char* name) {
    return mean_at_start(r.curves,
                         [name](const MacroCurve& c) -> const std::vector<double>& { return c.more.at(name); });
  };
  s.solid_fraction_start = more(kSolidFraction);
  s.rattlers_start = more(kRattlers);
  s.coordination_start =
      mean_at_start(r.curves, [](const MacroCurve& c) -> const std::vector<double>& { return c.coordination; });
  s.runs = softgrain::summary_of(r.curves, kMaterialEngine);
  return s;
}

void require_engine(const MaterialScene& scene, const std::optional<LammpsEngine>& lammps) {
  for (const MaterialVariant& v : scene.variants)
    if (v.setup.spec.preparation == Preparation::lammps && !lammps)
      throw InputError("key packing.preparation = \"lammps\" needs --engine lammps");
  if (!lammps) return;
  for (const MaterialVariant& v : scene.variants) {
    refuse_sliding(v.setup.spec);
    if (!v.setup.spec.grain_materials.empty())
      throw InputError(
          "--engine lammps: its grains have one E, nu and mu; [[constituent]] with their own are run without --engine");
  }
}

}  // namespace

namespace {

/// The tests that a packing was meant for, from its first variant on: "a, b".
std::string tests_of(const std::vector<MaterialVariant>& variants, const MaterialVariant& first) {
  std::string names = first.name;
  for (auto v = static_cast<std::size_t>(&first - variants.data()) + 1; v < variants.size(); ++v) {
    if (!variants[v].same_packings) break;
    names += ", " + variants[v].name;
  }
  return names;
}

}  // namespace

std::string packing_title(const std::vector<MaterialVariant>& variants, const MaterialVariant& of) {
  const auto own = [](const MaterialVariant& v) { return !v.same_packings; };
  const std::int64_t all = std::ranges::count_if(variants, own);
  if (variants.size() < 2) return of.name;
  const std::int64_t number = std::count_if(variants.data(), &of + 1, own);
  return fmt::format("packing {} of {}, {}", number, all, of.name);
}

VariantRuns run_variants(const MaterialScene& scene, const Run& run, const VariantOptions& options) {
  require_engine(scene, options.lammps);
  VariantRuns out;
  const auto failed = [&](const MaterialVariant& v, const std::string& of, const std::string& problem) {
    out.failures.push_back({&v, (of == kMaterialEngine ? "" : of + ": ") + problem});
    run.context.say(out.failures.back().problem);
  };
  const auto prepared = [&](const MaterialVariant& v) -> Packings {
    try {
      return packings_of(v, packing_title(scene.variants, v), run);
    } catch (const UnusableResult& e) {
      const std::string tests = tests_of(scene.variants, v);
      failed(v, packings_name(v) == kMaterialEngine ? kMaterialEngine : "packing " + packings_name(v),
             e.what() + (tests == packings_name(v) ? "" : "; not tested: " + tests));
      return nullptr;
    }
  };
  const auto test = [&](const MaterialVariant& v, const Packings& packings) {
    try {
      out.results.push_back(run_variant(scene, v, options.lammps, run, *packings));
      if (options.packings) out.results.back().packings = packings;
    } catch (const UnusableResult& e) {
      failed(v, v.name, e.what() + std::string("; another seed or more grains (count) may do"));
    }
  };
  run.guard([&] {
    Packings packings;
    for (const MaterialVariant& v : scene.variants) {
      if (!v.same_packings) packings = prepared(v);
      if (packings) test(v, packings);
    }
    if (out.results.empty()) throw UnusableResult(out.failures.front().problem);
  });
  return out;
}

void reject_failures(const std::vector<VariantFailure>& failures, SummaryHead& head) {
  for (const VariantFailure& f : failures) head.mark_unusable(f.problem);
}

namespace {

/// Beside the stresses of the axes; the shear strain of tests that slide.
constexpr std::array kShearColumns{&MacroCurve::stress_xy, &MacroCurve::stress_xz, &MacroCurve::stress_yz,
                                   &MacroCurve::stress_asymmetry, &MacroCurve::shear_strain};

/// Empty where it was not recorded, as by LAMMPS.
std::string cell_of(const std::vector<double>& column, std::size_t k) {
  return k < column.size() ? fmt::format("{:.8g}", column[k]) : "";
}

}  // namespace

TextTable points_of(const std::vector<VariantResult>& results) {
  TextTable table{{"variant", "sample", "stage", "strain_x", "strain_y", "strain_z", "stress_x [Pa]", "stress_y [Pa]",
                   "stress_z [Pa]", "p/E", "q/p", "coordination", "residual"},
                  {}};
  for (const auto& [name, values] : results.front().curves.front().more) table.header.push_back(name);
  for (const auto column : kShearColumns) table.header.push_back(macro_column(column).header());
  for (const MacroTensor& tensor : kMacroTensors)
    for (std::size_t k = 0; k < kTensorComponents.size(); ++k) table.header.push_back(tensor.of(k));
  for (const VariantResult& r : results)
    for (const MacroCurve& c : r.curves) {
      const std::vector<double> p = mean_stresses(c);
      const std::vector<double> ratio = stress_ratios(c);
      for (std::size_t k = 0; k < c.strain.size(); ++k) {
        std::vector<std::string> row{r.variant->name, std::to_string(c.sample),
                                     c.stages[static_cast<std::size_t>(c.stage[k])].name};
        for (const double x :
             {c.strain_x[k], c.strain_y[k], c.strain_z[k], c.stress_x[k], c.stress_y[k], c.stress_axial[k],
              p[k] / c.start.youngs_modulus, ratio[k], c.coordination[k], c.residual[k]})
          row.push_back(std::isfinite(x) ? fmt::format("{:.8g}", x) : "");
        for (const auto& [name, values] : c.more) row.push_back(fmt::format("{:.6g}", values[k]));
        for (const auto column : kShearColumns) row.push_back(cell_of(c.*column, k));
        for (const MacroTensor& tensor : kMacroTensors)
          for (const std::vector<double>& component : c.*tensor.values) row.push_back(cell_of(component, k));
        table.rows.push_back(std::move(row));
      }
    }
  return table;
}

namespace {

/// Empty where variants differ in it.
std::optional<double> common_modulus(const MaterialScene& scene) {
  const double first = scene.variants.front().setup.spec.youngs_modulus;
  for (const MaterialVariant& v : scene.variants)
    if (v.setup.spec.youngs_modulus != first) return std::nullopt;
  return first;
}

std::optional<EquationResult> equation(const MaterialScene& scene, const std::vector<VariantResult>& results,
                                       std::uint64_t seed) {
  std::vector<EquationInput> inputs;
  for (const VariantResult* r : first_compressed(results)) {
    const MacroSpec& spec = r->variant->setup.spec;
    inputs.push_back({r->variant->name, spec.solid_polydispersity, family_of(*r->variant, scene.variants), r->curves,
                      exponent_of(spec).value_or(0.0)});
  }
  return equation_of(inputs, scene.equation, seed);
}

std::vector<PredictionInput> prediction_inputs(const MaterialScene& scene, const std::vector<VariantResult>& results) {
  std::vector<PredictionInput> inputs;
  for (const VariantResult& r : results) {
    const MacroSpec& spec = r.variant->setup.spec;
    inputs.push_back({packings_name(*r.variant), spec.solid_polydispersity, material_family(*r.variant, scene.variants),
                      r.variant->loading, test_family(*r.variant, scene.variants), exponent_of(spec).value_or(0.0),
                      spec.start_pressure, r.curves});
  }
  return inputs;
}

std::string equation_text(const EquationSummary& s) {
  if (!s.usable) return "equation of state: not usable: " + s.message + "\n";
  std::string text =
      fmt::format("equation of state, {} form: K = {}, n = {}; pressures follow it to {:.2g} %\n", to_string(s.form),
                  interval_text(s.modulus), interval_text(s.exponent), 100.0 * s.pressure_deviation);
  if (s.message != "fitted") text += "  " + s.message + "\n";
  for (const OnsetSummary& o : s.onsets)
    text += fmt::format("  {}: phi_J = {}, K by itself {:.4g}\n", o.name, interval_text(o.onset), o.own_modulus);
  for (const KnownOnset& k : s.known)
    text += fmt::format("  span {:g}, measured elsewhere: phi_J = {}\n", k.span, with_error(k.value, k.standard_error));
  if (s.onsets.size() > 1)
    text += fmt::format(
        "  K of variants scatters by {:.2g} %; as much or more has a probability of {:.2g} if there is one K\n",
        100.0 * s.modulus_scatter, s.collapse_probability);
  for (const ExtrapolationSummary& e : s.extrapolations)
    text += fmt::format("  {}, span {:g}: {}{}\n", e.family, e.span,
                        e.onset ? "phi_J = " + interval_text(*e.onset) : "not extrapolated: " + e.message,
                        e.measured ? ", measured " + interval_text(*e.measured) : "");
  return text;
}

}  // namespace

std::string console_summary(const MaterialSummary& s) {
  std::string text;
  for (const MaterialVariantSummary& v : s.variants) {
    text += fmt::format("{}: {} of {} grains", v.name, counted(v.runs.samples, "sample"), v.grains);
    if (v.solid_fraction_start)
      text += fmt::format(", solid fraction {} at the start",
                          with_error(*v.solid_fraction_start, {.value = {4, true}, .error = {4, true}}));
    text += "\n";
    if (v.runs.density) text += "  " + density_text(*v.runs.density) + "\n";
    for (const StageMeans& m : v.runs.stages) {
      if (m.axial_end && m.ratio_end)
        text += fmt::format(
            "  {}: axial stress {} ({:.4g} E), lateral {}{}, q/p {:.3f}{}\n", m.record.name,
            pressure_text(m.axial_end->mean, 4), m.axial_end->mean / modulus_of(s, v),
            pressure_text(m.lateral_end->mean, 4),
            m.lateral_ratio ? ", K0 " + with_error(*m.lateral_ratio, {.value = {3}}) : "", m.ratio_end->mean,
            m.friction_end ? fmt::format(", shear over normal stress {:.3f}", m.friction_end->mean) : "");
      if (const std::string modulus = modulus_text(m); !modulus.empty()) text += "    " + modulus + "\n";
    }
  }
  return text + (s.equation ? equation_text(*s.equation) : "") + prediction_text(s.predictions);
}

MaterialOutcome summarise(const MaterialScene& scene, const std::vector<VariantResult>& results, const Run& run) {
  MaterialOutcome out;
  MaterialSummary& s = out.summary;
  s.head.title = scene.title;
  s.youngs_modulus = common_modulus(scene);
  for (const VariantResult& r : results) {
    s.variants.push_back(summary_of(r));
    s.head.files[r.variant->name] = run.path(r.file);
    if (std::string text = negative_tangents_text(tangents_of(s.variants.back().runs.stages),
                                                  results.size() > 1 ? r.variant->name + "," : "");
        !text.empty())
      s.head.warnings.push_back(std::move(text));
    for (const MacroCurve& c : r.curves)
      if (!c.usable || !(c.stress_axial.back() > 0.0))
        s.head.mark_unusable(fmt::format("{}, sample {}: {}", r.variant->name, c.sample,
                                         c.note.empty() ? "bears no stress at its end" : c.note));
    if (r.variant->same_packings) continue;
    for (const SizesSummary& sizes : summaries_of(drawn_sizes(
             r.variant->setup, run.seed, scene.variants.size() > 1 ? packings_name(*r.variant) + ": " : "")))
      s.head.sizes.push_back(sizes);
  }
  if (std::optional<EquationResult> found = equation(scene, results, run.seed)) {
    s.equation = std::move(found->summary);
    out.states = std::move(found->fit);
  }
  const std::vector<PredictionInput> inputs = prediction_inputs(scene, results);
  s.predictions = predict_spans(inputs, scene.equation, run.seed);
  if (!s.equation && scene.equation.asked)
    s.head.remarks.push_back("no equation of state ([equation]): no sample was compressed over four recorded points");
  if (s.equation)
    for (const std::string& remark : prediction_remarks(inputs, s.predictions, scene.equation))
      s.head.remarks.push_back(remark);
  if (s.equation)
    for (std::string& warning : extrapolation_warnings(*s.equation)) s.head.warnings.push_back(std::move(warning));
  if (s.equation && !s.equation->usable)
    s.head.remarks.push_back("the equation of state is not usable: " + s.equation->message);
  else if (s.equation && s.equation->message != "fitted")
    s.head.remarks.push_back("equation of state: " + s.equation->message);
  s.head.files["points"] = run.path("material.csv");
  s.head.files["report"] = run.path("report.html");
  return out;
}

std::vector<const VariantResult*> first_compressed(const std::vector<VariantResult>& results) {
  std::vector<const VariantResult*> out;
  bool found = false;
  for (const VariantResult& r : results) {
    found = found && r.variant->same_packings;
    if (found || std::ranges::none_of(r.curves, takes_part)) continue;
    found = true;
    out.push_back(&r);
  }
  return out;
}

std::array<double, 2> pressure_range(const std::vector<VariantResult>& results) {
  std::array<double, 2> range{kInfinity, 0.0};
  for (const VariantResult* r : first_compressed(results))
    for (const MacroCurve& c : r->curves)
      for (const double p : state_curve(c, r->variant->name, 1.0).pressure) {
        if (p > 0.0) range[0] = std::min(range[0], p);
        range[1] = std::max(range[1], p);
      }
  return range;
}

std::string sizes_text(const MaterialScene& scene) {
  std::string text;
  for (const MaterialVariant& v : scene.variants) text += sizes_text(v.setup.spec);
  return text;
}

namespace {

void add_directories(const MaterialVariant& v, const Run& run, MaterialSummary& summary) {
  for (std::int64_t k = 0; k < v.setup.samples; ++k)
    summary.head.files[fmt::format("lammps_{}_{}", v.name, k)] = lammps_directory(run.context, k, folder_of(v));
}

/// The input of LAMMPS, to be run elsewhere or with --resume; the packings stay in the store for that.
ExitStatus write_only(const MaterialScene& scene, const Run& run) {
  const NamedLaws laws = no_soft_laws();
  Packings packings;
  run.guard([&] {
    for (const MaterialVariant& v : scene.variants) {
      if (!v.same_packings) packings = packings_of(v, packing_title(scene.variants, v), run);
      write_lammps_files(lammps_runs(scene, v, laws, run), *packings, run.context);
    }
  });
  MaterialSummary summary;
  summary.head = {RunStatus::written, scene.title, {"nothing was run"}, {}};
  summary.youngs_modulus = common_modulus(scene);
  for (const MaterialVariant& v : scene.variants) add_directories(v, run, summary);
  std::string directories;
  for (const auto& [name, directory] : summary.head.files) append_part(directories, directory, ", ");
  run.context.finish(json_of(summary), run.provenance, written_text(directories));
  return ExitStatus::good;
}

ExitStatus run_material(const Scene& scene, const CommonOptions& options) {
  const MaterialScene material = read_material_scene(scene);
  const auto fewest = std::min_element(material.variants.begin(), material.variants.end(),
                                       [](auto& a, auto& b) { return a.setup.spec.bodies < b.setup.spec.bodies; });
  const std::optional<LammpsEngine> lammps = read_engine(options, fewest->setup.spec.bodies);
  require_engine(material, lammps);
  const Run run(scene, options, "run", {.seed = material.seed, .text = sizes_text(material)});
  if (lammps && lammps->write_only) return write_only(material, run);
  const auto [results, failures] = run_variants(material, run, {.lammps = lammps});
  MaterialSummary summary = summarise(material, results, run).summary;
  const MacroSpec& spec = material.variants.front().setup.spec;
  if (const std::string text = materials_text(spec.grain_materials, spec.youngs_modulus); !text.empty())
    summary.head.remarks.push_back(text);
  reject_failures(failures, summary.head);
  if (lammps) {
    const MaterialVariant& first = *results.front().variant;
    summary.engine = engine_use(*lammps, lammps_directory(run.context, 0, folder_of(first)));
    for (const VariantResult& r : results) add_directories(*r.variant, run, summary);
  }
  write_text_atomic(run.path("material.csv"), as_csv(points_of(results)));
  return run.finish(json_of(summary), console_summary(summary));
}

void check_material(const Scene& scene, const CommonOptions&, Findings& out) {
  const MaterialScene material = read_material_scene(scene);
  const MacroSpec& spec = material.variants.front().setup.spec;
  if (const std::string text = materials_text(spec.grain_materials, spec.youngs_modulus); !text.empty())
    out.add("E", spec.youngs_modulus, text);
  check_variants(material, out);
}

/// As SceneKind::starter.
constexpr const char* kMaterialStarter = R"(title = "Compression of a graded packing"
seed = 1
samples = 2
[grains]
count = 200
ratio = 2.0
[packing]
preparation = "fast"
[test]
test = "oedometric"
strain = 0.1
steps = 10
)";

}  // namespace

SceneKind material_kind() {
  return {.name = "material",
          .command = "run",
          .run = run_material,
          .check = check_material,
          .read = [](const Scene& scene) { (void)read_material_scene(scene); },
          .results = material_results(),
          .summary = members_of<MaterialSummary>,
          .takes_engine = true,
          .keeps = {.measurements = true, .packings = true},
          .explored_from = {"", explored_stages(), explored_stages("loading"), explored_stages("variant")},
          .starter = kMaterialStarter};
}

}  // namespace softgrain
