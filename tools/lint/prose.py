"""What a file says to people: comments, messages, pages. For check_docs.py and check_words.py.

Each function returns a text of the same length with the same line breaks, so that positions hold:
marks of comments and quotes are spaces, what is code is NUL. A sentence that goes on in the next
line of a comment, or in the next literal, can be found by an expression with white space.
"""

import re

CODE_FOLDERS = ("model", "hal", "estimator", "controller", "config", "tools", "tests")
SCRIPTS = {".sh", ".cmake", ".toml", ".in", ".service", ".txt", ".run", ""}

CPP = re.compile(r"//[^\n]*|/\*.*?\*/|R\"(?P<tag>[^(\s]*)\(.*?\)(?P=tag)\"|\"(?:\\.|[^\"\\\n])*\""
                 r"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'", re.S)
PYTHON = re.compile(r"(?P<comment>#[^\n]*)|(?P<docstring>^[ \t]*\"\"\".*?\"\"\")"
                    r"|\"\"\".*?\"\"\"|'''.*?'''"
                    r"|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S | re.M)
FENCE = re.compile(r"^[ \t]*```.*?^[ \t]*```[ \t]*$", re.M | re.S)
SPAN = re.compile(r"`((?:[^`\n]|\n(?!\s*\n))+)`")


def same_length(pattern, text, fill=" "):
    """Every match becomes `fill`, but for its line breaks."""
    return re.sub(pattern, lambda match: re.sub(r"[^\n]", fill, match.group(0)), text)


def code(text):
    return re.sub(r"\S+", lambda match: "\0" * len(match.group(0)), text)


def literal(token):
    return same_length(r"\\.", " " + token[1:-1] + " ")


def kept(token_pattern, text, keep):
    """The text with all but its tokens as code, and each token as `keep` returns it."""
    parts, end = [], 0
    for match in token_pattern.finditer(text):
        parts += [code(text[end:match.start()]), keep(match)]
        end = match.end()
    return "".join(parts + [code(text[end:])])


def cpp(text):
    """Comments and string literals of a C++ file."""
    def keep(match):
        token = match.group(0)
        if token.startswith(("//", "/*")):
            return same_length(r"^//[/!]?<?|^/\*+|\*/$|(?m:^[ \t]*\*(?!/))", token)
        if token.startswith("'"):
            return code(token)
        return literal(token) if token.startswith('"') else token
    return kept(CPP, text, keep)


def python(text, literals=True):
    """Comments, docstrings and other string literals of a Python file."""
    def keep(match):
        token = match.group(0)
        if match.group("comment"):
            return " " + token[1:]
        return literal(token) if literals or match.group("docstring") else code(token)
    return kept(PYTHON, text, keep)


def script(text):
    """All of a file in which comments begin with #."""
    return same_length(r"(?m:^[ \t]*#+!?)", text)


def of_file(path, text, literals=True):
    """What the file says, or None if it is of no known kind. Literals: those of Python."""
    if path.suffix in (".h", ".cpp"):
        return cpp(text)
    if path.suffix == ".py" or text.startswith("#!/usr/bin/env python3"):
        return python(text, literals)
    if path.suffix == ".md":
        return text
    return script(text) if path.suffix in SCRIPTS else None


def spans(page):
    """Yields (position, text, whether it is of a code block) of what a page shows as code. A
    command that goes on after a backslash is one text."""
    for block in FENCE.finditer(page):
        end = block.start()
        for line in re.split(r"(?<!\\)\n", block.group(0)):
            if not line.strip().startswith("```"):
                yield end, line.replace("\\\n", " \n"), True
            end += len(line) + 1
    for match in SPAN.finditer(same_length(FENCE, page)):
        yield match.start(1), match.group(1).replace("\n", " "), False


def files(root):
    """All text files of the tree but the pages, sorted."""
    for path in sorted(root.glob("*")):
        if path.is_file() and path.name in ("CMakeLists.txt", "CMakePresets.json"):
            yield path
    for folder in (*CODE_FOLDERS, "systemd", "package", ".ci"):
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".md":
                yield path


def pages(root):
    """README.md, docs/ and model/symbols.md: all pages but the changelog."""
    found = [*root.glob("*.md"), *(root / "docs").rglob("*.md"), *root.glob("model/*.md")]
    return sorted(path for path in found if path.name != "CHANGELOG.md")


def read(path):
    """The text of a file, or "" if it is none."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def line_of(text, position):
    return text.count("\n", 0, position) + 1
