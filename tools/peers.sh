#!/usr/bin/env bash
# Unpacks peers of the cache server that Debian 12 lacks, or has too old, from a newer suite into a private folder: buildbox
# (casd, casupload, casdownload, trexe, recc), sccache, ccache 4.14 and, with --bazel, Bazel 7. Nothing is installed: apt
# resolves against an empty list of packages, dpkg-deb unpacks, FOLDER/enter runs a program in there. Idempotent.
# Prints the versions. Where the suite cannot be had it prints "SKIP: <reason>" and ends with 77.
#
# FOLDER/enter PROGRAM ARGUMENT...   the program inside the suite, in a mount namespace of its own (without root also a user
#                                    namespace), with the host's /proc, /dev and /tmp and the same working folder in /tmp
# FOLDER/bin/PROGRAM ARGUMENT...     a buildbox program outside, by the suite's own loader, so that the actions it runs see
#                                    the host. buildbox-casd mounts in a namespace of its own: no mount outlives it
# Both keep the process id that they are started with, so that a peer can be ended by it.
set -euo pipefail

folder=${KILN_PEERS:-${XDG_CACHE_HOME:-$HOME/.cache}/kiln-peers}
suite=${KILN_PEERS_SUITE:-forky}
mirror=${KILN_PEERS_MIRROR:-}
bazel=no
while [ $# -gt 0 ]; do
  case "$1" in
    --folder) folder=$2; shift ;;
    --suite) suite=$2; shift ;;
    --bazel) bazel=yes ;;
    --help) echo "usage: tools/peers.sh [--folder DIR] [--suite forky|sid] [--bazel]"; exit 0 ;;
    *) echo "peers.sh: unknown argument '$1'" >&2; exit 2 ;;
  esac
  shift
done
skip() { echo "SKIP: $*"; exit 77; }

case "$(realpath -m "$folder")/" in
  "$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")"/*) echo "peers.sh: $folder lies in the source tree" >&2; exit 2 ;;
esac
packages=(base-files dash bash coreutils grep sed findutils gcc libc6-dev buildbox sccache ccache)
[ "$bazel" = no ] || packages+=(bazel-bootstrap libxext6 zip unzip)
mkdir -p "$folder"
folder=$(cd "$folder" && pwd -P)
root=$folder/$suite
exec 9>"$folder/lock"
flock -w 600 9 || skip "another peers.sh holds $folder"

