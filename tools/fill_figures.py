#!/usr/bin/env python3
"""fill_figures.py [--check]: writes measured figures of docs/results/*.json into README.md and the pages of docs/.

A figure stands between two comments, which a page does not show:

    <!--= FILE:PATH | FORMAT -->15 %<!--=-->

    FILE     docs/results/FILE.json
    PATH     keys and list indices with dots between them; a key with dots or spaces stands in double quotes:
             chain:pooled."pooled without squeeze".displacement_error.median
    FORMAT   a factor (x100; may be missing), a format of Python (.1f), a text that is appended (may be missing):
             x100 .0f %

In a table, where | ends a cell, \\| stands for |. Markers in code blocks and between backticks are examples and stay.
--check writes nothing: it prints each figure that differs, each path that does not exist and each marker that is not
complete, and exits with 1 if there are any.
"""
import functools
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MARKER = re.compile(r"<!--=\s*([\w-]+):([^|<>]+?)\s*\\?\|\s*([^<>]+?)\s*-->([^<>]*)<!--=-->")
CODE = re.compile(r"^```.*?^```|^~~~.*?^~~~|(?<!`)(`+)(?!`).*?[^`]\1(?!`)", re.DOTALL | re.MULTILINE)
KEY = re.compile(r'"([^"]+)"|([^."]+)')


class NoFigure(Exception):
    pass


def without_code(text):
    """The text with code blocks and code spans blanked, so that positions and line numbers stay."""
    return CODE.sub(lambda code: re.sub(r"[^\n]", " ", code[0]), text)


def pages():
    return [page for page in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))) if page.is_file()]


@functools.cache
def read(file):
    path = ROOT / "docs/results" / f"{file}.json"
    if not path.is_file():
        raise NoFigure(f"docs/results/{file}.json does not exist")
    return json.loads(path.read_text())


def figure(file, path):
    value, done = read(file), file + ":"
    for quoted, plain in KEY.findall(path):
        key = quoted or plain
        try:
            value = value[int(key)] if isinstance(value, list) else value[key]
        except (KeyError, IndexError, ValueError, TypeError):
            there = ", ".join(value) if isinstance(value, dict) else f"0 to {len(value) - 1}" if isinstance(value, list) else "nothing"
            raise NoFigure(f"'{key}' does not exist below '{done.rstrip('.')}', which has {there[:120]}") from None
        done += key + "."
    if not isinstance(value, (int, float, str)):
        raise NoFigure(f"'{done.rstrip('.')}' is no number or text: {json.dumps(value)[:60]}")
    return value


def text_of(file, path, form):
    """The text of a figure. Raises NoFigure."""
    value = figure(file, path)
    factor, spec, unit = re.fullmatch(r"(?:x([\d.e+-]+)\s+)?(\S+)(.*)", form, re.DOTALL).groups()
    try:
        return format(value * float(factor) if factor else value, spec) + unit
    except (ValueError, TypeError) as error:
        raise NoFigure(f"format '{form}': {error}") from None


def filled(page):
    """The page's text with its figures filled in, and one (line, complaint) for each that was wrong."""
    text = page.read_text(encoding="utf-8")
    prose, wrong, parts, done, markers = without_code(text), [], [], 0, set()
    for marker in MARKER.finditer(text):
        if not prose.startswith("<!--=", marker.start()):
            continue  # an example in code
        markers |= {marker.start(), marker.end() - len("<!--=-->")}
        line, (file, path, form, present) = text.count("\n", 0, marker.start()) + 1, marker.groups()
        try:
            wanted = text_of(file, path, form)
        except NoFigure as error:
            wrong.append((line, str(error)))
            continue
        if present != wanted:
            wrong.append((line, f"'{present}' is present, '{wanted}' is {file}:{path}"))
        parts += [text[done:marker.start(4)], wanted]
        done = marker.end(4)
    wrong += [(text.count("\n", 0, start.start()) + 1, "a marker is not complete: <!--= FILE:PATH | FORMAT -->TEXT<!--=-->")
              for start in re.finditer("<!--=", prose) if start.start() not in markers]
    return "".join([*parts, text[done:]]), sorted(wrong)


def complaints():
    """One line for each figure that is not as docs/results/*.json has it."""
    return list(dict.fromkeys(f"{page.relative_to(ROOT)}:{line}: {what}" for page in pages() for line, what in filled(page)[1]))


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    if not sys.argv[1:]:
        for page in pages():
            text = filled(page)[0]
            if text != page.read_text(encoding="utf-8"):
                page.write_text(text, encoding="utf-8")
                print(f"filled: {page.relative_to(ROOT)}")
    wrong = complaints()
    print("\n".join(wrong) if wrong else "every figure is that of docs/results/*.json")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
