// Law tables and multi-contact measurements made from known numbers.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/contact/multi_contact_prediction.h"
#include "common/core/random.h"
#include "common/data/multi_contact_law.h"
#include "common/data/multi_contact_measurements.h"
#include "microsim/multi_contact_arrangements.h"
#include "tests/support/synthetic_law.h"

namespace softgrain::synthetic {

inline Estimate near(double value) { return {value, 0.1 * value / 3.0, 0.9 * value, 1.1 * value}; }
inline Estimate unknown(double value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {value, kInfinity, -kInfinity, kInfinity};
}

/// One form; `shift` moves every number a little.
inline MultiContactLaw multi_contact_law(LawForm form, double shift = 0.0) {
  MultiContactLaw law;
  law.form = form;
  law.a = near(0.7 + shift);
  law.b = near(2.8 + shift / 3.0);
  law.delta = near(0.08 + shift / 7.0);
  law.m0.value = 1.0;
  if (form == LawForm::directional) {
    law.m0 = near(0.6 + shift);
    law.m1 = near(0.5 + shift / 3.0);
    law.m2 = near(0.1 + shift / 7.0);
  }
  law.partners = {{PartnerKind::solid, 0.5, near(0.7 + shift), near(1.1), 0.4, 0.1 / 3.0},
                  {PartnerKind::solid, 2.0, near(0.8 + shift), near(1.1), 0.3, 0.2 / 3.0},
                  {PartnerKind::soft, 1.0, near(0.4 + shift), near(1.3), 0.35, 0.1 / 7.0},
                  {PartnerKind::soft, 2.0, near(0.5 + shift), near(1.3), 0.25, 0.2 / 7.0}};
  law.errors = {{"one-plane", MultiContactUse::fitted, 0.05 / 3.0, 1.01, 0.02},
                {"cube-plane", MultiContactUse::predicted, 0.1 / 3.0, 0.97, 0.03}};
  law.error_fitted = 0.05 / 3.0;
  law.error_held_out = 0.1 / 3.0;
  law.error_cross = 0.07 / 3.0;
  law.criterion = -100.0 / 3.0;
  law.parameters = form == LawForm::directional ? 6 : 3;
  return law;
}

inline LawTableEntry law_entry(double solid_fraction = 0.7, double shift = 0.0) {
  LawTableEntry e;
  e.spec.shell_radius = 0.1 / 7.0;
  e.solid_fraction = solid_fraction;
  e.solid_fraction_error = 0.001 / 3.0;
  e.packings = 12;
  e.grains = 1.0e6 / 3.0;
  e.relaxation = "damped, increment 0.005";
  e.volume_max = 0.2 / 3.0 + shift;
  e.overlap_max = 0.28 + shift;
  e.grain_overlap_max = 1.0 / 3.0;
  e.slide_plane = {near(0.3 + shift), near(0.25 + shift)};
  e.slide_solid = {near(0.2 + shift), near(0.35 + shift)};
  e.slide_soft = {near(0.1 + shift), near(0.45 + shift)};
  e.unloading = near(1.5 + shift);
  e.laws = {multi_contact_law(LawForm::pair, shift), multi_contact_law(LawForm::isotropic, shift),
            multi_contact_law(LawForm::directional, shift)};
  e.best = LawForm::directional;
  return e;
}

/// A configuration that is loaded to `overlap` and then, when `after` says so, unloaded or slid.
inline MultiContactConfiguration multi_contact_configuration(Arrangement arranged, PartnerKind kind, double ratio,
                                                             double overlap,
                                                             MultiContactMove after = MultiContactMove::load) {
  MultiContactConfiguration c;
  c.name = to_string(arranged) + "-" + to_string(kind) + "-" + std::to_string(ratio) +
           (after == MultiContactMove::load ? "" : to_string(after));
  for (const Vec3& d : directions_of(arranged))
    c.partners.push_back({kind, kind == PartnerKind::plane ? 0.0 : ratio, d});
  c.stages = {{MultiContactMove::load, std::vector<double>(c.partners.size(), overlap), 0.0}};
  if (after == MultiContactMove::unload)
    c.stages.push_back({MultiContactMove::unload, std::vector<double>(c.partners.size(), 0.0), 0.0});
  if (after == MultiContactMove::slide) c.stages.push_back({MultiContactMove::slide, c.stages[0].overlap, 0.4});
  if (after == MultiContactMove::roll) c.stages.push_back({MultiContactMove::roll, c.stages[0].overlap, 0.0, 0.4});
  return c;
}

/// What the packings of a made-up measurement do besides following the law.
struct MultiContactOptionsKnown {
  int packings = 12;
  double noise = 0.0;             ///< relative, of every force by itself
  int points = 12;                ///< per stage
  double unloading = 1.5;         ///< unloading: x_max - s (x_max - x) is felt
  double kt = 0.5;                ///< slide: drag grows by this per slide, over E Rs
  double limit = 0.2;             ///< up to this share of the normal force
  double rolling = 0.006;         ///< roll: moment grows by this per way, over E Rs^2
  double rolling_friction = 0.1;  ///< up to this share of the normal force times Rs
  std::uint64_t seed = 1;
};

/// A state of the path: share of the stage.
inline MultiContactPoint multi_contact_point(const MultiContactModel& model, const MultiContactConfiguration& c,
                                             std::size_t stage, double share, const MultiContactOptionsKnown& o) {
  MultiContactPoint p;
  p.stage = static_cast<std::int64_t>(stage);
  p.converged = true;
  p.max_overlap = 0.1 + share;
  std::vector<double> felt;
  for (const double deepest : c.stages[0].overlap) {
    const double x = stage == 0                                           ? share * deepest
                     : c.stages[stage].slide + c.stages[stage].roll > 0.0 ? deepest
                                                                          : (1.0 - share) * deepest;
    p.overlap.push_back(x);
    felt.push_back(stage == 0 ? x : std::max(deepest - o.unloading * (deepest - x), 0.0));
  }
  p.normal = multi_contact_forces(model, c.partners, felt);
  p.tangential.resize(p.normal.size());
  p.slide = c.stages[stage].slide * share;
  if (p.slide > 0.0)
    p.tangential[0] = slide_direction(c.partners[0].direction) * -std::min(o.kt * p.slide, o.limit * p.normal[0]);
  p.roll = c.stages[stage].roll * share;
  p.moment.resize(p.normal.size());
  const Vec3& n = c.partners[0].direction;
  if (p.roll > 0.0)
    p.moment[0] = cross(n, slide_direction(n)) * -std::min(o.rolling * p.roll, o.rolling_friction * p.normal[0]);
  return p;
}

/// Forces of `model` with noise; packing after packing.
inline MultiContactMeasurements multi_contact_measurements(const MultiContactModel& model,
                                                           const std::vector<MultiContactConfiguration>& list,
                                                           const MultiContactOptionsKnown& o) {
  MultiContactMeasurements data;
  data.relaxation = "made up";
  data.configurations = list;
  for (int i = 0; i < o.packings; ++i) {
    RandomStream random(o.seed, RandomPurpose::test, static_cast<std::uint64_t>(i));
    data.packings.push_back({static_cast<std::uint64_t>(i), 400, 0.70 + 0.001 * i, 0.8, 3.5, 0.1, {}});
    for (std::size_t c = 0; c < list.size(); ++c) {
      MultiContactRun run;
      run.configuration = static_cast<std::int64_t>(c);
      run.packing = i;
      for (std::size_t stage = 0; stage < list[c].stages.size(); ++stage)
        for (int k = 1; k <= o.points; ++k)
          run.points.push_back(multi_contact_point(model, list[c], stage, static_cast<double>(k) / o.points, o));
      for (MultiContactPoint& p : run.points)
        for (double& f : p.normal) f *= 1.0 + o.noise * test::normal_number(random);
      data.runs.push_back(run);
    }
  }
  return data;
}

}  // namespace softgrain::synthetic
