#!/usr/bin/env python3
"""Finds names in the anonymous namespaces of one module that several of its files use.

The release build compiles a module as one file (PALPABLE_UNITY, cmake/PalpableModule.cmake): a type or constant that
two files define is then an error, and two functions of one name become overloads, of which a call may select the other
file's without a message. The same may happen to a call of a function declared in a header that another file hides by
one of its own. Prints one line for each such name; exit code 1 if there are any.
Programs and benchmarks (folders of apps and bench) are compiled the same way. Tests are not: they remain single files.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# A word, ::, or a single sign; comments, strings and preprocessor lines are removed before.
TOKEN = re.compile(r"[A-Za-z_]\w*|::|->|[^\s\w]|\d[\w.']*")
NOISE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"|(?<!\w)\'(?:[^\'\\\n]|\\.)+\'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*',
                   re.DOTALL | re.MULTILINE)
SKIPPED_WORDS = {"static", "inline", "constexpr", "const", "extern", "constinit", "thread_local"}


def tokens_of(text):
    """(token, line) of a C++ file."""
    text = NOISE.sub(lambda match: " " + "\n" * match[0].count("\n"), text)
    line = 1
    for part in re.finditer(rf"\n|{TOKEN.pattern}", text):
        if part[0] == "\n":
            line += 1
        else:
            yield part[0], line


def after_brackets(tokens, at, opening, closing):
    """The index after the bracket that closes the one at `at`."""
    depth = 0
    while at < len(tokens):
        depth += (tokens[at][0] == opening) - (tokens[at][0] == closing)
        at += 1
        if depth == 0:
            break
    return at


def declared_name(words):
    """The name that a declaration, given up to its first { or ;, declares; None if it declares none."""
    if words[:1] == ["template"]:
        words = words[after_brackets([(w, 0) for w in words], 1, "<", ">"):]
    while words and (words[0] in SKIPPED_WORDS or words[0] == "["):
        words = words[words.index("]", words.index("]") + 1) + 1:] if words[0] == "[" else words[1:]
    if not words or words[0] in ("friend", "static_assert", "namespace", "requires"):
        return None
    if words[0] == "using":
        return words[1] if "=" in words else None
    if words[0] in ("struct", "class", "union", "enum"):
        rest = [w for w in words[1:] if w not in ("class", "struct", "final", "alignas")]
        if rest and rest[0] == "(":
            rest = rest[rest.index(")") + 1:]
        # A declaration of a variable of that type, or of the type itself.
        return rest[0] if rest and re.match(r"[A-Za-z_]", rest[0]) and (len(rest) == 1 or rest[1] == ":") else None
    angle = 0
    for at, word in enumerate(words):
        if word == "operator":
            return None
        angle += (word == "<") - (word == ">")
        if angle == 0 and word in ("(", "=", "[") and at > 0 and re.match(r"[A-Za-z_]", words[at - 1]):
            if words[at - 1] in ("decltype", "alignas", "noexcept"):
                continue
            return None if at > 1 and words[at - 2] == "::" else words[at - 1]
    named = [w for w in words if re.match(r"[A-Za-z_]", w)]
    return named[-1] if len(named) > 1 else None


def names_of(text, is_header=False):
    """{name: line} of the names that a file declares for itself alone: in its anonymous namespaces, and static ones. For a
    header: those in its other namespaces."""
    tokens, found, scopes, at, start = list(tokens_of(text)), {}, [], 0, 0
    while at < len(tokens):
        word, line = tokens[at]
        words = [w for w, _ in tokens[start:at]]
        if word == "}":  # end of a namespace; other blocks are skipped as a whole
            if scopes:
                scopes.pop()
            at += 1
            start = at
        elif word == "(" or (word == "[" and words):
            at = after_brackets(tokens, at, word, ")" if word == "(" else "]")
        elif word == "{" and words[:1] == ["namespace"] or word == "{" and words[:2] == ["inline", "namespace"]:
            scopes.append("" if words == ["namespace"] else words[-1])
            at += 1
            start = at
        elif word in ("{", ";"):
            hidden = "" in scopes or "static" in words[:3]
            if is_header:
                hidden = not hidden and bool(scopes) and "detail" not in scopes
            name = declared_name(words) if hidden and words else None
            if name is not None:
                found.setdefault(name, tokens[start][1])
            if hidden and word == "{" and words[0] == "enum" and words[1:2] != ["class"]:
                inside = tokens[at + 1:after_brackets(tokens, at, "{", "}") - 1]
                for before, (enumerator, where) in zip([("{", 0), *inside], inside):
                    if before[0] in ("{", ",") and re.match(r"[A-Za-z_]", enumerator):
                        found.setdefault(enumerator, where)
            if word == "{":
                at = after_brackets(tokens, at, "{", "}")
                # A braced initialiser or a type is followed by ;, a function by the next declaration. Initialisers of a
                # constructor have braces of their own before the body.
                while at < len(tokens) and tokens[at][0] in (",", "{") and ":" in words:
                    at = after_brackets(tokens, at, "{", "}") if tokens[at][0] == "{" else at + 1
                    while at < len(tokens) and tokens[at][0] not in ("{", ";", "("):
                        at += 1
                    if at < len(tokens) and tokens[at][0] == "(":
                        at = after_brackets(tokens, at, "(", ")")
                if at < len(tokens) and tokens[at][0] in (";",):
                    at += 1
            else:
                at += 1
            start = at
        else:
            at += 1
    return found


def units():
    """Lists of files that are compiled as one."""
    for folder in sorted([*(ROOT / "src/palpable").glob("*/*"), *(ROOT / "apps").iterdir(), *(ROOT / "bench").iterdir()]):
        if folder.is_dir():
            files = [file for file in sorted(folder.rglob("*.cpp")) if not file.stem.endswith("_test")]
            yield {file: file.read_text() for file in files if "foreach_target.h" not in file.read_text()}


def names_of_headers():
    """{name: where} of all names that our headers declare."""
    found = {}
    for folder in ("src/palpable", "apps", "bench"):
        for header in sorted((ROOT / folder).rglob("*.h")):
            for name, line in names_of(header.read_text(), is_header=True).items():
                found.setdefault(name, []).append(f"{header.relative_to(ROOT)}:{line}")
    return found


def included(where, text):
    """Whether a file with this text includes the header of `where`, a path and a line."""
    return f'#include "{where.split(":")[0].removeprefix("src/")}"' in text


def main():
    wrong, declared = [], names_of_headers()
    for texts in units():
        there = {}
        words = {file: set(re.findall(r"(?<![.>:\w])[A-Za-z_]\w*", NOISE.sub(" ", text))) for file, text in texts.items()}
        for file, text in texts.items():
            where = file.relative_to(ROOT)
            for name, line in names_of(text).items():
                if name in there:
                    wrong.append(f"{where}:{line}: '{name}' is also a name in the anonymous namespace of {there[name]}")
                there.setdefault(name, f"{where}:{line}")
                # A file's own overload of a function that it also defines for others is correct: the types distinguish them.
                for header in declared.get(name, ()) if name not in names_of(text, is_header=True) else ():
                    users = [f for f in texts if f != file and name in words[f] and included(header, texts[f])]
                    if users:
                        wrong.append(f"{where}:{line}: '{name}' hides that of {header}, which "
                                     f"{users[0].relative_to(ROOT)} uses")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
