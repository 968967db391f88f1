#pragma once
// The commands behind main(): each takes its options, prints, and returns an exit code.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/model.hpp"
#include "cli/command_tree.hpp"
#include "cli/exit_code.hpp"
#include "report/table_choice.hpp"
#include "sweep/atlas.hpp"
#include "sweep/store.hpp"

namespace gear3k::cli {

enum class Format { kTable, kJson, kCsv };
/// Names on the command line, in the order of the enum.
inline constexpr std::array<std::string_view, 3> kFormatNames{"table", "json", "csv"};

/// What every command takes.
struct CommonOptions {
  Format format = Format::kTable;
  std::string out;  ///< file (or, for optimize, folder); "" = stdout
  bool quiet = false;
  int threads = 0;  ///< 0 = all processors
};

/// Columns of a screen, as asked for or those of the terminal; empty into a file.
std::optional<int> known_columns(int asked);
inline constexpr int kUsualColumns = 100;

/// Which part of a result's table is printed.
struct ShowOptions {
  std::vector<std::string> show;  ///< names of sections
  bool full = false;
  int columns = 0;  ///< of the first screen; 0: those of the terminal, or 100
};
/// Names of sections were checked with the options.
report::TableChoice table_choice(const ShowOptions& options);
/// Checks that a first screen lists.
inline constexpr std::size_t kTightestShown = 6;
/// Of the further lines of one that is broken.
inline constexpr std::size_t kBrokenIndent = 4;

struct AnalyzeOptions : CommonOptions {
  ShowOptions show;
  std::string file;
  std::string model;    ///< MODEL.toml of `analyze`; "" = none
  std::string figures;  ///< folder of `analyze`; "" = none
  bool strict = false;  ///< a failed check ends with kNoFeasibleDesign
};

struct CompareOptions : CommonOptions {
  int columns = 0;                 ///< of the table; 0: those of the terminal, or 100
  std::vector<std::string> files;  ///< two or more designs
};

struct SearchOptions : CommonOptions {
  std::string file;
  int top = 20;  ///< rows of the table
};

struct OptimizeOptions : CommonOptions {
  ShowOptions show;
  std::string file;
  std::string model;            ///< MODEL.toml; "" = none
  bool certify = false;         ///< refine only what can still win, and prove that nothing else can
  bool round = false;           ///< the best design of what is made, too
  bool resume = false;          ///< go on with the journal of an interrupted run
  bool force = false;           ///< replace the result of an earlier run
  double front_budget_s = 0.0;  ///< for the search of a front; 0: as long as it takes
};

struct ReproduceOptions : CommonOptions {
  std::string figures;  ///< folder; "" = none
};

struct MapOptions : CommonOptions {  ///< out: a folder; "" = none
  std::string file;
  std::string model;  ///< MODEL.toml; "" = none
};

/// A limit of the next experiment; an end that is not stated follows from the data.
struct ConditionLimit {
  std::optional<double> least{}, greatest{};
};

struct DiagnoseOptions : CommonOptions {  ///< out: a folder; "" = none
  std::string file;                       ///< DESIGN, PAIR or a black box
  std::vector<std::string> data;
  std::string model;  ///< MODEL.toml; "" = none
  double false_discovery_rate = 0.05;
  std::uint64_t seed = 1;
  std::vector<std::string> stated;  ///< options that were given, with --
  ConditionLimit sun_speed_rpm, output_torque_nm, test_torque_nm, temperature_c;
};

struct TolerancesOptions : CommonOptions {  ///< out: a folder; "" = none
  std::string file;
  std::optional<std::int64_t> samples;  ///< instead of tolerances.samples
  std::optional<std::uint64_t> seed;    ///< instead of tolerances.seed
};

/// Bounds of --chord-error-um: below, coordinates are rounded as coarsely; above, teeth lose shape.
inline constexpr double kLeastChordErrorUm = 0.01, kGreatestChordErrorUm = 100.0;

struct ExportOptions : CommonOptions {
  std::string file;
  std::string dxf_folder, svg_folder, sheet_folder;  ///< "" = none; at least one is given
  double chord_error_um = 1.0;
};

struct ActuatorOptions : CommonOptions {  ///< out: a file, with select a folder
  std::string file;
  std::string cycle;  ///< CYCLE.csv; "" = none
  bool without_each = false;
  bool strict = false;    ///< a failed check ends with kNoFeasibleDesign
  std::string impedance;  ///< "LO:HI:N" [Hz]; "" = none
  double amplitude_rad = 0.0;
  std::string motor = "open";  ///< terminals during --impedance
  std::string figures;         ///< folder; "" = none
  std::string select;          ///< SPEC.toml of a selection; "" = none
};

struct SimulateOptions : CommonOptions {  ///< out: a folder; "" = none
  std::string actuator, scenario;
};

struct KeysOptions : CommonOptions {
  std::string word;  ///< what a printed row holds; "" = all rows
};

struct NewOptions : CommonOptions {
  std::string kind;  ///< one of io::first_files()
};

struct ManualOptions : CommonOptions {  ///< out: a folder; "" = none
  std::string page;                     ///< its name or that of its command; "" = gear3k
};

struct SweepOptions : CommonOptions {  ///< out: the database
  std::string file;
  int workers = 1;
  sweep::Shard shard;
  std::optional<double> most_s;  ///< ends after so long
  bool yes = false;              ///< any number of tasks
};
/// What a text i/n names; empty where that is none.
std::optional<sweep::Shard> shard_of(std::string_view text);
/// Seconds of a text as 10h, 30m or 45s; empty where it is none.
std::optional<double> duration_s(std::string_view text);

/// What is asked of a sweep's database.
struct SweepQuestion : CommonOptions {
  std::string database;
  std::optional<std::int64_t> run;  ///< whose tasks; empty = all
  std::vector<std::string> by;
  std::string most, least;  ///< both "": the objective of the tasks
  std::string x, y;         ///< of a figure
  std::string sql;
  std::string since;    ///< revision or date of a comparison
  bool strict = false;  ///< ends with kNoFeasibleDesign where anything is worse
};

struct AtlasOptions : CommonOptions {
  sweep::AtlasQuestion question;
  std::string task;     ///< file of a SPEC; "" = none
  std::string figures;  ///< folder; "" = none
};

struct SweepMergeOptions : CommonOptions {  ///< out: the database that takes them
  std::vector<std::string> databases;
};

ExitCode run_sweep(const SweepOptions& options);
ExitCode run_atlas(const AtlasOptions& options);
ExitCode run_sweep_merge(const SweepMergeOptions& options);
ExitCode run_sweep_status(const SweepQuestion& question);
ExitCode run_sweep_best(const SweepQuestion& question);
ExitCode run_sweep_query(const SweepQuestion& question);
ExitCode run_sweep_compare(const SweepQuestion& question);
ExitCode run_sweep_figure(const SweepQuestion& question);
ExitCode run_analyze(const AnalyzeOptions& options);
ExitCode run_mesh(const AnalyzeOptions& options);
ExitCode run_compare(const CompareOptions& options);
ExitCode run_search(const SearchOptions& options);
ExitCode run_optimize(const OptimizeOptions& options);
ExitCode run_reproduce(const ReproduceOptions& options);
ExitCode run_map(const MapOptions& options);
ExitCode run_diagnose(const DiagnoseOptions& options);
/// The same of logs of kind `dynamic`, of an ACTUATOR.
ExitCode run_diagnose_motion(const DiagnoseOptions& options);
ExitCode run_tolerances(const TolerancesOptions& options);
ExitCode run_export(const ExportOptions& options);
ExitCode run_actuator(const ActuatorOptions& options);
/// What is wrong with a value of --impedance; "" when nothing is.
std::string impedance_error(std::string_view value);
ExitCode run_simulate(const SimulateOptions& options);
/// Prints docs/keys.md: every key of DESIGN, PAIR and SPEC files, or those that hold a word.
ExitCode run_keys(const KeysOptions& options);
/// What `gear3k keys` prints.
std::string keys_document();
/// Prints a first file of a kind, with comments.
ExitCode run_new(const NewOptions& options);
/// Prints a page of the manual, or writes all of them.
ExitCode run_manual(const ManualOptions& options, const CommandTree& gear3k);
/// The words that name its pages.
std::vector<std::string> manual_page_words(const CommandTree& gear3k);
/// Prints the completion of bash.
ExitCode run_completion(const CommonOptions& options, CommandTree gear3k);
/// Whether a document that has one form only was asked for in another; it is then said.
/// @param form  what the document is
bool other_form(const CommonOptions& options, std::string_view command, std::string_view form);

/// Prints a result to stdout.
/// @throws io::InvalidInput when stdout cannot be written
void print_result(const std::string& text);

/// Prints a result to stdout, or writes it to options.out.
void deliver(const CommonOptions& options, const std::string& text);
/// The same for a text that is made piece by piece.
/// @param produce  called once with the function that takes the pieces
void deliver_in_pieces(
    const CommonOptions& options,
    const std::function<void(const std::function<void(std::string_view)>&)>& produce);

/// Notes on the use of a model on stderr, unless quiet.
void warn(const app::Notes& notes, bool quiet);

/// Runs OpenMP regions with the number of threads asked for.  @returns that number
int use_threads(const CommonOptions& options);

}  // namespace gear3k::cli
