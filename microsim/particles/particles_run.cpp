#include "microsim/particles/particles_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

#include "common/core/error.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "common/neighbours/spatial_order.h"
#include "common/state/checkpoint.h"
#include "common/state/system_io.h"
#include "microsim/particles/scene_memory.h"

namespace softgrain {

namespace {

/// Steps between two looks at whether all is sound, and reports of progress.
constexpr std::int64_t kCheckInterval = 64;

/// Grains are put into spatial order from this many on, at the start and every so many steps.
constexpr Slot kOrderedGrains = 2000;
constexpr std::int64_t kOrderInterval = 8192;

/// Grains times steps between two looks for a signal.
constexpr std::int64_t kGrainStepsPerLook = 4'000'000;

using Clock = std::chrono::steady_clock;

template <int D>
class ParticlesRun {
 public:
  ParticlesRun(const ParticlesSceneOf<D>& scene, System<D> start, const ParticlesControl& control)
      : scene_(scene),
        control_(control),
        identity_(control.checkpoint.empty() ? "" : scene.text + content_of(scene, start)),
        system_(std::move(start)),
        integrator_(scene.time.step),
        guards_(scene.guards, system_),
        due_(scene.checkpoint_seconds),
        started_(Clock::now()) {}

  ParticlesResultOf<D> run();

 private:
  void begin();
  void order_grains();
  [[nodiscard]] std::int64_t next_event(std::int64_t end) const;
  [[nodiscard]] std::optional<h5::Group> open_saved() const;
  bool restore();
  void advance();
  LoopPart advance_to(std::int64_t step);
  void observe();
  void require_valid() const;
  void save_if_due();
  void save();
  void count_time();
  void record(bool with_contacts = true);
  [[nodiscard]] bool watched() const { return scene_.record && system_.particles.grains <= kMostWatched; }
  [[nodiscard]] bool frame_due() const { return scene_.output_stride > 0 && system_.step % scene_.output_stride == 0; }
  ParticlesResultOf<D> result(bool usable, const std::string& reason);

