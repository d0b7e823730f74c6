// SPDX-License-Identifier: BSD-3-Clause
// What the documentation tells people to type.
#include "base/files.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string docs = ADIT_SOURCE_DIR "/docs";

// Lines that a page sets apart as commands or files, without their indent.
std::vector<std::string> set_apart(const std::string& page) {
  std::vector<std::string> lines;
  std::istringstream text(read_text(page));
  for (std::string line; std::getline(text, line);)
    if (line.starts_with("    ")) lines.push_back(line.substr(4));
  return lines;
}

int run_in(const std::string& dir, const std::string& command) {
  const int status = std::system(
      ("cd " + dir + " && adit() { " ADIT_BINARY " \"$@\" --quiet >>said.txt 2>&1; } && " + command).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// The commands of a tutorial, one after the other, in a mine that takes seconds.
void follow(const std::string& tutorial, const std::set<std::string>& leave_out = {}) {
  const std::string dir = scratch("follow_" + tutorial);
  fs::create_directories(dir);
  const std::string tiny = ADIT_SOURCE_DIR "/tests/cli/tiny.toml";
  std::string file;
  int commands = 0;
  for (std::string line : set_apart(docs + "/tutorials/" + tutorial + ".md")) {
    line = std::regex_replace(line, std::regex("(run|drive|world) mini\\b"), "$1 " + tiny);
    line = std::regex_replace(line, std::regex("scenario = \"mini\""), "scenario = \"" + tiny + "\"");
    line = std::regex_replace(line, std::regex("seeds = 3"), "seeds = 1");
    if (!line.starts_with("adit ")) {
      if (line.starts_with("# ")) file = dir + "/" + line.substr(2);
      if (!file.empty()) write_text(file, (fs::exists(file) ? read_text(file) : "") + line + "\n");
      continue;
    }
    if (leave_out.contains(line.substr(5, line.find(' ', 5) - 5))) continue;
    ++commands;
    EXPECT_EQ(run_in(dir, line), 0) << tutorial << ": " << line << "\n" << read_text(dir + "/said.txt");
  }
  EXPECT_GT(commands, 2);
}

TEST(Tutorials, MinesRuns) {
  follow("mines");
}
TEST(Tutorials, ReportsRuns) {
  follow("reports");
}
TEST(Tutorials, RegressionsRuns) {
  follow("regressions");
}
// Its study of 8 runs takes minutes; the tests of `adit study` run smaller ones.
TEST(Tutorials, PlacementRuns) {
  follow("placement", {"study"});
}

std::string help_of(const std::string& command) {
  static std::map<std::string, std::string> known;
  if (known.contains(command)) return known[command];
  const std::string at = scratch("help.txt");
  const int status = std::system((ADIT_BINARY " " + command + " --help >" + at + " 2>&1").c_str());
  return known[command] = status == 0 ? read_text(at) : "";
}

// Every command in every page, and in the README: there is such a command, and it has such options.
TEST(Docs, EveryCommandAndOptionThatTheyNameIsThere) {
  std::vector<std::string> pages{ADIT_SOURCE_DIR "/README.md"};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(docs))
    if (entry.path().extension() == ".md") pages.push_back(entry.path().string());
  const std::regex call("(^ {4,}|`|bin/|&& )adit ([a-z]+)([^`#&\\n]*)"), option("(^| )(--[a-z][a-z-]*)");
  int calls = 0;
  for (const std::string& page : pages) {
    std::istringstream text(read_text(page));
    for (std::string line; std::getline(text, line);)
      for (std::sregex_iterator c(line.begin(), line.end(), call), end; c != end; ++c) {
        const std::string help = help_of((*c)[2]), words = (*c)[3];
        if ((*c)[2] == "log" || (*c)[2] == "truth") continue;  // formats of files that bear these names
        ++calls;
        EXPECT_NE(help, "") << page << ": adit " << (*c)[2];
        for (std::sregex_iterator o(words.begin(), words.end(), option); o != end; ++o)
          EXPECT_THAT(help, HasSubstr((*o)[2].str())) << page << ": adit " << (*c)[2] << words;
      }
  }
  EXPECT_GT(calls, 60);
}

}  // namespace
}  // namespace adit
