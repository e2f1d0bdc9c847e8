"""Bad module files: what is wrong, the text it replaces, the wrong text, the whole message."""

from support.formats.format_samples import MODULE

MODULE_CASES = [
    (
        "an unknown key",
        "mass: 2 kg",
        "masss: 2 kg",
        (
            'arm.yaml:18: body link: unknown key "masss"; did you mean "mass"? known: '
            "body, span, expressed_in, mass, com, inertia"
        ),
    ),
    (
        "an unknown key like no other",
        "mass: 2 kg",
        "mass: 2 kg\n    colour: red",
        (
            'arm.yaml:19: body link: unknown key "colour"; known: body, span, '
            "expressed_in, mass, com, inertia"
        ),
    ),
    (
        "a missing key",
        "    mass: 2 kg\n",
        "",
        'arm.yaml:16: body link: no "mass"; this key is required; add mass',
    ),
    (
        "an empty value",
        "mass: 2 kg",
        "mass:",
        (
            "arm.yaml:18: body link, mass: nothing is written; a number is expected; write "
            'one such as "1.5 kg"'
        ),
    ),
    (
        "a unit of another dimension",
        "mass: 2 kg",
        "mass: 2 m",
        (
            'arm.yaml:18: body link, mass: "2 m" has the unit "m"; a mass [kg] is '
            "expected; write it in kg"
        ),
    ),
    (
        "an unknown unit",
        "mass: 2 kg",
        "mass: 2 kgm",
        (
            'arm.yaml:18: body link, mass: "2 kgm": unknown unit "kgm"; did you mean "kg"? '
            "known: m, mm, cm, kg, g, s, ms, min, rad, deg, rpm, N, Nm, Hz, kHz, MHz and their "
            "products"
        ),
    ),
    (
        "a unit that is no product",
        "mass: 2 kg",
        "mass: 2 kg/",
        (
            'arm.yaml:18: body link, mass: "2 kg/": "kg/" is not a unit; units are '
            'products such as "kg m^2" or "N m s/rad", where "/" applies to the next '
            "factor only"
        ),
    ),
    (
        "a list as a unit power",
        "xx: 0.02",
        "xx: 0.02 kg m^99",
        (
            'arm.yaml:20: body link, inertia.xx: "0.02 kg m^99": "kg m^99" has the power '
            "99; powers go up to 6; lower it"
        ),
    ),
    (
        "text for a number",
        "mass: 2 kg",
        "mass: heavy",
        (
            'arm.yaml:18: body link, mass: "heavy" is not a number; a quantity is NUMBER '
            '[UNIT] such as "101.3 mm", "5e-5 kg m^2" or "3.9 kg ± 2%"; write it so'
        ),
    ),
    (
        "NaN",
        "mass: 2 kg",
        "mass: .nan",
        (
            'arm.yaml:18: body link, mass: ".nan" is not a number; numbers are finite; '
            "write a finite number"
        ),
    ),
    (
        "an infinite number",
        "mass: 2 kg",
        "mass: -.inf",
        (
            'arm.yaml:18: body link, mass: "-.inf" is infinite; numbers are finite; write '
            "a finite number"
        ),
    ),
    (
        "an absurd exponent",
        "mass: 2 kg",
        "mass: 1e999999999",
        (
            'arm.yaml:18: body link, mass: "1e999999999" is out of range; exponents lie '
            "between -300 and 300; check the exponent"
        ),
    ),
    (
        "a number too large",
        "mass: 2 kg",
        "mass: " + "9" * 100 + "e299",
        (
            "arm.yaml:18: body link, mass: too large; numbers stay below 1.79e308 in SI "
            "units; check its exponent"
        ),
    ),
    (
        "a number of many digits",
        "mass: 2 kg",
        "mass: " + "1" * 1000,
        (
            "arm.yaml:18: body link, mass: a number of 1000 characters; a number has at "
            "most 400; shorten it"
        ),
    ),
    (
        "a sexagesimal number",
        "gear_ratio: 100",
        "gear_ratio: 160:1",
        (
            'arm.yaml:14: joint axis, drive.gear_ratio: "160:1": ":1" is not a unit; units '
            'are products such as "kg m^2" or "N m s/rad", where "/" applies to the next '
            "factor only"
        ),
    ),
    (
        "a product without pi",
        "mass: 2 kg",
        "mass: 1/2",
        (
            'arm.yaml:18: body link, mass: "1/2" is a product; only products with pi are '
            "read; write a decimal number"
        ),
    ),
    (
        "pi in a mass",
        "mass: 2 kg",
        "mass: pi kg",
        (
            'arm.yaml:18: body link, mass: "pi kg" uses pi; pi is for angles in rad; write '
            "a decimal number"
        ),
    ),
    (
        "a division by zero",
        "alpha: pi/2",
        "alpha: pi/0",
        (
            'arm.yaml:17: body link, span.dh.alpha: "pi/0" divides by 0; a number is '
            "finite; divide by another"
        ),
    ),
    (
        "an angle for a length",
        "a: 0.3 m",
        "a: 90 deg",
        (
            'arm.yaml:17: body link, span.dh.a: "90 deg" has the unit "deg"; a length [m] '
            "is expected; write it in m"
        ),
    ),
    (
        "an angle that no robot has",
        "alpha: pi/2",
        "alpha: 1e7 deg",
        (
            "arm.yaml:17: body link, span.dh.alpha: 174533 rad; an angle lies within 100000 rad; "
            "reduce it by whole turns"
        ),
    ),
    (
        "a length for an angle",
        "alpha: pi/2",
        "alpha: 1 m",
        (
            'arm.yaml:17: body link, span.dh.alpha: "1 m" has the unit "m"; an angle [rad] '
            "is expected; write it in rad"
        ),
    ),
    (
        "a stiffness for a torque",
        "torque: 5 N m",
        "torque: 5 N m/rad",
        (
            'arm.yaml:13: joint axis, limits.torque: "5 N m/rad" has the unit "N m/rad"; a '
            "torque [N m] is expected; write it in N m"
        ),
    ),
    (
        "bounds in reverse",
        "mass: 2 kg",
        "mass: [3 kg, 1 kg]",
        (
            "arm.yaml:18: body link, mass: lower bound 3 above upper bound 1; bounds are "
            "[lo, hi]; exchange them"
        ),
    ),
    (
        "a nominal value outside its bounds",
        "mass: 2 kg",
        "mass: {nominal: 4 kg, lo: 1 kg, hi: 3 kg}",
        (
            "arm.yaml:18: body link, mass: nominal 4 outside its bounds [1, 3]; the "
            "nominal value lies inside; widen the bounds or correct it"
        ),
    ),
    (
        "bounds without one end",
        "mass: 2 kg",
        "mass: {nominal: 2 kg, lo: 1 kg}",
        'arm.yaml:18: body link, mass: no "hi"; bounds are {nominal, lo, hi}; add hi',
    ),
    (
        "bounds with a wrong key",
        "mass: 2 kg",
        "mass: {nominal: 2 kg, low: 1 kg, hi: 3 kg}",
        (
            'arm.yaml:18: body link, mass: unknown key "low"; did you mean "lo"? known: '
            "nominal, lo, hi"
        ),
    ),
    (
        "bounds of three numbers",
        "mass: 2 kg",
        "mass: [1 kg, 2 kg, 3 kg]",
        ("arm.yaml:18: body link, mass: a list of 3; bounds are a list of two; write [lo, hi]"),
    ),
    (
        "a list as a bound",
        "mass: 2 kg",
        "mass: [[1 kg], 2 kg]",
        (
            "arm.yaml:18: body link, mass[0]: a list; one number is expected here; write "
            '"NUMBER UNIT"'
        ),
    ),
    (
        "two tolerances on one number",
        "mass: 2 kg",
        "mass: 2 kg ± 1 kg ± 1 kg",
        (
            'arm.yaml:18: body link, mass: "2 kg ± 1 kg ± 1 kg" has two bounds; a quantity '
            "has one ±; keep one of them"
        ),
    ),
    (
        "a negative tolerance",
        "mass: 2 kg",
        "mass: 2 kg ± -1 kg",
        (
            'arm.yaml:18: body link, mass: "2 kg ± -1 kg" has a negative width; ± is '
            "positive; remove the -"
        ),
    ),
    (
        "a negative percentage",
        "mass: 2 kg",
        "mass: 2 kg ± -1%",
        (
            'arm.yaml:18: body link, mass: "2 kg ± -1%" has a negative width; ± is '
            "positive; remove the -"
        ),
    ),
    (
        "a percentage of zero",
        "com: [0.1 m, 0, 0]",
        "com: [0.1 m, 0 ± 5%, 0]",
        (
            "arm.yaml:19: body link, com[1]: a per cent of 0; that leaves no width; write "
            "an absolute bound such as ± 0.001 with its unit"
        ),
    ),
    (
        "a tolerance in per cent of zero",
        "tolerance: {mass: 2%}",
        "tolerance: {com: 2%}",
        (
            "arm.yaml:19: body link, com[1]: tolerance.com is a per cent and this value is "
            "0; a per cent of 0 leaves no width; give this value or the tolerance an "
            "absolute bound"
        ),
    ),
    (
        "a tolerance in another unit",
        "tolerance: {mass: 2%}",
        "tolerance: {mass: 2 m}",
        (
            'arm.yaml:6: tolerance.mass: "2 m" has the unit "m"; a mass [kg] is expected; '
            "write it in kg"
        ),
    ),
    (
        "a negative tolerance of the module",
        "tolerance: {mass: 2%}",
        "tolerance: {mass: -2 kg}",
        ('arm.yaml:6: tolerance.mass: "-2 kg" is negative; a tolerance is a width; remove the -'),
    ),
    (
        "a tolerance block without content",
        "tolerance: {mass: 2%}",
        "tolerance:",
        (
            "arm.yaml:6: tolerance: nothing; a mapping is expected; write its keys: mass, "
            "com, inertia, rotor_inertia, viscous, coulomb"
        ),
    ),
    (
        "bounds on a length",
        "a: 0.3 m",
        "a: 0.3 m ± 1 mm",
        (
            'arm.yaml:17: body link, span.dh.a: "0.3 m ± 1 mm" has bounds; this field '
            "takes none; remove them"
        ),
    ),
    (
        "a list for a length",
        "a: 0.3 m",
        "a: [0.2 m, 0.3 m]",
        (
            "arm.yaml:17: body link, span.dh.a: a list; one number without bounds is "
            'expected; write "NUMBER UNIT"'
        ),
    ),
    (
        "a vector of two",
        "com: [0.1 m, 0, 0]",
        "com: [0.1 m, 0]",
        ("arm.yaml:19: body link, com: a list of 2; a vector is a list of three; write [x, y, z]"),
    ),
    (
        "a number for a vector",
        "com: [0.1 m, 0, 0]",
        "com: 3",
        ('arm.yaml:19: body link, com: "3"; a vector is a list of three; write [x, y, z]'),
    ),
    (
        "a vector bound of two",
        "com: [0.1 m, 0, 0]",
        "com: {nominal: [0, 0, 0], lo: [0, 0], hi: [1, 1, 1]}",
        (
            "arm.yaml:19: body link, com.lo: a list of 2; a vector is a list of three; "
            "write [x, y, z]"
        ),
    ),
    (
        "a span of two numbers",
        "dh: {convention: standard, a: 0.3 m, alpha: pi/2}",
        "xyz: [1, 2]",
        (
            "arm.yaml:17: body link, span.xyz: a list of 2; a vector is a list of three; "
            "write [x, y, z]"
        ),
    ),
    (
        "a mass of zero with a tensor",
        "mass: 2 kg",
        "mass: [0 kg, 0 kg]",
        (
            "arm.yaml:20: body link, inertia: not 0 for a body of 0 kg; what has no mass has no "
            "moment of inertia; give the mass, or write physical: as-written here if the figures "
            "are meant"
        ),
    ),
    (
        "a negative mass",
        "mass: 2 kg",
        "mass: -2 kg",
        (
            "arm.yaml:18: body link, mass: -2 kg is negative; a body's mass is at least "
            "0; write 0 or more"
        ),
    ),
    (
        "a mass whose bounds go below zero",
        "mass: 2 kg",
        "mass: [-1 kg, 3 kg]",
        (
            "arm.yaml:18: body link, mass: lower bound -1 kg is negative; a mass is at "
            "least 0; narrow the bounds"
        ),
    ),
    (
        "a negative moment of inertia",
        "yy: 0.03",
        "yy: -0.03",
        (
            "arm.yaml:20: body link, inertia.yy: -0.03 kg m^2 is negative; a moment of "
            'inertia is at least 0; check the figures and the reference point ("about")'
        ),
    ),
    (
        "a moment of inertia of zero beside two that differ",
        "yy: 0.03",
        "yy: 0",
        (
            "arm.yaml:20: body link, inertia: principal moments 0, 0.02, 0.03 kg m^2 break the "
            "triangle inequality; the largest is at most the sum of the other two; check the "
            'figures and the reference point ("about"), or write physical: as-written beside them '
            "if they are meant"
        ),
    ),
    (
        "a tensor that is not positive definite",
        "yy: 0.03",
        "yy: 0.03, xy: 1",
        (
            "arm.yaml:20: body link, inertia: principal moments -0.975012, 0.03, 1.02501 "
            "kg m^2; no principal moment of the nominal tensor is negative; check the figures and "
            'the reference point ("about")'
        ),
    ),
    (
        "a tensor that breaks the triangle inequality",
        "yy: 0.03",
        "yy: 0.1",
        (
            "arm.yaml:20: body link, inertia: principal moments 0.02, 0.03, 0.1 kg m^2 "
            "break the triangle inequality; the largest is at most the sum of the other "
            'two; check the figures and the reference point ("about"), or write physical: '
            "as-written beside them if they are meant"
        ),
    ),
    (
        "a tensor about the frame that is too small",
        "yy: 0.03",
        "about: frame, yy: 0.01",
        (
            "arm.yaml:20: body link, inertia.yy: -0.01 kg m^2 after the move to the COM is "
            "negative; a moment of inertia is at least 0; check the figures and the "
            'reference point ("about")'
        ),
    ),
    (
        "a reference point that is none",
        "yy: 0.03",
        "about: origin, yy: 0.03",
        ('arm.yaml:20: body link, inertia.about: "origin" is not allowed here; known: com, frame'),
    ),
    (
        "a negative friction",
        "viscous: 1 N m s/rad",
        "viscous: -1 N m s/rad",
        (
            "arm.yaml:15: joint axis, friction.viscous: -1 is negative; it is at least 0; "
            "write 0 or more"
        ),
    ),
    (
        "a friction whose bounds go below zero",
        "viscous: 1 N m s/rad",
        "viscous: 1 N m s/rad ± 200%",
        (
            "arm.yaml:15: joint axis, friction.viscous: lower bound -1 is negative; it is "
            "at least 0; write 0 or more"
        ),
    ),
    (
        "a rotor inertia without a gear",
        "gear_ratio: 100, ",
        "",
        (
            "arm.yaml:14: joint axis, drive: rotor_inertia without gear_ratio; the joint "
            "feels the rotor through the gear; add gear_ratio (1 for a direct drive)"
        ),
    ),
    (
        "a gear ratio of zero",
        "gear_ratio: 100",
        "gear_ratio: 0",
        (
            "arm.yaml:14: joint axis, drive.gear_ratio: 0 is not positive; it must be "
            "above 0; write a positive number or leave it out"
        ),
    ),
    (
        "limits in reverse",
        "[-1 rad, 1 rad]",
        "[1 rad, -1 rad]",
        (
            "arm.yaml:13: joint axis, limits.position: lower limit 1 not below upper limit "
            "-1; limits are [lo, hi]; exchange or correct them"
        ),
    ),
    (
        "one limit",
        "[-1 rad, 1 rad]",
        "[1 rad]",
        (
            "arm.yaml:13: joint axis, limits.position: a list of 1; position limits are "
            "two; write [lo, hi]"
        ),
    ),
    (
        "a limit on a continuous joint",
        "type: revolute",
        "type: continuous",
        (
            "arm.yaml:13: joint axis, limits.position: limits on a continuous joint; a "
            "continuous joint has no position limits; remove them or write type: revolute"
        ),
    ),
    (
        "a torque limit on a prismatic joint",
        "type: revolute\n    limits: {position: [-1 rad, 1 rad], velocity: 1 rad/s, torque",
        "type: prismatic\n    limits: {torque",
        (
            "arm.yaml:13: joint axis, limits.torque: torque limit on a prismatic joint; a "
            "prismatic joint has a force; rename it to force"
        ),
    ),
    (
        "a joint of unknown type",
        "type: revolute",
        "type: revolut",
        (
            'arm.yaml:12: joint axis, type: "revolut" is not allowed here; did you mean '
            '"revolute"? known: revolute, prismatic, continuous'
        ),
    ),
    (
        "two kinds in one entry",
        "body: link",
        "body: link\n    joint: elbow",
        (
            "arm.yaml:16: chain[1]: joint and body in one entry; a chain entry is exactly "
            "one of joint, body, frame, module; split it into two entries"
        ),
    ),
    (
        "an entry of no kind",
        "body: link",
        "bodi: link",
        (
            "arm.yaml:16: chain[1]: none of joint, body, frame, module; did you mean "
            '"body"? a chain entry is exactly one of them; start it with e.g. "- body: '
            'name"'
        ),
    ),
    (
        "an entry that is a word",
        MODULE[MODULE.index("  - body") :],
        "  - link\n",
        (
            'arm.yaml:16: chain[1]: "link"; a chain entry is a mapping with one of joint, '
            'body, frame, module; write e.g. "- body: name"'
        ),
    ),
    (
        "an empty chain",
        MODULE[MODULE.index("chain:") :],
        "chain: []\n",
        (
            "arm.yaml:10: chain: an empty list; a module has at least one entry; add a "
            "body or a joint"
        ),
    ),
    (
        "a chain that is no list",
        MODULE[MODULE.index("chain:") :],
        "chain: link\n",
        'arm.yaml:10: chain: "link"; a list is expected; start each entry with -',
    ),
    (
        "a name with a space",
        "body: link",
        "body: my link",
        (
            'arm.yaml:16: body my link, body: "my link" is not a name; names are letters, '
            "digits, _ and -, at most 100; rename it"
        ),
    ),
    (
        "two entries of one name",
        "body: link",
        "body: axis",
        (
            "arm.yaml:16: axis: a second entry of this name (first on line 11); names "
            "within a module differ; rename one"
        ),
    ),
    (
        "two spans in one",
        "dh: {convention: standard, a: 0.3 m, alpha: pi/2}",
        "dh: {convention: standard}, xyz: [0, 0, 1 m]",
        (
            "arm.yaml:17: body link, span: dh and xyz/rpy in one span; a span is one of "
            "dh, giusti2015, xyz/rpy; keep one of them"
        ),
    ),
    (
        "a convention that is none",
        "convention: standard",
        "convention: craig",
        (
            'arm.yaml:17: body link, span.dh.convention: "craig" is not allowed here; '
            "known: standard, modified"
        ),
    ),
    (
        "a convention left out",
        "convention: standard, ",
        "",
        ('arm.yaml:17: body link, span.dh: no "convention"; this key is required; add convention'),
    ),
    (
        "a clocking of zero",
        "clocking: 90 deg",
        "clocking: 0 deg",
        (
            "arm.yaml:9: connectors.out.clocking: 0 rad is not positive; clocking is the "
            "step of the allowed mounts; write e.g. 90 deg"
        ),
    ),
    (
        "a gender that is none",
        "{type: t}",
        "{type: t, gender: x}",
        'arm.yaml:8: connectors.in.gender: "x" is not allowed here; known: m, f, n',
    ),
    (
        "another version",
        "modrobust: 1",
        "modrobust: 2",
        (
            'arm.yaml:1: modrobust: version "2"; this modrobust reads version 1; write 1 '
            "or install a newer modrobust"
        ),
    ),
    (
        "a module named unlike its file",
        "module: arm",
        "module: leg",
        (
            'arm.yaml:2: module: "leg" in a file named "arm.yaml"; the name is the file\'s '
            "name without its suffix; write arm or rename the file"
        ),
    ),
    (
        "a list for a text",
        "name: Arm",
        "name: [Arm]",
        "arm.yaml:3: name: a list; a text is expected; write one",
    ),
    (
        "a word for true or false",
        "name: Arm",
        "name: Arm\nproduct: no",
        'arm.yaml:4: product: "no"; true or false is expected; write one of them',
    ),
    (
        "a duplicate key",
        "mass: 2 kg",
        "mass: 2 kg\n    mass: 3 kg",
        (
            'arm.yaml:19: chain[1].mass: duplicate key "mass" (first on line 18); a key '
            "stands once; remove one of them"
        ),
    ),
    (
        "an anchor",
        "mass: 2 kg",
        "mass: &m 2 kg",
        (
            'arm.yaml:18: chain[1].mass: anchor "&m"; aliases and anchors are not allowed, '
            "because they can expand without end; write the value out where it is needed"
        ),
    ),
    (
        "an alias",
        "mass: 2 kg",
        "mass: *m",
        (
            'arm.yaml:18: chain[1].mass: alias "*m"; aliases and anchors are not allowed, '
            "because they can expand without end; write the value out"
        ),
    ),
    (
        "a tag",
        "mass: 2 kg",
        "mass: !!float 2",
        (
            'arm.yaml:18: chain[1].mass: tag "tag:yaml.org,2002:float"; tags are not '
            "allowed; remove it"
        ),
    ),
    (
        "a list as a key",
        "name: Arm",
        "[a, b]: Arm",
        "arm.yaml:3: a list or mapping as a key; a key is a plain text; write a name",
    ),
    (
        "two documents",
        "chain:",
        "---\nchain:",
        (
            'arm.yaml:10: a second document ("---"); a file holds one description; put it '
            "into a file of its own"
        ),
    ),
    (
        "broken YAML",
        "com: [0.1 m, 0, 0]",
        "com: [0.1 m, 0, 0",
        (
            "arm.yaml:20: not YAML: expected ',' or ']', but got ':'; check indentation, "
            "quotes and brackets near this line"
        ),
    ),
    (
        "a tab as indentation",
        "  - body: link",
        "\t- body: link",
        (
            "arm.yaml:16: not YAML: found character '\\t' that cannot start any token; "
            "check indentation, quotes and brackets near this line"
        ),
    ),
    (
        "a control character",
        "name: Arm",
        "name: A\u0007rm",
        "arm.yaml:3: control character U+0007; a description is plain text; remove it",
    ),
    (
        "an escape beyond Unicode",
        "name: Arm",
        'name: "\\UFFFFFFFF"',
        (
            "arm.yaml:3: not YAML: an escape after this line is no Unicode character; write "
            "the letter "
            "itself"
        ),
    ),
    (
        "half a surrogate pair",
        "name: Arm",
        'name: "\\ud800"',
        ("arm.yaml:3: name: half a surrogate pair; text is Unicode; write the letter itself"),
    ),
    (
        "deep nesting",
        "name: Arm",
        "name: " + "[" * 1000,
        (
            "arm.yaml:3: nested more than 32 levels deep; a description has at most 32 "
            "levels; check the brackets"
        ),
    ),
    (
        "a line without end",
        "name: Arm",
        "name: " + "x" * 5000,
        "arm.yaml:3: a line of 5006 characters; a line has at most 4096; break it",
    ),
    (
        "more values than a description has",
        "notes: none",
        "notes: [" + "1,\n" * 20000 + "]",
        (
            "arm.yaml:19994: more than 20000 keys and values; a description has at most "
            "20000; split it"
        ),
    ),
    (
        "a top level that is a list",
        MODULE,
        "- 1\n",
        (
            "arm.yaml:1: a list at the top level; a description is a mapping that starts "
            'with "modrobust: 1"; see docs/reference/formats.md'
        ),
    ),
    (
        "nothing but a comment",
        MODULE,
        "# soon\n",
        (
            "arm.yaml:1: nothing at the top level; a description is a mapping that starts "
            'with "modrobust: 1"; see docs/reference/formats.md'
        ),
    ),
    (
        "an assembly in place of a module",
        "module: arm",
        "robot: arm",
        (
            'arm.yaml:2: robot: an assembly file; a module file has "module:"; give the '
            "other kind of file"
        ),
    ),
]
