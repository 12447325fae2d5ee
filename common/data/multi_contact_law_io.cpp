// A law table as text: the card, written and read.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "common/core/error.h"
#include "common/data/attributes.h"
#include "common/data/card_text.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

namespace {

using Out = std::back_insert_iterator<std::string>;

struct SlideName {
  const char* key;
  SlideLaw LawTableEntry::*law;
};
constexpr std::array<SlideName, 3> kSlides{{{"slide_plane", &LawTableEntry::slide_plane},
                                            {"slide_solid", &LawTableEntry::slide_solid},
                                            {"slide_soft", &LawTableEntry::slide_soft}}};

void write_head(Out out, const LawTable& table, const Provenance& provenance, const std::string& table_id) {
  fmt::format_to(out, "# Laws of soft particles with several contacts: fitted parameters and how well they predict.\n");
  fmt::format_to(out, "# The forces they stand for are tabulated in the .h5 file of the same name.\n");
  fmt::format_to(out, "schema = {}\n\n[provenance]\n", table.schema);
  fmt::format_to(out, "version = {}\ncommit = {}\n", quoted(provenance.version), quoted(provenance.commit));
  fmt::format_to(out, "compiler = {}\ncommand = {}\n", quoted(provenance.compiler), quoted(provenance.command));
  fmt::format_to(out, "seed = {}\nthreads = {}\n", quoted(fmt::format("{}", provenance.seed)), provenance.threads);
  if (!table_id.empty()) fmt::format_to(out, "table = {}  # the .h5 that belongs to this table\n", quoted(table_id));
  fmt::format_to(out, "\n[definitions]\n");
  fmt::format_to(
      out,
      "lost_volume = \"nu = w v^m, v the volume of the lens with the neighbour over that of the shell; a "
      "plane with the friction of the grains has w = m = 1; rows of kind plane are of planes without friction\"\n");
  fmt::format_to(out,
                 "equivalent_volume = \"S^2 = sum_cd M(n_c.n_d) nu_c nu_d, M = 1 for a contact with itself, else m0 - "
                 "m1 c - m2 c^2; the pair law has M = 0 else\"\n");
  fmt::format_to(out,
                 "pressure = \"p(S)/E = a (D^b - delta^b)/(3/4 (2 D - D^2)) for D >= delta, else 0; 3/4 D^2 (1 - D/3) "
                 "= S\"\n");
  fmt::format_to(
      out, "force = \"E Rs^2 dnu/d(h/Rs) p(S)/S sum_d M nu_d along the normal; a soft neighbour adds its own\"\n");
  fmt::format_to(out, "ratio = \"radius of the neighbour over Rs; soft neighbours: larger over smaller\"\n");
}

void write_partner(Out out, const PartnerRow& row) {
  fmt::format_to(out, "\n[[entry.law.partner]]\nkind = \"{}\"\nratio = {}\n", to_string(row.kind), real(row.ratio));
  fmt::format_to(out, "weight = {}\nexponent = {}\n", estimate_text(row.weight), estimate_text(row.exponent));
  fmt::format_to(out, "overlap_max = {}  # over the smaller radius\nerror = {}\n", real(row.overlap_max),
                 real(row.error));
}

void write_law(Out out, const MultiContactLaw& law) {
  fmt::format_to(out, "\n[[entry.law]]\nform = {}\nstatus = {}\nreason = {}\n", quoted(to_string(law.form)),
                 quoted(to_string(law.status)), quoted(law.reason));
  for (const MultiContactParameterName& p : kMultiContactParameters)
    fmt::format_to(out, "{} = {}\n", p.key, estimate_text(law.*p.estimate));
  fmt::format_to(out, "parameters = {}\n", law.parameters);
  fmt::format_to(out, "error_fitted = {}  # root mean square over that of the mean force, configurations of the fit\n",
                 real(law.error_fitted));
  fmt::format_to(out, "error_held_out = {}  # those left out of it\n", real(law.error_held_out));
  fmt::format_to(out, "error_cross = {}  # leave one out, configurations of planes that may be fitted\n",
                 real(law.error_cross));
  fmt::format_to(out, "criterion = {}  # corrected Akaike, smaller is better\n", real(law.criterion));
  fmt::format_to(out, "replicates_failed = {}  # refits without a minimum, which count nowhere\n",
                 law.replicates_failed);
  for (const PartnerRow& row : law.partners) write_partner(out, row);
  for (const ConfigurationError& e : law.errors) {
    fmt::format_to(out, "\n[[entry.law.error]]\nconfiguration = {}\nuse = {}\n", quoted(e.name),
                   quoted(to_string(e.use)));
    fmt::format_to(out, "error = {}\nend_ratio = {}\nnoise = {}\n", real(e.error), real(e.end_ratio), real(e.noise));
    if (e.packings > 0) fmt::format_to(out, "packings = {}\n", e.packings);
    if (!e.in_proportion) fmt::format_to(out, "in_proportion = false  # overlaps: some grow as others shrink\n");
    if (e.offset)
      fmt::format_to(out,
                     "off = {{ force = {}, onset = {} }}  # ln of a factor, and delta, that would put the law right\n",
                     real(e.offset->force), real(e.offset->onset));
  }
}

/// One number a line, without what is not known.
void write_prior(Out out, const LawPrior& prior) {
  fmt::format_to(out,
                 "\n[entry.prior]  # the isotropic law: own packings and a library together, as normal distributions\n"
                 "library = {}\ndistance = {}  # to the nearest measured material, 1: the range of one variable\n"
                 "own_factor = {}  # own errors are widened by it: the form is off by more than packings scatter\n"
                 "number = [\n",
                 quoted(prior.library), real(prior.distance), real(prior.own_factor));
  for (const PriorNumber& n : prior.numbers) {
    std::vector<std::string> parts;
    const auto write = [&]<class Member>(const char* name, const Member& member, const auto&...) {
      if constexpr (std::is_same_v<Member, std::string>)
        parts.push_back(fmt::format("{} = {}", name, quoted(member)));
      else if (std::isfinite(member))
        parts.push_back(fmt::format("{} = {:.7g}", name, member));
    };
    fields(write, n);
    fmt::format_to(out, "  {{ {} }},\n", fmt::join(parts, ", "));
  }
  fmt::format_to(out, "]\n");
}

void write_entry(Out out, const LawTableEntry& e) {
  fmt::format_to(out, "\n[[entry]]\nsolid_fraction = {}\nsolid_fraction_error = {}\npackings = {}\n",
                 real(e.solid_fraction), real(e.solid_fraction_error), e.packings);
  if (e.grains > 0.0)
    fmt::format_to(out, "grains = {}  # that one soft particle represents, those inside inner ones included\n",
                   real(e.grains));
  if (e.main) fmt::format_to(out, "main = true  # the packing that the table was made for\n");
  fmt::format_to(out, "relaxation = {}\nbest = {}  # taken where no form is named\n", quoted(e.relaxation),
                 quoted(to_string(e.best)));
  if (e.source != TableSource::measured) fmt::format_to(out, "source = \"{}\"\n", to_string(e.source));
  fmt::format_to(out, "volume_max = {}  # validity: equivalent volume S\n", real(e.volume_max));
  fmt::format_to(out,
                 "beyond = \"{}\"  # above volume_max: \"error\", \"clamp\" or \"extrapolate\"; counted either way\n",
                 to_string(e.beyond));
  fmt::format_to(out, "overlap_max = {}  # and overlap with a plane, h/Rs\n", real(e.overlap_max));
  fmt::format_to(out, "grain_overlap_max = {}  # of grains over the smaller radius in that range\n",
                 real(e.grain_overlap_max));
  fmt::format_to(out, "unloading = {}  # s of the unloading branch of planes\n", estimate_text(e.unloading));
  fmt::format_to(out, "unloading_measured = {}\n", e.unloading_measured);
  for (const SlideName& slide : kSlides) {
    const SlideLaw& law = e.*slide.law;
    fmt::format_to(out,
                   "\n[entry.{}]  # kt/kn (slow slide of pi Rs/180) and mu_soft\nkt_ratio = {}\nfriction = "
                   "{}\nmeasured = {}\n",
                   slide.key, estimate_text(law.kt_ratio), estimate_text(law.friction), law.measured);
    if (law.rolls)
      fmt::format_to(out,
                     "rolling = {}  # moment over E R^2 R12 per angle\nrolling_friction = {}  # largest over F R\n",
                     estimate_text(law.rolling), estimate_text(law.rolling_friction));
    if (law.has_unloading)
      fmt::format_to(out, "unloading = {}  # s of the unloading branch\n", estimate_text(law.unloading));
  }
  fmt::format_to(out, "\n[entry.measurement]\n{}", spec_text(e.spec));
  if (e.prior) write_prior(out, *e.prior);
  for (const MultiContactLaw& law : e.laws) write_law(out, law);
}

constexpr double kLargestOverlap = 2.0;  ///< beyond, two bodies have passed each other
constexpr double kLargestShare = 100.0;  ///< largest friction, kt/kn and stiffness ratio of unloading

/// Numbers of a law of planes; the coupling is of the order of one, and fits end within 3.
Range range_of(const MultiContactParameterName& p) {
  if (p.estimate == &MultiContactLaw::a) return Range::positive();
  if (p.estimate == &MultiContactLaw::b) return {0.0, kLargestExponent, true, false};
  if (p.estimate == &MultiContactLaw::delta) return {0.0, 1.0, false, true};
  return Range::closed(-10.0, 10.0);
}

PartnerRow read_partner(const SceneTable& t) {
  PartnerRow row;
  row.kind = t.choice<PartnerKind>("kind");
  row.ratio = t.number("ratio", Unit::none, Range::not_negative());
  if ((row.kind == PartnerKind::plane) != (row.ratio == 0.0))
    t.add_error("ratio", "0 is that of planes, and theirs alone");
  row.weight = read_estimate_text(t.table("weight"), Range{0.0, 1e3, true, false});
  row.exponent = read_estimate_text(t.table("exponent"), Range{0.0, kLargestExponent, true, false});
  row.overlap_max = t.number("overlap_max", Unit::none, Range::closed(0.0, kLargestOverlap));
  row.error = t.number("error", Unit::none, Range::not_negative());
  return row;
}

std::optional<FormOffset> read_offset(const SceneTable& t) {
  if (!t.has("off")) return {};
  const SceneTable off = t.table("off");
  return FormOffset{off.number("force", Unit::none, Range::closed(-10.0, 10.0)),
                    off.number("onset", Unit::none, Range::closed(-1.0, 1.0))};
}

MultiContactLaw read_law(const SceneTable& t) {
  MultiContactLaw law;
  law.form = t.choice<LawForm>("form");
  law.status = t.choice(
      "status", {LawStatus::good, LawStatus::no_threshold_crossing, LawStatus::underdetermined, LawStatus::inaccurate});
  law.reason = t.text("reason", "");
  for (const MultiContactParameterName& p : kMultiContactParameters) {
    law.*p.estimate = read_estimate_text(t.table(p.key), range_of(p));
  }
  law.parameters = static_cast<int>(t.count("parameters", 1, 1000));
  law.error_fitted = t.number("error_fitted", Unit::none, Range::not_negative());
  law.error_held_out = read_real(t, "error_held_out", Range::not_negative());
  law.error_cross = read_real(t, "error_cross", Range::not_negative());
  law.criterion = read_real(t, "criterion", Range::any());
  law.replicates_failed = static_cast<int>(t.count("replicates_failed", 0, 1000000000, 0));
  for (const SceneTable& p : t.tables("partner")) law.partners.push_back(read_partner(p));
  for (const SceneTable& e : t.tables("error"))
    law.errors.push_back({e.text("configuration"), e.choice<MultiContactUse>("use"),
                          e.number("error", Unit::none, Range::not_negative()), e.number("end_ratio", Unit::none),
                          e.number("noise", Unit::none, Range::not_negative()), e.count("packings", 0, 1000000, 0),
                          read_offset(e), e.flag("in_proportion", true)});
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid, PartnerKind::soft}) {
    const auto rows = law.rows(kind);
    for (std::size_t k = 1; k < rows.size(); ++k) {
      if (!(rows[k - 1].ratio < rows[k].ratio)) t.throw_error("partner", "ratios of one kind must ascend");
      if (rows[k - 1].exponent.value != rows[k].exponent.value)
        t.throw_error("partner", "all rows of one kind have the same exponent");
    }
    if (kind == PartnerKind::soft && !rows.empty() && rows.front().ratio < 1.0)
      t.throw_error("partner", "soft neighbours: the ratio is larger over smaller, at least 1");
  }
  return law;
}

