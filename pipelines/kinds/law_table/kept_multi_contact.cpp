#include "pipelines/kinds/law_table/multi_contact_stage.h"

#include "common/core/error.h"
#include "common/data/attributes.h"
#include "common/state/system_io.h"

namespace softgrain {

/// Without its run and its positions.
void fields(auto&& visit, Of<MultiContactPlace> auto& p) {
  visit("stage", p.stage);
  visit("leg", p.leg);
  visit("increments", p.increments);
}

namespace {

void write_target(const h5::Group& group, const std::string& name, const MultiContactTarget& target) {
  std::vector<double> values = target.overlap;
  values.push_back(target.slide);
  values.push_back(target.roll);
  group.write(name, values);
}

MultiContactTarget read_target(const h5::Group& group, const std::string& name) {
  std::vector<double> values = group.doubles(name);
  if (values.size() < 2) throw IoError("saved state: '" + name + "' is too short");
  const double roll = values.back();
  values.pop_back();
  const double slide = values.back();
  values.pop_back();
  return {std::move(values), slide, roll};
}

void write_place(const h5::Group& group, const MultiContactPlace& place, const MultiContactExperiment& e) {
  write_attributes(group, place);
  write_target(group, "stage_from", place.stage_from);
  write_target(group, "leg_from", place.leg_from);
  write_target(group, "now", e.now());
  write_multi_contact_runs(group.create("run"), {place.run});
  write_system(group.create("system"), e.system);
}

MultiContactPlace read_place(const h5::Group& group, MultiContactExperiment& e) {
  MultiContactPlace place;
  read_attributes(group, place);
  place.stage_from = read_target(group, "stage_from");
  place.leg_from = read_target(group, "leg_from");
  MultiContactTarget now = read_target(group, "now");
  e.overlap = std::move(now.overlap);
  e.slide = now.slide;
  e.roll = now.roll;
  place.run = read_multi_contact_runs(group.open("run")).at(0);
  read_system(group.open("system"), e.system);
  return place;
}

/// Neither its name nor what it is used for changes what is measured.
MultiContactConfiguration without_name(MultiContactConfiguration configuration) {
  const MultiContactConfiguration none;
  configuration.name = none.name;
  configuration.held_out = none.held_out;
  return configuration;
}

}  // namespace

std::string multi_contact_run_key(const SoftParticleSpec& spec, const MultiContactConfiguration& configuration,
                                  const MultiContactPlan& plan, const MultiContactOptions& options,
                                  const std::string& contents) {
  return KeyText("crowd run", kMultiContactSchema, spec, without_name(configuration), plan, options, contents).text();
}

const KeptForm<MultiContactRun>& kept_multi_contact_run() {
  static const KeptForm<MultiContactRun> form{
      "crowd-run", "crowd", "measured again",
      [](const h5::Group& group) {
        std::vector<MultiContactRun> runs = read_multi_contact_runs(group);
        if (runs.size() != 1) throw IoError("damaged: holds no single run");
        return std::move(runs.front());
      },
      [](const h5::Group& group, const MultiContactRun& run) { write_multi_contact_runs(group, {run}); }};
  return form;
}

MultiContactRun run_kept_multi_contact(const TaskStore& store, const std::string& name,
                                       MultiContactExperiment& experiment, const MultiContactPlan& plan,
                                       const MultiContactOptions& options,
                                       const std::function<void(double share)>& progress) {
  const std::string task = name + "-under-way";
  MultiContactPlace start;
  store.load(task, [&](const h5::Group& g) { start = read_place(g, experiment); });
  RunControl<MultiContactUnderWay> control;
  control.seconds = store.seconds();
  control.save = [&](const MultiContactUnderWay& now) {
    store.save(task, [&](const h5::Group& g) { write_place(g, now.place, now.experiment); });
  };
  if (progress) control.progress = [&](const MultiContactUnderWay&, double share) { progress(share); };
  MultiContactRun run = run_multi_contact(experiment, plan, options, control, std::move(start));
  store.remove(task);
  return run;
}

}  // namespace softgrain
