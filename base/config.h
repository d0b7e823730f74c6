// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Settings that people write. A room's settings are a struct with defaults and ONE list of its fields:
//
//   struct SweepSettings { double jitter_s = 0.002; std::string mode = "80m"; };
//   Fields fields(SweepSettings& s) {
//     return {{"jitter_s", &s.jitter_s, "spread of the scan interval", 0, 0.1},
//             {"mode", &s.mode, "range mode", {"8m", "80m"}}};
//   }
//
// That list reads, writes, prints, checks and documents them.

#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace adit {

using FieldRef = std::variant<bool*, int*, double*, std::string*, std::vector<double>*, std::vector<std::string>*,
                              std::vector<int>*>;

/// One setting: its key, where it is kept, what it means, what is allowed.
struct Field {
  Field(std::string key, FieldRef value, std::string help);
  Field(std::string key, FieldRef value, std::string help, double min, double max);
  Field(std::string key, FieldRef value, std::string help, std::vector<std::string> choices);

  std::string key;  // dotted below a table: "world.width_m"
  FieldRef value;
  std::string help;
  double min = -std::numeric_limits<double>::infinity(),
         max = std::numeric_limits<double>::infinity();  // numbers, inclusive
  std::vector<std::string> choices;                      // strings; empty = any
};
using Fields = std::vector<Field>;

/// The fields under a table's name: keys become "table.key". Appends to `all`.
void append(Fields& all, const std::string& table, const Fields& fields);

/// A parsed TOML file that knows its name and lines.
class Document {
 public:
  /// A file, or bundled text with the name that errors shall give.
  static Document parse(const std::string& name, const std::string& text);
  static Document load(const std::string& file);
  /// `name` with a '/' or ending in .toml is a file; else the bundled FOLDER/name.toml. An unknown name is an Error
  /// that lists those there are.
  static Document find(const std::string& folder, const std::string& name);

  const std::string& name() const;
  /// Sets every field that the document has. Keys in it that no field has, wrong types, values out of range: Error
  /// "file:line: key ...". Keys that begin with one of `elsewhere` are left to others.
  void read(const Fields& fields, const std::vector<std::string>& elsewhere = {}) const;
  /// The tables of an array of tables ([[laser]]), in order, each a document of its own; empty where there is none.
  std::vector<Document> tables(const std::string& key) const;
  bool has(const std::string& key) const;
  /// The items of a list of anything as text that set_field reads; empty where there is no such key. Error for what is no
  /// list, or holds tables.
  std::vector<std::string> texts(const std::string& key) const;
  /// Error at the line of a key, for checks that span several fields.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// "key=value" as given on a command line (value in TOML, quotes around strings optional).
void set_field(const Fields& fields, const std::string& assignment);
/// The fields as TOML with their tables, every value written.
std::string to_toml(const Fields& fields);

}  // namespace adit
