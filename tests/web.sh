#!/bin/sh
# tests/web.sh core|types|page: the tests of web/; exit code 77, and the reason, where they cannot run.
cd "$(dirname "$0")/.." || exit 1
skip() { echo "SKIPPED: $*"; exit 77; }
[ -e web/dist/palpable.wasm ] || skip "web/dist/palpable.wasm is not built (web/build.sh --install builds it)"
command -v node >/dev/null || skip "node is not installed (tools/packages-web.txt)"
has_npm_packages() {
  cmp -s web/package-lock.json web/node_modules/.installed-lock.json ||
    skip "the npm packages of web/package-lock.json are not installed (web/page/build.sh installs them)"
}
case "$1" in
  core) exec node --test web/test.mjs ;;
  types)
    has_npm_packages
    exec node --test web/test/types.mjs ;;
  page)
    has_npm_packages
    [ -e web/dist/page/palpable.wasm ] || skip "web/dist/page is not built (web/page/build.sh)"
    [ -n "$PALPABLE_CHROMIUM" ] || [ -e /usr/bin/chromium ] || skip "chromium is not installed (tools/packages-page.txt)"
    exec node --test web/page/hands_test.mjs web/page/test.mjs web/page/desk_test.mjs web/page/webcam_test.mjs ;;
  *) echo "usage: tests/web.sh core|types|page" >&2; exit 2 ;;
esac
