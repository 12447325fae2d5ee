#include "common/dynamics/core_use.h"

#include <omp.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

namespace softgrain {

namespace {

namespace fs = std::filesystem;

constexpr double kNanosecond = 1e-9;

/// The first numbers of /proc/PID/task/TID/schedstat: nanoseconds on a core and on a run queue. All are 0 where the
/// kernel does not count them.
struct CoreTime {
  std::uint64_t running = 0;
  std::uint64_t queued = 0;
};

std::optional<CoreTime> core_time(const fs::path& task) {
  std::ifstream in(task / "schedstat");
  CoreTime out;
  if (!(in >> out.running >> out.queued)) return std::nullopt;
  return out;
}

/// Idle time of one line of /proc/stat, waits for disks included: "cpu3 user nice system idle iowait ...".
double idle_of_line(const std::string& line) {
  std::istringstream words(line);
  std::string name;
  double user = 0.0;
  double nice = 0.0;
  double system = 0.0;
  double idle = 0.0;
  double disks = 0.0;
  words >> name >> user >> nice >> system >> idle >> disks;
  return words ? idle + disks : 0.0;
}

/// Cores of all threads. Where OpenMP binds threads to places, the calling thread is allowed one of these alone.
cpu_set_t allowed_cores() {
  cpu_set_t out;
  CPU_ZERO(&out);
  if (omp_get_proc_bind() == omp_proc_bind_false || omp_get_num_places() == 0) {
    if (sched_getaffinity(0, sizeof(out), &out) != 0) CPU_ZERO(&out);
    return out;
  }
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> cores(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, cores.data());
    for (const int core : cores)
      if (core >= 0 && core < CPU_SETSIZE) CPU_SET(static_cast<unsigned>(core), &out);
  }
  return out;
}

std::optional<double> idle_so_far() {
  const cpu_set_t allowed = allowed_cores();
  const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
  std::ifstream in("/proc/stat");
  if (CPU_COUNT(&allowed) == 0 || !(ticks > 0.0) || !in) return std::nullopt;
  double idle = 0.0;
  int cores = 0;
  for (std::string line; std::getline(in, line) && line.starts_with("cpu");) {
    int number = -1;
    std::from_chars(line.data() + 3, line.data() + line.size(), number);
    if (number < 0 || number >= CPU_SETSIZE || !CPU_ISSET(static_cast<unsigned>(number), &allowed)) continue;
    idle += idle_of_line(line);
    ++cores;
  }
  if (cores < CPU_COUNT(&allowed)) return std::nullopt;
  return idle / ticks;
}

}  // namespace

std::optional<double> CoreWaits::since_last() {
  std::vector<OfThread> now;
  std::error_code error;
  bool counted = false;
  for (fs::directory_iterator task("/proc/self/task", error), end; !error && task != end; task.increment(error)) {
    const std::string name = task->path().filename().string();
    OfThread thread;
    std::from_chars(name.data(), name.data() + name.size(), thread.id);
    const auto so_far = core_time(task->path());
    if (!so_far) continue;  // it has just ended
    thread.waited = kNanosecond * static_cast<double>(so_far->queued);
    counted = counted || so_far->running > 0;
    now.push_back(thread);
  }
  if (error || !counted) return std::nullopt;
  double sum = 0.0;
  for (const OfThread& thread : now) {
    const auto before =
        std::find_if(threads_.begin(), threads_.end(), [&](const OfThread& t) { return t.id == thread.id; });
    sum += thread.waited - (before != threads_.end() ? std::min(before->waited, thread.waited) : 0.0);
  }
  threads_ = std::move(now);
  return sum;
}

std::optional<double> IdleCores::since_last() {
  const auto now = idle_so_far();
  const auto before = before_;
  before_ = now;
  if (!now || !before) return std::nullopt;
  return std::max(0.0, *now - *before);
}

}  // namespace softgrain
