#!/usr/bin/env python3
"""command_reference.py: writes what the programs declare of their commands in other forms.

    tools/command_reference.py markdown -o docs/commands.md        (--check: only compare)
    tools/command_reference.py man -o build/man                    palpable/palpable.1, palpable/palpable-live.1, ...,
                                                                   palpable-bake/palpable-bake.1, ...
    tools/command_reference.py completion -o build/completion      bash/palpable, zsh/_palpable

The programs themselves are asked (`palpable help --reference`, `palpable-bake help --reference`), so that nothing here
can differ from --help. --json takes two files with what they print instead, for builds for another machine.
Manual pages are sorted by the program that has the command, which is the package that holds them.
"""
import argparse
import datetime
import gzip
import json
import os
import pathlib
import re
import subprocess
import sys

# The order in which commands are shown, by what a person wants to do. Every command stands here once.
GROUPS = [
    ("Play", ["live", "replay", "scan", "view", "press", "inspect"]),
    ("Set up", ["doctor", "cameras", "calibrate"]),
    ("Bake", ["bake", "mesh", "merge", "reduce", "report", "compare", "solve"]),
    ("Exchange", ["export", "import-modes", "import-snapshots", "hands", "serve"]),
    ("Evaluate", ["synth", "truth", "score", "bench", "reproduce"]),
]
NAMES = [name for _, names in GROUPS for name in names]
# Other programs start these; people do not.
HIDDEN = {"refine", "about"}
# A program of its own, which is in no package; its commands are explained by itself.
WITHOUT_PAGE = {"bench"}
# Every command takes these, but only the program declares them.
OF_ALL = [("-q", "--quiet", "Print results, errors and warnings only: no progress, no notes"),
          ("-v", "--verbose", "Also print time and memory at the end, and what video libraries report"),
          ("-h", "--help", "Print help and exit")]


# ---- what is declared ----------------------------------------------------------------------------

def declared_by(programs, files):
    """[(program, its declaration)], that of palpable-bake first."""
    for index, program in ((1, "palpable-bake"), (0, "palpable")):
        if files:
            text = files[index].read_text()
        else:
            text = subprocess.run([programs / program, "help", "--reference"], check=True, capture_output=True, text=True).stdout
        yield program, json.loads(text)


def reference_of(programs, files):
    """All commands by name; of both programs, with the name of the program that has them."""
    commands = {}
    for program, declaration in declared_by(programs, files):
        for command in declaration["commands"]:
            name = command["name"]
            # palpable lists the other program's commands without their options.
            if name in HIDDEN or (name in commands and len(command["options"]) < len(commands[name]["options"])):
                continue
            commands[name] = command | {"program": program}
    missed = sorted(set(commands) ^ set(NAMES))
    if missed:
        sys.exit(f"command_reference.py: GROUPS and the programs differ in: {', '.join(missed)}")
    return commands


def options_of(command):
    """Without --help and its like, which all commands have."""
    return [o for o in command["options"] if o["names"][-1] not in ("--help", "--help-all")]


def argument_name(option):
    """DESCRIPTION of an argument that may also be given as --description."""
    return option["names"][-1].lstrip("-").upper()


def arguments_of(command):
    """What stands after the command without an option before it: "BODY [OTHER ...]"."""
    words = []
    for option in options_of(command):
        if option["positional"]:
            word = argument_name(option) + (" ..." if option["several"] else "")
            words.append(word if option["default"] == "required" else f"[{word}]")
    return " ".join(words)


def usage_of(command):
    return f"palpable {command['name']} {arguments_of(command)}".strip() + " [OPTIONS]"


def spelled(option):
    """-o, --out FILE"""
    named = [name for name in option["names"] if name.startswith("-")]
    value = (f" {option['value']}" if option["value"] else "") + (" ..." if option["several"] else "")
    words = [", ".join(named) + value] if named else []
    return " or ".join(([argument_name(option)] if option["positional"] else []) + words)


def notes(option):
    """ [0 or more; default: 7mm]"""
    words = list(option["limits"])
    if option["default"] == "required":
        words.append("required")
    elif option["default"] and not (option["positional"] and option["default"] == "none"):
        words.append("default: " + option["default"])
    return f" [{'; '.join(words)}]" if words else ""


