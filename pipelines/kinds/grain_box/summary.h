// What grain boxes came to: summary.json of their run.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/core/limits.h"
#include "microsim/grain_box/analysis.h"
#include "microsim/grain_box/record.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// The last state of a phase.
struct PhaseSummary {
  std::size_t states = 0;
  BoxPoint point{};
  double density = 0.0;  ///< of the grains [kg/m^3]
};

void fields(auto&& visit, Of<PhaseSummary> auto& s) {
  auto& p = s.point;
  double bulk_density = s.density * p.solid_fraction;
  visit("states", s.states, Means{"number of states of the phase", "1"});
  visit("pressure", p.pressure, Means{"confining stress sigma_c", "Pa"});
  visit("stress", p.stress.v, Means{"stress along x, y and z", "Pa"});
  visit("strain", p.strain.v, Means{"strain along x, y and z", "1"});
  visit("deviator", p.deviator, Means{"deviatoric stress", "Pa"});
  visit("shear_stress", p.shear, Means{"shear stress by the moments of the wall forces", "Pa"});
  visit("wall_moment", p.moment, Means{"moment of the wall forces over the volume", "Pa"});
  visit("solid_fraction", p.solid_fraction, Means{"solid fraction", "1"});
  visit("bulk_density", bulk_density, Means{"mass of the grains over the volume", "kg/m^3"});
  visit("coordination", p.coordination, Means{"coordination number", "1"});
  visit("coordination_without_rattlers", p.coordination_without, Means{"coordination number without rattlers", "1"});
  visit("rattlers", p.rattlers, Means{"number of rattlers", "1"});
  visit("fewest_contacts", p.fewest_contacts, Means{"fewest contacts of a grain", "1"});
  visit("sliding_share", p.sliding_share, Means{"share of the contacts that slide", "1"});
  visit("sliding_limit_at_start", p.at_start_limit,
        Means{"share of the contacts that are at the Coulomb limit when the increment begins", "1"});
  visit("mean_normal_force", p.mean_force, Means{"mean normal force", "N"});
}

/// Moduli at a stress, means over intervals or over arrangements.
struct ModuliSummary {
  ModuliAt moduli{};
  bool over_arrangements = false;
};

void fields(auto&& visit, Of<ModuliSummary> auto& s) {
  auto& m = s.moduli;
  visit("pressure", m.pressure, Means{"confining stress", "Pa"});
  visit("K", m.bulk, Means{"bulk modulus", "Pa"});
  visit("K_error", m.bulk_error, Means{"standard error of it", "Pa"});
  visit("G", m.shear, Means{"shear modulus", "Pa"});
  visit("G_error", m.shear_error, Means{"standard error of it", "Pa"});
  visit("mean_normal_force", m.force, Means{"mean normal force", "N"});
  visit("mean_normal_force_error", m.force_error, Means{"standard error of it", "N"});
  if (s.over_arrangements)
    visit("arrangements", m.points, Means{"number of arrangements", "1"});
  else
    visit("intervals", m.points, Means{"number of intervals", "1"});
}

/// A fit without its prefactor, whose unit depends on the exponent.
struct FitSummary {
  PowerFit fit{};
};

void fields(auto&& visit, Of<FitSummary> auto& s) {
  fields(
      [&](const std::string& name, auto& number, const auto&... options) {
        if (name != "prefactor") visit(name, number, options...);
      },
      s.fit);
}

struct ExponentsSummary {
  GrainBoxFits fits{};
};

void fields(auto&& visit, Of<ExponentsSummary> auto& s) {
  fields([&](const char* name, auto& fit, const auto&... options) { visit(name, FitSummary{fit}, options...); },
         s.fits);
}

struct EffortSummary {
  std::size_t states = 0;
  StepEffort effort{};
  std::int64_t loose_passes = 0;
  double seconds = 0.0;
};

void fields(auto&& visit, Of<EffortSummary> auto& s) {
  auto& e = s.effort;
  visit("states", s.states, Means{"number of states", "1"});
  visit("worst_residual", e.residual, Means{"largest residual: net force over largest contact force", "1"});
  visit("iterations", e.iterations, Means{"iterations of the minimiser", "1"});
  visit("loop_passes", e.loop_passes, Means{"passes over all contacts", "1"});
  visit("contact_evaluations", e.contact_evaluations, Means{"evaluations of contact laws", "1"});
  visit("factorisations", e.factorisations, Means{"factorisations of the stiffness matrix", "1"});
  visit("linear_iterations", e.linear_iterations, Means{"iterations of the linear solver", "1"});
  visit("equilibria", e.solutions, Means{"equilibria found on the way", "1"});
  visit("retries", e.retries, Means{"increments that were tried again", "1"});
  visit("loose_passes", s.loose_passes, Means{"passes of the dynamic relaxation before stress appeared", "1"});
  visit("seconds", s.seconds, Means{"duration", "s"});
}

