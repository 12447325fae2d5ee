#include "pipelines/kinds/macro/stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/core/text.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

namespace {

constexpr const char* kCycles = "cycles";
constexpr double kLargestStrain = 0.5;

const Key kNameKey{"name", "name of the stage in the results", "the kind, numbered; `\"cycles\"`: \"cycle\""};
const Key kStressKey{"stress",
                     "stress at the end of the stage; in `\"consolidation\"` one number or three, `[x, y, z]`"};

bool goes_a_way(StageKind kind) {
  return kind != StageKind::unload && kind != StageKind::reload && kind != StageKind::hold;
}

std::string quoted(StageKind kind) { return fmt::format("kind = \"{}\"", to_string(kind)); }

/// One table [[stage]] after the other.
class StageReader {
 public:
  StageReader(const MacroSpec& spec, std::vector<MacroStage>& stages) : spec_(spec), stages_(stages) {}

  void read(const SceneTable& t) {
    std::vector<const char*> kinds = all_enum_names<StageKind>();
    kinds.push_back(kCycles);
    const std::string word =
        t.choice({"kind", "kind of the stage: which axes go by strain, or to a stress, and how"}, kinds);
    if (word == kCycles) return read_cycles(t);
    const StageKind kind = *parse_enum<StageKind>(word);
    refuse_foreign_keys(t, word);
    stages_.push_back(begin(t, kind));
    stages_.back().record.name = name_of(t, word);
    switch (kind) {
      case StageKind::unload:
        return unload(t);
      case StageKind::reload:
        return reload(t);
      case StageKind::hold:
        return hold(t);
      default:
        return drive(t, stages_.back().record.way, 1.0);
    }
  }

 private:
  MacroStage begin(const SceneTable& t, StageKind kind) {
    const bool hold = kind == StageKind::hold;
    MacroStage stage;
    stage.record.kind = kind;
    stage.record.way = goes_a_way(kind) ? kind : way_before(t, kind);
    stage.steps = t.count({"steps", "recorded points of the stage", "that of the whole test; `\"hold\"`: 1"}, 1, 100000,
                          hold ? 1 : spec_.steps);
    stage.increments_per_step =
        t.count({"increments_per_step", "increments per recorded point", "that of the whole test; `\"hold\"`: 1"}, 1,
                10000, hold ? 1 : spec_.increments_per_step);
    stage.tolerance =
        t.number({"tolerance",
                  "equilibrium: largest net force over the mean contact force; controlled stresses are met to a third "
                  "of `tolerance` times the largest target stress",
                  "that of the whole test; `\"hold\"`: a tenth of it"},
                 Unit::none, Range{0.0, 1.0, true, false}, hold ? 0.1 * spec_.tolerance : spec_.tolerance);
    if (hold) t.refuse({"modulus_stress"}, "nothing is driven while all is held: there is no modulus");
    if (!hold) stage.record.modulus_stress = spec_.modulus_stress;
    read_modulus_stress(t, stage.record.modulus_stress);
    return stage;
  }

  /// The kind of the last stage that goes a way of its own.
  StageKind way_before(const SceneTable& t, StageKind kind) const {
    for (auto s = stages_.rbegin(); s != stages_.rend(); ++s)
      if (goes_a_way(s->record.kind)) return s->record.kind;
    t.add_error("kind", kind == StageKind::hold
                            ? "a hold keeps what the stage before it left, and none is before it: the preparation has "
                              "brought the packing to rest already, so leave it out or put it behind another stage"
                            : "there is no stage before it whose way it could go");
    return StageKind::oedometric;
  }

  static std::string given_name(const SceneTable& t, const char* usual) { return t.line_text(kNameKey, usual); }

  /// Results of stages are known by their names.
  [[nodiscard]] bool is_taken(const std::string& name) const {
    return std::any_of(stages_.begin(), stages_.end(), [&](const MacroStage& s) { return s.record.name == name; });
  }

