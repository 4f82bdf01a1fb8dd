#!/usr/bin/env bash
# Bundles the page: web/dist/page, which `palpable export --to page` copies. web/page/build.sh --help says more.
set -euo pipefail
cd "$(dirname "$0")/.."

usage() {
  cat <<'TEXT'
web/page/build.sh

Installs the npm packages of web/package-lock.json into web/node_modules, unless these are there, and
bundles the page into web/dist/page, unless that is newer than its sources. web/build.sh has to have
compiled the core before.

Exit code 77: npm, the network or the core is missing, and the reason is printed.
TEXT
}
case "${1:-}" in
  "") ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac

cannot() { echo "web/page/build.sh: $*" >&2; exit 77; }
[[ -s dist/palpable.wasm ]] || cannot "web/dist/palpable.wasm is missing: web/build.sh compiles it"
command -v npm >/dev/null && command -v node >/dev/null || cannot "npm or node is missing (tools/packages.txt, tools/packages-web.txt)"

# npm ci deletes node_modules first: an interrupted one leaves no copy of the list behind, and runs again.
installed=node_modules/.installed-lock.json
if ! cmp -s package-lock.json $installed; then
  npm ci --silent --no-audit --no-fund --ignore-scripts || cannot "npm could not install what web/package-lock.json lists; is there a network?"
  cp package-lock.json $installed
fi

last=dist/page/palpable.wasm  # which build.mjs writes last
sources=(index.js core.js dist/palpable.wasm package-lock.json page/*.js page/*.css page/*.html page/build.mjs
         ../src/palpable/live/render/shaders)
if [[ ! -s $last || -n $(find "${sources[@]}" -newer $last -print -quit) ]]; then
  nice -n "${WEB_NICE:-15}" node page/build.mjs
fi
