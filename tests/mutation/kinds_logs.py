"""Inputs that are SQLite files: run logs and the results of sweeps."""

import shutil
import sqlite3

import mutate
from inputs import CONFIGS

VERBS = ("info", "info --json", "replay", "check", "export", "diff", "plot")


def run_verb(trial, verb, file, **judged):
    if verb == "export":
        return trial.flexarm("export", file, "-o", "out.csv", names=(file.name,), **judged)
    if verb == "diff":
        return trial.flexarm("diff", file, trial.programs.run, "--json", names=(file.name,), **judged)
    if verb == "plot":
        return trial.flexarm("plot", file, "-o", "out.svg", names=(file.name,), **judged)
    return trial.flexarm(*verb.split(), file, names=(file.name,), **judged)


def log_bytes(trial):
    file = trial.write("changed.flexarm", mutate.in_bytes(trial.chosen, trial.programs.run.read_bytes()))
    run_verb(trial, trial.chosen.choice(VERBS), file)


def contents(file):
    """All that a reader of the file can see, with the types of the values; None: it is damaged."""
    log = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
    log.text_factory = bytes
    try:
        tables = [name.decode() for name, in log.execute(
            "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")]
        return [(name, repr(log.execute(f'SELECT * FROM "{name}"').fetchall())) for name in tables]
    except (sqlite3.Error, UnicodeDecodeError, MemoryError):
        return None
    finally:
        log.close()


def flipped_bit(trial):
    """One bit of a log: if it changes what the log says, replay or check says so."""
    data = bytearray(trial.programs.run.read_bytes())
    at = trial.chosen.randrange(len(data))
    data[at] ^= 1 << trial.chosen.randrange(8)
    file = trial.write("flipped.flexarm", bytes(data))
    ended = [run_verb(trial, verb, file) for verb in ("replay", "check")]
    if all(each.code == 0 for each in ended) and contents(file) != contents(trial.programs.run):
        trial.add(["replay and check", file.name], [f"a flipped bit in byte {at} is not noticed"])


TABLES = ("run", "block", "grid", "sample", "activation", "safety", "event")
RECURSIVE = ("WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n LIMIT {rows}) ")


def columns_of(log, table):
    return [row[1] for row in log.execute(f"PRAGMA table_info({table})")]


def table_as_view(log, chosen):
    """A view that never ends in the place of a table or view."""
    table = chosen.choice(TABLES + ("tick", "timing"))
    names = columns_of(log, table)
    log.execute(f"DROP {'TABLE' if table in TABLES else 'VIEW'} {table}")
    rows = chosen.choice((1_000_000, 10**15))
    log.execute(f"CREATE VIEW {table} AS " + RECURSIVE.format(rows=rows) + "SELECT " +
                ", ".join(f"i AS {name}" for name in names) + " FROM n")


def trigger(log, chosen):
    table = chosen.choice(TABLES)
    log.execute(f"CREATE TRIGGER t AFTER INSERT ON {table} BEGIN DELETE FROM block; END")


def large_value(log, chosen):
    table, column = chosen.choice((("run", "value"), ("event", "text"), ("event", "value_json"),
                                   ("safety", "record"), ("block", "records"), ("event", "kind")))
    size = chosen.choice((1_000_000, 100_000_000))
    value = chosen.choice((f"zeroblob({size})", f"replace(hex(zeroblob({size // 2})), '0', 'x')"))
    log.execute(f"UPDATE {table} SET {column} = {value}"
                + (" WHERE key = (SELECT key FROM run ORDER BY random() LIMIT 1)" if table == "run" else ""))


def many_rows(log, chosen):
    rows = chosen.choice((100_000, 1_000_000))
    log.execute("INSERT INTO event (time_ns, time_s, kind, name, text, value_json) "
                + RECURSIVE.format(rows=rows) + "SELECT i, i, 'x', 'x', 'x', '{}' FROM n")


def text_of_run(log, chosen):
    """Texts of the table of the run, which are JSON, TOML and names."""
    keys = [key for key, in log.execute("SELECT key FROM run ORDER BY key")]
    key = chosen.choice(keys)
    value = chosen.choice(("", "x", "\x1b[31mred", "[" * 100_000, '{"a":' * 10_000, "null", "[]", "nan", "-1",
                           "1e999", "99999999999999999999", "{}", "x" * 100_000, "\u202eevil", "a\x00b",
                           b"\xff\xfe", None, 1.5, '{"trip": [[[]]]}', '{"tripped": "\x1b]0;x\x07"}'))
    if value is None:
        log.execute("DELETE FROM run WHERE key = ?", (key,))
    else:
        log.execute("UPDATE run SET value = ? WHERE key = ?", (value, key))


