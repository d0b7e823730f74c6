// SPDX-License-Identifier: BSD-3-Clause
#include "eval/history.h"

#include "base/error.h"
#include "base/sqlite.h"

#include <filesystem>
#include <limits>

namespace adit {
namespace {

constexpr std::int64_t schema = 2;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t application = 0x61646974;  // "adit"

// Of schema 1, which knew no memory.
const char* const from_1 = "ALTER TABLE cell ADD COLUMN peak_gib REAL";

const char* const tables = R"sql(
CREATE TABLE night (id INTEGER PRIMARY KEY, suite TEXT NOT NULL, branch TEXT NOT NULL, commit_id TEXT NOT NULL,
  version TEXT NOT NULL, evaluator TEXT NOT NULL, machine TEXT NOT NULL, compiler TEXT NOT NULL, date TEXT NOT NULL,
  verdict TEXT NOT NULL, accepted TEXT NOT NULL);
CREATE TABLE cell (id INTEGER PRIMARY KEY, night INTEGER NOT NULL REFERENCES night, scenario TEXT NOT NULL,
  method TEXT NOT NULL, seed INTEGER NOT NULL, truth TEXT NOT NULL, failure TEXT NOT NULL, run TEXT NOT NULL,
  seconds REAL, peak_gib REAL);
CREATE TABLE metric (id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE);
CREATE TABLE value (cell INTEGER NOT NULL REFERENCES cell, metric INTEGER NOT NULL REFERENCES metric,
  value REAL NOT NULL, PRIMARY KEY (cell, metric)) WITHOUT ROWID;
CREATE TABLE claim (id INTEGER PRIMARY KEY, night INTEGER NOT NULL REFERENCES night, scenario TEXT NOT NULL,
  method TEXT NOT NULL, metric TEXT NOT NULL, kind TEXT NOT NULL, words TEXT NOT NULL);
CREATE INDEX cell_night ON cell (night);
CREATE INDEX claim_night ON claim (night);
)sql";

std::int64_t pragma(Sqlite& base, const std::string& name) {
  SqliteStatement ask = base.prepare("PRAGMA " + name);
  return ask.step() ? ask.integer(0) : 0;
}

// Undone unless it is committed.
class Transaction {
 public:
  explicit Transaction(Sqlite& base) : base_(base) { base_.exec("BEGIN IMMEDIATE"); }
  ~Transaction() {
    if (done_) return;
    try {
      base_.exec("ROLLBACK");
    } catch (const Error&) {
      // SQLite has rolled it back already, as it does on a full disk.
    }
  }
  void commit() {
    base_.exec("COMMIT");
    done_ = true;
  }

 private:
  Sqlite& base_;
  bool done_ = false;
};

}  // namespace

struct History::Impl {
  std::string file;
  mutable Sqlite base;

  explicit Impl(const std::string& name) : file(name), base(name) {}

  std::int64_t last_id() {
    SqliteStatement ask = base.prepare("SELECT last_insert_rowid()");
    ask.step();
    return ask.integer(0);
  }

  void make_tables() {
    Transaction all(base);
    const std::int64_t version = pragma(base, "user_version");  // another process may have been faster
    if (version == 0) {
      base.exec(tables);
      base.exec("PRAGMA application_id = " + std::to_string(application));
    } else if (version == 1) {
      base.exec(from_1);
    }
    base.exec("PRAGMA user_version = " + std::to_string(schema));
    all.commit();
  }

  std::map<std::string, std::int64_t> metric_ids() const {
    std::map<std::string, std::int64_t> ids;
    SqliteStatement row = base.prepare("SELECT name, id FROM metric");
    while (row.step()) ids[row.text(0)] = row.integer(1);
    return ids;
  }

  void add_cells(const Night& night, std::int64_t id) {
    SqliteStatement cell = base.prepare(
        "INSERT INTO cell (night, scenario, method, seed, truth, failure, run, seconds, peak_gib) VALUES (?, ?, ?, ?, "
        "?, ?, ?, ?, ?)");
    SqliteStatement metric = base.prepare("INSERT INTO metric (name) VALUES (?)"),
                    value = base.prepare("INSERT INTO value VALUES (?, ?, ?)");
    std::map<std::string, std::int64_t> ids = metric_ids();
    for (const NightCell& c : night.cells) {
      cell.bind(0, id).bind(1, c.scenario).bind(2, c.method).bind(3, std::int64_t{c.seed}).bind(4, c.truth);
      cell.bind(5, c.failure).bind(6, c.run).bind(7, c.seconds).bind(8, c.peak_gib).step();
      const std::int64_t cell_id = last_id();
      for (const auto& [name, number] : c.value) {
        if (!ids.contains(name)) {
          metric.bind(0, name).step();
          ids[name] = last_id();
        }
        value.bind(0, cell_id).bind(1, ids[name]).bind(2, number).step();
      }
    }
  }

