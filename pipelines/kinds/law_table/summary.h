// What a law table came to: summary.json of its run.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/data/fields.h"
#include "common/data/multi_contact_law.h"
#include "pipelines/law/law_json.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// What was measured of one configuration.
struct ConfigurationSummary {
  std::string name;
  std::size_t neighbours = 0;
  bool held_out = false;
  std::int64_t packings = 0;
  double force = 0.0;
  double force_error = kNaN;  ///< NaN with one packing
  bool target_met = false;
  std::optional<double> within{};
  double onset = 0.0;
  std::int64_t points = 0;
  double converged_share = 0.0;
  Cost cost;
};

void fields(auto&& visit, Of<ConfigurationSummary> auto& s) {
  visit("name", s.name, Means{"name of the configuration"});
  visit("neighbours", s.neighbours, Means{"number of neighbours of the centre", "1"});
  visit("held_out", s.held_out, Means{"whether it is kept from the fit: the law has to predict it"});
  visit("packings", s.packings, Means{"number of packings", "1"});
  visit("force", s.force, Means{"mean force per neighbour at the end of the first loading", "E Rs^2"});
  visit("force_standard_error", s.force_error, Means{"standard error of it", "E Rs^2"});
  visit("target_met", s.target_met, Means{"whether the standard error is as small as was wanted"});
  visit("variance_within_packings", s.within, kLeftOut,
        Means{"share of the variance of forces between orientations of one packing", "1"});
  visit("onset", s.onset, Means{"overlap h/Rs at which force sets in", "1"});
  visit("points", s.points, Means{"number of points", "1"});
  visit("converged_share", s.converged_share, Means{"share of the points that converged", "1"});
  fields(visit, s.cost);
}

struct MultiContactSummary {
  std::string relaxation;
  std::size_t runs = 0;
  std::int64_t points = 0;
  std::string force_unit = "E Rs^2";
  std::vector<ConfigurationSummary> configurations{};
  Cost cost;
};

void fields(auto&& visit, Of<MultiContactSummary> auto& s) {
  visit("relaxation", s.relaxation, Means{"relaxation that measured"});
  visit("runs", s.runs, Means{"number of runs", "1"});
  visit("points", s.points, Means{"number of points", "1"});
  visit("force_unit", s.force_unit, Means{"unit of the forces"});
  visit("configurations", s.configurations, Means{"what was measured of each configuration"});
  fields(visit, s.cost);
}

// Laws of a table, without unit.

struct LawEstimate {
  Estimate estimate;
};

void fields(auto&& visit, Of<LawEstimate> auto& s) {
  visit("value", s.estimate.value, Means{"value", "1"});
  visit("standard_error", s.estimate.standard_error, Means{"standard error", "1"});
  visit("low", s.estimate.low, Means{"lower end of the 95 % interval", "1"});
  visit("high", s.estimate.high, Means{"upper end of the 95 % interval", "1"});
}

struct SlideSummary {
  SlideLaw law;
};

void fields(auto&& visit, Of<SlideSummary> auto& s) {
  const bool all = Describes<decltype(visit)>;
  visit("kt_ratio", LawEstimate{s.law.kt_ratio}, Means{"tangential over normal stiffness"});
  visit("friction", LawEstimate{s.law.friction}, Means{"friction coefficient"});
  if (all || s.law.rolls) {
    visit("rolling", LawEstimate{s.law.rolling}, Means{"moment of rolling over E R^2 R12, per angle"});
    visit("rolling_friction", LawEstimate{s.law.rolling_friction}, Means{"largest moment of rolling over F R"});
  }
  if (all || s.law.has_unloading)
    visit("unloading", LawEstimate{s.law.unloading}, Means{"number s of the unloading branch"});
}

struct FormSummary {
  MultiContactLaw law;
};

void fields(auto&& visit, Of<FormSummary> auto& s) {
  verdict_fields(visit, s.law);
  visit("criterion", s.law.criterion, Means{"what forms are ranked by; the smallest is the best", "1"});
  visit("reason", s.law.reason, Means{"why the law is not usable"});
  visit("replicates_failed", s.law.replicates_failed, Means{"refits that did not come to a minimum", "1"});
  for (const MultiContactParameterName& p : kMultiContactParameters)
    visit(p.key, LawEstimate{s.law.*p.estimate}, Means{"number of the law, see law tables"});
}

struct EntrySummary {
  LawTableEntry entry;
};

void fields(auto&& visit, Of<EntrySummary> auto& s) {
  const LawTableEntry& e = s.entry;
  verdict_fields(visit, e);
  visit("slide_plane", SlideSummary{e.slide_plane}, Means{"how planes slide"});
  visit("slide_solid", SlideSummary{e.slide_solid}, Means{"how solid grains slide"});
  visit("slide_soft", SlideSummary{e.slide_soft}, Means{"how soft particles slide"});
  visit("unloading", LawEstimate{e.unloading}, Means{"number s of the unloading branch"});
  visit("prior", e.prior, kLeftOut, Means{"how the prediction of a library came into the law"});
  const std::vector<FormSummary> laws = [&] {
    std::vector<FormSummary> out;
    for (const MultiContactLaw& law : e.laws) out.push_back({law});
    return out;
  }();
  visit("laws", laws, kLeftOut, Means{"the forms of law"});
}

struct LawTableSummary {
  RunStatus status = RunStatus::good;
  std::string title;
  std::optional<MultiContactSummary> multi_contact;
  std::vector<EntrySummary> entries;
  std::vector<std::string> warnings;
  std::vector<std::string> remarks;
  std::vector<SizesSummary> sizes{};
  std::map<std::string, std::string> files{};
};

/// What its head has stands in AnySummary too, with its meaning.
void fields(auto&& visit, Of<LawTableSummary> auto& s) {
  visit("status", s.status);
  visit("title", s.title);
  visit("multi_contact", s.multi_contact, kLeftOut, Means{"what was measured with several neighbours at once"});
  visit("entries", s.entries, Means{"laws of each kind of packing"});
  visit("warnings", s.warnings, kLeftOut);
  visit("remarks", s.remarks);
  visit("sizes", s.sizes, kLeftOut);
  visit("files", s.files);
}

}  // namespace softgrain
