"""What the server of `spear explore` answers is what the study computes."""

import base64
import json
from urllib.parse import urlencode

import numpy as np
import pytest
import umsgpack

from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.hops import settle_hops
from spear_pin.studies.explore.legs import spear_ii_hop
from tests.viz.explore.exploring import ask


class TestAnswers:
    @pytest.mark.slow
    def test_a_hop_is_what_the_study_computes(self, server):
        knobs = spear_ii_hop().at(stiffness=52.0, stance_torque=8.2)
        hops = settle_hops(knobs, best_engine())
        shown = json.loads(ask(server, f"/hop?{urlencode({'stiffness': 52, 'stance_torque': 8.2})}")[2])
        assert shown["knobs"] == knobs.values and shown["view"] == "settled"
        assert shown["verdict"] == hops.verdict and shown["message"] == hops.message
        assert shown["figures"] == pytest.approx(figures(hops))
        assert shown["duration"] == pytest.approx(hops.gait.period)
        series = {name: np.array(values) for name, values in shown["series"].items()}
        assert {len(values) for values in series.values()} == {len(hops.trajectory.t)}
        np.testing.assert_allclose(series["normal"], hops.trajectory.force[:, 0, 1], atol=0.01)
        total = series["motor"] + series["spring"] + series["damper"]
        np.testing.assert_allclose(total, hops.trajectory.tau[:, 1], atol=0.002)

    @pytest.mark.slow
    def test_the_playback_keeps_the_robot_and_the_ground(self, server):
        shown = json.loads(ask(server, "/hop?friction=0.3")[2])
        commands = [umsgpack.unpackb(base64.b64decode(command)) for command in shown["commands"]]
        drawn = [command["path"].split("/")[3] for command in commands if command["type"] == "set_object"]
        assert {name.split(" ")[0] for name in drawn} <= {"robot", "path", "force"}
        assert not any("/shape " in command["path"] for command in commands if command["type"] == "set_object")
        assert not any(command["path"].startswith("/Cameras") for command in commands)
        assert commands[-1]["type"] == "set_animation"

    @pytest.mark.slow
    def test_the_same_address_gives_the_same_answer(self, server):
        assert ask(server, "/hop?damping=1.2")[2] == ask(server, "/hop?damping=1.2")[2]

    @pytest.mark.slow
    def test_the_script_is_a_download(self, server):
        _, headers, body = ask(server, "/script?friction=0.5")
        assert headers["Content-Disposition"] == 'attachment; filename="explored_hop.py"'
        assert body.decode() == write_script(settle_hops(spear_ii_hop().at(friction=0.5), best_engine()))
