"""Inputs that are text files: configs, experiments, trajectories, CSV files, gains, calibrations."""

import mutate
from inputs import CONFIGS, EXPERIMENTS, copy_of_configs, special_file

RIGS = ("thesis-rig.toml", "hil.toml", "hil-wire.toml", "daq-rig.toml", "half-bridges.toml",
        "quanser-2dsfl.toml",
        "thesis-rig-printed.toml", "thesis-rig-stiffened.toml")
LAWS = ("sobel", "sobel-thesis", "sobel-original", "lqr-cgt", "lqr-um", "lqg", "pd", "pd-zv", "pd-zvd", "gain-scheduled",
        "receding-horizon")


def changed_config(trial, change):
    """A rig with one changed file: its own, or the one that it extends. @returns the rig"""
    folder = trial.folder / "config"
    folder.mkdir()
    copy_of_configs(folder)
    rig = folder / trial.chosen.choice(RIGS)
    base = folder / "thesis-rig.toml"
    file = trial.chosen.choice((rig, base))
    file.write_bytes(change(trial.chosen, file.read_bytes()))
    for each in (rig, base):
        trial.keep(each)
    return rig


def config_structure(trial):
    rig = changed_config(trial, mutate.in_text)
    trial.flexarm("config", "check", rig, codes=(0, 2), names=(rig.name, "thesis-rig.toml"))


def config_numbers(trial):
    rig = changed_config(trial, mutate.in_numbers)
    trial.flexarm("config", "check", rig, codes=(0, 2), names=(rig.name, "thesis-rig.toml"))


def config_accepted(trial):
    """A config that is accepted does what the verbs do with any."""
    def gently(chosen, data):
        return mutate.in_numbers(chosen, data, gentle=True)

    rig = changed_config(trial, gently)
    names = (rig.name, "thesis-rig.toml")
    if trial.flexarm("config", "check", rig, codes=(0, 2), names=names).code != 0:
        return
    verb = trial.chosen.randrange(3)
    if verb == 0:
        trial.flexarm("simulate", "-c", rig, "--experiment", trial.programs.experiment, "--controller",
                      trial.chosen.choice(LAWS), "--json")
    elif verb == 1:
        trial.flexarm("design", "-c", rig, "-o", "out.json")
    else:
        trial.flexarm("modes", "-c", rig, "--json")


def experiment(trial, change, verb):
    folder = trial.folder / "experiments"
    folder.mkdir()
    good = trial.chosen.choice(sorted(EXPERIMENTS.glob("*.toml")))
    for table in EXPERIMENTS.glob("*.csv"):
        trial.write("experiments/" + table.name, table.read_bytes())
    file = trial.write("experiments/" + good.name, change(trial.chosen, good.read_bytes()))
    trial.flexarm(*verb, "--experiment", file, "--json", names=(file.name, "trajectory.csv"))


def experiment_structure(trial):
    experiment(trial, mutate.in_text, ("simulate", "-c", CONFIGS / "hil.toml"))


def experiment_numbers(trial):
    experiment(trial, mutate.in_numbers, ("simulate", "-c", CONFIGS / "hil.toml"))


def trajectory(trial):
    for name in ("trajectory.toml", "trajectory.csv"):
        data = (EXPERIMENTS / name).read_bytes()
        if name.endswith(".csv"):
            change = trial.chosen.choice((mutate.in_cells, mutate.in_cells, mutate.in_text, mutate.in_numbers))
            data = change(trial.chosen, data)
        trial.write(name, data)
    trial.flexarm("simulate", "-c", CONFIGS / "hil.toml", "--experiment", "trajectory.toml", "--json",
                  names=("trajectory.csv", "trajectory.toml"))


def csv_of_a_run(trial):
    data = trial.programs.csv.read_bytes()
    change = trial.chosen.choice((mutate.in_cells, mutate.in_cells, mutate.in_text, mutate.in_numbers))
    file = trial.write("changed.csv", change(trial.chosen, data))
    if trial.chosen.random() < 0.7:
        trial.flexarm("replay", file, "-c", CONFIGS / "hil.toml", "--json", names=(file.name,))
    else:
        trial.flexarm("identify", "-c", CONFIGS / "hil.toml", "--run", file, "--free",
                      "arm.payload_mass_kg", "--json", names=(file.name,))


def change_json(trial, data):
    choice = trial.chosen.random()
    if choice < 0.1:
        return mutate.nested(trial.chosen)
    change = mutate.in_json if choice < 0.6 else mutate.in_numbers if choice < 0.8 else mutate.in_bytes
    return change(trial.chosen, data)


def gains(trial):
    file = trial.write("changed.json", change_json(trial, trial.programs.gains.read_bytes()))
    trial.flexarm("simulate", "-c", CONFIGS / "hil.toml", "--experiment", trial.programs.experiment, "--set",
                  f"controller.gains='{file}'", "--json", names=(file.name, "short.toml"))