def examples_and_text(command):
    """The commands and the other lines of the text at the end of --help."""
    lines, examples, text = command["footer"].split("\n"), [], []
    for line in lines:
        # The second example of some texts stands below the first, without the word.
        found = re.match(r"(?:Example:| {8}) (palpable\b.*)", line)
        (examples if found else text).append(found[1] if found else line)
    if not options_of(command):
        text.append(f"palpable {command['name']} --help says more.")
    return examples, [line for line in text if line]


def headings(options):
    """[((heading, whether of experts), options)] in the order in which they were declared; arguments first."""
    found = {("Arguments", False): []}
    for option in options:
        key = ("Arguments", False) if option["positional"] else (option["heading"], option["expert"])
        found.setdefault(key, []).append(option)
    return [(key, of) for key, of in found.items() if of]


# ---- markdown ------------------------------------------------------------------------------------

def cell(text):
    return re.sub(r"([|<>\[\]*_])", r"\\\1", text)


def code(text):
    return "`" + text.replace("|", "\\|") + "`"


def markdown_of(command):
    examples, text = examples_and_text(command)
    out = [f"## {command['name']}", "", cell(command["what"]).rstrip(".") + ".", "", f"    {usage_of(command)}", ""]
    for (heading, expert), options in headings(options_of(command)):
        out += [f"| {heading}{' (`--help-all`)' if expert else ''} | |", "|---|---|"]
        out += [f"| {code(spelled(option))} | {cell(option['what'] + notes(option))} |" for option in options]
        out.append("")
    for line in text:
        # Tables of words in columns stay as they are.
        out += [f"    {line}"] if re.search(r"^ |\S {2,}\S", line) else ["", cell(line), ""]
    if examples:
        out += ["", "```sh", *examples, "```"]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out).rstrip("\n")).split("\n") + [""]


def markdown(commands):
    out = ["# Commands", "",
           "Made by `tools/command_reference.py markdown` from what the programs declare; `palpable help COMMAND` prints the same.",
           "Every command takes `-q` (no progress, no notes) and `-v` (time and memory at the end). Results are printed on stdout,",
           "everything else on stderr. Exit code 0, or 1 after any error.", ""]
    for group, names in GROUPS:
        out += [f"**{group}:** " + ", ".join(f"[{name}](#{name})" for name in names), ""]
    for name in NAMES:
        out += markdown_of(commands[name])
    return "\n".join(out).rstrip("\n") + "\n"


# ---- manual pages --------------------------------------------------------------------------------

