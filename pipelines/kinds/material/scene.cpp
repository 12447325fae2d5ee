// Reads scenes of kind "material", and says what follows from them: softgrain check.
#include "pipelines/kinds/material/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "common/contact/rolling_scene.h"
#include "common/core/cost.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "common/packing/grading_scene.h"
#include "macrosim/preparation.h"
#include "macrosim/test_protocol.h"
#include "microsim/particles/scene_memory.h"
#include "pipelines/kinds/macro/check.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

namespace {

/// A third: what counts as coarse in most pages about mixtures; a half beside it.
const std::vector<double> kSplits{1.0 / 3.0, 0.5};

const Key kSamplesKey{"samples", "number of packings that are drawn, prepared and tested"};

}  // namespace

MacroSetup material_defaults() {
  MacroSetup setup;
  setup.twins.clear();
  MacroSpec& spec = setup.spec;
  spec.boundary = Boundary::periodic;
  spec.soft_share = 0.0;
  spec.bodies = 2000;
  spec.solid_polydispersity = 6.0;
  spec.splits = kSplits;
  spec.start_pressure = 1e-4;
  return setup;
}

namespace {

void read_matter(const SceneTable& t, MacroSpec& spec) {
  spec.youngs_modulus =
      t.number({"E", "Young's modulus of the grains"}, Unit::pressure, Range::positive(), spec.youngs_modulus);
  spec.poisson_ratio = t.number({"nu", "Poisson's ratio of the grains"}, Unit::none, kPoissonRange, spec.poisson_ratio);
  spec.friction = t.number({"mu", "friction coefficient of the grains"}, Unit::none, Range::friction(), spec.friction);
  read_rolling_resistance(t, spec.friction, spec.rolling);
  spec.density = t.number({"density", "density of the grains"}, Unit::density, Range::positive(), spec.density);
}

void read_grains(const SceneTable& t, MacroSpec& spec) {
  spec.bodies = t.count({"count",
                         "grains in each packing; a recipe raises the default where a periodic cell needs more "
                         "(`check` and the run say so)"},
                        8, 100000000, spec.bodies);
  if (t.has("exponent") || t.has("radius_max") || t.has("ratio")) spec.solid_sizes.reset();
  spec.exponent = t.number({"exponent", "power law of sizes: b of the number density P(r) ~ r^-b"}, Unit::none,
                           kSizeExponents, spec.exponent);
  spec.solid_radius_max =
      t.number({"radius_max", "largest radius"}, Unit::length, Range::positive(), spec.solid_radius_max);
  spec.solid_polydispersity =
      t.number({"ratio", "span: largest over smallest radius"}, Unit::none, kSizeRatios, spec.solid_polydispersity);
  if (!t.has("sizes")) return;
  spec.solid_sizes.reset();
  if (const auto sizes =
          read_sizes(t, {"sizes", "any other size distribution, instead of `exponent`, `radius_max` and `ratio`"},
                     {"exponent", "radius_max", "ratio"}))
    take_sizes(spec, *sizes);
}

void read_splits(const SceneTable& t, MacroSpec& spec) {
  spec.splits = t.numbers({"splits",
                           "a grain is coarse above this share of the largest radius; for each split, the stress on "
                           "coarse and fine grains is recorded"},
                          Unit::none, Range{0.0, 1.0, true, true}, spec.splits);
  std::set<double> once(spec.splits.begin(), spec.splits.end());
  if (once.size() != spec.splits.size()) t.add_error("splits", "one is there twice");
  if (spec.splits.empty()) t.add_error("splits", "at least one value is needed");
}

/// Preparations of materials end at a finer tolerance: at 0.03 the curve after one starts too soft.
constexpr double kPreparationTolerance = 3e-3;

void read_finer_preparation(const SceneTable& t, MacroSetup& setup) {
  read_preparation(t, setup);
  if (!setup.said.contains("preparation_tolerance")) setup.spec.protocol.tolerance = kPreparationTolerance;
}

void require_own_preparation(const SceneTable& t, const MacroSpec& spec) {
  if (spec.preparation == Preparation::lammps && !spec.grain_materials.empty())
    t.add_error("preparation",
                "\"lammps\" compacts grains of one E, nu and mu: constituents with their own go without");
}

}  // namespace

