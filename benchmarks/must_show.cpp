// All that a table of how right `diagnose` is needs, from one run: campaigns of the wide rig and of
// series of gearboxes, each diagnosed once for every line of the table that it serves.
//
//   must_show --out=FILE [--campaigns=200] [--first=SEED] [--budget-cpu-seconds=S] [--threads=N]
//             [--shard=K/N] [--only=GROUP-PREFIX] [--line=PREFIX]... [--again [FILE...]]
//   must_show --report [--csv=TABLE] FILE...
//   must_show --table=TABLE
//
// A campaign is a line of FILE as soon as it is diagnosed.  FILE is gone on with where it exists,
// so that a run may be stopped at any time.  Groups come on evenly: the next campaign is of the
// group that is the least share of its number, and of its lines the next one in an order that mixes
// kinds and causes.  Shards divide the campaigns; --report puts their files together,
// prints the table and writes its counts, which --table prints again.  --line leaves of the groups
// the lines whose names begin so; each has N campaigns of its group then, fewer lines more seeds.
//
// --again, with the options of a run that is whole (its records in FILE and in those named behind):
// single laws of which any campaign is not right have 40 more, plans without anything hidden whose
// upper limit of something said is above 8 % 400 more, of seeds that the run has not.

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/must_show_table.hpp"
#include "benchmarks/program.hpp"
#include "benchmarks/rate_record.hpp"
#include "benchmarks/second_sample.hpp"
#include "io/text/diagnostics.hpp"
#include "numerics/parallel.hpp"
#include "tests/app/wide_scoring.hpp"
#include "tests/calibrate/series_scoring.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using benchmarks::RateRecord;

struct RateCell {
  std::optional<wide_rig::Line> line{};
  std::optional<series_rig::SeriesScenario> series{};
  double strength = 0.0;
  bool again = false;  ///< of the second sample

  [[nodiscard]] std::string name() const {
    std::string text = line ? line->name : "series " + series->name;
    if (again) text.insert(0, benchmarks::kAgain);
    std::ranges::replace(text, ',', ';');
    return text;
  }
};

/// Campaigns of one purpose.
struct RateGroup {
  std::string name;
  std::vector<RateCell> cells;
  double share = 1.0;      ///< of the number of campaigns that is asked for
  bool leave_out = false;  ///< every fourth campaign is diagnosed without a part, too
};

struct DueCampaign {
  const RateGroup* group = nullptr;
  const RateCell* cell = nullptr;
  std::uint64_t seed = 0;
  bool leave_out = false;
};

const std::vector<double>& rate_strengths() {
  static const std::vector<double> list{2.0, 4.0, 8.0, 16.0};
  return list;
}

std::vector<RateGroup> rate_groups() {
  const std::vector<wide_rig::Line> lines = wide_rig::lines();
  std::vector<RateGroup> all;
  const auto chosen = [&](const auto& wanted, const std::vector<double>& at) {
    std::vector<RateCell> cells;
    for (const wide_rig::Line& line : lines) {
      if (!wanted(line)) continue;
      for (const double strength : at) cells.push_back({.line = line, .strength = strength});
    }
    return cells;
  };
  const auto of_group = [](const std::string& group) {
    return [group](const wide_rig::Line& l) { return l.group == group; };
  };
  const auto begins = [](const std::string& name) {
    return [name](const wide_rig::Line& l) {
      return l.group == "special" && l.name.starts_with(name);
    };
  };
  for (const double strength : rate_strengths()) {
    all.push_back({.name = fmt::format("singles at {}", strength),
                   .cells = chosen(of_group("single"), {strength}),
                   .leave_out = true});
  }
  for (const char* special :
       {"drift on friction", "gain steps", "steps of all sessions in lost motion",
        "first-order wave on one turn"}) {
    all.push_back({.name = special, .cells = chosen(begins(special), rate_strengths())});
  }
  all.push_back(
      {.name = "pairs", .cells = chosen(of_group("pair"), rate_strengths()), .leave_out = true});
  all.push_back({.name = "triples",
                 .cells = chosen(
                     [](const wide_rig::Line& l) {
                       return l.group == "triple" && benchmarks::has_free_reference(l.name);
                     },
                     rate_strengths())});
  std::map<std::string, std::vector<RateCell>> nulls;
  for (RateCell& cell :
       chosen([](const wide_rig::Line& l) { return l.group == "null" || l.group == "correlated"; },
              {0.0})) {
    nulls["nulls " + cell.line->kind + " " + cell.line->plan].push_back(std::move(cell));
  }
  for (auto& [name, cells] : nulls) all.push_back({.name = name, .cells = std::move(cells)});
  all.push_back({.name = "confounded", .cells = chosen(of_group("confounded"), {2.0, 8.0})});
  all.push_back({.name = "aliased", .cells = chosen(of_group("aliased"), rate_strengths())});
  all.push_back({.name = "unknown", .cells = chosen(of_group("unknown"), {4.0}), .share = 0.5});
  RateGroup series{.name = "series", .cells = {}};
  for (const series_rig::SeriesScenario& s : series_rig::scenarios()) {
    series.cells.push_back({.series = s});
  }
  all.push_back(std::move(series));
  return all;
}

