#!/usr/bin/env python3
"""Delivery files: palpable export --to web, and what reads them."""
import base64
import json
import shutil
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case


def touched_ball(programs):
    return programs.baked_ball(programs.work / "touched", base.TOUCHED_BALL)


def header_of(data):
    size = struct.unpack_from("<Q", data, 24)[0]
    return json.loads(data[32:32 + size]), 32 + size


@case("export --to web writes the tables of a body file as they are, without palpable-bake")
def _(programs, folder):
    body = touched_ball(programs)
    # A folder in which palpable stands alone.
    alone = folder / "bin"
    alone.mkdir()
    shutil.copy2(programs.palpable, alone / "palpable")
    programs.palpable, present = str(alone / "palpable"), programs.palpable
    try:
        result = programs.succeeds("export", body, "--to", "web", "-o", "ball.palpweb", cwd=folder)
        programs.succeeds("export", body, "--to=web", "-o", "again.palpweb", cwd=folder)
        programs.refuses("export", body, "--to", "vtu", "-o", "vtu", cwd=folder, says=["needs the program", "palpable-bake"])
    finally:
        programs.palpable = present
    assert result.stdout == "ball.palpweb\n", result.stdout
    data = (folder / "ball.palpweb").read_bytes()
    assert data == (folder / "again.palpweb").read_bytes()
    assert data[:8] == b"PALPWEB\n" and struct.unpack_from("<Q", data, 8)[0] == len(data)
    header, begin = header_of(data)
    assert (header["format"], header["version"], header["byte_order"]) == ("palpable web body", 1, "little"), header
    arrays = {array["name"]: array for array in header["arrays"]}
    assert begin % 16 == 0 and all(array["offset"] % 16 == 0 for array in header["arrays"])
    near = arrays["touch/compliance/near"]
    assert near["type"] == "int16" and len(near["shape"]) == 1, near
    stated = json.loads(programs.succeeds("inspect", body, "--json").stdout)
    assert arrays["surface/vertices"]["shape"] == [stated["vertices"], 3]
    assert len(data) < body.stat().st_size, (len(data), body.stat().st_size)


@case("inspect says the same of a delivery file as of the body file that it was made of")
def _(programs, folder):
    body = touched_ball(programs)
    programs.succeeds("export", body, "--to", "web", "-o", folder / "ball.palpweb")
    of_body, of_web = (json.loads(programs.succeeds("inspect", file, "--json").stdout) for file in (body, folder / "ball.palpweb"))
    for answer in (of_body, of_web):
        for key in ("file_bytes", "evaluation_ms"):
            answer.pop(key)
    assert of_body["touch"] is not None and of_body == of_web, (of_body, of_web)


@case("a delivery file that is damaged, cut short or of another kind is refused in one line")
def _(programs, folder):
    programs.succeeds("export", touched_ball(programs), "--to", "web", "-o", folder / "ball.palpweb")
    good = (folder / "ball.palpweb").read_bytes()
    middle = len(good) // 2
    for content, says in ((good[:middle], "is cut short"), (good[:20], "is cut short"), (good + b"\0", "is damaged"),
                          (good[:middle] + bytes([good[middle] ^ 1]) + good[middle + 1:], "is damaged"),
                          (b"", "is no delivery file"), (b"solid ball\n", "is no delivery file")):
        (folder / "bad.palpweb").write_bytes(content)
        programs.refuses("inspect", folder / "bad.palpweb", says=["bad.palpweb: ", says])
    programs.refuses("inspect", folder / "none.palpweb", says=["none.palpweb: no such file"])


