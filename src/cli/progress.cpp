#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <string_view>

#include "cli/exit_code.hpp"
#include "cli/talk.hpp"
#include "optimize/work_rate.hpp"

namespace gear3k::cli {

namespace {

using Clock = std::chrono::steady_clock;

// The signal handler reaches the run through this; lock-free by the standard's atomic<bool> here.
std::atomic<std::atomic<bool>*> stop_flag{nullptr};

extern "C" void on_interrupt(int signal) {
  if (std::atomic<bool>* flag = stop_flag.load()) *flag = true;
  std::signal(signal, SIG_DFL);
}

extern "C" void on_interrupt_without_progress(int) {
  constexpr std::string_view kMessage = "interrupted\n";
  const auto written = ::write(STDERR_FILENO, kMessage.data(), kMessage.size());
  static_cast<void>(written);
  ::_exit(kInterrupted);
}

std::string clock_text(double seconds) {
  const long long whole = std::llround(seconds);
  if (whole >= 3600)
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

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
  optimize::Progress::Phase shown_phase = optimize::Progress::Phase::kSearch;
  optimize::WorkRate rate;  ///< of the phase
  optimize::Progress::Stage shown_stage = optimize::Progress::Stage::kOne;
  Clock::time_point stage_start = start, search_start = start;
  std::size_t shown_searches = 0;
  std::size_t shown_done = 0;
  std::mutex mutex;
  std::condition_variable wake;
  bool done = false;
  std::thread thread;

  State(optimize::Progress& p, Counts c) : progress(p), counts(c) { rate.restart(0.0, 0); }

  [[nodiscard]] double elapsed_s() const {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// What is left of a stage of several searches: the rest of the one that runs, by how many of
  /// its tooth sets are done, and the others at the mean of those that were begun.
  [[nodiscard]] std::string stage_left(std::size_t finished, std::size_t total) {
    const std::size_t begun = progress.searches.load();
    const Clock::time_point now = Clock::now();
    if (begun != shown_searches) {
      shown_searches = begun;
      search_start = now;
    }
    const auto seconds = [&](Clock::time_point since) {
      return std::chrono::duration<double>(now - since).count();
    };
    if (begun == 0) return "?";
    const auto ready = static_cast<double>(progress.done.load());
    const auto all = static_cast<double>(progress.total.load());
    const bool refines = progress.phase.load() == optimize::Progress::Phase::kRefinement;
    const double rest =
        refines && ready > 0.0 ? seconds(search_start) * (all - ready) / ready : 0.0;
    const double mean = (seconds(stage_start) + rest) / static_cast<double>(begun);
    const double each =
        progress.stage.load() != optimize::Progress::Stage::kFrontGaps
            ? 1.0
            : static_cast<double>(begun) / std::max(1.0, static_cast<double>(finished));
    const double more = std::max(0.0, static_cast<double>(total - finished) * each - 1.0);
    return clock_text(rest + mean * more);
  }

  /// What the searches of a run are for, with the time that is left; "" where there is one.
  std::string of_stage() {
    using Stage = optimize::Progress::Stage;
    const Stage stage = progress.stage.load();
    if (stage != shown_stage) {
      shown_stage = stage;
      stage_start = Clock::now();
    }
    if (stage == Stage::kOne) return "";
    const std::size_t total = progress.stage_total.load();
    const std::size_t finished = std::min(progress.stage_done.load(), total);
    const std::string left = stage_left(finished, total);
    if (stage == Stage::kFrontGaps) {
      return fmt::format("front, {} of {} designs in its gaps, {} left", finished, total, left);
    }
    return fmt::format("{}, search {} of {}, {} left",
                       stage == Stage::kFrontEnds ? "ends of the front" : "beyond ends of ranges",
                       std::min(finished + 1, total), total, left);
  }

  void show() {
    const std::size_t total = progress.total.load();
    const std::size_t finished = progress.done.load();
    if (total == 0) return;
    // Rates are those of the phase: refinement starts its own clock.
    if (progress.phase.load() != shown_phase || finished < shown_done) {
      shown_phase = progress.phase.load();
      shown_done = finished;
      rate.restart(elapsed_s(), finished);
      return;
    }
    shown_done = finished;
    rate.observe(elapsed_s(), finished);
    const std::string stage = of_stage();
    const std::optional<double> left = rate.seconds_left(total);
    const std::string remaining = left ? clock_text(*left) : "?";
    using Phase = optimize::Progress::Phase;
    const Phase phase = progress.phase.load();
    const auto count_of = [&](const char* what) {
      return stage.empty() ? fmt::format("{}/{} {}, {:.0f}/s, {} left", finished, total, what,
                                         rate.per_second().value_or(0.0), remaining)
                           : fmt::format("{}; {}/{} {}", stage, finished, total, what);
    };
    std::string facts;
    switch (phase) {
      case Phase::kSearch:
        facts = count_of("(S, P1) pairs searched");
        break;
      case Phase::kBounds:
        facts = count_of("stages bounded");
        break;
      case Phase::kRefinement:
        facts = count_of("tooth sets refined");
        if (stage.empty()) facts += fmt::format(", {} feasible", progress.feasible.load());
        break;
      case Phase::kCertificate:
        facts = count_of("bounds sharpened");
        break;
      case Phase::kGearboxes:
        facts = count_of("gearboxes built at random");
        break;
    }
    if (counts == Counts::kSharesDiagnosed) {
      facts = fmt::format("{} % diagnosed, {} left", 100 * finished / total, remaining);
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
    const auto interval = terminal ? milliseconds(200) : milliseconds(5000);
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, interval, [this] { return done; })) show();
  }
};

ProgressDisplay::ProgressDisplay(optimize::Progress& progress, bool quiet, Counts counts)
    : state_(std::make_unique<State>(progress, counts)) {
  stop_flag = &progress.stop;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  if (!quiet) state_->thread = std::thread([s = state_.get()] { s->watch(); });
}

ProgressDisplay::~ProgressDisplay() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->done = true;
  }
  state_->wake.notify_all();
  if (state_->thread.joinable()) state_->thread.join();
  if (state_->bar_shown) say_as_it_is("\r\033[K");
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  stop_flag = nullptr;
}

double ProgressDisplay::elapsed_s() const { return state_->elapsed_s(); }

}  // namespace gear3k::cli
