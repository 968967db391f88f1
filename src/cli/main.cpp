#include <fmt/format.h>
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <sstream>

#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/common_options.hpp"
#include "cli/sweep_options.hpp"
#include "cli/talk.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/first_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/files/selection_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/version.hpp"
#include "units/units.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): the program's own namespace
using cli::add_common_options, cli::add_out_file, cli::keys_of;

void add_model_option(CLI::App& command, std::string& model) {
  command
      .add_option("--model", model,
                  "MODEL.toml of diagnose: what measurements add to the simulation")
      ->option_text("MODEL");
}

/// Options of `export`; its callback runs after all were read.
void add_export_options(CLI::App& command, cli::ExportOptions& options) {
  command.add_option("DESIGN", options.file, "DESIGN.toml; for --sheet also PAIR.toml")->required();
  command.add_option("--dxf", options.dxf_folder, "folder for DXF files; made when missing")
      ->option_text("DIR");
  command.add_option("--svg", options.svg_folder, "folder for SVG files; made when missing")
      ->option_text("DIR");
  command
      .add_option("--sheet", options.sheet_folder,
                  "folder for inspection sheets (CSV and pages); made when missing")
      ->option_text("DIR");
  command
      .add_option("--chord-error-um", options.chord_error_um,
                  fmt::format("greatest distance of a drawn chord from the contour, {} to {} um",
                              cli::kLeastChordErrorUm, cli::kGreatestChordErrorUm))
      ->option_text("UM [1]");
  add_common_options(command, options);
  command.footer([] {
    return "At least one of --dxf, --svg and --sheet is needed.  Each folder of drawings gets S, "
           "P1, R1, P2, R2\n(one gear each, tooth 0 on the +x axis), train (all of them in mesh, "
           "backlash centred) and\nassembly (a section with dimensions), one of sheets every gear "
           "and the compound planet; files of\nthese names are replaced, all of them or none.  "
           "Planets that cannot be equally spaced: the train\nshows planet 1 alone.  A design that "
           "fails checks is drawn all the same; stderr names them.\n\n" +
           keys_of("DESIGN.toml");
  });
}

/// What is wrong with the options of `export` together; "" when nothing is.
std::string export_usage_error(const cli::ExportOptions& options) {
  std::string text;
  if (options.dxf_folder.empty() && options.svg_folder.empty() && options.sheet_folder.empty()) {
    text = "--dxf DIR, --svg DIR, --sheet DIR: none is given, allowed: one or more";
  }
  const double um = options.chord_error_um;
  if (!(um >= cli::kLeastChordErrorUm && um <= cli::kGreatestChordErrorUm)) {
    text +=
        fmt::format("{}--chord-error-um = {:g} um: allowed: {} to {} um", text.empty() ? "" : "\n",
                    um, cli::kLeastChordErrorUm, cli::kGreatestChordErrorUm);
  }
  return text;
}

struct LimitOption {
  const char* name;  ///< of the quantity with its unit, as in the options
  const char* text;
  cli::ConditionLimit cli::DiagnoseOptions::*limit;
  double least;  ///< of what may be stated
};
constexpr std::array<LimitOption, 4> kLimitOptions{
    {{.name = "sun-speed-rpm",
      .text = "sun speed of the next experiment",
      .limit = &cli::DiagnoseOptions::sun_speed_rpm,
      .least = 0.0},
     {.name = "output-torque-nm",
      .text = "output torque of the next experiment",
      .limit = &cli::DiagnoseOptions::output_torque_nm,
      .least = 0.0},
     {.name = "test-torque-nm",
      .text = "test torque of the next experiment (lost motion)",
      .limit = &cli::DiagnoseOptions::test_torque_nm,
      .least = 0.0},
     {.name = "temperature-c",
      .text = "temperature of the next experiment",
      .limit = &cli::DiagnoseOptions::temperature_c,
      .least = units::kAbsoluteZero_c}}};

/// A seed from its decimal digits.
std::uint64_t seed_of(const std::string& text) {
  std::uint64_t seed = 0;
  const char* last = text.data() + text.size();
  const auto read = std::from_chars(text.data(), last, seed);
  if (read.ec == std::errc() && read.ptr == last) return seed;
  throw CLI::ValidationError(fmt::format("--seed = {}: allowed: a whole number, 0 to {}", text,
                                         std::numeric_limits<std::uint64_t>::max()),
                             CLI::ExitCodes::ValidationError);
}

