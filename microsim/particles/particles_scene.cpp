#include "microsim/particles/particles_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

#include "common/core/error.h"
#include "common/data/snapshot.h"
#include "common/io/scene.h"
#include "microsim/particles/scene_bodies.h"
#include "microsim/particles/scene_contacts.h"
#include "microsim/particles/scene_memory.h"
#include "microsim/particles/scene_walls.h"
#include "microsim/particles/trajectory.h"

namespace softgrain {

namespace {

constexpr double kMostFrameBytes = 8.0 * 1024 * 1024 * 1024;

/// Walls have no periodic images.
template <int D>
void require_walls_fit_cell(const SceneTable& root, const Cell<D>& cell) {
  if (!cell.any_periodic()) return;
  for (const SceneTable& t : root.tables("wall")) {
    if (t.choice<WallShape>("shape") != WallShape::plane)
      t.throw_error("shape", "the inside of a sphere cannot be combined with a periodic cell");
    const Vec<D> normal = read_vector<D>(t, "normal", Unit::none);
    for (int k = 0; k < D; ++k)
      if (cell.periodic[static_cast<std::size_t>(k)] && normal[k] != 0.0)
        t.throw_error("normal", "must not point along a periodic axis of the cell");
  }
}

using MaterialPairs = std::set<std::pair<std::int32_t, std::int32_t>>;

/// Materials of grains that may meet, each pair once, lower index first.
template <int D>
MaterialPairs meeting_grains(const Particles<D>& p) {
  MaterialPairs out;
  std::vector<std::int32_t> seen;
  const auto meet = [&](std::int32_t a, std::int32_t b) { out.emplace(std::min(a, b), std::max(a, b)); };
  for (Slot i = 0; i < p.grains; ++i) {
    const std::int32_t m = p.material[at(i)];
    if (std::find(seen.begin(), seen.end(), m) != seen.end()) {
      meet(m, m);
    } else {
      for (const std::int32_t other : seen) meet(m, other);
      seen.push_back(m);
    }
  }
  return out;
}

/// Materials of a grain and of a wall that it may meet.
template <int D>
MaterialPairs grains_at_walls(const Particles<D>& p) {
  MaterialPairs out;
  std::set<std::int32_t> grains;
  for (Slot i = 0; i < p.grains; ++i) {
    grains.insert(p.material[at(i)]);
    if (p.shell[at(i)] >= 0) out.emplace(p.material[at(i)], p.material[at(p.shell[at(i)])]);
  }
  for (Slot plane = p.first_plane(); plane < p.size(); ++plane)
    for (const std::int32_t m : grains) out.emplace(m, p.material[at(plane)]);
  return out;
}

template <int D>
void require_contacts(const Scene& scene, const System<D>& s) {
  MaterialPairs pairs = meeting_grains(s.particles);
  for (const auto& [m, wall] : grains_at_walls(s.particles)) pairs.emplace(std::min(m, wall), std::max(m, wall));
  for (const auto& [a, b] : pairs) {
    if (s.laws.index(a, b) != LawSet::kNoContact) continue;
    throw InputError(scene.root().where("contact") + ": contact: no law for the materials '" +
                     s.materials[static_cast<std::size_t>(a)].name + "' and '" +
                     s.materials[static_cast<std::size_t>(b)].name +
                     "', which can touch: add [[contact]] with this pair");
  }
}

/// A law of soft contacts measures overlaps by the radius of the soft body, which walls do not have; some laws know
/// walls only, or none.
template <int D>
void require_partners(const Scene& scene, const System<D>& s, const SceneLaws& laws) {
  const auto refuse = [&](std::int32_t law, const char* why) {
    throw InputError(scene.root().where("wall") + ": wall: " + laws.description[static_cast<std::size_t>(law)] + why);
  };
  for (const auto& [m, wall] : grains_at_walls(s.particles)) {
    const std::int32_t law = s.laws.index(m, wall);
    if (law == LawSet::kNoContact) continue;
    if (soft_sides(s.laws.law(law)).j) refuse(law, " makes a wall the soft body; walls must be solid");
    if (laws.scopes[static_cast<std::size_t>(law)] == LawScope::grains)
      refuse(law, D == 2 ? " attracts at a distance, which walls cannot: give the wall a material of its own and a law "
                           "with adhesion = 0, or \"linear-spring\""
                         : " was measured with grains: give the wall a material of its own and kind = \"soft-wall\"");
  }
  for (const auto& [a, b] : meeting_grains(s.particles)) {
    const std::int32_t law = s.laws.index(a, b);
    if (law != LawSet::kNoContact && laws.scopes[static_cast<std::size_t>(law)] == LawScope::walls)
      refuse(law, " was measured with walls (kind = \"soft-wall\") and would serve particles: \"soft-solid\" does");
  }
}

/// Overlaps are differences of coordinates: far from the origin nothing is left of them. At 1e-7 of the radius a slow
/// impact still comes out to a few 1e-4.
template <int D>
void require_resolved(const Scene& scene, const System<D>& s) {
  constexpr double kCoarsest = 1e-7;
  const auto& p = s.particles;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto& sphere = p.sphere[at(i)];
    double far = 0.0;
    for (int k = 0; k < D; ++k) far = std::max(far, std::abs(sphere.x[k]));
    const double spacing = std::nextafter(far, std::numeric_limits<double>::infinity()) - far;
    if (spacing <= kCoarsest * sphere.r) continue;
    std::ostringstream text;
    text << scene.root().where("particle") << ": position of particle " << i << ": " << far
         << " m from the origin numbers resolve only " << spacing << " m, " << spacing / sphere.r
         << " of its radius (at most 1e-7): move the scene to the origin";
    throw InputError(text.str());
  }
}

/// With a longer reach every disk would be a neighbour of nearly all others.
template <int D>
void require_short_reach(const SceneTable& root, const Particles<D>& p) {
  constexpr double kMostRadii = 10.0;
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) largest = std::max(largest, p.sphere[at(i)].r);
  for (const SceneTable& t : root.tables("contact"))
    if (t.text("law") == "cohesive" && t.has("range") && t.number("range", Unit::length) > kMostRadii * largest)
      t.add_error("range", fmt::format("must be at most {:.6g} m, {:g} radii of the largest particle",
                                       kMostRadii * largest, kMostRadii));
}

