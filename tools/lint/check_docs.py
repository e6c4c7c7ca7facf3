#!/usr/bin/env python3
"""Checks that what pages and comments name is there. Exit 1 if it is not.

In README.md, docs/ and model/symbols.md:
test      `Suite.Name` is a C++ test under tests/, `tests/x.sh: text` a script that holds this text;
          PROGRAM --gtest_filter='Suite.Name:Suite.*': the program has a test for each pattern;
          python3 tests/x_test.py -k TEXT: a test of that file has TEXT in its name
link      a relative link leads to a file that is installed with the page
path      `controller/law/design.h`, `hal/can*`, `design.h`, `law/`: files and folders are there, a
          header without its folder exactly once, `Name` in `file.h` in that file; words in
          capitals stand for names
verb      `flexarm VERB --option`: the programs register both
key       `table.key` is read by config/ or stands in one of its TOML files
block     every block of commands has its tag (command_blocks.py), also on other pages
lane      docs/testing.md has a row for each lane of tools/lanes.sh, with the sets that it runs in
coverage  docs/thesis-coverage.md numbers its rows from 1 on, and its text counts them by state
requirement  docs/safety.md numbers its requirements R1, R2, ..; each is one sentence with "shall" and
          names a test
symbol    model/symbols.md: no symbol twice but with another meaning in brackets; the code has the
          names of the columns "in equations", "across files" and "in the code"; and what a display
          line of docs/theory sets (four spaces, then `NAME = ..`) is there, by symbol or name

There, and in comments and messages of the code, the scripts and the configs:
citation  `docs/theory/plant.md 4.2`, `(timing.md#an-undeclared-delay)`: the page, its numbered
          section, the heading of the anchor are there; no path outside the repository
verb      in C++ text: `flexarm VERB` in backticks, at the start of a literal or of an example

tests/lint/check_docs_test.py breaks each rule once. CHANGELOG.md speaks of the past: it is exempt.
"""

import argparse
import functools
import re
import sys
from fnmatch import fnmatch
from pathlib import Path

import command_blocks
import prose

CPP_TEST = re.compile(r"\bTEST(_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")
NAMED_TEST = re.compile(r"`([A-Z]\w+)\.([A-Z]\w+)`")
TEST_PROGRAM = re.compile(r"\bflexarm_tests\((\w+)(.*?)\)", re.S)
FILTERED = re.compile(r"(\w+) --gtest_filter='?([^'\s`]*)'?")
SELECTED = re.compile(r"python3 (tests/[\w/.-]+\.py) -k (\w+)")
NAMED_SCRIPT = re.compile(r"`(tests/[\w/.-]+)(?:: ([^`]+))?`")
LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)[^)]*\)")
# What the pages may link to: systemd/CMakeLists.txt installs it beside them; of config/ only
# the rigs and experiments.
INSTALLED = re.compile(r"docs/.*|config/.*\.(?:toml|csv)|model/symbols\.md|(?:README|CHANGELOG)\.md|LICENSE")
LANES = Path("tools/lanes.sh")
LANES_PAGE = Path("docs/testing.md")
LANE_SET = re.compile(r"\b(quick|ci|only_all)_lanes=\(([^)]*)\)")
LANE_FUNCTION = re.compile(r"^lane_([\w-]+)\(\)", re.M)
LANE_ROW = re.compile(r"^\| `([\w-]+)` \|(?:[^|]*\|){2}([^|]*)\|")

PAGE = re.compile(r"(?<![\w/.$}@-])(?P<page>/?(?:[\w.-]+/)*[\w-]+\.md)(?P<anchor>#[\w-]+)?")
OWN_ANCHOR = re.compile(r"\]\((#[\w-]+)\)")
# After a page: backtick, bracket and link, then numbers of sections.
NUMBERS = r"(\d+(?:\.\d+)*(?:(?:,|,?\s+and|\s+to)\s+\d+(?:\.\d+)*)*)"
SECTIONS = re.compile(r"[`\])]*,?(?:\s+sections?)?\s+" + NUMBERS)
OWN_SECTIONS = re.compile(r"\bsections?\s+" + NUMBERS)
HEADING = re.compile(r"^#+ +(.*?) *$", re.M)
OUTSIDE = re.compile(r"(?<![\w.$}/])/home/[\w./-]*")

