#include "common/contact/make_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "common/data/law_card_format.h"
#include "common/data/multi_contact_replicates.h"
#include "common/data/soft_particle_schema.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr const char* kFormat = "multi-contact law table";

/// Force of one contact over E Rs^2 on a grid of overlaps, one row per neighbour.
void write_grid(const h5::Group& group, const MultiContactLaw& law, double overlap_max) {
  constexpr std::size_t kPoints = 51;
  const MultiContactModel model = multi_contact_model(law);
  std::vector<MultiContactPartner> partners{{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}}};
  std::vector<double> reach{overlap_max};
  for (const PartnerRow& row : law.partners) {
    const bool smooth = row.kind == PartnerKind::plane;  // the row of planes is that of planes without friction
    partners.push_back({row.kind, row.ratio, {{1.0, 0.0, 0.0}}, smooth});
    reach.push_back(row.overlap_max * (smooth ? 1.0 : std::min(1.0, row.ratio)));
  }
  std::vector<double> overlap;
  std::vector<double> force;
  std::vector<double> ratio;
  std::vector<std::int64_t> kind;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    ratio.push_back(partners[k].ratio);
    kind.push_back(static_cast<std::int64_t>(partners[k].kind));
    for (std::size_t n = 0; n < kPoints; ++n) {
      overlap.push_back(reach[k] * static_cast<double>(n) / static_cast<double>(kPoints - 1));
      force.push_back(multi_contact_forces(model, {partners[k]}, {overlap.back()}).front());
    }
  }
  group.attribute(
      "rows",
      "neighbours: kind 0 plane (a second such row: without friction), 1 solid, 2 soft; ratio of radii, 0 for planes");
  group.attribute("units", "overlap h/Rs, force F/(E Rs^2) of one contact alone");
  group.write("kind", kind);
  group.write("ratio", ratio);
  group.write("overlap", overlap, {partners.size(), kPoints});
  group.write("force", force, {partners.size(), kPoints});
}

/// One row per parameter of planes.
void write_parameters(const h5::Group& group, const MultiContactLaw& law) {
  std::vector<double> all;
  std::string names;
  for (const MultiContactParameterName& p : kMultiContactParameters) {
    const Estimate& v = law.*p.estimate;
    all.insert(all.end(), {v.value, v.standard_error, v.low, v.high});
    names += (names.empty() ? "" : ", ") + std::string(p.key);
  }
  group.write("parameters", all, {std::size(kMultiContactParameters), 4});
  group.attribute_of("parameters", "rows", names);
  group.attribute_of("parameters", "columns", "value, standard error, ends of the 95 % interval");
}

/// What the fit gave for packings drawn with replacement; "numbers" says which law they belong to.
void write_replicates(const h5::Group& group, const MultiContactLaw& law) {
  if (law.replicates.empty()) return;
  const std::vector<double> numbers = multi_contact_numbers(law);
  std::vector<double> all;
  for (const std::vector<double>& row : law.replicates) all.insert(all.end(), row.begin(), row.end());
  group.write("numbers", numbers);
  group.attribute_of("numbers", "columns", "a, b, delta, m0, m1, m2, then weight and exponent of every neighbour");
  group.write("replicates", all, {law.replicates.size(), numbers.size()});
}

void write_table_file(const LawTable& table, const std::string& path, const Provenance& provenance,
                      const std::string& table_id) {
  h5::AtomicFile file(path);
  write_format(file.root(), kFormat);
  file.root().attribute(kTableId, table_id);
  write_provenance(file.root(), provenance);
  for (std::size_t k = 0; k < table.entries.size(); ++k) {
    const LawTableEntry& e = table.entries[k];
    const h5::Group group = file.root().create(fmt::format("entry_{}", k));
    group.attribute("solid_fraction", e.solid_fraction);
    group.attribute("best", to_string(e.best));
    write_spec(group, e.spec);
    for (const MultiContactLaw& law : e.laws) {
      const h5::Group of_law = group.create(to_string(law.form));
      write_parameters(of_law, law);
      write_replicates(of_law, law);
      write_grid(of_law, law, e.overlap_max);
    }
  }
  file.commit();
}

}  // namespace

void save_law_table(const LawTable& table, const std::string& toml_path, const Provenance& provenance) {
  const std::string id = short_hash(law_table_text(table, provenance, ""));
  write_table_file(table, table_path(toml_path), provenance, id);
  write_text_atomic(toml_path, law_table_text(table, provenance, id));
}

}  // namespace softgrain
