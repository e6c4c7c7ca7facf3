"""The command blocks of the pages: their tags, and what is wrong with them. check_docs.py reports
the latter; tests/docs/run_blocks.py runs the blocks.

A block of commands is a fence of language `sh` with a tag:

    ```sh ci                     runs in lane docs, in a clone and with the installed programs
    ```sh ci clone               only in a clone: it needs the source tree
    ```sh ci installed           only with the installed programs
    ```sh all unbuilt            only in a clone without its build folder: it builds everything
    ```sh rig: needs the drives  does not run; the reason says why

`all` is for what takes minutes (lane docs-all), `guest` for what needs the emulated real-time
kernel (lane guest), `newcomer` for what needs the installed package there (lane guest-long). Each
block of text after a `newcomer` block is what it prints. Every other fence says its language, and holds no commands.
"""

import dataclasses
import re

import prose

LANES = ("ci", "all", "guest", "newcomer", "rig")
PLACES = ("clone", "installed", "unbuilt")
TAGS = "ci, all, guest, newcomer or rig: REASON"
SHELLS = ("bash", "bat", "cmd", "console", "dash", "fish", "ksh", "powershell", "pwsh",
          "shell", "shell-session", "shellsession", "sh-session", "terminal", "zsh")
OTHERS = ("c", "cpp", "csv", "html", "ini", "json", "matlab", "octave", "python", "sql", "text",
          "toml", "xml", "yaml")
REASON_WORDS = 3

OPENING = re.compile(r"(?P<indent>[ \t]*)(?P<ticks>`{3,})[ \t]*(?P<info>[^`]*?)[ \t]*")
ELSEWHERE = re.compile(r"[ \t]*(?:~~~|>\s*(?:```|~~~)|(?:[-*+]|\d+[.)])\s+(?:```|~~~)|<pre\b)")
TAG = re.compile(r"(?P<lane>[^\s:]+)(?:[ \t]+(?P<place>[^\s:]+))?[ \t]*(?::[ \t]*(?P<reason>.*))?")
# The beginning of a line that is a command: a prompt, or a program with a word after it.
COMMAND = re.compile(r"[ \t]*(?:[$#] \w|(?:\./[\w/.-]+|(?:tools|tests|build)/[\w/.-]+|apt(?:-get)?|cd|"
                     r"cmake|cp|ctest|flexarm(?:d|-study)?|git|ln|mkdir|ninja|pip3?|python3|rm|sudo|"
                     r"systemctl|valgrind)[ \t]+[-.\w/$\"'])")
INDENTED = re.compile(r"(?: {4,}|\t)")


@dataclasses.dataclass
class Block:
    """A fence of a page. Lines are numbered from 1; the body begins in the line after `line`."""
    line: int
    info: str
    body: list
    closed: bool

    @property
    def language(self):
        return self.info.split()[0] if self.info else ""

    @property
    def tag(self):
        return TAG.fullmatch(self.info[len(self.language):].strip())

    @property
    def lane(self):
        return self.tag["lane"]

    @property
    def place(self):
        return self.tag["place"]


def fences(text):
    """Yields each fence of a page, without the indentation of a list."""
    block = None
    for number, line in enumerate(text.splitlines(), 1):
        if block is None:
            match = OPENING.fullmatch(line)
            if match:
                indent, ticks = match["indent"], match["ticks"]
                block = Block(number, match["info"], [], False)
        elif re.fullmatch(rf"[ \t]*{ticks}`*[ \t]*", line):
            block.closed = True
            yield block
            block = None
        else:
            block.body.append(line[len(indent):] if line.startswith(indent) else line.lstrip())
    if block is not None:
        yield block


def commands(text):
    """The blocks of a page that hold commands."""
    return [block for block in fences(text) if block.language == "sh"]


def tag_problem(block):
    """What is wrong with the tag of a block of commands, or None."""
    tag = block.tag
    if tag is None:
        return f"a block of commands has no tag: write ```sh and {TAGS}"
    lane, place, reason = tag["lane"], tag["place"], tag["reason"]
    if lane not in LANES:
        return f"found the tag '{lane}', expected {TAGS}"
    if lane == "rig":
        if place or len((reason or "").split()) < REASON_WORDS:
            return f"a block that does not run says why, in {REASON_WORDS} words at least: " \
                   "```sh rig: REASON"
        return None
    if reason is not None:
        return f"only rig has a reason, and '{lane}' runs"
    if place not in (None, *PLACES):
        return f"found '{place}' after {lane}, expected nothing, {', '.join(PLACES)}"
    if place and lane == "newcomer":
        return "a newcomer has the package alone: no newcomer block has a place"
    if place == "unbuilt" and lane == "guest":
        return "nothing is built in the guest: no guest block is unbuilt"
    return None


def block_problems(block):
    """Yields (line, message) of a fence."""
    if not block.closed:
        yield block.line, "the fence has no end"
    language = block.language
    if language in SHELLS:
        yield block.line, f"found the language {language}, expected sh for commands, with a tag"
    elif not language:
        yield block.line, f"a fence has no language: ```text, or ```sh and {TAGS} for commands"
    elif language == "sh":
        problem = tag_problem(block)
        if problem:
            yield block.line, problem
        if not any(line.strip() and not line.lstrip().startswith("#") for line in block.body):
            yield block.line, "a block of commands has no command"
        for number, line in enumerate(block.body, block.line + 1):
            if re.match(r"[ \t]*\$ ", line):
                yield number, "a command has no prompt; its output is a block of text"
            elif problem is None and block.lane != "rig" and "&&" in re.sub(r"\s#.*", "", line):
                yield number, "a failure before && would not be noticed: write two lines"
    elif language not in OTHERS:
        yield block.line, f"found the language {language}, expected sh or {', '.join(OTHERS)}"
    if language != "sh":
        for number, line in enumerate(block.body, block.line + 1):
            if COMMAND.match(line) and not (language == "python" and line.startswith("#")):
                yield number, f"commands belong into a block ```sh and {TAGS}"


def problems(text):
    """Yields (line, message) of what is wrong with the blocks of a page, and of commands that are
    in none."""
    for block in fences(text):
        yield from block_problems(block)
    before, quoted = "", False
    for number, line in enumerate(prose.same_length(prose.FENCE, text).splitlines(), 1):
        if ELSEWHERE.match(line):
            yield number, "a block begins with ``` at the start of a line, or below an item of a list"
        # Markdown shows a line as code that stands four spaces in, after an empty line.
        quoted = bool(INDENTED.match(line)) and (quoted or not before.strip())
        if quoted and COMMAND.match(line):
            yield number, f"commands belong into a block ```sh and {TAGS}"
        before = line


def pages(root):
    """All pages of the tree, the changelog and those beside code too."""
    folders = ("docs", "systemd", "package", ".ci", *prose.CODE_FOLDERS)
    return sorted([*root.glob("*.md"),
                   *(page for folder in folders for page in (root / folder).rglob("*.md"))])
