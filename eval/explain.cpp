// SPDX-License-Identifier: BSD-3-Clause
#include "eval/explain.h"

#include "base/bundled.h"
#include "base/error.h"

#include <algorithm>
#include <regex>
#include <sstream>

namespace adit {
namespace {

struct Definition {
  std::string block, name;  // name: "<alignment>.ate_rmse_m"; <...> stands for one part, * for any
  std::string words;
};
struct Page {
  std::vector<Definition> metrics;
  std::vector<std::pair<std::string, std::string>> alignments;  // name, words
  std::vector<std::pair<std::string, std::string>> blocks;      // name, its first paragraphs
};

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream text(row.substr(1));
  for (std::string cell; std::getline(text, cell, '|');) {
    const size_t begin = cell.find_first_not_of(' '), end = cell.find_last_not_of(' ');
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

std::vector<std::string> quoted(const std::string& cell) {
  std::vector<std::string> names;
  for (size_t begin = cell.find('`'); begin != std::string::npos;) {
    const size_t end = cell.find('`', begin + 1);
    if (end == std::string::npos) break;
    names.push_back(cell.substr(begin + 1, end - begin - 1));
    begin = cell.find('`', end + 1);
  }
  return names;
}

// A table's kind is its first heading: metrics are defined under "metric", ways of laying M on W under "name".
Page read_page(const std::string& text) {
  Page page;
  std::istringstream lines(text);
  std::string block, table;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) {
      const std::vector<std::string> names = quoted(line);
      block = names.empty() ? "" : names[0];
      if (!block.empty()) page.blocks.emplace_back(block, "");
      continue;
    }
    if (!line.starts_with("|")) {
      table.clear();
      const bool before = page.metrics.empty() || page.metrics.back().block != block;
      if (!block.empty() && before) page.blocks.back().second += line + "\n";
      continue;
    }
    const std::vector<std::string> cells = cells_of(line);
    if (table.empty()) {
      table = cells.empty() ? "" : cells[0];
    } else if (table == "metric" && cells.size() >= 2) {
      for (const std::string& name : quoted(cells[0])) page.metrics.push_back({block, name, cells[1]});
    } else if (table == "name" && cells.size() >= 3) {
      for (const std::string& name : quoted(cells[0]))
        page.alignments.emplace_back(name, cells[1] + "; takes away: " + cells[2]);
    }
  }
  return page;
}

const Page& the_page() {
  static const Page page = read_page(std::string(bundled("docs/metrics.md")));
  return page;
}

std::regex pattern_of(const std::string& name) {
  std::string out;
  for (size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '<') {
      out += "[^.]+";
      i = name.find('>', i);
    } else if (name[i] == '*') {
      out += ".*";
    } else {
      out += name[i] == '.' ? std::string("\\.") : std::string(1, name[i]);
    }
  }
  return std::regex(out);
}

// "block.a.b.c" is asked by all of it, without its block, or by its last part.
bool is_asked(const Definition& d, const std::string& asked) {
  const std::string full = d.block + "." + d.name;
  if (std::regex_match(asked, pattern_of(full)) || std::regex_match(asked, pattern_of(d.name))) return true;
  const size_t dot = d.name.rfind('.');
  return dot != std::string::npos && d.name.back() != '*' &&
         std::regex_match(asked, pattern_of(d.name.substr(dot + 1)));
}

std::string without_quotes(std::string words) {
  std::erase(words, '`');
  return words;
}

}  // namespace

std::vector<std::string> defined_metrics() {
  std::vector<std::string> names;
  for (const Definition& d : the_page().metrics) names.push_back(d.block + "." + d.name);
  return names;
}

bool is_metric(const std::string& name) {
  const std::vector<std::string> names = defined_metrics();
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& d) { return std::regex_match(name, pattern_of(d)); });
}

std::string explain_metric(const std::string& name) {
  const Page& page = the_page();
  std::string out, block;
  // What is under a path of its own (open_loop, by_label) is also explained by its own last part.
  for (const Definition& d : page.metrics) {
    if (!is_asked(d, name)) continue;
    out += d.block + "." + d.name + "\n  " + without_quotes(d.words) + "\n";
    block = d.block;
  }
  if (out.empty()) {
    std::string near;
    const std::string last = name.substr(name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1);
    for (const std::string& known : defined_metrics())
      if (!last.empty() && known.find(last.substr(0, 4)) != std::string::npos)
        near += (near.empty() ? "" : ", ") + known;
    throw Error("no metric '" + name + "'" + (near.empty() ? "" : "; near it: " + near) +
                "; 'adit list metrics' shows all");
  }
  for (const auto& [alignment, words] : page.alignments)
    if (name.find(alignment) != std::string::npos)
      out += "\nalignment " + alignment + "\n  " + without_quotes(words) + "\n";
  for (const auto& [of, words] : page.blocks)
    if (of == block && words.find_first_not_of(" \n") != std::string::npos)
      out += "\n" + of + "\n" + without_quotes(words.substr(words.find_first_not_of('\n')));
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out;
}

}  // namespace adit
