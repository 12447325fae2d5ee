// A card of the cell law as text: written for people, read strictly.
#include <fmt/format.h>

#include <array>
#include <iterator>
#include <limits>

#include "common/core/error.h"
#include "common/data/card_text.h"
#include "common/data/cell_card.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

using Out = std::back_insert_iterator<std::string>;

/// A number of [cell].
struct CellNumber {
  const char* key;
  Estimate CellCard::*estimate;
  Range range;
  const char* meaning;
};

const std::array<CellNumber, 9>& cell_numbers() {
  using C = CellCard;
  static const std::array<CellNumber, 9> numbers{
      {{"K", &C::modulus, Range::positive(), ""},
       {"n", &C::exponent, Range{1.0, kLargestExponent, true, false}, ""},
       {"e_J", &C::void_ratio, Range::positive(), "pores over solid volume of the fines alone where they jam"},
       {"e_c", &C::excess_alone, Range::positive(), "the same of the coarse grains alone"},
       {"w_inf", &C::excess_many, Range::not_negative(), ""},
       {"xi", &C::excess_decay, Range::positive(), ""},
       {"mu_f", &C::friction, Range::not_negative(), "limit of the friction of faces over p A"},
       {"chi", &C::stiffness, Range::positive(), "stiffness of its spring over B A/d"},
       {"K0", &C::lateral_ratio, Range{0.0, 1.0, true, false},
        "lateral over axial stress of the fines, oedometric; for people"}}};
  return numbers;
}

void write_head(Out out, const Provenance& provenance) {
  fmt::format_to(out,
                 "# Law of coarse grains in cells of fines: measured on fines, on coarse grains and on mixtures.\n");
  fmt::format_to(out,
                 "# All numbers are dimensionless, so one card serves any E and any size of grains of this shape\n");
  fmt::format_to(out, "# of distribution, prepared in the same way.\n");
  fmt::format_to(out, "schema = {}\n\n[provenance]\n", kSchemaVersion);
  fmt::format_to(out, "version = {}\ncommit = {}\n", quoted(provenance.version), quoted(provenance.commit));
  fmt::format_to(out, "compiler = {}\ncommand = {}\n", quoted(provenance.compiler), quoted(provenance.command));
  fmt::format_to(out, "seed = {}\nthreads = {}\n", quoted(fmt::format("{}", provenance.seed)), provenance.threads);
}

void write_numbers(Out out, const CellCard& card) {
  fmt::format_to(out,
                 "\n# p/E = K x^n of a cell. \"porosity\": x = (phi - phi_J)/(1 - phi_J), \"pores\": x = 1 - Vp/Vp_J;\n"
                 "# Vp_J = e_J V_f + W, and of all cells W/V_c = w_inf + (e_c - w_inf) exp(-(V_f/V_c)/xi) for solid\n"
                 "# volumes V_f of fines and V_c of coarse grains. Ends of intervals: 95 %.\n");
  fmt::format_to(out, "[cell]\nform = {}\n", quoted(to_string(card.form)));
  for (const CellNumber& n : cell_numbers())
    fmt::format_to(out, "{} = {}{}{}\n", n.key, estimate_text(card.*n.estimate), *n.meaning == '\0' ? "" : "  # ",
                   n.meaning);
}

void write_range(Out out, const CellCard& card) {
  fmt::format_to(out, "\n# Where it was measured.\n[range]\n");
  fmt::format_to(out, "pressure = [{}, {}]  # p/E\n", real(card.pressure_low), real(card.pressure_high));
  fmt::format_to(out, "mixture_max = {}  # V_f/V_c; the smallest is 0\n", real(card.mixture_high));
}

void write_measured(Out out, const CellCard& card) {
  fmt::format_to(out, "\n# Grains and preparation; others have other numbers.\n[measured]\n");
  if (is_known(card.youngs_modulus))
    fmt::format_to(out, "E = {}  # [Pa]; a scene may have another one: stresses go with it\n",
                   real(card.youngs_modulus));
  if (is_known(card.density)) fmt::format_to(out, "density = {}  # [kg/m^3]\n", real(card.density));
  fmt::format_to(out, "nu = {}\nmu = {}\n", real(card.poisson_ratio), real(card.grain_friction));
  fmt::format_to(out, "preparation = {}\n", quoted(card.preparation));
  fmt::format_to(out, "start_pressure = {}  # p/E of its end\n", real(card.start_pressure));
  fmt::format_to(out, "split = {}  # fines are below this share of the largest radius\n", real(card.split));
  fmt::format_to(out, "fines_ratio = {}  # largest over smallest radius of the fines\n", real(card.fines_ratio));
  fmt::format_to(out, "fines_sizes = {}\n", quoted(card.fines_sizes));
  fmt::format_to(out, "samples = {}\n", card.samples);
}

Estimate read_estimate(const SceneTable& table, const Range& range) {
  Estimate e = read_estimate_text(table, range);
  if (!(e.low <= e.high)) table.throw_error("low", "must not be above the high end");
  return e;
}

void read_range(const SceneTable& t, CellCard& card) {
  const std::vector<double> pressure = t.numbers("pressure", Unit::none, Range::positive());
  if (pressure.size() != 2 || !(pressure[0] < pressure[1])) t.throw_error("pressure", "must be two rising values");
  card.pressure_low = pressure[0];
  card.pressure_high = pressure[1];
  card.mixture_high = t.number("mixture_max", Unit::none, Range::positive());
}

std::string read_words_of(const SceneTable& t, const char* key) {
  std::string text = t.text(key);
  if (text.empty()) t.throw_error(key, "must not be empty");
  return text;
}

void read_measured(const SceneTable& t, CellCard& card) {
  if (t.has("E")) card.youngs_modulus = t.number("E", Unit::pressure, Range::positive());
  if (t.has("density")) card.density = t.number("density", Unit::density, Range::positive());
  card.poisson_ratio = t.number("nu", Unit::none, kPoissonRange);
  card.grain_friction = t.number("mu", Unit::none, Range::not_negative());
  card.preparation = read_words_of(t, "preparation");
  card.start_pressure = t.number("start_pressure", Unit::none, Range::positive());
  card.split = t.number("split", Unit::none, Range{0.0, 1.0, true, true});
  card.fines_ratio = t.number("fines_ratio", Unit::none, Range{1.0, std::numeric_limits<double>::max(), false, false});
  card.fines_sizes = read_words_of(t, "fines_sizes");
  card.samples = t.count("samples", 1, std::numeric_limits<int>::max());
}

}  // namespace

void write_cell_card(const CellCard& card, const std::string& path, const Provenance& provenance) {
  std::string text;
  const Out out(text);
  write_head(out, provenance);
  write_numbers(out, card);
  write_range(out, card);
  write_measured(out, card);
  write_text_atomic(path, text);
}

CellCard read_cell_card(const std::string& path) { return read_cell_card(Scene::load(path)); }

CellCard read_cell_card(const Scene& file) {
  const SceneTable root = file.root();
  CellCard card;
  (void)root.count("schema", kSchemaVersion, kSchemaVersion);
  (void)read_words(root, {});
  const SceneTable cell = root.table("cell");
  card.form = cell.choice<StateForm>("form");
  for (const CellNumber& n : cell_numbers()) card.*n.estimate = read_estimate(cell.table(n.key), n.range);
  read_range(root.table("range"), card);
  read_measured(root.table("measured"), card);
  root.finish();
  return card;
}

}  // namespace softgrain
