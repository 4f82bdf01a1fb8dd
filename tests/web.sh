#!/bin/sh
# The tests of web/; exit code 77, and the reason, where they cannot run.
cd "$(dirname "$0")/.." || exit 1
skip() { echo "SKIPPED: $*"; exit 77; }
[ -e web/dist/palpable.wasm ] || skip "web/dist/palpable.wasm is not built (web/build.sh --install builds it)"
command -v node >/dev/null || skip "node is not installed (tools/packages-web.txt)"
exec node --test web/test.mjs
