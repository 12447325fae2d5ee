// A trial of results/law_memory: soft particles of multi-contact laws with a memory, linked around the program as it is
// (build.sh). Not part of any build. By the environment: MEMORY_A (A of the form `shear`), MEMORY_WORK=1 (the form `work`
// instead of `shear`), MEMORY_S (s of the form `maximum`, which the program has as `unloading_ratio`; with MEMORY_A the
// form `both`); without them the program computes as it does.
//
// The state of a particle moves when a strained box is strained again: what was at rest before is kept. One law at a
// time (a scene with `forms` of one name, --threads 1). Restarts forget the state.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "common/dynamics/parallel_pass.h"
#include "macrosim/macro_system.h"

namespace softgrain::law_memory {

namespace {

double number(const char* name, double otherwise) {
  const char* const value = std::getenv(name);
  return value != nullptr ? std::atof(value) : otherwise;
}

const double kSteeper = number("MEMORY_S", 1.0);
const double kCompaction = number("MEMORY_A", 0.0);
const bool kByWork = number("MEMORY_WORK", 0.0) > 0.0;

bool is_on() { return kSteeper > 1.0 || kCompaction > 0.0; }

/// Of a soft particle.
struct Memory {
  double largest = 0.0;  ///< M, largest S - J so far
  double onset = 0.0;    ///< J, by which the onset has moved
  double volume = 0.0;   ///< S when it was kept last
  double stored = 0.0;   ///< Q then
};

std::vector<Memory> memories;
/// Lost volume of each contact when it was kept last: body, the other one.
std::map<std::pair<Slot, Slot>, double> lost_before;

void forget() {
  memories.clear();
  lost_before.clear();
}

/// Integral of the pressure over the volume [E R^3].
double energy(const MultiContactPressure& pressure, double volume) {
  constexpr int kParts = 200;
  double sum = 0.0;
  for (int k = 0; k < kParts && volume > 0.0; ++k) sum += pressure.at((k + 0.5) * volume / kParts).p * volume / kParts;
  return sum;
}

template <class Law>
void close_with_memory(const Law& law, const Memory& memory, MultiContactSum<3>& sum) {
  const double volume = law.equivalent(sum);
  double seen = volume - memory.onset;
  double steeper = 1.0;
  if (kSteeper > 1.0 && seen < memory.largest) {
    seen = memory.largest - kSteeper * (memory.largest - seen);
    steeper = kSteeper;
  }
  sum.gain = 0.0;
  sum.gain_slope = 0.0;
  if (!(seen > 0.0)) return;
  const auto [p, slope] = law.form.pressure.at(seen);
  sum.gain = p / volume;
  sum.gain_slope = (steeper * slope - sum.gain) / (volume * volume);
}

/// The closed sums of a thread's bodies, anew.
void close_again(System3& s, const ThreadPart& part) {
  if (!is_on()) return;
  if (memories.size() < s.contacts.particle_sum.size()) memories.resize(s.contacts.particle_sum.size());
  for (const MultiContactBody& one : s.contacts.multi_contact_bodies) {
    if (part.owner != nullptr && part.owner[at(one.body)] != part.thread) continue;
    MultiContactSum<3>& sum = s.contacts.particle_sum[at(one.body)];
    if (!(sum.square > 0.0)) continue;
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (Law::traits.needs_particle_pass) close_with_memory(law, memories[at(one.body)], sum);
        },
        s.laws.law(one.law));
  }
}

/// What every contact takes from its soft bodies; the sums have just been made.
std::map<std::pair<Slot, Slot>, double> lost_now(const System3& s) {
  constexpr std::int32_t kSoft = 1;  // material, see make_law_system()
  const auto& p = s.particles;
  std::map<std::pair<Slot, Slot>, double> out;
  for (std::size_t c = 0; c < s.contacts.i.size(); ++c) {
    const Slot i = s.contacts.i[c];
    const Slot j = s.contacts.j[c];
    const bool plane = j >= p.first_plane();
    const Vec3 apart = p.sphere[at(i)].x - p.sphere[at(j)].x;
    const double distance = plane ? dot(apart, p.normal_of(j)) : norm(apart);
    if (distance >= p.sphere[at(i)].r + p.sphere[at(j)].r) continue;
    if (p.material[at(i)] == kSoft) out[{i, j}] = s.contacts.lost_i[c];
    if (!plane && p.material[at(j)] == kSoft) out[{j, i}] = s.contacts.lost_j[c];
  }
  return out;
}

