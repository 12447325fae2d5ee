#!/usr/bin/env bash
# kt with the shell turning or staying, and with fresh or cumulative rotations: writes rotation_study.md here.
# Usage: results/published/rotation_study.sh [WORK_DIRECTORY]; a few minutes on two cores.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=${1:-$root/results/rotation_study}
mkdir -p "$work"

run() { # name shell_turns rotation
  "$root/softgrain" microsim "$root/pipelines/rotation_study.toml" --out "$work/$1" --quiet \
    --set measure.shell_turns="$2" --set measure.rotation="$3" >/dev/null || [ $? -eq 3 ]
}
compare() { # candidate reference
  "$root/softgrain" compare "$work/$1/measurements.h5" "$work/$2/measurements.h5" --out "$work/$1-$2" --quiet | grep -v '^summary'
}

run turns true fresh
run stays false fresh
run cumulative true cumulative
{
  echo "Tangential stiffness of a soft particle on a plane, 24 packings, damped relaxation; dimensionless, kt/(E Rs) and Fn/(E Rs^2)."
  echo "Made by \`results/published/rotation_study.sh\`."
  printf '\n## Shell stays (candidate) against shell turns with its grains (reference)\n\n```\n'
  compare stays turns
  printf '```\n\n## Cumulative rotation (candidate) against rotation afresh for each angle (reference)\n\n```\n'
  compare cumulative turns
  printf '```\n'
} >"$root/results/published/rotation_study.md"
