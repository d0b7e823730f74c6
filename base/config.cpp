// SPDX-License-Identifier: BSD-3-Clause
#include "base/config.h"

#define TOML_ENABLE_FORMATTERS 0
#include "base/bundled.h"
#include "base/error.h"
#include "base/files.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace adit {
namespace {

std::string number(double v) {
  char text[40];
  for (int digits : {6, 9, 12, 15, 17}) {
    std::snprintf(text, sizeof text, "%.*g", digits, v);
    if (std::strtod(text, nullptr) == v) break;
  }
  return text;
}

std::string in_quotes(const std::string& s) {
  std::string text = "\"";
  for (char c : s) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", c);
      text += code;
    } else {
      text += c;
    }
  }
  return text + "\"";
}

std::string real(double v) {
  std::string text = number(v);
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

struct Writer {
  std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
  std::string operator()(const int* v) const { return std::to_string(*v); }
  std::string operator()(const double* v) const { return real(*v); }
  std::string operator()(const std::string* v) const { return in_quotes(*v); }
  template <class T>
  std::string operator()(const std::vector<T>* values) const {
    std::string text = "[";
    for (size_t i = 0; i < values->size(); ++i) {
      const T item = (*values)[i];
      text += (i ? ", " : "") + (*this)(&item);
    }
    return text + "]";
  }
};

// Levenshtein distance, for "did you mean".
size_t edits(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t up = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = up;
    }
  }
  return row[b.size()];
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  size_t least = std::max<size_t>(2, word.size() / 3) + 1;
  for (const std::string& k : known) {
    const size_t d = edits(word, k);
    if (d < least) least = d, best = k;
  }
  return best.empty() ? "" : " (did you mean '" + best + "'?)";
}

std::string unknown_key(const std::string& key, const Fields& fields) {
  std::vector<std::string> known;
  for (const Field& f : fields) known.push_back(f.key);
  return "unknown key '" + key + "'" + did_you_mean(key, known);
}

std::string allowed(const Field& f) {
  std::string text;
  for (const std::string& c : f.choices) text += (text.empty() ? "" : ", ") + in_quotes(c);
  if (!text.empty()) return "one of " + text;
  if (std::isfinite(f.min) && std::isfinite(f.max)) return number(f.min) + " to " + number(f.max);
  return std::isfinite(f.min) ? "at least " + number(f.min) : "at most " + number(f.max);
}

// Puts a TOML value where the field is kept; the answer is what is wrong, empty if nothing.
struct Setter {
  const toml::node& node;
  const Field& field;

  std::string in_range(double v) const {
    if (!std::isfinite(v) || v < field.min || v > field.max)
      return "is " + number(v) + ", must be " + (std::isfinite(v) ? allowed(field) : "finite");
    return "";
  }
  std::string operator()(bool* v) const {
    const auto value = node.value_exact<bool>();
    if (!value) return "must be true or false";
    *v = *value;
    return "";
  }
  std::string operator()(int* v) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value) return "must be a whole number";
    if (*value < std::numeric_limits<int>::min() || *value > std::numeric_limits<int>::max()) return "is out of range";
    *v = static_cast<int>(*value);
    return in_range(static_cast<double>(*value));
  }
  std::string operator()(double* v) const {
    if (!node.is_number()) return "must be a number";
    *v = *node.value<double>();
    return in_range(*v);
  }
  std::string operator()(std::string* v) const {
    const auto value = node.value_exact<std::string>();
    if (!value) return "must be a string";
    *v = *value;
    if (!field.choices.empty() && std::find(field.choices.begin(), field.choices.end(), *v) == field.choices.end())
      return "is " + in_quotes(*v) + ", must be " + allowed(field);
    return "";
  }
  template <class T>
  std::string operator()(std::vector<T>* values) const {
    const toml::array* items = node.as_array();
    if (!items) return "must be a list in [ ]";
    values->clear();
    for (const toml::node& item : *items) {
      T value{};
      const std::string wrong = Setter{item, field}(&value);
      if (!wrong.empty()) return "holds an item that " + wrong;
      values->push_back(value);
    }
    return "";
  }
};

// TOML of a value, empty for what settings do not have.
std::string text_of(const toml::node& node) {
  if (const auto v = node.value_exact<bool>()) return *v ? "true" : "false";
  if (const auto v = node.value_exact<std::int64_t>()) return std::to_string(*v);
  if (const auto v = node.value_exact<double>()) return real(*v);
  if (const auto v = node.value_exact<std::string>()) return in_quotes(*v);
  const toml::array* items = node.as_array();
  if (!items) return "";
  std::string text;
  for (const toml::node& item : *items) {
    const std::string one = text_of(item);
    if (one.empty()) return "";
    text += (text.empty() ? "" : ", ") + one;
  }
  return "[" + text + "]";
}

bool is_table_array(const toml::node& node) {
  const toml::array* a = node.as_array();
  return a && !a->empty() && a->is_homogeneous(toml::node_type::table);
}

bool left_to_others(const std::string& key, const std::vector<std::string>& elsewhere) {
  return std::any_of(elsewhere.begin(), elsewhere.end(),
                     [&](const std::string& e) { return key == e || key.starts_with(e + "."); });
}

}  // namespace

Field::Field(std::string k, FieldRef v, std::string h) : key(std::move(k)), value(v), help(std::move(h)) {}
Field::Field(std::string k, FieldRef v, std::string h, double lo, double hi)
    : key(std::move(k)), value(v), help(std::move(h)), min(lo), max(hi) {}
Field::Field(std::string k, FieldRef v, std::string h, std::vector<std::string> c)
    : key(std::move(k)), value(v), help(std::move(h)), choices(std::move(c)) {}

