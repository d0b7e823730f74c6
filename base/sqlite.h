// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace adit {

class Sqlite;

/// A prepared statement. Parameters and columns count from 0; a value that is not finite is NULL.
class SqliteStatement {
 public:
  SqliteStatement(SqliteStatement&&) noexcept;
  SqliteStatement& operator=(SqliteStatement&&) noexcept;
  ~SqliteStatement();

  SqliteStatement& bind(int i, const std::string& text);
  SqliteStatement& bind(int i, double number);
  SqliteStatement& bind(int i, std::int64_t number);
  /// True while there is a row; afterwards the statement is reset, to be bound and stepped again.
  bool step();

  std::string text(int column) const;  // "" for NULL
  std::optional<double> number(int column) const;
  std::int64_t integer(int column) const;  // 0 for NULL

 private:
  friend class Sqlite;
  struct Impl;
  explicit SqliteStatement(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// An SQLite database; it must outlive its statements. Every fault is an Error (Fault::file) that names the file, the
/// statement and SQLite's reason. Writers of other processes are waited for up to a minute.
class Sqlite {
 public:
  enum class Open { read, create };
  explicit Sqlite(const std::string& file, Open how = Open::create);
  ~Sqlite();
  Sqlite(Sqlite&&) noexcept;
  Sqlite& operator=(Sqlite&&) noexcept;

  /// Statements without results, parted by ';'.
  void exec(const std::string& sql);
  SqliteStatement prepare(const std::string& sql);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
