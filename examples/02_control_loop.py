"""Use the controller in a loop of your own; here the "robot" is `forward_dynamics`.

Each tick: measure, ask for the command, apply `tau`. When the controller raises an error it gives
no torque, and the loop must fall back to a safe stop of its own.
"""

import numpy as np

import modrobust as mr

robot = mr.load_robot("lwa4p-paper")
controller = mr.RobustController(robot, bound="hull")
true_parameters = robot.sample_parameters(rng=1)  # what nobody knows

dt = 2e-5  # [s], 50 kHz
q, dq = np.full(robot.n, 0.02), np.zeros(robot.n)
q_des, still = np.zeros(robot.n), np.zeros(robot.n)

for tick in range(5000):
    command = controller.command(tick * dt, q, dq, q_des, still, still)
    if tick % 1000 == 0:
        error = np.linalg.norm(q_des - q)
        print(f"t = {tick * dt:.2f} s: error {error:.4f} rad, |rho| {command.rho_norm:.2f} N m")
    ddq = mr.forward_dynamics(robot, q, dq, command.tau, parameters=true_parameters)
    dq = dq + dt * ddq
    q = q + dt * dq

print(f"after {5000 * dt:.2f} s: error {np.linalg.norm(q_des - q):.4f} rad")