/// The campaigns of a group one after the other: k-th cell of an order that mixes the cells, a seed
/// more with each round.
class RateQueue {
 public:
  RateQueue(const RateGroup& group, int campaigns, std::uint64_t first)
      : group_(&group), first_(first) {
    const std::size_t n = group.cells.size();
    const auto asked = static_cast<std::size_t>(std::ceil(group.share * campaigns));
    count_ = (asked + n - 1) / n * n;
    if (asked < n) count_ = asked;
    stride_ = static_cast<std::size_t>(0.618 * static_cast<double>(n)) + 1;
    while (std::gcd(stride_, n) != 1) ++stride_;
  }
  [[nodiscard]] double done() const {
    return static_cast<double>(at_) / static_cast<double>(count_);
  }
  [[nodiscard]] bool empty() const { return at_ >= count_; }
  [[nodiscard]] std::size_t at() const { return at_; }
  DueCampaign next() {
    const std::size_t n = group_->cells.size(), k = at_++;
    const std::size_t round = k / n, place = k % n;
    return {.group = group_,
            .cell = &group_->cells[place * stride_ % n],
            .seed = first_ + round,
            .leave_out = group_->leave_out && (place + round) % 4 == 0};
  }

 private:
  const RateGroup* group_;
  std::uint64_t first_;
  std::size_t count_ = 0, stride_ = 1, at_ = 0;
};

/// Those of the second sample, out of the lines of the first.
std::vector<RateGroup> groups_again(const std::vector<RateGroup>& first,
                                    const std::vector<RateRecord>& records) {
  std::vector<RateGroup> again;
  const auto add = [&](const std::string& name, const auto& wanted) {
    RateGroup group{.name = std::string(benchmarks::kAgain) + name, .cells = {}};
    for (const RateGroup& from : first) {
      for (const RateCell& cell : from.cells) {
        if (!cell.line || !wanted(cell)) continue;
        group.cells.push_back(cell);
        group.cells.back().again = true;
      }
    }
    if (!group.cells.empty()) again.push_back(std::move(group));
  };
  for (const benchmarks::TwoSamples& law : benchmarks::laws_taken_again(records)) {
    add(law.name, [&](const RateCell& cell) { return cell.name() == law.name; });
    if (!again.empty())
      again.back().share = 1.0 * benchmarks::kAgainOfLaw / benchmarks::kAgainOfPlan;
  }
  for (const benchmarks::TwoSamples& plan : benchmarks::plans_taken_again(records)) {
    add("nulls " + plan.name, [&](const RateCell& cell) {
      return benchmarks::is_null_line(cell.name()) &&
             !benchmarks::noise_remembers(cell.line->noise) &&
             cell.line->kind + " " + cell.line->plan == plan.name;
    });
  }
  return again;
}

std::string key_of(const DueCampaign& task) {
  return RateRecord{.line = task.cell->name(), .strength = task.cell->strength, .seed = task.seed}
      .key();
}

/// Campaigns of the groups that no record is of; how many seeds the groups take.
struct FirstSample {
  std::vector<std::string> missing{};
  std::uint64_t seeds = 0;
};

