#!/usr/bin/env bash
# The start script on a made-up machine: PATH holds only stubs that write down how they were called, and a few basic tools.
#   test_start_script.sh ROOT    ROOT: the repository
# shellcheck disable=SC2016  # the bodies of the stubs are written out as they stand
set -euo pipefail

root=$(readlink -f "${1:-"$(dirname "${BASH_SOURCE[0]}")/../.."}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
repo="$work/a copy with spaces"
calls="$work/calls"
real_bash=$(command -v bash)
failures=0

check() {  # check DESCRIPTION COMMAND...
  local what=$1
  shift
  "$@" || { printf 'FAILED: %s\n' "$what"; sed 's/^/    /' "$calls" "$work/out" "$work/err"; failures=$((failures + 1)); }
}
called() { [[ $(grep -c "$2" "$calls") == "$1" ]]; }            # called TIMES PATTERN
printed() { grep -q -- "$2" "$work/$1"; }                       # printed out|err PATTERN
silent() { [[ ! -s "$work/$1" ]]; }                             # silent out|err
lines() { [[ $(wc -l <"$work/$2") == "$1" ]]; }                 # lines COUNT out|err
status() { [[ $got == "$1" ]]; }                                # status NUMBER

stub() {  # stub NAME BODY
  printf '#!%s\nprintf "%%s %%s\\n" "${0##*/}" "$*" >>"%s"\n%s\n' "$real_bash" "$calls" "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}

# A fresh copy and machine: everything installed, user root, no sudo.
fresh() {
  rm -rf "${work:?}/bin" "$repo"
  mkdir -p "$work/bin" "$repo/cmake"
  for layer in common microsim calibrate macrosim pipelines; do mkdir "$repo/$layer"; done
  cp "$root/softgrain" "$repo/"
  cp "$root/cmake/packages.txt" "$repo/cmake/"
  touch "$repo/CMakeLists.txt"
  local tool
  for tool in bash cat chmod dirname env find flock grep mkdir readlink rm tail touch true; do
    ln -s "$(type -P "$tool")" "$work/bin/$tool"
  done
  stub id 'echo 0'
  stub dpkg-query 'for name in "${@:4}"; do echo "installed $name"; done'
  stub apt-get ''
  stub ctest 'exit 8'
  # Configuring leaves a cache and build.ninja, building a program that prints its arguments and working directory.
  stub cmake 'echo "noise of the build"
case "$1" in
  --preset) mkdir -p build/release; touch build/release/build.ninja
    printf "CMAKE_HOME_DIRECTORY:INTERNAL=%s\nSOFTGRAIN_TESTS:BOOL=%s\n" "$PWD" "${3#*=}" >build/release/CMakeCache.txt ;;
  --build) printf "#!%s\nprintf \"<%%s>\" \"\$PWD\" \"\$@\"\n" "'"$real_bash"'" >"$2/softgrain"; chmod +x "$2/softgrain" ;;
esac'
}

start() {  # start [ARGS...]: runs the script, keeps its status and what it printed
  : >"$calls"
  got=0
  PATH="$work/bin" "$real_bash" "${script:-$repo/softgrain}" "$@" >"$work/out" 2>"$work/err" </dev/null || got=$?
}

nothing_missing() {
  fresh
  mkdir -p "$work/elsewhere"
  cd "$work/elsewhere"
  start run 'my scene.toml' --json
  check "runs with status 0" status 0
  check "apt-get is not called" called 0 '^apt-get'
  check "configured once, without tests" called 1 '^cmake --preset release -DSOFTGRAIN_TESTS=OFF$'
  check "built the program only" called 1 '^cmake --build .* --target softgrain$'
  check "arguments and working directory reach the program; nothing else on standard output" \
    [ "$(cat "$work/out")" = "<$work/elsewhere><run><my scene.toml><--json>" ]
  start --help
  check "a second start does not configure again" called 0 '^cmake --preset'
  check "a second start says nothing of its own" silent err
  ln -sf "$repo/softgrain" "$work/link"
  script="$work/link" start check x
  check "works through a symbolic link" [ "$(cat "$work/out")" = "<$work/elsewhere><check><x>" ]
  cd "$work"
}

missing_as_root() {
  fresh
  stub dpkg-query 'for name in "${@:4}"; do [[ $name == g++ ]] || echo "installed $name"; done; exit 1'
  start setup
  check "runs with status 0" status 0
  check "apt-get update once" called 1 '^apt-get .* update$'
  check "apt-get install once, of what is missing and nothing else" called 1 '^apt-get .* install --no-install-recommends g++$'
  check "standard output stays empty" silent out
}

missing_with_sudo() {
  fresh
  stub dpkg-query ''
  stub id 'echo 1000'
  stub sudo 'shift; exec "$@"'
  start setup
  check "runs with status 0" status 0
  check "asks no password" called 3 '^sudo -n'
  check "installs once" called 1 '^apt-get .* install .*cmake'
  check "leaves out what only tests need" called 0 'libgtest-dev'
  check "leaves out what only LAMMPS needs" called 0 'liblammps-dev'
}

