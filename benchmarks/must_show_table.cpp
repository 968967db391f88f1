#include "benchmarks/must_show_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "benchmarks/second_sample.hpp"
#include "benchmarks/share.hpp"

namespace gear3k::benchmarks {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kWorse = 1.05;  // more than 5 % worse than the refit

using Records = std::vector<const RateRecord*>;

// What is asked of a line.
struct Asked {
  double least = kNone, most = kNone;
  bool by_upper = false;
};

bool begins(const RateRecord& r, std::string_view name) { return r.line.starts_with(name); }
bool is_null(const RateRecord& r) { return is_null_line(r.line); }
bool remembers(const RateRecord& r) { return is_null(r) && noise_remembers(r.noise); }
bool is_series(const RateRecord& r) { return begins(r, "series "); }
bool has_truth(const RateRecord& r) {
  return !is_null(r) && !is_series(r) && !begins(r, "unknown ");
}

class Table {
 public:
  explicit Table(const std::vector<RateRecord>& records) : all_(records) {}

  template <typename Filter>
  Records where(Filter filter) const {
    Records chosen;
    for (const RateRecord& r : all_) {
      if (filter(r)) chosen.push_back(&r);
    }
    return chosen;
  }
  Records beginning(std::string_view name) const {
    return where([&](const RateRecord& r) { return begins(r, name); });
  }
  void part(std::string name) { part_ = std::move(name); }
  // Share of records; right in all four beside right names where asked.
  template <typename Hit>
  void share(const std::string& what, const Records& of, Hit hit, Asked asked = {}) {
    TableLine line = counted(what, of.size(), asked);
    for (const RateRecord* r : of) line.hits += hit(*r) ? 1 : 0;
    lines_.push_back(std::move(line));
  }
  void right(const std::string& what, const Records& of, Asked asked) {
    TableLine line = counted(what, of.size(), asked);
    line.names = 0;
    for (const RateRecord* r : of) {
      line.hits += r->all_right ? 1 : 0;
      line.names += r->right ? 1 : 0;
    }
    lines_.push_back(std::move(line));
  }
  void count(const std::string& what, int hits, int of, Asked asked) {
    TableLine line = counted(what, static_cast<std::size_t>(of), asked);
    line.hits = hits;
    lines_.push_back(std::move(line));
  }
  void value(const std::string& what, int count, std::array<double, 3> value, Asked asked) {
    TableLine line = counted(what, static_cast<std::size_t>(count), asked);
    line.value = value[0];
    line.low = value[1];
    line.high = value[2];
    lines_.push_back(std::move(line));
  }
  std::vector<TableLine> take() { return std::move(lines_); }

 private:
  TableLine counted(const std::string& what, std::size_t count, const Asked& asked) const {
    return {.part = part_,
            .what = what,
            .count = static_cast<int>(count),
            .value = kNone,
            .low = kNone,
            .high = kNone,
            .least = asked.least,
            .most = asked.most,
            .by_upper = asked.by_upper};
  }