FirstSample first_sample(const std::vector<RateGroup>& groups, int campaigns, std::uint64_t first,
                         const std::vector<RateRecord>& records) {
  std::set<std::string> done;
  for (const RateRecord& r : records) done.insert(r.key());
  FirstSample sample;
  for (const RateGroup& group : groups) {
    for (RateQueue queue(group, campaigns, first); !queue.empty();) {
      const DueCampaign task = queue.next();
      sample.seeds = std::max(sample.seeds, task.seed - first + 1);
      if (!done.contains(key_of(task))) sample.missing.push_back(key_of(task));
    }
  }
  return sample;
}

double thread_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void add_prediction(const wide_rig::Score& s, double error, double refit, double& clean,
                    double& read) {
  if (std::isfinite(error) && std::isfinite(refit)) {
    clean = error / refit;
    read = std::hypot(error, s.noise) / std::hypot(refit, s.noise);
  }
}

/// The verdict on one campaign.
/// @throws io::InvalidInput for data that diagnose refuses to read
void add_score(const DueCampaign& task, const wide_rig::Campaign& campaign, RateRecord& r) {
  const wide_rig::Score s = wide_rig::score(campaign);
  r.verdict = s.verdict;
  r.reached = s.strength;
  r.right = s.right;
  r.all_right = s.all_right();
  r.wrong_name = s.wrong_name;
  r.false_remainder = s.false_remainder;
  r.disclosed = s.disclosed;
  r.lists_excluded = s.lists_excluded;
  r.verdict_fits = s.verdict_fits;
  r.own_order_listed = s.own_order_listed;
  r.all_orders_listed = s.orders > 0 && s.orders == s.orders_listed;
  r.gain = s.gain;
  add_prediction(s, s.unseen, s.unseen_refit, r.unseen, r.unseen_read);
  add_prediction(s, s.later, s.later_refit, r.later, r.later_read);
  r.orders = s.orders;
  r.intervals = s.intervals;
  r.inside = s.inside;
  for (const wide_rig::Claim& c : s.claims) {
    r.claims.push_back({100.0 * c.probability, c.holds});
  }
  if (!s.all_right() || s.inside < s.intervals) r.answer = s.answer;
  if (task.leave_out) {
    const wide_rig::LeftOut left = wide_rig::leave_out(campaign, s, task.seed + r.line.size());
    r.left_out = left.same ? "same" : left.same_or_alternatives ? "alternative" : "changed";
    if (!left.same) r.answer = s.answer + " | left out: " + left.answer;
  }
}

RateRecord diagnosed(const DueCampaign& task) {
  RateRecord r{.line = task.cell->name(), .strength = task.cell->strength, .seed = task.seed};
  r.gain = r.unseen = r.unseen_read = r.later = r.later_read = std::nan("");
  const double start_s = thread_seconds();
  if (task.cell->series) {
    const auto s = series_rig::score(series_rig::make_series(*task.cell->series, task.seed), false);
    r.right = r.all_right = s.right;
    for (const auto& t : s.truths) {
      r.parts.push_back({.named = t.named,
                         .owner = t.right,
                         .deviation = t.measured && t.deviation > 0.0 ? t.deviation : 0.0});
      if (!t.measured) continue;
      r.intervals += 2;
      r.inside += (t.mean_inside ? 1 : 0) + (t.deviation_inside ? 1 : 0);
    }
    if (!s.right) r.answer = s.answer;
  } else {
    const wide_rig::Campaign campaign =
        wide_rig::make_campaign(*task.cell->line, task.cell->strength, task.seed);
    r.plan = campaign.plan;
    r.noise = campaign.noise_model;
    for (const wide_rig::Truth& t : campaign.truths) r.laws += (r.laws.empty() ? "" : "+") + t.law;
    try {
      add_score(task, campaign, r);
    } catch (const io::InvalidInput& refused) {
      if (r.verdict.empty()) {
        r.verdict = "refused";
      } else {
        r.left_out = "changed";
      }
      r.answer = refused.what();
    }
  }
  r.processor_s = thread_seconds() - start_s;
  return r;
}

