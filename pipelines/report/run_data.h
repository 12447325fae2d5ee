// Everything a run directory holds that a report can show.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/data/crowd_law.h"
#include "common/data/crowd_measurements.h"
#include "common/data/law_band.h"
#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "microsim/grain_box/record.h"
#include "pipelines/compare/measured_stiffness.h"
#include "pipelines/snapshots/powder_data.h"

namespace softgrain::report {

/// One scene of a comparison of laws with twins.
struct MacroScene {
  std::string name;
  std::vector<MacroCurve> curves;
};

struct RunData {
  std::string directory;
  nlohmann::json summary;  ///< empty object when absent
  std::optional<Measurements> measurements;
  std::optional<LawCard> card;
  std::optional<CrowdMeasurements> crowd;
  std::optional<LawTable> law_table;
  std::vector<MacroCurve> macro;
  std::vector<MacroScene> macro_scenes;
  std::vector<GrainBoxResult> grain_boxes;
  std::optional<PowderRun> powder;

  /// Law of a pair kind, if it was fitted and is usable for drawing.
  [[nodiscard]] const PairLaw* law(PairKind kind) const;
  /// The relaxation that the main figures show: that of the card, else the first measured; empty without runs.
  [[nodiscard]] std::string relaxation(PairKind kind) const;
  /// Angles that define the stiffnesses: those of the card, else the defaults.
  [[nodiscard]] StiffnessAngles angles(PairKind kind) const;
};

/// Reads what exists among summary.json, measurements.h5, law.toml, crowd.h5, law_table.toml, macro.h5, comparison.json
/// (and the curves that it names), grain_box.h5 and powder.h5. Throws FileTrouble when the directory is missing, holds
/// none of them, or one of them is damaged.
RunData load_run(const std::string& directory);

/// Lookups that never throw: a path of keys "measurement.points"; absent or of another type gives nothing.
const nlohmann::json* find_value(const nlohmann::json& root, const std::string& path);
std::optional<double> find_number(const nlohmann::json& root, const std::string& path);
std::string find_text(const nlohmann::json& root,
                      const std::string& path);  ///< empty when absent; numbers and flags as text

/// Band that was read with the card when it is there, else from the covariance of the parameters by linearised error
/// propagation; empty when neither exists.
std::optional<LawBand> law_band(const PairLaw& law, LawPart part);

/// n values evenly spread over [low, high].
std::vector<double> spread(double low, double high, int n);

}  // namespace softgrain::report
