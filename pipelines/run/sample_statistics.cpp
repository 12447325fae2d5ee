#include "pipelines/run/sample_statistics.h"

#include <cmath>
#include <map>
#include <string>

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
  const auto n = static_cast<double>(values.size());
  json out{{"mean", nullptr}, {"deviation", nullptr}, {"samples", values.size()}};
  if (values.empty()) return out;
  double mean = 0.0;
  for (const double x : values) mean += x / n;
  double square = 0.0;
  for (const double x : values) square += (x - mean) * (x - mean);
  out["mean"] = mean;
  if (values.size() > 1) out["deviation"] = std::sqrt(square / (n - 1.0));
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