struct RateOptions {
  std::string out{}, only{}, csv{}, table{};
  int campaigns = 200, threads = 1;
  std::uint64_t first = 1;
  double budget_s = HUGE_VAL;
  std::size_t shard = 1, shards = 1;
  bool report = false, again = false;
  std::vector<std::string> files{}, lines{};
};

std::optional<RateOptions> rate_options(int argc, char** argv) {
  RateOptions o;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const std::size_t equal = word.find('=');
    const std::string name = word.substr(0, equal);
    const std::string value = equal == std::string::npos ? "" : word.substr(equal + 1);
    if (name == "--out") {
      o.out = value;
    } else if (name == "--only") {
      o.only = value;
    } else if (name == "--table") {
      o.table = value;
    } else if (name == "--line") {
      o.lines.push_back(value);
    } else if (name == "--csv") {
      o.csv = value;
    } else if (name == "--campaigns") {
      o.campaigns = std::max(1, std::atoi(value.c_str()));
    } else if (name == "--threads") {
      o.threads = std::max(1, std::atoi(value.c_str()));
    } else if (name == "--first") {
      o.first = std::strtoull(value.c_str(), nullptr, 10);
    } else if (name == "--budget-cpu-seconds") {
      o.budget_s = std::atof(value.c_str());
    } else if (name == "--shard") {
      o.shard = std::strtoull(value.c_str(), nullptr, 10);
      const std::size_t slash = value.find('/');
      o.shards =
          slash == std::string::npos ? 0 : std::strtoull(value.c_str() + slash + 1, nullptr, 10);
      if (o.shard < 1 || o.shard > o.shards) return std::nullopt;
    } else if (word == "--report") {
      o.report = true;
    } else if (word == "--again") {
      o.again = true;
    } else if (word.starts_with("--")) {
      return std::nullopt;
    } else {
      o.files.push_back(word);
    }
  }
  if (!o.table.empty()) return o;
  if (o.report ? o.files.empty() : o.out.empty() || (!o.again && !o.files.empty())) {
    return std::nullopt;
  }
  return o;
}

/// Hands out campaigns and keeps what they came to.
class RateRun {
 public:
  RateRun(const RateOptions& options, const std::vector<RateGroup>& all) : options_(options) {
    for (const RateGroup& group : all) {
      queues_.emplace_back(group, options.campaigns, options.first);
      groups_.push_back(&group);
    }
    const bool exists = std::filesystem::exists(options.out);
    bool cut_off = false;
    if (exists) {
      for (const RateRecord& r : benchmarks::read_rate_records({options.out}))
        done_.insert(r.key());
      std::ifstream file(options.out, std::ios::ate | std::ios::binary);
      if (file.tellg() > 0) {
        file.seekg(-1, std::ios::end);
        cut_off = file.get() != '\n';
      }
    }
    file_.open(options.out, std::ios::app);
    if (cut_off) file_ << '\n';
    if (!exists) file_ << benchmarks::rate_header();
  }

  std::optional<DueCampaign> next() {
    const std::lock_guard lock(mutex_);
    while (spent_s_ < options_.budget_s) {
      RateQueue* least = nullptr;
      for (RateQueue& queue : queues_) {
        if (!queue.empty() && (least == nullptr || queue.done() < least->done())) least = &queue;
      }
      if (least == nullptr) break;
      const bool mine = least->at() % options_.shards == options_.shard - 1;
      const DueCampaign task = least->next();
      if (mine && done_.insert(key_of(task)).second) return task;
    }
    return std::nullopt;
  }
  void keep(const DueCampaign& task, const RateRecord& record) {
    const std::lock_guard lock(mutex_);
    file_ << benchmarks::text_of(record) << std::flush;
    auto& [count, seconds] = spent_[task.group->name];
    ++count;
    seconds += record.processor_s;
    spent_s_ += record.processor_s;
  }
  void failed(const DueCampaign& task, const std::string& why) {
    const std::lock_guard lock(mutex_);
    fmt::print("{} at {}, seed {}: {}\n", task.cell->name(), task.cell->strength, task.seed, why);
  }
  void print() const {
    fmt::print("{:<44} {:>9} {:>9} {:>9}\n", "group", "reached", "now", "CPU s");
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const auto found = spent_.find(groups_[g]->name);
      const auto [count, seconds] =
          found == spent_.end() ? std::pair<int, double>{} : found->second;
      fmt::print("{:<44} {:>7.1f} % {:>9} {:>9.1f}\n", groups_[g]->name, 100.0 * queues_[g].done(),
                 count, seconds);
    }
    fmt::print("{:.1f} s of CPU\n", spent_s_);
  }

 private:
  RateOptions options_;
  std::vector<RateQueue> queues_;
  std::vector<const RateGroup*> groups_;
  std::set<std::string> done_;
  std::ofstream file_;
  std::mutex mutex_;
  std::map<std::string, std::pair<int, double>> spent_;
  double spent_s_ = 0.0;
};