  const ParticlesSceneOf<D>& scene_;
  const ParticlesControl& control_;
  std::string identity_;
  System<D> system_;
  VelocityVerlet<D> integrator_;
  Guards<D> guards_;
  Trajectory trajectory_;
  FrameContacts frame_contacts_;
  ContactMonitor monitor_;
  LoopPart warm_up_;
  LoopPart measured_;
  CheckpointClock due_;
  Clock::time_point started_;
};

template <int D>
void ParticlesRun<D>::count_time() {
  const auto now = Clock::now();
  system_.cost.seconds += std::chrono::duration<double>(now - started_).count();
  started_ = now;
}

/// What was saved last; nothing when there is none, or none of which a copy is sound.
template <int D>
std::optional<h5::Group> ParticlesRun<D>::open_saved() const {
  std::string note;
  std::optional<h5::Group> saved;
  try {
    saved = open_checkpoint(control_.checkpoint, identity_, note);
    if (!saved) note = "no checkpoint, starting from the beginning";
  } catch (const DamagedCheckpoint& e) {
    note = std::string(e.what()) + ": the run starts afresh";
    remove_checkpoint(control_.checkpoint);
  }
  if (control_.say && !note.empty()) control_.say(note);
  return saved;
}

template <int D>
bool ParticlesRun<D>::restore() {
  if (!control_.resume || control_.checkpoint.empty()) return false;
  const std::optional<h5::Group> saved = open_saved();
  if (!saved) return false;
  h5::naming_file(control_.checkpoint, [&] {
    read_system(saved->open("system"), system_);
    trajectory_ = read_trajectory(saved->open("trajectory"));
    const auto& p = system_.particles;
    frame_contacts_ = read_frame_contacts(saved->open("frame_contacts"), static_cast<std::size_t>(p.grains),
                                          static_cast<std::size_t>(p.size()));
    monitor_.load(saved->open("contacts"));
    guards_.load(saved->open("guards"));
  });
  if (control_.say) control_.say("continuing from step " + std::to_string(system_.step));
  return true;
}

template <int D>
void ParticlesRun<D>::begin() {
  if (restore()) return;
  order_grains();
  integrator_.initialise(system_);
  require_valid();
  guards_.look(system_);
  if (watched()) monitor_.observe(system_);
  record();
}

template <int D>
void ParticlesRun<D>::record(bool with_contacts) {
  if (!scene_.record) return;
  const auto frame = static_cast<std::int64_t>(trajectory_.time.size());
  const bool contacts = with_contacts && is_snapshot(frame, scene_.frames(), scene_.snapshots);
  if (contacts) record_contacts(frame_contacts_, frame, system_);
  record_frame(trajectory_, system_);
  record_tensors(trajectory_, system_, contacts);
}

/// Grains that were neighbours drift apart; watched systems are small and keep their order.
template <int D>
void ParticlesRun<D>::order_grains() {
  if (system_.particles.grains >= kOrderedGrains && !watched()) reorder_grains(system_, spatial_order(system_));
}

/// The first step after this one at which there is something to do.
template <int D>
std::int64_t ParticlesRun<D>::next_event(std::int64_t end) const {
  if (watched()) return system_.step + 1;
  const auto next = [&](std::int64_t interval) {
    return interval > 0 ? (system_.step / interval + 1) * interval : end;
  };
  // A signal is answered within a second or so, however many grains there are.
  const std::int64_t patience = std::max<std::int64_t>(1, kGrainStepsPerLook / (system_.particles.grains + 1));
  return std::min({end, next(kCheckInterval), next(kOrderInterval), next(scene_.output_stride),
                   next(scene_.checkpoint_steps), system_.step + patience});
}

template <int D>
void ParticlesRun<D>::require_valid() const {
  const auto& p = system_.particles;
  const Slot lost = lost_particle(system_, scene_.time.step);
  if (lost < 0) return;
  const auto u = static_cast<std::size_t>(lost);
  const double move = norm(p.velocity[u]) * scene_.time.step;
  throw UnusableResult("particle " + std::to_string(p.id.empty() ? lost : p.id[u]) + " is lost: " +
                       (std::isfinite(move) && move >= p.sphere[u].r ? "it moves more than its radius in one step"
                                                                     : "its motion is not finite"));
}

template <int D>
void ParticlesRun<D>::save() {
  count_time();
  write_checkpoint(control_.checkpoint, identity_, [&](const h5::Group& root) {
    write_system(root.create("system"), system_);
    write_trajectory(root.create("trajectory"), trajectory_);
    write_frame_contacts(root.create("frame_contacts"), frame_contacts_);
    monitor_.save(root.create("contacts"));
    guards_.save(root.create("guards"));
  });
}

template <int D>
void ParticlesRun<D>::save_if_due() {
  if (control_.checkpoint.empty()) return;
  if (interrupt_requested()) {
    save();
    throw Interrupted("interrupted at step " + std::to_string(system_.step) + " of " +
                      std::to_string(scene_.time.steps) + "; go on with --resume (" + control_.checkpoint + ")");
  }
  const bool by_steps = scene_.checkpoint_steps > 0 && system_.step % scene_.checkpoint_steps == 0;
  const bool by_time = system_.step % kCheckInterval == 0 && due_.due();
  if (by_steps || by_time) save();
}

template <int D>
void ParticlesRun<D>::observe() {
  if (watched()) monitor_.observe(system_);
  if (system_.step % kCheckInterval == 0) {
    require_valid();
    if (control_.progress) control_.progress(system_.step);
  }
  if (system_.step % guards_.every() == 0) guards_.look(system_);
  if (frame_due() && system_.step < scene_.time.steps) record();
}

template <int D>
LoopPart ParticlesRun<D>::advance_to(std::int64_t step) {
  const auto from = Clock::now();
  const std::clock_t cpu_from = std::clock();
  LoopPart part{-system_.step, 0.0, 0.0, -system_.cost.contact_evaluations, -system_.neighbours.rebuilds};
  while (system_.step < step) {
    integrator_.advance(system_, next_event(step) - system_.step);
    if (system_.step % kOrderInterval == 0) order_grains();
    observe();
    save_if_due();
  }
  part.steps += system_.step;
  part.seconds = std::chrono::duration<double>(Clock::now() - from).count();
  part.cpu_seconds = static_cast<double>(std::clock() - cpu_from) / CLOCKS_PER_SEC;
  part.contact_evaluations += system_.cost.contact_evaluations;
  part.rebuilds += system_.neighbours.rebuilds;
  return part;
}

template <int D>
void ParticlesRun<D>::advance() {
  warm_up_ = advance_to(scene_.time.warm_up_steps);
  measured_ = advance_to(scene_.time.steps);
  require_valid();
  if (system_.step % guards_.every() != 0) guards_.look(system_);
}

template <int D>
ParticlesResultOf<D> ParticlesRun<D>::result(bool usable, const std::string& reason) {
  const double peak = peak_memory();  // before the copies that are made for output
  count_time();
  restore_order(system_);
  record(usable);  // who touches whom is not asked where numbers may be lost
  return {std::move(system_),
          std::move(trajectory_),
          std::move(frame_contacts_),
          watched(),
          monitor_.histories(),
          usable,
          reason,
          guards_.report(),
          warm_up_,
          measured_,
          peak};
}

template <int D>
ParticlesResultOf<D> ParticlesRun<D>::run() {
  try {
    begin();
    advance();
  } catch (const UnusableResult& e) {
    std::ostringstream reason;
    reason << e.what() << " (step " << system_.step << " of " << scene_.time.steps << ", time " << system_.time
           << " s)";
    return result(false, reason.str());
  }
  return result(true, "");
}

}  // namespace

template <int D>
Slot lost_particle(const System<D>& system, double step) {
  const auto& p = system.particles;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const double move = norm(p.velocity[u]) * step;
    const bool finite = std::isfinite(move) && std::isfinite(norm2(p.sphere[u].x)) && std::isfinite(norm2(p.spin[u]));
    if (!finite || !(move < p.sphere[u].r)) return i;
  }
  return -1;
}

