#pragma once

#ifdef __linux__
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace flies {

/// Lets other threads have the processor first, from now on: for a thread that encodes or writes what may come a moment
/// later. Threads that it starts inherit that. Nothing changes where threads have no priority of their own.
inline void yield_to_other_threads() {
#ifdef __linux__
  constexpr int kNice = 10;
  // Of the calling thread alone, against POSIX: see setpriority(2). Being refused does no harm.
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice));
  if (sched_getscheduler(0) != SCHED_OTHER) return;  // the user has said how the program is to run
  const sched_param none{};                          // a batch job does not push others aside when it wakes up
  static_cast<void>(sched_setscheduler(0, SCHED_BATCH, &none));
#endif
}

}  // namespace flies
