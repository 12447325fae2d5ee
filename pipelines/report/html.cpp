#include "pipelines/report/html.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

#include "common/core/text.h"
#include "pipelines/report/report.h"

namespace softgrain::report {
namespace {

/// Nothing may be fetched from anywhere: the page holds all that it shows.
constexpr const char* kNoNetwork =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:\">\n";

struct Entity {
  char character;
  std::string_view text;
};

constexpr std::array<Entity, 5> kEntities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}}};

std::string table_row(const std::vector<std::string>& cells, const std::vector<std::string>& classes,
                      const std::string& tag) {
  std::string out = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string name = classes[i].empty() ? "" : " class=\"" + classes[i] + "\"";
    out += "<" + tag + name + ">" + escape(cells[i]) + "</" + tag + ">";
  }
  return out + "</tr>\n";
}

/// Too long for one line beside others: words, not a number.
bool is_long(const std::string& cell) {
  constexpr std::size_t kLong = 40;
  return cell.size() > kLong;
}

/// "Table of stage, engine, modulus and 3 more columns, 6 rows".
std::string summary_of(const std::vector<std::string>& header, std::size_t rows) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> titled;
  std::ranges::copy_if(header, std::back_inserter(titled), [](const std::string& t) { return !t.empty(); });
  const std::size_t named = std::min(titled.size(), kNamed);
  std::string text = "Table of " + join_text(std::span(titled).first(named));
  const std::size_t more = titled.size() - named;
  if (more > 0) text += " and " + std::to_string(more) + " more column" + (more == 1 ? "" : "s");
  return text + ", " + std::to_string(rows) + (rows == 1 ? " row" : " rows");
}

}  // namespace

std::string escape(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (const char ch : text) {
    const auto known = std::ranges::find(kEntities, ch, &Entity::character);
    if (known != kEntities.end())
      out += known->text;
    else if (static_cast<unsigned char>(ch) >= 0x20 || ch == '\n' || ch == '\t')
      out += ch;
  }
  return out;
}

std::string unescape(const std::string& html) {
  std::string out;
  out.reserve(html.size());
  for (std::size_t at = 0; at < html.size();) {
    const auto known =
        std::ranges::find_if(kEntities, [&](const Entity& e) { return html.compare(at, e.text.size(), e.text) == 0; });
    out += known == kEntities.end() ? html[at] : known->character;
    at += known == kEntities.end() ? 1 : known->text.size();
  }
  return out;
}

HtmlTable::HtmlTable(std::vector<std::string> header, std::size_t left_columns)
    : header_(std::move(header)), left_columns_(left_columns) {}

void HtmlTable::row(std::vector<std::string> cells) {
  cells.resize(header_.size());
  rows_.push_back(std::move(cells));
}

std::string HtmlTable::html() const {
  std::vector<std::string> classes(header_.size());
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (i < left_columns_) classes[i] = "l";
    if (i > 0 && std::ranges::any_of(rows_, [i](const auto& cells) { return is_long(cells[i]); })) classes[i] = "t";
  }
  std::string out = "<details class=\"table\"><summary>" + escape(summary_of(header_, rows_.size())) +
                    "</summary>\n<div class=\"scroll\"><table><thead>" + table_row(header_, classes, "th") +
                    "</thead><tbody>\n";
  for (const auto& cells : rows_) out += table_row(cells, classes, "td");
  return out + "</tbody></table></div></details>\n";
}

std::string paragraph(const std::string& text) { return "<p>" + escape(text) + "</p>\n"; }

std::string figure(const std::string& svg, const std::string& caption) {
  return "<figure>" + svg + (caption.empty() ? "" : "<figcaption>" + escape(caption) + "</figcaption>") + "</figure>\n";
}

std::string figure_row(const std::vector<std::string>& figures) {
  std::string out;
  for (const std::string& one : figures) out += one;
  return out.empty() ? "" : "<div class=\"row\">\n" + out + "</div>\n";
}

std::string section(const std::string& id, const std::string& heading, const std::string& lead,
                    const std::string& body) {
  if (body.empty()) return "";
  const bool figures = body.find("<figure") != std::string::npos;
  return "<section id=\"" + escape(id) + "\"" + (figures ? " class=\"page\"" : "") + ">\n<h2>" + escape(heading) +
         "</h2>\n<p class=\"what\">" + escape(lead) + "</p>\n" + body + "</section>\n";
}

std::string contents(const std::string& body) {
  const std::string begin = "<section id=\"";
  const std::string title = "<h2>";
  std::string out;
  for (std::size_t at = body.find(begin); at != std::string::npos; at = body.find(begin, at + 1)) {
    const std::size_t id = at + begin.size();
    const std::size_t heading = body.find(title, at) + title.size();
    out += "<a href=\"#" + body.substr(id, body.find('"', id) - id) + "\">" +
           body.substr(heading, body.find("</h2>", heading) - heading) + "</a>\n";
  }
  return out.empty() ? "" : "<nav class=\"contents\" aria-label=\"Sections\">\n" + out + "</nav>\n";
}

std::string script(std::string_view source) { return "<script>\n" + std::string(source) + "</script>\n"; }

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n" + std::string(kNoNetwork) +
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" + escape(title) +
         "</title>\n<style>\n" + std::string(assets::report_css()) + "</style>\n</head>\n<body>\n" + body +
         script(assets::report_js()) + "</body>\n</html>\n";
}

}  // namespace softgrain::report
