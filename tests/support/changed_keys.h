// All keys that the reader of a scene asks for, and other values for each that the reader would take.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/io/key_record.h"
#include "common/io/scene.h"

namespace softgrain::test {

/// Keys by path.
using Keys = std::map<std::string, AskedKey>;

namespace changed_keys {

inline std::string text_of(double value) {
  const std::string text = fmt::format("{:.17g}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

inline bool allowed(const Range& r, double x) {
  return (r.low_open ? x > r.low : x >= r.low) && (r.high_open ? x < r.high : x <= r.high);
}

inline std::string list_of(const std::vector<double>& values) {
  std::string text;
  for (const double x : values) text += (text.empty() ? "" : ", ") + text_of(x);
  return "[" + text + "]";
}

inline std::vector<double> other_numbers(double now, const Range& range) {
  std::vector<double> out;
  const auto add = [&](double x) {
    if (std::isfinite(x) && x != now && allowed(range, x)) out.push_back(x);
  };
  if (std::isfinite(now) && now != 0.0)
    for (const double by : {1.1, 0.9, 1.02, 0.5, 2.0, 0.1, 10.0}) add(by * now);
  for (const double x : {0.01, 0.1, 0.5, 1.5, 3.0, 0.3, 0.02, 1e-3, 20.0, 1e3, 1e5}) add(x);
  if (std::isfinite(range.low) && std::isfinite(range.high)) add(0.5 * (range.low + range.high));
  return out;
}

/// What has no form yet shows it when something stands there.
inline std::vector<std::string> guesses() { return {"true", "0.5", "2", "\"x\"", "[0.5]", "[\"x\"]", "{}"}; }

inline std::vector<std::string> other_lists(const AskedKey& k) {
  std::vector<std::string> out;
  const auto scaled = [&](double by) {
    std::vector<double> v = k.numbers;
    for (double& x : v) x *= by;
    if (std::all_of(v.begin(), v.end(), [&](double x) { return allowed(k.range, x); }) && v != k.numbers)
      out.push_back(list_of(v));
  };
  for (const double by : {0.98, 1.02, 0.5, -1.0}) scaled(by);
  if (!k.numbers.empty()) {
    std::vector<double> aside = k.numbers;
    aside.front() += 1e-3;
    out.push_back(list_of(aside));
  }
  if (k.numbers.size() > 1) out.push_back(list_of({k.numbers.begin(), k.numbers.end() - 1}));
  if (k.form == KeyForm::vector) {
    for (const double x : {0.01, 0.5, 2.0}) out.push_back(list_of({x, 1.5 * x, 2.0 * x}));
    std::vector<double> v = k.numbers;
    if (v.size() == 3 && (v[2] += 0.01) != 0.0) out.push_back(list_of(v));
  }
  if (k.form == KeyForm::numbers)
    for (const auto& some : {std::vector<double>{0.1, 0.2}, {0.2, 0.4, 0.6}, {0.3}, {2.0, 3.0}, {-0.5, 0.5}})
      if (some != k.numbers && std::all_of(some.begin(), some.end(), [&](double x) { return allowed(k.range, x); }))
        out.push_back(list_of(some));
  return out;
}

inline std::string quoted_list(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& w : words) text += (text.empty() ? "\"" : ", \"") + w + "\"";
  return "[" + text + "]";
}

/// `texts`: all that stand in the scene, as one may name another.
inline std::vector<std::string> other_words(const AskedKey& k, const std::set<std::string>& texts) {
  std::vector<std::string> out;
  if (k.form == KeyForm::texts) {
    if (k.texts.size() > 1) {
      out.push_back(quoted_list({k.texts.begin(), k.texts.end() - 1}));
      const std::vector<std::string> reversed{k.texts.rbegin(), k.texts.rend()};
      if (reversed != k.texts) out.push_back(quoted_list(reversed));
    }
    for (const std::string& w : texts)
      if (k.texts != std::vector{w}) out.push_back(quoted_list({w}));
    return out;
  }
  const std::string now = k.texts.empty() ? "" : k.texts.front();
  out.push_back("\"" + now + "x\"");
  std::set<std::string> others = texts;
  others.insert({"none", "other-law.toml", "other-bodies.csv"});
  for (const std::string& w : others)
    if (w != now) out.push_back("\"" + w + "\"");
  return out;
}

}  // namespace changed_keys

/// Values other than that of the reader, as TOML; of a choice all other words, of other forms as many as may be needed
/// until one goes with the rest of the scene.
inline std::vector<std::string> other_values(const AskedKey& k, const std::set<std::string>& texts) {
  using namespace changed_keys;
  std::vector<std::string> out;
  switch (k.form) {
    case KeyForm::any:
      return guesses();
    case KeyForm::number:
      for (const double x : other_numbers(k.numbers.at(0), k.range)) out.push_back(text_of(x));
      return out;
    case KeyForm::count:
      for (const double x :
           {k.numbers.at(0) + 1, 1.0, k.numbers.at(0) - 1, 2 * k.numbers.at(0), k.numbers.at(0) + 10, 60.0})
        if (allowed(k.range, x) && x != k.numbers.at(0)) out.push_back(fmt::format("{:.0f}", x));
      return out;
    case KeyForm::flag:
      if (k.numbers.empty()) return {"true", "false"};
      return {k.numbers.at(0) != 0.0 ? "false" : "true"};
    case KeyForm::choice:
      for (const std::string& w : k.words)
        if (k.texts.empty() || w != k.texts.front()) out.push_back("\"" + w + "\"");
      return out;
    case KeyForm::text:
    case KeyForm::texts:
      return other_words(k, texts);
    case KeyForm::vector:
    case KeyForm::numbers:
      return other_lists(k);
    case KeyForm::flags:
      for (std::size_t at = 0; at < k.numbers.size(); ++at) {
        std::string text;
        for (std::size_t b = 0; b < k.numbers.size(); ++b)
          text += std::string(b == 0 ? "" : ", ") + ((k.numbers[b] != 0.0) != (at == b) ? "true" : "false");
        out.push_back("[" + text + "]");
      }
      return out;
    case KeyForm::table:
    case KeyForm::tables:
      return {};
  }
  return out;
}

/// A scene with its changes, as --set takes them.
struct KeyedText {
  std::string text;
  std::string path;
  std::vector<std::string> changes{};

