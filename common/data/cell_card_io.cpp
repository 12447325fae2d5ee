// A card of the cell law as text: written for people, read strictly.
#include <fmt/format.h>
#include <gsl/gsl_eigen.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <memory>

#include "common/core/error.h"
#include "common/data/card_text.h"
#include "common/data/cell_card.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

using Out = std::back_insert_iterator<std::string>;

/// A number of [cell] or of [memory].
template <class Table>
struct CardEntry {
  const char* key;
  Estimate Table::*estimate;
  Range range;
  const char* meaning;
  bool logarithm = true;
  bool is_drawn = true;
};

// Ranges hold all numbers that fits end at, and far more. Beyond them a number is a mistake, and a run with it fails
// late.
/// Void ratios: grains jam at solid fractions above 0.01, and fits end at 0.999.
constexpr double kMostPores = 100.0;
constexpr Range kPores{1e-4, kMostPores, false, false};
/// Factors on void ratios, and void ratios over each other.
constexpr Range kFactor{0.01, 100.0, false, false};
/// Numbers of order 1 whose order of magnitude is not known before.
constexpr Range kAnyScale{1e-6, 1e6, false, false};
/// Exponents of p/E: fits of equations of state end there.
constexpr Range kStateExponent{1.0, 20.0, true, false};
/// Pressures over E: those of gravity on fine powders, and far beyond all grains pressed flat.
constexpr Range kOverModulus{1e-15, 1000.0, false, false};

const std::array<CardEntry<CellCard>, 9>& cell_numbers() {
  using C = CellCard;
  static const std::array<CardEntry<C>, 9> numbers{
      {{"K", &C::modulus, kAnyScale, "p/E = K x^n"},
       {"n", &C::exponent, kStateExponent, "its exponent", false},
       {"e_J", &C::void_ratio, kPores, "void ratio of the fines alone where they jam"},
       {"e_c", &C::excess_alone, kPores, "void ratio of the coarse grains alone where they jam"},
       {"w_inf", &C::excess_many, Range::closed(0.0, kMostPores), "excess pores beside coarse grains among many fines",
        false},
       {"xi", &C::excess_decay, kAnyScale, "ratio of fines over which they fall to that"},
       {"mu_f", &C::friction, Range::friction(), "friction of faces"},
       {"chi", &C::stiffness, kAnyScale, "stiffness of their springs"},
       {"K0", &C::lateral_ratio, Range{0.0, 1.0, true, false}, "lateral over axial stress of the fines alone", false,
        false}}};
  return numbers;
}

const std::array<CardEntry<CellMemory>, 6>& memory_numbers() {
  using M = CellMemory;
  static const std::array<CardEntry<M>, 6> numbers{
      {{"A", &M::dilatancy, Range::closed(0.0, 1000.0), "compaction by slip beyond what friction uses of the work",
        false},
       {"r_c", &M::critical_pores, kFactor, "pores at the critical state over those at the onset", false},
       {"m", &M::strength_slope, Range::closed(0.0, 1e6), "growth of the strength of faces with density"},
       {"c", &M::strength_range, Range{0.001, 1.0, false, true}, "strengths lie within mu_f (1 -+ c)", false},
       {"lambda", &M::density_slope, Range{-kLargestExponent, kLargestExponent, false, false},
        "change of the critical solid fraction with phi - phi_J", false},
       {"x_r", &M::least_state, Range{0.0, 1.0, true, true},
        "a cell below this x counts as unloaded; not of the material", true, false}}};
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
  fmt::format_to(
      out,
      "\n# p/E = K x^n of a cell. \"porosity\": x = (phi - phi_J)/(1 - phi_J), \"pores\": x = 1 - Vp/Vp_J;\n"
      "# Vp_J = e_J V_f + W, and of all cells W/V_c = w_inf + (e_c - w_inf) exp(-(V_f/V_c)/xi) for solid\n"
      "# volumes V_f of fines and V_c of coarse grains. A face bears mu_f p A at most, its spring has the stiffness\n"
      "# chi B A/d. Ends of intervals: 95 %.\n");
  fmt::format_to(out, "[cell]\nform = {}\n", quoted(to_string(card.form)));
  for (const auto& n : cell_numbers())
    fmt::format_to(out, "{} = {}  # {}\n", n.key, estimate_text(card.*n.estimate), n.meaning);
}