def odd_values(log, chosen):
    """Values of other types and sizes in a column."""
    table = chosen.choice(TABLES[1:])
    column = chosen.choice(columns_of(log, table))
    value = chosen.choice((None, "x", "\x1b[31m", b"", b"\x00" * 7, 1e300, -1, 2**62, "nan", b"\xff" * 1000))
    where = "" if column not in ("tick", "number", "first_tick") else " WHERE rowid = (SELECT max(rowid) FROM " + table + ")"
    log.execute(f"UPDATE OR IGNORE {table} SET {column} = ?{where}", (value,))


def other_schema(log, chosen):
    table = chosen.choice(("run", "tick", "safety", "event", "timing"))
    kind = chosen.randrange(5)
    if kind == 0:
        log.execute(f"DROP TABLE {table}")
    elif kind == 1:
        log.execute(f"ALTER TABLE {table} RENAME TO other")
    elif kind == 2:
        column = chosen.choice(columns_of(log, table))
        log.execute(f'ALTER TABLE {table} RENAME COLUMN {column} TO "\x1b[31m"')
    elif kind == 3:
        log.execute(f'ALTER TABLE {table} ADD COLUMN extra TEXT DEFAULT (hex(zeroblob(1000)))'
                    .replace("(hex(zeroblob(1000)))", "'x'"))
    else:
        log.execute(f"DELETE FROM {table}")


def header(log, chosen):
    pragma = chosen.choice(("user_version = 999", "user_version = -1", "application_id = 1",
                            "journal_mode = WAL", "encoding = 'UTF-16'"))
    log.execute("PRAGMA " + pragma)


HURTS = (table_as_view, trigger, large_value, many_rows, text_of_run, text_of_run, odd_values, odd_values,
         other_schema, header)


def made_to_hurt(trial):
    file = trial.folder / "hurts.flexarm"
    shutil.copy(trial.programs.run, file)
    hurt = trial.chosen.choice(HURTS)
    log = sqlite3.connect(file, isolation_level=None)
    try:
        hurt(log, trial.chosen)
    except sqlite3.Error as error:  # what SQLite does not allow is no input
        if "disk I/O" in str(error):
            raise
    finally:
        log.close()
    trial.keep(file)
    before = len(trial.found)
    run_verb(trial, trial.chosen.choice(VERBS), file)
    trial.found[before:] = [f"[{hurt.__name__}] {text}" for text in trial.found[before:]]


def sweep_results(trial):
    chosen = trial.chosen
    good = trial.programs.sweep
    file = trial.folder / "changed.sqlite"
    if chosen.random() < 0.6:
        file.write_bytes(mutate.in_bytes(chosen, good.read_bytes()))
    else:
        shutil.copy(good, file)
        results = sqlite3.connect(file, isolation_level=None)
        tables = [name for name, in results.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        table = chosen.choice(sorted(tables))
        column = chosen.choice(columns_of(results, table))
        value = chosen.choice(("x", "\x1b[31m", None, b"\xff", 1e300, -1, "[" * 1000, ""))
        try:
            results.execute(f'UPDATE "{table}" SET "{column}" = ?', (value,))
        except sqlite3.Error:
            pass
        results.close()
    verb = chosen.choice(("show", "resume", "merge"))
    if verb == "show":
        trial.keep(file)
        trial.flexarm("sweep", "show", file, names=(file.name,))
    elif verb == "merge":
        trial.keep(file)
        trial.flexarm("sweep", "merge", file, good, "-o", "merged.sqlite", names=(file.name, good.name))
    else:
        trial.flexarm("sweep", "-c", CONFIGS / "hil.toml", "--experiment", trial.programs.experiment, "--over",
                      "controller.alpha=2.5,3.0", "--seeds", "1..2", "-o", file, "--json", names=(file.name,))


KINDS = {
    "log-bytes": log_bytes,
    "log-flipped-bit": flipped_bit,
    "log-made-to-hurt": made_to_hurt,
    "sweep-results": sweep_results,
}
