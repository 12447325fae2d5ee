// The few pieces of HTML that a report is made of. Every text that comes from data goes through escape().
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace softgrain::report {

/// Text made safe for element content and quoted attributes; control characters that XML forbids are dropped.
std::string escape(const std::string& text);

/// The text that escape() was given, but for what that dropped.
std::string unescape(const std::string& html);

/// A table of escaped texts, folded under a line that names its first columns. Columns after the first are aligned to
/// the right unless `left_columns` says otherwise; columns with long texts to the left, in several lines.
class HtmlTable {
 public:
  explicit HtmlTable(std::vector<std::string> header, std::size_t left_columns = 1);
  void row(std::vector<std::string> cells);
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::string html() const;

 private:
  std::vector<std::string> header_;
  std::size_t left_columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// "<p>...</p>" of escaped text.
std::string paragraph(const std::string& text);

/// A drawing with its caption (escaped).
std::string figure(const std::string& svg, const std::string& caption);

/// Figures side by side where the page is wide enough.
std::string figure_row(const std::vector<std::string>& figures);

/// A section with a heading and a sentence, `lead`, that says what to see; empty when the body is empty, so that a
/// section without data leaves no trace. With figures it begins a page in print.
std::string section(const std::string& id, const std::string& heading, const std::string& lead,
                    const std::string& body);

/// Links to the sections of a body.
std::string contents(const std::string& body);

/// A script element. The source must not hold the end tag of one.
std::string script(std::string_view source);

/// The whole page around a body: style for screen and print, no network.
std::string page(const std::string& title, const std::string& body);

}  // namespace softgrain::report