/// What of a result's table is printed.
void add_columns(CLI::App& command, int& columns, int least, const char* help) {
  command.add_option("--columns", columns, help)->check(cli::within(least, 500))->option_text("N");
}

void add_show_options(CLI::App& command, cli::ShowOptions& options,
                      const std::vector<std::string>& never = {}) {
  std::vector<std::string> parts(report::kSectionNames.begin(), report::kSectionNames.end());
  std::erase_if(parts, [&](const std::string& part) {
    return std::ranges::find(never, part) != never.end();
  });
  command
      .add_option("--show", options.show,
                  fmt::format("parts of the table after the first screen, by commas: {}",
                              fmt::join(parts, ", ")))
      ->delimiter(',')
      ->check(cli::one_of("part", parts))
      ->option_text("PART,...");
  command.add_flag("--full", options.full, "the whole table");
  add_columns(command, options.columns, 60, "of the first screen; 100 into a file");
}

/// Options of `diagnose`; its callback runs after all were read.
void add_diagnose_options(CLI::App& command, cli::DiagnoseOptions& options) {
  command
      .add_option("SUBJECT", options.file,
                  "DESIGN.toml, PAIR.toml, a table [gearbox], or ACTUATOR.toml for logs")
      ->required();
  command
      .add_option("DATA", options.data,
                  "CSV files, of several kinds together too; columns: docs/interface.md")
      ->required();
  command
      .add_option("--out", options.out,
                  "folder for result files and figures (by gnuplot); made when missing")
      ->option_text("DIR");
  add_model_option(command, options.model);
  command
      .add_option("--false-discovery-rate", options.false_discovery_rate,
                  "probability of a finding where nothing is wrong, up to 0.5 [0.05]")
      ->check(cli::number_that([](double rate) { return rate > 0.0 && rate <= 0.5; },
                               "a number above 0, up to 0.5"))
      ->option_text("P");
  command
      .add_option_function<std::string>(
          "--seed", [&options](const std::string& text) { options.seed = seed_of(text); },
          "of subsamples and of random signs")
      ->option_text("SEED [1]");
  for (const LimitOption& limit : kLimitOptions) {
    const auto check = cli::number_that(
        [least = limit.least](double end) { return std::isfinite(end) && end >= least; },
        fmt::format("a finite number, {:g} or more", limit.least));
    command
        .add_option(fmt::format("--min-{}", limit.name), (options.*limit.limit).least,
                    fmt::format("least {}", limit.text))
        ->check(check)
        ->option_text("MIN");
    command
        .add_option(fmt::format("--max-{}", limit.name), (options.*limit.limit).greatest,
                    fmt::format("greatest {}", limit.text))
        ->check(check)
        ->option_text("MAX");
  }
  add_common_options(command, options);
}

/// What is wrong with the options of `diagnose` together; "" when nothing is.
std::string diagnose_usage_error(const cli::DiagnoseOptions& options) {
  std::vector<std::string> errors;
  for (const LimitOption& limit : kLimitOptions) {
    const auto& [least, greatest] = options.*limit.limit;
    if (least && greatest && *least > *greatest) {
      errors.push_back(fmt::format("--min-{0} = {1:g}, --max-{0} = {2:g}: allowed: min <= max",
                                   limit.name, *least, *greatest));
    }
  }
  return fmt::format("{}", fmt::join(errors, "\n"));
}

/// Options of `actuator`; its callback runs after all were read.
void add_actuator_options(CLI::App& command, cli::ActuatorOptions& options) {
  command.add_option("ACTUATOR", options.file, "ACTUATOR.toml; not with --select");
  command
      .add_option("--cycle", options.cycle,
                  "CYCLE.csv: time_s, torque_nm, and speed_rad_s or angle_rad")
      ->option_text("CYCLE");
  command.add_flag("--without-each", options.without_each,
                   "what the cycle costs without each cause of loss");
  command.add_flag("--strict", options.strict, "exit with 3 when a limit is exceeded");
  command
      .add_option("--impedance", options.impedance,
                  "what the output feels like at N frequencies from LO to HI in Hz")
      ->option_text("LO:HI:N");
  command
      .add_option("--amplitude", options.amplitude_rad,
                  "of the output in --impedance, for the first harmonic with losses")
      ->check(cli::within(0.0, 1e6))
      ->option_text("RAD");
  command
      .add_option("--motor", options.motor, "of the motor in --impedance: open, shorted or locked")
      ->check(cli::one_of("terminals", {"open", "shorted", "locked"}))
      ->option_text("TERMINALS");
  command
      .add_option("--figures", options.figures,
                  "folder for figures (by gnuplot) and their CSV; made when missing")
      ->option_text("DIR");
  command
      .add_option("--select", options.select,
                  "SPEC.toml of motors, gearboxes, cycles: the Pareto front of all pairs")
      ->option_text("SPEC");
  add_common_options(command, options, true);
  command
      .add_option("--out", options.out,
                  "file for the result, instead of stdout; with --select the folder for "
                  "selection.csv, pareto.csv and summary.json, made when missing")
      ->option_text("FILE | DIR");
  command.footer(keys_of("ACTUATOR.toml and SPEC.toml"));
}

