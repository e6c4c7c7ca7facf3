#!/usr/bin/env python3
"""Checks the rules of the source tree that no compiler knows. Exit 1 if one is broken.

layers      a folder includes those folders that layers.py names, and is written from the root
target      each folder is one CMake target, which links the folders that it includes
realtime    no I/O, lock or clock by name in folders whose code runs on the real-time threads
heap        no allocation by name in folders whose code Step runs, but at start-up
libm        Step computes with + - * / and sqrt: libm's sin and exp differ between machines
picture     docs/images/folders.svg shows the folders and their arrows (--picture writes it)
file-size   a source file has at most 400 lines, a test 600
function    a function of more than 60 lines is worth a look (a warning)
leftover    no to-do notes in the tree
unit        a double of a public struct has a unit in its name, or a comment
comment     what a header declares at namespace scope has a comment

tests/lint/check_layers_test.py breaks each rule once.
"""

import argparse
import re
import sys
from pathlib import Path

from folder_picture import draw, levels_of
from layers import LAYERS, REALTIME, STEP

CODE_FOLDERS = ("model", "hal", "estimator", "controller", "config", "tools", "tests")
TEXT_SUFFIXES = {".h", ".cpp", ".py", ".sh", ".cmake", ".toml", ".in", ".service", ".txt", ""}
MAX_FILE_LINES = 400
MAX_TEST_LINES = 600  # tables of cases are long
MAX_FUNCTION_LINES = 60
PICTURE = "docs/images/folders.svg"

REALTIME_HEADERS = re.compile(
    r"#\s*include\s*<(spdlog/|fmt/|iostream|fstream|sstream|ostream|istream|iomanip|print|cstdio"
    r"|stdio\.h|mutex|shared_mutex|condition_variable|semaphore|thread|future|chrono|ctime|time\.h"
    r"|filesystem|regex|nlohmann/|sqlite3)")
REALTIME_WORDS = re.compile(
    r"\bspdlog::|\bstd::(cout|cerr|clog|mutex|lock_guard|unique_lock|scoped_lock"
    r"|condition_variable|this_thread|async|chrono)\b|\bprintf\s*\(|\bclock_gettime\s*\("
    r"|\bnanosleep\s*\(")
HEAP = re.compile(
    r"\bnew\s+[A-Za-z]|\b(malloc|calloc|realloc)\s*\(|\bstd::(function|deque|list|map|set)\b"
    r"|\bmake_(unique|shared)\b|\bstd::to_string\b|(\.|->)(push_back|emplace_back|resize|reserve"
    r"|emplace|insert)\s*\(")
START_UP = re.compile(r"//.*\bstart-up\b")
# Also as `using std::sin; sin(x)`.
LIBM = re.compile(
    r"(?:\bstd::|(?<![\w:.>]))(sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log(?:2|10|1p)?|pow|hypot"
    r"|cbrt|fmod|remainder|erf|tgamma)\s*\(")

# Tokens of a name that say the unit of a quantity; `_per_` joins any two.
UNITS = {"nm", "n", "m", "mm", "m2", "m4", "kg", "kgm2", "m3", "rad", "deg", "s", "ms", "us", "ns",
         "hz", "v", "a", "w", "j", "pa", "counts", "ticks", "s2", "percent", "unit"}

NOTE_WORDS = re.compile(r"\b(" + "|".join(("TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK"))
                        + r")\b")


class Finding:
    def __init__(self, path, line, rule, message, warning=False):
        self.path, self.line, self.rule = path, line, rule
        self.message, self.warning = message, warning

    def __str__(self):
        kind = "warning: " if self.warning else ""
        return f"{self.path}:{self.line}: {kind}{self.rule}: {self.message}"


def blank(match):
    """Spaces in place of a match, with its line breaks kept, so that line numbers hold."""
    return re.sub(r"[^\n]", " ", match.group(0))


def without_comments(text):
    """The code with comments and the contents of literals blanked."""
    pattern = (r"//[^\n]*|/\*.*?\*/|R\"(?P<tag>[^(\s]*)\(.*?\)(?P=tag)\""
               r"|\"(?:\\.|[^\"\\\n])*\"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'")
    return re.sub(pattern, blank, text, flags=re.S)


def folder_of(path):
    return path.rpartition("/")[0]


def included(text):
    """Yields (line, path) of the includes of our own files."""
    for number, line in enumerate(text.splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*"([^"]+)"', line)
        if match and not match.group(1).endswith("_generated.h"):
            yield number, match.group(1)


