#include "pipelines/law_table_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "calibrate/crowd_fit.h"
#include "common/data/crowd_law.h"
#include "pipelines/crowd_plan.h"
#include "pipelines/crowd_stage.h"
#include "pipelines/crowd_summary.h"
#include "pipelines/report/report.h"
#include "pipelines/run_summary.h"

namespace softgrain {

namespace {

constexpr std::int64_t kVariantPackings = 8;

/// The same measurement on looser or denser packings.
struct Variant {
  SoftParticleSpec spec;
  std::int64_t packings = 0;
};

struct LawTableScene {
  std::string title;
  CrowdSetup crowd;
  std::vector<Variant> variants;
  CrowdFitOptions fit;
};

Variant read_variant(const SceneTable& t, const CrowdSetup& base) {
  Variant v{base.spec, 0};
  v.spec.beta = t.number("beta", Unit::none, Range::positive(), v.spec.beta);
  v.spec.trials = t.count("trials", 1, 1000000000000, v.spec.trials);
  v.packings = t.count("packings", 2, base.packings_max, std::min(base.packings_min, kVariantPackings));
  if (v.spec.beta == base.spec.beta && v.spec.trials == base.spec.trials)
    t.reject("beta", "a variant needs another beta or another number of trials than [packing]");
  return v;
}

CrowdFitOptions read_fit(const SceneTable& t) {
  CrowdFitOptions o;
  o.discrepancy = t.number("discrepancy", Unit::none, Range{0.0, 1.0, true, false}, o.discrepancy);
  o.replicates = static_cast<int>(t.count("replicates", 0, 100000, o.replicates));
  o.min_packings = static_cast<int>(t.count("min_packings", 2, 100000, o.min_packings));
  return o;
}

LawTableScene read_law_table(const Scene& scene) {
  const SceneTable root = scene.root();
  (void)root.choice("kind", {"law-table"});
  LawTableScene out{root.text("title", ""), read_crowd_setup(root), {}, read_fit(root.table_or_empty("calibrate"))};
  for (const SceneTable& t : root.tables("variant")) out.variants.push_back(read_variant(t, out.crowd));
  const auto& all = out.crowd.configurations;
  if (std::none_of(all.begin(), all.end(), [](const CrowdConfiguration& c) {
        return c.partners.size() == 1 && c.partners[0].kind == PartnerKind::plane && !c.held_out && !c.centre_free;
      }))
    root.reject("configuration", "a law table needs one plane alone (arrangement \"one\", partner \"plane\")");
  root.finish();
  return out;
}

/// Configurations that only test the law are left to the main measurement.
CrowdSetup setup_of(const Variant& variant, const CrowdSetup& base) {
  CrowdSetup setup = base;
  setup.spec = variant.spec;
  setup.packings_min = setup.packings_max = variant.packings;
  std::erase_if(setup.configurations, [&](const CrowdConfiguration& c) {
    const auto softs = std::count_if(c.partners.begin(), c.partners.end(),
                                     [](const CrowdPartner& p) { return p.kind == PartnerKind::soft; });
    return c.held_out || c.centre_free || softs >= setup.packings_max;
  });
  return setup;
}

bool all_converged(const CrowdMeasurements& data) {
  for (const CrowdRun& run : data.runs)
    for (const CrowdPoint& p : run.points)
      if (!p.converged) return false;
  return true;
}

}  // namespace

namespace {

std::string law_line(const CrowdLaw& law, bool best) {
  return fmt::format(
      "  {}{}: off by {:.1f} % on what it was fitted to, {:.1f} % on what was held out, {:.1f} % leaving one out\n",
      law.form, best ? " (best)" : "", 100.0 * law.error_fitted, 100.0 * law.error_held_out, 100.0 * law.error_cross);
}

nlohmann::json estimate_json(const Estimate& e) {
  return {{"value", e.value}, {"standard_error", e.standard_error}, {"low", e.low}, {"high", e.high}};
}

nlohmann::json slide_json(const SlideLaw& s) {
  return {{"kt_ratio", estimate_json(s.kt_ratio)}, {"friction", estimate_json(s.friction)}};
}

nlohmann::json entry_json(const LawTableEntry& entry) {
  nlohmann::json out{{"solid_fraction", entry.solid_fraction},
                     {"packings", entry.packings},
                     {"best", entry.best},
                     {"volume_max", entry.volume_max},
                     {"overlap_max", entry.overlap_max},
                     {"grain_overlap_max", entry.grain_overlap_max},
                     {"slide_plane", slide_json(entry.slide_plane)},
                     {"slide_solid", slide_json(entry.slide_solid)},
                     {"slide_soft", slide_json(entry.slide_soft)},
                     {"retreat", estimate_json(entry.retreat)}};
  for (const CrowdLaw& law : entry.laws)
    out["laws"].push_back({{"form", law.form},
                           {"status", law.status},
                           {"error_fitted", law.error_fitted},
                           {"error_held_out", law.error_held_out},
                           {"error_cross", law.error_cross},
                           {"criterion", law.criterion},
                           {"a", estimate_json(law.a)},
                           {"b", estimate_json(law.b)},
                           {"delta", estimate_json(law.delta)},
                           {"m0", estimate_json(law.m0)},
                           {"m1", estimate_json(law.m1)},
                           {"m2", estimate_json(law.m2)}});
  return out;
}

/// Everything a run leaves behind, for summary and screen.
struct LawTableRun {
  CrowdMeasurements data;
  LawTable table;
  std::vector<std::string> remarks;
  bool usable = true;
};

void add_entry(LawTableRun& run, const CrowdMeasurements& data, const LawTableScene& setup, std::uint64_t seed) {
  CrowdFitOptions fit = setup.fit;
  fit.seed = seed;
  run.table.entries.push_back(fit_crowd_laws(data, fit));
  run.usable = run.usable && all_converged(data);
  for (const std::string& r : crowd_remarks(data, setup.crowd.target))
    run.remarks.push_back(fmt::format("solid fraction {:.3f}: {}", run.table.entries.back().solid_fraction, r));
  for (const CrowdLaw& law : run.table.entries.back().laws) {
    if (law.status == "good") continue;
    run.usable = run.usable && law.form != run.table.entries.back().best;
    run.remarks.push_back(law.form + " law: " + law.status + ": " + law.reason);
  }
}

void sort_entries(LawTable& table) {
  std::sort(table.entries.begin(), table.entries.end(),
            [](const LawTableEntry& a, const LawTableEntry& b) { return a.solid_fraction < b.solid_fraction; });
}

LawTableRun measure_and_fit(const LawTableScene& setup, const TaskStore& store, const RunContext& context,
                            const Provenance& provenance) {
  LawTableRun run;
  const std::uint64_t seed = context.seed(setup.crowd.seed);
  run.data = run_crowd_stage(setup.crowd, store, context, provenance, nullptr);
  add_entry(run, run.data, setup, seed);
  for (std::size_t k = 0; k < setup.variants.size(); ++k) {
    const Variant& v = setup.variants[k];
    context.say(fmt::format("variant {}: beta = {}, {} trials", k + 1, v.spec.beta, v.spec.trials));
    CrowdLevel named;  // nothing inside the soft particles, but a file of its own
    named.fill = [](const ShellPacking& packing, std::int64_t) { return SoftContent{packing, {}, {}}; };
    named.file = fmt::format("crowd_variant_{}.h5", k + 1);
    add_entry(run, run_crowd_stage(setup_of(v, setup.crowd), store, context, provenance, nullptr, &named), setup, seed);
  }
  sort_entries(run.table);
  save_law_table(run.table, context.path("law_table.toml"), provenance);
  return run;
}

nlohmann::json summarise(const LawTableScene& setup, const LawTableRun& run, const RunContext& context,
                         const Provenance& provenance, double seconds) {
  nlohmann::json summary;
  summary["status"] = run.usable ? "good" : "not usable";
  summary["title"] = setup.title;
  summary["seconds"] = seconds;
  summary["crowd"] = crowd_json(run.data, setup.crowd.target);
  for (const LawTableEntry& entry : run.table.entries) summary["entries"].push_back(entry_json(entry));
  summary["remarks"] = run.remarks;
  for (const char* file : {"crowd.h5", "law_table.toml", "law_table.h5", "report.html"})
    summary["files"][file] = context.path(file);
  summary["provenance"] = provenance_json(provenance);
  return summary;
}

std::string people_text(const LawTableRun& run, const RunContext& context, double seconds) {
  std::string text = fmt::format("{} configurations, {} runs:\n", run.data.configurations.size(), run.data.runs.size());
  text += crowd_text(run.data);
  for (const LawTableEntry& entry : run.table.entries) {
    text += fmt::format("laws at solid fraction {:.3f} ({} packings):\n", entry.solid_fraction, entry.packings);
    for (const CrowdLaw& law : entry.laws) text += law_line(law, law.form == entry.best);
  }
  for (const std::string& remark : run.remarks) text += "note: " + remark + "\n";
  return text + fmt::format("{:.0f} s; law table: {}; report: {}", seconds, context.path("law_table.toml"),
                            context.path("report.html"));
}

}  // namespace

ExitStatus run_law_table(const Scene& scene, const CommonOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const LawTableScene setup = read_law_table(scene);
  const RunContext context(options, "run", std::filesystem::path(scene.path()).stem().string());
  const std::uint64_t seed = context.seed(setup.crowd.seed);
  const Provenance provenance = context.provenance(scene, seed);
  const TaskStore store(context, scene, seed);
  LawTableRun run;
  context.guard([&] { run = measure_and_fit(setup, store, context, provenance); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  context.finish(summarise(setup, run, context, provenance, seconds), people_text(run, context, seconds));
  write_report(context.directory());
  store.clear();
  return run.usable ? ExitStatus::good : ExitStatus::not_usable;
}

void check_law_table(const Scene& scene, nlohmann::json& facts, std::string& lines) {
  const CrowdSetup setup = read_law_table(scene).crowd;
  const auto configurations = static_cast<std::int64_t>(setup.configurations.size());
  std::int64_t increments = 0;
  std::int64_t stages = 0;
  for (const CrowdConfiguration& c : setup.configurations) {
    increments += count_increments(c, CrowdPlan(c.stages.size(), {1.0}), setup.options);
    stages += static_cast<std::int64_t>(c.stages.size());
  }
  facts["configurations"] = configurations;
  facts["runs_min"] = configurations * setup.packings_min;
  facts["runs_max"] = configurations * setup.packings_max;
  facts["points_per_packing"] = stages * setup.points;
  facts["relaxations_per_packing"] = increments;
  lines += fmt::format("  {} configurations on {} to {} packings: {} to {} runs\n", configurations, setup.packings_min,
                       setup.packings_max, configurations * setup.packings_min, configurations * setup.packings_max);
  lines +=
      fmt::format("  per packing: up to {} recorded states, about {} relaxations\n", stages * setup.points, increments);
}

}  // namespace softgrain