def calibration(trial):
    file = trial.write("changed.json", change_json(trial, trial.programs.calibration.read_bytes()))
    trial.flexarm("replay", trial.programs.csv, "-c", CONFIGS / "hil.toml", "--calibration", file, "--json",
                  names=(file.name,))


def special_files(trial):
    """A FIFO, a device, a loop, another encoding in the place of each kind of file."""
    chosen, programs = trial.chosen, trial.programs
    hil = CONFIGS / "hil.toml"
    place = chosen.choice(("config", "extends", "experiment", "trajectory", "csv", "gains", "calibration",
                           "log", "sweep"))
    good = {"config": CONFIGS / "thesis-rig.toml", "extends": CONFIGS / "thesis-rig.toml",
            "experiment": EXPERIMENTS / "square-30deg.toml", "trajectory": EXPERIMENTS / "trajectory.csv",
            "csv": programs.csv, "gains": programs.gains, "calibration": programs.calibration,
            "log": None, "sweep": None}[place]
    name = "special.csv" if place in ("csv", "trajectory") else "special.file"
    file = trial.folder / name
    what = special_file(chosen, file, good.read_bytes() if good else b"SQLite format 3\0")
    trial.keep(file)
    if place == "extends":
        trial.write("rig.toml", f'extends = "{name}"\n'.encode())
    if place == "trajectory":
        trial.write("moves.toml",
                    (EXPERIMENTS / "trajectory.toml").read_bytes().replace(b"trajectory.csv", name.encode()))
    command = {
        "config": ("config", "check", file), "extends": ("config", "check", "rig.toml"),
        "experiment": ("simulate", "-c", hil, "--experiment", file, "--json"),
        "trajectory": ("simulate", "-c", hil, "--experiment", "moves.toml", "--json"),
        "csv": ("replay", file, "-c", hil, "--json"),
        "gains": ("simulate", "-c", hil, "--experiment", programs.experiment, "--set",
                  f"controller.gains='{file}'", "--json"),
        "calibration": ("replay", programs.csv, "-c", hil, "--calibration", file, "--json"),
        "log": ("info", file), "sweep": ("sweep", "show", file),
    }[place]
    before = len(trial.found)
    trial.flexarm(*command, names=(name,))
    trial.found[before:] = [f"[{what}] {text}" for text in trial.found[before:]]


ODD = ("", " ", "=", "a", "a=", "=1", "controller.alpha", "controller.alpha=", "controller.alpha=x",
       "controller.alpha=nan", "controller.alpha=1e999", "controller.alpha=\x1b[31m", "\x1b]0;x\x07=1",
       "controller.alpha=[[[[", "controller..alpha=1", "controller.alpha.x=1", "link1=1", "rig.name='\x07'",
       "limits.torque_limit_nm=[1,2,3]", "x" * 5_000, "controller.alpha=" + "[" * 5_000, "\u202e=1",
       "rig.name=\"\\u001b[2J\"", "sim.seed=-1", "sim.seed=99999999999999999999", "-1", "--", "-",
       "controller.alpha=1\ncontroller.alpha=2", "\udcff=1")
OPTIONS = ("--set", "--payload-kg", "--seed", "--controller", "--estimator", "--plant-modes", "--experiment",
           "-o", "-c", "--json", "--without-prediction", "--no-such-option", "--help")


def arguments(trial):
    chosen = trial.chosen
    odd = [mutate.in_bytes(chosen, chosen.choice(ODD).encode("utf-8", "surrogateescape")).replace(b"\0", b"")
           if chosen.random() < 0.3 else chosen.choice(ODD).encode("utf-8", "surrogateescape")
           for _ in range(4)]
    words = []
    for word in odd[:chosen.randrange(1, 4)]:
        words += [chosen.choice(OPTIONS).encode(), word]
    verb = chosen.choice((("simulate", "-c", CONFIGS / "hil.toml", "--experiment", trial.programs.experiment),
                          ("config", "check", CONFIGS / "hil.toml"), ("modes", "-c", CONFIGS / "hil.toml"),
                          ("info", trial.programs.run), ("design", "-c", CONFIGS / "hil.toml"),
                          ("status", "--socket", odd[3]), ()))
    trial.keep(trial.programs.run)
    trial.flexarm(*[part if isinstance(part, bytes) else str(part).encode() for part in verb], *words)


KINDS = {
    "config-structure": config_structure,
    "config-numbers": config_numbers,
    "config-accepted": config_accepted,
    "special-files": special_files,
    "experiment-structure": experiment_structure,
    "experiment-numbers": experiment_numbers,
    "trajectory": trajectory,
    "csv": csv_of_a_run,
    "gains": gains,
    "calibration": calibration,
    "arguments": arguments,
}
