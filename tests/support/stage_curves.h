// Curves in stages whose numbers are known.
#pragma once

#include <cmath>

#include "common/core/vec.h"
#include "common/data/macro_result.h"

namespace softgrain::test {

/// Linear elastic: logarithmic strains in, stresses by Hooke's law out.
struct Elastic {
  double bulk = 3e6;
  double shear = 1e6;
  MacroCurve curve;

  void add(double stage, const Vec3& strain) {
    const double volume = strain[0] + strain[1] + strain[2];
    Vec3 s;
    for (int k = 0; k < 3; ++k) s[k] = 1e5 + bulk * volume + 2.0 * shear * (strain[k] - volume / 3.0);
    curve.stage.push_back(stage);
    curve.strain_x.push_back(-std::expm1(-strain[0]));
    curve.strain_y.push_back(-std::expm1(-strain[1]));
    curve.strain_z.push_back(-std::expm1(-strain[2]));
    curve.strain.push_back(curve.strain_z.back());
    curve.stress_x.push_back(s[0]);
    curve.stress_y.push_back(s[1]);
    curve.stress_axial.push_back(s[2]);
    curve.stress_lateral.push_back(0.5 * (s[0] + s[1]));
  }
};

/// Four points of undrained compression and five of a slide.
inline Elastic pressed_and_slid() {
  Elastic e;
  e.curve.engine = "law";
  e.curve.test = MacroTest::stages;
  using K = StageKind;
  e.curve.stages = {{"a", K::undrained, K::undrained}, {"b", K::direct_shear, K::direct_shear}};
  e.add(0, {});
  for (int k = 1; k <= 4; ++k) e.add(0, {{-0.0005 * k, -0.0005 * k, 0.001 * k}});
  for (int k = 1; k <= 5; ++k) e.add(1, {{-0.002, -0.002, 0.004}});
  MacroCurve& c = e.curve;
  for (std::size_t k = 0; k < c.strain.size(); ++k) {
    const double gamma = k < 5 ? 0.0 : 0.002 * static_cast<double>(k - 4);
    c.shear_strain.push_back(gamma);
    c.stress_xz.push_back(e.shear * gamma);
    c.stress_xy.push_back(0.0);
    c.stress_yz.push_back(0.0);
    c.stress_deviator.push_back(c.stress_axial[k] - c.stress_x[k]);
    for (auto* none : {&c.stress_axial_contacts, &c.coordination, &c.residual}) none->push_back(0.0);
  }
  c.stress_xz[8] *= 2.0;  // a peak
  return e;
}

}  // namespace softgrain::test
