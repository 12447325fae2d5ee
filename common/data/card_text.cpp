#include "common/data/card_text.h"
#include "common/data/soft_particle_schema.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "common/packing/grading_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>

namespace softgrain {

std::string real(double value) {
  if (std::isnan(value)) return "\"nan\"";
  if (std::isinf(value)) return value > 0.0 ? "\"inf\"" : "\"-inf\"";
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : replaced_utf8(text)) {  // a file name may be any bytes, TOML must be UTF-8
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string read_words(const SceneTable& root, std::initializer_list<const char*> definitions) {
  const SceneTable provenance = root.table_or_empty("provenance");
  const std::string table_id = provenance.text("table", "");
  for (const char* key : {"version", "commit", "compiler", "command", "seed"}) (void)provenance.text(key, "");
  (void)provenance.count("threads", 1, std::numeric_limits<int>::max(), 1);
  const SceneTable known = root.table_or_empty("definitions");
  for (const char* key : definitions) (void)known.text(key, "");
  return table_id;
}

std::optional<Extrapolation> read_beyond(const SceneTable& table) {
  if (!table.has("beyond")) return std::nullopt;
  return table.choice<Extrapolation>({"beyond", "what holds beyond the measured range of a law card or law table",
                                      "as the file says, else \"extrapolate\""});
}

namespace {

/// Inline table of lines "key = value".
std::string inline_table(const std::string& lines) {
  std::string text = "{";
  for (const char c : lines) text += c == '\n' ? std::string(", ") : std::string(1, c);
  return text.substr(0, text.size() - 2) + "}";
}

}  // namespace

std::string spec_text(const SoftParticleSpec& s) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const SoftParticleNumber& line : soft_particle_numbers()) {
    const std::string meaning = *line.meaning == '\0' ? "" : std::string("  # ") + line.meaning;
    if (is_known(s.*line.value)) fmt::format_to(out, "{} = {}{}\n", line.key, real(s.*line.value), meaning);
  }
  if (s.sizes)
    fmt::format_to(out, "sizes = {}  # radii of the grains as they were drawn\n", inline_table(s.sizes->text()));
  if (s.trials == 0) return text;
  fmt::format_to(out, "trials = {}  # random positions tried per grain\n", s.trials);
  fmt::format_to(out, "placement = {}  # blind trials, or the same law by looking only where there is room\n",
                 quoted(to_string(s.placement)));
  return text;
}

SoftParticleSpec read_spec_text(const SceneTable& table, bool may_be_unknown) {
  SoftParticleSpec s = unknown_soft_particle(0.0, 0.0);
  s.sizes = read_sizes(table, "sizes", {"exponent"});
  for (const SoftParticleNumber& line : soft_particle_numbers())
    if (line.always || !(may_be_unknown || (s.sizes && line.value == &SoftParticleSpec::exponent)) ||
        table.has(line.key))
      s.*line.value = table.number(line.key, line.unit, line.range);
  if (!may_be_unknown || table.has("trials"))
    s.trials = table.count("trials", 1, std::numeric_limits<std::int64_t>::max());
  s.placement = table.choice<Placement>("placement", Placement::trials);
  return s;
}

std::string estimate_text(const Estimate& e) {
  return fmt::format("{{ value = {}, standard_error = {}, low = {}, high = {} }}", real(e.value),
                     real(e.standard_error), real(e.low), real(e.high));
}

double read_real(const SceneTable& table, const std::string& key, const Range& range) {
  if (!table.is_text(key)) return table.number(key, Unit::none, range);
  const std::string word = table.choice(key, {"nan", "inf", "-inf"});
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  return word == "inf" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
}

namespace {

/// An interval holds its value: draws take the distances to its ends for errors. Both ends are 0 where a number was not
/// fitted.
void require_interval(const SceneTable& table, const Estimate& e) {
  constexpr double kRounding = 1e-9;
  if (e.low == 0.0 && e.high == 0.0) return;
  if (e.low > e.high) table.throw_error("low", "must not be above the high end");
  const double slack = kRounding * std::abs(e.value);
  const auto away = [&](const char* where, const char* unknown) {
    return fmt::format("must not be {} value = {}; an end that is not known is \"{}\"", where, real(e.value), unknown);
  };
  if (e.low > e.value + slack) table.throw_error("low", away("above", "-inf"));
  if (e.high < e.value - slack) table.throw_error("high", away("below", "inf"));
}

}  // namespace

Estimate read_estimate_text(const SceneTable& table, const Range& range) {
  Estimate e;
  e.value = table.number("value", Unit::none, range);
  e.standard_error = read_real(table, "standard_error", Range::not_negative());
  e.low = read_real(table, "low", Range::any());
  e.high = read_real(table, "high", Range::any());
  require_interval(table, e);
  return e;
}

}  // namespace softgrain
