"""Bad assembly files: what is wrong, the text it replaces, the wrong text, the whole message."""

from support.formats.format_samples import ASSEMBLY

ASSEMBLY_CASES = [
    (
        "an unknown key",
        "payload:",
        "paylod:",
        (
            'r.yaml:8: unknown key "paylod"; did you mean "payload"? known: modrobust, '
            "robot, source, notes, modules, base, gravity, chain, urdf, base_link, tip_link, lock, "
            "links, joints, tolerance, xacro, packages, payload, payloads, disturbance, "
            "controller, loop, trajectory, initial, "
            "scenarios"
        ),
    ),
    (
        "a module in place of an assembly",
        "robot: r",
        "module: r",
        (
            'r.yaml:2: module: a module file; an assembly file has "robot:"; give the '
            "other kind of file"
        ),
    ),
    (
        "a robot named unlike its file",
        "robot: r",
        "robot: lwa4p",
        (
            'r.yaml:2: robot: "lwa4p" in a file named "r.yaml"; the name is the file\'s '
            "name without its suffix; write r or rename the file"
        ),
    ),
    (
        "a directory that is not there",
        "modules: .",
        "modules: [., nowhere]",
        (
            'r.yaml:3: modules: no directory "nowhere"; directories are relative to this '
            "file; make it or name another"
        ),
    ),
    (
        "an entry that is no name",
        "- arm",
        "- 3.5",
        (
            'r.yaml:6: chain[0]: "3.5" is not a name; names are letters, digits, _ and -, '
            "at most 100; rename it"
        ),
    ),
    (
        "an entry that is a list",
        "- arm",
        "- [arm]",
        (
            "r.yaml:6: chain[0]: a list; a mapping is expected; write its keys: module, "
            "as, mount, set"
        ),
    ),
    (
        "an empty chain",
        ASSEMBLY[ASSEMBLY.index("chain:") :],
        "chain: []\n",
        "r.yaml:5: chain: an empty list; a robot has at least one module; add one",
    ),
    (
        "a key of an entry that is unknown",
        "mount: 90 deg",
        "mont: 90 deg",
        (
            'r.yaml:7: chain[1]: unknown key "mont"; did you mean "mount"? known: module, '
            "as, mount, set"
        ),
    ),
    (
        "a mount of many turns",
        "mount: 90 deg",
        "mount: 1e300",
        "r.yaml:7: chain[1].mount: 1e+300 rad; an angle lies within 100000 rad; reduce it by "
        "whole turns",
    ),
    (
        "a mount in metres",
        "mount: 90 deg",
        "mount: 90 mm",
        (
            'r.yaml:7: chain[1].mount: "90 mm" has the unit "mm"; an angle [rad] is '
            "expected; write it in rad"
        ),
    ),
    (
        "a gravity of two numbers",
        "gravity: [0, 0, -9.81 m/s^2]",
        "gravity: [0, -9.81]",
        "r.yaml:4: gravity: a list of 2; a vector is a list of three; write [x, y, z]",
    ),
    (
        "a gravity in another unit",
        "-9.81 m/s^2",
        "-9.81 m/s",
        (
            'r.yaml:4: gravity[2]: "-9.81 m/s" has the unit "m/s"; an acceleration [m/s^2] '
            "is expected; write it in m/s^2"
        ),
    ),
    (
        "a payload without mass",
        "mass: [0 kg, 2 kg], ",
        "",
        'r.yaml:8: payload: no "mass"; this key is required; add mass',
    ),
    (
        "a payload with size and inertia",
        "com: [0",
        "size: [1, 1, 1], inertia: {xx: 1, yy: 1, zz: 1}, com: [0",
        ("r.yaml:8: payload: inertia and size; a payload has one of them; remove the other"),
    ),
    (
        "a payload without extent",
        "com: [0",
        "size: [1, 1, 0], com: [0",
        (
            "r.yaml:8: payload.size[2]: 0 m is not positive; the edge of a box is above 0, "
            "its lower bound too; write a positive length"
        ),
    ),
    (
        "a list per joint",
        "disturbance: [-1 N m, 1 N m]",
        "disturbance: [1, 2, 3]",
        (
            "r.yaml:9: disturbance: a list of 3; a value per joint is one quantity for all "
            "joints or a mapping by joint name, never a list; write joint: value for each "
            "joint"
        ),
    ),
    (
        "a mass for a torque",
        "disturbance: [-1 N m, 1 N m]",
        "disturbance: 5 kg",
        (
            'r.yaml:9: disturbance: "5 kg" has the unit "kg"; a torque [N m] or a force '
            "[N] is expected; write it in N m or N"
        ),
    ),
    (
        "an empty mapping per joint",
        "disturbance: [-1 N m, 1 N m]",
        "disturbance: {}",
        ("r.yaml:9: disturbance: nothing; a mapping names every joint; write joint: value"),
    ),
    (
        "a list of gains",
        "K_r: 10",
        "K_r: [1, 2]",
        (
            "r.yaml:10: controller.K_r: a list of 2; a value per joint is one quantity for "
            "all joints or a mapping by joint name, never a list; write joint: value for "
            "each joint"
        ),
    ),
    (
        "a negative gain",
        "K_r: 10",
        "K_r: -1",
        "r.yaml:10: controller.K_r: -1 is not positive; it must be above 0; write a positive "
        "number",
    ),
    (
        "a negative integrator gain",
        "kappa_P: 2",
        "kappa_P: -2",
        "r.yaml:10: controller.kappa_P: -2 is negative; it is at least 0; write 0 or more",
    ),
    (
        "a law that is none",
        "law: norm",
        "law: form",
        (
            'r.yaml:10: controller.law: "form" is not allowed here; did you mean "norm"? known: '
            "norm, componentwise, sampled, auto"
        ),
    ),
    (
        "an epsilon of zero",
        "epsilon: 0.01 rad",
        "epsilon: 0 rad",
        (
            "r.yaml:10: controller.epsilon: 0 is not positive; it must be above 0; write a "
            "positive number"
        ),
    ),
    (
        "a trajectory of unknown kind",
        "kind: sines",
        "kind: sine",
        (
            'r.yaml:11: trajectory: "sine" is no kind of trajectory; did you mean "sines"? '
            "known: sines, quintic, csv"
        ),
    ),
    (
        "a trajectory without kind",
        "kind: sines, ",
        "",
        (
            'r.yaml:11: trajectory: no "kind"; a trajectory is a mapping with kind: one of '
            "sines, quintic, csv; add it"
        ),
    ),
    (
        "a negative duration",
        "duration: 10 s",
        "duration: -10 s",
        (
            "r.yaml:11: trajectory.duration: -10 is not positive; it must be above 0; write "
            "a positive number"
        ),
    ),
    (
        "sines without frequency",
        "omega: [pi/5 rad/s]",
        "omega: []",
        "r.yaml:11: trajectory.omega: an empty list; sines need a frequency; add one",
    ),
    (
        "bounds on an amplitude",
        "amplitude: pi/2",
        "amplitude: pi/2 ± 1%",
        (
            'r.yaml:11: trajectory.amplitude: "pi/2 ± 1%" has bounds; this field takes '
            "none; remove them"
        ),
    ),
    (
        "waypoints out of order",
        "kind: sines, amplitude: pi/2, omega: [pi/5 rad/s]",
        "kind: quintic, points: [{at: 1 s, q: 0}, {at: 1 s, q: 1}]",
        ("r.yaml:11: trajectory.points[1].at: 1 s after 1 s; times increase; order the points"),
    ),
    (
        "one waypoint",
        "kind: sines, amplitude: pi/2, omega: [pi/5 rad/s]",
        "kind: quintic, points: [{at: 1 s, q: 0}]",
        "r.yaml:11: trajectory.points: 1 point; a motion has at least two; add one",
    ),
    (
        "a start in kilograms",
        "arm.axis: 0 rad",
        "arm.axis: 0 kg",
        (
            'r.yaml:12: initial.q.arm.axis: "0 kg" has the unit "kg"; an angle [rad] or a '
            "length [m] is expected; write it in rad or m"
        ),
    ),
    (
        "a scenario with an unknown key",
        "set: {arm",
        "sets: {arm",
        ('r.yaml:13: scenarios.heavy: unknown key "sets"; did you mean "set"? known: set, notes'),
    ),
]
