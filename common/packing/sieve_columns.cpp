#include "common/packing/sieve_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"
#include "common/packing/sieve_size.h"

namespace softgrain {

namespace {

bool has_any(const std::string& words, std::initializer_list<const char*> parts) {
  return std::ranges::any_of(parts, [&](const char* part) { return words.find(part) != std::string::npos; });
}

bool is_any(const std::string& word, std::initializer_list<const char*> others) {
  return std::ranges::any_of(others, [&](const char* other) { return word == other; });
}

/// The parts of a title, and whether each stands in brackets.
struct TitleWord {
  std::string text;
  bool bracket = false;
};

std::vector<TitleWord> words_of_title(const std::string& title) {
  std::vector<TitleWord> words(1);
  bool bracket = false;
  for (const char c : csv::folded(title)) {
    const bool opens = c == '[' || c == '(';
    const bool closes = c == ']' || c == ')';
    if (opens || closes) bracket = opens;
    if (opens || closes || std::string(" ,;:/_=|\t").find(c) != std::string::npos)
      words.push_back({"", bracket});
    else
      words.back().text += c;
  }
  std::erase_if(words, [](const TitleWord& w) { return w.text.empty(); });
  return words;
}

bool is_percent_word(const std::string& word) {
  return word.find('%') != std::string::npos ||
         is_any(word, {"percent", "pct", "prozent", "pourcent", "pourcentage", "percentage"});
}

bool is_mass_unit(std::string word) {
  while (!word.empty() && word.back() == '.') word.pop_back();
  return is_any(word, {"g", "kg", "mg", "t", "lb", "lbs", "oz", "gram", "grams", "gramm", "grammes", "gr", "ug"});
}

/// Whether what a word says can be a unit here: "in" is one in brackets or as the last word.
bool is_length_word(const std::vector<TitleWord>& words, std::size_t k) {
  const std::string unit = sieve_unit(words[k].text);
  if (unit.empty()) return false;
  const bool word_of_language = is_any(words[k].text, {"in", "m", "mesh", "astm"});
  return !word_of_language || words[k].bracket || k + 1 == words.size();
}

/// Finds the unit of a title and leaves the words that are none.
SieveTitle take_unit_of_title(std::vector<TitleWord>& words) {
  SieveTitle title;
  for (const bool bracket : {true, false})
    for (std::size_t k = 0; k < words.size(); ++k) {
      if (words[k].bracket != bracket) continue;
      const bool length = is_length_word(words, k);
      if (is_percent_word(words[k].text)) {
        title.measure = SieveMeasure::percent;
        std::erase_if(words[k].text, [](char c) { return std::isalpha(static_cast<unsigned char>(c)) == 0; });
        if (is_percent_word(words[k].text)) words[k].text.clear();
        return title;
      }
      if (!length && !is_mass_unit(words[k].text)) continue;
      title.measure = length ? SieveMeasure::length : SieveMeasure::mass;
      title.unit = length ? sieve_unit(words[k].text) : words[k].text;
      if (!is_any(words[k].text, {"mesh", "astm", "phi"})) words[k].text.clear();
      return title;
    }
  return title;
}

/// " sieve size " of the words, for a search of whole ones.
std::string spaced(const std::vector<TitleWord>& words) {
  std::string out = " ";
  for (const TitleWord& word : words) {
    std::string text = word.text;
    for (char& c : text)
      if (c == '.' || c == '-' || c == '\'') c = ' ';
    if (!trimmed(text).empty()) out += trimmed(text) + " ";
  }
  return out;
}

bool is_of_no_part(const std::string& words) {
  const bool of_sieve = has_any(words, {"sieve mass", "mass of sieve", "sieve weight", "weight of sieve", "siebmasse"});
  if (of_sieve && !has_any(words, {"retain", "retenu", "rueckst", "ruckst", "refus"})) return true;
  return has_any(words, {" empty ", " tare ",  " leer",  "brutto",     " gross ",  "with sample",    "mit probe",
                         "+",       " limit",  " grenz", " soll",      " spec ",   " specification", " specified",
                         " loss",   "verlust", " error", " deviation", "einwaage", " module "});
}

SieveColumn value_column(const std::string& words, SieveMeasure measure) {
  if (has_any(words, {"passing", "passed", "passant", "finer", "undersize", "durchgang", "durchgaeng", "tamisat",
                      " tamise ", " tamises ", "<", "smaller", "kleiner", "inferieur", " q3 "}))
    return SieveColumn::passing;
  const bool retained = has_any(words, {"retain", "retenu", "oversize", "coarser", "rueckst", "ruckst", "refus"});
  const bool mass = has_any(words, {"mass", "weight", " wt ", "gewicht", "poids", "auswaage"});
  const bool all =
      has_any(words, {"cum", "kum", "summe", "gesamt", "accum", "sum of", " total "}) && !has_any(words, {" of total"});
  const bool each =
      has_any(words, {"each", "indiv", "partial", "partiel", "einzel", "je sieb", "auf dem sieb", "differential",
                      "fraktion", " fraction ", "klasse", "elementaire", "anteil", "on sieve"});
  if (all && (retained || has_any(words, {">"}))) return SieveColumn::cumulative;
  if (all && (mass || measure != SieveMeasure::length)) return SieveColumn::running;
  if (each && (retained || mass || measure == SieveMeasure::percent)) return SieveColumn::retained;
  return retained || mass ? SieveColumn::unclear : SieveColumn::other;
}

SieveColumn size_column(const std::string& words, const SieveTitle& title) {
  const bool length = title.measure == SieveMeasure::length;
  const bool sizes =
      has_any(words, {"opening",   "aperture", "sieve",  "screen",   "sieb",        "maschen",    "lochweite",
                      "ouverture", "tamis",    "maille", "diamet",   "durchmesser", "korngr",     " size",
                      " d ",       "mesh",     " phi ",  "fraktion", "klasse",      " fraction ", " class"});
  if (!sizes && !(length && trimmed(words).empty())) return SieveColumn::other;
  const bool numbered = has_any(words, {" no ", " nr ", " number ", " nummer ", " numero ", " name ", " designation ",
                                        " bezeichnung ", " astm ", " mesh ", " n "});
  const bool by_number = is_any(title.unit, {"mesh", "astm"});
  return (numbered && !length) || by_number ? SieveColumn::name : SieveColumn::opening;
}

constexpr const char* kTheOpening = "the opening";

std::string head_of_sieves(const CsvFile& csv) { return csv.where(csv.header_line()) + ": "; }

/// One column of several that say the same; in `better` units rather than in others.
template <class Better>
std::size_t one_of(const CsvFile& csv, const std::vector<std::size_t>& found, const char* what, bool key,
                   Better better) {
  std::vector<std::size_t> best;
  std::ranges::copy_if(found, std::back_inserter(best), better);
  if (best.empty()) best = found;
  if (best.size() == 1) return best.front();
  const std::string& first = csv.columns()[best[0]].title;
  const std::string& second = csv.columns()[best[1]].title;
  throw InputError(fmt::format("{}columns \"{}\" and \"{}\" both say {}: {}", head_of_sieves(csv), first, second, what,
                               key ? fmt::format("remove one, or give column = \"{}\" in the table of sizes of the "
                                                 "scene",
                                                 first)
                                   : "remove one"));
}

class ColumnChoice {
 public:
  ColumnChoice(const CsvFile& csv, const std::string& asked) : csv_(csv) {
    for (const CsvColumn& c : csv.columns()) out_.titles.push_back(sieve_title(c));
    out_.size = size();
    if (asked.empty())
      choose_value();
    else
      take_asked(asked);
    refuse_other_numbers();
  }
  [[nodiscard]] SieveChoice result() const { return out_; }