  const std::vector<RateRecord>& all_;
  std::string part_;
  std::vector<TableLine> lines_;
};

void add_singles(Table& table) {
  table.part("singles");
  const Records singles = table.beginning("single ");
  for (const double strength : {2.0, 4.0, 8.0, 16.0}) {
    Records there;
    std::ranges::copy_if(singles, std::back_inserter(there),
                         [&](const RateRecord* r) { return r->strength == strength; });
    table.right(fmt::format("at {} times the noise", strength), there, {.least = 95.0});
    if (strength == 16.0) {
      Records reached;
      std::ranges::copy_if(there, std::back_inserter(reached),
                           [](const RateRecord* r) { return r->reached > 0.9 * r->strength; });
      table.right("at 16; those that physics lets reach it", reached, {});
    }
  }
  table.right("2 to 16", singles, {.least = 95.0});

  // By law, all strengths together.
  std::map<std::string, Records> laws;
  for (const RateRecord* r : singles) laws[r->line].push_back(r);
  const auto rate = [](const Records& of) {
    const auto hits = std::ranges::count_if(of, [](const auto* r) { return r->all_right; });
    return std::pair{static_cast<int>(hits), static_cast<int>(of.size())};
  };
  int below = 0, surely = 0;
  const std::string* worst = nullptr;
  double least = 2.0;
  for (const auto& [law, of] : laws) {
    const auto [hits, count] = rate(of);
    const double share = static_cast<double>(hits) / count;
    below += share < 0.88 ? 1 : 0;
    surely += share_interval(hits, count)[1] < 0.88 ? 1 : 0;
    if (share < least) {
      least = share;
      worst = &law;
    }
  }
  if (worst != nullptr) {
    table.right("worst law: " + worst->substr(7), laws[*worst], {.least = 88.0});
    table.count("laws below 88 %", below, static_cast<int>(laws.size()), {.most = 0.0});
    table.count("laws whose interval is below 88 %", surely, static_cast<int>(laws.size()), {});
  }

  // The same gearboxes, plans and laws at 2 and at 16: a paired difference.
  std::map<std::string, const RateRecord*> at_two;
  for (const RateRecord* r : singles) {
    if (r->strength == 2.0) at_two[fmt::format("{}|{}", r->line, r->seed)] = r;
  }
  int pairs = 0, lost = 0, won = 0;
  for (const RateRecord* r : singles) {
    const auto found = at_two.find(fmt::format("{}|{}", r->line, r->seed));
    if (r->strength != 16.0 || found == at_two.end()) continue;
    ++pairs;
    lost += found->second->all_right && !r->all_right ? 1 : 0;
    won += !found->second->all_right && r->all_right ? 1 : 0;
  }
  if (pairs > 0) {
    const double n = pairs, difference = (lost - won) / n;
    const double deviation = std::sqrt(std::max(lost + won - n * difference * difference, 0.0)) / n;
    table.value("fall from 2 to 16; points", pairs,
                {100.0 * difference, 100.0 * (difference - 1.96 * deviation),
                 100.0 * (difference + 1.96 * deviation)},
                {.most = 3.0});
  }
}

void add_specials(Table& table) {
  table.part("special");
  const std::pair<const char*, const char*> kinds[] = {
      {"drift on friction", "drift on friction"},
      {"gain steps", "gain steps"},
      {"steps of all sessions in lost motion", "steps of all sessions in lost motion"},
      {"first-order wave on one turn", "first-order wave on one turn"}};
  for (const auto& [what, name] : kinds) table.right(what, table.beginning(name), {.least = 93.0});
  table.part("several");
  table.right("pairs", table.beginning("pair "), {.least = 88.0});
  table.right("triples with a law of free reference", table.where([](const RateRecord& r) {
    return begins(r, "triple ") && has_free_reference(r.line);
  }),
              {.least = 75.0});
}

void add_nulls(Table& table) {
  table.part("nothing hidden; something said");
  const auto wrong = [](const RateRecord& r) { return !r.all_right; };
  const auto independent = [](const RateRecord& r) { return is_null(r) && !remembers(r); };
  table.share("independent noise", table.where(independent), wrong, {.most = 5.0});
  std::map<std::string, Records> plans, noises;
  for (const RateRecord* r : table.where(is_null)) {
    if (!remembers(*r)) plans[plan_name(*r)].push_back(r);
    noises[r->noise].push_back(r);
  }
  for (const auto& [plan, of] : plans) {
    table.share(plan, of, wrong, {.most = 8.0, .by_upper = true});
  }
  for (const auto& [noise, of] : noises) {
    const bool memory = noise == "correlated" || noise == "blocks";
    table.share("noise: " + noise, of, wrong, {.most = memory ? kNone : 8.0, .by_upper = true});
  }
  table.share("noise that remembers", table.where(remembers), wrong, {.most = 5.0});
}

void add_names(Table& table) {
  table.part("names");
  const auto hidden = table.where(
      [](const RateRecord& r) { return has_truth(r) && (r.right || r.false_remainder); });
  table.share("right names; but the verdict unexplained",
              table.where([](const RateRecord& r) { return has_truth(r) && r.right; }),
              [](const RateRecord& r) { return !r.verdict_fits; });
  table.share("false remainder beside right names", hidden,
              [](const RateRecord& r) { return r.false_remainder; }, {.most = 1.5});
  table.share("confounded: the truth is named or listed", table.beginning("confounded "),
              [](const RateRecord& r) { return r.disclosed; }, {.least = 95.0});
  table.right("confounded: right", table.beginning("confounded "), {});
  table.share("confounded: lists what the data rule out", table.beginning("confounded "),
              [](const RateRecord& r) { return r.lists_excluded; }, {.most = 3.0});
  table.share("all: lists what the data rule out", table.where(has_truth),
              [](const RateRecord& r) { return r.lists_excluded; }, {.most = 3.0});
  table.share("aliased orders: the true body is named or listed", table.beginning("aliased "),
              [](const RateRecord& r) { return r.own_order_listed; }, {.least = 95.0});
  table.right("aliased orders: right", table.beginning("aliased "), {});
  table.share("aliased orders: all bodies that fit are", table.beginning("aliased "),
              [](const RateRecord& r) { return r.all_orders_listed; }, {});
  table.share("no cause fits: left unexplained", table.beginning("unknown "),
              [](const RateRecord& r) { return r.right; }, {});
  table.share("... and nothing named that is not hidden", table.beginning("unknown "),
              [](const RateRecord& r) { return r.right && !r.wrong_name; }, {});
  const auto tried = table.where([](const RateRecord& r) { return !r.left_out.empty(); });
  table.share("a session or block left out: the same names", tried,
              [](const RateRecord& r) { return r.left_out == "same"; }, {.least = 90.0});
  table.share("... or names that change places with an alternative", tried,
              [](const RateRecord& r) { return r.left_out != "changed"; }, {});
}

// Stated probabilities by tenths.
struct Tenths {
  std::array<int, 10> claims{}, held{};
  std::array<double, 10> stated{};