TOP_FOLDERS = (*prose.CODE_FOLDERS, "systemd", "package", "docs")
PATH = re.compile(r"(?<![\w/.{}-])(?:" + "|".join(TOP_FOLDERS) + r")/[\w./{},*+-]*")
BARE_FILE = re.compile(r"\w+\.(?:h|cpp|py|sh)")
NAME_IN_FILE = re.compile(r"`([A-Z]\w+(?:::\w+)*)`(?:\s+in\s+|\s+\()`(\w+\.(?:h|cpp))`")
BARE_FOLDER = re.compile(r"\w+/")
PLACEHOLDER = re.compile(r"\b[A-Z]{2,}\b")
FILE_KINDS = {"h", "cpp", "py", "sh", "md", "json", "csv", "toml", "svg", "png", "sqlite", "txt",
              "flexarm", "service", "in", "log", "html", "passed", "network", "cmake",
              "def", "pml"}

VERB = re.compile(r"(\w+)(?:\.|->)add_subcommand\(\s*\"([\w-]+)\""
                  r"|\bAdd(?:Verb|Command)\(\s*(app),(?: exit,)?\s*\"([\w-]+)\"")
OTHER_VERB = re.compile(r"\bOtherVerb\{\s*\"([\w-]+)\"")
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*")
COMMAND = re.compile(r"(?:^|[;&|(]|\$)\s*(flexarm(?:d|-study)?)((?:\s+[^\s;&|]+)*)")
SAID_COMMAND = re.compile(r"(?:[\"`]\s*|Examples?:\s+|Next:\s+|&& )"
                          r"(flexarm(?:-study)?)((?: +[a-z][\w-]*){1,2})(?![\w./=-])")
KEY = re.compile(r"([a-z]\w*(?:\.[a-z]\w*)+)(?: = .*)?")
SET_KEY = re.compile(r"--(?:set|over) ([a-z]\w*(?:\.[a-z]\w*)+)=")

COVERAGE = Path("docs/thesis-coverage.md")
COVERAGE_STATES = ("works", "differs", "cannot be done")
COVERAGE_ROW = re.compile(r"^\| (\d+) \|(?:[^|]*\|){2} ([^|:;]*)", re.M)
COVERAGE_COUNT = re.compile(r"(\d+) rows: (\d+) works, (\d+) differs, (\d+) cannot be done")

REQUIREMENTS = Path("docs/safety.md")
REQUIREMENT_ROW = re.compile(r"^\| R(\d+) \| ([^|]*) \| ([^|]*) \|", re.M)

LAWS = Path("controller/types/law_table.h")
LAWS_PAGE = Path("docs/theory/README.md")
LAW = re.compile(r'\{ControllerKind::\w+,\s*"([\w-]+)",\s*"([^"]*)"')
LAW_ROW = re.compile(r"^\| `([\w-]+)` \| ([^|]*) \| [^|]*\|$", re.M)

SYMBOLS = Path("model/symbols.md")
CODE_COLUMNS = ("in equations", "across files", "in the code")
EQUATION = re.compile(r"^ {4,}([A-Za-z]\w*[*']*(?:\(\w+\))?)\s*(?:=|<-)(?![=>])", re.M)


class Finding:
    def __init__(self, page, line, rule, message):
        self.page, self.line, self.rule, self.message = page, line, rule, message

    def __str__(self):
        return f"{self.page}:{self.line}: {self.rule}: {self.message}"


