#include "microsim/particles/particles_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// Particles in the same wrong place: the first of them, what is wrong with it, and how many there are.
struct Misplaced {
  Slot first = -1;
  std::string what;
  std::int64_t count = 0;

  void add(Slot particle, const std::string& problem) {
    if (count++ > 0) return;
    first = particle;
    what = problem;
  }
};

template <int D>
class PlaceCheck {
 public:
  PlaceCheck(const SceneBodies<D>& bodies, const System<D>& system, const std::vector<std::string>& wall_name,
             const GuardSpec& guards)
      : bodies_(bodies), s_(system), wall_name_(wall_name), guards_(guards) {}

  std::vector<std::string> remarks(bool has_cell) {
    if (guards_.escape.action != GuardAction::ignore) {
      escaped(behind_planes());
      escaped(outside_room());
    } else {
      remark(behind_planes());
    }
    remark(outside_spheres());
    if (has_cell) remark(outside_cell());
    return std::move(remarks_);
  }

 private:
  [[nodiscard]] const Vec<D>& centre(Slot i) const { return s_.particles.sphere[at(i)].x; }

  [[nodiscard]] std::string text(const Misplaced& m) const {
    return fmt::format("{}: position: {}{}", bodies_.where_of(m.first), m.what,
                       m.count > 1 ? fmt::format(" (and {} more)", m.count - 1) : "");
  }
  void remark(const Misplaced& m) {
    if (m.count > 0) remarks_.push_back(text(m));
  }
  /// What guards.escape stops is refused before the run.
  void escaped(const Misplaced& m) {
    if (m.count > 0 && guards_.escape.action == GuardAction::stop) throw InputError(text(m));
    remark(m);
  }

  [[nodiscard]] Misplaced behind_planes() const {
    Misplaced out;
    const auto& p = s_.particles;
    for (Slot i = 0; i < p.grains; ++i)
      for (Slot plane = p.first_plane(); plane < p.size(); ++plane) {
        const double height = dot(p.normal_of(plane), centre(i) - p.sphere[at(plane)].x);
        if (height >= 0.0) continue;
        out.add(i, fmt::format("the centre of particle {} is {:.3g} m behind the wall '{}', whose normal points to "
                               "where particles are; move the particle, or turn the normal",
                               i, -height, wall_name_[at(plane - p.grains)]));
        break;
      }
    return out;
  }

  [[nodiscard]] Misplaced outside_room() const {
    Misplaced out;
    for (Slot i = 0; i < s_.particles.grains; ++i)
      for (int k = 0; k < D; ++k) {
        const double x = centre(i)[k];
        if (!(guards_.low && x < (*guards_.low)[k]) && !(guards_.high && x > (*guards_.high)[k])) continue;
        out.add(i,
                fmt::format("the centre of particle {} is outside the room of guards.escape (its low and high): {} = "
                            "{:.6g} m",
                            i, "xyz"[k], x));
        break;
      }
    return out;
  }

  [[nodiscard]] Misplaced outside_spheres() const {
    Misplaced out;
    for (const Slot i : bodies_.outside_spheres)
      out.add(i, fmt::format("the centre of particle {} is outside every wall of shape \"sphere-inside\", so that it "
                             "touches none of them; inside = \"none\" says that this is meant",
                             i));
    return out;
  }

  [[nodiscard]] Misplaced outside_cell() const {
    Misplaced out;
    for (Slot i = 0; i < s_.particles.grains; ++i)
      for (int k = 0; k < D; ++k) {
        const double x = centre(i)[k];
        const double size = s_.cell.edges[k][k];
        if (s_.cell.periodic[static_cast<std::size_t>(k)] || (x >= 0.0 && x <= size)) continue;
        out.add(i, fmt::format("the centre of particle {} is outside the cell: {} = {:.6g} m, not from 0 to {:.6g} m; "
                               "the cell is not periodic along {}, so that nothing brings the particle back",
                               i, "xyz"[k], x, size, "xyz"[k]));
        break;
      }
    return out;
  }

  const SceneBodies<D>& bodies_;
  const System<D>& s_;
  const std::vector<std::string>& wall_name_;
  const GuardSpec& guards_;
  std::vector<std::string> remarks_;
};

}  // namespace

template <int D>
std::vector<std::string> place_remarks(const SceneBodies<D>& bodies, const System<D>& system,
                                       const std::vector<std::string>& wall_name, const GuardSpec& guards,
                                       bool has_cell) {
  return PlaceCheck<D>(bodies, system, wall_name, guards).remarks(has_cell);
}

template std::vector<std::string> place_remarks<2>(const SceneBodies<2>&, const System<2>&,
                                                   const std::vector<std::string>&, const GuardSpec&, bool);
template std::vector<std::string> place_remarks<3>(const SceneBodies<3>&, const System<3>&,
                                                   const std::vector<std::string>&, const GuardSpec&, bool);

}  // namespace softgrain
