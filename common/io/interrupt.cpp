#include "common/io/interrupt.h"

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// Set by the handler, which runs on one thread, and read by all of them: sig_atomic_t would be a race.
std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a handler must not wait for a lock");

extern "C" void softgrain_note_signal(int) { requested = true; }

/// Says why, unless that would have to wait for somebody to read it.
extern "C" void softgrain_end_at_once(int) {
  constexpr char kWhy[] = "softgrain: stopped by a signal\n";
  pollfd errors{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&errors, 1, 0) > 0) (void)!::write(STDERR_FILENO, kWhy, sizeof kWhy - 1);
  ::_exit(static_cast<int>(ExitStatus::interrupted));
}

void install(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  // The first signal asks for an orderly end, a second one of the same kind ends the program at once.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

void install_interrupt_handler() { install(softgrain_note_signal); }
void end_at_once_on_signals() { install(softgrain_end_at_once); }

bool interrupt_requested() { return requested; }
void request_interrupt() { requested = true; }
void clear_interrupt() { requested = false; }

void stop_if_interrupted(const char* doing) {
  if (interrupt_requested())
    throw Interrupted(std::string("stopped by a signal while ") + doing + "; go on with --resume");
}

}  // namespace softgrain