template <int D>
std::string content_of(const ParticlesSceneOf<D>& scene, const System<D>& start) {
  constexpr std::size_t kPiece = std::size_t{1} << 16;  // bytes
  const auto& p = start.particles;
  std::string bytes;
  const auto add = [&bytes](double x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof x); };
  for (std::size_t u = 0; u < p.sphere.size(); ++u) {
    add(p.sphere[u].r);
    for (int k = 0; k < D; ++k) {
      add(p.sphere[u].x[k]);
      add(p.velocity[u][k]);
      if (k < static_cast<int>(p.spin[u].v.size())) add(p.spin[u][k]);
    }
    if (bytes.size() > kPiece) bytes = short_hash(bytes);
  }
  for (const Vec<D>& row : start.cell.edges.row)
    for (int k = 0; k < D; ++k) add(row[k]);
  const std::string laws = scene.law_files.empty() ? "" : "\n# laws " + short_hash(scene.law_files);
  return "\n# particles " + short_hash(bytes) + laws;
}

template <int D>
ParticlesResultOf<D> run_particles(const ParticlesSceneOf<D>& scene, System<D> start, const ParticlesControl& control) {
  return ParticlesRun<D>(scene, std::move(start), control).run();
}

template <int D>
ParticlesResultOf<D> run_particles(const ParticlesSceneOf<D>& scene, const ParticlesControl& control) {
  return run_particles(scene, scene.system, control);
}

