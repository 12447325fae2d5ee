#include "microsim/particles/contact_totals.h"

#include "common/dynamics/force_pass.h"

namespace softgrain {

ContactTotals contact_totals(const System3& s) {
  ContactTotals out;
  std::int64_t ends_at_grains = 0;
  Matrix<3> sum;
  for (const ContactRecord<3>& c : contact_records(s)) {
    ++out.contacts;
    ends_at_grains += c.j < s.particles.grains ? 2 : 1;
    const Vec3 force = c.normal * c.normal_force + c.tangential_force;
    for (int k = 0; k < 3; ++k) sum[k] += force * c.branch[k];
  }
  if (s.particles.grains > 0)
    out.coordination_number = static_cast<double>(ends_at_grains) / static_cast<double>(s.particles.grains);
  out.has_stress = s.cell.periodic[0] && s.cell.periodic[1] && s.cell.periodic[2];
  if (!out.has_stress) return out;
  const double volume = s.cell.volume();
  for (int k = 0; k < 3; ++k) {
    out.stress[k] = sum[k] * (-1.0 / volume);
    out.pressure -= out.stress[k][k] / 3.0;
  }
  return out;
}

}  // namespace softgrain
