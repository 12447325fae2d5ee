// A run that is taken up at any moment at which it can be saved, between recorded points too, ends in the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/contact/make_laws.h"
#include "common/state/system_io.h"
#include "macrosim/compression.h"
#include "macrosim/preparation.h"
#include "microsim/measure.h"
#include "microsim/shell_packing.h"
#include "tests/support/multi_contact.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

void expect_same(const Cost& a, const Cost& b) {
  EXPECT_EQ(a.loop_passes, b.loop_passes);
  EXPECT_EQ(a.contact_evaluations, b.contact_evaluations);
}

TEST(RestartBetweenPoints, AMultiContactGoesOnFromEveryIncrement) {
  const SoftParticleSpec spec = coarse_spec();
  MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, {{{1.0, 0.0, 0.0}}, {{-1.0, 0.0, 0.0}}}, 0.2);
  c.stages.push_back({MultiContactMove::unload, {0.1, 0.2}, 0.0});
  const MultiContactPlan plan{{0.6, 1.0}, {0.5}};  // the last leg ends without a record
  MultiContactOptions options;
  options.increment = 0.02;
  const MultiContactExperiment start = make_multi_contact(spec, c, content_of(spec, 0), {});
  std::vector<std::pair<MultiContactPlace, MultiContactExperiment>> saved;
  RunControl<MultiContactUnderWay> control{.seconds = 0.0};
  control.save = [&](const MultiContactUnderWay& now) { saved.emplace_back(now.place, now.experiment); };
  MultiContactExperiment whole = start;
  const MultiContactRun run = run_multi_contact(whole, plan, options, control);
  ASSERT_EQ(run.points.size(), 3U);
  ASSERT_EQ(saved.size(), 16U);  // ten increments in, six out
  for (auto& [place, e] : saved) {
    const MultiContactRun resumed = run_multi_contact(e, plan, options, {}, place);
    expect_equal(run.points, resumed.points);
    expect_same(run.cost, resumed.cost);
    EXPECT_EQ(e.overlap, whole.overlap);
  }
}

void expect_same(const PackingRun& a, const PackingRun& b) {
  ASSERT_EQ(a.normal.size(), b.normal.size());
  for (std::size_t k = 0; k < a.normal.size(); ++k) {
    EXPECT_EQ(a.normal[k].force, b.normal[k].force);
    EXPECT_EQ(a.normal[k].residual, b.normal[k].residual);
  }
  ASSERT_EQ(a.tangential.size(), b.tangential.size());
  for (std::size_t k = 0; k < a.tangential.size(); ++k) {
    EXPECT_EQ(a.tangential[k].angle_deg, b.tangential[k].angle_deg);
    EXPECT_EQ(a.tangential[k].force_parallel, b.tangential[k].force_parallel);
    EXPECT_EQ(a.tangential[k].force_perpendicular, b.tangential[k].force_perpendicular);
  }
  expect_same(a.normal_cost, b.normal_cost);
  expect_same(a.tangential_cost, b.tangential_cost);
}

TEST(RestartBetweenPoints, AMeasurementGoesOnFromEveryRotation) {
  const SoftParticleSpec spec = coarse_spec();
  const auto protocol = make_damped_protocol({});
  for (const bool cumulative : {false, true}) {
    const MeasurementPlan plan{{0.15, 0.25}, {0.25}, {-1.0, -0.07, 0.05, 1.0}, 0.05, true, cumulative};
    std::vector<MeasurementState> saved;
    MeasurementState whole;
    whole.experiment = make_soft_solid(spec, generate_shell_packing(spec, 1, 0), false);
    RunControl<MeasurementState> control{.seconds = 0.0};
    control.save = [&](const MeasurementState& s) { saved.push_back(s); };
    measure(whole, plan, *protocol, control);
    ASSERT_EQ(whole.run.tangential.size(), 5U);
    EXPECT_EQ(saved.size(), cumulative ? 4U : 6U);  // two overlaps, before each angle or each sign
    for (MeasurementState& state : saved) {
      measure(state, plan, *protocol);
      expect_same(whole.run, state.run);
    }
  }
}

/// Keeps every fourth state of a preparation in a file of its own, or takes up one of them.
class FourthStates : public PreparationKeeper {
 public:
  explicit FourthStates(std::string folder, std::int64_t from = -1) : folder_(std::move(folder)), from_(from) {}

  bool due() override { return from_ < 0 && asked_++ % 4 == 0; }
  void save(const std::function<void(const h5::Group&)>& write) override {
    h5::AtomicFile file(path(count_++));
    write(file.root());
    file.commit();
  }
  void load(const std::function<void(const h5::Group&)>& read) override {
    if (from_ >= 0) read(h5::open_file(path(from_)));
  }
  [[nodiscard]] std::int64_t count() const { return count_; }

