#include "microsim/particles/particles_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "common/core/error.h"
#include "microsim/particles/frame_contacts.h"
#include "microsim/particles/scene_bodies.h"
#include "microsim/particles/scene_cell.h"
#include "microsim/particles/scene_memory.h"

namespace softgrain {

namespace {

constexpr double kMostFrameBytes = 8.0 * 1024 * 1024 * 1024;

std::size_t at(Slot slot) { return static_cast<std::size_t>(slot); }

/// Walls have no periodic images.
void require_walls_fit_cell(const SceneTable& root, const Cell<3>& cell) {
  if (!cell.any_periodic()) return;
  for (const SceneTable& t : root.tables("wall")) {
    if (t.text("shape") != "plane") t.reject("shape", "the inside of a sphere cannot be combined with a periodic cell");
    const Vec3 normal = t.vector3("normal", Unit::none);
    for (int k = 0; k < 3; ++k)
      if (cell.periodic[static_cast<std::size_t>(k)] && normal[k] != 0.0)
        t.reject("normal", "must not point along a periodic axis of the cell");
  }
}

/// Materials that may meet, each pair once, lower index first.
std::set<std::pair<std::int32_t, std::int32_t>> meeting_materials(const Particles<3>& p) {
  std::set<std::pair<std::int32_t, std::int32_t>> out;
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
    if (p.shell[at(i)] >= 0) meet(m, p.material[at(p.shell[at(i)])]);
  }
  for (Slot plane = p.first_plane(); plane < p.size(); ++plane)
    for (const std::int32_t m : seen) meet(m, p.material[at(plane)]);
  return out;
}

void require_contacts(const Scene& scene, const System3& s) {
  for (const auto& [a, b] : meeting_materials(s.particles)) {
    if (s.laws.index(a, b) != LawSet::kNoContact) continue;
    throw BadInput(scene.root().where("contact") + ": contact: no law for the materials '" +
                   s.materials[static_cast<std::size_t>(a)].name + "' and '" +
                   s.materials[static_cast<std::size_t>(b)].name +
                   "', which can touch: add [[contact]] with this pair");
  }
}

/// A law of soft contacts measures overlaps by the radius of the soft body, which walls do not have.
void require_walls_solid(const Scene& scene, const System3& s, const std::vector<std::string>& description) {
  const auto& p = s.particles;
  for (Slot wall = p.grains; wall < p.size(); ++wall)
    for (Slot i = 0; i < p.grains; ++i) {
      const std::int32_t index = s.laws.index(p.material[at(i)], p.material[at(wall)]);
      if (index == LawSet::kNoContact) continue;
      const auto* law = std::get_if<SoftContact>(&s.laws.law(index));
      if (law != nullptr && (law->partner_is_soft || !law->i_is_soft))
        throw BadInput(scene.root().where("wall") + ": wall: " + description[static_cast<std::size_t>(index)] +
                       " makes a wall the soft body; walls must be solid");
    }
}

/// Overlaps are differences of coordinates: far from the origin nothing is left of them. At 1e-7 of the radius a slow
/// impact still comes out to a few 1e-4.
void require_resolved(const Scene& scene, const System3& s) {
  constexpr double kCoarsest = 1e-7;
  const auto& p = s.particles;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto& sphere = p.sphere[at(i)];
    double far = 0.0;
    for (int k = 0; k < 3; ++k) far = std::max(far, std::abs(sphere.x[k]));
    const double spacing = std::nextafter(far, std::numeric_limits<double>::infinity()) - far;
    if (spacing <= kCoarsest * sphere.r) continue;
    std::ostringstream text;
    text << scene.root().where("particle") << ": position of particle " << i << ": " << far
         << " m from the origin numbers resolve only " << spacing << " m, " << spacing / sphere.r
         << " of its radius (at most 1e-7): move the scene to the origin";
    throw BadInput(text.str());
  }
}

void read_output(const SceneTable& t, ParticlesScene& out) {
  out.record = t.flag("record", true);
  if (!out.record && t.has("snapshots"))
    t.reject("snapshots", "cannot be combined with record = false, which records nothing");
  out.snapshots = t.count("snapshots", 0, 1'000'000, default_snapshots(out.system.particles.grains));
  if (!t.has("every")) return;
  if (!out.record) t.reject("every", "cannot be combined with record = false, which records nothing");
  const double every = t.number("every", Unit::time, Range::positive());
  const double steps = std::round(every / out.time.step);
  if (steps >= static_cast<double>(out.time.steps)) return;
  out.output_stride = std::max<std::int64_t>(1, static_cast<std::int64_t>(steps));
  const double frames = static_cast<double>(out.time.steps) / static_cast<double>(out.output_stride);
  const double bytes = frames * 72.0 * static_cast<double>(out.system.particles.size());
  if (bytes > kMostFrameBytes)
    t.reject("every", std::to_string(static_cast<std::int64_t>(frames)) + " frames take " +
                          std::to_string(bytes / 1e9) + " GB of memory, at most 8.6 are allowed");
}

void read_checkpoint(const SceneTable& t, ParticlesScene& out) {
  out.checkpoint_steps = t.count("every_steps", 0, std::int64_t{1} << 53, out.checkpoint_steps);
  out.checkpoint_seconds = t.number("every_seconds", Unit::time, Range::positive(), out.checkpoint_seconds);
}

}  // namespace

ParticlesScene read_particles_scene(const Scene& scene) {
  const SceneTable root = scene.root();
  (void)root.choice("kind", {"particles"});
  ParticlesScene out;
  out.title = root.text("title", "");
  out.text = scene.text();
  System3& s = out.system;
  s.gravity = root.vector3("gravity", Unit::acceleration, {});
  s.materials = read_materials(root);
  SceneLaws laws = read_contacts(scene, s.materials);
  s.laws = std::move(laws.laws);
  SceneBodies bodies = read_bodies(scene, s.materials);
  s.cell = read_cell(root, bodies);
  s.particles = std::move(bodies.particles);
  out.wall_name = std::move(bodies.wall_name);
  require_walls_fit_cell(root, s.cell);
  require_contacts(scene, s);
  require_resolved(scene, s);
  require_walls_solid(scene, s, laws.description);
  out.time = read_time(root.table("time"), s, laws.description);
  require_wide_cell(root, s.particles, s.cell);
  read_output(root.table_or_empty("output"), out);
  read_checkpoint(root.table_or_empty("checkpoint"), out);
  out.guards = read_guards(root.table_or_empty("guards"));
  root.finish();
  return out;
}

}  // namespace softgrain