def check_layers(path, text, code, root):
    folder = folder_of(path)
    in_tests = path.startswith("tests/")
    if folder not in LAYERS and not in_tests:
        yield Finding(path, 1, "layers", f"tools/lint/layers.py does not know {folder}")
        return
    for number, target in included(text):
        other = folder_of(target)
        if not (root / target).is_file():
            yield Finding(path, number, "layers", f'"{target}" is not a file under the root')
        elif not in_tests and other != folder and other not in LAYERS[folder]:
            yield Finding(path, number, "layers", f"{folder} must not use {target}")


def check_realtime(path, text, code, root):
    folder = folder_of(path)
    rules = []
    if folder in REALTIME:
        rules += [("realtime", REALTIME_HEADERS), ("realtime", REALTIME_WORDS)]
    if folder in STEP:
        rules += [("heap", HEAP), ("libm", LIBM)]
    lines = text.splitlines()
    for number, line in enumerate(code.splitlines(), 1):
        for rule, pattern in rules:
            match = pattern.search(line)
            if match and not (rule in ("heap", "libm") and START_UP.search(lines[number - 1])):
                yield Finding(path, number, rule,
                              f"'{match.group(0).strip()}' in a folder of the real-time threads")


def check_file_size(path, text, code, root):
    lines = text.count("\n")
    most = MAX_TEST_LINES if path.startswith("tests/") else MAX_FILE_LINES
    if lines > most:
        yield Finding(path, lines, "file-size", f"{lines} lines, at most {most}")


def blocks(code):
    """Yields (head, first line, last line, enclosing heads) of every brace block."""
    stack, head_start = [], 0
    line = 1
    for position, char in enumerate(code):
        if char == "\n":
            line += 1
        elif char == "{":
            head = re.sub(r"\s+", " ", code[head_start:position]).strip()
            stack.append((head, line))
            head_start = position + 1
        elif char == "}":
            if stack:
                head, first = stack.pop()
                yield head, first, line, [outer for outer, _ in stack]
            head_start = position + 1
        elif char == ";":
            head_start = position + 1


SCOPE = re.compile(r"^(inline )?namespace\b|^extern\b|\b(class|struct|union)\b(?!.*\()")


def check_function_size(path, text, code, root):
    plain = re.sub(r"^[ \t]*#.*(?:\\\n.*)*", blank, code, flags=re.M)
    for head, first, last, outer in blocks(plain):
        function = "(" in head and not re.search(r"(^|\W)(if|for|while|switch|catch)\s*\($", head)
        if function and all(SCOPE.search(h) for h in outer) and last - first > MAX_FUNCTION_LINES:
            name = head.split("(")[0].split(" ")[-1]
            yield Finding(path, first, "function", f"{name} has {last - first} lines", warning=True)


def check_leftovers(path, text, code, root):
    for number, line in enumerate(text.splitlines(), 1):
        match = NOTE_WORDS.search(line)
        if match:
            yield Finding(path, number, "leftover", f"'{match.group(0)}': do it, or open an issue")


def has_comment(lines, number):
    """Is there a comment on line `number` (0-based) or on the line before it?"""
    if "//" in lines[number]:
        return True
    return number > 0 and lines[number - 1].strip().startswith(("//", "*", "/*"))


def names_unit(name):
    """Also true of a symbol of the thesis, which stands inside equations (L1, J2, th1), and of a
    figure whose unit is that of what it belongs to."""
    tokens = name.strip("_").lower().split("_")
    return (len(tokens) > 1 and (tokens[-1] in UNITS or "per" in tokens)
            or re.fullmatch(r"[a-zA-Z]{1,2}\d{0,2}h?|rotor\d|value|limit", name))


DOUBLE = re.compile(r"^\s*(?:const\s+)?(?:std::(?:array|optional|vector|span)<\s*)?(?:const\s+)?"
                    r"double\b[^()]*?\s(\w+)\s*(?:\{[^}]*\}|=[^;,]*)?\s*[;,]")


def public_members(code):
    """Yields (line, text) of each line that stands directly in a struct at namespace scope, or in
    the public part of a nested one."""
    stack, public, head = [], [], ""
    for number, line in enumerate(code.splitlines()):
        if stack and stack[-1] == "struct" and public[-1]:
            yield number, line
        if re.match(r"\s*(private|protected)\s*:", line) and public:
            public[-1] = False
        elif re.match(r"\s*public\s*:", line) and public:
            public[-1] = True
        for char in line:
            if char == "{":
                kind = ("namespace" if re.search(r"\b(namespace|extern)\b", head) else
                        "struct" if re.search(r"\bstruct\b", head) and "(" not in head else
                        "class" if re.search(r"\bclass\b", head) and "enum" not in head else
                        "other")
                outer_public = all(public) and all(k != "other" for k in stack)
                stack.append(kind)
                public.append(outer_public and kind in ("namespace", "struct"))
                head = ""
            elif char == "}":
                if stack:
                    stack.pop()
                    public.pop()
                head = ""
            elif char == ";":
                head = ""
            else:
                head += char
        head += " "


