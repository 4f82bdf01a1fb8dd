#!/usr/bin/env python3
"""command_reference.py: writes what the programs declare of their commands in other forms.

    tools/command_reference.py markdown -o docs/commands.md
    tools/command_reference.py man -o build/man            palpable.1, palpable-live.1, ...
    tools/command_reference.py completion -o build/completion   bash/palpable, zsh/_palpable

The programs themselves are asked (`palpable help --reference`, `palpable-bake help --reference`), so that nothing here
can differ from --help. --check compares the markdown file with what would be written, and says how to renew it.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

# The order in which commands are shown, by what a person wants to do. Every command stands here once.
GROUPS = [
    ("Play", ["live", "replay", "scan", "view", "press", "inspect"]),
    ("Set up", ["doctor", "cameras", "calibrate"]),
    ("Bake", ["bake", "mesh", "merge", "reduce", "report", "compare", "solve"]),
    ("Exchange", ["export", "import-modes", "import-snapshots"]),
    ("Evaluate", ["synth", "truth", "score", "bench", "reproduce"]),
]
# Other programs start these; people do not.
HIDDEN = {"refine", "about"}


def reference_of(programs):
    """All commands by name; of both programs, with the name of the program that has them."""
    commands = {}
    for program in ("palpable-bake", "palpable"):
        text = subprocess.run([programs / program, "help", "--reference"], check=True, capture_output=True, text=True).stdout
        for command in json.loads(text)["commands"]:
            name = command["name"]
            # palpable lists the other program's commands without their options.
            if name in HIDDEN or (name in commands and len(command["options"]) < len(commands[name]["options"])):
                continue
            commands[name] = command
    grouped = [name for _, names in GROUPS for name in names]
    missing = sorted(set(commands) - set(grouped)) + sorted(set(grouped) - set(commands))
    if missing:
        sys.exit(f"command_reference.py: GROUPS and the programs differ in: {', '.join(missing)}")
    return commands


def options_of(command):
    """Without --help and its like, which all commands have."""
    return [o for o in command["options"] if o["names"][-1] not in ("--help", "--help-all")]


def spelled(option):
    """-o, --out FILE"""
    names = ", ".join(option["names"])
    if option["positional"] and not option["names"][0].startswith("-"):
        return option["names"][0]
    return names + (f" {option['value']}" if option["value"] else "") + (" ..." if option["several"] else "")


def notes(option):
    """[0 or more; default: 7mm]"""
    words = list(option["limits"])
    if option["default"] == "required":
        words.append("required")
    elif option["default"]:
        words.append("default: " + option["default"])
    return f" [{'; '.join(words)}]" if words else ""


def examples_and_text(footer):
    lines = footer.split("\n")
    return ([line.removeprefix("Example: ") for line in lines if line.startswith("Example: ")],
            [line for line in lines if line and not line.startswith("Example: ")])


def headings(options):
    """Groups of options in the order in which they were declared."""
    found = {}
    for option in options:
        heading = "Arguments" if option["positional"] else option["heading"]
        found.setdefault((heading, option["expert"]), []).append(option)
    return found


def cell(text):
    return re.sub(r"([|<>\[\]*_])", r"\\\1", text)


def markdown(commands):
    out = ["# Commands", "",
           "Made by `tools/command_reference.py markdown` from what the programs declare; `palpable help COMMAND` prints the same.",
           "Every command takes `-q` (no progress, no notes) and `-v` (time and memory at the end). Results are printed on stdout,",
           "everything else on stderr. Exit code 0, or 1 after any error.", ""]
    for group, names in GROUPS:
        out += [f"**{group}:** " + ", ".join(f"[{name}](#{name})" for name in names), ""]
    for _, names in GROUPS:
        for name in names:
            command = commands[name]
            examples, text = examples_and_text(command["footer"])
            out += [f"## {name}", "", cell(command["what"]) + ".", ""]
            for (heading, expert), options in headings(options_of(command)).items():
                title = heading + (" (`--help-all`)" if expert else "")
                out += [f"| {title} | |", "|---|---|"]
                for option in options:
                    out.append(f"| `{spelled(option).replace('|', chr(92) + '|')}` | {cell(option['what'] + notes(option))} |")
                out.append("")
            for line in text:
                out += [cell(line), ""]
            if examples:
                out += ["```sh", *examples, "```", ""]
    return "\n".join(out).rstrip("\n") + "\n"


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text.startswith((".", "'")) else text


def man_page(name, command, version):
    title = name.upper()
    out = [f'.TH {title} 1 "" "palpable {version}" "User Commands"', ".SH NAME", roff(f"{name} - {command['what']}"),
           ".SH SYNOPSIS", f".B {roff(name.replace('palpable-', 'palpable ', 1) if name != 'palpable-bake' else name)}"]
    options = options_of(command)
    arguments = " ".join(o["names"][0] for o in options if o["positional"])
    out += [roff(f"[OPTIONS] {arguments}".strip())]
    for (heading, _), group in headings(options).items():
        out += [f".SH {roff(heading.upper())}"]
        for option in group:
            out += [".TP", f".B {roff(spelled(option))}", roff(option["what"] + notes(option))]
    examples, text = examples_and_text(command["footer"])
    if text:
        out += [".SH NOTES"]
        for line in text:
            out += [roff(line), ".PP"]
    if examples:
        out += [".SH EXAMPLES", ".nf", *[roff(e) for e in examples], ".fi"]
    out += [".SH SEE ALSO", ".BR palpable (1)"]
    return "\n".join(out) + "\n"


def main_page(commands, version):
    out = [f'.TH PALPABLE 1 "" "palpable {version}" "User Commands"', ".SH NAME",
           roff("palpable - virtual deformable bodies that real hands press"), ".SH SYNOPSIS",
           ".B palpable", roff("COMMAND [OPTIONS]"), ".SH DESCRIPTION",
           "A stereo camera sees a desk; virtual bodies stand on it and yield where real things press them.",
           roff("palpable COMMAND --help and palpable-COMMAND(1) explain each command.")]
    for group, names in GROUPS:
        out += [f".SH {roff(group.upper())}"]
        for name in names:
            out += [".TP", f".BR palpable\\-{roff(name)} (1)", roff(commands[name]["what"])]
    out += [".SH OPTIONS", ".TP", ".B \\-q, \\-\\-quiet", "Print results, errors and warnings only", ".TP",
            ".B \\-v, \\-\\-verbose", "Also print time and memory at the end", ".TP", ".B \\-\\-version", "Print the version and exit",
            ".SH EXIT STATUS", "0, or 1 after any error."]
    return "\n".join(out) + "\n"


def completes_files(option):
    return option["value"].split(".")[0].split("|")[0] in ("FILE", "DIR")


def bash_completion(commands):
    names = [name for _, group in GROUPS for name in group]
    out = ["# bash completion for palpable, made by tools/command_reference.py", "_palpable() {",
           '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]}',
           "  COMPREPLY=()", "  if [ \"$COMP_CWORD\" -eq 1 ] || { [ \"$command\" = help ] && [ \"$COMP_CWORD\" -eq 2 ]; }; then",
           f'    COMPREPLY=($(compgen -W "{" ".join(names)} help --help --version" -- "$word"))', "    return", "  fi",
           '  case "$command $before" in']
    for name in names:
        for option in options_of(commands[name]):
            pattern = "|".join(f'"{name} {n}"' for n in option["names"] if n.startswith("-"))
            if pattern and option["choices"]:
                out.append(f'    {pattern}) COMPREPLY=($(compgen -W "{" ".join(option["choices"])}" -- "$word")); return ;;')
            elif pattern and completes_files(option):
                out.append(f'    {pattern}) COMPREPLY=($(compgen -f -- "$word")); compopt -o filenames 2>/dev/null; return ;;')
    out += ["  esac", '  case "$word" in', "    -*)", '      case "$command" in']
    for name in names:
        words = " ".join(n for o in options_of(commands[name]) for n in o["names"] if n.startswith("--"))
        out.append(f'        {name}) COMPREPLY=($(compgen -W "{words} --help" -- "$word")) ;;')
    out += ["      esac", "      return ;;", "  esac",
            '  COMPREPLY=($(compgen -f -- "$word"))', "  compopt -o filenames 2>/dev/null", "}", "complete -F _palpable palpable"]
    return "\n".join(out) + "\n"


def zsh_quoted(text):
    return text.replace("'", "'\\''").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")


def zsh_completion(commands):
    out = ["#compdef palpable", "# made by tools/command_reference.py", "_palpable() {", "  local -a commands", "  commands=("]
    names = [name for _, group in GROUPS for name in group]
    out += [f"    '{name}:{zsh_quoted(commands[name]['what'])}'" for name in names]
    out += ["    'help:Explain a command'", "  )", "  if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then",
            "    _describe command commands", "    return", "  fi", "  local command=$words[2]", "  shift words", "  (( CURRENT-- ))",
            "  case $command in"]
    for name in names:
        out.append(f"    {name}) _arguments -s \\")
        for option in options_of(commands[name]):
            for word in option["names"]:
                if not word.startswith("-"):
                    continue
                action = ""
                if option["value"]:
                    what = f"({' '.join(option['choices'])})" if option["choices"] else "_files" if completes_files(option) else " "
                    action = f":{zsh_quoted(option['value'])}:{what}"
                out.append(f"      '*{word}[{zsh_quoted(option['what'])}]{action}' \\")
        out.append("      '*:file:_files' ;;")
    out += ["  esac", "}", '_palpable "$@"']
    return "\n".join(out) + "\n"


def written(form, programs):
    """{path below the output: text}"""
    commands = reference_of(programs)
    if form == "markdown":
        return {"": markdown(commands)}
    if form == "completion":
        return {"bash/palpable": bash_completion(commands), "zsh/_palpable": zsh_completion(commands)}
    version = subprocess.run([programs / "palpable", "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    pages = {f"palpable-{name}.1": man_page(f"palpable-{name}", command, version) for name, command in commands.items()}
    return {**pages, "palpable.1": main_page(commands, version)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("form", choices=["markdown", "man", "completion"])
    parser.add_argument("-o", "--out", type=pathlib.Path, required=True, help="file (markdown) or folder to write")
    parser.add_argument("--programs", type=pathlib.Path, default=pathlib.Path("build/release/bin"), help="folder of the programs")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if the file differs")
    options = parser.parse_args()
    for name, text in written(options.form, options.programs).items():
        path = options.out / name if name else options.out
        if options.check:
            if not path.exists() or path.read_text() != text:
                sys.exit(f"{path} differs from what the programs declare: tools/command_reference.py {options.form} -o {options.out}")
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


if __name__ == "__main__":
    main()