unpack() {
  command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || skip "no apt-get or no dpkg-deb"
  if [ -z "$mirror" ]; then  # the one that this machine's own suite comes from
    local codename; codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    # shellcheck disable=SC2016
    mirror=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 2>/dev/null |
      awk -v c="$codename" '$1 == c && $2 == "main" {print $3; exit}')
  fi
  [ -n "$mirror" ] || skip "no Debian mirror is known: set KILN_PEERS_MIRROR"
  local keys=/usr/share/keyrings/debian-archive-keyring.gpg
  [ -r "$keys" ] || skip "no $keys"
  local a=$folder/apt-$suite
  rm -rf "$root"
  mkdir -p "$a/lists/partial" "$a/archives/partial" "$a/etc/preferences.d" "$root"
  : >"$a/status"
  echo "deb [signed-by=$keys] $mirror $suite main" >"$a/sources.list"
  # A suite in motion may be past its date on a mirror; its signature still has to be right.
  local apt=(apt-get -q -y -o "Dir::Etc=$a/etc" -o "Dir::Etc::SourceList=$a/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o "Dir::State=$a" -o "Dir::State::lists=$a/lists" -o "Dir::State::status=$a/status" -o "Dir::Cache=$a"
    -o Acquire::Check-Valid-Until=false -o Acquire::Retries=2 -o Acquire::http::Timeout=20 -o APT::Install-Recommends=false
    -o APT::Sandbox::User=root -o Debug::NoLocking=1 -o APT::Update::Error-Mode=any)
  timeout 300 "${apt[@]}" update >"$a/log" 2>&1 || skip "$suite is not to be had: $(grep -m1 '^E:' "$a/log" || echo timeout)"
  timeout 900 "${apt[@]}" --download-only install "${packages[@]}" >>"$a/log" 2>&1 ||
    skip "packages of $suite are not to be had: $(grep -m1 '^E:' "$a/log" || echo timeout)"
  for deb in "$a"/archives/*.deb; do
    dpkg-deb --extract "$deb" "$root" || skip "$(basename "$deb") cannot be unpacked"
  done
  rm -rf "$a/archives" "$a/lists"
  mkdir -p "$root/tmp" "$root/proc" "$root/dev"
  chmod 1777 "$root/tmp"
  # What configuring the packages would have made.
  echo 'root:x:0:0:root:/root:/bin/sh' >"$root/etc/passwd"
  echo 'root:x:0:' >"$root/etc/group"
  for java in "$root"/usr/lib/jvm/java-*-openjdk-amd64; do [ ! -d "$java" ] || ln -sfn "${java#"$root"}/bin/java" "$root/usr/bin/java"; done
}

stamp="$suite ${packages[*]}"
if [ "$(cat "$root/.unpacked" 2>/dev/null)" != "$stamp" ] &&
  { [ "$bazel" = yes ] || [[ "$(cat "$root/.unpacked" 2>/dev/null)" != "$stamp "* ]]; }; then
  unpack
  echo "$stamp" >"$root/.unpacked"
fi
cat >"$folder/enter" <<SH
#!/bin/sh
user=; [ "\$(id -u)" = 0 ] || user=--user\ --map-root-user
export KILN_PEERS_CWD="\$(pwd -P)"
exec unshare --mount \$user /bin/sh -c '
  mount --rbind /proc "$root/proc" && mount --rbind /dev "$root/dev" && mount --rbind /tmp "$root/tmp" || exit 126
  exec chroot "$root" /bin/sh -c '\''PATH=/usr/bin; export JAVA_HOME=/usr/lib/jvm/default-java; cd "\$KILN_PEERS_CWD" 2>/dev/null || cd /; exec "\$@"'\'' enter "\$@"' enter "\$@"
SH
chmod +x "$folder/enter"
"$folder/enter" true 2>"$folder/enter.log" || skip "no namespaces here: $(tail -n 1 "$folder/enter.log")"

# The suite's programs want its C library, which is newer than the host's: its loader starts them.
mkdir -p "$folder/bin"
libraries=$root/usr/lib/$(uname -m)-linux-gnu
for tool in buildbox-casd buildbox-fuse buildbox-run-hosttools casupload casdownload trexe recc; do
  own=
  if [ "$tool" = buildbox-casd ] && [ "$(id -u)" = 0 ]; then own='unshare --mount '; fi
  cat >"$folder/bin/$tool.new" <<SH
#!/bin/sh
PATH=$folder/bin:\$PATH
export PATH
exec $own$root/lib64/ld-linux-x86-64.so.2 --library-path $libraries $root/usr/bin/$tool "\$@"
SH
  chmod +x "$folder/bin/$tool.new"
  mv "$folder/bin/$tool.new" "$folder/bin/$tool"
done

echo "folder: $folder"
version() { echo "$1: $("$folder/enter" "$@" 2>&1 | grep -oE '[0-9]+\.[0-9]+[-+~.0-9a-z]*' | head -n 1)"; }
for tool in buildbox-casd casupload casdownload trexe recc sccache ccache gcc; do version "$tool" --version; done
bazels=$(echo "$root"/usr/share/doc/bazel-bootstrap/changelog.Debian.gz)
[ ! -e "$bazels" ] || echo "bazel: $(zcat "$bazels" | head -n 1 | grep -oE '[0-9][^)]*' | head -n 1)"
