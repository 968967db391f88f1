#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <optional>
#include <string_view>

#include "cli/exit_code.hpp"
#include "cli/talk.hpp"
#include "optimize/run_forecast.hpp"

namespace gear3k::cli {

namespace {

using Clock = std::chrono::steady_clock;

// The signal handler reaches the run through this; lock-free as StopFlag is.
std::atomic<optimize::StopFlag*> stop_flag{nullptr};

// Whether results may be there already.
std::atomic<bool> results_began{false};

[[noreturn]] void exit_interrupted(std::string_view message) {
  const auto written = ::write(STDERR_FILENO, message.data(), message.size());
  static_cast<void>(written);
  ::_exit(kInterrupted);
}

extern "C" void on_interrupt_without_progress(int) {
  exit_interrupted(results_began ? "interrupted\n" : "interrupted: nothing is kept\n");
}

extern "C" void on_interrupt(int signal) {
  optimize::StopFlag* const flag = stop_flag.load();
  // One that was held until after the run: what it found is written.
  if (flag == nullptr) exit_interrupted("interrupted\n");
  *flag = true;
  std::signal(signal, SIG_DFL);
}

/// Takes the handler of a display away, where no other one holds the signal since.
void end_handler(int signal) {
  struct sigaction now {};
  ::sigaction(signal, nullptr, &now);
  if (now.sa_handler == on_interrupt) std::signal(signal, SIG_DFL);
}

std::string clock_text(double seconds) {
  const long long whole = std::llround(seconds);
  if (whole >= 3600)
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

/// "1:20", "0:40 to 2:40" where that is not known better, or "at most 12:00" where hardly at all.
std::string range_text(const optimize::RunForecast::Range& left) {
  const std::string least = clock_text(left.least_s), most = clock_text(left.most_s);
  if (left.is_one() || least == most) return clock_text(left.middle_s());
  if (left.is_bound()) return "at most " + most;
  return fmt::format("{} to {}", least, most);
}

}  // namespace

void results_begin() { results_began = true; }

void end_on_interrupt() {
  std::signal(SIGINT, on_interrupt_without_progress);
  std::signal(SIGTERM, on_interrupt_without_progress);
}

struct ProgressDisplay::State {
  optimize::Progress& progress;
  Counts counts;
  Clock::time_point start = Clock::now();
  bool terminal = ::isatty(STDERR_FILENO) != 0;
  bool bar_shown = false;
  bool shown = true;
  double front_budget_s = 0.0;
  std::optional<double> front_began_s;
  optimize::RunForecast forecast;
  std::mutex mutex;
  std::condition_variable wake;
  bool done = false;
  std::thread thread;

  State(optimize::Progress& p, Counts c) : progress(p), counts(c) {}

