#include "pipelines/kinds/cohesive_powder/output.h"

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "common/core/statistics.h"
#include "pipelines/kinds/cohesive_powder/summary.h"

namespace softgrain {

namespace {

using nlohmann::json;

constexpr std::array kHistograms{std::pair{"normal", &PowderForces::normal},
                                 std::pair{"normal_over_mean", &PowderForces::normal_over_mean},
                                 std::pair{"ratio", &PowderForces::ratio}, std::pair{"angle", &PowderForces::angle}};

void add_counts(Histogram& sum, const Histogram& more) {
  for (std::size_t k = 0; k < sum.counts.size(); ++k) sum.counts[k] += more.counts[k];
  sum.below += more.below;
  sum.above += more.above;
}

void write_histogram(const h5::Group& group, const Histogram& h) {
  group.attribute("low", h.low);
  group.attribute("high", h.high);
  group.attribute("below", h.below);
  group.attribute("above", h.above);
  group.write("counts", h.counts);
}

void write_pairs(const h5::Group& group, const std::vector<PowderInteraction>& pairs) {
  constexpr std::size_t kColumns = 10;
  std::vector<double> rows;
  for (const auto& p : pairs)
    rows.insert(rows.end(),
                {static_cast<double>(p.i), static_cast<double>(p.j), p.normal[0], p.normal[1], p.branch[0], p.branch[1],
                 p.normal_force, p.tangential_force, p.rolling_moment, static_cast<double>(p.kind)});
  group.write("pairs", rows, {pairs.size(), kColumns});
  group.attribute_of(
      "pairs", "columns",
      "slots i, j; normal to i x, y; branch x_i - x_j x, y [a]; N, T [F0; without cohesion P a]; rolling "
      "moment on i; kind: 0 compressive, 1 tensile, 2 distant, 3 unstressed");
}

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

json histograms_json(const std::vector<const PowderForces*>& samples) {
  PowderForces sum;
  json out = json::object();
  for (const auto& [name, member] : kHistograms) {
    Histogram& h = sum.*member;
    for (const PowderForces* sample : samples) add_counts(h, sample->*member);
    out[name] = {{"low", h.low}, {"high", h.high}, {"below", h.below}, {"above", h.above}, {"counts", h.counts}};
  }
  return out;
}

void write_analysis(const h5::Group& group, const PowderAnalysis& analysis) {
  write_pairs(group, analysis.pairs);
  const h5::Group histograms = group.create("histograms");
  for (const auto& [name, member] : kHistograms) write_histogram(histograms.create(name), analysis.forces.*member);
  group.attribute("scalars", json_of(analysis).dump());
}

json sample_statistics(const std::vector<json>& samples) {
  Values values;
  for (const json& sample : samples) collect(sample, "", values);
  json out = json::object();
  for (const auto& [name, list] : values) out[name] = statistics_of(list);
  return out;
}

}  // namespace softgrain