void write_memory(Out out, const CellMemory& memory) {
  fmt::format_to(
      out,
      "\n# Slip gamma_p with the frictional work W_p moves phi_J: d ln phi_J = A (1.5 mu_f gamma_p - W_p/p). Faces\n"
      "# of cells bear mu_f [1 + c tanh(-m psi/c)], psi = [phi_c + lambda (phi - phi_J) - phi_J]/(1 - phi_c).\n"
      "[memory]\n");
  for (const auto& n : memory_numbers())
    fmt::format_to(out, "{} = {}  # {}\n", n.key, estimate_text(memory.*n.estimate), n.meaning);
}

void write_correlation(Out out, const CellCorrelation& c) {
  const std::size_t n = c.numbers.size();
  fmt::format_to(out,
                 "\n# Correlations of the errors of these numbers, row by row; a number that is missing is held.\n");
  fmt::format_to(out, "[correlation]\nnumbers = [\"{}\"]\nmatrix = [", fmt::join(c.numbers, "\", \""));
  for (std::size_t k = 0; k < n * n; ++k)
    fmt::format_to(out, "{}{}", k == 0 ? "" : k % n == 0 ? ",\n          " : ", ", real(c.matrix[k]));
  fmt::format_to(out, "]\n");
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
  if (card.grain_rolling.friction > 0.0)
    fmt::format_to(out, "mu_r = {}\nkr_ratio = {}\n", real(card.grain_rolling.friction),
                   real(card.grain_rolling.stiffness));
  fmt::format_to(out, "preparation = {}\n", quoted(card.preparation));
  fmt::format_to(out, "start_pressure = {}  # p/E of its end\n", real(card.start_pressure));
  fmt::format_to(out, "split = {}  # fines are below this share of the largest radius\n", real(card.split));
  fmt::format_to(out, "fines_ratio = {}  # largest over smallest radius of the fines\n", real(card.fines_ratio));
  fmt::format_to(out, "fines_sizes = {}\n", quoted(card.fines_sizes));
  fmt::format_to(out, "samples = {}\n", card.samples);
}

void write_preparations(Out out, const std::vector<PreparationFactor>& preparations) {
  if (preparations.empty()) return;
  fmt::format_to(out,
                 "\n# Other preparations of these grains: e_J, e_c and w_inf times the factor; critical pores (r_c) "
                 "stay.\n");
  for (const PreparationFactor& p : preparations)
    fmt::format_to(out, "[[preparation]]\nname = {}\nfactor = {}\n", quoted(p.preparation), estimate_text(p.factor));
}

/// Number `key` of `holder`. A value out of range is said under its name, which its inline table does not hold.
Estimate read_estimate(const SceneTable& holder, const char* key, const Range& range) {
  const SceneTable table = holder.table(key);
  const double value = table.number("value", Unit::none, Range::any());
  if (!range.contains(value))
    holder.throw_error(key, fmt::format("value = {} must be {}", real(value), range_text(range)));
  Estimate e = read_estimate_text(table, range);
  if (!(e.low <= e.high)) table.throw_error("low", "must not be above the high end");
  return e;
}

CellMemory read_memory(const SceneTable& t) {
  CellMemory memory;
  for (const auto& n : memory_numbers()) memory.*n.estimate = read_estimate(t, n.key, n.range);
  const double c = memory.strength_range.value;
  if (memory.dilatancy.value > most_dilatancy(c))
    t.throw_error("A",
                  fmt::format("must be at most (1 + c)/c = {:.4g}, or slip would give energy back", most_dilatancy(c)));
  return memory;
}

