#pragma once
// What is asked of a sweep's database.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sweep/rows.hpp"

namespace gear3k::sweep {

/// A row for every run, the last first: its number, what it asked for and what became of it.
/// @param run  its uid, for one of them; "" = all
Rows status_of(const Database& database, const std::string& run = "");

/// A column that results are asked by: the name of a key (`ratio.target`, `planets`), of a column
/// of refined.csv (`eta_b`), of a task (`merit`, `bound`, `sets`, `status`), or a part of one
/// between dots and underscores (`ratio`, `outer_diameter`).
struct Column {
  std::string name;  ///< whole
  std::string sql;   ///< of task t and its best design d
};
/// What a name is asked for: of several that it may be, which goes first.
enum class Role {
  kCondition,  ///< keys that a run varied go before columns, these before other keys
  kResult      ///< columns go before keys
};
/// @throws io::InvalidInput for one that there is not, or that may be several
Column column_of(const Database& database, const std::string& name, Role role);

/// Of whose tasks a question is asked.
struct AskedTasks {
  /// Number of a run, for its tasks; without it those of all runs, of the newest revision of each.
  std::optional<std::int64_t> run = {};
};

struct BestQuestion {
  AskedTasks tasks = {};
  std::vector<std::string> by;  ///< a row for each of their values; one that comes again is none
  std::string of = {};          ///< what is best; "" = ranking_of() the tasks
  bool least = false;           ///< instead of most
};
/// What designs are ranked by where a question does not say it.
struct Ranking {
  std::string of;  ///< column
  std::string
      text;  ///< a line of why, and how another is asked for; "" for eta_b of tasks that want it
};
/// The objective of the tasks: eta_b or eta_f, any other as `merit`, as are several of which each
/// row has one (by the key objective); eta_b where the objectives in a row may differ.
Ranking ranking_of(const Database& database, const AskedTasks& tasks,
                   const std::vector<std::string>& by);
/// The best design for every value of the columns; without a design the row has its status.  Of
/// values that agree to nine digits that of the greater objective is best.  Keys that the tasks of
/// the rows differ in, and that are not asked by, come last.
/// @throws io::InvalidInput where there are designs, and none has a value of what is best; for a
/// run that there is not
Rows best_of(const Database& database, const BestQuestion& question);

/// Says that the tasks asked of are those of several questions: of which keys that no run varies
/// they have different values, and that files which they name have changed; "" where of none.
/// @param shown  names of keys that the answer tells
std::string pooled_text(const Database& database, const AskedTasks& tasks,
                        const std::vector<std::string>& shown);

/// The rows of a statement that only reads.
/// @param database  opened to read
/// @throws io::InvalidInput for one that is wrong or would write, for several
Rows answer_to(const Database& database, const std::string& sql);

/// What is drawn: a line for each value of `by`.
struct MapQuestion {
  AskedTasks tasks = {};
  std::string x, y;
  std::string by;  ///< "" = one line
};
struct Map {
  std::string title, x, y, by;
  struct Line {
    std::string name;
    std::vector<std::pair<double, double>> points;  ///< by rising x
  };
  std::vector<Line> lines;
};
/// @throws io::InvalidInput where there is nothing to draw
Map map_of(const Database& database, const MapQuestion& question);

}  // namespace gear3k::sweep