struct BoxSummary {
  std::string name;
  RunStatus status = RunStatus::good;
  std::int64_t grains = 0;
  nlohmann::json friction;
  GrainBoxGeneration generation{};
  std::string test;
  std::vector<double> increments;
  std::int64_t growth_passes = 0;
  std::optional<PhaseSummary> after_compaction;
  std::optional<PhaseSummary> after_friction;
  std::optional<PhaseSummary> at_end;
  double pressure_of_smallest_shear = kNaN;
  double largest_shear = 0.0;
  double largest_moment = 0.0;
  std::vector<ModuliSummary> moduli;
  EffortSummary effort;
  ExponentsSummary exponents;
  std::string reason{};
};

void fields(auto&& visit, Of<BoxSummary> auto& s) {
  visit("name", s.name, Means{"name of the pack"});
  visit("status", s.status, Means{"good or not usable"});
  visit("grains", s.grains, Means{"number of grains", "1"});
  visit("mu", s.friction, Means{"friction between grains, a number or \"infinite\"", "1"});
  visit("generation_pressure", s.generation.pressure, Means{"pressure of the generation", "Pa"});
  visit("generation_lower_pressures", s.generation.lower_pressures, Means{"lower pressures on the way there", "Pa"});
  visit("test", s.test, Means{"test"});
  visit("increments", s.increments, Means{"strain increments", "1"});
  visit("growth_passes", s.growth_passes, Means{"passes of the growth of the grains", "1"});
  visit("after_compaction", s.after_compaction, Means{"state after compaction without friction"});
  visit("after_friction", s.after_friction, Means{"state after compression with friction"});
  visit("at_end", s.at_end, Means{"state at the end of the loading"});
  visit("pressure_of_smallest_G", s.pressure_of_smallest_shear,
        Means{"confining stress at which G is smallest with friction on", "Pa"});
  visit("largest_shear_stress_ratio", s.largest_shear, Means{"largest shear stress over the confining stress", "1"});
  visit("largest_wall_moment_ratio", s.largest_moment, Means{"largest wall moment over the confining stress", "1"});
  visit("moduli", s.moduli, Means{"moduli at round stresses"});
  visit("effort", s.effort, Means{"what the pack took"});
  visit("exponents", s.exponents, Means{"growth exponents of K and G over the confining stress"});
  visit("reason", s.reason, kLeftOut, Means{"why it is not usable"});
}

/// Over the arrangements of one pack.
struct ArrangementsSummary {
  OverArrangements over{};
  std::vector<ModuliSummary> moduli;
};

void fields(auto&& visit, Of<ArrangementsSummary> auto& s) {
  visit("pack", s.over.pack, Means{"name of the pack"});
  visit("arrangements", s.over.arrangements, Means{"number of arrangements that came to their end", "1"});
  visit("moduli", s.moduli, Means{"moduli at round stresses, means over the arrangements"});
  visit("sliding_share", s.over.sliding, Means{"share of the contacts that slide at the end of the loading", "1"});
  visit("sliding_share_error", s.over.sliding_error, Means{"standard error of it", "1"});
}

struct GrainBoxSummary {
  RunStatus status = RunStatus::good;
  std::string title;
  std::vector<BoxSummary> packs;
  std::vector<ArrangementsSummary> over_arrangements;
  std::vector<std::string> remarks;
  std::vector<SizesSummary> sizes{};
  std::map<std::string, std::string> files;
};

/// What its head has stands in AnySummary too, with its meaning.
void fields(auto&& visit, Of<GrainBoxSummary> auto& s) {
  visit("status", s.status);
  visit("title", s.title);
  visit("packs", s.packs, Means{"the packs"});
  visit("over_arrangements", s.over_arrangements, kLeftOut, Means{"means over the arrangements of each pack"});
  visit("remarks", s.remarks);
  visit("sizes", s.sizes, kLeftOut);
  visit("files", s.files);
}

/// One per pack: states at the ends of the phases, moduli at round stresses, growth exponents, effort.
std::vector<BoxSummary> summaries_of(const std::vector<GrainBoxResult>& results);

/// K, G and sliding shares over the arrangements of every pack; empty where each has one.
std::vector<ArrangementsSummary> arrangements_of(const std::vector<GrainBoxResult>& results);

/// A line for each pack: its means over arrangements with standard errors, K and G at the largest round stress.
std::string arrangements_text(const std::vector<OverArrangements>& packs);

}  // namespace softgrain