  void read_cells(const std::string& suite, std::map<std::int64_t, Night*>& nights) const {
    std::map<std::int64_t, std::string> names;
    for (const auto& [name, id] : metric_ids()) names[id] = name;
    SqliteStatement row = base.prepare(
        "SELECT cell.id, night, scenario, method, seed, truth, failure, run, seconds, peak_gib FROM cell JOIN night ON "
        "night = "
        "night.id WHERE suite = ? ORDER BY cell.id");
    std::map<std::int64_t, std::pair<Night*, size_t>> cells;
    row.bind(0, suite);
    while (row.step()) {
      const auto night = nights.find(row.integer(1));
      if (night == nights.end()) continue;  // added since the nights were read
      cells[row.integer(0)] = {night->second, night->second->cells.size()};
      night->second->cells.push_back({row.text(2),
                                      row.text(3),
                                      static_cast<int>(row.integer(4)),
                                      row.text(5),
                                      row.text(6),
                                      row.text(7),
                                      row.number(8).value_or(none),
                                      {},
                                      row.number(9).value_or(none)});
    }
    SqliteStatement value = base.prepare(
        "SELECT cell, metric, value FROM value JOIN cell ON cell = cell.id JOIN night ON night = night.id WHERE suite "
        "= ?");
    value.bind(0, suite);
    while (value.step())
      if (const auto at = cells.find(value.integer(0)); at != cells.end())
        at->second.first->cells[at->second.second].value[names[value.integer(1)]] = value.number(2).value_or(0);
  }
};

History::History(const std::string& file, int wait_ms) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  std::error_code failed;
  if (!folder.empty()) std::filesystem::create_directories(folder, failed);
  impl_ = std::make_unique<Impl>(file);
  Sqlite& base = impl_->base;
  base.exec("PRAGMA busy_timeout = " + std::to_string(wait_ms) + "; PRAGMA foreign_keys = ON");
  const std::int64_t version = pragma(base, "user_version");
  if (version > schema)
    throw Error(file + ": was written by a newer adit (schema " + std::to_string(version) + ", this one knows " +
                    std::to_string(schema) + "); update adit or name another --history",
                Fault::file);
  SqliteStatement any = base.prepare("SELECT count(*) FROM sqlite_master");
  const bool empty = any.step() && any.integer(0) == 0;
  while (any.step()) {
  }
  if (!empty && pragma(base, "application_id") != application)
    throw Error(file + ": is a database, but not a history of adit; name another file with --history", Fault::file);
  if (version < schema) impl_->make_tables();
}

History::~History() = default;

std::vector<Night> History::nights(const std::string& suite) const {
  impl_->base.exec("BEGIN");  // one view of the file over all that is read
  std::vector<Night> nights;
  SqliteStatement row = impl_->base.prepare(
      "SELECT id, suite, branch, commit_id, version, evaluator, machine, compiler, date, verdict, accepted FROM night "
      "WHERE suite = ? ORDER BY id");
  row.bind(0, suite);
  while (row.step())
    nights.push_back({row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5), row.text(6),
                      row.text(7), row.text(8), row.text(9), row.text(10)});
  std::map<std::int64_t, Night*> by_id;
  for (Night& n : nights) by_id[n.id] = &n;
  impl_->read_cells(suite, by_id);
  SqliteStatement claim =
      impl_->base.prepare("SELECT night, scenario, method, metric, kind, words FROM claim ORDER BY id");
  while (claim.step())
    if (const auto night = by_id.find(claim.integer(0)); night != by_id.end())
      night->second->claims.push_back({claim.text(1), claim.text(2), claim.text(3), claim.text(4), claim.text(5)});
  impl_->base.exec("COMMIT");
  return nights;
}

std::int64_t History::add(const Night& n) {
  Transaction all(impl_->base);
  SqliteStatement row = impl_->base.prepare(
      "INSERT INTO night (suite, branch, commit_id, version, evaluator, machine, compiler, date, verdict, accepted) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  int i = 0;
  for (const std::string* text : {&n.suite, &n.branch, &n.commit, &n.version, &n.evaluator, &n.machine, &n.compiler,
                                  &n.date, &n.verdict, &n.accepted})
    row.bind(i++, *text);
  row.step();
  const std::int64_t id = impl_->last_id();
  impl_->add_cells(n, id);
  SqliteStatement claim =
      impl_->base.prepare("INSERT INTO claim (night, scenario, method, metric, kind, words) VALUES (?, ?, ?, ?, ?, ?)");
  for (const Claim& c : n.claims)
    claim.bind(0, id).bind(1, c.scenario).bind(2, c.method).bind(3, c.metric).bind(4, c.kind).bind(5, c.words).step();
  all.commit();
  return id;
}

std::int64_t History::accept(const std::string& suite, const std::string& branch, const std::string& why) {
  Transaction all(impl_->base);
  SqliteStatement last = impl_->base.prepare("SELECT max(id) FROM night WHERE suite = ?1 AND (?2 = '' OR branch = ?2)");
  last.bind(0, suite).bind(1, branch);
  const std::int64_t id = last.step() ? last.integer(0) : 0;
  while (last.step()) {
  }
  if (id == 0)
    throw Error(impl_->file + ": has no night of suite '" + suite + "'" +
                (branch.empty() ? "" : " on branch '" + branch + "'") + " that could be accepted");
  SqliteStatement mark = impl_->base.prepare("UPDATE night SET accepted = ? WHERE id = ?");
  mark.bind(0, why).bind(1, id).step();
  all.commit();
  return id;
}

}  // namespace adit