  std::string name_of(const SceneTable& t, const std::string& word) const {
    if (const std::string name = given_name(t, ""); !name.empty()) {
      if (is_taken(name)) t.add_error("name", fmt::format("a stage before it is called '{}' too", name));
      return name;
    }
    const auto same = [&](const MacroStage& s) {
      return s.record.name == word || s.record.name.starts_with(word + " ");
    };
    auto number = std::count_if(stages_.begin(), stages_.end() - 1, same) + 1;
    const auto numbered = [&] { return number == 1 ? word : fmt::format("{} {}", word, number); };
    while (is_taken(numbered())) ++number;
    return numbered();
  }

  static void refuse_foreign_keys(const SceneTable& t, const std::string& word) {
    const auto is = [&](StageKind kind) { return word == to_string(kind); };
    if (!is(StageKind::triaxial)) t.refuse({"lateral_stress"}, "goes with " + quoted(StageKind::triaxial));
    if (!is(StageKind::direct_shear)) t.refuse({"normal_stress"}, "goes with " + quoted(StageKind::direct_shear));
    if (!is(StageKind::axes))
      t.refuse({"strain_x", "strain_y", "strain_z", "stress_x", "stress_y", "stress_z"},
               "goes with " + quoted(StageKind::axes));
    if (!is(StageKind::hold)) t.refuse({"by"}, "goes with " + quoted(StageKind::hold));
    if (word != kCycles) t.refuse({"count"}, "goes with kind = \"cycles\"");
    if (is(StageKind::axes) || is(StageKind::hold))
      t.refuse({"strain", "stress"},
               is(StageKind::hold) ? "nothing is driven while all is held" : "give strain_x or stress_x, and so on");
  }

  [[nodiscard]] std::int64_t here() const { return static_cast<std::int64_t>(stages_.size()) - 1; }

  /// Less is lost in the rounding of the box.
  static void require_strain(const SceneTable& t, const std::string& key, double strain) {
    if (strain != 0.0 && std::abs(strain) < kLeastStrain)
      t.add_error(key, fmt::format("must be at least {:g} in size, either sign", kLeastStrain));
  }

  static double read_strain(const SceneTable& t, bool back) {
    const Range range =
        back ? Range::closed(kLeastStrain, kLargestStrain) : Range::closed(-kLargestStrain, kLargestStrain);
    const double strain =
        t.number({"strain",
                  "nominal strain from the start of the stage (`\"shear\"`, `\"undrained\"`: logarithmic; "
                  "`\"simple-shear\"`, `\"direct-shear\"`: shear strain); negative values lengthen the box. In "
                  "`\"unload\"`, `\"reload\"` and `\"cycles\"`: amount of strain, above 0"},
                 Unit::none, range);
    if (strain == 0.0)
      t.add_error("strain", "must not be 0: kind = \"hold\" keeps the box as it is");
    else
      require_strain(t, "strain", strain);
    return strain;
  }

  /// Axes in the order x, y, z; a single number is that of all.
  static Vec3 read_stresses(const SceneTable& t) {
    if (!t.is_list("stress")) {
      const double stress = t.number(kStressKey, Unit::pressure, Range::positive());
      return {{stress, stress, stress}};
    }
    const Vec3 stress = t.vector3(kStressKey, Unit::pressure);
    for (int k = 0; k < 3; ++k)
      if (!(stress[k] > 0.0)) t.add_error("stress", "must be above 0 along all axes: grains cannot be pulled");
    return stress;
  }