def check_units(path, text, code, root):
    if not path.endswith(".h") or path.startswith("tests/"):
        return
    lines = text.splitlines()
    commented_run = False  # a run of doubles below one comment shares it
    last = -2
    for number, line in public_members(code):
        match = DOUBLE.match(line)
        if not match:
            continue
        commented_run = has_comment(lines, number) or (commented_run and number == last + 1)
        last = number
        if not names_unit(match.group(1)) and not commented_run:
            yield Finding(path, number + 1, "unit",
                          f"{match.group(1)} has neither a unit in its name nor a comment")


TYPE = re.compile(r"^(?:struct|class|enum(?:\s+class)?)\s+\w+")
FUNCTION = re.compile(r"^(?!using\b|static_assert\b|return\b|#)(?:\[\[\w+\]\]\s*)?"
                      r"[A-Za-z_][\w:<>,&*\s]*[\s&*](?P<name>[A-Za-z_]\w*)\s*\((?P<rest>.*)$")
NUMBER_CONSTANT = re.compile(r"^(?:inline\s+)?constexpr\s+(?:double|float)\s+(?P<name>\w+)")


def statement_end(code_lines, first):
    """Last line (0-based) of the declaration, or of the body, that begins on line `first`."""
    depth = 0
    for number in range(first, len(code_lines)):
        for char in code_lines[number]:
            depth += {"{": 1, "}": -1}.get(char, 0)
            if depth == 0 and char in ";}":
                return number
    return len(code_lines) - 1


def speaks_for_itself(declaration):
    """A function of one parameter, or a maker of its type, that takes no bare double."""
    match = FUNCTION.match(declaration)
    parameters = match.group("rest").split(")")[0]
    few = "," not in parameters or match.group("name").startswith("Make")
    return few and not re.search(r"\bdouble\b(?!\s*>)", parameters)


def check_comments(path, text, code, root):
    if not path.endswith(".h") or path.endswith("_impl.h") or path.startswith("tests/"):
        return
    lines, code_lines = text.splitlines(), code.splitlines()
    number = -1
    while number + 1 < len(code_lines):
        number += 1
        first = number  # where the comment stands, above any template<>
        while re.match(r"^template\s*<.*>\s*$", code_lines[number]) and number + 1 < len(code_lines):
            number += 1
        line = code_lines[number]
        is_type, is_function = TYPE.match(line), FUNCTION.match(line)
        if not (is_type or is_function or NUMBER_CONSTANT.match(line)):
            continue
        end = statement_end(code_lines, number)
        whole = " ".join(code_lines[number:end + 1])
        inside = any("//" in inner for inner in lines[number:end + 1])
        before = lines[first - 1].strip() if first else ""
        if has_comment(lines, first) or has_comment(lines, number):
            pass
        elif before and not before.startswith(("#", "namespace", "}", "static_assert")):
            pass  # one of a group without a gap, below one comment
        elif is_type and (inside or end == number):
            pass  # only says that it exists, or says all in a line; or its members are commented
        elif is_function and speaks_for_itself(whole):
            pass
        else:
            yield Finding(path, number + 1, "comment", f"no comment on: {line.strip()}")
        number = end


CPP_CHECKS = (check_layers, check_realtime, check_file_size, check_function_size, check_leftovers,
              check_units, check_comments)


def sources(root):
    for folder in (*CODE_FOLDERS, "systemd", "package", ".ci"):
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path


class Graph:
    """Which folder includes which, as the files say."""

    def __init__(self):
        self.uses, self.files = {}, {}

    def add(self, path, text):
        folder = folder_of(path)
        if folder not in LAYERS:
            return
        self.files[path] = {target for _, target in included(text)}
        others = {folder_of(target) for target in self.files[path]} - {folder}
        self.uses.setdefault(folder, set()).update(others)

    def top(self):
        """Of the folders at the root."""
        uses = {}
        for folder, others in self.uses.items():
            root = folder.split("/")[0]
            uses.setdefault(root, set()).update({o.split("/")[0] for o in others} - {root})
        return uses


