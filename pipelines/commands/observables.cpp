#include "pipelines/commands/commands.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

/// Named columns of equal length.
using Columns = std::vector<std::pair<std::string, std::vector<double>>>;

std::string text_of(const Columns& columns) {
  std::string text = "#";
  for (const auto& [name, values] : columns) text += " " + name;
  text += "\n";
  for (std::size_t row = 0; row < columns.front().second.size(); ++row)
    text +=
        join_text(columns, " ", [row](const auto& column) { return rounded_text(column.second[row], {10}); }) + "\n";
  return text;
}

/// Overlaps, means and standard errors of the first relaxation of a kind.
struct ForceColumns {
  std::vector<double> delta;
  std::vector<double> mean;
  std::vector<double> error;
};

ForceColumns forces_of(const Measurements& data, PairKind kind) {
  std::map<double, std::vector<double>> values;
  std::string relaxation;
  for (const PackingRun& run : data.runs) {
    if (run.kind != kind) continue;
    if (relaxation.empty()) relaxation = run.relaxation;
    if (run.relaxation != relaxation) continue;
    for (const NormalPoint& p : run.normal) {
      auto& list = values[p.delta];  // an overlap without a converged point keeps its row: all runs have equal lengths
      if (p.converged) list.push_back(p.force);
    }
  }
  ForceColumns out;
  for (const auto& [delta, list] : values) {
    const MeanError m = list.empty() ? MeanError{} : mean_error(list);
    out.delta.push_back(delta);
    out.mean.push_back(list.empty() ? std::nan("") : m.mean);
    out.error.push_back(list.empty() ? std::nan("") : m.error);
  }
  return out;
}

Columns force_columns(const Measurements& data) {
  ForceColumns first = forces_of(data, PairKind::soft_solid);
  ForceColumns second = forces_of(data, PairKind::soft_soft);
  if (first.delta.empty()) std::swap(first, second);
  if (first.delta.empty()) throw InputError("observables: the run measured no force");
  Columns out{{"Delta", first.delta}, {"Fn", first.mean}, {"Fn_error", first.error}};
  if (second.delta == first.delta)
    out.insert(out.end(), {{"Fn_soft_soft", second.mean}, {"Fn_soft_soft_error", second.error}});
  return out;
}

/// Adds what one sample recorded; `samples`: how many have come to each row.
void add_to_rows(const std::vector<double>& values, std::vector<double>& sum, std::vector<double>& samples) {
  sum.resize(std::max(sum.size(), values.size()), 0.0);
  samples.resize(sum.size(), 0.0);
  for (std::size_t row = 0; row < values.size(); ++row) {
    sum[row] += values[row];
    samples[row] += 1.0;
  }
}

/// Means over the samples that came to a point: others broke off before it.
Columns macro_columns(const std::vector<MacroCurve>& curves) {
  std::string law;
  for (const MacroCurve& c : curves)
    if (law.empty() && !c.twin()) law = c.engine;
  Columns out{{"strain", {}}, {"stress", {}}, {"lateral_stress", {}}, {"coordination", {}}};
  std::vector<std::vector<double>> samples(out.size());
  for (const MacroCurve& c : curves) {
    if (c.engine != law) continue;
    const std::vector<double>* const parts[] = {&c.strain, &c.stress_axial, &c.stress_lateral, &c.coordination};
    for (std::size_t k = 0; k < out.size(); ++k) add_to_rows(*parts[k], out[k].second, samples[k]);
  }
  const std::size_t rows = out.front().second.size();
  if (rows == 0) throw InputError("observables: the macro run recorded nothing");
  for (std::size_t k = 0; k < out.size(); ++k) {
    std::vector<double>& values = out[k].second;
    for (std::size_t row = 0; row < values.size(); ++row) values[row] /= samples[k][row];
    values.resize(rows, std::nan(""));  // what no sample recorded
  }
  return out;
}

/// "key=value" with a value that is a number, with a unit or without: in SI then.
bool number_of_setting(const std::string& setting, std::string& key, double& value) {
  const std::size_t mark = setting.find('=');
  if (mark == std::string::npos) return false;
  key = trimmed(setting.substr(0, mark));
  std::string text = trimmed(setting.substr(mark + 1));
  const bool quoted = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front();
  if (quoted) text = text.substr(1, text.size() - 2);
  const std::optional<double> number = quantity_of_any_unit(text);
  value = number.value_or(0.0);
  return number.has_value();
}

Columns parameter_columns(const std::vector<std::string>& overrides) {
  std::map<std::string, int> times;
  const auto last = [](const std::string& key) { return key.substr(key.rfind('.') + 1); };
  Columns out;
  for (const std::string& text : overrides) {
    std::string key;
    double value = 0.0;
    const bool number = number_of_setting(text, key, value);
    std::erase_if(out, [&](const auto& column) { return column.first == key; });  // the last of a key holds
    if (number) out.push_back({key, {value}});
  }
  for (const auto& [key, value] : out) ++times[last(key)];
  for (auto& [key, value] : out)
    if (times[last(key)] == 1) key = last(key);
  return out;
}

}  // namespace

void require_observables(const std::string& scene, const std::vector<std::string>& overrides) {
  const std::string kind = Scene::load(scene, overrides).root().text("kind");
  const std::set<std::string> known{"pipeline", "soft-particle", "macro"};
  if (known.count(kind) == 0)
    throw InputError(scene + ": --observables: a scene of kind \"" + kind +
                     "\" has none; kinds pipeline, soft-particle and macro do");
}

void forget_observables(const std::string& prefix) {
  std::error_code ignored;
  for (const char* end : {"_param.txt", "_sim.txt"}) std::filesystem::remove(prefix + end, ignored);
}

void write_observables(const std::string& directory, const std::vector<std::string>& overrides,
                       const std::string& prefix) {
  const std::string macro = directory + "/macro.h5";
  const Columns observed = std::filesystem::exists(macro)
                               ? macro_columns(load_macro(macro))
                               : force_columns(load_measurements(directory + "/measurements.h5"));
  const Columns parameters = parameter_columns(overrides);
  const std::string folder = std::filesystem::path(prefix).parent_path().string();
  if (!folder.empty()) require_writable_directory(folder);
  if (!parameters.empty()) write_text_atomic(prefix + "_param.txt", text_of(parameters));
  write_text_atomic(prefix + "_sim.txt", text_of(observed));
}

}  // namespace softgrain