/// Times that come out as whole numbers of steps, where that makes a difference.
constexpr double kNotedDifference = 0.01;

std::string rounding_remark(const SceneTable& t, const char* key, double asked, double real) {
  if (!(std::abs(real - asked) > kNotedDifference * asked)) return "";
  return fmt::format("{}: {} = {:.6g} s comes out as {:.6g} s, a whole number of steps", t.where(key), key, asked,
                     real);
}

template <int D>
void note_end(const SceneTable& t, ParticlesSceneOf<D>& out) {
  if (!t.has("end") || !(out.time.step > 0.0)) return;
  const double real = static_cast<double>(out.time.steps) * out.time.step;
  if (std::string remark = rounding_remark(t, "end", out.time.end, real); !remark.empty())
    out.remarks.push_back(std::move(remark));
}

template <int D>
void read_output(const SceneTable& t, ParticlesSceneOf<D>& out) {
  out.record = t.flag({"record", "false: no trajectory is written"}, true);
  if (!out.record) t.refuse({"snapshots"}, "cannot be combined with record = false, which records nothing");
  out.snapshots = t.count({"snapshots", "number of frames that keep their contacts, evenly spread, the last included",
                           "100; above 2000 particles 200,000 over their number, at least 1"},
                          0, 1'000'000, default_snapshots(out.system.particles.grains));
  if (!t.has("every")) return;
  if (!out.record) t.add_error("every", "cannot be combined with record = false, which records nothing");
  const double every = t.number({"every", "time between frames", "start and end"}, Unit::time, Range::positive());
  if (!(out.time.step > 0.0)) return;  // nothing is known of the time
  if (out.time.is_given && every < (1.0 - kNotedDifference) * out.time.step)
    t.add_error("every", fmt::format("below the time step; allowed: at least {:.6g} s", out.time.step));
  const double steps = std::round(every / out.time.step);
  if (steps >= static_cast<double>(out.time.steps)) return;
  out.output_stride = std::max<std::int64_t>(1, static_cast<std::int64_t>(steps));
  if (std::string remark = rounding_remark(t, "every", every, static_cast<double>(out.output_stride) * out.time.step);
      !remark.empty())
    out.remarks.push_back(std::move(remark));
  const double frames = static_cast<double>(out.time.steps) / static_cast<double>(out.output_stride);
  const double bytes = frames * 72.0 * static_cast<double>(out.system.particles.size());
  if (bytes > kMostFrameBytes)
    t.add_error("every", std::to_string(static_cast<std::int64_t>(frames)) + " frames take " +
                             std::to_string(bytes / 1e9) + " GB of memory, at most 8.6 are allowed");
}

