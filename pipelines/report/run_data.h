// Everything a run directory holds that a report can show.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "common/data/law_band.h"
#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/data/multi_contact_law.h"
#include "common/data/multi_contact_measurements.h"
#include "common/io/json_record.h"
#include "pipelines/compare/measured_stiffness.h"

namespace softgrain::report {

/// One scene of a comparison of laws with twins.
struct ComparedCurves {
  std::string name;
  std::vector<MacroCurve> curves;
};

struct RunData {
  std::string directory;
  nlohmann::json summary;   ///< empty object when absent
  bool unfinished = false;  ///< a run that was stopped, or is at work: it has no summary yet
  std::optional<Measurements> measurements;
  std::optional<LawCard> card;
  std::optional<MultiContactMeasurements> multi_contact;
  std::optional<LawTable> law_table;
  std::vector<MacroCurve> macro;
  std::vector<ComparedCurves> macro_scenes;

  /// Kind of the scene, as the summary says; of summaries that do not, that of the scene in the provenance. Empty where
  /// no scene was run.
  [[nodiscard]] std::string kind() const;
  /// The summary, or what there is of it, as a record of a kind; members that it does not hold keep their defaults.
  template <class Summary>
  [[nodiscard]] Summary summary_as() const {
    return record_of<Summary>(summary);
  }
  /// What `load` makes of a file of the directory, read once for each type; null when there is none. For what one kind
  /// alone keeps.
  template <class T>
  const T* file(const std::string& name, T (*load)(const std::string& path)) const {
    const auto known = files_.find({name, typeid(T)});
    if (known != files_.end()) return static_cast<const T*>(known->second.get());
    const std::string path = directory + "/" + name;
    if (!std::filesystem::exists(path)) return nullptr;
    hold(name, load(path));
    return static_cast<const T*>(files_.at({name, typeid(T)}).get());
  }
  /// Stands for that file from here on.
  template <class T>
  void hold(const std::string& name, T content) const {
    files_[{name, typeid(T)}] = std::make_shared<T>(std::move(content));
  }
  /// Law of a pair kind, if it was fitted and is usable for drawing.
  [[nodiscard]] const PairLaw* law(PairKind kind) const;
  /// The relaxation that the main figures show: that of the card, else the first measured; empty without runs.
  [[nodiscard]] std::string relaxation(PairKind kind) const;
  /// Angles that define the stiffnesses: those of the card, else the defaults.
  [[nodiscard]] StiffnessAngles angles(PairKind kind) const;

 private:
  mutable std::map<std::pair<std::string, std::type_index>, std::shared_ptr<const void>> files_;
};

/// Whether a directory is that of a run that has not come to its end.
bool is_unfinished(const std::string& directory);

/// The message on a directory that holds no results: of a run that has not come to its end, or of no run.
std::string why_without_results(const std::string& directory);

/// Reads what exists among summary.json, measurements.h5, law.toml, multi_contact.h5, law_table.toml, macro.h5 and
/// comparison.json (with the curves that it names). Throws IoError when the directory is missing, holds no results
/// of any kind, or one of these files is damaged.
RunData load_run(const std::string& directory);

}  // namespace softgrain::report
