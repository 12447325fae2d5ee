// What to measure next of a law table: which configuration, pressed in how deep and on how many packings, would narrow
// the error bars of a macro scene most per second.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/law/fitted_law.h"

namespace softgrain {

/// A configuration of a scene up to an overlap.
struct PlanCandidate {
  std::string configuration;
  double depth = 1.0;         ///< overlap over that at the end of its loading
  double overlap = 0.0;       ///< largest of its neighbours [Rs]
  double scatter = 0.0;       ///< relative scatter of the force between packings
  bool measured = false;      ///< its scatter is that of the table; else the median of those there
  std::int64_t packings = 0;  ///< packings in the table, or those that the scene asks for
  double seconds = 0.0;       ///< core seconds with one packing
  double share = 1.0;         ///< width of the band's law part over what it is, after one block of packings more
};

/// Packings of one candidate, in all blocks of the plan.
struct PlanStep {
  std::size_t candidate = 0;
  std::int64_t packings = 0;
  double seconds = 0.0;  ///< core seconds
  double share = 1.0;    ///< after this step and those before
};

struct LawPlan {
  std::string engine;      ///< whose curves they are
  std::size_t curves = 0;  ///< number of curves with draws
  std::size_t draws = 0;
  double law_part = 0.0;     ///< standard deviation of the axial stress over its root mean square, of all curves
  double discrepancy = 0.0;  ///< error of the form of law, see LawDraws::discrepancy; no number of packings lessens it
  std::int64_t block = 0;
  std::vector<PlanCandidate> candidates;  ///< what helps most per second first
  std::vector<PlanStep> steps;
  double share = 1.0;         ///< law part after the plan over that before
  double seconds = 0.0;       ///< core seconds of all steps
  double even_seconds = 0.0;  ///< core seconds for this share with equal packings per configuration; NaN: out of reach
  std::vector<std::string> remarks;
};

struct LawPlanWish {
  std::int64_t block = 8;  ///< packings that are added at a time
  double share = 0.5;      ///< wanted: law part of the band over what it is
  WantedForm form{};       ///< empty: that which the table prefers, of those that have draws
};

/// Forces of draws and predictions of draws are taken as jointly normal (calibrate/next_measurements.h); a
/// configuration tells the logarithm of the force on its neighbours at the overlap, off by the scatter of packings.
/// `curves`: of runs with bands by this table. Throws InputError: none has draws of one of its laws, or of more than
/// the table keeps.
LawPlan plan_law(const FittedLaw& table, const MultiContactSetup& candidates, const std::vector<MacroCurve>& curves,
                 const LawPlanWish& wish);

/// Whether draws of both tables are the same, as the curves took them: the table is that of the run, or one that the
/// same fit made again. Throws as plan_law().
bool same_draws(const FittedLaw& a, const FittedLaw& b, const std::vector<MacroCurve>& curves, WantedForm form);

/// The plan as text for people.
std::string plan_text(const LawPlan& plan);

/// The plan as [[plan]] tables of a law-table scene.
std::string plan_scene_text(const LawPlan& plan);

}  // namespace softgrain
