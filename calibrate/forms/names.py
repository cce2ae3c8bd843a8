"""Names that columns have in readers' files, and what each stands for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TypeVar

from calibrate.settings import AngleForm, Kind

_Word = TypeVar("_Word", bound=str)
_AZIMUTH = r"(az|azim|azimuth|phi)(_angle)?"
_ABOUT = r"(rot|theta|angle|tilt|r)_?@|@_?(angle|tilt)"
_INNER = (
    rf"inner|pitch|tilt|{_ABOUT.replace('@', 'x')}|x_deg|dec|inner_(gimbal|angle|axis)"
    r"|gimbal_?(inner|1|x)|axis_?1|vert(ical)?(_angle)?|v_angle|theta"
)
_OUTER_AXIS = (
    rf"outer|yaw|pan|{_ABOUT.replace('@', 'y')}|y_deg|ha|outer_(gimbal|angle|axis)"
    r"|gimbal_?(outer|2|y)|axis_?2|hor(izontal)?(_angle)?|h_angle|psi"
)
#: Patterns of two angles, tried in this order; `named` puts ``_deg`` behind names with a unit.
ANGLES: tuple[tuple[AngleForm, tuple[str, ...]], ...] = (
    (
        "azimuth-zenith",
        (_AZIMUTH, r"(zenith|polar|off_?axis|theta|cone|boresight|incidence|aoi)(_angle)?"),
    ),
    ("azimuth-elevation", (_AZIMUTH, r"(el|elev|elevation|alt|altitude)(_angle)?")),
    ("projection", (r"alpha", r"beta")),
    (
        "alpha-inner",
        (_INNER, _OUTER_AXIS),
    ),
)
#: Names of the angle of a sensor of one axis.
ONE_ANGLE = (
    r"(sun_|light_)?(theta|angle|alpha|beta|phi|pan|tilt|rot(ation)?|aoi|incidence|table|stage"
    r"|el(evation)?|az(imuth)?|yaw|pitch|roll)(_?[xy])?(_angle)?"
)
_SUN = r"(sun|s|u|n|dir(ection)?|light|los|truth|true|vec(tor)?)"
_OF_SENSOR = r"(_?(vec(tor)?|dir(ection)?|body|b|sensor|sens|sf|true|truth|unit))?"
_OUTER = r"(eci|icrf|j2000|gcrf|gcrs|inertial|i|ref(erence)?|world|lab|bench|table|outer)"


def _components(pattern: str) -> tuple[str, ...]:
    return tuple(pattern.replace("@", part) for part in "xyz")


#: A vector towards the light, one along its rays, and one in the outer frame of an attitude.
VECTOR = _components(rf"{_SUN}{_OF_SENSOR}_?@|{_SUN}_?@_(body|b|sensor|true)|@_(sun|light|true)")
FROM_LIGHT = _components(
    r"(sun_to_(sensor|sat|body|sc)|from_(sun|light)|rays?|light_dir|incident|incoming|photon)"
    r"(_dir(ection)?)?_?@"
)
OUTER_LIGHT = _components(rf"{_SUN}_{_OUTER}_?@|{_OUTER}_{_SUN}_?@|{_SUN}_?@_{_OUTER}")
_Q = r"(att(itude)?_|body_|sc_|b_)?(q|quat|quaternion)_?"
#: Quaternions whose scalar the names tell, its place last, and those that are numbered.
QUATERNION = (
    tuple(_Q + part for part in ("x", "y", "z", "(w|s|r|scalar)")),
    tuple(_Q + part for part in ("i", "j", "k", "(w|s|r|scalar)")),
    tuple(_Q + part for part in ("v1", "v2", "v3", "(w|s|r|scalar)")),
)
NUMBERED = tuple(tuple(_Q + part for part in word) for word in ("0123", "1234"))
_R = r"(r|m|rot|dcm|a|c|att|matrix|att_matrix)_?"
#: Rotation matrices, row by row.
MATRICES = tuple(
    tuple(f"{_R}{row}_?{column}" for row in word for column in word)
    for word in ("123", "012", "xyz")
)

_SPOT = r"(spot|centroid|centre|center|peak|pos(ition)?|c)"
_ALIKE = r"(q|quad|quadrant|v|i|ch|pd|cell|sig(nal)?)"
_QUADRANT = r"((q|quad(rant)?|v|i|ch|pd|cell|sig(nal)?)_?)?"
READINGS: tuple[tuple[Kind, tuple[str, ...]], ...] = (
    ("frames", (r"(frame|image|picture|photo)(_?(file|name|path))?|file_?name",)),
    *(
        ("quadrants", tuple(_QUADRANT + part for part in parts))
        for parts in (
            (r"(ul|tl|nw)", r"(ur|tr|ne)", r"(lr|br|se)", r"(ll|bl|sw)"),
            (
                r"(upper|top)_?left",
                r"(upper|top)_?right",
                r"(lower|bottom)_?right",
                r"(lower|bottom)_?left",
            ),
            (r"ii", r"i", r"iv", r"iii"),  # as the quadrants of a plane are counted
        )
    ),
    (
        "balance",
        (
            r"(balance_?x|s_?a|sx_?bal|fx|x_?balance|bal_?x|ratio_?x|x_?ratio)",
            r"(balance_?y|s_?b|fy|y_?balance|bal_?y|ratio_?y|y_?ratio)",
        ),
    ),
    (
        "spot",
        (
            rf"({_SPOT}_?)?x(c|_?pos|_?pix)?|u|col(umn)?",
            rf"({_SPOT}_?)?y(c|_?pos|_?pix)?|v|row",
        ),
    ),
    (
        "electrodes",
        (
            r"(i_?|v_?)?x_?(1|p|plus|pos|\+)",
            r"(i_?|v_?)?x_?(2|m|minus|neg|n|-)",
            r"(i_?|v_?)?y_?(1|p|plus|pos|\+)",
            r"(i_?|v_?)?y_?(2|m|minus|neg|n|-)",
        ),
    ),
    *(
        (
            "quadrants",
            tuple(rf"(q|quad|quadrant|v|i|ch|pd|cell|sig(nal)?)_?{part}" for part in word),
        )
        for word in ("1234", "abcd")
    ),
    ("quadrants", ("a", "b", "c", "d")),
)
#: Two photodiodes of one axis, the first lit more where the angle is positive.
PAIR = (
    (
        r"(.*_)?(p|plus|pos|right|r|a|1|\+)|.*[a-z](a|1|p|\+)",
        r"(.*_)?(m|minus|n|neg|left|l|b|2|-)|.*[a-z](b|2|m|n|-)",
    ),
)
RUN = r"(run|series|sweep|file|test)(_?(id|no|number))?"
TIME = (
    r"(t|time(_?stamp)?|date(_?time)?|utc|epoch|unix(_time)?|elapsed(_time)?|seconds|m?jd"
    r"|julian_da(te|y)|met)(_.*)?"
)
TEMPERATURE = r"(.*_)?temp(erature)?(_.*)?|t"
INDEX = r"(index|idx|id|no|nr|num(ber)?|n|#|row|sample|point|pose|pos_?(id|no)|column_1|unnamed.*)"
#: One of many alike.
CHANNEL = r"(q|ch|channel|i|v|pd|cell|face|s|adc|p|panel|css|diode|d|sensor|sig(nal)?)_?\d+"
#: Unit normals of faces by what their channel's name ends in.
_FACES = {
    "xp": (1.0, 0.0, 0.0),
    "xm": (-1.0, 0.0, 0.0),
    "yp": (0.0, 1.0, 0.0),
    "ym": (0.0, -1.0, 0.0),
    "zp": (0.0, 0.0, 1.0),
    "zm": (0.0, 0.0, -1.0),
}
_FACE = re.compile(
    r"(?:.*_)?(?:([xyz])_?(p|plus|pos|\+|m|minus|neg|n|-)|([+-]|plus_?|minus_?)([xyz]))$",
    re.IGNORECASE,
)


def match(pattern: str, keys: Mapping[str, str], among: Sequence[str]) -> str | None:
    """Return the first of some columns whose key is of a pattern, with a unit of angles or not."""
    whole = re.compile(pattern)
    return next(
        (
            name
            for name in among
            if whole.fullmatch(keys[name]) or whole.fullmatch(keys[name].removesuffix("_deg"))
        ),
        None,
    )


def match_all(
    patterns: Sequence[str], keys: Mapping[str, str], among: Sequence[str]
) -> tuple[str, ...]:
    """Return a column for each pattern, each another one; none at all where one is missing."""
    found: list[str] = []
    for pattern in patterns:
        name = match(pattern, keys, [one for one in among if one not in found])
        if name is None:
            return ()
        found.append(name)
    return tuple(found)


def first_of(
    patterns: Sequence[tuple[_Word, Sequence[str]]], keys: Mapping[str, str], among: Sequence[str]
) -> tuple[_Word | None, tuple[str, ...]]:
    """Return the first entry whose patterns each match another column, with these columns."""
    for word, wanted in patterns:
        found = match_all(wanted, keys, among)
        if found:
            return word, found
    return None, ()


def face_normal(bare: str) -> tuple[float, float, float] | None:
    """Return the normal of the face that a channel's name says, if it says one."""
    found = _FACE.fullmatch(bare)
    if found is None:
        return None
    axis = (found[1] or found[4]).lower()
    sign = "p" if (found[2] or found[3]).lower() in ("p", "plus", "plus_", "pos", "+") else "m"
    return _FACES[axis + sign]
