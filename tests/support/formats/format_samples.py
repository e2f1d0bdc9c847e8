"""A small module and assembly that the tests of the formats change line by line."""

MODULE = """\
modrobust: 1
module: arm
name: Arm
source: made up for the tests
notes: none
tolerance: {mass: 2%}
connectors:
  in: {type: t}
  out: {type: t, clocking: 90 deg}
chain:
  - joint: axis
    type: revolute
    limits: {position: [-1 rad, 1 rad], velocity: 1 rad/s, torque: 5 N m}
    drive: {gear_ratio: 100, rotor_inertia: 1e-5 kg m^2}
    friction: {viscous: 1 N m s/rad, coulomb: 1 N m}
  - body: link
    span: {dh: {convention: standard, a: 0.3 m, alpha: pi/2}}
    mass: 2 kg
    com: [0.1 m, 0, 0]
    inertia: {xx: 0.02, yy: 0.03, zz: 0.03}
"""

ASSEMBLY = """\
modrobust: 1
robot: r
modules: .
gravity: [0, 0, -9.81 m/s^2]
chain:
  - arm
  - {module: arm, as: tool, mount: 90 deg, set: {link.mass: 3 kg}}
payload: {mass: [0 kg, 2 kg], com: [0, 0, [20 mm, 80 mm]]}
disturbance: [-1 N m, 1 N m]
controller: {law: norm, K_r: 10, kappa_P: 2, epsilon: 0.01 rad}
trajectory: {kind: sines, amplitude: pi/2, omega: [pi/5 rad/s], duration: 10 s}
initial: {q: {arm.axis: 0 rad, tool.axis: 0 rad}}
scenarios: {heavy: {set: {arm.link.mass: 2.01 kg}}}
"""