bool read_material_tables(const SceneTable& root, MacroSetup& setup, std::vector<Constituent>* constituents) {
  MacroSpec& spec = setup.spec;
  const SceneTable material = root.table_or_empty({"material", "elasticity, friction and density of the grains"});
  read_matter(material, spec);
  bool modulus_is_known = !material.has_errors();
  const SceneTable grains =
      root.table({"grains", "sizes of all grains of the material, and their number in each packing"});
  read_grains(grains, spec);
  if (constituents != nullptr) {
    *constituents = read_constituents(root, spec);
    refuse_idle_material(root);
    if (!constituents->empty())
      grains.refuse({"sizes", "exponent", "radius_max", "ratio"},
                    "goes without [[constituent]], which have sizes of their own");
    if (root.has("constituent")) modulus_is_known = !root.has_errors();
    if (!root.has_errors()) take_materials(root, *constituents, spec);
  }
  spec.protocol = protocol_of(spec.preparation, spec.friction);
  const SceneTable packing = root.table_or_empty({"packing", "preparation of the packings"});
  constexpr double kAnyPressure = 1e13;  // [Pa]: where E was refused no pressure of this world is out of range
  if (!modulus_is_known && packing.is_text("start_pressure")) spec.youngs_modulus = kAnyPressure;
  read_finer_preparation(packing, setup);
  require_own_preparation(packing, spec);
  read_test(root.table_or_empty({"test", "test of the prepared packings"}), spec);
  return modulus_is_known;
}

Grading sizes_of(const MacroSpec& spec) {
  if (spec.solid_sizes) return *spec.solid_sizes;
  return Grading::power_law(spec.exponent, spec.solid_radius_max / spec.solid_polydispersity, spec.solid_radius_max);
}

void take_sizes(MacroSpec& spec, const Grading& sizes) {
  spec.solid_sizes = sizes;
  spec.solid_radius_max = sizes.largest();
  spec.solid_polydispersity = sizes.largest() / sizes.smallest();
}

std::optional<double> exponent_of(const MacroSpec& spec) { return sizes_of(spec).exponent(); }

void require_material_memory(const SceneTable& grains, const MacroSetup& setup) {
  const std::string problem = macro_memory_problem(setup, 0.0, available_memory());
  if (!problem.empty()) grains.throw_error("count", problem);
}

namespace {

/// The tables [[loading]]: tests of every variant. Their keys are read over those of each, once all are found valid.
class Loadings {
 public:
  Loadings(const SceneTable& root, const MacroSpec& base)
      : tables_(root.tables({"loading",
                             "one of several tests of the same packings: the keys of `[test]` that differ, and "
                             "`[[loading.stage]]` for stages"})) {
    if (tables_.empty()) return;
    if (!root.tables("stage").empty())
      root.add_error("stage", "goes without [[loading]]: give [[loading.stage]], or a loading of its own");
    for (const SceneTable& t : tables_) {
      MacroSpec spec = base;
      t.section([&] { read(t, spec, false); });
      names_.push_back(t.text("name", ""));
      if (std::count(names_.begin(), names_.end(), names_.back()) > 1) t.add_error("name", "is used twice");
    }
  }

  [[nodiscard]] bool empty() const { return tables_.empty(); }

  /// Requires stresses of the loadings of these numbers to be below E of `base`.
  void require_below_modulus(const MacroSpec& base, const std::vector<std::size_t>& numbers) const {
    for (const std::size_t k : numbers) {
      MacroSpec spec = base;
      tables_[k].section([&] { read(tables_[k], spec, true); });
    }
  }