/// The groups and the options of the second sample in place of the first's.
/// @returns false, with what is missing said, unless the first is whole
bool turn_to_second_sample(RateOptions& options, std::vector<RateGroup>& groups) {
  std::vector<std::string> files = options.files;
  if (std::filesystem::exists(options.out)) files.push_back(options.out);
  const auto records = benchmarks::read_rate_records(files);
  const FirstSample first = first_sample(groups, options.campaigns, options.first, records);
  if (!first.missing.empty()) {
    fmt::print("the first sample is not whole: {} campaigns missing, such as {}\n",
               first.missing.size(), first.missing.front());
    return false;
  }
  if (first.seeds > benchmarks::kAgainSeeds) {
    fmt::print("the first sample has {} seeds, the second begins {} after its first\n", first.seeds,
               benchmarks::kAgainSeeds);
    return false;
  }
  groups = groups_again(groups, records);
  options.first += benchmarks::kAgainSeeds;
  options.campaigns = benchmarks::kAgainOfPlan;
  return true;
}

}  // namespace

PROGRAM(must_show)(int argc, char** argv) {
  auto options = rate_options(argc, argv);
  if (!options) {
    fmt::print(
        "usage: must_show --out=FILE [--campaigns=200] [--first=SEED] [--budget-cpu-seconds=S]\n"
        "                 [--threads=N] [--shard=K/N] [--only=GROUP-PREFIX] [--line=PREFIX]...\n"
        "                 [--again [FILE...]]\n"
        "       must_show --report [--csv=TABLE] FILE...\n"
        "       must_show --table=TABLE\n");
    return 1;
  }
  if (!options->table.empty()) {
    std::ifstream file(options->table);
    const std::string text((std::istreambuf_iterator<char>(file)),
                           std::istreambuf_iterator<char>());
    fmt::print("{}", benchmarks::markdown_of(benchmarks::table_of_csv(text)));
    return file ? 0 : 1;
  }
  if (options->report) {
    const auto table = benchmarks::must_show_table(benchmarks::read_rate_records(options->files));
    fmt::print("{}", benchmarks::markdown_of(table));
    if (!options->csv.empty()) std::ofstream(options->csv) << benchmarks::csv_of(table);
    return 0;
  }
  std::vector<RateGroup> all = rate_groups();
  if (!options->lines.empty()) {
    for (RateGroup& group : all) {
      std::erase_if(group.cells, [&](const RateCell& cell) {
        return std::ranges::none_of(
            options->lines, [&](const std::string& line) { return cell.name().starts_with(line); });
      });
    }
    std::erase_if(all, [](const RateGroup& group) { return group.cells.empty(); });
  }
  std::erase_if(all,
                [&](const RateGroup& group) { return !group.name.starts_with(options->only); });
  if (options->again && !turn_to_second_sample(*options, all)) return 1;
  RateRun run(*options, all);
  omp_set_num_threads(options->threads);
  numerics::parallel_for(static_cast<std::size_t>(options->threads), [&](std::size_t) {
    while (const auto task = run.next()) {
      try {
        run.keep(*task, diagnosed(*task));
      } catch (const std::exception& error) {
        run.failed(*task, error.what());
      }
    }
  });
  run.print();
  return 0;
}
