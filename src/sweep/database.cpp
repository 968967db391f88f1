#include "sweep/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "io/text/diagnostics.hpp"

namespace gear3k::sweep {

namespace {

/// What an error of SQLite means to whoever runs a sweep.
std::string meaning_of(int extended, const char* told) {
  switch (extended & 0xFF) {
    case SQLITE_FULL:
      return "cannot be written: the disk, or what the file may grow to, is full; what was "
             "recorded "
             "is kept: allowed: make room, and run the same command again";
    case SQLITE_READONLY:
      return "cannot be written: it is read-only; nothing was changed: allowed: a copy that may be "
             "written";
    case SQLITE_CANTOPEN:
      return "cannot be opened: allowed: a file, and a folder in which files may be made beside it";
    case SQLITE_NOTADB:
      return "is no SQLite database; nothing was changed: allowed: a file that gear3k sweep made, "
             "or a new name";
    case SQLITE_CORRUPT:
      return "is damaged; nothing was changed: allowed: a copy from before, or what `sqlite3 FILE "
             "\".recover\"` finds in it";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return fmt::format("another process has held it for {} s: allowed: end that process, or wait",
                         Database::kBusySeconds);
    case SQLITE_AUTH:
      return "a statement that does more than read; nothing was changed: allowed: SELECT, WITH, "
             "VALUES, EXPLAIN, or a PRAGMA that only tells";
    case SQLITE_IOERR:
      return fmt::format("cannot be read or written ({}); what was recorded is kept", told);
    default:
      break;
  }
  const std::string_view text(told);
  // Not a column of a table, as SQL reads it.
  const bool is_key =
      text.starts_with("no such column") && text.find('.') != std::string_view::npos;
  return std::string(text) +
         (is_key ? ": allowed: a key in double quotes, as \"ratio.target\"" : "");
}

/// The code of the last error; a limit of the file's size, which is an error of writing to SQLite,
/// as that of a full disk; a refusal by allow_reading(), whose code some statements lose.
int code_of(sqlite3* database) {
  if (std::string_view(sqlite3_errmsg(database)) == "not authorized") return SQLITE_AUTH;
  const int code = sqlite3_extended_errcode(database);
  const int cause = sqlite3_system_errno(database);
  const bool full = cause == EFBIG || cause == ENOSPC || cause == EDQUOT;
  return (code & 0xFF) == SQLITE_IOERR && full ? SQLITE_FULL : code;
}

[[noreturn]] void refuse(sqlite3* database, const std::string& path) {
  throw io::InvalidInput(
      fmt::format("{}: {}", path,
                  database == nullptr ? "cannot be opened: out of memory"
                                      : meaning_of(code_of(database), sqlite3_errmsg(database))));
}

/// Whether nobody can write a file beside it, and all that was recorded is in the file: a log that
/// is not yet in it would be passed over.
bool is_still(const std::string& path) {
  namespace fs = std::filesystem;
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  std::error_code no_log;
  const auto log_size = fs::file_size(path + "-wal", no_log);
  return ::access(folder.c_str(), W_OK) != 0 && (no_log || log_size == 0);
}

/// The address of a file that does not change (SQLite, "Uniform Resource Identifiers"): it is read
/// without the files beside it that connections share.
std::string still_address(const std::string& path) {
  std::string address = "file:";
  for (const char c : path) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       std::string_view("/-._~").find(c) != std::string_view::npos;
    address += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return address + "?immutable=1";
}

/// Whether a PRAGMA only tells.
bool is_telling(const char* pragma, const char* argument) {
  const auto is_it = [pragma](const char* name) { return sqlite3_stricmp(pragma, name) == 0; };
  // Their argument is what is asked about.
  constexpr std::array kOfSomething{"table_info",  "table_xinfo",     "index_list",  "index_info",
                                    "index_xinfo", "integrity_check", "quick_check", "table_list"};
  constexpr std::array kOfAll{"application_id", "compile_options", "database_list",
                              "encoding",       "freelist_count",  "function_list",
                              "journal_mode",   "page_count",      "page_size",
                              "pragma_list",    "schema_version",  "user_version"};
  return std::ranges::any_of(kOfSomething, is_it) ||
         (argument == nullptr && std::ranges::any_of(kOfAll, is_it));
}

/// Lets statements read; a file opened for reading alone does not keep VACUUM INTO and ATTACH from
/// making others.
int allow_reading(void* /*nothing*/, int action, const char* first, const char* second,
                  const char* /*database*/, const char* /*view*/) {
  switch (action) {
    case SQLITE_SELECT:
    case SQLITE_READ:
    case SQLITE_FUNCTION:
    case SQLITE_RECURSIVE:
      return SQLITE_OK;
    case SQLITE_PRAGMA:
      return is_telling(first, second) ? SQLITE_OK : SQLITE_DENY;
    case SQLITE_UPDATE:
      // SQLite asks so when it declares the columns of pragma_table_info() or json_each(); of the
      // table itself nothing can be written, as the file is opened to read.
      return sqlite3_stricmp(first, "sqlite_master") == 0 ? SQLITE_OK : SQLITE_DENY;
    default:
      return SQLITE_DENY;
  }
}

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

}  // namespace

Statement::Statement(sqlite3* database, const std::string& path, std::string_view sql)
    : database_(database), path_(&path) {
  // SQLite reads up to there, and would never come to the end.
  if (sql.find('\0') != std::string_view::npos) {
    throw io::InvalidInput(fmt::format("{}: a zero byte in an SQL statement", path));
  }
  std::unique_ptr<sqlite3_stmt, Finalize> only;
  while (!sql.empty()) {
    sqlite3_stmt* next = nullptr;
    const char* rest = nullptr;
    if (sqlite3_prepare_v2(database, sql.data(), static_cast<int>(sql.size()), &next, &rest) !=
        SQLITE_OK) {
      refuse(database, path);
    }
    // Spaces, comments and a semicolon alone are none.
    std::unique_ptr<sqlite3_stmt, Finalize> found(next);
    if (found && only) {
      throw io::InvalidInput(fmt::format("{}: several SQL statements: allowed: one", path));
    }
    if (found) only = std::move(found);
    sql.remove_prefix(static_cast<std::size_t>(rest - sql.data()));
  }
  if (!only) {
    throw io::InvalidInput(
        fmt::format("{}: no SQL statement: allowed: one, as \"SELECT * FROM result\"", path));
  }
  statement_ = only.release();
}

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_),
      path_(other.path_),
      statement_(std::exchange(other.statement_, nullptr)) {}