  /// Their numbers.
  [[nodiscard]] std::vector<std::size_t> all() const {
    std::vector<std::size_t> numbers(tables_.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
  }

  /// Refuses keys of tests in the tables of loadings, of the variant that they load, and of the scene that none takes.
  void refuse_idle(const SceneTable& root, const std::vector<SceneTable>& variants,
                   const std::vector<std::vector<std::size_t>>& under, const std::vector<MaterialVariant>& all) const {
    std::vector<const MacroSpec*> tests;
    for (const MaterialVariant& v : all) tests.push_back(&v.setup.spec);
    const SceneTable test = root.table_or_empty("test");
    if (!tests.empty()) refuse_idle_test_keys(test, root, tests);
    for (std::size_t k = 0; k < tables_.size(); ++k) {
      tests.clear();
      for (const MaterialVariant& v : all)
        if (v.loading == names_[k]) tests.push_back(&v.setup.spec);
      if (tests.empty())
        tables_[k].add_error("name", "no variant is tested under it: key loadings of a variant says which are");
      else
        refuse_idle_test_keys(tables_[k], tables_[k], tests);
    }
    if (!empty()) refuse_said_twice(variants, under);
    if (empty() && all.size() == variants.size())
      for (std::size_t v = 0; v < variants.size(); ++v)
        refuse_idle_test_keys(variants[v], variants[v].has("stage") ? variants[v] : root, {&all[v].setup.spec});
  }

  /// Numbers of the loadings that a variant is tested under.
  [[nodiscard]] std::vector<std::size_t> of_variant(const SceneTable& t) const {
    if (!empty()) {
      t.refuse({"test", "strain", "preload", "preload_steps", "stage"},
               "goes without [[loading]], which says what is tested");
    }
    if (!t.has("loadings")) return all();
    std::vector<std::size_t> some;
    for (const std::string& name :
         t.texts({"loadings", "names of the loadings under which a variant is tested", "all"})) {
      const auto found = std::find(names_.begin(), names_.end(), name);
      const auto number = static_cast<std::size_t>(found - names_.begin());
      const std::string near = nearest_word(name, names_);
      if (found == names_.end())
        t.add_error("loadings",
                    fmt::format("no [[loading]] '{}'{}", name, near.empty() ? "" : "; nearest is '" + near + "'"));
      else if (std::count(some.begin(), some.end(), number) > 0)
        t.add_error("loadings", fmt::format("'{}' is there twice", name));
      else
        some.push_back(number);
    }
    if (some.empty()) t.add_error("loadings", "at least one is needed");
    return some;
  }

  /// One variant for each, all with the same packings. `plain`: the scene has no variants, names are those of loadings.
  [[nodiscard]] std::vector<MaterialVariant> apply(const MaterialVariant& v, const std::vector<std::size_t>& numbers,
                                                   bool plain) const {
    std::vector<MaterialVariant> out;
    for (const std::size_t k : numbers) {
      MaterialVariant one{plain ? names_[k] : v.name + "-" + names_[k], v.setup, !out.empty(), v.name, names_[k]};
      read(tables_[k], one.setup.spec, true);
      out.push_back(std::move(one));
    }
    return out;
  }

 private:
  /// What a variant says of its tests, and each of its loadings again.
  void refuse_said_twice(const std::vector<SceneTable>& variants,
                         const std::vector<std::vector<std::size_t>>& under) const {
    for (std::size_t v = 0; v < variants.size(); ++v)
      for (const char* key :
           {"steps", "increments_per_step", "tolerance", "force_floor", "max_passes", "modulus_stress"})
        if (variants[v].has(key) &&
            std::all_of(under[v].begin(), under[v].end(), [&](std::size_t k) { return says_in_test(tables_[k], key); }))
          variants[v].add_error(key, "each [[loading]] of this variant gives its own");
  }

  static void read(const SceneTable& t, MacroSpec& spec, bool modulus_is_known) {
    (void)read_variant_name(t);
    read_test(t, spec);
    read_stages(t, t, spec, modulus_is_known);
  }

  std::vector<SceneTable> tables_;
  std::vector<std::string> names_;
};

void read_density_target(const SceneTable& t, MacroSetup& setup, bool densities) {
  if (densities)
    read_density(t, setup);
  else
    t.refuse(kDensityKeys,
             "models are prepared as the material is, by its preparation and compaction_mu: a target "
             "goes with kind = \"material\", which says the compaction_mu that meets it");
}

/// What the tables of the scene say, which its variants read over.
struct CommonTables {
  MacroSetup setup;
  bool modulus_is_known = false;  ///< see read_stages()
  bool valid = false;             ///< nothing was found wrong in them
};

struct VariantRead {
  MaterialVariant variant;
  bool modulus_is_known = false;  ///< see read_stages()
};

/// Keys of all tables of the scene, in one.
VariantRead read_variant(const SceneTable& root, const SceneTable& t, const CommonTables& common, bool alone) {
  MaterialVariant v{read_variant_name(t), common.setup};
  MacroSpec& spec = v.setup.spec;
  if (alone && !root.tables("constituent").empty())
    t.refuse({"sizes", "exponent", "radius_max", "ratio"},
             "goes without [[constituent]], which have sizes of their own");
  if (!spec.grain_materials.empty())
    t.refuse({"E", "nu", "mu", "density"}, "every [[constituent]] has its own, in all variants");
  read_matter(t, spec);
  const bool modulus_is_known = common.modulus_is_known && !t.has_errors();
  read_grains(t, spec);
  read_finer_preparation(t, v.setup);
  require_own_preparation(t, spec);
  read_density_target(t, v.setup, alone);
  require_density(t, v.setup);
  read_test(t, spec);
  read_part_stages(root, t, spec, modulus_is_known);
  v.setup.samples = t.count(kSamplesKey, 1, 10000, v.setup.samples);
  if (common.valid && !t.has_errors()) require_material_memory(t, v.setup);
  return {std::move(v), modulus_is_known};
}

/// Requires room in all variants from `first` on, which are the loadings of the same packings.
void require_room(const SceneTable& t, const MaterialScene& scene, std::size_t first) {
  for (std::size_t k = first; k < scene.variants.size(); ++k) {
    const std::string problem = room_problem(scene.variants[k].setup, scene.seed, "grains");
    if (problem.empty()) continue;
    t.add_error("count", problem + " ([grains] count)");
    return;  // the others have the same grains
  }
}

/// "a-b" under "c" and "a" under "b-c" would be one file; material_initial.h5 is that of the packings.
void require_names_apart(const SceneTable& root, const std::vector<MaterialVariant>& variants) {
  std::set<std::string> names;
  for (const MaterialVariant& v : variants) {
    const char* const what = v.loading.empty() ? "variant" : "loading";
    if (!v.loading.empty() && !names.insert(v.name).second)
      root.add_error(what, fmt::format("'{}' would be the name of two results", v.name));
    if (v.name == "initial" || v.name.starts_with("initial_"))
      root.add_error(what, fmt::format("'{}': files of packings begin with \"initial\": give another name", v.name));
  }
}

/// Between packings of one span nothing is extrapolated, unless another span is asked for.
void refuse_idle_span(const SceneTable& equation, const MaterialScene& scene) {
  if (!equation.has("largest_span") || !scene.equation.spans.empty()) return;
  const auto span = [](const MaterialVariant& v) { return v.setup.spec.solid_polydispersity; };
  for (const MaterialVariant& v : scene.variants)
    if (span(v) != span(scene.variants.front())) return;
  equation.add_error("largest_span",
                     "nothing is extrapolated: all packings have one span, and `spans` asks for no other");
}

/// An onset measured elsewhere is that of one material, and for extrapolations alone.
void refuse_idle_onsets(const SceneTable& equation, const MaterialScene& scene) {
  if (scene.equation.onsets.empty()) return;
  if (scene.equation.spans.empty()) equation.add_error("onset", "nothing is extrapolated: `spans` asks for no span");
  std::set<std::string> families;
  for (const MaterialVariant& v : scene.variants) families.insert(material_family(v, scene.variants));
  if (families.size() > 1)
    equation.add_error("onset",
                       fmt::format("is that of one material, but variants of {} differ in more than their span: {}",
                                   families.size(), fmt::join(families, "; ")));
}

}  // namespace

MaterialScene read_material(const SceneTable& root, bool alone) {
  MaterialScene out;
  out.title = root.title();
  out.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
  MacroSetup base = material_defaults();
  std::vector<Constituent> constituents;
  const bool modulus_is_known = read_material_tables(root, base, alone ? &constituents : nullptr);
  const SceneTable grains = root.table("grains");
  if (!constituents.empty() && !root.has_errors()) {
    take_sizes(base.spec, mixed_sizes(constituents));
    if (base.spec.grain_materials.empty()) base.spec.density = mean_density(constituents);
  }
  const SceneTable packing = root.table_or_empty("packing");
  read_density_target(packing, base, alone);
  read_splits(grains, base.spec);
  read_stages(root, root.table_or_empty("test"), base.spec, false);
  base.samples = root.count(kSamplesKey, 1, 10000, base.samples);
  base.kept_states = read_kept_states(root);
  const SceneTable equation = root.table_or_empty(
      {"equation", "equation of state (pressure over solid fraction), fitted to all variants together"});
  out.equation = read_equation(equation);
  out.equation.asked = root.has("equation");
  const Loadings loadings(root, base.spec);
  std::set<std::string> names;
  const CommonTables common{base, modulus_is_known, !root.has_errors()};
  const auto add = [&](const MaterialVariant& v, const std::vector<std::size_t>& under, bool plain) {
    if (loadings.empty()) return out.variants.push_back(v);
    if (root.has_errors()) return;  // nothing comes of it
    for (MaterialVariant& one : loadings.apply(v, under, plain)) out.variants.push_back(std::move(one));
  };
  const std::vector<SceneTable> variants =
      root.tables({"variant",
                   "another material, preparation or test: the keys of the other tables that differ, without their "
                   "table names, and `[[variant.stage]]` for its stages"});
  std::vector<std::vector<std::size_t>> under;
  for (const SceneTable& t : variants) {
    const VariantRead read = read_variant(root, t, common, alone);
    const MaterialVariant& v = read.variant;
    if (!names.insert(v.name).second) t.add_error("name", "is used twice");
    const std::size_t first = out.variants.size();
    under.push_back(loadings.of_variant(t));
    if (read.modulus_is_known) loadings.require_below_modulus(v.setup.spec, under.back());
    add(v, under.back(), false);
    if (!root.has_errors()) require_room(t, out, first);
  }
  if (variants.empty()) {
    if (modulus_is_known) {  // that of all packings
      read_stages(root, root.table_or_empty("test"), base.spec, true);
      loadings.require_below_modulus(base.spec, loadings.all());
    }
    require_density(packing, base);
    if (!root.has_errors()) require_material_memory(grains, base);
    add({kMaterialEngine, base}, loadings.all(), true);
    if (!root.has_errors()) require_room(grains, out, 0);
  }
  if (!root.has_errors()) loadings.refuse_idle(root, variants, under, out.variants);
  refuse_idle_stages(root, "variant", variants);
  const auto by_lammps = [](const MaterialVariant& v) { return v.setup.spec.preparation == Preparation::lammps; };
  if (!out.variants.empty() && std::all_of(out.variants.begin(), out.variants.end(), by_lammps))
    refuse_protocol_keys(root.table_or_empty("packing"));
  if (!root.has_errors()) refuse_idle_span(equation, out);
  if (!root.has_errors()) refuse_idle_onsets(equation, out);
  require_names_apart(root, out.variants);
  return out;
}

MaterialScene read_material_scene(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.choice(kKindKey, {"material"});
    return read_material(root, true);
  });
}