with_python() {
  fresh
  stub dpkg-query ''
  start setup
  check "setup installs what the Python package needs" called 1 '^apt-get .* install .*pybind11-dev'
  check "builds the program alone where that is not to be found" called 1 '^cmake --build .* --target softgrain$'
  echo 'pybind11_DIR:PATH=pybind11_DIR-NOTFOUND' >>"$repo/build/release/CMakeCache.txt"
  start setup
  check "looks for it anew" called 1 '^cmake --preset release'
  echo 'pybind11_DIR:PATH=/usr/lib/cmake/pybind11' >>"$repo/build/release/CMakeCache.txt"
  start setup
  check "builds the package too" called 1 '^cmake --build .* --target softgrain softgrain_python$'
  start check x
  check "other starts do without" called 0 'pybind11-dev\|softgrain_python'
}

with_lammps() {
  fresh
  start setup --with-lammps
  check "runs with status 0" status 0
  check "looks for LAMMPS anew" called 1 '^cmake --preset release .*-DSOFTGRAIN_LAMMPS=AUTO$'
  check "builds both programs" called 1 '^cmake --build .* --target softgrain softgrain-lammps$'
  start setup --with-lamps
  check "status 2 for an unknown option" status 2
}

missing_without_rights() {
  fresh
  stub dpkg-query ''
  stub id 'echo 1000'
  start run x
  check "status 4 without sudo" status 4
  check "one line" lines 1 err
  check "the line is the command to run" printed err 'apt-get install -y --no-install-recommends .*libceres-dev'
  check "apt-get is not called" called 0 '^apt-get'
  check "nothing is built" called 0 '^cmake'
  stub sudo 'exit 1'
  start run x
  check "status 4 when sudo wants a password" status 4
  SOFTGRAIN_SKIP_INSTALL=1 start run x
  check "goes on when told to skip the installation" status 0
}

other_system() {
  fresh
  rm "$work/bin/dpkg-query" "$work/bin/apt-get"
  start run x
  check "status 4 without dpkg" status 4
  check "prints the list" printed err 'libeigen3-dev'
  SOFTGRAIN_SKIP_INSTALL=1 start run x
  check "goes on when told to skip the installation" status 0
}

failing_steps() {
  fresh
  stub cmake 'echo "error: no such thing"; exit 1'
  start run x
  check "status 4 when the build fails" status 4
  check "shows the end of the log" printed err 'error: no such thing'
  check "names the log" printed err "$repo/build/release/build.log"
  check "standard output stays empty" silent out
  fresh
  stub dpkg-query ''
  stub apt-get 'case "$*" in *install*) echo "E: no such package"; exit 100 ;; esac'
  start run x
  check "status 4 when the installation fails" status 4
  check "shows what apt-get said" printed err 'E: no such package'
}

unwritable() {
  fresh
  touch "$repo/build"
  start run x
  check "status 4 when the build directory cannot be made" status 4
  check "says so in one line" lines 1 err
}

tests_command() {
  fresh
  start run x
  start test -R layers
  check "the status of ctest" status 8
  check "configured again, with tests" called 1 '^cmake --preset release -DSOFTGRAIN_TESTS=ON$'
  check "slow tests left out, arguments passed on" called 1 '^ctest .*-LE slow|browser -R layers$'
  start test -L slow
  check "a label option replaces the default" called 1 '^ctest .*-j 2 -L slow$'
  start run x
  check "the program does not configure again after that" called 0 '^cmake --preset'
}

beside_another_build() {
  fresh
  start run x
  # Somebody else holds the lock, as long as this test goes on.
  exec 8>>"$repo/build/.lock"
  flock 8
  (sleep 20; flock -u 8) &
  local holder=$!
  start run y
  check "a current program runs at once beside another build" [ "$(cat "$work/out")" = "<$PWD><run><y>" ]
  check "it is not built again" called 0 '^cmake'
  check "it says nothing of its own" silent err
  kill "$holder"
  wait "$holder" || true
  # A source that is newer is built first, once the other build has ended.
  touch -d '+1 hour' "$repo/common/new.cpp"
  (sleep 1; flock -u 8) &
  start run z
  wait
  exec 8>&-
  check "an outdated program waits for the other build" printed err 'waiting for another start'
  check "and is built" called 1 '^cmake --build .* --target softgrain$'
  # A build that had nothing to link counts as well.
  fresh
  start run x
  touch -d '-1 hour' "$repo/build/release/softgrain" "$repo/build/release/.begun"
  touch -d '-30 minutes' "$repo/common/old.cpp"
  stub cmake 'echo "nothing to do"'
  start run x
  check "built when a source is newer" called 1 '^cmake --build'
  start run x
  check "not again when the build found nothing to do" called 0 '^cmake'
  mkdir -p "$repo/.git/logs"
  touch -d '+1 hour' "$repo/.git/logs/HEAD"
  start run x
  check "built when another commit was checked out" called 1 '^cmake --build'
}

moved_copy() {
  fresh
  start run x
  mv "$repo" "$repo moved"
  repo="$repo moved"
  start run x
  check "a moved copy is configured again" called 1 '^cmake --preset'
  rm -rf "$repo"
  repo="$work/a copy with spaces"
}

for script_file in softgrain .ci/run; do
  "$real_bash" -n "$root/$script_file" || failures=$((failures + 1))
done
for group in nothing_missing missing_as_root missing_with_sudo with_python with_lammps missing_without_rights other_system failing_steps unwritable tests_command beside_another_build moved_copy; do
  printf -- '-- %s\n' "$group"
  "$group"
done
printf '%d failures\n' "$failures"
[[ $failures == 0 ]]
