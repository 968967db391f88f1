#pragma once
// SQLite, as far as sweeps need it; its header is known to the .cpp file alone.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

struct sqlite3;
struct sqlite3_stmt;

namespace gear3k::sweep {

/// NULL, INTEGER, REAL or TEXT.
using SqlValue = std::variant<std::nullptr_t, std::int64_t, double, std::string>;

/// A statement and its place among its rows.  Must not outlive its database.
class Statement {
 public:
  /// @throws io::InvalidInput also for a text without a statement, or with several
  Statement(sqlite3* database, const std::string& path, std::string_view sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Begins anew with these values in place of ?1, ?2, ...
  template <class... Values>
  Statement& with(const Values&... values) {
    reset();
    int place = 0;
    (bind(++place, SqlValue(values)), ...);
    return *this;
  }
  /// Begins anew, values kept.
  void reset();
  /// @param place  from 1
  void bind(int place, const SqlValue& value);
  /// Goes to the next row.  @returns false at the end
  bool step();
  /// Runs it to its end, and makes it ready for the next time.
  void run();

  [[nodiscard]] int columns() const;
  [[nodiscard]] std::string name(int column) const;
  /// Of the row at which it is, columns from 0.
  [[nodiscard]] SqlValue value(int column) const;
  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double number(int column) const;
  [[nodiscard]] std::string text(int column) const;

 private:
  sqlite3* database_;
  const std::string* path_;
  sqlite3_stmt* statement_ = nullptr;
};

/// A connection.  Of a process that forks afterwards: closed before (SQLite, "How To Corrupt An
/// SQLite Database File", 2.6).
///
/// Every function throws io::InvalidInput that names the file, what is wrong and what to do: no
/// database, damaged, full, read-only, held by another process for longer than kBusySeconds.
class Database {
 public:
  enum class Access {
    kRead,   ///< an existing file; statements that do more than read are refused
    kWrite,  ///< an existing file
    kCreate  ///< the same, or a new file
  };
  /// How long another process may hold the file.
  static constexpr int kBusySeconds = 60;

  Database(std::string path, Access access);
  ~Database();
  Database(Database&& other) noexcept;
  Database& operator=(Database&&) = delete;
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  [[nodiscard]] const std::string& path() const { return *path_; }
  /// Runs statements without values and without results.
  void execute(const std::string& sql);
  [[nodiscard]] Statement prepare(std::string_view sql) const;
  /// The first column of the only row; NULL where there is none.
  [[nodiscard]] SqlValue one(std::string_view sql) const;
  /// The same as an integer, 0 for NULL.
  [[nodiscard]] std::int64_t count(std::string_view sql) const;
  /// Rows that the last INSERT, UPDATE or DELETE changed.
  [[nodiscard]] std::int64_t changes() const;
  [[nodiscard]] std::int64_t last_id() const;

 private:
  sqlite3* database_ = nullptr;
  std::unique_ptr<const std::string> path_;  // statements point to it
};

/// BEGIN IMMEDIATE, and ROLLBACK unless it is committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  Transaction(Transaction&&) = delete;
  Transaction& operator=(Transaction&&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace gear3k::sweep