/// Whether errors can have these correlations: no eigenvalue below 0 but for rounding. It may be 0: numbers that few
/// samples determine go together exactly.
bool is_positive(std::vector<double> matrix, std::size_t n) {
  constexpr double kRounding = 1e-9;
  std::vector<double> values(n);
  const std::unique_ptr<gsl_eigen_symm_workspace, decltype(&gsl_eigen_symm_free)> space(gsl_eigen_symm_alloc(n),
                                                                                        &gsl_eigen_symm_free);
  gsl_matrix_view m = gsl_matrix_view_array(matrix.data(), n, n);
  gsl_vector_view v = gsl_vector_view_array(values.data(), n);
  gsl_eigen_symm(&m.matrix, &v.vector, space.get());
  return *std::ranges::min_element(values) >= -kRounding;
}

/// For numbers of the card as it has been read so far.
CellCorrelation read_correlation(const SceneTable& t, const CellCard& card) {
  CellCorrelation out;
  out.numbers = t.texts("numbers");
  const std::vector<CellCardNumber> known = numbers_of(card);
  std::vector<std::string> keys;
  for (const CellCardNumber& n : known) keys.push_back(n.key);
  for (std::size_t k = 0; k < out.numbers.size(); ++k) {
    const auto first = out.numbers.begin();
    if (std::ranges::find(keys, out.numbers[k]) == keys.end())
      t.throw_error("numbers",
                    fmt::format("\"{}\" is no number of this card: {}", out.numbers[k], fmt::join(keys, ", ")));
    if (std::find(first, first + static_cast<std::ptrdiff_t>(k), out.numbers[k]) !=
        first + static_cast<std::ptrdiff_t>(k))
      t.throw_error("numbers", fmt::format("\"{}\" stands there twice", out.numbers[k]));
  }
  const std::size_t n = out.numbers.size();
  out.matrix = t.numbers("matrix", Unit::none, Range::closed(-1.0, 1.0));
  if (n == 0 || out.matrix.size() != n * n)
    t.throw_error("matrix", fmt::format("must be {} numbers, row by row", n * n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (out.matrix[i * n + j] != (i == j ? 1.0 : out.matrix[j * n + i]))
        t.throw_error("matrix", "must be 1 on its diagonal, and the same across it");
  if (!is_positive(out.matrix, n))
    t.throw_error("matrix", "contradicts itself: no errors have these correlations (an eigenvalue is below 0)");
  return out;
}

void read_range(const SceneTable& t, CellCard& card) {
  const std::vector<double> pressure = t.numbers("pressure", Unit::none, kOverModulus);
  if (pressure.size() != 2 || !(pressure[0] < pressure[1])) t.throw_error("pressure", "must be two rising values");
  card.pressure_low = pressure[0];
  card.pressure_high = pressure[1];
  card.mixture_high = t.number("mixture_max", Unit::none, kAnyScale);
}

void read_measured(const SceneTable& t, CellCard& card) {
  if (t.has("E")) card.youngs_modulus = t.number("E", Unit::pressure, Range::positive());
  if (t.has("density")) card.density = t.number("density", Unit::density, Range::positive());
  card.poisson_ratio = t.number("nu", Unit::none, kPoissonRange);
  card.grain_friction = t.number("mu", Unit::none, Range::friction());
  if (t.has("mu_r")) {
    card.grain_rolling.friction = t.number("mu_r", Unit::none, Range{0.0, 1000.0, true, false});
    card.grain_rolling.stiffness = t.number("kr_ratio", Unit::none, Range{0.0, 1000.0, true, false});
  }
  card.preparation = t.line_text("preparation");
  card.start_pressure = t.number("start_pressure", Unit::none, kOverModulus);
  card.split = t.number("split", Unit::none, Range{0.0, 1.0, true, true});
  card.fines_ratio = t.number("fines_ratio", Unit::none, Range::closed(1.0, 1e9));
  card.fines_sizes = t.filled_text("fines_sizes");
  card.samples = t.count("samples", 1, std::numeric_limits<int>::max());
}

void read_preparations(const SceneTable& root, CellCard& card) {
  for (const SceneTable& t : root.tables("preparation")) {
    PreparationFactor p{t.line_text("name"), read_estimate(t, "factor", kFactor)};
    if (void_ratio_factor(card, p.preparation))
      t.throw_error("name",
                    p.preparation == card.preparation ? "is that of [measured], whose factor is 1" : "is used twice");
    card.preparations.push_back(std::move(p));
  }
}

}  // namespace

std::optional<double> void_ratio_factor(const CellCard& card, const std::string& preparation) {
  if (preparation.empty() || preparation == card.preparation) return 1.0;
  const auto at = std::ranges::find(card.preparations, preparation, &PreparationFactor::preparation);
  if (at == card.preparations.end()) return std::nullopt;
  return at->factor.value;
}

std::string missing_factor_text(const CellCard& card, const std::string& preparation) {
  std::string has = fmt::format("the card was measured on grains prepared '{}'", card.preparation);
  for (std::size_t k = 0; k < card.preparations.size(); ++k)
    has += fmt::format("{} '{}'", k == 0 ? ", has a factor for" : ",", card.preparations[k].preparation);
  return fmt::format(
      "{}{} for '{}': kind \"material-law\" measures one for every way of preparing but LAMMPS ([law] "
      "preparations)",
      has, card.preparations.empty() ? " and has no factor on void ratios" : " and none", preparation);
}

std::vector<CellCardNumber> numbers_of(const CellCard& card) {
  std::vector<CellCardNumber> out;
  for (const auto& n : cell_numbers()) out.push_back({n.key, card.*n.estimate, n.meaning, n.logarithm, n.is_drawn});
  if (card.memory)
    for (const auto& n : memory_numbers())
      out.push_back({n.key, *card.memory.*n.estimate, n.meaning, n.logarithm, n.is_drawn});
  return out;
}

void set_number(CellCard& card, const std::string& key, double value) {
  constexpr double kLeast = 1e-9;  // of what lies above an end
  const auto within = [&](const Range& range) {
    return std::clamp(value, range.low_open ? range.low + kLeast : range.low,
                      range.high_open ? range.high - kLeast : range.high);
  };
  for (const auto& n : cell_numbers())
    if (n.key == key) return void((card.*n.estimate).value = within(n.range));
  if (card.memory)
    for (const auto& n : memory_numbers())
      if (n.key == key) return void((*card.memory.*n.estimate).value = within(n.range));
  throw InputError("cell law: no number \"" + key + "\" in the card");
}

std::string meaning_of_cell_number(const std::string& key) {
  for (const auto& n : cell_numbers())
    if (n.key == key) return n.meaning;
  for (const auto& n : memory_numbers())
    if (n.key == key) return n.meaning;
  return "";
}

void write_cell_card(const CellCard& card, const std::string& path, const Provenance& provenance) {
  std::string text;
  const Out out(text);
  write_head(out, provenance);
  write_numbers(out, card);
  if (card.memory) write_memory(out, *card.memory);
  if (!card.correlation.numbers.empty()) write_correlation(out, card.correlation);
  write_range(out, card);
  write_measured(out, card);
  write_preparations(out, card.preparations);
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
  for (const auto& n : cell_numbers()) card.*n.estimate = read_estimate(cell, n.key, n.range);
  if (root.has("memory")) {
    card.memory = read_memory(root.table("memory"));
    if (card.form != StateForm::porosity) cell.throw_error("form", "[memory] goes with \"porosity\"");
    if (!(card.friction.value > 0.0)) cell.throw_error("mu_f", "must be above 0 with [memory]");
  }
  if (root.has("correlation")) card.correlation = read_correlation(root.table("correlation"), card);
  read_range(root.table("range"), card);
  read_measured(root.table("measured"), card);
  read_preparations(root, card);
  root.finish();
  return card;
}

}  // namespace softgrain
