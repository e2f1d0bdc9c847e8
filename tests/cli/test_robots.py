"""Built-in robots whose URDF comes with another package, which may be absent."""

import pytest


@pytest.mark.parametrize(
    ("name", "package"),
    [("ur5", "example-robot-data"), ("iiwa", "pybullet"), ("baxter", "example-robot-data")],
)
def test_a_real_robot_loads_or_names_the_package_that_is_missing(run, name, package):
    result = run("assemble", name)
    if result.returncode == 0:
        assert result.stdout.startswith(f"{name}: ")
        return
    assert result.returncode == 2
    assert result.stdout == ""
    assert f"{name}.yaml:" in result.stderr
    assert f'urdf: package "{package}" is not installed' in result.stderr
    assert f"pip install {package}" in result.stderr


def test_bench_says_that_a_loop_diverged(run, tmp_path):
    text = "modrobust: 1\nrobot: arm\nchain: [lwa4p-paper-link-1]\ncontroller: {phi_P: 1e7}\n"
    (tmp_path / "arm.yaml").write_text(text)
    result = run("bench", "arm.yaml", "--repeat", "1")
    assert result.returncode == 1
    assert "arm: the loop diverged at" in result.stderr
    assert "nothing of it is measured" in " ".join(result.stderr.split())
