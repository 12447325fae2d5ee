// One level of a hierarchy: its content, its measurement, its law, and how far it is from the level below.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/multi_contact_fit.h"
#include "common/data/multi_contact_law.h"
#include "microsim/filled_shell.h"
#include "pipelines/kinds/hierarchy/scene.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// Force at the end of loading, this level over the one below it on the same packings.
struct LevelChange {
  std::string configuration;
  double ratio = 1.0;
  double error = 0.0;  ///< standard error over packings, of the paired ratio of means
};

/// Relative change of the forces of a level over that of the law below.
struct Sensitivity {
  double value = 0.0;
  double error = 0.0;
};

struct HierarchyLevel {
  std::int64_t number = 0;  ///< 0: the finest, grains only
  LawTableEntry entry;
  double inner_mean = 0.0;    ///< soft particles inside, mean over packings
  double inner_volume = 0.0;  ///< their volume over that of the shell
  double grain_volume = 0.0;  ///< volume of its own grains over that of the shell
  double inner_low = 0.0;     ///< radii over Rs
  double inner_high = 0.0;
  std::vector<LevelChange> changes;  ///< against the level below; empty for the finest
  double distance = 0.0;             ///< distance of the two laws in the form of the hierarchy, see law_distance()
  double distance_noise = 0.0;       ///< what packings alone would make of it, from the standard errors of the changes
  std::optional<Sensitivity> sensitivity;  ///< sensitivity to the law below; empty without one or without error bars
  double own_error = 0.0;                  ///< relative standard error of its forces, from its packings alone
  double error = 0.0;                      ///< relative standard error of its forces, that of the law below included
  std::vector<std::string> left_out;       ///< a sentence for each measurement that broke off
  Cost cost;
  double seconds = 0.0;
  double grains = 0.0;  ///< number of grains that a resolved soft particle of this level would hold
};

/// Packings of grains alone, made once, and what a level makes of each: its content.
class LevelContents {
 public:
  LevelContents(const HierarchySetup& setup, std::uint64_t seed) : setup_(setup), seed_(seed) {}
  /// Starts a level: from now on contents hold soft particles of the level below; null: grains alone.
  void begin_level(const HierarchyLevel* below);
  /// Content made of the packing with this number in the pool; safe from several threads.
  SoftContent of(const ShellPacking& packing, std::int64_t number);

  std::vector<ShellPacking> packings;  ///< the pool of all levels, once one has made it

 private:
  const HierarchySetup& setup_;
  std::uint64_t seed_;
  std::optional<ShellFilling> filling_;
  std::mutex mutex_;
  std::map<std::int64_t, SoftContent> known_;
};

/// Soft particles in the voids of a packing of grains, largest hole first, until they have their volume or no hole is
/// left; deterministic.
SoftContent fill_holes(const HierarchySetup& setup, const ShellFilling& filling, const ShellPacking& packing);

/// Soft particles on top of this level: what they hold of it has `next_volume` of the volume of the grains beside them.
ShellFilling filling_above(const HierarchySetup& setup, const HierarchyLevel& below);

/// Laws of inner soft particles from the entry of the level below. E is that of the grains.
InnerLaws inner_laws(const HierarchySetup& setup, const LawTableEntry& below);

/// Measures and fits level `number` on top of `below` (none for the finest).
HierarchyLevel run_level(const HierarchySetup& setup, LevelContents& contents, std::int64_t number,
                         const HierarchyLevel* below, const MultiContactMeasurements* data_below,
                         MultiContactMeasurements& data, const Run& run);

/// Ratio of mean end forces of a configuration on the packings that both levels have, with its error by linear
/// propagation of the paired residuals; orientations of one packing are no further packings. None where nothing is
/// there, or bears no force.
std::optional<LevelChange> level_change(const MultiContactMeasurements& data, const MultiContactMeasurements& below,
                                        std::int64_t configuration);

/// Root mean square of the difference of two laws over that of the one below, along one plane and along six planes.
double law_distance(const LawTableEntry& law, const LawTableEntry& below, LawForm form);

// Error bars through levels: how the law of a level follows that of the level below, and what the uncertainty of that
// one adds to its own.

/// One plane from each side, along the axes.
std::vector<MultiContactPartner> six_planes();

/// How strong a law is: geometric mean of the forces of one plane at `overlap` and of six planes at two thirds of it.
double law_strength(const MultiContactLaw& law, double overlap);

/// Overlap over Rs from which a soft particle bears between six planes; `most` when it bears nothing up to there.
double law_onset(const MultiContactLaw& law, double most);

/// The table with all forces times `factor`.
LawTableEntry scaled_law(LawTableEntry entry, double factor);

/// How much a draw of the law below makes of this one: strength over that of the fit, to the power of `sensitivity`.
std::vector<double> strength_draws(const LawTableEntry& below, LawForm form, double sensitivity);

/// Every replicate of every law times one draw, turn by turn; standard error and interval of `a` follow.
void spread(LawTableEntry& entry, const std::vector<double>& draws);

/// Relative standard deviation of the strength over the replicates; NaN with fewer than two.
double strength_error(const LawTableEntry& entry, LawForm form);

// Two decades with every grain: one soft particle whose inner soft particles hold their grains, against the same one
// whose inner soft particles act by law.

/// Forces at one overlap with a plane, means over packings, over E Rs^2.
struct CheckPoint {
  double overlap = 0.0;
  double law = 0.0;
  double law_error = 0.0;
  double resolved = 0.0;
  double resolved_error = 0.0;
  double ratio = 0.0;
  double ratio_error = 0.0;  ///< standard error of the paired ratio of means
};

struct CheckResult {
  std::vector<CheckPoint> points;
  double inner = 0.0;   ///< soft particles inside, mean
  double grains = 0.0;  ///< grains of a resolved run, mean
  std::int64_t packings = 0;
  Cost law_cost;
  Cost resolved_cost;
  bool converged = true;
};

/// Runs the check with the law of the finest level. Finished runs are kept in the run.store.
CheckResult check_two_decades(const HierarchySetup& setup, const HierarchyLevel& finest, const Run& run);

}  // namespace softgrain
