#!/usr/bin/env bash
# Compiles the core for web pages: web/dist/palpable.wasm. web/build.sh --help says more.
set -euo pipefail
cd "$(dirname "$0")/.."
objects=build/wasm
packages=tools/packages-web.txt

usage() {
  cat <<'TEXT'
web/build.sh [--install]

Compiles base, geometry, material, reduced, contact, response, web_file, things and the C functions
over them to WebAssembly: web/dist/palpable.wasm, for browsers and for Node 18 or later. A second
call compiles what changed; objects lie in build/wasm.

  --install   first installs the Debian packages of tools/packages-web.txt (805 MB). Without it
              nothing is installed, and the script says what is missing

WEB_NICE=15   the priority it compiles at, as of nice(1)
TEXT
}

wanted() { sed 's/ *#.*//' "$packages" | grep .; }

install_packages() {
  echo "installing: $(wanted | tr '\n' ' ')"
  apt-get install -y --no-install-recommends $(wanted)
}

case "${1:-}" in
  "") ;;
  --install) install_packages ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
if ! command -v em++ > /dev/null; then
  echo "web/build.sh: em++ is missing; 'web/build.sh --install' installs $(wanted | tr '\n' ' ')" >&2
  exit 1
fi

# A Node that is not Debian's does not look for acorn where Debian puts it.
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}
mkdir -p "$objects/headers" web/dist
# Emscripten compiles its standard library into its cache when it is first used; Debian's belongs to root.
[[ -w /usr/share/emscripten/cache ]] || export EM_CACHE=$PWD/$objects/cache

# Headers of these libraries alone: /usr/include has the C library of this machine, too.
for library in fmt hwy nlohmann; do ln -sfn "/usr/include/$library" "$objects/headers/$library"; done

flags=(
  -std=c++20 -O3 -DNDEBUG
  -fwasm-exceptions  # the C functions turn exceptions into statuses
  # Eigen adds in the order of SSE, as in the library: the same bytes. Emscripten makes wasm's vectors of it.
  -msimd128 -msse2
  # Below 6.0 Eigen's product writes no assembler for x86, and from 6.3 on its minimum neither: 5 * 10 + 13 is
  # 63 to the one, and 5.13 is below 6.0 to the other.
  -fgnuc-version=5.13
  # As CMakeLists.txt has them where bytes depend on them.
  -ffp-contract=off -fno-math-errno
  -Wall -Wno-psabi
  -DFMT_HEADER_ONLY -DPALPABLE_VERSION="\"$(sed -n 's/^project(palpable VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)\""
  -I. -Isrc -Iweb/src/stand_ins -isystem "$objects/headers" -isystem /usr/include/eigen3
)

# Names of the C interface, for index.js.
exports=_malloc,_free,_palpable_read_body,_palpable_layout
for name in version last_error place_body free_body open reset close press_at get_frame get_touch get_skin hand_capsules; do
  exports+=,_palpable_$name
done

sources_of() {  # the files of a folder, its tests and some others excepted
  local folder=$1; shift
  local file
  for file in "$folder"/*.cpp; do
    case " $* " in *" $(basename "$file" .cpp) "*) continue ;; esac
    [[ $file == *_test.cpp ]] || echo "$file"
  done
}

keep() {  # writes stdin to a file, unless it has that content
  cat > "$1.next"
  if cmp -s "$1.next" "$1"; then rm "$1.next"; else mv "$1.next" "$1"; fi
}
echo "$exports" | keep "$objects/exports"
{ em++ --version | sed -n 1p; printf '%s\n' "${flags[@]}"; } | keep "$objects/flags"

# unit NAME FILE...: several files as one, whose headers are read once; compiled when one of them, or a header, is newer.
linked=()
unit() {
  local name=$1 object=$objects/$1.o file; shift
  linked+=("$object")
  for file in "$@"; do echo "#include \"$file\""; done | keep "$objects/$name.cpp"
  if [[ -e $object ]] && ! is_older "$object" "$objects/$name.d" "$objects/$name.cpp" "$objects/flags"; then return; fi
  echo "web: $name"
  nice -n "${WEB_NICE:-15}" em++ "${flags[@]}" -MD -MF "$objects/$name.d" -c "$objects/$name.cpp" -o "$object.next"
  mv "$object.next" "$object"
}
is_newer() {  # is_newer MADE FILE...: whether one of the files is newer, or missing
  local made=$1 file; shift
  for file in "$@"; do [[ -e $file && ! $file -nt $made ]] || return 0; done
  return 1
}
is_older() {  # is_older OBJECT DEPENDENCIES FILE...
  local object=$1 dependencies=$2 file; shift 2
  [[ -e $dependencies ]] || return 0
  for file in "$@" $(sed 's/^[^:]*://; s/\\$//' "$dependencies"); do
    [[ -e $file && ! $file -nt $object ]] || return 0
  done
  return 1
}

common=src/palpable/common
capi=src/palpable/live/capi
unit row_kernels $common/base/row_kernels.cpp
unit mode_kernels $common/reduced/mode_kernels.cpp
unit base $common/base/{bounded_text,checksum,double_chars,json,order_statistics,plain_text,text_numbers,whole_file}.cpp
unit geometry $common/geometry/{capsule,element_order,place_text,quadratic_shape,quadrature,rigid,size_text,skin_points,surface_distance,surface_mesh,tracked_hand,vertex_weld}.cpp \
  $common/material/material.cpp
unit reduced $(sources_of $common/reduced mode_kernels)
unit contact $(sources_of $common/contact)
mapfile -t response < <(sources_of $common/response solution_messages)
half=$(((${#response[@]} + 1) / 2))
unit response_1 "${response[@]:0:half}"
unit response_2 "${response[@]:half}"
unit interface $(sources_of $common/web_file web_file_writer) $(sources_of src/palpable/live/things) \
  $capi/{c_session,c_things,guarded,hands,poses}.cpp web/src/{palpable_web,simd_targets}.cpp

unit memory web/src/aligned_new.cpp

# Not linked again where nothing changed: tools/package.sh packs anew what is newer than the packages.
if [[ -s web/dist/palpable.wasm ]] && ! is_newer web/dist/palpable.wasm "${linked[@]}" "$objects/exports"; then exit 0; fi
echo "web: palpable.wasm"
nice -n "${WEB_NICE:-15}" em++ "${flags[@]}" --no-entry -sSTANDALONE_WASM -sALLOW_MEMORY_GROWTH \
  -sEXPORTED_FUNCTIONS="$exports" "${linked[@]}" -o "$objects/palpable.wasm"
cp "$objects/palpable.wasm" web/dist/palpable.wasm
ls -l web/dist/palpable.wasm | awk '{print "web/dist/palpable.wasm: " $5 " bytes"}'