LawPrior read_prior(const SceneTable& t) {
  LawPrior out;
  out.library = t.text("library");
  out.distance = t.number("distance", Unit::none, Range::not_negative());
  out.own_factor = t.number("own_factor", Unit::none, Range{1.0, kInfinity, false, true});
  for (const SceneTable& n : t.tables("number")) {
    PriorNumber one;
    const auto read = [&]<class Member>(const char* name, Member& member, const auto&... options) {
      const Limits* const asked = attributes::limits_among(options...);
      const Limits limits = asked != nullptr ? *asked : Limits::anything();
      if constexpr (std::is_same_v<Member, std::string>)
        member = n.text(name);
      else if (n.has(name) || !std::isnan(member))  // what may be unknown is NaN
        member = n.number(name, Unit::none, Range::closed(limits.low, limits.high));
    };
    fields(read, one);
    out.numbers.push_back(std::move(one));
  }
  return out;
}

LawTableEntry read_entry(const SceneTable& t) {
  LawTableEntry e;
  e.solid_fraction = t.number("solid_fraction", Unit::none, Range{0.0, 1.0, true, false});
  e.solid_fraction_error = t.number("solid_fraction_error", Unit::none, Range::not_negative());
  e.packings = static_cast<int>(t.count("packings", 1, 1000000000));
  if (t.has("grains")) e.grains = t.number("grains", Unit::none, Range::above(0.0));
  e.main = t.flag("main", false);
  e.relaxation = t.text("relaxation");
  e.best = t.choice<LawForm>("best");
  e.volume_max = t.number("volume_max", Unit::none, Range::not_negative());
  e.beyond = read_beyond(t).value_or(Extrapolation::extrapolate);
  e.overlap_max = t.number("overlap_max", Unit::none, Range::closed(0.0, kLargestOverlap));
  e.grain_overlap_max = t.number("grain_overlap_max", Unit::none, Range::not_negative());
  for (const SlideName& slide : kSlides) {
    const SceneTable of_kind = t.table(slide.key);
    (e.*slide.law).kt_ratio = read_estimate_text(of_kind.table("kt_ratio"), Range::closed(0.0, kLargestShare));
    (e.*slide.law).friction = read_estimate_text(of_kind.table("friction"), Range::closed(0.0, kLargestShare));
    // Where it is not said: what stands in for a measurement has no error.
    (e.*slide.law).measured = of_kind.flag("measured", std::isfinite((e.*slide.law).friction.standard_error));
    if (of_kind.has("unloading")) {
      (e.*slide.law).unloading = read_estimate_text(of_kind.table("unloading"), Range::closed(1.0, kLargestShare));
      (e.*slide.law).has_unloading = true;
    }
    if (!of_kind.has("rolling") && !of_kind.has("rolling_friction")) continue;
    (e.*slide.law).rolling = read_estimate_text(of_kind.table("rolling"), Range::closed(0.0, kLargestShare));
    (e.*slide.law).rolling_friction =
        read_estimate_text(of_kind.table("rolling_friction"), Range::closed(0.0, kLargestShare));
    (e.*slide.law).rolls = true;
  }
  e.unloading = read_estimate_text(t.table("unloading"), Range::closed(1.0, kLargestShare));
  e.unloading_measured = t.flag("unloading_measured", std::isfinite(e.unloading.standard_error));
  e.source = t.choice<TableSource>("source", TableSource::measured);
  e.spec = read_spec_text(t.table("measurement"), e.source == TableSource::press_test);
  if (t.has("prior")) e.prior = read_prior(t.table("prior"));
  for (const SceneTable& law : t.tables("law")) e.laws.push_back(read_law(law));
  if (e.find(e.best) == nullptr) t.throw_error("best", "is no form that the entry has");
  return e;
}

}  // namespace

