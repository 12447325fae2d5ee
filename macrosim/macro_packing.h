// The initial state of a macro scene: bodies just in touch in a box. Law runs and resolved twins start from the same
// one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/core/vec.h"
#include "common/data/macro_result.h"
#include "common/io/hdf5_file.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

struct MacroBody {
  Vec3 x{};
  double r = 0.0;
  bool soft = false;
  std::int32_t material = 0;  ///< of a solid grain: place in MacroSpec::grain_materials
};

/// The history of two bodies in touch, or of a body and a wall, as laws keep it.
struct BodySpring {
  std::int32_t i = 0;
  std::int32_t j = 0;  ///< body, or bodies + number of the wall in the order of the box
  Vec3 spring{};       ///< tangential spring [m]
  Vec3 roll{};         ///< angle of rolling [rad]; 0 without rolling resistance
};

struct MacroPacking {
  Vec3 low{};  ///< corners of the box [m]
  Vec3 high{};
  std::vector<MacroBody> bodies;
  Cost cost{};                             ///< cost of the preparation
  std::vector<BodySpring> springs{};       ///< histories of a preparation with friction, sorted by i, then j
  std::optional<DensitySearch> density{};  ///< how it came to a density that was asked for

  [[nodiscard]] Vec3 size() const { return high - low; }
  [[nodiscard]] double body_volume() const;     ///< volume of solid grains and shells [m^3]
  [[nodiscard]] double solid_fraction() const;  ///< body_volume() over the volume of the box
  [[nodiscard]] double soft_volume_share() const;
  [[nodiscard]] std::int64_t soft_count() const;
};

/// The bodies of a sample, largest first and without places: solid grains alone where soft particles fill voids later.
/// Radii of power laws are drawn one by one, always of the kind that is behind its share of the volume; of other
/// distributions as Grading::draw does, in the numbers that make the share.
std::vector<MacroBody> drawn_bodies(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample);

/// Text of the distributions, or of the packing, that a scene asks for.
inline std::string sizes_text(const MacroSpec& spec) {
  return (spec.solid_sizes ? spec.solid_sizes->text() : "") +
         (spec.soft_sizes ? "soft: " + spec.soft_sizes->text() : "") + spec.packing_text;
}

/// The springs with which a test begins: between solid grains, and of solid grains with walls, where the test has
/// friction there. What soft particles bore is that of hard bodies, and forgotten.
std::vector<BodySpring> springs_of_test(const MacroSpec& spec, const MacroPacking& packing);

/// Whether any contact has rolled against a resistance.
bool any_rolls(const std::vector<BodySpring>& springs);

/// Where a preparation keeps what it has come to, so that a run that is stopped goes on from there in the same bits.
class PreparationKeeper {
 public:
  virtual ~PreparationKeeper() = default;
  /// Whether it is time to keep it.
  virtual bool due() = 0;
  virtual void save(const std::function<void(const h5::Group&)>& write) = 0;
  /// Calls `read` with what was kept last; never where nothing was.
  virtual void load(const std::function<void(const h5::Group&)>& read) = 0;
};

/// Who looks at a preparation: is told the share that is done, and keeps its states. Either may be missing.
struct PreparationWatch {
  std::function<void(double share)> progress{};
  PreparationKeeper* keeper = nullptr;

  void operator()(double share) const {
    if (progress) progress(share);
  }
  /// The same for a part of it, which begins at one share and takes another.
  [[nodiscard]] PreparationWatch part(double begin, double length) const {
    return {[tell = progress, begin, length](double share) {
              if (tell) tell(begin + length * share);
            },
            keeper};
  }
};

/// Draws bodies, places them at random without overlap, and compacts them isotropically as hard grains by spec.protocol
/// until the wall pressure is start_pressure * E; with preparation "lammps" there is no compaction. Throws InputError
/// when the shares cannot be met, UnusableResult when it does not jam.
MacroPacking make_macro_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                                const PreparationWatch& watch = {});

/// Places and compacts the given bodies, which come largest first and without places, as make_macro_packing() does.
MacroPacking pack_bodies(const MacroSpec& spec, std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample,
                         const PreparationWatch& watch = {});

void write_macro_packing(const h5::Group& group, const MacroPacking& packing);
MacroPacking read_macro_packing(const h5::Group& group);

}  // namespace softgrain