  /// Sets the axes of the last stage for a way; `sign` -1: its strain, an amount, is taken the other way round.
  void drive(const SceneTable& t, StageKind way, double sign) {
    MacroStage& stage = stages_.back();
    if (way == StageKind::axes) return read_axes(t, stage);
    if (way == StageKind::consolidation) {
      t.refuse({"strain"}, "a consolidation goes to a stress, and so does a stage that unloads or repeats it");
      return by_stress(stage, way, read_stresses(t));
    }
    const bool strain = t.has("strain");
    const bool stress = t.has("stress");
    if (strain == stress) {
      t.add_error(strain ? "stress" : "strain",
                  strain ? "contradicts strain: give one of both" : "missing; give strain or stress");
      return;
    }
    if (stress && (way == StageKind::shear || way == StageKind::undrained || slides(way))) {
      t.add_error("stress", way == StageKind::direct_shear
                                ? "direct shear goes by strain; normal_stress is the stress along z that it holds"
                                : "shear at constant volume goes by strain");
      return;
    }
    if (stress) {
      const double value = t.number(kStressKey, Unit::pressure, Range::positive());
      by_stress(stage, way, {{value, value, value}});
    } else {
      drive_by_strain(stage, way, sign * read_strain(t, stage.record.kind != stage.record.way));
      stage.isotropic = way == StageKind::isotropic;
    }
    if (way == StageKind::triaxial) hold_sides(t, stage);
    if (way == StageKind::direct_shear) hold_normal_stress(t, stage);
    if (slides(way)) require_sliding(t, "kind", spec_);
  }

  static void by_stress(MacroStage& stage, StageKind way, const Vec3& stress) {
    const bool all = way == StageKind::isotropic || way == StageKind::consolidation;
    for (int k = all ? 0 : 2; k < 3; ++k) stage.axis[static_cast<std::size_t>(k)] = {true, stress[k], -1};
    stage.isotropic = way == StageKind::isotropic;
  }

  /// Holds the lateral stresses at their values at the start of the stage, or takes them to `lateral_stress` where it
  /// is given.
  void hold_sides(const SceneTable& t, MacroStage& stage) const {
    const bool given = t.has("lateral_stress");
    const double stress = given ? t.number({"lateral_stress", "of `\"triaxial\"`: stress along x and y",
                                            "the lateral stress when the stage begins"},
                                           Unit::pressure, Range::positive())
                                : 0.0;
    for (const std::size_t k : {0U, 1U}) stage.axis[k] = {true, stress, given ? -1 : here()};
  }

  /// Holds the stress along z at its value at the start of the stage, or takes it to `normal_stress` where that is
  /// given.
  void hold_normal_stress(const SceneTable& t, MacroStage& stage) const {
    const bool given = t.has("normal_stress");
    const double stress = given ? t.number({"normal_stress", "of `\"direct-shear\"`: stress along z",
                                            "the stress along z when the stage begins"},
                                           Unit::pressure, Range::positive())
                                : 0.0;
    stage.axis[2] = {true, stress, given ? -1 : here()};
  }

  static void read_axes(const SceneTable& t, MacroStage& stage) {
    bool any = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      const Key strain{"strain_" + axis,
                       "of `\"axes\"`: strain along " + axis + ", where this axis is strain-controlled"};
      const Key stress{"stress_" + axis,
                       "of `\"axes\"`: final stress along " + axis + ", where this axis is stress-controlled",
                       "controlled by strain"};
      if (t.has(strain.name) && t.has(stress.name))
        t.add_error(stress.name, "contradicts " + strain.name + ": give one of both");
      any = any || t.has(strain.name) || t.has(stress.name);
      if (t.has(stress.name))
        stage.axis[k] = {true, t.number(stress, Unit::pressure, Range::positive()), -1};
      else
        stage.axis[k].value = t.number(strain, Unit::none, Range::closed(-kLargestStrain, kLargestStrain), 0.0);
      if (!stage.axis[k].by_stress) require_strain(t, strain.name, stage.axis[k].value);
    }
    if (!any) t.add_error("kind", "no axis is driven: give strain_x, stress_z, ...; kind = \"hold\" drives none");
  }

  bool refuse_axes(const SceneTable& t) const {
    if (stages_.back().record.way != StageKind::axes) return false;
    t.add_error("kind",
                "after " + quoted(StageKind::axes) + " another stage of that kind says how every axis goes back");
    return true;
  }

