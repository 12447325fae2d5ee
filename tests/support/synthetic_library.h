// A library of law tables made from smooth functions of the material.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/core/random.h"
#include "common/data/multi_contact_law.h"
#include "common/data/multi_contact_replicates.h"
#include "pipelines/law/law_library.h"
#include "tests/support/synthetic_multi_contact.h"

namespace softgrain::synthetic {

/// ln F at D = 0.35, b, delta of a material.
inline double library_force(const LibraryPoint& p) {
  return -4.0 + 0.4 * p.friction + 0.1 * (p.exponent - 3.0) + 5.0 * (p.solid_fraction - 0.65) +
         0.1 * std::log(p.polydispersity);
}
inline double library_exponent(const LibraryPoint& p) {
  return 3.0 - 0.5 * p.friction - 2.0 * (p.solid_fraction - 0.65);
}
inline double library_onset(const LibraryPoint& p) {
  return 0.14 - 0.05 * p.friction - 0.8 * (p.solid_fraction - 0.65);
}

/// The entry of a table of this material: `noise` is the standard error of ln F, b/5 and delta/0.1.
inline LawTableEntry library_entry(const LibraryPoint& p, double noise, std::uint64_t seed,
                                   double poisson_ratio = 0.3) {
  RandomStream random(seed, RandomPurpose::test, 2);
  LawTableEntry e = law_entry(p.solid_fraction);
  e.spec.friction = p.friction;
  e.spec.exponent = p.exponent;
  e.spec.polydispersity = p.polydispersity;
  e.spec.poisson_ratio = poisson_ratio;
  e.spec.trials = static_cast<std::int64_t>(1e4 * std::exp(20.0 * (p.solid_fraction - 0.65)));
  e.slide_plane.measured = e.slide_solid.measured = e.slide_soft.measured = true;
  e.slide_plane.kt_ratio = near(0.3 - 0.1 * p.friction);
  e.packings = 24;
  MultiContactLaw law = multi_contact_law(LawForm::isotropic);
  const auto put = [&](std::vector<double>& numbers) {
    const double b = library_exponent(p) + 0.2 * noise * random.normal();
    const double delta = library_onset(p) + 0.1 * noise * random.normal();
    const double force = std::exp(library_force(p) + noise * random.normal());
    numbers[0] = force / (std::pow(0.35, b) - std::pow(delta, b)) / (1.0 - poisson_ratio * poisson_ratio);
    numbers[1] = b;
    numbers[2] = delta;
    const double solid = 0.1 * noise * random.normal();  // all sizes of a kind have one exponent
    const double soft = 0.1 * noise * random.normal();
    for (std::size_t k = 0; k < law.partners.size(); ++k) {
      numbers[6 + 2 * k] *= std::exp(noise * random.normal());
      numbers[7 + 2 * k] += law.partners[k].kind == PartnerKind::solid ? solid : soft;
    }
  };
  std::vector<double> numbers = multi_contact_numbers(law);
  put(numbers);
  for (int r = 0; r < 60; ++r) {
    std::vector<double> refit = multi_contact_numbers(law);
    put(refit);
    law.replicates.push_back(refit);
  }
  const auto replicates = law.replicates;
  law = with_numbers(law, numbers);
  law.replicates = replicates;
  const auto hold = [](Estimate& number) {
    number.low = std::min(number.low, number.value);
    number.high = std::max(number.high, number.value);
  };
  for (const MultiContactParameterName& number : kMultiContactParameters) hold(law.*number.estimate);
  for (PartnerRow& row : law.partners) {
    hold(row.weight);
    hold(row.exponent);
  }
  e.laws = {law};
  e.best = LawForm::isotropic;
  return e;
}

/// Materials at random within mu 0 to 0.8, exponent 2.5 to 4, ratio 4 to 14, solid fraction 0.58 to 0.72, and all
/// corners. Its checks say that the processes predict all numbers and their deviations are right.
inline LawLibrary law_library(std::size_t count, double noise = 0.02) {
  LawLibrary library = library_like(library_entry({0.4, 3.0, 6.0, 0.65}, noise, 0));
  RandomStream random(3, RandomPurpose::test, 1);
  for (std::size_t k = 0; k < count + 16; ++k) {
    const auto at = [&](std::size_t bit) {
      return k < count ? random.uniform() : static_cast<double>((k - count) >> bit & 1U);
    };
    const LibraryPoint p{0.8 * at(0), 2.5 + 1.5 * at(1), 4.0 * std::pow(3.5, at(2)), 0.58 + 0.14 * at(3)};
    std::string why;
    library.materials.push_back(*library_row(library, library_entry(p, noise, k), "synthetic", why));
  }
  const std::vector<std::string> names = library.names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto has = [k](const LibraryMaterial& m) { return std::isfinite(m.numbers[k]); };
    const auto known = static_cast<std::size_t>(std::count_if(library.materials.begin(), library.materials.end(), has));
    library.checks.push_back({names[k], known, 0.0, 1.0, 1.0, 1.0});
  }
  return library;
}

}  // namespace softgrain::synthetic
