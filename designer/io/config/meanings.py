"""What the fields of a study are called and mean: by their paths without list places."""

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
    "uncertainty": "Uncertainty",
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
    "robot.platform.drag.area": (
        "Area across the wind",
        "Of the platform, as the wind of a load case finds it.",
    ),
    "robot.platform.drag.coefficient": (
        "Drag of the platform",
        "Force of the wind over its pressure times the area.",
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
    "workspace.sag": (
        "Largest sag",
        "Largest distance of a cable from its chord, over the chord. Of ropes to buy, 20 % unless "
        "given; of the configured cable only if given. The word none lifts it.",
    ),
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
    "selection.limits.stiffness": (
        "Least stiffness",
        "Force per displacement of the platform, in any direction, cables of fixed length.",
    ),
    "selection.limits.excitation": (
        "Excitation",
        "Band of frequencies in which no cable shall swing as a string.",
    ),
    "selection.limits.drum_capacity": (
        "Drum capacity",
        "Rope that a drum takes up, beside its dead turns.",
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
        "From how many directions, evenly spread, the wind may come; all searches for the worst.",
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
    "cable.drag_coefficient": (
        "Drag of the cables",
        "Force of a load case's wind over its pressure times the cables' diameter and length.",
    ),
    "cable.thermal_expansion": (
        "Thermal expansion of the cables",
        "Strain per change of temperature in load cases; left out, that of the rope's table, or "
        "that of steel, 12e-6 /K.",
    ),
    "load_cases.temperature_change": (
        "Change of temperature in load case",
        "Of the cables since the pose was reached; the winches are braked and the lengths kept, "
        "so that the platform comes to rest elsewhere.",
    ),
    "load_cases.cable_lost": ("Cable lost in load case", "Number of the cable that breaks."),
    "uncertainty.payload.standard_deviation": (
        "Scatter of the payload",
        "Standard deviation of weight, inertia and constant loads of the platform, of a normal "
        "distribution, relative.",
    ),
    "uncertainty.payload.uniform": (
        "Range of the payload",
        "Half width of a uniform distribution of the same, relative, or its two ends.",
    ),
    "uncertainty.modulus.standard_deviation": (
        "Scatter of the modulus",
        "Standard deviation of the rope's modulus, of a normal distribution, relative.",
    ),
    "uncertainty.modulus.uniform": (
        "Range of the modulus",
        "Half width of a uniform distribution of the same, relative, or its two ends.",
    ),
    "uncertainty.linear_mass.standard_deviation": (
        "Scatter of the rope's mass",
        "Standard deviation of the rope's mass per length, of a normal distribution, relative.",
    ),
    "uncertainty.linear_mass.uniform": (
        "Range of the rope's mass",
        "Half width of a uniform distribution of the same, relative, or its two ends.",
    ),
    "uncertainty.breaking_load.standard_deviation": (
        "Scatter of the breaking load",
        "Standard deviation of the rope's breaking load, of a normal distribution, relative.",
    ),
    "uncertainty.breaking_load.uniform": (
        "Range of the breaking load",
        "Half width of a uniform distribution of the same, relative, or its two ends.",
    ),
    "uncertainty.exit_points.standard_deviation": (
        "Scatter of the exit points",
        "Standard deviation of each coordinate of each exit point, of a normal distribution.",
    ),
    "uncertainty.exit_points.uniform": (
        "Range of the exit points",
        "Half width of a uniform distribution of the same, or its two ends.",
    ),
    "uncertainty.samples": ("Draws", "How often the inputs are drawn."),
    "uncertainty.seed": ("Seed of the draws", "Of the random numbers; other seeds, other draws."),
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

WORDS: Mapping[str, str] = {
    "name": "Title of the report.",
    "robot": "The machine.",
    "robot.platform": "What the cables carry.",
    "robot.platform.wrench": "Constant load beside the weight, at the origin of the platform's "
    "frame.",
    "robot.platform.drag": "What the wind of a load case finds of the platform.",
    "cable": "The family of cables in which the optimum is computed: by its figures, or a grade "
    "as if it were sold in every diameter.",
    "cable.grade": "Id of a grade, from `designer catalog list`.",
    "pose": "One pose that the report shows in detail.",
    "pose.quaternion": "Orientation as a unit quaternion [w, x, y, z] from the platform's frame "
    "to the world.",
    "pose.euler": "Orientation as three turns, one after the other.",
    "pose.euler.convention": "Order of the axes: XYZ turn with the platform, xyz stay.",
    "workspace": "All poses that the cable has to serve.",
    "workspace.region": "Where the platform works: one of prism, box, points and rectangle.",
    "workspace.orientation": "How the platform is turned at every position.",
    "workspace.orientation.quaternion": "Orientation as a unit quaternion [w, x, y, z].",
    "workspace.orientation.euler": "Orientation as three turns, one after the other.",
    "workspace.orientation.euler.convention": "Order of the axes: XYZ turn with the platform, "
    "xyz stay.",
    "workspace.orientations": "Several orientations, all of them asked for at every position.",
    "workspace.orientation_range": "All rotation vectors between two ends a component, zero where "
    "left out, asked for at every position.",
    "selection": "Which rope to buy.",
    "selection.grades": "Grades to choose among: all, or a list of ids from "
    "`designer catalog list`.",
    "selection.objectives": "What ropes are compared by; the first decides.",
    "selection.limits": "What else the chosen rope is checked against.",
    "selection.groups": "Cables that may get a rope of their own: names, each with its cable "
    "numbers, counted from 1 in the order of the anchors.",
    "load_cases": "Load cases, at most 50, in each of which the rope has to hold everywhere; left "
    "out, there is one case without wind, ice, motion or loss of a cable.",
    "load_cases.name": "What the report calls the case.",
    "load_cases.wrench": "Constant load on the platform in this case, instead of the robot's.",
    "load_cases.wind": "Wind on the platform and on the cables.",
    "load_cases.wind.direction": "Where the wind blows to; instead of `directions`.",
    "load_cases.ice": "Ice around the cables.",
    "load_cases.region": "Where the platform is in this case, instead of the workspace's region.",
    "catalogues": "Rope tables of your own: files or folders, relative to this file.",
    "measurements": "What was measured on the built machine, for `designer diagnose`.",
    "measurements.file": "The table, a CSV file, relative to this file.",
    "measurements.columns": "What the file's columns are, where their names are not ours.",
    "measurements.columns.to": "Our name, such as length_1_m; ignore; or covariate.",
    "measurements.columns.unit": "Unit of the readings.",
    "measurements.columns.scale": "Factor from the readings to ours; instead of a unit.",
    "measurements.columns.offset": "What is added after that, as a quantity.",
    "measurements.unknown": "Effects that are fitted from the start and not counted as a finding; "
    "`anchors` for all exit points; `poses` where lengths and tensions have to tell them.",
    "measurements.cable": "The cable that was on the machine.",
    "measurements.noise": "Standard deviations of one reading; estimated from the data where left "
    "out.",
    "measurements.noise.estimated": "Which of them a diagnosis has estimated; it writes this.",
    "effects": "What the machine is known to do beside the rest, by the ids of effects; "
    "`designer diagnose` writes here what it finds.",
    "surroundings": "What the laws of effects are given in a design.",
    "uncertainty": "How surely inputs are known: how likely the chosen rope is enough. What is "
    "left out is certain.",
    "uncertainty.payload": "Of weight, inertia and constant loads of the platform.",
    "uncertainty.modulus": "Of the rope's modulus; left out, what its grade states.",
    "uncertainty.linear_mass": "Of the rope's mass per length, on all cables alike.",
    "uncertainty.breaking_load": "Of the rope's breaking load, on all cables alike.",
    "uncertainty.exit_points": "Of each coordinate of each exit point, for itself.",
    "document": "What a drawing office writes at the head of the report.",
    "document.number": "Number of the document.",
    "document.revision": "Its revision.",
    "document.author": "Who made it.",
    "document.checker": "Who checked it.",
    "document.approver": "Who approved it.",
    "document.logo": "A picture for the head, PNG, JPEG or SVG, relative to this file.",
    "format": "Format of this file, for later versions of the program.",
}
"""What all else is: sections, texts and choices."""


def words_of(path: str) -> tuple[str, str]:
    """Return title and meaning of a field; those of a load case's region are the workspace's."""
    at = path.replace("load_cases.region.", "workspace.region.")
    if at not in MEANINGS:
        at = at.replace("orientations.", "orientation.")
    name = at.rpartition(".")[2].replace("_", " ")
    title = GROUPS.get(at, name[:1].upper() + name[1:])
    return MEANINGS.get(at) or (title, WORDS.get(at, ""))
