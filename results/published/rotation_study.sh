#!/usr/bin/env bash
# kt by a slow turn beside the published stiffness, and what the shell, the path and the speed of the turn make of it: writes
# rotation_study.md, rotation_study.csv and the pictures here. Usage: results/published/rotation_study.sh [WORK_DIRECTORY]; ten minutes of one core.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=${1:-$root/results/rotation_study}
mkdir -p "$work"

run() { # name and overrides; status 3: a few points did not converge
  local name=$1
  shift
  "$root/softgrain" microsim "$root/pipelines/rotation_study.toml" --out "$work/$name" --quiet "$@" >/dev/null || [ $? -eq 3 ]
}
# Variants on the first of the same packings, on a plane alone.
variant() {
  run "$@" --set packing.count=6 --set measure.soft_soft.deltas='[0.05]' --set measure.soft_soft.tangential_deltas='[]'
}
compare() { # candidate reference
  "$root/softgrain" compare "$work/$1" "$work/$2" --out "$work/$1-$2" --different --quiet >/dev/null
}

run turns
for angle in 0.5 1 2; do # the secant at each angle is that of the card beside the measurements
  "$root/softgrain" calibrate "$work/turns/measurements.h5" --set secant_angle_deg=$angle --out "$work/angle-$angle" --quiet >/dev/null || [ $? -eq 3 ]
  cp "$work/turns/measurements.h5" "$work/angle-$angle/"
  compare "angle-$angle" "angle-$angle"
done
variant few
variant stays --set measure.shell_turns=false
variant cumulative --set measure.rotation=cumulative
variant slower --set measure.turn_speed=0.0005
for name in stays cumulative slower; do compare $name few; done
python3 "$root/results/published/rotation_study.py" "$work"
