// Particles and walls of a scene of explicit particles.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/particles.h"
#include "common/io/scene.h"
#include "common/packing/grading.h"
#include "microsim/particles/scene_contacts.h"

namespace softgrain {

/// Bodies as slots: particles in the order of the scene ([[particle]] tables, then the file), sphere-insides, planes.
template <int D>
struct SceneBodies {
  Particles<D> particles;
  std::vector<std::string>
      wall_name;  ///< slot order (from `particles.grains` on); given, or "wall-1", "wall-2"... in scene order
  std::vector<std::string> where;  ///< "file:line" of particles that have a table of their own
  std::string many_file;           ///< path of the file with the others
  Vec3 many_box{};                 ///< first line of that file [m]
  std::optional<Grading> sizes;    ///< sizes of the particles that were drawn, which have no table of their own either
  std::vector<double> drawn;       ///< radii of the particles that were drawn
  std::string drawn_where;         ///< "file:line" of their table
  std::uint64_t seed = 0;          ///< seed with which the particles were drawn
  /// Particles that no sphere-inside of the scene holds, and that do not say that this is meant.
  std::vector<Slot> outside_spheres{};

  /// "file:line" of a particle, for messages.
  [[nodiscard]] std::string where_of(Slot particle) const;
};

/// [[particle]], [particles] and [[wall]]. Throws InputError: no particle, coincident centres, a particle without
/// density, one that does not fit into its sphere, more than there is memory for; a seed, of the scene or of the
/// command line (`seed`), where nothing is drawn.
template <int D>
SceneBodies<D> read_bodies(const Scene& scene, const std::vector<Material>& materials,
                           const std::optional<std::uint64_t>& seed);

}  // namespace softgrain