def slug(heading):
    """The anchor that GitHub makes of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


class Tree:
    """What there is to name, read once."""

    def __init__(self, root):
        self.root = root
        self.files = list(prose.files(root))
        self.pages = list(prose.pages(root))

    def name(self, path):
        return path.relative_to(self.root).as_posix()

    @functools.cached_property
    def names(self):
        return [self.name(path) for path in self.files]

    @functools.cached_property
    def texts(self):
        return {path: prose.read(path) for path in (*self.files, *self.pages)}

    def code(self, folder, *suffixes):
        """Texts of the files below a folder."""
        return [(path, self.texts[path]) for path in self.files
                if path.suffix in suffixes and self.name(path).startswith(folder)]

    @functools.cached_property
    def tests(self):
        return {(suite, name) for _, text in self.code("tests/", ".cpp")
                for _, suite, name in CPP_TEST.findall(text)}

    @functools.cached_property
    def test_programs(self):
        """Of each test program, the names of its tests; PREFIX/Suite.Name/NUMBER if they have
        parameters."""
        found = {}
        for path in self.files:
            if path.name != "CMakeLists.txt" or not self.name(path).startswith("tests/"):
                continue
            for program, body in TEST_PROGRAM.findall(re.sub(r"#.*", "", self.texts[path])):
                sources = [path.parent / name for name in re.findall(r"[\w/.-]+\.cpp", body)]
                found[program] = [
                    f"PREFIX/{suite}.{name}/NUMBER" if kind == "_P" else f"{suite}.{name}"
                    for source in sources
                    for kind, suite, name in CPP_TEST.findall(self.texts.get(source, ""))]
        return found

    @functools.cached_property
    def headings(self):
        """Of each page: numbers of its sections, and anchors."""
        found = {}
        for page in self.pages:
            titles = HEADING.findall(prose.same_length(prose.FENCE, self.texts[page]))
            numbers = {match.group(1) for title in titles
                       if (match := re.match(r"(\d+(?:\.\d+)*)\.?(?:\s|$)", title))}
            found[page] = numbers, {slug(title) for title in titles}
        return found

    @functools.cached_property
    def verbs(self):
        """Of each verb, its own verbs. Files of a verb that has some are called verb_NAME*.cpp."""
        found = {}
        for path, text in self.code("tools/", ".h", ".cpp"):
            for verb in OTHER_VERB.findall(text):
                found.setdefault(verb, set())
            for parent, verb, top, command in VERB.findall(text):
                if top or parent == "app":
                    found.setdefault(verb or command, set())
                else:
                    found.setdefault(path.stem.split("_")[1], set()).add(verb)
        return found

    @functools.cached_property
    def options(self):
        """Options of the programs, and all that the scripts of the tree know."""
        programs, scripts = {"--help", "--version"}, set()
        for path, text in self.code("tools/", ".cpp"):
            programs.update(re.findall(r"\"(?:-\w,)?(--[a-z][\w-]*)\"", text))
        for path in self.files:
            if path.suffix in ("", ".sh", ".py", ".txt", ".cmake", ".json"):
                scripts.update(OPTION.findall(self.texts[path]))
        return programs, scripts

    @functools.cached_property
    def keys(self):
        """Tables at the top of a config, and all keys."""
        tables, keys = set(), set()
        for _, text in self.code("config/", ".toml"):
            for table in re.findall(r"^\s*\[+([\w.]+)\]", text, re.M):
                tables.add(table.split(".")[0])
                keys.update(table.split("."))
            keys.update(re.findall(r"(?:^|[{,])\s*(\w+)\s*=", text, re.M))
        for path, text in self.code("config/", ".cpp"):
            literals = re.findall(r"\"(\w+)\"", text)
            keys.update(literals)
            if path.name.endswith("_binding.cpp"):
                tables.update(literals)
        return tables, keys

    @functools.cached_property
    def words(self):
        """All words of the C++ code, without comments and literals."""
        found = set()
        for path in self.files:
            if path.suffix in (".h", ".cpp"):
                bare = prose.CPP.sub(" ", self.texts[path])
                found.update(re.findall(r"[A-Za-z_]\w*", bare))
        return found

    @functools.cached_property
    def written(self):
        """Names of Markdown files that the programs write: a literal that is nothing else."""
        return {name for _, text in self.code("", ".cpp", ".h")
                for name in re.findall(r"\"([\w-]+\.md)\"", text)}


def numbers_of(sections):
    return re.findall(r"\d+(?:\.\d+)*", sections)


def cited_page(tree, name, source):
    """The page that a citation in file `source` means: beside it, from the root, in docs/."""
    for folder in (source.parent, tree.root, tree.root / "docs", tree.root / "docs/theory"):
        page = (folder / name).resolve()
        if page.is_file():
            return page
    return None


def check_citations(tree, path, text):
    """Yields (position, rule, message) of citations in what a file says."""
    for match in OUTSIDE.finditer(text):
        yield match.start(), "citation", f"{match.group(0)} is not in the repository"
    for match in PAGE.finditer(text):
        name, anchor = match.group("page", "anchor")
        if name.startswith("/") or Path(name).stem.isupper() and not name.endswith("README.md"):
            continue
        page = cited_page(tree, name, path)
        if page is None:
            before = text[max(0, match.start() - 30):match.start()]
            argument = re.search(r"(?:^|\s)--?[\w-]+ $", before)  # a file to be written
            if name not in tree.written and not argument:
                yield match.start(), "citation", f"there is no {name}"
            continue
        if page not in tree.headings:
            continue
        numbers, anchors = tree.headings[page]
        if anchor and anchor[1:] not in anchors:
            yield match.start(), "citation", f"{name} has no heading for {anchor}"
        cited = SECTIONS.match(text, match.end())
        for number in numbers_of(cited.group(1)) if cited else ():
            if number not in numbers:
                yield match.start(), "citation", f"{name} has no section {number}"
    if path not in tree.headings:
        return
    numbers, anchors = tree.headings[path]
    for match in OWN_ANCHOR.finditer(text):
        if match.group(1)[1:] not in anchors:
            yield match.start(), "citation", f"this page has no heading for {match.group(1)}"
    if numbers:
        for match in OWN_SECTIONS.finditer(text):
            if re.search(r"\.md[`)]*,?\s+$", text[max(0, match.start() - 12):match.start()]):
                continue
            for number in numbers_of(match.group(1)):
                if number not in numbers:
                    yield match.start(), "citation", f"this page has no section {number}"


def check_verb(tree, program, words):
    """Yields what is wrong with the words after the name of a program."""
    known = {} if program == "flexarmd" else tree.verbs
    if not words or not re.fullmatch(r"[a-z][a-z-]*", words[0]):
        return
    if words[0] not in known:
        yield f"{program} has no verb {words[0]}"
        return
    below, rest = known[words[0]], words[1:2]
    if below and rest and re.fullmatch(r"[a-z][a-z-]*", rest[0]) and rest[0] not in below:
        yield f"{program} {words[0]} has no verb {rest[0]}"


def check_commands(tree, text, in_block):
    """Yields (rule, message) of the commands and options in a piece of code of a page."""
    programs, scripts = tree.options
    shown = re.sub(r"\s#.*", "", text)
    if not in_block and shown.startswith("--"):
        for option in OPTION.findall(shown):
            if option not in programs | scripts and not option.startswith("--gtest"):
                yield "verb", f"no program and no script has {option}"
    for match in COMMAND.finditer(shown):
        program, words = match.group(1), match.group(2).split()
        for message in check_verb(tree, program, words):
            yield "verb", message
        for word in words:
            option = OPTION.match(word)
            if option and option.group(0) not in programs:
                yield "verb", f"{program} has no {option.group(0)}"


def expand(pattern):
    """The paths of a pattern with {a,b}."""
    match = re.search(r"\{([^{}]*)\}", pattern)
    if not match:
        return [pattern]
    return [path for word in match.group(1).split(",")
            for path in expand(pattern[:match.start()] + word + pattern[match.end():])]


def check_paths(tree, text, in_block):
    """Yields (rule, message) of files and folders in a piece of code of a page."""
    for match in PATH.finditer(text):
        for path in expand(match.group(0).rstrip(".,")):
            if PLACEHOLDER.search(path.replace("README", "").replace("CMakeLists", "")):
                continue
            if not ((tree.root / path).exists() or "*" in path and any(tree.root.glob(path))):
                yield "path", f"there is no {path}"
    if in_block:
        return
    if BARE_FILE.fullmatch(text):
        places = [name for name in tree.names if name.rpartition("/")[2] == text]
        if not places:
            yield "path", f"there is no {text}"
        elif len(places) > 1 and text.endswith(".h"):
            yield "path", f"{text} is {' and '.join(places)}: name the folder"
    if BARE_FOLDER.fullmatch(text) and text != "build/":
        if not any(f"/{text}" in f"/{name}" for name in (*tree.names, *map(tree.name, tree.pages))):
            yield "path", f"there is no folder {text}"


def check_keys(tree, text, in_block):
    """Yields (rule, message) of keys of a config in a piece of code of a page."""
    tables, keys = tree.keys
    whole = None if in_block else KEY.fullmatch(text)
    named = SET_KEY.findall(text) + ([whole.group(1)] if whole else [])
    for key in named:
        first, *rest = key.split(".")
        if rest[-1] in FILE_KINDS:
            continue
        if first not in tables:
            yield "key", f"no config has a table {first}"
        for part in rest:
            if part not in keys:
                yield "key", f"{key}: config/ does not know {part}"


def check_tests(tree, text, _in_block):
    """Yields (rule, message) of the tests that a piece of code of a page runs."""
    for program, patterns in FILTERED.findall(text):
        if program not in tree.test_programs:
            yield "test", f"there is no test program {program}"
            continue
        for pattern in patterns.split(":"):
            if not any(fnmatch(test, pattern) for test in tree.test_programs[program]):
                yield "test", f"{program} has no test {pattern}"
    for script, words in SELECTED.findall(text):
        target = tree.root / script
        if target.exists() and not re.search(rf"def test_\w*{words}|def {words}",
                                             prose.read(target)):
            yield "test", f"{script} has no test with {words} in its name"


def check_page(tree, path, text):
    """Yields (position, rule, message) of what a page names."""
    for match in NAMED_TEST.finditer(text):
        if match.groups() not in tree.tests:
            yield match.start(), "test", "there is no test {}.{}".format(*match.groups())
    for match in NAMED_SCRIPT.finditer(text):
        script, said = match.groups()
        target = tree.root / script
        if said and target.exists() and said not in prose.read(target):
            yield match.start(), "test", f"{script} does not say '{said}'"
    for match in LINK.finditer(text):
        linked = (path.parent / match.group(1)).resolve()
        if not linked.exists():
            yield match.start(), "link", f"there is no {match.group(1)}"
        elif not (linked.is_relative_to(tree.root) and INSTALLED.fullmatch(tree.name(linked))):
            yield match.start(), "link", f"{match.group(1)} is not installed with the page"
    for match in NAME_IN_FILE.finditer(text):
        name, file = match.groups()
        for path_there, code in tree.code("", ".h", ".cpp"):
            if path_there.name == file and not re.search(rf"\b{name.split('::')[-1]}\b", code):
                yield match.start(), "path", f"{file} does not have {name}"
    for position, span, in_block in prose.spans(text):
        for check in (check_commands, check_paths, check_keys, check_tests):
            for rule, message in check(tree, span, in_block):
                yield position, rule, message


def check_said_commands(tree, text):
    """Yields (position, rule, message) of the verbs in a C++ file's comments and literals."""
    for match in SAID_COMMAND.finditer(text):
        for message in check_verb(tree, match.group(1), match.group(2).split()):
            yield match.start(), "verb", message


