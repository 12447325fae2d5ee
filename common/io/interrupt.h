// SIGINT and SIGTERM set a flag that long loops ask for at safe points; they then save and throw Interrupted.
#pragma once

namespace softgrain {

void install_interrupt_handler();
[[nodiscard]] bool interrupt_requested();
void request_interrupt();  ///< what the handler does; for tests
void clear_interrupt();

}  // namespace softgrain
