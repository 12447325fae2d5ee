#include "pipelines/kinds/law_table/multi_contact_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/core/text.h"
#include "common/data/multi_contact_measurements.h"
#include "common/dynamics/slow_dynamics.h"
#include "microsim/multi_contact_arrangements.h"
#include "pipelines/kinds/soft_particle/scene.h"

namespace softgrain {

namespace {

const Range kShare{0.0, 1.0, true, true};

const Key kShallow{
    "shallow",
    "`\"beside-five\"`: overlap of the first neighbour, over that of the five others; `\"scattered\"`: least overlap, "
    "over `overlap`. One neighbour reaches `overlap`; the others are drawn evenly between both values",
    "`\"beside-five\"`: 0.5; `\"scattered\"`: 0.3"};

/// Least work is for one neighbour alone.
void read_relaxation(const SceneTable& t, const SoftParticleSpec& spec, MultiContactOptions& o) {
  if (t.has("relaxation"))
    o.relaxation =
        t.choice<Relaxation>({"relaxation", "method that brings the grains to equilibrium", "\"slow-dynamics\""},
                             {Relaxation::slow_dynamics, Relaxation::damped, Relaxation::published});
  const auto only_dynamics = [&](const char* key) {
    if (t.has(key) && o.relaxation == Relaxation::damped)
      t.add_error(key, "relaxation = \"damped\" knows no motion; leave it out");
  };
  for (const char* key : {"approach_speed", "step_factor", "settle_time"}) only_dynamics(key);
  if (t.has("approach_speed"))
    o.approach_speed =
        t.number({"approach_speed",
                  "speed of the neighbour that moves farthest, 1e-7 to 0.1 of sqrt(E/rho); not for `\"damped\"`",
                  "0.002 m/s at the published parameters, scaled with sqrt(E/rho)"},
                 Unit::velocity, approach_speeds(spec, kFastestApproach), o.approach_speed);
  o.step_factor = t.number({"step_factor", "`\"slow-dynamics\"`: time step, over that of `\"published\"`"}, Unit::none,
                           Range::closed(0.01, 10.0), o.step_factor);
  o.settle_time =
      t.number({"settle_time", "`\"slow-dynamics\"`: waiting time before a state is recorded, over Rs sqrt(rho/E)"},
               Unit::none, Range::closed(0.0, kLongestSettling), o.settle_time);
}

void read_multi_contact(const SceneTable& t, MultiContactSetup& setup) {
  MultiContactOptions& o = setup.options;
  o.increment = t.number({"increment",
                          "`\"damped\"`: largest change of an overlap between two relaxations, over Rs. In the other "
                          "methods a run can be stopped and resumed after each such change"},
                         Unit::none, Range::closed(1e-7, 0.1), o.increment);
  o.tolerance = t.number({"tolerance", "recorded states: largest net force on a grain, over the mean contact force"},
                         Unit::none, Range{0.0, 1.0, true, false}, o.tolerance);
  o.tolerance_between = t.number({"tolerance_between", "`\"damped\"`: `tolerance` of states that are not recorded"},
                                 Unit::none, Range{0.0, 10.0, true, false}, o.tolerance_between);
  o.max_passes =
      t.count({"max_passes", "largest number of passes per relaxation; one pass evaluates all contacts once"}, 10,
              100000000, o.max_passes);
  read_relaxation(t, setup.spec, o);
  setup.packings_min =
      t.count({"packings_min", "least number of packings per configuration"}, 2, 100000, setup.packings_min);
  setup.packings_max =
      t.count({"packings_max", "largest number of packings per configuration", "24, or `packings_min` if larger"}, 2,
              100000, std::max(setup.packings_max, setup.packings_min));
  if (setup.packings_max < setup.packings_min) t.add_error("packings_max", "must be at least packings_min");
  setup.target = t.number(
      {"target",
       "packings are added until the mean force at the largest overlap has a relative standard error below this value"},
      Unit::none, kShare, setup.target);
  setup.points =
      t.count({"points", "recorded states per stage. They are dense around the onset, which a pilot run finds"}, 2,
              1000, setup.points);
  setup.orientations =
      t.count({"orientations",
               "orientations in which each packing is measured; all grains are rotated together. Their mean counts as "
               "one packing. The summary says how many packings the orientations are worth"},
              1, 1000, setup.orientations);
}

/// How the neighbours come and go.
enum class MultiContactPath {
  together,
  sequential,
  unload,
  slide,
  back_and_forth,  ///< slides, back past where it began, and forth again
  oblique,         ///< pressed and slid at once, at an angle to the normal
  slide_press,     ///< half of the way in, a slide, the rest of the way
  shear,           ///< all in, then some further and others back, as those of a packing that is sheared
  roll
};
enum class Centre { fixed, free };
/// Kinds of neighbours: one PartnerKind, or all of them mixed.
enum class Partners {
  plane = static_cast<int>(PartnerKind::plane),
  solid = static_cast<int>(PartnerKind::solid),
  soft = static_cast<int>(PartnerKind::soft),
  mixed
};

}  // namespace

template <>
inline constexpr auto enum_names<MultiContactPath> =
    enum_name_list<MultiContactPath>({{MultiContactPath::together, "together"},
                                      {MultiContactPath::sequential, "sequential"},
                                      {MultiContactPath::unload, "unload"},
                                      {MultiContactPath::slide, "slide"},
                                      {MultiContactPath::back_and_forth, "back-and-forth"},
                                      {MultiContactPath::oblique, "oblique"},
                                      {MultiContactPath::slide_press, "slide-press"},
                                      {MultiContactPath::shear, "shear"},
                                      {MultiContactPath::roll, "roll"}});
template <>
inline constexpr auto enum_names<Partners> = enum_name_list<Partners>(
    {{Partners::plane, "plane"}, {Partners::solid, "solid"}, {Partners::soft, "soft"}, {Partners::mixed, "mixed"}});
template <>
inline constexpr auto enum_names<Centre> = enum_name_list<Centre>({{Centre::fixed, "fixed"}, {Centre::free, "free"}});

namespace {

/// What a [[configuration]] says, before it becomes neighbours and stages.
struct ConfigurationKeys {
  Arrangement arrangement = Arrangement::one;
  std::optional<PartnerKind> partner{};  ///< empty: mixed
  double ratio = 0.0;
  bool smooth = false;
  ScatterChoice scatter{};
  double overlap = 0.0;
  double shallow = 1.0;
  MultiContactPath path = MultiContactPath::together;
  double slide = 0.0;  ///< length of the slide or roll [Rs]
  double angle = 0.0;  ///< angle of an oblique path to the normal [degree]
  double shear = 0.0;  ///< relative change of overlaps in shear
};

bool slides(MultiContactPath path) {
  return path == MultiContactPath::slide || path == MultiContactPath::back_and_forth ||
         path == MultiContactPath::slide_press;
}

/// All neighbours only come nearer or go back.
bool goes_straight(MultiContactPath path) {
  return path == MultiContactPath::together || path == MultiContactPath::sequential ||
         path == MultiContactPath::unload || path == MultiContactPath::shear;
}

/// How far the first neighbour slides or rolls, and at which angle it comes.
void read_path_keys(const SceneTable& t, ConfigurationKeys& w) {
  if (slides(w.path))
    w.slide = t.number({"slide", "paths with a slide: sliding distance over Rs"}, Unit::none,
                       Range{0.0, 1.0, true, false}, 0.1);
  else
    t.refuse({"slide"}, "only paths that slide have it: \"slide\", \"back-and-forth\", \"slide-press\"");
  if (w.path == MultiContactPath::roll)
    w.slide =
        t.number({"roll", "path `\"roll\"`: rolling distance over Rs"}, Unit::none, Range{0.0, 1.0, true, false}, 0.1);
  else
    t.refuse({"roll"}, "only a path that rolls has it: path = \"roll\"");
  if (w.path == MultiContactPath::shear)
    w.shear = t.number({"shear",
                        "path `\"shear\"`: s. Overlaps h first reach h/(1 + s), then h (1 + s (3 c^2 - 1)/2)/(1 + s); "
                        "c: cosine of the angle to the first neighbour"},
                       Unit::none, Range{0.0, 1.0, true, false}, 0.3);
  else
    t.refuse({"shear"}, "only a path of that name has it: path = \"shear\"");
  if (w.path == MultiContactPath::oblique)
    w.angle = t.number({"angle", "path `\"oblique\"`: angle between the motion and the normal [degree]"}, Unit::none,
                       Range::closed(0.0, 85.0), 45.0);
  else
    t.refuse({"angle"}, "only an oblique path has it: path = \"oblique\"");
}

/// Radii of spheres: one, or those that scattered ones are drawn from.
void read_ratios(const SceneTable& t, ConfigurationKeys& w) {
  const bool scattered = w.arrangement == Arrangement::scattered;
  if (w.partner == PartnerKind::plane) {
    t.refuse({"ratio", "ratios"}, "a plane has no radius; leave it out");
  } else if (scattered && t.has("ratios")) {
    w.scatter.ratios = t.numbers(
        {"ratios", "`\"scattered\"`, instead of `ratio`: radii over Rs. Each neighbour draws its radius from the list"},
        Unit::none, Range::positive());
    if (w.scatter.ratios.empty()) {
      t.add_error("ratios", "at least one");
      w.scatter.ratios = {1.0};
    }
    t.refuse({"ratio"}, "the ratios are given already; leave one of the two out");
  } else {
    w.ratio =
        t.number({"ratio", "radius of the neighbours over Rs; not for planes"}, Unit::none, Range::positive(), 1.0);
    w.scatter.ratios = {w.ratio};
    t.refuse({"ratios"}, "only the arrangement scattered draws radii; give one ratio");
  }
  for (const double ratio : w.scatter.ratios)
    if (w.overlap >= ratio)
      t.add_error("overlap", "must be below the ratio, so that the neighbour's centre stays outside");
}

/// Reads how scattered neighbours are drawn.
void read_scatter(const SceneTable& t, ConfigurationKeys& w) {
  ScatterChoice& s = w.scatter;
  s.kind = w.partner;
  s.smooth = w.smooth;
  s.count = t.count({"neighbours", "`\"scattered\"`: number of neighbours"}, 4, 20, s.count);
  s.draw = static_cast<std::uint64_t>(
      t.count({"draw", "`\"scattered\"`: number of the random set of neighbours. Equal numbers give equal neighbours"},
              0, 1000000, static_cast<std::int64_t>(s.draw)));
  s.shallow = t.number(kShallow, Unit::none, kShare, s.shallow);
}

ConfigurationKeys read_configuration_keys(const SceneTable& t) {
  ConfigurationKeys w;
  w.arrangement =
      t.choice<Arrangement>({"arrangement", "directions of the neighbours; `\"scattered\"`: random, as in a packing"});
  const bool scattered = w.arrangement == Arrangement::scattered;
  const Partners partner = t.choice<Partners>({"partner",
                                               "kind of the neighbours; `\"mixed\"`, only if `\"scattered\"`: of five "
                                               "neighbours three solid, one a plane, one soft"});
  if (partner == Partners::mixed && !scattered)
    t.add_error("partner", "only the arrangement scattered mixes them: one of plane, solid, soft");
  if (partner != Partners::mixed) w.partner = static_cast<PartnerKind>(partner);
  w.overlap = t.number({"overlap", "largest h/Rs"}, Unit::none, kShare);
  read_ratios(t, w);
  w.smooth = t.flag({"smooth", "true: planes have no friction; false: they have mu of the grains"}, false);
  if (w.smooth && w.partner.value_or(PartnerKind::plane) != PartnerKind::plane)
    t.add_error("smooth", "only planes are without friction");
  w.path = t.choice<MultiContactPath>({"path", "motion of the neighbours"}, MultiContactPath::together);
  read_path_keys(t, w);
  if (scattered)
    read_scatter(t, w);
  else
    t.refuse({"neighbours", "draw"}, "only the arrangement scattered is drawn");
  if (w.arrangement == Arrangement::beside_five)
    w.shallow = t.number(kShallow, Unit::none, Range{0.0, 1.0, true, false}, 0.5);
  else if (!scattered)
    t.refuse({"shallow"}, "only the arrangements beside-five and scattered have shallow neighbours");
  return w;
}

/// All neighbours so deep, then those along the first one by 1 + s times, those across it by 1 - s/2 times (Legendre's
/// P2 of the cosine between): overlaps of bodies that a homogeneous shear at constant volume moves.
std::vector<MultiContactStage> sheared(const std::vector<MultiContactPartner>& partners,
                                       const std::vector<double>& deepest, double s) {
  std::vector<double> before = deepest;
  std::vector<double> after = deepest;
  for (std::size_t k = 0; k < deepest.size(); ++k) {
    const double c = dot(partners[k].direction, partners[0].direction);
    before[k] /= 1.0 + s;
    after[k] = before[k] * (1.0 + s * 0.5 * (3.0 * c * c - 1.0));
  }
  return {{MultiContactMove::load, before}, {MultiContactMove::load, after}};
}

std::vector<MultiContactStage> stages_of(const ConfigurationKeys& w, const std::vector<MultiContactPartner>& partners,
                                         const std::vector<double>& deepest) {
  const std::vector<double> apart(deepest.size(), 0.0);
  const MultiContactStage load{MultiContactMove::load, deepest};
  switch (w.path) {
    case MultiContactPath::together:
      return {load};
    case MultiContactPath::unload:
      return {load, {MultiContactMove::unload, apart}, {MultiContactMove::reload, deepest}};
    case MultiContactPath::slide:
      return {load, {MultiContactMove::slide, deepest, w.slide}};
    case MultiContactPath::back_and_forth:
      return {load,
              {MultiContactMove::slide, deepest, w.slide},
              {MultiContactMove::slide, deepest, -2.0 * w.slide},
              {MultiContactMove::slide, deepest, 2.0 * w.slide}};
    case MultiContactPath::oblique:
      return {{MultiContactMove::oblique, deepest, deepest[0] * std::tan(w.angle * std::numbers::pi / 180.0)}};
    case MultiContactPath::slide_press: {
      std::vector<double> half = deepest;
      for (double& h : half) h *= 0.5;
      return {{MultiContactMove::load, half},
              {MultiContactMove::slide, half, w.slide},
              {MultiContactMove::oblique, deepest}};
    }
    case MultiContactPath::roll:
      return {load, {MultiContactMove::roll, deepest, 0.0, w.slide}};
    case MultiContactPath::shear:
      return sheared(partners, deepest, w.shear);
    case MultiContactPath::sequential:
      break;
  }
  std::vector<MultiContactStage> stages;
  std::vector<double> reached = apart;
  for (std::size_t k = 0; k < deepest.size(); ++k) {
    reached[k] = deepest[k];
    stages.push_back({MultiContactMove::load, reached});
  }
  return stages;
}

/// "0.25", "1", "2.5": as people write it.
std::string short_number(double x) { return without_trailing_zeros(std::to_string(x)); }

std::string default_name(const ConfigurationKeys& w, bool free) {
  std::string name = to_string(w.arrangement) + "-" + (w.partner ? to_string(*w.partner) : "mixed");
  if (w.arrangement == Arrangement::scattered) name += fmt::format("-{}-{}", w.scatter.count, w.scatter.draw);
  if (w.smooth) name += "-smooth";
  if (w.ratio > 0.0) name += "-" + short_number(w.ratio);
  if (w.path != MultiContactPath::together) name += "-" + to_string(w.path);
  if (w.path == MultiContactPath::oblique) name += "-" + short_number(w.angle);
  return free ? name + "-free" : name;
}

/// Five planes around each soft neighbour, on the sides where the centre is not, `depth` of its radius deep at the end.
void press_soft_neighbours(MultiContactConfiguration& c, double depth) {
  const std::size_t touching = c.partners.size();
  for (std::size_t k = 0; k < touching; ++k) {
    const MultiContactPartner on = c.partners[k];
    if (on.kind != PartnerKind::soft) continue;
    const Vec3 across = slide_direction(on.direction);
    const Vec3 third = cross(on.direction, across);
    for (const Vec3& n : {on.direction, across, -across, third, -third}) {
      c.partners.push_back({PartnerKind::plane, 0.0, n, false, static_cast<std::int32_t>(k)});
      for (MultiContactStage& s : c.stages)
        s.overlap.push_back(s.move == MultiContactMove::unload ? 0.0 : depth * on.ratio);
    }
  }
}

void read_press(const SceneTable& t, MultiContactPath path, MultiContactConfiguration& c) {
  if (!t.has("pressed")) return;
  const double depth = t.number(
      {"pressed", "overlap of five additional planes with each soft neighbour, over its radius"}, Unit::none, kShare);
  if (std::ranges::none_of(c.partners, [](const auto& p) { return p.kind == PartnerKind::soft; }))
    t.add_error("pressed", "no neighbour is soft: there is nothing that the planes could press");
  if (!c.centre_free) t.add_error("pressed", "only around a free shell: centre = \"free\"");
  if (!goes_straight(path) || path == MultiContactPath::sequential)
    t.add_error("pressed", "neighbours that slide, roll or come one after the other are led: leave it out");
  press_soft_neighbours(c, depth);
}

MultiContactConfiguration read_configuration(const SceneTable& t) {
  const ConfigurationKeys w = read_configuration_keys(t);
  MultiContactConfiguration c;
  std::vector<double> deepest = depth_shares(w.arrangement, w.shallow);
  for (const Vec3& d : directions_of(w.arrangement))
    c.partners.push_back({w.partner.value_or(PartnerKind::solid), w.ratio, d, w.smooth});
  if (w.arrangement == Arrangement::scattered)
    for (const ScatteredNeighbour& n : scattered_neighbours(w.scatter)) {
      c.partners.push_back(n.partner);
      deepest.push_back(n.share);
    }
  for (double& h : deepest) h *= w.overlap;
  c.stages = stages_of(w, c.partners, deepest);
  c.centre_free = t.choice<Centre>({"centre",
                                    "shell of the measured particle; `\"free\"`: it moves and turns under the forces "
                                    "of its grains, as in a macro scene"},
                                   Centre::fixed) == Centre::free;
  c.held_out = t.flag({"held_out", "true: the law is not fitted to this configuration but predicts it"}, false);
  c.turning = t.flag(
      {"turning", "true: solid neighbours rotate under the forces on them, as in a macro scene; false: they do not"},
      false);
  if (c.turning && !goes_straight(w.path))
    t.add_error("turning", "neighbours that slide or roll are led: leave it out");
  read_press(t, w.path, c);
  c.name = t.line_text({"name", "name in tables and files", "arrangement, partner, path"},
                       default_name(w, c.centre_free) + (t.has("pressed") ? "-pressed" : ""));
  return c;
}

void require_packings(const SceneTable& t, const MultiContactConfiguration& c, std::int64_t pool) {
  const auto softs =
      std::ranges::count_if(c.partners, [](const MultiContactPartner& p) { return p.kind == PartnerKind::soft; });
  if (softs >= pool)
    t.add_error("partner", std::to_string(softs) +
                               " soft neighbours and the centre need as many different packings: raise "
                               "multi_contact.packings_max to " +
                               std::to_string(softs + 1) + " or more");
}

}  // namespace

MultiContactSetup read_multi_contact_setup(const SceneTable& root) {
  MultiContactSetup setup;
  setup.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
  setup.spec = read_soft_particle(root);
  read_multi_contact(
      root.table_or_empty({"multi_contact",
                           "how forces with several neighbours are measured: method, accuracy and number of packings"}),
      setup);
  for (const SceneTable& t :
       root.tables({"configuration", "set of neighbours around one soft particle, and a path along which they move"})) {
    setup.configurations.push_back(read_configuration(t));
    const MultiContactConfiguration& c = setup.configurations.back();
    if (setup.options.relaxation == Relaxation::damped && c.stages.back().roll != 0.0)
      t.add_error("path", "\"roll\" needs motion: relaxation = \"slow-dynamics\"");
    if (t.has("packings"))
      setup.packings[c.name] = t.count(
          {"packings",
           "fixed number of packings, whatever their scatter. `softgrain law plan` says where more of them help most",
           "by `[multi_contact]`"},
          2, 100000, 0);
    if (!root.table_or_empty("multi_contact").has_errors()) require_packings(t, c, setup.packings_max);
    for (std::size_t k = 0; k + 1 < setup.configurations.size(); ++k)
      if (setup.configurations[k].name == c.name)
        t.add_error("name", "'" + c.name + "' is there already; give another name");
  }
  if (setup.configurations.empty()) root.add_error("configuration", "at least one [[configuration]] is needed");
  return setup;
}

bool may_be_cut(const MultiContactConfiguration& configuration) {
  return configuration.stages.front().move == MultiContactMove::load;
}

MultiContactConfiguration cut_short(const MultiContactConfiguration& configuration, double depth) {
  MultiContactConfiguration c = configuration;
  if (depth >= 1.0) return c;
  c.stages.resize(1);
  for (double& h : c.stages.front().overlap) h *= depth;
  return c;
}

void read_plan(const SceneTable& root, MultiContactSetup& setup) {
  for (const SceneTable& t : root.tables({"plan", "adds packings; `softgrain law plan` writes these tables"})) {
    PlannedPackings p{
        t.text({"configuration", "name of a configuration"}),
        t.number({"depth", "the planned packings stop at this share of the overlaps of the configuration"}, Unit::none,
                 kShare, 1.0),
        t.count({"packings", "total number of packings of that configuration"}, 2, 100000)};
    const auto named = std::ranges::find_if(
        setup.configurations, [&](const MultiContactConfiguration& c) { return c.name == p.configuration; });
    if (named == setup.configurations.end())
      t.add_error("configuration", "no [[configuration]] has this name");
    else if (p.depth < 1.0 && !may_be_cut(*named))
      t.add_error("depth", "its way begins with a slide: it cannot be cut short; leave it out");
    setup.plan.push_back(std::move(p));
  }
}

}  // namespace softgrain