def cells_of(row):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]]


def tables_of(text):
    """Yields (line, heads of the columns, cells) of each row of each table."""
    heads = None
    for number, line in enumerate(text.splitlines(), 1):
        if not line.startswith("|"):
            heads = None
        elif heads is None:
            heads = cells_of(line)
        elif not re.match(r"\|[-:| ]+$", line):
            yield number, heads, cells_of(line)


def plain(symbol):
    """A symbol without primes, stars, indices in digits or letters behind _, and arguments."""
    symbol = re.sub(r"\([^)]*\)|[*'^]", "", symbol.replace("_dot", "")).strip()
    return re.sub(r"_(?:\d+|[ijkl]{1,2})$|(?<=[a-zA-Z])\d+$", "", symbol)


def check_symbols(tree):
    """Yields findings in model/symbols.md and in the equations of docs/theory."""
    page = tree.root / SYMBOLS
    if page not in tree.texts:
        return
    listed, seen = set(), {}
    for line, heads, cells in tables_of(tree.texts[page]):
        cell = cells[0].replace(" (own)", "")
        symbols, meaning = re.fullmatch(r"(.*?)((?: \([^()]*\))?)", cell).groups()
        for symbol in re.split(r", (?![^(]*\))", symbols):
            if symbol != "-" and (symbol, meaning) in seen:
                yield Finding(SYMBOLS, line, "symbol", f"{symbol}{meaning} is in line "
                              f"{seen[symbol, meaning]} too: say in brackets which one is meant")
            seen[symbol, meaning] = line
            listed.update(re.findall(r"[A-Za-z]\w*[*']*", re.sub(r"\([^)]*\)", " ", symbol)))
        for head, cell in zip(heads, cells):
            if head in CODE_COLUMNS:
                shown = " ".join(re.findall(r"`([^`]+)`", cell))
                for name in re.findall(r"[A-Za-z_]\w*\*?", shown):
                    listed.add(name)
                    if not (name in tree.words or
                            name.endswith("*") and any(fnmatch(w, name) for w in tree.words)):
                        yield Finding(SYMBOLS, line, "symbol", f"the code has no {name}")
    listed |= {plain(symbol) for symbol in listed}
    for path in tree.pages:
        name = tree.name(path)
        if not name.startswith("docs/theory/"):
            continue
        text = tree.texts[path]
        for match in EQUATION.finditer(text):
            symbol = match.group(1)
            if symbol not in listed and plain(symbol) not in listed:
                yield Finding(name, prose.line_of(text, match.start(1)), "symbol",
                              f"{SYMBOLS} has no {symbol}")