  [[nodiscard]] Scene scene() const { return Scene::parse(text, path, changes); }
  [[nodiscard]] KeyedText with(const std::string& change) const {
    KeyedText out = *this;
    out.changes.push_back(change);
    return out;
  }
};

/// Of long lists of tables the first and the last stand for all.
inline bool stands_for_all(const std::string& path, const Keys& keys) {
  std::string before;
  std::size_t from = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', from)) {
    const std::string part = path.substr(from, dot - from);
    const bool number = !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    if (number && std::stoul(part) > 2 && std::any_of(keys.begin(), keys.end(), [&](const auto& k) {
          return k.first.starts_with(before + "." + std::to_string(std::stoul(part) + 1) + ".");
        }))
      return false;
    before = path.substr(0, dot);
    from = dot + 1;
  }
  return true;
}

/// What `read` asks the scene for. Keys that are only looked for get a value once, so that their form shows; `read`
/// may throw InputError.
inline Keys asked_keys(const KeyedText& text, const std::function<void(const Scene&)>& read) {
  const auto ask = [&](const KeyedText& t, Keys& into) {
    KeyRecord record;
    try {
      read(t.scene());
    } catch (const Error&) {  // refused, after it was asked for
    }
    for (const auto& [path, key] : record.keys(t.path)) {
      AskedKey& known = into[path];
      if (known.form == KeyForm::any || known.form == KeyForm::table) known = key;
    }
  };
  Keys keys;
  ask(text, keys);
  for (const auto& [path, key] : Keys(keys)) {
    if (key.form != KeyForm::any || key.given || !stands_for_all(path, keys)) continue;
    for (const std::string& guess : changed_keys::guesses()) {
      Keys again;
      ask(text.with(path + "=" + guess), again);
      const auto found = again.find(path);
      if (found == again.end() || found->second.form == KeyForm::any) continue;
      for (const auto& [below, one] : again)  // of a table that was not there, what is in it too
        if (below == path || below.starts_with(path + ".")) {
          AskedKey& k = keys[below] = one;
          if (below != path) continue;  // what stands there is a guess, the default is not known
          k.given = false;
          if (k.form == KeyForm::choice || k.form == KeyForm::flag) k.texts.clear(), k.numbers.clear();
        }
      break;
    }
  }
  return keys;
}

/// Whether a part of the scene ([[variant]], [[scene]], [[loading]]) gives the key again, so that the common value may
/// serve nobody.
inline bool given_in_a_part(const std::string& path, const Keys& keys) {
  const auto last = [](const std::string& p) { return p.substr(p.rfind('.') + 1); };
  const auto in_part = [](const std::string& p) {
    return p.starts_with("variant.") || p.starts_with("scene.") || p.starts_with("loading.");
  };
  return !in_part(path) && std::any_of(keys.begin(), keys.end(), [&](const auto& k) {
    return k.second.given && in_part(k.first) && last(k.first) == last(path);
  });
}

/// Values that mean what another one means, or what the scene means without, by the end of the path: and why.
inline bool means_the_same(const std::string& path, const std::string& value) {
  const std::string key = path.substr(path.rfind('.') + 1);
  return (key == "preparation" && value == "\"softgrain\"") ||             // another name of "frictionless"
         (key == "form" && (value == "\"cell\"" || value == "\"pair\""));  // says what the law file is
}

/// All texts in quotes that the reader got.
inline std::set<std::string> texts_of(const Keys& keys) {
  std::set<std::string> out;
  for (const auto& [path, key] : keys)
    if (key.form == KeyForm::text || key.form == KeyForm::texts) out.insert(key.texts.begin(), key.texts.end());
  out.erase("");
  return out;
}

}  // namespace softgrain::test
