#!/usr/bin/env bash
# How beta, which is not published, moves F(Delta) on a plane: writes beta_study.md here.
# Usage: results/published/beta_study.sh [WORK_DIRECTORY]; a few minutes of one core.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=${1:-$root/results/beta_study}
"$root/softgrain" sweep "$root/results/published/beta_study.toml" --over packing.beta=3.0,3.5,4.0,4.5,5.0 --seeds 2,3 \
  --out "$work" --quiet >/dev/null
python3 "$root/results/published/beta_study.py" "$work" >"$root/results/published/beta_study.md"