def lane_sets(script):
    """The sets that each lane runs in, as the page writes them."""
    of = {name: lanes.split() for name, lanes in LANE_SET.findall(script)}
    quick, ci, only_all = (of.get(name, []) for name in ("quick", "ci", "only_all"))
    return {lane: ", ".join(["quick"] * (lane in quick) + ["CI"] * (lane in ci) + ["all"])
            for lane in (*ci, *only_all)}


def check_lanes(root):
    """Yields where the lanes of run-tests and the page about them differ."""
    script, page = root / LANES, root / LANES_PAGE
    if not script.exists() and not page.exists():
        return
    script, page = (path.read_text(encoding="utf-8") if path.exists() else ""
                    for path in (script, page))
    sets = lane_sets(script)
    for lane in sorted(set(LANE_FUNCTION.findall(script)) ^ set(sets)):
        yield Finding(LANES, 1, "lane", f"{lane} is either a function or in a set, and not both")
    rows = {}
    for number, line in enumerate(page.splitlines(), 1):
        for lane, shown in LANE_ROW.findall(line):
            rows[lane] = shown.strip()
            if lane not in sets:
                yield Finding(LANES_PAGE, number, "lane", f"run-tests has no lane {lane}")
            elif rows[lane] != sets[lane]:
                yield Finding(LANES_PAGE, number, "lane", f"{lane} runs in '{sets[lane]}'")
    for lane in sorted(set(sets) - set(rows)):
        yield Finding(LANES_PAGE, 1, "lane", f"there is no row for {lane}")


