"""`spear doctor`."""

import re
import sys
import tomllib
from pathlib import Path

from spear_pin.cli.doctor import OPTIONAL, REQUIRED
from tests.cli.calls import printed, run

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
NOT_USED = {"test", "docs", "dev"}  # extras that the package itself has no use for


class TestDoctor:
    def test_json(self, capsys):
        result = printed(capsys, "doctor")
        assert result["python_version"] == ".".join(map(str, sys.version_info[:3]))
        assert all(result["packages"][name] for name in ("pin", "numpy", "scipy", "lxml"))
        assert set(result["checks"].values()) == {"ok"}

    def test_text(self, capsys):
        status, out, err = run(capsys, "doctor")
        assert status == 0 and err == ""
        assert "numpy" in out and "one hop: ok" in out and "one stride: ok" in out

    def test_it_looks_for_all_that_the_project_names(self):
        extras = [each for extra, each in PROJECT["optional-dependencies"].items() if extra not in NOT_USED]
        assert set(REQUIRED) == _names(PROJECT["dependencies"])
        assert set(OPTIONAL) == _names(requirement for extra in extras for requirement in extra)

    def test_a_check_that_fails(self, capsys, monkeypatch):
        def broken():
            raise RuntimeError("no libpinocchio")

        monkeypatch.setattr("spear_pin.cli.doctor.CHECKS", {"dynamics": broken})
        status, out, err = run(capsys, "doctor")
        assert status == 2
        assert "dynamics: FAILED: RuntimeError: no libpinocchio" in out


def _names(requirements):
    return {re.match(r"[\w-]+", requirement)[0] for requirement in requirements}
