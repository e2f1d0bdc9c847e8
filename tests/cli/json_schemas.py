"""JSON Schemas of what the commands print with ``--json``: every key, and no other."""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]

TEXT: Schema = {"type": "string"}
FLAG: Schema = {"type": "boolean"}
NUMBER: Schema = {"type": "number"}
COUNT: Schema = {"type": "integer", "minimum": 0}
INDEX: Schema = {"type": "integer", "minimum": -1}
SIZE: Schema = {"type": "number", "minimum": 0}


def array(items: Schema, least: int = 0) -> Schema:
    return {"type": "array", "items": items, "minItems": least}


def exactly(*words: str) -> Schema:
    return {"enum": list(words)}


def optional(schema: Schema) -> Schema:
    return {"anyOf": [schema, {"type": "null"}]}


def record(properties: dict[str, Schema], absent: tuple[str, ...] = ()) -> Schema:
    """An object with these keys and no others; all but those of `absent` are always there."""
    return {
        "type": "object",
        "properties": properties,
        "required": [key for key in properties if key not in absent],
        "additionalProperties": False,
    }


def matrix(rows: int, columns: int) -> Schema:
    return {**array({**array(NUMBER, columns), "maxItems": columns}, rows), "maxItems": rows}


def bounded(shape: Schema) -> Schema:
    return record({"nominal": shape, "lo": shape, "hi": shape})


NUMBERS = array(NUMBER)
POINT = {**array(NUMBER, 3), "maxItems": 3}
PLACE = matrix(4, 4)
TIMES = record(dict.fromkeys(("mean", "max", "std", "p50", "p99", "min"), optional(SIZE)))

ASSEMBLE = record(
    {
        "robot": TEXT,
        "version": COUNT,
        "gravity": POINT,
        "base": PLACE,
        "joints": array(
            record(
                {
                    "name": TEXT,
                    "type": exactly("revolute", "continuous", "prismatic"),
                    "parent": INDEX,
                    "before": PLACE,
                    "after": PLACE,
                    "limits": record(
                        {
                            "position": optional({**array(NUMBER, 2), "maxItems": 2}),
                            "velocity": optional(NUMBER),
                            "effort": optional(NUMBER),
                            "acceleration": optional(NUMBER),
                        }
                    ),
                    "mimic": record({"joint": INDEX, "multiplier": NUMBER, "offset": NUMBER}),
                    "drive": record({"gear_ratio": NUMBER, "rotor_inertia": bounded(NUMBER)}),
                    "friction": record(
                        {
                            "viscous": bounded(NUMBER),
                            "coulomb": bounded(NUMBER),
                            "coulomb_speed": NUMBER,
                        }
                    ),
                },
                absent=("mimic",),
            )
        ),
        "bodies": array(
            record(
                {
                    "name": TEXT,
                    "joint": INDEX,
                    "placement": PLACE,
                    "mass": bounded(NUMBER),
                    "com": bounded(POINT),
                    "inertia_about": exactly("com", "frame"),
                    "inertia": bounded(matrix(3, 3)),
                }
            )
        ),
        "disturbance": array(bounded(NUMBER)),
        "dh": optional(
            record(
                {
                    "base": PLACE,
                    "tool": PLACE,
                    "rows": array(
                        record(
                            {
                                **dict.fromkeys(("a", "alpha", "d", "theta"), NUMBER),
                                "near_parallel": FLAG,
                            }
                        )
                    ),
                }
            )
        ),
        "exact": array(TEXT),
        "not_modelled": array(TEXT),
        "unphysical": array(record({"body": TEXT, "excess": optional(SIZE)})),
    }
)

DIVERGENCE = record(
    {
        "joint": optional(TEXT),
        "kind": optional(exactly("revolute", "continuous", "prismatic")),
        "hold": SIZE,
        **dict.fromkeys(("t", "gain", "inertia", "share", "rate"), optional(SIZE)),
        "law": exactly("norm", "componentwise", "sampled"),
        "cause": TEXT,
        "remedy": TEXT,
    }
)

