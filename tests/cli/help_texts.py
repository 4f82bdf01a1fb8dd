#!/usr/bin/env python3
"""What the programs say of their options: in --help and --help-all, in what `help --reference` declares, in messages,
in examples, and in the documents, which are made of it or have to agree with it."""
import json
import re
import shlex
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import programs as base

base.CASES.clear()
case = base.case

WIDEST = 100
MOST_OF_LIVE = 20
# Every command has these. They count as no option of their own.
COMMON = {"-h", "--help", "--help-all", "-q", "--quiet", "-v", "--verbose", "--json"}
# Of the program: not in the list of a command.
OF_PROGRAM = {"-q", "--quiet", "-v", "--verbose", "--version", "--help-all", "--reference"}


class Reference:
    """What the programs declare: {command: declaration}. Benches are called "bench NAME"."""

    def __init__(self, programs):
        self.folder = Path(programs.palpable).parent
        self.commands = {}
        for program, before in (("palpable", ""), ("palpable-bake", ""), ("palpable-bench", "bench "),
                                ("palpable-bake-bench", "bench ")):
            said = subprocess.run([self.folder / program, "help", "--reference"], capture_output=True, text=True, check=True)
            for command in json.loads(said.stdout)["commands"]:
                # palpable lists the commands of palpable-bake without their options.
                known = self.commands.get(before + command["name"])
                if known is None or len(command["options"]) > len(known["options"]):
                    command["program"] = program
                    self.commands[before + command["name"]] = command

    def users(self):
        """Those of the two programs, without benches."""
        return {name: command for name, command in self.commands.items() if " " not in name}

    def option(self, command, word):
        for option in self.commands[command]["options"]:
            if word in option["names"]:
                return option
        return None

    def names(self):
        return {name for command in self.commands.values() for option in command["options"] for name in option["names"]}

    def text(self, command, how):
        # Other programs start these two; palpable does not know them.
        program = "palpable-bake" if command in ("about", "refine") else "palpable"
        return subprocess.run([self.folder / program, *command.split(), how], capture_output=True, text=True, check=True).stdout


def own_options(command):
    """The options of a command that are no arguments, without those that every command has."""
    return [option for option in command["options"]
            if option["names"][-1].startswith("-") and not COMMON & set(option["names"])]


def entries(help_text):
    """{option's last name: its lines in the help text as one line}"""
    found = {}
    for names, rest, more in re.findall(r"^  (-\S+)(.*)\n((?: {12,}.*\n)*)", help_text, re.MULTILINE):
        found[names.split(",")[-1]] = " ".join((rest + " " + more).split())
    return found


def listing(lines):
    return "\n".join(sorted(lines))


