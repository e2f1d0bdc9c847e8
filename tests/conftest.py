"""Fixtures that several test files share."""

import pytest

from modrobust.assembly import load_robot
from support.small_modules import MODULES


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Loads the robot of an assembly text; test modules beside it, messages with short paths."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "modules").mkdir()
    for name, text in MODULES.items():
        (tmp_path / "modules" / f"{name}.yaml").write_text(text.lstrip())

    def load_text(body, modules=(), name="arm"):
        for module, text in dict(modules).items():
            (tmp_path / "modules" / f"{module}.yaml").write_text(text.lstrip())
        head = f"modrobust: 1\nrobot: {name}\nmodules: modules\n"
        (tmp_path / f"{name}.yaml").write_text(head + body.lstrip("\n"))
        return load_robot(f"{name}.yaml")

    return load_text