@case("export --to web refuses what it cannot read, and does not replace a file of another kind")
def _(programs, folder):
    body = touched_ball(programs)
    damaged = bytearray(body.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    (folder / "bad.palpable").write_bytes(damaged)
    (folder / "mine.palpweb").write_text("my notes\n")
    web = ("--to", "web", "-o")
    programs.refuses("export", "bad.palpable", *web, "a.palpweb", cwd=folder, says=["bad.palpable: "])
    programs.refuses("export", "none.palpable", *web, "a.palpweb", cwd=folder, says=["none.palpable: ", "no such body file"])
    programs.refuses("export", body, *web, "a.bin", cwd=folder, says=["a.bin", ".palpweb"])
    programs.refuses("export", body, *web, "mine.palpweb", cwd=folder, says=["mine.palpweb", "is there already"])
    programs.refuses("export", body, *web, "none/a.palpweb", cwd=folder, says=["none"])
    programs.refuses("export", body, *web, "a.palpweb", "--set", "age=3", cwd=folder, says=["'age'"])
    programs.refuses("export", body, *web, "a.palpweb", "--site", "3", cwd=folder, says=["--site"])
    assert (folder / "mine.palpweb").read_text() == "my notes\n"
    assert not (folder / "a.palpweb").exists()


def write_bundle(folder):
    """A bundle of the page, where a build leaves it, relative to the source folder."""
    bundle = folder / "web/dist/page"
    bundle.mkdir(parents=True)
    (bundle / "index.html").write_text("/*palpable:page*/<!-- palpable:scripts -->")
    for name in ("page.js", "page-classic.js", "palpable.wasm"):
        (bundle / name).write_text(name)


@case("export --to page writes a page of one file or of several, and says how to build what it lacks")
def _(programs, folder):
    body = touched_ball(programs)
    page = ("--to", "page", "-o")
    programs.refuses("export", body, *page, "a", cwd=folder, says=["index.html", "web/build.sh"])
    write_bundle(folder)
    result = programs.succeeds("export", body, *page, "one", cwd=folder)
    assert result.stdout.startswith("one/index.html\n"), result.stdout
    assert [file.name for file in (folder / "one").iterdir()] == ["index.html"]
    programs.succeeds("export", body, body, *page, "two", "--inline", "never", cwd=folder)
    names = sorted(file.name for file in (folder / "two").iterdir())
    assert len(names) == 5 and sum(name.endswith(".palpweb") for name in names) == 2, names
    facts = json.loads((folder / "two/index.html").read_text().split("<script")[0])
    assert facts["inline"] is False and len(facts["bodies"]) == 2, facts
    for fact in facts["bodies"]:
        assert (folder / "two" / fact["file"]).stat().st_size == fact["bytes"] and fact["stressTop"] > 0, fact
        # The skin at rest, as base64 of float32 and uint32.
        vertices, triangles = (base64.b64decode(fact["skin"][name]) for name in ("vertices", "triangles"))
        stated = json.loads(programs.succeeds("inspect", body, "--json").stdout)
        assert len(vertices) == 12 * stated["vertices"] and len(triangles) == 12 * stated["triangles"], stated
        assert max(struct.unpack(f"<{len(triangles) // 4}I", triangles)) == stated["vertices"] - 1
        assert "credit" not in fact, fact
    programs.refuses("export", body, body, "--to", "web", "-o", "a.palpweb", cwd=folder, says=["--to page takes several"])
    programs.refuses("export", body, *page, "a.html", cwd=folder, says=["a.html"])
    programs.refuses("serve", folder, "--port", "0", says=["holds no index.html"])


@case("the credit of a shape goes from its description through the body file and the delivery file into the page")
def _(programs, folder):
    credit = 'credit = "Scan: A. Carver"\ncredit_url = "https://example.org/ball"\nterms = "CC BY 4.0"\n'
    described = base.TOUCHED_BALL.replace('up = "z"\n', f'up = "z"\n{credit}')
    body = programs.baked_ball(programs.work / "credited", described)
    programs.succeeds("export", body, "--to", "web", "-o", "ball.palpweb", cwd=folder)
    for file in (body, "ball.palpweb"):
        said = json.loads(programs.succeeds("inspect", file, "--json", cwd=folder).stdout)["provenance"]
        assert (said["credit"], said["credit url"], said["terms"]) == ("Scan: A. Carver", "https://example.org/ball", "CC BY 4.0"), said
    write_bundle(folder)
    programs.succeeds("export", body, "--to", "page", "-o", "page", "--inline", "never", cwd=folder)
    facts = json.loads((folder / "page/index.html").read_text().split("<script")[0])
    assert facts["bodies"][0]["credit"] == {"text": "Scan: A. Carver", "url": "https://example.org/ball", "terms": "(CC BY 4.0)"}, facts
    bad = base.write_ball(folder / "bad", described.replace("https://example.org/ball", "javascript:alert(1)"))
    programs.refuses("bake", bad, "-o", "bad.palpable", cwd=folder, says=["'credit_url'", "https://"])


if __name__ == "__main__":
    sys.exit(base.main())
