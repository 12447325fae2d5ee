#!/usr/bin/env bash
# Error against cost of every relaxation, on 24 packings that no setting was chosen on: writes the CSV files and the picture of
# this folder. Usage: results/relaxation/study.sh [WORK_DIRECTORY]; an hour and a half on two cores, most of it the reference.
# Finished runs in WORK_DIRECTORY are kept.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
program=${SOFTGRAIN:-$root/softgrain} # another build of the program may be given
work=${1:-$root/results/relaxation_study}
mkdir -p "$work"

run() { # name, then key=value ...
  local name=$1 options=() setting
  shift
  for setting in "$@"; do options+=(--set "$setting"); done
  [ -f "$work/$name/summary.json" ] ||
    "$program" microsim "$root/pipelines/relaxation_study.toml" --out "$work/$name" --resume --quiet \
      "${options[@]}" >/dev/null || [ $? -eq 3 ]
  [ "$name" = published ] ||
    "$program" compare "$work/$name/measurements.h5" "$work/published/measurements.h5" \
      --out "$work/$name-compared" --json --quiet >"$work/$name.json"
}

run published measure.relaxation=published
run least-work
run half-increment measure.least_work.increment=0.00125
run short-path-settling measure.least_work.path_settle_time=16
run no-settling measure.least_work.settle_time=0 measure.least_work.settle_time_rotated=0
run dynamics-only measure.least_work.increment_passes=0
run dynamics-finer measure.least_work.increment_passes=0 measure.least_work.step_factor=2
run damped measure.relaxation=damped
# Tangential stiffness on a plane alone, on more packings, in parts that can be left out.
for seed in 3001 3002 3003; do
  [ -f "$work/stiffness-$seed/summary.json" ] ||
    "$program" microsim "$root/results/relaxation/stiffness_study.toml" --seed $seed --out "$work/stiffness-$seed" --resume --quiet \
      >/dev/null || [ $? -eq 3 ]
done
# With several neighbours.
multi_contact() { # name, then key=value ...
  local name=$1 options=() setting
  shift
  for setting in "$@"; do options+=(--set "$setting"); done
  [ -f "$work/$name/summary.json" ] ||
    "$program" run "$root/results/relaxation/multi_contact_study.toml" --out "$work/$name" --resume --quiet "${options[@]}" >/dev/null ||
    [ $? -eq 3 ]
}
multi_contact multi-contact-scenes
multi_contact multi-contact-finer multi_contact.step_factor=2 multi_contact.settle_time=480
multi_contact multi-contact-longer multi_contact.settle_time=480
multi_contact multi-contact-short multi_contact.step_factor=2 multi_contact.settle_time=120
multi_contact multi-contact-damped multi_contact.relaxation=damped
multi_contact multi-contact-damped-half multi_contact.relaxation=damped multi_contact.increment=0.0025
multi_contact multi-contact-published multi_contact.relaxation=published
python3 "$root/results/relaxation/multi_contact.py" "$work"
python3 "$root/results/relaxation/collect.py" "$work"
