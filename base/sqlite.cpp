// SPDX-License-Identifier: BSD-3-Clause
#include "base/sqlite.h"

#include "base/error.h"

#include <sqlite3.h>

#include <cmath>

namespace adit {

struct Sqlite::Impl {
  std::string file;
  sqlite3* base = nullptr;

  ~Impl() { sqlite3_close(base); }
};

struct SqliteStatement::Impl {
  std::string file, sql;
  sqlite3* base = nullptr;
  sqlite3_stmt* statement = nullptr;

  ~Impl() { sqlite3_finalize(statement); }
  [[noreturn]] void fail() const { throw Error(file + ": " + sqlite3_errmsg(base) + " in: " + sql, Fault::file); }
  void expect(int code) const {
    if (code != SQLITE_OK) fail();
  }
};

SqliteStatement::SqliteStatement(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SqliteStatement::SqliteStatement(SqliteStatement&&) noexcept = default;
SqliteStatement& SqliteStatement::operator=(SqliteStatement&&) noexcept = default;
SqliteStatement::~SqliteStatement() = default;

SqliteStatement& SqliteStatement::bind(int i, const std::string& text) {
  impl_->expect(
      sqlite3_bind_text(impl_->statement, i + 1, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  return *this;
}
SqliteStatement& SqliteStatement::bind(int i, double number) {
  impl_->expect(std::isfinite(number) ? sqlite3_bind_double(impl_->statement, i + 1, number)
                                      : sqlite3_bind_null(impl_->statement, i + 1));
  return *this;
}
SqliteStatement& SqliteStatement::bind(int i, std::int64_t number) {
  impl_->expect(sqlite3_bind_int64(impl_->statement, i + 1, number));
  return *this;
}

bool SqliteStatement::step() {
  const int code = sqlite3_step(impl_->statement);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) impl_->fail();
  impl_->expect(sqlite3_reset(impl_->statement));
  return false;
}

std::string SqliteStatement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(impl_->statement, column));
  return text ? std::string(text, static_cast<size_t>(sqlite3_column_bytes(impl_->statement, column))) : "";
}
std::optional<double> SqliteStatement::number(int column) const {
  if (sqlite3_column_type(impl_->statement, column) == SQLITE_NULL) return {};
  return sqlite3_column_double(impl_->statement, column);
}
std::int64_t SqliteStatement::integer(int column) const {
  return sqlite3_column_int64(impl_->statement, column);
}

Sqlite::Sqlite(const std::string& file, Open how) : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  const int flags = how == Open::read ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  if (sqlite3_open_v2(file.c_str(), &impl_->base, flags, nullptr) != SQLITE_OK) {
    const std::string why = impl_->base ? sqlite3_errmsg(impl_->base) : "out of memory";
    throw Error(file + ": cannot be opened as an SQLite database: " + why, Fault::file);
  }
  sqlite3_busy_timeout(impl_->base, 60000);
}
Sqlite::~Sqlite() = default;
Sqlite::Sqlite(Sqlite&&) noexcept = default;
Sqlite& Sqlite::operator=(Sqlite&&) noexcept = default;

void Sqlite::exec(const std::string& sql) {
  char* why = nullptr;
  if (sqlite3_exec(impl_->base, sql.c_str(), nullptr, nullptr, &why) == SQLITE_OK) return;
  const std::string what = why ? why : "unknown";
  sqlite3_free(why);
  throw Error(impl_->file + ": " + what + " in: " + sql, Fault::file);
}

SqliteStatement Sqlite::prepare(const std::string& sql) {
  auto statement = std::make_unique<SqliteStatement::Impl>();
  statement->file = impl_->file, statement->sql = sql, statement->base = impl_->base;
  if (sqlite3_prepare_v2(impl_->base, sql.c_str(), -1, &statement->statement, nullptr) != SQLITE_OK) statement->fail();
  return SqliteStatement(std::move(statement));
}

}  // namespace adit
