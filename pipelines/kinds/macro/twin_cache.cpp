#include "pipelines/kinds/macro/twin_cache.h"

#include <fmt/format.h>

#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "macrosim/test_protocol.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

namespace {

/// Raised whenever the same key would give another curve.
constexpr int kTwinSchema = 2;

class Bytes {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(const Vec3& x) {
    for (int a = 0; a < 3; ++a) add(x[a]);
  }
  [[nodiscard]] std::string hash() const { return short_hash(bytes_); }

 private:
  std::string bytes_;
};

void add_springs(Bytes& bytes, const MacroPacking& packing) {
  for (const BodySpring& s : packing.springs) {
    bytes.add(s.i);
    bytes.add(s.j);
    bytes.add(s.spring);
  }
}

/// Every grain and shell, whom it belongs to, and the springs that the packing was prepared with.
std::string hash_of(const MacroSystem& macro, const MacroPacking& packing) {
  Bytes bytes;
  bytes.add(packing.low);
  bytes.add(packing.high);
  const auto& p = macro.system.particles;
  for (Slot u = 0; u < p.first_plane(); ++u) {
    bytes.add(p.sphere[at(u)].x);
    bytes.add(p.sphere[at(u)].r);
    bytes.add(macro.body[at(u)]);
  }
  add_springs(bytes, packing);
  return bytes.hash();
}

std::string stage_text(const MacroStage& s) {
  std::string text =
      fmt::format("{} {} {} {} {} {} {} {:.17g}", s.record.name, to_string(s.record.kind), to_string(s.record.way),
                  s.logarithmic, s.alike, s.steps, s.increments_per_step, s.tolerance);
  if (s.record.modulus_stress[1] > 0.0)
    text += fmt::format(" modulus {:.17g} {:.17g}", s.record.modulus_stress[0], s.record.modulus_stress[1]);
  for (const AxisDrive& a : s.axis) text += fmt::format(" {} {:.17g} {}", a.by_stress, a.value, a.as_at);
  return text + "\n";
}

/// Material and test.
std::string spec_text(const MacroSpec& spec, const std::vector<double>& more) {
  std::string text;
  for (const double x : {spec.youngs_modulus, spec.poisson_ratio, spec.friction, spec.wall_friction, spec.density,
                         spec.start_pressure, spec.tolerance, spec.force_floor, spec.preload})
    text += fmt::format(" {:.17g}", x);
  for (const double x : more) text += fmt::format(" {:.17g}", x);
  for (const double x : spec.splits) text += fmt::format(" split {:.17g}", x);
  text += fmt::format(" {}\n", spec.max_passes);
  for (const MacroStage& s : stages_of(spec)) text += stage_text(s);
  return text;
}

}  // namespace

std::string test_key(const MacroSpec& spec, const MacroPacking& packing) {
  Bytes bytes;
  bytes.add(packing.low);
  bytes.add(packing.high);
  for (const MacroBody& b : packing.bodies) {
    bytes.add(b.x);
    bytes.add(b.r);
  }
  add_springs(bytes, packing);
  return fmt::format("test, schema {}\n{} {} {}\n", kTwinSchema, bytes.hash(), to_string(spec.boundary),
                     to_string(spec.test)) +
         spec_text(spec, {});
}

std::string twin_key(const MacroSpec& spec, const MacroSetup& setup, const MacroPacking& packing,
                     const MacroSystem& macro, const std::string& engine, std::int64_t sample,
                     const std::string& runs) {
  std::string text =
      fmt::format("twin, schema {}\n{} {} {} of {}\n{} {} {}\n", kTwinSchema, engine, sample, hash_of(macro, packing),
                  runs, to_string(spec.boundary), to_string(spec.test), to_string(spec.twin.relaxation));
  const TwinMotion& m = spec.twin;
  text += spec_text(spec, {m.speed, m.step_factor, m.settle_time, m.restitution});
  return text + fmt::format("again {} states {}\n", sample < setup.noise_samples, sample == 0 ? setup.kept_states : 0);
}

RunOutcome kept_twin(const std::string& key, const Run& run, const std::function<RunOutcome()>& go) {
  RunOutcome out;
  const ResultCache cache(run.context.twin_cache(), "macro twin", "twin", "run again",
                          [&](const std::string& remark) { run.context.say(remark); });
  const bool found = cache.find(key, [&](const h5::Group& g) {
    out.curve = read_macro_curve(g.open("curve"));
    out.states = read_snapshot_list(g.open("states"));
  });
  if (found) return out;
  out = go();
  if (out.curve.usable)
    cache.keep(key, [&](const h5::Group& g) {
      write_macro_curve(g.create("curve"), out.curve);
      write_snapshot_list(g.create("states"), out.states);
    });
  return out;
}

}  // namespace softgrain
