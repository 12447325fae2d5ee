// The refits behind multi-contact laws, how sure these are by them, and up to where they were measured.
#include "common/data/multi_contact_replicates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/data/columns.h"
#include "common/data/law_card_format.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

namespace {

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return std::abs(x - y) <= 1e-9 * std::abs(y); });
}

/// False when the refits are those of other numbers.
bool read_law(const h5::Group& group, MultiContactLaw& law, const std::string& path) {
  if (!group.has("replicates") || !group.has("numbers")) return true;
  const std::vector<double> numbers = multi_contact_numbers(law);
  if (!same(group.doubles("numbers"), numbers)) return false;
  const h5::Shape shape = group.shape("replicates");
  const std::vector<double> all = group.doubles("replicates");
  if (shape.size() != 2 || shape[1] != numbers.size())
    throw IoError(path + ": the replicates of the " + to_string(law.form) + " law have a wrong length");
  if (!std::all_of(all.begin(), all.end(), [](double x) { return std::isfinite(x); }))
    throw IoError(path + ": the replicates of the " + to_string(law.form) + " law hold a number that is not finite");
  for (std::size_t r = 0; r < shape[0]; ++r) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(r * shape[1]);
    law.replicates.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(shape[1]));
  }
  return true;
}

}  // namespace

std::vector<double> multi_contact_numbers(const MultiContactLaw& law) {
  std::vector<double> out;
  for (const MultiContactParameterName& p : kMultiContactParameters) out.push_back((law.*p.estimate).value);
  for (const PartnerRow& row : law.partners) {
    out.push_back(row.weight.value);
    out.push_back(row.exponent.value);
  }
  return out;
}

MultiContactLaw with_numbers(const MultiContactLaw& law, const std::vector<double>& numbers) {
  if (numbers.size() != kMultiContactParameters.size() + 2 * law.partners.size())
    throw std::invalid_argument("a row of numbers that is not of this law");
  MultiContactLaw out = law;
  auto next = numbers.begin();
  for (const MultiContactParameterName& p : kMultiContactParameters) (out.*p.estimate).value = *next++;
  for (PartnerRow& row : out.partners) {
    row.weight.value = *next++;
    row.exponent.value = *next++;
  }
  return out;
}

void read_replicates(LawTable& table, const std::string& toml_path) {
  const std::string path = table_path(toml_path);
  if (!std::filesystem::exists(path)) return;
  const h5::Group root = h5::open_file(path);
  require_own_table(root, table.table_id, path);
  for (std::size_t k = 0; k < table.entries.size(); ++k) {
    const std::string name = fmt::format("entry_{}", k);
    if (!root.has(name)) continue;
    const h5::Group entry = root.open(name);
    for (MultiContactLaw& law : table.entries[k].laws) {
      std::string form = to_string(law.form);
      if (!entry.has(form)) form = earlier_name(form);
      if (entry.has(form) && !read_law(entry.open(form), law, path))
        table.notes.push_back(fmt::format(
            "solid fraction {:.3f}, {} law: its numbers are not those that {} was written with: the refits there, and "
            "intervals from them, are not used",
            table.entries[k].solid_fraction, to_string(law.form), path));
    }
  }
}

namespace {

void require_rows(const h5::Group& group, const char* name, std::size_t rows) {
  const h5::Shape shape = group.shape(name);
  if (shape.size() != 2 || shape[0] != rows) group.refuse(name, fmt::format("must have {} rows", rows));
}

/// `known`: this form is taken unless another is asked for, so that its numbers are finite; errors of parameters may be
/// infinite all the same. Numbers of forms whose fit failed may be anything.
void check_form(const h5::Group& law, bool known) {
  require_rows(law, "parameters", kMultiContactParameters.size());
  const std::vector<double> parameters = law.doubles("parameters");
  const std::size_t columns = parameters.size() / kMultiContactParameters.size();
  for (std::size_t k = 0; known && k < parameters.size(); k += columns)
    if (!std::isfinite(parameters[k]))
      law.refuse("parameters", fmt::format("row {} begins with a number that is not finite", k / columns));
  for (const char* grid : {"overlap", "force"}) {
    require_rows(law, grid, law.integers("kind").size());
    if (known) (void)finite_numbers(law, grid);
  }
  if (!law.has("replicates")) return;
  const h5::Shape shape = law.shape("replicates");
  if (shape.size() != 2 || shape[1] != finite_numbers(law, "numbers").size())
    law.refuse("replicates", "must have a column for each of 'numbers'");
  (void)finite_numbers(law, "replicates");
}

}  // namespace

void check_replicates(const std::string& path) {
  h5::naming_file(path, [&] {
    const h5::Group root = h5::open_file(path);
    for (std::size_t k = 0; root.has(fmt::format("entry_{}", k)); ++k) {
      const h5::Group entry = root.open(fmt::format("entry_{}", k));
      const std::string best = entry.text("best");
      for (const std::string& name : entry.children())
        if (name != "spec") check_form(entry.open(name), name == best);
    }
  });
}

LawTable replicate_of(const LawTable& table, LawForm form, std::size_t r) {
  LawTable out = table;
  for (LawTableEntry& e : out.entries)
    for (MultiContactLaw& law : e.laws)
      if (law.form == form) law = with_numbers(law, law.replicates.at(r));
  return out;
}

std::size_t replicate_count(const LawTable& table, LawForm form) {
  std::size_t least = table.entries.empty() ? 0 : static_cast<std::size_t>(-1);
  for (const LawTableEntry& e : table.entries) {
    const MultiContactLaw* law = e.find(form);
    least = std::min(least, law == nullptr ? 0 : law->replicates.size());
  }
  return least;
}

double measured_overlap(const LawTableEntry& entry, LawForm form, PartnerKind partner, double ratio) {
  if (partner == PartnerKind::plane) return entry.overlap_max;
  const MultiContactLaw* law = entry.find(form);
  const std::vector<PartnerRow> rows = law == nullptr ? std::vector<PartnerRow>{} : law->rows(partner);
  if (rows.empty()) return 0.0;
  const double wanted = partner == PartnerKind::soft ? std::max(ratio, 1.0 / ratio) : ratio;
  const auto nearest = std::min_element(rows.begin(), rows.end(), [&](const PartnerRow& a, const PartnerRow& b) {
    return std::abs(std::log(a.ratio / wanted)) < std::abs(std::log(b.ratio / wanted));
  });
  return nearest->overlap_max * std::min(1.0, ratio);
}

std::optional<LawInterval> refit_interval(double value, const std::vector<double>& refits, int packings) {
  if (refits.size() < kEnoughReplicates) return std::nullopt;
  const double factor = factor_of_several(packings);
  const auto [low, high] = widened(value, quantile(refits, 0.025), quantile(refits, 0.975), factor, true);
  return LawInterval{low, high, kFromPackings};
}

}  // namespace softgrain
