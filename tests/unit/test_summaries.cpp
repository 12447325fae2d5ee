// Summaries of all kinds: what was written comes back, and what others wrote in its place is no trouble.
#include <gtest/gtest.h>

#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/kinds/hierarchy/summary.h"
#include "pipelines/kinds/inverse/summary.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/kinds/macro_comparison/summary.h"
#include "pipelines/kinds/particles/scene.h"
#include "pipelines/kinds/particles/summary.h"
#include "pipelines/law/law_fit.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/sections.h"

namespace softgrain {
namespace {

using nlohmann::json;

SummaryHead head() { return {RunStatus::not_usable, "title", {"a remark"}, {{"file", "path"}}}; }

HierarchySummary hierarchy() {
  HierarchySummary s;
  s.head = head();
  s.levels.resize(2);
  s.levels[1].level = 1;
  s.levels[1].grain_percent = 45.0;
  s.levels[1].solid_percent = 58.0;
  s.levels[1].inner = InnerSummary{4.0, 0.1, 0.2, 3.0, 0.3};
  s.levels[1].error_percent = 4.0;
  s.levels[1].own_error_percent = 3.0;
  s.levels[1].sensitivity = Sensitivity{0.4, 0.05};
  s.levels[1].law.parameters = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  s.levels[1].curves = {{0.1, 0.2}, {1.0, 2.0}, {3.0, 4.0}};
  s.levels[1].distance_percent = 2.5;
  s.levels[1].changes = {{"one", 1.1, 0.1}};
  s.fixed_point = FixedPoint{true, "text", 1};
  s.check = CheckSummary{};
  s.check->result.points.resize(1);
  return s;
}

InverseSummary inverse() {
  InverseSummary s;
  s.head = head();
  s.inverse = SearchSummary{};
  s.inverse->parameters = {{"mu", 0.3, {{0.2, 0.4}}, 0.05, true, {{0.0, 1.0}}, false}};
  s.inverse->target = {{0.1}, {2.0}, {0.1}, 0.04};
  s.inverse->confirmed = {{2.1}, {0.2}, 8, 1.1, {7}};
  s.inverse->evaluations = {{{0.3}, kNaN, {2.2}}};
  return s;
}

PowderSummary powder() {
  PowderSummary s;
  s.head = head();
  s.samples.resize(1);
  PackSummary& pack = s.samples[0];
  pack.contacts.shares = {0.1, 0.9};
  pack.analysis.rigidity = PowderRigidity{};
  pack.analysis.rigidity->backbone = Rigidity{};
  pack.scattering = ScatteringFit{};
  pack.scattering->covariance.assign(16, 1.0);
  pack.scattering->dimension = {1.9, 0.1, 1.7, 2.1};
  pack.holes = PowderHoles{};
  s.seconds = {1.5};
  s.statistics = {{"z", 3.0}};
  s.scattering = EnsembleFit{*pack.scattering, {*pack.scattering}};
  return s;
}

PowderVariantsSummary variants() {
  PowderVariantsSummary s;
  s.variants.resize(1);
  s.variants[0].name = "rough";
  s.variants[0].values["Phi"] = {0.7, 0.01, 4, 0.005};
  s.variants[0].published["Phi"] = {0.71, kNaN};
  s.variants[0].difference["Phi"] = {-0.01, kNaN};
  return s;
}

MacroRunSummary macro() {
  MacroRunSummary s;
  s.head = head();
  s.law = RunLaw{{LawForm::pair, 0.7, 5e5, 0.3, {}, "hash"}, "law.toml"};
  s.runs.macro = EngineSummary{};
  s.runs.comparison = ComparisonSummary{};
  s.runs.comparison->samples.resize(1);
  s.engine = EngineUse{MacroEngine::lammps, 4, "lmp", "2021"};
  return s;
}

ParticlesSummary particles() {
  ParticlesSummary s;
  s.head = head();
  s.particles = {{0, {1.0, 2.0}, {3.0, 4.0}, {5.0}}};
  s.contacts = std::vector<PairSummary>{{{0, "wall"}, 1, 2.0, 3.0, 4.0}};
  return s;
}

ExperimentSummary experiment() {
  ExperimentSummary s;
  s.head = head();
  PairLawSummary& law = s.laws["soft-solid"];
  law.parts.normal = LawNumbers{};
  law.parts.normal->a = {1.0, 0.1, 0.8, 1.2};
  s.experiment = {{PairKind::soft_soft, "a", {0.1}, {1.0}, {kNaN}, 5, 0}};
  return s;
}

/// Calls with the value at every place in it replaced by something of another kind, or gone.
void damage(json& whole, json& at, const std::function<void(const json&)>& look) {
  for (const json& other : {json(), json(true), json(-7), json(1e300), json("text"),
                            json::array({json(), "x", json::object()}), json{{"a", 1}}}) {
    const json before = std::exchange(at, other);
    look(whole);
    at = before;
  }
  if (at.is_structured())
    for (json& inner : at) damage(whole, inner, look);
}

/// `section`: of the report, drawn of every damaged summary.
template <class Summary>
void expect_lasting(const Summary& summary, std::string (*section)(const report::RunData&) = nullptr) {
  json written = json_of(summary);
  EXPECT_EQ(json_of(record_of<Summary>(json::parse(written.dump()))).dump(), written.dump());
  std::size_t looks = 0;
  damage(written, written, [&](const json& damaged) {
    (void)json_of(record_of<Summary>(damaged));
    (void)record_of<AnySummary>(damaged);
    report::RunData run;
    run.summary = damaged;
    if (section != nullptr) (void)section(run);
    (void)report::heading_section(run);
    (void)report::provenance_section(run);
    ++looks;
  });
  EXPECT_GT(looks, 50U);
}

TEST(Summaries, OfHierarchiesLast) { expect_lasting(hierarchy(), report::hierarchy_section); }
TEST(Summaries, OfSearchesLast) { expect_lasting(inverse(), report::inverse_section); }
/// Of few packings the mean is known by Student's t, of one not at all.
TEST(Summaries, TheConfirmedCurveIsAsSureAsItsPackingsAreMany) {
  const ConfirmedCurve c{{2.0, 2.0, 2.0}, {0.1, 0.1, 0.0}, 8, 1.0, {8, 2, 1}};
  EXPECT_NEAR(c.interval(0).second, 2.0 + 0.1 * student95(7.0), 1e-12);
  EXPECT_NEAR(c.interval(1).first, 2.0 - 0.1 * student95(1.0), 1e-12);
  EXPECT_TRUE(std::isnan(c.interval(2).first) && std::isnan(c.interval(2).second));
  const ConfirmedCurve earlier{{2.0}, {0.1}, 8, 1.0};
  EXPECT_EQ(earlier.interval(0), c.interval(0));
}

TEST(Summaries, OfVariantsLast) { expect_lasting(variants(), report::powder_variants_section); }
TEST(Summaries, OfMacroRunsLast) { expect_lasting(macro(), report::cost_section); }
TEST(Summaries, OfParticlesLast) { expect_lasting(particles(), report::particles_section); }

/// Whatever else there is to say of the run: here a number that no law uses.
TEST(Summaries, OfParticlesThatAreLostSayItFirst) {
  const ParticlesScene scene = read_particles_scene(Scene::parse(R"(kind = "particles"
[material.glass]
density = 2500.0
E = "1 GPa"
nu = 0.2
[[contact]]
pair = ["glass", "glass"]
law = "linear-spring"
normal_stiffness = 1000.0
restitution = 1.0
mu = 0.0
[[particle]]
material = "glass"
radius = 0.001
position = [0.0, 0.0, 0.0]
velocity = [1000.0, 0.0, 0.0]
[time]
end = 0.002
step = 2e-6
)",
                                                                 "lost.toml"));
  ASSERT_FALSE(scene.remarks.empty());
  const auto known = record_of<AnySummary>(json_of(summary_of(scene, run_particles(scene, {}), 0.0)));
  EXPECT_EQ(known.status, "not usable");
  ASSERT_EQ(warnings_of(known).size(), 1 + scene.remarks.size());
  EXPECT_NE(warnings_of(known).front().find("is lost"), std::string::npos) << warnings_of(known).front();
}
TEST(Summaries, OfExperimentsLast) { expect_lasting(experiment(), report::laws_section); }

/// Stresses of disks are forces per length, shares of their sizes are of the area; more particles than are listed.
TEST(Summaries, OfDisksHaveTheirUnits) {
  ParticlesSummary s;
  s.dimension = 2;
  s.particle_count = 1331;
  s.particles.resize(60);
  s.contact_state = {{"pressure", 2.0}};
  SizesSummary sizes;
  sizes.dimension = 2;
  sizes.unit = "m";
  sizes.diameter = {1.0, 2.0};
  sizes.asked = sizes.obtained = {0.0, 1.0};
  s.head.sizes = {sizes};
  report::RunData run;
  run.summary = json_of(s);
  for (const RunValue& value : particles_results().values(run))
    EXPECT_EQ(value.unit, value.name == "pressure" ? "N/m" : value.name.starts_with("kinetic") ? "J" : "");
  EXPECT_NE(report::particles_section(run).find("The first 50 of 1331."), std::string::npos);
  const std::string drawn = report::sizes_section(run);
  EXPECT_NE(drawn.find("% of the area"), std::string::npos);
  EXPECT_EQ(drawn.find("% of the volume"), std::string::npos);
}

TEST(Summaries, OfPowdersLast) {
  // A fit that is read has numbers or none; the covariance, which says so when it is written, stays in powder.h5.
  PowderSummary s = powder();
  const json written = json_of(s);
  const auto back = record_of<PowderSummary>(written);
  EXPECT_EQ(back.samples[0].scattering->dimension.low, 1.7);
  EXPECT_EQ(back.scattering->other_ranges.at(0).dimension.error, 0.1);
  EXPECT_EQ(back.samples[0].analysis.rigidity->backbone->freedoms, 0);
  s.scattering.reset();
  s.samples[0].scattering.reset();
  expect_lasting(s);
}

TEST(Summaries, OfComparedScenesNameTheirCurves) {
  ComparedScenes s;
  s.scenes = {{"a", {}, MacroTest::shear, Construction::mixed, 0.3, "macro_a.h5", std::vector<SceneFacts>(1), {}}};
  s.scenes[0].samples[0].solid = 12;
  const auto back = record_of<ComparedScenes>(json_of(s));
  ASSERT_EQ(back.scenes.size(), 1U);
  EXPECT_EQ(back.scenes[0].file, "macro_a.h5");
  EXPECT_EQ(back.scenes[0].test, MacroTest::shear);
  EXPECT_EQ(back.scenes[0].samples.at(0).solid, 12);
}

}  // namespace
}  // namespace softgrain
