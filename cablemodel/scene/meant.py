"""What a key that no scene has may stand for: words of other programs, and of the trade."""

from __future__ import annotations

import re

_MEANT: dict[str, tuple[str, ...]] = {
    "ea": ("axial_stiffness",),
    "stiffness": ("axial_stiffness",),
    "ba": ("axial_damping",),
    "damping": ("axial_damping",),
    "ei": ("bending_stiffness",),
    "od": ("diameter",),
    "outerdiameter": ("diameter",),
    "diam": ("diameter",),
    "d": ("diameter",),
    "radius": ("diameter (twice the radius)",),
    "massden": ("mass",),
    "massperunitlength": ("mass",),
    "massperlength": ("mass",),
    "linearmass": ("mass",),
    "inertia": ("rotary_inertia",),
    "w": ("submerged_weight",),
    "weight": ("submerged_weight",),
    "wetweight": ("submerged_weight",),
    "weightinwater": ("submerged_weight",),
    "buoyancy": ("submerged_weight (negative: it floats)",),
    "volume": ("submerged_weight (of mass less the water displaced)",),
    "cd": ("drag_normal", "drag_coefficient", "drag_area (area times coefficient)"),
    "cdn": ("drag_normal", "drag_coefficient"),
    "cdt": ("drag_tangential", "drag_coefficient_axial"),
    "cdax": ("drag_tangential", "drag_coefficient_axial"),
    "cda": ("drag_area",),
    "normaldrag": ("drag_normal",),
    "tangentialdrag": ("drag_tangential",),
    "axialdrag": ("drag_tangential", "drag_area_axial"),
    "dragcoefficient": ("drag_normal", "drag_area (area times coefficient)"),
    "ca": ("added_mass",),
    "can": ("added_mass",),
    "cm": ("added_mass (the coefficient less 1)",),
    "unstrlen": ("length",),
    "unstretchedlength": ("length",),
    "drumlength": ("drum",),
    "numsegs": ("elements (which the tolerance decides by itself)",),
    "segments": ("elements (which the tolerance decides by itself)",),
    "linetype": ("type",),
    "depth": ("floor: {z: -DEPTH}",),
    "seabed": ("floor",),
    "seafloor": ("floor",),
    "bathymetry": ("floor: {depth_table: ...}", "depth_table"),
    "bottom": ("floor",),
    "waterdepth": ("floor: {z: -DEPTH}",),
    "wtrdpth": ("floor: {z: -DEPTH}",),
    "wtrdens": ("water_density",),
    "rho": ("water_density",),
    "density": ("water_density",),
    "g": ("gravity",),
    "frictioncoefficient": ("friction",),
    "waveheight": ("height", "hs"),
    "waveperiod": ("period", "tp"),
    "tz": ("tp (the peak period, some 1.29 Tz)",),
    "h": ("height",),
    "t": ("period",),
    "speed": (
        "path: legs with speed and heading, or velocity: [x, y, z]",
        "table: rows of z and velocity (a uniform current is one list [x, y, z])",
        "velocity: [x, y, z]",
    ),
    "heading": ("path: legs with speed and heading",),
    "yaw": ("attitude",),
    "course": ("path: legs with speed and heading",),
    "altitude": ("position",),
    "latitude": ("position",),
    "longitude": ("position",),
    "winches": ("payout (winches by name are of systems, which have lines)",),
    "raos": ("velocity: {file: ...} (raos are of systems, which have lines)",),
    "points": ("position (points by name are of systems, which have lines)",),
    "winch": ("payout", "winches"),
    "bodies": ("line: [..., {body: ...}] (bodies by name are of systems, which have lines)",),
    "cuts": ("line (cuts are of systems, which have lines)",),
    "tau": ("tolerance",),
    "dt": ("output_interval (steps are chosen by the tolerance)",),
    "timestep": ("output_interval (steps are chosen by the tolerance)",),
    "dtout": ("output_interval",),
    "tmax": ("duration",),
    "simulationtime": ("duration",),
    "until": ("duration",),
    "start": ("from",),
    "enda": ("from",),
    "end": ("to", "duration"),
    "endb": ("to",),
    "fairleads": ("points",),
    "fairlead": ("point",),
    "buoys": ("bodies",),
    "linetypes": ("cable_types",),
}
"""By the word in small letters and digits: keys, the first of which a place knows is meant; what
follows a key tells how it is used."""

_OF_ONE_LINE = {"bodies": "vessel", "cuts": "vessel", "winches": "vessel", "raos": "path"}
"""Words of systems, and what a place in a scene of one line knows, where they may be meant: ends of
lines have a key line, too."""


def meant(word: str, known: list[str]) -> str:
    """The key, of those that a place knows, that such a word stands for elsewhere; else nothing."""
    plain = re.sub(r"[\W_]", "", word.lower())
    if _OF_ONE_LINE.get(plain, known[0] if known else "") not in known:
        return ""
    for key in _MEANT.get(plain, ()):
        if re.split(r"\W", key, maxsplit=1)[0] in known:
            return key
    return ""
