"""`spear doctor`."""

import sys

from tests.cli.calls import printed, run


class TestDoctor:
    def test_json(self, capsys):
        result = printed(capsys, "doctor")
        assert result["python"] == ".".join(map(str, sys.version_info[:3]))
        assert all(result["packages"][name] for name in ("pin", "numpy", "scipy", "lxml"))
        assert set(result["checks"].values()) == {"ok"}

    def test_text(self, capsys):
        status, out, err = run(capsys, "doctor")
        assert status == 0 and err == ""
        assert "numpy" in out and "one hop: ok" in out and "one stride: ok" in out

    def test_a_check_that_fails(self, capsys, monkeypatch):
        def broken():
            raise RuntimeError("no libpinocchio")

        monkeypatch.setattr("spear_pin.cli.doctor.CHECKS", {"dynamics": broken})
        status, out, err = run(capsys, "doctor")
        assert status == 2
        assert "dynamics: FAILED: RuntimeError: no libpinocchio" in out