def roff(text):
    """The text with what roff would take for its own escaped."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("`", "\\(ga").replace("^", "\\(ha").replace("~", "\\(ti")
    return "\\&" + text if text.startswith((".", "'")) else text


def roff_lines(lines):
    """Paragraphs; lines in columns are kept as they are."""
    out, kept = [], False
    for line in lines:
        columns = re.search(r"^ |\S {2,}\S", line) is not None
        if columns != kept:
            out.append(".nf" if columns else ".fi")
        out += [roff(line)] if columns else [".PP", roff(line)]
        kept = columns
    return out + ([".fi"] if kept else [])


def head_of_page(name, what, version):
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    date = datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc).strftime("%B %Y") if epoch else ""
    return [f'.TH {name.upper()} 1 "{date}" "palpable {version}" "User Commands"', ".SH NAME", f"{roff(name)} \\- {roff(what)}"]


def options_on_page(command):
    out = []
    for (heading, _), options in headings(options_of(command)):
        out += [f".SH {roff(heading.upper())}"]
        for option in options:
            out += [".TP", f".B {roff(spelled(option))}", roff(option["what"] + notes(option))]
    out += [".SH COMMON OPTIONS"]
    for short, long, what in OF_ALL:
        out += [".TP", f".B {roff(short)}, {roff(long)}", roff(what)]
    return out


def man_page(command, version):
    """The page of a command: palpable-live(1)."""
    name = f"palpable-{command['name']}"
    usage = usage_of(command).split(" ", 2)
    out = [*head_of_page(name, command["what"], version), ".SH SYNOPSIS", f".B {roff(' '.join(usage[:2]))}", roff(usage[2]),
           *options_on_page(command)]
    examples, text = examples_and_text(command)
    if command["name"] == "bake":
        text.append("The program palpable-bake, which palpable starts, has this command and the others that prepare bodies.")
    if text:
        out += [".SH NOTES", *roff_lines(text)]
    if examples:
        out += [".SH EXAMPLES", ".nf", *[roff(example) for example in examples], ".fi"]
    return "\n".join(out + [".SH SEE ALSO", ".BR palpable (1)"]) + "\n"


def main_page(commands, version):
    out = [*head_of_page("palpable", "virtual deformable bodies that real hands press", version), ".SH SYNOPSIS",
           ".B palpable", roff("COMMAND [OPTIONS]"), ".SH DESCRIPTION",
           "A stereo camera sees a desk; virtual bodies stand on it and yield where real things press them.",
           "Without an argument the program says what to begin with.",
           roff("palpable help COMMAND and palpable-COMMAND(1) explain each command.")]
    for group, names in GROUPS:
        out += [f".SH {roff(group.upper())}"]
        for name in names:
            title = f".B {roff('bench')}" if name in WITHOUT_PAGE else f".BR palpable\\-{roff(name)} (1)"
            out += [".TP", title, roff(commands[name]["what"])]
    out += [".SH OPTIONS"]
    for short, long, what in OF_ALL:
        out += [".TP", f".B {roff(short)}, {roff(long)}", roff(what)]
    return "\n".join(out + [".TP", ".B \\-\\-version", "Print the version and exit", ".SH EXIT STATUS", "0, or 1 after any error."]) + "\n"


def pages(commands, version):
    """{file: text}, sorted into a folder for each program."""
    found = {f"{commands[name]['program']}/palpable-{name}.1": man_page(commands[name], version)
             for name in NAMES if name not in WITHOUT_PAGE}
    return found | {"palpable/palpable.1": main_page(commands, version)}


# ---- completion ----------------------------------------------------------------------------------

def completes(option):
    """"words", "files", "folders", or an empty text."""
    if option["choices"]:
        return "words"
    kinds = {re.sub(r"\..*", "", word) for word in option["value"].split("|")}
    return "files" if "FILE" in kinds else "folders" if "DIR" in kinds else ""


BASH_HEAD = """# bash completion for palpable, made by tools/command_reference.py

# Words that begin like the one before the cursor.
_palpable_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_palpable_paths() {
  mapfile -t COMPREPLY < <(compgen "$1" -- "$word")
  compopt -o filenames 2>/dev/null
}

_palpable() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} last=$((COMP_CWORD - 1)) several=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ] || { [ "$command" = help ] && [ "$COMP_CWORD" -eq 2 ]; }; then
    _palpable_words "@commands@ help --help --version"
    return
  fi
  # --out=x is three words to bash.
  [ "$word" = = ] && word=
  [ "${COMP_WORDS[last]}" = = ] && last=$((last - 1))
  # The option to which the word belongs; of some several words follow.
  while [ "$last" -gt 1 ] && [[ ${COMP_WORDS[last]} != -* ]]; do
    last=$((last - 1))
    several=" several"
  done
  if [[ $word != -* ]]; then
    case "$command ${COMP_WORDS[last]}$several" in
"""
BASH_MIDDLE = """    esac
  fi
  case "$word" in
    -*)
      case "$command" in
