// The members of records, each with its name and unit once: fields(visit, record) calls visit(name, member, unit,
// options), in the order in which rows hold them. Columns and attributes of files, rows of checkpoints
// and JSON go by it; options: Limits, and those of columns.h and attributes.h.
#pragma once

#include "common/core/statistics.h"
#include "common/data/columns.h"
#include "common/data/measurements.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

void fields(auto&& visit, Of<NormalPoint> auto& p) {
  visit("delta", p.delta, "1", kOverlaps);
  visit("force", p.force, "N");
  visit("residual", p.residual, "1", Limits::anything());
  visit("max_overlap", p.max_overlap, "1", Limits::not_negative());
  visit("converged", p.converged, "1", Limits::flag());
}

void fields(auto&& visit, Of<TangentialPoint> auto& p) {
  visit("delta", p.delta, "1", kOverlaps);
  visit("angle", p.angle_deg, "degree", Limits{-360.0, 360.0});
  visit("force_parallel", p.force_parallel, "N");
  visit("force_perpendicular", p.force_perpendicular, "N");
  visit("residual", p.residual, "1", Limits::anything());
  visit("converged", p.converged, "1", Limits::flag());
}

void fields(auto&& visit, Of<Cost> auto& c, const std::string& prefix = "") {
  visit(prefix + "loop_passes", c.loop_passes, "1", Limits::not_negative(), Means{"passes over all contacts"});
  visit(prefix + "contact_evaluations", c.contact_evaluations, "1", Limits::not_negative(),
        Means{"evaluations of contact laws"});
  visit(prefix + "seconds", c.seconds, "s", Limits::not_negative(),
        Means{"time, of the wall or of cores as the member that holds it says"});
}

void fields(auto&& visit, Of<MeanError> auto& m) {
  visit("mean", m.mean, Means{"mean over samples, in the unit of the quantity", "as the quantity"});
  visit("standard_error", m.error, Means{"standard error of the mean", "as the quantity"});
  visit("n", m.n, Means{"number of samples", "1"});
}

void fields(auto&& visit, Of<PackingInfo> auto& p) {
  visit("seed", p.seed, "1", Means{"seed of the packing"});
  visit("grains", p.grains, "1", Limits::not_negative(), Means{"number of grains"});
  visit("solid_fraction", p.solid_fraction, "1", Limits::flag(), Means{"volume of the grains over that of the shell"});
  visit("contacts_per_grain", p.contacts_per_grain, "1", Limits::not_negative(),
        Means{"mean number of contacts of a grain"});
  visit("exponent", p.exponent, "1", Limits::anything(),
        Means{"power-law exponent of the radii, by maximum likelihood"});
  visit("exponent_error", p.exponent_error, "1", Limits::anything(), Means{"standard error of the exponent"});
}

/// Fields of a PackingRun without its lists.
void fields(auto&& visit, Of<PackingRun> auto& r) {
  visit("packing", r.packing, "1");
  fields(visit, r.normal_cost, "normal_");
  fields(visit, r.tangential_cost, "tangential_");
  visit("kind", r.kind, "1", UpTo{PairKind::soft_soft, "kind of a run out of range"});
}

void fields(auto&& visit, Of<MultiContactPartner> auto& p) {
  std::int32_t on = p.on + 1;  // 0: the centre
  visit("on", on, "1", Limits{0.0, 999.0}, kLater);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(p)>>) p.on = on - 1;
  visit("kind", p.kind, "1", UpTo{PartnerKind::soft, "kind of a neighbour out of range"});
  visit("smooth", p.smooth, "1", kLater);
  visit("ratio", p.ratio, "1", Limits::not_negative());
  visit("direction", p.direction, "1");
}

void fields(auto&& visit, Of<MultiContactConfiguration> auto& c) {
  visit("centre_free", c.centre_free, "1", Limits::flag());
  visit("held_out", c.held_out, "1", Limits::flag());
  visit("turning", c.turning, "1", kLater);
}

/// Fields of a MultiContactStage without its move and its overlaps.
void fields(auto&& visit, Of<MultiContactStage> auto& s) {
  visit("slide", s.slide, "Rs");
  visit("roll", s.roll, "Rs", kLater);
}

/// Fields of a MultiContactPoint without its values per neighbour.
void fields(auto&& visit, Of<MultiContactPoint> auto& p) {
  visit("stage", p.stage, "1");
  visit("slide", p.slide, "Rs");
  visit("centre", p.centre, "Rs");
  visit("residual", p.residual, "1", Limits::anything());
  visit("max_overlap", p.max_overlap, "1", Limits::not_negative());
  visit("converged", p.converged, "1", Limits::flag());
  visit("roll", p.roll, "Rs", kLater);
}

/// Fields of a MultiContactRun without its points.
void fields(auto&& visit, Of<MultiContactRun> auto& r) {
  visit("configuration", r.configuration, "1");
  visit("packing", r.packing, "1");
  fields(visit, r.cost);
  visit("orientation", r.orientation, "1", Limits{0.0, 999999.0}, kLater);
}

}  // namespace softgrain