void append(Fields& all, const std::string& table, const Fields& fields) {
  for (Field f : fields) {
    f.key = table + "." + f.key;
    all.push_back(std::move(f));
  }
}

struct Document::Impl {
  std::string name;
  std::shared_ptr<const toml::table> root;  // keeps `table` alive
  const toml::table* table = nullptr;

  std::string place(const toml::node* node) const {
    const auto line = node ? node->source().begin.line : table->source().begin.line;
    return name + (line ? ":" + std::to_string(line) : "") + ": ";
  }

  void read(const toml::table& from, const std::string& prefix, const Fields& fields,
            const std::vector<std::string>& elsewhere) const {
    for (const auto& [k, node] : from) {
      const std::string key = prefix + std::string(k.str());
      if (left_to_others(key, elsewhere)) continue;
      if (const toml::table* inner = node.as_table()) {
        read(*inner, key + ".", fields, elsewhere);
        continue;
      }
      const auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == key; });
      if (field == fields.end() || is_table_array(node)) throw Error(place(&node) + unknown_key(key, fields));
      const std::string wrong = std::visit(Setter{node, *field}, field->value);
      if (!wrong.empty()) throw Error(place(&node) + "'" + key + "' " + wrong);
    }
  }
};

Document Document::parse(const std::string& name, const std::string& text) {
  try {
    auto root = std::make_shared<const toml::table>(toml::parse(text, name));
    Document d;
    d.impl_ = std::make_shared<const Impl>(Impl{name, root, root.get()});
    return d;
  } catch (const toml::parse_error& e) {
    throw Error(name + ":" + std::to_string(e.source().begin.line) + ": not TOML: " + std::string(e.description()));
  }
}

Document Document::load(const std::string& file) {
  return parse(file, read_text(file));
}

Document Document::find(const std::string& folder, const std::string& name) {
  if (name.find('/') != std::string::npos || name.ends_with(".toml")) return load(name);
  const std::string path = folder + "/" + name + ".toml";
  const std::string_view text = bundled(path);
  if (!text.empty()) return parse(path, std::string(text));
  std::string known;
  const std::vector<std::string> names = bundled_names(folder);
  for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
  throw Error("'" + name + "' is not bundled under " + folder + did_you_mean(name, names) + "; there are: " + known +
              "; a file's name must end in .toml");
}

const std::string& Document::name() const {
  return impl_->name;
}

void Document::read(const Fields& fields, const std::vector<std::string>& elsewhere) const {
  impl_->read(*impl_->table, "", fields, elsewhere);
}

std::vector<Document> Document::tables(const std::string& key) const {
  std::vector<Document> found;
  const toml::node_view<const toml::node> view = impl_->table->at_path(key);
  const toml::array* items = view.as_array();
  if (!items) return found;
  for (const toml::node& item : *items) {
    if (!item.is_table()) throw Error(impl_->place(&item) + "'" + key + "' must be tables, [[" + key + "]]");
    Document d;
    d.impl_ = std::make_shared<const Impl>(Impl{impl_->name, impl_->root, item.as_table()});
    found.push_back(std::move(d));
  }
  return found;
}

bool Document::has(const std::string& key) const {
  return static_cast<bool>(impl_->table->at_path(key));
}

std::vector<std::string> Document::texts(const std::string& key) const {
  std::vector<std::string> texts;
  const toml::node* node = impl_->table->at_path(key).node();
  if (!node) return texts;
  if (!node->is_array()) fail(key, "must be a list in [ ]");
  for (const toml::node& item : *node->as_array()) {
    const std::string text = text_of(item);
    if (text.empty()) fail(key, "may hold numbers, strings, true, false and lists of them");
    texts.push_back(text);
  }
  return texts;
}

void Document::fail(const std::string& key, const std::string& what) const {
  const toml::node* node = impl_->table->at_path(key).node();
  throw Error(impl_->place(node) + "'" + key + "' " + what);
}

void set_field(const Fields& fields, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error("--set " + assignment + ": must be key=value, as in --set world.height_m=2.0");
  const std::string key = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  const auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == key; });
  if (field == fields.end()) throw Error("--set " + assignment + ": " + unknown_key(key, fields));
  toml::table parsed;
  try {
    const bool bare =
        std::holds_alternative<std::string*>(field->value) && !value.starts_with('"') && !value.starts_with('\'');
    parsed = toml::parse("v = " + (bare ? in_quotes(value) : value));
  } catch (const toml::parse_error& e) {
    throw Error("--set " + assignment + ": the value is not TOML: " + std::string(e.description()));
  }
  const std::string wrong = std::visit(Setter{*parsed.get("v"), *field}, field->value);
  if (!wrong.empty()) throw Error("--set " + assignment + ": '" + key + "' " + wrong);
}

std::string to_toml(const Fields& fields) {
  // Keys without a table come first; then table by table, in the order of the tables' first field.
  std::vector<std::string> tables{""};
  const auto table_of = [](const Field& f) {
    const size_t dot = f.key.rfind('.');
    return dot == std::string::npos ? std::string() : f.key.substr(0, dot);
  };
  for (const Field& f : fields)
    if (std::find(tables.begin(), tables.end(), table_of(f)) == tables.end()) tables.push_back(table_of(f));
  std::string text;
  for (const std::string& table : tables) {
    if (!table.empty()) text += "\n[" + table + "]\n";
    for (const Field& f : fields)
      if (table_of(f) == table)
        text += f.key.substr(table.empty() ? 0 : table.size() + 1) + " = " + std::visit(Writer{}, f.value) + "\n";
  }
  return text;
}

}  // namespace adit
