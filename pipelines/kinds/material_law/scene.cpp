#include "pipelines/kinds/material_law/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/packing/grading.h"
#include "macrosim/preparation.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/material_law/fines_in_cells.h"
#include "pipelines/kinds/material_law/memory_fit.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"

namespace softgrain {

namespace {

/// Fewer coarse or fine grains than this in a mixture: its onset scatters.
constexpr std::int64_t kFewGrains = 30;
/// So many have room, and some of both kinds: they are not drawn before the run.
constexpr std::int64_t kManyGrains = 1000000;
constexpr std::size_t kLeastMixtures = 3;
/// Fewer sites are their own neighbours.
constexpr std::int64_t kLeastCells = 40;

}  // namespace

MacroSetup material_law_defaults() {
  MacroSetup setup = material_defaults();
  MacroSpec& spec = setup.spec;
  spec.strain_end = 0.08;
  spec.steps = 16;
  spec.increments_per_step = 4;
  spec.preload = 0.02;
  return setup;
}

namespace {

MaterialVariant variant_of(const std::string& name, const MacroSetup& base, const Grading& sizes) {
  MaterialVariant v{name, base};
  take_sizes(v.setup.spec, sizes);
  return v;
}

std::string name_of(double share) { return fmt::format("mix-{:.6g}", 100.0 * share); }

void read_law(const SceneTable& law, MaterialLawScene& out) {
  out.split = law.number({"split", "a grain belongs to the fines below this share of the largest radius"}, Unit::none,
                         Range{0.0, 1.0, true, true}, out.split);
  out.material.equation.form = law.choice<StateForm>({"form", "form of the equation of state"}, StateForm::porosity);
  out.mixtures =
      law.numbers({"mixtures", "shares of fines in the mixtures, by solid volume; three at least, ascending"},
                  Unit::none, Range{0.0, 1.0, true, true}, {0.2, 0.4, 0.6, 0.8});
  out.material.equation.replicates = law.count({"replicates", "bootstrap replicates"}, 40, 100000, 400);
  out.cells =
      law.count({"cells", "sites of the packing of cells to which friction is fitted"}, kLeastCells, 100000, out.cells);
  if (out.mixtures.size() < kLeastMixtures)
    law.add_error("mixtures", "at least three shares are needed: w_inf and xi are fitted to them");
  for (std::size_t k = 1; k < out.mixtures.size(); ++k)
    if (!(out.mixtures[k - 1] < out.mixtures[k])) {
      law.add_error("mixtures", "shares must ascend");
      return;
    }
}

/// Other preparations of the fines, of which the card gets a factor on void ratios.
std::vector<Preparation> read_preparations(const SceneTable& law, Preparation own) {
  const Key key{"preparations",
                "other preparations whose void ratios are measured on the fines, as factors on those of the card; of "
                "these packings nothing but the onset is taken",
                "none"};
  std::vector<Preparation> out;
  if (!law.has(key.name)) return out;
  for (const std::string& word : law.texts(key)) {
    const std::vector<const char*> names = all_enum_names<Preparation>();
    const auto known = parse_enum<Preparation>(word);
    if (!known)
      law.add_error(key.name, fmt::format("\"{}\" is no preparation; {}", word,
                                          nearest_text(word, {names.begin(), names.end()},
                                                       fmt::format("known are {}", fmt::join(names, ", ")))));
    else if (*known == own)
      law.add_error(key.name, fmt::format("\"{}\" is that of [packing], whose factor is 1", word));
    else if (*known == Preparation::lammps)
      law.add_error(key.name, "\"lammps\" goes with kind = \"material\" alone");
    else if (std::ranges::find(out, *known) != out.end())
      law.add_error(key.name, fmt::format("\"{}\" stands there twice", word));
    else
      out.push_back(*known);
  }
  return out;
}

/// Strains of the tests of a law with shear memory.
struct MemoryStrains {
  double isotropic = 0.03;
  double triaxial = 0.10;
  double unload = 0.02;
};

MemoryStrains read_memory(const SceneTable& law, Preparation preparation, MaterialLawScene& out) {
  MemoryStrains s;
  out.memory = law.flag({"memory",
                         "whether cells remember shear: faces that yield gradually, onsets and strengths that "
                         "shear moves. Needed for tests that shear; measured in more tests of the fines"},
                        false);
  if (!out.memory) {
    law.refuse({"dense", "isotropic_strain", "triaxial_strain", "unload_strain"}, "goes with memory = true");
    return s;
  }
  law.refuse({"cells"}, "shear memory is fitted without cells");
  if (out.material.equation.form != StateForm::porosity) law.add_error("form", "memory = true goes with \"porosity\"");
  if (preparation == Preparation::dense) law.refuse({"dense"}, "all fines are prepared so");
  out.dense = law.flag({"dense",
                        "with `memory`: whether fines of preparation `\"dense\"` are tested too, without which "
                        "A = 1, c = 2/3 and lambda = 0 are taken"},
                       preparation != Preparation::dense);
  const Range range{0.0, 0.3, true, false};
  s.isotropic = law.number({"isotropic_strain",
                            "with `memory`: nominal strain along each axis to which all packings are "
                            "compressed"},
                           Unit::none, range, s.isotropic);
  s.triaxial =
      law.number({"triaxial_strain", "with `memory`: nominal axial strain of fines under constant lateral stress"},
                 Unit::none, range, s.triaxial);
  s.unload = law.number({"unload_strain",
                         "with `memory`: nominal strain by which fines are unloaded after oedometric "
                         "compression"},
                        Unit::none, range, s.unload);
  return s;
}

/// The same packings as the variant before, in stages.
MaterialVariant test_of(const MaterialVariant& packing, const std::string& name, std::vector<MacroStage> stages) {
  MaterialVariant v = packing;
  v.name = name;
  v.same_packings = true;
  v.packings = packing.name;
  v.setup.spec.test = MacroTest::stages;
  v.setup.spec.stages = std::move(stages);
  return v;
}

/// Fines in tests that shear memory is fitted to: `loose` ones also oedometrically.
void add_memory_tests(const MaterialVariant& packing, const MemoryStrains& strains, double shear, bool loose,
                      MaterialLawScene& out) {
  auto& variants = out.material.variants;
  const MacroSpec& spec = packing.setup.spec;
  const auto add = [&](const std::string& name, std::vector<MacroStage> stages) {
    variants.push_back(test_of(packing, packing.name + "-" + name, std::move(stages)));
    out.at.shear_tests.push_back(variants.size() - 1);
  };
  const auto triaxial = [&](std::int64_t number) {
    MacroStage stage = short_stage(spec, StageKind::triaxial, strains.triaxial, spec.steps);
    for (const std::size_t k : {0U, 1U}) stage.axis[k] = {true, 0.0, number};
    return stage;
  };
  MacroStage preload = short_stage(spec, StageKind::isotropic, spec.preload, spec.preload_steps);
  preload.record.name = "preload";
  if (loose) {
    MacroStage unload =
        short_stage(spec, StageKind::oedometric, -strains.unload, std::max<std::int64_t>(spec.steps / 2, 1));
    unload.record.name = "unload";
    unload.record.kind = StageKind::unload;
    out.at.oedometer = variants.size();
    add("oedometric", {short_stage(spec, StageKind::oedometric, spec.strain_end, spec.steps), unload});
  }
  add("triaxial", {triaxial(0)});
  add("preload-triaxial", {preload, triaxial(1)});
  add("preload-shear", {preload, short_stage(spec, StageKind::shear, shear, spec.steps)});
}

/// Another preparation by name, with the tolerance and the bound of the one that the scene gives.
void prepare_otherwise(MacroSpec& spec, Preparation preparation) {
  if (preparation == spec.preparation) return;
  const PreparationProtocol own = spec.protocol;
  spec.preparation = preparation;
  spec.protocol = protocol_of(preparation, spec.friction);
  spec.protocol.tolerance = own.tolerance;
  spec.protocol.max_passes = own.max_passes;
}

/// The same grains as the fines, prepared otherwise: recorded at the start, then hardly strained.
void add_preparations(const MacroSetup& base, const std::vector<SizePiece>& fines,
                      const std::vector<Preparation>& preparations, MaterialLawScene& out) {
  constexpr double kHardly = 1e-3;
  for (const Preparation preparation : preparations) {
    const std::string name = "fines-" + to_string(preparation);
    auto& variants = out.material.variants;
    const auto made = std::ranges::find(variants, name, &MaterialVariant::name);  // dense ones, with shear memory
    out.at.preparations.push_back(static_cast<std::size_t>(made - variants.begin()));
    if (made != variants.end()) continue;
    variants.push_back(variant_of(name, base, Grading::classes(fines)));
    MacroSpec& spec = variants.back().setup.spec;
    prepare_otherwise(spec, preparation);
    spec.test = MacroTest::isotropic;
    spec.preload = 0.0;
    spec.strain_end = kHardly;
    spec.steps = spec.increments_per_step = 1;
  }
}

/// All packings of a law with shear memory: compressed isotropically, which hardly moves onsets.
void make_memory_variants(const MacroSetup& base, const MemoryStrains& strains, double shear,
                          const std::vector<SizePiece>& fines, const std::vector<SizePiece>& coarse,
                          const std::vector<Preparation>& preparations, MaterialLawScene& out) {
  auto& variants = out.material.variants;
  MacroSetup pressed = base;
  pressed.spec.test = MacroTest::isotropic;
  pressed.spec.strain_end = strains.isotropic;
  const auto add = [&](const std::string& name, const Grading& sizes) {
    variants.push_back(variant_of(name, pressed, sizes));
    return variants.size() - 1;
  };
  const auto add_fines = [&](const std::string& name, Preparation preparation, bool loose) {
    const std::size_t at = add(name, Grading::classes(fines));
    MaterialVariant& v = variants[at];
    prepare_otherwise(v.setup.spec, preparation);
    MaterialVariant tested = v;
    tested.setup.spec.strain_end = base.spec.strain_end;
    add_memory_tests(tested, strains, shear, loose, out);
    return at;
  };
  out.at.fines = out.at.sheared_fines = add_fines("fines", base.spec.preparation, true);
  if (out.dense) (void)add_fines("fines-dense", Preparation::dense, false);
  add_preparations(base, fines, preparations, out);
  out.at.coarse = add("coarse", Grading::classes(coarse));
  out.at.first_mixture = variants.size();
  for (const double share : out.mixtures) add(name_of(share), mixture_of(coarse, fines, share));
}

/// All packings that are measured, from the grains of the whole material.
void make_variants(const SceneTable& law, const MacroSetup& base, double shear_strain, const MemoryStrains& strains,
                   const std::vector<Preparation>& preparations, MaterialLawScene& out) {
  const double cut = out.split * out.sizes.largest();
  const std::vector<SizePiece> fines = pieces_between(out.sizes, 0.0, cut);
  const std::vector<SizePiece> coarse = pieces_between(out.sizes, cut, kInfinity);
  if (fines.empty())
    law.throw_error("split", fmt::format("no grain is fine: the smallest radius is {:.3g} of the largest",
                                         out.sizes.smallest() / out.sizes.largest()));
  if (out.memory) return make_memory_variants(base, strains, shear_strain, fines, coarse, preparations, out);
  MacroSetup still = base;  // what other tests than shear do before is nothing
  still.spec.preload = 0.0;
  auto& variants = out.material.variants;
  variants.push_back(variant_of("fines", still, Grading::classes(fines)));
  variants.push_back(variant_of("fines-shear", base, Grading::classes(fines)));
  variants.back().same_packings = true;
  variants.back().setup.spec.test = MacroTest::shear;
  variants.back().setup.spec.strain_end = shear_strain;
  add_preparations(base, fines, preparations, out);
  out.at.coarse = variants.size();
  variants.push_back(variant_of("coarse", still, Grading::classes(coarse)));
  out.at.first_mixture = variants.size();
  for (const double share : out.mixtures)
    variants.push_back(variant_of(name_of(share), still, mixture_of(coarse, fines, share)));
}

/// Mixtures need grains of both kinds, and all packings more than a few grains.
void require_grains(const SceneTable& law, const SceneTable& grains, const MaterialLawScene& scene) {
  for (const MaterialVariant& v : scene.material.variants) {
    if (v.setup.spec.bodies > kManyGrains) continue;
    const std::string problem = room_problem(v.setup, scene.material.seed, "grains");
    if (!problem.empty()) grains.throw_error("count", fmt::format("packing {}: {} ([grains] count)", v.name, problem));
    if (&v - scene.material.variants.data() < static_cast<std::ptrdiff_t>(scene.at.first_mixture)) continue;
    const GrainShares shares = shares_of(scene, v, scene.material.seed, 0);
    if (shares.coarse == 0 || shares.fines == 0)
      law.throw_error("mixtures",
                      fmt::format("{}: none of {} grains is {}: more grains ([grains] count), or another share", v.name,
                                  v.setup.spec.bodies, shares.coarse == 0 ? "coarse" : "fine"));
  }
}

}  // namespace

GrainShares shares_of(const MaterialLawScene& scene, const MaterialVariant& variant, std::uint64_t seed,
                      std::uint64_t sample) {
  GrainShares out;
  const double cut = scene.split * scene.sizes.largest();
  for (const MacroBody& b : drawn_bodies(variant.setup.spec, seed, sample)) {
    const bool fine = b.r < cut;
    ++(fine ? out.fines : out.coarse);
    (fine ? out.fines_volume : out.coarse_volume) += kSphereVolume * b.r * b.r * b.r;
  }
  return out;
}

MaterialLawScene read_material_law_scene(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.choice(kKindKey, {"material-law"});
    MaterialLawScene out{{}, Grading::power_law(3.5, 1.0, 2.0), 1.0 / 3.0, {}};
    out.material.title = root.title();
    out.material.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
    MacroSetup base = material_law_defaults();
    (void)read_material_tables(root, base);
    root.table_or_empty("packing").refuse(kDensityKeys,
                                          "the packings that are measured differ in density, by their sizes: give "
                                          "preparation or compaction_mu; a target goes with kind = \"material\"");
    const SceneTable test = root.table_or_empty("test");
    if (base.spec.test != MacroTest::oedometric)
      test.add_error("test", "the law is measured in oedometric compression (and the fines in shear)");
    base.samples = root.count({"samples", "samples of each measured packing that are drawn, prepared and tested"}, 1,
                              10000, base.samples);
    base.kept_states = read_kept_states(root);
    const SceneTable law = root.table_or_empty({"law", "measurement and fit of the cell law"});
    read_law(law, out);
    const double shear =
        law.number({"shear_strain", "logarithmic strain to which the fines are sheared at constant volume"}, Unit::none,
                   Range{0.0, 0.5, true, false}, 0.06);
    const MemoryStrains strains = read_memory(law, base.spec.preparation, out);
    const std::vector<Preparation> preparations = read_preparations(law, base.spec.preparation);
    if (root.has_errors()) return out;
    out.sizes = sizes_of(base.spec);
    make_variants(law, base, shear, strains, preparations, out);
    require_material_memory(root.table("grains"), base);
    require_grains(law, root.table("grains"), out);
    return out;
  });
}

void check_material_law(const MaterialLawScene& law, Findings& out) {
  check_variants(law.material, out);
  for (std::size_t k = law.at.first_mixture; k < law.material.variants.size(); ++k) {
    const MaterialVariant& v = law.material.variants[k];
    const GrainShares shares = shares_of(law, v, law.material.seed, 0);
    out.lines += fmt::format("  {}: {} coarse and {} fine grains\n", v.name, shares.coarse, shares.fines);
    if (std::min(shares.coarse, shares.fines) < kFewGrains)
      out.warn(fmt::format("{}: only {} grains are {}: its onset will scatter, and w_inf and xi with it", v.name,
                           std::min(shares.coarse, shares.fines), shares.coarse < shares.fines ? "coarse" : "fine"));
  }
  if (law.material.variants.front().setup.samples < 2) out.warn("one sample: the law will have no errors");
  if (law.memory)
    out.spend("shear memory", memory_fit_seconds(law));
  else
    out.spend("friction of cells", friction_seconds(law.cells));
}

}  // namespace softgrain
