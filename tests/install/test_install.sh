#!/usr/bin/env bash
# Installs the build into a folder of its own, moves that elsewhere, and uses it: the program with installed scenes, the
# manual page, the CMake package with the law header, from a project that knows nothing of the source tree.
# Usage: test_install.sh CMAKE BUILD_DIR CXX_COMPILER SOURCE_DIR
set -euo pipefail
cmake=$1 build=$2 compiler=$3 source=$4
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
work=$(mktemp -d "$build/install_test.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { printf 'test_install: %s\n' "$*" >&2; exit 1; }

"$cmake" --install "$build" --prefix "$work/first" >install.log
mv first elsewhere
prefix=$work/elsewhere

# Everything that people are told about is there.
for file in bin/softgrain share/man/man1/softgrain.1 share/softgrain/pipelines/quickstart.toml include/softgrain/laws.h \
  share/doc/softgrain/README.md share/doc/softgrain/LICENSE share/doc/softgrain/pipelines/guide/README.md; do
  [[ -s "$prefix/$file" ]] || fail "$file is not installed"
done
[[ -z "$(find "$prefix" -name '*.cpp' -print -quit)" ]] || fail "sources are installed"

# No installed file knows where the source tree is.
if grep -rlF "$source/" "$prefix/include" "$prefix/share" >told; then fail "names the source tree: $(head -n1 told)"; fi

# Scenes find the laws that they name; the page names every command.
for scene in quickstart macro_vs_resolved; do
  "$prefix/bin/softgrain" check --quiet "$prefix/share/softgrain/pipelines/$scene.toml" >/dev/null || fail "check of $scene"
done
place=$(readlink -f "$prefix")
"$prefix/bin/softgrain" examples >examples.txt
grep -qF "scenes of $place/share/softgrain/pipelines" examples.txt || fail "examples are those of another place"
"$prefix/bin/softgrain" examples macro_vs_resolved --out copy.toml >/dev/null && "$prefix/bin/softgrain" new macro --out new.toml >/dev/null ||
  fail "no scene could be written"
for scene in copy new; do
  "$prefix/bin/softgrain" check --quiet $scene.toml >/dev/null || fail "check of $scene"
  grep -qF "\"$place/share/softgrain/results/" $scene.toml || fail "$scene names no installed law"
done
mapfile -t commands < <("$prefix/bin/softgrain" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p')
((${#commands[@]} >= 7)) || fail "--help lists ${#commands[@]} commands"
for command in "${commands[@]}"; do
  grep -q "^\.SS softgrain $command$" "$prefix/share/man/man1/softgrain.1" || fail "no $command in the manual page"
done

# The consumer sees the package and no part of this tree.
"$cmake" -G Ninja -S "$here" -B consumer -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror" >configure.log || fail "$(cat configure.log)"
"$cmake" --build consumer >build.log || fail "$(cat build.log)"
# Worked out apart from the code: E R^2 a (0.2^b - delta^b), and 4/3 E/(2 (1 - nu^2)) sqrt(R/2) h^1.5.
mapfile -t forces < <(./consumer/consumer)
close() { awk -v a="$1" -v b="$2" 'BEGIN { d = a / b - 1; exit !(d < 1e-13 && d > -1e-13) }'; }
close "${forces[0]}" 0.6319459126655842 || fail "force of the soft contact: ${forces[0]}"
close "${forces[1]}" 1.086977489062398 || fail "force of the glass beads: ${forces[1]}"
# The comparison itself can fail.
! close "${forces[0]}" 0.6319459126 || fail "the comparison takes anything"

# Another minor version is not what was asked for.
mkdir other && sed 's/find_package(softgrain 0.2/find_package(softgrain 0.99/' "$here/CMakeLists.txt" >other/CMakeLists.txt
cp "$here/consumer.cpp" other/
! "$cmake" -G Ninja -S other -B other/build -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" >other.log 2>&1 ||
  fail "version 0.99 was found"
