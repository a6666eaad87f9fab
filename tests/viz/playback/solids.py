"""Mesh files, written by the tests."""

import struct

import numpy as np

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip
"""Of a cube between the origin and (1, 1, 1)."""

COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="{meter}"/><up_axis>Z_UP</up_axis></asset>
<library_effects>{effect}</library_effects>
<library_materials><material id="paint"><instance_effect url="#coat"/></material></library_materials>
<library_geometries><geometry id="cube"><mesh>
  <source id="places"><float_array id="numbers" count="24">{corners}</float_array>
    <technique_common><accessor source="#numbers" count="8" stride="3">
      <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
    </accessor></technique_common></source>
  <vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
  <triangles count="12" material="paint">
    <input semantic="VERTEX" source="#corners" offset="0"/><p>{faces}</p></triangles>
</mesh></geometry></library_geometries>
<library_nodes>{nodes}</library_nodes>
<library_visual_scenes><visual_scene id="all"><node id="node">
  <matrix>1 0 0 {shift} 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
  <instance_geometry url="#cube"><bind_material><technique_common>
    <instance_material symbol="paint" target="#paint"/>
  </technique_common></bind_material></instance_geometry>
</node>{put}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#all"/></scene>
</COLLADA>"""
EFFECT = """<effect id="coat"><profile_COMMON><technique sid="common"><lambert>
<diffuse><color>1 0.2 0 1</color></diffuse></lambert></technique></profile_COMMON></effect>"""


def stl(corners=CORNERS, faces=FACES) -> bytes:
    """A binary STL."""
    triangles = np.zeros((len(faces), 12), dtype="<f4")
    triangles[:, 3:] = np.asarray(corners)[faces].reshape(-1, 9)
    return b"\0" * 80 + struct.pack("<I", len(faces)) + b"".join(row.tobytes() + b"\0\0" for row in triangles)


def obj(extra="") -> str:
    """The cube as an OBJ."""
    return "\n".join(
        [extra] + [f"v {x} {y} {z}" for x, y, z in CORNERS] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES]
    )


def dae(meter=1.0, shift=0.0, effect=EFFECT, nodes="", put="") -> str:
    """The cube as COLLADA, orange, moved along x; with nodes beside it, and one of them put into the scene."""
    put = put and f'<node><instance_node url="#{put}"/></node>'
    corners, faces = (" ".join(map(str, array.ravel())) for array in (CORNERS, FACES))
    return COLLADA.format(meter=meter, shift=shift, effect=effect, corners=corners, faces=faces, nodes=nodes, put=put)


def ball(rings, center=(0.0, 0.0, 0.0), radius=1.0):
    """Corners and faces of a sphere, 2 rings² faces or so."""
    turn, height = np.meshgrid(np.arange(rings) * 2 * np.pi / rings, np.linspace(0, np.pi, rings + 1), indexing="ij")
    corners = np.stack((np.sin(height) * np.cos(turn), np.sin(height) * np.sin(turn), np.cos(height)), axis=-1)
    here = np.arange(rings)[:, None] * (rings + 1) + np.arange(rings)
    there = np.roll(here, -1, axis=0)
    faces = np.stack((here, there, there + 1, here, there + 1, here + 1), axis=-1)
    return radius * corners.reshape(-1, 3) + center, faces.reshape(-1, 3)
