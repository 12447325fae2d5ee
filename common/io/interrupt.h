// SIGINT and SIGTERM set a flag that long loops ask for at safe points; they then save and throw Interrupted.
#pragma once

namespace softgrain {

void install_interrupt_handler();
/// Makes both signals end the program at once, with status 130, whatever it waits for. For commands that have nothing
/// to save.
void end_at_once_on_signals();
[[nodiscard]] bool interrupt_requested();
void request_interrupt();  ///< what the handler does; for tests
void clear_interrupt();

/// Throws Interrupted when a signal came. For loops that take long between two moments worth saving: what they were
/// at is lost, what was saved before is not. `doing` completes "stopped by a signal while ...". Not inside a parallel
/// region, which exceptions must not leave.
void stop_if_interrupted(const char* doing);

}  // namespace softgrain
