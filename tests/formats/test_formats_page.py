"""Every YAML example of docs/reference/formats.md is read as the page says."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from modrobust.formats import JointItem, load_assembly, load_module
from support.formats.format_samples import MODULE
from support.paths import ROOT

PAGE = (ROOT / "docs" / "reference" / "formats.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
HEAD = MODULE[: MODULE.index("chain:")].replace("module: arm", "module: part")
ROBOT = "modrobust: 1\nrobot: part\nchain: [elbow-60, {module: elbow-60, as: wrist}]\n"


@pytest.mark.parametrize("example", EXAMPLES, ids=range(len(EXAMPLES)))
def test_each_example_loads(tmp_path, example):
    named = re.search(r"^(module|robot): (\S+)$", example, re.MULTILINE)
    load: Callable[[Path], object]
    if example.startswith("- "):  # chain entries
        text, stem, load = f"{HEAD}chain:\n{example}", "part", load_module
    elif not example.startswith("modrobust: 1"):  # keys of an assembly
        text, stem, load = f"{ROBOT}{example}", "part", load_assembly
    else:
        assert named is not None
        text, stem = example, named[2]
        load = load_module if named[1] == "module" else load_assembly
    path = tmp_path / f"{stem}.yaml"
    path.write_text(text, encoding="utf-8")
    loaded = load(path)
    for value in (getattr(loaded, "initial_q", None), getattr(loaded, "disturbance", None)):
        if value is not None:
            value.resolve(["elbow-60.axis", "wrist.axis"], ["revolute", "revolute"])


def test_the_page_has_an_example_of_each_kind():
    assert sum(example.startswith("- ") for example in EXAMPLES) >= 2
    assert sum("\nmodule: " in example for example in EXAMPLES) >= 1
    assert sum("\nrobot: " in example for example in EXAMPLES) >= 1


def test_the_messages_on_the_page_are_the_real_ones(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for old, new in (("mass: 2 kg", "masss: 2 kg"), ("a: 0.3 m", "a: 90 deg")):
        Path("arm.yaml").write_text(MODULE.replace(old, new), encoding="utf-8")
        with pytest.raises(Exception, match=r"^arm\.yaml") as caught:
            load_module("arm.yaml")
        assert f"\n{caught.value}\n" in PAGE


def test_the_first_example_has_a_drive(tmp_path):
    (tmp_path / "elbow-60.yaml").write_text(EXAMPLES[0], encoding="utf-8")
    joint = load_module(tmp_path / "elbow-60.yaml").items[0]
    assert isinstance(joint, JointItem)
    assert joint.rotor_inertia is not None
    assert joint.rotor_inertia.hi >= 6e-5
