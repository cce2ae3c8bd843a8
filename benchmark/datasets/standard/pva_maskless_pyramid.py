"""`pva-maskless-pyramid`: four solar cells on the faces of a pyramid."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.faces import QUADRANTS, TOWARDS_QUADRANTS, faces
from benchmark.datasets.conditions.solar_faces import cells_on, solar_conditions

PRESET = faces(
    name="pva-maskless-pyramid",
    version=3,
    drawn_as=1,
    detector="PVA",
    normals=QUADRANTS,
    order=TOWARDS_QUADRANTS,
    setups=solar_conditions(cells_on(QUADRANTS, sunlit_ua=50_000.0), body="pyramid"),
    half_fov_deg=55.0,
    directions=ConeField(55.0),
    follows=("Pita2014", "Wang2019"),
    description=(
        "Single solar cells on the lateral faces of a regular pyramid (eq:msfpyra1), as on "
        "NANOSAT-1B (Pita2014) and as Wang2019 suggests. Number and tilt of faces are not "
        "known. Assumed: four faces, 30 deg from the boresight, all lit within a cone of 110 "
        "deg; cells as in pva-maskless-sphere."
    ),
)
