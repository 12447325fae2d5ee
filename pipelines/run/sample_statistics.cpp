#include "pipelines/run/sample_statistics.h"

#include <cmath>
#include <map>
#include <string>

#include "common/core/statistics.h"

namespace softgrain {

namespace {

using nlohmann::json;
using Values = std::map<std::string, std::vector<double>>;

void collect(const json& object, const std::string& path, Values& values) {
  for (const auto& [key, value] : object.items()) {
    const std::string name = path.empty() ? key : path + "." + key;
    if (value.is_object()) collect(value, name, values);
    if (value.is_number()) values[name].push_back(value.get<double>());
    if (value.is_null()) values[name];  // named, though undefined
  }
}

json statistics_of(const std::vector<double>& values) {
  const MeanError m = mean_error(values);
  json out{{"mean", nullptr}, {"deviation", nullptr}, {"samples", m.n}};
  if (m.n > 0) out["mean"] = m.mean;
  if (m.n > 1) out["deviation"] = m.deviation;
  return out;
}

}  // namespace

json sample_statistics(const std::vector<json>& samples) {
  Values values;
  for (const json& sample : samples) collect(sample, "", values);
  json out = json::object();
  for (const auto& [name, list] : values) out[name] = statistics_of(list);
  return out;
}

}  // namespace softgrain
