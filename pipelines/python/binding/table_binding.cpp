#include "pipelines/python/binding/law_bindings.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/contact/make_laws.h"
#include "common/core/limits.h"
#include "common/data/multi_contact_replicates.h"
#include "pipelines/python/binding/binding_tools.h"

namespace softgrain::python {

namespace {

constexpr std::size_t kChunk = 4096;  ///< states whose replicates are kept at a time

LawTableEntry entry_of(const LawTable& table, const TableChoice& choice, std::string& remark) {
  return entry_at(table, choice.solid_fraction.value_or(main_entry(table).solid_fraction),
                  parse_choice<RangePolicy>("range", choice.range), remark, kReachOfNumbers);
}

LawForm form_of(const LawTableEntry& entry, const TableChoice& choice) {
  return choice.form ? parse_choice<LawForm>("form", *choice.form) : entry.best;
}

MultiContactLaws laws_of(const LawTableEntry& entry, LawForm form, const TableChoice& choice, double scale) {
  MultiContactChoices choices;
  choices.form = form;
  choices.modulus = scale;
  choices.rolling = false;
  choices.beyond = beyond_of(choice.beyond);
  return make_multi_contact_laws(entry, choices);
}

Vec3 unit(const std::vector<double>& direction) {
  if (direction.size() != 3) throw InputError("direction: must have three coordinates");
  const Vec3 d{{direction[0], direction[1], direction[2]}};
  const double length = norm(d);
  if (!std::isfinite(length) || !(length > 0.0))
    throw InputError("direction: must be a vector of finite length, not 0");
  return d * (1.0 / length);
}

std::vector<law::MultiContactNeighbour> neighbours_of(const NeighbourChoice& choice) {
  if (choice.kinds.empty()) throw InputError("neighbours: must be at least one");
  if (choice.ratios.size() != choice.kinds.size() || choice.directions.size() != choice.kinds.size())
    throw InputError("neighbours: as many ratios and directions are needed as kinds, " +
                     std::to_string(choice.kinds.size()));
  std::vector<law::MultiContactNeighbour> out;
  for (std::size_t k = 0; k < choice.kinds.size(); ++k) {
    const PartnerKind kind = parse_choice<PartnerKind>("partner", choice.kinds[k]);
    if (kind != PartnerKind::plane && !(choice.ratios[k] > 0.0 && std::isfinite(choice.ratios[k])))
      throw InputError("ratio: must be above 0");
    out.push_back({kind, choice.ratios[k], unit(choice.directions[k])});
  }
  return out;
}

void require_columns(const Array& overlap, std::size_t neighbours, int which) {
  if (overlap.ndim() != 2 || overlap.shape(1) != static_cast<pybind11::ssize_t>(neighbours))
    throw InputError("overlap: must have one column per neighbour, " + std::to_string(neighbours));
  if (which >= static_cast<int>(neighbours)) throw InputError("which: must be below the number of neighbours");
}

/// Throws InputError for equivalent volumes beyond what was measured, when the laws do not allow them.
void require_allowed(const MultiContactLaws& laws, const std::vector<law::MultiContactNeighbour>& around,
                     const LawTableEntry& entry, const TableChoice& choice, std::span<const double> overlap) {
  if (beyond_of(choice.beyond).value_or(entry.beyond) != Extrapolation::error || !(entry.volume_max > 0.0)) return;
  std::vector<double> volume(overlap.size() / around.size());
  multi_contact_array(laws, around, LawOutput::volume, 0, overlap, volume);
  const auto most = std::max_element(volume.begin(), volume.end());
  constexpr double kRounding = 1e-9;
  if (most == volume.end() || !(*most > entry.volume_max * (1.0 + kRounding))) return;
  std::ostringstream text;
  text << "overlap: an equivalent volume of " << *most << " must be at most " << entry.volume_max
       << ", the end of what was measured (beyond = \"error\"; \"clamp\" and \"extrapolate\" go on)";
  throw InputError(text.str());
}

/// The laws of all replicates.
std::vector<MultiContactLaws> drawn_laws(const LawTable& table, LawForm form, const TableChoice& choice, double scale) {
  std::vector<MultiContactLaws> out;
  std::string ignored;
  const std::size_t n = replicate_count(table, form);
  for (std::size_t r = 0; r < n; ++r)
    out.push_back(laws_of(entry_of(replicate_of(table, form, r), choice, ignored), form, choice, scale));
  return out;
}

/// Whether each state lies beyond what was measured: a single overlap, or the equivalent volume.
std::vector<char> beyond_range(const MultiContactLaws& laws, const std::vector<law::MultiContactNeighbour>& around,
                               const LawTableEntry& entry, LawForm form, std::span<const double> overlap) {
  constexpr double kRounding = 1e-9;
  const std::size_t neighbours = around.size();
  std::vector<char> out(overlap.size() / neighbours, 0);
  std::vector<double> volume(out.size());
  multi_contact_array(laws, around, LawOutput::volume, 0, overlap, volume);
  for (std::size_t k = 0; k < neighbours; ++k) {
    const double end = measured_overlap(entry, form, around[k].kind, around[k].ratio);
    for (std::size_t s = 0; s < out.size(); ++s)
      if (overlap[s * neighbours + k] > end * (1.0 + kRounding)) out[s] = 1;
  }
  for (std::size_t s = 0; s < out.size(); ++s)
    if (entry.volume_max > 0.0 && volume[s] > entry.volume_max * (1.0 + kRounding)) out[s] = 1;
  return out;
}

/// 95 % intervals over the laws of replicates about the law itself, state by state.
void band(const MultiContactLaws& laws, const std::vector<MultiContactLaws>& drawn, int packings,
          const std::vector<law::MultiContactNeighbour>& around, LawOutput what, int which,
          std::span<const double> overlap, std::span<double> low, std::span<double> high) {
  std::vector<double> value(low.size());
  multi_contact_array(laws, around, what, which, overlap, value);
  std::vector<double> rows(drawn.size() * low.size());
  for (std::size_t r = 0; r < drawn.size(); ++r)
    multi_contact_array(drawn[r], around, what, which, overlap, std::span(rows).subspan(r * low.size(), low.size()));
  std::vector<double> one(drawn.size());
  for (std::size_t k = 0; k < low.size(); ++k) {
    for (std::size_t r = 0; r < drawn.size(); ++r) one[r] = rows[r * low.size() + k];
    const auto interval = refit_interval(value[k], one, packings);
    low[k] = interval ? interval->low : kNaN;
    high[k] = interval ? interval->high : kNaN;
  }
}

}  // namespace

pybind11::dict TableBinding::about(const TableChoice& choice) const {
  std::string remark;
  const LawTableEntry entry = entry_of(table_, choice, remark);
  const LawForm form = form_of(entry, choice);
  pybind11::dict out;
  out["form"] = to_string(form);
  out["solid_fraction"] = entry.solid_fraction;
  out["volume_max"] = entry.volume_max;
  out["overlap_max"] = entry.overlap_max;
  out["beyond"] = to_string(entry.beyond);
  out["remark"] = remark;
  out["shell_radius"] = entry.spec.shell_radius;
  out["youngs_modulus"] = entry.spec.youngs_modulus;
  out["replicates"] = replicate_count(table_, form);
  const MultiContactLaw* law = entry.find(form);
  out["status"] = law == nullptr ? "not run" : to_string(law->status);
  return out;
}

Array TableBinding::values(const TableChoice& choice, const NeighbourChoice& neighbours, const std::string& what,
                           int which, const Array& overlap, double scale) const {
  const LawOutput output = parse_choice<LawOutput>("what", what);
  const std::vector<law::MultiContactNeighbour> around = neighbours_of(neighbours);
  require_columns(overlap, around.size(), which);
  std::string remark;
  const LawTableEntry entry = entry_of(table_, choice, remark);
  const MultiContactLaws laws = laws_of(entry, form_of(entry, choice), choice, scale);
  Array out = which < 0 ? like(overlap) : Array(overlap.shape(0));
  const std::span<const double> in = view(overlap);
  const std::span<double> to = view(out);
  const pybind11::gil_scoped_release others_may_run;
  require_allowed(laws, around, entry, choice, in);
  multi_contact_array(laws, around, output, which, in, to);
  return out;
}

std::optional<std::pair<Array, Array>> TableBinding::interval(const TableChoice& choice,
                                                              const NeighbourChoice& neighbours,
                                                              const std::string& what, int which, const Array& overlap,
                                                              double scale) const {
  const LawOutput output = parse_choice<LawOutput>("what", what);
  const std::vector<law::MultiContactNeighbour> around = neighbours_of(neighbours);
  require_columns(overlap, around.size(), which);
  std::string remark;
  const LawTableEntry entry = entry_of(table_, choice, remark);
  const LawForm form = form_of(entry, choice);
  if (replicate_count(table_, form) < kEnoughReplicates) return std::nullopt;
  Array low(overlap.shape(0));
  Array high(overlap.shape(0));
  const std::span<const double> in = view(overlap);
  const std::span<double> to_low = view(low);
  const std::span<double> to_high = view(high);
  const pybind11::gil_scoped_release others_may_run;
  const MultiContactLaws laws = laws_of(entry, form, choice, scale);
  require_allowed(laws, around, entry, choice, in);
  const std::vector<MultiContactLaws> drawn = drawn_laws(table_, form, choice, scale);
  for (std::size_t at = 0; at < to_low.size(); at += kChunk) {
    const std::size_t n = std::min(kChunk, to_low.size() - at);
    const std::span<const double> some = in.subspan(at * around.size(), n * around.size());
    band(laws, drawn, entry.packings, around, output, which, some, to_low.subspan(at, n), to_high.subspan(at, n));
    const std::vector<char> beyond = beyond_range(laws, around, entry, form, some);
    for (std::size_t k = 0; k < n; ++k)
      if (beyond[k] != 0) to_low[at + k] = to_high[at + k] = kNaN;
  }
  return std::pair{std::move(low), std::move(high)};
}

}  // namespace softgrain::python
