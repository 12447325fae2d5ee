// Commands that have nothing to save end at once at SIGINT and SIGTERM, whatever they are at, and leave nothing that
// looks like a result; no command waits for ever for somebody to read what it says.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "common/data/snapshot_io.h"
#include "tests/support/disturbed_run.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

/// Inputs that keep each command busy for about half a second of processor time or more.
class LongInputs {
 public:
  LongInputs() {
    for (const char* directory : {"drawn", "compared", "states"}) fs::create_directories(file(directory));
    save_macro(curves(20), file("drawn/macro.h5"), {});
    save_macro(curves(150), file("compared/macro.h5"), {});
    save_snapshots(std::vector<Snapshot>(8, state()), file("states/states_macro.h5"), {});
    std::string rows = "sample,hn [mm],Fn [N]\n";
    for (int sample = 0; sample < 6; ++sample)
      for (int k = 1; k <= 50000; ++k) {
        const double hn = 8e-5 * k;
        const double force = std::pow(std::max(hn - 0.3, 0.0), 1.5) * (1.0 + 0.1 * synthetic::wobble(sample, 2));
        rows += fmt::format("{},{:.5f},{:.6f}\n", sample, hn, force + 0.05 * synthetic::wobble(k, sample));
      }
    write_text_atomic(file("curve.csv"), rows);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }

 private:
  static std::vector<MacroCurve> curves(int samples) {
    std::vector<MacroCurve> curves;
    for (int sample = 0; sample < samples; ++sample)
      for (const char* engine : {"law", "shelled"})
        curves.push_back(synthetic::macro_curve(engine, sample, 0.8 + 1e-3 * sample, 401));
    return curves;
  }
  static Snapshot state() {
    Snapshot s;
    s.kind = SnapshotKind::macro;
    s.series = "law-0";
    for (int k = 0; k < 20000; ++k) {
      SnapshotParticle p;
      p.position = {{0.1 * k, 0.2 * k, 0.3 * k}};
      p.radius = 0.05;
      p.id = p.body = k;
      s.particles.push_back(p);
    }
    return s;
  }

  TemporaryDirectory directory_;
};

struct Busy {
  std::vector<std::string> words;
  std::vector<std::string> results;  ///< what is there once it has ended
  std::string over_earlier = {};     ///< directory where those of an earlier call lie, which it takes away
};

/// Files of a directory and when each was written.
std::map<std::string, fs::file_time_type> files_of(const std::string& directory) {
  std::map<std::string, fs::file_time_type> files;
  if (directory.empty()) return files;
  for (const auto& entry : fs::directory_iterator(directory)) files[entry.path()] = entry.last_write_time();
  return files;
}

/// Ended by the signal in the middle of its work, of which all takes `whole` seconds of processor time; one that was
/// quicker is started again. One that was stopped before it touched what an earlier call left leaves all of that.
void expect_to_end_at_once(const Busy& busy, double whole, int signal) {
  double delay = 0.4 * whole;
  for (int tries = 0; tries < 5; ++tries, delay *= 0.6) {
    for (const std::string& result : busy.results)
      if (busy.over_earlier.empty()) fs::remove(result);
    const auto earlier = files_of(busy.over_earlier);
    const Signalled ended = signalled_after(start_program(busy.words), delay, signal);
    if (!ended_with(ended.status, 130)) continue;
    EXPECT_LT(ended.after, 0.3 * whole + 0.2) << "it went on with its work";
    const bool untouched = !busy.over_earlier.empty() && files_of(busy.over_earlier) == earlier;
    for (const std::string& result : busy.results) EXPECT_TRUE(untouched || !fs::exists(result)) << result;
    return;
  }
  ADD_FAILURE() << "went on to its end, whatever the signal";
}

TEST(Signals, EndCommandsThatSaveNothingAtOnce) {
  const LongInputs in;
  const auto file = [&](const std::string& name) { return in.file(name); };
  const std::vector<Busy> commands{
      {{"report", file("drawn")}, {file("drawn/report.html")}},
      {{"compare", file("compared"), file("compared"), "--out", file("comparison")}, {file("comparison/summary.json")}},
      {{"export", file("states"), "--to", "csv", "--out", file("exported")},
       {file("exported/law-0.csv")},
       file("exported")},
      {{"calibrate", file("curve.csv"), "--kind", "soft-solid", "--radius", "16 mm", "--modulus", "1 MPa", "--quiet",
        "--out", file("fitted")},
       {file("fitted/law.toml"), file("fitted/summary.json")}},
  };
  for (const Busy& busy : commands) {
    SCOPED_TRACE(busy.words.front());
    const double whole = child_seconds_of([&] { ASSERT_TRUE(WIFEXITED(wait_for(start_program(busy.words)))); });
    for (const std::string& result : busy.results) EXPECT_TRUE(fs::exists(result)) << result;
    for (const int signal : {SIGINT, SIGTERM}) expect_to_end_at_once(busy, whole, signal);
  }
}

/// A pipe that takes no byte more, and that nobody reads.
class FullPipe {
 public:
  FullPipe() {
    EXPECT_EQ(::pipe2(ends_.data(), O_NONBLOCK), 0);
    while (::write(ends_[1], "x", 1) == 1) {
    }
    ::fcntl(ends_[1], F_SETFL, 0);
  }
  ~FullPipe() {
    for (const int end : ends_) ::close(end);
  }
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;
  [[nodiscard]] std::function<void()> as_output() const {
    return [out = ends_[1]] { ::dup2(out, STDOUT_FILENO); };
  }

 private:
  std::array<int, 2> ends_{};
};

constexpr int kStillThere = -1;

/// The wait status of a program that ends within so many seconds.
int status_within(double seconds, pid_t child) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  int status = 0;
  while (std::chrono::steady_clock::now() < end) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    ::usleep(1000);
  }
  return kStillThere;
}

TEST(Signals, AreAnsweredWhereNobodyReadsWhatIsSaid) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.05"), 0});
  const std::string run = runs.out("run");
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("run"))), 0));
  const std::vector<std::vector<std::string>> commands{
      runs.arguments("again"), {"report", run}, {"export", run, "--to", "csv"}, {"law", "show", runs.out("law.toml")}};
  const FullPipe full;
  for (const auto& words : commands) {
    const pid_t child = start_program(words, full.as_output());
    EXPECT_EQ(status_within(1.5, child), kStillThere) << words.front();
    ::kill(child, SIGTERM);
    const int status = status_within(std::chrono::duration<double>(kLongestWait).count(), child);
    EXPECT_TRUE(status != kStillThere && ended_with(status, 130)) << words.front() << " " << status;
    if (status != kStillThere) continue;
    ::kill(child, SIGKILL);
    (void)wait_for(child);
  }
}

}  // namespace