"""
BASH_END = """      esac
      return ;;
  esac
  _palpable_paths -f
}
complete -F _palpable palpable
"""


def bash_case(name, option):
    """The line for a word after this option; empty if nothing is known of it."""
    patterns = [f'"{name} {word}"' for word in option["names"] if word.startswith("-")]
    if not patterns or not completes(option):
        return ""
    if option["several"]:
        patterns += [pattern[:-1] + ' several"' for pattern in patterns]
    what = {"words": f'_palpable_words "{" ".join(option["choices"])}"', "files": "_palpable_paths -f",
            "folders": "_palpable_paths -d"}[completes(option)]
    return f"      {' | '.join(patterns)}) {what}; return ;;\n"


def bash_completion(commands):
    out = BASH_HEAD.replace("@commands@", " ".join(NAMES))
    for name in NAMES:
        out += "".join(bash_case(name, option) for option in options_of(commands[name]))
        # An argument that is one of some words stands after the command or after options that have their values.
        for option in options_of(commands[name]):
            if option["positional"] and option["choices"]:
                out += f'      "{name} {name}") _palpable_words "{" ".join(option["choices"])}"; return ;;\n'
    out += BASH_MIDDLE
    for name in NAMES:
        words = [word for option in options_of(commands[name]) for word in option["names"] if word.startswith("--")]
        out += f'        {name}) _palpable_words "{" ".join([*words, "--quiet", "--verbose", "--help", "--help-all"])}" ;;\n'
    return out + BASH_END


def zsh_quoted(text):
    """Inside of '...' and of [...]."""
    return re.sub(r"([\[\]:\\])", r"\\\1", text).replace("'", "'\\''")


def zsh_spec(option, word):
    """'*--out=[Folder to write into]:DIR:_files -/'"""
    action = ""
    if option["value"]:
        way = {"words": f"({' '.join(option['choices'])})", "files": "_files", "folders": "_files -/", "": " "}[completes(option)]
        action = f":{zsh_quoted(option['value'])}:{way}"
    equals = "=" if action and word.startswith("--") else ""
    return f"'*{word}{equals}[{zsh_quoted(option['what'])}]{action}'"


def zsh_completion(commands):
    out = ["#compdef palpable", "# made by tools/command_reference.py", "_palpable() {", "  local -a commands", "  commands=("]
    out += [f"    '{name}:{zsh_quoted(commands[name]['what'])}'" for name in NAMES]
    out += ["    'help:Explain a command'", "  )",
            "  if (( CURRENT == 2 )) || { (( CURRENT == 3 )) && [[ $words[2] == help ]] }; then",
            "    _describe command commands", "    return", "  fi", "  local command=$words[2]", "  shift words", "  (( CURRENT-- ))",
            "  case $command in"]
    for name in NAMES:
        options = options_of(commands[name])
        out.append(f"    {name}) _arguments -s \\")
        out += [f"      {zsh_spec(option, word)} \\" for option in options for word in option["names"] if word.startswith("-")]
        out += [f"      '{short}[{zsh_quoted(what)}]' '{long}[{zsh_quoted(what)}]' \\" for short, long, what in OF_ALL]
        words = [" ".join(option["choices"]) for option in options if option["positional"] and option["choices"]]
        out.append(f"      '*:argument:{f'({words[0]})' if words else '_files'}' ;;")
    return "\n".join(out + ["  esac", "}", '_palpable "$@"']) + "\n"


# ---- the tool ------------------------------------------------------------------------------------

def written(options):
    """{path below the output: text}; an empty path is the output itself."""
    commands = reference_of(options.programs, options.json)
    if options.form == "markdown":
        return {"": markdown(commands)}
    if options.form == "completion":
        return {"bash/palpable": bash_completion(commands), "zsh/_palpable": zsh_completion(commands)}
    version = options.release or subprocess.run([options.programs / "palpable", "--version"], check=True, capture_output=True,
                                                text=True).stdout.split()[-1]
    return pages(commands, version)


def write(out, files, compress):
    if compress:  # pages of commands that are gone must not be packed
        for old in out.glob("*/*.1.gz"):
            old.unlink()
    for name, text in files.items():
        path = out / (name + ".gz" if compress else name) if name else out
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(gzip.compress(text.encode(), 9, mtime=0) if compress else text.encode())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("form", choices=["markdown", "man", "completion"])
    parser.add_argument("-o", "--out", type=pathlib.Path, required=True, help="file (markdown) or folder to write")
    parser.add_argument("--programs", type=pathlib.Path, default=pathlib.Path("build/release/bin"), help="folder of the programs")
    parser.add_argument("--json", type=pathlib.Path, nargs=2, metavar=("PALPABLE", "BAKE"), help="files with what they declare, instead")
    parser.add_argument("--release", help="version for manual pages; with --json it is not asked for")
    parser.add_argument("--gzip", action="store_true", help="compress manual pages")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a file differs")
    options = parser.parse_args()
    if options.form == "man" and options.json and not options.release:
        parser.error("man with --json needs --release")
    files = written(options)
    if not options.check:
        write(options.out, files, options.gzip)
        return
    for name, text in files.items():
        path = options.out / name if name else options.out
        if not path.exists() or path.read_text() != text:
            sys.exit(f"{path} differs from what the programs declare: tools/command_reference.py {options.form} -o {options.out}")


if __name__ == "__main__":
    main()
