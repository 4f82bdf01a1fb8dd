#!/usr/bin/env python3
"""What tools/command_reference.py makes of the programs' declarations: docs/commands.md, manual pages, completion."""
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case

TOOL = base.ROOT / "tools/command_reference.py"


def made(programs, form, out, *more):
    """Runs the tool; returns the folder or file that it has written."""
    words = [sys.executable, TOOL, form, "-o", out, "--programs", Path(programs.palpable).parent, *more]
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True,
                            env=os.environ | {"SOURCE_DATE_EPOCH": "1795000000"})
    assert result.returncode == 0, result.stderr
    return out


def declared(programs):
    """{command: its options} of both programs."""
    found = {}
    for program in ("palpable", "palpable-bake"):
        said = subprocess.run([Path(programs.palpable).with_name(program), "help", "--reference"], capture_output=True, text=True,
                              check=True)
        for command in json.loads(said.stdout)["commands"]:
            if len(command["options"]) >= len(found.get(command["name"], [])):
                found[command["name"]] = command["options"]
    return found


@case("docs/commands.md is what the programs declare, and the tool finds a change")
def _(programs, folder):
    made(programs, "markdown", base.ROOT / "docs/commands.md", "--check")
    other = folder / "commands.md"
    text = (base.ROOT / "docs/commands.md").read_text()
    other.write_text(text.replace("## live\n", "## life\n"))
    words = [sys.executable, str(TOOL), "markdown", "-o", str(other), "--programs", str(Path(programs.palpable).parent), "--check"]
    result = subprocess.run(words, capture_output=True, text=True)
    assert result.returncode == 1 and "commands.md differs" in result.stderr, result.stderr
    for name, options in declared(programs).items():
        if name in ("about", "refine"):
            continue
        section = re.search(rf"^## {name}\n.*?(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
        assert section, name
        for option in options:
            last = option["names"][-1]
            assert last in ("--help", "--help-all") or last in section[0] or last.upper() in section[0], f"{name} {last}"


@case("every command has a manual page, which man shows without a warning")
def _(programs, folder):
    pages = made(programs, "man", folder / "man")
    files = {path.name: path for path in pages.rglob("*.1")}
    for name, options in declared(programs).items():
        if name in ("about", "refine", "bench"):
            continue
        text = files[f"palpable-{name}.1"].read_text()
        for option in options:
            last = option["names"][-1]
            assert last == "--help-all" or last.replace("-", "\\-") in text or last.upper() in text, f"{name} {last}"
    # Each lies with the program, whose package holds it.
    assert files["palpable-bake.1"].parent.name == "palpable-bake" and files["palpable.1"].parent.name == "palpable"
    assert files["palpable-mesh.1"].parent.name == "palpable-bake" and files["palpable-live.1"].parent.name == "palpable"
    assert "palpable\\-live (1)" in files["palpable.1"].read_text() and '"November 2026"' in files["palpable.1"].read_text()
    packed = made(programs, "man", folder / "packed", "--gzip")
    assert len(list(packed.rglob("*.1.gz"))) == len(files)
    if shutil.which("man") is None or shutil.which("groff") is None:
        print("man or groff is not installed: pages are not shown")
        return
    for path in files.values():
        shown = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", str(path)], capture_output=True, text=True,
                               env=os.environ | {"LC_ALL": "C.UTF-8", "MANWIDTH": "100", "MANPAGER": "cat"})
        assert shown.returncode == 0 and not shown.stderr, f"{path.name}: {shown.stderr}"
        assert "NAME" in shown.stdout and path.name[:-2] in shown.stdout, shown.stdout[:500]


# Prints what bash would offer for these words, the last of which is being typed.
ASK = r"""
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
_palpable
printf '%s\n' "${COMPREPLY[@]}"
"""


@case("bash completes commands, options, their words and files")
def _(programs, folder):
    script = made(programs, "completion", folder / "completion") / "bash/palpable"
    assert subprocess.run(["bash", "-n", script]).returncode == 0
    here = folder / "here"
    (here / "clip").mkdir(parents=True)
    (here / "a body.palpable").write_text("")

    def offered(*words):
        result = subprocess.run(["bash", "--noprofile", "--norc", "-c", ASK, "bash", str(script), "palpable", *words],
                                capture_output=True, text=True, cwd=here)
        assert result.returncode == 0, result.stderr
        return set(result.stdout.splitlines()) - {""}

    options = {option["names"][-1]: option for option in declared(programs)["live"]}
    views = set(options["--view"]["choices"])
    assert {"camera", "depth", "map"} <= views
    assert offered("li") == {"live"}
    assert {"replay", "reduce", "report"} <= offered("re") and offered("help", "li") == {"live"}
    assert offered("live", "--wi") == {"--window"}
    assert options.keys() - {"body"} <= offered("live", "body.palpable", "--") | {name for name in options if name[0] != "-"}
    assert offered("live", "--view", "") == views and offered("live", "--view", "de") == {"depth"}
    assert offered("live", "--view", "camera", "de") == {"depth"}  # several words
    assert offered("live", "--view", "=", "de") == {"depth"}  # bash takes --view=de for three words
    assert offered("live", "a") == {"a body.palpable"} and offered("live", "--out", "") == {"clip"}
    assert offered("live", "--paced", "") == {"clip", "a body.palpable"}
    assert offered("mesh", "--up", "") == {"x", "y", "z"} and "beams" in offered("reproduce", "")
    assert offered("live", "--nothing-that-is-there") == set()


@case("zsh reads the completion")
def _(programs, folder):
    script = made(programs, "completion", folder / "completion") / "zsh/_palpable"
    text = script.read_text()
    assert text.startswith("#compdef palpable\n")
    for name, options in declared(programs).items():
        if name not in ("about", "refine"):
            assert f"\n    {name}) _arguments" in text, name
    if shutil.which("zsh") is None:
        print("SKIPPED: zsh is not installed")
        return
    assert subprocess.run(["zsh", "-f", "-n", script]).returncode == 0


if __name__ == "__main__":
    sys.exit(base.main())
