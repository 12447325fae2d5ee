// A material of coarse grains and fines in a periodic cell, with the numbers of loose power-law packings.
#pragma once

#include <vector>

#include "common/core/particles.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/cell_matter/cell_start.h"
#include "tests/support/random_sites.h"

namespace softgrain {

inline FinesLaw sample_fines(bool porosity) {
  FinesLaw law;
  if (porosity)
    law.equation = PorosityForm{0.0447, 1.75};
  else
    law.equation = PoreForm{0.0336, 2.03};
  law.void_ratio = 0.567;
  law.excess = {0.6155, 0.3075, 0.355};
  return law;
}

struct CellSample {
  Cell<3> cell;
  std::vector<Sphere<3>> sites;
  CoarseBodies bodies;
  std::vector<double> volume;
  double fines = 0.0;
  FinesLaw law;
};

/// `n` grains of radii 1/3 to 1 that fill `share` of the cell, no two closer than 0.8 of touching; the fines fill 0.51
/// of what they leave.
inline CellSample cell_sample(int n, double share, bool porosity, std::uint64_t index) {
  CellSample out;
  RandomStream random(31, RandomPurpose::test, index);
  double solid = 0.0;
  for (int i = 0; i < n; ++i) {
    out.bodies.radius.push_back(1.0 / (3.0 - 2.0 * (i + 0.5) / n));
    solid += kSphereVolume * cube(out.bodies.radius.back());
  }
  const double l = std::cbrt(solid / share);
  out.cell = box_cell<3>({{l, l, l}}, {true, true, true});
  for (int i = n; i-- > 0;) {
    const double r = out.bodies.radius[static_cast<std::size_t>(i)];
    for (bool free = false; !free;) {
      const Vec3 x{{l * random.uniform(), l * random.uniform(), l * random.uniform()}};
      free = true;
      for (const auto& s : out.sites)
        for (int image = 0; image < image_count<3>() && free; ++image)
          free = norm(s.x + out.cell.image_shift(image) - x) > 0.8 * (s.r + r);
      if (free) out.sites.push_back({x, r});
    }
  }
  for (std::size_t i = 0; i < out.sites.size(); ++i) out.bodies.radius[i] = out.sites[i].r;
  out.volume = radical_cells(out.sites, out.cell).volume;
  out.fines = 0.51 * (l * l * l - solid);
  out.law = sample_fines(porosity);
  return out;
}

inline CellPacking packing_of(const CellSample& s, const CellStart& start, const FaceFriction& friction) {
  return {CellLaw{s.law.equation, {}, friction}, s.sites, start.content, s.cell};
}

}  // namespace softgrain