std::string law_table_text(const LawTable& table, const Provenance& provenance, const std::string& table_id) {
  std::string text;
  const Out out(text);
  write_head(out, table, provenance, table_id);
  for (const LawTableEntry& e : table.entries) write_entry(out, e);
  return text;
}

LawTable load_law_table(const std::string& toml_path) { return load_law_table(Scene::load(toml_path)); }

LawTable load_law_table(const Scene& file) {
  const SceneTable root = file.root();
  LawTable table;
  table.schema = static_cast<int>(root.count("schema", 1, 1));
  table.table_id = read_words(root, {"lost_volume", "equivalent_volume", "pressure", "force", "ratio"});
  for (const SceneTable& e : root.tables("entry")) {
    const LawTableEntry entry = read_entry(e);
    if (!table.entries.empty() && !(table.entries.back().solid_fraction < entry.solid_fraction))
      e.throw_error("solid_fraction", "entries must ascend");
    if (entry.main && std::any_of(table.entries.begin(), table.entries.end(), [](const auto& x) { return x.main; }))
      e.throw_error("main", "another entry is the main one already");
    table.entries.push_back(entry);
  }
  if (table.entries.empty()) root.throw_error("entry", "a law table needs at least one [[entry]]");
  root.finish();
  return table;
}

}  // namespace softgrain
