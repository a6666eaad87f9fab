"""`spear completion`: the shells themselves are asked what they complete to."""

import re
import shlex
import shutil
import subprocess
import sys

import pytest

from spear_pin.cli import _parser, main
from spear_pin.cli.arguments import commands_of
from tests.cli.calls import printed, refused, run

needs_shtab = pytest.mark.extra("shtab")
ASK = """
source "$1"; shift
function=$(complete -p spear | sed 's/.*-F \\([^ ]*\\).*/\\1/')
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
"$function" spear "${COMP_WORDS[COMP_CWORD]}"
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    """The script of each shell, in a file, by its name."""
    folder = tmp_path_factory.mktemp("completion")
    paths = {}
    for shell in ("bash", "zsh", "fish"):
        paths[shell] = folder / f"spear.{shell}"
        done = subprocess.run([sys.executable, "-m", "spear_pin", "completion", shell], capture_output=True, text=True)
        assert done.returncode == 0 and done.stderr == "", done.stderr
        paths[shell].write_text(done.stdout)
    return paths


@needs_shtab
class TestBash:
    @pytest.mark.parametrize(
        ("words", "found"),
        [
            (["ex"], {"explore", "export"}),
            (["export", "--mc"], {"--mcap"}),
            (["export", "--m"], {"--mjcf", "--mat", "--mcap", "--mp4", "--motors"}),
            (["bound", "--gait", "long_stride_3.0"], {"long_stride_3.00"}),
            (["bound", "--robot", "spear_"], {"spear_ii", "spear_ii_series"}),
            (["hop", "--robot", "mine"], {"mine.urdf"}),
            (["compare", "long_stride_3.0"], {"long_stride_3.00"}),
            (["bound", "long_stride_3.0"], {"long_stride_3.00"}),
            (["sweep", "bou"], {"bound"}),
            (["explore", "long_stride_3.0"], {"long_stride_3.00"}),
            (["hop", "--out", "fo"], {"folder"}),
            (["report", "--figures", ""], {"svg", "pdf", "png"}),
            (["completion", ""], {"bash", "zsh", "fish"}),
        ],
        ids=lambda value: " ".join(value) if isinstance(value, list) else "",
    )
    @pytest.mark.skipif(shutil.which("bash") is None, reason="no bash here")
    def test_words(self, tmp_path, scripts, words, found):
        (tmp_path / "folder").mkdir()
        (tmp_path / "mine.urdf").touch()
        (tmp_path / "four.txt").touch()
        command = ["bash", "--norc", "-c", ASK, "bash", str(scripts["bash"]), "spear", *words]
        done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert set(done.stdout.split()) == found


@needs_shtab
def test_commands_as_the_help_lists_them(scripts):
    listed = re.search(r"^_shtab_spear_subparsers=\((.*)\)$", scripts["bash"].read_text(), re.M)
    names = [name for group in commands_of(_parser()).groups.values() for name in group]
    assert shlex.split(listed[1]) == names


@needs_shtab
@pytest.mark.skipif(shutil.which("fish") is None, reason="no fish here")
def test_fish(scripts):
    asked = f"source {scripts['fish']}; complete -C 'spear ex'; complete -C 'spear export --mc'"
    done = subprocess.run(["fish", "-N", "-c", asked], capture_output=True, text=True)
    assert [line.split("\t")[0] for line in done.stdout.splitlines()] == ["explore", "export", "--mcap"]


@needs_shtab
@pytest.mark.skipif(shutil.which("zsh") is None, reason="no zsh here")
def test_zsh_reads_it(scripts):
    done = subprocess.run(["zsh", "-n", str(scripts["zsh"])], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@needs_shtab
def test_json(capsys):
    result = printed(capsys, "completion", "bash")
    assert result["shell"] == "bash"
    assert run(capsys, "completion", "bash")[1] == result["script"].rstrip("\n") + "\n"


def test_mistakes(capsys, monkeypatch):
    assert "unknown choice 'tcsh'; valid: bash, zsh, fish" in refused(capsys, "completion", "tcsh")
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert "needs shtab, which is not installed: pip install '.[completion]'" in refused(capsys, "completion", "bash")


def test_parsing_needs_no_extra(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "shtab", None)
    with pytest.raises(SystemExit):
        main(["--help"])
    assert "completion" in capsys.readouterr().out
