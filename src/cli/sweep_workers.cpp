#include "cli/sweep_workers.hpp"

#include <fmt/format.h>
#include <omp.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <exception>
#include <system_error>
#include <vector>

#include "app/sweep.hpp"
#include "cli/exit_code.hpp"
#include "cli/talk.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/toml_value.hpp"
#include "sweep/store.hpp"
#include "sweep/task.hpp"

namespace gear3k::cli {

namespace {

using sweep::Database, sweep::Process, sweep::Store;

// Signal handlers reach the run through these; lock-free, as atomics of these types are here.
std::atomic<bool> sweep_stop{false};
std::atomic<optimize::StopFlag*> task_stop{nullptr};

extern "C" void stop_sweep(int signal) {
  sweep_stop = true;
  if (optimize::StopFlag* flag = task_stop.load()) *flag = true;
  // A second one ends the process at once.
  std::signal(signal, SIG_DFL);
}

void listen_for_stop() {
  std::signal(SIGINT, stop_sweep);
  std::signal(SIGTERM, stop_sweep);
}

Store open_store(const std::string& path) {
  return Store(sweep::open_sweep_database(path, Database::Access::kWrite));
}

double cpu_s() {
  rusage use{};
  ::getrusage(RUSAGE_SELF, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

/// Whether the files that a task names are those of its key.
bool has_its_files(const sweep::Claimed& claimed) {
  const io::TomlValue spec = io::parse_toml(claimed.spec, "task");
  return !sweep::has_files(spec) || sweep::task_of(spec).key == claimed.key;
}

/// Takes tasks and records what became of them until none is left or it is to stop.
void work(const SweepWork& sweep) {
  // Not as many as there are processors, which the workers share.
  omp_set_num_threads(sweep.threads);
  Store store = open_store(sweep.database);
  const Process self = sweep::this_process();
  while (!sweep_stop) {
    const auto claimed = store.claim(sweep.run, self, now_s());
    if (!claimed) return;
    if (!has_its_files(*claimed)) {
      store.release(claimed->id, self);
      throw io::InvalidInput(
          "a file of [actuator] or [cycle] has changed since the tasks were put into the queue: "
          "allowed: the same command anew, which asks for the tasks of the new files");
    }
    optimize::Progress progress;
    task_stop = &progress.stop;
    if (sweep_stop) progress.stop = true;
    const double before_s = cpu_s();
    const sweep::TaskResult result = app::solve_task(claimed->spec, progress);
    task_stop = nullptr;
    if (result.interrupted) {
      store.release(claimed->id, self);
      return;
    }
    store.finish(claimed->id, result,
                 {.run = sweep.uid,
                  .host = sweep::host_name(),
                  .finished_s = now_s(),
                  .cpu_s = cpu_s() - before_s});
  }
}

/// Whether a signal is the program's own failure.
bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGFPE ||
         signal == SIGILL;
}

class Supervisor {
 public:
  explicit Supervisor(const SweepWork& sweep) : sweep_(sweep) {
    if (::pipe(pipe_.data()) != 0) {
      throw std::system_error(errno, std::generic_category(), "pipe");
    }
  }
  ~Supervisor() {
    for (const int end : pipe_) ::close(end);
  }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  Supervisor(Supervisor&&) = delete;
  Supervisor& operator=(Supervisor&&) = delete;

  SweepEnd run() {
    const auto most = static_cast<std::size_t>(sweep_.workers);
    std::int64_t open = open_tasks();
    first_open_ = open;
    while (workers_.size() < std::min(most, static_cast<std::size_t>(open))) start();
    while (!workers_.empty()) {
      wait_a_little();
      look_after_time();
      bool lost = false;
      for (std::size_t k = 0; k < workers_.size();) lost = has_ended(k) || lost;
      if (lost && !stopping_) {
        open = open_tasks();
        while (workers_.size() < std::min(most, static_cast<std::size_t>(open))) start();
      }
    }
    read_failures();
    end_.open = open_tasks();
    if (bar_shown_) say_as_it_is("\n");
    return end_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::int64_t open_tasks() const {
    return open_store(sweep_.database).open_tasks(sweep_.run);
  }

  void start() {
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (child > 0) {
      workers_.push_back(sweep::process_of(child));
      return;
    }
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(kDone);
    ::close(pipe_[0]);
    ExitCode code = kDone;
    try {
      work(sweep_);
    } catch (const std::exception& error) {
      const std::string line = std::string(error.what()) + "\n";
      code = ::write(pipe_[1], line.data(), line.size()) < 0 ? kSolverFailure : kInvalidInput;
    }
    ::_exit(code);
  }

  void wait_a_little() {
    constexpr int kMilliseconds = 50;
    pollfd readable{.fd = pipe_[0], .events = POLLIN, .revents = 0};
    if (::poll(&readable, 1, kMilliseconds) > 0) read_failures();
  }

  void read_failures() {
    pollfd readable{.fd = pipe_[0], .events = POLLIN, .revents = 0};
    while (::poll(&readable, 1, 0) > 0 && (readable.revents & POLLIN) != 0) {
      std::array<char, 4096> bytes{};
      const auto count = ::read(pipe_[0], bytes.data(), bytes.size());
      if (count <= 0) break;
      if (end_.failure.empty()) {
        const std::string text(bytes.data(), static_cast<std::size_t>(count));
        end_.failure = text.substr(0, text.find('\n'));
      }
    }
    if (!end_.failure.empty()) stop();
  }

  void stop() {
    if (stopping_) return;
    stopping_ = true;
    for (const Process& worker : workers_) ::kill(static_cast<pid_t>(worker.number), SIGTERM);
  }

  void look_after_time() {
    const Clock::time_point now = Clock::now();
    const auto since = [&](Clock::time_point then) {
      return std::chrono::duration<double>(now - then).count();
    };
    if (sweep_stop) {
      end_.interrupted = true;
      stop();
    } else if (sweep_.most_s && since(start_) > *sweep_.most_s) {
      end_.out_of_time = true;
      stop();
    }
    if (since(renewed_) > sweep::kLeaseSeconds / 4.0) {
      renewed_ = now;
      open_store(sweep_.database).renew(workers_, now_s());
    }
    const double pause_s = terminal_ ? 0.5 : 10.0;
    if (!sweep_.quiet && since(shown_) > pause_s) {
      shown_ = now;
      show(since(start_));
    }
  }

  void show(double elapsed_s) {
    const std::int64_t open = open_tasks();
    const std::int64_t done = first_open_ - open;
    const double rate = static_cast<double>(done) / elapsed_s;
    const std::string left =
        done > 0 ? fmt::format("{:.0f} s left", static_cast<double>(open) / rate) : "? left";
    const std::string line = fmt::format("{}/{} tasks, {:.3g}/s, {}, {} workers", done, first_open_,
                                         rate, left, workers_.size());
    say_as_it_is(terminal_ ? fmt::format("\r{}\033[K", line) : line + "\n");
    bar_shown_ = terminal_;
  }

  /// Buries a worker that has ended.  @returns whether it had; the next one then has its place
  bool has_ended(std::size_t& k) {
    int status = 0;
    const auto number = static_cast<pid_t>(workers_[k].number);
    const pid_t ended = ::waitpid(number, &status, WNOHANG);
    const bool gone = ended < 0 && errno == ECHILD;  // somebody else has waited for it
    if (ended != number && !gone) {
      ++k;
      return false;
    }
    const Process worker = workers_[k];
    workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(k));
    if (WIFSIGNALED(status)) {
      const int signal = WTERMSIG(status);
      open_store(sweep_.database)
          .bury(
              worker, {.signal = stopping_ || sweep_stop ? 0 : signal, .crash = is_crash(signal)},
              {.run = sweep_.uid, .host = sweep::host_name(), .finished_s = now_s(), .cpu_s = 0.0});
      return true;
    }
    // It has ended as there was nothing for it to take, or said why it could not.
    if (WEXITSTATUS(status) != kDone) {
      read_failures();
      if (end_.failure.empty()) {
        end_.failure = fmt::format("a worker ended with exit code {}", WEXITSTATUS(status));
      }
      stop();
    }
    return false;
  }

  const SweepWork& sweep_;
  std::array<int, 2> pipe_{};
  std::vector<Process> workers_;
  SweepEnd end_;
  bool stopping_ = false;
  bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  bool bar_shown_ = false;
  std::int64_t first_open_ = 0;
  Clock::time_point start_ = Clock::now(), renewed_ = start_, shown_ = start_;
};

}  // namespace

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

bool sweep_interrupted() {
  static const bool listening = [] {
    listen_for_stop();
    return true;
  }();
  return listening && sweep_stop;
}

SweepEnd work_on_sweep(const SweepWork& work) { return Supervisor(work).run(); }

}  // namespace gear3k::cli