  void add(const RateRecord& r) {
    for (const StatedProbability& c : r.claims) {
      const auto tenth = static_cast<std::size_t>(std::clamp(c.percent / 10.0, 0.0, 9.0));
      ++claims[tenth];
      held[tenth] += c.holds ? 1 : 0;
      stated[tenth] += c.percent;
    }
  }
};

void add_numbers(Table& table, const std::vector<RateRecord>& records) {
  table.part("numbers");
  int intervals = 0, inside = 0;
  Tenths tenths;
  for (const RateRecord& r : records) {
    if (is_series(r)) continue;
    intervals += r.intervals;
    inside += r.inside;
    // How often each of two aliases is true is a choice of this bench; noise that remembers is not
    // what the probabilities are of.
    if (!begins(r, "aliased ") && !remembers(r)) tenths.add(r);
  }
  table.count("95 % intervals of causes named rightly that hold the truth", inside, intervals,
              {.least = 93.0, .most = 97.0});
  table.part("probabilities; stated less held");
  for (std::size_t k = 0; k < tenths.claims.size(); ++k) {
    const int claims = tenths.claims[k];
    if (claims == 0) continue;
    const auto [low, high] = share_interval(tenths.held[k], claims);
    const double said = tenths.stated[k] / claims, now = 100.0 * tenths.held[k] / claims;
    table.value(
        fmt::format("{} to {} %: stated {:.1f}; held {:.1f}", 10 * k, 10 * (k + 1), said, now),
        claims, {said - now, said - 100.0 * high, said - 100.0 * low},
        {.least = -7.0, .most = 7.0});
  }
}

void add_predictions(Table& table) {
  table.part("more than 5 % worse than a refit of one parameter");
  struct Prediction {
    const char* what;
    double RateRecord::*ratio;
    bool of_nulls;
  };
  const Prediction kinds[] = {
      {"loads and speeds not measured; without noise", &RateRecord::unseen, false},
      {"loads and speeds not measured; as read", &RateRecord::unseen_read, false},
      {"a later session; without noise", &RateRecord::later, false},
      {"a later session; as read", &RateRecord::later_read, false},
      {"nothing hidden: loads and speeds; as read", &RateRecord::unseen_read, true},
      {"nothing hidden: a later session; as read", &RateRecord::later_read, true}};
  // Beside how often they are worse, how often as much better: where what comes is drawn anew both
  // are luck.
  const auto compare = [&](const std::string& what, const Records& of, double RateRecord::*ratio,
                           Asked asked) {
    std::vector<double> ratios;
    for (const RateRecord* r : of) ratios.push_back(r->*ratio);
    std::ranges::sort(ratios);
    const double worst = ratios.empty() ? 0.0 : ratios.back();
    const double middle = ratios.empty() ? 0.0 : ratios[ratios.size() / 2];
    table.share(
        fmt::format("{} (worst {:.2f} times)", what, worst), of,
        [&](const RateRecord& r) { return r.*ratio > kWorse; }, asked);
    table.share(fmt::format("... more than 5 % better (median {:.2f} times)", middle), of,
                [&](const RateRecord& r) { return r.*ratio < 1.0 / kWorse; }, {});
  };
  for (const Prediction& kind : kinds) {
    compare(kind.what, table.where([&](const RateRecord& r) {
      return is_null(r) == kind.of_nulls && std::isfinite(r.*kind.ratio);
    }),
            kind.ratio, {.most = 0.0});
  }
  compare("a later session after steps of the gain by session; as read",
          table.where([](const RateRecord& r) {
            return r.laws.find("gain_sessions") != std::string::npos && std::isfinite(r.later_read);
          }),
          &RateRecord::later_read, {});
}

void add_series(Table& table) {
  table.part("series of 8 gearboxes");
  const Records series = table.where(is_series);
  int named = 0, owner = 0, near = 0, compared = 0, intervals = 0, inside = 0;
  std::vector<double> ratios;
  for (const RateRecord* r : series) {
    intervals += r->intervals;
    inside += r->inside;
    for (const SeriesPart& p : r->parts) {
      named += p.named ? 1 : 0;
      owner += p.owner ? 1 : 0;
      if (!(p.deviation > 0.0)) continue;
      ++compared;
      near += std::abs(p.deviation - 1.0) <= 0.2 ? 1 : 0;
      ratios.push_back(p.deviation);
    }
  }
  table.share("right", series, [](const RateRecord& r) { return r.right; }, {});
  table.count("part or design", owner, named, {.least = 95.0});
  table.count("part-to-part deviation within 20 % of that built", near, compared, {.least = 95.0});
  table.count("intervals of mean and deviation hold the population's", inside, intervals, {});
}

// What the first sample is too small to tell; nothing without a second.
void add_second_sample(Table& table, const std::vector<RateRecord>& records) {
  table.part("second sample; the first chose it");
  const auto compared = [](const TwoSamples& s) {
    return fmt::format("{}: first {} of {}; again", s.name, s.first_hits, s.first);
  };
  const auto taken = [](std::vector<TwoSamples> due, int whole) {
    const auto number = due.size();
    std::erase_if(due, [whole](const TwoSamples& s) { return s.again < whole; });
    return std::pair{std::move(due), static_cast<int>(number)};
  };
  const auto [laws, laws_due] = taken(laws_taken_again(records), kAgainOfLaw);
  int below = 0;
  for (const TwoSamples& s : laws) {
    below += s.again_hits < 0.88 * s.again ? 1 : 0;
    table.count(compared(s), s.again_hits, s.again, {.least = 88.0});
  }
  const auto [plans, plans_due] = taken(plans_taken_again(records), kAgainOfPlan);
  int above = 0;
  for (const TwoSamples& s : plans) {
    above += 100.0 * share_interval(s.again_hits, s.again)[1] > 8.0 ? 1 : 0;
    table.count(compared(s), s.again_hits, s.again, {.most = 8.0, .by_upper = true});
  }
  if (laws.empty() && plans.empty()) return;
  const int of_laws = static_cast<int>(laws.size()), of_plans = static_cast<int>(plans.size());
  table.count("laws with any not right in the first: taken again", of_laws, laws_due, {});
  table.count("of these: laws below 88 % in the second sample", below, of_laws, {.most = 0.0});
  table.count("plans whose upper limit is above 8 % in the first: taken again", of_plans, plans_due,
              {});
  table.count("of these: upper limit above 8 % in the second sample, too", above, of_plans,
              {.most = 0.0});
}

std::string asked_text(const TableLine& l) {
  const std::string unit = std::isfinite(l.value) ? "" : " %";
  const std::string end = l.by_upper ? ", upper end" : "";
  if (std::isfinite(l.least) && std::isfinite(l.most)) {
    return fmt::format("{:g} to {:g}{}", l.least, l.most, unit);
  }
  if (std::isfinite(l.least)) return fmt::format(">= {:g}{}", l.least, unit);
  if (std::isfinite(l.most)) return fmt::format("<= {:g}{}{}", l.most, unit, end);
  return "";
}

// Percent, or the value, with its interval.
std::array<double, 3> numbers_of(const TableLine& l) {
  if (std::isfinite(l.value)) return {l.value, l.low, l.high};
  if (l.count == 0) return {kNone, kNone, kNone};
  const auto [low, high] = share_interval(l.hits, l.count);
  return {100.0 * l.hits / l.count, 100.0 * low, 100.0 * high};
}

// yes and no: the whole interval says so; rate and short: the rate alone does.
std::string held_text(const TableLine& l) {
  const auto [rate, low, high] = numbers_of(l);
  if (asked_text(l).empty() || !std::isfinite(rate)) return "";
  const auto within = [&](double x) { return !(x < l.least) && !(x > l.most); };
  if (l.by_upper)
    return within(high) ? "yes" : within(low) ? (within(rate) ? "rate" : "short") : "no";
  if (within(rate)) return within(low) && within(high) ? "yes" : "rate";
  return high < l.least || low > l.most ? "no" : "short";
}

}  // namespace

