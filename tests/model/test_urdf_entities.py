"""Hostile URDFs: no entity is expanded, and no file that one names is read or even opened."""

import os
import subprocess
import sys

import pytest

from tests.model.planar_arm import refusal


class TestEntities:
    """Documents that would cost memory or leak a file if their entities were expanded."""

    TENFOLD = "".join(f"<!ENTITY e{n + 1} '{f'&e{n};' * 10}'>\n" for n in range(9))
    BOMB = f"<!DOCTYPE robot [\n<!ENTITY e0 'boom'>\n{TENFOLD}]>\n"

    @pytest.mark.parametrize("place", ['<robot name="arm"><note>&e9;</note>', '<robot name="&e9;">'])
    def test_bomb(self, write, place):
        error = refusal(write(f'{self.BOMB}{place}<link name="base"/></robot>'))
        assert "amplification" in error.problem or "document type" in error.problem

    @pytest.mark.parametrize("place", ['<robot name="arm">&leak;', '<robot name="&leak;">'])
    @pytest.mark.parametrize("target", ["secret", "nowhere", "/etc/passwd"])
    def test_external_entity(self, write, tmp_path, place, target):
        (tmp_path / "secret").write_text("hunter2")
        declared = f'<!DOCTYPE robot [<!ENTITY leak SYSTEM "file://{tmp_path / target}">]>'
        text = str(refusal(write(f'{declared}{place}<link name="base"/></robot>')))
        assert "hunter2" not in text and "root:" not in text

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
    @pytest.mark.parametrize(
        "start",
        [
            '<!DOCTYPE robot [<!ENTITY leak SYSTEM "file://PIPE">]><robot name="arm">&leak;',
            '<!DOCTYPE robot [<!ENTITY % leak SYSTEM "file://PIPE"> %leak;]><robot name="arm">',
            '<!DOCTYPE robot SYSTEM "file://PIPE"><robot name="arm">',
        ],
    )
    def test_external_file_is_not_even_opened(self, write, tmp_path, start):
        """Opening a pipe that nobody writes to would wait for ever."""
        pipe = tmp_path / "pipe"
        os.mkfifo(pipe)
        path = write(f'{start.replace("PIPE", str(pipe))}<link name="base"/></robot>')
        code = f"from spear_pin.model.urdf import read_urdf; read_urdf({str(path)!r})"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=20)
        assert "BadFile" in done.stderr and "document type" in done.stderr
