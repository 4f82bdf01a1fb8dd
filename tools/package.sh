#!/usr/bin/env bash
# Builds the five Debian packages: build/packages/*.deb. The programs are compiled as the preset release
# does, without tests, in build/package; the post that ships is baked; cpack does the rest
# (cmake/Packages.cmake). Idempotent: what is up to date is not made again.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "palpable: $*" >&2; exit 1; }
step() { printf '\n== %s\n' "$*"; }

case "${1:-}" in
  "") ;;
  --help|-h)
    cat <<'TEXT'
usage: tools/package.sh

Builds the Debian packages palpable, palpable-bake, libpalpable0, libpalpable-dev and python3-palpable into build/packages,
for the architecture of this machine, on Debian 12. Installs what it needs to build them (the lists
tools/packages.txt, tools/packages-package.txt and tools/packages-web.txt), unless PALPABLE_SETUP=skip.

Then, on any Debian 12:
  apt install ./build/packages/*.deb
  palpable live post --source synthetic --out out
TEXT
    exit 0 ;;
  *) fail "unknown option '$1'; tools/package.sh --help says what there is" ;;
esac

[ "${PALPABLE_SETUP:-}" = skip ] || tools/setup.sh package
for tool in cmake ninja dpkg-shlibdeps file python3; do
  command -v "$tool" >/dev/null ||
    fail "$tool is missing: run tools/package.sh without PALPABLE_SETUP=skip, or install what tools/packages-package.txt lists"
done
web/build.sh
web/page/build.sh || fail "the page was not bundled, see above"
[ -s build/meshes/post.off ] || python3 tools/make_post.py build/meshes/post.off

# Files in the packages and manual pages bear the date of the last change in packaging/changelog.
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH=$(dpkg-parsechangelog -l packaging/changelog -S Timestamp)
  export SOURCE_DATE_EPOCH
fi
umask 022

step "build"
mkdir -p build/packages
# Ninja configures again by itself where the CMake files have changed.
[ -f build/package/build.ninja ] && [ build/package/build.ninja -nt CMakePresets.json ] ||
  cmake --preset package >build/configure-package.log 2>&1 ||
  { rm -f build/package/build.ninja; cat build/configure-package.log >&2; fail "CMake stopped, see above"; }
cmake --build --preset package --target package_contents

step "package"
oldest=$(find build/packages -name '*.deb' -printf '%T@ %p\n' | sort -n | head -1 | cut -d' ' -f2)
made_of=(build/package/{bin,lib,man,completion,generated,CPackConfig.cmake,bodies/post.palpable} packaging cmake python web/{dist,index.js,core.js,index.d.ts,package.json,README.md})
if [ "$(find build/packages -name '*.deb' | wc -l)" = 5 ] && [ -z "$(find "${made_of[@]}" -newer "$oldest" -print -quit)" ]; then
  echo "up to date"
  ls build/packages/*.deb
  exit 0
fi
rm -rf build/package/cpack
(cd build/package && cpack --config CPackConfig.cmake -G DEB -B cpack) >build/package/cpack.log 2>&1 ||
  { cat build/package/cpack.log >&2; fail "cpack stopped, see above"; }
rm -f build/packages/*.deb
mv build/package/cpack/*.deb build/packages/
rm -rf build/package/cpack
ls -l --block-size=K build/packages/*.deb | awk '{ print $5, $9 }'
cat <<'TEXT'

Install    apt install ./build/packages/*.deb    (as root)
Try        palpable live post --source synthetic --out out
TEXT