def check_graph(root, graph):
    """No cycle; layers.py is in order, and says no more than is there."""
    for uses in (graph.top(), graph.uses, graph.files):
        try:
            levels_of(uses)
        except ValueError as cycle:
            yield Finding("tools/lint/layers.py", 1, "layers", str(cycle))
    page, seen = "tools/lint/layers.py", set()
    if not (root / page).is_file():
        return
    for folder, uses in LAYERS.items():
        for other in uses:
            if other not in seen:
                yield Finding(page, 1, "layers", f"{folder} uses {other}, which is not above it")
            elif other not in graph.uses.get(folder, ()):
                yield Finding(page, 1, "layers", f"{folder} does not include {other}")
        seen.add(folder)


def target_of(folder):
    return "flexarm_" + folder.replace("/", "_")


def check_targets(root, graph):
    """The targets that a folder's CMakeLists.txt links are the folders that it includes."""
    targets = {target_of(folder): [folder] for folder in LAYERS}
    for path in root.glob("*/CMakeLists.txt"):
        for group in re.findall(r"flexarm_group\((.*?)\)", path.read_text(encoding="utf-8"), re.S):
            name, *members = group.split()
            targets[name] = [folder for member in members for folder in targets.get(member, [])]
    for folder in LAYERS:
        path = root / folder / "CMakeLists.txt"
        if not path.is_file():
            continue
        name, text = f"{folder}/CMakeLists.txt", path.read_text(encoding="utf-8")
        linked = re.search(r"flexarm_(library|program)\((.*?)\)\n", text, re.S)
        if linked is None:
            yield Finding(name, 1, "target", "no flexarm_library() or flexarm_program()")
            continue
        words = linked.group(2).split()
        if linked.group(1) == "library" and words[0] != target_of(folder):
            yield Finding(name, 1, "target", f"{words[0]} must be {target_of(folder)}")
        links = {linked for word in words[1:] for linked in targets.get(word, [])}
        for other in sorted(links ^ graph.uses.get(folder, set())):
            what = "is linked and not included" if other in links else "is included and not linked"
            yield Finding(name, 1, "target", f"{other} {what}")


def check_tree(root):
    """All findings in the tree under `root`, and the graph of its folders."""
    findings, graph = [], Graph()
    for path in sources(root):
        name = path.relative_to(root).as_posix()
        if path.suffix not in TEXT_SUFFIXES:
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        if path.suffix in (".h", ".cpp"):
            code = without_comments(text)
            graph.add(name, text)
            for check in CPP_CHECKS:
                # Includes are literals: they are looked for in the text.
                findings.extend(check(name, text, code, root))
        else:
            findings.extend(check_leftovers(name, text, text, root))
    findings.extend(check_graph(root, graph))
    findings.extend(check_targets(root, graph))
    findings.extend(check_picture(root, graph))
    return findings, graph


def check_picture(root, graph):
    path = root / PICTURE
    if path.is_file() and path.read_text(encoding="utf-8") != draw(graph.uses):
        yield Finding(PICTURE, 1, "picture", "differs: tools/lint/check_layers.py --picture")


def print_graph(graph):
    for uses in (graph.top(), graph.uses):
        levels = levels_of(uses)
        for folder in sorted(levels, key=lambda f: (levels[f], f)):
            print(f"{levels[folder]:3} {folder} -> {' '.join(sorted(uses.get(folder, ())))}")
        print(f"{len(levels)} folders, {sum(map(len, uses.values()))} arrows, no cycle\n")
    print(f"{len(levels_of(graph.files))} files, no cycle")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[2],
                        help="the tree to check (default: this one)")
    parser.add_argument("--graph", action="store_true",
                        help="print which folder includes which, by levels: no arrow points up")
    parser.add_argument("--picture", action="store_true", help=f"write {PICTURE}")
    arguments = parser.parse_args()
    if not any((arguments.root / folder).is_dir() for folder in CODE_FOLDERS):
        print(f"check_layers: {arguments.root} has no source folder", file=sys.stderr)
        return 2
    findings, graph = check_tree(arguments.root)
    if arguments.graph:
        print_graph(graph)
    if arguments.picture:
        (arguments.root / PICTURE).write_text(draw(graph.uses), encoding="utf-8")
        findings = [finding for finding in findings if finding.rule != "picture"]
    for finding in findings:
        print(finding)
    errors = [finding for finding in findings if not finding.warning]
    warnings = len(findings) - len(errors)
    print(f"check_layers: {len(errors)} errors, {warnings} warnings")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
