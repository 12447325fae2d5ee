#include "tests/verification/cases/impact_cases.h"

#include <algorithm>
#include <cmath>

#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

OutsideRun run_with(const ImpactCase& which, double steps_per_contact, bool record) {
  const std::string step = digits(which.closed_form.duration / steps_per_contact);
  Overrides overrides{"time.step=" + step};
  overrides.push_back("time.end=" + digits(which.onset + 2.0 * which.closed_form.duration));
  overrides.push_back("output.every=" + (record ? step : std::string("1.0")));
  return run_file(which.scene, overrides);
}

/// Value at `x` of a curve through points with ascending abscissae; 0 before the first, the last one after it.
double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  const auto above = std::lower_bound(xs.begin(), xs.end(), x);
  if (above == xs.begin()) return 0.0;
  if (above == xs.end()) return ys.back();
  const auto k = static_cast<std::size_t>(above - xs.begin());
  return ys[k - 1] + (ys[k] - ys[k - 1]) * (x - xs[k - 1]) / (xs[k] - xs[k - 1]);
}

DigitisedCurve read_digitised(const std::string& file) {
  DigitisedCurve out;
  for (const auto& row : reference_table(file)) {
    out.x.push_back(row[0] * 1e-6);
    out.force.push_back(row[1] * 1e3);
  }
  return out;
}

CurveDistance distance(const std::vector<double>& xs, const std::vector<double>& forces, const DigitisedCurve& data,
                       double scale) {
  CurveDistance out;
  for (std::size_t k = 0; k < data.x.size(); ++k) {
    const double d = std::abs(interpolate(xs, forces, data.x[k]) - data.force[k]) / scale;
    out.largest = std::max(out.largest, d);
    out.rms += d * d / static_cast<double>(data.x.size());
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

}  // namespace

ImpactCase two_spheres() {
  ImpactCase out{"two glass spheres", "two_spheres", "chung_ooi/chung_ooi_test1",           0,
                 1e-3 / 20.0,         20.0,          {10696.889, 274.1127e-6, 40.33946e-6}, {}};
  const double mass = sphere_mass(0.01, 2800.0);
  out.closed_form = hertz_impact({hertz_stiffness(effective_modulus(4.8e10, 0.2), 0.005), 0.5 * mass}, out.speed);
  return out;
}

ImpactCase sphere_on_rigid_plane() {
  ImpactCase out{"sphere on a rigid plane",
                 "sphere_on_rigid_plane",
                 "chung_ooi/chung_ooi_test2",
                 2,
                 1e-4 / 0.2,
                 0.2,
                 {11369.858, 49.7172e-6, 731.6566e-6},
                 {}};
  const double modulus = 7e10 / (1.0 - 0.3 * 0.3);
  out.closed_form = hertz_impact({hertz_stiffness(modulus, 0.1), sphere_mass(0.1, 2699.0)}, out.speed);
  return out;
}

ImpactErrors run_impact(const ImpactCase& which, double steps_per_contact) {
  const OutsideRun run = run_with(which, steps_per_contact, false);
  const ContactHistory& contact = only_contact(run);
  const ImpactNumbers& exact = which.closed_form;
  ImpactErrors out;
  out.steps_per_contact = steps_per_contact;
  out.here = {contact.max_force, contact.max_overlap, contact.duration};
  out.relative = {out.here.force / exact.force - 1.0, out.here.overlap / exact.overlap - 1.0,
                  out.here.duration / exact.duration - 1.0};
  // The spheres of test 1 come from both sides at half the speed each.
  const double own = which.axis == 0 ? 0.5 * which.speed : which.speed;
  out.relative_restitution = std::abs(run.final_velocity(0)[which.axis]) / own - 1.0;
  return out;
}

ImpactCurve impact_curve(const ImpactCase& which) {
  const OutsideRun run = run_with(which, 400.0, true);
  const int axis = which.axis;
  ImpactCurve out;
  for (std::size_t k = 1; k + 1 < run.frames(); ++k) {
    const double gained = run.velocity(k + 1, 0)[axis] - run.velocity(k - 1, 0)[axis];
    const double place = run.position(k, 0)[axis];
    out.time.push_back(run.time(k) - which.onset);
    out.force.push_back(run.mass(0) * std::abs(gained) / (run.time(k + 1) - run.time(k - 1)));
    out.overlap.push_back(axis == 0 ? 0.02 - (run.position(k, 1)[0] - place) : 0.1 - place);
  }
  return out;
}

DigitisedCurve digitised_over_time(const ImpactCase& which) { return read_digitised(which.data + "_F_vs_t.dat"); }
DigitisedCurve digitised_over_overlap(const ImpactCase& which) {
  return read_digitised(which.data + "_F_vs_delta.dat");
}

CurveDistance distance_over_time(const ImpactCase& which) {
  const ImpactCurve curve = impact_curve(which);
  return distance(curve.time, curve.force, digitised_over_time(which), which.published.force);
}

CurveDistance distance_over_overlap(const ImpactCase& which) {
  const ImpactCurve curve = impact_curve(which);
  // The branch of loading: there the overlap ascends.
  const auto top = std::max_element(curve.overlap.begin(), curve.overlap.end()) - curve.overlap.begin();
  const std::vector<double> xs(curve.overlap.begin(), curve.overlap.begin() + top + 1);
  const std::vector<double> forces(curve.force.begin(), curve.force.begin() + top + 1);
  return distance(xs, forces, digitised_over_overlap(which), which.published.force);
}

}  // namespace softgrain::verification