Statement::~Statement() { sqlite3_finalize(statement_); }

void Statement::reset() { sqlite3_reset(statement_); }

void Statement::bind(int place, const SqlValue& value) {
  int result = SQLITE_OK;
  if (std::holds_alternative<std::nullptr_t>(value)) {
    result = sqlite3_bind_null(statement_, place);
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    result = sqlite3_bind_int64(statement_, place, *integer);
  } else if (const auto* number = std::get_if<double>(&value)) {
    result = sqlite3_bind_double(statement_, place, *number);
  } else {
    const auto& text = std::get<std::string>(value);
    result = sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()),
                               SQLITE_TRANSIENT);
  }
  if (result != SQLITE_OK) refuse(database_, *path_);
}

bool Statement::step() {
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  refuse(database_, *path_);
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

int Statement::columns() const { return sqlite3_column_count(statement_); }

std::string Statement::name(int column) const {
  const char* name = sqlite3_column_name(statement_, column);
  return name == nullptr ? "" : name;
}

SqlValue Statement::value(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
    case SQLITE_NULL:
      return nullptr;
    case SQLITE_INTEGER:
      return integer(column);
    case SQLITE_FLOAT:
      return number(column);
    default:
      return text(column);
  }
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Statement::number(int column) const { return sqlite3_column_double(statement_, column); }

std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_, column);
  if (text == nullptr) return "";
  const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the library's own type of a text
  return {reinterpret_cast<const char*>(text), bytes};
}

Database::Database(std::string path, Access access)
    : path_(std::make_unique<const std::string>(std::move(path))) {
  int flags = SQLITE_OPEN_READONLY;
  if (access == Access::kWrite) flags = SQLITE_OPEN_READWRITE;
  if (access == Access::kCreate) flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  const bool still = access == Access::kRead && is_still(*path_);
  const std::string address = still ? still_address(*path_) : *path_;
  if (still) flags |= SQLITE_OPEN_URI;
  try {
    if (sqlite3_open_v2(address.c_str(), &database_, flags, nullptr) != SQLITE_OK) {
      refuse(database_, *path_);
    }
    sqlite3_extended_result_codes(database_, 1);
    constexpr int kMilliseconds = 1000;
    sqlite3_busy_timeout(database_, kBusySeconds * kMilliseconds);
    if (access != Access::kRead && sqlite3_db_readonly(database_, "main") == 1) {
      throw io::InvalidInput(fmt::format("{}: {}", *path_, meaning_of(SQLITE_READONLY, "")));
    }
    if (access == Access::kRead) {
      sqlite3_set_authorizer(database_, allow_reading, nullptr);
      // A key in double quotes that there is not would be a text, the same in every row.
      sqlite3_db_config(database_, SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
    }
  } catch (...) {
    sqlite3_close_v2(database_);
    throw;
  }
}

Database::Database(Database&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)), path_(std::move(other.path_)) {}

Database::~Database() { sqlite3_close_v2(database_); }

void Database::execute(const std::string& sql) {
  if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    refuse(database_, *path_);
  }
}

Statement Database::prepare(std::string_view sql) const { return {database_, *path_, sql}; }

SqlValue Database::one(std::string_view sql) const {
  Statement statement = prepare(sql);
  return statement.step() ? statement.value(0) : SqlValue(nullptr);
}

std::int64_t Database::count(std::string_view sql) const {
  Statement statement = prepare(sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::int64_t Database::changes() const { return sqlite3_changes64(database_); }

std::int64_t Database::last_id() const { return sqlite3_last_insert_rowid(database_); }

Transaction::Transaction(Database& database) : database_(database) {
  database_.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const io::InvalidInput&) {
    // What broke the transaction has ended it already.
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace gear3k::sweep
