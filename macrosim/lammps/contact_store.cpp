// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/contact_store.h"

#include <algorithm>

namespace softgrain::lammps {

void ContactStore::assign(const std::vector<NearPair>& pairs, std::size_t laws) {
  std::vector<std::size_t> next(laws + 1, 0);
  for (const NearPair& p : pairs) ++next[static_cast<std::size_t>(p.law) + 1];
  sections.clear();
  for (std::size_t law = 0; law < laws; ++law) {
    const std::size_t begin = next[law];
    next[law + 1] += begin;
    if (next[law + 1] > begin)
      sections.push_back(
          {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(next[law + 1]), static_cast<int>(law)});
  }
  i.resize(pairs.size());
  j.resize(pairs.size());
  constants.resize(pairs.size());
  for (const NearPair& p : pairs) {
    const std::size_t at = next[static_cast<std::size_t>(p.law)]++;
    i[at] = p.i;
    j[at] = p.j;
    constants[at] = p.constants;
  }
  spring.assign(pairs.size(), {});
  memory.assign(pairs.size(), 0.0);
  roll.assign(pairs.size(), {});
  touched.assign(pairs.size(), 0);
}

const Remembered* find(const AtomMemory& memory, int partner) {
  const auto at = std::find_if(memory.begin(), memory.end(), [&](const Remembered& r) { return r.partner == partner; });
  return at == memory.end() ? nullptr : &*at;
}

}  // namespace softgrain::lammps
