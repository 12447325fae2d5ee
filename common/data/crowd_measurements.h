// What was recorded of a soft particle with several neighbours at once [SP 1.7, 1.7.1]: which bodies touch it, how deep
// each one presses and what force each one feels. Dimensionless, so one record serves every E and Rs [SP 1.6].
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/core/vec.h"
#include "common/data/measurements.h"

namespace softgrain {

/// What presses on the soft particle that is measured.
enum class PartnerKind { plane, solid, soft };

template <>
inline constexpr auto words<PartnerKind> =
    word_list<PartnerKind>({{PartnerKind::plane, "plane"}, {PartnerKind::solid, "solid"}, {PartnerKind::soft, "soft"}});

/// One neighbour. It is moved towards the centre and never by forces, but for a soft one that planes press on all
/// sides: those are led, and its shell moves and turns with the forces of its grains.
struct CrowdPartner {
  PartnerKind kind = PartnerKind::plane;
  double ratio = 0.0;    ///< its radius over Rs; 0 for planes (infinite)
  Vec3 direction{};      ///< unit vector from the centre of the soft particle to the neighbour
  bool smooth = false;   ///< a plane without friction; else mu is that of the grains
  std::int32_t on = -1;  ///< < 0: touches the centre; else a plane around the soft neighbour of this number, direction
                         ///< and overlap [Rs] counted from that one's centre
};

enum class CrowdMove {
  load,
  unload,
  reload,
  slide,
  oblique,  ///< pressed and slid at once
  roll      ///< the first neighbour rolls over the soft particle, at constant overlaps
};

template <>
inline constexpr auto words<CrowdMove> = word_list<CrowdMove>({{CrowdMove::load, "load"},
                                                               {CrowdMove::unload, "unload"},
                                                               {CrowdMove::reload, "reload"},
                                                               {CrowdMove::slide, "slide"},
                                                               {CrowdMove::oblique, "oblique"},
                                                               {CrowdMove::roll, "roll"}});

/// A stretch of the path: all overlaps go in straight lines from where they are to `overlap`, one value per neighbour
/// [Rs].
struct CrowdStage {
  CrowdMove move = CrowdMove::load;
  std::vector<double> overlap{};  ///< h/Rs of each neighbour at the end
  double slide = 0.0;             ///< how far the first neighbour moves across its normal [Rs]; back: negative
  double roll = 0.0;              ///< how far its contact goes over the surface of the centre without sliding [Rs]
};

/// A measurement set: neighbours and path.
struct CrowdConfiguration {
  std::string name;                    ///< unique in the file, e.g. "cube-plane"
  std::vector<CrowdPartner> partners;  ///< those of the centre first, then planes around its soft neighbours
  std::vector<CrowdStage> stages;
  bool centre_free = false;  ///< the shell moves and turns with the forces of its grains; else it is held
  bool held_out = false;     ///< not for the fit: the law has to predict it
  bool turning = false;      ///< solid neighbours turn with the forces on them; they go where they are led

  /// Neighbours that touch the centre, all before the others.
  [[nodiscard]] std::size_t touching() const { return touching_of(partners); }
  static std::size_t touching_of(const std::vector<CrowdPartner>& partners);
  /// Whether planes press neighbour k from its other sides.
  [[nodiscard]] bool pressed(std::size_t k) const;
  /// Whether all overlaps keep their ratios along the path; where it is sheared, some grow as others shrink.
  [[nodiscard]] bool in_proportion() const;
};

/// One relaxed state.
struct CrowdPoint {
  std::int64_t stage = 0;        ///< index into CrowdConfiguration::stages
  std::vector<double> overlap;   ///< h/Rs of each neighbour, towards the shell where it is now
  std::vector<double> normal;    ///< force on each neighbour along its direction, over E Rs^2, compression positive
  std::vector<Vec3> tangential;  ///< the rest of that force
  std::vector<Vec3> moment;      ///< of the forces on each neighbour about its contact point (1 - h/2 Rs from the
                                 ///< centre along its direction), over E Rs^3; empty: not recorded
  double slide = 0.0;            ///< of the first neighbour so far [Rs]
  double roll = 0.0;             ///< likewise
  Vec3 centre{};                 ///< displacement of the shell [Rs]; zero when it is held
  double residual = 0.0;         ///< largest net force on a grain over the mean contact force (or floor)
  double max_overlap = 0.0;      ///< largest overlap over the smaller radius
  bool converged = false;
};

/// All points of one packing, in one orientation, in one configuration.
struct CrowdRun {
  std::int64_t configuration = 0;  ///< index into CrowdMeasurements::configurations
  std::int64_t packing = 0;        ///< index into CrowdMeasurements::packings
  std::vector<CrowdPoint> points;
  Cost cost;
  std::int64_t orientation = 0;  ///< 0: as it was made, else so many times turned (microsim/soft_content.h)
};

struct CrowdMeasurements {
  SoftParticleSpec spec;
  std::string relaxation;  ///< how every state came to rest
  std::vector<PackingInfo> packings;
  std::vector<CrowdConfiguration> configurations;
  std::vector<CrowdRun> runs;
};

/// The same with one run of every packing in every configuration: the mean over its orientations, point by point, of
/// those that converged (residual and overlap of grains: the largest). What one packing tells in several orientations
/// is not independent, so that errors are those over packings. A run that ended early ends the mean.
CrowdMeasurements mean_over_orientations(const CrowdMeasurements& data);

/// Writes to an HDF5 file, atomically. Throws FileTrouble.
void save_crowd(const CrowdMeasurements& data, const std::string& path,
                const Provenance& provenance = build_provenance());

/// Reads what save_crowd() wrote. Throws FileTrouble naming the file and what is missing or damaged.
CrowdMeasurements load_crowd(const std::string& path);

/// The runs alone, as data sets of `group`: for files that keep single runs.
void write_crowd_runs(const h5::Group& group, const std::vector<CrowdRun>& runs);
/// Reads them back. Throws FileTrouble when columns are missing or do not fit together.
std::vector<CrowdRun> read_crowd_runs(const h5::Group& group);

}  // namespace softgrain