def check_coverage(root):
    """Yields where the numbers of the rows of the coverage page are not those of its text."""
    page = root / COVERAGE
    if not page.exists():
        return
    text = page.read_text(encoding="utf-8")
    rows = COVERAGE_ROW.findall(text)
    if [int(number) for number, _ in rows] != list(range(1, len(rows) + 1)):
        yield Finding(COVERAGE, 1, "coverage", "the rows are not numbered 1, 2, 3, ..")
    states = [state.strip() for _, state in rows]
    for number, state in zip((number for number, _ in rows), states):
        if state not in COVERAGE_STATES:
            yield Finding(COVERAGE, 1, "coverage", f"row {number} has the state '{state}'")
    counts = (len(rows), *map(states.count, COVERAGE_STATES))
    said = COVERAGE_COUNT.search(text)
    if said is None or tuple(map(int, said.groups())) != counts:
        yield Finding(COVERAGE, 1, "coverage", "it has {} rows: {} works, {} differs, "
                      "{} cannot be done".format(*counts))


def check_requirements(root):
    """Yields where the requirements of the safety page have no number, "shall" or test."""
    page = root / REQUIREMENTS
    if not page.exists():
        return
    text = page.read_text(encoding="utf-8")
    for place, row in enumerate(REQUIREMENT_ROW.finditer(text), 1):
        number, sentence, tests = row.groups()
        line = prose.line_of(text, row.start())
        if int(number) != place:
            yield Finding(REQUIREMENTS, line, "requirement", f"R{number} stands in place {place}")
        if sentence.count(" shall ") != 1 or sentence.rstrip(".").count(". "):
            yield Finding(REQUIREMENTS, line, "requirement",
                          f"R{number} is not one sentence with 'shall'")
        if not (NAMED_TEST.search(tests) or
                any(said for _, said in NAMED_SCRIPT.findall(tests))):
            yield Finding(REQUIREMENTS, line, "requirement", f"R{number} names no test")


