"""What Python says is what C says: the same structs, the same bytes."""
import re
import shutil
import struct
import subprocess

import numpy as np
import palpable
import pytest
from conftest import ROOT
from palpable import _library as c
from palpable._session import _THING
from palpable._things import _LAYOUTS, _SIDES

CAPI = ROOT / "src/palpable/live/capi"
STRUCTS = {"setup": c.Setup, "image": c.Image, "thing": c.Thing, "frame": c.Frame, "touch": c.Touch, "skin": c.Skin, "depth": c.Depth}
# Presses as the test of the same bytes does, and writes what comes out, raw.
PRESS = """
#include "palpable.h"
#include <stdio.h>
int main(int count, char** word) {
  palpable_body* body;
  palpable_session* session;
  const palpable_setup setup = {.size = sizeof setup};
  if (count < 2 || palpable_load_body(word[1], 1, &body) != PALPABLE_OK) return puts(palpable_last_error()), 1;
  if (palpable_open((const palpable_body* const*)&body, 1, &setup, &session) != PALPABLE_OK) return 1;
  for (int k = 0; k < 20; ++k) {
    const double z = 0.107 - 0.0003 * k;
    const palpable_capsule finger = {{0.0005 * k, 0, z}, {0.0005 * k, 0, z + 0.06}, 0.008, 0.008};
    const palpable_thing thing = {sizeof thing, 3, &finger, 1};
    palpable_frame frame = {.size = sizeof frame};
    palpable_touch touch = {.size = sizeof touch};
    palpable_skin skin = {.size = sizeof skin};
    if (palpable_press_at(session, &thing, 1, 0.01 * k) != PALPABLE_OK) return 1;
    palpable_get_frame(session, &frame);
    fwrite(&frame.left_to_go, 8, 1, stdout);
    for (int i = 0; i < frame.touch_count; ++i) {
      palpable_get_touch(session, i, &touch);
      fwrite(touch.force, 8, 3, stdout);
      fwrite(touch.point, 8, 3, stdout);
    }
    palpable_get_skin(session, 0, &skin);
    fwrite(skin.vertices, 4, 3 * skin.vertex_count, stdout);
    fwrite(skin.von_mises, 4, skin.vertex_count, stdout);
    fwrite(skin.contact_pressure, 4, skin.vertex_count, stdout);
  }
  return 0;
}
"""


def compiled(folder, text, *words):
    if shutil.which("cc") is None:
        pytest.skip("cc is not installed")
    (folder / "program.c").write_text(text)
    subprocess.run(["cc", "-std=c11", f"-I{CAPI}", folder / "program.c", "-o", folder / "program", *words], check=True)
    return folder / "program"


def members(name):
    """Names of a struct's members in the header."""
    text = re.sub(r"/\*.*?\*/", "", (CAPI / "palpable.h").read_text(), flags=re.DOTALL)
    inside = re.search(rf"typedef struct palpable_{name} \{{(.*?)\}} palpable_{name};", text, re.DOTALL)[1]
    declared = [one for line in inside.split(";") if line.strip() for one in line.split(",")]
    return [re.search(r"(\w+)(\[\d+\])?$", one.strip())[1] for one in declared]


def test_structs_lie_in_memory_as_those_of_the_header(tmp_path):
    lines, expected = [], []
    for name, mirror in STRUCTS.items():
        assert [field[0] for field in mirror._fields_] == members(name)
        lines.append(f'printf("%zu\\n", sizeof(palpable_{name}));')
        expected.append(c.ctypes.sizeof(mirror))
        for member, *_ in mirror._fields_:
            lines.append(f'printf("%zu\\n", offsetof(palpable_{name}, {member}));')
            expected.append(getattr(mirror, member).offset)
    assert _THING.size == c.ctypes.sizeof(c.Thing)
    lines.append('printf("%zu %d %lld\\n", sizeof(palpable_capsule), PALPABLE_HAND_CAPSULES, (long long)PALPABLE_NO_THING);')
    text = '#include "hands.h"\n#include <stdio.h>\nint main(void) {\n' + "\n".join(lines) + "\nreturn 0;\n}\n"
    said = subprocess.run([compiled(tmp_path, text)], capture_output=True, text=True, check=True).stdout.split()
    assert [int(number) for number in said] == [*expected, 64, c.HAND_CAPSULES, c.NO_THING]


