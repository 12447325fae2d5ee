#include "pipelines/kinds/macro/twin_cache.h"

#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "macrosim/test_protocol.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

namespace {

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
    bytes.add(s.roll);
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

/// Laws do not matter to a twin, and the file that places came from is in the hash of the places.
MacroSpec without_laws(MacroSpec spec) {
  const MacroSpec none;
  spec.kt_secant = none.kt_secant;
  spec.packing_text = none.packing_text;
  return spec;
}

int schema_of(const MacroSpec& spec) { return any_slides(stages_of(spec)) ? kSlidingTwinSchema : kTwinSchema; }

/// What a setup says of one sample beside its spec and its packing. Bands and law_increments are of runs with laws.
KeyText& add_setup(KeyText& key, const MacroSetup& setup, std::int64_t sample) {
  // Every member: one more does not compile until it is named here, and part of the key or known to change nothing.
  const auto& [spec, samples, twins, given, kept_states, bands, estimator, law_increments, noise_samples, assumed,
               start_stress, density, said] = setup;
  return key.add(sample < noise_samples).add(sample == 0 ? kept_states : 0);
}

}  // namespace

std::string test_key(const MacroSetup& setup, const MacroPacking& packing, std::int64_t sample) {
  Bytes bytes;
  bytes.add(packing.low);
  bytes.add(packing.high);
  for (const MacroBody& b : packing.bodies) {
    bytes.add(b.x);
    bytes.add(b.r);
    bytes.add(b.soft);
    if (b.material != 0) bytes.add(b.material);
  }
  add_springs(bytes, packing);
  KeyText key("test", schema_of(setup.spec), bytes.hash(), without_laws(setup.spec), setup.law_increments);
  return add_setup(key, setup, sample).text();
}

std::string twin_key(const MacroSpec& spec, const MacroSetup& setup, const MacroPacking& packing,
                     const MacroSystem& macro, const std::string& engine, std::int64_t sample,
                     const std::string& runs) {
  KeyText key("twin", schema_of(spec), engine, sample, hash_of(macro, packing), runs, without_laws(spec));
  return add_setup(key, setup, sample).text();
}

RunOutcome kept_twin(const std::string& key, const Run& run, const std::function<RunOutcome()>& go) {
  static const KeptForm<RunOutcome> form{
      "macro twin",
      "twin",
      "run again",
      [](const h5::Group& g) {
        return RunOutcome{read_macro_curve(g.open("curve")), read_snapshot_list(g.open("states"))};
      },
      [](const h5::Group& g, const RunOutcome& out) {
        write_macro_curve(g.create("curve"), out.curve);
        write_snapshot_list(g.create("states"), out.states);
      },
      [](const RunOutcome& out) { return out.curve.usable; }};
  return run.get_or_make(form, "", run.context.twin_cache(), key, go);
}

}  // namespace softgrain
