#include "microsim/particles/contact_totals.h"

#include <algorithm>

#include "common/dynamics/force_pass.h"

namespace softgrain {

template <int D>
ContactTotals<D> contact_totals(const System<D>& s) {
  ContactTotals<D> out;
  std::int64_t ends_at_grains = 0;
  Matrix<D> sum;
  for (const ContactRecord<D>& c : contact_records(s)) {
    ++out.contacts;
    ends_at_grains += c.j < s.particles.grains ? 2 : 1;
    const Vec<D> force = c.normal * c.normal_force + c.tangential_force;
    for (int k = 0; k < D; ++k) sum[k] += force * c.branch[k];
  }
  if (s.particles.grains > 0)
    out.coordination_number = static_cast<double>(ends_at_grains) / static_cast<double>(s.particles.grains);
  out.has_stress = std::all_of(s.cell.periodic.begin(), s.cell.periodic.end(), [](bool along) { return along; });
  if (!out.has_stress) return out;
  const double volume = s.cell.volume();
  for (int k = 0; k < D; ++k) {
    out.stress[k] = sum[k] * (-1.0 / volume);
    out.pressure -= out.stress[k][k] / static_cast<double>(D);
  }
  return out;
}

template ContactTotals<2> contact_totals<2>(const System<2>&);
template ContactTotals<3> contact_totals<3>(const System<3>&);

}  // namespace softgrain
