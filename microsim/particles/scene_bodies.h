// Particles and walls of a scene of explicit particles; particles from files of many spheres; particles that are drawn
// by a distribution of sizes and placed at random.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/cell.h"
#include "common/core/particles.h"
#include "common/core/vec.h"
#include "common/io/scene.h"
#include "common/packing/grading.h"
#include "microsim/particles/scene_contacts.h"

namespace softgrain {

// Files of many spheres: "N Lx Ly Lz" on the first line, then N lines "x y z r". Plain or compressed by gzip. SI
// units.

struct XyzrFile {
  Vec3 box{};                  ///< Lx Ly Lz [m], as written
  std::vector<Vec3> position;  ///< [m]
  std::vector<double> radius;  ///< [m], > 0
};

/// Line of a sphere in its file.
inline std::int64_t xyzr_line(std::size_t sphere) { return static_cast<std::int64_t>(sphere) + 2; }

/// Throws InputError ("file:line: ...") for wrong content, IoError for missing, unreadable or damaged files. `admit`
/// hears the number of spheres before they are read and throws when that is too many; may be empty.
XyzrFile read_xyzr(const std::string& path, const std::function<void(std::int64_t)>& admit = {});

template <int D>
struct SceneWall;  // scene_walls.h

template <int D>
struct DrawnParticles {
  std::vector<Vec<D>> position;
  std::vector<double> radius;  ///< largest first
  std::optional<Grading> sizes;
  std::uint64_t seed = 1;  ///< they were drawn with
};

/// `count`, `sizes`, `seed` (or that of the root; `seed` of the command line goes first), `low` and `high` (corners of
/// the box of places; without them [cell]) of the table `t` = [particles]: largest first at random places, without
/// overlap with each other, with `others` or with walls, nor with images in a periodic cell; `in_file`: edges of a cell
/// with size = "file". Throws InputError when one finds none.
template <int D>
DrawnParticles<D> read_drawn(const SceneTable& root, const SceneTable& t, const std::vector<SceneWall<D>>& walls,
                             const std::vector<NewBody<D>>& others, const Vec3& in_file,
                             const std::optional<std::uint64_t>& seed);

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

/// Throws InputError for two particles at one place, or at places that periods of the cell bring together.
template <int D>
void require_distinct_centres(const SceneBodies<D>& bodies, const Cell<D>& cell);

}  // namespace softgrain