/// What is wrong with the options of `actuator` together; "" when nothing is.
std::string actuator_usage_error(const CLI::App& command, const cli::ActuatorOptions& options) {
  std::vector<std::string> errors;
  const bool select = !options.select.empty();
  if (select == !options.file.empty()) {
    errors.emplace_back("actuator: allowed: ACTUATOR, or --select SPEC --out DIR");
  }
  if (select && options.out.empty()) errors.emplace_back("--select: allowed: with --out DIR");
  if (select && (!options.cycle.empty() || !options.figures.empty() || !options.impedance.empty() ||
                 options.without_each || options.strict)) {
    errors.emplace_back(
        "--cycle, --without-each, --impedance, --figures, --strict: allowed: without --select");
  }
  if (options.without_each && options.cycle.empty() && !select) {
    errors.emplace_back("--without-each: allowed: with --cycle CYCLE");
  }
  if (options.amplitude_rad > 0.0 && options.impedance.empty()) {
    errors.emplace_back("--amplitude: allowed: with --impedance LO:HI:N");
  }
  if (options.impedance.empty() && command.count("--motor") > 0) {
    errors.emplace_back("--motor: allowed: with --impedance LO:HI:N");
  }
  if (!options.impedance.empty()) {
    const std::string slip = cli::impedance_error(options.impedance);
    if (!slip.empty()) errors.push_back(slip);
  }
  if (options.format == cli::Format::kCsv && options.cycle.empty() && options.impedance.empty() &&
      !select) {
    errors.emplace_back("--format csv: allowed: with --cycle, --impedance or --select");
  }
  return fmt::format("{}", fmt::join(errors, "\n"));
}

/// Options of every command, and what runs: a command is called after all arguments were accepted.
struct Commands {
  cli::AnalyzeOptions analyze;
  cli::AnalyzeOptions mesh;
  cli::CompareOptions compare;
  cli::SearchOptions search;
  cli::OptimizeOptions optimize;
  cli::ExportOptions drawings;
  cli::MapOptions map;
  cli::TolerancesOptions tolerances;
  cli::DiagnoseOptions diagnose;
  cli::ReproduceOptions reproduce;
  cli::ActuatorOptions actuator;
  cli::SimulateOptions simulate;
  cli::AtlasOptions atlas;
  cli::SweepCommands sweep;
  cli::KeysOptions keys;
  cli::NewOptions first;
  cli::ManualOptions manual;
  cli::CommonOptions completion;
  std::function<cli::ExitCode()> run;
};

/// One gearbox or pair, and several beside each other.
void add_gearbox_commands(CLI::App& app, Commands& c) {
  CLI::App* analyze_command = app.add_subcommand("analyze", "everything known about one gearbox");
  analyze_command->add_option("DESIGN", c.analyze.file, "DESIGN.toml")->required();
  analyze_command->add_flag("--strict", c.analyze.strict, "exit with 3 when a check fails");
  add_model_option(*analyze_command, c.analyze.model);
  add_show_options(*analyze_command, c.analyze.show);
  add_common_options(*analyze_command, c.analyze);
  add_out_file(*analyze_command, c.analyze);
  analyze_command
      ->add_option("--figures", c.analyze.figures,
                   "folder for torque_angle.csv and its figure, of a design with [strength]; made "
                   "when missing; figures need gnuplot")
      ->option_text("DIR");
  analyze_command->footer(keys_of("DESIGN.toml"));
  analyze_command->callback([&c] { c.run = [&c] { return cli::run_analyze(c.analyze); }; });

  CLI::App* mesh_command = app.add_subcommand("mesh", "one external or internal pair of gears");
  mesh_command->add_option("PAIR", c.mesh.file, "PAIR.toml")->required();
  mesh_command->add_flag("--strict", c.mesh.strict, "exit with 3 when a check fails");
  add_show_options(*mesh_command, c.mesh.show, {"masses", "sensitivities"});
  add_common_options(*mesh_command, c.mesh);
  add_out_file(*mesh_command, c.mesh);
  mesh_command->footer(keys_of("PAIR.toml"));
  mesh_command->callback([&c] { c.run = [&c] { return cli::run_mesh(c.mesh); }; });

  CLI::App* compare_command =
      app.add_subcommand("compare", "designs side by side: what differs, and by how much");
  constexpr int kMostCompared = 32;
  compare_command->add_option("DESIGN", c.compare.files, "DESIGN.toml, two or more")
      ->required()
      ->expected(2, kMostCompared)
      ->option_text(fmt::format("2 to {} files", kMostCompared));
  add_common_options(*compare_command, c.compare);
  add_out_file(*compare_command, c.compare);
  add_columns(*compare_command, c.compare.columns, 80, "of the table; 100 into a file");
  compare_command->callback([&c] { c.run = [&c] { return cli::run_compare(c.compare); }; });
}