 private:
  [[nodiscard]] std::vector<std::size_t> columns(std::initializer_list<SieveColumn> meanings) const {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < out_.titles.size(); ++k)
      if (std::ranges::find(meanings, out_.titles[k].column) != meanings.end()) found.push_back(k);
    return found;
  }

  [[nodiscard]] std::size_t size() const {
    const auto has_unit = [&](std::size_t k) { return !out_.titles[k].unit.empty(); };
    const auto metric = [&](std::size_t k) { return has_unit(k) && out_.titles[k].unit.ends_with('m'); };
    const std::vector<std::size_t> openings = columns({SieveColumn::opening});
    if (!openings.empty()) {
      const bool any = std::ranges::any_of(openings, metric);
      return one_of(csv_, openings, kTheOpening, false, [&](std::size_t k) { return any ? metric(k) : has_unit(k); });
    }
    const std::vector<std::size_t> names = columns({SieveColumn::name});
    if (names.empty()) throw InputError(head_of_sieves(csv_) + "needs a column \"opening [mm]\"");
    return one_of(csv_, names, kTheOpening, false, [](std::size_t) { return true; });
  }

  [[nodiscard]] bool is_of(std::size_t k, std::initializer_list<SieveMeasure> measures) const {
    return std::ranges::find(measures, out_.titles[k].measure) != measures.end();
  }

  bool take(std::initializer_list<SieveColumn> meanings, const char* what) {
    const std::vector<std::size_t> found = columns(meanings);
    if (found.empty()) return false;
    const bool each = meanings.size() > 1;
    out_.value = one_of(csv_, found, what, true, [&](std::size_t k) {
      if (!each) return is_of(k, {SieveMeasure::percent, SieveMeasure::share});
      return is_of(k, {SieveMeasure::mass}) && !std::ranges::any_of(found, [&](std::size_t other) {
               return is_of(other, {SieveMeasure::mass}) && named_retained(other) && !named_retained(k);
             });
    });
    out_.meaning = out_.titles[out_.value].column;
    return true;
  }

  [[nodiscard]] bool named_retained(std::size_t k) const {
    return has_any(csv::folded(csv_.columns()[k].title), {"retain", "rueckst", "ruckst", "refus"});
  }

