// Watches a run of explicit particles for what must not happen. Looks only: the trajectory never depends on it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/dynamics/contact_watch.h"
#include "common/io/hdf5_file.h"
#include "common/io/scene.h"
#include "common/system.h"

namespace softgrain {

enum class GuardAction {
  ignore,  ///< not looked at
  count,   ///< counted and reported
  stop     ///< the run ends, not usable, with the state as it is
};

template <>
inline constexpr auto enum_names<GuardAction> = enum_name_list<GuardAction>({{GuardAction::ignore, "ignore"},
                                                                             {GuardAction::count, "count"},
                                                                             {GuardAction::stop, "stop"}});

/// One guard: the run is looked at every so many steps, and what exceeds `limit` is answered by `action`.
struct GuardRule {
  double limit = 0.0;
  GuardAction action = GuardAction::count;
};

/// Table [guards] of a scene.
struct GuardSpec {
  /// Overlap over the smaller radius; 1: a centre has reached the other's surface.
  GuardRule overlap{1.0, GuardAction::count};
  GuardRule energy{0.05, GuardAction::stop};  ///< growth over the least so far, over the most that moved or was stored
  GuardRule escape{0.0, GuardAction::stop};   ///< a centre behind a plane, or outside `low`..`high`
  std::optional<Vec3> low{};                  ///< low corner of the region that grains may be in; empty: any
  std::optional<Vec3> high{};
  /// Displacement of walls moved by forces [m]; limit 0: twice the way through all grains.
  GuardRule wall_travel{0.0, GuardAction::stop};
};

/// `dimension` is that of the vectors. Throws InputError.
GuardSpec read_guards(const SceneTable& table, int dimension = 3);

/// What one guard saw.
struct GuardRecord {
  double worst = 0.0;       ///< largest value seen, in units of the rule
  std::int64_t count = 0;   ///< looks at which it was above the limit
  double first_time = 0.0;  ///< time of the first of these looks [s]
};

/// Everything that was seen so far.
struct GuardReport {
  std::int64_t looks = 0;
  std::int64_t every = 0;  ///< steps between two looks
  GuardRecord overlap;
  GuardRecord energy;
  GuardRecord escape;  ///< worst: grains outside at one look
  GuardRecord wall_travel;
  double wall_travel_limit = 0.0;  ///< the one in force [m]; infinite without walls moved by forces
  std::string energy_unwatched;    ///< why the energy is not watched; empty: it is
  LawUse laws;                     ///< summed over all looks
};

template <int D>
class Guards {
 public:
  /// `start`: the system before the first step, also of a run that goes on from a checkpoint.
  Guards(const GuardSpec& spec, const System<D>& start);

  /// Steps between two looks: small systems are looked at more often, so that looking never costs more than a few
  /// percent of the steps between.
  [[nodiscard]] std::int64_t every() const { return report_.every; }

  /// Looks at a state after a step. Throws UnusableResult when a guard stops the run.
  void look(const System<D>& system);

  [[nodiscard]] const GuardReport& report() const { return report_; }

  void save(const h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  struct Numbers;

  void note(const GuardRule& rule, double value, double time, GuardRecord& record, const std::string& what);
  void look_at_energy(const System<D>& s, const ContactWatch<D>& watch);
  void look_at_grains(const System<D>& s, const ContactWatch<D>& watch);
  void look_at_walls(const System<D>& s);

  GuardSpec spec_;
  bool watches_ = true;  ///< false: every guard is ignored and no law has a range
  GuardReport report_;
  std::vector<Vec<D>> wall_start_;
  double least_ = 0.0;  ///< smallest energy so far [J]
  double scale_ = 0.0;  ///< largest kinetic + stored energy so far, bound disks by amount [J]
};

}  // namespace softgrain
