"""The JSON Schema that editors get: valid itself, accepts our files, refuses misspelt keys."""

import pytest
from jsonschema import Draft202012Validator

from modrobust.formats import json_schema
from modrobust.formats.nodes import ListNode, ScalarNode
from modrobust.formats.reader import _parse_yaml, read_description
from support.formats.format_samples import ASSEMBLY, MODULE
from support.paths import ROOT

FILES = {
    "module": sorted((ROOT / "modules").glob("*.yaml")),
    "assembly": sorted((ROOT / "assemblies").glob("*.yaml")),
}


def _data(node):
    """A tree as an editor's YAML reader gives it: true and false are no texts."""
    if isinstance(node, ScalarNode):
        return {"true": True, "false": False}.get(node.text, node.text)
    if isinstance(node, ListNode):
        return [_data(item) for item in node.items]
    return {key: _data(value) for key, value in node.entries.items()}


@pytest.mark.parametrize("kind", FILES)
def test_the_schema_is_a_valid_schema_of_its_draft(kind):
    schema = json_schema(kind)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    Draft202012Validator.check_schema(schema)


@pytest.mark.parametrize("kind", FILES)
def test_the_schema_accepts_every_file_of_the_catalogue(kind):
    validator = Draft202012Validator(json_schema(kind))
    assert FILES[kind]
    for path in FILES[kind]:
        errors = [error.message for error in validator.iter_errors(_data(read_description(path)))]
        assert errors == [], path.name


@pytest.mark.parametrize(
    ("kind", "text", "old", "new"),
    [
        ("module", MODULE, "mass: 2 kg", "masss: 2 kg"),
        ("module", MODULE, "    mass: 2 kg\n", ""),
        ("module", MODULE, "type: revolute", "type: rotary"),
        ("module", MODULE, "body: link", "body: link\n    joint: x"),
        ("module", MODULE, "com: [0.1 m, 0, 0]", "com: [0.1 m, 0]"),
        ("module", MODULE, "modrobust: 1", "modrobust: 2"),
        ("assembly", ASSEMBLY, "payload", "paylod"),
        ("assembly", ASSEMBLY, "kind: sines", "kind: sine"),
        ("assembly", ASSEMBLY, "law: norm", "lawe: norm"),
        ("assembly", ASSEMBLY, "law: norm", "law: nrom"),
        ("assembly", ASSEMBLY, "disturbance: [-1 N m, 1 N m]", "disturbance: [1, 2, 3]"),
    ],
)
def test_the_schema_refuses_what_the_loader_refuses(kind, text, old, new):
    validator = Draft202012Validator(json_schema(kind))
    assert validator.is_valid(_data(_parse_yaml(text, "x.yaml")))
    assert not validator.is_valid(_data(_parse_yaml(text.replace(old, new, 1), "x.yaml")))


@pytest.mark.parametrize(
    ("line", "valid"),
    [
        ("controller: auto", True),
        ("controller: norm", False),
        ("controller: {G: 40 1/s, integral: off, predictor: false}", True),
        ("controller: {G: [1, 2]}", False),
        (
            "loop: {rate: 1 kHz, delay: 1, saturation: true, noise: {position: 1e-4, sign: worst}}",
            True,
        ),
        ("loop: {noise: {position: {arm.axis: 1e-4 rad, tool.axis: 1e-4}}}", True),
        ("loop: {rate: [1, 2]}", False),
        ("loop: {noise: 1e-4}", False),
        ("loop: {saturation: 1}", False),
    ],
)
def test_the_schema_of_controller_and_loop_is_that_of_the_loader(line, valid):
    own = "controller: {law: norm, K_r: 10, kappa_P: 2, epsilon: 0.01 rad}"
    text = ASSEMBLY.replace(own, line)
    assert own in ASSEMBLY
    data = _data(_parse_yaml(text, "x.yaml"))
    assert Draft202012Validator(json_schema("assembly")).is_valid(data) == valid


@pytest.mark.parametrize("kind", FILES)
def test_every_key_of_the_schema_is_described(kind):
    schema = json_schema(kind)
    for part in (schema, *schema["$defs"].values()):
        for key, value in part.get("properties", {}).items():
            assert "description" in value, key


def test_an_absent_key_is_not_null():
    data = _data(_parse_yaml(MODULE, "x.yaml"))
    assert not Draft202012Validator(json_schema("module")).is_valid({**data, "licence": None})
