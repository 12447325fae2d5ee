#include "pipelines/kinds/cohesive_powder/powder_data.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "common/data/attributes.h"
#include "common/state/system_io.h"
#include "microsim/powder/powder_state_io.h"

namespace softgrain {

void fields(auto&& visit, Of<FittedCurve> auto& c) {
  visit("fit_usable", c.fit.usable);
  visit("fit_reason", c.fit.reason, kLater);
  visit("fit_k_low", c.fit.k_low);
  visit("fit_k_high", c.fit.k_high);
  visit("amplitude", c.fit.model.amplitude);
  visit("dF", c.fit.model.dimension);
  visit("xi", c.fit.model.length);
  visit("c", c.fit.model.background);
  visit("tie_cost", c.fit.tie_cost, kLater);
}

namespace {

struct CurveColumn {
  const char* name;
  const char* unit;  ///< empty: none is written
  std::vector<double> ScatteringCurve::*values;
};
constexpr CurveColumn kCurve[] = {{"k", "1/a", &ScatteringCurve::k},
                                  {"intensity", "a^2", &ScatteringCurve::intensity},
                                  {"modes", "", &ScatteringCurve::modes}};

/// The published picture of a pack with rolling resistance colours contacts below it as unstressed [CP 3.5].
constexpr double kRollingIdleColour = 1e-2;

std::optional<FittedCurve> read_scattering(const h5::Group& group) {
  if (!group.has("scattering")) return std::nullopt;
  const h5::Group g = group.open("scattering");
  FittedCurve out;
  for (const CurveColumn& c : kCurve) out.curve.*c.values = g.doubles(c.name);
  read_attributes(g, out);
  return out;
}

/// Moduli of a stage may be unknown; nothing else of a sample at rest is.
void require_finite(const h5::Group& group, const PowderSample& sample) {
  const auto is_finite = [](auto... numbers) { return (std::isfinite(numbers) && ...); };
  for (const PowderPoint& p : sample.course)
    if (!is_finite(p.time, p.fraction, p.coordination, p.kinetic, p.stress[0], p.stress[1]))
      group.refuse("course", "holds a number that is not finite");
  for (const PowderStage& s : sample.stages)
    if (!is_finite(s.pressure, s.time, s.fraction, s.coordination, s.mean_repulsive, s.mean_tensile))
      group.refuse("stages", "holds a number that is not finite");
}

PowderSample read_sample(const h5::Group& group, const PowderSpec& spec) {
  PowderSample out;
  out.usable = group.integer("usable") != 0;
  out.course = read_course(group);
  out.stages = read_stages(group);
  if (out.usable) require_finite(group, out);
  const System<2> system = read_powder_system(group, spec);
  out.packing = snapshot_of(system, false);
  out.contacts = contact_records(system);
  out.snapshots = read_powder_series(group, out.packing);
  out.scattering = read_scattering(group);
  return out;
}

}  // namespace

void write_scattering(const h5::Group& group, const FittedCurve& fitted) {
  const h5::Group g = group.create("scattering");
  for (const CurveColumn& c : kCurve) {
    g.write(c.name, fitted.curve.*c.values);
    if (*c.unit != '\0') g.attribute_of(c.name, "unit", c.unit);
  }
  write_attributes(g, fitted);
  if (!fitted.fit.covariance.empty()) g.write("covariance", fitted.fit.covariance, {4, 4});
}

SnapshotSeries read_powder_series(const h5::Group& sample, Snapshot state) {
  state.has_velocity = false;
  for (SnapshotParticle& p : state.particles) p.mass = Snapshot::kNone;
  return {std::move(state), read_snapshots(sample)};
}

PowderRun load_powder(const std::string& path) {
  return h5::naming_file(path, [&] {
    const h5::Group root = h5::open_file(path);
    const PowderSpec spec = read_powder_spec(root.open("spec"));
    PowderRun run;
    run.cohesive = spec.cohesive;
    if (spec.rolling) run.idle_colour = kRollingIdleColour;
    for (std::size_t k = 0; root.has(fmt::format("sample_{}", k)); ++k)
      run.samples.push_back(read_sample(root.open(fmt::format("sample_{}", k)), spec));
    run.scattering = read_scattering(root);
    return run;
  });
}

}  // namespace softgrain