  void unload(const SceneTable& t) {
    if (refuse_axes(t)) return;
    const double back = -way_sign(stages_, here());
    drive(t, stages_.back().record.way, back);
    require_way(t, back);
  }

  /// A stress to unload to lies below that of the stage before, one to reload to above it; `sign` -1: below. Where that
  /// stage goes by strain, this is known in the run alone (note_stages).
  void require_way(const SceneTable& t, double sign) const {
    const std::optional<double> target = stages_.back().target_stress();
    std::int64_t before = here() - 1;
    while (before >= 0 && stages_[static_cast<std::size_t>(before)].record.kind == StageKind::hold) --before;
    if (before < 0 || !target) return;
    const MacroStage& from = stages_[static_cast<std::size_t>(before)];
    const std::optional<double> there = from.target_stress();
    if (!there || from.goes_to_mean() != stages_.back().goes_to_mean() || sign * (*target - *there) > 0.0) return;
    t.add_error("stress", fmt::format("must be {} the {} of stage '{}', from which it {}",
                                      sign < 0.0 ? "below" : "above", pressure_text(*there), from.record.name,
                                      stages_.back().record.kind == StageKind::unload ? "unloads" : "reloads"));
  }

  /// Back to where the unloading before it began, unless it says how far.
  void reload(const SceneTable& t) {
    if (refuse_axes(t)) return;
    MacroStage& stage = stages_.back();
    if (t.has("strain") || t.has("stress")) {
      const double forth = way_sign(stages_, here());
      drive(t, stage.record.way, forth);
      return require_way(t, forth);
    }
    std::int64_t from = here() - 1;
    while (from >= 0 && stages_[static_cast<std::size_t>(from)].record.kind == StageKind::hold) --from;
    if (from < 0 || stages_[static_cast<std::size_t>(from)].record.kind != StageKind::unload) {
      t.add_error("kind", "nothing was unloaded before it: give strain or stress, or a stage of kind = \"unload\"");
      return;
    }
    turn_back(stages_[static_cast<std::size_t>(from)], from, stage);
  }

  /// The way of the unloading, the other way round.
  void turn_back(const MacroStage& unload, std::int64_t from, MacroStage& stage) const {
    stage.axis = unload.axis;
    stage.shear = -unload.shear;
    stage.logarithmic = unload.logarithmic;
    stage.isotropic = unload.isotropic;
    for (AxisDrive& drive : stage.axis) {
      if (!drive.by_stress)
        drive.value = drive.value == 0.0 ? 0.0 : unload.logarithmic ? -drive.value : -drive.value / (1.0 - drive.value);
      else
        drive.as_at = drive.as_at == from ? here() : from;
    }
  }

  void hold(const SceneTable& t) {
    if (t.choice({"by", "of `\"hold\"`: `\"strain\"` keeps the box, `\"stress\"` keeps the stresses"},
                 {"strain", "stress"}, "strain") == "strain")
      return;
    for (AxisDrive& drive : stages_.back().axis) drive = {true, 0.0, here()};
  }

  void read_cycles(const SceneTable& t) {
    refuse_foreign_keys(t, kCycles);
    const std::int64_t count = t.count({"count", "of `\"cycles\"`: number of cycles"}, 1, 1000);
    const std::string name = given_name(t, "cycle");
    std::int64_t first = 1;  // cycles of an earlier table of this name come before
    for (std::int64_t k = first; k < first + count; ++k)
      for (const char* way : {"unload", "reload"})
        if (is_taken(fmt::format("{} {} {}", name, k, way))) first = k + 1;
    for (std::int64_t k = first; k < first + count; ++k) {
      stages_.push_back(begin(t, StageKind::unload));
      stages_.back().record.name = fmt::format("{} {} unload", name, k);
      unload(t);
      const MacroStage& down = stages_.back();
      MacroStage up = down;
      up.record = {fmt::format("{} {} reload", name, k), StageKind::reload, down.record.way,
                   down.record.modulus_stress};
      stages_.push_back(up);
      turn_back(MacroStage(stages_[stages_.size() - 2]), here() - 1, stages_.back());
      if (t.has_errors()) return;
    }
  }