LOOP = record(
    {
        **dict.fromkeys(("rate", "delay", "filter", "frequency"), SIZE),
        **dict.fromkeys(("noise_position", "noise_velocity"), array(SIZE)),
        **dict.fromkeys(("quantisation_position", "quantisation_velocity"), array(SIZE)),
        "noise": exactly("uniform", "worst"),
        "velocity": exactly("measured", "differentiated"),
        "saturation": FLAG,
        "disturbance": exactly("constant", "sine", "random", "worst"),
    }
)

DESIGN = record(
    {
        "robot": TEXT,
        "motion": TEXT,
        "loop": LOOP,
        "gains": record(
            {
                "law": exactly("sampled"),
                **dict.fromkeys(("G", "Lambda", "L_i", "blend", "epsilon"), SIZE),
            }
        ),
        "bounds": record(
            {
                "G_stab": SIZE,
                "G_noise": optional(SIZE),
                "G_eps": SIZE,
                "binding": exactly("stability", "noise", "epsilon", "floor"),
            }
        ),
        "reachable": FLAG,
        "epsilon_reached": SIZE,
        "spectra": record({"pi": array(SIZE, 2), "c": array(SIZE, 2), "xi": SIZE}),
        "need": record(dict.fromkeys(("parameters", "friction", "disturbance", "total"), SIZE)),
        "expected": {"type": "object", "additionalProperties": SIZE},
        "error": SIZE,
        "remarks": array(TEXT),
        "helps": array(record({"change": TEXT, "epsilon": SIZE, "G": SIZE})),
    },
    absent=("helps",),
)

SETTINGS = record(
    {
        "robot": TEXT,
        "scenario": optional(TEXT),
        "parameters": exactly(
            *("nominal", "lower", "upper", "corner", "random", "given", "scenario")
        ),
        "seed": COUNT,
        "K_r": NUMBERS,
        "law": exactly("norm", "componentwise", "sampled"),
        "bound": exactly("hull", "ianea"),
        **dict.fromkeys(("kappa_P", "kappa_I", "phi_P", "phi_I", "epsilon", "leak"), SIZE),
        **dict.fromkeys(("kappa_max", "phi_max", "G", "Lambda", "L_i"), optional(SIZE)),
        "blend": SIZE,
        **dict.fromkeys(("hold_aware", "integral", "predictor", "vector_saturation"), FLAG),
        "trajectory": {
            "anyOf": [
                record({"kind": exactly("sines"), "amplitude": NUMBERS, "omega": NUMBERS}),
                record({"kind": exactly("quintic", "csv"), "source": TEXT}),
                record(
                    {"kind": exactly("quintic", "csv"), "times": NUMBERS, "points": array(NUMBERS)}
                ),
            ]
        },
        "motion_time": optional(SIZE),
        "motion_remarks": array(TEXT),
        "duration": SIZE,
        "loop": LOOP,
        "rate_needed": optional(SIZE),
        "rate_warning": optional(TEXT),
        "design": optional({"type": "object"}),  # its keys are those of the command design
        "substeps": COUNT,
        "integrator": TEXT,
        "plant": exactly("builtin", "mujoco", "pinocchio"),
        "log_step": SIZE,
        "q0": NUMBERS,
        "dq0": NUMBERS,
        "disturbance": NUMBERS,
        "parameters_inside_bounds": FLAG,
        "scaled_to_physical": array(TEXT),
    }
)

SIMULATE = record(
    {
        "violations": COUNT,
        "violation_max": optional(SIZE),
        "diverged": FLAG,
        "divergence": optional(DIVERGENCE),
        "epsilon_entered_at": optional(SIZE),
        "cut_short": FLAG,
        "error_final": optional(SIZE),
        "error_max_after_entry": optional(SIZE),
        "tau_max": optional(array(optional(SIZE))),
        "tau_limit": array(optional(SIZE)),
        "rho_mean": optional(SIZE),
        "rho_max": optional(SIZE),
        **dict.fromkeys(("width_hull", "width_ianea", "ianea_over_hull"), array(optional(SIZE))),
        "chattering": optional(array(optional(SIZE))),
        "chattering_limit": optional(SIZE),
        "limited": COUNT,
        "ticks_at_limit": optional(array(SIZE)),
        "command_time": TIMES,
        "ticks": COUNT,
        "time": SIZE,
        "interrupted": FLAG,
        "uncertain": FLAG,
        "ok": FLAG,
        "reasons": array(TEXT),
        "remarks": array(TEXT),
        "joints": array(TEXT, 1),
        "settings": SETTINGS,
    }
)

