#!/usr/bin/env python3
"""Checks the rules of the source tree that no compiler knows. Exit 1 if one is broken.

layers      an include points in the allowed direction only, and is written from the root
realtime    no I/O, lock, clock or heap by name in files that run on the real-time threads
libm        Step computes with + - * / and sqrt: libm's sin and exp differ between CPUs
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

CODE_FOLDERS = ("model", "hal", "estimator", "controller", "config", "tools", "tests")
TEXT_SUFFIXES = {".h", ".cpp", ".py", ".sh", ".cmake", ".toml", ".in", ".service", ".txt", ""}
MAX_FILE_LINES = 400
MAX_TEST_LINES = 600  # tables of cases are long
MAX_FUNCTION_LINES = 60

# Who may include whom: a room, and the rooms or single files that it may use beside itself. A file
# belongs to the longest room that it starts with. Plain structs of configuration and of messages
# are named one by one where they are used against the arrow's direction.
ROOMS = {
    "model/": [],
    "hal/": ["model/problem.h", "model/problem_list.h"],
    "hal/sim/": ["hal/", "model/"],
    "hal/rig/": ["hal/", "hal/sim/", "model/"],
    "estimator/": ["model/", "hal/"],
    "controller/safety/": ["hal/", "model/problem.h", "model/problem_list.h", "model/units.h",
                           "controller/runtime/messages.h", "controller/runtime/runtime_config.h"],
    "controller/law/": ["model/", "hal/", "estimator/",
                        "controller/safety/safety_config.h", "controller/safety/safety_state.h",
                        "controller/safety/trip_cause.h",
                        "controller/runtime/loop_grid.h",
                        "controller/runtime/stack_config.h",
                        "controller/runtime/runtime_config.h"],
    "controller/commissioning/": ["model/", "hal/", "estimator/", "controller/law/",
                                  "controller/safety/", "controller/runlog/",
                                  "controller/runtime/planned_run.h",
                                  "controller/runtime/stack_config.h"],
    "controller/runlog/": ["model/", "hal/", "estimator/", "controller/law/", "controller/safety/",
                           "controller/runtime/float_environment.h",
                           "controller/runtime/loop_grid.h", "controller/runtime/messages.h",
                           "controller/runtime/runtime_config.h", "controller/runtime/spsc_queue.h",
                           "controller/runtime/stack_config.h", "controller/runtime/task.h"],
    "controller/": ["controller/commissioning/",
                    "model/", "hal/", "hal/sim/", "estimator/", "controller/law/",
                    "controller/safety/", "controller/runlog/", "controller/runtime/"],
    "controller/runtime/": ["model/", "hal/", "hal/sim/", "estimator/", "controller/",
                            "controller/commissioning/",
                            "controller/law/", "controller/safety/", "controller/runlog/"],
    "config/": ["model/", "hal/", "hal/sim/", "estimator/", "controller/", "controller/law/",
                "controller/commissioning/",
                "controller/safety/", "controller/runlog/", "controller/runtime/"],
    "tools/": ["*"],
    "tests/": ["*"],
}

# Files whose code may run on the safety, control, plant or I/O threads.
REALTIME = re.compile(
    r"(model/|estimator/|hal/|controller/(law|safety)/"
    r"|controller/runtime/(safety_task|control_task|plant_task|simulated_lines|history|latest_value"
    r"|spsc_queue|messages|frame_packet|homing_goal|loop_grid|task)\.)")
# Off-line work that lives beside the loop, so that an equation and its use are read together; the
# rules of config structs; and the simulated devices, which are a program of their own.
OFFLINE = re.compile(
    r"controller/law/(design|design_json|command_generator|reference|experiment)\."
    r"|model/arm_parameters\.|hal/rig/|.*_config\.cpp$")
REALTIME_HEADERS = re.compile(
    r"#\s*include\s*<(spdlog/|fmt/|iostream|fstream|sstream|ostream|istream|iomanip|print|cstdio"
    r"|stdio\.h|mutex|shared_mutex|condition_variable|semaphore|thread|future|chrono|ctime|time\.h"
    r"|filesystem|regex|nlohmann/|sqlite3)")
REALTIME_WORDS = re.compile(
    r"\bspdlog::|\bstd::(cout|cerr|clog|mutex|lock_guard|unique_lock|scoped_lock"
    r"|condition_variable|this_thread|async|chrono)\b|\bprintf\s*\(|\bclock_gettime\s*\("
    r"|\b(malloc|calloc|realloc)\s*\(|\bnanosleep\s*\(")

# What ControlStep::Step runs.
STEP = re.compile(
    r"(estimator/(counter_decoder|payload_estimator|payload_filter|state_estimator|strain_fit)"
    r"|model/(portable_math|quasi_static_map|rigid_joint_(arm|arm_impl|transition))"
    r"|controller/law/(control_step|gain_payload|loop_supervisor|move_watch|path_reference"
    r"|payload_supervisor|rigid_point|scheduled_law|tracking_law)|controller/safety/gate)\.")
LIBM = re.compile(
    r"\bstd::(sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log(?:2|10|1p)?|pow|hypot"
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


def room_of(path):
    rooms = [room for room in ROOMS if path.startswith(room)]
    return max(rooms, key=len) if rooms else None


def check_layers(path, text, code, root):
    room = room_of(path)
    if room is None:
        return
    allowed = ROOMS[room]
    for number, line in enumerate(text.splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*"([^"]+)"', line)
        if not match or match.group(1).endswith("_generated.h"):
            continue
        target = match.group(1)
        if not (root / target).is_file():
            yield Finding(path, number, "layers", f'"{target}" is not a file under the root')
            continue
        target_room = room_of(target)
        if "*" in allowed or target_room == room or target in allowed or target_room in allowed:
            if target_room == "tests/" and room != "tests/":
                yield Finding(path, number, "layers", f"{room} must not use the tests' {target}")
            continue
        yield Finding(path, number, "layers", f"{room} must not use {target}")


def check_realtime(path, text, code, root):
    if path.startswith(("tests/", "tools/")):
        return
    if REALTIME.match(path) and not OFFLINE.match(path):
        for number, line in enumerate(code.splitlines(), 1):
            for pattern in (REALTIME_HEADERS, REALTIME_WORDS):
                match = pattern.search(line)
                if match:
                    yield Finding(path, number, "realtime",
                                  f"'{match.group(0).strip()}' in a file of the real-time threads")
    if STEP.match(path):
        for number, line in enumerate(code.splitlines(), 1):
            match = LIBM.search(line)
            if match:
                yield Finding(path, number, "libm", f"{match.group(1)}() in a file that Step runs")


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
    for folder in (*CODE_FOLDERS, "systemd", ".ci"):
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path


def check_tree(root):
    """All findings in the tree under `root`."""
    findings = []
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
            for check in CPP_CHECKS:
                # Includes are literals: they are looked for in the text.
                findings.extend(check(name, text, code, root))
        else:
            findings.extend(check_leftovers(name, text, text, root))
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[2],
                        help="the tree to check (default: this one)")
    arguments = parser.parse_args()
    if not any((arguments.root / folder).is_dir() for folder in CODE_FOLDERS):
        print(f"check_layers: {arguments.root} has no source folder", file=sys.stderr)
        return 2
    findings = check_tree(arguments.root)
    for finding in findings:
        print(finding)
    errors = [finding for finding in findings if not finding.warning]
    warnings = len(findings) - len(errors)
    print(f"check_layers: {len(errors)} errors, {warnings} warnings")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
