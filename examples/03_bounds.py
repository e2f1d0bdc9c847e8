"""How tight is the bound? Sample parameters, and compare the torques with both kinds of bound."""

import numpy as np

import modrobust as mr

robot = mr.load_robot("lwa4p-paper")
rng = np.random.default_rng(0)
q, dq, dq_a, ddq_a = rng.uniform(-1.0, 1.0, (4, robot.n))

corners = [robot.corner_parameters(rng) for _ in range(2000)]
torques = np.array([mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a, p) for p in corners])
print("joint        seen at corners          hull         ianea   [N m wide]")
widths = []
for bound in ("hull", "ianea"):
    lo, hi = mr.inverse_dynamics_bounds(robot, q, dq, dq_a, ddq_a, bound=bound)
    assert (torques >= lo - 1e-9).all()
    assert (torques <= hi + 1e-9).all()
    widths.append(hi - lo)
for name, seen, hull, ianea in zip(
    robot.joint_names, np.ptp(torques, axis=0), *widths, strict=True
):
    print(f"{name}  {seen:16.4f}  {hull:12.4f}  {ianea:12.4f}")
