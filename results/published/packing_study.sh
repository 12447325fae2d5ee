#!/usr/bin/env bash
# How beta, I (trials) and rmax/Rs move F(Delta), soft-solid, beside the published law: writes packing_study.md and packing_study.csv here.
# Usage: results/published/packing_study.sh [WORK_DIRECTORY]; about ten minutes on two cores.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=${1:-$root/results/packing_study}
mkdir -p "$work"

run() { # name beta trials ratio
  "$root/softgrain" microsim "$root/pipelines/packing_study.toml" --out "$work/$1" --quiet \
    --set packing.beta="$2" --set packing.trials="$3" --set packing.rmax_over_shell="$4" >/dev/null || [ $? -eq 3 ]
}

run b3.0-i10000-r0.50 3.0 10000 0.5
run b1.5-i10000-r0.50 1.5 10000 0.5
run b6.0-i10000-r0.50 6.0 10000 0.5
run b3.0-i1000-r0.50 3.0 1000 0.5
run b3.0-i100000-r0.50 3.0 100000 0.5
run b1.5-i100000-r0.50 1.5 100000 0.5
run b3.0-i10000-r0.35 3.0 10000 0.35
run b3.0-i10000-r0.65 3.0 10000 0.65

python3 "$root/results/published/packing_study.py" "$work" >"$root/results/published/packing_study.md"