bool has_free_reference(const std::string& line) {
  return line.find("friction_load") != std::string::npos ||
         line.find("friction_speed") != std::string::npos ||
         line.find("friction_temperature") != std::string::npos;
}

std::vector<TableLine> must_show_table(const std::vector<RateRecord>& records) {
  std::vector<RateRecord> first;
  std::ranges::copy_if(records, std::back_inserter(first),
                       [](const RateRecord& r) { return !is_again(r); });
  Table table(first);
  add_singles(table);
  add_specials(table);
  add_nulls(table);
  add_names(table);
  add_numbers(table, first);
  add_predictions(table);
  add_series(table);
  add_second_sample(table, records);
  return table.take();
}

std::string markdown_of(const std::vector<TableLine>& table) {
  std::size_t width = 4;
  for (const TableLine& l : table) width = std::max(width, l.what.size());
  std::string text = fmt::format("| {:<{}} | {:>6} | {:>21} | {:>6} | {:<17} | {:<5} |\n", "",
                                 width, "count", "percent", "names", "asked", "held");
  text += fmt::format("|-{:-<{}}-|-{:->6}:|-{:->21}:|-{:->6}:|-{:-<17}-|-{:-<5}-|\n", "", width, "",
                      "", "", "", "");
  std::string part;
  for (const TableLine& l : table) {
    if (l.part != part) {
      part = l.part;
      text += fmt::format("| {:<{}} | {:>6} | {:>21} | {:>6} | {:<17} | {:<5} |\n",
                          "**" + part + "**", width, "", "", "", "", "");
    }
    const auto [rate, low, high] = numbers_of(l);
    const std::string numbers =
        std::isfinite(rate) ? fmt::format("{:.1f} [{:.1f}, {:.1f}]", rate, low, high) : "-";
    const std::string names =
        l.names < 0 || l.count == 0 ? "" : fmt::format("{:.1f}", 100.0 * l.names / l.count);
    text += fmt::format("| {:<{}} | {:>6} | {:>21} | {:>6} | {:<17} | {:<5} |\n", l.what, width,
                        l.count, numbers, names, asked_text(l), held_text(l));
  }
  return text;
}

