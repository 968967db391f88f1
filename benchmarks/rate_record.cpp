#include "benchmarks/rate_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

namespace gear3k::benchmarks {
namespace {

constexpr std::size_t kFields = 21;

struct Flag {
  char letter;
  bool RateRecord::*value;
};
constexpr std::array kFlags{Flag{'R', &RateRecord::right},
                            Flag{'A', &RateRecord::all_right},
                            Flag{'W', &RateRecord::wrong_name},
                            Flag{'M', &RateRecord::false_remainder},
                            Flag{'D', &RateRecord::disclosed},
                            Flag{'X', &RateRecord::lists_excluded},
                            Flag{'V', &RateRecord::verdict_fits},
                            Flag{'o', &RateRecord::own_order_listed},
                            Flag{'O', &RateRecord::all_orders_listed}};

std::string number(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : ""; }

double value_of(const std::string& text) {
  return text.empty() ? std::nan("") : std::strtod(text.c_str(), nullptr);
}

std::string without_commas(std::string text) {
  std::ranges::replace(text, ',', ';');
  std::ranges::replace(text, '\n', ' ');
  return text;
}

}  // namespace

std::string RateRecord::key() const { return fmt::format("{}|{}|{}", line, strength, seed); }

std::string rate_header() {
  return "# flags: R names right, nothing left; A and verdict, alternatives, gain; W wrong name; M "
         "remainder beside right names; D disclosed; X lists what is ruled out; V verdict fits; o "
         "true order listed; O all orders listed\n"
         "line,strength,seed,plan,noise,laws,verdict,reached,flags,gain,unseen,unseen_read,later,"
         "later_read,orders,intervals,inside,left_out,claims,processor_s,answer\n";
}

std::string text_of(const RateRecord& r) {
  std::string flags;
  for (const Flag& flag : kFlags) flags += r.*flag.value ? std::string(1, flag.letter) : "";
  // Claims: percent and + or -; of series: named, owner, deviation.
  std::string claims;
  for (const StatedProbability& c : r.claims) {
    claims += fmt::format("{}{:.1f}{}", claims.empty() ? "" : " ", c.percent, c.holds ? '+' : '-');
  }
  for (const SeriesPart& p : r.parts) {
    claims += fmt::format("{}{}/{}/{:.3f}", claims.empty() ? "" : " ", p.named ? 1 : 0,
                          p.owner ? 1 : 0, p.deviation);
  }
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.2f},{}\n", r.line,
                     r.strength, r.seed, r.plan, r.noise, without_commas(r.laws), r.verdict,
                     number(r.reached), flags, number(r.gain), number(r.unseen),
                     number(r.unseen_read), number(r.later), number(r.later_read), r.orders,
                     r.intervals, r.inside, r.left_out, claims, r.processor_s,
                     without_commas(r.answer));
}

std::optional<RateRecord> record_of(const std::string& line) {
  if (line.empty() || line.front() == '#' || line.starts_with("line,")) return std::nullopt;
  std::vector<std::string> f;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) f.push_back(field);
  if (!line.empty() && line.back() == ',') f.emplace_back();
  if (f.size() != kFields) return std::nullopt;
  RateRecord r{.line = f[0],
               .strength = value_of(f[1]),
               .seed = std::strtoull(f[2].c_str(), nullptr, 10),
               .plan = f[3],
               .noise = f[4],
               .laws = f[5],
               .verdict = f[6],
               .reached = value_of(f[7])};
  for (const Flag& flag : kFlags) r.*flag.value = f[8].find(flag.letter) != std::string::npos;
  r.gain = value_of(f[9]);
  r.unseen = value_of(f[10]);
  r.unseen_read = value_of(f[11]);
  r.later = value_of(f[12]);
  r.later_read = value_of(f[13]);
  r.orders = std::atoi(f[14].c_str());
  r.intervals = std::atoi(f[15].c_str());
  r.inside = std::atoi(f[16].c_str());
  r.left_out = f[17];
  std::istringstream claims(f[18]);
  for (std::string one; claims >> one;) {
    if (one.find('/') == std::string::npos) {
      r.claims.push_back({value_of(one), one.back() == '+'});
    } else {
      r.parts.push_back({one[0] == '1', one[2] == '1', value_of(one.substr(4))});
    }
  }
  r.processor_s = value_of(f[19]);
  r.answer = f[20];
  return r;
}

std::vector<RateRecord> read_rate_records(const std::vector<std::string>& files) {
  std::vector<RateRecord> records;
  std::set<std::string> keys;
  for (const std::string& name : files) {
    std::ifstream file(name);
    if (!file) throw std::runtime_error("cannot read " + name);
    for (std::string line; std::getline(file, line);) {
      auto record = record_of(line);
      if (record && keys.insert(record->key()).second) records.push_back(std::move(*record));
    }
  }
  return records;
}

}  // namespace gear3k::benchmarks
