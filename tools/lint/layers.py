"""The folders of the source tree, the lowest first, and the folders that each may include.

A folder may name only folders that stand above it here: so there is no cycle. check_layers.py
checks that the code includes no more than this, and no less.
"""

LAYERS = {
    "model": "",
    "model/math": "",
    "model/parameters": "model",
    "model/beam": "model model/math model/parameters",
    "model/beam_methods": "model model/math model/parameters model/beam",
    "model/arm": "model model/math model/parameters model/beam",
    "model/simulation": "model/math model/arm",
    "model/perturbation": "model/math model/arm model/simulation",
    "model/reduction": "model/math model/arm",
    "model/rigid_joint": "model/math model/parameters model/arm model/simulation",
    "hal": "model",
    "hal/sim": "model model/parameters model/arm model/simulation model/rigid_joint hal",
    "hal/canopen": "model hal",
    "hal/modbus": "model hal",
    "hal/comedi": "model hal",
    "hal/gpiod": "model hal",
    "hal/wired": "model hal hal/gpiod",
    "hal/emulation": "hal hal/sim hal/canopen hal/modbus hal/wired",
    "estimator": "model model/math model/parameters model/beam model/arm model/rigid_joint hal",
    "controller/files": "",
    "controller/exchange": "",
    "controller/realtime": "hal controller/exchange",
    "controller/types": "model model/parameters model/arm model/rigid_joint hal hal/sim hal/wired "
                        "estimator controller/exchange",
    "controller/safety": "hal controller/types",
    "controller/law": "model/math model/rigid_joint estimator controller/types",
    "controller/reference": "model model/rigid_joint estimator controller/types "
                            "controller/law",
    "controller/planner": "model/math model/rigid_joint controller/types controller/law",
    "controller/design": "model model/math model/arm model/rigid_joint estimator controller/types "
                         "controller/law controller/files",
    "controller/step": "model model/rigid_joint hal estimator controller/types controller/law",
    "controller/runlog": "model model/beam hal estimator controller/exchange "
                         "controller/realtime controller/types controller/safety controller/files",
    "controller/tasks": "hal hal/sim controller/exchange controller/realtime controller/types "
                        "controller/safety controller/law controller/reference "
                        "controller/planner controller/step",
    "controller/latch": "controller/files controller/types controller/runlog",
    "controller/telemetry": "model hal estimator controller/exchange controller/realtime "
                            "controller/types controller/runlog",
    "controller/commissioning": "model model/parameters model/arm model/simulation hal estimator "
                                "controller/types controller/runlog controller/tasks controller/files",
    "controller/health": "model model/math model/parameters model/arm model/simulation hal "
                         "estimator controller/files controller/exchange controller/types "
                         "controller/step",
    "controller/operator": "model hal hal/gpiod estimator controller/files controller/realtime controller/reference "
                           "controller/types "
                           "controller/runlog controller/tasks controller/latch "
                           "controller/commissioning",
    "controller/host": "model model/beam hal/sim estimator controller/step controller/files hal/canopen hal/modbus hal/comedi hal/wired controller/realtime controller/types "
                       "controller/law controller/design controller/runlog controller/tasks "
                       "controller/latch controller/telemetry controller/health controller/operator",
    "config/derivation": "model model/beam model/parameters hal estimator",
    "config": "model model/parameters hal hal/canopen hal/modbus hal/comedi hal/wired estimator controller/files "
              "controller/types controller/runlog config/derivation",
    "config/new_rig": "config config/derivation model",
    "config/plausibility": "model model/arm model/parameters hal estimator controller/types",
    "tools/support": "",
    "tools/html": "",
    "tools/replay": "estimator controller/types controller/law controller/design controller/step "
                    "controller/runlog",
    "tools/runs": "controller/runlog controller/safety config",
    "tools/plot": "model model/beam hal controller/types controller/files controller/runlog "
                  "controller/safety tools/html tools/runs",
    "tools/trip_report": "model hal controller/realtime controller/types controller/files "
                         "controller/runlog controller/operator controller/host config "
                         "tools/html tools/replay tools/runs tools/plot",
    "tools/mat": "controller/runlog",
    "tools/csv": "model model/math model/beam estimator controller/files controller/types "
                 "controller/design controller/step controller/runlog controller/commissioning "
                 "controller/host config tools/runs",
    "tools/health": "controller/files controller/health controller/runlog config tools/runs",
    "tools/command_line": "controller/files controller/types controller/runlog config",
    "tools/status": "model",
    "tools/advice": "controller/types controller/operator",
    "tools/daemon_client": "model controller/runlog controller/operator config "
                           "tools/command_line tools/status",
    "tools/dashboard": "controller/files controller/types controller/runlog controller/operator "
                       "config tools/status tools/advice tools/daemon_client",
    "tools/analysis": "model model/math model/parameters model/beam model/beam_methods model/arm "
                      "model/simulation model/perturbation model/reduction controller/files config tools/support "
                      "tools/runs tools/plot",
    "tools/bound": "model model/math model/rigid_joint estimator controller/types",
    "tools/sweep": "model model/rigid_joint hal controller/types controller/runlog controller/host "
                   "config config/derivation tools/support tools/runs tools/plot tools/bound controller/files",
    "tools/torture": "model model/rigid_joint estimator hal hal/sim controller/realtime controller/types "
                     "controller/files tools/runs "
                     "controller/safety controller/law controller/step controller/runlog controller/tasks controller/latch "
                     "controller/operator controller/design controller/host config tools/support tools/sweep",
    "tools/bench_host": "model/arm model/simulation controller/files controller/types "
                        "controller/law controller/planner controller/design controller/step "
                        "controller/runlog controller/tasks controller/host config tools/support tools/sweep",
    "tools/tuning": "model model/beam estimator controller/types controller/design controller/host config config/new_rig tools/sweep",
    "tools/benchmark": "controller/types controller/runlog config tools/runs tools/plot tools/sweep",
    "tools/identification": "model model/math model/arm model/simulation hal estimator "
                            "controller/types controller/runlog config tools/support tools/runs "
                            "tools/plot controller/files",
    "tools/thesis": "model model/math model/beam_methods model/arm model/simulation "
                    "model/perturbation model/reduction controller/types controller/law "
                    "controller/design controller/host config tools/support tools/analysis "
                    "tools/sweep",
    "tools/report": "model model/beam model/arm model/simulation model/perturbation estimator "
                    "controller/types controller/runlog controller/host config "
                    "tools/support tools/html tools/plot tools/analysis tools/benchmark "
                    "tools/sweep tools/thesis controller/files",
    "tools/flexarm": "model model/math model/arm estimator hal/gpiod hal/wired hal/emulation controller/realtime "
                     "controller/types controller/safety controller/law controller/design "
                     "controller/runlog "
                     "controller/operator controller/host config config/new_rig config/plausibility tools/tuning "
                     "tools/support tools/replay tools/runs tools/plot tools/trip_report tools/health tools/csv tools/command_line tools/status tools/advice tools/daemon_client controller/files",
    "tools/flexarm_study": "model model/math model/beam model/beam_methods model/arm "
                           "model/simulation model/perturbation controller/runlog config tools/support tools/runs "
                           "tools/command_line tools/analysis tools/sweep tools/benchmark "
                           "tools/identification tools/thesis tools/report controller/files tools/plot "
                           "controller/types controller/commissioning tools/bound tools/torture tools/bench_host "
                           "tools/mat",
    "tools/flexarm_web": "controller/files tools/command_line tools/daemon_client tools/dashboard",
    "tools/flexarmd": "hal controller/realtime controller/types controller/runlog controller/host "
                      "config controller/files tools/command_line tools/trip_report",
}
LAYERS = {folder: uses.split() for folder, uses in LAYERS.items()}

# Code that runs on the safety, control, bus and plant threads: no I/O, lock, clock or log by name.
# Drivers call their bus through its library, on threads of their own.
REALTIME = {
    "model", "model/math", "model/beam", "model/arm", "model/simulation",
    "model/rigid_joint", "hal", "hal/sim", "hal/canopen", "hal/modbus", "hal/comedi", "hal/gpiod",
    "estimator", "controller/exchange", "controller/types", "controller/safety", "controller/law",
    "controller/reference", "controller/planner", "controller/step", "controller/tasks",
}

# What ControlStep::Step, the planner and the safety machine run, too: no heap, and + - * / and sqrt
# in place of libm, whose sin and exp differ between machines. A line of start-up code says so:
# `// start-up`.
STEP = {
    "model/rigid_joint", "estimator", "controller/exchange", "controller/safety", "controller/law",
    "controller/planner", "controller/step",
}
