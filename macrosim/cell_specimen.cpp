#include "macrosim/cell_specimen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/contact/rolling_scene.h"
#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/text.h"
#include "common/data/rows.h"
#include "macrosim/curve_notes.h"

namespace softgrain {

namespace {

EquationOfState equation_of(const CellCard& card, double youngs_modulus) {
  const double modulus = card.modulus.value * youngs_modulus;
  if (card.form == StateForm::pores) return PoreForm{modulus, card.exponent.value};
  return PorosityForm{modulus, card.exponent.value};
}

double solid_volume(const std::vector<MacroBody>& bodies) {
  double sum = 0.0;
  for (const MacroBody& b : bodies)
    if (!b.soft) sum += kSphereVolume * cube(b.r);
  return sum;
}

double thickened_volume(const std::vector<MacroBody>& bodies, double thickness) {
  double sum = 0.0;
  for (const MacroBody& b : bodies) sum += kSphereVolume * cube(b.soft ? b.r : b.r + thickness);
  return sum;
}

/// Thickness with which dressed bodies fill their share of the room.
double thickness_of(const std::vector<MacroBody>& bodies, double room) {
  const double wanted = kThickenedFraction * room;
  double high = std::cbrt(room);
  double low = 0.0;
  if (thickened_volume(bodies, 0.0) > wanted) {  // coarse grains are denser by themselves: they lose a little
    double smallest = HUGE_VAL;
    for (const MacroBody& b : bodies)
      if (!b.soft) smallest = std::min(smallest, b.r);
    low = -0.1 * smallest;
    high = 0.0;
  }
  if (!(thickened_volume(bodies, low) < wanted))
    throw InputError(fmt::format(
        "cells: coarse bodies and soft particles fill {:.3g} of the room, too much for places of their own: "
        "fewer soft particles, more fines, or a packing from a file",
        thickened_volume(bodies, 0.0) / room));
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (thickened_volume(bodies, middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void scale_room(MacroPacking& packing, double room) {
  const Vec3 size = packing.size();
  const double factor = std::cbrt(room / (size[0] * size[1] * size[2]));
  const Vec3 low = packing.low;
  for (MacroBody& b : packing.bodies) b.x = low + (b.x - low) * factor;
  packing.high = low + size * factor;
}

CellRoom room_of(const MacroSpec& spec, const MacroPacking& packing) {
  if (spec.boundary == Boundary::walls) return PlaneBox{packing.low, packing.high};
  return box_cell(packing.size(), {true, true, true});
}

}  // namespace

CellLaw cell_law_of(const CellCard& card, const MacroSpec& spec) {
  CellLaw law{equation_of(card, spec.youngs_modulus), {}, {card.friction.value, card.stiffness.value}, std::nullopt};
  if (card.memory) {
    const CellMemory& m = *card.memory;
    const double unloaded = state_at(law.equation, kUnloadedPressure * spec.start_pressure * spec.youngs_modulus);
    law.memory = ShearMemory{m.dilatancy.value,      m.critical_pores.value, m.strength_slope.value,
                             m.strength_range.value, m.density_slope.value,  std::min(m.least_state.value, unloaded)};
  }
  return law;
}

FinesLaw fines_law_of(const CellCard& card, double youngs_modulus, const std::string& preparation) {
  const std::optional<double> f = void_ratio_factor(card, preparation);
  if (!f) throw InputError("cell law: " + missing_factor_text(card, preparation));
  return {equation_of(card, youngs_modulus),
          *f * card.void_ratio.value,
          {*f * card.excess_alone.value, *f * card.excess_many.value, card.excess_decay.value},
          card.memory ? card.memory->critical_pores.value / *f : 0.0,
          !preparation.empty()};
}

double fines_volume(const CellMatter& matter, double coarse) { return coarse * matter.share / (1.0 - matter.share); }

MacroPacking make_cell_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                               const PreparationWatch& watch) {
  const CellMatter& matter = *spec.cells;
  std::vector<MacroBody> bodies = drawn_bodies(spec, seed, sample);
  const double coarse = solid_volume(bodies);
  const double fines = fines_volume(matter, coarse);
  const double room = matter.solid_fraction > 0.0
                          ? (coarse + fines) / matter.solid_fraction
                          : room_at_pressure(fines_law_of(matter.card, spec.youngs_modulus, matter.preparation), fines,
                                             coarse, spec.start_pressure * spec.youngs_modulus);
  const double thickness = thickness_of(bodies, room);
  for (MacroBody& b : bodies)
    if (!b.soft) b.r += thickness;
  std::stable_sort(bodies.begin(), bodies.end(), [](const MacroBody& a, const MacroBody& b) { return a.r > b.r; });
  MacroPacking packing = pack_bodies(spec, std::move(bodies), seed, sample, watch);
  for (MacroBody& b : packing.bodies)
    if (!b.soft) b.r -= thickness;
  packing.springs.clear();
  scale_room(packing, room);
  return packing;
}

CellSpecimen make_cells(const MacroSpec& spec, const MacroPacking& packing) {
  const CellMatter& matter = *spec.cells;
  require_same_grains(matter.card, spec);
  const double coarse = solid_volume(packing.bodies);
  if (!(coarse > 0.0)) throw InputError("cells: no solid grains are there, whose cells fines could fill");
  std::vector<Sphere<3>> sites;
  CoarseBodies bodies;
  for (const MacroBody& b : packing.bodies) {
    sites.push_back({b.x - (spec.boundary == Boundary::periodic ? packing.low : Vec3{}), b.r});
    bodies.radius.push_back(b.r);
    bodies.soft.push_back(b.soft);
  }
  const CellRoom room = room_of(spec, packing);
  std::vector<std::array<std::int32_t, 3>> periods(sites.size());
  room.bring_home(sites, periods);
  if (!room.holds(sites)) throw InputError("cells: a body lies outside its box");
  const RadicalCells cells = room.cells_of(sites);
  const FinesLaw fines = fines_law_of(matter.card, spec.youngs_modulus, matter.preparation);
  const double volume = fines_volume(matter, coarse);
  CellStart start = matter.at_density ? start_at_density(fines, bodies, cells.volume, volume)
                                      : start_at_pressure(fines, bodies, cells.volume, volume,
                                                          spec.start_pressure * spec.youngs_modulus);
  CellPacking made(cell_law_of(matter.card, spec), sites, start.content, room);
  return {std::move(made), std::move(start)};
}

std::string compression_only_text(const MacroSpec& spec) {
  if (spec.cells->card.memory) return "";
  const std::string names = stage_names(spec, [](const MacroStage& stage) {
    const StageKind way = stage.record.way;
    const bool shears = keeps_volume(way) || way == StageKind::triaxial || way == StageKind::axes;
    return stage.record.kind == StageKind::unload || (shears && stage.record.kind != StageKind::hold);
  });
  if (names.empty()) return "";
  return fmt::format(
      "the card has no shear memory and serves compression, not {}: in tests with its own fines an unloading modulus "
      "was a third too low, and stresses of loose fines sheared at constant volume were at least 3 times too high; "
      "kind \"material-law\" measures a card with it ([law] memory = true)",
      names);
}

std::string other_preparation_text(const MacroSpec& spec) {
  const CellCard& card = spec.cells->card;
  const std::string own = to_string(spec.preparation);
  if (!spec.cells->preparation.empty() || card.preparation.empty() || card.preparation == own) return "";
  return fmt::format("the fines of the card were prepared '{}', this specimen '{}'{}", card.preparation, own,
                     void_ratio_factor(card, own)
                         ? fmt::format("; with [fines] preparation = \"{}\" cells take the factor of the card", own)
                         : "");
}

std::string start_remark(const MacroSpec& spec, const CellStart& start) {
  const CellCard& card = spec.cells->card;
  const double mixture = spec.cells->share / (1.0 - spec.cells->share);
  std::string text;
  const auto add = [&text](const std::string& one) { append_part(text, one); };
  if (mixture > card.mixture_high)
    add(fmt::format("fines are {:.3g} times the volume of coarse grains, and excess pores were measured up to {:.3g}",
                    mixture, card.mixture_high));
  if (const std::string other = other_preparation_text(spec); !other.empty()) add(other);
  // Onsets follow the start pressure, pores at the critical state follow the card where the preparation was not said:
  // a share of 1.15 then took 63 % of the pressure in shear, one of 0.83 added 26 %.
  const bool of_other_grading = card.memory && spec.cells->preparation.empty() && other_preparation_text(spec).empty();
  const double far = of_other_grading ? 0.05 : 0.5;
  if (!spec.cells->at_density && std::abs(start.excess_share - 1.0) > far)
    add(fmt::format("excess pores are {:.3g} times those of the card at this start pressure{}", start.excess_share,
                    of_other_grading ? fmt::format(", which the critical state does not follow{}",
                                                   card.preparation.empty()
                                                       ? ""
                                                       : fmt::format("; with [fines] preparation = \"{}\" it does",
                                                                     card.preparation))
                                     : ""));
  if (!spec.cells->at_density && spec.start_pressure < card.pressure_low)
    add(fmt::format("the specimen starts at p/E = {:.3g}, below {:.3g}, from which on the law was fitted",
                    spec.start_pressure, card.pressure_low));
  if (start.without_fines > 0)
    add(fmt::format("{} of {} cells are too small for any fines", start.without_fines, start.content.size()));
  return text;
}

void require_same_grains(const CellCard& card, const MacroSpec& spec) {
  if (card.poisson_ratio != spec.poisson_ratio || card.grain_friction != spec.friction ||
      card.grain_rolling != spec.rolling)
    throw InputError(fmt::format(
        "cell law: it was measured with nu = {}, mu = {}{} and serves no grains of nu = {}, mu = {}{}: measure a "
        "card for them",
        card.poisson_ratio, card.grain_friction, rolling_text(card.grain_rolling), spec.poisson_ratio, spec.friction,
        rolling_text(spec.rolling)));
}

namespace {

// What stands in a row of each data set.

constexpr auto kSite = [](auto&& visit, auto& s) {
  visit(s.x);
  visit(s.r);
};
constexpr auto kContent = [](auto&& visit, auto& c) {
  visit(c.solid);
  visit(c.pores);
};
constexpr auto kPeriods = [](auto&& visit, auto& periods) { visit(periods); };
constexpr auto kFace = [](auto&& visit, auto& f) {
  visit(f.key.i);
  visit(f.key.j);
  visit(f.key.periods);
  visit(f.slides);
};
constexpr auto kFaceSpring = [](auto&& visit, auto& f) {
  visit(f.force);
  visit(f.separation);
  visit(f.stiffness);
};
constexpr auto kRoom = [](auto&& visit, auto& state) {
  visit(state.low);
  visit(state.high);
};
constexpr auto kCriticalPores = [](auto&& visit, auto& c) { visit(c.critical); };
constexpr auto kStress = [](auto&& visit, auto& state) { visit(state.stress); };
constexpr auto kFaceShape = [](auto&& visit, auto& f) { visit(f.shape); };
constexpr auto kSpringForces = [](auto&& visit, auto& forces) { visit(forces); };

/// What a law with memory knows beyond the springs of faces.
void write_memory(const h5::Group& memory, const CellState& state) {
  write_rows(memory, "critical_pores", state.content, kCriticalPores);
  write_row(memory, "stress", state, kStress);
  memory.write("strength", state.strength);
  memory.write("next_pores", state.next_pores);
  write_rows(memory, "face_shape", state.springs.springs, kFaceShape);
  write_rows(memory, "spring_forces", state.springs.parts, kSpringForces);
}

void read_memory(const h5::Group& memory, CellState& state) {
  read_rows(memory, "critical_pores", state.content, kCriticalPores);
  read_row(memory, "stress", state, kStress);
  state.strength = memory.doubles("strength");
  state.next_pores = memory.doubles("next_pores");
  read_rows(memory, "face_shape", state.springs.springs, kFaceShape);
  state.springs.parts.resize(state.springs.springs.size());
  read_rows(memory, "spring_forces", state.springs.parts, kSpringForces);
}

}  // namespace

void write_cell_state(const h5::Group& group, const CellState& state) {
  write_row(group, "room", state, kRoom);
  write_rows(group, "sites", state.sites, kSite);
  write_rows(group, "content", state.content, kContent);
  write_rows(group, "periods", state.periods, kPeriods);
  write_rows(group, "faces", state.springs.springs, kFace);
  write_rows(group, "face_springs", state.springs.springs, kFaceSpring);
  if (!state.strength.empty()) write_memory(group.create("memory"), state);
}

CellState read_cell_state(const h5::Group& group) {
  CellState out;
  read_row(group, "room", out, kRoom);
  out.sites = records_in_rows<Sphere<3>>(group, "sites", kSite);
  out.content.resize(out.sites.size());
  read_rows(group, "content", out.content, kContent);
  out.periods.resize(out.sites.size());
  read_rows(group, "periods", out.periods, kPeriods);
  out.springs.springs = records_in_rows<FaceSpring>(group, "faces", kFace);
  read_rows(group, "face_springs", out.springs.springs, kFaceSpring);
  if (group.has("memory")) read_memory(group.open("memory"), out);
  return out;
}

}  // namespace softgrain