void keep(const MultiContactPressure& pressure, double unlike, double volume, Memory& memory) {
  const double middle = 0.5 * (volume + memory.volume) - memory.onset;
  const double p = middle > 0.0 ? pressure.at(middle).p : 0.0;
  if (kCompaction > 0.0 && p > 0.0) {
    if (kByWork) unlike = std::max(unlike - std::abs(energy(pressure, volume - memory.onset) - memory.stored) / p, 0.0);
    memory.onset += kCompaction * unlike;
  }
  memory.volume = volume;
  if (kByWork) memory.stored = energy(pressure, volume - memory.onset);
  memory.largest = std::max(memory.largest, volume - memory.onset);
}

void keep_all(System3& s) {
  auto now = lost_now(s);
  const std::size_t bodies = s.contacts.particle_sum.size();
  std::vector<double> moved(bodies);
  std::vector<double> change(bodies);
  std::vector<double> volume(bodies);
  for (const auto& [contact, nu] : now) {
    const auto before = lost_before.find(contact);
    const double more = nu - (before == lost_before.end() ? 0.0 : before->second);
    moved[at(contact.first)] += std::abs(more);
    change[at(contact.first)] += more;
    volume[at(contact.first)] += nu;
  }
  for (const auto& [contact, nu] : lost_before)
    if (!now.contains(contact)) {
      moved[at(contact.first)] += nu;
      change[at(contact.first)] -= nu;
    }
  lost_before = std::move(now);
  std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (Law::traits.needs_particle_pass)
          for (std::size_t b = 0; b < bodies; ++b)
            if (volume[b] > 0.0 || memories[b].volume > 0.0)
              keep(law.form.pressure, moved[b] - std::abs(change[b]), volume[b], memories[b]);
      },
      s.laws.law(s.contacts.multi_contact_bodies.front().law));
}

}  // namespace

// What the linker puts around functions of the program (--wrap).

#define LAW_MEMORY_CLOSE "_ZN9softgrain19close_particle_sumsILi3EEEvRNS_6SystemIXT_EEENS_10ThreadPartE"
#define LAW_MEMORY_PASS "_ZN9softgrain13particle_passILi3EEEvRNS_6SystemIXT_EEE"
#define LAW_MEMORY_MOVE "_ZN9softgrain8displaceILi3EEEvRNS_6SystemIXT_EEERKSt6vectorINS_3VecIXT_EdEESaIS6_EE"
#define LAW_MEMORY_MAKE "_ZN9softgrain15make_law_systemERKNS_9MacroSpecERKNS_12MacroPackingERKNS_8SoftLawsEd"

void real_close(System3&, ThreadPart) asm("__real_" LAW_MEMORY_CLOSE);
void wrap_close(System3&, ThreadPart) asm("__wrap_" LAW_MEMORY_CLOSE);
void wrap_close(System3& s, ThreadPart part) {
  real_close(s, part);
  close_again(s, part);
}

void real_pass(System3&) asm("__real_" LAW_MEMORY_PASS);
void wrap_pass(System3&) asm("__wrap_" LAW_MEMORY_PASS);
void wrap_pass(System3& s) {
  real_pass(s);
  close_again(s, {});
}

void real_move(System3&, const std::vector<Vec3>&) asm("__real_" LAW_MEMORY_MOVE);
void wrap_move(System3&, const std::vector<Vec3>&) asm("__wrap_" LAW_MEMORY_MOVE);
void wrap_move(System3& s, const std::vector<Vec3>& moves) {
  if (is_on() && !s.contacts.particle_sum.empty() && !s.contacts.multi_contact_bodies.empty()) {
    wrap_pass(s);
    keep_all(s);
  }
  real_move(s, moves);
}

MacroSystem real_make(const MacroSpec&, const MacroPacking&, const SoftLaws&, double) asm("__real_" LAW_MEMORY_MAKE);
MacroSystem wrap_make(const MacroSpec&, const MacroPacking&, const SoftLaws&, double) asm("__wrap_" LAW_MEMORY_MAKE);
MacroSystem wrap_make(const MacroSpec& spec, const MacroPacking& packing, const SoftLaws& laws, double fraction) {
  forget();
  return real_make(spec, packing, laws, fraction);
}

}  // namespace softgrain::law_memory
