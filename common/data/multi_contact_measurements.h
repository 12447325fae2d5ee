// What was recorded of a soft particle with several neighbours at once [SP 1.7, 1.7.1]: which bodies touch it, how
// deep each one presses and what force each one feels. Dimensionless, so one record serves every E and Rs [SP 1.6].
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/core/vec.h"
#include "common/data/measurements.h"

namespace softgrain {

/// Name in a run directory, and that of earlier versions, which is still read.
inline constexpr const char* kMultiContactFile = "multi_contact.h5";
inline constexpr const char* kEarlierMultiContactFile = "crowd.h5";

/// What presses on the soft particle that is measured.
enum class PartnerKind { plane, solid, soft };

template <>
inline constexpr auto enum_names<PartnerKind> = enum_name_list<PartnerKind>({{PartnerKind::plane, "plane"},
                                                                             {PartnerKind::solid, "solid"},
                                                                             {PartnerKind::soft, "soft"}});

/// One neighbour. It is moved towards the centre and never by forces, but for a soft one that planes press on all
/// sides: those are led, and its shell moves and turns with the forces of its grains.
struct MultiContactPartner {
  PartnerKind kind = PartnerKind::plane;
  double ratio = 0.0;    ///< its radius over Rs; 0 for planes (infinite)
  Vec3 direction{};      ///< unit vector from the centre of the soft particle to the neighbour
  bool smooth = false;   ///< a plane without friction; else mu is that of the grains
  std::int32_t on = -1;  ///< < 0: touches the centre; else a plane around the soft neighbour of this number, from whose
                         ///< centre its direction and overlap [Rs] are counted
};

enum class MultiContactMove {
  load,
  unload,
  reload,
  slide,
  oblique,  ///< pressed and slid at once
  roll      ///< the first neighbour rolls over the soft particle, at constant overlaps
};

template <>
inline constexpr auto enum_names<MultiContactMove> =
    enum_name_list<MultiContactMove>({{MultiContactMove::load, "load"},
                                      {MultiContactMove::unload, "unload"},
                                      {MultiContactMove::reload, "reload"},
                                      {MultiContactMove::slide, "slide"},
                                      {MultiContactMove::oblique, "oblique"},
                                      {MultiContactMove::roll, "roll"}});

/// A stretch of the path: all overlaps go in straight lines from where they are to `overlap`, one value per neighbour
/// [Rs].
struct MultiContactStage {
  MultiContactMove move = MultiContactMove::load;
  std::vector<double> overlap{};  ///< h/Rs of each neighbour at the end
  double slide = 0.0;             ///< how far the first neighbour moves across its normal [Rs]; back: negative
  double roll = 0.0;              ///< how far its contact goes over the surface of the centre without sliding [Rs]
};

/// A measurement set: neighbours and path.
struct MultiContactConfiguration {
  std::string name;                           ///< unique in the file, e.g. "cube-plane"
  std::vector<MultiContactPartner> partners;  ///< neighbours of the centre, then planes around its soft ones
  std::vector<MultiContactStage> stages;
  bool centre_free = false;  ///< the shell moves and turns with the forces of its grains; else it is held
  bool held_out = false;     ///< not for the fit: the law has to predict it
  bool turning = false;      ///< solid neighbours turn with the forces on them; they go where they are led

  /// Neighbours that touch the centre, all before the others.
  [[nodiscard]] std::size_t touching() const { return touching_of(partners); }
  static std::size_t touching_of(const std::vector<MultiContactPartner>& partners);
  /// Whether planes press neighbour k from its other sides.
  [[nodiscard]] bool pressed(std::size_t k) const;
  /// Whether all overlaps keep their ratios along the path; where it is sheared, some grow as others shrink.
  [[nodiscard]] bool in_proportion() const;
};

/// One relaxed state.
struct MultiContactPoint {
  std::int64_t stage = 0;        ///< index into MultiContactConfiguration::stages
  std::vector<double> overlap;   ///< h/Rs of each neighbour, towards the shell where it is now
  std::vector<double> normal;    ///< force on each neighbour along its direction, over E Rs^2, compression positive
  std::vector<Vec3> tangential;  ///< the rest of that force
  std::vector<Vec3> moment;  ///< moment of the forces on each neighbour about its contact point (1 - h/2 Rs from the
                             ///< centre along its direction), over E Rs^3; empty: not recorded
  double slide = 0.0;        ///< slide of the first neighbour so far [Rs]
  double roll = 0.0;         ///< roll of the first neighbour so far [Rs]
  Vec3 centre{};             ///< displacement of the shell [Rs]; zero when it is held
  double residual = 0.0;     ///< largest net force on a grain over the mean contact force (or floor)
  double max_overlap = 0.0;  ///< largest overlap over the smaller radius
  bool converged = false;
};

/// All points of one packing, in one orientation, in one configuration.
struct MultiContactRun {
  std::int64_t configuration = 0;  ///< index into MultiContactMeasurements::configurations
  std::int64_t packing = 0;        ///< index into MultiContactMeasurements::packings
  std::vector<MultiContactPoint> points;
  Cost cost;
  std::int64_t orientation = 0;  ///< 0: as it was made, else so many times turned (microsim/filled_shell.h)
};

struct MultiContactMeasurements {
  SoftParticleSpec spec;
  std::string relaxation;  ///< how every state came to rest
  std::vector<PackingInfo> packings;
  std::vector<MultiContactConfiguration> configurations;
  std::vector<MultiContactRun> runs;
};

/// Reduces the data to one run of every packing in every configuration. It is the mean over the orientations, point by
/// point, of those that converged (residual and overlap of grains: the largest). Several orientations of one packing
/// are not independent, so errors are those over packings. A run that ended early ends the mean.
MultiContactMeasurements mean_over_orientations(const MultiContactMeasurements& data);

/// Writes to an HDF5 file, atomically. Throws IoError.
void save_multi_contact(const MultiContactMeasurements& data, const std::string& path,
                        const Provenance& provenance = build_provenance());

/// Reads what save_multi_contact() wrote. Throws IoError naming the file and what is missing or damaged.
MultiContactMeasurements load_multi_contact(const std::string& path);

/// The runs alone, as data sets of `group`: for files that keep single runs.
void write_multi_contact_runs(const h5::Group& group, const std::vector<MultiContactRun>& runs);
/// Reads them back. Throws IoError when columns are missing or do not fit together.
std::vector<MultiContactRun> read_multi_contact_runs(const h5::Group& group);

/// The unit vector along which the first neighbour slides: the coordinate axis least aligned with `direction` (the
/// first of equals), made perpendicular to it. +x slides along +y.
inline Vec3 slide_direction(const Vec3& direction) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(direction[k]) < std::abs(direction[axis])) axis = k;
  Vec3 along{};
  along[axis] = 1.0;
  along -= direction * dot(along, direction);
  return along * (1.0 / norm(along));
}

}  // namespace softgrain
