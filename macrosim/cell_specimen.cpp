#include "macrosim/cell_specimen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/contact/rolling_scene.h"
#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/text.h"
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
          card.memory ? card.memory->critical_pores.value / *f : 0.0};
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
  constexpr double kFar = 0.5;
  if (!spec.cells->at_density && std::abs(start.excess_share - 1.0) > kFar)
    add(fmt::format("excess pores are {:.3g} times those of the card at this start pressure", start.excess_share));
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

/// What a law with memory knows beyond the springs of faces.
void write_memory(const h5::Group& group, const CellState& state) {
  const h5::Group memory = group.create("memory");
  std::vector<double> critical;
  for (const CellContent& c : state.content) critical.push_back(c.critical);
  std::vector<double> shape;
  for (const FaceSpring& f : state.springs.springs) shape.push_back(f.shape);
  std::vector<double> parts;
  for (const SpringForces& forces : state.springs.parts)
    for (const Vec3& v : forces) parts.insert(parts.end(), {v[0], v[1], v[2]});
  std::vector<double> stress;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) stress.push_back(state.stress[k][l]);
  memory.write("critical_pores", critical);
  memory.write("stress", stress);
  memory.write("strength", state.strength);
  memory.write("next_pores", state.next_pores);
  memory.write("face_shape", shape);
  memory.write("spring_forces", parts, {shape.size(), 3 * kFaceSprings});
}

void read_memory(const h5::Group& memory, CellState& state) {
  const auto critical = memory.doubles("critical_pores");
  const auto shape = memory.doubles("face_shape");
  const auto parts = memory.doubles("spring_forces");
  const auto stress = memory.doubles("stress");
  state.strength = memory.doubles("strength");
  state.next_pores = memory.doubles("next_pores");
  std::vector<FaceSpring>& springs = state.springs.springs;
  if (stress.size() != 9 || critical.size() != state.content.size() || shape.size() != springs.size() ||
      parts.size() != 3 * kFaceSprings * springs.size())
    throw IoError("cells: arrays of wrong length");
  for (int k = 0; k < 9; ++k) state.stress[k / 3][k % 3] = stress[static_cast<std::size_t>(k)];
  for (std::size_t i = 0; i < critical.size(); ++i) state.content[i].critical = critical[i];
  for (std::size_t f = 0; f < springs.size(); ++f) {
    springs[f].shape = shape[f];
    SpringForces& forces = state.springs.parts.emplace_back();
    for (std::size_t k = 0; k < 3 * kFaceSprings; ++k)
      forces[k / 3][static_cast<int>(k % 3)] = parts[3 * kFaceSprings * f + k];
  }
}

}  // namespace

void write_cell_state(const h5::Group& group, const CellState& state) {
  std::vector<double> sites;
  std::vector<double> content;
  std::vector<std::int64_t> periods;
  for (const auto& s : state.sites) sites.insert(sites.end(), {s.x[0], s.x[1], s.x[2], s.r});
  for (const CellContent& c : state.content) content.insert(content.end(), {c.solid, c.pores});
  for (const auto& p : state.periods) periods.insert(periods.end(), p.begin(), p.end());
  std::vector<std::int64_t> faces;
  std::vector<double> springs;
  for (const FaceSpring& f : state.springs.springs) {
    faces.insert(faces.end(), {f.key.i, f.key.j, f.key.periods[0], f.key.periods[1], f.key.periods[2], f.slides});
    for (const Vec3& v : {f.force, f.separation}) springs.insert(springs.end(), {v[0], v[1], v[2]});
    springs.push_back(f.stiffness);
  }
  const std::vector<double> box{state.low[0], state.low[1], state.low[2], state.high[0], state.high[1], state.high[2]};
  group.write("room", box);
  group.write("sites", sites, {state.sites.size(), 4});
  group.write("content", content, {state.content.size(), 2});
  group.write("periods", periods, {state.periods.size(), 3});
  const std::size_t count = state.springs.springs.size();
  group.write("faces", faces, {count, 6});
  group.write("face_springs", springs, {count, 7});
  if (!state.strength.empty()) write_memory(group, state);
}

CellState read_cell_state(const h5::Group& group) {
  const auto box = group.doubles("room");
  const auto sites = group.doubles("sites");
  const auto content = group.doubles("content");
  const auto periods = group.integers("periods");
  const auto faces = group.integers("faces");
  const auto springs = group.doubles("face_springs");
  const std::size_t n = sites.size() / 4;
  if (box.size() != 6 || sites.size() != 4 * n || content.size() != 2 * n || periods.size() != 3 * n ||
      faces.size() % 6 != 0 || springs.size() != faces.size() / 6 * 7)
    throw IoError("cells: arrays of wrong length");
  CellState out;
  out.low = {{box[0], box[1], box[2]}};
  out.high = {{box[3], box[4], box[5]}};
  const auto whole = [](std::int64_t x) { return static_cast<std::int32_t>(x); };
  for (std::size_t i = 0; i < n; ++i) {
    out.sites.push_back({{{sites[4 * i], sites[4 * i + 1], sites[4 * i + 2]}}, sites[4 * i + 3]});
    out.content.push_back({content[2 * i], content[2 * i + 1]});
    out.periods.push_back({whole(periods[3 * i]), whole(periods[3 * i + 1]), whole(periods[3 * i + 2])});
  }
  for (std::size_t f = 0; 6 * f < faces.size(); ++f) {
    const auto* k = &faces[6 * f];
    const auto* v = &springs[7 * f];
    FaceSpring spring{{whole(k[0]), whole(k[1]), {whole(k[2]), whole(k[3]), whole(k[4])}},
                      {{v[0], v[1], v[2]}},
                      v[6],
                      {{v[3], v[4], v[5]}},
                      k[5] != 0};
    out.springs.springs.push_back(spring);
  }
  if (group.has("memory")) read_memory(group.open("memory"), out);
  return out;
}

}  // namespace softgrain
