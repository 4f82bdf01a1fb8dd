#!/usr/bin/env python3
"""check_documents.py: the documents hold together. One line for each fault; exit code 1 if there are any.

* Each relative link and anchor in README.md, CHANGELOG.md, CONTRIBUTING.md and docs/**/*.md leads somewhere.
* So does each `docs/PAGE.md`, `docs/PAGE.md#anchor` and `docs/PAGE.md, "Heading"` in sources, help texts, tools, tests,
  scenes and descriptions of bodies.
* docs/README.md links each page of docs/, or the folder below docs/ in which it is.
* A page shows or links each file of docs/pictures/.
* The figures of docs/results/*.json are filled in (tools/fill_figures.py).
* README.md keeps to the limit that a comment in it states: <!-- at most 700 words of prose -->. Tables, code blocks,
  headings, targets of links and comments are no prose.
"""
import functools
import re
import subprocess
import sys
from pathlib import Path

import fill_figures

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(<?([^)\s>]+)>?(?:\s+[\"'][^)]*)?\)|<(?:img|source|a|video)\b[^>]*?(?:src|srcset|href|poster)=\"([^\"\s]+)"
                  r"|^\[[^\]]+\]:[ \t]+(\S+)", re.MULTILINE)
# In sources; a heading may stand on the next line of a comment.
NAMED = re.compile(r"\bdocs/([\w/-]+\.md)(?:#([\w-]+)|,(?:\s|//+|#)+\"([^\"\n]+)\")?")
HEADING = re.compile(r"^#{1,6} +(.*?)(?: +#+)?$", re.MULTILINE)
LIMIT = re.compile(r"<!-- at most (\d+) words of prose -->")
SOURCES = re.compile(r"^(?:src|apps|bench|tests|examples|tools|cmake|scenes|bodies|packaging|\.github)/|^(?:CMakeLists\.txt|Dockerfile|check|demo)$")


def slug(heading):
    """The anchor that GitHub gives a heading."""
    text = re.sub(r"<[^>]*>", "", re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading))
    return re.sub(r"[^\w\- ]", "", text.replace("*", "").strip().lower()).replace(" ", "-")


@functools.cache
def text_of(page):
    return page.read_text(encoding="utf-8")


@functools.cache
def headings(page):
    """Texts of a page's headings without marks, code blocks left out."""
    code = re.sub(r"^(```|~~~).*?^\1", "", text_of(page), flags=re.DOTALL | re.MULTILINE)
    return HEADING.findall(code)


@functools.cache
def anchors(page):
    found, seen = set(re.findall(r"<a (?:name|id)=\"([^\"]+)\"", text_of(page))), {}
    for heading in headings(page):
        name = slug(heading)
        count = seen.get(name, 0)
        seen[name] = count + 1
        found.add(f"{name}-{count}" if count else name)
    return found


def pages():
    others = (ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md")
    return [*fill_figures.pages(), *(page for page in others if page.is_file())]


@functools.cache
def links(page):
    """(line, target) of a page's links to files of the project."""
    prose = fill_figures.without_code(text_of(page))
    return [(prose.count("\n", 0, link.start()) + 1, target) for link in LINK.finditer(prose)
            if not re.match(r"[a-z]+:", target := link[1] or link[2] or link[3])]


def at(page, line):
    return f"{page.relative_to(ROOT)}:{line}"


def broken_links():
    for page in pages():
        for line, target in links(page):
            name, _, anchor = target.partition("#")
            file = (page.parent / name).resolve() if name else page
            if not file.exists():
                yield f"{at(page, line)}: {name} does not exist"
            elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                yield f"{at(page, line)}: {name or page.name} has no heading for #{anchor}"


def broken_names():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in listed.stdout.split("\n"):
        source = ROOT / name
        if not SOURCES.match(name) or name == "tools/check_documents.py" or not source.is_file():
            continue
        try:
            text = source.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # pictures, meshes
        for named in NAMED.finditer(text):
            file, anchor, heading = ROOT / "docs" / named[1], named[2], named[3]
            where = at(source, text.count("\n", 0, named.start()) + 1)
            if not file.is_file():
                yield f"{where}: docs/{named[1]} does not exist"
            elif anchor and anchor not in anchors(file):
                yield f"{where}: docs/{named[1]} has no heading for #{anchor}"
            elif heading and slug(heading) not in {slug(one)[:len(slug(heading))] for one in headings(file)}:
                yield f"{where}: docs/{named[1]} has no heading \"{heading}\""


def unlisted():
    index = ROOT / "docs/README.md"
    if not index.is_file():
        yield "docs/README.md, which lists the pages, does not exist"
        return
    listed = {(index.parent / target.partition("#")[0]).resolve() for _, target in links(index)}
    for page in sorted((ROOT / "docs").rglob("*.md")):
        if page != index and page not in listed and (page.parent == index.parent or page.parent not in listed):
            yield f"docs/README.md does not list {page.relative_to(ROOT / 'docs')}"


def unused_pictures():
    used = {(page.parent / target.partition("#")[0]).resolve() for page in pages() for _, target in links(page)}
    for picture in sorted((ROOT / "docs/pictures").iterdir()):
        if picture not in used:
            yield f"{picture.relative_to(ROOT)}: no page shows it"


def prose_words():
    """Words of README's prose."""
    text = re.sub(r"^(```|~~~).*?^\1|<!--.*?-->|<[^>]*>", " ", text_of(ROOT / "README.md"), flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^\s*\|.*|^#.*|^(?: {4}|\t).*", "", text, flags=re.MULTILINE)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\]\([^)]*\)|^\[[^\]]+\]:.*", "]", text, flags=re.MULTILINE)
    return len(re.findall(r"\w[\w'.,-]*", text))


def word_limit():
    """The number of words that README.md allows itself, or None."""
    limit = LIMIT.search(text_of(ROOT / "README.md"))
    return int(limit[1]) if limit else None


def too_long():
    limit = word_limit()
    if limit is not None and prose_words() > limit:
        yield f"README.md: {prose_words()} words of prose, {limit} at most"


def main():
    wrong = [*broken_links(), *broken_names(), *unlisted(), *unused_pictures(), *fill_figures.complaints(), *too_long()]
    print("\n".join(wrong))
    limit = word_limit()
    print(f"{len(pages())} pages, {sum(len(links(page)) for page in pages())} links, README.md {prose_words()} words of prose "
          f"({'without a limit' if limit is None else f'{limit} at most'}): {len(wrong)} faults")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
