// The numbers of a soft particle, and the groups of HDF5 files that hold them and its packings.
#include "common/data/soft_particle_schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/data/columns.h"
#include "common/data/fields.h"
#include "common/io/provenance.h"
#include "common/io/scene.h"
#include "common/packing/grading_scene.h"

namespace softgrain {

namespace {

const auto& numbers() {
  using S = SoftParticleSpec;
  const Range any = Range::any();
  const Range positive = Range::positive();
  const Range not_negative = Range::not_negative();
  const Range above_one = Range::above(1.0);
  const Range share = Range::closed(0.0, 1.0);
  constexpr double kLargestExponent = 20.0;  // powers of polydispersities of many decades stay numbers
  static const std::array<SoftParticleNumber, 10> all{
      {{"shell_radius", "shell_radius", &S::shell_radius, Unit::length, positive, positive, "Rs", "Rs [m]", "Rs [m]",
        "Rs, radius of the shell (the sphere with the grains)", true},
       {"youngs_modulus", "E", &S::youngs_modulus, Unit::pressure, positive, positive, "E", "E [Pa]",
        "E of the grains [Pa]", "Young's modulus of the grains", true},
       {"poisson_ratio", "nu", &S::poisson_ratio, Unit::none, kPoissonRange, kPoissonRange, "nu", "nu",
        "nu of the grains", "Poisson's ratio of the grains"},
       {"friction", "mu", &S::friction, Unit::none, not_negative, Range::friction(), "mu", "mu", "mu of the grains",
        "friction between grains"},
       {"density", "density", &S::density, Unit::density, positive, positive, "density", "[kg/m^3]", "",
        "density of the grains"},
       {"restitution", "restitution", &S::restitution, Unit::none, share, share, "restitution", "", "",
        "coefficient of restitution of grains; sets the damping of the published relaxation"},
       {"exponent", "exponent", &S::exponent, Unit::none, any, Range{1.0, kLargestExponent, true, false}, "exponent",
        "b of P(r) ~ r^-b", "exponent of the radii", "b of P(r) ~ r^-b, the number of grains of radius r"},
       {"polydispersity", "polydispersity", &S::polydispersity, Unit::none, Range{1.0, kInfinity, false, false},
        above_one, "polydispersity", "rmax/rmin", "polydispersity", "largest over smallest grain radius"},
       {"rmax_over_shell", "rmax_over_shell", &S::rmax_over_shell, Unit::none, Range{0.0, 1.0, true, false},
        Range{0.0, 1.0, true, true}, "rmax_over_shell", "rmax/Rs", "largest grain over Rs",
        "radius of the largest grain over Rs"},
       {"beta", "beta", &S::beta, Unit::none, positive, above_one, "beta",
        "volume of drawn grains over volume of the shell", "packing, beta",
        "volume of the grains that are drawn, over the volume of the shell"}}};
  return all;
}

}  // namespace

std::span<const SoftParticleNumber> soft_particle_numbers() { return numbers(); }

const SoftParticleNumber& soft_particle_number(double SoftParticleSpec::*value) {
  const auto found = std::ranges::find(numbers(), value, &SoftParticleNumber::value);
  if (found == numbers().end()) throw std::logic_error("a number of a soft particle that is not described");
  return *found;
}

Limits limits_of(const Range& range) {
  constexpr double kMost = std::numeric_limits<double>::max();
  // Above zero: no number so small that it has lost digits.
  const double next = range.low == 0.0 ? std::numeric_limits<double>::min() : std::nextafter(range.low, kInfinity);
  return {std::max(-kMost, range.low_open ? next : range.low),
          std::min(kMost, range.high_open ? std::nextafter(range.high, -kInfinity) : range.high)};
}

namespace {

constexpr const char* kUnits = "shell_radius m, youngs_modulus Pa, density kg/m^3, all others 1";

}  // namespace

void write_spec(const h5::Group& root, const SoftParticleSpec& spec) {
  const h5::Group group = root.create("spec");
  group.attribute("units", kUnits);
  for (const SoftParticleNumber& number : soft_particle_numbers())
    if (is_known(spec.*number.value)) group.attribute(number.key, spec.*number.value);
  if (spec.sizes) group.attribute("sizes", spec.sizes->text());
  if (!packing_known(spec)) return;
  group.attribute("trials", spec.trials);
  group.attribute("placement", to_string(spec.placement));
}

SoftParticleSpec read_spec(const h5::Group& root) {
  const h5::Group group = root.open("spec");
  SoftParticleSpec spec;
  if (group.text("units") != kUnits) throw IoError("spec: units '" + group.text("units") + "' are not known");
  if (group.has_attribute("sizes")) {
    spec.sizes = stored_grading(group.text("sizes"));
    spec.exponent = std::numeric_limits<double>::quiet_NaN();
  }
  for (const SoftParticleNumber& number : soft_particle_numbers())
    if (!spec.sizes || number.value != &SoftParticleSpec::exponent)
      spec.*number.value = read_attribute(group, number.key, limits_of(number.range));
  spec.trials = group.integer("trials");
  if (spec.trials < 1) throw IoError("attribute 'trials' is " + std::to_string(spec.trials) + "; allowed: at least 1");
  if (!group.has_attribute("placement")) return spec;
  const auto placement = parse_enum<Placement>(group.text("placement"));
  if (!placement) throw IoError("spec: unknown placement '" + group.text("placement") + "'");
  spec.placement = *placement;
  return spec;
}

void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings) {
  const h5::Group group = root.create("packings");
  write_records(group, packings);
  write_column(group, "radius_count", "1", packings, [](const auto& p) { return p.radii.size(); });
  std::vector<double> radii;
  for (const PackingInfo& p : packings) radii.insert(radii.end(), p.radii.begin(), p.radii.end());
  group.write("radii", std::span<const double>(radii));
  group.attribute_of("radii", "unit", "m");
}

std::vector<PackingInfo> read_packings(const h5::Group& root) {
  const h5::Group group = root.open("packings");
  std::vector<PackingInfo> packings(column_length(group, "seed"));
  read_records(group, packings);
  const std::vector<double> radii =
      read_numbers(group, "radii", "m", {group.doubles("radii").size()}, Limits::not_negative());
  Slices slices(radii.size());
  read_integers(group, "radius_count", packings, [&](auto& p, auto v) { p.radii = take(radii, slices, v); });
  slices.finish();
  return packings;
}

}  // namespace softgrain