void check_variants(const MaterialScene& material, Findings& out, bool timed) {
  constexpr double kMoment = 10.0;  // of trials; what is left then is taken to be like what was tried
  const Stopwatch watch;
  double bodies = 0.0;
  double untried = 0.0;
  nlohmann::json variants = nlohmann::json::array();
  for (const MaterialVariant& v : material.variants) {
    const nlohmann::json common = std::exchange(out.facts, nlohmann::json{{"name", v.name}});
    if (material.variants.size() > 1) out.lines += "  variant " + v.name + ":\n";
    if (!v.same_packings) add_sizes(out, drawn_sizes(v.setup, material.seed));
    const bool trial = timed && watch.seconds() < kMoment;
    (trial ? bodies : untried) += static_cast<double>(v.setup.spec.bodies * v.setup.samples);
    check_macro(v.setup, {.prepared = v.same_packings, .untimed = !trial}, nullptr, material.seed, out);
    if (const std::string doubt = room_doubt(v.setup, material.seed, "grains"); !doubt.empty())
      out.warn((v.name == kMaterialEngine ? "" : v.name + ": ") + doubt + " ([grains] count)");
    constexpr double kCoarse = 100.0;  // above a third of the largest radius
    double coarse = 0.0;
    for (const MacroBody& b : drawn_bodies(v.setup.spec, material.seed, 0))
      coarse += b.r > v.setup.spec.solid_radius_max / 3.0 ? 1.0 : 0.0;
    if (coarse < kCoarse && !v.same_packings)
      out.warn(
          fmt::format("{}: {:.0f} grains above a third of the largest radius are few: stresses of samples will "
                      "scatter by more than 5 %",
                      v.packings.empty() ? v.name : v.packings, coarse));
    variants.push_back(std::exchange(out.facts, common));
  }
  out.facts["variants"] = variants;
  if (timed && untried > 0.0 && bodies > 0.0) out.spend("variants that were not tried", out.spent() * untried / bodies);
}

}  // namespace softgrain
