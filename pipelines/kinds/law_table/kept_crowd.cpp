#include "pipelines/kinds/law_table/kept_crowd.h"

#include "common/state/system_io.h"

namespace softgrain {

namespace {

void write_target(const h5::Group& group, const std::string& name, const CrowdTarget& target) {
  std::vector<double> values = target.overlap;
  values.push_back(target.slide);
  values.push_back(target.roll);
  group.write(name, values);
}

CrowdTarget read_target(const h5::Group& group, const std::string& name) {
  std::vector<double> values = group.doubles(name);
  if (values.size() < 2) throw FileTrouble("saved state: '" + name + "' is too short");
  const double roll = values.back();
  values.pop_back();
  const double slide = values.back();
  values.pop_back();
  return {std::move(values), slide, roll};
}

void write_place(const h5::Group& group, const CrowdPlace& place, const CrowdExperiment& e) {
  group.attribute("stage", static_cast<std::int64_t>(place.stage));
  group.attribute("leg", static_cast<std::int64_t>(place.leg));
  group.attribute("increments", place.increments);
  write_target(group, "stage_from", place.stage_from);
  write_target(group, "leg_from", place.leg_from);
  write_target(group, "now", e.now());
  write_crowd_runs(group.create("run"), {place.run});
  write_system(group.create("system"), e.system);
}

CrowdPlace read_place(const h5::Group& group, CrowdExperiment& e) {
  CrowdPlace place;
  place.stage = static_cast<std::size_t>(group.integer("stage"));
  place.leg = static_cast<std::size_t>(group.integer("leg"));
  place.increments = group.integer("increments");
  place.stage_from = read_target(group, "stage_from");
  place.leg_from = read_target(group, "leg_from");
  CrowdTarget now = read_target(group, "now");
  e.overlap = std::move(now.overlap);
  e.slide = now.slide;
  e.roll = now.roll;
  place.run = read_crowd_runs(group.open("run")).at(0);
  read_system(group.open("system"), e.system);
  return place;
}

}  // namespace

CrowdRun run_kept_crowd(const TaskStore& store, const std::string& name, CrowdExperiment& experiment,
                        const CrowdPlan& plan, const CrowdOptions& options,
                        const std::function<void(double share)>& progress) {
  const std::string task = name + "-under-way";
  CrowdPlace start;
  store.load(task, [&](const h5::Group& g) { start = read_place(g, experiment); });
  RunControl<CrowdUnderWay> control;
  control.seconds = store.seconds();
  control.save = [&](const CrowdUnderWay& now) {
    store.save(task, [&](const h5::Group& g) { write_place(g, now.place, now.experiment); });
  };
  if (progress) control.progress = [&](const CrowdUnderWay&, double share) { progress(share); };
  CrowdRun run = run_crowd(experiment, plan, options, control, std::move(start));
  store.remove(task);
  return run;
}

}  // namespace softgrain
