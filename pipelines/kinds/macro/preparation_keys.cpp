// Keys of how bodies are brought together: of macro scenes, materials and recipes.
#include "macrosim/preparation.h"
#include "pipelines/kinds/macro/scene.h"

namespace softgrain {

void refuse_protocol_keys(const SceneTable& t) {
  t.refuse({"inertial_number", "compaction_mu", "compaction_restitution", "coarse_share", "first_pressure",
            "preparation_tolerance", "preparation_passes"},
           "LAMMPS has a protocol of its own: goes without preparation = \"lammps\"");
}

/// A name stands for all that defines a preparation; keys beside it replace single parts, whichever table gave them.
void read_preparation(const SceneTable& t, MacroSetup& setup) {
  MacroSpec& spec = setup.spec;
  spec.preparation = t.choice<Preparation>(
      {"preparation",
       "how particles are compacted; sets those of the keys from `start_fraction` to `preparation_passes` that are not "
       "given. `\"softgrain\"`: as `\"frictionless\"`; `\"lammps\"` goes with `--engine lammps`"},
      spec.preparation);
  const bool renewed = t.has("preparation") || t.has("mu");
  const PreparationProtocol named = protocol_of(spec.preparation, spec.friction);
  spec.start_pressure = t.number({"start_pressure", "pressure at the end of the preparation, over E"}, Unit::none,
                                 Range{0.0, 1e-2, true, false}, spec.start_pressure);
  PreparationProtocol& p = spec.protocol;
  const auto follows = [&](const std::string& key) {  // from the name and mu, as nobody said it
    if (t.has(key)) setup.said.insert(key);
    return renewed && !setup.said.contains(key);
  };
  using Protocol = PreparationProtocol;
  const auto read = [&](const SceneTable& from, const Key& key, double Protocol::*part, const Range& range) {
    if (follows(key.name)) p.*part = named.*part;
    p.*part = from.number(key, Unit::none, range, p.*part);
  };
  read(t, {"start_fraction", "solid fraction at placement (`construction = \"mixed\"` only)"},
       &Protocol::start_fraction, Range::closed(0.05, 0.4));
  read(t,
       {"inertial_number",
        "strain rate of the box times d sqrt(density/pressure), with the mean diameter d; 0: no motion",
        "0; `\"fast\"`: 0.1, `\"slow\"`: 1e-3"},
       &Protocol::inertial_number, Range::closed(0.0, 1.0));
  read(t, {"compaction_mu", "friction during the preparation", "0; `\"fast\"`, `\"slow\"`: `mu`"}, &Protocol::friction,
       Range::not_negative());
  read(t, {"compaction_restitution", "coefficient of restitution during motion"}, &Protocol::restitution,
       Range::closed(0.05, 1.0));
  read(t, {"coarse_share", "volume share of the largest particles, which jam first", "1; `\"dense\"`: 0.75"},
       &Protocol::coarse_share, Range{0.0, 1.0, true, false});
  read(t, {"first_pressure", "first pressure over `start_pressure`", "128; `\"fast\"`, `\"slow\"`: 1"},
       &Protocol::first_pressure, Range::closed(1.0, 1e6));
  read(t,
       {"preparation_tolerance",
        "largest net force over mean contact force at the end; with more than 2000 particles one in 2000 may exceed "
        "it. The pressure is met to a third of this value",
        "0.03; scenes of materials: 3e-3"},
       &Protocol::tolerance, Range{0.0, 0.1, true, false});
  if (follows("preparation_passes")) p.max_passes = named.max_passes;
  p.max_passes =
      t.count({"preparation_passes", "largest number of loop passes of a relaxation"}, 10, 100000000, p.max_passes);
  if (spec.preparation == Preparation::lammps) refuse_protocol_keys(t);
  if (!(p.inertial_number > 0.0))
    t.refuse({"compaction_restitution"}, "nothing moves at inertial_number = 0: give one, or preparation = \"fast\"");
  if (spec.construction != Construction::voids) return;
  if (spec.preparation == Preparation::lammps)
    t.add_error("preparation",
                "\"lammps\" goes with construction \"mixed\": holes are filled in a packing that is compacted");
  if (p.coarse_share < 1.0)
    t.add_error(t.has("coarse_share") ? "coarse_share" : "preparation",
                "fines grow between coarse bodies of construction \"mixed\" alone");
  t.refuse({"start_fraction"}, "construction \"voids\" begins at solid_fill");
}

}  // namespace softgrain
