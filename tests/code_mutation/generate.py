"""Mutants of a C++ source: small changes, each of which some test must notice.

Works on tokens; comments, texts in quotes and preprocessor lines are left alone. It relies on the
format of clang-format here: a comparison has spaces around it, the bracket of a template has not.
The same text always has the same mutants in the same order.
"""

import re
from collections import Counter
from dataclasses import dataclass

TOKEN = re.compile(r"""
    (?P<skip>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*)
  | (?P<text>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
  | (?P<number>\.?\d(?:[eEpP][+-]|'?[\w.])*)
  | (?P<word>[A-Za-z_]\w*)
  | (?P<sign><<=|>>=|<=>|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|::|[^\s\w])
""", re.VERBOSE | re.MULTILINE | re.DOTALL)

# Binary signs, with a space on either side, and what takes their place.
BINARY = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||",
          "||": "&&", "+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "|": "&", "&": "|",
          "^": "|", "<<": ">>", ">>": "<<", "+=": "-=", "-=": "+=", "|=": "=", "&=": "=",
          "^=": "="}
OFF_BY_ONE = {"<", "<=", ">", ">="}
WORDS = {"true": "false", "false": "true", "min": "max", "max": "min", "INT64_MIN": "0",
         "INT64_MAX": "0"}
ZERO_NAMES = {"kNone", "kStarting"}  # enumerators that are 0 already
NO_STATEMENT = {"alignas", "auto", "break", "case", "class", "const", "constexpr", "default", "do",
                "else", "enum", "explicit", "extern", "for", "friend", "if", "inline", "namespace",
                "operator", "private", "protected", "public", "return", "static", "static_assert",
                "struct", "switch", "template", "thread_local", "throw", "try", "typedef",
                "typename", "using", "virtual", "void", "while"}
OPEN, CLOSE = set("([{"), set(")]}")


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    begin: int
    end: int


@dataclass(frozen=True)
class Mutant:
    operator: str  # negate, drop, off-by-one, swap or constant
    begin: int
    end: int
    new: str
    line_number: int
    line: str  # the text of its first line
    mutation: str  # old -> new
    nth: int  # which of the same mutation on lines of the same text, from 1

    def apply(self, text):
        return text[:self.begin] + self.new + text[self.end:]


def tokens_of(text):
    return [Token(match.lastgroup, match.group(), match.start(), match.end())
            for match in TOKEN.finditer(text) if match.lastgroup != "skip"]


def partners(tokens):
    """The index of the bracket that closes, for each that opens, and the reverse."""
    found, waiting = {}, []
    for index, token in enumerate(tokens):
        if token.kind == "sign" and token.text in OPEN:
            waiting.append(index)
        elif token.kind == "sign" and token.text in CLOSE and waiting:
            found[index] = waiting.pop()
            found[found[index]] = index
    return found


def end_of_operand(tokens, pairs, index):
    """The index of the token that ends the operand which begins at `index`."""
    while index < len(tokens):
        text = tokens[index].text
        if text in OPEN and index in pairs:
            index = pairs[index]
        elif text in CLOSE or text in {",", ";", ":"}:
            return index
        elif text == "?":  # a conditional inside: its colon is not ours
            index = end_of_operand(tokens, pairs, index + 1)
        index += 1
    return index


def spaced(text, token):
    return text[token.begin - 1:token.begin].isspace() and text[token.end:token.end + 1].isspace()


def conditions(text, tokens, pairs):
    for index, token in enumerate(tokens[:-1]):
        if token.text in {"if", "while"}:
            opens = index + 1 + (tokens[index + 1].text == "constexpr")
            if tokens[opens].text != "(":
                continue
            begin = opens + 1
            for inner in range(begin, pairs[opens]):  # `if (init; condition)`
                if tokens[inner].text == ";":
                    begin = inner + 1
            first, last = tokens[begin].begin, tokens[pairs[opens]].begin
            inside = [inner.text for inner in tokens[begin:pairs[opens]]]
            joined = {"&&", "||"} & set(inside)
            # Another mutant does the same: without the `!`, or with the other comparison.
            if joined or inside[0] != "!" and not {"==", "!="} & set(inside):
                yield "negate", first, last, f"!({text[first:last]})"
        elif token.text == "?":
            colon = end_of_operand(tokens, pairs, index + 1)
            if colon >= len(tokens) or tokens[colon].text != ":":
                continue
            end = end_of_operand(tokens, pairs, colon + 1)
            first, last = tokens[index + 1].begin, tokens[end - 1].end
            yes = text[first:tokens[colon - 1].end]
            no = text[tokens[colon + 1].begin:last]
            yield "negate", first, last, f"({no}) : ({yes})"