def test_every_function_of_the_headers_is_called_by_the_package():
    headers = "".join((CAPI / name).read_text() for name in ("palpable.h", "hands.h"))
    functions = set(re.findall(r"^PALPABLE_API .*?(palpable_\w+)\(", headers, re.MULTILINE))
    ours = {*c._FUNCTIONS, *c._FREES, "palpable_version", "palpable_last_error"}
    assert functions - ours == {"palpable_press"}  # palpable_press_at does that and more
    assert ours <= functions


def test_enumerations_have_the_values_of_the_headers():
    headers = "".join((CAPI / name).read_text() for name in ("palpable.h", "hands.h"))
    values = dict(re.findall(r"PALPABLE_(\w+) =\s+(\d+)", headers))
    for one in [*palpable.Answer, *palpable.CameraState]:
        assert int(values[one.name]) == one.value
    for kind in (palpable.WrongArgument, palpable.WrongFile, palpable.NotPossible, palpable.NoMemory, palpable.Broken):
        assert int(values[re.sub(r"(?<!^)([A-Z])", r"_\1", kind.__name__).upper()]) == kind.status
    for name in ("GRAY8", "RGB8", "BGR8", "RGBA8", "DEPTH_F32", "STEREO", "COLOR_DEPTH", "NO_CAMERA"):
        assert int(values[name]) == getattr(c, name)
    for name, (value, _) in _LAYOUTS.items():
        assert int(values[f"{name.upper()}_HAND"]) == value
    for side, value in _SIDES.items():
        assert int(values[side.upper()]) == value


def test_forces_and_skins_are_the_same_bytes(ball, tmp_path):
    library = c.library()._name
    if "/" not in library:
        pytest.skip("PALPABLE_LIBRARY does not name the library")
    program = compiled(tmp_path, PRESS, library, f"-Wl,-rpath,{library.rpartition('/')[0]}")
    said = subprocess.run([program, ball], capture_output=True, check=True).stdout
    ours = b""
    with palpable.Session(palpable.Body(ball)) as session:
        for k in range(20):
            z = 0.107 - 0.0003 * k
            finger = np.array([[0.0005 * k, 0, z, 0.0005 * k, 0, z + 0.06, 0.008, 0.008]])
            session.press(palpable.Capsules(finger, id=3), time=0.01 * k)
            ours += struct.pack("d", session.frame.left_to_go)
            for touch in session.touches:
                ours += touch.force.tobytes() + touch.point.tobytes()
            skin = session.skin()
            ours += skin.vertices.tobytes() + skin.von_mises.tobytes() + skin.contact_pressure.tobytes()
    assert ours == said and len(ours) > 10_000


def test_a_missing_or_old_library_is_named_with_the_package_to_install(monkeypatch, tmp_path):
    try:
        monkeypatch.setenv("PALPABLE_LIBRARY", str(tmp_path / "libpalpable.so.0"))
        c.library.cache_clear()
        with pytest.raises(palpable.LibraryMissing, match="libpalpable0"):
            palpable.Body("x.palpable")
        old = compiled(tmp_path, "const char* palpable_version(void) { return 0; }", "-shared", "-fPIC")
        monkeypatch.setenv("PALPABLE_LIBRARY", str(old))
        with pytest.raises(palpable.LibraryMissing, match="older"):
            palpable.Body("x.palpable")
    finally:
        monkeypatch.undo()
        c.library.cache_clear()
    assert palpable.library_version().count(".") == 2
