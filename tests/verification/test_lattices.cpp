// Cubic lattices under strain: stress and elastic constants.
#include "tests/verification/cases/lattice_cases.h"
#include "tests/verification/the_program.h"

namespace {

using namespace softgrain;
using namespace softgrain::verification;

void expect_stress(const Matrix<3>& here, const Matrix<3>& exact, const std::string& name) {
  double size = 0.0;
  for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(exact[k][k]));
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(here[r][c] / size, exact[r][c] / size, 1e-11) << name << " " << r << c;
}

TEST(VerifiedLattices, StressUnderAnyStretch) {
  for (const Lattice lattice : kLattices)
    for (const Vec3& strain : {Vec3{}, Vec3{{-0.01, 0.0, 0.0}}, Vec3{{-0.01, 0.004, -0.003}}}) {
      const LatticeState state{lattice, 0.02, false};
      expect_stress(run_stretched(state, strain), stretched_closed_form(state, strain), name_of(lattice));
    }
}

TEST(VerifiedLattices, ElasticConstantsWithAndWithoutTangentialSprings) {
  for (const Lattice lattice : kLattices)
    for (const double overlap : {1e-4, 1e-3, 1e-2})
      for (const bool friction : {false, true}) {
        const LatticeState state{lattice, overlap, friction};
        const Moduli here = run_moduli(state);
        const Moduli exact = moduli_closed_form(state);
        EXPECT_NEAR(here.pressure / exact.pressure, 1.0, 1e-10) << name_of(lattice) << overlap;
        EXPECT_NEAR(here.c11 / exact.c11, 1.0, 5e-7) << name_of(lattice) << overlap;
        EXPECT_NEAR(here.c12 / exact.c12, 1.0, 5e-7) << name_of(lattice) << overlap;
        EXPECT_NEAR(here.c44 / exact.c44, 1.0, 5e-7) << name_of(lattice) << overlap << (friction ? " springs" : "");
      }
}

TEST(VerifiedLattices, FaceCentredCubicIsThatOfDuffyAndMindlin) {
  // Without the terms of prestress, X = [3 G^2 p/(2 (1 - nu)^2)]^(1/3):
  // c11 = (4 - 3 nu)/(2 - nu) X, c12 = nu/(2 (2 - nu)) X, c44 = c11/2.
  const double nu = 0.25;
  const double g = 7e10 / (2.0 * (1.0 + nu));
  const LatticeState straight{Lattice::face_centred, 1e-5, true};
  const LatticeState turned{Lattice::face_centred_turned, 1e-5, true};
  const double pressure = -run_stretched(straight, {})[0][0];
  const double x = std::cbrt(3.0 * g * g * pressure / (2.0 * (1.0 - nu) * (1.0 - nu)));
  const double c11 = (4.0 - 3.0 * nu) / (2.0 - nu) * x;
  const double c12 = nu / (2.0 * (2.0 - nu)) * x;
  EXPECT_NEAR(run_shear_modulus(straight) / (0.5 * c11), 1.0, 3e-5);
  EXPECT_NEAR(run_shear_modulus(turned) / (0.5 * (c11 - c12)), 1.0, 3e-5);
  // Tangential springs do not resist pressure: the bulk modulus without them is that with them.
  const Moduli bare = run_moduli({Lattice::face_centred, 1e-5, false});
  EXPECT_NEAR((bare.c11 + 2.0 * bare.c12) / (c11 + 2.0 * c12), 1.0, 3e-5);
}

TEST(VerifiedLattices, TheProgram) {
  const LatticeState state{Lattice::face_centred, 0.02, false};
  const Vec3 strain{{-0.01, 0.004, -0.003}};
  const auto summary = run_by_program(stretched_scene(state, strain));
  expect_same_end(summary, run_text(stretched_scene(state, strain)));
  Matrix<3> there;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) there.row[r].v[c] = summary["contact_state"]["stress"][r][c].get<double>();
  expect_stress(there, stretched_closed_form(state, strain), "the program");
  EXPECT_NEAR(summary["contact_state"]["coordination_number"].get<double>(), 12.0, 1e-12);
}

}  // namespace
