// Near pairs of one rank with their history: structure of arrays in sections of one law, as in the program's own list.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/contact/contact_state.h"
#include "common/contact/law_set.h"

namespace softgrain::lammps {

/// A pair that may come to touch before the next list.
struct NearPair {
  int i = 0;  ///< an atom of this rank
  int j = 0;  ///< atom (own or ghost), or number of a plane
  int law = 0;
  PairConstants constants{};
};

struct Section {
  std::int32_t begin = 0;
  std::int32_t end = 0;
  int law = 0;
};

struct ContactStore {
  std::vector<int> i;
  std::vector<int> j;
  std::vector<PairConstants> constants;
  std::vector<Vec<3>> spring;  ///< tangential spring of i against j
  std::vector<double> memory;
  std::vector<Vec<3>> roll;   ///< rolling history of i against j
  std::vector<char> touched;  ///< 0: the history is known to be empty
  std::vector<Section> sections;

  [[nodiscard]] std::size_t size() const { return i.size(); }

  /// Takes the pairs over, sorted by law, without history.
  void assign(const std::vector<NearPair>& pairs, std::size_t laws);
};

/// What one atom remembers of a contact: `partner` is the tag of an atom, or minus the number of a plane from 1.
struct Remembered {
  int partner = 0;
  Vec<3> spring{};  ///< seen from this atom, as is a memory that has sides
  double memory = 0.0;
  Vec<3> roll{};
};

using AtomMemory = std::vector<Remembered>;

/// The entry for a partner; nullptr when there is none.
const Remembered* find(const AtomMemory& memory, int partner);

}  // namespace softgrain::lammps
