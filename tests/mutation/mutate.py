"""Changes an input at random: bytes, lines, numbers, the structure of TOML, JSON and CSV."""

import json
import re

NUMBER = re.compile(r"(?<![\w.\"'-])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.\"'])", re.IGNORECASE)
SCALES = (0.0, -1.0, 0.5, 2.0, 0.9, 1.1, 1e-3, 1e3, 1e-9, 1e9, 1e300, -1e300)
SPECIAL_NUMBERS = ("nan", "inf", "-inf", "1e999", "-0.0", "9223372036854775807", "-9223372036854775809",
                   "18446744073709551616", "0x7fffffff", "1e-320", "0", "1", "-1")
# Escape sequences, bidirectional text, a nul, not UTF-8, a lone surrogate, a byte-order mark.
NASTY = (b"\x1b[31m", b"\x1b]0;title\x07", b"\x00", b"\xff\xfe", b"\xc3", b"\xed\xa0\x80", b"\xef\xbb\xbf",
         "\u202e".encode(), b"\x9b31m", "\u0085".encode(), b"\x7f", b"\r", b"%s%n", b"'; DROP TABLE tick; --")


def one_byte_change(chosen, data):
    at = chosen.randrange(len(data) + 1)
    end = min(len(data), at + chosen.choice((1, 1, 2, 8, 100)))
    kind = chosen.randrange(6)
    if kind == 0:
        return data[:at] + bytes(chosen.randrange(256) for _ in range(end - at)) + data[end:]
    if kind == 1:
        return data[:at] + data[end:]
    if kind == 2:
        return data[:at] + data[at:end] * chosen.choice((2, 3, 100)) + data[end:]
    if kind == 3:
        return data[:at] + chosen.choice(NASTY) + data[at:]
    if kind == 4 and at < len(data):
        return data[:at] + bytes([data[at] ^ 1 << chosen.randrange(8)]) + data[at + 1:]
    return data[:at]


def in_bytes(chosen, data):
    for _ in range(chosen.choice((1, 1, 1, 2, 5))):
        data = one_byte_change(chosen, data)
    return data


def in_lines(chosen, data):
    """Lines removed, repeated, exchanged, cut, joined, or taken into another place."""
    lines = data.split(b"\n")
    for _ in range(chosen.choice((1, 1, 2, 5))):
        at, other = chosen.randrange(len(lines)), chosen.randrange(len(lines))
        kind = chosen.randrange(6)
        if kind == 0 and len(lines) > 1:
            del lines[at]
        elif kind == 1:
            lines.insert(other, lines[at])
        elif kind == 2:
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == 3:
            lines[at] = lines[at][:chosen.randrange(len(lines[at]) + 1)]
        elif kind == 4:
            lines[at] += chosen.choice((b" ", b"=", b",", b"[", b"]", b"{", b"#", b'"')) + lines[other]
        else:
            lines[at] = lines[at].replace(b"=", chosen.choice((b"==", b":", b"")), 1)
    ends = chosen.choice((b"\n", b"\n", b"\n", b"\n", b"\r\n", b"\r"))
    return ends.join(lines)


def in_numbers(chosen, data, gentle=False):
    """Some numbers scaled, or replaced by special ones."""
    text = data.decode("utf-8", "surrogateescape")
    spans = [match.span() for match in NUMBER.finditer(text)]
    for start, end in sorted(chosen.sample(spans, min(len(spans), chosen.choice((1, 1, 2, 4)))),
                             reverse=True):
        if gentle:
            number = repr(float(text[start:end]) * chosen.uniform(0.8, 1.25))
        elif chosen.random() < 0.3:
            number = chosen.choice(SPECIAL_NUMBERS)
        else:
            number = repr(float(text[start:end]) * chosen.choice(SCALES))
        text = text[:start] + number + text[end:]
    return text.encode("utf-8", "surrogateescape")


def other_value(chosen):
    return chosen.choice((None, True, -1, 0, 1e300, 2**63, 0.5, "", "x", "\x1b[31m", "\x00", [], {}, [[]],
                          [None], {"a": 1}, "nan", "\u202e", "x" * 10_000, [0.0] * 10_000))


def in_json(chosen, data):
    """One value of a JSON text replaced, removed, repeated or nested."""
    tree = json.loads(data)
    for _ in range(chosen.choice((1, 1, 2, 4))):
        places = list(places_of(tree))
        if not places:
            return json.dumps(other_value(chosen)).encode()
        parent, key = chosen.choice(places)
        kind = chosen.randrange(6)
        if kind == 0:
            del parent[key]
        elif kind == 1 and isinstance(parent, list):
            parent.insert(key, parent[key])
        elif kind == 2:
            parent[key] = [parent[key]]
        elif kind == 3 and isinstance(parent[key], (int, float)):
            parent[key] = float(parent[key]) * chosen.choice(SCALES)
        elif kind == 4 and isinstance(parent, dict):
            parent[chosen.choice(("", "x", key + " ", key.upper(), "\x1b[2J"))] = parent.pop(key)
        else:
            parent[key] = other_value(chosen)
    return json.dumps(tree).encode()


def nested(chosen):
    """Deeper than any reader should follow."""
    depth = chosen.choice((33, 200, 5_000, 100_000))
    return chosen.choice((b"[" * depth, b"[" * depth + b"]" * depth, b'{"a":' * depth + b"1" + b"}" * depth,
                          b'[{"a":' * depth))


def places_of(tree):
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield tree, key
        yield from places_of(value)


def in_cells(chosen, data):
    """Cells of a CSV file replaced, columns and rows removed, repeated, moved or renamed."""
    rows = [line.split(b",") for line in data.split(b"\n")]
    for _ in range(chosen.choice((1, 1, 2, 5))):
        row = chosen.choice(rows)
        at = chosen.randrange(len(row))
        kind = chosen.randrange(7)
        if kind == 0:
            row[at] = chosen.choice((b"", b"x", b'"', b'"a,b"', b" 1", b"1 2", b"1;2", b"nan", b"1e999"))
        elif kind == 1:
            row[at] = chosen.choice(NASTY)
        elif kind == 2:
            del row[at]
            row[:] = row or [b""]
        elif kind == 3:
            row.insert(at, row[at])
        elif kind == 4:
            column = chosen.randrange(len(rows[0]))
            for each in rows:
                del each[column:column + 1]
                each[:] = each or [b""]
        elif kind == 5:
            chosen.choice(rows)[:] = row
        else:
            rows[0][chosen.randrange(len(rows[0]))] = chosen.choice((b"", b"time_s", b"x", b"\xff"))
    return b"\n".join(b",".join(row) for row in rows)


def in_text(chosen, data):
    """Any of the changes that suit a text."""
    return chosen.choice((in_bytes, in_lines, in_lines))(chosen, data)
