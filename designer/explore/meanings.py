"""What the numbers of a study are called, and what each is: by their paths without list places."""

from __future__ import annotations

from collections.abc import Mapping

GROUPS: Mapping[str, str] = {
    "robot": "Robot and load",
    "cable": "Cable family",
    "pose": "Pose",
    "load_cases": "Load cases",
    "workspace": "Workspace",
    "selection": "Choice of the rope",
    "measurements": "Measured data",
    "effects": "Effects",
    "surroundings": "Surroundings",
}
"""Titles of the sections of the file."""

_TURN = "Component of the rotation vector: axis times angle, from the platform's frame to the world"

MEANINGS: Mapping[str, tuple[str, str]] = {
    "robot.anchors": (
        "Exit point",
        "Where the cable leaves the base, in the world frame, z upward.",
    ),
    "robot.platform.mass": (
        "Platform with payload",
        "Mass that the cables carry: the platform with its payload.",
    ),
    "robot.platform.attachments": (
        "Attachment",
        "Where the cable holds the platform, in the platform's own frame.",
    ),
    "robot.platform.centre_of_mass": (
        "Centre of mass",
        "Where the platform's weight acts, in its own frame.",
    ),
    "robot.platform.hull": (
        "Hull of the platform",
        "Box, in the platform's own frame, that cables shall keep clear of.",
    ),
    "robot.platform.wrench.force": (
        "Force on the platform",
        "Constant force beside the weight, along the axes of the world frame.",
    ),
    "robot.platform.wrench.moment": (
        "Moment on the platform",
        "Constant moment about the origin of the platform's frame, along the axes of the world.",
    ),
    "robot.gravity": ("Gravity", "Where things fall; only its direction counts."),
    "robot.planar": ("Planar", "Whether the robot lies in one vertical plane."),
    "robot.tension_min": (
        "Least tension",
        "Least tension anywhere in any cable, where there are more cables than degrees of freedom.",
    ),
    "cable.density": (
        "Density",
        "Mass per length over the area of the circle of the nominal diameter, of the family in "
        "which the optimum is computed.",
    ),
    "cable.youngs_modulus": (
        "Modulus",
        "Force per strain over the area of the circle of the nominal diameter.",
    ),
    "cable.allowable_stress": (
        "Allowable stress",
        "Allowable tension over the area of the circle of the nominal diameter, safety factor "
        "included.",
    ),
    "cable.safety_factor": (
        "Safety factor of the family",
        "Breaking load over allowable tension of the grade that the optimum is computed in.",
    ),
    "pose.position": ("Position", "Origin of the platform's frame in the world frame."),
    "pose.rotation_vector": ("Turn", f"{_TURN}."),
    "pose.euler.angles": ("Euler angle", "Turned about in the order of the convention."),
    "workspace.region.inset": (
        "Inset",
        "How far the outline of the region is moved inward from the outline of the anchors or "
        "corners.",
    ),
    "workspace.region.z": ("Height", "Lowest and highest z of the region."),
    "workspace.region.box": ("Box", "From where to where the region reaches along each axis."),
    "workspace.region.prism": ("Corner", "Corner of the region's outline, seen from above."),
    "workspace.region.rectangle": ("End", "End of the region's lower edge, seen from above."),
    "workspace.region.points": ("Point", "Position that the platform shall be able to take."),
    "workspace.samples": ("Samples", "Number of positions of the region that are tried."),
    "workspace.sampling": (
        "Kind of samples",
        "An even random spread (low_discrepancy), or a grid.",
    ),
    "workspace.seed": ("Seed", "Of the random spread; another one tries other positions."),
    "workspace.hangs_below": (
        "Cables that hang below",
        "Whether poses in which a cable hangs below the platform count.",
    ),
    "workspace.clearance": (
        "Clearance",
        "Least distance that cables shall keep from each other and from the platform.",
    ),
    "workspace.floor": ("Floor", "Height that no cable may hang below."),
    "workspace.proof": (
        "Time for the proof",
        "How long to try to prove that the chosen rope holds in all poses; 0 for not at all.",
    ),
    "workspace.orientation.rotation_vector": ("Turn", f"{_TURN}, at every position."),
    "workspace.orientation.euler.angles": ("Euler angle", "Of the platform at every position."),
    "workspace.orientations.rotation_vector": ("Turn", f"{_TURN}, one of several."),
    "workspace.orientations.euler.angles": ("Euler angle", "Of one of several orientations."),
    "workspace.orientation_range.rx": ("Turn about x", f"{_TURN}: from where to where."),
    "workspace.orientation_range.ry": ("Turn about y", f"{_TURN}: from where to where."),
    "workspace.orientation_range.rz": ("Turn about z", f"{_TURN}: from where to where."),
    "selection.safety_factor": (
        "Safety factor",
        "What is left of the minimum breaking load, over the allowable tension.",
    ),
    "selection.termination_efficiency": (
        "End fittings keep",
        "Share of the breaking load that the end fittings keep: poured socket about 1, swaged "
        "0.95, steel ferrule 0.89, clips 0.8, wedge socket 0.75.",
    ),
    "selection.sheave_diameter": (
        "Sheave diameter",
        "Diameter that the rope is bent over; a wire rope keeps 1 - 0.5/sqrt(D/d) of its breaking "
        "load. Bending is left out where it is not given.",
    ),
    "selection.max_distinct_products": (
        "Different ropes",
        "How many different ropes the groups of cables may have between them.",
    ),
    "load_cases.mass": (
        "Mass in load case",
        "Mass of the platform with its payload in this case, instead of the study's.",
    ),
    "load_cases.wrench.force": (
        "Force in load case",
        "Constant force on the platform in this case, along the axes of the world frame.",
    ),
    "load_cases.wrench.moment": (
        "Moment in load case",
        "Constant moment on the platform in this case, along the axes of the world frame.",
    ),
    "load_cases.dynamic_factor": (
        "Dynamic factor in load case",
        "On the weight and the wrench of the platform, not on the cables' own weight.",
    ),
    "load_cases.acceleration": (
        "Acceleration in load case",
        "Of the platform, in the direction in which its inertia force is worst.",
    ),
    "load_cases.wind.speed": (
        "Wind in load case",
        "Speed of the wind, horizontal; it acts on the platform and on the cables.",
    ),
    "load_cases.wind.directions": (
        "Winds in load case",
        "From how many directions, evenly spread, the wind may come.",
    ),
    "load_cases.ice.thickness": (
        "Ice in load case",
        "Thickness of the ice around the cables.",
    ),
    "load_cases.ice.density": ("Density of ice in load case", "Of the ice around the cables."),
    "load_cases.safety_factor": (
        "Safety factor in load case",
        "Instead of that of the selection.",
    ),
    "load_cases.termination_efficiency": (
        "End fittings keep in load case",
        "Share of the breaking load, instead of that of the selection.",
    ),
    "load_cases.cable_lost": ("Cable lost in load case", "Number of the cable that breaks."),
    "measurements.settled": (
        "Settled",
        "Whether each row of the data is a pose at rest; else a sample of a slow motion.",
    ),
    "measurements.cable.linear_mass": (
        "Mass of the cable on the machine",
        "Mass per length of the cable that was on the machine when it was measured.",
    ),
    "measurements.cable.axial_stiffness": (
        "Stiffness of the cable on the machine",
        "Force per strain of the cable that was on the machine when it was measured.",
    ),
    "measurements.cable.diameter": (
        "Diameter of the cable on the machine",
        "Nominal diameter of the cable that was on the machine, for laws that ask for it.",
    ),
    "measurements.cable.minimum_breaking_load": (
        "Breaking load of the cable on the machine",
        "With it the cable is checked as a product would be.",
    ),
    "measurements.noise.length": ("Noise of lengths", "Standard deviation of a measured length."),
    "measurements.noise.tension": (
        "Noise of tensions",
        "Standard deviation of a measured tension.",
    ),
    "measurements.search_time": (
        "Time for the search",
        "How long the diagnosis may search for effects.",
    ),
    "surroundings.temperature": (
        "Temperature",
        "What the laws of effects are given in a design; lengths are counted at 20 °C.",
    ),
}
"""Title and definition."""
