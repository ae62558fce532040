"""Texts of small studies with every kind of answer."""

from __future__ import annotations

FAST = """
name: {name}
robot:
  anchors: [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
  platform: {{mass: 4000 kg}}
cable: {{density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}}
pose: {pose}
workspace:
  region: {{prism: anchors, inset: {inset}, z: [-200, -40]}}
  samples: 300
  hangs_below: {hangs_below}
  sag: none
selection: {{grades: {grades}, safety_factor: 2}}
"""
DEFAULTS = {
    "name": "Crane",
    "pose": "[250, 200, -50]",
    "inset": "10.35 m",
    "hangs_below": "include",
    "grades": "[gost-6x19s-iwrc-1960, unirope-7x19-galvanised]",
}
CASES: dict[str, dict[str, str]] = {
    "positive": {},
    "exclude": {"hangs_below": "exclude"},
    "no_finite_cable": {"inset": "0 m"},
    "only_found_by_search": {"inset": "4.5 m"},
    "pose_outside": {"pose": "[250, -60, -50]"},
    "too_thin": {"grades": "[unirope-7x19-galvanised]"},
    "markup": {"name": "'<b>A</b> & <script>alert(1)</script>'"},
}
