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
  sag: 50 %
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

SIX = """
name: Six cables
robot:
  anchors:
    - [30, 0, 12]
    - [30, 0.8, 12]
    - [-15, 26, 12]
    - [-15.7, 25.6, 12]
    - [-15, -26, 12]
    - [-14.3, -26.4, 12]
  platform:
    mass: 900 kg
    attachments: [[1, -1.73, 0], [1, 1.73, 0], [1, 1.73, 0], [-2, 0, 0], [-2, 0, 0], [1, -1.73, 0]]
    centre_of_mass: [0, 0, -0.5]
    hull: [[-2, 1], [-1.8, 1.8], [-1, 0]]
cable: {{density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}}
workspace:
  region: {region}
  samples: 60
  clearance: {clearance}
{selection}
"""
PRISM = "{prism: anchors, inset: 9 m, z: [1, 8]}"
SELECTION = "selection: {grades: [lg-7x19-wsc-galvanised-2070], safety_factor: 2}"
CLEARANCE_KEPT = SIX.format(region=PRISM, clearance="0.1 m", selection=SELECTION)
CLEARANCE_NOT_KEPT = SIX.format(region=PRISM, clearance="0.4 m", selection="")
