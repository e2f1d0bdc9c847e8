"""Where a URDF's parts come from: xacro arguments, folders of packages, other people's formats."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import modrobust as mr
from support.urdf_texts import two_links, written

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
HEAD = f'<robot name="small" {XACRO}><xacro:arg name="h" default="0.1"/><xacro:arg name="side"/>'


def with_argument() -> str:
    text = two_links().replace('<robot name="small">', HEAD.replace('<xacro:arg name="side"/>', ""))
    return text.replace("0 0 0.3", "0 0 $(arg h)")


def packed(folder: Path) -> Path:
    """A package whose robot includes a file of another package."""
    inner, outer = folder / "parts", folder / "robots" / "urdf"
    inner.mkdir()
    outer.mkdir(parents=True)
    height = f'<robot {XACRO}><xacro:property name="h" value="0.7"/></robot>'
    written(inner, height, "height.xacro")
    text = two_links().replace(
        '<robot name="small">',
        f'<robot name="small" {XACRO}><xacro:include filename="$(find parts)/height.xacro"/>',
    )
    written(outer, text.replace("0 0 0.3", "0 0 ${h}"), "small.xacro")
    return outer / "small.xacro"


def height(loaded: mr.Robot) -> float:
    return float(loaded.before[0, 2, 3])


def test_arguments_reach_xacro(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    path = written(tmp_path, with_argument(), "small.xacro")
    assert height(mr.load_robot(path)) == 0.1
    assert height(mr.load_robot(path, xacro={"h": 0.25})) == 0.25
    over = "modrobust: 1\nrobot: over\nurdf: small.xacro\nxacro: {h: 0.5}\n"
    overlaid = written(tmp_path, over, "over.yaml")
    assert height(mr.load_robot(overlaid)) == 0.5
    assert height(mr.load_robot(overlaid, xacro={"h": "0.75"})) == 0.75
    done = subprocess.run(
        [sys.executable, "-m", "modrobust", "assemble", str(path), "--xacro", "h:=0.25", "--json"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "0.25" in done.stdout


def test_an_argument_that_the_file_does_not_have_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    path = written(tmp_path, with_argument(), "small.xacro")
    with pytest.raises(mr.ModrobustError, match='no xacro argument "hh"; did you mean "h"'):
        mr.load_robot(path, xacro={"hh": "0.25"})
    for bad, told in (({"_h": "1"}, "xacro._h: not a name"), ({"h": "a:=b"}, 'holds ":="')):
        with pytest.raises(mr.ModrobustError, match=told):
            mr.load_robot(path, xacro=bad)
    plain = written(tmp_path, two_links())
    with pytest.raises(mr.ModrobustError, match="for a file that is not xacro"):
        mr.load_robot(plain, xacro={"h": "1"})


def test_an_argument_that_is_missing_is_named(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    text = with_argument().replace('<xacro:arg name="h" default="0.1"/>', "")
    path = written(tmp_path, text, "small.xacro")
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(path)
    assert "takes an argument without a default; give it (xacro: {h: ...})" in str(caught.value)


def test_a_package_is_found_in_the_folder_that_is_given(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    path = packed(tmp_path)
    folders: dict[str, str | Path] = {"parts": tmp_path / "parts", "robots": tmp_path / "robots"}
    assert height(mr.load_robot(path, packages=folders)) == 0.7
    assert height(mr.load_robot("package://robots/urdf/small.xacro", packages=folders)) == 0.7
    over = (
        "modrobust: 1\nrobot: over\nurdf: package://robots/urdf/small.xacro\n"
        "packages: {parts: parts, robots: robots}\n"
    )
    assert height(mr.load_robot(written(tmp_path, over, "over.yaml"))) == 0.7
    command = [sys.executable, "-m", "modrobust", "assemble", "package://robots/urdf/small.xacro"]
    options = ["--package", f"parts={tmp_path}/parts", "--package", f"robots={tmp_path}/robots"]
    subprocess.run([*command, *options, "--json"], capture_output=True, check=True)


def test_a_package_whose_folder_is_not_known_is_named_with_the_remedy(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    path = packed(tmp_path)
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(path)
    assert str(caught.value) == (
        f'{path}: xacro asks for the folder of package "parts", which is not known; give it '
        "(packages: {parts: FOLDER}), or expand the file where its packages are installed: "
        "xacro FILE > robot.urdf"
    )
    with pytest.raises(mr.ModrobustError, match='folder of package "robot" is not given; did you'):
        mr.load_robot("package://robot/x.urdf", packages={"robots": tmp_path / "robots"})
    with pytest.raises(mr.ModrobustError, match=r"packages\.parts: no directory"):
        mr.load_robot(path, packages={"parts": tmp_path / "none"})
    with pytest.raises(mr.ModrobustError, match="is not package://NAME/PATH"):
        mr.load_robot("package://robots", packages={"robots": tmp_path / "robots"})


def test_pairs_of_the_command_line_that_are_none_are_refused() -> None:
    for option, told in (
        (["--xacro", "h=1"], '--xacro: "h=1" is no NAME:=VALUE'),
        (["--package", "parts"], '--package: "parts" is no NAME=PATH'),
        (["--xacro", "h:=1", "--xacro", "h:=2"], "--xacro: h is given twice"),
        (["--xacro", "h:=1"], "a robot of modules"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "modrobust", "assemble", "lwa4p", *option],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 2
        assert told in done.stderr


def test_hrdf_is_named_and_not_read(tmp_path: Path) -> None:
    text = '<robot version="1.6.0"><actuator type="X8-9"/></robot>'
    for name in ("arm.hrdf", "arm.HRDF"):
        path = written(tmp_path, text, name)
        with pytest.raises(mr.ModrobustError, match=r"HEBI's HRDF.*it is not read"):
            mr.load_robot(path)
    over = written(tmp_path, "modrobust: 1\nrobot: over\nurdf: arm.hrdf\n", "over.yaml")
    with pytest.raises(mr.ModrobustError, match="HEBI's HRDF"):
        mr.load_robot(over)
