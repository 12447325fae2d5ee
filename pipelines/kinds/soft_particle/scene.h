// Tables of a scene that describe the soft particle and how it is measured.
#pragma once

#include <string>
#include <vector>

#include "common/data/measurements.h"
#include "common/io/scene.h"
#include "microsim/measure.h"
#include "microsim/protocol.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// One series of measurements: which relaxation, how many packings, which states of which pair kind.
struct MeasureSeries {
  Relaxation relaxation = Relaxation::least_work;
  std::int64_t packings = 0;
  std::vector<PairKind> kinds;
  MeasurementPlan soft_solid;
  MeasurementPlan soft_soft;

  [[nodiscard]] const MeasurementPlan& plan(PairKind kind) const {
    return kind == PairKind::soft_solid ? soft_solid : soft_soft;
  }
};

struct MeasureSetup {
  SoftParticleSpec spec;
  PublishedOptions published;
  LeastWorkProtocolOptions least_work;
  DampedProtocolOptions damped;
  std::vector<MeasureSeries>
      series;  ///< the first one feeds the fit; a second one is the reference it is compared with
  std::uint64_t seed = 1;
  std::int64_t kept_states = 0;  ///< kept states of the first packing of every kind and relaxation, for pictures

  [[nodiscard]] std::int64_t packings() const;  ///< largest number of packings of a series
  [[nodiscard]] bool rotates() const;           ///< whether any series turns soft particles
  [[nodiscard]] bool turns_on() const;          ///< whether some angle is one beyond another of the same sign
  /// Names of the relaxations, that of the fit first.
  [[nodiscard]] std::vector<std::string> relaxations() const {
    std::vector<std::string> names;
    for (const MeasureSeries& s : series) names.push_back(to_string(s.relaxation));
    return names;
  }
};

/// Throws InputError at a key of `packing` when a packing of this kind would be drawn from more than 1e7 grains (or
/// from a law whose mean volume is no number).
void require_drawable(const SceneTable& packing, const SoftParticleSpec& spec);

/// Refuses keys of the tables below [measure] that none of the relaxations takes, and those of rotations where nothing
/// is rotated.
void refuse_idle_protocols(const SceneTable& measure, const std::vector<Relaxation>& relaxations, bool rotates);

/// Speeds at which neighbours may approach a soft particle of such grains [m/s]: `fastest` is over sqrt(E/rho).
Range approach_speeds(const SoftParticleSpec& spec, double fastest);

/// A sentence for each speed of approach above kFastestApproach (common/dynamics/slow_dynamics.h): waves then press
/// beside the plane.
std::vector<std::string> speed_warnings(const MeasureSetup& setup);

/// Reads [material] and what [packing] says of the soft particle (not `count`). Throws InputError.
SoftParticleSpec read_soft_particle(const SceneTable& root);

/// Reads seed, [material], [packing] and how [measure] relaxes, without what is measured: `plan` gets the rotations'
/// settings, `relaxation` the name. Throws InputError.
MeasureSetup read_measure_protocols(const SceneTable& root, Relaxation& relaxation, MeasurementPlan& plan);

/// Reads [material], [packing], [measure], [reference] and [output]. Throws InputError.
MeasureSetup read_measure_setup(const SceneTable& root);

/// A scene of kind "soft-particle".
struct SoftParticleScene {
  std::string title;
  MeasureSetup measure;
};

/// Reads it to the last key. Throws InputError.
SoftParticleScene read_soft_particle_scene(const Scene& scene);

/// The settings of the least-work protocol, under which slow dynamics is one with no increment by least work.
LeastWorkProtocolOptions least_work_options(const MeasureSetup& setup, Relaxation relaxation);

/// The protocol of a name.
std::unique_ptr<Protocol> make_protocol(const MeasureSetup& setup, Relaxation relaxation);

/// Its settings as text, "increment = 0.0025, ...", with the numbers that it takes where the scene gives none: equal
/// for equal protocols.
std::string settings_text(const MeasureSetup& setup, Relaxation relaxation);

/// Runs a scene of kind "soft-particle"; writes measurements.h5, summary.json and report.html.
/// Status not_usable when a recorded point did not converge under its own criterion.
SceneKind soft_particle_kind();

// The measuring part of a pipeline: packings and runs in parallel, each saved as it goes, so that a stopped run goes
// on.

class Run;

struct MeasureResult {
  Measurements data;
  std::vector<ShellPacking> packings;  ///< first bodies, to fill resolved twins with
  /// One sentence for each packing whose measurement broke off (a grain squeezed out of its shell...). It is left out
  /// of `data` as a whole: a mean over those that got further is a mean over the soft ones.
  std::vector<std::string> left_out;
  bool enough_left = true;  ///< whether at least half of the packings of every relaxation and kind of pair are left
  double wall_seconds = 0.0;
  double packing_seconds = 0.0;  ///< part of it that went into generating packings
};

/// What makes the measurements doubtful: fast planes, and what was left out.
std::vector<std::string> warnings_of(const MeasureSetup& setup, const MeasureResult& result);

/// Packing index of the second body of a soft-soft pair: a stream of its own.
std::uint64_t second_body_index(std::int64_t packing);

/// Generates, measures and saves DIR/measurements.h5. Results do not depend on the number of threads.
MeasureResult run_measure_stage(const MeasureSetup& setup, const Run& run);

// What measurements of soft particles leave behind, and laws fitted to them.

KindResults soft_particle_results();

namespace report {
std::string normal_section(const RunData& run);       ///< Fn(Delta)
std::string tangential_section(const RunData& run);   ///< Ft(ht)
std::string stiffness_section(const RunData& run);    ///< kt(Delta)
std::string relaxations_section(const RunData& run);  ///< published against damped relaxation
}  // namespace report

}  // namespace softgrain