 private:
  [[nodiscard]] std::string path(std::int64_t k) const { return folder_ + "/" + std::to_string(k) + ".h5"; }

  std::string folder_;
  std::int64_t from_;
  std::int64_t asked_ = 0;
  std::int64_t count_ = 0;
};

void expect_same(const MacroPacking& a, const MacroPacking& b) {
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].x, b.bodies[k].x);
    EXPECT_EQ(a.bodies[k].r, b.bodies[k].r);
  }
  ASSERT_EQ(a.springs.size(), b.springs.size());
  for (std::size_t k = 0; k < a.springs.size(); ++k) EXPECT_EQ(a.springs[k].spring, b.springs[k].spring);
  expect_same(a.cost, b.cost);
}

/// By shrinking and pressing, by falling pressures, with fines that grow between coarse bodies; in boxes of both kinds.
TEST(RestartBetweenPoints, APreparationGoesOnFromStatesUnderWay) {
  for (const Preparation preparation : {Preparation::fast, Preparation::frictionless, Preparation::dense}) {
    for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
      MacroSpec spec;
      spec.boundary = boundary;
      spec.bodies = 60;
      spec.preparation = preparation;
      spec.protocol = protocol_of(preparation, 0.3);
      spec.friction = spec.wall_friction = 0.3;
      const TemporaryDirectory folder;
      FourthStates states(folder.file(""));
      const MacroPacking whole = make_macro_packing(spec, 1, 0, {{}, &states});
      EXPECT_EQ(whole.springs.empty(), preparation != Preparation::fast);
      expect_same(whole, make_macro_packing(spec, 1, 0));
      ASSERT_GT(states.count(), 20);
      constexpr std::int64_t kTried = 12;
      for (std::int64_t k = 0; k < kTried; ++k) {
        SCOPED_TRACE(fmt::format("{}, {}, state {} of {}", to_string(preparation), to_string(boundary),
                                 k * (states.count() - 1) / (kTried - 1), states.count()));
        FourthStates one(folder.file(""), k * (states.count() - 1) / (kTried - 1));
        expect_same(whole, make_macro_packing(spec, 1, 0, {{}, &one}));
      }
    }
  }
}

TEST(RestartBetweenPoints, ACompressionGoesOnFromEveryIncrement) {
  MacroSpec spec;
  spec.bodies = 8;
  spec.soft_share = 0.4;
  spec.steps = 2;
  spec.increments_per_step = 3;
  spec.strain_end = 0.2;
  const SoftParticleSpec inside = coarse_spec();
  const MacroPacking packing = make_macro_packing(spec, 1, 0);
  CompressionState whole;
  whole.macro = make_shelled_system(spec, packing, {generate_shell_packing(inside, 1, 0)}, 1, 0);
  whole.curve = begin_curve(spec, packing, whole.macro, "shelled", 0);
  std::vector<CompressionState> saved;
  RunControl<CompressionState> control{.seconds = 0.0};
  control.save = [&](const CompressionState& s) { saved.push_back(s); };
  compress(whole, spec, control);
  ASSERT_EQ(saved.size(), 7U);  // three points, twice two increments between
  for (CompressionState& state : saved) {
    compress(state, spec);
    EXPECT_EQ(whole.curve.strain, state.curve.strain);
    EXPECT_EQ(whole.curve.stress_axial, state.curve.stress_axial);
    EXPECT_EQ(whole.curve.stress_lateral, state.curve.stress_lateral);
    EXPECT_EQ(whole.curve.residual, state.curve.residual);
    expect_same(whole.curve.cost, state.curve.cost);
  }
}

/// Stages by stress, whose way begins at what was measured, in a cell that is taken up anywhere.
TEST(RestartBetweenPoints, StagesGoOnFromEveryIncrement) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.bodies = 60;
  spec.soft_share = 0.2;
  spec.test = MacroTest::stages;
  for (const StageKind kind : {StageKind::consolidation, StageKind::triaxial, StageKind::unload}) {
    MacroStage stage;
    stage.record = {to_string(kind), kind, kind};
    stage.steps = 2;
    spec.stages.push_back(stage);
  }
  for (AxisDrive& axis : spec.stages[0].axis) axis = {true, 300.0, -1};
  for (const std::size_t k : {1U, 2U})
    spec.stages[k].axis[0] = spec.stages[k].axis[1] = {true, 0.0, static_cast<std::int64_t>(k)};
  spec.stages[1].axis[2].value = 0.02;
  spec.stages[2].axis[2] = {true, 0.0, 1};
  const MacroPacking packing = make_macro_packing(spec, 1, 0);
  CompressionState whole;
  whole.macro = make_shelled_system(spec, packing, {generate_shell_packing(coarse_spec(), 1, 0)}, 1, 0);
  whole.curve = begin_curve(spec, packing, whole.macro, "shelled", 0);
  std::vector<CompressionState> saved;
  RunControl<CompressionState> control{.seconds = 0.0};
  control.save = [&](const CompressionState& s) { saved.push_back(s); };
  compress(whole, spec, control);
  ASSERT_TRUE(whole.curve.usable) << whole.curve.note;
  ASSERT_EQ(saved.size(), 13U);
  for (std::size_t k = 0; k < saved.size(); k += 3) {
    compress(saved[k], spec);
    EXPECT_EQ(whole.curve.stress_axial, saved[k].curve.stress_axial) << k;
    EXPECT_EQ(whole.curve.stress_x, saved[k].curve.stress_x) << k;
    EXPECT_EQ(whole.curve.strain_x, saved[k].curve.strain_x) << k;
    EXPECT_EQ(whole.curve.stage, saved[k].curve.stage) << k;
    expect_same(whole.curve.cost, saved[k].curve.cost);
  }
}

