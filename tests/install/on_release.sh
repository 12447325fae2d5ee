#!/usr/bin/env bash
# A command of the README on a release of Debian or Ubuntu, from its base system and the last commit of this tree: the
# first one, or `./softgrain` with the arguments behind FOLDER.
# By hand: it needs root, debootstrap, the network, 3 GB and a quarter of an hour; `test` takes 6 GB and an hour.
#   on_release.sh bookworm http://deb.debian.org/debian FOLDER
#   on_release.sh noble http://archive.ubuntu.com/ubuntu FOLDER test
set -euo pipefail

suite=$1 mirror=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
mkdir -p "$3" && folder=$(readlink -f "$3")
shift 3
(($#)) || set -- run pipelines/quickstart.toml
[[ $folder != / ]]
components=main
[[ $mirror == *ubuntu* ]] && components=main,universe

[[ -e $folder/etc/debian_version ]] || debootstrap --variant=minbase --components="$components" "$suite" "$folder" "$mirror"
cp /etc/resolv.conf "$folder/etc/"
rm -rf "$folder/root/softgrain"
# What else the program needs the list of packages has to bring.
git clone -q "$root" "$folder/root/softgrain"
for of in proc dev; do mount --bind "/$of" "$folder/$of"; done
trap 'umount "$folder/proc" "$folder/dev"' EXIT
chroot "$folder" bash -c 'cd /root/softgrain && time ./softgrain "$@" </dev/null' _ "$@"