/// From a task to a gearbox.
void add_task_commands(CLI::App& app, Commands& c) {
  CLI::App* search_command =
      app.add_subcommand("search", "the tooth sets that fit a ratio, ranked at zero profile shift");
  search_command->add_option("SPEC", c.search.file, "SPEC.toml")->required();
  search_command->add_option("--top", c.search.top, "rows of the table")
      ->check(cli::within(1, 1'000'000))
      ->capture_default_str();
  add_common_options(*search_command, c.search);
  add_out_file(*search_command, c.search);
  search_command->footer(keys_of("SPEC.toml"));
  search_command->callback([&c] { c.run = [&c] { return cli::run_search(c.search); }; });

  CLI::App* optimize_command =
      app.add_subcommand("optimize", "search, refine every tooth set, write the best design");
  optimize_command->add_option("SPEC", c.optimize.file, "SPEC.toml")->required();
  add_show_options(*optimize_command, c.optimize.show);
  optimize_command->add_option("--out", c.optimize.out, "folder for the result files")->required();
  optimize_command->add_flag(
      "--certify", c.optimize.certify,
      "refine only sets whose bound reaches the best, and prove none better");
  optimize_command->add_flag("--round", c.optimize.round,
                             "write it rounded to the steps of [round] too, as best_rounded.toml");
  optimize_command
      ->add_option("--front-budget", c.optimize.front_budget_s,
                   "after which the front of a list of objectives is left as it is")
      ->check(cli::within(0.001, 1e7))
      ->option_text("SECONDS");
  CLI::Option* resume = optimize_command->add_flag(
      "--resume", c.optimize.resume, "go on with the run in --out that was interrupted or killed");
  optimize_command
      ->add_flag("--force", c.optimize.force, "replace the result of an earlier run in --out")
      ->excludes(resume);
  add_model_option(*optimize_command, c.optimize.model);
  add_common_options(*optimize_command, c.optimize);
  optimize_command->footer(keys_of("SPEC.toml"));
  optimize_command->callback([&c] { c.run = [&c] { return cli::run_optimize(c.optimize); }; });
}