/// Loading and unloading, between walls by strain, in a cell by stress.
MacroSpec spec_that_unloads(Boundary boundary) {
  MacroSpec spec;
  spec.boundary = boundary;
  spec.bodies = 40;
  spec.soft_share = 0.4;
  spec.test = MacroTest::stages;
  for (const StageKind kind : {StageKind::isotropic, StageKind::unload}) {
    MacroStage stage;
    stage.record = {to_string(kind), kind, StageKind::isotropic};
    stage.steps = 2;
    stage.isotropic = true;
    const bool loads = kind == StageKind::isotropic;
    for (AxisDrive& axis : stage.axis)
      axis = boundary == Boundary::periodic ? AxisDrive{true, loads ? 600.0 : 200.0, -1}
                                            : AxisDrive{false, loads ? 0.06 : -0.01, -1};
    spec.stages.push_back(stage);
  }
  return spec;
}

CompressionState state_with_ratio(const MacroSpec& spec, double ratio) {
  static const LawTable table = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  MultiContactChoices choices;
  choices.form = LawForm::isotropic;
  choices.modulus = spec.youngs_modulus;
  choices.unloading_ratio = ratio;
  const MultiContactLaws laws = make_multi_contact_laws(main_entry(table), choices);
  const MacroPacking packing = make_macro_packing(spec, 1, 0);
  CompressionState state;
  state.macro =
      make_law_system(spec, packing, {laws.soft_solid, laws.solid_soft, laws.soft_plane, laws.soft_soft}, 0.7);
  state.curve = begin_curve(spec, packing, state.macro, "law", 0);
  return state;
}

System3 through_a_file(const System3& s) {
  const TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_system(file.root().create("state"), s);
    file.commit();
  }
  System3 read;
  read.materials = s.materials;
  read.laws = s.laws;
  read_system(h5::open_file(directory.file("state.h5")).open("state"), read);
  return read;
}

/// Soft particles that unload from their largest volume at rest take it along.
TEST(RestartBetweenPoints, ParticlesThatRememberGoOnFromEveryFile) {
  for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
    const MacroSpec spec = spec_that_unloads(boundary);
    CompressionState elastic = state_with_ratio(spec, 1.0);
    compress(elastic, spec);
    CompressionState whole = state_with_ratio(spec, 1.5);
    std::vector<CompressionState> saved;
    RunControl<CompressionState> control{.seconds = 0.0};
    control.save = [&](const CompressionState& s) { saved.push_back(s); };
    compress(whole, spec, control);
    ASSERT_TRUE(whole.curve.usable) << whole.curve.note;
    ASSERT_EQ(whole.curve.stress_axial.size(), 5U);
    EXPECT_TRUE(elastic.macro.system.particles.largest_volume.empty());
    EXPECT_NEAR(whole.curve.stress_axial[2], elastic.curve.stress_axial[2], 0.02 * elastic.curve.stress_axial[2]);
    if (boundary == Boundary::walls)
      EXPECT_LT(whole.curve.stress_axial[4], 0.97 * elastic.curve.stress_axial[4]);
    else
      EXPECT_GT(whole.curve.strain[4], elastic.curve.strain[4]) << "less strain comes back";
    ASSERT_EQ(saved.size(), 9U);
    for (CompressionState& state : saved) {
      state.macro.system = through_a_file(state.macro.system);
      compress(state, spec);
      EXPECT_EQ(whole.curve.strain, state.curve.strain);
      EXPECT_EQ(whole.curve.stress_axial, state.curve.stress_axial);
      EXPECT_EQ(whole.curve.stress_lateral, state.curve.stress_lateral);
      EXPECT_EQ(whole.macro.system.particles.largest_volume, state.macro.system.particles.largest_volume);
      expect_same(whole.curve.cost, state.curve.cost);
    }
  }
}

}  // namespace
