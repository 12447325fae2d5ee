#include "pipelines/kinds/law_table/crowd_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/data/slide_direction.h"
#include "microsim/crowd_arrangements.h"
#include "pipelines/kinds/soft_particle/scene.h"

namespace softgrain {

namespace {

const Range kShare{0.0, 1.0, true, true};

/// Least work is for one neighbour alone.
void read_relaxation(const SceneTable& t, CrowdOptions& o) {
  if (t.has("relaxation"))
    o.relaxation =
        t.choice<Relaxation>("relaxation", {Relaxation::slow_dynamics, Relaxation::damped, Relaxation::published});
  const auto only_dynamics = [&](const char* key) {
    if (t.has(key) && o.relaxation == Relaxation::damped)
      t.mistake(key, "relaxation = \"damped\" knows no motion; leave it out");
  };
  for (const char* key : {"approach_speed", "step_factor", "settle_time"}) only_dynamics(key);
  if (t.has("approach_speed"))
    o.approach_speed = t.number("approach_speed", Unit::velocity, Range::positive(), o.approach_speed);
  o.step_factor = t.number("step_factor", Unit::none, Range::closed(0.01, 10.0), o.step_factor);
  o.settle_time = t.number("settle_time", Unit::none, Range::not_negative(), o.settle_time);
}

void read_crowd(const SceneTable& t, CrowdSetup& setup) {
  CrowdOptions& o = setup.options;
  o.increment = t.number("increment", Unit::none, Range::closed(1e-7, 0.1), o.increment);
  o.tolerance = t.number("tolerance", Unit::none, Range{0.0, 1.0, true, false}, o.tolerance);
  o.tolerance_between = t.number("tolerance_between", Unit::none, Range{0.0, 10.0, true, false}, o.tolerance_between);
  o.max_passes = t.count("max_passes", 10, 100000000, o.max_passes);
  read_relaxation(t, o);
  setup.packings_min = t.count("packings_min", 2, 100000, setup.packings_min);
  setup.packings_max = t.count("packings_max", 2, 100000, std::max(setup.packings_max, setup.packings_min));
  if (setup.packings_max < setup.packings_min) t.mistake("packings_max", "must be at least packings_min");
  setup.target = t.number("target", Unit::none, kShare, setup.target);
  setup.points = t.count("points", 2, 1000, setup.points);
  setup.orientations = t.count("orientations", 1, 1000, setup.orientations);
}

/// How the neighbours come and go.
enum class CrowdPath {
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
/// As PartnerKind, or all of them.
enum class Partners {
  plane = static_cast<int>(PartnerKind::plane),
  solid = static_cast<int>(PartnerKind::solid),
  soft = static_cast<int>(PartnerKind::soft),
  mixed
};

}  // namespace

template <>
inline constexpr auto words<CrowdPath> = word_list<CrowdPath>({{CrowdPath::together, "together"},
                                                               {CrowdPath::sequential, "sequential"},
                                                               {CrowdPath::unload, "unload"},
                                                               {CrowdPath::slide, "slide"},
                                                               {CrowdPath::back_and_forth, "back-and-forth"},
                                                               {CrowdPath::oblique, "oblique"},
                                                               {CrowdPath::slide_press, "slide-press"},
                                                               {CrowdPath::shear, "shear"},
                                                               {CrowdPath::roll, "roll"}});
template <>
inline constexpr auto words<Partners> = word_list<Partners>(
    {{Partners::plane, "plane"}, {Partners::solid, "solid"}, {Partners::soft, "soft"}, {Partners::mixed, "mixed"}});
template <>
inline constexpr auto words<Centre> = word_list<Centre>({{Centre::fixed, "fixed"}, {Centre::free, "free"}});

namespace {

/// What a [[configuration]] says, before it becomes neighbours and stages.
struct Wanted {
  Arrangement arrangement = Arrangement::one;
  std::optional<PartnerKind> partner{};  ///< empty: mixed
  double ratio = 0.0;
  bool smooth = false;
  ScatterChoice scatter{};
  double overlap = 0.0;
  double shallow = 1.0;
  CrowdPath path = CrowdPath::together;
  double slide = 0.0;  ///< or roll [Rs]
  double angle = 0.0;  ///< of an oblique path to the normal [degree]
  double shear = 0.0;  ///< of overlaps
};

bool slides(CrowdPath path) {
  return path == CrowdPath::slide || path == CrowdPath::back_and_forth || path == CrowdPath::slide_press;
}

/// All neighbours only come nearer or go back.
bool goes_straight(CrowdPath path) {
  return path == CrowdPath::together || path == CrowdPath::sequential || path == CrowdPath::unload ||
         path == CrowdPath::shear;
}

/// How far the first neighbour slides or rolls, and at which angle it comes.
void read_way(const SceneTable& t, Wanted& w) {
  if (slides(w.path))
    w.slide = t.number("slide", Unit::none, Range{0.0, 1.0, true, false}, 0.1);
  else if (t.has("slide"))
    t.mistake("slide", "only paths that slide have it: \"slide\", \"back-and-forth\", \"slide-press\"");
  if (w.path == CrowdPath::roll)
    w.slide = t.number("roll", Unit::none, Range{0.0, 1.0, true, false}, 0.1);
  else if (t.has("roll"))
    t.mistake("roll", "only a path that rolls has it: path = \"roll\"");
  if (w.path == CrowdPath::shear)
    w.shear = t.number("shear", Unit::none, Range{0.0, 1.0, true, false}, 0.3);
  else if (t.has("shear"))
    t.mistake("shear", "only a path of that name has it: path = \"shear\"");
  if (w.path == CrowdPath::oblique)
    w.angle = t.number("angle", Unit::none, Range::closed(0.0, 85.0), 45.0);
  else if (t.has("angle"))
    t.mistake("angle", "only an oblique path has it: path = \"oblique\"");
}

/// Radii of spheres: one, or those that scattered ones are drawn from.
void read_ratios(const SceneTable& t, Wanted& w) {
  const bool scattered = w.arrangement == Arrangement::scattered;
  if (w.partner == PartnerKind::plane) {
    for (const char* key : {"ratio", "ratios"})
      if (t.has(key)) t.mistake(key, "a plane has no radius; leave it out");
  } else if (scattered && t.has("ratios")) {
    w.scatter.ratios = t.numbers("ratios", Unit::none, Range::positive());
    if (w.scatter.ratios.empty()) {
      t.mistake("ratios", "at least one");
      w.scatter.ratios = {1.0};
    }
    if (t.has("ratio")) t.mistake("ratio", "the ratios are given already; leave one of the two out");
  } else {
    w.ratio = t.number("ratio", Unit::none, Range::positive(), 1.0);
    w.scatter.ratios = {w.ratio};
    if (t.has("ratios")) t.mistake("ratios", "only the arrangement scattered draws radii; give one ratio");
  }
  for (const double ratio : w.scatter.ratios)
    if (w.overlap >= ratio)
      t.mistake("overlap", "must be below the ratio, so that the neighbour's centre stays outside");
}

/// Which neighbours are drawn.
void read_scatter(const SceneTable& t, Wanted& w) {
  ScatterChoice& s = w.scatter;
  s.kind = w.partner;
  s.smooth = w.smooth;
  s.count = t.count("neighbours", 4, 20, s.count);
  s.draw = static_cast<std::uint64_t>(t.count("draw", 0, 1000000, static_cast<std::int64_t>(s.draw)));
  s.shallow = t.number("shallow", Unit::none, kShare, s.shallow);
}

Wanted read_wanted(const SceneTable& t) {
  Wanted w;
  w.arrangement = t.choice<Arrangement>("arrangement");
  const bool scattered = w.arrangement == Arrangement::scattered;
  const Partners partner = t.choice<Partners>("partner");
  if (partner == Partners::mixed && !scattered)
    t.mistake("partner", "only the arrangement scattered mixes them: one of plane, solid, soft");
  if (partner != Partners::mixed) w.partner = static_cast<PartnerKind>(partner);
  w.overlap = t.number("overlap", Unit::none, kShare);
  read_ratios(t, w);
  w.smooth = t.flag("smooth", false);
  if (w.smooth && w.partner.value_or(PartnerKind::plane) != PartnerKind::plane)
    t.mistake("smooth", "only planes are without friction");
  w.path = t.choice<CrowdPath>("path", CrowdPath::together);
  read_way(t, w);
  if (scattered)
    read_scatter(t, w);
  else
    for (const char* key : {"neighbours", "draw"})
      if (t.has(key)) t.mistake(key, "only the arrangement scattered is drawn");
  if (w.arrangement == Arrangement::beside_five)
    w.shallow = t.number("shallow", Unit::none, Range{0.0, 1.0, true, false}, 0.5);
  else if (!scattered && t.has("shallow"))
    t.mistake("shallow", "only the arrangements beside-five and scattered have shallow neighbours");
  return w;
}

/// All neighbours so deep, then those along the first one by 1 + s times, those across it by 1 - s/2 times (Legendre's
/// P2 of the cosine between): overlaps of bodies that a homogeneous shear at constant volume moves.
std::vector<CrowdStage> sheared(const std::vector<CrowdPartner>& partners, const std::vector<double>& deepest,
                                double s) {
  std::vector<double> before = deepest;
  std::vector<double> after = deepest;
  for (std::size_t k = 0; k < deepest.size(); ++k) {
    const double c = dot(partners[k].direction, partners[0].direction);
    before[k] /= 1.0 + s;
    after[k] = before[k] * (1.0 + s * 0.5 * (3.0 * c * c - 1.0));
  }
  return {{CrowdMove::load, before}, {CrowdMove::load, after}};
}

std::vector<CrowdStage> stages_of(const Wanted& w, const std::vector<CrowdPartner>& partners,
                                  const std::vector<double>& deepest) {
  const std::vector<double> apart(deepest.size(), 0.0);
  const CrowdStage load{CrowdMove::load, deepest};
  switch (w.path) {
    case CrowdPath::together:
      return {load};
    case CrowdPath::unload:
      return {load, {CrowdMove::unload, apart}, {CrowdMove::reload, deepest}};
    case CrowdPath::slide:
      return {load, {CrowdMove::slide, deepest, w.slide}};
    case CrowdPath::back_and_forth:
      return {load,
              {CrowdMove::slide, deepest, w.slide},
              {CrowdMove::slide, deepest, -2.0 * w.slide},
              {CrowdMove::slide, deepest, 2.0 * w.slide}};
    case CrowdPath::oblique:
      return {{CrowdMove::oblique, deepest, deepest[0] * std::tan(w.angle * std::numbers::pi / 180.0)}};
    case CrowdPath::slide_press: {
      std::vector<double> half = deepest;
      for (double& h : half) h *= 0.5;
      return {{CrowdMove::load, half}, {CrowdMove::slide, half, w.slide}, {CrowdMove::oblique, deepest}};
    }
    case CrowdPath::roll:
      return {load, {CrowdMove::roll, deepest, 0.0, w.slide}};
    case CrowdPath::shear:
      return sheared(partners, deepest, w.shear);
    case CrowdPath::sequential:
      break;
  }
  std::vector<CrowdStage> stages;
  std::vector<double> reached = apart;
  for (std::size_t k = 0; k < deepest.size(); ++k) {
    reached[k] = deepest[k];
    stages.push_back({CrowdMove::load, reached});
  }
  return stages;
}

/// "0.25", "1", "2.5": as people write it.
std::string short_number(double x) {
  std::string text = std::to_string(x);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string default_name(const Wanted& w, bool free) {
  std::string name = to_string(w.arrangement) + "-" + (w.partner ? to_string(*w.partner) : "mixed");
  if (w.arrangement == Arrangement::scattered) name += fmt::format("-{}-{}", w.scatter.count, w.scatter.draw);
  if (w.smooth) name += "-smooth";
  if (w.ratio > 0.0) name += "-" + short_number(w.ratio);
  if (w.path != CrowdPath::together) name += "-" + to_string(w.path);
  if (w.path == CrowdPath::oblique) name += "-" + short_number(w.angle);
  return free ? name + "-free" : name;
}

/// Five planes around each soft neighbour, on the sides where the centre is not, `depth` of its radius deep at the end.
void press_soft_neighbours(CrowdConfiguration& c, double depth) {
  const std::size_t touching = c.partners.size();
  for (std::size_t k = 0; k < touching; ++k) {
    const CrowdPartner on = c.partners[k];
    if (on.kind != PartnerKind::soft) continue;
    const Vec3 across = slide_direction(on.direction);
    const Vec3 third = cross(on.direction, across);
    for (const Vec3& n : {on.direction, across, -across, third, -third}) {
      c.partners.push_back({PartnerKind::plane, 0.0, n, false, static_cast<std::int32_t>(k)});
      for (CrowdStage& s : c.stages) s.overlap.push_back(s.move == CrowdMove::unload ? 0.0 : depth * on.ratio);
    }
  }
}

void read_press(const SceneTable& t, CrowdPath path, CrowdConfiguration& c) {
  if (!t.has("pressed")) return;
  const double depth = t.number("pressed", Unit::none, kShare);
  if (std::none_of(c.partners.begin(), c.partners.end(), [](const auto& p) { return p.kind == PartnerKind::soft; }))
    t.mistake("pressed", "no neighbour is soft: there is nothing that the planes could press");
  if (!c.centre_free) t.mistake("pressed", "only around a free shell: centre = \"free\"");
  if (!goes_straight(path) || path == CrowdPath::sequential)
    t.mistake("pressed", "neighbours that slide, roll or come one after the other are led: leave it out");
  press_soft_neighbours(c, depth);
}

CrowdConfiguration read_configuration(const SceneTable& t) {
  const Wanted w = read_wanted(t);
  CrowdConfiguration c;
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
  c.centre_free = t.choice<Centre>("centre", Centre::fixed) == Centre::free;
  c.held_out = t.flag("held_out", false);
  c.turning = t.flag("turning", false);
  if (c.turning && !goes_straight(w.path)) t.mistake("turning", "neighbours that slide or roll are led: leave it out");
  read_press(t, w.path, c);
  c.name = t.text("name", default_name(w, c.centre_free) + (t.has("pressed") ? "-pressed" : ""));
  if (c.name.empty()) t.mistake("name", "must not be empty");
  return c;
}

void require_packings(const SceneTable& t, const CrowdConfiguration& c, std::int64_t pool) {
  const auto softs = std::count_if(c.partners.begin(), c.partners.end(),
                                   [](const CrowdPartner& p) { return p.kind == PartnerKind::soft; });
  if (softs >= pool)
    t.mistake("partner", std::to_string(softs) +
                             " soft neighbours and the centre need as many different packings: raise "
                             "crowd.packings_max to " +
                             std::to_string(softs + 1) + " or more");
}

}  // namespace

CrowdSetup read_crowd_setup(const SceneTable& root) {
  CrowdSetup setup;
  setup.seed = static_cast<std::uint64_t>(root.count("seed", 0, 1000000000000, 1));
  setup.spec = read_soft_particle(root);
  read_crowd(root.table_or_empty("crowd"), setup);
  for (const SceneTable& t : root.tables("configuration")) {
    setup.configurations.push_back(read_configuration(t));
    const CrowdConfiguration& c = setup.configurations.back();
    if (setup.options.relaxation == Relaxation::damped && c.stages.back().roll != 0.0)
      t.mistake("path", "\"roll\" needs motion: relaxation = \"slow-dynamics\"");
    if (t.has("packings")) setup.packings[c.name] = t.count("packings", 2, 100000, 0);
    if (root.table_or_empty("crowd").sound()) require_packings(t, c, setup.packings_max);
    for (std::size_t k = 0; k + 1 < setup.configurations.size(); ++k)
      if (setup.configurations[k].name == c.name)
        t.mistake("name", "'" + c.name + "' is there already; give another name");
  }
  if (setup.configurations.empty()) root.mistake("configuration", "at least one [[configuration]] is needed");
  return setup;
}

bool may_be_cut(const CrowdConfiguration& configuration) {
  return configuration.stages.front().move == CrowdMove::load;
}

CrowdConfiguration cut_short(const CrowdConfiguration& configuration, double depth) {
  CrowdConfiguration c = configuration;
  if (depth >= 1.0) return c;
  c.stages.resize(1);
  for (double& h : c.stages.front().overlap) h *= depth;
  return c;
}

void read_plan(const SceneTable& root, CrowdSetup& setup) {
  for (const SceneTable& t : root.tables("plan")) {
    PlannedPackings p{t.text("configuration"), t.number("depth", Unit::none, kShare, 1.0),
                      t.count("packings", 2, 100000)};
    const auto named = std::find_if(setup.configurations.begin(), setup.configurations.end(),
                                    [&](const CrowdConfiguration& c) { return c.name == p.configuration; });
    if (named == setup.configurations.end())
      t.mistake("configuration", "no [[configuration]] has this name");
    else if (p.depth < 1.0 && !may_be_cut(*named))
      t.mistake("depth", "its way begins with a slide: it cannot be cut short; leave it out");
    setup.plan.push_back(std::move(p));
  }
}

}  // namespace softgrain