@case("no line of any help text is wider than 100 columns, and none ends in spaces")
def _(programs, folder):
    reference = Reference(programs)
    texts = {(command, how): reference.text(command, how) for command in reference.commands for how in ("--help", "--help-all")}
    for program in ("palpable", "palpable-bake", "palpable-bench", "palpable-bake-bench"):
        for words in ((), ("--help",), ("help",)):
            said = subprocess.run([reference.folder / program, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)
            texts[(program, *words)] = said.stdout
    wrong = [f"{' '.join(words)}: {len(line)} columns: {line}|" for words, text in texts.items() for line in text.splitlines()
             if len(line) > WIDEST or line != line.rstrip()]
    assert not wrong, listing(wrong)
    assert len(reference.users()) >= 25 and len(reference.commands) >= 38, sorted(reference.commands)
    for name in reference.users().keys() - {"about", "refine"}:
        assert re.search(rf"^  {name} ", texts[("palpable", "--help")], re.MULTILINE), f"{name} is not in palpable --help"
    assert all(command["what"] for command in reference.commands.values())


@case("every option that takes a value shows its default, that it is required, or that there is none")
def _(programs, folder):
    reference, wrong = Reference(programs), []
    for name, command in reference.commands.items():
        shown = entries(reference.text(name, "--help-all"))
        for option in command["options"]:
            last = option["names"][-1]
            if "Default:" in option["what"] or "default:" in option["what"]:
                wrong.append(f"{name} {last}: its text speaks of the default: {option['what']}")
            if not option["value"]:
                continue
            if not option["default"]:
                wrong.append(f"{name} {last}: declares no default")
            # That of an argument stands in the line "usage".
            if last.startswith("-") and not re.search(r"\[.*(default: \S|required).*\]", shown.get(last, "")):
                wrong.append(f"{name} {last}: {shown.get(last, 'is not in --help-all')}")
    assert not wrong, listing(wrong)


# A thing that several commands speak of, the name of its option, and what betrays an option of that thing: a pattern of
# its text, and one of its value. An argument (without -- before it) may have any name.
THINGS = [
    ("the result, a file or folder", "--out", r"^(?!Also).*\b(to write|write the results)\b", r"^(FILE|DIR)"),
    ("how many threads", "--threads", r"one for each core|[Tt]hreads", r"^N$"),
    ("the error that is accepted", "--tolerance", r"[Rr]elative error|error of the (reduction|modes)", r"^NUMBER$"),
    ("the most modes", "--max-modes", r"[Mm]odes at the (latest|most)|[Aa]t most this many modes", r"^N$"),
    ("a body file", "--body", r"^(The )?[Bb]od(y|ies)( file)?s?\b(?!.*to write)", r"^FILE(\.palpable)?$"),
    ("the description of a body", "--description", r"docs/body\.md", r"^FILE"),
    ("a scene file", "--scene", r"docs/scenes\.md", r"^FILE"),
    ("the value of a parameter", "--set", r"", r"^NAME=VALUE$"),
    ("the result as JSON", "--json", r"JSON object", r"^$"),
    ("after how many frames to stop", "--frames", r"[Ff]rames at most|after this many frames|^How many, at 30 a second", r"^N$"),
    ("where the body stands", "--place", r"", r"^POSE$"),
    ("the seed of what is random", "--seed", r"^(sparse-pgd: )?[Dd]ecides", r"^N$"),
    ("what is painted on bodies", "--paint", r"painted on", r""),
    ("width and height", "--size", r"", r"^WIDTHxHEIGHT$"),
    ("a load at a point", "--load", r"", r"^X,Y,Z=F$"),
    ("which site", "--site", r"\b(this site|[Ww]hich of the description's sites)\b", r"^N$"),
    ("a share of the full load", "--level", r"[Ss]hare of", r"^NUMBER$"),
    ("where pictures come from", "--source", r"^(Stereo pairs of a board: )?[Aa] folder\b.*images by name", r""),
    ("the calibration of a camera", "--calibration", r"^(OpenCV YAML|Calibration of)", r"^FILE"),
    ("the corners of a board", "--board", r"", r"^COLUMNSxROWS$"),
    ("the side of a board's squares", "--square", r"[Ss]ide of one of its squares", r""),
    ("that an earlier result is replaced", "--overwrite", r"^Replace", r"^$"),
    ("the pace of a recording", "--paced", r"at its own pace", r"^$"),
    ("the order of tetrahedra", "--order", r"10-node|[Tt]etrahedra of 4 nodes", r"^N$"),
]
# (command, option): why it is no option of the thing that its text speaks of.
OTHER_THINGS = {
    ("live", "--refine"): "asks for a second process, which reads the description",
    ("replay", "--view"): "a picture's content",
    ("bake", "--snapshots"): "a folder beside the result, which is kept",
    ("solve", "--poses"): "a path of obstacles",
}


@case("no two commands have two names for one thing")
def _(programs, folder):
    wrong, found = [], defaultdict(set)
    for name, command in Reference(programs).users().items():
        for option in own_options(command) + [o for o in command["options"] if "--json" in o["names"]]:
            for thing, only, text, value in THINGS:
                is_one = re.search(text, option["what"]) and re.search(value, option["value"])
                if not is_one or (name, option["names"][-1]) in OTHER_THINGS:
                    continue
                found[thing].add(name)
                if only not in option["names"]:
                    wrong.append(f"{name} {option['names'][-1]} is {thing}, which is called {only}: {option['what']}")
    assert not wrong, listing(wrong)
    # A pattern that meets nothing would guard nothing.
    missed = [thing for thing, *_ in THINGS if not found[thing]]
    assert not missed, missed


# Names whose values are of several kinds, with the reason.
SEVERAL_KINDS = {
    "--out": "a file or a folder: what the command makes",
    "--poses": "poses in a file; score also finds them in the folder of a data set",
}
# How values are called; each of these has one spelling, and these are other ones.
OTHER_SPELLINGS = {"FOLDER", "PATH", "STORE", "CLIP", "METRES", "MM", "INT", "UINT", "FLOAT", "BODY", "SCENE", "NUM", "COUNT"}


def kind_of(option):
    """FILE of FILE.toml and FILE...; all lists of words are one kind."""
    if option["choices"]:
        return "one of its words"
    return re.sub(r"(?<=FILE)\.\w+|\.\.\.$", "", option["value"])


@case("no name of an option is used for two kinds of value, and each kind of value has one spelling")
def _(programs, folder):
    kinds, wrong = defaultdict(lambda: defaultdict(set)), []
    for name, command in Reference(programs).users().items():
        for option in command["options"]:
            spelled = set(re.split(r"[.|, ]+", option["value"])) & OTHER_SPELLINGS
            is_folder = re.search(r"^Folders? |\binto this folder\b", option["what"])
            if spelled or (option["value"] and is_folder and "DIR" not in option["value"]):
                wrong.append(f"{name} {option['names'][-1]}: {option['value']}: {option['what']}")
            for word in option["names"]:
                if word.startswith("-"):
                    kinds[word][kind_of(option)].add(name)
    for word, of in kinds.items():
        if len(of) > 1 and word not in SEVERAL_KINDS and "-o" != word:
            wrong.append(f"{word}: " + "; ".join(f"{kind or 'no value'} in {', '.join(sorted(names))}" for kind, names in of.items()))
    assert not wrong, listing(wrong)
    assert all(len(kinds[word]) > 1 for word in SEVERAL_KINDS), "an exception that is needed no more"
    # -o is short for --out and for nothing else.
    assert kinds["-o"].keys() == kinds["--out"].keys(), (kinds["-o"], kinds["--out"])


@case("live --help has 20 options at most, and --help-all all of them")
def _(programs, folder):
    reference = Reference(programs)
    usual, every = (entries(reference.text("live", how)) for how in ("--help", "--help-all"))
    shown = usual.keys() - COMMON
    assert len(shown) <= MOST_OF_LIVE, f"{len(shown)}: {', '.join(sorted(shown))}"
    declared = own_options(reference.commands["live"])
    assert shown == {option["names"][-1] for option in declared if not option["expert"]}
    assert every.keys() - COMMON == {option["names"][-1] for option in declared}
    assert len(every) > len(usual) > 10
    for name, command in reference.users().items():
        if name == "bench":  # its help is that of the programs with benchmarks
            continue
        found = entries(reference.text(name, "--help-all")).keys() - COMMON
        assert found == {option["names"][-1] for option in own_options(command)}, name


# ---- messages ------------------------------------------------------------------------------------

# Options of other programs that messages name: cmake, update-alternatives, gnuplot.
OF_OTHERS = {"--build", "--preset", "--target", "--config"}


def without_comments(code):
    code = re.sub(r"/\*.*?\*/", "", code, flags=re.DOTALL)
    return re.sub(r'("(?:[^"\\\n]|\\.)*")|//[^\n]*', lambda found: found[1] or "", code)


def literals(code):
    # The compiler joins adjacent string literals, and an option's name may be split between two.
    code = re.sub(r'(?<=[^\\])"\s*\n\s*"', "", without_comments(code))
    return ["".join(parts) for parts in re.findall(r'"((?:[^"\\\n]|\\.)*)"|R"\((.*?)\)"', code, re.DOTALL)]


def options_in(text):
    return re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*(?<!-)", text)


@case("every option that a message names is one that a command has")
def _(programs, folder):
    known = Reference(programs).names() | OF_PROGRAM | OF_OTHERS
    wrong, count, of_others = [], 0, set()
    for root in ("src/palpable", "apps"):
        for path in sorted((base.ROOT / root).rglob("*")):
            if path.suffix not in (".cpp", ".h") or path.stem.endswith("_test") or path.name == "old_spellings.cpp":
                continue
            for text in literals(path.read_text()):
                for option in options_in(text):
                    count += 1
                    of_others |= {option} & OF_OTHERS
                    if option not in known:
                        wrong.append(f"{path.relative_to(base.ROOT)}: {option} in \"{text}\"")
    assert not wrong, listing(wrong)
    assert count > 200 and of_others == OF_OTHERS, (count, OF_OTHERS - of_others)


def old_spellings():
    """[(command, option, what to write instead)] of 0.1."""
    code = without_comments((base.ROOT / "apps/common/old_spellings.cpp").read_text())
    text = r'"((?:[^"\\]|\\.)*)"'
    return re.findall(rf"OldSpelling\{{\s*{text},\s*{text},\s*{text}\s*\}}", re.sub(r'"\s*\n\s*"', "", code))


@case("each spelling of 0.1 is refused with the new one named")
def _(programs, folder):
    reference, old = Reference(programs), old_spellings()
    assert len(old) > 30, old
    for command, option, now in old:
        wanted = options_in(now)
        for name in [command] if command else reference.users().keys() - {"about", "refine"}:
            for word in (option, f"{option}=1") if option.startswith("--") else (option,):
                programs.refuses(name, word, cwd=folder, says=[f"'{option}'", now])
            for new in wanted:
                assert reference.option(name, new), f"{name} {option}: {new} is no option of it"
            assert reference.option(name, option) is None, f"{name} {option} is refused as old, and is an option"
    # What the options of live were called, which a person would type from memory.
    for option in ("--at", "--views", "--scene", "--distance", "--depth", "--no-masks", "--no-depth", "--meshes", "--pictures"):
        assert ("live", option) in {(command, word) for command, word, _ in old}, option


# ---- commands in texts ---------------------------------------------------------------------------

def complaint(reference, words, strict):
    """Why the command is none that the programs would parse; an empty text if it is one.
    strict: also the number of arguments, and words of a list."""
    name = " ".join(words[:2]) if words[:1] == ["bench"] and len(words) > 1 else words[0] if words else ""
    if name in ("help", "bench", "") or name.startswith("-"):
        return ""
    if name not in reference.commands:
        return f"there is no command {name}"
    declared = reference.commands[name]["options"]
    rest, arguments = words[len(name.split()):], 0
    while rest:
        word, equals, value = rest.pop(0).partition("=") if rest[0].startswith("-") else (rest.pop(0), "", "")
        if not word.startswith("-") or re.fullmatch(r"-[\d.]+", word):
            arguments += 1
            continue
        if word in OF_PROGRAM:
            continue
        option = reference.option(name, word)
        if option is None:
            return f"{name} has no option {word}"
        given = [value] if equals else []
        if option["value"] and not equals:
            while rest and not re.match(r"-[a-z-]", rest[0]) and (not given or option["several"]):
                given.append(rest.pop(0))
        if given and not option["value"]:
            return f"{name} {word}: takes no value"
        # In an example every word is meant; a text may name an option alone, or write a placeholder.
        if strict and option["value"] and not given:
            return f"{name} {word}: a value is missing"
        unknown = [one for one in given if option["choices"] and one not in option["choices"]]
        if strict and unknown:
            return f"{name} {word}: {unknown[0]} is none of {', '.join(option['choices'])}"
    arguments_of = [option for option in declared if option["positional"]]
    if strict and arguments > len(arguments_of) and not any(option["several"] for option in arguments_of):
        return f"{name}: {arguments} arguments"
    return ""


def words_of(line):
    line = re.split(r"\s{3,}|\s[|>]\s", line)[0]  # what is said of it follows after some spaces
    return [word for word in shlex.split(line, comments=True) if word not in ("...", "…", "\\")]


@case("each example at the end of a help text is a command that would be parsed")
def _(programs, folder):
    reference, wrong, count = Reference(programs), [], 0
    for name, command in reference.commands.items():
        examples = re.findall(r"^(?:Example:|        ) palpable(?:-bake)? (.*)$", command["footer"], re.MULTILINE)
        # bench in palpable only hands on.
        if not examples and name != "bench":
            wrong.append(f"{name} has no example")
        for example in examples:
            count += 1
            why = complaint(reference, words_of(example), True)
            if why:
                wrong.append(f"{name}: palpable {example}: {why}")
    assert not wrong, listing(wrong)
    assert count > 45, count


def commands_in(path):
    """[(line, command without the word palpable)] of a document, a scene or a text with commands."""
    text = path.read_text()
    # A line that ends in a backslash goes on.
    for number, line in enumerate(text.splitlines(), 1):
        for found in re.findall(r"^(?:    |#   |#  |\$ )?palpable(?:-bake)? ([a-z]\S*.*)$", line):
            yield number, found
        for found in re.findall(r"`palpable(?:-bake)? ([^`]+)`", line):
            yield number, found
        for found in re.findall(r'^command = "([^"]*)"', line):
            yield number, found
        for found in re.findall(r"`((?:live|replay|scan|view|synth|bake|reduce|truth|score) -[^`]+)`", line):
            yield number, found


@case("each command in the documents, in scenes and in paper.toml has options of that command")
def _(programs, folder):
    reference, wrong, count = Reference(programs), [], 0
    # commands.md is made from the declarations themselves.
    pages = [page for page in (base.ROOT / "docs").glob("*.md") if page.name != "commands.md"]
    texts = [*pages, *(base.ROOT / "docs/decisions").glob("*.md"), base.ROOT / "README.md",
             base.ROOT / "CONTRIBUTING.md", *(base.ROOT / "scenes").glob("*.toml"), *(base.ROOT / "bodies").glob("*.toml"),
             base.ROOT / "src/palpable/bake/reproduce/paper.toml"]
    for path in texts:
        for number, command in commands_in(path):
            command = re.sub(r"[\[\]]", "", command)  # what may be left out
            try:
                words = words_of(command)
            except ValueError:  # a quotation that goes on in the next line
                words = command.split()
            count += 1
            why = complaint(reference, words, False)
            if why and not command.startswith("body file, layout"):  # the format's name in a body file
                wrong.append(f"{path.relative_to(base.ROOT)}:{number}: {command}: {why}")
    assert not wrong, listing(wrong)
    assert count > 150, count


# Of ./check, tools and other programs, and of what an older version had.
OF_DOCUMENTS = OF_OTHERS | {"--only", "--long", "--describes", "--fresh", "--films", "--keep", "--install", "--browser"}


@case("each option that a document names is one that a command has")
def _(programs, folder):
    reference = Reference(programs)
    known = reference.names() | OF_PROGRAM | OF_DOCUMENTS
    wrong = []
    for path in [*(base.ROOT / "docs").glob("*.md"), base.ROOT / "README.md", base.ROOT / "CONTRIBUTING.md"]:
        for number, line in enumerate(path.read_text().splitlines(), 1):
            wrong += [f"{path.relative_to(base.ROOT)}:{number}: {option}" for option in re.findall(r"`(--[a-z][a-z0-9-]*)", line)
                      if option not in known]
    assert not wrong, listing(wrong)


if __name__ == "__main__":
    sys.exit(base.main())
