// What tests of multi-contact laws share: small contents and comparison of points.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "common/data/multi_contact_measurements.h"
#include "microsim/multi_contact_experiment.h"
#include "microsim/shell_packing.h"

namespace softgrain::test {

/// Some fifty grains that carry force early.
inline SoftParticleSpec coarse_spec() {
  SoftParticleSpec spec;
  spec.polydispersity = 4.0;
  spec.beta = 8.0;
  spec.trials = 1000;
  spec.placement = Placement::voids;
  return spec;
}

inline SoftContent content_of(const SoftParticleSpec& spec, std::uint64_t index) {
  return {generate_shell_packing(spec, 1, index), {}, {}};
}

inline MultiContactConfiguration multi_contact_of(PartnerKind kind, double ratio, const std::vector<Vec3>& directions,
                                                  double overlap) {
  MultiContactConfiguration c;
  c.name = "test";
  for (const Vec3& d : directions) c.partners.push_back({kind, kind == PartnerKind::plane ? 0.0 : ratio, d});
  c.stages = {{MultiContactMove::load, std::vector<double>(directions.size(), overlap), 0.0}};
  return c;
}

inline void expect_equal(const std::vector<MultiContactPoint>& a, const std::vector<MultiContactPoint>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].stage, b[k].stage);
    EXPECT_EQ(a[k].overlap, b[k].overlap);
    EXPECT_EQ(a[k].normal, b[k].normal);
    EXPECT_EQ(a[k].tangential, b[k].tangential);
    EXPECT_EQ(a[k].moment, b[k].moment);
    EXPECT_EQ(a[k].slide, b[k].slide);
    EXPECT_EQ(a[k].roll, b[k].roll);
    EXPECT_EQ(a[k].centre, b[k].centre);
    EXPECT_EQ(a[k].residual, b[k].residual);
    EXPECT_EQ(a[k].max_overlap, b[k].max_overlap);
    EXPECT_EQ(a[k].converged, b[k].converged);
  }
}

}  // namespace softgrain::test