std::string csv_of(const std::vector<TableLine>& table) {
  std::string text = "part,what,count,hits,value,low,high,names,least,most,by_upper,held\n";
  const auto number = [](double x) { return std::isfinite(x) ? fmt::format("{}", x) : ""; };
  for (const TableLine& l : table) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", l.part, l.what, l.count, l.hits,
                        number(l.value), number(l.low), number(l.high), l.names, number(l.least),
                        number(l.most), l.by_upper ? 1 : 0, held_text(l));
  }
  return text;
}

std::vector<TableLine> table_of_csv(const std::string& text) {
  std::vector<TableLine> table;
  std::istringstream rows(text);
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::vector<std::string> f;
    std::istringstream fields(row);
    for (std::string field; std::getline(fields, field, ',');) f.push_back(field);
    constexpr std::size_t kLeast = 11;
    if (f.size() < kLeast) throw std::runtime_error("a line of a table is cut off: " + row);
    const auto value = [](const std::string& field) {
      return field.empty() ? kNone : std::strtod(field.c_str(), nullptr);
    };
    table.push_back({.part = f[0],
                     .what = f[1],
                     .count = std::atoi(f[2].c_str()),
                     .hits = std::atoi(f[3].c_str()),
                     .value = value(f[4]),
                     .low = value(f[5]),
                     .high = value(f[6]),
                     .names = std::atoi(f[7].c_str()),
                     .least = value(f[8]),
                     .most = value(f[9]),
                     .by_upper = f[10] == "1"});
  }
  return table;
}

}  // namespace gear3k::benchmarks