template <int D>
void read_checkpoint(const SceneTable& t, ParticlesSceneOf<D>& out) {
  out.checkpoint_steps = t.count({"every_steps", "steps between checkpoints; 0: by time alone"}, 0,
                                 std::int64_t{1} << 53, out.checkpoint_steps);
  out.checkpoint_seconds = t.number({"every_seconds", "wall time between checkpoints"}, Unit::time, Range::positive(),
                                    out.checkpoint_seconds);
}

}  // namespace

int particles_dimension(const Scene& scene) {
  return static_cast<int>(scene.root().count({"dimension", "3: spheres; 2: disks"}, 2, 3, 3));
}

namespace {

/// What no table shows by itself.
template <int D>
void validate_combination(const Scene& scene, const System<D>& s, const SceneLaws& laws) {
  const SceneTable root = scene.root();
  require_walls_fit_cell(root, s.cell);
  require_contacts(scene, s);
  require_resolved(scene, s);
  require_partners(scene, s, laws);
  require_short_reach(root, s.particles);
  require_wide_cell(root, s);
}

}  // namespace

template <int D>
ParticlesSceneOf<D> read_particles_scene(const Scene& scene, const std::optional<std::uint64_t>& seed) {
  if (particles_dimension(scene) != D) throw std::logic_error("a scene of another number of dimensions");
  return scene.read([&](const SceneTable& root) {
    (void)root.choice(kKindKey, {"particles"});
    ParticlesSceneOf<D> out;
    out.title = root.title();
    out.text = scene.text();
    System<D>& s = out.system;
    s.gravity = read_vector<D>(root, {"gravity", "acceleration vector"}, Unit::acceleration, {});
    s.materials = read_materials(root, D);
    SceneLaws laws = read_contacts(scene, s.materials, D);
    s.laws = laws.laws;
    out.law_files = std::move(laws.files);
    out.remarks = laws.remarks;
    SceneBodies<D> bodies = read_bodies<D>(scene, s.materials, seed);
    root.table_or_empty({"cell", "box with edges, periodic along some or all axes"}).section([&] {
      s.cell = read_cell(root, bodies);
    });
    if (!root.has_errors()) require_distinct_centres(bodies, s.cell);
    s.particles = std::move(bodies.particles);
    if (bodies.sizes) out.law_files += bodies.sizes->text();
    out.sizes = std::move(bodies.sizes);
    out.drawn = std::move(bodies.drawn);
    out.seed = bodies.seed;
    out.wall_name = std::move(bodies.wall_name);
    if (!root.has_errors()) root.check([&] { validate_combination(scene, s, laws); });
    const SceneTable time = root.table({"time", "simulated time and time step"});
    time.section([&] { out.time = read_time(time, s, laws.description, !root.has_errors()); });
    note_end(time, out);
    read_output(root.table_or_empty({"output", "what is recorded of the run"}), out);
    read_checkpoint(root.table_or_empty({"checkpoint", "how often the state is saved for `--resume`"}), out);
    out.guards = read_guards(root.table_or_empty({"guards", "checks of the running simulation"}), D);
    if (!root.has_errors())
      root.check([&] {
        for (std::string& r : place_remarks(bodies, s, out.wall_name, out.guards, root.has("cell")))
          out.remarks.push_back(std::move(r));
      });
    return out;
  });
}

template ParticlesSceneOf<2> read_particles_scene<2>(const Scene&, const std::optional<std::uint64_t>&);
template ParticlesSceneOf<3> read_particles_scene<3>(const Scene&, const std::optional<std::uint64_t>&);

}  // namespace softgrain