/// What becomes of a drawn gearbox.
void add_drawn_commands(CLI::App& app, Commands& c) {
  CLI::App* export_command = app.add_subcommand(
      "export", "tooth outlines and the assembled train as DXF and SVG drawings");
  add_export_options(*export_command, c.drawings);
  export_command->callback([&c] {
    if (const std::string error = export_usage_error(c.drawings); !error.empty()) {
      throw CLI::ValidationError(error, CLI::ExitCodes::ValidationError);
    }
    c.run = [&c] { return cli::run_export(c.drawings); };
  });

  CLI::App* map_command = app.add_subcommand(
      "map", "efficiency over speed and load in both directions, no-load and breakaway torque");
  map_command->add_option("DESIGN", c.map.file, "DESIGN.toml")->required();
  map_command
      ->add_option("--out", c.map.out,
                   "folder for map.csv, map.json and figures; made when missing; figures need "
                   "gnuplot")
      ->option_text("DIR");
  add_model_option(*map_command, c.map.model);
  add_common_options(*map_command, c.map);
  map_command->footer(keys_of("DESIGN.toml"));
  map_command->callback([&c] { c.run = [&c] { return cli::run_map(c.map); }; });

  CLI::App* tolerances_command = app.add_subcommand(
      "tolerances", "what gearboxes built within their tolerances will do: yield, jamming, spread");
  tolerances_command->add_option("DESIGN", c.tolerances.file, "DESIGN.toml with [tolerances]")
      ->required();
  tolerances_command
      ->add_option("--out", c.tolerances.out,
                   "folder for tolerances.json, lost_motion.csv, tolerances.csv, turn.csv, "
                   "turn_orders.csv and figures; made when missing; figures need gnuplot")
      ->option_text("DIR");
  tolerances_command
      ->add_option("--samples", c.tolerances.samples, "gearboxes, instead of tolerances.samples")
      ->check(cli::within(1000, 1'000'000'000))
      ->option_text("N");
  tolerances_command
      ->add_option("--seed", c.tolerances.seed,
                   "of the random gearboxes, instead of tolerances.seed")
      ->check(cli::within(std::int64_t{0}, std::int64_t{9'000'000'000'000'000}))
      ->option_text("N");
  add_common_options(*tolerances_command, c.tolerances);
  tolerances_command->footer(keys_of("DESIGN.toml"));
  tolerances_command->callback(
      [&c] { c.run = [&c] { return cli::run_tolerances(c.tolerances); }; });
}

/// Beside measurements.
void add_measured_commands(CLI::App& app, Commands& c) {
  CLI::App* diagnose_command = app.add_subcommand(
      "diagnose", "what the simulation gets wrong on measurements, why, and what to measure next");
  add_diagnose_options(*diagnose_command, c.diagnose);
  diagnose_command->callback([&c, diagnose_command] {
    for (const CLI::Option* option : diagnose_command->get_options()) {
      if (option->count() > 0) c.diagnose.stated.push_back(option->get_name());
    }
    if (const std::string error = diagnose_usage_error(c.diagnose); !error.empty()) {
      throw CLI::ValidationError(error, CLI::ExitCodes::ValidationError);
    }
    c.run = [&c] { return cli::run_diagnose(c.diagnose); };
  });

  CLI::App* reproduce_command = app.add_subcommand(
      "reproduce", "published gearboxes and actuators: paper, its equations, measurement; errata");
  reproduce_command
      ->add_option("--figures", c.reproduce.figures,
                   "folder for the papers' figures from our own models, CSV and "
                   "figures; made when missing; figures need gnuplot")
      ->option_text("DIR");
  add_common_options(*reproduce_command, c.reproduce);
  add_out_file(*reproduce_command, c.reproduce);
  reproduce_command->callback([&c] { c.run = [&c] { return cli::run_reproduce(c.reproduce); }; });
}

/// With a motor.
void add_actuator_commands(CLI::App& app, Commands& c) {
  CLI::App* actuator_command = app.add_subcommand(
      "actuator", "motor, gearbox and load: what the output feels, what a duty cycle costs");
  add_actuator_options(*actuator_command, c.actuator);
  actuator_command->callback([&c, actuator_command] {
    if (const std::string error = actuator_usage_error(*actuator_command, c.actuator);
        !error.empty()) {
      throw CLI::ValidationError(error, CLI::ExitCodes::ValidationError);
    }
    c.run = [&c] { return cli::run_actuator(c.actuator); };
  });

  CLI::App* simulate_command = app.add_subcommand(
      "simulate", "an actuator moved forward in time: modes, events, where its energy goes");
  simulate_command->add_option("ACTUATOR", c.simulate.actuator, "ACTUATOR.toml")->required();
  simulate_command->add_option("SCENARIO", c.simulate.scenario, "SCENARIO.toml")->required();
  add_common_options(*simulate_command, c.simulate);
  simulate_command
      ->add_option("--out", c.simulate.out,
                   "folder for motion.csv, events.csv, ledger.json and motion.svg; made when "
                   "missing; the figure needs gnuplot")
      ->option_text("DIR");
  simulate_command->footer(keys_of("SCENARIO.toml"));
  simulate_command->callback([&c] { c.run = [&c] { return cli::run_simulate(c.simulate); }; });
}

/// Many tasks at once.
void add_many_task_commands(CLI::App& app, Commands& c) {
  cli::add_atlas_options(
      *app.add_subcommand("atlas",
                          "what 3K gearboxes of one size can do: a start for one's own task"),
      c.atlas, c.run);

  add_sweep_commands(
      *app.add_subcommand(
          "sweep", "many tasks, kept in a database: what varies, what is best, what changed"),
      c.sweep, c.run);
}

/// What files hold and how commands are called.
void add_help_commands(CLI::App& app, Commands& c) {
  CLI::App* keys_command =
      app.add_subcommand("keys", "every key of the input files, as a Markdown document");
  keys_command->add_option("WORD", c.keys.word, "only keys whose path or meaning holds this word");
  add_common_options(*keys_command, c.keys);
  add_out_file(*keys_command, c.keys);
  keys_command->callback([&c] { c.run = [&c] { return cli::run_keys(c.keys); }; });

  CLI::App* new_command =
      app.add_subcommand("new",
                         "a first file to change: a task, one design, one pair, an "
                         "actuator or a scenario");
  std::vector<std::string> kinds;
  for (const io::FirstFile& file : io::first_files()) kinds.emplace_back(file.kind);
  new_command->add_option("KIND", c.first.kind, "what to write")
      ->required()
      ->check(cli::one_of("kind", kinds))
      ->option_text(fmt::format("{}", fmt::join(kinds, " | ")));
  add_common_options(*new_command, c.first);
  add_out_file(*new_command, c.first);
  new_command->callback([&c] { c.run = [&c] { return cli::run_new(c.first); }; });

  CLI::App* manual_command = app.add_subcommand("manual", "a page of the manual, for man -l -");
  manual_command->add_option("PAGE", c.manual.page,
                             "gear3k-optimize, optimize, ...; gear3k without");
  manual_command
      ->add_option(
          "--out", c.manual.out,
          "folder for all pages, man1/*.1 and man5/*.5; made when missing: man -M DIR PAGE")
      ->option_text("DIR");
  add_common_options(*manual_command, c.manual);
  manual_command->callback([&app, &c] {
    c.run = [&app, &c] { return cli::run_manual(c.manual, cli::described(app)); };
  });

  CLI::App* completion_command = app.add_subcommand(
      "completion", "what bash has to read to complete commands: source <(gear3k completion)");
  add_common_options(*completion_command, c.completion);
  add_out_file(*completion_command, c.completion);
  completion_command->callback([&app, &c] {
    c.run = [&app, &c] { return cli::run_completion(c.completion, cli::described(app)); };
  });
}

int run_program(int argc, char** argv) {
  CLI::App app{
      "gear3k designs 3K compound planetary gearboxes (Wolfrom gears) for robot actuators.\n" +
      cli::exit_codes_text()};
  app.formatter(cli::narrow_formatter());
  app.set_version_flag("--version", fmt::format("gear3k {} ({})", io::version(), io::git_commit()));
  app.require_subcommand(1);

  Commands commands;
  add_gearbox_commands(app, commands);
  add_task_commands(app, commands);
  add_drawn_commands(app, commands);
  add_measured_commands(app, commands);
  add_actuator_commands(app, commands);
  add_many_task_commands(app, commands);
  add_help_commands(app, commands);

  cli::check_file_names(app);
  if (const std::string error = cli::unknown_word(app, {argv + 1, argv + argc}); !error.empty()) {
    cli::say(fmt::format("{}\nRun with --help for more information.\n", error));
    return cli::kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help;
    std::ostringstream complaint;
    if (app.exit(error, help, complaint) == 0) {
      cli::print_result(help.str());
      return cli::kDone;
    }
    std::string text = cli::usage_error(app, error);
    if (app.got_subcommand("diagnose")) {
      const std::string more = diagnose_usage_error(commands.diagnose);
      if (text.find(more) == std::string::npos) text += more + '\n';
    }
    cli::say(text + "Run with --help for more information.\n");
    return cli::kUsage;
  }
  return commands.run();
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file too large is an error of writing, with its message
  // Where a launcher has it ignored, no child could be waited for.
  std::signal(SIGCHLD, SIG_DFL);
  cli::reserve_standard_streams();
  // Ceres logs what it also returns; nobody but the program itself speaks to the user.
  FLAGS_minloglevel = google::GLOG_FATAL;
  try {
    return run_program(argc, argv);
  } catch (const io::InvalidInput& error) {
    cli::say(fmt::format("{}\n", error.what()));
    return cli::kInvalidInput;
  } catch (const std::bad_alloc&) {
    cli::say("gear3k: out of memory: allowed: fewer tooth sets (narrower ranges)\n");
    return cli::kSolverFailure;
  } catch (const std::exception& error) {
    cli::say(fmt::format("gear3k: {}\n", error.what()));
    return cli::kSolverFailure;
  }
}