  const MacroSpec& spec_;
  std::vector<MacroStage>& stages_;
};

/// What a packing is shortened by until it bears a stress, from nothing: p = 0.045 E x^1.75, x its relative loss of
/// pores, 1.8 times the loss of volume.
double strain_under(double stress, const MacroSpec& spec) {
  return std::pow(stress / (0.045 * spec.youngs_modulus), 1.0 / 1.75) / 1.8;
}

}  // namespace

void require_sliding(const SceneTable& t, const char* key, const MacroSpec& spec) {
  if (spec.boundary == Boundary::walls)
    t.add_error(key,
                "planes of particles slide over each other along x, which side walls would stop: needs boundary = "
                "\"periodic\"");
}

void read_modulus_stress(const SceneTable& t, std::array<double, 2>& interval) {
  if (!t.has("modulus_stress")) return;
  const std::vector<double> ends =
      t.numbers({"modulus_stress",
                 "two stresses between which moduli are taken, the lower one first: axial stress; mean stress for "
                 "`\"isotropic\"` and `\"consolidation\"`; (σz - σx)/2 for `\"shear\"`; σz - (σx + σy)/2 for "
                 "`\"undrained\"`; σxz for `\"simple-shear\"` and `\"direct-shear\"`",
                 "depends on the kind of test; in a stage that of the whole test"},
                Unit::pressure, Range::not_negative());
  if (ends.size() != 2 || !(ends[0] < ends[1]))
    t.add_error("modulus_stress", "must be two stresses, the lower one first: [\"1 MPa\", \"2 MPa\"]");
  else
    interval = {ends[0], ends[1]};
}

namespace {

/// Keys that are defaults of stages.
constexpr std::array kOfStages{"steps", "increments_per_step", "tolerance", "modulus_stress"};

/// Under a stress above E nothing is left of grains: E or the stress misses its unit.
void require_below_modulus(const SceneTable& t, const MacroStage& stage, double modulus) {
  for (std::size_t k = 0; k < stage.axis.size(); ++k) {
    const AxisDrive& drive = stage.axis[k];
    if (!drive.to_stress() || drive.value <= modulus) continue;
    std::string key = stage.record.way == StageKind::axes ? std::string("stress_") + "xyz"[k] : "stress";
    if (k < 2 && t.has("lateral_stress")) key = "lateral_stress";
    if (k == 2 && t.has("normal_stress")) key = "normal_stress";
    t.add_error(key, fmt::format("is {:.3g} times E = {} of the grains; at most E is allowed: is a unit missing, such "
                                 "as E = \"70 GPa\"?",
                                 drive.value / modulus, pressure_text(modulus)));
  }
}

/// `modulus_is_known`: whether stresses can be compared with E of `spec`.
void take_stages(const std::vector<SceneTable>& tables, MacroSpec& spec, bool modulus_is_known) {
  std::vector<MacroStage> stages;
  StageReader reader(spec, stages);
  for (const SceneTable& t : tables)
    t.section([&] {
      const std::size_t before = stages.size();
      reader.read(t);
      for (std::size_t k = before; modulus_is_known && k < stages.size(); ++k)
        require_below_modulus(t, stages[k], spec.youngs_modulus);
    });
  spec.test = MacroTest::stages;
  spec.stages = std::move(stages);
}

/// Whether every stage says this key itself. A stage that rests takes only the tolerance from the test.
bool each_says(const std::vector<SceneTable>& stages, const std::string& key) {
  const auto says = [&](const SceneTable& s) {
    const bool rests = s.is_text("kind") && s.text("kind") == to_string(StageKind::hold);
    return s.has(key) || (rests && key != "tolerance");
  };
  return !stages.empty() && std::all_of(stages.begin(), stages.end(), says);
}

}  // namespace