_WIDTHS = array(optional(SIZE))
BENCH = record(
    {
        "robots": array(
            record(
                {
                    "robot": TEXT,
                    "joints": array(TEXT, 1),
                    "times": array(
                        record(
                            {
                                "bound": exactly("hull", "ianea"),
                                "commands": COUNT,
                                "in_c": TIMES,
                                "in_python": TIMES,
                            }
                        )
                    ),
                    "laws": {"type": "object", "additionalProperties": TIMES},
                    "tightness": array(
                        record(
                            {
                                "where": TEXT,
                                "states": COUNT,
                                **dict.fromkeys(("width_found", "width_hull"), _WIDTHS),
                                "width_ianea": _WIDTHS,
                                "hull_over_found": _WIDTHS,
                                "ianea_over_hull": _WIDTHS,
                                "ianea_over_hull_median": _WIDTHS,
                            }
                        )
                    ),
                }
            )
        ),
        "growth": array(
            record(
                {
                    "bound": exactly("hull", "ianea"),
                    "joints": array(COUNT),
                    "seconds": array(SIZE),
                    "exponent": optional(NUMBER),
                    "fitted_from": COUNT,
                }
            )
        ),
        "paper": record(
            {
                "robot": TEXT,
                "times": record(dict.fromkeys(("mean", "max", "std"), SIZE)),
                "source": TEXT,
            }
        ),
        "interrupted": FLAG,
    }
)  # fmt: skip

PEERS = array(
    record(
        {
            "robot": TEXT,
            "joints": COUNT,
            "peers": array(
                record(
                    {
                        "peer": TEXT,
                        "title": TEXT,
                        "reference": TEXT,
                        "disagreement": optional(SIZE),
                        "remarks": array(TEXT),
                        "subjects": array(
                            record(
                                {
                                    "name": TEXT,
                                    "minimum": SIZE,
                                    "median": SIZE,
                                    "ratio_of_minima": SIZE,
                                    "ratio_of_medians": SIZE,
                                    "rounds": COUNT,
                                    "alone": optional(record({"calls": TIMES, "states": TIMES})),
                                }
                            )
                        ),
                    }
                )
            ),
            "absent": {"type": "object", "additionalProperties": TEXT},
            "interrupted": FLAG,
        }
    )
)

CONNECTOR = record(
    {
        "type": TEXT,
        "size": optional(TEXT),
        "gender": optional(TEXT),
        "clocking": optional(NUMBER),
    }
)
MODULES = array(
    record(
        {
            "module": TEXT,
            "name": TEXT,
            "product": FLAG,
            "source": array(TEXT),
            "licence": optional(TEXT),
            "joints": array(
                record({"name": TEXT, "type": exactly("revolute", "continuous", "prismatic")})
            ),
            "in": optional(CONNECTOR),
            "out": optional(CONNECTOR),
            "mounts": array(TEXT),
        }
    )
)

IMPORT_TIMOR = record(
    {"written": array(TEXT), "left_out": array(record({"module": TEXT, "why": TEXT}))}
)

SCHEMAS: dict[str, Schema] = {
    "assemble": ASSEMBLE,
    "simulate": SIMULATE,
    "bench": BENCH,
    "bench --peers": PEERS,
    "modules": MODULES,
    "import-timor": IMPORT_TIMOR,
}


def keys(schema: Any) -> set[str]:
    """Every key that a schema names, at any depth."""
    if isinstance(schema, list):
        return set().union(*map(keys, schema))
    if not isinstance(schema, dict):
        return set()
    own = set(schema.get("properties", {}))
    return own.union(*map(keys, schema.get("properties", {}).values()), *(
        keys(schema[word]) for word in ("items", "anyOf") if word in schema
    ))  # fmt: skip
