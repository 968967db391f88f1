#include "io/text/held_signals.hpp"

#include <algorithm>

namespace gear3k::io {

namespace {

std::recursive_mutex one_holder;
constexpr int kMostSignals = 32;
std::array<volatile std::sig_atomic_t, kMostSignals> came{};

void remember_signal(int signal) { came[static_cast<std::size_t>(signal)] = 1; }

}  // namespace

HeldSignals::HeldSignals() : only_one_(one_holder) {
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    ::sigaction(kSignals[k], nullptr, &before_[k]);
    if (before_[k].sa_handler == SIG_IGN || before_[k].sa_handler == remember_signal) continue;
    came[static_cast<std::size_t>(kSignals[k])] = 0;
    struct sigaction hold {};
    hold.sa_handler = remember_signal;
    hold.sa_flags = SA_RESTART;
    ::sigaction(kSignals[k], &hold, nullptr);
  }
}

HeldSignals::~HeldSignals() {
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    // Within another holder nothing was set.
    if (before_[k].sa_handler == remember_signal) continue;
    ::sigaction(kSignals[k], &before_[k], nullptr);
    const auto signal = static_cast<std::size_t>(kSignals[k]);
    if (came[signal] == 0) continue;
    came[signal] = 0;
    std::raise(kSignals[k]);
  }
}

}  // namespace gear3k::io