def statements(text, tokens, pairs):
    """Statements that are no declaration, and the values of return statements."""
    for index, token in enumerate(tokens):
        before = tokens[index - 1].text if index else ";"
        if token.text == "return" and tokens[index + 1].text != ";":
            end = index + 1
            while tokens[end].text != ";":
                end = pairs[end] + 1 if tokens[end].text in OPEN else end + 1
            first, last = tokens[index + 1].begin, tokens[end].begin
            if text[first:last] not in {"0", "false", "nullptr", "{}", '""'}:
                yield "constant", first, last, "{}"
            continue
        if before not in {"{", "}", ";", ")", "else", ":"} or token.text in CLOSE:
            continue
        if before == ")" and (pairs.get(index - 1, 0) == 0 or
                              tokens[pairs[index - 1] - 1].text not in {"if", "for", "while"}):
            continue
        if token.text in NO_STATEMENT or token.text in {";", "{", ",", ":"}:
            continue
        end, shape = index, []
        while end < len(tokens) and tokens[end].text not in {";", "}", ","}:
            shape.append(tokens[end])
            end = pairs[end] + 1 if tokens[end].text in OPEN else end + 1
        if end >= len(tokens) or tokens[end].text != ";" or declares(text, shape):
            continue
        yield "drop", token.begin, tokens[end].begin, ""


def declares(text, shape):
    """Is it `Type name ..`? Only an assignment, a call or an increment changes anything."""
    if not any(token.text in {"++", "--", "("} or (token.text.endswith("=") and token.kind == "sign")
               for token in shape):
        return True
    for one, other in zip(shape, shape[1:]):
        if one.text in {"=", "("}:
            return False
        if other.kind == "word" and (one.kind == "word" or (one.text in {"&", "*", ">"} and
                                                            text[one.end:one.end + 1] == " ")):
            return True
    return False


def single_tokens(text, tokens):
    for index, token in enumerate(tokens):
        before = tokens[index - 1].text if index else ""
        after = tokens[index + 1].text if index + 1 < len(tokens) else ""
        if token.kind == "sign":
            if token.text in BINARY and spaced(text, token) and before != "operator":
                kind = "off-by-one" if token.text in OFF_BY_ONE else "swap"
                yield kind, token.begin, token.end, BINARY[token.text]
            elif token.text == "!" or (token.text == "~" and before != "}"):
                yield "negate", token.begin, token.end, ""
            elif token.text in {"++", "--"}:
                yield "swap", token.begin, token.end, {"++": "--", "--": "++"}[token.text]
        elif token.kind == "number":
            if after in {">"} and before in {"<", ","} and not spaced(text, tokens[index + 1]):
                continue  # the argument of a template
            real = re.search(r"[.]|\d[eE]", token.text) and not token.text.startswith("0x")
            yield "off-by-one", token.begin, token.end, f"({token.text} + {'1.0' if real else '1'})"
        elif token.kind == "word":
            if token.text in WORDS:
                yield ("swap" if token.text in {"min", "max"} else "constant",
                       token.begin, token.end, WORDS[token.text])
            elif re.match(r"k[A-Z]", token.text) and token.text not in ZERO_NAMES:
                constant = name_mutant(text, tokens, index)
                if constant:
                    yield constant


def name_mutant(text, tokens, index):
    """A named constant becomes the zero of its type; not where it is defined or a label."""
    first = index
    while first >= 2 and tokens[first - 1].text == "::" and tokens[first - 2].kind == "word":
        first -= 2
    before = tokens[first - 1].text if first else ""
    after = tokens[index + 1].text if index + 1 < len(tokens) else ""
    defined = tokens[first - 1].kind == "word" and before not in {"return", "case", "else"}
    if first and (defined or before in {"case", "&", ">"} and not spaced(text, tokens[first - 1])):
        return None
    if after in {"(", "[", "{", "::", "."} or (after == "=" and first == index):
        return None
    name = text[tokens[first].begin:tokens[index].end]
    return ("constant", tokens[first].begin, tokens[index].end,
            f"static_cast<decltype({name})>(0)")


def mutants_of(text):
    """All mutants of the text of a source, in the order of their places."""
    tokens = tokens_of(text)
    pairs = partners(tokens)
    found = [*conditions(text, tokens, pairs), *statements(text, tokens, pairs),
             *single_tokens(text, tokens)]
    lines = text.splitlines()
    seen, mutants = Counter(), []
    for operator, begin, end, new in sorted(set(found), key=lambda m: (m[1], m[2], m[3])):
        if text.rfind("static_assert", 0, begin) > max(text.rfind(";", 0, begin),
                                                       text.rfind("}", 0, begin)):
            continue
        number = text.count("\n", 0, begin)
        old = " ".join(text[begin:end].split())
        mutation = f"{old} -> {' '.join(new.split()) or 'nothing'}"
        line = lines[number].strip()
        seen[line, mutation] += 1
        mutants.append(Mutant(operator, begin, end, new, number + 1, line, mutation,
                              seen[line, mutation]))
    return mutants