  [[nodiscard]] double elapsed_s() const {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// What the searches of a run are for; "" where there is one.
  static std::string of_stage(const optimize::ProgressSeen& seen) {
    using Stage = optimize::Progress::Stage;
    const std::size_t total = seen.stage_total;
    const std::size_t finished = std::min(seen.stage_done, total);
    switch (seen.stage) {
      case Stage::kOne:
        break;
      case Stage::kFrontGaps:
        return fmt::format("front, {} of {} designs in its gaps", finished, total);
      case Stage::kFrontEnds:
        return fmt::format("ends of the front, search {} of {}", std::min(finished + 1, total),
                           total);
      case Stage::kBeyond:
        return fmt::format("beyond ranges and limits, search {} of {}",
                           std::min(finished + 1, total), total);
      case Stage::kBuilt:
        return fmt::format("limits for built gearboxes, search {} of at most {}",
                           std::max<std::size_t>(1, seen.searches), total);
      case Stage::kPlanets:
        return fmt::format("best by number of planets, {} of {}", std::min(finished + 1, total),
                           total);
      case Stage::kHeldBack:
        return fmt::format("what holds the best back, {} of {}", std::min(finished + 1, total),
                           total);
      case Stage::kRelaxed:
        return fmt::format("limits left out, search {} of {}", std::min(finished + 1, total),
                           total);
    }
    return "";
  }

  /// Ends the search of a front when its time is spent.
  void keep_budget() {
    if (!progress.stop.part_is_open()) return;
    if (!front_began_s) front_began_s = elapsed_s();
    if (elapsed_s() - *front_began_s < front_budget_s) return;
    progress.stop.end_part();
  }

  void show() {
    const optimize::ProgressSeen seen = optimize::seen_of(progress);
    forecast.observe(elapsed_s(), seen);
    const std::size_t total = seen.total;
    const std::size_t finished = seen.done;
    if (total == 0) return;
    const std::string stage = of_stage(seen);
    std::optional<optimize::RunForecast::Range> left = forecast.range_left();
    if (left && front_budget_s > 0.0 && front_began_s && !stage.empty()) {
      const double of_budget_s = std::max(0.0, front_budget_s - (elapsed_s() - *front_began_s));
      left->least_s = std::min(left->least_s, of_budget_s);
      left->most_s = std::min(left->most_s, of_budget_s);
    }
    const std::string remaining = left ? range_text(*left) : "?";
    using Phase = optimize::Progress::Phase;
    const auto count_of = [&](const char* what) {
      const double per_second = forecast.per_second().value_or(0.0);
      const std::string speed = per_second >= 0.5 ? fmt::format(", {:.0f}/s", per_second) : "";
      if (stage.empty() && finished >= total) return fmt::format("{}/{} {}", finished, total, what);
      return stage.empty()
                 ? fmt::format("{}/{} {}{}, {} left", finished, total, what, speed, remaining)
                 : fmt::format("{}, {} left; {}/{} {}", stage, remaining, finished, total, what);
    };
    std::string facts;
    switch (seen.phase) {
      case Phase::kSearch:
        facts = count_of("(S, P1) pairs searched");
        break;
      case Phase::kBounds:
        facts = count_of("stages bounded");
        break;
      case Phase::kRefinement:
        facts = count_of(seen.stage == optimize::Progress::Stage::kHeldBack ? "limits moved"
                                                                            : "tooth sets refined");
        if (stage.empty()) facts += fmt::format(", {} feasible", progress.feasible.load());
        break;
      case Phase::kCertificate:
        facts = count_of("bounds sharpened");
        break;
      case Phase::kGearboxes:
        facts = count_of("gearboxes built at random");
        break;
    }
    if (counts != Counts::kOfPhase) {
      facts =
          fmt::format("{} % {}, {} left", 100 * finished / total,
                      counts == Counts::kSharesDiagnosed ? "diagnosed" : "simulated", remaining);
    }
    if (progress.feasible.load() > 0 && stage.empty()) {
      facts += fmt::format(", best {:.5g}",
                           progress.best_merit.load() * progress.shown_per_merit.load());
    }
    if (terminal) {
      constexpr std::size_t kWidth = 24;
      const std::size_t filled = kWidth * std::min(finished, total) / total;
      say_as_it_is(
          fmt::format("\r[{:#<{}}{:.<{}}] {}\033[K", "", filled, "", kWidth - filled, facts));
      bar_shown = true;
    } else {
      say(fmt::format("{}\n", facts));
    }
    std::fflush(stderr);
  }

  void watch() {
    using std::chrono::milliseconds;
    constexpr int kLook_ms = 50;           // what short phases take is told by a few looks
    const int every = terminal ? 4 : 100;  // looks between two lines
    std::unique_lock lock(mutex);
    for (int n = 1; !wake.wait_for(lock, milliseconds(kLook_ms), [this] { return done; }); ++n) {
      if (front_budget_s > 0.0) keep_budget();
      if (!shown) continue;
      if (n % every == 0) {
        show();
      } else {
        forecast.observe(elapsed_s(), optimize::seen_of(progress));
      }
    }
  }
};

ProgressDisplay::ProgressDisplay(optimize::Progress& progress, bool quiet, Counts counts,
                                 double front_budget_s)
    : state_(std::make_unique<State>(progress, counts)) {
  state_->shown = !quiet;
  state_->front_budget_s = front_budget_s;
  stop_flag = &progress.stop;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  if (!quiet || front_budget_s > 0.0)
    state_->thread = std::thread([s = state_.get()] { s->watch(); });
}

ProgressDisplay::~ProgressDisplay() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->done = true;
  }
  state_->wake.notify_all();
  if (state_->thread.joinable()) state_->thread.join();
  if (state_->bar_shown) say_as_it_is("\r\033[K");
  end_handler(SIGINT);
  end_handler(SIGTERM);
  stop_flag = nullptr;
}

double ProgressDisplay::elapsed_s() const { return state_->elapsed_s(); }

}  // namespace gear3k::cli
