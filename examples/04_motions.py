"""Motions of your own: waypoints, or a CSV file; and what a run leaves in a file."""

import tempfile
from pathlib import Path

import numpy as np

import modrobust as mr

robot = mr.load_robot("scara")
start = np.zeros(robot.n)
goal = np.array([0.4, -0.3, 0.02, 0.5])  # [rad], [m] for the prismatic joint

with tempfile.TemporaryDirectory() as folder:
    # Rest to rest through waypoints.
    motion = mr.Quintic(times=np.array([0.0, 1.0]), points=np.array([start, goal]))
    result = mr.simulate(robot, trajectory=motion, parameters="corner", seed=2)
    print(f"waypoints: ok = {result.ok}, error {result.summary()['error_final']:.5f} at the end")

    # The same motion recorded in a file, splined.
    t = np.linspace(0.0, 1.0, 101)
    file = Path(folder) / "motion.csv"
    header = ",".join(["t", *robot.joint_names])
    rows = np.column_stack([t, motion.sample(t)[0]])
    np.savetxt(file, rows, delimiter=",", header=header, comments="", fmt="%.17g")
    result = mr.simulate(robot, trajectory=file, parameters="corner", seed=2)
    print(f"CSV file: ok = {result.ok}, error {result.summary()['error_final']:.5f} at the end")

    # Everything over time, sampled at 1 ms.
    result.save(Path(folder) / "run.npz")
    with np.load(Path(folder) / "run.npz") as run:
        print(f"saved: {len(run['t'])} instants of {', '.join(run.files[:6])}, ...")
