"""A robot described in Python, without files: two joints, bounds, and what they cost in torque.

The words are those of the files (docs/reference/formats.md). A number is in SI units; a text may
have a unit, a tolerance or bounds.
"""

import modrobust as mr

chain: list[str | dict[str, object]] = [
    {"joint": "shoulder", "type": "revolute", "limits": {"torque": 60}},
    {
        "body": "upper-arm",
        "span": {"xyz": [0.4, 0, 0]},
        "mass": "3 kg ± 5%",
        "com": ["0.2 m ± 5 mm", 0, 0],
        "inertia": {"xx": 0.004, "yy": "0.04 ± 10%", "zz": "0.04 ± 10%"},
    },
    {"joint": "elbow", "type": "revolute", "limits": {"torque": 30}},
    {
        "body": "forearm",
        "span": {"xyz": [0.3, 0, 0]},
        "mass": [1.4, 1.6],  # [kg], bounds
        "com": [0.15, 0, 0],
        "inertia": {"xx": 0.001, "yy": 0.012, "zz": 0.012},
    },
]
robot = mr.build_robot(
    "planar",
    chain,
    base={"rpy": ["90 deg", 0, 0]},  # the axes are level: the arm moves in a vertical plane
    payload={"mass": ["0 kg", "0.5 kg"], "com": [0, 0, 0]},
    controller={"K_r": 10},
)

lo, hi = mr.inverse_dynamics_bounds(robot, [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0])
for name, low, high, limit in zip(robot.joint_names, lo, hi, robot.effort_limits, strict=True):
    print(f"{name:>8}: holding takes {low:.2f} to {high:.2f} N m of {limit:g}")
