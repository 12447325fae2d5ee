#!/bin/bash
# Runs one fuzz target for so many seconds of processor time:
#   tests/fuzz/run.sh PROGRAM SECONDS DIRECTORY [options of libFuzzer]
# PROGRAM is .../fuzz_scene, fuzz_law, fuzz_particles, fuzz_csv or fuzz_hdf5. DIRECTORY takes the seeds, the corpus that grows and
# what was found (crash-*, leak-*, timeout-*).
set -eu
program=$(realpath "$1") seconds=$2 directory=$3
shift 3
source=$(realpath "$(dirname "$0")/../..")
mkdir -p "$directory/seeds" "$directory/corpus"
cd "$directory"
target=$(basename "$program")
case $target in
  fuzz_scene) cp "$source"/pipelines/*.toml "$source"/tests/reference/scenes/*.toml "$source"/tests/bench/scenes/*.toml seeds ;;
  fuzz_law) # of the library as many materials as it needs to answer
    cp "$source"/tests/fuzz/seeds/law_*.toml "$source"/results/material_law/cell_law_memory_lambda.toml seeds
    awk '/^\[\[material\]\]/ { n++ } n < 8' "$source/results/law_library/library.toml" > seeds/library.toml ;;
  fuzz_particles) # the first byte says whether zlib packs the rest, the second how much is cut off
    printf ' 2 1 1 1\n0 0 1 0.01\n0.1 0.2 0.3 2e-3\n' > seeds/plain
    printf '\001\0002 1 1 1\n0 0 1 0.01\n0.1 0.2 0.3 2e-3\n' > seeds/packed
    printf '\001\0602 1 1 1\n0 0 1 0.01\n0.1 0.2 0.3 2e-3\n' > seeds/cut ;;
  fuzz_csv) # the first byte says what the command line gives, the second whether the curves are fitted
    for sieve in "$source"/tests/data/sieves/*; do { printf ' 1'; cat "$sieve"; } > "seeds/$(basename "$sieve")"; done
    { printf ' 1'; head -c 1200 "$source/pipelines/press_test.csv"; } > seeds/press
    { printf '"1'; head -c 2400 "$source/pipelines/press_test_unloading.csv"; } > seeds/unloading
    printf '!0Delta, Fn [N], se [N], sample\n0.02,0,1e-3,A\n0.06,1e-3,1e-3,A\n0.1,0.1,0.01,A\n0.15,0.3,0.01,A\n0.2,0.7,0.01,A\n0.25,1.3,,A\n' > seeds/plain
    printf '\001\000hn [mm]\tFn [mN]\tht [um]\tFt [mN]\n0,3\t0\t\t\n1\t3\t\t\n1\t3\t-14\t-1\n1\t3\t14\t1\n2\t70\t\t\n3\t300\t\t\n4\t800\t\t\n' > seeds/slide ;;
  fuzz_hdf5) # kind of file, whether it is fitted, then changes: what, place (two bytes), attribute, numbers
    for kind in 18 19 20 21 22 23 24 25 26; do
      for byte in 0 40 80 120 160 200; do
        printf "\\x$(printf %x $kind)\\x$(printf %x $((byte % 3)))\\x$(printf %x $((byte % 8)))\\x00\\x$(printf %x $byte)\\x01\\x05\\x01" > seeds/$kind-$byte
      done
    done ;;
esac
dictionary=()
[[ $target == fuzz_scene || $target == fuzz_law ]] && dictionary=("-dict=$source/tests/fuzz/words.dict")
nice -n 5 "$program" "${dictionary[@]}" -max_len=20000 -timeout=20 -rss_limit_mb=3000 -print_final_stats=1 "$@" corpus seeds &
child=$!
ticks=$(getconf CLK_TCK)
while kill -0 $child 2>/dev/null; do
  read -r -a stat < <(sed 's/.*) //' /proc/$child/stat 2>/dev/null) || break
  (( (stat[11] + stat[12]) / ticks >= seconds )) && { kill -INT $child; break; }
  sleep 1
done
wait $child
