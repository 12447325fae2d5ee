#include "pipelines/kinds/cohesive_powder/output.h"

#include <array>
#include <utility>

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

}  // namespace softgrain