  void choose_value() {
    if (take({SieveColumn::passing}, "what passes")) return;
    if (take({SieveColumn::cumulative}, "what is retained in all")) return;
    if (take({SieveColumn::retained, SieveColumn::unclear}, "what is retained")) return;
    if (take({SieveColumn::running}, "what adds up")) return;
    throw InputError(head_of_sieves(csv_) +
                     "needs a column \"passing [%]\", of mass; also retained, cumulative retained");
  }

  void take_asked(const std::string& asked) {
    const std::size_t as = asked.rfind(" as ");
    const auto as_meaning = as == std::string::npos ? std::nullopt : parse_enum<SieveColumn>(asked.substr(as + 4));
    if (const auto meaning = parse_enum<SieveColumn>(asked)) {
      const std::vector<std::size_t> found = columns_for(*meaning);
      if (!found.empty()) {
        out_.value = one_of(csv_, found, "it", true, [&](std::size_t k) { return out_.titles[k].column == *meaning; });
        out_.meaning = *meaning;
        return;
      }
    }
    const std::string title = csv::folded(trimmed(as_meaning ? asked.substr(0, as) : asked));
    for (std::size_t k = 0; k < csv_.columns().size(); ++k) {
      if (csv::folded(csv_.columns()[k].title) != title || k == out_.size) continue;
      out_.value = k;
      out_.meaning = as_meaning.value_or(out_.titles[k].column);
      if (out_.meaning == SieveColumn::other || out_.meaning == SieveColumn::ignored)
        throw InputError(
            fmt::format("{}column = \"{}\": say what it is: \"{} as passing\", \"... as retained\" or "
                        "\"... as cumulative retained\"",
                        head_of_sieves(csv_), asked, csv_.columns()[k].title));
      return;
    }
    throw InputError(fmt::format("{}column = \"{}\": no such column; allowed: {}, or one of the titles: {}",
                                 head_of_sieves(csv_), asked, join_text(all_enum_names<SieveColumn>()),
                                 join_text(csv_.columns(), ", ", [](const CsvColumn& c) { return c.title; })));
  }

  [[nodiscard]] std::vector<std::size_t> columns_for(SieveColumn meaning) const {
    if (meaning == SieveColumn::passing) return columns({meaning, SieveColumn::running});
    if (meaning == SieveColumn::cumulative) return columns({meaning, SieveColumn::running, SieveColumn::unclear});
    return columns({meaning, SieveColumn::unclear});
  }

  /// Columns of words are notes; numbers that nothing is known of may count.
  void refuse_other_numbers() const {
    CsvNames known{"opening", "passing"};
    for (std::size_t k = 0; k < out_.titles.size(); ++k) {
      const bool numbers = std::ranges::any_of(csv_.rows(), [&](const CsvRow& row) {
        return k < row.cells.size() && row.cells[k].find_first_of("0123456789") != std::string::npos;
      });
      if (k == out_.value || out_.titles[k].column != SieveColumn::other || !numbers)
        known.push_back(csv_.columns()[k].name);
    }
    csv_.require_known_columns(known, "a sieve curve");
  }

  const CsvFile& csv_;
  SieveChoice out_;
};

bool is_size(SieveColumn what) { return what == SieveColumn::opening || what == SieveColumn::name; }

}  // namespace

SieveTitle sieve_title(const CsvColumn& column) {
  std::vector<TitleWord> words = words_of_title(column.title);
  SieveTitle title = take_unit_of_title(words);
  const std::string text = spaced(words);
  if (is_of_no_part(text)) {
    title.column = SieveColumn::ignored;
    return title;
  }
  title.column = value_column(text, title.measure);
  if (title.column == SieveColumn::other || title.column == SieveColumn::running)
    if (const SieveColumn size = size_column(text, title); size != SieveColumn::other) title.column = size;
  if (title.measure == SieveMeasure::unknown && is_any(column.unit, {"1", "-"})) title.measure = SieveMeasure::share;
  const bool no_unit =
      column.unit.empty() || column.unit.size() > 4 || has_any(csv::folded(column.unit), {"cum", "kum"});
  if (!is_size(title.column) && title.measure == SieveMeasure::unknown && !no_unit) {
    title.measure = SieveMeasure::length;  // or any other quantity
    title.unit = column.unit;
  }
  if (is_size(title.column) && title.measure != SieveMeasure::length) title.unit.clear();
  return title;
}

bool are_sieve_columns(const std::vector<CsvColumn>& columns) {
  bool sizes = false;
  bool values = false;
  for (const CsvColumn& c : columns) {
    const SieveColumn what = sieve_title(c).column;
    const std::string title = csv::folded(c.title);
    if (has_any(title, {":"})) continue;  // "Total mass: 500 g" stands above a table
    sizes = sizes || (is_size(what) && !has_any(title, {"analys", "report", "bericht", "siebung", "sample", "probe"}));
    values = values || (!is_size(what) && what != SieveColumn::other && what != SieveColumn::ignored);
  }
  return sizes && values;
}

SieveChoice choose_sieve_columns(const CsvFile& csv, const std::string& asked) {
  return ColumnChoice(csv, asked).result();
}

}  // namespace softgrain