namespace {

/// Materials of soft particles: those that some law takes as the soft body.
template <int D>
std::vector<std::int64_t> soft_materials(const System<D>& s) {
  const auto n = static_cast<std::int32_t>(s.materials.size());
  std::vector<std::int64_t> soft(s.materials.size(), 0);
  for (std::int32_t a = 0; a < n; ++a)
    for (std::int32_t b = 0; b < n; ++b) {
      const std::int32_t index = s.laws.index(a, b);
      if (index == LawSet::kNoContact) continue;
      const SoftSides sides = soft_sides(s.laws.law(index));
      if (sides.i) soft[static_cast<std::size_t>(a)] = 1;
      if (sides.j) soft[static_cast<std::size_t>(b)] = 1;
    }
  return soft;
}

template <int D>
void write_bodies(const h5::Group& g, const ParticlesSceneOf<D>& scene, const System<D>& s) {
  const auto& p = s.particles;
  const auto n = static_cast<std::size_t>(p.grains);
  std::vector<double> radius;
  std::vector<double> mass;
  for (std::size_t u = 0; u < n; ++u) {
    radius.push_back(p.sphere[u].r);
    mass.push_back(1.0 / p.inverse_mass[u]);
  }
  g.write("radius", radius);
  g.attribute_of("radius", "unit", "m");
  g.write("mass", mass);
  g.attribute_of("mass", "unit", "kg");
  std::vector<std::int64_t> id(n);
  std::iota(id.begin(), id.end(), std::int64_t{0});
  g.write("id", id);
  g.write("material", std::vector<std::int64_t>(p.material.begin(), p.material.begin() + p.grains));
  g.write("material_is_soft", soft_materials(s));
  for (std::size_t m = 0; m < s.materials.size(); ++m)
    g.attribute("material_" + std::to_string(m), s.materials[m].name);
  for (std::size_t w = 0; w < scene.wall_name.size(); ++w) g.attribute("wall_" + std::to_string(w), scene.wall_name[w]);
}

void write_histories(const h5::Group& g, const std::vector<ContactHistory>& contacts) {
  std::vector<std::int64_t> pairs;
  std::vector<double> numbers;
  for (const ContactHistory& c : contacts) {
    pairs.insert(pairs.end(), {c.i, c.j, c.count});
    numbers.insert(numbers.end(), {c.duration, c.max_force, c.max_overlap});
  }
  g.write("pair_and_count", pairs, {contacts.size(), 3});
  g.write("duration_force_overlap", numbers, {contacts.size(), 3});
  g.attribute_of("duration_force_overlap", "unit", "s, N, m");
}

}  // namespace

template <int D>
void save_particles_run(const std::string& path, const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result,
                        const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  root.attribute("kind", "particles");
  root.attribute("dimension", std::int64_t{D});
  root.attribute("status", result.usable ? "good" : "not usable");
  root.attribute("reason", result.reason);
  write_provenance(root, provenance);
  write_bodies(root.create("bodies"), scene, result.system);
  write_trajectory(root.create("trajectory"), result.trajectory);
  write_frame_contacts(root.create("frame_contacts"), result.frame_contacts);
  if (result.watched) write_histories(root.create("contacts"), result.contacts);
  write_system(root.create("final"), result.system);
  file.commit();
}

template ParticlesResultOf<2> run_particles<2>(const ParticlesSceneOf<2>&, System<2>, const ParticlesControl&);
template ParticlesResultOf<3> run_particles<3>(const ParticlesSceneOf<3>&, System<3>, const ParticlesControl&);
template ParticlesResultOf<2> run_particles<2>(const ParticlesSceneOf<2>&, const ParticlesControl&);
template ParticlesResultOf<3> run_particles<3>(const ParticlesSceneOf<3>&, const ParticlesControl&);
template Slot lost_particle<2>(const System<2>&, double);
template Slot lost_particle<3>(const System<3>&, double);
template std::string content_of<2>(const ParticlesSceneOf<2>&, const System<2>&);
template std::string content_of<3>(const ParticlesSceneOf<3>&, const System<3>&);
template void save_particles_run<2>(const std::string&, const ParticlesSceneOf<2>&, const ParticlesResultOf<2>&,
                                    const Provenance&);
template void save_particles_run<3>(const std::string&, const ParticlesSceneOf<3>&, const ParticlesResultOf<3>&,
                                    const Provenance&);

}  // namespace softgrain
