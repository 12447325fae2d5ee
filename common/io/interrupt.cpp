#include "common/io/interrupt.h"

#include <csignal>
#include <string>

#include "common/core/error.h"

namespace softgrain {

namespace {

volatile std::sig_atomic_t requested = 0;

extern "C" void softgrain_note_signal(int) { requested = 1; }

}  // namespace

void install_interrupt_handler() {
  struct sigaction action {};
  action.sa_handler = softgrain_note_signal;
  // The first signal asks for an orderly end, a second one of the same kind ends the program at once.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() { return requested != 0; }
void request_interrupt() { requested = 1; }
void clear_interrupt() { requested = 0; }

void stop_if_interrupted(const char* doing) {
  if (interrupt_requested())
    throw Interrupted(std::string("stopped by a signal while ") + doing + "; go on with --resume");
}

}  // namespace softgrain
