// Watches every contact of a small system at every step: how long, how hard, how deep. Never changes the trajectory.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "common/io/hdf5_file.h"
#include "common/system.h"

namespace softgrain {

/// What happened between two bodies.
struct ContactHistory {
  Slot i = 0;
  Slot j = 0;
  std::int64_t count = 0;    ///< how many times they touched
  double duration = 0.0;     ///< total [s]
  double max_force = 0.0;    ///< largest normal force that pushes [N]; 0 when it only pulled
  double max_overlap = 0.0;  ///< [m]
};

/// Beginnings and ends are interpolated linearly between steps (free flight), maxima by a parabola through three steps.
class ContactMonitor {
 public:
  /// Observes the committed state; to be called after every step, and once before the first. Writes nothing but scratch
  /// of the contact list that the next pass overwrites.
  template <int D>
  void observe(System<D>& system);

  /// All pairs that have touched, by slots; contacts that last are counted up to the last observation.
  [[nodiscard]] std::vector<ContactHistory> histories() const;

  void save(const h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  /// Largest value of a smooth curve seen at equal steps.
  struct Peak {
    double before = std::numeric_limits<double>::quiet_NaN();  ///< none yet
    double last = std::numeric_limits<double>::quiet_NaN();
    double top = 0.0;
    void add(double value);
    void reset() { before = last = std::numeric_limits<double>::quiet_NaN(); }
  };
  struct Watched {
    std::int64_t count = 0;
    double duration = 0.0;  ///< total duration of contacts that have ended [s]
    double begin = 0.0;     ///< time at which the present contact began [s]
    double seen = 0.0;      ///< time of the last observation [s]
    double overlap = 0.0;   ///< overlap at the last observation [m]; negative: gap
    Peak force;
    Peak depth;
  };
  using Key = std::pair<Slot, Slot>;
  using Entry = std::pair<Key, Watched>;  ///< a pair and its history, as checkpoints hold them

  template <int D>
  void match_list(const ContactList<D>& contacts);
  void update(Watched& w, double time, double overlap, double force) const;

  std::map<Key, Watched> watched_;
  std::vector<Watched*> of_contact_;  ///< per entry of the list
  std::vector<double> force_;         ///< scratch, per entry of the list
  std::uint64_t build_ = 0;
};

}  // namespace softgrain
