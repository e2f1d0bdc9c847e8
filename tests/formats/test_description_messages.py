"""Each kind of bad description ends in one message, byte for byte."""

import pytest

from formats.assembly_messages import ASSEMBLY_CASES
from formats.module_messages import MODULE_CASES
from modrobust.errors import DescriptionError, SeveralFaultsError
from modrobust.formats import load_assembly, load_module
from support.formats.format_samples import ASSEMBLY, MODULE


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the messages name the file as it was given


def _ids(cases):
    return [case[0] for case in cases]


@pytest.mark.parametrize(("wrong", "old", "new", "message"), MODULE_CASES, ids=_ids(MODULE_CASES))
def test_a_module_file_is_refused_for(tmp_path, wrong, old, new, message):
    assert old in MODULE, wrong
    (tmp_path / "arm.yaml").write_text(MODULE.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(DescriptionError) as caught:
        load_module("arm.yaml")
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("wrong", "old", "new", "message"), ASSEMBLY_CASES, ids=_ids(ASSEMBLY_CASES)
)
def test_an_assembly_file_is_refused_for(tmp_path, wrong, old, new, message):
    assert old in ASSEMBLY, wrong
    (tmp_path / "r.yaml").write_text(ASSEMBLY.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(DescriptionError) as caught:
        load_assembly("r.yaml")
    assert str(caught.value) == message


def test_the_samples_themselves_load(tmp_path):
    (tmp_path / "arm.yaml").write_text(MODULE, encoding="utf-8")
    (tmp_path / "r.yaml").write_text(ASSEMBLY, encoding="utf-8")
    assert load_module("arm.yaml").id == "arm"
    assert load_assembly("r.yaml").name == "r"


def test_the_path_in_a_message_is_the_path_as_given(tmp_path):
    folder = tmp_path / "parts"
    folder.mkdir()
    (folder / "arm.yaml").write_text(MODULE.replace("2 kg", "2 m"), encoding="utf-8")
    with pytest.raises(DescriptionError, match=r"^parts/\.\./parts/arm\.yaml:18: "):
        load_module("parts/../parts/arm.yaml")


def test_all_faults_of_a_module_are_told_in_one_reading(tmp_path):
    text = (
        MODULE.replace("name: Arm", "name: [Arm]")
        .replace("mass: 2 kg", "masss: 2 kg\n    colour: red")
        .replace("type: revolute", "type: hinge")
    )
    (tmp_path / "arm.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SeveralFaultsError) as caught:
        load_module("arm.yaml")
    told = str(caught.value).splitlines()
    assert [line.split("; ")[0] for line in told] == [
        "arm.yaml:3: name: a list",
        'arm.yaml:12: joint axis, type: "hinge" is not allowed here',
        'arm.yaml:18: body link: unknown key "masss"',
        'arm.yaml:19: body link: unknown key "colour"',
    ]
    assert caught.value.line == 3


def test_figures_of_all_entries_are_told_in_one_reading(tmp_path):
    text = MODULE.replace("mass: 2 kg", "mass: -2 kg").replace("velocity: 1", "velocity: 0")
    (tmp_path / "arm.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SeveralFaultsError) as caught:
        load_module("arm.yaml")
    assert [fault.field for fault in caught.value.faults] == [
        "joint axis, limits.velocity",
        "body link, mass",
    ]


def test_all_faults_of_an_assembly_are_told_in_one_reading(tmp_path):
    text = ASSEMBLY.replace("mass: [0 kg, 2 kg]", "mass: -1 kg").replace(
        "[0, 0, -9.81", "[0, -9.81"
    )
    text = text.replace("modules: .\n", "")
    (tmp_path / "r.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SeveralFaultsError) as caught:
        load_assembly("r.yaml")
    assert {fault.field for fault in caught.value.faults} == {"gravity", "payload.mass"}
