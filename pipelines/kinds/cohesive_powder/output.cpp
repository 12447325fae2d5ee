#include "pipelines/kinds/cohesive_powder/output.h"

#include <array>
#include <utility>

namespace softgrain {

namespace {

using nlohmann::json;

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

json rank_json(const SparseRank& rank) {
  return {{"rank", rank.rank}, {"smallest_kept", rank.smallest_kept}, {"largest_dropped", rank.largest_dropped}};
}

json rigidity_json(const Rigidity& r) {
  return {{"freedoms", r.freedoms},
          {"constraints", r.constraints},
          {"h", r.indeterminacy},
          {"k", r.floppy},
          {"identity_holds", r.identity_holds()},
          {"of_matrix", rank_json(r.of_matrix)},
          {"of_transpose", rank_json(r.of_transpose)},
          {"positive_definite", r.stiffness.positive},
          {"smallest_pivot", or_null(r.stiffness.smallest_pivot)}};
}
json rigidity_json(const std::optional<Rigidity>& r) { return r ? rigidity_json(*r) : json(nullptr); }

json rigidity_json(const PowderRigidity& r) {
  return {{"fixed", rigidity_json(r.fixed)},
          {"free", rigidity_json(r.free)},
          {"backbone", rigidity_json(r.backbone)},
          {"backbone_free", rigidity_json(r.backbone_free)}};
}

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

json analysis_json(const PowderAnalysis& a) {
  return {{"zero_force", a.zero},
          {"zero_share", or_null(a.forces.zero_share)},
          {"F_perc",
           {{"x", or_null(a.percolation.x)},
            {"y", or_null(a.percolation.y)},
            {"either", or_null(a.percolation.either)},
            {"both", or_null(a.percolation.both)}}},
          {"rumpf_ratio", or_null(a.rumpf_ratio)},
          {"solid_fraction_3d", a.solid_fraction_3d},
          {"rigidity", a.rigidity ? rigidity_json(*a.rigidity) : json(nullptr)}};
}

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
  group.attribute("scalars", analysis_json(analysis).dump());
}

}  // namespace softgrain
