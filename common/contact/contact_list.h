// The contacts and near pairs of a system with their history: structure of arrays, sorted, in sections of one geometry
// and law.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/contact/contact_state.h"
#include "common/core/particles.h"

namespace softgrain {

/// What a pass does with the history of contacts.
enum class History {
  next,     ///< new history goes to spring_next; the committed one stays (states that may be thrown away)
  advance,  ///< the committed history is overwritten: the state is accepted before it is known
  none      ///< forces only
};

enum class Geometry : std::int32_t { sphere_sphere, sphere_shell, sphere_plane };

/// A run of contacts that share geometry and law, so that both are types inside the loop.
struct ContactSection {
  std::int32_t begin = 0;
  std::int32_t end = 0;
  Geometry geometry = Geometry::sphere_sphere;
  std::int32_t law = 0;
};

/// A soft particle with a pair in the list under a law with a particle pass.
struct MultiContactBody {
  Slot body = 0;
  std::int32_t law = 0;  ///< one of them
};

/// What a pass over the list keeps for the next one. It stays with a list and does not go with its copies.
class PassPlan {
 public:
  PassPlan() = default;
  PassPlan(const PassPlan&) {}
  PassPlan(PassPlan&&) noexcept = default;
  PassPlan& operator=(const PassPlan& other) {
    if (this != &other) kept_.reset();
    return *this;
  }
  PassPlan& operator=(PassPlan&&) noexcept = default;
  ~PassPlan() = default;

  /// The plan, made when there is none.
  template <class Plan>
  Plan& get() {
    if (!kept_) kept_ = std::make_shared<Plan>();
    return *static_cast<Plan*>(kept_.get());
  }

 private:
  std::shared_ptr<void> kept_;
};

template <int D>
struct ContactList {
  std::vector<Slot> i;                   ///< a grain, always
  std::vector<Slot> j;                   ///< grain (j > i), shell or plane
  std::vector<std::int32_t> image;       ///< periodic image of j, see Cell
  std::vector<PairConstants> constants;  ///< pair constants of the law
  std::vector<Stored<D>> spring;         ///< committed history
  std::vector<Stored<D>> spring_next;    ///< history of the state tried last; there after the first pass that tries
  std::vector<double> memory;  ///< committed history of laws with a memory; empty when no law of the scene has one
  std::vector<double> memory_next;
  std::vector<Stored<D>> roll;  ///< committed history of laws with rolling resistance in space; empty without them
  std::vector<Stored<D>> roll_next;
  std::vector<std::uint8_t> touched;  ///< 0: the committed history is known to be empty
  std::vector<MultiContactSum<D>>
      particle_sum;            ///< scratch of laws with a particle pass, per body; empty when no law has one
  std::vector<double> lost_i;  ///< scratch per touching pair: what it takes from body i, if soft
  std::vector<double> lost_j;
  std::vector<MultiContactBody> multi_contact_bodies;  ///< whose sums are asked for, by laws, then by bodies
  std::vector<ContactSection> sections;
  PassPlan plan;            ///< plan of the pass on several threads
  bool has_spring = false;  ///< some law of the scene has a tangential spring
  bool has_memory = false;
  bool has_roll = false;
  std::uint64_t build = 0;  ///< number of the build, unique in the process; not part of a saved state

  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(i.size()); }

  /// Room for the history of a state that is tried.
  void make_next() {
    spring_next.resize(spring.size());
    memory_next.resize(memory.size());
    roll_next.resize(roll.size());
  }

  /// The state tried last becomes the state that is.
  void commit() {
    if (has_spring) spring.swap(spring_next);
    if (has_memory) memory.swap(memory_next);
    if (has_roll) roll.swap(roll_next);
    std::fill(touched.begin(), touched.end(), std::uint8_t{1});
  }
};

}  // namespace softgrain