def check_laws(root):
    """Yields where the table of laws and the page about it differ."""
    table, page = root / LAWS, root / LAWS_PAGE
    if not table.exists() or not page.exists():
        return
    laws = LAW.findall(table.read_text(encoding="utf-8"))
    rows = LAW_ROW.findall(page.read_text(encoding="utf-8"))
    for name, about in laws:
        if (name, about) not in rows:
            yield Finding(LAWS_PAGE, 1, "law", f"there is no row for {name}: {about}")
    for name, about in rows:
        if (name, about) not in laws:
            yield Finding(LAWS_PAGE, 1, "law", f"{LAWS} has no {name}: {about}")


def check_blocks(root):
    """Yields what is wrong with the blocks of commands of all pages."""
    for page in command_blocks.pages(root):
        for line, message in command_blocks.problems(prose.read(page)):
            yield Finding(page.relative_to(root).as_posix(), line, "block", message)


def check_file(tree, path):
    """Yields (position, rule, message) of one file."""
    text = tree.texts[path]
    if path in tree.pages:
        yield from check_citations(tree, path, text)
        yield from check_page(tree, path, text)
        return
    said = text if path.suffix == ".json" else prose.of_file(path, text, path.suffix != ".py")
    if said is not None:
        yield from check_citations(tree, path, said)
    if path.suffix in (".h", ".cpp"):
        yield from check_said_commands(tree, text)


def check_tree(root):
    """All findings in the tree under `root`, as FILE:LINE: text."""
    tree = Tree(root.resolve())
    findings = [*check_lanes(root), *check_laws(root), *check_coverage(root), *check_blocks(root),
                *check_requirements(root), *check_symbols(tree)]
    for path in (*tree.pages, *tree.files):
        for position, rule, message in sorted(set(check_file(tree, path))):
            line = prose.line_of(tree.texts[path], position)
            findings.append(Finding(tree.name(path), line, rule, message))
    return [str(finding) for finding in findings]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[2],
                        help="the tree to check (default: this one)")
    findings = check_tree(parser.parse_args().root)
    for finding in findings:
        print(finding)
    print(f"check_docs: {len(findings)} errors")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