void read_stages(const SceneTable& holder, const SceneTable& macro, MacroSpec& spec, bool modulus_is_known) {
  const std::vector<SceneTable> tables = holder.tables(
      {"stage",
       "one loading of a test, in this order; such tables replace `test`, `strain`, `preload` and `preload_steps`"});
  if (tables.empty()) return;
  macro.refuse({"test", "strain", "preload", "preload_steps"}, "goes without [[stage]], which says the whole test");
  take_stages(tables, spec, modulus_is_known);
}

void read_part_stages(const SceneTable& common, const SceneTable& t, MacroSpec& spec, bool modulus_is_known) {
  const std::vector<SceneTable> stages = common.tables("stage");
  if (t.has("test")) spec.stages.clear();
  if (t.has("stage") || t.has("test") || stages.empty()) return read_stages(t, t, spec, modulus_is_known);
  for (const char* key : {"strain", "preload", "preload_steps"})
    if (t.has(key))
      t.add_error(key,
                  "belongs to a test, and the common [[stage]] say what is tested: give test too, which takes their "
                  "place, or [[stage]] of its own");
  take_stages(stages, spec, modulus_is_known);
}

void refuse_idle_test_keys(const SceneTable& t, const SceneTable& stages, const std::vector<const MacroSpec*>& tests) {
  const auto none = [&](auto&& takes) {
    return std::none_of(tests.begin(), tests.end(), [&](const MacroSpec* s) { return takes(*s); });
  };
  const auto refuse = [&](const char* key, const char* problem) {
    if (t.has(key)) t.add_error(key, problem);
  };
  if (none([](const MacroSpec& s) { return is_shear(s.test); }))
    for (const char* key : {"preload", "preload_steps"})
      refuse(key,
             "goes with test = \"shear\", \"undrained\", \"simple-shear\" or \"direct-shear\": other tests have "
             "nothing before them (a test in [[stage]] has)");
  else if (none([](const MacroSpec& s) { return preload_points(s) > 0; }))
    refuse("preload_steps", "goes with preload, the strain before the shear");
  if (none([](const MacroSpec& s) { return s.test != MacroTest::stages; })) {
    refuse("strain", "goes without [[stage]], which says the whole test");
    for (const char* key : kOfStages)
      if (each_says(stages.tables("stage"), key)) refuse(key, "every [[stage]] gives its own");
  }
}

void refuse_idle_stages(const SceneTable& root, const char* part, const std::vector<SceneTable>& parts) {
  const auto takes_none = [](const SceneTable& t) { return t.has("test") || t.has("stage"); };
  if (root.has("stage") && !parts.empty() && std::all_of(parts.begin(), parts.end(), takes_none))
    root.add_error("stage", fmt::format("no [[{}]] takes it: each gives test or [[stage]] of its own", part));
}

bool says_in_test(const SceneTable& t, const std::string& key) {
  return t.has(key) || each_says(t.tables("stage"), key);
}

RoughStrains rough_strains(const MacroSpec& spec) {
  RoughStrains rough;
  Vec3 now{};
  for (const MacroStage& stage : stages_of(spec)) {
    double largest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const AxisDrive& drive = stage.axis[static_cast<std::size_t>(k)];
      const double before = now[k];
      if (!drive.by_stress)
        now[k] += drive.value;
      else if (drive.as_at < 0)
        now[k] = strain_under(drive.value, spec) / 3.0;
      largest = std::max(largest, std::abs(now[k] - before));
    }
    largest = std::max(largest, std::abs(stage.shear));
    rough.way += largest;
    rough.largest_axial = std::max({rough.largest_axial, now[0], now[2]});
    rough.largest_volumetric = std::max(rough.largest_volumetric, now[0] + now[1] + now[2]);
  }
  return rough;
}

}  // namespace softgrain
