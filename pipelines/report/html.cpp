#include "pipelines/report/html.h"

namespace softgrain::report {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 1180px; padding: 1.2rem 1.6rem 3rem; background: #fff; color: #1a1a1a;
  font: 15px/1.5 Helvetica, Arial, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.65rem; margin: 0.4rem 0 0.6rem; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 0.5rem; padding-bottom: 0.2rem; border-bottom: 1px solid #d0d0d0; }
h3 { font-size: 1rem; margin: 1.1rem 0 0.3rem; }
p { margin: 0.4rem 0; max-width: 62rem; }
ul { margin: 0.3rem 0; padding-left: 1.3rem; }
.lead p { margin: 0.1rem 0; max-width: none; }
.status { display: inline-block; padding: 0 0.55rem; border-radius: 0.7rem; font-size: 0.85rem; vertical-align: middle; font-weight: 600; }
.status-good { background: #d9f2e8; color: #005c43; }
.status-bad { background: #fde3d0; color: #8a3c00; }
.remarks { background: #fff8ec; border-left: 4px solid #e69f00; padding: 0.5rem 0.9rem; margin: 1rem 0; }
.remarks h2 { margin: 0; border: 0; font-size: 1rem; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); gap: 0.6rem 1.2rem; align-items: start; }
.row figure:only-child { max-width: 680px; }
figure { margin: 0.4rem 0 0.8rem; break-inside: avoid; }
figure svg { display: block; width: 100%; height: auto; }
figcaption { font-size: 0.86rem; color: #444; padding: 0.2rem 0.4rem 0; }
.strip { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 0.4rem; align-items: end; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.88rem; margin: 0.5rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: 0.22rem 0.6rem; text-align: right; white-space: nowrap; border-bottom: 1px solid #e4e4e4; }
th { white-space: normal; border-bottom: 1.5px solid #555; font-weight: 600; vertical-align: bottom; }
.l { text-align: left; }
tbody tr:hover { background: #f5f8fa; }
pre { background: #f6f6f6; padding: 0.7rem; font-size: 0.8rem; white-space: pre-wrap; overflow-wrap: anywhere; }
code { overflow-wrap: anywhere; }
@media print { body { max-width: none; padding: 0; font-size: 10pt; } .row { grid-template-columns: 1fr 1fr; }
  h2 { break-after: avoid; } tr { break-inside: avoid; } .scroll { overflow: visible; } }
@media (max-width: 520px) { .row { grid-template-columns: 1fr; } }
)css";

std::string table_row(const std::vector<std::string>& cells, std::size_t left_columns, const std::string& tag) {
  std::string out = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    out += "<" + tag + (i < left_columns ? " class=\"l\">" : ">") + escape(cells[i]) + "</" + tag + ">";
  }
  return out + "</tr>\n";
}

}  // namespace

std::string escape(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (const char ch : text) {
    switch (ch) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(ch) >= 0x20 || ch == '\n' || ch == '\t') out += ch;
    }
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
  std::string out =
      "<div class=\"scroll\"><table><thead>" + table_row(header_, left_columns_, "th") + "</thead><tbody>\n";
  for (const auto& cells : rows_) out += table_row(cells, left_columns_, "td");
  return out + "</tbody></table></div>\n";
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

std::string section(const std::string& id, const std::string& heading, const std::string& body) {
  if (body.empty()) return "";
  return "<section id=\"" + escape(id) + "\">\n<h2>" + escape(heading) + "</h2>\n" + body + "</section>\n";
}

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + body + "</body>\n</html>\n";
}

}  // namespace softgrain::report
